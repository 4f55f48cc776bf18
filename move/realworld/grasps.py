"""Where demonstrations grasp: the places on the table in a data set of any layout, or in one collected here."""

from __future__ import annotations

import json
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
from move.realworld.units import BY_SIZE
from move.realworld.workspace import grasp_step, positions, stacked
from move.untrusted import read_json
from move.validation import reason_of

DECIDING = {"nothing had to be assumed": "assumed", "no two episodes are equal": "the same twice"}
"""Checks that a place rests on, and what is said where they fail."""


class Grasps(NamedTuple):
    """Places in metres, (N, 2): x and y of the object in the simulation, of the hand for a robot, in its own frame."""

    places: np.ndarray
    origin: str  # one line on where they come from
    without: tuple[str, ...]  # a line on each kind of demonstration that has no place
    doubts: tuple[str, ...] = ()  # a line on each thing that was assumed or does not fit
    passed: np.ndarray | None = None  # (M, 2): every place of the object before a grasp, where that is known
    simulated: bool = False  # in the layout of robot data

    @property
    def seen(self) -> np.ndarray:
        """The places that training sees: those that the object passed, or if nobody knows them those of the grasps."""
        return self.places if self.passed is None else np.vstack([self.places, self.passed])


def grasps(data: str, *, units_file: Path | None = None) -> Grasps:
    """Read the places of all grasps of a data set.

    Args:
        data: a folder, or owner/name of a data set of the Hub.
        units_file: as for `open_dataset`.

    Raises:
        BadInput: no such data set, or one whose rows hold no grasp or nothing of where the hand was.
    """
    about = Path(data) / ".zattrs"
    if about.is_file() and "record" in read_json(about, "a JSON object that describes a data set"):
        if units_file is not None:
            raise BadInput(f"units_file: {str(units_file)!r} given; {data} was collected here, in known units")
        try:
            return _collected(data)
        except (KeyError, TypeError, ValueError) as error:
            raise BadInput(f"{data}: how it was collected is not told as `move collect` does: {reason_of(error)}"
                           ) from error
    demos = open_dataset(data, revision=None, episodes=None, units_file=units_file)
    table, why = grasp_table(demos.episodes), why_no_grasps(demos.episodes)
    if table.empty:
        raise BadInput(f"{data}: no place of a grasp: {why}; allowed are rows with a gripper and an end effector's "
                       "pose in known units (a units file names them) or a PIPER's joints")
    return Grasps(table[["x_m", "y_m"]].to_numpy(), demos.origin, (*filter(None, [why]), *demos.unread), _doubts(demos),
                  simulated=demos.simulated)


def _collected(data: str) -> Grasps:
    """Of a data set collected here, which is collected again without images to know where the object was."""
    from move.learn.dataset import load  # refuses one that was changed
    from move.sim.collection import Collection
    from move.sim.coverage import configurations

    demonstrations, attributes = load(Path(data))
    record, whole = attributes["record"], "whole_episodes" in attributes
    cut = round(record["mean_steps"] * record["demonstrations"]) > record["timesteps"]  # the last one, by the budget
    points = np.array(record["grasp_points"], float).reshape(-1, 2)[: record["demonstrations"] - cut]
    if not len(points):
        raise BadInput(f"{data}: no place of a grasp: its only demonstration was cut by the budget")
    collection = Collection.model_validate_json(json.dumps(attributes["collection"]))
    rows = configurations(collection.model_copy(update={"timesteps": demonstrations.timesteps}), attributes["seed"])
    passed = rows[rows.phase == "pick"][["object_x", "object_y"]].drop_duplicates().to_numpy()
    kept = demonstrations.episodes
    lacking = [f"1 of {kept} demonstrations: cut by the budget, perhaps before its grasp"] * (cut and not whole)
    return Grasps(points, f"simulation, {kept} demonstrations", tuple(lacking), passed=passed)


def _doubts(demos: RobotDataSet) -> tuple[str, ...]:
    """What was assumed of the hand, its units and its frame, and demonstrations that stand there twice."""
    checks = {check.name: check for check in check_dataset(demos)}
    doubts = [f"{DECIDING[name]}: {checks[name].detail}" for name in DECIDING if checks[name].outcome == "differs"]
    doubts += [f"{row.part}: {row.quantity} in {row.unit}: {row.note}" for row in demos.units.itertuples()
             if row.note and row.quantity in ("gripper", "position", "joints") and row.unit != "unknown"]
    doubts += [f"{row.part}: positions up to {max(-row.lowest, row.highest):g} taken for {row.unit} by their size"
               for row in demos.units.itertuples()
               if row.quantity == "position" and row.decided_by == BY_SIZE and row.unit != "unknown"]
    if any(episode.method != "static" for episode in demos.episodes):
        doubts.append("an object that moved before its grasp was seen at more places than these, which nobody recorded")
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
    if not np.isfinite(episode.gripper).all():
        return "NaN in the gripper"
    step = grasp_step(episode.gripper)
    if step is None:
        return "the gripper never closes on anything"
    return hand[step, :2] if np.isfinite(hand[step, :2]).all() else "no finite pose where the gripper closes"
