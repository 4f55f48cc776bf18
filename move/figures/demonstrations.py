"""Films of demonstrations: static, ADC and MOVE side by side, task by task; as WebP, too, for pages such as README."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from move import paths
from move.figures.page.captions import Words
from move.figures.page.data import Data
from move.figures.page.make import steps
from move.figures.page.parameters import Pixels, RandomSeed, TaskName
from move.figures.plots.style import NAMES
from move.machine import gl_problem
from move.paper import PAPER_METHODS

SIMULATES = True


def seen(
    data: Data, *, tasks: tuple[TaskName, ...] = ("pick-place",), image_size: Pixels = 320, seed: RandomSeed = 0,
) -> dict[str, Path]:
    """Task -> its film, which is written.

    Args:
        tasks: whose demonstrations are filmed; a film takes some seconds.
        image_size: pixels along a side.
    """
    from move.figures.plots import film

    films = {}
    for task in steps([] if gl_problem() else tasks, "tasks"):
        three = film.side_by_side([film.titled(film.demonstration_take(film.demonstration(
            task, method, image_size), seed), NAMES[method], task, "success") for method in PAPER_METHODS])
        ending = "" if task == "pick-place" else f"_{task}"
        films[task] = film.write_film(three, data.folder / f"demonstrations{ending}.mp4")
        film.write_webp(three, data.folder / f"demonstrations{ending}.webp")
    return films


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """There are films alone."""
    return {}


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """How many films there are, and where."""
    films = ", ".join(f"`{path.relative_to(paths.ROOT)}`" for path in data.seen.values())
    return gl_problem() or f"{films or 'No film'}. A film is about three times slower than real."


WORDS = Words()
