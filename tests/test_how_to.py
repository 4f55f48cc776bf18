"""What the how-to pages add is a commit each: it fits what stands here, is as small as the page says, and works."""

import os
import re
import shutil
import subprocess
import sys

import pytest

from move import paths

PAGES = {"encoder": "add_an_encoder_or_a_figure", "task": "add_a_task", "method": "add_a_collection_method"}
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
def test_a_commit_fits_what_stands_here(name):
    done = subprocess.run(["git", "apply", "--check", "--unsafe-paths", COMMITS / f"{name}.patch"], cwd=paths.ROOT,
                          capture_output=True, text=True)
    assert done.returncode == 0, f"make it again from what stands here: {done.stderr}"


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


@pytest.mark.slow
@pytest.mark.parametrize(("name", "collected", "profile"), [
    ("encoder", ["--observation", "rgb", "--image-size", 48], "pooled"), ("method", ["--method", "jitter"], "smoke"),
    ("task", ["--task", "push-back"], "smoke")])
def test_what_a_commit_adds_is_collected_learnt_and_tried_and_no_run_gets_another_hash(
        name, collected, profile, tmp_path):
    here, data, policy = tmp_path / "here", tmp_path / "data.zarr", tmp_path / "policy"
    shutil.copytree(paths.ROOT, here, ignore=shutil.ignore_patterns(".git", ".venv", "build", "results"))
    subprocess.run(["git", "apply", COMMITS / f"{name}.patch"], cwd=here, check=True)

    def python(*arguments: object) -> str:
        environment = os.environ | {"PYTHONPATH": str(here), "MOVE_ROOT": str(here), "OMP_NUM_THREADS": "1"}
        done = subprocess.run([sys.executable, "-m", *map(str, arguments)], cwd=here, env=environment,
                              capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    python("pytest", "-q", "tests/test_hashes.py")
    smoke = (here / "profiles/smoke.yaml").read_text(encoding="utf-8")
    (here / "profiles/pooled.yaml").write_text(smoke.replace("encoder: small_cnn", "encoder: pooled"))
    python("move.cli", "collect", "--out", data, *collected, "--timesteps", 150)
    python("move.cli", "train", data, policy, "--profile", profile, "--gradient-steps", 3)
    assert "success" in python("move.cli", "evaluate", policy, "--episodes", 1)
