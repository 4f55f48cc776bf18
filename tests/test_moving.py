"""`move.moving`: the paper's motions around MuJoCo environments of others, and around a model of every kind of body."""

import math
import re
import warnings
from pathlib import Path

import gymnasium
import mujoco
import numpy as np
import pytest
from gymnasium.spaces import Box as BoxSpace
from shared import refused

import move
from move import paths
from move.errors import BadInput
from move.exchange.export import export
from move.learn import dataset
from move.sim.demonstrations import Demonstrations
from move.sim.motion import equations
from move.sim.motion.wrappers import scene_of
from move.sim.scene.mujoco_scene import lifted, touched

MODEL = """
<mujoco>
  <option timestep="0.005"/>
  <worldbody>
    <geom name="table" type="plane" size="2 2 .1"/>
    <camera name="front" pos="1 0 1" xyaxes="0 1 0 -.7 0 .7"/>
    <body name="cube" pos=".1 .1 .05"><freejoint/><geom type="box" size=".02 .02 .02" mass=".1"/></body>
    <body name="puck" pos="-.1 .1 .02" euler="0 0 30">
      <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/><geom type="cylinder" size=".02 .01"/></body>
    <body name="rail" pos="0 -.2 .02"><joint type="slide" axis="1 0 0"/><geom type="sphere" size=".01"/></body>
    <body name="mark" mocap="true" pos=".2 .2 .3"/>
    <body name="stand" pos="-.2 -.2 0" euler="0 0 90">
      <site name="spot" pos=".1 0 .1"/><body name="board" pos=".05 0 .02"><geom type="box" size=".01 .01 .01"/></body>
      <camera name="side" pos="0 .5 .5"/></body>
    <body name="hand" pos="0 0 .5">
      <joint name="down" type="slide" axis="0 0 1" damping="50"/><geom type="sphere" size=".03"/>
      <body name="finger" pos="0 0 -.05"><geom type="sphere" size=".01"/><site name="tip"/><camera name="wrist"/></body>
    </body>
  </worldbody>
  <actuator><position joint="down" kp="200"/></actuator>
</mujoco>
"""
RANGE = ((-0.3, -0.3), (0.3, 0.3))


class Table(gymnasium.Env):
    """The model above; an observation is where the cube is."""

    action_space = BoxSpace(-1, 1, (1,), np.float32)
    observation_space = BoxSpace(-np.inf, np.inf, (3,), np.float64)

    def __init__(self) -> None:
        self.model = mujoco.MjModel.from_xml_string(MODEL)
        self.data = mujoco.MjData(self.model)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:2] += self.np_random.uniform(-0.05, 0.05, 2)
        mujoco.mj_forward(self.model, self.data)
        self.goal = np.array([0.2, 0.2, 0.3])
        return self.data.body("cube").xpos.copy(), {}

    def step(self, action):
        self.data.ctrl[:] = action
        mujoco.mj_step(self.model, self.data, nstep=5)
        return self.data.body("cube").xpos.copy(), 0.0, False, False, {}


def around(env: gymnasium.Env | None = None, **chosen) -> gymnasium.Env:
    return move.moving(env or Table(), **{"object": "cube", "within": RANGE, **chosen})


def path(env: gymnasium.Env, name: str, steps: int = 40, seed: int | None = 3) -> np.ndarray:
    """Where a body or a site is after the reset and after each of some steps without an action."""
    env.reset(seed=seed)
    seen, action = [], np.zeros(env.action_space.shape, np.float32)
    kind = "site" if name == "spot" else "body"
    for _ in range(steps + 1):
        scene = scene_of(env)
        mujoco.mj_forward(scene.model, scene.data)
        seen.append(getattr(scene.data, kind)(name).xpos.copy())
        env.step(action)
    return np.array(seen)


def test_the_package_has_no_other_name():
    with pytest.raises(AttributeError, match="no attribute 'standing'"):
        move.standing  # noqa: B018


@pytest.mark.parametrize("name", ["cube", "puck", "mark", "board", "spot"])
def test_every_kind_of_body_goes_the_papers_way_and_stays_inside(name):
    env = around(object=name, object_speed=0.1)
    seen = path(env, name)
    motion = env.env
    law = np.array([equations.translate(motion.start.object_position, motion.velocity, min(step, 30), motion.region)
                    for step in range(41)])
    assert np.allclose(seen[:, :2], law[:, :2], atol=1e-4)  # what physics does within a step
    assert np.ptp(seen[:, 0]) > 0.1 and (np.abs(seen[:, :2]) <= 0.3 + 1e-4).all()
    assert np.array_equal(seen, path(env, name)) and not np.array_equal(seen, path(env, name, seed=4))


def test_it_bounces():
    env = around(object_speed=1.0, within=((-0.2, -0.2), (0.2, 0.2)))
    seen = path(env, "cube")[:30, :2]
    ways = np.sign(np.diff(seen, axis=0))
    assert (np.abs(seen) <= 0.2 + 1e-4).all() and (ways == 1).any(axis=0).all() and (ways == -1).any(axis=0).all()


def test_the_cubes_height_is_physics_own_and_what_slides_keeps_its():
    assert path(around(), "cube")[-1, 2] == pytest.approx(0.02, abs=1e-3)  # it began 5 cm above the table
    assert (path(around(object="puck"), "puck")[:, 2] == pytest.approx(0.02))


def test_a_rail_moves_along_itself_alone():
    seen = path(around(object="rail", within=((-0.3, -0.2), (0.3, -0.2)), object_speed=0.1), "rail")
    assert np.ptp(seen[:, 0]) > 0.05 and np.ptp(seen[:, 1:], axis=0).tolist() == [0, 0]
    with pytest.raises(BadInput, match="whose joints do not move it along y"):
        around(object="rail")


def test_an_environment_at_rest_is_itself():
    """With no speed the wrapper changes no bit of what the environment does."""
    bare, still = Table(), around(object_speed=0.0, camera=None)
    assert np.array_equal(path_of(bare), path_of(still))


def path_of(env: gymnasium.Env) -> np.ndarray:
    first, _ = env.reset(seed=3)
    return np.array([first, *(env.step(np.float32([step / 50 - 1]))[0] for step in range(50))])


def test_motions_draw_nothing_from_the_environment():
    env, bare = around(), Table()
    starts = [[one.reset(seed=seed)[0] for seed in (1, None, None)] for one in (env, bare)]
    assert np.array_equal(*starts)
    assert env.np_random is not env.unwrapped.np_random and isinstance(env.unwrapped, Table)


def test_the_target_and_the_environments_goal_move_from_the_grasp_on():
    box = ((-0.3, -0.3, 0.1), (0.3, 0.3, 0.4))
    env = around(target="mark", target_within=box, goal="goal", phase=lambda scene: scene.steps == 10)
    env.reset(seed=0)
    seen = []
    for _ in range(60):
        *_, info = env.step(np.zeros(1, np.float32))
        seen.append((info["phase"], *env.unwrapped.data.body("mark").xpos))
        assert np.allclose(env.unwrapped.goal, seen[-1][1:])
    phases, places = [one[0] for one in seen], np.array([one[1:] for one in seen])
    assert phases == ["pick"] * 9 + ["place"] * 51
    assert np.ptp(places[:10], axis=0).max() == 0 and (np.ptp(places[10:], axis=0) > 0.01).all()
    assert (places >= np.array(box[0]) - 1e-9).all() and (places <= np.array(box[1]) + 1e-9).all()


def test_a_target_near_its_object_stands_still():
    env = around(target="spot", target_within=RANGE, phase=lambda scene: True, freeze_distance=1.0)
    assert np.ptp(path(env, "spot"), axis=0).max() == 0


def test_clearance_is_kept_where_without_it_they_meet():
    def least(clearance: float) -> float:
        env = around(target="spot", target_within=RANGE, object_speed=0.3, clearance=clearance, object_steps=60)
        return min(np.linalg.norm(path(env, "cube", 60, seed)[:, :2] - scene_of(env).point("spot")[:2], axis=1).min()
                   for seed in range(8))

    assert least(0.0) < 0.05 and least(0.1) >= 0.1 - 1e-6


def test_the_object_turns_within_its_range_and_a_start_has_its_own_yaw():
    env = around(yaw_range=(-0.2, 0.2), yaw_speed=0.1, object_speed=0.0)
    env.reset(seed=1)
    yaws = []
    for _ in range(30):
        env.step(np.zeros(1, np.float32))
        matrix = env.unwrapped.data.body("cube").xmat
        yaws.append(math.atan2(matrix[3], matrix[0]))
    assert np.ptp(yaws) > 0.2 and max(np.abs(yaws)) <= 0.2 + 1e-3
    assert yaws[-1] == pytest.approx(scene_of(env).configuration.object_yaw, abs=1e-3)


@pytest.mark.parametrize("camera", ["front", "side"])
def test_a_camera_goes_round_its_axis_and_goes_on_seeing_what_it_saw(camera):
    env = around(camera=camera, camera_speed=0.1, camera_around=(0.1, 0.0), camera_range=(-0.5, 0.5), object_speed=0.0)
    env.reset(seed=0)
    first, angles = None, []
    for _ in range(40):
        data = env.unwrapped.data
        mujoco.mj_forward(env.unwrapped.model, data)
        one, angle = data.camera(camera), scene_of(env).configuration.camera_angle
        back = np.array([[math.cos(angle), math.sin(angle), 0], [-math.sin(angle), math.cos(angle), 0], [0, 0, 1]])
        seen = np.concatenate([back @ (one.xpos - [0.1, 0, 0]), (back @ one.xmat.reshape(3, 3)).ravel()])
        first = seen if first is None else first
        assert np.allclose(seen, first, atol=1e-12)
        angles.append(angle)
        env.step(np.zeros(1, np.float32))
    assert angles[0] == 0 and max(np.abs(angles)) <= 0.5 and np.ptp(angles) > 0.4


def test_what_is_written_into_the_model_is_put_back():
    env = around(object="spot", camera="side", camera_speed=0.1)
    model = env.unwrapped.model
    before = model.site_pos.copy(), model.cam_pos.copy(), model.cam_quat.copy()
    path(env, "spot")
    assert not np.array_equal(model.site_pos, before[0]) and not np.array_equal(model.cam_quat, before[2])
    env.reset(seed=0)
    assert all(map(np.array_equal, (model.site_pos, model.cam_pos, model.cam_quat), before))


@pytest.mark.parametrize("phase, height", [(lifted, 0.1), (touched, 0.43)])
def test_lifting_ends_the_pick_phase_and_so_does_a_touch(phase, height):
    """The cube falls on the table and lies there; then it is held up, or against the finger that ends at 0.44 m."""
    env = around(within=((0.04, 0.04), (0.16, 0.16)), object_speed=0.0, phase=phase)
    env.reset(seed=0)
    phases = [env.step(np.zeros(1, np.float32))[4]["phase"] for _ in range(30)]
    assert set(phases) == {"pick"}
    env.unwrapped.data.qpos[:3] = 0.0, 0.0, height
    assert env.step(np.zeros(1, np.float32))[4]["phase"] == "place"


@pytest.mark.parametrize("chosen, message", [
    ({"object": "ball"}, "object: 'ball' given; allowed are cube, puck, rail, mark, stand, board, hand, .*, spot, tip"),
    ({"object": "site:cube"}, "object: 'site:cube' given; allowed are spot, tip"),
    ({"object": "finger"}, "object: 'finger' given, which 'hand' carries; allowed are .*: cube, puck"),
    ({"object": "tip"}, "object: 'tip' given, which 'finger' carries"),
    ({"object": "hand"}, "whose joints do not move it along x"),
    ({"object": "puck", "yaw_range": (-1.0, 1.0)}, "yaw_range: given with 'puck', which slides"),
    ({"camera": "back"}, "camera: 'back' given; allowed are front, side, wrist"),
    ({"target": "goal", "target_within": RANGE}, "target: 'goal' given; allowed are"),
    ({"target": "mark"}, "target, target_within: one of them given"),
    ({"goal": "goal"}, "goal: 'goal' given without a target"),
    ({"within": 3}, "within: 3 given; allowed are the lowest and the highest corner"),
    ({"within": ((0, 0, 0), (1, 1, 1))}, "within: .* in metres"),
    ({"within": ((0, 0), (math.nan, 1))}, "within: .* in metres"),
    ({"within": ((1, 0), (0, 1))}, "within: range: low .* is above high"),
    ({"clearance": -0.1}, "clearance: -0.1 given; input should be greater"),
    ({"object_steps": 0}, "object_steps: 0 given"),
    ({"camera_range": (0.1, 0.2), "camera": "front"}, "camera_range: .* at most 0 and at least 0"),
    ({"yaw_range": 1.0}, "yaw_range: 1.0 given; allowed are two finite numbers"),
    ({"object_sped": 0.1}, "moving: 'object_sped' given; allowed are object_speed"),
    ({"object_speed": -1.0}, "object_speed: -1.0 given"),
    ({"camera_speed": 0.1}, "camera_speed: given, and no camera moves; allowed with camera"),
    ({"yaw_speed": 0.1}, "yaw_speed: given, and no rotation moves; allowed with yaw_range"),
    ({"object_speed": math.inf}, "object_speed: inf given; input should be a finite number"),
    ({"camera": "front", "camera_around": (math.nan, 0.0)}, "camera_around: .* allowed are two finite numbers"),
    ({"phase": 3}, "phase: 3 given; allowed is a function of the scene"),
    ({"target": "body:cube", "target_within": RANGE}, "target: 'body:cube' given, which is the object's own body"),
    ({"target": "puck", "target_within": RANGE, "clearance": 5.0}, "clearance: 5 given; .* never more than 0.84"),
])
def test_a_choice_without_sense_is_one_clear_line(chosen, message):
    with refused(message):
        around(**chosen)


SLIDES = '<joint name="x" type="slide" axis="1 0 0"/><joint name="y" type="slide" axis="0 1 0"/>'


@pytest.mark.parametrize(("joints", "message"), [
    (SLIDES, ""), (SLIDES.replace("/>", ' range="-.4 .4"/>'), ""), (SLIDES + '<joint type="hinge"/>', ""),
    (SLIDES.replace("/>", ' range="-.1 .4"/>'), "'lid' is to slide from -0.3.* its joint 'x' allows -0.1.* to 0.4"),
    ('<joint type="hinge" axis="0 0 1"/>' + SLIDES, "'lid' given, which a joint turns before others slide it"),
    (SLIDES + '<joint type="hinge" pos=".1 0 0"/>', "about another point than its own"),
])
def test_a_sliding_body_stays_within_its_joints_limits_and_goes_where_it_is_put(monkeypatch, joints, message):
    body = f'<body name="lid" pos="0 0 .2">{joints}<geom type="sphere" size=".01"/></body>'
    monkeypatch.setattr("test_moving.MODEL", MODEL.replace("<worldbody>", f"<worldbody>{body}"))
    if message:
        with refused(message):
            around(object="lid")
        return
    env = around(object="lid", object_speed=0.05)
    env.reset(seed=0)
    scene = scene_of(env)
    for _ in range(10):
        env.step(np.zeros(1, np.float32))
        assert scene.point("lid")[:2] == pytest.approx(scene.configuration.object_position[:2], abs=2e-3)
    assert math.dist(scene.point("lid")[:2], (0, 0)) > 0.02


def test_what_cannot_be_moved_is_one_clear_line():
    with pytest.raises(BadInput, match="env: CartPoleEnv shows no MuJoCo model and data; allowed are"):
        around(gymnasium.make("CartPole-v1"))
    with pytest.raises(BadInput, match="env: str given; allowed are Gymnasium environments"):
        around("Pusher-v5")
    env = around(within=((0.2, 0.2), (0.3, 0.3)))
    with pytest.raises(BadInput, match=r"within: \(0.2, 0.2\) to \(0.3, 0.3\) given, and this episode starts at \(0."):
        env.reset(seed=0)
    env = around(target="mark", target_within=RANGE, goal="gaol")
    with pytest.raises(BadInput, match="goal: 'gaol' given; allowed is an attribute of Table that holds 3 numbers"):
        env.reset(seed=0)
    with pytest.raises(gymnasium.error.ResetNeeded):
        around().step(np.zeros(1, np.float32))


# environments of others -----------------------------------------------------------------------------------------------


@pytest.mark.filterwarnings("ignore")
def test_a_metaworld_task_outside_the_ten_moves_with_its_goal():
    from metaworld.env_dict import ALL_V3_ENVIRONMENTS

    bare = ALL_V3_ENVIRONMENTS["sweep-v3"]()
    bare._set_task_called, bare._freeze_rand_vec = True, False
    env = move.moving(bare, object="obj", within=((-0.3, 0.3), (0.3, 0.9)), target="goal",
                      target_within=((0.3, 0.4), (0.7, 0.8)), goal="_target_pos", camera="corner2",
                      phase=lambda scene: scene.steps > 30)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        seen, angle = path(env, "obj", 60), scene_of(env).configuration.camera_angle
    assert 0.05 < np.ptp(seen[:30, :2], axis=0).max() and angle != 0
    assert not np.allclose(bare._target_pos, env.env.start.target_position)
    assert bare.model.site("goal").pos == pytest.approx(bare._target_pos)
    assert bare.data.site("goal").xpos == pytest.approx(bare._target_pos), "and is seen there"


@pytest.mark.filterwarnings("ignore")
def test_the_how_to_pages_lines_collect_and_export(tmp_path, monkeypatch):
    """With an expert that does nothing, in an environment that says it succeeded: whole episodes, all kept."""
    page = (paths.ROOT / "docs/how-to/put_your_own_scene_in_motion.md").read_text(encoding="utf-8")
    lines = re.findall(r"```python\n(.*?)```", page, flags=re.S)[-1]
    monkeypatch.chdir(tmp_path)
    Path("build").mkdir()

    class Content(gymnasium.Wrapper):
        def step(self, action):
            *rest, info = self.env.step(action)
            return *rest, {**info, "is_success": True}

    env = around(Content(gymnasium.make("Pusher-v5")), object="object", within=((0.1, -0.6), (0.8, 0.3)))
    exec(lines.replace("range(50)", "range(2)"), {
        "env": env, "expert": lambda seen, phase: np.zeros(7), "gymnasium": gymnasium, "np": np, "Path": Path,
        "Demonstrations": Demonstrations, "dataset": dataset, "export": export})
    demonstrations, _ = dataset.load(tmp_path / "build/mine.zarr")
    assert demonstrations.lengths.tolist() == [100, 100] and demonstrations.observations.shape == (200, 23)
    puck = demonstrations.observations[:100, 17:19]  # x and y
    assert 0.02 < np.abs(np.diff(puck[:30], axis=0)).sum() and np.ptp(puck[31:], axis=0).max() < 1e-3
    assert (tmp_path / "build/mine_lerobot/meta/info.json").exists()
