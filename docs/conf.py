"""How Sphinx makes the site from what tools/make_site.py writes: no network, no script from elsewhere, mathematics as
MathML at build time."""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from docutils.utils.math import latex2mathml

project = "MOVE, reproduced"
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
html_theme = "furo"
html_title = project
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = html_show_sphinx = False
html_math_renderer = "mathml"
html_theme_options = {"navigation_with_keys": True}
copyright = "the authors of this reproduction; the paper and its figures belong to its authors"  # noqa: A001

nb_execution_mode = "off"  # what is shown was executed before
nb_merge_streams = True
nb_output_stderr = "remove"
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 3
suppress_warnings = ["mystnb.unknown_mime_type", "misc.highlighting_failure", "myst.header"]

autodoc_default_options = {"members": True, "member-order": "bysource", "exclude-members": "model_config"}
autodoc_typehints = "signature"
python_use_unqualified_type_names = True

COLUMNS = re.compile(r"\S {2,}\S")


def keep_columns(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Show tables that docstrings draw with spaces as they are drawn."""
    blocks = re.split(r"\n{2,}", "\n".join(lines).strip("\n"))
    drawn = [f"::\n\n{_indented(block)}" if _is_drawn(block) else block for block in blocks]
    lines[:] = "\n\n".join(drawn).split("\n")


def _is_drawn(block: str) -> bool:
    rows = block.split("\n")
    wide = sum(bool(COLUMNS.search(row)) for row in rows)
    return not block.lstrip().startswith((">>>", ":", "..")) and (2 * wide > len(rows) or block.startswith("|"))


def _indented(block: str) -> str:
    return "\n".join("    " + row for row in block.split("\n"))


def write_math(writer: Any, node: nodes.Element) -> None:
    """One formula as MathML."""
    block = isinstance(node, nodes.math_block)
    formula = latex2mathml.tex2mathml(node.astext(), as_block=block)
    writer.body.append(f'<div class="formula">{formula}</div>' if block else formula)
    raise nodes.SkipNode


def setup(app: Any) -> None:
    """Register what this file adds to Sphinx."""
    app.add_html_math_renderer("mathml", (write_math, None), (write_math, None))
    app.connect("autodoc-process-docstring", keep_columns, priority=900)
nb_ipywidgets_js = {}  # a page has no kernel that sliders could ask, and nothing is loaded from elsewhere
