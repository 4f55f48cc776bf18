"""What a reader does first: `make`, and the set-up with whatever Python there is."""

import hashlib
import importlib.util
import re
import subprocess
import tarfile
import zipfile

import pytest

from move import paths
from move.figures import names, short_names

STUB = "#!/bin/sh\nmkdir -p .venv/bin; echo \"$@\" > .venv/called; ln -sf /bin/true .venv/bin/python\n"


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


def set_up(folder, tools: dict[str, str]) -> subprocess.CompletedProcess:
    """`make setup` in a copy where Python is too new and `tools` are all that is on the path besides the system's."""
    (folder / "tools").mkdir()
    for name in ("Makefile", "environment.lock", "environment-cuda.lock", "pyproject.toml", "tools/install.py"):
        (folder / name).write_bytes((paths.ROOT / name).read_bytes())
    (folder / "bin").mkdir()
    for name, text in tools.items():
        (folder / "bin" / name).write_text(text)
        (folder / "bin" / name).chmod(0o755)
    return subprocess.run(["make", "setup", "PYTHON=false"], cwd=folder, capture_output=True, text=True,
                          env={"PATH": f"{folder}/bin:/usr/bin:/bin"})


def test_without_python_3_11_the_set_up_takes_it_from_uv(tmp_path):
    done = set_up(tmp_path, {"uv": STUB})
    assert done.returncode == 0, done.stderr
    assert (tmp_path / ".venv/called").read_text().split() == ["venv", "--quiet", "--seed", "--python", "3.11", ".venv"]
    assert (tmp_path / ".venv/ready").exists()


def test_without_either_one_line_names_two_ways(tmp_path):
    done = set_up(tmp_path, {})
    lines = [line for line in done.stderr.splitlines() if "***" not in line]
    assert done.returncode == 2 and len(lines) == 1 and "PYTHON=" in lines[0] and "install uv" in lines[0]
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
