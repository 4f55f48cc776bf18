"""Runs that carry labels: products of named axes, columns of the table, and one reading of the profile."""

import dataclasses
from functools import partial

import pytest
from shared import refused

from move import figures, paths
from move.errors import BadInput
from move.figures.page import parameters
from move.learn.evaluation import Evaluation
from move.study import profiles, results
from move.study import run as running
from move.study.kinds import collector_run, control_run, policy_run
from move.study.labels import LabelledRun, distinct, grid
from move.study.profiles import load_profile

SMOKE = load_profile("smoke")
PUSH = partial(policy_run, SMOKE, task="push", method="move", seed=0, timesteps=100, observation="keypoints")


def test_a_grid_is_the_product_of_its_axes_with_the_last_one_fastest():
    base = partial(policy_run, SMOKE, task="push", observation="keypoints")
    runs = grid(base, timesteps=(100, 200), seed=range(2), method=("static", "move"))
    found = [(run.spec.collection.timesteps, run.spec.seed, run.spec.method) for run in runs]
    assert found == [(100, 0, "static"), (100, 0, "move"), (100, 1, "static"), (100, 1, "move"),
                     (200, 0, "static"), (200, 0, "move"), (200, 1, "static"), (200, 1, "move")]
    assert [tuple(run.labels.values()) for run in runs] == found
    assert list(runs[0].labels) == ["timesteps", "seed", "method"]


def test_a_mapping_gives_a_label_to_several_settings():
    runs = grid(partial(PUSH), change={"none": {}, "slow and long": {"learning_rate": 1e-4, "length": 2}})
    assert [run.labels for run in runs] == [{"change": "none"}, {"change": "slow and long"}]
    none, other = (run.spec.training for run in runs)
    assert none == SMOKE.training["keypoints"]
    assert (other.learning_rate, other.gradient_steps) == (1e-4, 2 * none.gradient_steps)


def test_a_setting_goes_to_the_part_of_the_run_that_has_it():
    spec = PUSH(factors="object", protocol="sparse", hand_spread=0.01, episodes=7, batch_size=8)
    assert spec.collection.factors == spec.evaluation.factors == "object"
    assert (spec.collection.protocol, spec.collection.hand_spread) == ("sparse", 0.01)
    assert (spec.evaluation.episodes, spec.training.batch_size) == (7, 8)


@pytest.mark.parametrize(("make", "message"), [
    (lambda: grid(PUSH, motions=[{"object_speed": 1}]), "axis motions: .* a mapping from such labels"),
    (lambda: grid(PUSH, a={"x": {"episodes": 3}}, episodes=[2]), "axis episodes: chooses episodes; allowed"),
    (lambda: PUSH(budget=3), "no setting budget; allowed are task, "),
    (lambda: PUSH(batch_size=-1), "batch_size: -1 given; input should be greater than 0"),
    (lambda: PUSH(protocol="spiral"), "protocol: 'spiral' given"),
    (lambda: control_run(task="push", agent="dog"), "agent: 'dog' given"),
    (lambda: collector_run(SMOKE, task="push", method="move", attempts=0), "episodes: 0 given"),
])
def test_what_no_run_can_be_is_one_clear_line(make, message):
    with refused(message):
        make()


def test_labels_are_neither_hashed_nor_stored_and_become_columns(tmp_path):
    run = LabelledRun(control_run(task="push", agent="expert", episodes=1), {"colour": "red", "task": "push"})
    assert run.spec.hash == control_run(task="push", agent="expert", episodes=1).hash
    results.store(dataclasses.replace(running.run(run.spec, tmp_path), labels=run.labels), tmp_path)
    again = results.load(run.spec, tmp_path)
    assert again.labels == {} and "red" not in (tmp_path / f"{run.spec.hash}.json").read_text()
    table = results.table([dataclasses.replace(again, labels=run.labels)])
    assert table.loc[0, ["colour", "task", "kind", "method"]].tolist() == ["red", "push", "control", "expert"]
    with pytest.raises(BadInput, match="label: success given"):
        results.table([dataclasses.replace(again, labels={"success": 1})])


def test_of_runs_with_one_hash_the_first_is_kept():
    first, second = LabelledRun(PUSH(), {"change": "chosen"}), LabelledRun(PUSH(), {"change": "none"})
    other = first.tried(Evaluation(episodes=3))
    assert distinct([first, second, other]) == [first, other] and other.labels == first.labels


def test_a_profile_is_read_once_however_many_runs_it_makes(monkeypatch):
    read = []
    real = profiles.yaml_text.read
    monkeypatch.setattr(profiles.yaml_text, "read", lambda text, where: read.append(where) or real(text, where))
    profile = load_profile("laptop")
    assert len(parameters.specs("table2_main", profile)) > 60 and len(read) == 1


def test_a_profile_says_where_its_files_go():
    laptop, other = load_profile("laptop"), load_profile("laptop-keypoints")
    assert laptop.figures == paths.ROOT / "paper_figures" != other.figures
    assert other.results == paths.ROOT / "results" / "laptop"  # a run is the same in whichever profile
    assert SMOKE.stamp and SMOKE.results.is_relative_to(paths.BUILD)
    assert [name for name in profiles.names() if load_profile(name).shipped] == ["laptop"]
    assert [name for name in profiles.names() if load_profile(name).stamp] == ["smoke"]


def test_a_profile_may_choose_how_a_method_collects():
    profile = SMOKE.model_copy(update={"collection": {"move": {"hand_spread": 0.02}}})
    base = partial(policy_run, profile, task="push", seed=0, timesteps=100, protocol="sparse")
    spread = {run.labels["method"]: run.spec.collection.hand_spread for run in grid(base, method=("static", "move"))}
    assert spread == {"static": 0.0, "move": 0.02}
    assert base(method="move", hand_spread=0.01).collection.hand_spread == 0.01  # the experiment's choice is stronger


def test_a_new_figure_is_one_file(tmp_path, monkeypatch):
    (tmp_path / "mine.py").write_text("""
from functools import partial
from move.study.kinds import control_run
from move.study.labels import grid

def runs(profile, seeds: int = 2):
    return grid(partial(control_run, task="push", agent="random"), seed=range(seeds))
""")
    monkeypatch.setattr(figures, "__path__", [*figures.__path__, str(tmp_path)])
    figures.names.cache_clear()
    try:
        assert "mine" in figures.names()
        assert [run.labels["seed"] for run in parameters.runs("mine", load_profile("laptop"))] == [0, 1]
        assert len(parameters.runs("mine", load_profile("laptop"), {"seeds": 5})) == 5
    finally:
        figures.names.cache_clear()
