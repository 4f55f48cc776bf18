"""The command line: JSON for machines, a chain that works by hand, help that lists what is allowed, no traceback."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from safetensors import SafetensorError
from shared import full_disk, move

from move import machine, paths
from move.figures import named
from move.learn import checkpoint, dataset
from move.sim.collect import Collection, collect
from move.study.doctor import examine, locked_versions


def test_ctrl_c_says_how_to_go_on(capsys, monkeypatch):
    def interrupted(*arguments, **keywords):
        raise KeyboardInterrupt

    monkeypatch.setattr("move.study.execute.execute", interrupted)
    code, _, err = move(capsys, "run", "--profile", "smoke")
    assert code == 130 and "the same command goes on" in err


def test_collect_train_evaluate_by_hand(capsys, tmp_path):
    data, policy = str(tmp_path / "data.zarr"), str(tmp_path / "policy")
    code, out, _ = move(capsys, "collect", "--task", "push", "--timesteps", "200", "--out", data, "--json")
    collected = json.loads(out)
    assert code == 0 and collected["timesteps"] == 200 and collected["generation_rate"] > 0.5
    code, out, _ = move(capsys, "train", data, policy, "--profile", "smoke", "--json")
    assert code == 0 and json.loads(out)["gradient_steps"] == 60
    code, out, _ = move(capsys, "evaluate", policy, "--episodes", "3", "--json")
    evaluated = json.loads(out)
    assert code == 0 and len(evaluated["rows"]) == 3 and evaluated["low"] < evaluated["high"]
    assert evaluated["task"] == "push", "which it learnt"
    code, _, err = move(capsys, "evaluate", policy, "--task", "pick-place")
    assert code == 2 and "learnt 'push'" in err and err.count("\n") == 1
    code, out, _ = move(capsys, "evaluate", "--agent", "expert", "--episodes", "2")
    assert code == 0 and "success_rate" in out
    assert move(capsys, "train", data, policy, "--profile", "smoke", "--json")[0] == 0  # goes on from what it holds


def test_a_policy_whose_data_name_no_task_is_evaluated_where_it_is_told_to(capsys, tmp_path):
    made, _ = collect(Collection(task="push", method="static", timesteps=100), 0)
    dataset.save(made, tmp_path / "data.zarr", {})
    policy = str(tmp_path / "policy")
    assert move(capsys, "train", str(tmp_path / "data.zarr"), policy, "--profile", "smoke",
                "--gradient-steps", "2")[0] == 0
    code, _, err = move(capsys, "evaluate", policy, "--episodes", "1")
    assert code == 2 and "data that name no task; --task says where" in err and err.count("\n") == 1
    code, out, _ = move(capsys, "evaluate", policy, "--task", "push", "--episodes", "1", "--json")
    assert code == 0 and json.loads(out)["task"] == "push"


def test_a_data_set_is_replaced_only_when_told_to(capsys, tmp_path):
    data = tmp_path / "data.zarr"
    collect = ("collect", "--timesteps", "50", "--out", str(data), "--json")
    assert move(capsys, *collect)[0] == 0
    code, _, err = move(capsys, *collect, "--seed", "1")
    assert code == 2 and "data.zarr exists; allowed is a new folder, or --overwrite" in err
    assert dataset.load(data)[1]["seed"] == 0
    assert move(capsys, *collect, "--seed", "1", "--overwrite")[0] == 0
    assert dataset.load(data)[1]["seed"] == 1 and [path.name for path in tmp_path.iterdir()] == ["data.zarr"]


@pytest.mark.parametrize("command", ["collect", "export"])
def test_a_full_disk_is_one_line_and_leaves_nothing(capsys, tmp_path, monkeypatch, command):
    data = str(tmp_path / "data.zarr")
    assert move(capsys, "collect", "--timesteps", "50", "--out", data, "--json")[0] == 0

    def full(demonstrations, folder, attributes):
        folder.mkdir(parents=True)
        (folder / "half").write_text("half")
        full_disk()

    monkeypatch.setattr(dataset, "_write", full)
    monkeypatch.setattr("move.exchange.export.write_lerobot", full)
    arguments = {"collect": ("--timesteps", "50", "--out", data, "--overwrite"),
                 "export": (data, str(tmp_path / "out"))}
    code, out, err = move(capsys, command, *arguments[command])
    assert (code, out, err.count("\n")) == (2, "", 1) and "No space left on device" in err
    monkeypatch.undo()
    assert [path.name for path in tmp_path.iterdir()] == ["data.zarr"] and dataset.load(data)[0].timesteps == 50


@pytest.mark.parametrize("file, error", [
    ("tensors", OSError(28, "No space left on device")),
    ("tensors", SafetensorError("Error while serializing: I/O error: No space left on device (os error 28)")),
    ("record", OSError(28, "No space left on device")),
])
def test_a_disk_full_while_training_is_one_line_and_the_checkpoint_before_stays(
        capsys, tmp_path, monkeypatch, file, error):
    data, policy = str(tmp_path / "data.zarr"), tmp_path / "policy"
    assert move(capsys, "collect", "--timesteps", "50", "--out", data, "--json")[0] == 0
    train = ("train", data, str(policy), "--profile", "smoke", "--gradient-steps", "3", "--json")
    monkeypatch.setattr("move.learn.train.CHECKPOINT_SECONDS", 0.0)  # one after each step
    real, writes = {"tensors": checkpoint.save_file, "record": Path.write_text}[file], []

    def full(*arguments):
        path = next(argument for argument in arguments if isinstance(argument, Path))
        writes.append(path)
        if len(writes) == 1:
            return real(*arguments)
        path.write_bytes(b"half")
        raise error

    monkeypatch.setattr(*{"tensors": (checkpoint, "save_file"), "record": (Path, "write_text")}[file], full)
    code, out, err = move(capsys, *train)
    monkeypatch.undo()
    assert (code, out, err.count("\n")) == (2, "", 1) and "No space left on device" in err and len(writes) == 2
    assert checkpoint.read(policy).step == 1
    names = {path.name for path in policy.iterdir()}
    assert {"run.json", "tensors-0000001.safetensors"} <= names
    assert names <= {"run.json", "tensors-0000001.safetensors", "tensors-0000002.safetensors", "lock"}
    assert move(capsys, *train)[0] == 0 and checkpoint.read(policy).finished  # once there is room


@pytest.mark.parametrize("output, code", [(">/dev/full", 2), (">&-", 0), ("| true", 1)])
def test_an_output_that_takes_nothing_is_no_traceback(output, code):
    command = f"set -o pipefail; {sys.executable} -m move.cli doctor --json {output}"
    done = subprocess.run(["bash", "-c", command], cwd=paths.ROOT, capture_output=True, text=True)
    assert done.returncode == code and "Traceback" not in done.stderr and done.stderr.count("\n") <= 1
    assert code != 2 or "No space left on device" in done.stderr


def test_help_lists_what_is_allowed_and_gives_examples(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "300")
    for command in ("collect", "export", "train", "evaluate", "run", "plan", "verify", "figure", "doctor", "mark"):
        code, out, _ = move(capsys, command, "--help")
        assert code == 0 and f"move {command}" in out.split("Examples:")[1]
    code, out, _ = move(capsys, "evaluate", "--help")
    assert all(word in "".join(out.split()) for word in ("goal-blind", "random|moving|grid", "disassemble"))
    code, out, _ = move(capsys)
    assert code == 0 and "--install-completion" in out


def test_figures_and_methods_are_completed():
    def complete(line: str) -> list[str]:
        variables = {"_MOVE_COMPLETE": "complete_bash", "COMP_WORDS": line, "COMP_CWORD": str(len(line.split(" ")) - 1),
                     "PATH": "/usr/bin:/bin"}
        program = "from move.cli import main; main()"
        return subprocess.run([sys.executable, "-c", program], cwd=paths.ROOT, env=variables, capture_output=True,
                              text=True).stdout.split()

    assert complete("move figure fig1") == ["fig1", "fig1_sparse"]
    assert complete("move collect --method s") == ["static"]


def test_short_and_long_names_mean_the_same_figure(capsys):
    rows = [json.loads(move(capsys, "plan", name, "--profile", "smoke", "--json")[1])
            for name in ("fig1", "fig1_sparse")]
    assert rows[0] == rows[1] and [row["figure"] for row in rows[0]] == ["fig1_sparse"]
    assert (named("fig8"), named("table3")) == ("fig8_real_setup", "table3_real")


def test_a_plan_tells_what_a_change_would_cost(capsys):
    def runs(*more: str) -> int:
        return json.loads(move(capsys, "plan", "fig1", "--profile", "smoke", *more, "--json")[1])[0]["runs"]

    assert runs("-p", "seeds=7", "-p", "near_hands=0", "-p", "identical_starts=0", "-p", "lengths=[]") == 14 != runs()


@pytest.mark.parametrize("name, message, code, line", [
    ("BadInput", "label: run given", 2, "label: run given"),
    ("ValidationError", "1 validation error for Trial\nsize\n  Too small [type=x, input_value=-4, input_type=int]\n"
     "    For further information visit https://errors.pydantic.dev", 2, "size: -4 given; Too small"),
    ("KeyError", "first line\nsecond line", 1, "fig1_sparse.ipynb failed: KeyError: first line second line"),
])
def test_what_fails_inside_a_notebook_is_told_in_one_useful_line(capsys, monkeypatch, name, message, code, line):
    from papermill.exceptions import PapermillExecutionError

    def fail(*_, **__):
        raise PapermillExecutionError(1, 1, "source", name, message, [])

    monkeypatch.setattr("papermill.execute_notebook", fail)
    ended, out, err = move(capsys, "figure", "fig1", "--profile", "smoke", "--stored-only")
    assert (ended, out) == (code, "") and err.splitlines()[-1].startswith(f"move: {line}")
    assert err.splitlines()[0] == "notebook fig1_sparse (1 of 1) (smoke) ..."


def test_a_mixture_with_motions_of_ones_own_by_hand(capsys, tmp_path):
    code, out, _ = move(capsys, "collect", "--timesteps", "201", "--out", str(tmp_path / "data.zarr"), "--json",
                        "--method", "mixture", "--shares", "static=0.5,move=0.5", "--object-speed", "0.05",
                        "--target-speed", "0.01", "--camera-speed", "0.1", "--moving", "target,object,camera")
    assert code == 0 and json.loads(out)["timesteps"] == 201
    _, attributes = dataset.load(tmp_path / "data.zarr")
    stored = attributes["collection"]
    assert stored["shares"] == [["static", 0.5], ["move", 0.5]] and stored["moving"] is None
    assert (stored["object_speed"], stored["target_speed"], stored["camera_speed"]) == (0.05, 0.01, 0.1)


def test_plan_and_doctor_speak_json(capsys):
    code, out, _ = move(capsys, "plan", "--profile", "smoke", "--json")
    assert code == 0 and {row["figure"] for row in json.loads(out)} >= {"fig1_sparse", "keypoint_control"}
    code, out, _ = move(capsys, "doctor", "--json")
    checks = {check["check"]: check for check in json.loads(out)}
    assert {"GL", "processor", "memory"} <= set(checks)
    assert code == (1 if any(check["outcome"] == "broken" for check in checks.values()) else 0)


def test_doctor_checks_the_pins_that_hold_for_this_platform_alone():
    pins = locked_versions(paths.LOCK.read_text())
    assert len(pins) > 180 and {"numpy", "scipy", "zarr", "numcodecs", "av", "torch"} <= set(pins)
    assert ("pywin32" in pins) is (sys.platform == "win32")
    assert all(check["mend"] for check in examine() if check["outcome"] != "fine")


@pytest.mark.parametrize("value", ["disable", "disabled", "OFF", "false ", "0"])
def test_every_word_by_which_mujoco_turns_images_off_is_known(value, monkeypatch):
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setenv("MUJOCO_GL", value)
    assert "libegl1" in machine.gl_problem()


def test_without_gl_there_is_one_clear_line_and_keypoints_go_on():
    program = ("from move.machine import gl_problem; from move.sim.scene.scene import Scene\n"
               "from move.errors import BadInput\n"
               "assert 'libegl1' in gl_problem() and '\\n' not in gl_problem()\n"
               "Scene().reset(seed=0)\n"
               "try: Scene(observation='rgb')\n"
               "except BadInput as problem: print(problem)")
    done = subprocess.run([sys.executable, "-c", program], env={"MUJOCO_GL": "disable", "PATH": "/usr/bin:/bin"},
                          capture_output=True, text=True, cwd=paths.ROOT)
    assert done.returncode == 0, done.stderr
    assert "apt-get install libegl1" in done.stdout


def test_training_on_the_authors_published_images(capsys, tmp_path):
    from test_dataset import published

    actions = np.random.default_rng(0).uniform(-2, 2, (60, 4)).astype(np.float32)
    published(tmp_path / "p.zarr", actions)
    arguments = ("train", str(tmp_path / "p.zarr"), str(tmp_path / "policy"), "--profile", "smoke", "--json")
    code, out, err = move(capsys, *arguments, "--gradient-steps", "2")
    assert code == 0 and json.loads(out)["gradient_steps"] == 2
    assert "actions from -1.9" in err and "--clip-actions" in err and err.count("\n") == 1
    code, _, err = move(capsys, *arguments, "--gradient-steps", "2", "--clip-actions")
    assert code == 2 and "another run: data" in err
    code, out, err = move(capsys, *arguments[:2], str(tmp_path / "clipped"), *arguments[3:], "--gradient-steps", "2",
                          "--clip-actions")
    assert (code, err) == (0, "") and json.loads(out)["gradient_steps"] == 2


def test_export_by_hand(capsys, tmp_path):
    data, out_folder = str(tmp_path / "data.zarr"), str(tmp_path / "lerobot")
    assert move(capsys, "collect", "--timesteps", "100", "--out", data, "--json")[0] == 0
    code, out, _ = move(capsys, "export", data, out_folder, "--json")
    assert code == 0 and json.loads(out)["timesteps"] == 100
    code, _, err = move(capsys, "export", data, out_folder)
    assert code == 2 and "exists; allowed is a new folder" in err
