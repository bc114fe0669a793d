"""Sphinx configuration of the website; docs/build_site.py prepares its sources."""

import re

import robotteamsim

project = "robotteamsim"
release = robotteamsim.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc"]
html_theme = "furo"
html_title = "robotteamsim"
html_copy_source = False
html_extra_path = ["extra"]
myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 4
# Links lead to files of the repository that are not pages, such as scenarios.
suppress_warnings = ["myst.xref_missing", "myst.header", "misc.highlighting_failure"]
exclude_patterns = ["extra"]
autodoc_member_order = "bysource"


def as_lines(app, what, name, obj, options, lines):
    """Keep lines and indentation of docstrings, which are plain text, and escape what Sphinx would interpret.

    Indented lines after a line that ends with `::` are code.
    """
    kept, is_code = [], False
    for line in lines:
        if is_code and (line.startswith("    ") or not line):
            kept.append(line)
            continue
        if is_code:
            kept.append("")
        is_code = line.endswith("::")
        kept.append(_plain(line.removesuffix(":") if is_code else line))
        if is_code:
            kept += ["", ".. code-block:: python"]
    lines[:] = kept


def _plain(line):
    parts = re.split(r"(`[^`]*`)", line)
    escaped = (part if part.startswith("`") else re.sub(r"([*|_\\`])", r"\\\1", part) for part in parts)
    return f"| {''.join(escaped)}".rstrip()


def setup(app):
    """Register `as_lines`."""
    app.connect("autodoc-process-docstring", as_lines)
