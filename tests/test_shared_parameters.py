"""Every figure that trains takes another task, other repetitions and other motions; what it has no name for has a way.
"""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from move import paths
from move.errors import BadInput
from move.figures import names
from move.figures.page import changes, make
from move.figures.page.data import Data
from move.figures.page.parameters import SHARED, defaults, extras, other_task, parameters, runs, trains, with_runs
from move.sim.motion.wrappers import movable
from move.sim.tasks import get_task
from move.study.profiles import load_profile

SMOKE, LAPTOP = load_profile("smoke"), load_profile("laptop")
TRAINING = [name for name in with_runs() if trains(name)]


def test_all_that_train_have_them_and_no_other_does():
    assert set(with_runs()) - set(TRAINING) == {"table5_data_sizes", "table6_collection"}
    for name in names():
        assert (set(SHARED) <= set(defaults(name))) == (name in TRAINING), name


@pytest.mark.parametrize("name", TRAINING)
def test_another_first_seed_trains_others_of_the_same(name):
    own, later = (runs(name, SMOKE, given) for given in ({}, {"first_seed": 5}))
    for one, other in zip(own, later, strict=True):
        shift = 5 * bool(one.spec.training)
        assert other.spec == one.spec.model_copy(update={"seed": one.spec.seed + shift})
        assert other.labels.get("seed", 0) == one.labels.get("seed", 0) + shift * ("seed" in one.labels)


@pytest.mark.parametrize("name", TRAINING)
def test_every_run_is_of_the_task_that_is_chosen(name):
    found = runs(name, SMOKE, {"task": "push"})
    assert found and {run.spec.task for run in found} == {"push"}
    assert {run.spec.collection.task for run in found if run.spec.collection} == {"push"}
    assert all(value not in ("pick-place", "assembly") for run in found for value in run.labels.values())


@pytest.mark.parametrize("name", TRAINING)
def test_motions_are_those_of_moves_demonstrations_where_the_figure_chooses_none(name):
    own, faster = (runs(name, SMOKE, given) for given in ({}, {"motions": {"object_speed": 0.05, "yaw_speed": 0.1}}))
    changed = 0
    for one, other in zip(own, faster, strict=True):
        made = one.spec.collection
        chosen_here = one.labels.get("part") == "object"  # by figure 7
        if not made or "move" not in made.methods or made.object_speed is not None or chosen_here:
            assert made is None or made.yaw_speed or "move" in made.methods or one.spec == other.spec
            continue
        moves = made.moving or movable(get_task(made.task), made.factors)
        assert other.spec.collection.object_speed == (0.05 if "object" in moves else None)
        assert other.spec.collection.yaw_speed == (0.1 if "rotation" in moves else None)
        changed += other.spec != one.spec
    assert changed or name in ("table_adc", "table_recipe", "decided_places")


def test_further_repetitions_follow_fewer_seeds_unless_they_are_given():
    assert set(extras("fig1_sparse")) == {"near_hands", "identical_starts", "length_seeds"}
    chosen = parameters("fig1_sparse", LAPTOP, {"seeds": 1})
    assert [chosen[name] for name in ("near_hands", "identical_starts", "length_seeds")] == [1, 1, 1]
    given = parameters("fig1_sparse", LAPTOP, {"seeds": 1, "near_hands": 2, "identical_starts": 0})
    assert (given["near_hands"], given["identical_starts"]) == (2, 0)
    assert parameters("fig1_sparse", LAPTOP, {"seeds": 4})["near_hands"] == 5
    change = changes.change("table2_main", LAPTOP, {"seeds": 1, "control_seeds": 3})  # as a notebook passes all
    assert change.parameters == {"seeds": (1, 3), "control_seeds": (1, 3)}


@pytest.mark.parametrize(("name", "unknown", "way"), [
    ("fig1_sparse", "v_max", "motions={object_speed: 0.05}"), ("fig1_sparse", "camera_speed", "motions={camera_speed"),
    ("fig1_sparse", "seed", "(nearest: first_seed)"), ("table1_spatial_factors", "tasks", "(nearest: task)"),
    ("fig3_dense", "timestep", "(nearest: timesteps)"), ("table_recipe", "seeds", "(nearest: first_seed)"),
    ("fig2_overview", "tasks", "(nearest: task)"), ("table4_hyperparameters", "zebra", "parameter zebra; allowed")])
def test_a_refused_name_says_the_nearest_way(name, unknown, way):
    with pytest.raises(BadInput) as told:
        parameters(name, LAPTOP, {unknown: 1})
    assert way in str(told.value) and "allowed are" in str(told.value)


@pytest.mark.parametrize(("given", "told"), [
    ({"motions": {"speed": 1}}, "motions"), ({"motions": {"object_speed": 5.0}}, "object_speed"),
    ({"task": "fly"}, "task"), ({"first_seed": -1}, "first_seed"), ({"motions": [1]}, "motions")])
def test_bad_values_are_refused(given, told):
    with pytest.raises(BadInput, match=told):
        runs("table1_spatial_factors", LAPTOP, given)


def test_of_another_task_the_papers_values_are_left_out_and_the_words_name_it(monkeypatch):
    chosen = parameters("table1_spatial_factors", LAPTOP, {"task": "push"})
    assert other_task("table1_spatial_factors", LAPTOP, chosen) == ("pick-place", "push")
    assert other_task("table1_spatial_factors", LAPTOP, {**chosen, "task": ""}) is None
    assert other_task("fig_mixture", LAPTOP, parameters("fig_mixture", LAPTOP)) is None
    assert other_task("table2_main", LAPTOP, parameters("table2_main", LAPTOP, {"task": "push"})) is None
    table = pd.DataFrame({"method": ["static"], "value": [0.4], "paper": [0.3]})
    assert np.isnan(make._without_papers(table).paper[0]) and make._without_papers(table).value[0] == 0.4
    named = make.Made("a", None, {}, {}, {}, {}, None, ("pick-place", "push"))
    assert make._named("Success on Pick-Place.", named) == "Success on Push."
    monkeypatch.setattr(changes, "by_command", lambda: False)
    shown = replace(named, data=Data(LAPTOP, paths.BUILD / "figures"), answers={"a": "It is."}).answer.data
    assert "The paper's values are of Pick-Place." in shown
