"""What a policy sees in an evaluation, what counts as success, and which configurations are tried."""

from types import SimpleNamespace

import numpy as np
import pytest
import recipes
from gymnasium.utils.seeding import np_random

from move.learn.agents import PolicyAgent
from move.learn.evaluate import evaluate
from move.learn.evaluation import Evaluation, starts
from move.learn.train import train
from move.sim.collect import Collection, attempt_seed, collect
from move.sim.scene.scene import Scene
from move.sim.tasks import TASKS, get_task
from move.sim.tasks.task import EPISODE_STEPS, SUCCESS_STEPS

TASK = get_task("pick-place")


class Recorder:
    """An agent that acts by a fixed script and keeps what it was shown."""

    def __init__(self, observation_horizon: int, action_steps: int) -> None:
        self.observation_horizon, self.action_steps, self.shown = observation_horizon, action_steps, []
        self.script = np.random.default_rng(7).uniform(-1, 1, (EPISODE_STEPS + action_steps, 4)).astype(np.float32)

    def start(self, scenes: list[Scene]) -> None:
        self.shown = []

    def act(self, running: list[int], scenes: list[Scene], observations: np.ndarray) -> np.ndarray:
        done = len(self.shown) * self.action_steps
        self.shown.append(observations.copy())
        return np.stack([self.script[done : done + self.action_steps]] * len(running))


def test_policies_of_two_seeds_act_with_other_noise_and_of_one_seed_with_the_same():
    drawn = {}
    for name, seed in (("one", 0), ("again", 0), ("other", 1)):
        policy = SimpleNamespace(training_settings=recipes.keypoints(), act=lambda observations, noise: noise)
        agent, scenes = PolicyAgent(policy, seed), [SimpleNamespace(task=TASK)] * 3
        agent.start(scenes)
        drawn[name] = [agent.act([0, 1, 2], scenes, np.zeros(1)) for _ in range(2)]
    assert all((one == again).all() for one, again in zip(drawn["one"], drawn["again"], strict=True))
    assert not any(np.isin(one, other).any() for one in drawn["one"] for other in drawn["other"])
    first, second = drawn["one"]
    assert not (first == second).any() and not (first[0] == first[1]).any(), "nor twice the same in one evaluation"


# what is seen --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("horizon, action_steps", [(1, 3), (2, 3), (3, 3), (4, 3), (2, 1)])
def test_each_decision_sees_the_newest_timesteps_as_training_windows_do(horizon, action_steps):
    agent, evaluation = Recorder(horizon, action_steps), Evaluation(episodes=2)
    evaluate(agent, TASK, evaluation)
    for episode, trial in enumerate(starts(TASK, evaluation)):
        scene = Scene(TASK, "keypoints")
        first, _ = scene.reset(options={"configuration": trial.configuration})
        frames = [first, *(scene.step(action)[0] for action in agent.script[:EPISODE_STEPS])]
        assert len(np.unique(frames[:60], axis=0)) == 60  # a wrong timestep could not go unnoticed
        for decision, shown in enumerate(agent.shown):
            now = decision * action_steps
            expected = [frames[max(0, now - back)] for back in reversed(range(horizon))]
            assert np.array_equal(shown[episode], expected), f"decision {decision}"


@pytest.mark.parametrize("horizon", [1, 2, 3])
def test_a_policy_of_any_observation_horizon_is_trained_and_evaluated(horizon):
    demonstrations, _ = collect(Collection(task="pick-place", method="static", timesteps=120), seed=0)
    training = recipes.tiny(observation_horizon=horizon, prediction_horizon=horizon + 2)
    policy, _ = train(demonstrations, training, seed=0)
    rows = evaluate(PolicyAgent(policy, 0), TASK, Evaluation(episodes=2))
    assert [row["steps"] for row in rows] == [EPISODE_STEPS] * 2


# success -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("successful, steps", [(0, EPISODE_STEPS), (1, EPISODE_STEPS), (9, EPISODE_STEPS),
                                               (SUCCESS_STEPS, 30 + SUCCESS_STEPS), (50, 30 + SUCCESS_STEPS)])
def test_one_successful_step_is_a_success_and_the_tenth_ends_the_episode(monkeypatch, successful, steps):
    """Steps 31 to 30 + `successful` of an episode succeed, whatever the agent does."""
    real = Scene.advance

    def advance(scene: Scene, action: np.ndarray) -> None:
        real(scene, action)
        scene.success = 30 < scene.steps <= 30 + successful

    monkeypatch.setattr(Scene, "advance", advance)
    (row,) = evaluate(Recorder(1, 3), TASK, Evaluation(episodes=1))
    assert row["success"] is (successful > 0)
    assert row["success_steps"] == min(successful, SUCCESS_STEPS) and row["steps"] == steps


# which configurations ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", TASKS)
def test_no_training_of_any_seed_starts_where_policies_are_tried(name):
    task = get_task(name)
    tried = {trial.configuration for trial in starts(task, Evaluation(episodes=100))}
    started = set()
    for seed in range(5):
        for attempt in range(250):  # more than any budget holds
            rng, _ = np_random(attempt_seed(seed, attempt))
            started.add(task.sample(rng, "all"))
    assert len(started) == 5 * 250 and not tried & started


def test_the_starts_compared_above_are_those_of_collections():
    _, record = collect(Collection(task="pick-place", method="static", timesteps=300), seed=3)
    rng, _ = np_random(attempt_seed(3, 0))
    assert record.starts[0] == TASK.sample(rng, "all")
