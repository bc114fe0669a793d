"""Files have at most 500 lines and functions at most 50, as CONTRIBUTING.md says; no linter counts them."""

from __future__ import annotations

import ast
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TOPS = ("src", "include", "test", "bench", "study", "examples", "gazebo", "setup", "templates", "docs")
FILES = sorted(
    path
    for top in TOPS
    for path in (ROOT / top).rglob("*")
    if path.suffix in (".py", ".cpp", ".hpp", ".js") and not path.name.endswith(".min.js")
)
MOST_LINES_OF_FILE, MOST_LINES_OF_FUNCTION = 500, 50


def long_functions(text: str) -> list[str]:
    functions = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]
    return [each.name for each in functions if each.end_lineno - each.lineno >= MOST_LINES_OF_FUNCTION]


def test_files_are_short():
    assert len(FILES) > 500
    assert [path for path in FILES if len(path.read_text("utf-8").splitlines()) > MOST_LINES_OF_FILE] == []


def test_functions_of_python_are_short():
    found = {path: long_functions(path.read_text("utf-8")) for path in FILES if path.suffix == ".py"}
    assert {path: names for path, names in found.items() if names} == {}


def test_a_function_of_51_lines_is_too_long():
    body = "    pass\n"
    assert long_functions("def long():\n" + 50 * body + "def short():\n" + 49 * body) == ["long"]
