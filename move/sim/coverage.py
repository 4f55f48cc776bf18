"""How much of the space of configurations a collection shows: what each timestep's scene looked like, and a share.

Figure 2 of the paper draws the idea; here it gets a number: the share of equal cells that at least one timestep
visited, for the object's place, the target's place and the camera's angle.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
import pandas as pd

from move.sim.collect import Collection, CollectionRecord, attempts
from move.sim.configuration import SpatialConfiguration
from move.sim.tasks import Task

SIDE = 10  # cells along each axis of a place
ANGLES = 20  # cells of the camera's range
PARTS = ("object", "target", "camera")
MEASURED = (2500, 5000)  # timesteps of a collection after which a result says what they cover


def configurations(collection: Collection, seed: int, env: gymnasium.Env | None = None) -> pd.DataFrame:
    """Where object, target (metres) and camera (radians) were at each timestep of a collection, one row each.

    Columns besides: episode, timestep, phase, method. Failed attempts are left out where the data set has none.
    `env` is as `collect` takes it.
    """
    rows: list[dict[str, Any]] = []
    kept = (episode for episode in attempts(collection, seed, env) if episode.succeeded or collection.keep_failures)
    for number, episode in enumerate(kept):
        rows += [{"episode": number, "timestep": timestep, "phase": phase, **where.columns()}
                 for timestep, (phase, where) in enumerate(episode.seen)]
        if len(rows) >= collection.timesteps or number + 1 == collection.demonstrations:
            break
    return pd.DataFrame(rows[: collection.timesteps]).assign(method=collection.method)


def covered(record: CollectionRecord, task: Task) -> dict[str, dict[str, float]]:
    """By number of timesteps, the shares of cells that the first so many of a collection visit: `shares` of each."""
    return {str(timesteps): shares(_table(record.seen[:timesteps]), task) for timesteps in MEASURED}


def shares(seen: pd.DataFrame, task: Task) -> dict[str, float]:
    """Shares of the cells visited of each of `PARTS` that the task has, and of the "joint" cells."""
    parts = [part for part in PARTS if task.has_target or part != "target"]
    return {**{part: visited_share(seen, task, part) for part in parts}, "joint": visited_joint_share(seen, task)}


def _table(seen: Sequence[tuple[str, SpatialConfiguration]]) -> pd.DataFrame:
    return pd.DataFrame([{"phase": phase, **where.columns()} for phase, where in seen])


def visited_share(seen: pd.DataFrame, task: Task, part: str) -> float:
    """Share of the cells of `part` ("object", "target" or "camera") that at least one row of `seen` lies in.

    Positions are divided into 10 x 10 cells of the range in the plane, the camera's range into 20. The object counts
    while it lies on the table (pick phase); afterwards the hand has it. NaN for the target of a task that has none.
    """
    if part == "target" and not task.has_target:
        return float("nan")
    if part == "camera":
        share = len(set(_angle_cells(seen, task, ANGLES))) / ANGLES
    else:
        rows = _on_the_table(seen) if part == "object" else seen
        share = len(set(_plane_cells(rows, task, part, SIDE))) / SIDE**2
    assert 0 <= share <= 1, f"{share} of the {part}'s cells visited"
    return share


def visited_joint_share(seen: pd.DataFrame, task: Task, side: int = 5, angles: int = 10) -> float:
    """Share of the joint cells of object position and camera angle, side x side x angles, that `seen` lies in.

    As in `visited_share` the object counts in the pick phase. Seeing an object from everywhere and having it
    everywhere is less than having each position from each angle.
    """
    rows = _on_the_table(seen)
    joint = zip(_plane_cells(rows, task, "object", side), _angle_cells(rows, task, angles), strict=True)
    return len(set(joint)) / (side**2 * angles)


def _on_the_table(seen: pd.DataFrame) -> pd.DataFrame:
    return seen[seen.phase == "pick"]


def _angle_cells(seen: pd.DataFrame, task: Task, angles: int) -> list[float]:
    low, high = task.camera_range
    return np.floor((seen.camera_angle - low) / (high - low) * angles).clip(0, angles - 1).tolist()


def _plane_cells(seen: pd.DataFrame, task: Task, part: str, side: int) -> list[tuple[float, float]]:
    box = task.object_range if part == "object" else task.target_range
    x, y = (np.floor((seen[f"{part}_{axis}"] - box.low[index]) / (box.high[index] - box.low[index]) * side)
            .clip(0, side - 1) for index, axis in enumerate("xy"))
    return list(zip(x, y, strict=True))
