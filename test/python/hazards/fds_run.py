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
    folder: Path, slices: Sequence[tuple[str, str, str, Field]], size_m: tuple[float, float] = (4.0, 3.0)
) -> str:
    """Write a run with horizontal slices at z = 1.5 m.

    Args: slices: quantity, label, unit, values.  size_m: of the mesh, from (0, 0), in steps of 0.5 m.
    """
    (width_m, depth_m), (cols, rows) = size_m, (round(2 * length_m) for length_m in size_m)
    x_nodes, y_nodes = np.linspace(0.0, width_m, cols + 1), np.linspace(0.0, depth_m, rows + 1)
    lines = ["CHID", " room", "", "FDSVERSION", "FDS6.8.0", "", "TOFFSET", " 0.0 0.0 0.0", ""]
    lines += ["HRRPUVCUT", "     1", "   200.0", "", "GRID  mesh", f" {cols} {rows} {len(Z) - 1} 0", ""]
    lines += ["PDIM", f" 0.0 {width_m} 0.0 {depth_m} 0.0 2.5 0.0 0.0 0.0"]
    lines += [*axis("X", x_nodes), *axis("Y", y_nodes), *axis("Z", Z)]
    lines += ["", "OBST", "    0", "", "VENT", "    0    0", "", "CVENT", "    0", ""]
    x, y = np.meshgrid(x_nodes, y_nodes, indexing="ij")
    for index, (quantity, label, unit, values) in enumerate(slices, start=1):
        file = f"room_1_{index}.sf"
        lines += [f"SLCF     1 # STRUCTURED &     0 {cols:5d}     0 {rows:5d}     3     3 ! {index}"]
        lines += [f" {file}", f" {quantity}", f" {label}", f" {unit}"]
        data = b"".join(record(text.ljust(30).encode()) for text in (quantity, label, unit))
        data += record(np.array([0, cols, 0, rows, 3, 3], dtype="<i4").tobytes())
        for time_s in TIMES_S:
            data += record(np.array([time_s], dtype="<f4").tobytes())
            data += record(values(x, y, time_s).astype("<f4").tobytes(order="F"))
        (folder / file).write_bytes(data)
    (folder / "room.smv").write_text("\n".join(lines) + "\n")
    return str(folder)
