"""What things cost, in seconds of one core, most against a reference measured in the same run (`make bench`).

    python tools/bench.py [PART ...]       commands, collection, expert, keypoints, drawing, training, memory, tests;
                                           by default all, in this order: ten minutes

Seconds are those of processors, of child processes too, so that they hold on a machine that does other things as well.
A part by itself is printed only; the whole is written to paper_figures/bench.md.
"""

from __future__ import annotations

import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path

for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "LP_NUM_THREADS"):
    os.environ[name] = "1"
warnings.filterwarnings("ignore")

import gymnasium  # noqa: E402
import metaworld  # noqa: E402, F401  (registers Meta-World/MT1)
import mujoco  # noqa: E402
import numpy as np  # noqa: E402
import torch  # noqa: E402
from metaworld.policies import ENV_POLICY_MAP  # noqa: E402

from move import paths  # noqa: E402
from move.files import written_aside  # noqa: E402
from move.learn.agents import PolicyAgent  # noqa: E402
from move.learn.evaluate import evaluate  # noqa: E402
from move.learn.evaluation import Evaluation  # noqa: E402
from move.learn.settings import Training  # noqa: E402
from move.learn.train import Trainer, train  # noqa: E402
from move.machine import gl_problem, gl_renderer, keep_freed_memory, processor  # noqa: E402
from move.paper import PAPER_METHODS  # noqa: E402
from move.sim.collect import Collection, attempts, collect  # noqa: E402
from move.sim.scene.scene import Scene  # noqa: E402
from move.sim.tasks import get_task  # noqa: E402
from move.study.kinds import policy_run  # noqa: E402
from move.study.processes import ProcessPool  # noqa: E402
from move.study.profiles import load_profile  # noqa: E402
from move.study.results import split  # noqa: E402

TASK = "pick-place"
torch.set_num_threads(1)
rows: list[tuple[str, str, str, str, str]] = []


def seconds(work: Callable[[], object]) -> float:
    """Seconds of one core that a call takes, its child processes and the system included."""
    started = sum(os.times()[:4])
    work()
    return sum(os.times()[:4]) - started


def report(what: str, ours: str, reference: str, ratio: float | None, wanted: str) -> None:
    """Note one line of the table."""
    rows.append((what, ours, reference, f"{ratio:.1f}x" if ratio else "", wanted))


def stock_collection(steps: int) -> int:
    """Meta-World as it comes, stepped by its own scripted policy; returns the steps made."""
    env, policy, made = gymnasium.make("Meta-World/MT1", env_name="pick-place-v3", seed=0), None, 0
    policy = ENV_POLICY_MAP["pick-place-v3"]()
    while made < steps:
        observation, _ = env.reset()
        successes = 0
        while successes < 10:
            action = np.clip(policy.get_action(observation), -1, 1).astype(np.float32)
            observation, _, _, truncated, info = env.step(action)
            successes, made = successes + int(info["success"]), made + 1
            if truncated:
                break
    return made


def bench_collection() -> None:
    """Demonstration steps a second, the same scripted policy in both."""
    plan = Collection(task=TASK, method="static", timesteps=12_000, expert="metaworld")
    collect(plan.model_copy(update={"timesteps": 200}), 0)
    made = 12_000 / seconds(lambda: collect(plan, 0))
    stock_collection(200)
    counted: list[int] = []
    took = seconds(lambda: counted.append(stock_collection(4000)))
    stock = counted[0] / took
    report("collection without images", f"{made:,.0f} steps/s", f"{stock:,.0f} stock Meta-World", made / stock, ">= 2x")


def bench_expert() -> None:
    """Success and length of the phase expert over 200 demonstrations of each method."""
    for method in PAPER_METHODS:
        tries = attempts(Collection(task=TASK, method=method, timesteps=1), seed=777)
        episodes = [next(tries) for _ in range(200)]
        kept = [len(episode.actions) for episode in episodes if episode.succeeded]
        outcome = f"{len(kept) / 2:.1f} %, {np.mean(kept):.1f} steps"
        report(f"expert, {method}, 200 demonstrations", outcome, "", None, "")


def bench_drawing() -> None:
    """Milliseconds a picture of 96 px, ours and with Meta-World's default settings at its own size."""
    scene = Scene(TASK, "rgb", 96)
    scene.reset(seed=0)
    scene.render_image(96)
    fast = seconds(lambda: [scene.render_image(96) for _ in range(40)]) / 40
    stock = gymnasium.make("Meta-World/MT1", env_name="pick-place-v3", seed=0, render_mode="rgb_array",
                           camera_name="corner2")
    stock.reset()
    stock.render()
    slow = seconds(lambda: [stock.render() for _ in range(8)]) / 8
    size = stock.render().shape[0]
    report("drawing at 96 px", f"{fast * 1e3:.1f} ms", f"{slow * 1e3:.0f} ms stock, {size} px", slow / fast, ">= 10x")
    model = stock.unwrapped.model
    model.vis.global_.offwidth = model.vis.global_.offheight = 480
    renderer = mujoco.Renderer(model, 96, 96)
    renderer.update_scene(stock.unwrapped.data, "corner2")
    renderer.render()
    slow = seconds(lambda: [renderer.render() for _ in range(8)]) / 8
    report("drawing at 96 px", f"{fast * 1e3:.1f} ms", f"{slow * 1e3:.0f} ms stock, 96 px", slow / fast, ">= 10x")


def bench_keypoint_run() -> None:
    """A whole keypoint run, and its evaluation batched against one episode at a time."""
    task, recipe = get_task(TASK), load_profile("laptop").training["keypoints"]
    made: dict[str, object] = {}
    took = seconds(lambda: made.update(data=collect(Collection(task=TASK, method="move", timesteps=2500), 0)[0]))
    trained = seconds(lambda: made.update(policy=train(made["data"], recipe, 0)[0]))
    batched = seconds(lambda: evaluate(PolicyAgent(made["policy"], 0), task, Evaluation()))
    single = seconds(lambda: evaluate(PolicyAgent(made["policy"], 0), task, Evaluation(episodes=20), batch_size=1)) * 5
    report("keypoint run, 2,500 timesteps", f"{took + trained + batched:.1f} s",
           f"{took:.1f} + {trained:.1f} + {batched:.1f} s", None, "<= 40 s")
    report("batched evaluation, 100 episodes", f"{batched:.1f} s", f"{single:.1f} s one at a time", single / batched,
           ">= 3x")


def bench_image_training() -> None:
    """A gradient step on pictures against the same windows without what makes it fast; and what whole runs take."""
    profile = load_profile("laptop")
    recipe = profile.training["rgb"]
    made: dict[str, object] = {}
    plan = Collection(task=TASK, method="static", timesteps=1000, observation="rgb", factors="object")
    keep_freed_memory()
    drawn = seconds(lambda: made.update(data=collect(plan, 0)[0])) / 1000

    def step_of(training: Training) -> float:
        trainer = Trainer(made["data"], training, 0, "cpu")
        trainer.take_step()
        return seconds(lambda: [trainer.take_step() for _ in range(40)]) / 40

    step = step_of(recipe)
    plain = recipe.model_copy(update={"noise_draws": 1, "learning_frames": None, "precision": "float32"})
    windows, reference = recipe.batch_size / step, recipe.batch_size / step_of(plain)
    how = "one noise level, all frames learn, float32"
    report("training windows, images", f"{windows:,.0f} a second", f"{reference:,.0f} {how}", windows / reference, "")
    report("noise levels tried on them", f"{windows * recipe.noise_draws:,.0f} a second", f"{reference:,.0f} {how}",
           windows * recipe.noise_draws / reference, "")
    report(f"image gradient step, {recipe.batch_size} windows x {recipe.noise_draws}", f"{step * 1e3:.0f} ms", "", None,
           "")
    policy, _ = train(made["data"], recipe.model_copy(update={"gradient_steps": 30, "warmup_steps": 10}), 0)
    small = Evaluation(starts="grid", grid_side=5, factors="object")
    tried = seconds(lambda: evaluate(PolicyAgent(policy, 0), get_task(TASK), small, policy.observation)) / 25
    for frames, episodes, wanted in ((7_000, 153, "<= 5"), (20_000, 100, "<= 10")):
        parts = (drawn * frames, step * profile.recipe("rgb", frames).gradient_steps, tried * episodes)
        report(f"image run of {frames:,} frames", f"{sum(parts) / 60:.1f} core-min",
               f"{parts[0]:.0f} + {parts[1]:.0f} + {parts[2]:.0f} s (scaled up)", None, wanted)


def bench_memory() -> None:
    """The most memory of an image run of 20,000 timesteps, with fewer gradient steps and episodes than it has."""
    profile = load_profile("laptop")
    spec = policy_run(profile, task=TASK, method="move", seed=0, timesteps=20_000, gradient_steps=50, warmup_steps=10,
                      episodes=20)
    with tempfile.TemporaryDirectory() as folder, ProcessPool(1) as pool:
        pool.submit(spec, Path(folder)).result()
        (made,), _ = split([spec], Path(folder))
    report("memory, image run of 20,000 timesteps", f"{made.provenance['peak_memory_mb']:,.0f} MB", "", None,
           "<= 1,300 MB")


def report_command(what: str, arguments: list[str], wanted: str, **variables: str) -> None:
    """Run a command in the repository with more environment variables, and note what it took.

    Raises:
        subprocess.CalledProcessError: it failed.
    """
    began = time.monotonic()
    took = seconds(lambda: subprocess.run(arguments, cwd=paths.ROOT, check=True, stdout=subprocess.DEVNULL,
                                          stderr=subprocess.DEVNULL, env={**os.environ, **variables}))
    report(what, f"{took:.1f} s", f"{time.monotonic() - began:.0f} s by the clock", None, wanted)


def bench_commands() -> None:
    """Commands that read what is stored, in a folder of their own, so that no shipped figure is written.

    First of all parts: a process begins with the memory of the one that starts it, and others' would count.
    """
    with tempfile.TemporaryDirectory() as folder:
        for name in ("profiles", "results", "notebooks"):
            Path(folder, name).symlink_to(paths.ROOT / name)
        shutil.copytree(paths.ROOT / "paper_figures", Path(folder, "paper_figures"))
        for what, arguments, wanted in COMMANDS:
            report_command(what, [sys.executable, "-m", "move.cli", *arguments], wanted, **{paths.VARIABLE: folder})
    most = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / (1e6 if sys.platform == "darwin" else 1e3)
    report("memory, the largest of their processes", f"{most:,.0f} MB", "", None, "<= 1,000 MB")


def bench_tests() -> None:
    """The tests: finding them, and `make test` with its checks of style and types."""
    report_command("finding all tests", [sys.executable, "-m", "pytest", "--collect-only", "-q"], "<= 6 s")
    report_command("make test", ["make", "test"], "<= 330 s")


COMMANDS = (
    ("move plan", ["plan"], "<= 3 s"),
    ("move verify --all", ["verify", "--all"], "<= 5 s"),
    ("make fig1", ["figure", "fig1_sparse", "--stored-only"], "<= 7 s"),
    ("make figures", ["figure", "--stored-only"], "<= 90 s"),
)
PARTS: dict[str, Callable[[], None]] = {
    "commands": bench_commands, "collection": bench_collection, "expert": bench_expert, "keypoints": bench_keypoint_run,
    "drawing": bench_drawing, "training": bench_image_training, "memory": bench_memory, "tests": bench_tests,
}
DRAWN = ("drawing", "training", "memory")


def main() -> None:
    """Measure what was asked for, or everything, and print one table."""
    asked = sys.argv[1:] or list(PARTS)
    load = os.getloadavg()[0]
    for name in asked:
        if name in DRAWN and gl_problem():
            sys.stderr.write(f"{gl_problem()}\n")
        else:
            PARTS[name]()
    header = ("what", "ours", "reference", "ratio", "wanted")
    lines = [f"Measured by `make bench` on {processor()}, in seconds of one core; GL: {gl_renderer()}; load when it "
             f"began: {load:.1f}.", "",
             *(f"| {' | '.join(row)} |" for row in (header, ("---",) * len(header), *rows))]
    text = "\n".join(lines) + "\n"
    print(text, end="")
    if not sys.argv[1:]:
        with written_aside(load_profile("laptop").figures / "bench.md") as new:
            new.write_text(text)


if __name__ == "__main__":
    main()
