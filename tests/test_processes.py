"""A process that dies costs its run alone, no process outlives the command, and two runs never share a simulator."""

import os
import subprocess
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path

import psutil
import pytest

from move import paths
from move.errors import BadInput
from move.study import execute, processes, run
from move.study.kinds import control_run
from move.study.processes import Processes, RunFailed

SPECS = [control_run(task="pick-place", agent="nothing", seed=seed, episodes=1) for seed in range(2)]
FAKE = """
import json, os, signal, sys
from contextlib import suppress
from pathlib import Path
sys.path.insert(0, {root!r})
from move.machine import end_with
end_with(int(sys.argv[1]))
for line in sys.stdin:
    asked = json.loads(line)
    seed, folder = json.loads(asked["spec"])["seed"], Path(asked["folder"])
    with (folder / f"tries-{{seed}}").open("a") as tries:
        tries.write(f"{{os.getpid()}}\\n")
    if seed < len(open(folder / "deaths").read()) and len((folder / f"tries-{{seed}}").open().readlines()) <= int(
            open(folder / "deaths").read()[seed]):
        os.kill(os.getpid(), signal.SIGKILL)
    print(json.dumps("no luck" if seed == 9 else None), flush=True)
"""


@pytest.fixture
def fake(tmp_path, monkeypatch):
    """A worker that imports nothing slow: run `seed` kills it as often as the file "deaths" says at that place."""
    (tmp_path / "fake.py").write_text(FAKE.format(root=str(paths.ROOT)))
    monkeypatch.setattr(processes, "COMMAND", [sys.executable, str(tmp_path / "fake.py")])
    (tmp_path / "deaths").write_text("")
    return tmp_path


def tries(folder: Path, seed: int) -> list[str]:
    return (folder / f"tries-{seed}").read_text().split()


def spec(seed: int):
    return control_run(task="pick-place", agent="nothing", seed=seed)


def test_a_run_whose_process_dies_is_tried_again_in_a_fresh_one(fake):
    (fake / "deaths").write_text("2")
    pool = Processes()
    assert pool.compute(spec(0), fake) == spec(0).hash
    assert pool.compute(spec(1), fake) == spec(1).hash
    assert len(set(tries(fake, 0))) == 3 and tries(fake, 1) == tries(fake, 0)[2:]  # the last one goes on
    pool.end()


def test_after_three_deaths_it_has_failed_and_the_others_go_on(fake):
    (fake / "deaths").write_text("090")
    with execute.process_pool(1) as pool:
        futures = [pool.submit(spec(seed), fake) for seed in (0, 1, 2, 9)]
        errors = [future.exception(30) for future in futures]
    assert [str(error) for error in errors] == [
        "None", "its process died 3 times, the last time by SIGKILL", "None", "no luck"]
    assert len(tries(fake, 1)) == 3


def test_a_thread_has_a_process_of_its_own_and_no_other_thread_has_it(fake):
    pool = Processes()
    threads = [threading.Thread(target=lambda seed=seed: [pool.compute(spec(seed), fake) for _ in range(2)])
               for seed in (0, 1)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    first, second = set(tries(fake, 0)), set(tries(fake, 1))
    assert len(first) == len(second) == 1 and first != second
    pool.end()
    with pytest.raises(RunFailed, match="interrupted"):
        pool.compute(spec(0), fake)


def test_a_killed_worker_costs_nothing_and_an_honest_one_gives_what_this_process_gives(tmp_path, monkeypatch):
    """The real worker, killed while it imports."""
    started = processes._start

    def start(number):
        process = started(number)
        if number == 0:
            threading.Timer(0.5, process.kill).start()
        return process

    monkeypatch.setattr(processes, "_start", start)
    there, missing = execute.execute(SPECS, tmp_path / "results", workers=1, quiet=True)
    assert not missing
    assert [result.rows for result in there] == [run.run(spec, tmp_path / "here").rows for spec in SPECS]


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
import os, subprocess, sys
subprocess.run([*sys.argv[1:], str(os.getpid()), "0"])
"""


@pytest.mark.parametrize("seconds", [0.0, 0.1, 0.5, 2.0])
def test_no_process_outlives_the_one_that_started_it(seconds):
    """Killed so many seconds after the real worker began: before, while and after that imports what is slow."""
    parent = psutil.Popen([sys.executable, "-c", PARENT, *processes.COMMAND], stdin=subprocess.PIPE,
                          env={**os.environ, "PYTHONPATH": str(paths.ROOT)})  # whose input does not end
    while not (workers := parent.children()):
        time.sleep(0.001)
    time.sleep(seconds)
    parent.kill()
    parent.wait()
    gone, alive = psutil.wait_procs(workers, timeout=10)
    assert gone and not alive


def test_notebook_kernel_and_workers_end_with_the_command_that_draws_a_figure(tmp_path):
    for name in ("profiles", "notebooks"):
        (tmp_path / name).symlink_to(paths.ROOT / name)
    command = psutil.Popen([sys.executable, "-m", "move.cli", "figure", "keypoint_control", "--profile", "smoke"],
                           env={**os.environ, "PYTHONPATH": str(paths.ROOT), "MOVE_ROOT": str(tmp_path)},
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def computes() -> bool:
        with suppress(psutil.Error):  # one of them may end while it is asked
            return any("move.study.worker" in child.cmdline() for child in command.children(recursive=True))
        return False

    while not computes():
        time.sleep(0.05)
        assert command.poll() is None
    started = command.children(recursive=True)
    assert len(started) >= 2, "a kernel and its workers"
    command.kill()
    command.wait()
    assert psutil.wait_procs(started, timeout=10)[1] == []


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
