"""Execute a notebook in an empty folder, and write it with its outputs.

Usage: python docs/execute_notebook.py SOURCE TARGET
"""

import os
import sys
import tempfile
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from traitlets.config import Config

_TIMEOUT_S = 600


def main() -> None:
    """Execute; the program `robotteamsim` is the one of this Python."""
    source, target = map(Path, sys.argv[1:])
    notebook = nbformat.read(source, as_version=4)
    # The kernel must not read a user's settings, and finds programs next to this Python.
    os.environ["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as sockets:
        # The default, free ports of TCP, fails if another program takes one of them before the kernel does.
        kernel = {"transport": "ipc", "ip": f"{sockets}/kernel"}
        client = NotebookClient(
            notebook,
            timeout=_TIMEOUT_S,
            coalesce_streams=True,  # A busy kernel sends what a cell prints in several pieces.
            resources={"metadata": {"path": folder}},
            config=Config(KernelManager=kernel),
        )
        client.execute()
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)  # Times differ each time.
    nbformat.write(notebook, target)


if __name__ == "__main__":
    main()
