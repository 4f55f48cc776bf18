"""Trained policies: the few that are shipped beside the results, and those that runs left on this machine."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load_file, save_file

from move import paths
from move.errors import BadInput
from move.learn.agents import Agent, PolicyAgent, Recorded
from move.learn.checkpoint import load_policy, read
from move.learn.diffusion import DiffusionPolicy
from move.study.profiles import Profile
from move.study.spec import RunSpec

EPISODES = "episodes.safetensors"  # beside a shipped policy: what it did in some of its evaluation's episodes


def _shipped(spec: RunSpec, profile: Profile) -> Path:
    return paths.results(profile) / "policies" / spec.policy_hash


def _trained_here(spec: RunSpec) -> Path:
    return paths.RUNS / spec.policy_hash / "policy"


def is_there(spec: RunSpec, profile: Profile) -> bool:
    """Whether the policy that the run `spec` evaluated is shipped, or left by a run on this machine."""
    return any((folder / "run.json").exists() for folder in (_shipped(spec, profile), _trained_here(spec)))


def trained_policy(spec: RunSpec, profile: Profile) -> DiffusionPolicy:
    """The policy that the run `spec` evaluated.

    Raises:
        BadInput: it is neither shipped nor left by a run on this machine, or damaged.
    """
    for folder in (_shipped(spec, profile), _trained_here(spec)):
        if (folder / "run.json").exists():
            return load_policy(folder, task=spec.task)
    raise BadInput(f"{spec.label}: its policy is not shipped; delete {paths.results(profile) / spec.hash}.json and "
                   "give `move run` again to train it here")


def acting(spec: RunSpec, profile: Profile) -> Callable[[int], Agent]:
    """Who acts in the evaluation's episode of a number: its policy as it was recorded there, else the policy anew.

    Raises:
        BadInput: the policy is not there, or what was recorded is damaged.
    """
    policy, recorded = trained_policy(spec, profile), recorded_episodes(spec, profile)
    return lambda number: Recorded(recorded[number]) if number in recorded else PolicyAgent(policy, spec.seed)


def recorded_episodes(spec: RunSpec, profile: Profile) -> dict[int, np.ndarray]:
    """Of some episodes of a shipped policy's evaluation, by number, the actions: (steps, action_size) float32.

    Raises:
        BadInput: the file is damaged.
    """
    path = _shipped(spec, profile) / EPISODES
    if not path.exists():
        return {}
    try:
        found = {int(number): actions for number, actions in load_file(path).items()}
    except (SafetensorError, ValueError) as error:
        raise BadInput(f"{path}: damaged; allowed is what tools/record_episodes.py writes") from error
    if not all(actions.ndim == 2 and len(actions) and np.isfinite(actions).all() for actions in found.values()):
        raise BadInput(f"{path}: not actions; allowed is what tools/record_episodes.py writes")
    return found


def record_episodes(spec: RunSpec, profile: Profile, episodes: dict[int, np.ndarray]) -> Path:
    """Write what a shipped policy did in these episodes beside it."""
    path = _shipped(spec, profile) / EPISODES
    save_file({str(number): np.ascontiguousarray(actions, np.float32) for number, actions in episodes.items()}, path)
    return path


def ship(spec: RunSpec, profile: Profile) -> Path:
    """Copy the finished policy of a run on this machine beside the profile's results.

    Raises:
        BadInput: there is none, or its training is unfinished.
    """
    saved = read(_trained_here(spec))
    if saved is None or not saved.finished:
        raise BadInput(f"{spec.label}: no finished policy in {_trained_here(spec)}")
    shutil.copytree(_trained_here(spec), _shipped(spec, profile), dirs_exist_ok=True,
                    ignore=shutil.ignore_patterns("lock", "*.part"))
    return _shipped(spec, profile)
