"""Marks tutorials that students have handed in: runs each in a process of its own and notes what its checks say.

**It runs the students' code**, with the rights of who calls it: mark in a container or an account of its own. The
process has a time limit and a folder of its own and none of this process's memory; it is not a sandbox.

mark          all notebooks of a folder, one row each
main          in the process of one notebook: execute its cells, note each verdict
"""

from __future__ import annotations

import json
import math
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from move import paths
from move.errors import BadInput

MINUTES = 10.0  # of computing, one core, that one notebook may take once everything is imported
BY_THE_CLOCK, TO_END = 4, 60  # so many times as long by the clock, and so many seconds more
TO_START, LOOKS = 600, 0.2  # seconds to import everything, and between looks whether that is done
SMALL: dict[str, dict[str, Any]] = {
    "1_a_scene_that_moves": {"demonstrations": 3, "timesteps": 200, "image_size": 48},
    "2_collect_and_look": {"timesteps": 200, "image_size": 32},
    "3_a_diffusion_policy": {"timesteps": 200, "gradient_steps": 40, "episodes": 2, "image_size": 48},
    "4_what_a_success_rate_can_say": {"draws": 10},
    "5_change_the_method": {"timesteps": 150, "gradient_steps": 20, "episodes": 2},
}
"""Each tutorial's parameters with which it runs in seconds; no exercise depends on them."""
ASKED = re.compile(r'check\("(\d)\.\d+",')


def mark(folder: Path, minutes: float = MINUTES, on_progress: Callable[[int, int], None] | None = None
         ) -> list[dict[str, Any]]:
    """Run every notebook below `folder` and return one row each: notebook, right, of, exercises, remark.

    `exercises` maps a number to what the notebook's last check of it said, "" where that was right.

    Raises:
        BadInput: no such folder, or no notebook in it.
    """
    if not folder.is_dir():
        raise BadInput(f"folder: {str(folder)!r} given; allowed is a folder with notebooks that students handed in")
    notebooks = sorted(path for path in folder.rglob("*.ipynb") if ".ipynb_checkpoints" not in path.parts)
    if not notebooks:
        raise BadInput(f"folder: no notebook (*.ipynb) in {folder}")
    rows = []
    for done, path in enumerate(notebooks):
        if on_progress:
            on_progress(done, len(notebooks))
        rows.append({"notebook": str(path.relative_to(folder)), **_marked(path, minutes)})
    return rows


def _marked(path: Path, minutes: float) -> dict[str, Any]:
    """One notebook's row; whatever is wrong with it is its remark."""
    try:
        name, cells = _read(path)
    except ValueError as problem:
        return {"right": 0, "of": 0, "exercises": {}, "remark": str(problem)}
    asked = _numbers(name)
    with tempfile.TemporaryDirectory(prefix="move-mark-") as scratch:
        job, said = Path(scratch, "job.json"), Path(scratch, "verdicts.json")
        content = {"cells": cells, "seconds": 60 * minutes}
        job.write_text(json.dumps(content), encoding="utf-8")
        remark = _run([sys.executable, "-m", __name__, str(job), str(said)], Path(scratch), 60 * minutes, said)
        found = _verdicts(said)
    exercises = {number: found.get("verdicts", {}).get(number, "not reached") for number in asked}
    remark = remark or found.get("stopped", "")
    return {"right": sum(text == "" for text in exercises.values()), "of": len(asked), "exercises": exercises,
            "remark": remark}


def _read(path: Path) -> tuple[str, list[str]]:
    """Which tutorial a notebook is, and its code cells; after that of the parameters one with those of `SMALL`."""
    import nbformat

    try:
        cells = [cell for cell in nbformat.read(path, 4).cells if cell.cell_type == "code"]
    except Exception as error:  # of nbformat, json, jsonschema and the file system
        raise ValueError(f"not readable as a notebook: {' '.join(str(error).split())[:80]}") from error
    parts = {match[1] for cell in cells for match in ASKED.finditer(cell.source)}
    names = [name for name in SMALL if name[0] in parts]
    if len(names) != 1:
        raise ValueError("asks for no exercise of a tutorial" if not names else "has exercises of several tutorials")
    small = "\n".join(f"{parameter} = {value!r}" for parameter, value in SMALL[names[0]].items())
    sources = []
    for cell in cells:
        sources.append(cell.source)
        if "parameters" in cell.metadata.get("tags", []):
            sources.append(small)
    return names[0], sources


def _numbers(name: str) -> list[str]:
    """The exercises that the tutorial of the package asks for."""
    text = (paths.NOTEBOOKS / "tutorial" / f"{name}.ipynb").read_text(encoding="utf-8")
    return re.findall(r'check\(\\"([\d.]+)\\"', text)


def _run(command: list[str], folder: Path, seconds: float, ready: Path) -> str:
    """Run a process in a session of its own; what stopped it, else "". Its time begins when the file `ready` is there.

    Args:
        seconds: of computing, which the process limits itself, and with a margin by the clock.
    """
    environment = os.environ | {"MPLBACKEND": "Agg", "OMP_NUM_THREADS": "1",
                                "PYTHONPATH": str(Path(__file__).parents[2])}
    process = subprocess.Popen(command, cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
    try:
        end = time.monotonic() + TO_START
        while process.poll() is None and not ready.exists() and time.monotonic() < end:
            time.sleep(LOOKS)
        code = process.wait(BY_THE_CLOCK * seconds + TO_END)
        if code != -signal.SIGXCPU:
            return "" if code == 0 else f"its process ended with {code}"
        return f"stopped after {seconds / 60:g} minutes of computing"
    except subprocess.TimeoutExpired:
        return f"stopped after {(BY_THE_CLOCK * seconds + TO_END) / 60:g} minutes"
    finally:
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGKILL)  # with all that it has left behind
        process.wait()


def _verdicts(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        texts = {str(number): str(text)[:300] for number, text in content["verdicts"].items()}
        return {"verdicts": texts, "stopped": str(content["stopped"])[:120]}
    except (OSError, ValueError, KeyError, TypeError, AttributeError):  # it did not come so far
        return {}


# in the process of one notebook --------------------------------------------------------------------------------------


def main(job: Path, said: Path) -> None:
    """Execute the cells of `job`, each even if one before it failed, and write what the checks say as they say it."""
    content = json.loads(job.read_text(encoding="utf-8"))
    verdicts: dict[str, str] = {}
    stopped = ""

    def write() -> None:
        said.with_suffix(".new").write_text(json.dumps({"verdicts": verdicts, "stopped": stopped}), encoding="utf-8")
        said.with_suffix(".new").replace(said)

    def noted(number: str, answer: Any) -> exercises.Verdict:
        verdict = judge(number, answer)
        verdicts[number] = "" if verdict.right else verdict.text
        write()
        return verdict

    from IPython.core.interactiveshell import InteractiveShell

    from move.teaching import exercises

    judge = exercises.check
    exercises.check = noted
    shell = InteractiveShell.instance()
    write()  # from now on its time runs
    limit = math.ceil(time.process_time() + content["seconds"])
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + TO_END))
    for place, source in enumerate(content["cells"]):
        done = shell.run_cell(source)
        if not done.success and not stopped:
            error = done.error_in_exec or done.error_before_exec
            stopped = f"cell {place + 1}: {type(error).__name__}: {' '.join(str(error).split())}"
    write()


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
