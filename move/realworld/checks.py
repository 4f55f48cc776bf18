"""What was checked on a data set, whatever its layout, and how it came out: one line a check, for a notebook's table.

A check passes on what it has seen alone: where the quantity it needs was not recorded it is `unknown`.
"""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass

import numpy as np
import pandas as pd

from move.errors import BadInput
from move.paper import REAL_SIZES_TIMESTEPS, TABLE6_REAL_MEAN_TIMESTEPS
from move.realworld.dataset import RobotDataSet
from move.realworld.episode import RobotEpisode
from move.realworld.frames import Frames
from move.realworld.piper import forward_kinematics, is_piper, outside_limits

OUTCOMES = ("pass", "differs", "unknown")
TOLERANCE = 0.05  # how far, as a share, a rate or a number of the paper may be missed
ALLOWED_GAP_M = 0.02  # between a recorded pose and that of the joints


@dataclass(frozen=True)
class Check:
    """One check, which passes, differs from what is stated or right, or is unknown for want of a quantity."""

    name: str
    outcome: str  # one of `OUTCOMES`
    detail: str


def check_dataset(data: RobotDataSet) -> list[Check]:
    """Make every check on the episodes that were read."""
    episodes = data.episodes
    return [
        _check("every chosen episode can be read", [*data.unread, *[""] * len(episodes)], f"{len(episodes)} episodes"),
        _check("all values are finite", [_each(e, e.not_finite) for e in episodes],
               ", ".join(sorted({stream for e in episodes for stream in e.lengths}))),
        _check("streams of an episode are equally long", [
            _each(e, e.lengths) if len(set(e.lengths.values())) > 1 else "" for e in episodes if len(e.lengths) > 1],
            "no stream was cut", "one stream alone"),
        _check("episodes are as long as stated", [
            f"{_name(e)} {e.timesteps} timesteps of {e.stated_timesteps}" if e.timesteps != e.stated_timesteps else ""
            for e in episodes if e.stated_timesteps is not None], "timesteps are counted", "no length is stated"),
        _check("timesteps are numbered in order", [_numbering(e) for e in episodes if e.numbering],
               "each belongs to its episode", "timesteps have no numbers"),
        _equal(episodes),
        _check("no chunk of an array is missing", [f"{_name(e)} {', '.join(e.gaps)}" if e.gaps else "" for e in episodes
                                                   if e.gaps is not None], "all are stored", "no layout of chunks"),
        _check("every timestep has its frames", [_frames(e, name, frames) for e in episodes
                                                 for name, frames in e.cameras.items()],
               f"cameras {', '.join(sorted({name for e in episodes for name in e.cameras}))}", "no camera is recorded"),
        _time(episodes),
        _check("the rate is the stated one", [_rate(e) for e in episodes if e.fps and _steps_s(e).size],
               "within 5 %", "no rate is stated, or no time stamps are recorded"),
        _check("streams belong to the same time", [_own_times(e) for e in episodes if e.own_times],
               "within half a timestep", "streams have no time stamps of their own"),
        _units(data),
        _limits(episodes),
        _kinematics(episodes),
        _assumptions(episodes),
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


def _each(episode: RobotEpisode, counts: Mapping[str, int]) -> str:
    """The counts of an episode's streams in words; "" where there are none."""
    told = ", ".join(f"{stream} {count}" for stream, count in counts.items())
    return f"{_name(episode)} {told}" if told else ""


def _numbering(episode: RobotEpisode) -> str:
    """What is wrong with the numbers that an episode's timesteps carry."""
    steps = np.arange(episode.timesteps)
    for name, numbers in episode.numbering.items():
        right = {"episode_index": np.full(len(steps), episode.index), "frame_index": steps}.get(
            name, steps + numbers[:1])
        if not np.array_equal(numbers, right):
            where = int(np.argmax(numbers != right))
            return f"{_name(episode)} {name} {numbers[where]:.0f} at timestep {where}, right is {right[where]:.0f}"
    return ""


def _equal(episodes: Sequence[RobotEpisode]) -> Check:
    """Whether two episodes hold the same numbers; their times and pictures are not looked at."""
    first: dict[str, str] = {}
    findings = []
    for e in episodes:
        streams = [stream for stream in (e.state, e.action, e.joints, e.end_effector, e.gripper) if stream is not None]
        digest = hashlib.sha256(b"".join(np.ascontiguousarray(stream).tobytes() for stream in streams)).hexdigest()
        same = first.setdefault(digest, _name(e))
        findings.append("" if same == _name(e) else f"{_name(e)} equals {same}")
    return _check("no two episodes are equal", findings if len(episodes) > 1 else [], f"{len(episodes)} episodes",
                  "one episode alone")


def _frames(episode: RobotEpisode, camera: str, frames: Frames) -> str:
    """What is wrong with a camera's frames: unreadable, some missing, or stored images that are not one a timestep."""
    name = f"{_name(episode)} {camera}"
    try:
        lacking, stored = int((frames.numbers() < 0).sum()), len(frames)
    except BadInput as error:
        return f"{name}: {error}"
    if lacking:
        return f"{name}: {lacking} of {episode.timesteps} timesteps without a frame"
    one_each = frames.place is not None or stored == episode.timesteps
    return "" if one_each else f"{name}: {stored} images for {episode.timesteps} timesteps"


def _steps_s(episode: RobotEpisode) -> np.ndarray:
    """Time from each timestep to the next, s, where it was recorded and its unit is known."""
    steps = np.diff(episode.timestamps_s) if episode.timestamps is not None else np.empty(0)
    return steps[np.isfinite(steps)]


def _time(episodes: Sequence[RobotEpisode]) -> Check:
    stamped = [(e, np.diff(e.timestamps)) for e in episodes if e.timestamps is not None and e.timesteps > 1]
    rates = [1 / step for e in episodes if _steps_s(e).size and (step := float(np.median(_steps_s(e)))) > 0]
    return _check("time increases", ["" if (steps > 0).all() else _name(e) for e, steps in stamped],
                  f"{np.median(rates):.1f} timesteps a second (median)" if rates else "its unit is unknown",
                  "no time stamps are recorded, or one timestep each")


def _rate(episode: RobotEpisode) -> str:
    step, fps = float(np.median(_steps_s(episode))), episode.fps or 0.0
    return "" if abs(step * fps - 1) <= TOLERANCE else f"{_name(episode)} states {fps:g} Hz, its steps take {step:g} s"


def _own_times(episode: RobotEpisode) -> str:
    """Which streams were read at another time than their timestep's."""
    times = episode.timestamps if episode.timestamps is not None else np.empty(0)
    half = np.median(np.abs(np.diff(times))) / 2 if len(times) > 1 else 0.0
    off = [name for name, own in episode.own_times.items() if not (np.abs(own - times) <= half).all()]
    return f"{_name(episode)} {', '.join(off)}" if off else ""


def _units(data: RobotDataSet) -> Check:
    rows = list(data.units.itertuples())
    return _check("all units are known", [f"{r.part} {r.quantity}: {r.note}" if r.unit == "unknown" else ""
                                          for r in rows],
                  "; ".join(sorted({f"{r.quantity} {r.unit}" for r in rows})), "no quantity with a unit is recorded")


def _limits(episodes: Sequence[RobotEpisode]) -> Check:
    shares = [(_name(e), outside_limits(e.joints)) for e in episodes
              if is_piper(e.robot) and e.joints is not None and e.joints.shape[1] == 6]
    return _check("joints stay within PIPER's limits", [f"{name} {100 * share:.0f} % of steps" if share else ""
                                                        for name, share in shares],
                  f"{len(shares)} episodes, slack 0.1 rad", f"no six joints of a PIPER; {arms(episodes)}")


def arms(episodes: Sequence[RobotEpisode]) -> str:
    """What the data say of the arm, in words."""
    named = sorted({e.robot or "" for e in episodes})
    return f"the arm: {', '.join(name or 'not named' for name in named)}"


def _kinematics(episodes: Sequence[RobotEpisode]) -> Check:
    """Compare the recorded pose with the pose that the joints give; catches wrong units, frames and tool offsets."""
    name = "recorded pose agrees with PIPER's kinematics"
    gaps = [np.linalg.norm(forward_kinematics(e.joints)[:, :3] - e.end_effector[:, :3], axis=1) for e in episodes
            if is_piper(e.robot) and e.joints is not None and e.end_effector is not None and e.joints.shape[1] == 6]
    known = np.concatenate([gap[np.isfinite(gap)] for gap in gaps]) if gaps else np.empty(0)
    if not known.size:
        return Check(name, "unknown", f"needs six joints of a PIPER and a pose; {arms(episodes)}")
    gap = float(np.median(known))
    right = gap <= ALLOWED_GAP_M
    return Check(name, "pass" if right else "differs", f"median distance {100 * gap:.1f} cm"
                 + ("" if right else ": another frame, a tool offset, another arm, or wrong units"))


def _assumptions(episodes: Sequence[RobotEpisode]) -> Check:
    notes = Counter(note for e in episodes for note in e.notes)
    return _check("nothing had to be assumed", [f"{note} ({count} episodes)" for note, count in notes.items()] or [""],
                  "everything was recorded")


def _robot(data: RobotDataSet) -> Check:
    flags = {e.simulated for e in data.episodes}
    if data.simulated:
        return Check("a robot was involved", "differs", "the data say that they are simulated")
    known = None not in flags
    return Check("a robot was involved", "pass" if known else "unknown", "each episode says so" if known else
                 "the data do not say whether they are simulated")


def _sizes(data: RobotDataSet) -> list[Check]:
    """Compare each part's number of timesteps with the paper's 35k and 75k."""
    checks = []
    for row in data.contents.itertuples():
        name = f"{row.part}: size is one of the paper's"
        if np.isnan(row.timesteps):
            checks.append(Check(name, "unknown", "its size is known only when all its episodes are read"))
            continue
        near = min(REAL_SIZES_TIMESTEPS, key=lambda size: abs(size - row.timesteps))
        close = abs(row.timesteps / near - 1) <= TOLERANCE
        checks.append(Check(name, "pass" if close else "differs", f"{row.timesteps:,.0f} timesteps; nearest {near:,}"))
    return checks


def _mean_lengths(data: RobotDataSet) -> list[Check]:
    """Compare the mean length of each method's demonstrations with the paper's."""
    checks = []
    for method in sorted({episode.method for episode in data.episodes}):
        name = f"{method}: mean length is the paper's"
        lengths = [episode.timesteps for episode in data.episodes if episode.method == method]
        wanted = TABLE6_REAL_MEAN_TIMESTEPS.get(method)
        detail = f"{np.mean(lengths):.1f} timesteps over {len(lengths)} episodes read"
        if wanted is None:
            checks.append(Check(name, "unknown", f"{detail}; the paper gives none for {method!r}"))
        else:
            close = abs(np.mean(lengths) / wanted - 1) <= TOLERANCE
            checks.append(Check(name, "pass" if close else "differs", f"{detail}; paper {wanted}"))
    return checks
