"""What this package's laptop recipe and LeRobot's diffusion policy reach on Pick-Place for the same core-minutes.

    python tools/ten_minutes.py build/lerobot-venv/bin/python [MINUTES] [EPISODES]     (10 and 50; `make test-lerobot`
                                                                                       makes that environment)

Both train from the images of the same 7,000 timesteps of MOVE on one thread, for as many gradient steps as fit into
MINUTES of a core by a step's CPU time, measured just before, LeRobot's network at its own sizes with batches of 32;
then both are tried on the same configurations, LeRobot's with 10 denoising steps. Collection and evaluation are not
counted. The evaluation of LeRobot's policy takes a minute of a core an episode. Prints one line each, as JSON.
"""

from __future__ import annotations

import json
import resource
import shutil
import sys
import time
from pathlib import Path

from test_lerobot import command, move

from move.learn import dataset
from move.learn.settings import Training
from move.learn.train import Trainer
from move.paths import BUILD, ROOT
from move.sim.demonstrations import Demonstrations
from move.study.profiles import load_profile

FOLDER, TIMESTEPS, SEED = BUILD / "ten-minutes", 7_000, 0
THEIR_SIZES = ("32", "16", "96", "84", "10")  # batch, horizon, pixels, crop, denoising steps


def children_cpu() -> float:
    """CPU-seconds of all commands that have ended, of the system's too."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def step_seconds(recipe: Training, demonstrations: Demonstrations) -> float:
    """CPU-seconds of one gradient step, the mean of 40 after one that is not counted."""
    trainer = Trainer(demonstrations, recipe, 0, "cpu")
    trainer.take_step()
    started = time.process_time()
    for _ in range(40):
        trainer.take_step()
    return (time.process_time() - started) / 40


def ours(data: Path, seconds: float, episodes: str) -> dict:
    """The laptop recipe, its schedule as long as the time."""
    demonstrations, _ = dataset.load(data)
    recipe, out = load_profile("laptop").recipe("rgb", TIMESTEPS), FOLDER / "ours"
    steps = int(seconds / step_seconds(recipe, demonstrations))
    before = children_cpu()
    move("train", data, out, "--gradient-steps", str(steps), "--seed", str(SEED))
    spent = children_cpu() - before
    return {"policy": "laptop recipe", "steps": steps, "cpu_seconds": spent,
            "tried": json.loads(move("evaluate", out, "--episodes", episodes, "--json"))}


def theirs(python: Path, data: Path, seconds: float, episodes: str) -> dict:
    """LeRobot's diffusion policy at its own sizes."""
    exported, out = FOLDER / "exported", FOLDER / "lerobot"
    move("export", data, exported, "--whole-episodes")
    measured = json.loads(command(python, "-I", ROOT / "tools" / "lerobot_bench.py", *THEIR_SIZES).splitlines()[-1])
    steps = int(seconds / measured["step"])
    before = children_cpu()
    command(python.parent / "lerobot-train", "--dataset.repo_id=local/x", f"--dataset.root={exported}",
            "--dataset.video_backend=pyav", "--policy.type=diffusion", "--policy.push_to_hub=false",
            "--policy.device=cpu", "--policy.crop_shape=[84,84]", "--policy.num_inference_steps=10",
            f"--steps={steps}", "--batch_size=32", "--num_workers=0", "--wandb.enable=false", f"--seed={SEED}",
            f"--output_dir={out}")
    spent = children_cpu() - before
    return {"policy": "LeRobot diffusion", "steps": steps, "cpu_seconds": spent,
            "tried": json.loads(move("evaluate", "--lerobot", out, "--lerobot-python", python, "--episodes", episodes,
                                     "--json"))}


def main() -> None:
    """Collect once, train and try both."""
    python = Path(sys.argv[1]).absolute()
    minutes, episodes = (sys.argv[2:] + ["10", "50"][len(sys.argv) - 2:])[:2]
    shutil.rmtree(FOLDER, ignore_errors=True)
    data = FOLDER / "data.zarr"
    move("collect", "--observation", "rgb", "--timesteps", str(TIMESTEPS), "--seed", str(SEED), "--out", data)
    for result in (ours(data, 60 * float(minutes), episodes), theirs(python, data, 60 * float(minutes), episodes)):
        tried = result.pop("tried")
        print(json.dumps({**result, **{name: tried[name] for name in ("episodes", "success_rate", "low", "high")}}),
              flush=True)


if __name__ == "__main__":
    main()
