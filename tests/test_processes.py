"""A process that dies costs its run alone, no process outlives the command, and two runs never share a simulator."""

import os
import subprocess
import sys
import threading
import time
from contextlib import suppress

import psutil
import pytest
from shared import refused

from move import paths
from move.errors import BadInput
from move.study import execute, processes, run
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


@pytest.mark.slow
def test_a_tortured_grid_ends_as_an_undisturbed_one(tmp_path):
    done = subprocess.run([sys.executable, paths.ROOT / "tools" / "torture.py", "--kills", "20"],
                          env={**os.environ, "PYTHONPATH": str(paths.ROOT)}, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
