"""Success conditions against the authors' own, where these are not Meta-World's; and that a box is closed."""

import math
from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

from move.paper import PAPER_METHODS, PAPER_TASKS
from move.sim.collect import attempt_seed, collecting_env, demonstrate
from move.sim.collection import Collection
from move.sim.experts.phase import make_expert
from move.sim.motion.adc import MENDED
from move.sim.scene.scene import Scene
from move.sim.tasks import get_task
from move.sim.tasks.success import joint_beyond


def on_box(scene):
    lid, box = scene.point("body:top_link"), scene.point("body:boxbody")
    yaw = math.degrees(scene.body_yaw("boxbodytop"))  # Meta-World's pose is 90 degrees
    return abs(lid[2] - 0.076) < 0.04 and math.dist(lid[:2], box[:2]) < 0.02 and abs(abs(yaw) - 90) < 5


def faucet_turned(scene):
    base, yaw = scene.configuration.object_position, scene.configuration.object_yaw
    open_at = (base[0] + 0.215 * math.cos(yaw), base[1] + 0.215 * math.sin(yaw), base[2] + 0.105)
    return math.dist(scene.point("site:handleStartOpen"), open_at) <= 0.07


AUTHORS = {"box-close": on_box, "faucet-open": faucet_turned}
AS_METAWORLD = ("pick-place", "push", "assembly", "hammer", "pick-place-wall", "disassemble", "basketball")
"""Whose rule is Meta-World's own, of which tests/test_tasks.py asks Meta-World itself."""
OTHERWISE = {
    "window-open": "theirs: the handle at most 0.105 m from a point, so the joint beyond 0.1955 m of 0.2; here the "
                   "joint beyond 0.19 m, Meta-World's condition at yaw 0. In effect the same: open",
    "hammer": "their demonstrations also end where the reward exceeds 5; evaluations do not",
    "disassemble": "their height is 0.15 m above where the nut starts, 0.025 m; here it starts at rest, at 0.019 m",
}
"""What remains different, and why."""


def test_every_task_of_the_paper_has_the_authors_rule_or_a_reason():
    assert {*AUTHORS, *AS_METAWORLD, *OTHERWISE} == set(PAPER_TASKS)


@pytest.mark.parametrize("name", AUTHORS)
def test_success_is_the_authors_condition(name):
    task, scene, expert, held = get_task(name), Scene(name), make_expert("phase", get_task(name)), 0
    for seed in range(2):
        scene.reset(seed=seed)
        expert.reset()
        while scene.steps < 180:
            scene.advance(expert.action(scene))
            assert task.success(scene) == AUTHORS[name](scene), f"step {scene.steps}"
            held += task.success(scene)
    assert held >= 10


def test_window_open_is_won_within_six_millimetres_of_where_the_authors_is():
    scene = Scene("window-open")
    scene.reset(seed=0)
    address, won = scene._world.hinge_or_slide("window_slide")[0], {}
    for opened in np.arange(0.15, 0.2, 0.0005):
        scene._data.qpos[address] = opened
        mujoco.mj_forward(scene._model, scene._data)
        there = math.dist(scene.point("body:window+0.2,0,0"), scene.point("site:handleOpenStart"))
        for whose, wins in (("authors", there <= 0.105), ("here", scene.task.success(scene))):
            won.setdefault(whose, opened) if wins else None
    assert 0.189 < won["here"] <= won["authors"] < won["here"] + 0.006


@pytest.mark.parametrize("limit, short, beyond", [(0.09, 0.089, 0.091), (-0.16, -0.159, -0.161), (-0.06, 0.2, -0.07)])
def test_a_joint_is_beyond_its_limit_on_the_side_of_the_limits_sign(limit, short, beyond):
    condition = joint_beyond("joint", limit)
    assert [condition(SimpleNamespace(joint=lambda name, at=at: at)) for at in (0.0, short, limit, beyond)] == [
        False, False, False, True]


@pytest.mark.parametrize("method", PAPER_METHODS)
def test_demonstrations_of_box_close_end_with_the_lid_on_the_box(method):
    collection = Collection(task="box-close", method=method, timesteps=1,
                            **({"jumping": MENDED} if method == "adc" else {}))
    env, expert, closed = collecting_env(collection), make_expert("phase", get_task("box-close")), 0
    for attempt in range(10):
        episode = demonstrate(env, expert, attempt_seed(7, attempt), {"factors": "all"})
        assert episode.succeeded <= on_box(env.unwrapped)
        closed += episode.succeeded
    assert closed >= 9


def test_a_lid_in_the_air_does_not_close_the_box_though_metaworld_says_so():
    scene, expert = Scene("box-close"), make_expert("phase", get_task("box-close"))
    scene.reset(seed=0)
    expert.reset()
    while not scene.recorded["metaworld_success"]:
        scene.advance(expert.action(scene))
    assert scene.point("body:top_link")[2] > 0.116 and not scene.success
