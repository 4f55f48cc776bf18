"""Hostile data sets: each is refused in one line that names what is wrong, and none takes much time or memory."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import h5py
import hostile
import pytest
import real_writers as w

from move.errors import BadInput
from move.learn import dataset
from move.realworld import open_dataset
from move.untrusted import Limits, limits, plain_files, within

MOST_BYTES, MOST_SECONDS = 2e9, 30


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


def test_the_tables_are_long_and_their_good_neighbours_are_read(tmp_path):
    assert len(hostile.REAL) > 90 and len(hostile.STORED) > 35
    read_all(hostile.with_video(tmp_path / "video"))
    read_all(hostile.store(tmp_path / "zarr"))
    train_reads(tmp_path / "zarr/replay_buffer.zarr")
    read_all(hostile.act(tmp_path / "act", hostile.dag))  # 2 ** 26 ways, each group looked at once


def test_a_file_that_links_within_itself_is_read(tmp_path):
    def loop(file: h5py.File) -> None:
        file["observations/loop"] = file["observations"]
        file["observations/soft"] = h5py.SoftLink("/observations/qpos")
        file["observations/nowhere"] = h5py.SoftLink("/gone")

    read_all(hostile.act(tmp_path / "act", loop))


def test_the_folder_itself_may_be_a_link(tmp_path):
    w.lerobot_v2(tmp_path / "there")
    (tmp_path / "here").symlink_to(tmp_path / "there")
    read_all(tmp_path / "here")


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
    line = refused(read_all, tmp_path / "set", "6 rows; allowed are 5 ")
    assert "MOVE_LIMITS=rows=6 raises it" in line
    monkeypatch.setenv("MOVE_LIMITS", "rows=6, pixels=1e6")
    read_all(tmp_path / "set")
    assert limits() == Limits(rows=6, pixels=1_000_000)


@pytest.mark.parametrize("given", ["rows", "rows=x", "row=5", "rows=0", "rows=inf", "=5"])
def test_a_wrong_limit_is_refused(monkeypatch, given):
    monkeypatch.setenv("MOVE_LIMITS", given)
    with pytest.raises(BadInput, match="MOVE_LIMITS"):
        within("rows", 1, "here")


def test_all_episodes_together_stay_within_the_memory(tmp_path, monkeypatch):
    w.lerobot_v2(tmp_path / "set", episodes=8)
    monkeypatch.setenv("MOVE_LIMITS", "memory_bytes=5000")
    refused(read_all, tmp_path / "set", "all episodes together")


def test_one_text_many_times_stays_within_the_memory(tmp_path, monkeypatch):
    hostile.imaged(tmp_path / "set", [{"bytes": bytes(200_000), "path": None}] * w.STEPS)
    monkeypatch.setenv("MOVE_LIMITS", "memory_bytes=1e6")
    refused(read_all, tmp_path / "set", "memory bytes")


def test_one_row_of_many_numbers_is_refused_by_its_footer(tmp_path, monkeypatch):
    hostile.table(tmp_path / "set", {"action": hostile.one_row_of_many(200_000)})
    monkeypatch.setenv("MOVE_LIMITS", "memory_bytes=1e6")
    refused(read_all, tmp_path / "set", "row group 0: 1,600,000 memory bytes")


REAL_BOMBS = ("hdf5 image of 40000 pixels a side", "png of 20000 pixels a side", "five million episodes",
              "video whose frames are larger than it says", "image file of a million million bytes",
              "parquet of three million rows", "zip with attributes of 17 MB")
STORED_BOMBS = ("four million columns in 29 kB", "chunk that is more than it says", "10 ** 10 rows")
CHILD = """
import json, sys, time
from pathlib import Path
from move.errors import BadInput
from test_hostile_data import read_all, train_reads
for kind, folder in json.loads(sys.argv[1]):
    started = time.monotonic()
    try:
        (read_all if kind == "real" else train_reads)(Path(folder))
    except BadInput:
        pass
    peak = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
    print(json.dumps([1024 * int(peak.split()[1]), time.monotonic() - started]))
"""


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="the peak of one process alone is told by Linux")
def test_the_worst_stay_within_memory_and_time(tmp_path):
    folders = [("real", hostile.REAL[name][1](tmp_path / f"r{n}")) for n, name in enumerate(REAL_BOMBS)]
    folders += [("stored", hostile.STORED[name][1](tmp_path / f"s{n}")) for n, name in enumerate(STORED_BOMBS)]
    folders.append(("real", hostile.act(tmp_path / "dag", hostile.dag)))
    root = Path(__file__).parent
    done = subprocess.run([sys.executable, "-c", CHILD, json.dumps([(kind, str(path)) for kind, path in folders])],
                          capture_output=True, text=True, timeout=300, check=True,
                          env=os.environ | {"PYTHONPATH": f"{root.parent}:{root}", "OMP_NUM_THREADS": "1"})
    rows = [json.loads(line) for line in done.stdout.splitlines()]
    assert len(rows) == len(folders)
    assert max(peak for peak, _ in rows) < MOST_BYTES and max(seconds for _, seconds in rows) < MOST_SECONDS
