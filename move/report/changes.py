"""What a reader changed in a notebook, and where its files go then: never over what is shipped.

The shipped folder is written by `move figure` alone, and only for a notebook that has the profile's own parameters and
runs. What runs in a browser writes under build/, and what was changed there has a folder of its own.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from IPython import get_ipython

from move import paths
from move.experiments import EXPERIMENTS, registry
from move.study.profiles import Profile
from move.study.spec import RunSpec

BY_COMMAND = "MOVE_FIGURE_COMMAND"  # in the environment of the kernels that `move figure` starts

SHOWN: dict[str, dict[str, Any]] = {
    "fig_coverage": {"covered_timesteps": 5000},
    "rollouts": {"seed": 0, "frames": 8, "image_size": 320},
    "fig2_overview": {"task": "pick-place", "rotating_task": "assembly", "timesteps": 2500, "frames": 8,
                      "image_size": 160, "seed": 0},
    "demonstrations": {"tasks": [], "image_size": 320, "shown": "pick-place", "seed": 0},
    "table4_hyperparameters": {"compared": ["laptop", "paper"]},
    "statistics": {"seeds": [1, 2, 3, 5], "deviations": [0.02, 0.04, 0.06, 0.08, 0.1], "rate": 0.4, "draws": 2000},
    "table3_real_robot": {"data": "", "revision": "", "episodes": 20, "size_cap_gb": 2.0, "units_file": "",
                          "sheet": ""},
}
"""Notebooks' parameters that decide no run, with the defaults that their cells have."""

NOTEBOOK_OF = {"fig4_efficiency": "fig4_scaling", "table3_real": "table3_real_robot",
               "fig8_real_setup": "table3_real_robot", "fig8_object_places": "table3_real_robot"}
"""The notebook of each figure that is not called as its notebook is."""


@dataclass(frozen=True)
class Change:
    """How a notebook differs from the profile's own: parameters (value, the profile's), and runs where only they do."""

    notebook: str
    profile: Profile
    parameters: Mapping[str, tuple[Any, Any]] = field(default_factory=dict)
    runs: tuple[str, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.parameters or self.runs)

    def __str__(self) -> str:
        """What a reader of the figure must know."""
        told = ", ".join(f"{name} {_spoken(value)} ({_spoken(own)})" for name, (value, own) in self.parameters.items())
        return f"Not the shipped figure: {told or 'other runs'}" if self else ""

    @property
    def folder(self) -> Path:
        """Where the figures and tables go."""
        if not self:
            return self.profile.figures if by_command() else paths.own_figures(self.profile.name)
        chosen = {name: value for name, (value, _) in self.parameters.items()}
        told = json.dumps([self.profile.name, chosen, self.runs], sort_keys=True)
        return paths.own_figures(f"{self.notebook}-{hashlib.sha256(told.encode()).hexdigest()[:8]}")


def by_command() -> bool:
    """Whether `move figure`, or no notebook at all, is at work here, and not a browser."""
    return get_ipython() is None or BY_COMMAND in os.environ


def own_parameters(notebook: str, profile: Profile) -> dict[str, Any]:
    """The parameters that a notebook has in `profile` unless somebody changes them."""
    decisive = registry.defaults(notebook) if notebook in EXPERIMENTS else {}
    return {**decisive, **SHOWN.get(notebook, {}), **profile.parameters(notebook)}


def change(name: str, profile: Profile, given: Mapping[str, Any] | None = None,
           runs: Iterable[RunSpec] | None = None) -> Change:
    """What is changed in the notebook of figure or notebook `name`.

    Args:
        given: its parameters; those in the kernel if left out.
        runs: what it is drawn from; the profile's if left out.
    """
    notebook = NOTEBOOK_OF.get(name, name)
    given = _in_the_kernel() if given is None else given
    differing = {key: (_plain(given[key]), _plain(own)) for key, own in own_parameters(notebook, profile).items()
                 if key in given and _plain(given[key]) != _plain(own)}
    other = () if differing or runs is None else _other_runs(notebook, profile, runs)
    return Change(notebook, profile, differing, other)


def _other_runs(notebook: str, profile: Profile, runs: Iterable[RunSpec]) -> tuple[str, ...]:
    """The hashes of `runs` where they are not those that the experiment asks for in `profile`."""
    if notebook not in EXPERIMENTS:
        return ()
    hashes = {spec.hash for spec in runs}
    return () if hashes == {spec.hash for spec in registry.specs(notebook, profile)} else tuple(sorted(hashes))


def _in_the_kernel() -> Mapping[str, Any]:
    shell = get_ipython()
    return {} if shell is None else shell.user_ns


def _plain(value: Any) -> Any:
    """As JSON has it: a tuple is a list, and whatever else is its text."""
    return json.loads(json.dumps(value, default=str))


def _spoken(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(map(_spoken, value)) or "none"
    return f"{value:,}" if isinstance(value, int) and not isinstance(value, bool) else str(value) or "none"
