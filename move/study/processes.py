"""Runs in processes of their own, so that one which dies costs its run alone, and two never share a simulator.

MuJoCo's model and the GL context are one a process, and a context belongs to one thread. So each thread that asks for
runs has a Python process (`worker.py`), which computes them one after another, and which ends with this one.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
from itertools import count
from pathlib import Path

import move
from move.machine import THREAD_VARIABLES
from move.study.provenance import deciding
from move.study.spec import RunSpec

TRIES = 3  # of a run whose process dies
COMMAND = [sys.executable, "-m", "move.study.worker"]


class RunFailed(RuntimeError):
    """A run ended without a result; the message says why in one line."""


class Processes:
    """The processes of the threads that ask: one each, started when it is needed and again when it died."""

    def __init__(self) -> None:
        self._mine = threading.local()
        self._lock = threading.Lock()
        self._numbers = count()
        self._running: set[subprocess.Popen[str]] = set()
        self._ended = False

    def compute(self, spec: RunSpec, folder: Path) -> str:
        """Compute and store a run in this thread's process, wait for it, and return its hash.

        Raises:
            RunFailed: the run failed, its process died three times, or `end` was called.
        """
        for _ in range(TRIES):
            process = self._own_process()
            answer = _ask(process, json.dumps({"spec": spec.model_dump_json(), "folder": str(folder),
                                               "there": deciding()}))
            if answer is None:
                self._forget(process)
                continue
            if problem := json.loads(answer):
                raise RunFailed(problem)
            return spec.hash
        raise RunFailed(f"its process died {TRIES} times, the last time by {_cause(process)}")

    def end(self) -> None:
        """Kill all of them, whatever they do, and start no more."""
        with self._lock:
            self._ended = True
            for process in self._running:
                process.kill()

    def _own_process(self) -> subprocess.Popen[str]:
        with self._lock:
            if self._ended:
                raise RunFailed("interrupted")
            process = getattr(self._mine, "process", None)
            if process is None or process.poll() is not None:
                process = self._mine.process = _start(next(self._numbers))
                self._running.add(process)
            return process

    def _forget(self, process: subprocess.Popen[str]) -> None:
        process.kill()
        process.wait()
        with self._lock:
            self._running.discard(process)


def _start(number: int) -> subprocess.Popen[str]:
    """A new process in a group of its own, which Ctrl-C in a terminal does not reach; one thread, this same package."""
    package = str(Path(move.__file__).parent.parent)
    paths = [package, os.environ.get("PYTHONPATH", "")]
    environment = {**dict.fromkeys(THREAD_VARIABLES, "1"), **os.environ,
                   "PYTHONPATH": os.pathsep.join(filter(None, paths))}
    return subprocess.Popen([*COMMAND, str(os.getpid()), str(number)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                            text=True, env=environment, process_group=0)


def _ask(process: subprocess.Popen[str], request: str) -> str | None:
    """The process's answer; None if it died."""
    assert process.stdin and process.stdout  # both are pipes
    try:
        process.stdin.write(request + "\n")
        process.stdin.flush()
        return process.stdout.readline() or None
    except OSError:
        return None


def _cause(process: subprocess.Popen[str]) -> str:
    code = process.returncode
    return signal.Signals(-code).name if code < 0 else f"exit code {code}"
