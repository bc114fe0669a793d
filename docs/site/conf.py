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
autoclass_content = "both"  # with the arguments of __init__


def as_fields(app, what, name, obj, options, lines):
    """Lay out a docstring: arguments, results and errors as fields, indented lines as they are, code after `::`.

    What Sphinx would interpret is escaped, since docstrings are plain text.
    """
    text, fields = _fields("\n".join(lines))
    kept, is_code = [], False
    for paragraph in text.split("\n\n"):
        if is_code and paragraph.startswith("    "):
            kept += [*paragraph.split("\n"), ""]
            continue
        is_code = paragraph.endswith("::")
        plain = [_plain(line) for line in (paragraph.removesuffix(":") if is_code else paragraph).split("\n")]
        has_layout = any(line.startswith((" ", "-")) for line in plain)
        kept += [f"| {line}".rstrip() for line in plain] if has_layout else plain
        kept += ["", ".. code-block:: python", ""] if is_code else [""]
    lines[:] = [*kept, *fields]


_SECTION = re.compile(
    r"(?:^[ ]*|(?<=[.)\]`] ))(Args|Returns|Raises):[ ]*\n?((?:.+\n?)*?)(?=[ ]*(?:Args|Returns|Raises):|\n|\Z)",
    re.MULTILINE,
)
_ITEM = {
    "Args": re.compile(r"(?:^|\n|[ ]{2})[ ]*([a-z_]\w*(?:, [a-z_]\w*)*):[ ]"),
    "Raises": re.compile(r"(?:^|\n|[ ]{2}|(?<=\.) )[ ]*([A-Z]\w+(?:, [A-Z]\w+)*)(?::[ ]|\.?(?=\n|\Z))"),
}
_FIELD = {"Args": "param", "Raises": "raises"}
_SECTIONS = {"Args": "Arguments", "Returns": "Returns", "Raises": "Raises"}


def _fields(text):
    """Return a docstring without its sections, and these as fields of Sphinx's domain of Python."""
    fields = []
    for kind, body in _SECTION.findall(text):
        parts = _ITEM[kind].split(body)[1:] if kind in _ITEM else []
        if not parts:  # such as "as `load`"
            fields.append(f":{_SECTIONS[kind]}: {_joined(body)}")
        for names, meaning in zip(parts[::2], parts[1::2], strict=True):
            fields += (f":{_FIELD[kind]} {name}: {_joined(meaning)}" for name in names.split(", "))
    return _SECTION.sub("", text).rstrip(), fields


def _joined(text):
    return _plain(" ".join(text.split()))


def _plain(line):
    parts = re.split(r"(`[^`]*`)", line)
    return "".join(part if part.startswith("`") else re.sub(r"([*|_\\`])", r"\\\1", part) for part in parts)


def setup(app):
    """Register `as_fields`."""
    app.connect("autodoc-process-docstring", as_fields)
