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
from move.sim.motion.wrappers import Motion, Motions, with_motions
from move.sim.scene.scene import EPISODE_STEPS, SUCCESS_STEPS, Scene
from move.sim.tasks.task import Task

Watch = Callable[[int, Scene], None]
MOTION_STREAM = 4  # first word of the seed of what moves in an evaluation


@dataclass
class Played:
    """An episode: its number, its scene, how many steps of it have succeeded, the observations that the agent sees.

    `world` is the scene with what moves around it; the scene itself where nothing does.
    """

    number: int
    scene: Scene
    world: Scene | Motion
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
    in_motion: str | None = None,
    numbers_from: int = 0,
) -> list[Played]:
    """Play one episode in each configuration to its end.

    Args:
        observation: "keypoints" or "rgb", made only if the agent needs observations.
        only: numbers of the configurations that are played; by default all.
        on_ended: called with the number of episodes that have ended, after each decision.
        watch: called with the number and the scene at the start and after every step.
        in_motion: a key of FACTORS: what moves while the agent acts, as in MOVE's demonstrations; by default nothing.
        numbers_from: the number of the first configuration, on which an episode's motions depend.
    """
    seen = observation if player.observation_horizon else "keypoints"
    scenes = [Scene(task, seen, image_size) for _ in configurations]
    worlds = [scene if in_motion is None else with_motions(scene, Motions(), in_motion) for scene in scenes]
    played = []
    for number in range(len(scenes)) if only is None else only:
        seed = int(np.random.SeedSequence([MOTION_STREAM, numbers_from + number]).generate_state(1)[0])
        first, _ = worlds[number].reset(seed=seed, options={"configuration": configurations[number]})
        window = deque([first] * player.observation_horizon, maxlen=player.observation_horizon)
        played.append(Played(number, scenes[number], worlds[number], window))
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
        one.world.advance(action)
        one.successes += one.scene.success
        if watch:
            watch(one.number, one.scene)
        if left < one.window.maxlen:
            one.window.append(one.scene.observe())
