"""Environments of seven packages in motion: what moves, where it stays, that a seed repeats it, and what it costs."""

import time
from types import SimpleNamespace

import gymnasium
import numpy as np
import pytest
from cases import CASES, Case

from move.sim.motion.wrappers import Motion, scene_of

PATHS = ("object", "put", "target", "angle")  # what a seed repeats
SLACK = 0.01  # metres that physics may add within a step to where a motion put something


class Counted(gymnasium.Wrapper):
    """The environment itself, with the CPU time that its own steps take."""

    seconds = 0.0

    def step(self, action):
        begin = time.thread_time()
        result = self.env.step(action)
        self.seconds += time.thread_time() - begin
        return result


def episode(env: gymnasium.Env, steps: int, seed: int) -> SimpleNamespace:
    """An episode without an action: where object, target and camera are after each step."""
    np.random.seed(seed)  # robosuite and OGBench draw their starts from numpy's global generator
    env.reset(seed=seed)
    scene, seen = scene_of(env), SimpleNamespace(object=[], put=[], target=[], angle=[], phases=[])
    action = np.zeros(env.action_space.shape, env.action_space.dtype)
    for _ in range(steps):
        *_, info = env.step(action)
        seen.object.append(scene.point(scene.task.object).copy())
        seen.put.append((*scene.configuration.object_position, *scene.configuration.target_position))
        seen.target.append(scene.point(scene.task.target_point).copy())
        seen.angle.append(scene.configuration.camera_angle)
        seen.phases.append(info["phase"])
    return SimpleNamespace(**{name: np.array(values) for name, values in vars(seen).items()})


def inside(places: np.ndarray, corners, slack: float) -> bool:
    low, high = np.array(corners)
    return bool((places[:, : len(low)] >= low - slack).all() and (places[:, : len(low)] <= high + slack).all())


@pytest.fixture(scope="module", params=CASES, ids=lambda case: f"{case.package}: {case.name}")
def case(request) -> Case:
    return request.param


@pytest.fixture(scope="module")
def tried(case) -> SimpleNamespace:
    """An episode whose pick phase ends halfway, and the same seed in another environment."""
    half = case.steps // 2
    envs = [case.moving(phase=lambda scene: scene.steps >= half) for _ in range(2)]
    seen = [episode(env, case.steps, seed=3) for env in envs]
    return SimpleNamespace(env=envs[0], half=half, first=seen[0], again=seen[1])


def test_what_was_named_moves_and_stays_inside(case, tried):
    seen, moves = tried.first, case.moves
    picked, placed = seen.object[: tried.half], seen.target[tried.half :]
    assert np.ptp(picked[:, :2], axis=0).max() > 0.02
    assert inside(picked[:30], moves["within"], SLACK) and inside(seen.put, moves["within"], 1e-9)
    if "target" in moves:
        assert np.ptp(seen.put[: tried.half, 3:], axis=0).max() == 0 and np.ptp(placed, axis=0).max() > 0.01
        assert inside(placed, moves["target_within"], SLACK)
    if "camera" in moves:
        assert np.ptp(seen.angle) > np.radians(1) and np.abs(seen.angle).max() <= np.pi / 4


def test_the_same_seed_gives_the_same_path(tried):
    for name in PATHS:
        assert np.array_equal(getattr(tried.first, name), getattr(tried.again, name)), name


def test_it_bounces(case):
    """At a speed that crosses the box in a few steps it goes to and fro, and never out."""
    size = np.subtract(*case.moves["within"][::-1]).max()
    env = case.moving(object_speed=float(2 * size), phase=lambda scene: False)
    put = episode(env, min(30, case.steps), seed=1).put[:, :2]
    ways = np.sign(np.diff(put, axis=0))
    moved = np.ptp(put, axis=0) > 0
    assert inside(put, case.moves["within"], 1e-9)
    assert (ways == 1).any(axis=0)[moved].all() and (ways == -1).any(axis=0)[moved].all() and moved.any()


def test_clearance_holds(case):
    if "target" not in case.moves:
        pytest.skip("nothing is placed here")
    env = case.moving(object_speed=0.2, clearance=0.06, phase=lambda scene: False)
    for seed in range(3):
        put = episode(env, min(30, case.steps), seed).put
        apart = np.hypot(*(put[:, :2] - put[:, 3:5]).T)
        assert apart.min() >= min(0.06, apart[0]) - 1e-9


def test_it_costs_little(case):
    assert cost(case).share <= case.most


def cost(case: Case) -> SimpleNamespace:
    """CPU time of an episode in motion outside the environment's own `step`, as a share of the time inside it.

    Both are measured in one run on this thread's clock, and of each step the least of several equal episodes is taken,
    so other processes hardly count; nor does what the motion makes physics do, such as a collision that the bare
    environment does not have.
    """
    inner = Counted(case.make(case.name))
    env = case.around(inner)
    action = np.zeros(env.action_space.shape, env.action_space.dtype)
    seen = np.empty((case.episodes, case.steps, 2))
    for number in range(case.episodes):
        np.random.seed(0)
        env.reset(seed=0)
        for step in range(case.steps):
            inner.seconds, begin = 0.0, time.thread_time()
            env.step(action)
            seen[number, step] = time.thread_time() - begin - inner.seconds, inner.seconds
    outside, inside = seen.min(axis=0).T
    return SimpleNamespace(share=outside.sum() / inside.sum(), microseconds=1e6 * inside.mean(),
                           moving=1e6 * np.median(outside[:29]), after=1e6 * np.median(outside[30:]))


def test_the_environment_itself_is_reached(tried):
    assert isinstance(tried.env.env, Motion) and not isinstance(tried.env.unwrapped, gymnasium.Wrapper)
