"""Installed as a wheel, without the repository: what works, and the one line of what needs a checkout."""

import os
import shutil
import subprocess
import sys
import tomllib
import zipfile

import pytest

from move import paths

WORKS = """
import gymnasium, move
env = gymnasium.make("MOVE/push-v0")
env.reset(seed=0)
assert env.step(env.action_space.sample())[0] is not None
print(move.__file__)
import sys
from move.cli import main
data = "build/data/pick-place-move-random-keypoints-150-0.zarr"
for command in ("collect --timesteps 150", f"train {data} policy --profile smoke --gradient-steps 4",
                "evaluate policy --episodes 1"):
    sys.argv = ["move", *command.split()]
    try:
        main()
    except SystemExit as end:
        assert not end.code, command
"""
NEEDS = """
import sys
from move.cli import main
codes = []
for command in ("plan", "run", "figure fig1", "verify", "doctor"):
    sys.argv = ["move", *command.split()]
    try:
        main()
    except SystemExit as end:
        codes.append(end.code)
print(*codes)
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """The wheel, built from a copy of what it is made of."""
    tree, built = tmp_path_factory.mktemp("tree"), tmp_path_factory.mktemp("built")
    for name in ("move", "profiles"):
        shutil.copytree(paths.ROOT / name, tree / name, symlinks=True, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(paths.ROOT / name, tree)
    subprocess.run([sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "--no-index",
                    "-w", str(built), str(tree)], check=True)
    return next(built.glob("*.whl"))


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory):
    """A folder with the wheel's content, as site-packages has it."""
    folder = tmp_path_factory.mktemp("site")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)
    return folder


def python(installed, folder, *arguments) -> subprocess.CompletedProcess:
    environment = {**os.environ, "PYTHONPATH": str(installed)}
    environment.pop(paths.VARIABLE, None)
    return subprocess.run([sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, text=True)


def test_the_wheel_has_every_module_of_the_tree_and_the_profiles_and_nothing_else(wheel):
    with zipfile.ZipFile(wheel) as archive:
        there = {name for name in archive.namelist() if ".dist-info/" not in name}
    modules = {path.relative_to(paths.ROOT).as_posix() for path in (paths.ROOT / "move").rglob("*.py")}
    profiles = {f"move/profiles/{path.name}" for path in paths.PROFILES.glob("*.yaml")}
    assert there == modules | profiles and len(profiles) >= 4
    packages = {path.parent for path in (paths.ROOT / "move").rglob("*.py")}
    assert all((folder / "__init__.py").exists() for folder in packages), "setuptools finds packages by __init__.py"
    assert "find" in tomllib.loads((paths.ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"]


def test_import_a_scene_collect_train_and_evaluate_work_without_the_repository(installed, tmp_path):
    done = python(installed, tmp_path, "-c", WORKS)
    assert done.returncode == 0 and done.stdout.startswith(str(installed)), done.stderr
    assert {path.name for path in tmp_path.iterdir()} == {"build", "policy"} and not (installed / "build").exists()


def test_what_needs_a_checkout_says_so_in_a_line(installed, tmp_path):
    done = python(installed, tmp_path, "-c", NEEDS)
    lines = done.stderr.splitlines()
    assert done.returncode == 0 and done.stdout == "2 2 2 2 2\n" and len(lines) == 5
    assert all("this needs a checkout of the repository" in line for line in lines) and not list(tmp_path.iterdir())
