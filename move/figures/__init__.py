"""The figures and tables of the study: one file each, and a notebook of the same name.

A figure's file holds

    runs(profile, ...) -> labelled runs            which trainings and evaluations it is made of, if any
    seen(data, *, ...) -> anything                 what else is looked at: films, collections; optional
    tables(data, *, ...) -> {suffix: DataFrame}    what is written as CSV and LaTeX
    draw(tables, data, *, ...) -> Figure           the picture, or {name: Figure} where there are several
    answer(tables, data, *, ...) -> str            the result in sentences, or {name: str}
    WORDS                                          title, caption, alternative text, and a caption for each table

The arguments by keyword are the figure's parameters: those of the notebook's parameters cell, of a profile's YAML and
of `-p`. One without a default has that of another function of the file. `page` runs these functions in turn (`make`),
`tables` and `plots` are what they share. Adding a figure is its file and its notebook; there is no list of them.
"""

from __future__ import annotations

import re
from difflib import get_close_matches
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType

from move.errors import BadInput


@cache
def names() -> tuple[str, ...]:
    """The figures and tables that there are: the paper's by their numbers, then the others by name."""
    found = [module.name for module in iter_modules(__path__) if not module.ispkg]
    return tuple(sorted(found, key=lambda name: (not re.match(r"(fig|table)\d", name), name)))


def short_names() -> dict[str, str]:
    """The short names that the paper gives its figures and tables, each with the whole one.

    >>> short_names()["fig1"]
    'fig1_sparse'
    """
    return {match[0]: name for name in names() if (match := re.match(r"(fig|table)\d+", name))}


def named(name: str) -> str:
    """The whole name of the figure called `name`, in full or in short.

    Raises:
        BadInput: there is none.

    >>> named("fig1")
    'fig1_sparse'
    """
    short, known = short_names(), names()
    if name in known:
        return name
    if name in short:
        return short[name]
    near = get_close_matches(name, [*known, *short], 1)
    meant = f" ({near[0]}?)" if near else ""
    raise BadInput(f"figure: {name[:60]!r} given{meant}; allowed are {', '.join([*short, *known])}")


def owner(picture: str) -> str:
    """The figure whose file draws `picture`; itself where the picture is called as its figure is."""
    return next((name for name in names() if picture in load(name).WORDS.others), picture)


def load(name: str) -> ModuleType:
    """The file of figure `name`.

    Raises:
        BadInput: there is none.
    """
    if name not in names():
        raise BadInput(f"figure: {name[:60]!r} given; allowed are {', '.join(names())}")
    return import_module(f"{__name__}.{name}")
