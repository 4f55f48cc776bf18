"""The loop of an evaluation: episodes stepped together, the agent asked for all that still run in one batch.

Between two decisions the agent's actions are executed; observations are made only for the timesteps that the next
decision sees, the last `observation_horizon` of them. At the start of an episode the first observation stands for
those before it, as in training.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from move.learn.agents import Player
from move.sim.configuration import SpatialConfiguration
from move.sim.scene.scene import EPISODE_STEPS, SUCCESS_STEPS, Scene
from move.sim.tasks.task import Task

Watch = Callable[[int, Scene], None]


@dataclass
class Played:
    """An episode: its number, its scene, how many steps of it have succeeded, the observations that the agent sees."""

    number: int
    scene: Scene
    window: deque[np.ndarray]
    successes: int = field(default=0)

    @property
    def running(self) -> bool:
        """Whether neither the episode's limit nor the tenth successful step is reached (the authors' rule)."""
        return self.scene.steps < EPISODE_STEPS and self.successes < SUCCESS_STEPS


def roll_out(
    player: Player,
    task: Task,
    configurations: Sequence[SpatialConfiguration],
    observation: str,
    image_size: int,
    only: Sequence[int] | None = None,
    on_ended: Callable[[int], None] | None = None,
    watch: Watch | None = None,
) -> list[Played]:
    """Play one episode in each configuration to its end.

    Args:
        observation: "keypoints" or "rgb", made only if the agent needs observations.
        only: numbers of the configurations that are played; by default all.
        on_ended: called with the number of episodes that have ended, after each decision.
        watch: called with the number and the scene at the start and after every step.
    """
    seen = observation if player.observation_horizon else "keypoints"
    scenes = [Scene(task, seen, image_size) for _ in configurations]
    played = []
    for number in range(len(scenes)) if only is None else only:
        first, _ = scenes[number].reset(options={"configuration": configurations[number]})
        played.append(Played(number, scenes[number], deque([first] * player.observation_horizon,
                                                           maxlen=player.observation_horizon)))
        if watch:
            watch(number, scenes[number])
    player.start(scenes)
    while running := [one for one in played if one.running]:
        observations = np.stack([np.stack(one.window) for one in running]) if player.observation_horizon else None
        actions = player.act([one.number for one in running], scenes, observations)
        for one, chunk in zip(running, actions, strict=True):
            _execute(one, chunk, watch)
        if on_ended:
            on_ended(sum(not one.running for one in played))
    return played


def _execute(one: Played, actions: np.ndarray, watch: Watch | None) -> None:
    """Execute one decision, until the episode ends."""
    for left, action in zip(reversed(range(len(actions))), actions, strict=True):
        if not one.running:
            break
        one.scene.advance(action)
        one.successes += one.scene.success
        if watch:
            watch(one.number, one.scene)
        if left < one.window.maxlen:
            one.window.append(one.scene.observe())
