"""The three kinds of run, each from named settings: what one would write as an axis of a grid.

policy_run      collect, train, evaluate
control_run     evaluate an untrained baseline
collector_run   count attempts to demonstrate
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel

from move.errors import BadInput
from move.learn.evaluation import Evaluation
from move.learn.settings import Training
from move.sim.collection import Collection
from move.sim.methods import get_method
from move.sim.motion.wrappers import SPEEDS, movable
from move.sim.tasks import get_task
from move.study.profiles import Profile
from move.study.spec import CollectionRun, ControlRun, PolicyRun
from move.validation import build


def policy_run(
    profile: Profile, *, task: str, method: str, seed: int, timesteps: int, observation: str = "rgb",
    length: float = 1, **settings: Any,
) -> PolicyRun:
    """A policy: its data by `method`, the profile's recipe for as much data, and how it is tried.

    Args:
        length: gradient steps, as a multiple of the recipe's.
        settings: fields of Collection, Training and Evaluation by their names. `factors` are those of the
            demonstrations and of the evaluation alike.

    Raises:
        BadInput: an unknown setting, or a value that is not allowed.
    """
    _refuse_unknown(settings, Collection, Training, Evaluation)
    recipe = profile.recipe(observation, timesteps)
    changes = _of(Training, settings)
    if length != 1:
        changes = {"gradient_steps": round(length * recipe.gradient_steps), **changes}
    chosen = _chosen(profile, task, method, settings)
    made = {"image_size": profile.image_size, **chosen, **_of(Collection, settings)}
    return build(
        PolicyRun, task=task, seed=seed,
        training=build(Training, **{**recipe.model_dump(), **changes}) if changes else recipe,
        collection=build(Collection, task=task, method=method, timesteps=timesteps, observation=observation, **made),
        evaluation=build(Evaluation, **_of(Evaluation, settings)),
    )


def control_run(*, task: str, agent: str, seed: int = 0, **settings: Any) -> ControlRun:
    """A floor or a ceiling: `agent` does nothing, acts at random, or is the expert; fields of Evaluation besides.

    Raises:
        BadInput: an unknown setting, or a value that is not allowed.
    """
    _refuse_unknown(settings, Evaluation)
    return build(ControlRun, task=task, seed=seed, agent=agent, evaluation=build(Evaluation, **settings))


def collector_run(
    profile: Profile, *, task: str, method: str, attempts: int, seed: int = 0, **settings: Any
) -> CollectionRun:
    """So many attempts to demonstrate, counted; fields of Collection besides.

    Raises:
        BadInput: an unknown setting, or a value that is not allowed.
    """
    _refuse_unknown(settings, Collection)
    made = {**_chosen(profile, task, method, settings), **settings}
    return build(CollectionRun, task=task, seed=seed, evaluation=build(Evaluation, episodes=attempts),
                 collection=build(Collection, task=task, method=method, timesteps=1, **made))


def _chosen(profile: Profile, task: str, method: str, settings: dict[str, Any]) -> dict[str, Any]:
    """What is chosen for a method where the settings choose nothing; for a mixture what is for each of its methods.

    Without the speeds of what does not move in this run.
    """
    chosen = {str(name): settings for name, settings in profile.collection.items()}
    own = chosen.get(method, {})
    shares = {**own, **settings}.get("shares", {})
    methods = shares if isinstance(shares, Mapping) else ()
    found: dict[str, Any] = {}
    for name in (*methods, method):
        found |= {**get_method(name).usual, **chosen.get(name, {})}
    moves = settings.get("moving") or movable(get_task(task), settings.get("factors", "all"))
    still = {field for part, field in SPEEDS.items() if part not in moves}
    return {field: value for field, value in found.items() if field not in still}


def _of(model: type[BaseModel], settings: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in settings.items() if name in model.model_fields}


def _refuse_unknown(settings: dict[str, Any], *models: type[BaseModel]) -> None:
    allowed = [name for model in models for name in model.model_fields]
    if unknown := [name for name in settings if name not in allowed]:
        raise BadInput(f"run: no setting {', '.join(unknown)}; allowed are {', '.join(dict.fromkeys(allowed))}")
