"""Whatever somebody does to one result's file: it is named with the reason, computed anew, and never a number."""

import hashlib
import json
import os
import re

import pytest
from recipes import tiny_run
from shared import full_disk, refused

from move.figures.page import data
from move.learn.evaluation import Evaluation
from move.sim.collect import Collection
from move.study import execute, plan, results, run, stored, verify
from move.study.labels import LabelledRun
from move.study.profiles import Profile, load_profile
from move.study.spec import ControlRun


@pytest.fixture(scope="module")
def honest(tmp_path_factory):
    """The text of the files of two results that were computed here."""
    folder = tmp_path_factory.mktemp("honest")
    made = [run.run(tiny_run(seed), folder, scratch=folder / "runs") for seed in (0, 1)]
    return [results.store(result, folder).read_text() for result in made]


def replaced(old: str, new: str):
    """An edit of the text, which has to change it."""
    def change(text: str, path, other: str) -> str:
        assert old in text
        return text.replace(old, new, 1)
    return change


def whole(new: str):
    return lambda text, path, other: new


def edited(change):
    """A change of the content whose digest is left as it was."""
    def with_old_digest(text: str, path, other: str) -> str:
        content = json.loads(text)
        change(content)
        return json.dumps(content)
    return with_old_digest


def forged(change):
    """A change of the content under a digest that fits."""
    def with_new_digest(text: str, path, other: str) -> str:
        content = json.loads(text)
        change(content)
        return stored.with_digest({name: value for name, value in content.items() if name != "digest"})
    return with_new_digest


def forged_text(body: str):
    """Any text under a digest that fits."""
    digest = hashlib.sha256(body.encode()).hexdigest()
    return lambda text, path, other: f'{{"digest":"{digest}",{body[1:]}'


def rows(**columns):
    """Columns changed by functions; None takes a column away."""
    def change(content):
        for name, make in columns.items():
            old = content["rows"].pop(name)
            if make is not None:
                content["rows"][name] = make(old)
    return change


def each_row(make):
    return lambda content: content.update(rows={name: column and make(column)
                                                for name, column in content["rows"].items()})


def as_a_link(to_other: bool):
    def change(text: str, path, other: str) -> None:
        path.unlink(missing_ok=True)
        target = path.with_name("elsewhere")
        target.write_text(other if to_other else text)
        path.symlink_to(target)
    return change


def as_a_folder(text: str, path, other: str) -> None:
    path.unlink(missing_ok=True)
    path.mkdir()
    (path / "inside").write_text("kept")


def as_a_pipe(text: str, path, other: str) -> None:
    path.unlink(missing_ok=True)
    os.mkfifo(path)


DIGEST = "does not fit its digest"
FLIP = {"success_steps": lambda old: [10 * (not old[0]), *old[1:]]}
TAMPERED = [  # what is done, the reason that is told, None where the file stays usable
    ("outcome flipped", edited(rows(**FLIP)), DIGEST),
    ("a digit changed", replaced('"steps":[200', '"steps":[199'), DIGEST),
    ("seconds", edited(lambda c: c["seconds"].update(train=1.0)), DIGEST),
    ("curve", edited(lambda c: c["training"]["curve"].reverse()), DIGEST),
    ("spec", edited(lambda c: c["spec"].update(seed=7)), DIGEST),
    ("a row dropped", edited(each_row(lambda column: column[1:])), DIGEST),
    ("no digest", edited(lambda c: c.pop("digest")), DIGEST),
    ("cut in the middle", lambda text, path, other: text[: len(text) // 2], DIGEST),
    ("zero bytes", whole("\0" * 500), DIGEST),
    ("not text", lambda text, path, other: path.write_bytes(b"\xff\xfe\xfa") and None, DIGEST),
    ("null", whole("null"), DIGEST),
    ("an empty object", whole("{}"), DIGEST),
    ("deep nesting", whole("[" * 200_000), DIGEST),
    ("a huge number", replaced('"seed":0', f'"seed":1{"0" * 6000}'), DIGEST),
    ("a copy under another name", lambda text, path, other: other, "holds another spec"),
    ("a link to another result", as_a_link(True), "holds another spec"),
    ("a folder", as_a_folder, "it is no file"),
    ("a pipe", as_a_pipe, "it is no file"),
    ("a link to a good copy", as_a_link(False), None),
    ("other white space", lambda text, path, other: json.dumps(json.loads(text), indent=3), DIGEST),
    ("a key twice, the last as it was", replaced('{"digest"', '{"digest":"x","digest"'), DIGEST),
    ("forged: no JSON", forged_text("{"), "invalid json"),
    ("forged: deep nesting", forged_text('{"spec":' + "[" * 200_000), "recursion limit"),
    ("forged: a huge number", forged(lambda c: c["spec"].update(seed=10**4000)), "spec"),
    ("forged: a list", forged_text("{}"), "field required"),
    ("forged: half the rows", forged(each_row(lambda column: column[:2])), "this run has 3"),
    ("forged: a column that the spec does not say", forged(lambda c: c["rows"].update(invented=None)), "invented"),
    ("forged: no outcome", forged(rows(success_steps=None)), "no success_steps"),
    ("forged: success text", forged(rows(success_steps=lambda old: ["yes", *old[1:]])), "success_steps.0: .*integer"),
    ("forged: success beyond its end", forged(rows(success_steps=lambda old: [11, *old[1:]])), "success_steps.0: .*10"),
    ("forged: NaN", forged(rows(object_x=lambda old: [float("nan")] * 3)), "rows.object_x.*0: .*finite"),
    ("forged: steps beyond the episode", forged(rows(steps=lambda old: [201, *old[1:]])), "rows.steps.0: .*200"),
    ("forged: no processor", forged(lambda c: c["provenance"].pop("processor")), "provenance.processor: .*required"),
    ("forged: no training", forged(lambda c: c.update(training=None)), "training: not as a policy's"),
    ("forged: seconds that could be", forged(lambda c: c["seconds"].update(train=1.0)), None),  # `verify` cannot know
    ("forged: outcome", forged(rows(**FLIP)), None),
]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A results folder of the profile, and build/ elsewhere."""
    monkeypatch.setattr(Profile, "results", property(lambda profile: tmp_path / "results"))
    monkeypatch.setattr(run, "RUNS", tmp_path / "runs")
    (tmp_path / "results").mkdir()
    return tmp_path / "results"


def tamper(change, honest, folder):
    """The first result, tampered with, and the second as it is; the file of the first."""
    path, beside = (folder / f"{tiny_run(seed).hash}.json" for seed in (0, 1))
    beside.write_text(honest[1])
    path.write_text(honest[0])
    text = change(honest[0], path, honest[1])
    if text is not None:
        path.write_text(text)
    return path


@pytest.mark.parametrize(("change", "reason"), [row[1:] for row in TAMPERED], ids=[row[0] for row in TAMPERED])
def test_one_bad_file_is_one_bad_file(honest, folder, change, reason, monkeypatch):
    path, profile = tamper(change, honest, folder), load_profile("smoke")
    specs = [tiny_run(0), tiny_run(1)]
    there, missing = results.split(specs, folder)
    (row,) = plan.plan_rows(profile, {"figure": specs})
    checked = {line["file"]: line for line in verify.check_files(folder)}
    monkeypatch.setenv("MOVE_STORED_ONLY", "1")
    drawn = data.load_or_run([LabelledRun(one, {}) for one in specs], profile, folder)
    if reason is None:
        assert len(there) == 2 and row["why"] == "complete" and checked[path.name]["same"]
        assert "MISSING" not in drawn.source
        return
    assert [result.spec for result in there] == [specs[1]] == [result.spec for result in drawn.results]
    for told in (missing[0][1], row["why"], drawn.source):
        assert re.search(f"{path} is not usable: .*{reason}", told) and "\n" not in told
    told = checked[path.name]
    assert not told["same"] and re.search(f"{reason}|is the run", told["difference"])
    assert checked[f"{specs[1].hash}.json"]["same"]


def test_a_collection_may_end_before_its_budget_only_with_the_demonstrations_asked_for(tmp_path):
    ended = tiny_run().model_copy(update={"collection": Collection(
        task="pick-place", method="static", timesteps=400, demonstrations=2)})
    path = results.store(run.run(ended, tmp_path, scratch=tmp_path / "runs"), tmp_path)
    record = results.read(path).collection
    assert record["demonstrations"] == 2 and record["timesteps"] < 400
    for name, value, reason in (("timesteps", 401, "another budget"), ("demonstrations", 1, "another budget"),
                                ("demonstrations", 3, "another budget")):
        text = forged(lambda content, name=name, value=value: content["collection"].update({name: value}))(
            path.read_text(), path, "")
        with pytest.raises(ValueError, match=reason):
            stored.from_bytes(text.encode())


@pytest.mark.parametrize("tried", [
    Evaluation(episodes=2), Evaluation(starts="moving", episodes=2), Evaluation(starts="listed"),
    Evaluation(starts="listed", episodes=3),
    Evaluation(starts="grid", grid_side=2, points="sparse"), Evaluation(starts="grid", grid_side=2, points="circle"),
], ids=lambda tried: f"{tried.starts} {tried.points}")
def test_every_way_to_choose_configurations_is_read_as_it_was_stored(tmp_path, tried):
    made = run.run(ControlRun(task="pick-place", seed=0, agent="nothing", evaluation=tried), tmp_path)
    assert results.read(results.store(made, tmp_path)).rows == made.rows


def test_verify_has_a_row_for_an_unusable_file(honest, folder, monkeypatch):
    path = tamper(whole("null"), honest, folder)
    monkeypatch.setattr(verify, "draw_sample", lambda *arguments: [])
    (row,) = verify.verify([tiny_run(0), tiny_run(1), tiny_run(2)], folder, 1, None)
    assert not row["same"] and str(path) in row["difference"] and DIGEST in row["difference"]


@pytest.mark.parametrize("change", [whole("null"), as_a_folder, as_a_pipe])
def test_run_sets_a_bad_file_aside_and_computes_anew(honest, folder, change, monkeypatch, capfd):
    from test_study import Here

    monkeypatch.setattr(execute, "ProcessPool", lambda workers: Here())
    path = tamper(change, honest, folder)
    path.with_suffix(".bad").write_text("an older one")
    there, missing = execute.execute([tiny_run(0), tiny_run(1)], folder, quiet=True)
    assert len(there) == 2 and not missing
    assert json.loads(path.read_text())["rows"] == json.loads(honest[0])["rows"]
    aside = path.with_suffix(".1.bad")
    assert aside.exists() and path.with_suffix(".bad").read_text() == "an older one"
    told = capfd.readouterr().err
    assert told.count("\n") == 1 and f"{path} is not usable" in told and aside.name in told


def test_a_full_disk_is_one_line_and_leaves_nothing(honest, tmp_path, monkeypatch):
    (tmp_path / f"{tiny_run(0).hash}.json").write_text(honest[0])
    result = results.load(tiny_run(0), tmp_path)

    def full(self, text):
        self.touch()
        full_disk()

    monkeypatch.setattr("pathlib.Path.write_text", full)
    with refused("cannot write .*: No space left on device"):
        results.store(result, tmp_path / "full")
    assert not list((tmp_path / "full").iterdir())


def test_missing_runs_are_named_a_few_and_the_bad_ones_first():
    bad = tiny_run(9), "result x is not usable: y"
    missing = [*((tiny_run(seed), results.NOT_COMPUTED) for seed in range(4)), bad]
    words = results.missing_in_words(missing, shown=2)
    assert words == f"{tiny_run(9).label} (result x is not usable: y), {tiny_run(0).label}, 3 more"
    assert results.missing_in_words(missing[:1]) == tiny_run(0).label
    other_evaluation = tiny_run(0).model_copy(update={"evaluation": Evaluation(episodes=7)})
    twice = [*missing[:1], (other_evaluation, results.NOT_COMPUTED)]
    assert results.missing_in_words(twice) == f"2 x {tiny_run(0).label}"
