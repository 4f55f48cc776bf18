"""Kills a command at random, starts it again until it is done, and compares with one that nobody disturbed.

    run      `move run` of a few short trainings from keypoints, with a checkpoint every tenth of a second
    figure   `move figure --stored-only` of two shipped figures: their pictures and tables
    site     `make site` of the shipped results, from notebooks that `move figure --stored-only` executed before

Each kill is a SIGKILL of the command, of its whole group, or of one process that it started, at a random moment. After
each, whatever is in its place has to be whole; in the end every result's rows, curve and collection, every policy's
weights, and every file of the figures and of the site have to be those of the undisturbed command, bit for bit, and no
process and no half-written file may be left. A command is a fork of this process, in which what it imports is there.
"""

from __future__ import annotations

import argparse
import importlib
import json
import os
import random
import shutil
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import psutil

SOURCE = Path(__file__).resolve().parent.parent
TARGETS = ("command", "group", "worker")
BAD = ("rounds that differ", "torn after a kill", "commands that failed", "half-written files", "orphans")
COMMANDS = {"run": ("run", "--profile", "tortured", "keypoint_control", "--workers", "2"),
            "figure": ("figure", "fig7_speed", "table4_hyperparameters", "--stored-only"), "site": ()}
SHARED = ("docs", "results", "README.md", "KNOWN_DEVIATIONS.md", "SECURITY.md")
PATIENCE = 30.0  # seconds that a worker may outlive its command, on a busy machine
EARLY = 0.6  # of the undisturbed time: later a resumed command has often ended already
CONTENT = ("spec", "rows", "collection")  # of a result, what a repetition has to give again
PROFILE = """
purpose: tortured
stamp: TORTURE
image_size: 48
training:
  keypoints: {encoder: keypoints, denoiser: mlp, gradient_steps: STEPS, warmup_steps: 10, batch_size: 32,
              learning_rate: 1.0e-3, ema_decay: 0.9, mlp_width: 64}
notebooks: {keypoint_control: {timesteps: [120], seeds: SEEDS, episodes: 2}}
minutes: {keypoints: 0.1}
"""


class Grid:
    """A folder in which a command computes the tiny grid; `steps` are gradient steps, `seeds` runs a method."""

    def __init__(self, folder: Path, command: str, seeds: int, steps: int) -> None:
        self.folder, self.command = folder, command
        shutil.copytree(SOURCE / "profiles", folder / "profiles")
        shutil.copytree(SOURCE / "notebooks", folder / "notebooks", ignore=shutil.ignore_patterns("tutorial"))
        for name in SHARED:
            (folder / name).symlink_to(SOURCE / name)
        text = PROFILE.replace("STEPS", str(steps)).replace("SEEDS", str(seeds))
        (folder / "profiles" / "tortured.yaml").write_text(text)
        os.environ.update(MOVE_ROOT=str(folder), MOVE_CHECKPOINT_SECONDS="0.1", OMP_NUM_THREADS="1",
                          PYTHONPATH=str(SOURCE))
        self.main = self._imported()

    def _imported(self) -> Callable[[], object]:
        """The command's main function, with all that it imports."""
        if self.command == "site":
            return importlib.import_module("make_site").main
        for name in ("move.figures.page.kernels", "move.figures.page.make", "move.study.run", "papermill", "ipykernel"):
            importlib.import_module(name)
        return importlib.import_module("move.cli").main

    def clear(self) -> None:
        """Delete what the command made; what it begins with comes from `SOURCE`."""
        for name in ("build", "paper_figures"):
            shutil.rmtree(self.folder / name, ignore_errors=True)
        if self.command == "site":
            shutil.copytree(SOURCE / "build/notebooks/laptop", self.folder / "build/notebooks/laptop")
            shutil.copytree(SOURCE / "paper_figures", self.folder / "paper_figures")

    def start(self) -> psutil.Process:
        """The command, in a group of its own."""
        if process := os.fork():
            return psutil.Process(process)
        os.setsid()
        for stream in (1, 2):
            os.dup2(os.open(self.folder / "log", os.O_WRONLY | os.O_CREAT | os.O_APPEND), stream)
        sys.argv = ["move", *COMMANDS[self.command]]
        code: object = 1
        try:
            self.main()
            code = 0
        except SystemExit as end:
            code = end.code
        finally:
            os._exit(code if isinstance(code, int) else int(code is not None))

    def outcome(self) -> dict[str, object]:
        """What has to be the same: of each result its content, else the bytes, by file."""
        found: dict[str, object] = {}
        for path in sorted(self.folder.glob("build/results/*/*.json")):
            content = json.loads(path.read_text())
            (content["collection"] or {}).pop("seconds", None)
            found[path.name] = [content[name] for name in CONTENT] + [(content["training"] or {}).get("curve")]
        files = (path for pattern in ("build/runs/*/policy/tensors-*", "paper_figures/*", "build/site/**/*")
                 for path in sorted(self.folder.glob(pattern)))
        return found | {str(path.relative_to(self.folder)): path.read_bytes() for path in files
                        if path.is_file() and not path.name.startswith(".")}


def kill(command: psutil.Process, target: str, chance: random.Random) -> bool:
    """Kill the command, its group with all that it started, or one of these; False if that was gone already."""
    try:
        workers = command.children(recursive=True)
        victims = {"command": [command], "group": [command, *workers],
                   "worker": [chance.choice(workers)] if workers else []}[target]
        for victim in victims:
            with suppress(psutil.NoSuchProcess):
                victim.kill()
        return bool(victims)
    except psutil.NoSuchProcess:
        return False


def torture(grid: Grid, expected: dict[str, object], kills: int, chance: random.Random, seconds: float) -> Counter[str]:
    """Kill so often, each within EARLY of `seconds` of a start; go on until every begun grid is whole, and count."""
    counts: Counter[str] = Counter()
    while counts["kills"] < kills or counts["rounds"] == 0:
        grid.clear()
        while not _came_to_its_end(grid, kills, chance, seconds, counts):
            counts["torn after a kill"] += any(expected.get(name, content) != content
                                               for name, content in grid.outcome().items())
            sys.stderr.write(f"of {kills} kills: {dict(counts)}\n")
        counts["rounds"] += 1
        counts["rounds that differ"] += grid.outcome() != expected
        counts["half-written files"] += len([path for ending in ("part", "old")
                                             for path in grid.folder.glob(f"*/**/*.{ending}")])
    return counts


def _came_to_its_end(grid: Grid, kills: int, chance: random.Random, seconds: float, counts: Counter[str]) -> bool:
    """Start the command, kill at a random moment if there are kills left; whether it did all its work."""
    command, target, workers, killed = grid.start(), chance.choice(TARGETS), [], False
    if counts["kills"] < kills:
        with suppress(psutil.TimeoutExpired):
            command.wait(chance.uniform(0, EARLY * seconds))
        with suppress(psutil.NoSuchProcess):
            workers = command.children(recursive=True)
        killed = kill(command, target, chance)
        counts["kills"] += killed
    if not killed or target == "worker":
        with suppress(psutil.NoSuchProcess):
            workers += command.children(recursive=True)
    code = command.wait()
    _, alive = psutil.wait_procs(workers, timeout=PATIENCE)
    counts["orphans"] += len(alive)
    counts["commands that failed"] += code > 0 and not killed  # one whose worker was killed says so
    return code == 0


def undisturbed(grid: Grid) -> tuple[dict[str, object], float]:
    """What has to come out, and the seconds that it takes."""
    grid.clear()
    started = time.monotonic()
    if code := grid.start().wait():
        raise SystemExit(f"the undisturbed run ended with exit code {code}: see {grid.folder / 'log'}")
    return grid.outcome(), time.monotonic() - started


def main() -> None:
    """Torture as told, print what was counted, and end with exit code 1 if anything differs or is left."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--command", choices=COMMANDS, default="run")
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0, help="decides who is killed and when")
    parser.add_argument("--seeds", type=int, default=1, help="trainings a method")
    parser.add_argument("--steps", type=int, default=300, help="gradient steps of a training")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        grid = Grid(Path(folder), given.command, given.seeds, given.steps)
        expected, seconds = undisturbed(grid)
        counts = torture(grid, expected, given.kills, random.Random(given.seed), seconds)
    print(f"undisturbed: {len(expected)} files in {seconds:.1f} s")
    for name in ("kills", "rounds", *BAD):
        print(f"{name:<20} {counts[name]:>5}")
    sys.exit(any(counts[name] for name in BAD))


if __name__ == "__main__":
    main()
