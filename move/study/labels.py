"""Runs that carry labels: which value of which named axis each of them has in its experiment."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import product
from typing import Any

from move.errors import BadInput
from move.learn.evaluation import Evaluation
from move.study.profiles import NoRecipe
from move.study.spec import RunSpec

Label = str | int | float | bool | None
Axis = Iterable[Label] | Mapping[Label, Mapping[str, Any]]


@dataclass(frozen=True)
class LabelledRun:
    """A run and its place in an experiment; the labels become columns of the episodes' table.

    They are neither hashed nor stored: the same run may have other labels in another experiment.
    """

    spec: RunSpec
    labels: Mapping[str, Label] = field(default_factory=dict, hash=False)

    def labelled(self, **labels: Label) -> LabelledRun:
        """The same run with more labels, or others in their place."""
        return LabelledRun(self.spec, {**self.labels, **labels})

    def tried(self, evaluation: Evaluation) -> LabelledRun:
        """The same policy under the same labels, tried on other configurations."""
        return LabelledRun(self.spec.model_copy(update={"evaluation": evaluation}), self.labels)


def grid(base: Callable[..., RunSpec], **axes: Axis) -> list[LabelledRun]:
    """The product of named axes, the last one running fastest, without runs for which the profile has no recipe.

    Args:
        base: makes a run from one value of each axis, given by name; such as a `partial` of those in `kinds`.
        axes: an axis's values; or a mapping from labels to the settings that each stands for.

    Raises:
        BadInput: a value that cannot be a label, or two axes that choose the same setting.

    >>> from functools import partial
    >>> from move.study.kinds import control_run
    >>> runs = grid(partial(control_run, episodes=5), task=["push"], agent=["nothing", "expert"])
    >>> [run.labels["agent"] for run in runs]
    ['nothing', 'expert']
    """
    choices = [[(name, label, settings) for label, settings in _settings(name, axis).items()]
               for name, axis in axes.items()]
    runs = []
    for chosen in product(*choices):
        with suppress(NoRecipe):
            runs.append(LabelledRun(base(**_merged(chosen)), {name: label for name, label, _ in chosen}))
    return runs


def _settings(name: str, axis: Axis) -> dict[Label, Mapping[str, Any]]:
    if isinstance(axis, Mapping):
        choices = list(axis.items())
    else:
        choices = [(value, {name: value}) for value in axis]
    for label, _ in choices:
        if not isinstance(label, Label):
            raise BadInput(f"axis {name}: {label!r} given; allowed are texts and numbers, or a "
                           "mapping from such labels to the settings that they stand for")
    return dict(choices)


def _merged(chosen: Iterable[tuple[str, Label, Mapping[str, Any]]]) -> dict[str, Any]:
    settings: dict[str, Any] = {}
    for name, _, values in chosen:
        if twice := settings.keys() & values.keys():
            raise BadInput(f"axis {name}: chooses {', '.join(sorted(twice))}; allowed is what no other axis chooses")
        settings.update(values)
    return settings


def distinct(runs: Iterable[LabelledRun]) -> list[LabelledRun]:
    """The first of each set of runs with the same hash, in order."""
    found: dict[str, LabelledRun] = {}
    for run in runs:
        found.setdefault(run.spec.hash, run)
    return list(found.values())
