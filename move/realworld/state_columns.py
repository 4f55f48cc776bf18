"""Which column of a state vector is what, from its names, or from its width where it has none."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

POSE = ("x", "y", "z", "roll", "pitch", "yaw")
_JOINT = re.compile(r"(?:^|_)(?:joint|j|motor)_?(\d+)(?:_|$)")
_POSE = re.compile(
    r"(?:^|_)(?:(?:eef|ee|end|endpose|tcp)_?)?(?:pose|pos|rot|position|rotation)?_?(x|y|z|roll|pitch|yaw)"
    r"(?:_(?:m|mm|rad|deg))?$")
_ROTATION_AXIS = {"x": "roll", "y": "pitch", "z": "yaw"}


@dataclass(frozen=True)
class Columns:
    """Column numbers of one arm in a state vector."""

    joints: tuple[int, ...] = ()
    pose: tuple[int, ...] = ()  # six numbers, x y z roll pitch yaw, or none
    gripper: int | None = None


def flat_names(names: object) -> list[str]:
    """Flatten the ways feature names are written: a list, a list in a list, `{"motors": [...]}`, or null.

    >>> flat_names([["joint_1", "gripper"]]), flat_names({"motors": ["a"]}), flat_names(None)
    (['joint_1', 'gripper'], ['a'], [])
    """
    if isinstance(names, dict):
        names = list(names.values()) if all(isinstance(v, list) for v in names.values()) else list(names)
    if not isinstance(names, list | tuple):
        return []
    return [
        leaf for name in names for leaf in (flat_names(name) if isinstance(name, list | tuple | dict) else [str(name)])
    ]


def split_columns(names: Sequence[str], width: int) -> tuple[dict[str, Columns], str | None]:
    """Tell the arms, joints, pose and gripper of a state vector apart.

    Args:
        names: one name a column, or none.
        width: number of columns found in the data.

    Returns:
        arm ("left", "right", "") -> columns, and a note where something had to be assumed.
    """
    arms = _by_name(names) if len(names) == width else {}
    if arms:
        return arms, None
    why = "no names" if not names else f"{len(names)} names that say nothing"
    arms = _by_width(width)
    note = (f"state of {width} columns with {why}: order assumed from the width" if arms else
            f"state of {width} columns with {why}: kept as stored; for an arm, 6, 7, 12, 13 or 14 columns or names "
            "are expected")
    return arms, note


def _by_name(names: Sequence[str]) -> dict[str, Columns]:
    """Sort columns by what their names say; a name that says nothing is left out."""
    arms: dict[str, dict] = {}
    for column, name in enumerate(names):
        low = re.sub(r"[.\-/ ]+", "_", name.lower())
        side = next((side for side in ("left", "right") if side in low), "")
        arm = arms.setdefault(side, {"joints": {}, "pose": {}, "gripper": None})
        if "gripper" in low or "grasper" in low:
            arm["gripper"] = column if arm["gripper"] is None else arm["gripper"]
        elif match := _JOINT.search(low):
            arm["joints"].setdefault(int(match.group(1)), column)
        elif match := _POSE.search(low):
            axis = match.group(1)
            arm["pose"].setdefault(_ROTATION_AXIS.get(axis, axis) if "rot" in low.split("_") else axis, column)
    return {side: _columns(arm) for side, arm in arms.items() if arm["joints"] or set(POSE) <= set(arm["pose"])}


def _columns(arm: dict) -> Columns:
    pose = tuple(arm["pose"][axis] for axis in POSE) if set(POSE) <= set(arm["pose"]) else ()
    return Columns(tuple(column for _, column in sorted(arm["joints"].items())), pose, arm["gripper"])


def _by_width(width: int) -> dict[str, Columns]:
    """The usual orders of a PIPER state without names."""
    one = Columns(tuple(range(6)))
    return {
        6: {"": one}, 7: {"": Columns(one.joints, (), 6)}, 12: {"": Columns(one.joints, tuple(range(6, 12)))},
        13: {"": Columns(one.joints, tuple(range(7, 13)),
                         6)}, 14: {"left": Columns(one.joints, (), 6), "right": Columns(tuple(range(7, 13)), (), 13)},
    }.get(width, {})


def busiest(arms: dict[str, Columns], state: np.ndarray) -> tuple[Columns, str | None]:
    """Choose the arm that moves most, and say so when there was a choice.

    Args:
        arms: from `split_columns`, at least one.
        state: (T, width).
    """
    if len(arms) == 1:
        return next(iter(arms.values())), None
    travel = {side: float(np.abs(np.diff(state[:, list(c.joints + c.pose)], axis=0)).sum()) for side, c in arms.items()}
    side = max(travel, key=lambda arm: travel[arm])
    return arms[side], f"{len(arms)} arms recorded: the {side or 'unnamed'} one moves most and is read"


def unit_hints(names: Sequence[str], columns: Columns) -> dict[str, str]:
    """Units that the column names state, e.g. `arm_joint_1_rad` or `gripper_open_scale`."""
    if not names:
        return {}

    def stated(numbers: Sequence[int], words: Sequence[str]) -> str | None:
        endings = {names[n].lower().rsplit("_", 1)[-1] for n in numbers}
        return endings.pop() if len(endings) == 1 and endings <= set(words) else None

    hints = {
        "joints": stated(columns.joints, ("rad", "deg", "mdeg")), "position": stated(columns.pose[:3], ("m", "mm")),
        "rotation": stated(columns.pose[3:], ("rad", "deg")),
    }
    if columns.gripper is not None:
        low = names[columns.gripper].lower()
        hints["gripper"] = "normalised" if low.endswith("open_scale") else stated([columns.gripper], ("m", "mm"))
    return {quantity: unit for quantity, unit in hints.items() if unit}
