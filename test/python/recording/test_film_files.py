from __future__ import annotations

import sys
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from robotteamsim.errors import RecordingError
from robotteamsim.recording.film_files import find_ffmpeg, write_gif, write_mp4


def frames(count: int = 6) -> list[np.ndarray]:
    """A red square that moves to the right by 10 pixels a frame, over white."""
    made = []
    for index in range(count):
        frame = np.full((48, 96, 3), 255, dtype=np.uint8)
        frame[16:32, 10 * index : 10 * index + 16] = (220, 30, 30)
        made.append(frame)
    return made


def ffmpeg() -> str | None:
    try:
        return find_ffmpeg()
    except RecordingError:
        return None


def program(folder: Path, text: str) -> str:
    """Make a program that stands in for ffmpeg."""
    path = folder / "ffmpeg"
    path.write_text(f"#!{sys.executable}\n{text}\n")
    path.chmod(0o755)
    return str(path)


def test_gif_has_every_frame_in_its_colours(tmp_path):
    path = tmp_path / "film.gif"
    write_gif(path, iter(frames()), frames()[:2], frames_per_s=10)
    with Image.open(path) as film:
        assert film.n_frames == 6
        for index, frame in enumerate(frames()):
            film.seek(index)
            assert film.info["duration"] == 100
            np.testing.assert_allclose(np.asarray(film.convert("RGB")).astype(int), frame, atol=8)


@pytest.mark.skipif(ffmpeg() is None, reason="ffmpeg is not installed")
def test_mp4_has_every_frame(tmp_path):
    path = tmp_path / "film.mp4"
    write_mp4(path, iter(frames()), frames_per_s=25, ffmpeg=find_ffmpeg())
    film = cv2.VideoCapture(str(path))
    assert film.get(cv2.CAP_PROP_FPS) == 25.0
    for frame in frames():
        ok, image = film.read()
        assert ok
        assert np.abs(image[..., ::-1].astype(int) - frame).mean() < 12.0
    assert not film.read()[0]


def test_ffmpeg_is_given_every_byte_and_the_size(tmp_path):
    text = "import sys; open(sys.argv[-1], 'wb').write(repr(sys.argv[1:-1]).encode() + sys.stdin.buffer.read())"
    write_mp4(tmp_path / "film.mp4", iter(frames()), 25, program(tmp_path, text))
    content = (tmp_path / "film.mp4").read_bytes()
    assert b"'-s', '96x48', '-r', '25'" in content
    assert content.endswith(b"".join(frame.tobytes() for frame in frames()))


def test_ffmpeg_that_fails_is_one_line_and_leaves_nothing(tmp_path):
    (tmp_path / "bin").mkdir()
    text = "import sys; sys.stderr.write('banner\\nUnknown encoder libx264\\n'); sys.exit(1)"
    with pytest.raises(RecordingError) as refused:
        write_mp4(tmp_path / "film.mp4", iter(frames(2000)), 25, program(tmp_path / "bin", text))
    path = tmp_path / "film.mp4"
    assert str(refused.value) == f"{path}: cannot be written: ffmpeg: Unknown encoder libx264"
    assert [entry.name for entry in tmp_path.iterdir()] == ["bin"]


def test_missing_ffmpeg_is_named_with_its_remedy(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(
        RecordingError, match=r"`apt install ffmpeg`, or the extra 'film' \(docs/install\.md\); a GIF needs"
    ):
        find_ffmpeg()


def test_installed_ffmpeg_is_found(monkeypatch, tmp_path):
    path = program(tmp_path, "")
    monkeypatch.setenv("PATH", str(tmp_path))
    assert find_ffmpeg() == path
