"""Films of demonstrations: static, ADC and MOVE beside each other, task by task."""

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
from move.paper import PAPER_METHODS, PAPER_TASKS


def seen(
    data: Data, *, tasks: tuple[TaskName, ...] = (), image_size: Pixels = 320, shown: TaskName = "pick-place",
    seed: RandomSeed = 0,
) -> dict[str, Path]:
    """Task -> its film, which is written.

    Args:
        tasks: such as ["hammer"]; empty: all ten.
        image_size: pixels along a side.
        shown: whose film is shipped; the others go to build/films.
    """
    from move.figures.plots import film

    films = {}
    for task in steps([] if gl_problem() else tasks or PAPER_TASKS, "tasks"):
        three = [film.titled(film.demonstration_frames(film.demonstration(task, method, image_size), seed),
                             NAMES[method], task, "success") for method in PAPER_METHODS]
        path = data.folder / "demonstrations.mp4" if task == shown else paths.BUILD / "films" / f"{task}.mp4"
        films[task] = film.write_film(film.side_by_side(three), path)
    return films


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """There are films alone."""
    return {}


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """How many films there are, and where."""
    size = sum(path.stat().st_size for path in data.seen.values()) / 1e6
    return gl_problem() or (
        f"{len(data.seen)} films, {size:.1f} MB in all: the one shown in "
        f"`{(data.folder / 'demonstrations.mp4').relative_to(paths.ROOT)}`, the others in `build/films`. A film is "
        "about three times slower than real.")


WORDS = Words()
