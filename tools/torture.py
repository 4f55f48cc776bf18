"""Kills `move run` at random, starts it again until it is done, and compares with a run that nobody disturbed.

A grid of a few short trainings from keypoints, with a checkpoint every tenth of a second. Each kill is a SIGKILL of the
command, of its whole group, or of one worker, at a random moment. When the grid is whole, every result's rows, curve
and collection and every policy's weights have to be those of the undisturbed run, bit for bit, and no process and no
half-written file may be left.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import sys
import tempfile
import time
from collections import Counter
from contextlib import suppress
from pathlib import Path

import psutil

SOURCE = Path(__file__).resolve().parent.parent
TARGETS = ("command", "group", "worker")
BAD = ("rounds that differ", "commands that failed", "half-written files", "orphans")
PATIENCE = 3.0  # seconds that a worker may outlive its command
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


def torture(grid: Grid, expected: dict[str, object], kills: int, chance: random.Random, seconds: float) -> Counter[str]:
    """Kill so often, each within EARLY of `seconds` of a start; go on until every begun grid is whole, and count."""
    counts: Counter[str] = Counter()
    while counts["kills"] < kills or counts["rounds"] == 0:
        shutil.rmtree(grid.folder / "build", ignore_errors=True)
        while not _came_to_its_end(grid, kills, chance, seconds, counts):
            pass
        counts["rounds"] += 1
        counts["rounds that differ"] += grid.outcome() != expected
        counts["half-written files"] += len(list(grid.folder.glob("build/**/*.part")))
        sys.stderr.write(f"{counts['kills']} of {kills} kills, {counts['rounds']} rounds\n")
    return counts


def _came_to_its_end(grid: Grid, kills: int, chance: random.Random, seconds: float, counts: Counter[str]) -> bool:
    """Start the command, kill at a random moment if there are kills left; whether it did all its work."""
    command, target, workers = grid.start(), chance.choice(TARGETS), []
    if counts["kills"] < kills:
        with suppress(psutil.TimeoutExpired):
            command.wait(chance.uniform(0, EARLY * seconds))
        with suppress(psutil.NoSuchProcess):
            workers = command.children(recursive=True)
        counts["kills"] += kill(command, target, chance)
    if not workers or target == "worker":
        with suppress(psutil.NoSuchProcess):
            workers += command.children(recursive=True)
    code = command.wait()
    _, alive = psutil.wait_procs(workers, timeout=PATIENCE)
    counts["orphans"] += len(alive)
    counts["commands that failed"] += code > 0
    return code == 0


def undisturbed(grid: Grid) -> tuple[dict[str, object], float]:
    """What has to come out, and the seconds that it takes."""
    started = time.monotonic()
    if code := grid.start().wait():
        raise SystemExit(f"the undisturbed run ended with exit code {code}: see {grid.folder / 'log'}")
    return grid.outcome(), time.monotonic() - started


def main() -> None:
    """Torture as told, print what was counted, and end with exit code 1 if anything differs or is left."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0, help="decides who is killed and when")
    parser.add_argument("--seeds", type=int, default=1, help="trainings a method")
    parser.add_argument("--steps", type=int, default=300, help="gradient steps of a training")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        grid = Grid(Path(folder), given.seeds, given.steps)
        expected, seconds = undisturbed(grid)
        counts = torture(grid, expected, given.kills, random.Random(given.seed), seconds)
    print(f"undisturbed: {len(expected)} files in {seconds:.1f} s")
    for name in ("kills", "rounds", *BAD):
        print(f"{name:<20} {counts[name]:>5}")
    sys.exit(any(counts[name] for name in BAD))


if __name__ == "__main__":
    main()
