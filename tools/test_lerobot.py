"""Exports in LeRobot's own hands: it reads every number back and trains on them.

    python tools/test_lerobot.py build/lerobot-venv/bin/python     (`make test-lerobot` builds that environment, 8 GB)

Networks are small and trained for three steps: what is tested is that everything fits together.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

from move.learn import dataset
from move.machine import gl_problem
from move.paths import BUILD, ROOT

FOLDER = BUILD / "lerobot-test"
SIZES = {"keypoints": 500, "rgb": 300}  # timesteps
SMALL = {
    "diffusion": ("--policy.down_dims=[64,128]", "--policy.num_inference_steps=4"),
    "act": ("--policy.dim_model=64", "--policy.dim_feedforward=64", "--policy.chunk_size=8",
            "--policy.n_action_steps=8", "--policy.pretrained_backbone_weights=null",
            '--policy.normalization_mapping={"VISUAL":"MEAN_STD","STATE":"QUANTILES","ENV":"QUANTILES","ACTION":'
            '"QUANTILES"}'),
}
OFFLINE = {**os.environ, "HF_HUB_OFFLINE": "1", "OMP_NUM_THREADS": "1"}


def command(*words: str | Path) -> str:
    """Run a command; its standard output. A failure ends this program with what it said."""
    done = subprocess.run([str(word) for word in words], cwd=ROOT, env=OFFLINE, text=True, capture_output=True)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, words))}\n{done.stdout[-2000:]}\n{done.stderr[-4000:]}")
    return done.stdout


def move(*words: str | Path) -> str:
    """Run one of this package's commands."""
    return command(sys.executable, "-m", "move.cli", *words)


def exported(observation: str) -> Path:
    """Collect demonstrations, keep their arrays beside, and export them without the one that the budget cut."""
    place = FOLDER / observation
    move("collect", "--observation", observation, "--timesteps", str(SIZES[observation]), "--seed", "1",
         "--out", place / "data.zarr")
    move("export", place / "data.zarr", place / "whole.zarr", "--format", "zarr", "--whole-episodes")
    move("export", place / "data.zarr", place / "exported", "--whole-episodes")
    demonstrations, _ = dataset.load(place / "whole.zarr")
    for name, values in (("observations", demonstrations.observations), ("actions", demonstrations.actions),
                         ("ends", demonstrations.episode_ends)):
        np.save(place / f"{name}.npy", values, allow_pickle=False)
    return place


def train(python: Path, place: Path, policy: str) -> None:
    """Three steps of LeRobot's own training."""
    command(python.parent / "lerobot-train", "--dataset.repo_id=local/x", f"--dataset.root={place / 'exported'}",
            "--dataset.video_backend=pyav", f"--policy.type={policy}", "--policy.push_to_hub=false",
            "--policy.device=cpu", "--steps=3", "--batch_size=8", "--num_workers=0", "--wandb.enable=false",
            f"--output_dir={place / policy}", *SMALL[policy])


def main() -> None:
    """Go through everything, a line each."""
    python = Path(sys.argv[1]).absolute()
    shutil.rmtree(FOLDER, ignore_errors=True)
    for observation in SIZES:
        if observation == "rgb" and (problem := gl_problem()):
            print(problem)
            continue
        place = exported(observation)
        compared = command(python, "-I", ROOT / "tools" / "lerobot_reads.py", place / "exported", place)
        print(f"{observation}: {compared.strip()}")
        for policy in SMALL:
            train(python, place, policy)
            print(f"{observation}, {policy}: trained 3 steps")


if __name__ == "__main__":
    main()
