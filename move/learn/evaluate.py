"""Evaluation: fixed configurations, all episodes stepped together, one row an episode.

The configurations of a task and setting are the same for every method and seed, and come from a stream that no
training uses. The policy looks at two timesteps and acts for three, batched over the episodes still running; pictures
are drawn only for the timesteps it looks at.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Container, Sequence
from dataclasses import dataclass, replace
from typing import Literal, Protocol

import numpy as np
import torch
from pydantic import BaseModel, ConfigDict, Field

from move.errors import BadInput
from move.learn.diffusion import DiffusionPolicy
from move.sim.configuration import SpatialConfiguration
from move.sim.experts import Expert as ScriptedExpert
from move.sim.experts import make_expert
from move.sim.protocols import circle_points, sparse_points
from move.sim.scene import EPISODE_STEPS, SUCCESS_STEPS, Scene
from move.sim.task import Task

CONFIGURATION_STREAM = 2  # first word of the seed of the configurations
PLAY_STREAM = 3  # first word of the seed of a player's own randomness
TOGETHER = 160  # episodes stepped together at most


class Evaluation(BaseModel):
    """Which configurations a policy is tried on."""

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid")

    layout: Literal["random", "grid", "own", "grasp"] = Field(
        "random", description="random configurations, a grid over the object, or those of the policy's own "
        'demonstrations: "own" as they began, "grasp" as they were when the object was grasped'
    )
    episodes: int = Field(100, gt=0, description="number of configurations, unless they are a grid")
    grid_side: int = Field(12, gt=0, description="cells along a side of the grid")
    factors: str = Field("all", description="what is random; a grid varies the object alone")
    points: Literal["none", "sparse", "circle"] = Field("none", description="grasp points tried besides a grid")


@dataclass(frozen=True)
class Trial:
    """One configuration to be tried; `group` is "random", "own", "grasp", "grid" or "point"."""

    group: str
    configuration: SpatialConfiguration


def trials(task: Task, evaluation: Evaluation, own: Sequence[SpatialConfiguration] = ()) -> list[Trial]:
    """The fixed list of configurations of a task and setting; for "own" and "grasp" the list that is given.

    >>> from move.sim.tasks import get_task
    >>> len(trials(get_task("pick-place"), Evaluation(layout="grid", points="sparse")))
    153
    """
    if evaluation.layout in ("own", "grasp"):
        return [Trial(evaluation.layout, configuration) for configuration in own]
    if evaluation.layout == "random":
        rng = np.random.default_rng([CONFIGURATION_STREAM, *task.name.encode()])
        return [Trial("random", task.sample(rng, evaluation.factors)) for _ in range(evaluation.episodes)]
    places = {"none": [], "sparse": sparse_points(task), "circle": circle_points(task)}[evaluation.points]
    return [
        Trial(group, replace(task.fixed, object_position=place))
        for group, group_places in (("grid", grid(task, evaluation.grid_side)), ("point", places))
        for place in group_places
    ]


def grid(task: Task, side: int) -> list[tuple[float, float, float]]:
    """Centres of side x side equal cells over the object's range, x slowest (metres)."""
    low, high = task.object_range.low, task.object_range.high
    xs, ys = (low[axis] + (high[axis] - low[axis]) * (np.arange(side) + 0.5) / side for axis in (0, 1))
    return [(float(x), float(y), low[2]) for x in xs for y in ys]


class Player(Protocol):
    """Whatever acts in an evaluation: a policy or a control.

    `action_steps` actions are executed before it is asked again; `looks` says whether it needs observations.
    """

    action_steps: int
    looks: bool

    def start(self, scenes: list[Scene]) -> None:
        """Begin with all episodes."""

    def act(self, running: list[int], scenes: list[Scene], observations: np.ndarray | None) -> np.ndarray:
        """Actions (len(running), action_steps, action_size) for the episodes whose numbers are in `running`."""


class PolicyPlayer:
    """A diffusion policy; an episode's noise does not depend on which others are still running."""

    looks = True

    def __init__(self, policy: DiffusionPolicy, seed: int) -> None:
        self.policy, self.settings = policy, policy.training_settings
        self.action_steps = self.settings.action_horizon
        self.generator = torch.Generator().manual_seed(_play_seed(seed))

    def start(self, scenes: list[Scene]) -> None:
        """Remember how many episodes there are."""
        self.shape = (len(scenes), self.settings.prediction_horizon, scenes[0].action_space.shape[0])

    def act(self, running: list[int], scenes: list[Scene], observations: np.ndarray) -> np.ndarray:
        """Denoise the actions of all running episodes in one batch."""
        noise = torch.randn(self.shape, generator=self.generator)[running]
        return self.policy.act(observations, noise=noise)


class Nothing:
    """The control that never moves."""

    action_steps, looks = 1, False

    def start(self, scenes: list[Scene]) -> None:
        """Nothing to do."""

    def act(self, running: list[int], scenes: list[Scene], observations: None) -> np.ndarray:
        """Zeros."""
        return np.zeros((len(running), 1, scenes[0].action_space.shape[0]), np.float32)


class Random:
    """The control that acts uniformly at random."""

    action_steps, looks = 1, False

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(_play_seed(seed))

    def start(self, scenes: list[Scene]) -> None:
        """Remember how many episodes there are."""
        self.shape = (len(scenes), 1, scenes[0].action_space.shape[0])

    def act(self, running: list[int], scenes: list[Scene], observations: None) -> np.ndarray:
        """Uniform actions in [-1, 1]."""
        return self.rng.uniform(-1, 1, self.shape).astype(np.float32)[running]


class Expert:
    """The ceiling: a scripted expert, one for each episode."""

    action_steps, looks = 1, False

    def __init__(self, name: str) -> None:
        self.name = name

    def start(self, scenes: list[Scene]) -> None:
        """Call one expert for each episode."""
        self.experts = [make_expert(self.name, scene.task) for scene in scenes]

    def act(self, running: list[int], scenes: list[Scene], observations: None) -> np.ndarray:
        """What the experts would do."""
        return np.stack([self.experts[number].action(scenes[number])[None] for number in running])


class GoalBlind(Expert):
    """The floor: the phase expert, told that the target is at the middle of its range; scored on the true target.

    Raises:
        BadInput: a task without a target.
    """

    def __init__(self) -> None:
        super().__init__("phase")

    def start(self, scenes: list[Scene]) -> None:
        """Call one expert for each episode."""
        if not scenes[0].task.has_target:
            raise BadInput(f"goal-blind: {scenes[0].task.name} has no target; allowed are tasks with one")
        super().start(scenes)

    def act(self, running: list[int], scenes: list[Scene], observations: None) -> np.ndarray:
        """What the experts would do if the target were in the middle."""
        return np.stack([self._mistaken(self.experts[number], scenes[number])[None] for number in running])

    @staticmethod
    def _mistaken(expert: ScriptedExpert, scene: Scene) -> np.ndarray:
        with scene.pretending(scene.task.target_range.centre):
            return expert.action(scene)


CONTROLS: dict[str, Callable[[int], Player]] = {
    "nothing": lambda seed: Nothing(),
    "random": Random,
    "expert": lambda seed: Expert("phase"),
    "goal-blind": lambda seed: GoalBlind(),
}
"""Every player that is no policy, made from a seed."""


def _play_seed(seed: int) -> int:
    return int(np.random.SeedSequence([PLAY_STREAM, seed]).generate_state(1)[0])


def evaluate(
    player: Player,
    task: Task,
    evaluation: Evaluation,
    observation: str = "keypoints",
    image_size: int = 96,
    on_step: Callable[[int, int], None] | None = None,
    together: int = TOGETHER,
    own: Sequence[SpatialConfiguration] = (),
    only: Container[int] | None = None,
    watch: Callable[[int, Scene], None] | None = None,
) -> list[dict]:
    """Try `player` once on each configuration: at most 200 steps, ended by the tenth successful one.

    Args:
        on_step: called with (episodes ended, episodes in all).
        together: how many episodes are stepped together.
        own: the configurations of the layouts "own" and "grasp".
        only: numbers of the trials to be tried, the others are left out; by default all.
        watch: called with the trial's number and its scene at the start and after every step.

    Returns:
        One row an episode: trial (number), group, the whole configuration that was tried (as
        `SpatialConfiguration.columns` names it), success (at least one successful step, Meta-World's rule),
        success_steps (10 is the authors' rule for a demonstration), steps; for a task with a strict condition
        strict_success as well.
    """
    listed, rows = trials(task, evaluation, own), []
    for first in range(0, len(listed), together):
        batch = listed[first : first + together]
        chosen = [number for number in range(len(batch)) if only is None or first + number in only]

        def look(number: int, scene: Scene, first: int = first) -> None:
            if watch:
                watch(first + number, scene)

        def ended(episodes: int, first: int = first) -> None:
            if on_step:
                on_step(first + episodes, len(listed))

        played = _play(player, task, batch, chosen, observation, image_size, ended, look)
        rows += [_row(first + number, batch[number], scene, successes) for number, scene, successes in played]
    return rows


def _play(
    player: Player, task: Task, batch: list[Trial], chosen: list[int], observation: str, image_size: int,
    on_ended: Callable[[int], None], watch: Callable[[int, Scene], None],
) -> list[tuple[int, Scene, int]]:
    """Play the `chosen` of a batch to their ends: number, scene and successful steps of each."""
    scenes = [Scene(task, observation if player.looks else "keypoints", image_size) for _ in batch]
    windows: dict[int, list[np.ndarray]] = {}
    for number in chosen:
        seen, _ = scenes[number].reset(options={"configuration": batch[number].configuration})
        windows[number] = [seen, seen]
        watch(number, scenes[number])
    successes, running = [0] * len(batch), chosen
    player.start(scenes)
    while running:
        observations = np.stack([np.stack(windows[number]) for number in running]) if player.looks else None
        for number, actions in zip(running, player.act(running, scenes, observations), strict=True):
            look = functools.partial(watch, number)
            successes[number] += _execute(scenes[number], actions, successes[number], windows[number], player.looks,
                                          look)
        running = [n for n in running if scenes[n].steps < EPISODE_STEPS and successes[n] < SUCCESS_STEPS]
        on_ended(len(chosen) - len(running))
    return [(number, scenes[number], successes[number]) for number in chosen]


def _execute(scene: Scene, actions: np.ndarray, successes: int, window: list[np.ndarray], looks: bool,
             watch: Callable[[Scene], None]) -> int:
    """Execute one decision; keep the last two observations in `window`; return how many steps succeeded."""
    gained = 0
    for index, action in enumerate(actions):
        if scene.steps >= EPISODE_STEPS or successes + gained >= SUCCESS_STEPS:
            break
        scene.advance(action)
        gained += scene.success
        watch(scene)
        if looks and index >= len(actions) - 2:
            window[:] = [window[1], scene.observe()]
    return gained


def _row(number: int, trial: Trial, scene: Scene, successes: int) -> dict:
    row = {"trial": number, "group": trial.group, **trial.configuration.columns(), "success": successes > 0,
           "success_steps": successes, "steps": scene.steps}
    return row | {"strict_success": scene.strict_steps > 0} if scene.task.strict_success else row
