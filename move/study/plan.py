"""What is missing, why, and how long it would take: from stored runs, the profile's estimate, or a measured step."""

from __future__ import annotations

import math
import time
from statistics import median
from typing import Any

import numpy as np

from move.learn.settings import Training
from move.machine import accelerator, best_device, processor
from move.sim.demonstrations import Demonstrations
from move.study.profiles import Profile
from move.study.results import NOT_COMPUTED, Result, split
from move.study.spec import PolicyRun, RunSpec

CONTROL_MINUTES = 0.05
TRIAL_MINUTES = 2.5  # to collect again and try a policy that is there, from pixels
MEASURED_STEPS = 3
SHOWN = 3  # unusable files that are named


def plan_rows(profile: Profile, figures: dict[str, list[RunSpec]]) -> list[dict[str, Any]]:
    """One row a figure: how many runs, how many stored, why the others are missing, and the hours they would take.

    What several figures or runs share, a run or a policy, counts in the first of them. A profile without an estimate of
    its own has a gradient step measured here, which is slow without a GPU.
    """
    rows: list[dict[str, Any]] = []
    runs: set[str] = set()
    policies: set[str] = set()
    minutes: dict[str, float] = {seen: minutes for seen, minutes in profile.minutes.items()}
    for figure, specs in figures.items():
        there, missing = split(specs, profile.results)
        todo = {spec.hash: spec for spec, _ in missing if spec.hash not in runs}
        spent = _minutes_of(list(todo.values()), there, minutes, profile.image_size, policies)
        runs |= set(todo)
        rows.append({
            "figure": figure,
            "runs": len(specs),
            "stored": len(there),
            "missing": len(missing),
            "hours_left": round(spent / 60, 2),
            "why": _why([why for _, why in missing]),
        })
    return rows


def minutes_left(profile: Profile, there: list[Result], missing: list[RunSpec]) -> float:
    """Core-minutes that missing runs of one figure would take; infinite in a profile without an estimate.

    Args:
        there: its stored runs.
    """
    if not profile.minutes and missing:
        return math.inf  # `plan_rows` would measure a step, which takes long itself
    return _minutes_of(missing, there, dict(profile.minutes), profile.image_size, set())


def _minutes_of(todo: list[RunSpec], there: list[Result], minutes: dict[Any, float], image_size: int,
                policies: set[str]) -> float:
    """Core-minutes of some runs; the policies that they train are added to `policies`, and trained once."""
    spent = 0.0
    for spec in todo:
        trained = spec.training is not None and spec.policy_hash in policies
        spent += TRIAL_MINUTES if trained else _minutes(spec, there, minutes, image_size)
        policies.add(spec.policy_hash)
    return spent


def _why(reasons: list[str]) -> str:
    """Why runs are missing: how many are not computed yet, and which files are not usable, the first ones by name."""
    unusable = list(dict.fromkeys(why for why in reasons if why != NOT_COMPUTED))
    parts = [f"{new} {NOT_COMPUTED}"] if (new := reasons.count(NOT_COMPUTED)) else []
    parts += unusable[:SHOWN] + ([f"{len(unusable) - SHOWN} more not usable"] if len(unusable) > SHOWN else [])
    return "; ".join(parts) or "complete"


def plan_title(profile: Profile) -> str:
    """One line on what the hours of `plan_rows` are hours of."""
    if profile.minutes:
        return f"Profile {profile.name}: what `move run` would do (hours, a run at a time on one core)"
    on_gpu = best_device() == "cuda"
    unit = f"GPU-hours of one {accelerator()}" if on_gpu else f"CORE-hours of {processor()}: no GPU here"
    return f"Profile {profile.name}: what `move run` would do ({unit}; gradient steps alone, from a step measured now)"


def _minutes(spec: RunSpec, there: list[Result], minutes: dict[str, float], image_size: int) -> float:
    """Minutes of one run: the median of stored runs like it, or the profile's estimate, or from a measured step."""
    alike = [sum(result.seconds.values()) / 60 for result in there
             if result.spec.observation == spec.observation and result.spec.task == spec.task]
    if alike:
        return median(alike)
    if not isinstance(spec, PolicyRun):
        return CONTROL_MINUTES
    if spec.observation not in minutes:
        seconds = step_seconds(spec.training, _example(spec, image_size))
        minutes[spec.observation] = seconds * spec.training.gradient_steps / 60
    return minutes[spec.observation]


def _example(spec: PolicyRun, image_size: int) -> Demonstrations:
    """As many timesteps as a batch has windows, of the right shapes and no meaning."""
    from move.sim.scene.scene import Scene

    scene, rng = Scene(spec.task, "keypoints"), np.random.default_rng(0)
    steps = spec.training.batch_size
    observations = (rng.integers(256, size=(steps, image_size, image_size, 3), dtype=np.uint8)
                    if spec.observation == "rgb"
                    else rng.normal(size=(steps, *scene.keypoints().shape)).astype(np.float32))
    actions = rng.uniform(-1, 1, (steps, scene.task.action_size)).astype(np.float32)
    return Demonstrations(observations, actions, np.array([steps]))


def step_seconds(training: Training, demonstrations: Demonstrations, steps: int = MEASURED_STEPS) -> float:
    """Seconds of one gradient step on the best device here, the mean of `steps` after one that is not counted."""
    import torch

    from move.learn.train import Trainer

    device = best_device()
    trainer = Trainer(demonstrations, training, 0, device)
    wait = torch.cuda.synchronize if device == "cuda" else lambda: None
    trainer.take_step()
    wait()
    started = time.perf_counter()
    for _ in range(steps):
        trainer.take_step()
    wait()
    return (time.perf_counter() - started) / steps
