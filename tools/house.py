"""Measure the house: sizes, types, documentation, tests for each line of code, and which room imports which.

    python tools/house.py

A public name is a function or class at the top of a file that other files may use. The lines of a test file are shared
among the rooms that it imports, by how many modules of each. A back edge is an import of a room that lies later in the
order in which data flow. What commands and tests cost, in seconds of a core, is measured by `make bench`.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Container, Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from statistics import median

import pandas as pd

ROOT = Path(__file__).resolve().parent.parent
ORDER = ("sim", "learn", "statistics", "realworld", "study", "figures", "claims", "exchange", "teaching", "cli")
LONG = 100  # characters

Function = ast.FunctionDef | ast.AsyncFunctionDef


def room(name: str) -> str:
    """The room of a module such as move.sim.tasks, "move" for what all rooms may use."""
    parts = name.split(".")
    return parts[1] if len(parts) > 1 and parts[1] in ORDER else "move"


def functions(tree: ast.AST) -> Iterator[Function]:
    """Every function of a file."""
    return (node for node in ast.walk(tree) if isinstance(node, Function))


def imports(tree: ast.Module, modules: Container[str], everywhere: bool = True) -> set[str]:
    """Those of `modules` that a file imports, at its top level or everywhere."""
    found: set[str] = set()
    for node in ast.walk(tree) if everywhere else tree.body:
        if isinstance(node, ast.ImportFrom) and node.module:
            names = [f"{node.module}.{alias.name}" for alias in node.names]
            found |= {name if name in modules else node.module for name in names}
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
    return {name for name in found if name in modules}


def module_name(path: Path) -> str:
    """The dotted name of a file."""
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def measure_room(name: str, paths: list[Path], test_lines: float) -> dict[str, float | str]:
    """One row: sizes, types and documentation of the files of a room."""
    texts = [path.read_text() for path in paths]
    lines = [len(text.splitlines()) for text in texts]
    trees = [ast.parse(text) for text in texts]
    found = [function for tree in trees for function in functions(tree)]
    sizes = [function.end_lineno - function.lineno + 1 for function in found]
    arguments = [argument for function in found for argument in (*function.args.args, *function.args.kwonlyargs)
                 if argument.arg not in ("self", "cls")]
    public = [function for function in found if not function.name.startswith("_")]
    names = sum(isinstance(node, Function | ast.ClassDef) and not node.name.startswith("_")
                for tree in trees for node in tree.body)
    return {
        "room": name, "files": len(paths), "lines": sum(lines), "lines_a_name": round(sum(lines) / names),
        "file_median": median(lines), "file_max": max(lines),
        "function_median": median(sizes), "function_max": max(sizes),
        "arguments_typed": round(100 * sum(argument.annotation is not None for argument in arguments) / len(arguments)),
        "documented": round(100 * sum(ast.get_docstring(function) is not None for function in public) / len(public)),
        "long_lines": round(100 * sum(len(line) > LONG for text in texts for line in text.splitlines()) / sum(lines)),
        "tests_a_line": round(test_lines / sum(lines), 2),
    }


def back_edges(trees: dict[str, ast.Module]) -> list[str]:
    """Imports of a later room, as "from -> to"."""
    found = {(name, other) for name, tree in trees.items() for other in imports(tree, trees)
             if room(name) in ORDER and room(other) in ORDER and ORDER.index(room(other)) > ORDER.index(room(name))}
    return sorted(f"{name} -> {other}" for name, other in found)


def cycle(trees: dict[str, ast.Module]) -> list[str]:
    """Files that import each other at their top level, the first such circle; empty where there is none."""
    edges = {name: imports(tree, trees, everywhere=False) - {name} for name, tree in trees.items()}
    try:
        TopologicalSorter(edges).prepare()
    except CycleError as error:
        return error.args[1]
    return []


def main() -> None:
    """Print one row a room, then cycles and back edges."""
    paths: dict[str, list[Path]] = {}
    for path in sorted((ROOT / "move").rglob("*.py")):
        paths.setdefault(room(module_name(path)), []).append(path)
    trees = {module_name(path): ast.parse(path.read_text()) for files in paths.values() for path in files}
    tests: Counter[str] = Counter()
    for path in (ROOT / "tests").glob("*.py"):
        used = Counter(room(name) for name in imports(ast.parse(path.read_text()), trees))
        for name, count in used.items():
            tests[name] += len(path.read_text().splitlines()) * count / used.total()
    rows = [measure_room(name, paths[name], tests[name]) for name in ("move", *ORDER)]
    rows.append(measure_room("all", [path for files in paths.values() for path in files], tests.total()))
    print(pd.DataFrame(rows).to_string(index=False))
    print(f"cycle: {cycle(trees) or 'none'}\nback edges: {back_edges(trees) or 'none'}")


if __name__ == "__main__":
    main()
