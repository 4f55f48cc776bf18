"""Trained policies: the few that are shipped next to the results, and those that runs left on this machine.

Each is sealed as the policy of its run (`move.study.seals`); one that is not is refused.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load_file, save_file

from move import paths
from move.errors import BadInput
from move.files import written_aside
from move.learn.agents import Agent, PolicyAgent, Recorded
from move.learn.checkpoint import load_policy
from move.learn.diffusion import DiffusionPolicy
from move.study.profiles import Profile
from move.study.results import find
from move.study.seals import refuse_another, seal
from move.study.spec import PolicyRun, RunSpec

EPISODES = "episodes.safetensors"  # next to a shipped policy: what it did in some of its evaluation's episodes
ATLAS = "atlas.safetensors"  # the same at places of figure 1's map, see tools/record_atlas.py


def _shipped(spec: RunSpec, profile: Profile) -> Path:
    return profile.results / "policies" / spec.policy_hash


def folder_of(spec: RunSpec, profile: Profile) -> Path | None:
    """Where the policy of the run `spec` is: shipped, or left by a run on this machine; else None."""
    folders = _shipped(spec, profile), paths.RUNS / spec.policy_hash / "policy"
    return next((folder for folder in folders if (folder / "run.json").exists()), None)


def trained_policy(spec: RunSpec, profile: Profile) -> DiffusionPolicy:
    """The policy that the run `spec` evaluated.

    Raises:
        BadInput: it is neither shipped nor left by a run on this machine, or damaged, or of another run.
    """
    if folder := folder_of(spec, profile):
        refuse_another(spec, folder)
        return load_policy(folder)
    raise BadInput(f"{spec.label}: its policy is not shipped; delete {profile.results / spec.hash}.json and "
                   "give `move run` again to train it here")


def of_run(name: str, profile: Profile) -> tuple[PolicyRun, DiffusionPolicy]:
    """The stored run whose hash is `name`, and its policy, shipped or left under build/ by a run on this machine.

    Raises:
        BadInput: no such run, one without a policy, or one whose weights are not there.
    """
    spec = find(name, [profile.results, profile.own_results]).spec
    if not isinstance(spec, PolicyRun):
        raise BadInput(f"run: {name} given, a {spec.kind}; allowed are runs that trained a policy")
    return spec, trained_policy(spec, profile)


def acting(spec: RunSpec, profile: Profile) -> Callable[[int], Agent]:
    """Who acts in the evaluation's episode of a number: its policy as it was recorded there, else the policy anew.

    Raises:
        BadInput: the policy is not there, or what was recorded is damaged.
    """
    policy, recorded = trained_policy(spec, profile), recorded_episodes(spec, profile)
    return lambda number: Recorded(recorded[number]) if number in recorded else PolicyAgent(policy, spec.seed)


def recorded_episodes(spec: RunSpec, profile: Profile, name: str = EPISODES) -> dict[int, np.ndarray]:
    """Of some episodes of a shipped policy, by number, the actions: (steps, action_size) float32.

    Args:
        name: of the file, `EPISODES` or `ATLAS`.

    Raises:
        BadInput: the file is damaged, or another policy's.
    """
    path = _shipped(spec, profile) / name
    if not path.parent.exists():
        return {}
    refuse_another(spec, path.parent)
    if not path.exists():
        return {}
    try:
        found = {int(number): actions for number, actions in load_file(path).items()}
    except (SafetensorError, ValueError) as error:
        raise BadInput(f"{path}: damaged; allowed is what tools/record_{path.stem}.py writes") from error
    if not all(actions.ndim == 2 and len(actions) and np.isfinite(actions).all() for actions in found.values()):
        raise BadInput(f"{path}: not actions; allowed is what tools/record_{path.stem}.py writes")
    return found


def record_episodes(spec: RunSpec, profile: Profile, episodes: dict[int, np.ndarray], name: str = EPISODES) -> Path:
    """Write what a shipped policy did in these episodes next to it, as the file `name`: `EPISODES` or `ATLAS`."""
    path = _shipped(spec, profile) / name
    with written_aside(path) as beside:
        save_file({str(number): np.ascontiguousarray(actions, np.float32) for number, actions in episodes.items()},
                  beside)
    seal(spec, path.parent)
    return path
