"""What acts in an evaluation: a policy, or one of the controls between which policies are read.

    PolicyAgent    a diffusion policy
    Recorded        one episode of a policy again, action by action
    Nothing         never moves
    Random          acts uniformly at random
    Expert          the ceiling: a scripted expert
    GoalBlind       the floor: the expert, given a wrong target
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import torch

from move.errors import BadInput
from move.learn.diffusion import DiffusionPolicy
from move.sim.experts.phase import make_expert
from move.sim.scene.scene import Scene

AGENT_STREAM = 3  # first word of the seed of a agent's own randomness


class Agent:
    """Whatever acts in an evaluation: a policy or a control."""

    observation_horizon = 0  # how many of the last observations it needs

    def start(self, scenes: list[Scene]) -> None:
        """Begin with all episodes."""

    def act(self, running: list[int], scenes: list[Scene], observations: np.ndarray | None) -> np.ndarray:
        """Actions for the episodes whose numbers are in `running`.

        Args:
            observations: (len(running), observation_horizon, ...), the newest last; None where none are needed.

        Returns:
            (len(running), steps, action_size) float32: all are executed before it is asked again; the scene clips them
            to [-1, 1].
        """
        raise NotImplementedError


class PolicyAgent(Agent):
    """A diffusion policy; an episode's noise does not depend on which others are still running."""

    def __init__(self, policy: DiffusionPolicy, seed: int) -> None:
        self.policy, self.settings = policy, policy.training_settings
        self.observation_horizon = self.settings.observation_horizon
        self.generator = torch.Generator().manual_seed(_agent_seed(seed))

    def start(self, scenes: list[Scene]) -> None:
        """Remember how many episodes there are."""
        self.shape = (len(scenes), self.settings.prediction_horizon, scenes[0].task.action_size)

    def act(self, running: list[int], scenes: list[Scene], observations: np.ndarray | None) -> np.ndarray:
        """Denoise the actions of all running episodes in one batch."""
        assert observations is not None, "a policy has an observation horizon of 1 or more"
        noise = torch.randn(self.shape, generator=self.generator)[running]
        return self.policy.act(observations, noise=noise)


class Recorded(Agent):
    """One episode again: the same on every machine, whereas a policy's rounding differs from processor to processor.

    Args:
        actions: (steps, action_size) float32, as they were executed; after the last one it is repeated.
    """

    def __init__(self, actions: np.ndarray) -> None:
        self.actions = actions

    def act(self, running: list[int], scenes: list[Scene], observations: np.ndarray | None) -> np.ndarray:
        """The action that was executed in each episode's present step."""
        last = len(self.actions) - 1
        return np.stack([self.actions[[min(scenes[number].steps, last)]] for number in running])


class Nothing(Agent):
    """The control that never moves."""

    def act(self, running: list[int], scenes: list[Scene], observations: np.ndarray | None) -> np.ndarray:
        """Zeros."""
        return np.zeros((len(running), 1, scenes[0].task.action_size), np.float32)


class Random(Agent):
    """The control that acts uniformly at random."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(_agent_seed(seed))

    def start(self, scenes: list[Scene]) -> None:
        """Remember how many episodes there are."""
        self.shape = (len(scenes), 1, scenes[0].task.action_size)

    def act(self, running: list[int], scenes: list[Scene], observations: np.ndarray | None) -> np.ndarray:
        """Uniform actions in [-1, 1]."""
        return self.rng.uniform(-1, 1, self.shape).astype(np.float32)[running]


class Expert(Agent):
    """The ceiling: a scripted expert, one for each episode."""

    def __init__(self, name: str) -> None:
        self.name = name

    def start(self, scenes: list[Scene]) -> None:
        """Call one expert for each episode."""
        self.experts = [make_expert(self.name, scene.task) for scene in scenes]

    def act(self, running: list[int], scenes: list[Scene], observations: np.ndarray | None) -> np.ndarray:
        """What the experts would do."""
        return np.stack([self.experts[number].action(scenes[number])[None] for number in running])


class GoalBlind(Expert):
    """The floor: the phase expert, for whom the target is at the middle of its range; scored on the true target.

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

    def act(self, running: list[int], scenes: list[Scene], observations: np.ndarray | None) -> np.ndarray:
        """What the experts would do if the target were in the middle."""
        actions = []
        for number in running:
            with scenes[number].with_target_at(scenes[number].task.target_range.centre):
                actions.append(self.experts[number].action(scenes[number])[None])
        return np.stack(actions)


CONTROLS: dict[str, Callable[[int], Agent]] = {
    "nothing": lambda seed: Nothing(),
    "random": Random,
    "expert": lambda seed: Expert("phase"),
    "goal-blind": lambda seed: GoalBlind(),
}
"""Every agent that is no policy, made from a seed."""


def _agent_seed(seed: int) -> int:
    return int(np.random.SeedSequence([AGENT_STREAM, seed]).generate_state(1)[0])
