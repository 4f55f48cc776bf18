"""One run from its spec to its stored result: collect, train, evaluate."""

from __future__ import annotations

import os
import shutil
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from itertools import islice
from pathlib import Path

import numpy as np
from filelock import FileLock

from move.errors import BadInput
from move.learn.agents import CONTROLS, Agent, PolicyAgent
from move.learn.checkpoint import UnusableCheckpoint
from move.learn.diffusion import DiffusionPolicy
from move.learn.evaluate import evaluate
from move.learn.train import TrainingReport, train
from move.machine import best_device, one_thread
from move.paths import RUNS
from move.sim import coverage
from move.sim.collect import CollectionRecord, attempts, collect
from move.sim.configuration import SpatialConfiguration
from move.sim.motion.adc import Jumping
from move.sim.observe import KEYPOINTS, ObservationSpec
from move.sim.tasks import get_task
from move.study.provenance import provenance, source
from move.study.results import Result, split, store
from move.study.seals import seal
from move.study.spec import RESULTS_VERSION, CollectionRun, ControlRun, PolicyRun, RunSpec

_UNDER_WAY = threading.Lock()  # held by the run of this process

OnProgress = Callable[[str, int, int], None]
"""Called with the part of the run, what is done of it and how much there is."""


def run(
    spec: RunSpec, folder: Path, on_progress: OnProgress | None = None, scratch: Path | None = None
) -> Result:
    """Compute `spec` on one thread and store its result in `folder`; an interrupted training goes on.

    Policies train and act on the GPU where there is one. Checkpoints go to `scratch`, by default build/runs/; runs that
    differ in their evaluation alone share one training there, whose time counts in the result of each. Demonstrations
    are not kept: the spec and the seed make the same ones again.

    Raises:
        BadInput: a spec of another results version; another thread of this process computes a run, whose simulator it
            would share; the scratch or the results folder cannot be written; training diverged.
    """
    if spec.results_version != RESULTS_VERSION:
        raise BadInput(f"results_version: {spec.results_version} given; this source computes {RESULTS_VERSION}")
    source()  # as it is now, and not when the run ends
    with _alone():
        return _run(spec, folder, on_progress, scratch)


@contextmanager
def _alone() -> Iterator[None]:
    """Hold the simulator, of which there is one a process."""
    if not _UNDER_WAY.acquire(blocking=False):
        raise BadInput("run: another run is under way in this process; allowed is one, and others in other processes")
    try:
        yield
    finally:
        _UNDER_WAY.release()


def _run(spec: RunSpec, folder: Path, on_progress: OnProgress | None, scratch: Path | None) -> Result:
    one_thread()
    report = on_progress or (lambda part, done, total: None)
    seconds: dict[str, float] = {}
    collected = trained = None
    match spec:
        case CollectionRun():
            rows = _count_attempts(spec, report, seconds)
        case ControlRun():
            rows = _evaluate(spec, CONTROLS[spec.agent](spec.seed), KEYPOINTS, [], report, seconds)
        case PolicyRun():
            policy, record, training = _learn(spec, report, seconds, scratch or RUNS)
            rows = _evaluate(spec, PolicyAgent(policy, spec.seed), spec.collection.observed, _own(spec, record), report,
                             seconds)
            covered = coverage.covered(record, get_task(spec.task))
            collected, trained = record.content() | {"covered": covered}, asdict(training)
    result = Result(spec, rows, collected, trained, {part: round(value, 2) for part, value in seconds.items()},
                    provenance(draws=spec.observation == "rgb"))
    store(result, folder)
    return result


def _count_attempts(spec: CollectionRun, report: OnProgress, seconds: dict[str, float]) -> list[dict]:
    """One row an attempt to demonstrate: whether it succeeded, its steps, and its jumps where ADC's rule is chosen."""
    started, rows = time.perf_counter(), []
    for number, episode in enumerate(islice(attempts(spec.collection, spec.seed), spec.evaluation.episodes)):
        rows.append({"trial": number, "group": "attempt", "success": episode.succeeded, "steps": len(episode.actions)})
        if spec.collection.jumping != Jumping():  # rows of the default stay what they were
            rows[-1]["jumps"] = episode.jumps
        report("collect", number + 1, spec.evaluation.episodes)
    seconds["collect"] = time.perf_counter() - started
    return rows


def _evaluate(
    spec: PolicyRun | ControlRun, agent: Agent, observation: ObservationSpec, own: list[SpatialConfiguration],
    report: OnProgress, seconds: dict[str, float],
) -> list[dict]:
    started = time.perf_counter()
    rows = evaluate(agent, get_task(spec.task), spec.evaluation, observation, own=own,
                    on_step=lambda done, total: report("evaluate", done, total))
    seconds["evaluate"] = time.perf_counter() - started
    return rows


def _own(spec: PolicyRun, record: CollectionRecord) -> list[SpatialConfiguration]:
    """As many of a policy's own configurations as are tried: the first ones; of a mixture some of each part."""
    own = {"own": record.starts, "grasp": record.grasps}.get(spec.evaluation.starts, [])
    count = spec.evaluation.episodes
    if not spec.collection.shares or len(own) <= count:
        return own[:count]
    return [own[index] for index in np.linspace(0, len(own) - 1, count).round().astype(int)]


def _learn(
    spec: PolicyRun, report: OnProgress, seconds: dict[str, float], scratch: Path
) -> tuple[DiffusionPolicy, CollectionRecord, TrainingReport]:
    started = time.perf_counter()
    demonstrations, record = collect(spec.collection, spec.seed, lambda done, total: report("collect", done, total))
    seconds["collect"] = time.perf_counter() - started

    place = scratch / spec.policy_hash
    checkpoint = place / "policy"

    def go_on() -> tuple[DiffusionPolicy, TrainingReport]:
        return train(demonstrations, spec.training, spec.seed, checkpoint=checkpoint, device=best_device(),
                     task=spec.task, on_step=lambda done, total, loss: report("train", done, total))

    place.mkdir(parents=True, exist_ok=True)
    with FileLock(place / "lock"):  # whoever else tries this policy waits, and finds it trained
        try:
            policy, trained = go_on()
        except UnusableCheckpoint:  # another version's or a damaged one: begin anew
            _set_aside(checkpoint)
            policy, trained = go_on()
        seal(spec, checkpoint)
    seconds["train"] = trained.seconds
    return policy, record, trained


def _set_aside(checkpoint: Path) -> None:
    """Rename a checkpoint that cannot be used; of several the last one is kept."""
    aside = checkpoint.with_name(f"{checkpoint.name}.bad")
    shutil.rmtree(aside, ignore_errors=True)
    checkpoint.rename(aside)


def run_and_report(spec: RunSpec, folder: Path) -> str:
    """`run` for a worker process, unless it is stored already; returns the hash.

    Progress goes to a small file that the parent reads.
    """
    there, _ = split([spec], folder)
    if there:
        return spec.hash
    place = RUNS / spec.hash
    place.mkdir(parents=True, exist_ok=True)
    last = 0.0

    def write(part: str, done: int, total: int) -> None:
        nonlocal last
        if time.monotonic() - last > 0.5 or done == total:
            last = time.monotonic()
            beside = place / f"progress.{os.getpid()}"
            beside.write_text(f"{part} {done} {total}")
            os.replace(beside, place / "progress")

    run(spec, folder, write)
    return spec.hash
