"""A real Dask scheduler and workers: the numbers are those of no cluster, and what goes wrong is one line."""

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from distributed import Client, LocalCluster
from shared import refused

from move.figures.page import parameters
from move.study import cluster, execute, results, run
from move.study.kinds import collector_run
from move.study.profiles import load_profile
from move.study.provenance import deciding

SMOKE = load_profile("smoke")
LONG = [collector_run(SMOKE, task="hammer", method="move", attempts=300, seed=seed) for seed in range(4)]


@contextlib.contextmanager
def two_threads(workers: int = 1):
    """The address of a scheduler whose workers have two threads each, as a plain `dask worker` on this machine has."""
    with LocalCluster(n_workers=workers, threads_per_worker=2, processes=False, protocol="tcp://",
                      dashboard_address=None) as local:
        try:
            yield local.scheduler_address
        finally:
            cluster._HERE.end()  # else the block waits for what it is computing
            cluster._HERE = cluster.Processes()


def content(result: results.Result) -> tuple:
    """What any machine gives."""
    return result.spec, result.rows, result.collection, result.training and result.training["curve"]


def assert_equal_to_no_cluster(specs, folder):
    with two_threads() as address:
        found, missing = execute.execute(specs, folder / "cluster", address, quiet=True)
    assert not missing and len(found) == len(specs)
    for result in found:
        assert content(result) == content(run.run(result.spec, folder / "here"))
    assert {path.name for path in (folder / "cluster").iterdir()} == {f"{spec.hash}.json" for spec in specs}


def test_a_worker_with_two_threads_gives_what_no_cluster_gives(tmp_path):
    assert_equal_to_no_cluster(parameters.specs("table6_collection", SMOKE)[:2], tmp_path)


@pytest.mark.slow
def test_a_worker_with_two_threads_gives_all_of_table_6_as_no_cluster_does(tmp_path):
    """When two runs shared a process, 10 to 15 of these 60 came out wrong."""
    specs = parameters.specs("table6_collection", SMOKE)
    assert len(specs) == 60
    assert_equal_to_no_cluster(specs, tmp_path)


def test_a_worker_that_is_killed_in_the_middle_loses_and_doubles_nothing(tmp_path):
    specs = parameters.specs("table6_collection", SMOKE)[:3]
    stored: dict[Path, int] = {}  # when each result that was there at the kill had been written
    with LocalCluster(n_workers=2, threads_per_worker=1, protocol="tcp://", dashboard_address=None) as local:
        first = next(iter(local.workers.values()))

        def kill_once_something_is_stored():
            while not stored:
                time.sleep(0.02)
                stored.update({path: path.stat().st_mtime_ns for path in tmp_path.glob("*.json")})
            first.process.process._process.kill()

        killer = threading.Thread(target=kill_once_something_is_stored)
        killer.start()
        found, missing = execute.execute(specs, tmp_path, local.scheduler_address, quiet=True)
        killer.join()
    assert 0 < len(stored) < len(specs)
    assert not missing and {path.name for path in tmp_path.iterdir()} == {f"{spec.hash}.json" for spec in specs}
    assert {path: path.stat().st_mtime_ns for path in stored} == stored  # not made again
    assert [result.spec for result in found] == specs


@contextlib.contextmanager
def interrupted(seconds: float):
    """Ctrl-C after so many seconds; it has to end the block within three more."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell has it ignored in the background
    timer = threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    started = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        yield
    timer.cancel()
    signal.signal(signal.SIGINT, before)
    assert seconds <= time.monotonic() - started < seconds + 3


def test_without_workers_one_is_told_and_ctrl_c_ends_it(tmp_path, capfd, monkeypatch):
    monkeypatch.setattr(cluster, "PATIENCE", 0.5)
    with two_threads(workers=0) as address, interrupted(3):
        execute.execute(LONG, tmp_path, address, quiet=True)
    assert capfd.readouterr().err == f"{address} has no workers; waiting for one\n"


def test_ctrl_c_ends_a_cluster_at_once_and_nothing_more_is_begun(tmp_path):
    with two_threads() as address:
        with interrupted(3):
            execute.execute(LONG, tmp_path, address, quiet=True)
        assert not list(tmp_path.iterdir())  # no token either


def test_ctrl_c_ends_local_runs_at_once(tmp_path):
    with interrupted(2):
        execute.execute(LONG, tmp_path, workers=2, quiet=True)


def test_a_scheduler_that_dies_is_one_line_however_late_its_client_closes(tmp_path):
    port = str(20_000 + os.getpid() % 20_000)
    command = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", port,
               "--no-dashboard"]
    scheduler = subprocess.Popen(command, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    timer = threading.Timer(3, scheduler.kill)

    def submitted(pool, *arguments):
        timer.start()
        return run_all(pool, *arguments)

    def closed_late(client, timeout):
        close(client)
        raise TimeoutError(f"timed out after {timeout} s.")

    with pytest.MonkeyPatch.context() as patch, refused("the scheduler is gone"):
        run_all, close = execute._run_all, Client.close
        patch.setattr(execute, "_run_all", submitted)
        patch.setattr(Client, "close", closed_late)
        execute.execute(LONG, tmp_path, f"tcp://127.0.0.1:{port}", quiet=True)
    scheduler.wait()


@pytest.mark.parametrize("when", ["at the start", "later"])
def test_a_worker_that_does_not_share_the_folder_is_refused_before_any_run(tmp_path, monkeypatch, when):
    if when == "later":
        monkeypatch.setattr(cluster.Cluster, "refuse_unfit_workers", lambda self: None)
    monkeypatch.setattr(Path, "touch", lambda path: None)  # so that the token is nowhere
    monkeypatch.setattr(execute, "refuse_unwritable", lambda path: None)
    with two_threads() as address, refused("worker.*: it does not share the folder"):
        execute.execute(LONG, tmp_path, address, quiet=True)


def test_what_a_worker_says_of_a_folder(tmp_path):
    (tmp_path / "token").touch()
    assert cluster._problem(tmp_path / "token", deciding()) is None and [*tmp_path.iterdir()] == [tmp_path / "token"]
    assert "does not share the folder" in cluster._problem(tmp_path / "elsewhere" / "token", deciding())
    assert "cannot write to /proc/self" in cluster._problem(Path("/proc/self/status"), deciding())
