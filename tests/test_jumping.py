"""ADC's jumps in all ten tasks: how many, when, and which demonstrations are kept."""

import math
from functools import partial
from itertools import islice

import gymnasium
import pytest
from shared import plan as any_plan

from move.sim import collect as collecting
from move.sim.collect import attempt_seed, attempts, collect, collecting_env, required_jumps
from move.sim.experts.phase import make_expert
from move.sim.motion.adc import JUMP_DISTANCE, MENDED, PERIODIC, Jumping
from move.sim.tasks import TASKS, get_task
from move.study.run import run
from move.study.spec import CollectionRun

plan = partial(any_plan, method="adc", timesteps=300, jumping=MENDED)


class Watch(gymnasium.Wrapper):
    """Notes for each episode at which step, and in which phase, object or target stood elsewhere than before."""

    def __init__(self, env):
        super().__init__(env)
        self.episodes = []

    def reset(self, **keywords):
        """Begin an empty list of jumps."""
        found = self.env.reset(**keywords)
        self.episodes.append([])
        self.before, self.phase, self.began = self.places(), "pick", 0
        return found

    def step(self, action):
        """Note (what jumped, phase, observations of the phase that showed its old place)."""
        scene = self.env.unwrapped
        if scene.phase != self.phase:
            self.phase, self.began = scene.phase, scene.steps
        shown = scene.steps - self.began + 1
        found = self.env.step(action)
        for what, old, new in zip(("object", "target"), self.before, self.places(), strict=True):
            if old != new:
                self.episodes[-1].append((what, self.phase, shown))
                self.began = scene.steps
        self.before = self.places()
        return found

    def places(self):
        """Where object and target were put."""
        configuration = self.env.unwrapped.configuration
        return (configuration.object_position, configuration.object_yaw), configuration.target_position


def watched(collection, count, seed=0):
    """`count` attempts, and the jumps that were seen in each."""
    env = Watch(collecting_env(collection))
    return list(zip(islice(attempts(collection, seed, env), count), env.episodes, strict=False))


@pytest.mark.parametrize("name", TASKS)
def test_object_and_target_jump_at_the_first_step_at_which_the_gripper_is_near(name):
    task = get_task(name)
    env = collecting_env(plan(task=name, jumping=Jumping()))
    scene, expert, jumps = env.unwrapped, make_expert("phase", task), []
    for attempt in range(4):
        env.reset(seed=attempt_seed(0, attempt))
        expert.reset()
        jumped: set[str] = set()
        for step in range(150):
            action, phase, before = expert.action(scene), scene.phase, scene.configuration
            fingers = (scene.point("site:leftEndEffector") + scene.point("site:rightEndEffector")) / 2
            goal = scene.point(task.object_point if phase == "pick" else task.target_point)
            near = math.dist(fingers, goal) < JUMP_DISTANCE
            env.step(action)
            after = scene.configuration
            moved = {part for part, changed in (("pick", before.object_position != after.object_position),
                                                ("place", before.target_position != after.target_position)) if changed}
            expected = {phase} if near and phase not in jumped and (phase == "pick" or task.has_target) else set()
            assert moved == expected, (attempt, step)
            jumped |= moved
            if phase == "pick" and moved:
                assert task.allows(after, task.separation)
        jumps.append(jumped)
    assert sum("pick" in jumped for jumped in jumps) >= 3  # the expert gets there


@pytest.mark.parametrize("name", TASKS)
@pytest.mark.parametrize("jumping", [MENDED, PERIODIC], ids=["mended", "periodic"])
def test_a_kept_demonstration_has_all_its_jumps_none_too_early(name, jumping):
    collection, task = plan(task=name, jumping=jumping), get_task(name)
    wanted = [("object", "pick")] * jumping.times + [("target", "place")] * (jumping.times if task.has_target else 0)
    tried = watched(collection, 4)
    kept = [(episode, jumps) for episode, jumps in tried if episode.succeeded]
    assert len(kept) >= 2
    for episode, jumps in kept:
        assert [(what, phase) for what, phase, _ in jumps] == wanted
        assert episode.jumps == len(wanted) == required_jumps(collection)
    for _, jumps in tried:
        assert all(shown >= jumping.seen_steps for _, _, shown in jumps)


def test_a_hand_that_starts_near_jumps_as_soon_as_the_place_was_seen():
    """By default some objects jump after their first observation; the mended ones wait for the tenth."""
    default, mended = ([jumps[0][2] for _, jumps in watched(plan(jumping=jumping), 12)]
                       for jumping in (Jumping(), MENDED))
    assert min(default) == 1 and min(mended) == MENDED.seen_steps
    assert [max(shown, MENDED.seen_steps) for shown in default] == mended


def test_the_hammers_head_decides_and_not_the_fingers():
    jumped = []
    for distance_from in ("fingers", "held"):
        tried = watched(plan(task="hammer", jumping=Jumping(distance_from=distance_from)), 15)
        jumped.append([any(what == "target" for what, _, _ in jumps) for episode, jumps in tried if episode.succeeded])
    assert sum(jumped[0]) <= 0.7 * len(jumped[0]) and all(jumped[1]) and len(jumped[1]) >= 13


@pytest.mark.parametrize(("name", "point"), [("pick-place", "body:obj"), ("assembly", "site:RoundNut"),
                                             ("box-close", "body:top_link"), ("hammer", "geom:HammerHead")])
def test_the_target_jumps_when_what_is_held_is_near(name, point):
    collection, distances = plan(task=name), []

    class Measure(gymnasium.Wrapper):
        def step(self, action):
            scene = self.env.unwrapped
            before, target = scene.configuration.target_position, scene.point(scene.task.target_point).copy()
            distance = float(sum((scene.point(point) - target) ** 2)) ** 0.5
            found = self.env.step(action)
            if scene.configuration.target_position != before:
                distances.append(distance)
            return found

    list(islice(attempts(collection, 0, Measure(collecting_env(collection))), 4))
    assert len(distances) >= 3 and all(distance < JUMP_DISTANCE for distance in distances)


def test_a_demonstration_without_its_jumps_is_discarded_and_counted(monkeypatch):
    real, calls = collecting.demonstrate, []

    def every_other_lacks_one(*arguments):
        calls.append(1)
        episode = real(*arguments)
        return collecting.replace(episode, jumps=episode.jumps - len(calls) % 2)

    monkeypatch.setattr(collecting, "demonstrate", every_other_lacks_one)
    _, record = collect(plan(), seed=0)
    assert record.generation_rate == 0.5 and set(record.jumps) == {2}
    calls.clear()
    _, record = collect(plan(jumping=MENDED.model_copy(update={"required": False})), seed=0)
    assert record.generation_rate == 1.0 and set(record.jumps) == {1, 2}


def test_the_record_and_the_rows_of_attempts_hold_the_jumps(tmp_path):
    _, record = collect(plan(jumping=PERIODIC), seed=0)
    assert record.content()["jumps"] == [4] * record.demonstrations
    assert collect(plan(method="static", jumping=Jumping()), seed=0)[1].jumps[0] == 0
    counted = [run(CollectionRun(task="pick-place", seed=0, collection=plan(jumping=jumping, timesteps=1),
                           evaluation={"episodes": 2}), tmp_path).rows for jumping in (MENDED, Jumping())]
    assert [row["jumps"] for row in counted[0]] == [2, 2] and "jumps" not in counted[1][0]


def test_only_the_object_jumps_where_only_it_is_random():
    (episode, jumps), = watched(plan(factors="object"), 1)
    assert episode.succeeded and [what for what, _, _ in jumps] == ["object"]
