"""What can be chosen by name, known without importing what is slow to import: fixed choices, figures by their files.

A figure or table is called like its notebook, fig1_sparse, or by the short name that the paper gives it, fig1.
"""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterable
from difflib import get_close_matches
from typing import Any, Literal

from move import paths
from move.errors import BadInput

Factors = Literal["object", "object+hand", "object+target", "all"]
Protocol = Literal["random", "sparse", "dense", "circle"]
ExpertName = Literal["phase", "metaworld"]
Place = Literal["package", "authors"]
Drawing = Literal["plain", "full"]
SpeedLaw = Literal["beta", "uniform", "constant"]
Control = Literal["nothing", "random", "expert", "goal-blind"]
ExportFormat = Literal["lerobot", "zarr"]

NUMBERED = re.compile(r"((?:fig|table)\d+)_")
ALSO = {"fig8": "table3_real_robot"}  # whose notebook draws it


def notebooks() -> list[str]:
    """The notebooks that exist, by name; each makes the figure or table of the same name."""
    return sorted(path.stem for path in paths.NOTEBOOKS.glob("*.ipynb"))


def short_names() -> dict[str, str]:
    """The short names, each with the notebook's own."""
    return {match[1]: name for name in notebooks() if (match := NUMBERED.match(name))} | ALSO


def notebook(name: str) -> str:
    """The notebook called `name`, in full or in short.

    Raises:
        BadInput: there is none.

    >>> notebook("fig1")
    'fig1_sparse'
    """
    short, known = short_names(), notebooks()
    if name in known:
        return name
    if name in short:
        return short[name]
    near = get_close_matches(name, [*known, *short], 1)
    meant = f" ({near[0]}?)" if near else ""
    raise BadInput(f"figure: {name[:60]!r} given{meant}; allowed are {', '.join([*short, *known])}")


def refuse_unknown_parameters(notebook: str, names: Iterable[str]) -> None:
    """Refuse names to which the notebook's parameters cell gives no value; the profile has an option of its own.

    Raises:
        BadInput: there is one.
    """
    known = [name for name in parameters(notebook) if name != "profile"]
    if unknown := sorted(set(names) - set(known)):
        raise BadInput(f"{notebook} has no parameter {', '.join(unknown)}; allowed are {', '.join(known)}")


def parameters(notebook: str) -> list[str]:
    """The names to which a notebook's parameters cell gives a value.

    >>> parameters("table6_collection")
    ['profile', 'attempts']
    """
    return list(_defaults(notebook))


def texts(notebooks: Iterable[str]) -> set[str]:
    """The parameters of notebooks that are texts, as their parameters cells have them.

    >>> sorted(texts(["rollouts"]))
    ['observation', 'profile', 'task']
    """
    return {name for notebook in notebooks for name, value in _defaults(notebook).items() if isinstance(value, str)}


def _defaults(notebook: str) -> dict[str, Any]:
    """What a notebook's parameters cell gives each name; None for what is no constant."""
    cells = json.loads((paths.NOTEBOOKS / f"{notebook}.ipynb").read_text(encoding="utf-8"))["cells"]
    source = next("".join(cell["source"]) for cell in cells if "parameters" in cell["metadata"].get("tags", []))
    return {target.id: statement.value.value if isinstance(statement.value, ast.Constant) else None
            for statement in ast.parse(source).body if isinstance(statement, ast.Assign)
            for target in statement.targets if isinstance(target, ast.Name)}
