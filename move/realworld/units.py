"""In which units a data set is written: told by names, else by the size of the numbers, else by the reader.

| quantity | what is seen | unit |
|---|---|---|
| time | median step times the stated rate, else the median step: 0.002 to 1 | s |
| | a thousand, a million, a thousand million times as much | ms, us, ns |
| joints, rotation | largest absolute value > 1000 | mdeg (0.001 degree, the arm's own bus) |
| | 7 to 360 | deg |
| | at most 3.2 | rad |
| position | largest > 2000 | um (0.001 mm, the arm's own bus) |
| | 10 to 2000 | mm |
| | at most 2 | m |
| gripper | largest at most 0.11 | m (finger gap) |
| | at most 1.05 | normalised, 0 closed and 1 open |
| | 1.2 to 1.8 | pika_rad (encoder angle, 0 closed, 1.6 open) |
| | 50 to 200 | mm |
| | > 1000 | um |

LeRobot's own arms (SO-100, SO-101, Koch) have joints in degrees or from -100 to 100 per cent, which no size tells
apart, and grippers in per cent; so may any arm that is not stated to be a PIPER. Whatever cannot be told is `unknown`
and stays out of the episodes until a units file names it:

    "*":                 # every part, or a part's folder name
      joints: deg        # or percent: known, and no angle
      gripper: half_m    # half the gap, in m
      gripper_closed_is: high
      time: ms
      arm: piper         # where the data set does not name its arm
      method: static     # where the folder's name does not tell
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

ANGLE = {"rad": 1.0, "deg": np.pi / 180, "mdeg": np.pi / 180e3}
LENGTH = {"m": 1.0, "mm": 1e-3, "um": 1e-6}
TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
PIKA_OPEN_RAD = 1.6
# unit of a gripper -> factor, unit that it is turned into
GRIPPER = {"m": (1.0, "m"), "mm": (1e-3, "m"), "um": (1e-6, "m"), "half_m": (2.0, "m"),
           "normalised": (1.0, "normalised"), "percent": (0.01, "normalised"),
           "pika_rad": (1 / PIKA_OPEN_RAD, "normalised"), "rad": (1.0, "rad"), "deg": (np.pi / 180, "rad")}
UNITS = {"time": tuple(TIME), "joints": (*ANGLE, "percent"), "position": tuple(LENGTH), "rotation": tuple(ANGLE),
         "gripper": tuple(GRIPPER)}
CHOICES = {"gripper_closed_is": ("low", "high"), "arm": ("piper", "other"), "method": PAPER_METHODS}
# quantity -> (lowest, highest allowed largest absolute value, unit); of time the median step
RANGES = {
    "time": ((0.002, 1.0, "s"), (2.0, 1e3, "ms"), (2e3, 1e6, "us"), (2e6, 1e9, "ns")),
    "joints": ((0.0, 3.2, "rad"), (7.0, 360.0, "deg"), (1000.0, np.inf, "mdeg")),
    "rotation": ((0.0, 3.2, "rad"), (7.0, 360.0, "deg"), (1000.0, np.inf, "mdeg")),
    "position": ((0.0, 2.0, "m"), (10.0, 2000.0, "mm"), (2000.0, np.inf, "um")),
    "gripper": ((0.0, 0.11, "m"), (0.11, 1.05, "normalised"), (1.2, 1.8, "pika_rad"), (50.0, 200.0, "mm"),
                (1000.0, np.inf, "um")),
}
MOST = {"percent": 120.0, "rad": 6.3, "deg": 360.0, "normalised": 1.2}  # of a gripper whose name states the unit
PER_CENT = 100.0
_IN_PER_CENT = re.compile(r"so[-_]?10[01]|koch|lekiwi|moss|omx", re.IGNORECASE)  # LeRobot's arms of hobby motors


@dataclass(frozen=True)
class UnitRow:
    """The unit of one quantity of one part, and how it was told."""

    part: str
    quantity: str
    unit: str  # "unknown" where it could not be told
    decided_by: str  # "units file", "column names", "size of the numbers" or "nothing"
    lowest: float
    highest: float
    note: str = ""


def read_units_file(path: Path | None, parts: Collection[str] = ()) -> dict[str, dict[str, str]]:
    """Read a units file: part -> quantity -> unit.

    Args:
        parts: the names that a part may have, besides "*".

    Raises:
        BadInput: not YAML, an unknown part, quantity or unit.
    """
    if path is None:
        return {}
    with reading(path, "a YAML mapping of part to quantity to unit"):
        content = yaml_text.read(read_text(Path(path)), str(path)) or {}
        allowed = UNITS | CHOICES
        for part, units in content.items():
            if part not in ("*", *parts):
                raise BadInput(f"{path}: part {part!r}; allowed: *, {', '.join(parts)}")
            for quantity, unit in units.items():
                if unit not in allowed.get(quantity, ()):
                    raise BadInput(f"{path}: {part}: {quantity}: {unit!r}; allowed: " +
                                   (f"{', '.join(allowed[quantity])}" if quantity in allowed else f"{sorted(allowed)}"))
        return content


def detect_units(recordings: Sequence[Recording], overrides: Mapping[str, Mapping[str, str]]) -> list[UnitRow]:
    """Tell the units of one part from all its recordings.

    Args:
        recordings: of one part, at least one.
        overrides: from `read_units_file`; the part's own entry wins over "*".
    """
    given = _given(recordings[0], overrides)
    about = replace(recordings[0], robot=given.get("arm", recordings[0].robot))
    return [_row(about, quantity, values, given) for quantity, values in _pool(recordings).items()]


def _given(recording: Recording, overrides: Mapping[str, Mapping[str, str]]) -> dict[str, str]:
    return {**overrides.get("*", {}), **overrides.get(recording.part, {})}


def _pool(recordings: Sequence[Recording]) -> dict[str, np.ndarray]:
    """All finite values of each quantity; of time the steps."""
    pieces: dict[str, list[np.ndarray]] = {quantity: [] for quantity in UNITS}
    for r in recordings:
        pose = r.end_effector
        found = {
            "time": None if r.timestamps is None else np.diff(r.timestamps),
            "joints": r.joints, "position": None if pose is None else pose[:, :3],
            "rotation": None if pose is None else pose[:, 3:], "gripper": r.gripper,
        }
        for quantity, values in found.items():
            if values is not None:
                pieces[quantity].append(values[np.isfinite(values)].ravel())
    pooled = {quantity: np.concatenate(values) for quantity, values in pieces.items() if values}
    return {quantity: values for quantity, values in pooled.items() if values.size}


def by_size(quantity: str, largest: float) -> str:
    """Unit told by the largest absolute value alone; "unknown" between the ranges of the table above.

    >>> by_size("joints", 1.57), by_size("joints", 90.0), by_size("joints", 90_000.0), by_size("joints", 5.0)
    ('rad', 'deg', 'mdeg', 'unknown')
    """
    return next((unit for low, high, unit in RANGES[quantity] if low <= largest <= high), "unknown")


def _row(about: Recording, quantity: str, values: np.ndarray, given: Mapping[str, str]) -> UnitRow:
    """Decide one quantity: by the units file, else by what names or the arm state, else by its size."""
    low, high = float(values.min()), float(values.max())
    largest = float(np.median(np.abs(values))) if quantity == "time" else max(abs(low), abs(high))
    sized, hint, by, note = by_size(quantity, largest), about.hints.get(quantity), "names", ""
    if quantity == "gripper" and hint is None and _IN_PER_CENT.search(about.robot or ""):
        hint, by = "percent", "the arm"
    if quantity == "time" and about.fps and (stated := by_rate(largest * about.fps)):
        hint, by = stated, "the stated rate"
    if quantity in given:
        unit, by = given[quantity], "units file"
    elif hint and by != "the stated rate" and _contradict(quantity, hint, sized, largest):
        unit, by, note = ("unknown", "nothing",
                          f"{by}: {hint}; the numbers look like {sized}: name it in a units file")
    elif hint:
        unit = hint
    elif percent := _may_be_percent(about, quantity, sized, largest):
        unit, by, note = "unknown", "nothing", percent
    elif sized == "unknown":
        unit, by, note = sized, "nothing", "between the known ranges: name it in a units file"
    else:
        unit, by, note = sized, "size of the numbers", _caution(quantity, sized, high)
    return UnitRow(about.part, quantity, unit, by, low, high, note)


def by_rate(steps: float) -> str | None:
    """Unit of time in which a median step is one of the stated rate, to 10 %; None: in none.

    >>> by_rate(1.0), by_rate(1000.4), by_rate(100.0)
    ('s', 'ms', None)
    """
    return next((unit for unit, seconds in TIME.items() if abs(steps * seconds - 1) <= 0.1), None)


def _may_be_percent(about: Recording, quantity: str, sized: str, largest: float) -> str:
    """Why numbers may be per cent as well as what they look like; "" where they may not."""
    if is_piper(about.robot) or quantity not in ("joints", "gripper") or largest > PER_CENT:
        return ""
    if quantity == "gripper":
        return "mm or per cent: name it in a units file (gripper: mm or percent)" if sized == "mm" else ""
    if sized == "deg" or _IN_PER_CENT.search(about.robot or ""):
        return "degrees or -100..100: name it in a units file (joints: deg or percent)"
    return ""


def _contradict(quantity: str, hint: str, sized: str, largest: float) -> bool:
    """Whether the numbers are too large for the stated unit (small numbers never contradict a name)."""
    order = [unit for _, _, unit in RANGES[quantity]]
    larger = hint in order and sized in order and order.index(sized) > order.index(hint)
    return larger or quantity == "gripper" and largest > MOST.get(hint, np.inf)


def _caution(quantity: str, unit: str, high: float) -> str:
    if quantity == "gripper" and unit == "normalised":
        return "0 taken as closed"
    if quantity == "gripper" and unit == "m" and high <= 0.05:
        return "never above 0.05 m: could be half the gap (half_m)"
    return ""


def convert(recording: Recording, rows: Sequence[UnitRow], overrides: Mapping[str, Mapping[str, str]],
            method: str) -> RobotEpisode:
    """Turn a recording into SI units; a quantity of unknown unit becomes None, and time NaN.

    Args:
        rows: of the recording's part, from `detect_units`.
        method: how it was collected, unless the overrides say it.
    """
    unit = {row.quantity: row.unit for row in rows if row.unit != "unknown"}
    given = _given(recording, overrides)
    pose = recording.end_effector
    if pose is not None:
        known = "position" in unit and "rotation" in unit
        scales = (LENGTH[unit["position"]], ANGLE[unit["rotation"]]) if known else ()
        pose = pose * np.repeat(scales, 3) if known else None
    gripper, gripper_unit = _gripper(recording.gripper, unit.get("gripper"), given.get("gripper_closed_is", "low"))
    joints = recording.joints * ANGLE[unit["joints"]] if (
        recording.joints is not None and unit.get("joints") in ANGLE) else None
    times_s = _times_s(recording, unit.get("time"))
    origin_s = times_s[np.isfinite(times_s)][:1].sum()
    told = recording.timestamps is not None or recording.fps
    camera_s = times_s if told else times_s * np.nan  # a guessed time finds no picture
    own = vars(recording) | {
        "joints": joints, "end_effector": pose, "gripper": gripper, "robot": given.get("arm", recording.robot),
        "cameras": {name: frames.at(camera_s) for name, frames in recording.cameras.items()}}
    return RobotEpisode(**own, method=given.get("method", method), gripper_unit=gripper_unit,
                        timestamps_s=times_s - origin_s)


def _times_s(recording: Recording, unit: str | None) -> np.ndarray:
    """Times of the timesteps in the data set's own clock, (T,) s; NaN where their unit is unknown."""
    steps = np.arange(recording.timesteps)
    if recording.timestamps is None:
        return steps / (recording.fps or recording.assumed_fps)
    if len(steps) == 1:
        return recording.timestamps * TIME[unit or "s"]
    return recording.timestamps * (TIME[unit] if unit else np.nan)


def _gripper(values: np.ndarray | None, unit: str | None, closed_is: str) -> tuple[np.ndarray | None, str | None]:
    if values is None or unit is None:
        return None, None
    factor, turned_into = GRIPPER[unit]
    opening = values * factor
    return (1.0 - opening if turned_into == "normalised" and closed_is == "high" else opening), turned_into


def units_table(rows: Sequence[UnitRow]) -> pd.DataFrame:
    """One row a part and quantity: unit, who decided, the range seen in the file's units, and a caution."""
    return pd.DataFrame([asdict(row) for row in rows], columns=list(UnitRow.__dataclass_fields__))
