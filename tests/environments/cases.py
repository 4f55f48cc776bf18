"""The environments of other packages that `move.moving` is tried on, and what moves in each."""

from __future__ import annotations

import logging
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import gymnasium

import move

warnings.filterwarnings("ignore")
logging.disable(logging.WARNING)  # robosuite's, about its own settings


def gymnasium_robotics(name: str) -> gymnasium.Env:
    import gymnasium_robotics

    gymnasium.register_envs(gymnasium_robotics)
    return gymnasium.make(name)


def robosuite(name: str) -> gymnasium.Env:
    import robosuite
    from robosuite.wrappers.gym_wrapper import GymWrapper

    return GymWrapper(robosuite.make(name, robots="Panda", has_renderer=False, has_offscreen_renderer=False,
                                     use_camera_obs=False))


def gym_aloha(name: str) -> gymnasium.Env:
    import gym_aloha  # noqa: F401

    return gymnasium.make(name)


def metaworld(name: str) -> gymnasium.Env:
    import metaworld  # noqa: F401

    return gymnasium.make("Meta-World/MT1", env_name=name, seed=0)


def dm_control(name: str) -> gymnasium.Env:
    import shimmy
    from dm_control import manipulation

    if name in manipulation.ALL:
        return shimmy.DmControlCompatibilityV0(manipulation.load(name, seed=0))
    return gymnasium.make(name)


def ogbench(name: str) -> gymnasium.Env:
    import ogbench  # noqa: F401

    return gymnasium.make(name)


@dataclass(frozen=True)
class Case:
    """An environment, how it is made, and what of it moves where."""

    make: Callable[[str], gymnasium.Env]
    name: str
    moves: dict[str, Any]
    steps: int = 100  # of an episode here
    most: float = 0.05  # of the environment's own CPU time that motion may cost: more where a step takes under 0.8 ms
    episodes: int = 4  # in which the cost is measured; gym-aloha draws three pictures a step

    @property
    def package(self) -> str:
        """The package that has the environment."""
        return "gymnasium" if self.make is gymnasium.make else self.make.__name__

    def moving(self, **changes: Any) -> gymnasium.Env:
        """The environment in motion."""
        return self.around(self.make(self.name), **changes)

    def around(self, env: gymnasium.Env, **changes: Any) -> gymnasium.Env:
        """Such an environment, made already, in motion."""
        return move.moving(env, **self.moves | changes)


FETCH = {"object": "object0", "within": ((1.15, 0.55), (1.53, 0.95)), "target": "target0",
         "target_within": ((1.15, 0.55), (1.53, 0.95)), "goal": "goal", "camera": "external_camera_0"}
CASES = (
    Case(gymnasium.make, "Pusher-v5", {
        "object": "object", "within": ((0.1, -0.6), (0.8, 0.3)), "target": "goal",
        "target_within": ((0.1, -0.6), (0.8, 0.3))}, most=0.4),
    Case(gymnasium_robotics, "FetchPickAndPlace-v4", FETCH, steps=50),
    Case(gymnasium_robotics, "FetchPush-v4", FETCH, steps=50),
    Case(robosuite, "Lift", {
        "object": "cube_main", "within": ((-0.15, -0.15), (0.15, 0.15)), "camera": "frontview"}, episodes=2),
    Case(robosuite, "Stack", {
        "object": "cubeA_main", "within": ((-0.2, -0.2), (0.2, 0.2)), "target": "cubeB_main",
        "target_within": ((-0.2, -0.2), (0.2, 0.2)), "camera": "agentview", "yaw_range": (-3.0, 3.0)}, episodes=2),
    Case(gym_aloha, "gym_aloha/AlohaTransferCube-v0", {
        "object": "box", "within": ((-0.05, 0.35), (0.25, 0.65)), "camera": "top"}, steps=16, episodes=2),
    Case(metaworld, "sweep-v3", {
        "object": "obj", "within": ((-0.2, 0.5), (0.2, 0.8)), "target": "goal",
        "target_within": ((0.3, 0.5), (0.7, 0.8)), "goal": "_target_pos", "camera": "corner2"}, most=0.1),
    Case(metaworld, "soccer-v3", {"object": "soccer_ball", "within": ((-0.2, 0.5), (0.2, 0.8)), "camera": "corner2"},
         most=0.1),
    Case(dm_control, "place_brick_features", {
        "object": "duplo2x4/", "within": ((-0.15, -0.15), (0.15, 0.15)), "target": "pedestal/",
        "target_within": ((-0.15, -0.15, 0.05), (0.15, 0.15, 0.2)), "camera": "front_close"}),
    Case(dm_control, "dm_control/manipulator-bring_ball-v0", {
        "object": "ball", "within": ((-0.5, 0.0), (0.5, 0.0)), "target": "target_ball",
        "target_within": ((-0.5, 0.0), (0.5, 0.01))}, most=0.1),
    Case(ogbench, "cube-single-v0", {
        "object": "object_0", "within": ((0.3, -0.25), (0.55, 0.25)), "target": "object_target_0",
        "target_within": ((0.3, -0.25), (0.55, 0.25)), "camera": "front"}),
)
