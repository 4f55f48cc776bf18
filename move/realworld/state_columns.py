"""Which column of a state vector is what: from its names, or from its width where it has none."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

POSE = ("x", "y", "z", "roll", "pitch", "yaw")
_ROTATION_AXIS = {"x": "roll", "y": "pitch", "z": "yaw"}
_UNITS = {"rad": "rad", "radian": "rad", "radians": "rad", "deg": "deg", "degree": "deg", "degrees": "deg",
         "mdeg": "mdeg", "m": "m", "cm": "cm", "mm": "mm", "um": "um", "percent": "percent", "pct": "percent",
         "degs": "deg", "rads": "rad", "percentage": "percent", "normalized": "normalised", "normalised": "normalised",
         **{f"{long}{metre}{s}": short for long, short in (("", "m"), ("centi", "cm"), ("milli", "mm"), ("micro", "um"))
            for metre in ("meter", "metre") for s in ("", "s")},
         **{name: name for name in ("turn", "turns", "rev", "revs", "ticks", "counts", "mrad", "millirad", "inch",
                                    "inches", "km", "nm")}}
# words of a name, in lower case
_SIDES = {"l": "left", "r": "right", "left": "left", "right": "right"}
_GRIPPER = {"gripper", "grippers", "grasper", "jaw", "claw"}
_NO_PLACE = {"vel", "velocity", "speed", "acc", "acceleration", "effort", "torque", "tau", "force", "current", "load",
             "temperature", "voltage", "target", "goal", "command", "cmd", "delta", "rel", "relative", "diff"}
_CLOSED = {"close", "closed", "closedness", "closing"}  # of a gripper whose large numbers are closed
_NO_ARM = {"leg", "hip", "knee", "ankle", "foot", "head", "neck", "torso", "hand", "finger", "thumb", "object", "cube"}
_OF_A_POSE = {"eef", "ee", "end", "effector", "endpose", "tcp", "pose", "pos", "position", "rot", "rotation", "euler",
              "flange", "arm", "sim", "observation", "state", *_SIDES, *_GRIPPER}
_JOINT_WORDS = ("waist", "shoulder", "elbow", "forearm", "wrist")  # from the base to the hand
_JOINT = re.compile(r"(?:^|_)(?:joint|motor|axis|j)_?(\d+)(?:_|$)")
_LIMB = re.compile(r"(?:^|_)((?:arm|robot|follower|puppet)_?\d+|leader|master)_")


@dataclass(frozen=True)
class Columns:
    """Column numbers of one arm in a state vector."""

    joints: tuple[int, ...] = ()
    pose: tuple[int, ...] = ()  # six numbers, x y z roll pitch yaw, or none
    gripper: int | None = None


def flat_names(names: object) -> list[str]:
    """Flatten the ways feature names are written: lists, `{"motors": [...]}`, names with their columns, or null.

    >>> flat_names([["joint_1", "gripper"]]), flat_names({"motors": ["a"]}), flat_names({"b": 1, "a": 0})
    (['joint_1', 'gripper'], ['a'], ['a', 'b'])
    """
    if isinstance(names, dict):
        if all(type(column) is int for column in names.values()):
            names = sorted(names, key=names.__getitem__)
        else:
            names = list(names.values()) if all(isinstance(v, list) for v in names.values()) else list(names)
    if not isinstance(names, list | tuple):
        return []
    flat: list[str] = []
    for name in names:
        flat += flat_names(name) if isinstance(name, list | tuple | dict) else [str(name)]
    return flat


def split_columns(names: Sequence[str], width: int, *, piper_order: bool = True
                  ) -> tuple[dict[str, Columns], str | None]:
    """Tell the arms, joints, pose and gripper of a state vector apart.

    Args:
        names: one name a column, or none.
        width: number of columns found in the data.
        piper_order: whether the arm may be PIPER's, whose joints have an order.

    Returns:
        limb ("", "left", "right", "arm_1", ...) -> columns, and a note where something had to be assumed or is left.
    """
    if len(names) == width:
        arms, left = _by_name(names)
        notes = [f"{left} of {width} columns are of no arm by their names: kept as stored"] * bool(left)
        joints = [names[column] for arm in arms.values() for column in arm.joints]
        if piper_order and any(not _JOINT.search("_".join(words(name))) for name in joints):
            notes.append("joints named by words are taken from the waist to the wrist, else as stored")
        return arms, "; ".join(notes) or None
    what = f"state of {width} columns with " + (f"{len(names)} names" if names else "no names")
    arms = _by_width(width) if piper_order else {}
    return arms, f"{what}: " + ("order assumed from the width" if arms else "kept as stored; for PIPER's arm 6, 7, 12, "
                                "13 or 14 columns, for another names are expected")


def words(name: str) -> list[str]:
    """The words of a name, in lower case.

    >>> words("rightArm.wrist_roll.pos")
    ['right', 'arm', 'wrist', 'roll', 'pos']
    """
    return [word for word in re.split(r"[^a-z0-9]+", re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()) if word]


def _by_name(names: Sequence[str]) -> tuple[dict[str, Columns], int]:
    """The arms that names distinguish, and how many columns are of none of them, apart from speeds and efforts."""
    limbs: dict[str, dict[tuple[str, str], int | None]] = {}
    name_words = [words(name) for name in names]
    for column, found in enumerate(name_words):
        if (what := _meaning(found)) is None:
            continue
        side = next((_SIDES[word] for word in found if word in _SIDES), "")
        parts = limbs.setdefault("_".join(filter(None, (side, *_LIMB.findall("_".join(found))))), {})
        parts[what] = None if what in parts else column  # what two columns claim is neither's
    arms = {limb: _columns(parts) for limb, parts in limbs.items()}
    arms = {limb: arm for limb, arm in arms.items() if arm.joints or arm.pose}
    read = {column for arm in arms.values() for column in (*arm.joints, *arm.pose, arm.gripper)}
    return arms, sum(column not in read and not set(found) & _NO_PLACE for column, found in enumerate(name_words))


def _meaning(found: list[str]) -> tuple[str, str] | None:
    """What the words of a column's name say it is: a joint, an axis of the pose, the gripper, or none of them."""
    body = found[:-1] if found[1:] and found[-1] in _UNITS else found
    if not body or set(found) & (_NO_PLACE | _NO_ARM):
        return None
    if body[-1] in POSE and set(body[:-1]) <= _OF_A_POSE:
        turned = set(body) & {"rot", "rotation", "euler"}
        return "pose", _ROTATION_AXIS.get(body[-1], body[-1]) if turned else body[-1]
    if set(body) & _GRIPPER:
        return None if set(body) & _CLOSED else ("gripper", "")
    if number := _JOINT.search("_".join(body)):
        return "joint", number.group(1)
    return ("joint", "_".join(body)) if set(body) & set(_JOINT_WORDS) and body[-1] not in POSE[:3] else None


def _columns(parts: dict[tuple[str, str], int | None]) -> Columns:
    """The columns of one limb; joints with numbers are in the order of these, others from the waist to the wrist."""
    joints = {place: column for (kind, place), column in parts.items() if kind == "joint"}
    order = sorted(joints, key=int if all(place.isdigit() for place in joints) else _from_the_base)
    pose = [parts.get(("pose", axis)) for axis in POSE]
    known = [column for column in map(joints.get, order) if column is not None]
    return Columns(tuple(known) if len(known) == len(order) else (),
                   tuple(column for column in pose if column is not None) if None not in pose else (),
                   parts.get(("gripper", "")))


def _from_the_base(joint: str) -> tuple[int, int]:
    """Where a joint named by words stands along an arm: by its word, then by its number."""
    found = joint.split("_")
    rank = next((rank for rank, word in enumerate(_JOINT_WORDS) if word in found), len(_JOINT_WORDS))
    return rank, next((int(word) for word in found if word.isdigit()), 0)


def _by_width(width: int) -> dict[str, Columns]:
    """The usual orders of a PIPER state without names."""
    one = Columns(tuple(range(6)))
    return {
        6: {"": one}, 7: {"": Columns(one.joints, (), 6)}, 12: {"": Columns(one.joints, tuple(range(6, 12)))},
        13: {"": Columns(one.joints, tuple(range(7, 13)), 6)},
        14: {"left": Columns(one.joints, (), 6), "right": Columns(tuple(range(7, 13)), (), 13)},
    }.get(width, {})


def arm_streams(state: np.ndarray, names: Sequence[str] = (), *, piper_order: bool = True
                ) -> tuple[dict[str, np.ndarray], dict[str, str], list[str], tuple[str, ...]]:
    """Joints, pose and gripper of the arm that moves most in a state vector.

    Args:
        state: (T, width).
        names, piper_order: as for `split_columns`.

    Returns:
        Streams "joints", "end_effector" and "gripper" where they are named; units that names state; notes; names of the
        joints, where there are any.
    """
    arms, note = split_columns(names, state.shape[1], piper_order=piper_order)
    notes = [note] if note else []
    if not arms:
        return {}, {}, notes, ()
    arms = {limb: arm for limb, arm in arms.items() if not re.match("leader|master", limb)} or arms
    steps = np.abs(np.diff(state, axis=0))
    travel = {limb: float(np.nansum(steps[:, list(arm.joints + arm.pose)])) for limb, arm in arms.items()}
    limb = max(travel, key=lambda arm: travel[arm])
    if len(arms) > 1:
        notes.append(f"{len(arms)} arms recorded: the {limb or 'unnamed'} one moves most and is read")
    arm = arms[limb]
    streams = {"joints": arm.joints, "end_effector": arm.pose, "gripper": () if arm.gripper is None else arm.gripper}
    found = {name: state[:, columns] for name, columns in streams.items() if columns != ()}
    if len(names) != state.shape[1]:
        return found, {}, notes, ()
    return found, _unit_hints(names, arm), notes, tuple(names[column] for column in arm.joints)


def _unit_hints(names: Sequence[str], columns: Columns) -> dict[str, str]:
    """Units that the column names state, e.g. `arm_joint_1_rad` or `gripper_open_scale`; "deg and rad" of both."""
    numbers = {"joints": columns.joints, "position": columns.pose[:3], "rotation": columns.pose[3:],
               "gripper": () if columns.gripper is None else (columns.gripper,)}
    hints = {}
    for quantity, mine in numbers.items():
        endings = {_UNITS.get(words(names[n])[-1], "") for n in mine}
        if "" not in endings and endings:
            hints[quantity] = " and ".join(sorted(endings))  # of several the numbers have none
    if columns.gripper is not None and words(names[columns.gripper])[-2:] == ["open", "scale"]:
        hints["gripper"] = "normalised"
    return hints
