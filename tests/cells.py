"""A notebook's cells, one after the other in the tests' own process: another kernel would tell nothing new."""

import ast
from pathlib import Path
from typing import Any

import nbformat
from matplotlib.figure import Figure

from move import paths
from move.figures.page.captions import Caption


def execute(name: str, **changes: Any) -> dict[str, Any]:
    """Execute the code cells of notebook `name` with other parameters; returns the names that its cells defined.

    As in a notebook "_" is what its last line shows.
    """
    first, *others = (cell.source for cell in nbformat.read(paths.NOTEBOOKS / f"{name}.ipynb", 4).cells
                      if cell.cell_type == "code")
    space: dict[str, Any] = {}
    exec(first, space)
    assert set(changes) <= set(space)
    space.update(changes)
    for source in others:
        *statements, last = ast.parse(source).body
        if not isinstance(last, ast.Expr):
            exec(source, space)
            continue
        exec(compile(ast.Module(statements, []), name, "exec"), space)
        space["_"] = eval(compile(ast.Expression(last.value), name, "eval"), space)
    return space


def picture_left_empty(figure: Figure, name: str, folder: Path, caption: Caption | None = None) -> None:
    """In place of `style.save`, which takes most of a notebook's time: the caption is written, the picture is empty."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.png").touch()  # which a notebook shows
    if caption:
        (folder / f"{name}.caption.md").write_text(caption.markdown(), encoding="utf-8")
