"""What demonstrations of a real robot cover: grasps, lengths, paths, and the share of the half disc visited."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from move.errors import BadInput
from move.paper import REAL_RADIUS_M
from move.realworld.episode import RobotEpisode
from move.realworld.piper import forward_kinematics, is_piper, outside_limits

CELL_M = 0.05  # side of a cell of the table
HOLD_STEPS = 3  # shortest time that counts as a grasp, timesteps
LEAST_TRAVEL = 0.1  # a gripper's range smaller than this share of its largest value is noise: no grasp
STRIP_FRAMES = 6


def coverage(points_m: np.ndarray) -> pd.DataFrame:
    """How often each square cell of the table was visited; cells whose centre lies in the half disc x >= 0.

    Args:
        points_m: (N, 2) x and y in the frame of the arm's base, x forward; non-finite points, and those
            in a cell whose centre lies outside the half disc, are not counted.

    Returns:
        Columns column, row (whole numbers), x_m, y_m (centres), visits.
    """
    half = int(np.ceil(REAL_RADIUS_M / CELL_M))
    far, (x, y) = half * CELL_M, np.asarray(points_m, dtype=float).T
    visits, *_ = np.histogram2d(x, y, bins=[half, 2 * half], range=[(0, far), (-far, far)])
    column, row = np.indices(visits.shape).reshape(2, -1)
    cells = pd.DataFrame({"column": column, "row": row - half, "x_m": (column + 0.5) * CELL_M,
                          "y_m": (row - half + 0.5) * CELL_M, "visits": visits.ravel().astype(int)})
    return cells[np.hypot(cells["x_m"], cells["y_m"]) <= REAL_RADIUS_M].reset_index(drop=True)


def grasp_step(gripper: np.ndarray | None) -> int | None:
    """The first step of the longest time the gripper stays closed.

    Closed means below the middle of the signal's own range, so the result does not depend on its unit.

    Args:
        gripper: (T,), larger is wider open; None: not recorded.

    Returns:
        A timestep, or None where nothing was grasped.

    >>> grasp_step(np.array([9, 9, 9, 6, 6, 6, 6, 9.0]))
    3
    """
    if gripper is None or len(gripper) < HOLD_STEPS + 1 or not np.isfinite(gripper).all():
        return None
    low, high = gripper.min(), gripper.max()
    if high - low < LEAST_TRAVEL * max(abs(high), 1e-12):
        return None
    closed = np.concatenate([[0], (gripper < (low + high) / 2).astype(int), [0]])
    starts, ends = np.flatnonzero(np.diff(closed) == 1), np.flatnonzero(np.diff(closed) == -1)
    lengths = np.where((starts > 0) & (ends - starts >= HOLD_STEPS), ends - starts, 0)
    return int(starts[np.argmax(lengths)]) if lengths.any() else None


def positions(episode: RobotEpisode) -> np.ndarray | None:
    """Where a PIPER's flange was, in the frame of the arm's base.

    From the six joint angles by PIPER's kinematics where there are six, because a recorded pose may be in another
    frame or of a tool; else the recorded pose.

    Returns:
        (T, 3) m, NaN where a joint is not finite; None for another arm, where neither was recorded, and where the
        joints are beyond PIPER's limits and so are another arm's or in another unit.
    """
    return None if isinstance(found := _positions(episode), str) else found


def _positions(episode: RobotEpisode) -> np.ndarray | str:
    """`positions`, or in words why there are none."""
    joints, pose = episode.joints, episode.end_effector
    if not is_piper(episode.robot):
        return f"the arm is {episode.robot or 'not named'}, not PIPER"
    if joints is not None and joints.shape[1] == 6:
        return "joints beyond PIPER's limits" if outside_limits(joints) else forward_kinematics(joints)[:, :3]
    return "no six joints and no pose in known units" if pose is None else pose[:, :3]


def why_no_positions(episodes: Sequence[RobotEpisode]) -> str:
    """Why some episodes have no `positions`, in words for a figure; "" where all have them."""
    reasons = Counter(found for found in map(_positions, episodes) if isinstance(found, str))
    listed = "; ".join(f"{count} of {len(episodes)} episodes: {reason}" for reason, count in reasons.items())
    return f"no trajectory of the hand: {listed}" if listed else ""


def stacked(pieces: Iterable[tuple[RobotEpisode, Mapping[str, Any]]], columns: Sequence[str]) -> pd.DataFrame:
    """One table of several episodes: method, part and index of each, and behind them its own `columns`."""
    tables = [pd.DataFrame({"method": e.method, "part": e.part, "index": e.index, **own}) for e, own in pieces]
    whole = ["method", "part", "index", *columns]
    return pd.concat(tables, ignore_index=True) if tables else pd.DataFrame(columns=whole)


def joint_table(episodes: Sequence[RobotEpisode]) -> pd.DataFrame:
    """Joint angles of the episodes that have no `positions`, one row a timestep and joint.

    Returns:
        Columns method, part, index, time_s, joint and degrees; a joint without a name is called by its number.
    """
    pieces = []
    for e in episodes:
        if e.joints is not None and positions(e) is None:
            count = e.joints.shape[1]
            names = e.joint_names or [f"joint {n + 1}" for n in range(count)]
            pieces.append((e, {"time_s": np.repeat(e.timestamps_s, count), "joint": np.tile(names, e.timesteps),
                               "degrees": np.degrees(e.joints).ravel()}))
    return stacked(pieces, ["time_s", "joint", "degrees"])


def length_table(episodes: Sequence[RobotEpisode]) -> pd.DataFrame:
    """Mean length of a demonstration: method, episodes (number), mean_timesteps, sd_timesteps."""
    table = pd.DataFrame([{"method": e.method, "timesteps": e.timesteps} for e in episodes])
    grouped = table.groupby("method", sort=True)["timesteps"]
    return grouped.agg(episodes="count", mean_timesteps="mean", sd_timesteps="std").reset_index()


def path_table(episodes: Sequence[RobotEpisode]) -> pd.DataFrame:
    """Every timestep of every episode with `positions`: method, part, index, step, x_m, y_m, z_m, grasped (bool)."""
    pieces = []
    for e in episodes:
        if (place := positions(e)) is not None:
            start, steps = grasp_step(e.gripper), np.arange(e.timesteps)
            pieces.append((e, {"step": steps, "x_m": place[:, 0], "y_m": place[:, 1], "z_m": place[:, 2],
                               "grasped": steps >= (e.timesteps if start is None else start)}))
    return stacked(pieces, ["step", "x_m", "y_m", "z_m", "grasped"])


def coverage_by_method(table: pd.DataFrame) -> pd.DataFrame:
    """`coverage` of each method of a table with columns `method`, `x_m`, `y_m`; adds a column `method`."""
    pieces = [coverage(rows[["x_m", "y_m"]].to_numpy()).assign(method=method)
              for method, rows in table.groupby("method", sort=True)]
    columns = ["column", "row", "x_m", "y_m", "visits", "method"]
    return pd.concat(pieces, ignore_index=True) if pieces else pd.DataFrame(columns=columns)


def equal_budget(table: pd.DataFrame) -> pd.DataFrame:
    """Cut every method to the timesteps of the smallest, in the order recorded: the paper compares equal budgets.

    Args:
        table: with a column `method`, one row a timestep (`path_table`).
    """
    budget = table.groupby("method").size().min() if len(table) else 0
    return table.groupby("method", sort=False).head(budget).reset_index(drop=True)


def frame_strips(episodes: Sequence[RobotEpisode]) -> dict[str, tuple[np.ndarray, list[str]]]:
    """Evenly spaced frames of the first episode of each method that has a camera whose frames can be read.

    Returns:
        method -> frames (STRIP_FRAMES at most, height, width, 3) uint8 and their times as text.
    """
    strips: dict[str, tuple[np.ndarray, list[str]]] = {}
    for e in episodes:
        for frames in e.cameras.values() if e.method not in strips else ():
            try:
                there = np.flatnonzero(frames.numbers() >= 0)
                spaced = np.linspace(0, len(there) - 1, STRIP_FRAMES if len(there) else 0)
                steps = there[np.unique(spaced.astype(int))]
                images = frames.read(steps)
            except BadInput:
                continue  # `checks` names it
            times = e.timestamps_s[steps]
            digits = 0 if len(times) < 2 or np.diff(times).min() >= 1 else 1
            strips[e.method] = images, [f"{time:.{digits}f} s" if np.isfinite(time) else f"step {step}"
                                        for step, time in zip(steps, times, strict=True)]
            break
    return strips


def action_table(episodes: Sequence[RobotEpisode]) -> pd.DataFrame:
    """Statistics of the recorded actions, as stored; what is not finite is left out.

    Returns:
        One row a method and component: method, component, mean, sd, lowest, highest, mean_step (mean absolute
        change from one timestep to the next).
    """
    groups: dict[tuple[str, int], list[RobotEpisode]] = {}
    for e in episodes:
        if e.action is not None:
            groups.setdefault((e.method, e.action.shape[1]), []).append(e)
    tables = []
    for (method, width), alike in sorted(groups.items()):
        stated, actions = alike[0].action_names, [e.action for e in alike if e.action is not None]
        steps = [np.abs(np.diff(action, axis=0)) for action in actions]
        values, change = (pd.DataFrame(np.vstack(rows)).replace([np.inf, -np.inf], np.nan) for rows in (actions, steps))
        tables.append(pd.DataFrame({
            "method": method, "component": stated if len(stated) == width else list(map(str, range(width))),
            "mean": values.mean(), "sd": values.std(ddof=0), "lowest": values.min(), "highest": values.max(),
            "mean_step": change.mean()}))
    return pd.concat(tables, ignore_index=True) if tables else pd.DataFrame()
