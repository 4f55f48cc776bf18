"""How Sphinx makes the site from what tools/make_site.py writes: no network, no script from elsewhere, mathematics as
MathML at build time."""

from __future__ import annotations

import re
from html import escape
from pathlib import Path
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


REPAIRS = (
    (re.compile(r'role="heading"(?! aria-level)'), 'role="heading" aria-level="2"'),  # the captions of the contents
    (re.compile(r"<pre(?![^>]*tabindex)"), '<pre tabindex="0"'),  # a box that scrolls is reached by keys
    (re.compile(r'<div class="(cell_output|table-wrapper|wide|formula)(?=[ "])'), r'<div tabindex="0" class="\1'),
    (re.compile(r"<th\b[^>]*>(?:\s|&nbsp;|<p></p>)*</th>"), "<td></td>"),  # a heading of nothing
    (re.compile(r'<aside class="sidebar-drawer"'), '<aside aria-label="the site" class="sidebar-drawer"'),
    (re.compile(r'<aside class="toc-drawer'), '<aside aria-label="this page" class="toc-drawer'),
    (re.compile(r'<div id="search-results">'), '<h1>Search</h1>\n<div id="search-results">'),
)
"""What the theme and notebooks write for eyes and mice alone."""


def describe(app: Any, page: str, template: str, context: dict[str, Any], doctree: nodes.document | None) -> None:
    """Give a page its description: how it begins."""
    first = next(iter(doctree.findall(nodes.paragraph)), None) if doctree else None
    text = " ".join(first.astext().split())[:200] if first else f"{context.get('title', page)}: {project}"
    context["metatags"] = context.get("metatags", "") + f'<meta name="description" content="{escape(text)}">'


def mend(app: Any, problem: Exception | None) -> None:
    """Mend the markup of all pages for readers with a keyboard or a screen reader."""
    for path in Path(app.outdir).rglob("*.html"):
        text = path.read_text(encoding="utf-8")
        for wrong, right in REPAIRS:
            text = wrong.sub(right, text)
        path.write_text(text, encoding="utf-8")


def setup(app: Any) -> None:
    """Register what this file adds to Sphinx."""
    app.add_html_math_renderer("mathml", (write_math, None), (write_math, None))
    app.connect("html-page-context", describe)
    app.connect("build-finished", mend)
    app.connect("autodoc-process-docstring", keep_columns, priority=900)
nb_ipywidgets_js = {}  # a page has no kernel that sliders could ask, and nothing is loaded from elsewhere
