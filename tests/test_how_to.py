"""What the how-to pages add is a commit each: it fits what stands here, is as small as the page says, and works."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from shared import plan as any_plan

from move import paths
from move.errors import BadInput
from move.learn.agents import Expert, Nothing
from move.learn.evaluate import Evaluation, evaluate
from move.paper import PAPER_METHODS
from move.sim.collect import collect
from move.sim.coverage import configurations
from move.sim.methods import METHODS, Method
from move.sim.motion.adc import Jumping
from move.sim.motion.wrappers import SPEEDS, Motions
from move.sim.tasks import TASKS, Task
from move.study.kinds import policy_run
from move.study.profiles import load_profile

PAGES = {"encoder": "add_an_encoder", "figure": "add_a_figure", "task": "add_a_task",
         "method": "add_a_collection_method"}
COMMITS = paths.ROOT / "docs/how-to/commits"


def page(name: str) -> str:
    return (paths.ROOT / f"docs/how-to/{PAGES[name]}.md").read_text(encoding="utf-8")


def added(name: str) -> dict[str, list[str]]:
    """The lines that a commit adds, of each file."""
    files = re.split(r"^diff --git a/\S+ b/", (COMMITS / f"{name}.patch").read_text(encoding="utf-8"), flags=re.M)[1:]
    return {text.split("\n", 1)[0]: [line[1:] for line in text.split("\n@@", 1)[1].splitlines() if line[:1] == "+"]
            for text in files}


def test_every_commit_has_its_page():
    assert {path.stem for path in COMMITS.iterdir()} == {*PAGES}


@pytest.mark.parametrize("name", PAGES)
def test_a_commit_fits_what_stands_here_or_stands_here_already(name):
    command = ["git", "apply", "--check", "--unsafe-paths", COMMITS / f"{name}.patch"]
    done, undone = (subprocess.run([*command, *more], cwd=paths.ROOT, capture_output=True, text=True)
                    for more in ([], ["--reverse"]))
    assert 0 in (done.returncode, undone.returncode), f"make it again from what stands here: {done.stderr}"


@pytest.mark.parametrize("name", PAGES)
def test_a_commit_is_as_small_as_its_page_says_and_holds_its_code(name):
    files = added(name)
    told = re.search(r"a commit of (\d+) files and (\d+) lines", page(name))
    assert told and [int(number) for number in told.groups()] == [len(files), sum(map(len, files.values()))]
    assert f"commits/{name}.patch" in page(name)
    assert all(f"`{file}`" in page(name) for file in files)
    block = re.findall(r"```python\n(.*?)```", page(name), flags=re.S)[-1]
    lines = [line for file in files.values() for line in file]
    assert set(block.splitlines()) <= {*lines, ""}


def known(monkeypatch: pytest.MonkeyPatch, name: str, table: dict) -> Any:
    """What the new file of a commit defines, entered in its table for the duration of a test."""
    (source,) = ["\n".join(lines) for file, lines in added(name).items() if not file.endswith("__init__.py")]
    defined: dict[str, Any] = {"__name__": name}
    exec(source, defined)
    found = next(value for value in reversed(defined.values()) if isinstance(value, Task | Method))
    monkeypatch.setitem(table, found.name, found)
    return found


@pytest.fixture
def jitter(monkeypatch) -> Method:
    return known(monkeypatch, "method", METHODS)


plan = partial(any_plan, method="jitter", timesteps=300)


def test_the_pages_task_is_demonstrated_by_every_method_and_solved_by_the_expert(monkeypatch):
    task = known(monkeypatch, "task", TASKS)
    for method in PAPER_METHODS:
        _, record = collect(plan(task=task.name, method=method, timesteps=600), seed=1)
        assert record.generation_rate >= 0.9
        moved = [start.object_position != grasp.object_position
                 for start, grasp in zip(record.starts, record.grasps, strict=True)]
        assert all(moved) if method != "static" else not any(moved)
    tried = Evaluation(episodes=20)
    assert sum(row["success"] for row in evaluate(Expert("phase"), task, tried)) >= 19
    assert not any(row["success"] for row in evaluate(Nothing(), task, tried))


@pytest.mark.parametrize("choice, moving", [
    ({}, {"object", "target", "camera"}), ({"moving": ["object", "target"]}, {"object", "target"}),
    ({"moving": ["camera"]}, {"camera"}), ({"object_speed": 0.1}, {"object", "target", "camera"})])
def test_the_pages_method_moves_what_is_chosen_as_fast_as_is_chosen(jitter, choice, moving):
    seen = configurations(plan(**choice), seed=1)
    found = {"object": seen[seen.phase == "pick"].groupby("episode")[["object_x", "object_y"]].diff(),
             "target": seen.groupby("episode")[["target_x"]].diff(),
             "camera": seen.groupby("episode")[["camera_angle"]].diff()}
    fastest = {part: np.linalg.norm(steps.dropna(), axis=1).max() for part, steps in found.items()}
    assert {part for part, speed in fastest.items() if speed > 0} == moving
    assert fastest["object"] <= choice.get("object_speed", 0.03)
    assert (fastest["object"] > 0.03) == ("object_speed" in choice)


def test_the_pages_method_is_a_part_of_mixtures_with_its_speeds(jitter):
    mixture = plan(method="mixture", shares={"jitter": 0.5, "static": 0.5}, object_speed=0.1, moving=["object"])
    static, trembling = mixture.parts
    assert static == plan(method="static", timesteps=150)
    assert trembling == plan(timesteps=150, object_speed=0.1, moving=["object"])
    made, alone = (collect(chosen, seed=2)[0] for chosen in (mixture, trembling))
    assert np.array_equal(made.observations[150:], alone.observations)


def test_the_pages_method_is_known_to_gymnasium_to_grids_and_to_messages(jitter):
    env = gymnasium.make("MOVE/pick-place-v0", method="jitter", object_speed=0.1, disable_env_checker=True)
    env.reset(seed=0)
    before = env.unwrapped.configuration.object_position
    env.step(np.zeros(4, np.float32))
    assert 0 < np.linalg.norm(np.subtract(env.unwrapped.configuration.object_position, before)) <= 0.1
    profile = load_profile("smoke").model_copy(update={"collection": {"jitter": {"object_speed": 0.01}}})
    spec = policy_run(profile, task="push", method="jitter", seed=0, timesteps=100)
    assert (spec.method, spec.collection.object_speed) == ("jitter", 0.01)
    for wrong, message in ({"method": "static", "object_speed": 0.1}, "nothing moves .* allowed with move, jitter"), (
            {"method": "dance"}, "allowed are static, adc, move, mixture, jitter"), (
            {"jumping": Jumping(times=2)}, "jumping given for method 'jitter'; allowed with adc"):
        with pytest.raises(BadInput, match=message):
            plan(**wrong)


def test_a_method_takes_speeds_of_what_it_moves_and_no_others(monkeypatch, jitter):
    monkeypatch.setitem(METHODS, "jitter", replace(jitter, moves=("object",)))
    assert plan().motions_used == Motions(target_speed=0, camera_speed=0, yaw_speed=0)
    with pytest.raises(BadInput, match="the camera does not move; allowed are speeds of object"):
        plan(camera_speed=0.1)
    mixture = plan(method="mixture", shares={"jitter": 0.5, "move": 0.5}, moving=["camera"])
    moved, trembling = mixture.parts
    assert moved.motions_used.camera_speed and not moved.motions_used.object_speed
    assert not any(getattr(trembling.motions_used, speed) for speed in SPEEDS.values())


def patched(folder: Path, *names: str) -> Callable[..., str]:
    """What runs a Python module in a copy of this tree with some commits, and returns what it wrote."""
    shutil.copytree(paths.ROOT, folder, ignore=shutil.ignore_patterns(".venv", "build"))
    for name in names:
        subprocess.run(["git", "apply", COMMITS / f"{name}.patch"], cwd=folder, check=True)

    def python(*arguments: object) -> str:
        environment = os.environ | {"PYTHONPATH": str(folder), "OMP_NUM_THREADS": "1"}
        environment.pop(paths.VARIABLE, None)  # the package in the copy has the copy for its root
        done = subprocess.run([sys.executable, "-m", *map(str, arguments)], cwd=folder, env=environment,
                              capture_output=True, text=True)
        assert done.returncode == 0, done.stdout[-5000:] + done.stderr[-5000:]
        return done.stdout

    return python


@pytest.mark.slow
@pytest.mark.parametrize(("name", "collected", "profile"), [
    ("encoder", ["--observation", "rgb", "--image-size", 48], "pooled"), ("method", ["--method", "jitter"], "smoke"),
    ("task", ["--task", "drawer-open"], "smoke")])
def test_what_a_commit_adds_is_collected_learnt_and_tried(name, collected, profile, tmp_path):
    here, data, policy = tmp_path / "here", tmp_path / "data.zarr", tmp_path / "policy"
    python = patched(here, name)
    smoke = (here / "profiles/smoke.yaml").read_text(encoding="utf-8")
    (here / "profiles/pooled.yaml").write_text(smoke.replace("encoder: small_cnn", "encoder: pooled"))
    python("move.cli", "collect", "--out", data, *collected, "--timesteps", 150)
    python("move.cli", "train", data, policy, "--profile", profile, "--gradient-steps", 3)
    assert "success" in python("move.cli", "evaluate", policy, "--episodes", 1)


@pytest.mark.slow
def test_with_all_commits_every_fast_test_passes_and_no_run_gets_another_hash(tmp_path):
    python = patched(tmp_path / "here", *PAGES)
    python("move.cli", "figure", "fig_patience", "--stored-only")  # and what it writes is committed with it
    with (tmp_path / "here/notebooks/start.md").open("a", encoding="utf-8") as start:
        start.write("\n[fig_patience](fig_patience.ipynb)\n")
    subprocess.run(["git", "add", "--all"], cwd=tmp_path / "here", check=True)
    python("pytest", "-q", "-n", 2, "--dist", "loadfile", "--no-loadscope-reorder", "-m", "not slow and not browser")
