"""What a reader does first: `make`, and the set-up with whatever Python there is."""

import hashlib
import importlib.util
import json
import re
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from functools import cache

import pytest
from packaging import tags
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name, parse_wheel_filename

from move import paths
from move.figures import names, short_names

PYTHONS = ("3.11", "3.12", "3.13")
PLATFORMS = (("linux", "x86_64"), ("linux", "aarch64"), ("darwin", "arm64"))
UV = '#!/bin/sh\nmkdir -p .venv/bin; echo "uv $@" > .venv/called; ln -sf /bin/true .venv/bin/python\n'
LOCK, CUDA_LOCK = paths.LOCK.name, "environment-cuda.lock"


def test_make_help_has_a_line_for_every_figure():
    listed = subprocess.run(["make"], cwd=paths.ROOT, capture_output=True, text=True, check=True).stdout
    listed_names = {word for line in listed.splitlines() if line.startswith("  ") for word in line.split()}
    assert {*names(), *short_names()} <= listed_names
    assert {"figures", "test", "plan", "verify", "lab", "bench"} <= listed_names
    assert max(map(len, listed.splitlines())) <= 115


def test_every_short_name_of_the_command_line_is_a_target():
    for name, whole in short_names().items():
        done = subprocess.run(["make", "-n", name], cwd=paths.ROOT, capture_output=True, text=True)
        assert done.returncode == 0 and f"figure {whole}" in done.stdout


def python_stub(version: tuple[int, ...]) -> str:
    """A Python of that version, which notes who was asked for an environment in place of making one."""
    return ('#!/bin/sh\nif [ "$1" = -c ]; then\n'
            f'  exec {sys.executable} -c "import sys; sys.version_info = {version}; $2"\nfi\n'
            'mkdir -p .venv/bin; echo "${0##*/} $@" > .venv/called; ln -sf /bin/true .venv/bin/python\n')


def set_up(folder, versions: dict[str, tuple[int, ...]], *arguments: str, uv: bool = False):
    """`make setup` in a copy where the Pythons on the path have these versions; those not given are too old."""
    (folder / "tools").mkdir()
    for name in ("Makefile", LOCK, CUDA_LOCK, "pyproject.toml", "tools/install.py"):
        (folder / name).write_bytes((paths.ROOT / name).read_bytes())
    (folder / "bin").mkdir()
    stubs = {name: python_stub(versions.get(name, (3, 10, 12)))
             for name in ("python3", *(f"python{version}" for version in PYTHONS), *versions)}
    for name, text in (stubs | ({"uv": UV} if uv else {})).items():
        (folder / "bin" / name).write_text(text)
        (folder / "bin" / name).chmod(0o755)
    return subprocess.run(["make", "setup", *arguments], cwd=folder, capture_output=True, text=True,
                          env={"PATH": f"{folder}/bin:/usr/bin:/bin"})


@pytest.mark.parametrize("versions, arguments, taken", [
    ({"python3": (3, 11, 2), "python3.13": (3, 13, 0)}, (), "python3"),
    ({"python3": (3, 13, 5)}, (), "python3"),
    ({"python3": (3, 14, 0), "python3.12": (3, 12, 1)}, (), "python3.12"),
    ({"python3.13": (3, 13, 0)}, (), "python3.13"),
    ({"python3": (3, 11, 2), "mine": (3, 12, 0)}, ("PYTHON=mine",), "mine"),
])
def test_the_set_up_takes_the_first_python_that_is_neither_too_old_nor_too_new(tmp_path, versions, arguments, taken):
    done = set_up(tmp_path, versions, *arguments, uv=True)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / ".venv/called").read_text().split() == [taken, "-m", "venv", "--clear", ".venv"]
    assert (tmp_path / ".venv/ready").exists()


def test_without_a_fitting_python_the_set_up_takes_one_from_uv(tmp_path):
    done = set_up(tmp_path, {"python3": (3, 14, 0)}, uv=True)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / ".venv/called").read_text().split() == "uv venv --quiet --seed --python 3.11 .venv".split()
    assert (tmp_path / ".venv/ready").exists()


@pytest.mark.parametrize("versions, arguments",
                         [({"python3": (3, 14, 0)}, ()), ({"python3": (3, 12, 0)}, ("PYTHON=false",))])
def test_without_either_one_line_says_which_pythons_fit_and_names_two_ways(tmp_path, versions, arguments):
    done = set_up(tmp_path, versions, *arguments)
    lines = [line for line in done.stderr.splitlines() if "***" not in line]
    assert done.returncode == 2 and len(lines) == 1 and "PYTHON=" in lines[0] and "install uv" in lines[0]
    assert all(version in lines[0] for version in PYTHONS)
    assert not (tmp_path / ".venv").exists()


@pytest.fixture
def install(tmp_path, monkeypatch):
    """tools/install.py with a lock of its own, where pip sees the folder "wheels" alone."""
    found = importlib.util.spec_from_file_location("install", paths.ROOT / "tools/install.py")
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    monkeypatch.setattr(module, "LOCK", tmp_path / "environment.lock")
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(tmp_path / "wheels"))
    (tmp_path / "wheels").mkdir()
    return module


def lock(folder, torch: str, numpy: str) -> None:
    (folder / "environment.lock").write_text(
        f"numpy==2.4.6 \\\n    --hash=sha256:{numpy}\ntorch==2.13.0 \\\n    --hash=sha256:{'0' * 64} \\\n"
        f"    --hash=sha256:{torch}\n    # via x\nzarr==3.0 \\\n    --hash=sha256:{numpy}\n")


def test_a_source_distribution_of_torch_is_not_fetched_and_its_code_does_not_run(install, tmp_path):
    lock(tmp_path, "1" * 64, "2" * 64)
    with tarfile.open(tmp_path / "wheels/torch-2.13.0+evil.tar.gz", "w:gz") as archive:
        for name, text in (("setup.py", f"open({str(tmp_path / 'ran')!r}, 'w')"),
                           ("PKG-INFO", "Metadata-Version: 2.1\nName: torch\nVersion: 2.13.0+evil\n")):
            (tmp_path / name).write_text(text)
            archive.add(tmp_path / name, f"torch-2.13.0+evil/{name}")
    with pytest.raises(subprocess.CalledProcessError):
        install.install_torch(None)
    assert not (tmp_path / "ran").exists()


@pytest.mark.parametrize("hashed_as", ["torch", "numpy"])
def test_a_wheel_of_torch_needs_a_hash_of_torchs_own(install, tmp_path, monkeypatch, hashed_as):
    wheel = tmp_path / "wheels/torch-2.13.0+evil-py3-none-any.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        archive.writestr("torch-2.13.0+evil.dist-info/METADATA",
                         "Metadata-Version: 2.1\nName: torch\nVersion: 2.13.0+evil\n")
        archive.writestr("torch-2.13.0+evil.dist-info/WHEEL", "Wheel-Version: 1.0\nTag: py3-none-any\n")
        archive.writestr("torch-2.13.0+evil.dist-info/RECORD", "")
    digest = hashlib.sha256(wheel.read_bytes()).hexdigest()
    lock(tmp_path, **{"torch": "1" * 64, "numpy": "2" * 64} | {hashed_as: digest})
    run, installed = subprocess.run, []

    def watched(command, **keywords):
        return installed.append(command) if "install" in command else run(command, **keywords)

    monkeypatch.setattr(subprocess, "run", watched)
    if hashed_as == "torch":
        install.install_torch(None)
        assert [command[-1].endswith("evil-py3-none-any.whl") for command in installed] == [True]
    else:
        with pytest.raises(SystemExit, match=f"torch-2.13.0.evil-.* has hash {digest}, which is none of torch's"):
            install.install_torch(None)
        assert not installed


def test_the_hashes_of_torch_are_its_own_and_everything_is_fetched_as_wheels():
    found = importlib.util.spec_from_file_location("install", paths.ROOT / "tools/install.py")
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    pin, own = module.locked_torch()
    blocks = re.split(r"\n(?=\S)", paths.LOCK.read_text())
    (block,) = [text for text in blocks if text.startswith("torch==")]
    assert block.startswith(pin) and own == set(re.findall("sha256:([0-9a-f]{64})", block)) and len(own) > 2
    assert "--only-binary :all:" in " ".join(module.LOCKED)


# the lock on every Python and platform -------------------------------------------------------------------------------


@cache
def pins(lock: str) -> list[tuple[Requirement, list[str]]]:
    """Each pin of a lock file with the names of its wheels, which `make lock` writes below the hashes."""
    blocks = re.split(r"\n(?=\S)", (paths.ROOT / lock).read_text().strip())
    return [(Requirement(block.partition("\\")[0]), re.findall(r"^    # (\S+\.whl)$", block, re.MULTILINE))
            for block in blocks if not block.startswith("#")]


@cache
def platform_tags(python: str, system: str, machine: str) -> frozenset[tags.Tag]:
    """What CPython of that version installs on Linux with glibc 2.28 (Debian 10) or on macOS 14, as torch's wheels."""
    version = tuple(int(number) for number in python.split("."))
    platforms = list(tags.mac_platforms((14, 0), machine)) if system == "darwin" else [
        *(f"manylinux_2_{minor}_{machine}" for minor in range(28, 4, -1)),
        *(f"manylinux{name}_{machine}" for name in ("2014", "2010", "1"))]
    return frozenset([*tags.cpython_tags(version, platforms=platforms),
                      *tags.compatible_tags(version, f"cp{python.replace('.', '')}", platforms)])


def selected(lock: str, python: str, system: str, machine: str) -> dict[str, tuple[str, list[str]]]:
    """Package to version and fitting wheels on a platform, by a lock's markers; an error where one is pinned twice."""
    environment = {"python_version": python, "python_full_version": f"{python}.5", "sys_platform": system,
                   "platform_system": system.title(), "platform_machine": machine, "os_name": "posix",
                   "implementation_name": "cpython", "platform_python_implementation": "CPython"}
    chosen: dict[str, tuple[str, list[str]]] = {}
    for pin, files in pins(lock):
        if pin.marker is None or pin.marker.evaluate(environment):
            assert pin.name not in chosen
            version = str(pin.specifier).removeprefix("==")
            wheels = [(name, *parse_wheel_filename(name)) for name in files]
            assert all(own == canonicalize_name(pin.name) and number.public == version for _, own, number, *_ in wheels)
            fitting = platform_tags(python, system, machine)
            chosen[pin.name] = version, [name for name, *_, offered in wheels if offered & fitting]
    return chosen


@pytest.mark.parametrize("system, machine", PLATFORMS)
def test_the_lock_has_a_wheel_of_every_package_for_every_python_and_one_version_for_all(system, machine):
    versions = set()
    for python in PYTHONS:
        found = selected(LOCK, python, system, machine)
        cuda = selected(CUDA_LOCK, python, system, machine)
        assert len(found) > 180 and "torch" in found and bool(cuda) is (system == "linux")
        assert not [name for name, (_, wheels) in (found | cuda).items() if not wheels]
        versions |= {(name, version) for name, (version, _) in (found | cuda).items()}
    assert len(versions) == len({name for name, _ in versions})


def test_the_lock_has_what_is_declared_for_every_python():
    project = tomllib.loads((paths.ROOT / "pyproject.toml").read_text())["project"]
    for python in PYTHONS:
        found = selected(LOCK, python, "linux", "x86_64")
        for wanted in map(Requirement, project["dependencies"]):
            assert wanted.specifier.contains(found[canonicalize_name(wanted.name)][0])
    assert project["requires-python"] == ">=3.11,<3.14"


def test_the_image_builds_on_a_python_whose_cpu_build_of_torch_is_locked():
    text = (paths.ROOT / "Dockerfile").read_text()
    [python] = re.findall(r"^FROM python:(3\.\d+)-slim-\w+ AS system$", text, re.MULTILINE)
    assert any("+cpu-" in name for name in selected(LOCK, python, "linux", "x86_64")["torch"][1])
    container = json.loads((paths.ROOT / ".devcontainer/devcontainer.json").read_text())
    assert container["build"]["target"] == "system"
    for opened in container["customizations"]["codespaces"]["openFiles"]:
        assert (paths.ROOT / opened).exists()
