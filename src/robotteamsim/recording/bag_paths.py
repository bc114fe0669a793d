"""The files and folders that are bags by their names."""

from pathlib import Path

METADATA = "metadata.yaml"
"""In each folder that `ros2 bag record` has written."""
SUFFIXES = (".bag", ".mcap", ".db3")
"""Of bags that are files: of ROS 1, and of the two formats of ROS 2."""


def is_bag(path: str | Path) -> bool:
    """Whether a path names a bag: a file by its suffix, a folder by its metadata."""
    path = Path(path)
    return path.suffix in SUFFIXES or (path / METADATA).is_file()


def files_of(path: Path) -> list[Path]:
    """Return the files of a bag."""
    return sorted(path.iterdir()) if path.is_dir() else [path]


def name_of(path: Path) -> str:
    """Return the name of a bag without its suffix."""
    path = path.absolute()
    return path.stem if path.suffix in SUFFIXES else path.name
