"""The loop of an evaluation: episodes stepped together, the agent asked for all that still run in one batch.

Between two decisions the agent's actions are executed; observations are made only for the timesteps that the next
decision sees, the last `observation_horizon` of them. At the start of an episode the first observation stands for
those before it, as in training.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Container, Sequence
from dataclasses import dataclass

import numpy as np

from move.learn.agents import Agent
from move.sim.configuration import SpatialConfiguration
from move.sim.motion.wrappers import Motion, Motions, with_motions
from move.sim.observe import KEYPOINTS, ObservationSpec
from move.sim.scene.scene import Scene
from move.sim.tasks.task import EPISODE_STEPS, SUCCESS_STEPS, Task

Callback = Callable[[int, Scene], None]
MOTION_STREAM = 4  # first word of the seed of what moves in an evaluation


@dataclass
class Rollout:
    """An episode: its index, its scene, how many steps of it have succeeded, the observations that the agent sees.

    `world` is the scene with what moves around it; the scene itself where nothing does. `window` holds the last
    `observation_horizon` observations.
    """

    index: int
    scene: Scene
    world: Scene | Motion
    window: deque[np.ndarray]
    observation_horizon: int
    successes: int = 0

    @property
    def running(self) -> bool:
        """Whether neither the episode's limit nor the tenth successful step is reached (the authors' rule)."""
        return self.scene.steps < EPISODE_STEPS and self.successes < SUCCESS_STEPS


def roll_out(
    agent: Agent,
    task: Task,
    configurations: Sequence[SpatialConfiguration],
    observation: ObservationSpec,
    indices: Container[int] | None = None,
    on_ended: Callable[[int], None] | None = None,
    callback: Callback | None = None,
    in_motion: str | None = None,
    first_index: int = 0,
) -> list[Rollout]:
    """Roll out one episode in each configuration to its end.

    Args:
        observation: what the agent sees, made only if it needs observations.
        indices: of the configurations that are tried; by default all.
        on_ended: called with the number of episodes that have ended, after each decision.
        callback: called with the index and the scene at the start and after every step.
        in_motion: a key of FACTORS: what moves while the agent acts, as in MOVE's demonstrations; by default nothing.
        first_index: the first configuration's in the whole list, on which an episode's motions depend; the episodes
            before it have ended.
    """
    seen = observation if agent.observation_horizon else KEYPOINTS
    scenes = [Scene(task, seen.kind, seen.image_size, drawing=seen.drawing) for _ in configurations]
    worlds = [scene if in_motion is None else with_motions(scene, Motions(), in_motion) for scene in scenes]
    rollouts = []
    for index, configuration in enumerate(configurations, first_index):
        if indices is not None and index not in indices:
            continue
        seed = int(np.random.SeedSequence([MOTION_STREAM, index]).generate_state(1)[0])
        scene, world = scenes[index - first_index], worlds[index - first_index]
        first, _ = world.reset(seed=seed, options={"configuration": configuration})
        window = deque([first] * agent.observation_horizon, maxlen=agent.observation_horizon)
        rollouts.append(Rollout(index, scene, world, window, agent.observation_horizon))
        if callback:
            callback(index, scene)
    agent.start(scenes)
    while running := [rollout for rollout in rollouts if rollout.running]:
        seen_now = np.stack([np.stack(rollout.window) for rollout in running]) if agent.observation_horizon else None
        actions = agent.act([rollout.index - first_index for rollout in running], scenes, seen_now)
        for rollout, chunk in zip(running, actions, strict=True):
            _execute(rollout, chunk, callback)
        if on_ended:
            on_ended(first_index + sum(not rollout.running for rollout in rollouts))
    return rollouts


def _execute(rollout: Rollout, actions: np.ndarray, callback: Callback | None) -> None:
    """Execute one decision, until the episode ends."""
    for left, action in zip(reversed(range(len(actions))), actions, strict=True):
        if not rollout.running:
            break
        rollout.world.advance(action)
        rollout.successes += rollout.scene.success
        if callback:
            callback(rollout.index, rollout.scene)
        if left < rollout.observation_horizon:
            rollout.window.append(rollout.scene.observe())
