"""What every layout is turned into: first a `Recording` (units of the file), then a `RobotEpisode` (SI units)."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from move.errors import BadInput
from move.realworld.frames import Frames
from move.realworld.untrusted_names import plain_text
from move.untrusted import within


@dataclass(frozen=True)
class Part:
    """One sub data set: the files under one folder that share a layout.

    A repository may hold several, e.g. `static_35k/` and `move_35k/`.
    """

    name: str  # its folder, relative to the data set; "." for the data set itself
    layout: str  # a key of `layouts.LAYOUTS`
    root: Path  # its folder on this machine
    files: tuple[str, ...]  # file names relative to `root`


@dataclass(frozen=True)
class EpisodeRef:
    """Where one episode lies, known before any of its data are read."""

    index: int  # its number in the part
    files: tuple[str, ...]  # the files needed to read it, relative to the part's root
    timesteps: int | None = None  # None where only the data say
    place: Mapping[str, Any] = field(default_factory=dict)  # whatever else its layout's reader needs


@dataclass(frozen=True)
class Recording:
    """One episode as found on disk, in the units of the file, with what its data set says of it.

    T is the number of timesteps; `n` joints; `k` action components. Streams of unequal length are cut to the
    shortest; `lengths` keeps what was found. None: not recorded, or not stated.
    """

    part: str
    index: int
    source: Path
    timestamps: np.ndarray | None = None  # (T,) float64
    joints: np.ndarray | None = None  # (T, n) float64
    joint_names: tuple[str, ...] = ()  # n of them, or none
    end_effector: np.ndarray | None = None  # (T, 6) float64, x y z roll pitch yaw
    gripper: np.ndarray | None = None  # (T,) float64
    action: np.ndarray | None = None  # (T, k) float64, as stored (never converted)
    action_names: tuple[str, ...] = ()
    state: np.ndarray | None = None  # (T, w) float64, the whole state vector as stored (never converted)
    cameras: Mapping[str, Frames] = field(default_factory=dict)
    robot: str | None = None  # the arm, as the data set calls it
    fps: float | None = None  # timesteps a second that the data set states
    assumed_fps: float = 30.0  # where there are neither time stamps nor a stated rate
    stated_timesteps: int | None = None
    numbering: Mapping[str, np.ndarray] = field(default_factory=dict)  # "episode_index", "frame_index", "index": (T,)
    own_times: Mapping[str, np.ndarray] = field(default_factory=dict)  # stream -> (T,) time stamps of its readings
    gaps: tuple[str, ...] | None = None  # stored arrays that lack chunks; None: a layout without chunks
    simulated: bool | None = None
    hints: Mapping[str, str] = field(default_factory=dict)  # quantity -> unit that a name states
    lengths: Mapping[str, int] = field(default_factory=dict)  # stream -> number of entries found on disk
    not_finite: Mapping[str, int] = field(default_factory=dict)  # stream -> timesteps with NaN or infinity
    notes: tuple[str, ...] = ()  # what the reader had to assume

    @property
    def timesteps(self) -> int:
        """Number of timesteps T."""
        streams = (self.timestamps, self.joints, self.end_effector, self.gripper, self.action, self.state)
        return next((len(stream) for stream in streams if stream is not None), 0)


@dataclass(frozen=True)
class RobotEpisode(Recording):
    """One demonstration of a real robot: a recording whose joints, end effector and gripper are in SI units.

    A quantity whose unit could not be inferred is None; so are joints that are no angles. Joints are in rad, the end
    effector in m and rad in the frame of the file; a larger gripper is wider open.
    """

    method: str = "unknown"  # "static", "adc", "move", or "unknown" (from the folder's name, or a units file)
    timestamps_s: np.ndarray = field(default_factory=lambda: np.empty(0))  # (T,), starts at 0; NaN: unit unknown
    gripper_unit: str | None = None  # "m", "rad" or "normalised" (0 closed, 1 open)

    @property
    def timesteps(self) -> int:
        """Number of timesteps T."""
        return len(self.timestamps_s)


def method_of(name: str) -> str:
    """Tell the collection method from a folder's name; whole words only.

    >>> method_of("orange/static_35k"), method_of("MOVE_75k"), method_of("remove_lid")
    ('static', 'move', 'unknown')
    """
    for word, method in (("static", "static"), ("adc", "adc"), ("move|moving|dynamic", "move")):
        if re.search(rf"(?<![a-z])(?:{word})(?![a-z])", name.lower()):
            return method
    return "unknown"


def make_recording(part: Part, ref: EpisodeRef, streams: Mapping[str, np.ndarray | None], **rest: Any) -> Recording:
    """Cut the streams of an episode to their shortest; the state, where none is recorded, is the arm's streams joined.

    Args:
        streams: any of `timestamps`, `joints`, `end_effector`, `gripper`, `action`, `state`; first axis time; None:
            left out.
        rest: the other fields of `Recording`.

    Raises:
        BadInput: no stream at all, one that is no table of real numbers with at least one row, or a name that is no
            `plain_text`.
    """
    where = f"episode {ref.index} of {part.root}"
    for name in (part.name, rest.get("robot") or "", *rest.get("action_names", ()), *rest.get("joint_names", ()),
                 *rest.get("cameras", ())):
        plain_text(name, where)
    found = {name: _numbers(name, values, where) for name, values in streams.items() if values is not None}
    if not found:
        raise BadInput(f"{where} holds none of {sorted(streams)}")
    lengths = {name: len(values) for name, values in found.items()}
    shortest = min(lengths.values())
    cut: dict[str, Any] = {name: values[:shortest] for name, values in found.items()}
    recorded = [cut[name].reshape(shortest, -1) for name in ("joints", "gripper", "end_effector") if name in cut]
    if "state" not in cut and recorded:
        cut["state"] = np.hstack(recorded)
    for kind in ("numbering", "own_times"):
        cut[kind] = {name: values[:shortest] for name, values in rest.pop(kind, {}).items()}
    notes = tuple(rest.pop("notes", ()))
    if "timestamps" not in cut:
        notes += (f"no timestamps on disk: {rest.get('fps') or rest.get('assumed_fps', 30.0):g} Hz assumed",)
    bad = {name: int((~np.isfinite(values.reshape(len(values), -1))).any(axis=1).sum())
           for name, values in found.items()}
    return Recording(part=part.name, index=ref.index, lengths=lengths, notes=notes, stated_timesteps=ref.timesteps,
                     not_finite={name: count for name, count in bad.items() if count}, **(rest | cut))


def _numbers(name: str, values: np.ndarray, where: str) -> np.ndarray:
    """A stream as float64: (T,) for time and gripper, (T, columns) for the rest, T at least 1."""
    values = np.asarray(values)
    axes = 1 if name in ("timestamps", "gripper") else 2
    if values.dtype.kind not in "iuf" or values.ndim != axes or 0 in values.shape:
        raise BadInput(f"{where}: {name} is {values.dtype} {values.shape}; expected real numbers of at least one "
                       f"timestep{' in columns' if axes == 2 else ''}")
    if name == "end_effector" and values.shape[1] != 6:
        raise BadInput(f"{where}: {name} has {values.shape[1]} columns; expected 6: x, y, z, roll, pitch, yaw")
    within("columns", math.prod(values.shape[1:]), f"{where}: {name}")
    return values.astype(np.float64)
