"""Where demonstrations grasp: the places on the table in a data set of any layout, or in one collected here."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from move.errors import BadInput
from move.realworld.checks import check_dataset
from move.realworld.dataset import RobotDataSet, open_dataset
from move.realworld.episode import RobotEpisode
from move.realworld.workspace import grasp_step, positions, stacked
from move.untrusted import read_json

DECIDING = ("nothing had to be assumed", "no two episodes are equal")  # checks that a place rests on
SIMULATION = ".zattrs"  # of a folder that `move collect` wrote; it holds the record of the collection


class Grasps(NamedTuple):
    """Places in metres, (N, 2): x and y of the object in the simulation, of the hand for a robot, in its own frame."""

    places: np.ndarray
    origin: str  # one line on where they come from
    without: tuple[str, ...]  # a line on each kind of demonstration that has no place
    doubts: tuple[str, ...] = ()  # a line on each thing that was assumed or does not fit


def grasps(data: str, *, units_file: Path | None = None) -> Grasps:
    """Read the places of all grasps of a data set.

    Args:
        data: a folder, or owner/name of a data set of the Hub.
        units_file: as for `open_dataset`.

    Raises:
        BadInput: no such data set, or one whose rows hold no grasp or nothing of where the hand was.
    """
    if (Path(data) / SIMULATION).is_file():
        attributes = read_json(Path(data) / SIMULATION, "a JSON object that describes a data set")
        if "record" in attributes:
            from move.learn.dataset import load  # refuses one that was changed

            _, attributes = load(Path(data))
            record = attributes["record"]
            points, kept = np.array(record["grasp_points"], float).reshape(-1, 2), record["demonstrations"]
            cut = round(record["mean_steps"] * kept) > record["timesteps"]  # the last one, by the budget
            points = points[: kept - cut]
            if not len(points):
                raise BadInput(f"{data}: no place of a grasp: its only demonstration was cut by the budget")
            return Grasps(points, f"simulation, {kept} demonstrations",
                          (f"1 of {kept} demonstrations: cut by the budget, perhaps before its grasp",) * cut)
    demos = open_dataset(data, revision=None, episodes=None, units_file=units_file)
    table, why = grasp_table(demos.episodes), why_no_grasps(demos.episodes)
    if table.empty:
        raise BadInput(f"{data}: no place of a grasp: {why}")
    return Grasps(table[["x_m", "y_m"]].to_numpy(), demos.origin, (*filter(None, [why]), *demos.unread), _doubts(demos))


def _doubts(demos: RobotDataSet) -> tuple[str, ...]:
    """What was assumed of the hand, its units and its frame, and demonstrations that stand there twice."""
    checks = {check.name: check for check in check_dataset(demos)}
    doubts = [f"{name}: {checks[name].detail}" for name in DECIDING if checks[name].outcome == "differs"]
    doubts += [f"{row.part}: {row.quantity} in {row.unit}: {row.note}" for row in demos.units.itertuples()
             if row.note and row.quantity in ("gripper", "position", "joints") and row.unit != "unknown"]
    frames = sorted({f"{episode.part} ({episode.robot or 'arm not named'})" for episode in demos.episodes})
    return (*doubts, *[f"taken as places in one frame: {', '.join(frames)}"] * (len(frames) > 1))


def grasp_table(episodes: Sequence[RobotEpisode]) -> pd.DataFrame:
    """Where the hand was at each grasp that has a place: method, part, index, x_m, y_m, in the arm's own frame."""
    return stacked([(episode, {"x_m": place[:1], "y_m": place[1:]}) for episode in episodes
                    if not isinstance(place := _place(episode), str)], ["x_m", "y_m"])


def why_no_grasps(episodes: Sequence[RobotEpisode]) -> str:
    """Why some demonstrations have no place of a grasp, in words; "" where all have one."""
    counts = Counter(place for place in map(_place, episodes) if isinstance(place, str))
    return "; ".join(f"{count} of {len(episodes)} demonstrations: {why}" for why, count in counts.items())


def _place(episode: RobotEpisode) -> np.ndarray | str:
    """Where the hand was when the gripper closed, (2,) m, or in words why nobody knows.

    By PIPER's kinematics, or for another arm as it was recorded.
    """
    hand = positions(episode)
    if hand is None and episode.end_effector is not None:
        hand = episode.end_effector[:, :3]
    if hand is None:
        return "no pose of the hand in known units, and no joints of a PIPER"
    if episode.gripper is None:
        return "no gripper"
    step = grasp_step(episode.gripper)
    return hand[step, :2] if step is not None and np.isfinite(hand[step, :2]).all() else "no grasp"
