"""What demonstrations of a real robot cover: grasps, lengths, paths, and the share of the half disc visited."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
import pandas as pd

from move.errors import BadInput
from move.paper import REAL_RADIUS_M
from move.realworld.episode import RobotEpisode
from move.realworld.piper import forward_kinematics, is_piper, outside_limits


def workspace_cells(cell_m: float = 0.05, *, radius_m: float = REAL_RADIUS_M) -> pd.DataFrame:
    """Square cells whose centre lies in the half disc x >= 0 around the arm's base.

    Returns:
        Columns column, row (whole numbers), x_m, y_m (centres).
    """
    half = int(np.ceil(radius_m / cell_m))
    column, row = (grid.ravel() for grid in np.meshgrid(np.arange(half), np.arange(-half, half), indexing="ij"))
    cells = pd.DataFrame({"column": column, "row": row, "x_m": (column + 0.5) * cell_m, "y_m": (row + 0.5) * cell_m})
    return cells[np.hypot(cells["x_m"], cells["y_m"]) <= radius_m].reset_index(drop=True)


def coverage(points_m: np.ndarray, *, cell_m: float = 0.05, radius_m: float = REAL_RADIUS_M) -> pd.DataFrame:
    """How often each cell of the table was visited.

    Args:
        points_m: (N, 2) x and y in the frame of the arm's base, x forward; non-finite points, and those
            in a cell whose centre lies outside the half disc, are not counted.

    Returns:
        The cells of `workspace_cells` with a column `visits`.
    """
    points_m = np.asarray(points_m, dtype=float).reshape(-1, 2)
    points_m = points_m[np.isfinite(points_m).all(axis=1)]
    cells = workspace_cells(cell_m, radius_m=radius_m)
    index = pd.DataFrame(np.floor(points_m / cell_m).astype(int), columns=["column", "row"])
    visits = index.value_counts().rename("visits").reset_index()
    merged = cells.merge(visits, on=["column", "row"], how="left")
    return merged.assign(visits=merged["visits"].fillna(0).astype(int))


def grasp_step(gripper: np.ndarray, *, hold_steps: int = 3, least_travel: float = 0.1) -> int | None:
    """The first step of the longest time the gripper stays closed.

    Closed means below the middle of the signal's own range, so the result does not depend on its unit.

    Args:
        gripper: (T,), larger is wider open.
        hold_steps: shortest time that counts as a grasp, timesteps.
        least_travel: a range smaller than this share of the largest value is noise: no grasp.

    Returns:
        A timestep, or None where nothing was grasped.

    >>> grasp_step(np.array([9, 9, 9, 6, 6, 6, 6, 9.0]))
    3
    """
    gripper = np.asarray(gripper, dtype=float)
    if len(gripper) < hold_steps + 1 or not np.isfinite(gripper).all():
        return None
    low, high = gripper.min(), gripper.max()
    if high - low < least_travel * max(abs(high), 1e-12):
        return None
    closed = np.concatenate([[0], (gripper < (low + high) / 2).astype(int), [0]])
    starts, ends = np.flatnonzero(np.diff(closed) == 1), np.flatnonzero(np.diff(closed) == -1)
    runs = [(int(e - s), int(s)) for s, e in zip(starts, ends, strict=True) if s > 0 and e - s >= hold_steps]
    return max(runs, key=lambda run: run[0], default=(0, None))[1]


def positions(episode: RobotEpisode) -> np.ndarray | None:
    """Where a PIPER's flange was, in the frame of the arm's base.

    From the six joint angles by PIPER's kinematics where there are six, because a recorded pose may be in another
    frame or of a tool; else the recorded pose.

    Returns:
        (T, 3) m, NaN where a joint is not finite; None for another arm, where neither was recorded, and where the
        joints are beyond PIPER's limits and so are another arm's or in another unit.
    """
    if _why_no_positions(episode):
        return None
    if episode.joints is not None and episode.joints.shape[1] == 6:
        return forward_kinematics(episode.joints)[:, :3]
    return None if episode.end_effector is None else episode.end_effector[:, :3]


def _why_no_positions(episode: RobotEpisode) -> str:
    joints = episode.joints
    if not is_piper(episode.robot):
        return f"the arm is {episode.robot or 'not named'}, not PIPER"
    if joints is not None and joints.shape[1] == 6:
        return "joints beyond PIPER's limits" if outside_limits(joints) else ""
    return "" if episode.end_effector is not None else "no six joints and no pose in known units"


def why_no_positions(episodes: Sequence[RobotEpisode]) -> str:
    """Why some episodes have no `positions`, in words for a figure; "" where all have them."""
    reasons = Counter(filter(None, map(_why_no_positions, episodes)))
    told = "; ".join(f"{count} of {len(episodes)} episodes: {reason}" for reason, count in reasons.items())
    return f"no trajectory of the hand: {told}" if told else ""


def length_table(episodes: Sequence[RobotEpisode]) -> pd.DataFrame:
    """Mean length of a demonstration: method, episodes (number), mean_timesteps, sd_timesteps."""
    table = pd.DataFrame([{"method": e.method, "timesteps": e.timesteps} for e in episodes])
    grouped = table.groupby("method", sort=True)["timesteps"]
    return grouped.agg(episodes="count", mean_timesteps="mean", sd_timesteps="std").reset_index()


def path_table(episodes: Sequence[RobotEpisode]) -> pd.DataFrame:
    """Every timestep of every episode with `positions`: method, part, index, step, x_m, y_m, z_m, grasped (bool)."""
    tables = []
    for e in episodes:
        if (place := positions(e)) is None:
            continue
        start = grasp_step(e.gripper) if e.gripper is not None else None
        steps = np.arange(e.timesteps)
        tables.append(
            pd.DataFrame({
                "method": e.method, "part": e.part, "index": e.index, "step": steps, "x_m": place[:, 0],
                "y_m": place[:, 1], "z_m": place[:, 2],
                "grasped": steps >= start if start is not None else np.zeros(e.timesteps, dtype=bool),
            }))
    columns = ["method", "part", "index", "step", "x_m", "y_m", "z_m", "grasped"]
    return pd.concat(tables, ignore_index=True) if tables else pd.DataFrame(columns=columns)


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


def frame_strips(episodes: Sequence[RobotEpisode], *, count: int = 6) -> dict[str, tuple[np.ndarray, list[str]]]:
    """Evenly spaced frames of the first episode of each method that has a camera whose frames can be read.

    Returns:
        method -> frames (count, height, width, 3) uint8 and their times as text.
    """
    strips: dict[str, tuple[np.ndarray, list[str]]] = {}
    for e in episodes:
        for frames in e.cameras.values() if e.method not in strips else ():
            try:
                there = np.flatnonzero(frames.numbers() >= 0)
                steps = there[np.unique(np.linspace(0, len(there) - 1, count).astype(int))] if len(there) else there
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
    rows = []
    for method in sorted({e.method for e in episodes if e.action is not None}):
        actions = [(e.action, e.action_names) for e in episodes if e.method == method and e.action is not None]
        for width in sorted({action.shape[1] for action, _ in actions}):
            alike = [(action, names) for action, names in actions if action.shape[1] == width]
            stated = alike[0][1]
            names = stated if len(stated) == width else tuple(str(n) for n in range(width))
            values = np.vstack([action for action, _ in alike])
            change = np.vstack([np.abs(np.diff(action, axis=0)) for action, _ in alike])
            for n, name in enumerate(names):
                mine, steps = (column[np.isfinite(column)] for column in (values[:, n], change[:, n]))
                told = (mine.mean(), mine.std(), mine.min(), mine.max()) if mine.size else (np.nan,) * 4
                rows.append({"method": method, "component": name,
                             **dict(zip(("mean", "sd", "lowest", "highest"), told, strict=True)),
                             "mean_step": steps.mean() if steps.size else np.nan})
    return pd.DataFrame(rows)
