"""What a reader does first: `make`, the set-up with whatever Python there is, and where the lock can be installed."""

import hashlib
import json
import subprocess

from move import choices, paths

STUB = "#!/bin/sh\nmkdir -p .venv/bin; echo \"$@\" > .venv/called; ln -sf /bin/true .venv/bin/python\n"


def test_make_help_has_a_line_for_every_figure():
    listed = subprocess.run(["make"], cwd=paths.ROOT, capture_output=True, text=True, check=True).stdout
    names = {line.split()[0] for line in listed.splitlines() if line.startswith("  ")}
    short = {long: name for name, long in choices.short_names().items() if name not in choices.ALSO}
    assert {short.get(name, name) for name in choices.notebooks()} <= names
    assert {"figures", "test", "plan", "verify", "lab", "bench"} <= names
    assert "Figure 5. Grasp points on a circle: inside and outside" in listed
    assert max(map(len, listed.splitlines())) <= 115


def test_every_short_name_of_the_command_line_is_a_target():
    for name in choices.short_names():
        done = subprocess.run(["make", "-n", name], cwd=paths.ROOT, capture_output=True, text=True)
        assert done.returncode == 0 and f"figure {choices.notebook(name)}" in done.stdout


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


def test_the_lock_was_found_to_install_on_each_platform():
    found = json.loads((paths.ROOT / "environment-platforms.json").read_text())
    assert found["lock"] == hashlib.sha256(paths.LOCK.read_bytes()).hexdigest(), "make lock, or tools/platforms.py"
    assert len(found["platforms"]) == 3 and set(found["platforms"].values()) == {"installs"}
    assert {word for name in found["platforms"] for word in ("x86-64", "Linux arm64", "macOS") if word in name} == {
        "x86-64", "Linux arm64", "macOS"}
