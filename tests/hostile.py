"""Hostile data sets, each a small folder that asks for something it must not get.

`REAL[name]` and `STORED[name]` are (what the refusal says, a function that writes into a folder and returns what is to
be opened): by `open_dataset`, and by `move train`'s reader.
"""

import os
import shutil
import struct
import zlib
from collections.abc import Callable
from pathlib import Path

import av
import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import real_writers as w
import zarr
from numcodecs import Blosc, Zstd

Write = Callable[[Path], Path]
SECRET = "root:x:0:0"
INFO, EPISODES = "meta/info.json", "meta/episodes.jsonl"
TABLE = "data/chunk-000/episode_000000.parquet"
VIDEO = "videos/chunk-000/observation.images.wrist/episode_000000.mp4"
SYNC = "episode0/arm/jointState/puppet/sync.txt"


# how they are made ----------------------------------------------------------------------------------------------------

def v2(folder: Path) -> Path:
    """One LeRobot v2.1 episode with a video."""
    return w.lerobot_v2(folder, codec="libx264", episodes=1)


def changed(write: Write, change: Callable[[Path], object]) -> Write:
    """A data set in which something is changed."""
    def make(folder: Path) -> Path:
        written = write(folder)
        change(written)
        return written

    return make


def linked(write: Write, part: str) -> Write:
    """A part of it lies elsewhere, and is a link."""
    def move(folder: Path) -> None:
        shutil.move(folder / part, folder.parent / "elsewhere")
        (folder / part).symlink_to(folder.parent / "elsewhere")

    return changed(write, move)


def piped(write: Write, part: str) -> Write:
    """A file of it is a pipe, which would be waited for."""
    def make(folder: Path) -> None:
        (folder / part).unlink()
        os.mkfifo(folder / part)

    return changed(write, make)


def text(part: str, content: str, write: Write = v2) -> Write:
    """A file of it holds something else."""
    return changed(write, lambda folder: (folder / part).write_text(content))


def many_parts(folder: Path) -> Path:
    for number in range(201):
        (folder / f"{number}/meta").mkdir(parents=True)
        (folder / f"{number}/{INFO}").write_text("{}")
    return folder


def info(**change: object) -> Write:
    """info.json says something else."""
    return changed(v2, lambda folder: w.change_json(folder / INFO, **change))


def table(columns: dict) -> Write:
    """The table of the one episode is another."""
    return changed(v2, lambda folder: pq.write_table(pa.table(columns), folder / TABLE))


def images(given: list[dict]) -> Write:
    """The images in the table are these."""
    kind = pa.struct([("bytes", pa.binary()), ("path", pa.string())])

    def change(folder: Path) -> None:
        old = pq.read_table(folder / TABLE).drop_columns("observation.images.front")
        pq.write_table(old.append_column("observation.images.front", pa.array(given, kind)), folder / TABLE)

    return changed(lambda folder: w.lerobot_v2(folder, episodes=1, image_column=True), change)


def act(change: Callable[[h5py.File], object]) -> Write:
    """An ACT episode, changed."""
    def make(folder: Path) -> None:
        with h5py.File(folder / "episode_0.hdf5", "a") as file:
            change(file)

    return changed(w.act_hdf5, make)


def replaced(name: str, **how: object) -> Write:
    """A data set of an ACT episode is made anew."""
    def change(file: h5py.File) -> None:
        if name in file:
            del file[name]
        file.create_dataset(name, **how)

    return act(change)


def virtual(file: h5py.File) -> None:
    layout = h5py.VirtualLayout((6, 7), np.float64)
    layout[:] = h5py.VirtualSource("/etc/passwd", "x", (6, 7))
    del file["action"]
    file.create_virtual_dataset("action", layout)


def soft_through_external(file: h5py.File) -> None:
    file["zz"] = h5py.ExternalLink("/etc/passwd", "/")
    del file["action"]
    file["action"] = h5py.SoftLink("/zz/x")


def dag(file: h5py.File) -> None:
    """Twenty-six levels of two links to the same next group: 2 ** 26 ways, 27 groups."""
    below = file.create_group("g26")
    for level in range(25, -1, -1):
        group = file.create_group(f"g{level}")
        group["a"] = group["b"] = below
        below = group


def png(side: int, rows: int) -> bytes:
    """A black PNG whose data end after some rows."""
    def piece(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0)
    data = zlib.compress(bytes((side + 1) * rows))
    return b"\x89PNG\r\n\x1a\n" + piece(b"IHDR", head) + piece(b"IDAT", data) + piece(b"IEND", b"")


def avi(folder: Path) -> None:
    with av.open(str(folder / VIDEO), "w", format="avi") as container:
        stream = container.add_stream("mpeg4", rate=10)
        stream.width = stream.height = 64
        container.mux(stream.encode(av.VideoFrame.from_ndarray(w.grey(0), format="rgb24")))
        container.mux(stream.encode())


def larger_frames(folder: Path) -> None:
    """A video of 64 pixels a side whose frames have 13,000."""
    with av.open(str(folder / VIDEO), "w", format="mov") as container:
        stream = container.add_stream("png", rate=10)
        stream.width = stream.height = 64
        stream.pix_fmt = "gray"
        for packet in stream.encode(av.VideoFrame.from_ndarray(np.zeros((64, 64), np.uint8), format="gray")):
            large = av.Packet(png(13_000, rows=13_000))
            large.pts, large.dts, large.time_base, large.stream = packet.pts, packet.dts, packet.time_base, stream
            container.mux(large)


def store(folder: Path, zarr_format: int = 2, **arrays: np.ndarray) -> Path:
    """A replay buffer of two episodes; `arrays` replace or add to what is in it."""
    folder.mkdir(parents=True)
    group = zarr.create_group(folder / "replay_buffer.zarr", zarr_format=zarr_format)
    given = {"keypoints": np.ones((6, 5), np.float32), "action": np.zeros((6, 4), np.float32), "ends": np.array([4, 6])}
    for name, values in (given | arrays).items():
        group.create_array("meta/episode_ends" if name == "ends" else f"data/{name}", data=values,
                           chunks=tuple(max(1, n) for n in values.shape), config={"write_empty_chunks": True})
    return folder / "replay_buffer.zarr"


def stored(**arrays: np.ndarray) -> Write:
    return lambda folder: store(folder, **arrays)


def described(**change: object) -> Write:
    """The description of the actions says something else."""
    return changed(store, lambda path: w.change_json(path / "data/action/.zarray", **change))


def chunk(data: bytes, **change: object) -> Write:
    """The one chunk of the actions is this."""
    return changed(described(**change), lambda path: (path / "data/action/0.0").write_bytes(data))


def gzip_3(folder: Path) -> Path:
    """Format 3, with another codec."""
    path = store(folder, zarr_format=3)
    w.change_json(path / "data/action/zarr.json", codecs=[{"name": "bytes", "configuration": {"endian": "little"}},
                                                          {"name": "gzip", "configuration": {"level": 1}}])
    return path


def columns_of_nothing(path: Path) -> None:
    """29 kB that are four million columns."""
    w.change_json(path / "data/keypoints/.zarray", shape=[60, 4_000_000], chunks=[4, 4_000_000])
    for number in range(15):
        (path / f"data/keypoints/{number}.0").write_bytes(Blosc(cname="zstd").encode(bytes(64_000_000)))


# what is refused ------------------------------------------------------------------------------------------------------

OUTSIDE = "leaves the data set"
PLAIN_FILES = {
    "a table that is a link": ("symbolic link", linked(v2, TABLE)),
    "a folder that is a link": ("symbolic link", linked(v2, "data")),
    "an info.json that is a link": ("symbolic link", linked(v2, INFO)),
    "an HDF5 file that is a link": ("symbolic link", linked(w.act_hdf5, "episode_0.hdf5")),
    "a chunk that is a link": ("symbolic link", linked(w.zarr_buffer, "replay_buffer.zarr/data/action/0.0")),
    "an image that is a link": ("symbolic link", linked(w.pika_hdf5, "episode0/camera/color/cam/0.jpg")),
    "a link to its own folder": ("symbolic link", changed(v2, lambda folder: (folder / "x").symlink_to(folder))),
    "a pipe for a table": ("a pipe", piped(v2, TABLE)), "a pipe for info.json": ("a pipe", piped(v2, INFO)),
}
NAMES = {
    "a template outside": (OUTSIDE, info(data_path="../{episode_index:06d}.parquet")),
    "an absolute template": (OUTSIDE, info(data_path="/etc/{episode_index}")),
    "a hidden template": ("hidden folder", info(data_path=".git/{episode_index}")),
    "a template of an attribute": ("path template", info(data_path="{episode_index.__class__}")),
    "a template of another field": ("uses 'secret'", info(data_path="{secret}")),
    "a template with a name as a number": ("path template", info(video_path="videos/{video_key:03d}.mp4")),
    "a very long template": ("has 5000 characters", info(data_path="a" * 5000)),
    "sync.txt outside": (OUTSIDE, text(SYNC, "../../../../../secret\n" * 6, w.pika_tree)),
    "sync.txt absolute": (OUTSIDE, text(SYNC, "/etc/passwd\n" * 6, w.pika_tree)),
    "an image of HDF5 outside": (OUTSIDE, lambda folder: w.pika_hdf5(folder, image_name="../../secret{}")),
    "an image of HDF5 on a drive": (OUTSIDE, lambda folder: w.pika_hdf5(folder, image_name="C:\\x\\{}.jpg")),
    "an image of a table outside": (OUTSIDE, images([{"bytes": None, "path": "/etc/passwd"}] * 6)),
    "too many parts": ("parts", many_parts),
}
ODD = {"an image": "<img src=x onerror=alert(1)>", "an entity": "&lt;b", "a quote": '"', "an apostrophe": "'",
       "a backtick": "`", "an escape": "\x1b[31m", "a line": "\nx", "a turn": "\u202ex", "nothing seen": "\u200bx",
       "a letter that is not seen": "\u3164x"}
MARKUP = {f"a part with {name}": ("markup", lambda folder, odd=odd: w.lerobot_v2(folder / f"static{odd}").parent)
          for name, odd in ODD.items()} | {
    "a folder with markup": ("markup", lambda folder: w.act_hdf5(folder.parent / "set<b>")),
    "a camera with markup": ("markup", replaced("observations/images/<b>", shape=(6, 4, 4, 3), dtype=np.uint8)),
    "an array with markup": ("markup", stored(**{"<i>": np.zeros((6, 2, 2, 3), np.uint8)})),
    "a robot with markup": ("markup", info(robot_type="piper<img src=x>")),
    "action names with markup": ("markup", info(features=w.info("v2.1")["features"] | {
        "action": {"dtype": "float32", "shape": [7], "names": ["<b>", *w.NAMES[1:]]}})),
}
JSON = {
    "an info.json of null": ("JSON NoneType", text(INFO, "null")), "of nothing": ("expected", text(INFO, "")),
    "of endless nesting": ("RecursionError", text(INFO, "[" * 100_000)),
    "of 17 MB": ("text bytes", text(INFO, " " * 17_000_000)),
    "with a key twice": ("given twice", text(INFO, '{"codebase_version": "v2.1", "codebase_version": "v3.0"}')),
    "features a list": ("features", info(features=["x"])), "a number for a path": ("data_path", info(data_path=5)),
    "chunks of 0": ("chunks_size", info(chunks_size=0)), "a rate of true": ("fps", info(fps=True)),
    "an endless rate": ("fps", text(INFO, '{"codebase_version": "v2.1", "features": {}, "fps": 1e999}')),
    "another version": ("codebase_version is 'v9'", info(codebase_version="v9")),
    "a text for a length": ("length is 'x'", text(EPISODES, '{"episode_index": 0, "length": "x"}')),
    "true for a number": ("whole number", text(EPISODES, '{"episode_index": true, "length": 6}')),
    "a huge length": ("rows", text(EPISODES, f'{{"episode_index": 0, "length": {10**400}}}')),
    "a huge number": ("characters", text(EPISODES, f'{{"episode_index": {10**4000}, "length": 1}}')),
    "an episode twice": ("episode 0 is listed twice", text(EPISODES, '{"episode_index": 0, "length": 6}\n' * 2)),
    "too many episodes": ("episodes", text(EPISODES, '{"episode_index": 0, "length": 1}\n' * 100_001)),
    "a reading that is a list": ("JSON list", text(SYNC.replace("sync.txt", "1.json"), "[1]", lambda folder: text(
        SYNC, "1.json\n" * 6, w.pika_tree)(folder))),
    "pixels of no size": ("metres_per_pixel", text("SIMULATED.json", '{"metres_per_pixel": "x"}')),
}
HDF5 = {
    "external storage": ("another file", replaced("x", shape=(2, 4), dtype=np.uint8, external=[("/etc/passwd", 0, 8)])),
    "virtual data": ("another file", act(virtual)),
    "an external link": ("links to another file", act(lambda file: file.__setitem__(
        "x", h5py.ExternalLink("/etc/passwd", "/x")))),
    "a soft link through an external one": ("links to another file", act(soft_through_external)),
    "ten thousand million rows": ("rows", replaced("action", shape=(10**10, 7), dtype=np.float32, chunks=(10, 7))),
}
STREAMS = {
    "HDF5 of texts": ("expected real numbers", replaced("observations/qpos", data=np.full((6, 7), b"1"))),
    "HDF5 of complex numbers": ("expected real numbers", replaced("action", data=np.ones((6, 7), complex))),
    "a table of texts": ("expected numbers", table({"observation.state": ["1", "2"], "action": [["x"], ["y"]]})),
    "a table of true and false": ("expected numbers", table({"observation.state": pa.array([[True] * 7] * 6)})),
    "time as text": ("expected numbers", changed(v2, lambda path: w.change_table(path / TABLE, timestamp=["0"] * 6))),
    "no columns": ("at least one timestep", table({"action": pa.array([[], []], pa.list_(pa.float32()))})),
    "ragged columns": ("inhomogeneous", table({"action": [[1.0], [1.0, 2.0]]})),
    "too many columns": ("columns", table({"action": [[0.0] * 10_000]})),
    "a table that is JSON": ("expected a parquet table", text(TABLE, "{}")),
    "a reading of true": ("expected numbers", text(SYNC.replace("sync.txt", "1.json"), '{"position": [true]}',
                                                   text(SYNC, "1.json\n" * 6, w.pika_tree))),
    "zarr of complex numbers": ("expected real numbers", stored(action=np.ones((6, 4), np.complex64))),
    "zarr of true and false": ("expected real numbers", stored(robot_joint=np.ones((6, 6), bool))),
    "a pose of seven columns": ("columns", stored(robot_eef_pose=np.zeros((6, 7)))),
    "a stream of no rows": ("at least one timestep", stored(timestamp=np.zeros(0))),
    "ends that are no whole numbers": ("whole numbers", stored(ends=np.array([4.5, 6]))),
    "ends that do not increase": ("must increase", stored(ends=np.array([4, 4]))),
}
PICTURES = {
    "a playlist for an image": ("expected images", images([{"bytes": b"#EXTM3U\nfile:///etc/x", "path": None}] * 6)),
    "images of two sizes": ("expected images", images([{"bytes": png(8 + n % 2, 8), "path": None} for n in range(6)])),
    "a video in another container": ("expected", changed(v2, avi)),
    "a list of files for a video": ("expected", text(VIDEO, "ffconcat version 1.0\nfile ../../../../secret\n")),
}
CODECS = {
    "pickle": ("pickle", described(filters=[{"id": "pickle"}])),
    "pickle of objects": ("pickle", described(dtype="|O", filters=[{"id": "pickle"}])),
    "texts of any length": ("StringDType", described(dtype="|O", filters=[{"id": "vlen-utf8"}])),
    "gzip": ("codecs GZip", described(compressor={"id": "gzip", "level": 1})),
    "a filter": ("codecs Delta", described(filters=[{"id": "delta", "dtype": "<f4"}])),
    "gzip in format 3": ("codecs GzipCodec", gzip_3),
    "chunks of 0": ("division by zero", described(chunks=[0, 4])),
    "a shape below 0": ("non-negative", described(shape=[-1, 4])),
    "a codec that is a text": ("compressor", described(compressor="x")),
    "ten thousand million rows": ("rows", described(shape=[10**10, 4])),
    "too many chunks": ("files", described(shape=[200_000, 4], chunks=[1, 1])),
    "a chunk that is more than it says": ("reshape", chunk(Blosc(cname="zstd").encode(bytes(10**6)))),
    "a chunk of two frames": ("reshape", chunk(Zstd().encode(bytes(96)) + Zstd().encode(bytes(10**8)),
                                               compressor={"id": "zstd", "level": 0})),
    "too many episodes": ("episodes", stored(ends=np.arange(1, 1_500_000))),
}
TRAINING = {
    "complex actions": ("complex numbers", stored(action=np.ones((6, 4), np.complex64))),
    "actions of true and false": ("true and false", stored(action=np.ones((6, 4), bool))),
    "actions without columns": ("at least one number", stored(action=np.zeros((6, 0), np.float32))),
    "nothing observed": ("at least one number", stored(keypoints=np.zeros((6, 0), np.float32))),
    "infinite actions": ("infinity", stored(action=np.full((6, 4), np.inf, np.float32))),
    "actions beyond float32": ("infinity", stored(action=np.full((6, 4), 1e300))),
    "actions that are no numbers": ("infinity", stored(action=np.full((6, 4), np.nan, np.float32))),
    "four million columns in 29 kB": ("columns", changed(store, columns_of_nothing)),
    "an array that is a link": ("symbolic link", linked(store, "data/action")),
    "a chunk that is a pipe": ("a pipe", piped(store, "data/action/0.0")),
}
REAL = PLAIN_FILES | NAMES | MARKUP | JSON | STREAMS | PICTURES
REAL |= {f"HDF5: {name}": case for name, case in HDF5.items()}
REAL |= {f"zarr: {name}": case for name, case in CODECS.items()}
STORED = CODECS | TRAINING

BOMBS = {  # what needs more memory than is allowed, wherever it says so
    "an HDF5 image of 40,000 pixels a side": replaced("observations/images/big", shape=(1, 40_000, 40_000, 3),
                                                      dtype=np.uint8, chunks=(1, 64, 64, 3)),
    "a PNG of 13,000 pixels a side": lambda folder: images([{"bytes": png(13_000, 13_000), "path": None}] * 6)(folder),
    "a video whose frames are larger than it says": changed(v2, larger_frames),
    "an image file of a million million bytes": changed(w.pika_hdf5, lambda folder: os.truncate(
        folder / "episode0/camera/color/cam/0.jpg", 10**12)),
    "a table row of 100 million numbers": changed(v2, lambda folder: pq.write_table(pa.table({
        "action": pa.ListArray.from_arrays(pa.array([0, 10**8]), pa.array(np.zeros(10**8, np.int8)))}),
        folder / TABLE, use_dictionary=False, column_encoding={"action.list.element": "DELTA_BINARY_PACKED"})),
    "a text many times": lambda folder: images([{"bytes": bytes(60_000_000), "path": None}] * 6)(folder),
    "a zarr chunk of 16 GB": described(shape=[60, 4 * 10**9], chunks=[60, 4 * 10**9]),
    "a zarr chunk of a million million bytes": changed(
        store, lambda path: os.truncate(path / "data/action/0.0", 10**12)),
}
