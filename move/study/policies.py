"""Trained policies: the few that are shipped beside the results, and those that runs left on this machine."""

from __future__ import annotations

import shutil
from pathlib import Path

from move import paths
from move.errors import BadInput
from move.learn.checkpoint import load_policy, read
from move.learn.diffusion import DiffusionPolicy
from move.study.profiles import Profile
from move.study.spec import RunSpec


def _shipped(spec: RunSpec, profile: Profile) -> Path:
    return paths.results(profile) / "policies" / spec.policy_hash


def _trained_here(spec: RunSpec) -> Path:
    return paths.RUNS / spec.policy_hash / "policy"


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
