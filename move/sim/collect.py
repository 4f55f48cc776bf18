"""Demonstrations of a scripted expert by any method, under an exact budget of timesteps.

The budget counts timesteps, not episodes, and the last demonstration is cut where the budget ends. Training makes one
window a timestep, so every method gives the same number of training windows. A demonstration that fails is discarded
and counted; attempt k of a seed starts from the same configuration whatever the method.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import cast

import gymnasium
import numpy as np

from move.errors import BadInput
from move.sim.collection import ANY_HAND, Collection
from move.sim.configuration import SpatialConfiguration, Vector
from move.sim.demonstrations import Demonstrations
from move.sim.experts.phase import Expert, make_expert
from move.sim.grasp_points import grasp_point, hand_near
from move.sim.methods import get_method
from move.sim.motion.adc import jumping_phases
from move.sim.scene.scene import Scene
from move.sim.tasks import Task, get_task
from move.sim.tasks.task import EPISODE_STEPS, SUCCESS_STEPS

STREAM = 1  # first word of every collection seed: no other part of the package draws from it
HAND = 1  # second word of the seed that draws a hand's start, next to what the scene draws from the same attempt
GRASP_TOLERANCE = 0.002  # metres between the prescribed grasp point and where the object stood when grasped
SEEN = 5000  # timesteps of a collection whose configurations its record keeps; more, and nearly all is covered
PATIENCE = 50  # failed attempts in a row after which a collection is given up


@dataclass(frozen=True)
class CollectionRecord:
    """What a collection cost: kept next to the data.

    `mean_steps` is over whole demonstrations, before the last is cut; `generation_rate` is kept over attempted.
    """

    attempts: int
    demonstrations: int
    timesteps: int
    mean_steps: float
    generation_rate: float
    grasp_points: list[tuple[float, float]]  # metres, where kept demonstrations grasped; a kept failure may not have
    seconds: float
    starts: list[SpatialConfiguration]  # of the kept demonstrations, in order
    grasps: list[SpatialConfiguration]  # those that grasped, at the step of the grasp or of the first touch
    jumps: list[int]  # ADC's jumps of object and target in each of the same demonstrations; 0 for the other methods
    seen: list[tuple[str, SpatialConfiguration]]  # phase and configuration of the first `SEEN` timesteps

    def content(self) -> dict:
        """The record as JSON holds it, without `seen`; configurations in columns, to a micrometre and a microradian."""
        stored = {name: value for name, value in vars(self).items() if name != "seen"}
        return {**stored, "starts": _columns(self.starts), "grasps": _columns(self.grasps)}


def _columns(configurations: list[SpatialConfiguration]) -> dict[str, list[float]]:
    rows = [configuration.columns() for configuration in configurations]
    return {name: [round(row[name], 6) for row in rows] for name in (rows[0] if rows else ())}


@dataclass(frozen=True)
class Episode:
    """One attempt: what was observed and done, whether it succeeded, and where everything was when it grasped."""

    observations: list[np.ndarray]
    actions: list[np.ndarray]
    seen: list[tuple[str, SpatialConfiguration]]  # phase and configuration of each observation
    succeeded: bool
    grasp: SpatialConfiguration | None  # None where nothing was grasped, or touched where a touch is enough
    jumps: int = 0  # of object and target, under ADC

    @property
    def start(self) -> SpatialConfiguration:
        """Where everything was at first."""
        return self.seen[0][1]


def collecting_env(collection: Collection) -> gymnasium.Env:
    """The scene of a collection with what its method moves around it; see `surrounded`."""
    scene = Scene(collection.scene_task, collection.observation, collection.image_size, drawing=collection.drawing)
    return surrounded(scene, collection)


def surrounded(scene: Scene, collection: Collection) -> gymnasium.Env:
    """`scene` with what the collection's method moves around it.

    Raises:
        BadInput: a mixture, whose parts have an environment each.
    """
    wrap = get_method(collection.method).wrap
    if wrap is None:
        raise BadInput(f"method: {collection.method!r} given; allowed here is each of its parts")
    return wrap(scene, collection)


def attempt_seed(seed: int, attempt: int) -> int:
    """The scene's seed for one attempt of a collection."""
    return int(np.random.SeedSequence([STREAM, seed, attempt]).generate_state(1)[0])


def demonstrate(env: gymnasium.Env, expert: Expert, seed: int, options: dict) -> Episode:
    """Let `expert` try the task once: at most 200 steps, ended by the tenth successful one."""
    scene = cast(Scene, env.unwrapped)
    observation, _ = env.reset(seed=seed, options=options)
    expert.reset()
    observations: list[np.ndarray] = []
    actions: list[np.ndarray] = []
    seen: list[tuple[str, SpatialConfiguration]] = []
    successes = 0
    grasp: SpatialConfiguration | None = None
    while len(actions) < EPISODE_STEPS and successes < SUCCESS_STEPS:
        observations.append(observation)
        seen.append((scene.phase, scene.configuration))
        actions.append(expert.action(scene))
        observation, _, _, _, info = env.step(actions[-1])
        successes += info["success"]
        if grasp is None and info["phase"] == "place":
            grasp = scene.configuration
    return Episode(observations, actions, seen, successes >= SUCCESS_STEPS, grasp, info.get("jumps", 0))


def attempts(collection: Collection, seed: int, env: gymnasium.Env | None = None) -> Iterator[Episode]:
    """Endless attempts; one that grasps away from its prescribed point counts as failed.

    So does one without all its jumps, where the collection requires them.

    Args:
        env: `collecting_env(collection)` with more wrapped around it, for a caller that watches.
    """
    env, task = env or collecting_env(collection), collection.scene_task
    expert = make_expert(collection.expert, task)
    attempt = kept = 0
    while True:
        point = grasp_point(collection.protocol, task, kept, seed, collection.placement)
        options = _start(collection, task, point, attempt_seed(seed, attempt))
        episode = demonstrate(env, expert, attempt_seed(seed, attempt), options)
        if (point is not None and not _grasped_there(episode, point)) or episode.jumps < required_jumps(collection):
            episode = replace(episode, succeeded=False)
        kept += episode.succeeded or collection.keep_failures
        attempt += 1
        yield episode


def required_jumps(collection: Collection) -> int:
    """How many jumps a demonstration must have to be kept."""
    if not collection.jumping.required:
        return 0
    return collection.jumping.times * len(jumping_phases(get_task(collection.task), collection.factors))


def _start(collection: Collection, task: Task, point: Vector | None, seed: int) -> dict:
    """The reset options of an attempt that has to grasp at `point`, or that starts anywhere."""
    if point is None:
        return {"factors": collection.factors}
    rng = np.random.default_rng([seed, HAND])
    anywhere = collection.factors == ANY_HAND
    hand = task.hand_range.sample(rng) if anywhere else hand_near(task, collection.hand_spread, rng)
    return {"configuration": replace(task.fixed, object_position=point, hand_position=hand)}


def _grasped_there(episode: Episode, point: Vector) -> bool:
    if episode.grasp is None:
        return False
    x, y, _ = episode.grasp.object_position
    return bool(np.hypot(x - point[0], y - point[1]) <= GRASP_TOLERANCE)


def collect(
    collection: Collection, seed: int, on_step: Callable[[int, int], None] | None = None,
    env: gymnasium.Env | None = None,
) -> tuple[Demonstrations, CollectionRecord]:
    """Collect demonstrations until the budget is full, or there are as many as the collection wants.

    Of a mixture one part comes behind the other.

    A part is what its method alone would collect with the same seed under that part's budget.

    Args:
        collection: what to collect.
        seed: with the collection it decides every byte.
        on_step: called with (timesteps so far, budget) after each demonstration.
        env: a scene with motions of one's own around it, instead of those of the collection's method.

    Raises:
        BadInput: fifty failed attempts in a row, or one `env` for the parts of a mixture.
    """
    if env and len(collection.parts) > 1:
        raise BadInput("env: one given for a mixture; allowed is one for a collection by a single method")
    started, kept, tried = time.perf_counter(), _Kept(collection.timesteps), 0
    for part in collection.parts:
        kept.end += part.timesteps
        failed_in_a_row = 0
        for episode in attempts(part, seed, env):
            tried += 1
            failed_in_a_row = 0 if episode.succeeded else failed_in_a_row + 1
            if episode.succeeded or collection.keep_failures:
                kept.add(episode)
                if on_step:
                    on_step(kept.ends[-1], collection.timesteps)
            if failed_in_a_row >= PATIENCE:
                raise BadInput(f"{part.task}, {part.method}: {PATIENCE} attempts in a row failed")
            if kept.ends[-1:] == [kept.end] or len(kept.ends) == collection.demonstrations:
                break
    used = kept.ends[-1]
    made = Demonstrations(kept.observations[:used], kept.actions[:used], np.array(kept.ends, np.int64))
    return made, kept.record(tried, time.perf_counter() - started)


class _Kept:
    """Demonstrations end to end in arrays as large as the budget, each copied once.

    The last one before `end`, where the budget of a part ends, is cut there.
    """

    def __init__(self, budget: int) -> None:
        self.budget, self.end, self.steps = budget, 0, 0  # `steps`: before any was cut
        self.ends: list[int] = []
        self.starts: list[SpatialConfiguration] = []
        self.grasps: list[SpatialConfiguration] = []  # a kept failure may have none
        self.jumps: list[int] = []
        self.seen: list[tuple[str, SpatialConfiguration]] = []

    def add(self, episode: Episode) -> None:
        if not self.ends:
            self.observations, self.actions = (np.empty((self.budget, *one.shape), one.dtype)
                                               for one in (episode.observations[0], episode.actions[0]))
        first = self.ends[-1] if self.ends else 0
        place = slice(first, min(first + len(episode.actions), self.end))
        self.observations[place] = episode.observations[: place.stop - place.start]
        self.actions[place] = episode.actions[: place.stop - place.start]
        self.steps += len(episode.actions)
        self.ends.append(place.stop)
        self.starts.append(episode.start)
        self.grasps += [episode.grasp] if episode.grasp else []
        self.jumps.append(episode.jumps)
        self.seen += episode.seen[: min(place.stop, SEEN) - min(place.start, SEEN)]

    def record(self, attempts: int, seconds: float) -> CollectionRecord:
        """What it cost to keep these."""
        return CollectionRecord(
            attempts=attempts,
            demonstrations=len(self.starts),
            timesteps=self.ends[-1],
            mean_steps=self.steps / len(self.starts),
            generation_rate=len(self.starts) / attempts,
            grasp_points=[grasp.object_position[:2] for grasp in self.grasps],
            seconds=seconds,
            starts=self.starts,
            grasps=self.grasps,
            jumps=self.jumps,
            seen=self.seen,
        )


def record_attributes(collection: Collection, seed: int, record: CollectionRecord) -> dict:
    """What is stored next to a data set: how it was made and what it cost."""
    return {"collection": collection.model_dump(), "seed": seed, "record": record.content()}
