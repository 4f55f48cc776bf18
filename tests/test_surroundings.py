"""What a terminal, a shell or a machine does to the commands: closed streams, encodings, variables, GL, addresses."""

import json
import os
import re
import subprocess
import sys

import pytest
from shared import refused

from move import machine, paths
from move.errors import BadInput
from move.learn import train
from move.study import cluster

COLLECT = ("collect", "--timesteps", "40", "--json", "--out")


def run(*arguments, closed=(), **environment) -> subprocess.CompletedProcess:
    """One command in a process of its own, with standard streams closed by the shell."""
    shell = f'exec "$@" {" ".join(closed)}'
    return subprocess.run(["sh", "-c", shell, "sh", sys.executable, "-m", "move.cli", *arguments],
                          env={**os.environ, "PYTHONPATH": str(paths.ROOT), **environment}, capture_output=True,
                          text=True)


@pytest.mark.parametrize("closed", [["<&-", "2>&-"], ["<&-", ">&-", "2>&-"]])
def test_a_command_works_with_closed_standard_streams(tmp_path, closed):
    done = run(*COLLECT, str(tmp_path / "data.zarr"), closed=closed)
    assert done.returncode == 0 and (tmp_path / "data.zarr").is_dir()
    assert (json.loads(done.stdout)["timesteps"] == 40) if ">&-" not in closed else done.stdout == ""


def test_a_refusal_without_standard_error_keeps_its_exit_code():
    assert run("plan", "fig99", closed=["2>&-"]).returncode == 2


def test_a_path_that_the_encoding_lacks_is_written_as_escapes(tmp_path):
    done = run(*COLLECT[:3], "--out", str(tmp_path / "größe_数.zarr"), LC_ALL="C", PYTHONUTF8="0",
               PYTHONCOERCECLOCALE="0")
    assert done.returncode == 0 and (tmp_path / "größe_数.zarr").is_dir() and "Traceback" not in done.stderr


@pytest.mark.parametrize("variables, reason", [
    ({"MUJOCO_GL": "bogus"}, "MUJOCO_GL: 'bogus' given; allowed are egl"),
    ({"PYOPENGL_PLATFORM": "moon", "MUJOCO_GL": "egl"}, "PYOPENGL_PLATFORM: 'moon' given|library is not installed"),
])
def test_gl_that_cannot_be_had_costs_images_alone(tmp_path, variables, reason):
    if variables == {"MUJOCO_GL": "bogus"}:  # which MuJoCo refuses to be imported with
        assert run(*COLLECT, str(tmp_path / "data.zarr"), **variables).returncode == 0
    done = run(*COLLECT, str(tmp_path / "images.zarr"), "--observation", "rgb", **variables)
    assert done.returncode == 2 and done.stderr.count("\n") == 1 and not (tmp_path / "images.zarr").exists()
    assert re.search(reason, done.stderr)


EGL = ["EGL", "OpenGL"]


@pytest.mark.parametrize("variables, libraries, reason", [
    ({"MUJOCO_GL": "egl"}, EGL, ""), ({"MUJOCO_GL": " EGL "}, EGL, ""), ({}, EGL, ""), ({}, [], ""),
    ({"MUJOCO_GL": "disable"}, [], ""), ({"MUJOCO_GL": "osmesa"}, ["OSMesa"], ""),
    ({"MUJOCO_GL": "glfw", "DISPLAY": ":0"}, [], ""), ({"MUJOCO_GL": "egl", "PYOPENGL_PLATFORM": "egl"}, EGL, ""),
    ({"PYOPENGL_PLATFORM": "osmesa"}, ["OSMesa"], ""),
    ({"MUJOCO_GL": "osmesa"}, EGL, "MUJOCO_GL: osmesa given, whose library"),
    ({"MUJOCO_GL": "egl"}, [], "MUJOCO_GL: egl given, whose library"),
    ({"MUJOCO_GL": "egl"}, ["EGL"], "not installed (libOpenGL)"), ({}, ["EGL"], ""),
    ({"MUJOCO_GL": "glfw"}, EGL, "needs a screen"), ({"MUJOCO_GL": "glx"}, EGL, "needs a screen"),
    ({"MUJOCO_GL": "opengl"}, EGL, "'opengl' given; allowed are"),
    ({"PYOPENGL_PLATFORM": "osmesa"}, [*EGL, "OSMesa"], "PYOPENGL_PLATFORM: 'osmesa' given; allowed is egl"),
    ({"MUJOCO_GL": "osmesa", "PYOPENGL_PLATFORM": "egl"}, ["OSMesa"], "allowed is osmesa"),
])
def test_what_gl_can_be_had(monkeypatch, variables, libraries, reason):
    for name in ("MUJOCO_GL", "PYOPENGL_PLATFORM", "DISPLAY", "WAYLAND_DISPLAY", machine.REFUSED_GL):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr("ctypes.util.find_library", lambda name: name if name in libraries else None)
    monkeypatch.setattr(sys, "platform", "linux")
    found = machine._refused_gl()
    assert (reason in found and "\n" not in found) if reason else found == ""


@pytest.mark.parametrize("libraries, chosen, line", [
    (EGL, "egl", None), (["OSMesa"], "osmesa", None), ([*EGL, "OSMesa"], "egl", None),
    (["EGL", "GLESv2"], "egl", None), (["EGL", "OSMesa"], "osmesa", None),
    (["EGL"], "disable", "GL library libOpenGL not found"),
    (["OpenGL"], "disable", "GL library libEGL not found"), ([], "disable", "no GL library found"),
])
def test_egl_is_chosen_where_both_its_libraries_are(monkeypatch, libraries, chosen, line):
    monkeypatch.setattr(machine, "load_gl", lambda: None)
    monkeypatch.setattr("ctypes.util.find_library", lambda name: name if name in libraries else None)
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(machine.os, "environ", {})
    machine.choose_gl()
    assert machine.os.environ["MUJOCO_GL"] == chosen
    found = machine.gl_problem()
    assert found is None if line is None else found.startswith(f"{line}: apt-get install libegl1 libopengl0 (Debian)")


@pytest.mark.parametrize("text", ["abc", "", "-1", "nan", "1:40"])
def test_a_variable_that_is_no_time_is_refused_when_training_begins(monkeypatch, text):
    monkeypatch.setenv(train.VARIABLE, text)
    with pytest.raises(BadInput, match=f"{train.VARIABLE}: '{text}' given; allowed are seconds"):
        train._checkpoint_seconds()


@pytest.mark.parametrize("text, seconds", [("0", 0.0), ("2.5", 2.5), (None, 180.0)])
def test_a_variable_that_is_a_time_is_taken(monkeypatch, text, seconds):
    monkeypatch.delenv(train.VARIABLE, raising=False)
    if text is not None:
        monkeypatch.setenv(train.VARIABLE, text)
    assert train._checkpoint_seconds() == seconds


@pytest.mark.parametrize("address", ["tls://127.0.0.1:1", "tcp://127.0.0.1:1", "ws://127.0.0.1:1"])
def test_an_address_without_a_scheduler_is_one_line(tmp_path, monkeypatch, address):
    monkeypatch.setattr(cluster, "ANSWER", 0.3)
    with refused(f"no Dask scheduler at {address}"), cluster.dask_cluster(address, tmp_path):
        pass
    assert not list(tmp_path.iterdir())


def test_another_root_is_said(tmp_path):
    (tmp_path / "notebooks").mkdir()
    done = run("plan", "fig1", MOVE_ROOT=str(tmp_path))
    assert done.returncode == 2 and done.stderr.splitlines()[0] == (
        f"move: MOVE_ROOT: profiles, results and figures are those in {tmp_path}")
