"""Specs and their hashes, results that are never half-read, execution that goes on, profiles, evaluation."""

import dataclasses
import json
import os
import shutil
import stat
import subprocess

import numpy as np
import pytest
from pydantic import ValidationError
from recipes import tiny, tiny_run

from move import paper, paths
from move.errors import BadInput
from move.figures import generalization, names, table2_main
from move.figures.page import kernels, parameters
from move.figures.page.data import load_or_run
from move.learn.agents import Expert, Nothing, PolicyAgent, Random
from move.learn.evaluate import evaluate
from move.learn.evaluation import Evaluation, starts
from move.learn.train import train
from move.sim.collect import Collection, collect
from move.sim.motion.adc import MENDED, Jumping
from move.sim.scene.scene import Scene
from move.sim.tasks import get_task
from move.sim.tasks.task import EPISODE_STEPS
from move.study import execute, policies, profiles, results, run
from move.study.plan import TRIAL_MINUTES, plan_rows
from move.study.profiles import Profile, load_profile

TASK = get_task("pick-place")
TINY = tiny()


@pytest.fixture(autouse=True)
def build_elsewhere(tmp_path, monkeypatch):
    for module in (run, execute):
        monkeypatch.setattr(module, "RUNS", tmp_path / "runs")


@pytest.fixture(scope="module")
def computed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("computed")
    return run.run(tiny_run(seed=3), folder / "results", scratch=folder / "runs"), folder


@pytest.fixture
def stored(computed, tmp_path):
    """A result, a folder that holds it, and what it left to go on from in "runs"."""
    result, folder = computed
    shutil.copytree(folder / "runs", tmp_path / "runs")
    shutil.copy(folder / "results" / f"{result.spec.hash}.json", tmp_path)
    return result, tmp_path


# specs ---------------------------------------------------------------------------------------------------------------


def test_the_hash_names_the_run():
    assert tiny_run().hash == tiny_run().hash
    others = [tiny_run(seed=1), tiny_run(method="move"), tiny_run(evaluation=Evaluation(episodes=2)),
              tiny_run(training=tiny(6)),
              tiny_run(results_version=99)]
    assert len({spec.hash for spec in [tiny_run(), *others]}) == 6


@pytest.mark.parametrize("wrong", [{"agent": "expert"}, {"training": None}, {"task": "push"}, {"seed": -1},
                                   {"sed": 1}])
def test_impossible_specs_are_refused(wrong):
    with pytest.raises(ValidationError):
        tiny_run(**wrong)


OF_THE_METHOD = ("method", "jumping", "shares", "moving", "object_speed", "target_speed", "camera_speed",
                 "object_steps")
METHOD_AXES = ("method", "jumping", "share", "moves", "part", "speed")  # labels that say how data are collected


def test_methods_of_a_figure_differ_in_nothing_but_the_method():
    for name in set(parameters.with_runs()) - {"equal_demonstrations"}:  # whose budgets differ, which is its question
        for profile in map(load_profile, profiles.names()):
            groups: dict[str, set[str]] = {}
            for asked_for in parameters.runs(name, profile):
                if asked_for.spec.collection:
                    rest = asked_for.spec.model_dump(mode="json")
                    chosen = {field: rest["collection"].pop(field) for field in OF_THE_METHOD}
                    usual = MENDED if "adc" in asked_for.spec.collection.methods else Jumping()
                    assert name == "table_adc" or chosen["jumping"] == usual.model_dump()
                    same = {axis: label for axis, label in asked_for.labels.items() if axis not in METHOD_AXES}
                    asked = json.dumps([same, rest["evaluation"], asked_for.spec.observation], sort_keys=True)
                    groups.setdefault(asked, set()).add(json.dumps(rest, sort_keys=True))
            assert {len(rests) for rests in groups.values()} <= {1}, name  # none where a profile has no such runs


# results -------------------------------------------------------------------------------------------------------------


@pytest.mark.skipif(not (paths.ROOT / ".git").exists() or (paths.ROOT / ".git" / "shallow").exists(),
                    reason="needs the whole history of a git checkout")
def test_every_shipped_result_names_a_commit_of_this_history():
    """A commit that was amended away could not be looked up by a reader who doubts a number."""
    named = {json.loads(path.read_text())["provenance"]["commit"] for path in (paths.ROOT / "results").glob("*/*.json")}
    assert named
    for commit in named:
        found = subprocess.run(["git", "merge-base", "--is-ancestor", commit, "HEAD"], cwd=paths.ROOT)
        assert found.returncode == 0, commit


def test_a_result_comes_back_as_it_was_stored(stored):
    result, folder = stored
    again = results.load(result.spec, folder)
    assert again.rows == result.rows and again.spec == result.spec
    assert again.provenance["versions"]["mujoco"] == "3.3.0"
    assert again.collection["timesteps"] == 100 and len(again.training["curve"]) == 3
    assert not list(folder.glob("*.part"))


def test_a_runs_rate_leaves_out_its_training_points(stored):
    result, _ = stored
    rows = [{"trial": n, "group": group, "success": won} for n, (group, won) in enumerate(
        [("grid", True), ("grid", False), ("point", True), ("grid", False), ("grid", False), ("point", True)])]
    result = dataclasses.replace(result, rows=rows)
    assert result.judged == [True, False, False, False] and result.rate == 0.25


def test_a_missing_result_is_missing(tmp_path):
    assert results.load(tiny_run(), tmp_path) is None
    assert results.split([tiny_run()], tmp_path)[1] == [(tiny_run(), "not computed yet")]


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_without_permission_is_refused(tmp_path):
    tmp_path.chmod(stat.S_IRUSR | stat.S_IXUSR)
    with pytest.raises(BadInput, match="cannot write"):
        execute.execute([tiny_run()], tmp_path / "results", quiet=True)


def test_a_folder_that_is_a_file_is_refused_before_any_work(tmp_path):
    (tmp_path / "results").write_text("not a folder")
    with pytest.raises(BadInput, match="cannot write"):
        execute.execute([tiny_run()], tmp_path / "results", quiet=True)


# execution -----------------------------------------------------------------------------------------------------------


class Here:
    """A pool that computes in this process, so that a test can break a run."""

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        return False

    def trouble(self):
        return ""

    def submit(self, spec, folder):
        from concurrent.futures import Future

        future = Future()
        try:
            future.set_result(run.run_and_report(spec, folder))
        except Exception as error:
            future.set_exception(error)
        return future


@pytest.fixture
def in_this_process(monkeypatch):
    monkeypatch.setattr(execute, "ProcessPool", lambda workers: Here())


def test_only_what_is_missing_is_computed(tmp_path, in_this_process, monkeypatch):
    specs = [tiny_run(seed=seed) for seed in range(2)]
    execute.execute(specs[:1], tmp_path, quiet=True)
    computed = []
    real = run.run_and_report
    monkeypatch.setattr(run, "run_and_report", lambda spec, folder: computed.append(spec) or real(spec, folder))
    there, missing = execute.execute([*specs, specs[1]], tmp_path, quiet=True)
    assert computed == [specs[1]] and not missing and len(there) == 3


def test_a_failed_run_is_missing_and_the_others_go_on(tmp_path, in_this_process, monkeypatch):
    real = run.collect
    monkeypatch.setattr(run, "collect", lambda plan, seed, on: 1 / 0 if seed == 0 else real(plan, seed, on))
    there, missing = execute.execute([tiny_run(seed=seed) for seed in range(2)], tmp_path, quiet=True)
    assert [result.spec.seed for result in there] == [1]
    assert missing[0][0].seed == 0 and "ZeroDivisionError" in missing[0][1]


def test_an_interrupted_run_goes_on_and_ends_the_same(tmp_path, monkeypatch):
    spec = tiny_run(training=tiny(8))
    whole = run.run(spec, tmp_path / "whole")
    monkeypatch.setattr(run, "RUNS", tmp_path / "runs2")
    real = run.train

    def interrupted(*arguments, on_step, **keywords):
        def stop(step, total, loss):
            if step == 5:
                raise KeyboardInterrupt

        return real(*arguments, on_step=stop, checkpoint_every=4, **keywords)

    monkeypatch.setattr(run, "train", interrupted)
    with pytest.raises(KeyboardInterrupt):
        run.run(spec, tmp_path / "parts")
    assert results.load(spec, tmp_path / "parts") is None
    monkeypatch.setattr(run, "train", real)
    assert run.run(spec, tmp_path / "parts").rows == whole.rows


@pytest.mark.parametrize("damage", ["{", "null", "of another run"])
def test_a_checkpoint_that_cannot_be_used_is_set_aside_and_the_run_begins_anew(tmp_path, stored, damage):
    result, _ = stored
    scratch = tmp_path / "scratch" / result.spec.policy_hash / "policy"
    if damage == "of another run":
        shutil.copytree(tmp_path / "runs" / result.spec.policy_hash / "policy", scratch)
        record = json.loads((scratch / "run.json").read_text()) | {"seed": 99}
        (scratch / "run.json").write_text(json.dumps({name: record[name] for name in record if name != "digest"}))
    else:
        scratch.mkdir(parents=True)
        (scratch / "run.json").write_text(damage)
    for folder in ("again", "and again"):
        assert run.run(result.spec, tmp_path / folder, scratch=tmp_path / "scratch").rows == result.rows
    assert (scratch.with_name("policy.bad") / "run.json").exists()


def test_a_run_that_diverges_is_not_begun_anew(tmp_path, monkeypatch):
    steps = []
    monkeypatch.setattr("move.learn.train.Trainer.take_step", lambda self: steps.append(1) or self.diverge())
    monkeypatch.setattr("move.learn.train.Trainer.diverge", lambda self: (_ for _ in ()).throw(BadInput("diverged")),
                        raising=False)
    with pytest.raises(BadInput, match="diverged"):
        run.run(tiny_run(), tmp_path)
    assert len(steps) == 1


def test_runs_that_differ_in_their_evaluation_share_a_training(tmp_path, stored, monkeypatch):
    spec = stored[0].spec.model_copy(update={"evaluation": Evaluation(starts="own", episodes=1)})
    alone = run.run(spec, tmp_path / "alone", scratch=tmp_path / "elsewhere")
    monkeypatch.setattr("move.learn.train.Trainer.take_step", lambda self: 1 / 0)
    shared = run.run(spec, tmp_path / "shared")
    assert shared.rows == alone.rows and shared.seconds["train"] == stored[0].seconds["train"]


@pytest.mark.parametrize("place", ["starts", "grasps"])
def test_a_policy_is_tried_where_its_own_demonstrations_began_or_where_they_grasped(place, tmp_path, monkeypatch):
    given, real = [], run.evaluate
    monkeypatch.setattr(
        run, "evaluate", lambda *asked, own, **rest: given.extend(own) or real(*asked, own=own, **rest))
    tried = Evaluation(starts={"starts": "own", "grasps": "grasp"}[place], episodes=1)
    spec = tiny_run(method="move", evaluation=tried)
    done = run.run(spec, tmp_path)
    _, record = collect(spec.collection, spec.seed)
    assert record.starts[0].camera_angle != record.grasps[0].camera_angle, "else they could be exchanged"
    assert given == getattr(record, place)[:1]
    assert done.rows[0]["camera_angle"] == pytest.approx(getattr(record, place)[0].camera_angle)


def test_processes_that_want_the_same_policy_at_once_both_end(tmp_path):
    specs = [tiny_run(evaluation=Evaluation(episodes=count)) for count in (1, 2)]
    there, missing = execute.execute(specs, tmp_path, workers=2, quiet=True)
    assert not missing and there[0].training["curve"] == there[1].training["curve"]


# profiles ------------------------------------------------------------------------------------------------------------


def test_more_data_are_trained_on_for_more_steps_and_little_data_not_for_fewer():
    profile = profiles.Profile(purpose="test", training={"keypoints": TINY}, notebooks={},
                               gradient_steps={"keypoints": {100: 3, 200: 23}})
    steps = {budget: profile.recipe("keypoints", budget).gradient_steps for budget in (8, 100, 150, 200, 400)}
    assert steps == {8: 3, 100: 3, 150: 13, 200: 23, 400: 46}
    assert profile.recipe("keypoints", 400).model_copy(update={"gradient_steps": TINY.gradient_steps}) == TINY
    with pytest.raises(BadInput, match="this profile has keypoints"):
        profile.recipe("rgb", 8)
    for wrong in ({"keypoints": {100: 6}}, {"keypoints": {}}, {"rgb": {100: 3}}):
        with pytest.raises(ValueError, match="smallest budget must have what training has"):
            profiles.Profile(purpose="test", training={"keypoints": TINY}, notebooks={}, gradient_steps=wrong)


def table_2_from_pixels(profile, seeds):
    """Specs of table 2's policies from pixels, however many seeds the profile's notebook asks for."""
    return [run.spec for run in table2_main.runs(profile, seeds=seeds) if run.spec.observation == "rgb"]


def test_the_plan_counts_a_shared_training_once(tmp_path, monkeypatch):
    monkeypatch.setattr(Profile, "results", property(lambda profile: tmp_path))
    profile = load_profile("laptop")
    table_2 = table_2_from_pixels(profile, seeds=1)
    gap = [run.spec for run in generalization.runs(profile, tasks=paper.PAPER_TASKS, seeds=(0,))]
    rows = plan_rows(profile, {"table 2": table_2, "difference": gap})
    minutes = profile.minutes["rgb"]
    assert rows[0]["hours_left"] == pytest.approx(30 * minutes / 60, abs=0.01)
    assert rows[1]["missing"] == 90 and rows[1]["hours_left"] == pytest.approx(60 * TRIAL_MINUTES / 60, abs=0.01)


def test_the_plan_costs_a_run_as_stored_runs_like_it_cost(monkeypatch):
    specs = table_2_from_pixels(load_profile("laptop"), seeds=1)
    new, *others = [spec for spec in specs if spec.task == "push"]
    other_task = next(spec for spec in specs if spec.task == "hammer")
    there = [results.Result(spec, [], None, None, {"collect": 60.0, "train": 60.0 * minutes}, {})
             for spec, minutes in [*zip(others, (5, 11), strict=True), (other_task, 90)]]
    monkeypatch.setattr("move.study.plan.split", lambda specs, folder: (there, [(new, "not computed yet")]))
    (row,) = plan_rows(load_profile("laptop"), {"table 2": [new]})
    assert row["hours_left"] == pytest.approx((1 + 8) / 60, abs=0.01)  # their median, and not that of other tasks


# evaluation ----------------------------------------------------------------------------------------------------------


def test_the_grid_covers_the_object_range_evenly():
    listed = starts(TASK, Evaluation(starts="grid", grid_side=12, points="sparse"))
    grid = [trial.configuration for trial in listed if trial.group == "grid"]
    assert len(grid) == 144 and len(listed) == 153
    assert {configuration.target_position for configuration in grid} == {TASK.fixed.target_position}
    xs = sorted({configuration.object_position[0] for configuration in grid})
    assert xs == pytest.approx(np.linspace(-0.2 + 0.0125, 0.1 - 0.0125, 12))


def test_controls_mark_the_floor_and_the_ceiling():
    plan = Evaluation(episodes=5)
    for agent in (Nothing(), Random(0)):
        rows = evaluate(agent, TASK, plan)
        assert not any(row["success"] for row in rows) and all(row["steps"] == 200 for row in rows)
    rows = evaluate(Expert("phase"), TASK, plan)
    assert all(row["success"] and row["success_steps"] == 10 and row["steps"] < 200 for row in rows)


def test_an_episode_does_not_depend_on_which_others_run_beside_it():
    demonstrations, _ = collect(Collection(task="pick-place", method="static", timesteps=100), 0)
    policy, _ = train(demonstrations, TINY, 0)

    def ends(**which) -> dict[int, np.ndarray]:
        seen = {}
        evaluate(PolicyAgent(policy, 0), TASK, Evaluation(episodes=3), **which,
                 callback=lambda number, scene: seen.__setitem__(number, scene.keypoints()))
        return seen

    together, alone = ends(), ends(indices={1})
    assert alone.keys() == {1} and alone[1] == pytest.approx(together[1], abs=1e-3)
    assert np.abs(together[1] - together[2]).max() > 0.01


def test_watching_some_episodes_shows_what_all_together_did():
    watched = []
    rows = evaluate(Expert("phase"), TASK, Evaluation(episodes=5))
    some = evaluate(Expert("phase"), TASK, Evaluation(episodes=5), indices={1, 4},
                    callback=lambda number, scene: watched.append((number, scene.steps)))
    assert some == [rows[1], rows[4]]
    for number in (1, 4):
        assert [steps for n, steps in watched if n == number] == list(range(rows[number]["steps"] + 1))


def test_a_policys_own_configurations_are_those_it_learnt_from():
    collection = Collection(task="pick-place", method="static", timesteps=400)
    demonstrations, record = collect(collection, seed=5)
    own = record.starts
    first = np.concatenate([[0], demonstrations.episode_ends[:-1]])
    for configuration, start in zip(own, first, strict=True):
        scene = Scene(TASK, "keypoints")
        scene.reset(options={"configuration": configuration})
        assert np.array_equal(scene.observe(), demonstrations.observations[start])
    assert [trial.configuration for trial in starts(TASK, Evaluation(starts="own"), own)] == own


def test_an_attempt_that_was_discarded_is_no_configuration_that_a_policy_learnt_from():
    collection = Collection(task="box-close", method="adc", timesteps=400, expert="metaworld")
    demonstrations, record = collect(collection, seed=1)
    assert record.attempts > record.demonstrations == demonstrations.episodes
    assert len(record.starts) == len(record.grasps) == record.demonstrations


@pytest.mark.parametrize("method", ["static", "adc", "move"])
def test_at_the_grasp_the_object_has_gone_where_the_method_takes_it(method):
    _, record = collect(Collection(task="pick-place", method=method, timesteps=800), seed=5)
    gone = [np.hypot(*np.subtract(grasp.object_position, start.object_position)[:2])
            for start, grasp in zip(record.starts, record.grasps, strict=True)]
    assert max(gone) == 0 if method == "static" else min(gone) > 0.01
    assert all(start.hand_position == grasp.hand_position
               for start, grasp in zip(record.starts, record.grasps, strict=True))


def test_rows_hold_the_whole_configuration_that_was_tried():
    evaluation = Evaluation(episodes=3)
    for row, trial in zip(evaluate(Nothing(), TASK, evaluation), starts(TASK, evaluation), strict=True):
        tried = trial.configuration
        assert [row[f"hand_{axis}"] for axis in "xyz"] == list(tried.hand_position)
        assert [row[f"target_{axis}"] for axis in "xyz"] == list(tried.target_position)
        assert (row["object_z"], row["object_yaw"], row["camera_angle"]) == (
            tried.object_position[2], tried.object_yaw, tried.camera_angle)


# the figures' experiments --------------------------------------------------------------------------------------------


def test_table_2_has_ten_tasks_three_methods_and_the_papers_budgets():
    specs = table_2_from_pixels(load_profile("laptop"), seeds=1)
    budgets = {(spec.task, spec.method): spec.collection.timesteps for spec in specs}
    assert len(budgets) == 30
    sizes = paper.published("table5_data_sizes", "timesteps").set_index("task").value
    for (task, _), timesteps in budgets.items():
        assert timesteps == (20_000 if task == "box-close" else sizes[task])


def test_the_papers_profile_gives_box_close_the_papers_budget():
    budgets = {spec.collection.timesteps for spec in parameters.specs("table2_main", load_profile("paper"))
               if spec.task == "box-close" and spec.training}
    assert budgets == {100_000}


def test_the_recipe_that_is_judged_is_the_one_of_the_figures():
    chosen = {run.labels["timesteps"]: run.spec.training
              for run in parameters.runs("table_recipe", load_profile("laptop")) if run.labels["change"] == "chosen"}
    for figure in ("fig1_sparse", "table1_spatial_factors"):
        for asked_for in parameters.runs(figure, load_profile("laptop")):
            recipe = chosen[asked_for.spec.collection.timesteps]
            steps = round(asked_for.labels.get("length", 1) * recipe.gradient_steps)
            assert asked_for.spec.training == recipe.model_copy(update={"gradient_steps": steps})


def test_generalization_tries_the_policies_of_table_2_at_their_own_grasps_and_in_motion():
    profile = load_profile("laptop")
    specs = [run.spec for run in generalization.runs(profile, tasks=paper.PAPER_TASKS, seeds=(0,))]
    elsewhere, own, moving = ([spec for spec in specs if spec.evaluation.starts == layout]
                              for layout in ("random", "grasp", "moving"))
    table_2 = table_2_from_pixels(profile, seeds=1)
    policies = {spec.policy_hash for spec in table_2}
    assert {spec.hash for spec in elsewhere} == {spec.hash for spec in table_2}
    assert {spec.policy_hash for spec in own} == {spec.policy_hash for spec in moving} == policies
    assert len(specs) == 3 * len(table_2) and {spec.evaluation.episodes for spec in moving} == {100}
    for spec in own:
        assert spec.evaluation.episodes <= max(1, spec.collection.timesteps // EPISODE_STEPS)
    some = generalization.runs(profile, tasks=("push",), methods=("move",), seeds=(2,))
    assert [(run.spec.task, run.spec.method, run.spec.seed) for run in some] == [("push", "move", 2)] * 3


@pytest.mark.parametrize(("figure", "protocol", "points"), [
    ("fig1_sparse", "sparse", "sparse"), ("fig3_dense", "dense", "none"), ("fig5_circle", "circle", "circle")])
def test_the_preliminary_figures_follow_the_papers_protocol(figure, protocol, points):
    specs = parameters.specs(figure, load_profile("laptop"))
    assert {spec.collection.protocol for spec in specs} == {protocol}
    on_grids = [spec for spec in specs if spec.evaluation.starts == "grid"]
    assert {(spec.evaluation.grid_side, spec.evaluation.points) for spec in on_grids} == {(15, points), (12, points)}
    anywhere = [spec for spec in on_grids if spec.collection.factors == "object+hand"]
    for spec in anywhere:
        assert spec.evaluation.factors == "object+hand" and spec.evaluation.fixed == spec.collection.fixed == "authors"
        assert spec.collection.object_steps == {"static": None, "move": 35}[spec.method]
    assert len({spec.seed for spec in specs}) >= 3 and {spec.method for spec in specs} == {"static", "move"}
    assert {spec.observation for spec in specs} == {"rgb"}


def test_fewer_demonstrations_are_figure_1_with_two_and_five_at_a_place_and_its_own_runs_at_ten():
    few, figure_1 = (parameters.specs(name, load_profile("laptop")) for name in ("few_demonstrations", "fig1_sparse"))
    assert {spec.seed for spec in few} == {0, 1, 2} and {spec.method for spec in few} == {"static", "move"}
    assert {spec.hash for spec in few if spec.collection.timesteps == 7000} <= {spec.hash for spec in figure_1}
    static = {spec.collection.timesteps: spec.collection for spec in few if spec.method == "static"}
    made, _ = collect(static[7000].model_copy(update={"observation": "keypoints"}), 0)  # begins as with less
    begun = {budget: 1 + int((made.episode_ends < budget).sum()) for budget in static}
    assert {budget: round(episodes / 9) for budget, episodes in begun.items()} == {1550: 2, 3900: 5, 7000: 9}


def test_without_gl_no_run_of_smoke_asks_for_images(monkeypatch):
    monkeypatch.setattr(profiles, "gl_problem", lambda: "no GL")
    smoke = load_profile("smoke")
    assert not [name for name in parameters.with_runs() for spec in parameters.specs(name, smoke)
                if spec.collection and spec.observation == "rgb"]


def test_a_profile_leaves_the_notebooks_out_that_have_nothing_to_show_in_it():
    assert set(kernels.of_profile(load_profile("laptop"))) == set(names())
    assert set(names()) - set(kernels.of_profile(load_profile("paper"))) == {"table_recipe"}
    left_out = set(names()) - set(kernels.of_profile(load_profile("laptop-keypoints")))
    from_pixels_alone = {name for name in parameters.with_runs() if "observation" not in parameters.defaults(name) and {
        spec.observation for spec in parameters.specs(name, load_profile("laptop")) if spec.training} == {"rgb"}}
    assert left_out == from_pixels_alone and "gap" in left_out
    with pytest.raises(BadInput, match="profile paper: has no runs of this figure"):
        load_or_run([], load_profile("paper"), paths.BUILD)


# policies ------------------------------------------------------------------------------------------------------------


def test_a_shipped_policy_is_the_one_that_was_evaluated(stored, tmp_path, monkeypatch):
    result, _ = stored
    monkeypatch.setattr(policies.paths, "RUNS", tmp_path / "nothing")
    monkeypatch.setattr(Profile, "results", property(lambda profile: tmp_path / profile.name))
    name = result.spec.policy_hash
    shutil.copytree(tmp_path / "runs" / name / "policy", tmp_path / "laptop" / "policies" / name)
    policy = policies.trained_policy(result.spec, load_profile("laptop"))
    assert evaluate(PolicyAgent(policy, result.spec.seed), TASK, result.spec.evaluation) == result.rows


def test_a_policy_that_is_not_there_is_one_clear_line(tmp_path, monkeypatch):
    monkeypatch.setattr(policies.paths, "RUNS", tmp_path)
    with pytest.raises(BadInput, match="its policy is not shipped"):
        policies.trained_policy(tiny_run(), load_profile("smoke"))


# tables --------------------------------------------------------------------------------------------------------------


def test_what_the_spec_says_is_not_stored_and_comes_back(stored):
    result, folder = stored
    content = json.loads((folder / f"{result.spec.hash}.json").read_text())
    assert {name for name, column in content["rows"].items() if column} == {"end_success", "held", "steps",
                                                                            "success_steps"}
    assert content["rows"].keys() | {"trial", "group", "success"} == result.rows[0].keys()
    assert "object_x" not in content["collection"]["grasps"] and "camera_angle" in content["collection"]["grasps"]
    collected = results.load(result.spec, folder).collection
    assert collected == json.loads(json.dumps(result.collection))


def test_a_result_is_read_again_where_its_file_changed_and_not_otherwise(stored, monkeypatch):
    result, folder = stored
    path = folder / f"{result.spec.hash}.json"
    first = results.read(path)
    assert results.read(path) is first
    path.write_text(path.read_text().replace('"collection":', '"collection" :'))
    with pytest.raises(BadInput, match="does not fit its digest"):
        results.read(path)
