"""In which units a data set is written: told by column names, else by the size of the numbers, else by the reader.

| quantity | what is seen | unit |
|---|---|---|
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

Whatever falls between is `unknown` and stays out of the episodes until a units file names it:

    "*":                 # every part, or a part's folder name
      joints: deg
      gripper: half_m    # half the gap, in m
      gripper_closed_is: high
      method: static     # where the folder's name does not tell
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import yaml

from move.errors import BadInput
from move.paper import PAPER_METHODS
from move.realworld.episode import Recording, RobotEpisode
from move.realworld.piper import LIMITS_RAD
from move.untrusted import reading

ANGLE = {"rad": 1.0, "deg": np.pi / 180, "mdeg": np.pi / 180e3}
LENGTH = {"m": 1.0, "mm": 1e-3, "um": 1e-6}
PIKA_OPEN_RAD = 1.6
# quantity -> unit -> factor to SI (or to 0..1 for a gripper that is not in metres)
FACTORS = {
    "joints": ANGLE, "position": LENGTH, "rotation": ANGLE,
    "gripper": LENGTH | {"half_m": 2.0, "normalised": 1.0, "pika_rad": 1 / PIKA_OPEN_RAD},
}
OPENS_TO_ONE = ("normalised", "pika_rad")
CHOICES = {"gripper_closed_is": ("low", "high"), "method": PAPER_METHODS}
# quantity -> (lowest, highest allowed largest absolute value, unit)
RANGES = {
    "joints": ((0.0, 3.2, "rad"), (7.0, 360.0, "deg"), (1000.0, np.inf, "mdeg")),
    "rotation": ((0.0, 3.2, "rad"), (7.0, 360.0, "deg"), (1000.0, np.inf, "mdeg")),
    "position": ((0.0, 2.0, "m"), (10.0, 2000.0, "mm"), (2000.0, np.inf, "um")),
    "gripper": ((0.0, 0.11, "m"), (0.11, 1.05, "normalised"), (1.2, 1.8, "pika_rad"), (50.0, 200.0, "mm"),
                (1000.0, np.inf, "um")),
}


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


def read_units_file(path: Path | None) -> dict[str, dict[str, str]]:
    """Read a units file: part -> quantity -> unit.

    Raises:
        BadInput: not YAML, an unknown quantity or an unknown unit.
    """
    if path is None:
        return {}
    with reading(path, "a YAML mapping of part to quantity to unit"):
        content = yaml.safe_load(Path(path).read_text(encoding="utf-8")) or {}
        allowed = {quantity: tuple(units) for quantity, units in FACTORS.items()} | CHOICES
        for part, units in content.items():
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
    part = recordings[0].part
    given = {**overrides.get("*", {}), **overrides.get(part, {})}
    hints = recordings[0].hints
    return [_row(part, quantity, values, hints.get(quantity), given) for quantity, values in _pool(recordings).items()]


def _pool(recordings: Sequence[Recording]) -> dict[str, np.ndarray]:
    """All finite values of each quantity."""
    pieces: dict[str, list[np.ndarray]] = {quantity: [] for quantity in FACTORS}
    for r in recordings:
        pose = r.end_effector
        found = {
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


def _row(part: str, quantity: str, values: np.ndarray, hint: str | None, given: Mapping[str, str]) -> UnitRow:
    low, high = float(values.min()), float(values.max())
    sized = by_size(quantity, max(abs(low), abs(high)))
    if quantity in given:
        unit, by, note = given[quantity], "units file", ""
    elif hint and _contradict(quantity, hint, sized):
        unit, by, note = ("unknown", "nothing",
                          f"column names say {hint}, the numbers look like {sized}: name it in a units file")
    elif hint:
        unit, by, note = hint, "column names", ""
    elif sized == "unknown":
        unit, by, note = sized, "nothing", "between the known ranges: name it in a units file"
    else:
        unit, by, note = sized, "size of the numbers", _caution(quantity, sized, high)
    return UnitRow(part, quantity, unit, by, low, high, note)


def _contradict(quantity: str, hint: str, sized: str) -> bool:
    """Whether the numbers are too large for the stated unit (small numbers never contradict a name)."""
    order = [unit for _, _, unit in RANGES[quantity]]
    return hint in order and sized in order and order.index(sized) > order.index(hint)


def _caution(quantity: str, unit: str, high: float) -> str:
    if quantity == "gripper" and unit == "normalised":
        return "0 taken as closed"
    if quantity == "gripper" and unit == "m" and high <= 0.05:
        return "never above 0.05 m: could be half the gap (half_m)"
    return ""


def convert(recording: Recording, rows: Sequence[UnitRow], overrides: Mapping[str, Mapping[str, str]],
            method: str) -> RobotEpisode:
    """Turn a recording into SI units; a quantity of unknown unit becomes None.

    Args:
        rows: of the recording's part, from `detect_units`.
        method: how it was collected, unless the overrides say it.
    """
    unit = {row.quantity: row.unit for row in rows if row.unit != "unknown"}
    given = {**overrides.get("*", {}), **overrides.get(recording.part, {})}
    pose = recording.end_effector
    if pose is not None:
        known = "position" in unit and "rotation" in unit
        scales = (LENGTH[unit["position"]], ANGLE[unit["rotation"]]) if known else ()
        pose = pose * np.repeat(scales, 3) if known else None
    gripper, gripper_unit = _gripper(recording.gripper, unit.get("gripper"), given.get("gripper_closed_is", "low"))
    return RobotEpisode(
        part=recording.part, method=given.get("method", method), index=recording.index, source=recording.source,
        timestamps_s=recording.timestamps_s,
        joints=recording.joints * ANGLE[unit["joints"]] if recording.joints is not None and "joints" in unit else None,
        end_effector=pose, gripper=gripper, gripper_unit=gripper_unit, action=recording.action,
        action_names=recording.action_names, state=recording.state, cameras=recording.cameras,
        lengths=recording.lengths, notes=recording.notes)


def _gripper(values: np.ndarray | None, unit: str | None, closed_is: str) -> tuple[np.ndarray | None, str | None]:
    if values is None or unit is None:
        return None, None
    opening = values * FACTORS["gripper"][unit]
    if unit not in OPENS_TO_ONE:
        return opening, "m"
    return (1.0 - opening if closed_is == "high" else opening), "normalised"


def units_table(rows: Sequence[UnitRow]) -> pd.DataFrame:
    """One row a part and quantity: unit, who decided, the range seen in the file's units, and a caution."""
    return pd.DataFrame([asdict(row) for row in rows], columns=list(UnitRow.__dataclass_fields__))


def outside_limits(joints_rad: np.ndarray, *, slack_rad: float = 0.1) -> float:
    """Share of timesteps with a joint outside PIPER's limits.

    Args:
        joints_rad: (T, n) rad; only the first six are judged.
    """
    joints = joints_rad[:, :6]
    low, high = LIMITS_RAD[:joints.shape[1]].T
    return float(((joints < low - slack_rad) | (joints > high + slack_rad)).any(axis=1).mean())
