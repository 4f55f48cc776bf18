"""The scenes as Gymnasium makes them: they move, its checkers and vector environments accept them, refusals are short.

RecordVideo needs moviepy and the last test stable-baselines3, both outside environment.lock (the extra `gymnasium`
and a package of its own).
"""

import copy
import math
import pickle
import subprocess
import sys
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from shared import needs_gl, refused

from move import paths
from move.errors import BadInput
from move.machine import gl_problem
from move.sim.scene.scene import Scene
from move.sim.tasks import FACTORS, TASKS

OBSERVATIONS = ["keypoints", pytest.param("rgb", marks=needs_gl)]
PARTS = {"object": "object_position", "rotation": "object_yaw", "target": "target_position", "camera": "camera_angle"}
STILL = np.zeros(4, np.float32)


def make(task: str = "pick-place", **choices) -> gymnasium.Env:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # keypoints have no natural limits
        return gymnasium.make(f"MOVE/{task}-v0", **choices)


def moved(env: gymnasium.Env, steps: int = 20, **reset) -> dict[str, float]:
    """How far each part is from where it began, after steps without an action."""
    env.reset(seed=1, **reset)
    scene = env.unwrapped
    before = scene.configuration
    for _ in range(steps):
        env.step(np.zeros(env.action_space.shape, np.float32))
    return {part: float(np.linalg.norm(np.subtract(getattr(scene.configuration, field), getattr(before, field))))
            for part, field in PARTS.items()}


def test_it_moves_as_moves_demonstrations_do():
    assert {part for part, far in moved(make()).items() if far} == {"object", "camera"}  # the target: from the grasp on
    assert {part for part, far in moved(make("assembly")).items() if far} == {"object", "rotation", "camera"}


@pytest.mark.parametrize("choices, parts", [
    ({"method": "static"}, set()),
    ({"moving": ["camera"]}, {"camera"}),
    ({"moving": ("object", "target")}, {"object"}),
    ({"factors": "object"}, {"object"}),
])
def test_only_what_is_chosen_moves(choices, parts):
    assert {part for part, far in moved(make(**choices)).items() if far} == parts


@pytest.mark.parametrize("speed, part, task", [
    ("object_speed", "object", "pick-place"), ("camera_speed", "camera", "pick-place"),
    ("yaw_speed", "rotation", "assembly")])
def test_a_part_goes_as_fast_as_is_chosen(speed, part, task):
    slow, fast = (moved(make(task, **{speed: value}), steps=1)[part] for value in (0.005, 0.05))
    assert fast == pytest.approx(10 * slow) and 0 < slow < 0.005


def test_under_the_constant_law_an_episode_goes_at_the_laws_mean():
    env = make(speed_law="constant")
    assert moved(env, steps=1)["object"] == pytest.approx(0.03 * 2 / 7)


def test_the_target_goes_as_fast_as_is_chosen_once_the_object_is_grasped():
    def far(**choice) -> float:
        env = make(**choice)
        env.reset(seed=1)
        scene = env.unwrapped
        scene.phase = "place"
        before = scene.configuration.target_position
        env.step(STILL)
        return math.dist(before, scene.configuration.target_position)

    assert far(target_speed=0.001) == pytest.approx(far() / 30) and far() > 0


def test_with_adc_the_object_jumps_as_the_hand_comes_near():
    env = make(method="adc")
    _, info = env.reset(seed=1)
    scene, seen = env.unwrapped, [info["jumps"]]
    for _ in range(60):
        down = np.clip((scene.point("body:obj") - scene.hand) / 0.01, -1, 1)
        seen.append(env.step(np.float32([*down, -1]))[4]["jumps"])
    assert seen[0] == 0 and seen[-1] == 1


@pytest.mark.parametrize("factors", FACTORS)
def test_a_reset_draws_the_factors_that_were_chosen(factors):
    env, fields = make(factors=factors), {"object": "object_position", "target": "target_position",
                                          "hand": "hand_position", "camera": "camera_angle"}
    drawn = [env.reset(seed=seed) and env.unwrapped.configuration for seed in (1, 2)]
    assert {name for name, field in fields.items()
            if getattr(drawn[0], field) != getattr(drawn[1], field)} == FACTORS[factors]


@pytest.mark.parametrize("method", ["move", "adc"])
def test_an_episode_is_truncated_after_200_steps(method):
    env = make(method=method)
    env.reset(seed=0)
    assert [env.step(STILL)[3] for _ in range(200)] == [False] * 199 + [True]


@pytest.mark.parametrize("observation", OBSERVATIONS)
@pytest.mark.parametrize("method", ["static", "adc", "move"])
def test_it_passes_gymnasiums_checks(method, observation):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", message=".*(infinity|different from the unwrapped version).*")
        env = make(method=method, observation=observation, image_size=32)
        check_env(env, skip_render_check=gl_problem() is not None)


def test_its_spec_makes_it_again():
    env = make(moving=["camera"], camera_speed=0.05)
    again = gymnasium.make(env.spec)
    assert again.spec == env.spec and moved(again) == moved(env)


@pytest.mark.parametrize("observation", OBSERVATIONS)
@pytest.mark.parametrize("twin", [lambda env: pickle.loads(pickle.dumps(env)), copy.deepcopy])
def test_within_an_episode_it_can_be_pickled_and_copied(twin, observation):
    env = make(observation=observation, image_size=32)
    env.reset(seed=3)
    rng = np.random.default_rng(0)
    for _ in range(30):
        env.step(rng.uniform(-1, 1, 4).astype(np.float32))
    other = twin(env)
    assert np.array_equal(other.unwrapped.observe(), env.unwrapped.observe())
    for _ in range(10):
        action = rng.uniform(-1, 1, 4).astype(np.float32)
        assert np.array_equal(env.step(action)[0], other.step(action)[0])
    assert np.array_equal(env.reset()[0], other.reset()[0])


@pytest.mark.parametrize("task", TASKS)
def test_every_task_can_be_pickled(task):
    scene = Scene(task)
    first, _ = scene.reset(seed=0)
    assert np.array_equal(pickle.loads(pickle.dumps(scene)).observe(), first)
    pickle.loads(pickle.dumps(Scene(task))).reset(seed=0)  # before its first episode


VECTOR = """
import sys, warnings
warnings.simplefilter("ignore")
import gymnasium, numpy as np
import move
context, choices = sys.argv[1], dict(num_envs=2, observation=sys.argv[2], image_size=32)
together = gymnasium.make_vec("MOVE/pick-place-v0", vectorization_mode="async",
                              vector_kwargs={"context": context}, **choices)
alone = gymnasium.make_vec("MOVE/pick-place-v0", vectorization_mode="sync", **choices)
seen = [together.reset(seed=5)[0]]  # before the other has drawn
rng = np.random.default_rng(0)
actions = rng.uniform(-1, 1, (5, 2, 4)).astype(np.float32)
seen += [together.step(action)[0] for action in actions]
together.close()
same = [alone.reset(seed=5)[0]] + [alone.step(action)[0] for action in actions]
assert np.array_equal(np.array(seen), np.array(same))
assert not np.array_equal(seen[0][0], seen[0][1]) and not np.array_equal(seen[0], seen[-1])
"""


@pytest.mark.parametrize("context, observation", [
    pytest.param("fork", "rgb", marks=needs_gl), ("spawn", "keypoints")])
def test_vector_environments_see_the_same_together_as_alone(context, observation):
    done = subprocess.run([sys.executable, "-c", VECTOR, context, observation], capture_output=True, text=True,
                          timeout=120, cwd=paths.ROOT)
    assert done.returncode == 0, done.stderr


@needs_gl
@pytest.mark.filterwarnings("ignore")
def test_a_fork_after_the_first_picture_is_refused_and_does_not_hang():
    make(observation="rgb", image_size=32).reset(seed=0)
    vector = gymnasium.make_vec("MOVE/pick-place-v0", 1, "async", observation="rgb", image_size=32,
                                vector_kwargs={"context": "fork"})
    with pytest.raises(BadInput, match="drawn before this process was forked"):
        vector.reset_async(seed=0)
        vector.reset_wait(timeout=60)


@needs_gl
def test_a_video_is_recorded(tmp_path):
    pytest.importorskip("moviepy", reason="moviepy is in the extra `gymnasium`, which environment.lock leaves out")
    env = gymnasium.wrappers.RecordVideo(make(render_mode="rgb_array", image_size=64), str(tmp_path))
    env.reset(seed=0)
    for _ in range(5):
        env.step(STILL)
    env.close()
    assert [path.stat().st_size > 0 for path in tmp_path.glob("*.mp4")] == [True]


@pytest.mark.parametrize("choices, message", [
    ({"method": "dance"}, "method: 'dance' given; allowed are static, adc, move"),
    ({"method": "mixture"}, "method: 'mixture' given; allowed are static, adc, move"),
    ({"observation": "smell"}, "observation: 'smell' given; allowed are keypoints, rgb"),
    ({"factors": "moon"}, "factors: 'moon' given; allowed are object"),
    ({"image_size": 0}, "image_size: 0 given; allowed are whole numbers from 1 to 4096"),
    ({"image_size": -3, "observation": "rgb"}, "image_size: -3 given"),
    ({"image_size": "big"}, "image_size: 'big' given"),
    ({"image_size": 9.5}, "image_size: 9.5 given"),
    ({"image_size": True}, "image_size: True given"),
    ({"render_mode": "ansi"}, "render_mode: 'ansi' given; allowed are None, rgb_array"),
    ({"object_speed": -1.0}, "object_speed: -1.0 given"),
])
def test_a_choice_without_sense_is_one_clear_line(choices, message):
    with refused(message):
        make(**choices)


@pytest.mark.parametrize("action", [[0, 0, 0, math.nan], [0, 0, math.inf, 0], np.zeros(3), np.zeros(6), 0.5, "left",
                                    None, np.zeros((4, 1)), np.zeros((1, 4)), [[1, 2], 3, 4, 5]])
def test_an_action_that_is_none_is_one_clear_line(action):
    scene = Scene()
    scene.reset(seed=0)
    with pytest.raises(BadInput, match="^action: .* given; allowed are 4 finite numbers$"):
        scene.step(action)
    assert scene.steps == 0


def test_a_step_before_the_reset_is_one_clear_line():
    with pytest.raises(BadInput, match="^step before the first reset"):
        Scene().step(STILL)
    with pytest.raises(gymnasium.error.ResetNeeded):
        make().step(STILL)


@pytest.mark.parametrize("options, message", [
    ({"factor": "object"}, "options: 'factor' given; allowed are configuration, factors"),
    ({"factors": "moon"}, "options: factors: 'moon' given; allowed are None, object"),
    ({"configuration": {"object": 1}}, "allowed is a SpatialConfiguration"),
])
def test_an_unknown_option_is_one_clear_line(options, message):
    with pytest.raises(BadInput, match=message):
        make().reset(options=options)


@pytest.mark.parametrize("observation", OBSERVATIONS)
@pytest.mark.filterwarnings("ignore")
def test_stable_baselines3_learns_in_it(observation):
    reason = "stable-baselines3 is not in environment.lock: pip install stable-baselines3 in an environment of its own"
    baselines = pytest.importorskip("stable_baselines3", reason=reason)
    env = make(observation=observation, image_size=64)
    model = baselines.PPO({"keypoints": "MlpPolicy", "rgb": "CnnPolicy"}[observation], env, n_steps=32, batch_size=16,
                          n_epochs=1, device="cpu")
    assert model.learn(64).num_timesteps == 64
    action, _ = model.predict(env.reset(seed=0)[0])
    assert env.action_space.contains(action)
