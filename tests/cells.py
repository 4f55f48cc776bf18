"""A notebook's cells, one after the other in the tests' own process: another kernel would tell nothing new."""

import ast
from typing import Any

import nbformat

from move import paths


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
