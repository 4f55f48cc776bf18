"""A mixture is its parts end to end, each as its method alone would have collected it."""

from functools import partial

import numpy as np
import pytest
from recipes import tiny
from shared import plan as any_plan

from move.errors import BadInput
from move.figures.plots import style
from move.learn.evaluation import Evaluation
from move.sim.collect import attempts, collect
from move.sim.collection import Collection
from move.sim.methods import METHODS
from move.sim.motion.adc import MENDED
from move.study import run
from move.study.kinds import policy_run
from move.study.labels import grid
from move.study.profiles import load_profile
from move.study.spec import CollectionRun, PolicyRun
from move.validation import build

HALF = {"static": 0.5, "move": 0.5}


plan = partial(any_plan, method="mixture", timesteps=600, shares=HALF)


@pytest.mark.parametrize("protocol, factors", [("random", "all"), ("sparse", "object")])
def test_half_and_half_has_exactly_the_demonstrations_of_both_at_half_the_budget(protocol, factors):
    both, record = collect(plan(protocol=protocol, factors=factors), seed=3)
    pure = [collect(plan(method=method, timesteps=300, shares={}, protocol=protocol, factors=factors), seed=3)
            for method in HALF]
    (static, one), (moved, two) = pure
    assert np.array_equal(both.observations, np.concatenate([static.observations, moved.observations]))
    assert np.array_equal(both.actions, np.concatenate([static.actions, moved.actions]))
    assert both.episode_ends.tolist() == [*static.episode_ends, *(moved.episode_ends + 300)]
    assert both.timesteps == record.timesteps == 600
    assert record.demonstrations == one.demonstrations + two.demonstrations == both.episodes
    assert record.attempts == one.attempts + two.attempts
    assert record.starts == one.starts + two.starts and record.grasps == one.grasps + two.grasps
    steps = one.mean_steps * one.demonstrations + two.mean_steps * two.demonstrations
    assert record.mean_steps == pytest.approx(steps / record.demonstrations)


@pytest.mark.parametrize("shares, timesteps, steps", [
    (HALF, 601, [("static", 300), ("move", 301)]),
    ({"move": 0.71, "static": 0.29}, 100, [("static", 29), ("move", 71)]),
    ({"static": 1 / 3, "adc": 1 / 3, "move": 1 / 3}, 100, [("static", 33), ("adc", 33), ("move", 34)]),
])
def test_shares_are_whole_timesteps_and_the_last_part_has_the_rest(shares, timesteps, steps):
    parts = plan(shares=shares, timesteps=timesteps).parts
    assert [(part.method, part.timesteps) for part in parts] == steps


def test_a_pure_collection_is_its_only_part():
    pure = plan(method="move", shares={})
    assert pure.parts == (pure,)


def test_a_part_is_chosen_as_its_method_alone_would_be():
    whole = plan(shares={"adc": 0.5, "move": 0.5}, jumping=MENDED, object_speed=0.01, moving=("object", "camera"))
    adc, moved = whole.parts
    assert adc == plan(method="adc", shares={}, timesteps=300, jumping=MENDED)
    assert moved == plan(method="move", shares={}, timesteps=300, object_speed=0.01, moving=("object", "camera"))


def test_the_order_in_which_shares_are_written_is_no_other_run():
    assert plan(shares={"move": 0.5, "static": 0.5}) == plan() == plan(shares=[("move", 0.5), ("static", 0.5)])
    assert Collection.model_validate_json(plan().model_dump_json()) == plan()


def test_what_needs_one_method_refuses_a_mixture():
    with pytest.raises(BadInput, match="allowed here is each of its parts"):
        next(attempts(plan(), 0))
    with pytest.raises(BadInput, match="attempts of a mixture"):
        build(CollectionRun, task="pick-place", seed=0, collection=plan())


def test_shares_are_an_axis_like_any_other():
    base = partial(policy_run, load_profile("smoke"), task="push", method="mixture", seed=0, timesteps=200)
    runs = grid(base, share={share: {"shares": {"adc": 1 - share, "move": share}} for share in (0.25, 0.75)})
    assert [run.spec.collection.shares for run in runs] == [(("adc", 0.75), ("move", 0.25)),
                                                            (("adc", 0.25), ("move", 0.75))]
    assert [run.spec.collection.jumping for run in runs] == [MENDED, MENDED]  # as ADC alone jumps
    assert [run.labels for run in runs] == [{"share": 0.25}, {"share": 0.75}]


def test_a_policy_learns_from_a_mixture_and_is_tried_at_configurations_of_each_part(tmp_path):
    training = tiny()
    spec = PolicyRun(task="pick-place", seed=0, collection=plan(), training=training,
                   evaluation=Evaluation(starts="own", episodes=2))
    result = run.run(spec, tmp_path / "results", scratch=tmp_path / "runs")
    _, record = collect(plan(), 0)
    tried = [(row["object_x"], row["object_y"]) for row in result.rows]
    assert tried == [record.starts[index].object_position[:2] for index in (0, -1)]


def test_a_mixture_has_a_colour_of_its_own_and_the_others_keep_theirs():
    okabe_and_ito = {"static": "#0072B2", "adc": "#E69F00", "move": "#D55E00", "mixture": "#009E73"}
    assert okabe_and_ito.items() <= style.COLOURS.items() and style.NAMES["mixture"] == "mixture"
    assert len({style.COLOURS[name] for name in METHODS}) == len(METHODS), "each method has a colour of its own"
