"""What was checked on a data set, whatever its layout, and how it came out: one line a check, for a notebook's table.

A check passes on what it has seen alone: where the quantity it needs was not recorded it is `unknown`.
"""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from move.errors import BadInput
from move.paper import REAL_SIZES_TIMESTEPS, TABLE6_REAL_MEAN_TIMESTEPS
from move.realworld.dataset import RobotDataSet
from move.realworld.episode import RobotEpisode
from move.realworld.piper import forward_kinematics, is_piper, outside_limits
from move.realworld.workspace import length_table

TOLERANCE = 0.05  # how far, as a share, a rate or a number of the paper may be missed
DRIFT = 0.01  # how far, as a share, the time of a whole episode may be from what the stated rate gives
MISSED = 1.5  # steps; where a longer time passes from a timestep to the next, one was not recorded
SAME = 1e-5  # how far, as a share of a column's range, copies of an episode may be from each other
ROUNDED = 1e-5  # and how far besides, in the numbers' own unit
ALLOWED_GAP_M = 0.02  # between a recorded pose and that of the joints


@dataclass(frozen=True)
class Check:
    """One check, which passes, differs from what is stated or right, or is unknown for want of a quantity."""

    name: str
    outcome: str  # "pass", "differs" or "unknown"
    detail: str


def check_dataset(data: RobotDataSet) -> list[Check]:
    """Make every check on the episodes that were read."""
    episodes = data.episodes
    streams = ", ".join(sorted({stream for e in episodes for stream in e.lengths}))
    cameras = [(e, camera) for e in episodes for camera in e.cameras]
    units = list(data.units.itertuples())
    unknown = [_unit(row) for row in units]
    notes = Counter(note for e in episodes for note in e.notes)

    def each(name: str, judge: Callable[[RobotEpisode], str | None], good: str, absent: str = "") -> Check:
        """A check of each episode that `judge` can judge: what is wrong, "", or None."""
        judged = [(e, judge(e)) for e in episodes]
        return _check(name, [wrong and f"{_name(e)} {wrong}" for e, wrong in judged if wrong is not None], good, absent)

    return [
        _check("every chosen episode can be read", [*data.unread, *[""] * len(episodes)], f"{len(episodes)} episodes"),
        each("all values are finite", lambda e: _counted(e.not_finite), streams),
        each("streams of an episode are equally long", _unequal, "no stream was cut", "one stream alone"),
        each("episodes are as long as stated", _length, "timesteps are counted", "no length is stated"),
        _check("everything is of an episode", data.lacking or [""] * (data.lacking is not None),
               "as many as stated, and no more", "no number of episodes is stated"),
        each("timesteps are numbered in order", _numbering, "each belongs to its episode", "timesteps have no numbers"),
        _indices(episodes),
        _equal(episodes),
        each("no chunk of an array is missing", lambda e: None if e.gaps is None else ", ".join(e.gaps),
             "all are stored", "no layout of chunks"),
        _check("every timestep has its frames", [_frames(*camera) for camera in cameras],
               f"cameras {', '.join(sorted({name for _, name in cameras}))}", "no camera is recorded"),
        _time(episodes),
        each("the rate is the stated one", _rate, "within 5 %", "no rate is stated, or no time stamps are recorded"),
        each("streams belong to the same time", _own_times, "within half a timestep",
             "streams have no time stamps of their own"),
        _check("all units are known", unknown, "; ".join(sorted({f"{row.quantity} {row.unit}" for row in units})),
               "no quantity with a unit is recorded"),
        each("joints stay within PIPER's limits", _limits, f"{sum(map(_has_pipers_joints, episodes))} episodes, slack "
             "0.1 rad", f"no six joints of a PIPER; {_arms(episodes)}"),
        _kinematics(episodes),
        _check("nothing had to be assumed", [f"{note} ({count} episodes)" for note, count in notes.items()] or [""],
               "everything was recorded"),
        _robot(data), *_sizes(data), *_mean_lengths(data),
    ]


def checks_table(checks: Sequence[Check]) -> pd.DataFrame:
    """The checks as columns `name`, `outcome`, `detail`."""
    return pd.DataFrame([asdict(check) for check in checks], columns=["name", "outcome", "detail"])


def _check(name: str, findings: Sequence[str], good: str, absent: str = "") -> Check:
    """A check of many things, each with what is wrong with it, or ""; without any of them it is unknown."""
    if not findings:
        return Check(name, "unknown", absent)
    bad = [finding for finding in findings if finding]
    return Check(name, "differs", f"{len(bad)}: {'; '.join(bad[:3])}") if bad else Check(name, "pass", good)


def _name(episode: RobotEpisode) -> str:
    return f"{episode.part}/{episode.index}"


def _counted(counts: Mapping[str, int]) -> str:
    return ", ".join(f"{stream} {count}" for stream, count in counts.items())


def _unit(row: Any) -> str:
    """What is wrong with a unit, a row of `units.units_table`: unknown, or a units file's that does not fit."""
    name = f"{row.part} {row.quantity}"
    if row.unit == "unknown":
        return f"{name}: {row.note}"
    return f"{name}: the units file says {row.unit}; {row.note}" if row.decided_by == "units file" and row.note else ""


def _unequal(episode: RobotEpisode) -> str | None:
    if len(episode.lengths) < 2:
        return None
    return _counted(episode.lengths) if len(set(episode.lengths.values())) > 1 else ""


def _length(episode: RobotEpisode) -> str | None:
    stated = episode.stated_timesteps
    if stated is None or stated == episode.timesteps:
        return None if stated is None else ""
    return f"{episode.timesteps} timesteps of {stated}"


def _numbering(episode: RobotEpisode) -> str | None:
    """What is wrong with the numbers that an episode's timesteps carry."""
    steps = np.arange(episode.timesteps)
    for name, numbers in episode.numbering.items():
        first = {"episode_index": 0, "frame_index": 0}.get(name, numbers[0])
        right = np.full(len(steps), episode.index) if name == "episode_index" else first + steps
        if not np.array_equal(numbers, right):
            where = int(np.argmax(numbers != right))
            return f"{name} {numbers[where]:.0f} at timestep {where}, right is {right[where]:.0f}"
    return "" if episode.numbering else None


def _indices(episodes: Sequence[RobotEpisode]) -> Check:
    """Whether the numbers by which a part counts its timesteps, from its beginning, grow from episode to episode."""
    spans = sorted((e.part, e.index, numbers[0], numbers[-1], _name(e)) for e in episodes
                   if len(numbers := e.numbering.get("index", np.empty(0))))
    return _check("indices count on from episode to episode", [
        f"{name} begins at {first:.0f}, {before} ends at {last:.0f}" if part == same and first <= last else ""
        for (same, _, _, last, before), (part, _, first, _, name) in pairwise(spans)], "none twice, none back",
        "no two have an index")


def _equal(episodes: Sequence[RobotEpisode]) -> Check:
    """Whether two episodes hold the same numbers but for noise, apart from their times, or videos of the same bytes."""
    recorded = [(place, numbers) for place, e in enumerate(episodes) if np.ptp(numbers := _numbers(e), axis=0).any()]
    recorded.sort(key=lambda one: (one[1].shape, one[1].mean()))  # brings equal ones together
    findings = []
    for (place, numbers), (other, others) in pairwise(recorded):
        near = SAME * np.ptp(numbers, axis=0) + ROUNDED
        same = numbers.shape == others.shape and bool((np.abs(numbers - others) <= near).all())
        earlier, later = sorted((place, other))
        findings.append(f"{_name(episodes[later])} equals {_name(episodes[earlier])}" if same else "")
    return _check("no two episodes are equal", [*findings, *_equal_videos(episodes)] if len(episodes) > 1 else [],
                  f"{len(episodes)} episodes", "one episode alone")


def _numbers(episode: RobotEpisode) -> np.ndarray:
    """All numbers that were recorded of an episode's arm, (T, columns); no column where there are none."""
    streams = (episode.state, episode.action, episode.joints, episode.end_effector, episode.gripper)
    return np.hstack([np.empty((episode.timesteps, 0)), *(
        np.nan_to_num(stream, posinf=0.0, neginf=0.0).reshape(episode.timesteps, -1)
        for stream in streams if stream is not None)])


def _equal_videos(episodes: Sequence[RobotEpisode]) -> list[str]:
    """Which files of videos are copies of others; only those of one size are read."""
    files = {path: f"{_name(e)} {camera}" for e in reversed(episodes) for camera, frames in e.cameras.items()
             if (path := Path(frames.source)).is_file()}
    sizes, first, findings = Counter(path.stat().st_size for path in files), dict[bytes, str](), []
    for path, name in reversed(files.items()):
        if sizes[path.stat().st_size] > 1:
            with path.open("rb") as file:
                same = first.setdefault(hashlib.file_digest(file, "sha256").digest(), name)
            findings.append("" if same == name else f"the video {name} equals {same}")
    return findings


def _frames(episode: RobotEpisode, camera: str) -> str:
    """What is wrong with a camera's frames: unreadable, some missing, or stored images that are not one a timestep."""
    name, frames = f"{_name(episode)} {camera}", episode.cameras[camera]
    try:
        lacking, stored = int((frames.numbers() < 0).sum()), len(frames)
    except BadInput as error:
        return f"{name}: {error}"
    if lacking:
        return f"{name}: {lacking} of {episode.timesteps} timesteps without a frame"
    one_each = frames.place is not None or stored == episode.timesteps
    return "" if one_each else f"{name}: {stored} images for {episode.timesteps} timesteps"


def _step_s(episode: RobotEpisode) -> float | None:
    """Median time from a timestep to the next, s, where it was recorded and its unit is known."""
    steps = np.diff(episode.timestamps_s) if episode.timestamps is not None else np.empty(0)
    steps = steps[np.isfinite(steps)]
    return float(np.median(steps)) if steps.size else None


def _time(episodes: Sequence[RobotEpisode]) -> Check:
    stamped = [(e, np.diff(e.timestamps)) for e in episodes if e.timestamps is not None and e.timesteps > 1]
    rates = [1 / step for e in episodes if (step := _step_s(e)) and step > 0]
    return _check("time increases", ["" if (steps > 0).all() else _name(e) for e, steps in stamped],
                  f"{np.median(rates):.1f} timesteps a second (median)" if rates else "its unit is unknown",
                  "no time stamps are recorded, or one timestep each")


def _rate(episode: RobotEpisode) -> str | None:
    step = _step_s(episode)
    if step is None or not episode.fps:
        return None
    steps = np.nan_to_num(np.diff(episode.timestamps_s))
    if min(abs(each * episode.fps - 1) for each in (step, steps.mean())) > TOLERANCE:
        return f"states {episode.fps:g} Hz, its steps take {step:g} s"
    gap = int(steps.argmax())
    if steps[gap:gap + 2].sum() > (MISSED + len(steps[gap + 1:gap + 2])) * step and steps[gap] > MISSED * step:
        return f"lacks {steps[gap] - step:g} s after timestep {gap}"
    drift_s = steps.sum() - len(steps) / episode.fps
    drifts = abs(drift_s) > max(step / 2, DRIFT * len(steps) * step)
    return f"drifts by {drift_s:.2g} s from {episode.fps:g} Hz" if drifts else ""


def _own_times(episode: RobotEpisode) -> str | None:
    """Which streams were read at another time than their timestep's."""
    if not episode.own_times or episode.timestamps is None:
        return None
    half = np.median(np.abs(np.diff(episode.timestamps))) / 2 if episode.timesteps > 1 else 0.0
    return ", ".join(name for name, own in episode.own_times.items()
                     if not (np.abs(own - episode.timestamps[:len(own)]) <= half).all())


def _has_pipers_joints(episode: RobotEpisode) -> bool:
    return is_piper(episode.robot) and episode.joints is not None and episode.joints.shape[1] == 6


def _limits(episode: RobotEpisode) -> str | None:
    if episode.joints is None or not _has_pipers_joints(episode):
        return None
    share = outside_limits(episode.joints)
    return f"{100 * share:.0f} % of steps" if share else ""


def _arms(episodes: Sequence[RobotEpisode]) -> str:
    """What the data say of the arm, in words."""
    named = sorted({e.robot or "" for e in episodes})
    return f"the arm: {', '.join(name or 'not named' for name in named)}"


def _kinematics(episodes: Sequence[RobotEpisode]) -> Check:
    """Compare the recorded pose with the pose that the joints give; catches wrong units, frames and tool offsets."""
    name = "recorded pose agrees with PIPER's kinematics"
    gaps = [np.linalg.norm(forward_kinematics(e.joints)[:, :3] - e.end_effector[:, :3], axis=1) for e in episodes
            if _has_pipers_joints(e) and e.joints is not None and e.end_effector is not None]
    known = np.concatenate([gap[np.isfinite(gap)] for gap in gaps]) if gaps else np.empty(0)
    if not known.size:
        return Check(name, "unknown", f"needs six joints of a PIPER and a pose; {_arms(episodes)}")
    gap_m = float(np.median(known))
    if gap_m <= ALLOWED_GAP_M:
        return Check(name, "pass", f"median distance {100 * gap_m:.1f} cm")
    return Check(name, "differs", f"median distance {100 * gap_m:.1f} cm: another frame, a tool offset, another arm, "
                 "or wrong units")


def _robot(data: RobotDataSet) -> Check:
    if data.simulated:
        return Check("a robot was involved", "differs", "the data say that they are simulated")
    if None in {e.simulated for e in data.episodes}:
        return Check("a robot was involved", "unknown", "the data do not say whether they are simulated")
    return Check("a robot was involved", "pass", "each episode says so")


def _sizes(data: RobotDataSet) -> list[Check]:
    """Compare each part's number of timesteps with the paper's 35k and 75k."""
    checks = []
    for row in data.contents.itertuples():
        name, steps = f"{row.part}: size is one of the paper's", row.timesteps
        near = min(REAL_SIZES_TIMESTEPS, key=lambda size: abs(size - steps))
        checks.append(Check(name, "unknown", "its size is known only when all its episodes are read")
                      if np.isnan(steps) else _near(name, steps, near, f"{steps:,.0f} timesteps; nearest {near:,}"))
    return checks


def _mean_lengths(data: RobotDataSet) -> list[Check]:
    """Compare the mean length of each method's demonstrations with the paper's."""
    checks = []
    for row in length_table(data.episodes).itertuples():
        name, wanted = f"{row.method}: mean length is the paper's", TABLE6_REAL_MEAN_TIMESTEPS.get(row.method)
        detail = f"{row.mean_timesteps:.1f} timesteps over {row.episodes} episodes read"
        checks.append(Check(name, "unknown", f"{detail}; the paper gives none for {row.method!r}") if wanted is None
                      else _near(name, row.mean_timesteps, wanted, f"{detail}; paper {wanted}"))
    return checks


def _near(name: str, number: float, wanted: float, detail: str) -> Check:
    """Whether a number is the paper's."""
    return Check(name, "pass" if abs(number / wanted - 1) <= TOLERANCE else "differs", detail)
