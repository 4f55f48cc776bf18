"""The scene: Gymnasium's rules, determinism, success as in Meta-World, a camera and keypoints that fit the pictures."""

import math
import warnings
from dataclasses import replace

import gymnasium
import mujoco
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from metaworld.env_dict import ALL_V3_ENVIRONMENTS
from metaworld.policies import ENV_POLICY_MAP

from move.errors import BadInput
from move.machine import gl_problem
from move.sim.experts.phase import make_expert
from move.sim.scene import camera
from move.sim.scene.scene import Scene
from move.sim.tasks import FACTORS, get_task

needs_gl = pytest.mark.skipif(gl_problem() is not None, reason="no GL library on this machine")
TASK = get_task("pick-place")


def rollout(scene: Scene, **reset) -> np.ndarray:
    observations = [scene.reset(**reset)[0]]
    rng = np.random.default_rng(0)
    observations += [scene.step(rng.uniform(-1, 1, 4))[0] for _ in range(20)]
    return np.array(observations)


def test_it_passes_gymnasiums_checks():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # keypoints have no natural limits
        check_env(gymnasium.make("MOVE/pick-place-v0").unwrapped, skip_render_check=gl_problem() is not None)


def test_the_registered_scene_ends_after_200_steps():
    env = gymnasium.make("MOVE/pick-place-v0")
    env.reset(seed=0)
    flags = [env.step(np.zeros(4, np.float32))[3] for _ in range(200)]
    assert flags == [False] * 199 + [True]


def test_same_seed_same_trajectory_bit_for_bit():
    first, second = Scene(), Scene()
    assert np.array_equal(rollout(first, seed=7), rollout(second, seed=7))
    assert np.array_equal(rollout(first, seed=7), rollout(second, seed=7))  # nothing is left over from before
    assert not np.array_equal(rollout(first, seed=7), rollout(second, seed=8))


@pytest.mark.parametrize("name", ["pick-place", "assembly"])  # Assembly's gripper turns
def test_an_action_beyond_one_does_what_one_does(name):
    def after(action: float) -> np.ndarray:
        scene = Scene(name)
        scene.reset(seed=0)
        return np.array([scene.step(np.full(scene.task.action_size, action))[0] for _ in range(5)])

    assert np.array_equal(after(7.0), after(1.0)) and np.array_equal(after(-7.0), after(-1.0))
    assert not np.array_equal(after(1.0), after(0.5))


def test_a_used_scene_is_as_good_as_a_new_one():
    used = Scene()
    in_turn = [rollout(used, seed=seed) for seed in (1, 2, 3)]  # no other scene writes into the model in between
    assert np.array_equal(in_turn, [rollout(Scene(), seed=seed) for seed in (1, 2, 3)])


def test_same_configuration_same_trajectory_bit_for_bit():
    configuration = TASK.sample(np.random.default_rng(3))
    options = {"configuration": configuration}
    assert np.array_equal(rollout(Scene(), options=options), rollout(Scene(), options=options, seed=5))


def test_scenes_that_share_a_model_do_not_disturb_each_other():
    options = [{"configuration": TASK.sample(np.random.default_rng(seed))} for seed in (1, 2)]
    alone = [rollout(Scene(), options=option) for option in options]
    scenes, actions = [Scene(), Scene()], np.random.default_rng(0).uniform(-1, 1, (20, 4))
    together = [[scene.reset(options=option)[0]] for scene, option in zip(scenes, options, strict=True)]
    for action in actions:
        for scene, seen in zip(scenes, together, strict=True):
            seen.append(scene.step(action)[0])
    assert np.array_equal(alone, together)


def test_what_is_moved_is_where_it_was_put():
    scene = Scene()
    scene.reset(seed=0)
    scene.move_object((-0.1, 0.55, 0.02), 0.0)
    scene.move_target((0.05, 0.85, 0.25))
    scene.step(np.zeros(4))
    assert scene.point("body:obj") == pytest.approx([-0.1, 0.55, 0.02], abs=2e-3)
    assert scene.point("site:goal") == pytest.approx([0.05, 0.85, 0.25])
    assert scene.configuration.target_position == (0.05, 0.85, 0.25)


def test_hand_reaches_its_start():
    scene = Scene()
    for seed in range(5):
        scene.reset(seed=seed)
        assert scene.hand == pytest.approx(scene.configuration.hand_position, abs=0.01)


class StockReading:
    """Meta-World's own environment, read as a success condition reads a scene."""

    def __init__(self, stock) -> None:
        self.stock = stock

    def point(self, name: str) -> np.ndarray:
        return self.stock._target_pos if name == "target" else self.stock.data.body(name.removeprefix("body:")).xpos


def test_success_agrees_with_metaworld_step_by_step():
    stock, policy = ALL_V3_ENVIRONMENTS["pick-place-v3"](), ENV_POLICY_MAP["pick-place-v3"]()
    stock._set_task_called, stock._freeze_rand_vec, stock._partially_observable = True, False, False
    positives = steps = 0
    for seed in range(4):
        stock.seed(seed)
        observation, _ = stock.reset()
        for _ in range(100):
            observation[36:] = stock._target_pos  # Meta-World clips it to zero
            observation, _, _, _, info = stock.step(np.clip(policy.get_action(observation), -1, 1))
            assert TASK.success(StockReading(stock)) == bool(info["success"])
            positives, steps = positives + int(info["success"]), steps + 1
    assert 20 < positives < steps


def test_success_without_a_touch_does_not_count():
    scene = Scene()
    scene.reset(seed=0)
    scene.move_object(scene.configuration.target_position, 0.0)
    scene.advance(np.zeros(4))
    assert TASK.success(scene) and not scene.success


def test_grasping_ends_the_pick_phase():
    scene, expert = Scene(), make_expert("phase", TASK)
    scene.reset(seed=0)
    phases = []
    for _ in range(80):
        phases.append(scene.phase)
        scene.advance(expert.action(scene))
    assert phases[0] == "pick" and phases[-1] == "place"
    assert phases == sorted(phases)  # once only


def test_keypoints_are_the_points_seen_from_the_camera():
    scene = Scene()
    observation, _ = scene.reset(seed=4)
    seen = observation[scene.keypoint_slices["body:obj"]]
    world = camera.position(scene.configuration.camera_angle) + seen @ camera.axes(scene.configuration.camera_angle)
    assert world == pytest.approx(scene.point("body:obj"), abs=1e-6)
    assert sum(part.stop - part.start for part in scene.keypoint_slices.values()) == len(observation)


def test_camera_axes_are_orthonormal_and_look_at_the_scene():
    for angle in np.linspace(0, np.pi, 7):
        axes = camera.axes(angle)
        assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-12)
        assert np.linalg.det(axes) == pytest.approx(-1.0)  # right, up, forward is a left-handed triple
        towards = np.array(camera.LOOK_AT) - camera.position(angle)
        assert axes[2] == pytest.approx(towards / np.linalg.norm(towards))


@needs_gl
@pytest.mark.parametrize("angle", [0.1, 1.0, 2.0, 3.0])
def test_projection_finds_the_object_in_the_picture(angle):
    scene = Scene(observation="rgb", image_size=96)
    there = replace(TASK.fixed, camera_angle=angle)
    scene.reset(options={"configuration": there})
    with_object = scene.render_image(96).astype(int)
    right, up, forward = camera.to_camera_frame(scene.point("body:obj")[None], angle)[0]
    scale = 48 / math.tan(camera.FIELD_OF_VIEW / 2)
    column, row = 48 + scale * right / forward, 48 - scale * up / forward
    scene.move_object((0.0, 0.6, -1.0), 0.0)
    without = scene.refresh().astype(int)
    rows, columns = np.nonzero(np.abs(with_object - without).sum(-1) > 30)
    assert len(rows) > 4
    assert (columns.mean() + 0.5, rows.mean() + 0.5) == pytest.approx((column, row), abs=1.5)


@needs_gl
@pytest.mark.parametrize("task", ["pick-place", "window-open", "hammer"])
def test_what_is_out_of_view_is_not_drawn_and_no_pixel_changes(task):
    scene, drawn = Scene(task, "rgb", 96), []
    renderer = scene._world.renderer(96)
    boxes, everything = renderer.boxes, renderer._renderer.scene
    for seed in range(20):
        scene.reset(seed=seed)
        scene.step(np.random.default_rng(seed).uniform(-1, 1, scene.action_space.shape))
        renderer.boxes = boxes
        image = scene.render_image(96)
        drawn.append(sum(geom.type != mujoco.mjtGeom.mjGEOM_NONE for geom in everything.geoms[: everything.ngeom]))
        renderer.boxes = None
        assert np.array_equal(image, scene.render_image(96))
    renderer.boxes = boxes
    assert min(drawn) < max(drawn) < everything.ngeom


@needs_gl
def test_pictures_are_the_same_every_time():
    first = Scene(observation="rgb", image_size=48).reset(seed=1)[0]
    assert first.dtype == np.uint8 and first.shape == (48, 48, 3)
    assert np.array_equal(first, Scene(observation="rgb", image_size=48).reset(seed=1)[0])


@pytest.mark.parametrize("factors", FACTORS)
def test_factors_leave_the_rest_fixed(factors):
    drawn = [TASK.sample(np.random.default_rng(seed), factors) for seed in range(5)]
    for part, field in (("object", "object_position"), ("target", "target_position"), ("hand", "hand_position"),
                        ("camera", "camera_angle")):
        values = {getattr(configuration, field) for configuration in drawn}
        assert (len(values) == 5) == (part in FACTORS[factors])


@pytest.mark.parametrize("make", [lambda: Scene("juggling"), lambda: Scene(observation="smell"),
                                  lambda: TASK.sample(np.random.default_rng(0), "everything")])
def test_unknown_names_are_refused(make):
    with pytest.raises(BadInput, match="allowed are"):
        make()
