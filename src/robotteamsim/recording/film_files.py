"""Writes films: GIF with Pillow, MP4 with ffmpeg."""

import itertools
import shutil
import subprocess
import tempfile
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from robotteamsim.errors import RecordingError
from robotteamsim.recording.files import atomically


def find_ffmpeg() -> str:
    """Return the path of the installed ffmpeg, or of that of imageio-ffmpeg. Raises: RecordingError: neither exists."""
    if found := shutil.which("ffmpeg"):
        return found
    try:
        import imageio_ffmpeg

        return str(imageio_ffmpeg.get_ffmpeg_exe())
    except (ImportError, RuntimeError):
        remedy = "`apt install ffmpeg`, or the extra 'film' (docs/install.md)"
        raise RecordingError(f"an MP4 needs ffmpeg, which is not installed: {remedy}; a GIF needs neither") from None


def write_gif(path: Path, frames: Iterable[np.ndarray], samples: Iterable[np.ndarray], frames_per_s: int) -> None:
    """Write frames, uint8, shape (height, width, 3), as a GIF that repeats. Raises: RecordingError.

    Args: samples: frames spread over the film, from which its 256 colours are chosen.
    """
    from PIL import Image  # Of an extra, and MP4 does not need it.

    palette = Image.fromarray(np.concatenate(list(samples))).quantize(256, Image.Quantize.MEDIANCUT)
    images = (Image.fromarray(frame).quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames)
    first = next(images)
    with atomically(path) as part:
        first.save(part, format="GIF", save_all=True, append_images=images, duration=round(1000 / frames_per_s), loop=0)


def write_mp4(path: Path, frames: Iterable[np.ndarray], frames_per_s: int, ffmpeg: str) -> None:
    """Write frames, uint8, shape (height, width, 3), both even, as H.264. Raises: RecordingError: ffmpeg fails."""
    rest = iter(frames)
    first = next(rest)
    height, width, _ = first.shape
    source = ("-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", str(frames_per_s), "-i", "-")
    coding = ("-c:v", "libx264", "-crf", "20", "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-f", "mp4")
    with atomically(path) as part, tempfile.TemporaryFile() as log:
        command = (ffmpeg, "-y", "-loglevel", "error", *source, *coding, str(part))
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=log) as process:
            assert process.stdin is not None
            try:
                for frame in itertools.chain([first], rest):
                    process.stdin.write(np.ascontiguousarray(frame).tobytes())
                process.stdin.close()
            except BrokenPipeError:
                pass  # ffmpeg has ended; its log contains the reason.
            except BaseException:
                process.kill()
                raise
        if process.returncode != 0:
            log.seek(0)
            lines = log.read().decode(errors="replace").strip().splitlines() or [f"status {process.returncode}"]
            raise RecordingError(f"{path}: cannot be written: ffmpeg: {lines[-1]}")
