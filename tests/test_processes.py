"""A process that dies costs its run alone, no process outlives the command, and two runs never share a simulator."""

import os
import random
import shutil
import subprocess
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path

import psutil
import pytest
from shared import refused

from move import paths
from move.errors import BadInput
from move.study import execute, processes, results, run
from move.study.kinds import control_run
from move.study.processes import Processes, RunFailed
from move.study.provenance import deciding

SPECS = [control_run(task="pick-place", agent="nothing", seed=seed, episodes=1) for seed in range(2)]


def test_a_killed_process_costs_its_run_alone_and_the_same_command_goes_on(tmp_path, monkeypatch):
    started = processes.Processes._start

    def start(pool, spec, *arguments):
        process = started(pool, spec, *arguments)
        if spec.seed == 0:
            process.kill()
        return process

    monkeypatch.setattr(processes.Processes, "_start", start)
    there, missing = execute.execute(SPECS, tmp_path / "results", workers=1, quiet=True)
    assert [result.spec for result in there] == SPECS[1:]
    assert [(spec, why) for spec, why in missing] == [
        (SPECS[0], "failed: its process died of SIGKILL; the same command goes on with it")]
    monkeypatch.undo()
    there, missing = execute.execute(SPECS, tmp_path / "results", workers=2, quiet=True)
    assert not missing
    assert [result.rows for result in there] == [run.run(spec, tmp_path / "here").rows for spec in SPECS]


@pytest.mark.parametrize(("spec", "there", "problem"), [
    (SPECS[0], {"source": "other"}, "its process has source .*: the source was changed meanwhile"),
    (SPECS[0].model_copy(update={"results_version": 2}), {}, "results_version: 2 given"),
])
def test_what_goes_wrong_in_a_process_is_one_line_here(tmp_path, monkeypatch, spec, there, problem):
    monkeypatch.setattr(processes, "deciding", lambda: deciding() | there)
    with refused(problem, RunFailed):
        Processes().compute(spec, tmp_path)


def test_once_ended_no_process_is_started(tmp_path):
    pool = Processes()
    pool.end()
    with pytest.raises(RunFailed, match="interrupted"):
        pool.compute(SPECS[0], tmp_path)


def test_two_runs_in_one_process_are_refused(tmp_path, monkeypatch):
    problems = []

    def evaluate(*arguments, **keywords):
        thread = threading.Thread(target=lambda: problems.append(pytest.raises(
            BadInput, run.run, SPECS[1], tmp_path)))
        thread.start()
        thread.join()
        return real(*arguments, **keywords)

    real = run.evaluate
    monkeypatch.setattr(run, "evaluate", evaluate)
    run.run(SPECS[0], tmp_path)
    assert problems[0].match("another run is under way in this process")
    monkeypatch.undo()
    assert run.run(SPECS[1], tmp_path).rows


def test_a_run_that_is_stored_is_not_computed_again(tmp_path, monkeypatch):
    monkeypatch.setattr(run, "RUNS", tmp_path / "runs")
    run.run(SPECS[0], tmp_path)
    monkeypatch.setattr(run, "run", lambda *arguments: 1 / 0)
    assert run.run_and_report(SPECS[0], tmp_path) == SPECS[0].hash
    (tmp_path / f"{SPECS[0].hash}.json").write_text("null")
    with pytest.raises(ZeroDivisionError):
        run.run_and_report(SPECS[0], tmp_path)


# orphans -------------------------------------------------------------------------------------------------------------

PARENT = """
from pathlib import Path
from move.study.kinds import control_run
from move.study.processes import Processes
Processes().compute(control_run(task="pick-place", agent="expert", episodes=99), Path("results"))
"""


@pytest.mark.parametrize("seconds", [0.0, 1.0])
def test_no_process_outlives_the_one_that_started_it(tmp_path, seconds):
    """Killed so many seconds after the process of a run began: before and while that imports what is slow."""
    parent = psutil.Popen([sys.executable, "-c", PARENT], cwd=tmp_path,
                          env={**os.environ, "PYTHONPATH": str(paths.ROOT), "MOVE_ROOT": str(tmp_path)})
    while len(workers := parent.children(recursive=True)) < 2 + (sys.platform == "linux"):  # multiprocessing's too
        time.sleep(0.001)
    time.sleep(seconds)
    parent.kill()
    parent.wait()
    gone, alive = psutil.wait_procs(workers, timeout=60)
    assert gone and not alive


def test_notebook_kernel_and_workers_end_with_the_command_that_draws_a_figure(tmp_path):
    for name in ("profiles", "notebooks"):
        (tmp_path / name).symlink_to(paths.ROOT / name)
    command = psutil.Popen([sys.executable, "-m", "move.cli", "figure", "keypoint_control", "--profile", "smoke"],
                           env={**os.environ, "PYTHONPATH": str(paths.ROOT), "MOVE_ROOT": str(tmp_path)},
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def computes() -> bool:
        with suppress(psutil.Error):  # one of them may end while it is asked
            for child in command.children(recursive=True):
                words = " ".join(child.cmdline())
                if "--multiprocessing-fork" in words or "forkserver" in words and child.children():
                    return True
        return False

    while not computes():
        time.sleep(0.05)
        assert command.poll() is None
    started = command.children(recursive=True)
    command.kill()
    command.wait()
    assert psutil.wait_procs(started, timeout=60)[1] == []


def test_a_process_whose_parent_is_gone_already_ends_at_once():
    code = "from move.machine import end_with; end_with(1); print('still here')"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60,
                          env={**os.environ, "PYTHONPATH": str(paths.ROOT)})
    assert done.returncode == 1 and done.stdout == ""


def test_where_the_kernel_does_not_help_a_thread_sees_that_the_parent_is_gone(tmp_path):
    """As on macOS: the same without the signal that Linux sends."""
    worker = ("import sys; sys.platform = 'other'; from move.machine import end_with; import os, time\n"
              "end_with(int(sys.argv[1])); print(os.getpid(), flush=True); time.sleep(60)")
    code = ("import os, subprocess, sys\n"
            "subprocess.Popen([sys.executable, '-c', sys.argv[1], str(os.getpid())]).wait()")
    parent = subprocess.Popen([sys.executable, "-c", code, worker], stdout=subprocess.PIPE,
                              env={**os.environ, "PYTHONPATH": str(paths.ROOT)})
    process = psutil.Process(int(parent.stdout.readline()))
    parent.kill()
    parent.wait()
    assert psutil.wait_procs([process], timeout=10)[1] == []


# a command that is killed --------------------------------------------------------------------------------------------

TINY = """
purpose: two short trainings
stamp: TINY
image_size: 48
training:
  keypoints: {encoder: keypoints, denoiser: mlp, gradient_steps: 300, warmup_steps: 10, batch_size: 32,
              learning_rate: 1.0e-3, ema_decay: 0.9, mlp_width: 64}
notebooks: {keypoint_control: {timesteps: [120], seeds: 1, episodes: 2}}
minutes: {keypoints: 0.1}
"""


def content(build: Path) -> dict[str, object]:
    """What has to be the same: of each result what a repetition gives again, and the weights of each policy."""
    found: dict[str, object] = {}
    for path in build.glob("results/*/*.json"):
        result = results.read(path)
        record = {**(result.collection or {}), "seconds": 0}
        found[path.name] = result.rows, record, (result.training or {}).get("curve")
    weights = build.glob("runs/*/policy/tensors-*")
    return found | {str(path.relative_to(build)): path.read_bytes() for path in weights}


@pytest.mark.slow
def test_a_command_that_is_killed_again_and_again_ends_as_an_undisturbed_one(tmp_path):
    """Killed is the command alone, with all that it started, or one of these, at a random moment before its end."""
    build, chance = tmp_path / "build", random.Random(0)
    shutil.copytree(paths.ROOT / "profiles", tmp_path / "profiles")
    (tmp_path / "profiles/tiny.yaml").write_text(TINY)
    (tmp_path / "notebooks").symlink_to(paths.ROOT / "notebooks")
    variables = {"PYTHONPATH": str(paths.ROOT), "MOVE_ROOT": str(tmp_path), "MOVE_CHECKPOINT_SECONDS": "0.1"}

    def start() -> psutil.Popen:
        arguments = ["run", "keypoint_control", "--profile", "tiny", "--workers", "2"]
        return psutil.Popen([sys.executable, "-m", "move.cli", *arguments], env=os.environ | variables,
                            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    began = time.monotonic()
    assert start().wait() == 0
    seconds, expected = time.monotonic() - began, content(build)
    shutil.rmtree(build)
    for target in ("command", "all", "one") * 7:
        command, children = start(), []
        with suppress(psutil.TimeoutExpired):
            command.wait(chance.uniform(0, 0.6 * seconds))
        with suppress(psutil.NoSuchProcess):  # what has ended by itself
            children = command.children(recursive=True)
            victims = {"command": [command], "all": [command, *children], "one": children and [chance.choice(children)]}
            for victim in victims[target]:
                victim.kill()
        code = command.wait()
        assert psutil.wait_procs(children, timeout=60)[1] == []
        found = content(build)
        assert all(expected.get(name, made) == made for name, made in found.items()), "torn"
        if code == 0:
            assert found == expected
            shutil.rmtree(build)
    assert start().wait() == 0 and content(build) == expected
    assert not [path for path in build.rglob("*") if path.suffix in (".part", ".old")]
