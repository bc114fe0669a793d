"""The packages that only some commands need: `pip install` brings them as extras, and their absence is one line."""

_EXTRA_OF_PACKAGE = {
    "PIL": "images",
    "collada": "mesh",
    "cv2": "images",
    "dask": "cluster",
    "distributed": "cluster",
    "ezdwg": "dwg",
    "ezdxf": "dxf",
    "fdsreader": "fds",
    "gymnasium": "learning",
    "ifcopenshell": "ifc",
    "jinja2": "report",
    "mapbox_earcut": "mesh",
    "matplotlib": "report",
    "mujoco": "mujoco",
    "pandas": "notebook",
    "pettingzoo": "learning",
    "scipy": "campaign",
    "stable_baselines3": "train",
    "statsmodels": "report",
    "tensordict": "train",
    "torch": "train",
    "torchrl": "train",
    "tornado": "cluster",
    "trimesh": "mesh",
}
"""The smallest extra of pyproject.toml that contains each package."""


def missing_extra(error: ImportError) -> str | None:
    """Return one line that says how to install the package that an import did not find; None if it is in no extra."""
    package = (error.name or "").partition(".")[0]
    extra = _EXTRA_OF_PACKAGE.get(package)
    if extra is None:
        return None
    needs = f"this needs the Python package {package}, which is not installed: it comes with the extra '{extra}'"
    if extra == "train":
        return f"{needs} (docs/learning.md)"
    return f"{needs} (docs/install.md), or with `make setup` in a clone of the repository"
