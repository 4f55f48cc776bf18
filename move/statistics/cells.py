"""From a table of episodes to cells: the successes of one method in one condition, seeds by configurations."""

from __future__ import annotations

import numpy as np
import pandas as pd

from move.sim.collection import METHODS
from move.sim.configuration import Disc
from move.statistics.training_noise import UNKNOWN, TrainingNoise, training_noise_of


def successes(episodes: pd.DataFrame) -> np.ndarray:
    """The successes of one method as an array (seeds, configurations), in the order of the trials."""
    return episodes.pivot(index="seed", columns="trial", values="success").to_numpy(dtype=float)


def by_budget(episodes: pd.DataFrame) -> dict[str, dict[int, np.ndarray]]:
    """The `successes` of static and of MOVE on one task at each budget, in timesteps."""
    rows_of = {method: episodes[episodes.method == method] for method in ("static", "move")}
    return {method: {budget: successes(cell) for budget, cell in rows.groupby("timesteps")}
            for method, rows in rows_of.items()}


def training_noise(episodes: pd.DataFrame, by: list[str], known: TrainingNoise = UNKNOWN) -> TrainingNoise:
    """How much trainings vary: `known` where something is, else from the cells of `episodes` that have several seeds.

    What is known comes from many cells; a figure's own few can agree by chance, and two figures that show the same
    rate would give it two intervals.
    """
    if known.degrees:
        return known
    return training_noise_of(successes(group) for _, group in episodes[episodes.method.isin(METHODS)].groupby(by))


def inside_and_outside(episodes: pd.DataFrame, disc: Disc) -> pd.DataFrame:
    """The grid's episodes with a column `where`: "inside" or "outside" of `disc`, by the object's place."""
    grid = episodes[episodes.group == "grid"]
    inside = [disc.contains((x, y, 0.0)) for x, y in zip(grid.object_x, grid.object_y, strict=True)]
    return grid.assign(where=np.where(inside, "inside", "outside")).sort_values("where", kind="stable")
