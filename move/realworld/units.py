"""The units of a data set: read from names, else from the size of the numbers (`RANGES`), else given by the reader.

LeRobot's own arms (SO-100, SO-101, Koch) have joints in degrees or from -100 to 100 per cent, which no size tells
apart, and grippers in per cent; so may any arm that is not stated to be a PIPER, and other arms' large numbers may be
counts of a motor. Whatever cannot be inferred is `unknown` and stays out of the episodes until a units file names it:

    "*":                 # every part, or a part's folder name
      joints: deg        # or percent: known, and no angle
      gripper: half_m    # half the gap, in m
      gripper_closed_is: high
      time: ms
      arm: piper         # where the data set does not name its arm
      method: static     # where the folder's name does not say
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from move import yaml_text
from move.errors import BadInput
from move.paper import PAPER_METHODS
from move.realworld.episode import Recording, RobotEpisode
from move.realworld.piper import is_piper
from move.untrusted import read_text, reading

ANGLE = {"rad": 1.0, "deg": np.pi / 180, "mdeg": np.pi / 180e3}  # mdeg, um: as on PIPER's own bus
LENGTH = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6}
TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
PIKA_OPEN_RAD = 1.6  # encoder angle; 0 is closed
# unit of a gripper -> factor, unit that it is turned into
GRIPPER = {"m": (1.0, "m"), "cm": (1e-2, "m"), "mm": (1e-3, "m"), "um": (1e-6, "m"), "half_m": (2.0, "m"),
           "normalised": (1.0, "normalised"), "percent": (0.01, "normalised"),
           "pika_rad": (1 / PIKA_OPEN_RAD, "normalised"), "rad": (1.0, "rad"), "deg": (np.pi / 180, "rad")}
UNITS = {"time": tuple(TIME), "joints": (*ANGLE, "percent"), "position": tuple(LENGTH), "rotation": tuple(ANGLE),
         "gripper": tuple(GRIPPER)}
CHOICES = {"gripper_closed_is": ("low", "high"), "arm": ("piper", "other"), "method": PAPER_METHODS}
_ANGLES = ((0.0, 3.2, "rad"), (7.0, 360.0, "deg"), (1000.0, np.inf, "mdeg"))
# quantity -> (lowest, highest allowed largest absolute value, unit), of time the median step; between them: unknown
RANGES = {
    "time": ((0.002, 1.0, "s"), (2.0, 1e3, "ms"), (2e3, 1e6, "us"), (2e6, 1e9, "ns")),
    "joints": _ANGLES, "rotation": _ANGLES,
    "position": ((0.0, 2.0, "m"), (100.0, 2000.0, "mm"), (2000.0, np.inf, "um")),  # below 100 it may be cm
    "gripper": ((0.0, 0.11, "m"), (0.5, 1.05, "normalised"), (1.2, 1.8, "pika_rad"), (50.0, 200.0, "mm"),
                (1000.0, np.inf, "um")),
}
_ANGLE_BOUNDS = {"rad": (0.0, 6.4), "deg": (3.2, 400.0), "mdeg": (400.0, np.inf), "percent": (1.2, 120.0)}
# quantity -> unit that is stated -> what the largest absolute value (of time the median step) is then between
BOUNDS = {
    "time": {"s": (0.0, 2.0), "ms": (0.1, 2e3), "us": (50.0, 2e6), "ns": (5e4, 2e9)},
    "joints": _ANGLE_BOUNDS, "rotation": _ANGLE_BOUNDS,
    "position": {"m": (2e-3, 3.0), "cm": (2.0, 300.0), "mm": (3.0, 3e3), "um": (3e3, np.inf)},
    "gripper": {"m": (1e-3, 0.25), "cm": (0.2, 25.0), "mm": (2.0, 250.0), "um": (1e3, np.inf), "half_m": (5e-4, 0.13),
                "normalised": (0.11, 1.2), "percent": (1.2, 120.0), "pika_rad": (0.0, 2.0), "rad": (0.0, 6.4),
                "deg": (1.8, 400.0)},
}
FASTEST_HZ = 1000.0  # a stated rate above it names no unit of time
PER_CENT = 100.0
BY_SIZE = "size of the numbers"
SCALED_TO_ONE = 1e-4  # how near 1 the largest of numbers that were scaled to -1..1 is
ONE_UNIT = 30.0  # the largest number of one joint may be so many times that of any other
MOTOR_COUNTS = 4096  # a turn of a hobby motor, which may be stored as it is read
_IN_PER_CENT = re.compile(r"so[-_]?10[01]|koch|lekiwi|moss|omx", re.IGNORECASE)  # LeRobot's arms of hobby motors


@dataclass(frozen=True)
class UnitRow:
    """The unit of one quantity of one part, and how it was inferred."""

    part: str
    quantity: str
    unit: str  # "unknown" where it could not be inferred
    decided_by: str  # "units file", "column names", "size of the numbers" or "nothing"
    lowest: float
    highest: float
    note: str = ""


def read_units_file(path: Path | None, parts: Collection[str] = ()) -> dict[str, dict[str, str]]:
    """Read a units file: part -> quantity -> unit, for each of the parts.

    Raises:
        BadInput: not YAML, an unknown part, quantity or unit.
    """
    if path is None:
        return {part: {} for part in parts}
    allowed = UNITS | CHOICES
    with reading(path, "a YAML mapping of part to quantity to unit"):
        content = yaml_text.read(read_text(Path(path)), str(path)) or {}
        for part, units in content.items():
            if part not in ("*", *parts):
                raise BadInput(f"{path}: part {part!r}; allowed: *, {', '.join(parts)}")
            for quantity, unit in units.items():
                if quantity not in allowed:
                    raise BadInput(f"{path}: {part}: {quantity}; allowed: {', '.join(allowed)}")
                if unit not in allowed[quantity]:
                    raise BadInput(f"{path}: {part}: {quantity}: {unit!r}; allowed: {', '.join(allowed[quantity])}")
        return {part: content.get("*", {}) | content.get(part, {}) for part in parts}


def detect_units(recordings: Sequence[Recording], given: Mapping[str, str]) -> list[UnitRow]:
    """Tell the units of one part from all its recordings.

    Args:
        recordings: of one part, at least one.
        given: the part's entries of the units file.
    """
    about = replace(recordings[0], robot=given.get("arm", recordings[0].robot))
    rows = []
    for quantity in UNITS:
        pieces = [values[np.isfinite(values)] for recording in recordings
                  if (values := _values(recording, quantity)) is not None and np.isfinite(values).any()]
        if pieces:
            rows.append(_row(about, quantity, np.concatenate(pieces), given, _apart(recordings, quantity, pieces)))
    return rows


def _apart(recordings: Sequence[Recording], quantity: str, pieces: Sequence[np.ndarray]) -> str:
    """Why the numbers of a quantity cannot be of one unit, in words; "" where they may be."""
    found = sorted({by_size(quantity, size) for piece in pieces if (size := _size(quantity, piece))} - {"unknown"})
    hints = sorted({recording.hints.get(quantity, "nothing") for recording in recordings
                    if _values(recording, quantity) is not None})
    if len(found) > 1:
        return f"single episodes look like {' and like '.join(found)}"
    if len(hints) > 1:
        return f"single episodes state {' and '.join(hints)}"
    return _odd_joint(recordings) if quantity == "joints" else ""


def _odd_joint(recordings: Sequence[Recording]) -> str:
    """Which joint's numbers are so large that they are of another unit than the others', in words; "" where none's."""
    joints = [recording.joints for recording in recordings if recording.joints is not None]
    if len({one.shape[1] for one in joints}) != 1:
        return ""
    columns = np.abs(np.nan_to_num(np.vstack(joints), posinf=0, neginf=0)).max(axis=0)
    *others, largest = np.sort(columns)
    odd = bool(others) and largest > ONE_UNIT * others[-1] > 0
    return f"joint {columns.argmax() + 1} is up to {largest:g}, the others up to {others[-1]:g}" if odd else ""


def _size(quantity: str, values: np.ndarray) -> float:
    """The number that a unit is inferred from: the largest absolute value, of time the median step."""
    return float(np.median(np.abs(values)) if quantity == "time" else np.abs(values).max())


def _values(recording: Recording, quantity: str) -> np.ndarray | None:
    """The numbers that a unit is inferred from; of time the steps."""
    if quantity == "time":
        return None if recording.timestamps is None else np.diff(recording.timestamps)
    if quantity in ("position", "rotation"):
        pose = recording.end_effector
        return pose if pose is None else pose[:, :3] if quantity == "position" else pose[:, 3:]
    return recording.joints if quantity == "joints" else recording.gripper


def by_size(quantity: str, largest: float) -> str:
    """Unit inferred from the largest absolute value alone; "unknown" between the ranges of the table above.

    >>> by_size("joints", 1.57), by_size("joints", 90.0), by_size("joints", 90_000.0), by_size("joints", 5.0)
    ('rad', 'deg', 'mdeg', 'unknown')
    """
    return next((unit for low, high, unit in RANGES[quantity] if low <= largest <= high), "unknown")


def _by_rate(steps: float) -> str | None:
    """Unit of time in which a median step, times the stated rate, is 1 to 10 %; None: in none."""
    return next((unit for unit, seconds in TIME.items() if abs(steps * seconds - 1) <= 0.1), None)


def _row(about: Recording, quantity: str, values: np.ndarray, given: Mapping[str, str], apart: str
         ) -> UnitRow:
    """Decide one quantity: by the units file, else by what names, the arm or the rate state, else by its size.

    `apart` says why its numbers cannot be of one unit, or nothing.
    """
    low, high = float(values.min()), float(values.max())
    largest = _size(quantity, values)

    def row(unit: str, decided_by: str, note: str = "") -> UnitRow:
        return UnitRow(about.part, quantity, unit, decided_by, low, high, note)

    def unknown(why: str) -> UnitRow:
        return row("unknown", "nothing", f"{why}: name it in a units file")

    if quantity in given:
        doubtful = _contradict(quantity, given[quantity], largest)
        return row(given[quantity], "units file", apart or f"the numbers are up to {largest:g}" * doubtful)
    if apart:
        return unknown(apart)
    if quantity == "time" and not about.fps and (values == 1).all() and len(values) > 1:
        return unknown("numbers of timesteps, or one a second")
    if quantity == "time" and about.fps and about.fps <= FASTEST_HZ and (stated := _by_rate(largest * about.fps)):
        return row(stated, "the stated rate")
    sized, hint, by = by_size(quantity, largest), about.hints.get(quantity), "names"
    if quantity == "gripper" and hint is None and _IN_PER_CENT.search(about.robot or ""):
        hint, by = "percent", "the arm"
    if hint and hint not in UNITS[quantity]:
        return unknown(f"{by}: {hint}, no unit of it")
    if hint and _contradict(quantity, hint, largest):
        look = f"look like {sized}" if sized not in ("unknown", hint) else f"are up to {largest:g}"
        return unknown(f"{by}: {hint}; the numbers {look}")
    if hint:
        return row(hint, by)
    if doubt := _may_be_else(about, quantity, sized, largest):
        return unknown(doubt)
    if sized == "unknown":
        return unknown("between the known ranges")
    caution = {"normalised": "" if "gripper_closed_is" in given else "0 taken as closed",
               "m": "never above 0.05 m: could be half the gap (half_m)" if high <= 0.05 else ""}
    return row(sized, BY_SIZE, caution.get(sized, "") if quantity == "gripper" else "")


def _may_be_else(about: Recording, quantity: str, sized: str, largest: float) -> str:
    """As what else numbers may be read than as what they look like; "" where as nothing else."""
    if quantity == "joints" and sized == "rad" and abs(largest - 1) <= SCALED_TO_ONE:
        return "radians, or scaled to -1..1"
    if quantity == "position" and abs(largest - 1) <= SCALED_TO_ONE:
        return "metres, or scaled to -1..1"
    if quantity == "gripper" and sized == "mm" and abs(largest - PER_CENT) <= 0.5:
        return "mm or per cent"
    if is_piper(about.robot) or quantity not in ("joints", "gripper"):
        return ""
    if sized in ("mdeg", "um") and (about.robot or largest <= MOTOR_COUNTS):
        return f"{sized} or counts of a motor"
    if quantity == "gripper" and sized == "mm" and largest <= PER_CENT:
        return "mm or per cent"
    if quantity == "joints" and largest <= PER_CENT and (sized == "deg" or _IN_PER_CENT.search(about.robot or "")):
        return "degrees or -100..100 per cent"
    return ""


def _contradict(quantity: str, unit: str, largest: float) -> bool:
    """Whether the numbers of a whole part are too large or too small for the stated unit."""
    low, high = BOUNDS[quantity][unit]
    return bool(largest) and not low <= largest <= high


def convert(recording: Recording, rows: Sequence[UnitRow], given: Mapping[str, str], method: str) -> RobotEpisode:
    """Turn a recording into SI units; a quantity of unknown unit becomes None, and time NaN.

    Args:
        rows: of the recording's part, from `detect_units`.
        method: how it was collected.
    """
    unit = {row.quantity: row.unit for row in rows if row.unit != "unknown"}
    joints, pose, gripper, gripper_unit = recording.joints, recording.end_effector, recording.gripper, None
    joints = joints * ANGLE[unit["joints"]] if joints is not None and unit.get("joints") in ANGLE else None
    if pose is not None:
        known = "position" in unit and "rotation" in unit
        pose = pose * np.repeat((LENGTH[unit["position"]], ANGLE[unit["rotation"]]), 3) if known else None
    if gripper is not None and "gripper" in unit:
        factor, gripper_unit = GRIPPER[unit["gripper"]]
        gripper = gripper * factor
        if given.get("gripper_closed_is") == "high":
            open_at = factor * next(row.highest for row in rows if row.quantity == "gripper")  # in the whole part
            gripper = (1.0 if gripper_unit == "normalised" else open_at) - gripper
    times_s = _times_s(recording, unit.get("time"))
    timed = recording.timestamps is not None or recording.fps
    camera_s = times_s if timed else times_s * np.nan  # a guessed time finds no picture
    own = vars(recording) | {
        "joints": joints, "end_effector": pose, "gripper": gripper if gripper_unit else None,
        "robot": given.get("arm", recording.robot),
        "cameras": {name: frames.at(camera_s) for name, frames in recording.cameras.items()}}
    return RobotEpisode(**own, method=method, gripper_unit=gripper_unit,
                        timestamps_s=times_s - times_s[np.isfinite(times_s)][:1].sum())


def _times_s(recording: Recording, unit: str | None) -> np.ndarray:
    """Times of the timesteps in the data set's own clock, (T,) s; NaN where their unit is unknown."""
    if recording.timestamps is None:
        return np.arange(recording.timesteps) / (recording.fps or recording.assumed_fps)
    if len(recording.timestamps) == 1:
        unit = unit or "s"  # one time alone has no step
    return recording.timestamps * (TIME[unit] if unit else np.nan)


def units_table(rows: Sequence[UnitRow]) -> pd.DataFrame:
    """One row a part and quantity: unit, who decided, the range seen in the file's units, and a caution."""
    return pd.DataFrame([asdict(row) for row in rows], columns=list(UnitRow.__dataclass_fields__))
