"""Runs in the file format of FDS, for tests: one mesh with cells of 0.5 m, and horizontal slices."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

TIMES_S = (0.0, 10.0, 20.0)
Z = np.linspace(0.0, 2.5, 6)
Field = Callable[[np.ndarray, np.ndarray, float], np.ndarray]


def record(data: bytes) -> bytes:
    """Return a record of Fortran's unformatted files."""
    size = np.array([len(data)], dtype="<i4").tobytes()
    return size + data + size


def axis(name: str, nodes: np.ndarray) -> list[str]:
    return ["", f"TRN{name}", "    0", *(f"{i:5d} {node:14.5f}" for i, node in enumerate(nodes))]


def write_run(
    folder: Path,
    slices: Sequence[tuple[str, str, str, Field]],
    size_m: tuple[float, float] = (4.0, 3.0),
    *,
    heights: Sequence[int] | None = None,
    cell_centred: bool = False,
    frames: Sequence[int] = (len(TIMES_S),),
) -> str:
    """Write a run with horizontal slices at z = 1.5 m.

    Args: slices: quantity, label, unit, values.  size_m: of a mesh, from (0, 0), in steps of 0.5 m.
        heights: index in Z of each slice.  frames: how many TIMES_S each mesh has; the next mesh lies east of a mesh.
    """
    lines = ["CHID", " room", "", "FDSVERSION", "FDS6.8.0", "", "TOFFSET", " 0.0 0.0 0.0", "", "INPF", " input.fds", ""]
    lines += ["HRRPUVCUT", "     1", "   200.0"]
    cols, rows = (round(2 * length_m) for length_m in size_m)
    y = np.linspace(0.0, size_m[1], rows + 1)
    all_x = [size_m[0] * mesh + np.linspace(0.0, size_m[0], cols + 1) for mesh in range(len(frames))]
    for mesh, x in enumerate(all_x, start=1):
        lines += ["", f"GRID  mesh_{mesh}", f" {cols} {rows} {len(Z) - 1} 0", ""]
        lines += ["PDIM", f" {x[0]} {x[-1]} 0.0 {size_m[1]} 0.0 2.5 0.0 0.0 0.0"]
        lines += [*axis("X", x), *axis("Y", y), *axis("Z", Z)]
        lines += ["", "OBST", "    0", "", "VENT", "    0    0", "", "CVENT", "    0", ""]
    for mesh, (x, count) in enumerate(zip(all_x, frames, strict=True), start=1):
        # In results by cell, FDS writes a first row and column that nobody reads.
        points = [np.append(-9.0, nodes[1:] - 0.25) if cell_centred else nodes for nodes in (x, y)]
        places = np.meshgrid(*points, indexing="ij")
        for index, (quantity, label, unit, values) in enumerate(slices, start=1):
            z, file = 3 if heights is None else heights[index - 1], f"room_{mesh}_{index}.sf"
            kind = "SLCC" if cell_centred else "SLCF"
            lines += [f"{kind} {mesh:5d} # STRUCTURED &     0 {cols:5d}     0 {rows:5d} {z:5d} {z:5d} ! {index}"]
            lines += [f" {file}", f" {quantity}", f" {label}", f" {unit}"]
            data = b"".join(record(text.ljust(30)[:30].encode()) for text in (quantity, label, unit))
            data += record(np.array([0, cols, 0, rows, z, z], dtype="<i4").tobytes())
            for time_s in TIMES_S[:count]:
                data += record(np.array([time_s], dtype="<f4").tobytes())
                data += record(values(*places, time_s).astype("<f4").tobytes(order="F"))
            (folder / file).write_bytes(data)
    (folder / "room.smv").write_text("\n".join(lines) + "\n")
    return str(folder)
