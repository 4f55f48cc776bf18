"""Hostile data sets: each is refused in one line that names what is wrong, and none takes much time or memory."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import h5py
import hostile
import numcodecs
import numpy as np
import pytest
import real_writers as w

from move.errors import BadInput
from move.learn import dataset
from move.realworld import open_dataset
from move.untrusted import Limits, limits, plain_files, within

MOST_SECONDS = 30


def read_all(folder: Path) -> None:
    """Open a data set, and look at frames of every camera; what could not be read is raised."""
    data = open_dataset(folder, episodes=None)
    if data.unread:
        raise BadInput(data.unread[0])
    for episode in data.episodes:
        for frames in episode.cameras.values():
            frames.read(range(min(2, len(frames))))


def train_reads(folder: Path) -> None:
    """What `move train --clip-actions` reads."""
    dataset.load(folder, clip_actions=True)


def refused(read, folder: Path, word: str) -> str:
    """The one line of a refusal."""
    started = time.monotonic()
    with pytest.raises(BadInput, match=word) as caught:
        read(folder)
    line = str(caught.value)
    assert "\n" not in line and len(line) < 1000 and hostile.SECRET not in line
    assert time.monotonic() - started < MOST_SECONDS
    return line


@pytest.mark.parametrize("name", hostile.REAL)
def test_a_hostile_data_set_is_refused_by_name(tmp_path, name):
    word, write = hostile.REAL[name]
    refused(read_all, write(tmp_path / "set"), word)


@pytest.mark.parametrize("name", hostile.STORED)
def test_hostile_demonstrations_are_refused_by_name(tmp_path, name):
    word, write = hostile.STORED[name]
    refused(train_reads, write(tmp_path / "set"), word)


class Opens:
    """Makes a file when it is unpickled."""

    def __init__(self, path: Path) -> None:
        self.path = str(path)

    def __reduce__(self):
        return open, (self.path, "w")


@pytest.mark.parametrize("how", [{"dtype": "|O"}, {}], ids=["of objects", "of numbers"])
@pytest.mark.parametrize("read", [read_all, train_reads])
def test_no_pickle_runs(tmp_path, monkeypatch, read, how):
    monkeypatch.setattr(numcodecs.pickles, "ALLOW_UNSAFE_PICKLE_DECODE", True)  # as somebody's environment may say
    pickled = numcodecs.Pickle().encode(np.array([Opens(tmp_path / "ran")], dtype=object))
    codecs = {"filters": [{"id": "pickle", "protocol": 5}], "compressor": None}
    refused(read, hostile.chunk(pickled, **codecs, **how)(tmp_path / "set"), "pickle")
    assert not (tmp_path / "ran").exists()
    numcodecs.Pickle().decode(pickled)
    assert (tmp_path / "ran").exists(), "it would have run"


def test_their_good_neighbours_are_read(tmp_path):
    def links(file: h5py.File) -> None:
        hostile.dag(file)  # 2 ** 26 ways, each group looked at once
        file["observations/loop"] = file["observations"]
        file["observations/soft"] = h5py.SoftLink("/observations/qpos")
        file["observations/nowhere"] = h5py.SoftLink("/gone")

    read_all(hostile.v2(tmp_path / "video"))
    read_all(hostile.store(tmp_path / "zarr").parent)
    train_reads(tmp_path / "zarr/replay_buffer.zarr")
    read_all(hostile.act(links)(tmp_path / "act"))
    (tmp_path / "link").symlink_to(tmp_path / "video")
    read_all(tmp_path / "link")


def test_hidden_folders_are_no_part_of_a_data_set(tmp_path):
    w.pika_tree(tmp_path / "set")
    for place in (".git", "episode0/arm/jointState/.aaa"):
        (tmp_path / "set" / place).mkdir()
        (tmp_path / "set" / place / "1.json").symlink_to("/etc/passwd")
    read_all(tmp_path / "set")
    assert not any("/." in f"/{name}" for name in plain_files(tmp_path / "set"))


def test_videos_beside_a_buffer_are_read_only_inside_the_data_set(tmp_path):
    w.zarr_buffer(tmp_path / "set")
    w.write_video(tmp_path / "set/videos/0/cam.mp4", range(6))
    assert "cam" in open_dataset(tmp_path / "set").episodes[0].cameras
    assert "cam" not in open_dataset(tmp_path / "set/replay_buffer.zarr").episodes[0].cameras


def test_a_limit_is_named_with_the_way_to_raise_it(tmp_path, monkeypatch):
    w.lerobot_v2(tmp_path / "set")
    monkeypatch.setenv("MOVE_LIMITS", "rows=5")
    line = refused(read_all, tmp_path / "set", "6 rows; allowed are 5;")
    assert "MOVE_LIMITS=rows=... allows more" in line
    monkeypatch.setenv("MOVE_LIMITS", "rows=6, files=1e6")
    read_all(tmp_path / "set")
    assert limits() == Limits(rows=6, files=1_000_000)


@pytest.mark.parametrize("given", ["rows", "rows=x", "row=5", "rows=0", "rows=inf", "=5"])
def test_a_wrong_limit_is_refused(monkeypatch, given):
    monkeypatch.setenv("MOVE_LIMITS", given)
    with pytest.raises(BadInput, match="MOVE_LIMITS"):
        within("rows", 1, "here")


CHILD = """
import json, sys, time
from pathlib import Path
from test_hostile_data import read_all
def peak():
    return next(int(line.split()[1]) for line in Path("/proc/self/status").read_text().splitlines() if "VmHWM" in line)
before = peak()
for folder in sys.argv[1:]:
    started, said = time.monotonic(), "read"
    try:
        read_all(Path(folder))
    except Exception as error:
        said = f"{type(error).__name__} {error}"
    print(json.dumps([said, 1024 * (peak() - before), time.monotonic() - started]))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the address space of a process is limited on Linux")
def test_what_needs_much_memory_is_refused_within_the_memory_that_is_allowed(tmp_path):
    folders = [str(write(tmp_path / str(number))) for number, write in enumerate(hostile.BOMBS.values())]
    tests = Path(__file__).parent
    done = subprocess.run([sys.executable, "-c", CHILD, *folders], capture_output=True, text=True, timeout=300,
                          check=True, env=os.environ | {"PYTHONPATH": f"{tests.parent}:{tests}",
                                                        "MOVE_LIMITS": "memory_bytes=5e8"})
    for name, row in zip(hostile.BOMBS, done.stdout.splitlines(), strict=True):
        said, peak_bytes, seconds = json.loads(row)
        assert said.startswith("BadInput") and "500,000,000 bytes of memory needed" in said, name
        assert peak_bytes < 8e8 and seconds < MOST_SECONDS, name  # what was mapped before and not used comes on top
