"""The scene: determinism, phases, a camera and keypoints that fit the pictures; every task's is in test_tasks."""

import math
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from shared import needs_gl

from move.errors import BadInput
from move.sim.scene import camera
from move.sim.scene.scene import Scene
from move.sim.tasks import get_task

TASK = get_task("pick-place")


def rollout(scene: Scene, **reset) -> np.ndarray:
    observations = [scene.reset(**reset)[0]]
    rng = np.random.default_rng(0)
    observations += [scene.step(rng.uniform(-1, 1, 4))[0] for _ in range(20)]
    return np.array(observations)


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


@pytest.mark.parametrize("make", [lambda: Scene("juggling"), lambda: Scene(observation="smell"),
                                  lambda: TASK.sample(np.random.default_rng(0), "everything")])
def test_unknown_names_are_refused(make):
    with pytest.raises(BadInput, match="allowed are"):
        make()
