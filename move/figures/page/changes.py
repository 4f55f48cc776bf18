"""What a reader changed in a figure, and where its files go then: never over what is shipped.

The shipped folder is written by `move figure` alone, and only for a figure that has the profile's own parameters. What
runs in a browser writes under build/, and what was changed there has a folder of its own.
"""

from __future__ import annotations

import hashlib
import json
import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from move import paths
from move.figures.page.parameters import parameters, with_extras
from move.study.profiles import Profile

BY_COMMAND = "MOVE_FIGURE_COMMAND"  # in the environment of the kernels that `move figure` starts


@dataclass(frozen=True)
class Change:
    """How a figure differs from the profile's own: parameter -> value, the profile's."""

    figure: str
    profile: Profile
    parameters: Mapping[str, tuple[Any, Any]] = field(default_factory=dict)

    def __bool__(self) -> bool:
        return bool(self.parameters)

    def __str__(self) -> str:
        """What a reader of the figure must know."""
        changed = ", ".join(f"{name} {_value_text(value)} ({_value_text(own)})"
                            for name, (value, own) in self.parameters.items())
        return f"Not the shipped figure: {changed}" if self else ""

    @property
    def folder(self) -> Path:
        """Where the figures and tables go."""
        if not self:
            return self.profile.figures if by_command() else paths.own_figures(self.profile.name)
        chosen = {name: value for name, (value, _) in self.parameters.items()}
        settings_text = json.dumps([self.profile.name, chosen], sort_keys=True)
        return paths.own_figures(f"{self.figure}-{hashlib.sha256(settings_text.encode()).hexdigest()[:8]}")


def get_ipython() -> Any:
    """The interactive shell in which this runs, None elsewhere."""
    shells = sys.modules.get("IPython")  # imported wherever there is one
    return shells.get_ipython() if shells else None


def by_command() -> bool:
    """Whether `move figure`, or no notebook at all, is at work here, and not a browser."""
    return get_ipython() is None or BY_COMMAND in os.environ


def change(name: str, profile: Profile, given: Mapping[str, Any]) -> Change:
    """What is changed in figure `name`.

    Args:
        given: its parameters, some or all.
    """
    own = {key: plain(value) for key, value in parameters(name, profile).items()}
    given = with_extras(name, own, {key: plain(value) for key, value in given.items()})
    return Change(name, profile, {key: (plain(value), own[key]) for key, value in given.items()
                                  if key in own and plain(value) != own[key]})


def plain(value: Any) -> Any:
    """As JSON has it: a tuple is a list, and whatever else is its text."""
    return json.loads(json.dumps(value, default=str))


def _value_text(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(map(_value_text, value)) or "none"
    return f"{value:,}" if isinstance(value, int) and not isinstance(value, bool) else str(value) or "none"
