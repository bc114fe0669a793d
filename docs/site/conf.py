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
    """Keep lines and indentation of docstrings, which are plain text, and escape what Sphinx would interpret."""
    for index, line in enumerate(lines):
        parts = re.split(r"(`[^`]*`)", line)
        plain = (re.sub(r"([*|_\\`])", r"\\\1", part) if not part.startswith("`") else f"`{part}`" for part in parts)
        lines[index] = f"| {''.join(plain)}".rstrip() if line else "|"


def setup(app):
    """Register `as_lines`."""
    app.connect("autodoc-process-docstring", as_lines)
