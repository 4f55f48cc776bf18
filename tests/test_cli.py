"""The command line: one clear line and exit code 2 for bad input, JSON for machines, a chain that works by hand."""

import json
import subprocess
import sys

import numpy as np
import pytest

from move import cli, paths
from move.learn import dataset
from move.report import notebooks


def move(capsys, *arguments: str) -> tuple[int, str, str]:
    """Exit code, standard output and standard error of one command, in this process."""
    with pytest.raises(SystemExit) as end, pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["move", *arguments])
        cli.main()
    out, err = capsys.readouterr()
    return end.value.code, out, err


@pytest.mark.parametrize(("arguments", "message"), [
    (("collect", "--task", "juggling"), "task: 'juggling' given; allowed are pick-place"),
    (("collect", "--method", "magic"), "method: 'magic' given; input should be 'static', 'adc', 'move' or 'mixture'"),
    (("collect", "--timesteps", "-5"), "timesteps: -5 given; input should be greater than 0"),
    (("collect", "--method", "static", "--object-speed", "0.1"), "object_speed: 0.1 given; nothing moves under"),
    (("collect", "--camera-speed", "nan"), "camera_speed: nan given"),
    (("collect", "--moving", "moon"), "'moon' given; input should be 'object', 'rotation', 'target' or 'camera'"),
    (("collect", "--moving", ""), "moving.0: '' given"),
    (("collect", "--method", "mixture"), "a mixture of nothing; allowed are shares of two methods or more"),
    (("collect", "--method", "mixture", "--shares", "half"), "shares: 'half' given; allowed are methods with numbers"),
    (("collect", "--method", "mixture", "--shares", "static=0.5,move=0.6"), "shares add up to 1.1; allowed is 1"),
    (("collect", "--timesteps", "many"), "Input should be a valid integer"),
    (("collect", "--observation", "smell"), "observation: 'smell' given"),
    (("collect", "--tiemsteps", "5"), "No such option: --tiemsteps"),
    (("train", "nowhere.zarr", "out"), "no demonstrations at nowhere.zarr"),
    (("export", "nowhere.zarr", "out"), "no demonstrations at nowhere.zarr"),
    (("export", "nowhere.zarr", "out", "--format", "hdf5"), "format: 'hdf5' given; allowed are lerobot, zarr"),
    (("evaluate", "nowhere"), "no checkpoint in nowhere"),
    (("evaluate",), "checkpoint: none given"),
    (("evaluate", "--agent", "dog"), "agent: 'dog' given; allowed are policy"),
    (("evaluate", "--agent", "nothing", "--episodes", "-1"), "episodes: -1 given"),
    (("evaluate", "--agent", "nothing", "--factors", "moon"), "factors: 'moon' given; allowed are object"),
    (("run", "--profile", "moon"), "profile: 'moon' given; allowed are"),
    (("run", "--figure", "fig99"), "figure: 'fig99' given; allowed are fig1_sparse"),
    (("plan", "--profile", "moon"), "profile: 'moon' given"),
    (("figure", "fig99"), "notebook: 'fig99' given"),
    (("figure", "fig1_sparse", "-p", "budget=5"), "no parameter budget; allowed are profile"),
    (("figure", "fig1_sparse", "-p", "timesteps=1e4"), "text to YAML"),
    (("figure", "fig1_sparse", "-p", "timesteps"), "allowed is name=value"),
    (("dance",), "No such command 'dance'"),
])
def test_bad_input_is_one_clear_line_and_exit_code_2(capsys, tmp_path, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    code, out, err = move(capsys, *arguments)
    assert (code, out) == (2, "")
    assert message in err and err.count("\n") == 1
    assert not list(tmp_path.iterdir())  # nothing half-written


def test_ctrl_c_says_how_to_go_on(capsys, monkeypatch):
    def interrupted(*arguments, **keywords):
        raise KeyboardInterrupt

    monkeypatch.setattr("move.study.execute.execute", interrupted)
    code, _, err = move(capsys, "run", "--profile", "smoke")
    assert code == 130 and "the same command goes on" in err


def test_a_results_folder_that_cannot_be_written_is_refused(capsys, tmp_path):
    (tmp_path / "file").write_text("")
    code, _, err = move(capsys, "run", "--profile", "smoke", "--results", str(tmp_path / "file"))
    assert code == 2 and "cannot write to" in err


def test_collect_train_evaluate_by_hand(capsys, tmp_path):
    data, policy = str(tmp_path / "data.zarr"), str(tmp_path / "policy")
    code, out, _ = move(capsys, "collect", "--timesteps", "200", "--out", data, "--json")
    collected = json.loads(out)
    assert code == 0 and collected["timesteps"] == 200 and collected["generation_rate"] > 0.5
    code, out, _ = move(capsys, "train", data, policy, "--profile", "smoke", "--json")
    assert code == 0 and json.loads(out)["gradient_steps"] == 60
    code, out, _ = move(capsys, "evaluate", policy, "--episodes", "3", "--json")
    evaluated = json.loads(out)
    assert code == 0 and len(evaluated["rows"]) == 3 and evaluated["low"] < evaluated["high"]
    code, _, err = move(capsys, "evaluate", policy, "--task", "push")
    assert code == 2 and "learnt 'pick-place'" in err and err.count("\n") == 1
    code, out, _ = move(capsys, "evaluate", "--agent", "expert", "--episodes", "2")
    assert code == 0 and "success_rate" in out


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


def test_every_notebook_has_parameters_and_teaches():
    for name in notebooks.names():
        content = json.loads((paths.NOTEBOOKS / f"{name}.ipynb").read_text())
        code = [cell for cell in content["cells"] if cell["cell_type"] == "code"]
        assert sum("parameters" in cell["metadata"].get("tags", []) for cell in code) == 1
        assert not any(cell["outputs"] for cell in code)
        assert sum(cell["cell_type"] == "markdown" for cell in content["cells"]) >= 2
        assert all("def " not in "".join(cell["source"]) for cell in code)  # an algorithm belongs in the package


def test_make_alone_prints_its_targets():
    listed = subprocess.run(["make"], cwd=paths.ROOT, capture_output=True, text=True, check=True).stdout
    assert all(target in listed for target in ("figures", "test", "plan", "verify", "lab", "bench", "fig1_sparse"))


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
    code, _, err = move(capsys, *arguments, "--gradient-steps", "2")
    assert code == 2 and "actions from -1.9" in err and "--clip-actions" in err and err.count("\n") == 1
    code, out, _ = move(capsys, *arguments, "--gradient-steps", "2", "--clip-actions")
    assert code == 0 and json.loads(out)["gradient_steps"] == 2


def test_export_by_hand(capsys, tmp_path):
    data, out_folder = str(tmp_path / "data.zarr"), str(tmp_path / "lerobot")
    assert move(capsys, "collect", "--timesteps", "100", "--out", data, "--json")[0] == 0
    code, out, _ = move(capsys, "export", data, out_folder, "--json")
    assert code == 0 and json.loads(out)["timesteps"] == 100
    code, _, err = move(capsys, "export", data, out_folder)
    assert code == 2 and "exists; allowed is a new folder" in err
