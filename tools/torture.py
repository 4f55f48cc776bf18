"""Kills `move run` at random, starts it again until it is done, and compares with a run that nobody disturbed.

A grid of a few short trainings from keypoints, with a checkpoint every tenth of a second. Each kill is a SIGKILL of the
command, of its whole group, or of one worker, at a random moment. When the grid is whole, every result's rows, curve
and collection and every policy's weights have to be those of the undisturbed run, bit for bit, and no process and no
half-written file may be left. `--orphans` kills the command alone at even moments of its first ten seconds, or of as
many as the grid takes, and looks for what outlives it. Ctrl-C shows what was counted so far.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from contextlib import suppress
from pathlib import Path

import psutil

SOURCE = Path(__file__).resolve().parent.parent
TARGETS = ("command", "group", "worker")
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
    """A folder in which `move run` computes the tiny grid; `steps` are gradient steps, `seeds` runs a method."""

    def __init__(self, folder: Path, seeds: int, steps: int) -> None:
        self.folder = folder
        (folder / "profiles").mkdir(parents=True)
        (folder / "notebooks").symlink_to(SOURCE / "notebooks")
        text = PROFILE.replace("STEPS", str(steps)).replace("SEEDS", str(seeds))
        (folder / "profiles" / "tortured.yaml").write_text(text)

    def start(self) -> psutil.Popen:
        """`move run` on two processes, in a group of its own."""
        environment = {**os.environ, "MOVE_ROOT": str(self.folder), "MOVE_CHECKPOINT_SECONDS": "0.1",
                       "PYTHONPATH": str(SOURCE), "OMP_NUM_THREADS": "1"}
        command = [sys.executable, "-m", "move.cli", "run", "--profile", "tortured", "keypoint_control",
                   "--workers", "2"]
        with (self.folder / "log").open("a") as log:
            return psutil.Popen(command, env=environment, start_new_session=True, stdout=log, stderr=log)

    def outcome(self) -> dict[str, object]:
        """What has to be the same: of each result its content, of each policy its tensors, by file."""
        found: dict[str, object] = {}
        for path in sorted(self.folder.glob("build/results/*/*.json")):
            content = json.loads(path.read_text())
            (content["collection"] or {}).pop("seconds", None)
            found[path.name] = [content[name] for name in CONTENT] + [(content["training"] or {}).get("curve")]
        for path in sorted(self.folder.glob("build/runs/*/policy/tensors-*")):
            found[f"{path.parent.parent.name}/{path.name}"] = path.read_bytes()
        return found

    def clear(self) -> None:
        """Forget everything that was computed."""
        shutil.rmtree(self.folder / "build", ignore_errors=True)

    def leftovers(self) -> list[str]:
        """Half-written files."""
        return [path.name for path in self.folder.glob("build/**/*.part")]


def kill(command: psutil.Popen, target: str, chance: random.Random) -> bool:
    """Kill the command, its group with all its workers, or one worker; False if that was gone already."""
    try:
        workers = command.children()
        victims = {"command": [command], "group": [command, *workers],
                   "worker": [chance.choice(workers)] if workers else []}[target]
        for victim in victims:
            victim.kill()
        return bool(victims)
    except psutil.NoSuchProcess:
        return False


def outlived(workers: list[psutil.Process], seconds: float = 3.0) -> list[int]:
    """Which of these processes are there some seconds after the command ended."""
    _, alive = psutil.wait_procs(workers, timeout=seconds)
    return [process.pid for process in alive]


def torture(grid: Grid, expected: dict[str, object], kills: int, chance: random.Random, seconds: float,
            counts: Counter[str]) -> None:
    """Kill so often, each within EARLY of `seconds` of a start, go on until every begun grid is whole, and count."""
    while sum(counts[target] for target in TARGETS) < kills or counts["rounds"] == 0:
        grid.clear()
        while not _goes_on_to_its_end(grid, kills, chance, seconds, counts):
            pass
        counts["rounds"] += 1
        counts["rounds that differ"] += grid.outcome() != expected
        counts["half-written files"] += len(grid.leftovers())
        done = sum(counts[target] for target in TARGETS)
        sys.stderr.write(f"{done} of {kills} kills, {counts['rounds']} rounds, {counts['rounds that differ']} differ\n")


def _goes_on_to_its_end(grid: Grid, kills: int, chance: random.Random, seconds: float, counts: Counter[str]) -> bool:
    """Start the command, kill at a random moment if there are kills left; whether it came to its end."""
    command, target = grid.start(), chance.choice(TARGETS)
    if sum(counts[name] for name in TARGETS) < kills:
        with suppress(psutil.TimeoutExpired):
            command.wait(chance.uniform(0, EARLY * seconds))
        workers = _children(command)
        if kill(command, target, chance):
            counts[target] += 1
            if target != "worker":
                command.wait()
                counts["orphans"] += len(outlived(workers))
    workers = _children(command)
    code = command.wait()
    counts["orphans"] += len(outlived(workers))
    counts["commands that failed"] += code > 0
    return code == 0


def aim(grid: Grid, kills: int, counts: Counter[str], latest: float) -> None:
    """Kill the command alone, at moments evenly from 0 to `latest` seconds after its start; count what outlives it."""
    for number in range(kills):
        grid.clear()
        command, started = grid.start(), time.monotonic()
        while time.monotonic() - started < latest * number / max(kills - 1, 1) and command.poll() is None:
            time.sleep(0.01)
        workers = _children(command)
        counts["command"] += kill(command, "command", random.Random(0))
        command.wait()
        counts["with workers"] += bool(workers)
        counts["orphans"] += len(outlived(workers)) + len(_of(grid))


def _children(command: psutil.Popen) -> list[psutil.Process]:
    with suppress(psutil.NoSuchProcess):
        return command.children(recursive=True)
    return []


def _of(grid: Grid) -> list[int]:
    """Processes that work on the grid, whoever started them."""
    found = []
    for process in psutil.process_iter():
        with suppress(psutil.Error):
            if process.environ().get("MOVE_ROOT") == str(grid.folder):
                found.append(process.pid)
    return found


def undisturbed(grid: Grid) -> tuple[dict[str, object], float]:
    """What has to come out, and the seconds that it takes."""
    started = time.monotonic()
    if code := grid.start().wait():
        raise SystemExit(f"the undisturbed run ended with exit code {code}: see {grid.folder / 'log'}")
    return grid.outcome(), time.monotonic() - started


def main() -> None:
    """Torture as told, print one table, and end with exit code 1 if anything differs or is left."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--orphans", type=int, default=0, help="kills of the command alone, at aimed moments")
    parser.add_argument("--seed", type=int, default=0, help="decides who is killed and when")
    parser.add_argument("--seeds", type=int, default=1, help="trainings a method")
    parser.add_argument("--steps", type=int, default=300, help="gradient steps of a training")
    given = parser.parse_args()
    signal.signal(signal.SIGINT, signal.default_int_handler)  # in the background a shell has it ignored
    with tempfile.TemporaryDirectory() as folder:
        grid = Grid(Path(folder), given.seeds, given.steps)
        expected, seconds = undisturbed(grid)
        counts, aimed = Counter(), Counter()
        with suppress(KeyboardInterrupt):  # what was counted so far is shown
            if given.kills:
                torture(grid, expected, given.kills, random.Random(given.seed), seconds, counts)
            aim(grid, given.orphans, aimed, max(seconds, 10))
    lines = {f"kills of the {name}": counts[name] for name in TARGETS}
    lines |= {name: counts[name] for name in ("rounds", "rounds that differ", "commands that failed",
                                              "half-written files", "orphans")}
    lines |= {"aimed kills": aimed["command"], "of them with workers": aimed["with workers"],
              "orphans of those": aimed["orphans"]}
    width = max(map(len, lines))
    print(f"undisturbed: {len(expected)} files in {seconds:.1f} s")
    print("\n".join(f"{name:<{width}} {value:>5}" for name, value in lines.items()))
    bad = ("rounds that differ", "commands that failed", "half-written files", "orphans", "orphans of those")
    sys.exit(any(lines[name] for name in bad))


if __name__ == "__main__":
    main()
