"""What was checked on a data set, and how it came out: one line a check, for a notebook's table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np
import pandas as pd

from move.paper import REAL_SIZES_TIMESTEPS, TABLE6_REAL_MEAN_TIMESTEPS
from move.realworld.dataset import RobotDataSet
from move.realworld.episode import RobotEpisode
from move.realworld.piper import forward_kinematics
from move.realworld.units import outside_limits

OUTCOMES = ("pass", "differs", "fail", "not checked")


@dataclass(frozen=True)
class Check:
    """One check. `differs` is readable data that are not what the paper describes; `fail` is wrong data."""

    name: str
    outcome: str  # one of `OUTCOMES`
    detail: str


def check_dataset(data: RobotDataSet, *, tolerance: float = 0.05) -> list[Check]:
    """Make every check on the episodes that were read.

    Args:
        tolerance: how far, as a share, numbers of the paper may be missed.
    """
    episodes = data.episodes
    return [
        _read(data),
        _finite(episodes),
        _lengths(episodes),
        _frames(episodes),
        _time(episodes),
        _units(data),
        _limits(episodes),
        _kinematics(episodes),
        _assumptions(episodes), *_sizes(data, tolerance), *_mean_lengths(data, tolerance),
    ]


def checks_table(checks: Sequence[Check]) -> pd.DataFrame:
    """The checks as columns `name`, `outcome`, `detail`."""
    return pd.DataFrame([asdict(check) for check in checks], columns=["name", "outcome", "detail"])


def _name(episode: RobotEpisode) -> str:
    return f"{episode.part}/{episode.index}"


def _bad(name: str, bad: Sequence[str], good: str, outcome: str = "fail") -> Check:
    """A check that passes when nothing bad was found."""
    return Check(name, outcome, f"{len(bad)}: {'; '.join(bad[:3])}") if bad else Check(name, "pass", good)


def _read(data: RobotDataSet) -> Check:
    return _bad("every chosen episode can be read", data.unread, f"{len(data.episodes)} episodes")


def _finite(episodes: Sequence[RobotEpisode]) -> Check:
    bad = [
        f"{_name(e)} {field}" for e in episodes
        for field in ("joints", "end_effector", "gripper", "action", "timestamps_s")
        if getattr(e, field) is not None and not np.isfinite(getattr(e, field)).all()
    ]
    return _bad("all values are finite", bad, "joints, poses, grippers, actions, times")


def _lengths(episodes: Sequence[RobotEpisode]) -> Check:
    bad = [f"{_name(e)} {dict(e.lengths)}" for e in episodes if len(set(e.lengths.values())) > 1]
    return _bad("streams of an episode are equally long", bad, "no stream was cut", "differs")


def _frames(episodes: Sequence[RobotEpisode]) -> Check:
    if not any(e.cameras for e in episodes):
        return Check("every timestep has its frames", "not checked", "no camera was recorded, or none could be found")
    bad = []
    for e in episodes:
        for camera, frames in e.cameras.items():
            try:
                bad += [] if len(frames) == e.timesteps else [f"{_name(e)} {camera}: {len(frames)} for {e.timesteps}"]
            except ValueError as error:
                bad.append(str(error))
    cameras = sorted({camera for e in episodes for camera in e.cameras})
    return _bad("every timestep has its frames", bad, f"cameras {', '.join(cameras)}")


def _time(episodes: Sequence[RobotEpisode]) -> Check:
    bad = [_name(e) for e in episodes if e.timesteps > 1 and not (np.diff(e.timestamps_s) > 0).all()]
    rates = [(e.timesteps - 1) / e.timestamps_s[-1] for e in episodes if e.timesteps > 1 and e.timestamps_s[-1] > 0]
    return _bad("time increases", bad,
                f"{np.median(rates):.1f} timesteps a second (median)" if rates else "one step each")


def _units(data: RobotDataSet) -> Check:
    unknown = data.units[data.units["unit"] == "unknown"]
    return _bad("all units are known", [f"{r.part} {r.quantity}: {r.note}" for r in unknown.itertuples()],
                "; ".join(sorted({f"{r.quantity} {r.unit}" for r in data.units.itertuples()})))


def _limits(episodes: Sequence[RobotEpisode]) -> Check:
    name = "joints stay within PIPER's limits"
    judged = [(_name(e), outside_limits(e.joints)) for e in episodes if e.joints is not None]
    if not judged:
        return Check(name, "not checked", "no joints")
    bad = [f"{episode} {100 * share:.0f} % of steps" for episode, share in judged if share > 0]
    return _bad(name, bad, f"{len(judged)} episodes, slack 0.1 rad", "differs")


def _kinematics(episodes: Sequence[RobotEpisode], *, allowed_m: float = 0.02) -> Check:
    """Compare the recorded pose with the pose that the joints give; catches wrong units, frames and tool offsets."""
    name = "recorded pose agrees with PIPER's kinematics"
    gaps = [np.linalg.norm(forward_kinematics(e.joints)[:, :3] - e.end_effector[:, :3], axis=1)
            for e in episodes if e.joints is not None and e.end_effector is not None and e.joints.shape[1] == 6]
    if not gaps:
        return Check(name, "not checked", "needs six joints and a pose")
    gap = float(np.nanmedian(np.concatenate(gaps)))
    detail = f"median distance {100 * gap:.1f} cm" + ("" if gap <= allowed_m else
                                                      ": another frame, a tool offset, another arm, or wrong units")
    return Check(name, "pass" if gap <= allowed_m else "differs", detail)


def _assumptions(episodes: Sequence[RobotEpisode]) -> Check:
    notes = Counter(note for e in episodes for note in e.notes)
    return _bad("nothing had to be assumed", [f"{note} ({count} episodes)" for note, count in notes.items()],
                "everything was recorded", "differs")


def _sizes(data: RobotDataSet, tolerance: float) -> list[Check]:
    """Compare each part's number of timesteps with the paper's 35k and 75k."""
    checks = []
    for row in data.contents.itertuples():
        name = f"{row.part}: size is one of the paper's"
        if np.isnan(row.timesteps):
            checks.append(Check(name, "not checked", "its size is known only when all its episodes are read"))
            continue
        near = min(REAL_SIZES_TIMESTEPS, key=lambda size: abs(size - row.timesteps))
        close = abs(row.timesteps / near - 1) <= tolerance
        checks.append(Check(name, "pass" if close else "differs", f"{row.timesteps:,.0f} timesteps; nearest {near:,}"))
    return checks


def _mean_lengths(data: RobotDataSet, tolerance: float) -> list[Check]:
    """Compare the mean length of each method's demonstrations with the paper's."""
    checks = []
    for method in sorted({episode.method for episode in data.episodes}):
        name = f"{method}: mean length is the paper's"
        lengths = [episode.timesteps for episode in data.episodes if episode.method == method]
        wanted = TABLE6_REAL_MEAN_TIMESTEPS.get(method)
        detail = f"{np.mean(lengths):.1f} timesteps over {len(lengths)} episodes read"
        if wanted is None:
            checks.append(Check(name, "not checked", f"{detail}; the paper gives none for {method!r}"))
        else:
            close = abs(np.mean(lengths) / wanted - 1) <= tolerance
            checks.append(Check(name, "pass" if close else "differs", f"{detail}; paper {wanted}"))
    return checks
