"""Hostile data sets, each a small folder that asks for something it must not get.

`REAL[name]` and `STORED[name]` are (the word that the refusal must hold, a function that writes the folder and returns
what is to be opened): by `open_dataset`, and by `move train`'s reader.
"""

import io
import json
import os
import shutil
import socket
import struct
import zipfile
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

Attack = tuple[str, Callable[[Path], Path]]
REAL: dict[str, Attack] = {}
STORED: dict[str, Attack] = {}
SECRET = "root:x:0:0"
VIDEO = "videos/chunk-000/observation.images.wrist/episode_000000.mp4"
TABLE = "data/chunk-000/episode_000000.parquet"


def hostile(word: str, table: dict = REAL):
    """Enter a function that writes a hostile data set into a table."""
    def enter(write):
        table[write.__name__.replace("_", " ")] = (word, write)
        return write

    return enter


def secret(folder: Path) -> Path:
    """A file beside the data set that it must not get."""
    path = folder.parent / "secret"
    path.write_text(SECRET * 1000)
    return path


# what is no plain file ------------------------------------------------------------------------------------------------

def linked(name: str, word: str, write: Callable[[Path], Path], part: str) -> None:
    """A data set with one part of it moved outside and linked to."""
    def make(folder: Path) -> Path:
        write(folder)
        outside = folder.parent / "outside"
        shutil.move(folder / part, outside)
        (folder / part).symlink_to(outside)
        return folder

    REAL[name] = (word, make)


def with_video(folder: Path) -> Path:
    return w.lerobot_v2(folder, codec="libx264", episodes=1)


for part_name, writer, part in (
        ("parquet", w.lerobot_v2, TABLE), ("data folder", w.lerobot_v2, "data"),
        ("info.json", w.lerobot_v2, "meta/info.json"), ("video", with_video, VIDEO),
        ("hdf5", w.act_hdf5, "episode_0.hdf5"),
        ("zarr array", w.zarr_buffer, "replay_buffer.zarr/data/action"),
        ("zarr chunk", w.zarr_buffer, "replay_buffer.zarr/data/action/0.0"),
        ("pika sensor", w.pika_tree, "episode0/arm/jointState/puppet"),
        ("sync.txt", w.pika_tree, "episode0/arm/jointState/puppet/sync.txt"),
        ("image", w.pika_hdf5, "episode0/camera/color/cam/0.jpg"),
):
    linked(f"{part_name} that is a link", "symbolic link", writer, part)


@hostile("symbolic link")
def link_to_its_own_folder(folder):
    w.lerobot_v2(folder)
    (folder / "again").symlink_to(folder)
    return folder


@hostile("a pipe")
def pipe_for_a_parquet(folder):
    w.lerobot_v2(folder)
    (folder / TABLE).unlink()
    os.mkfifo(folder / TABLE)
    return folder


@hostile("a pipe")
def pipe_for_the_info(folder):
    w.lerobot_v2(folder)
    (folder / "meta/info.json").unlink()
    os.mkfifo(folder / "meta/info.json")
    return folder


@hostile("a socket")
def socket_for_a_video(folder):
    with_video(folder)
    (folder / VIDEO).unlink()
    here = os.getcwd()
    os.chdir((folder / VIDEO).parent)  # a socket's own path may not be long
    try:
        with socket.socket(socket.AF_UNIX) as one:
            one.bind(Path(VIDEO).name)
    finally:
        os.chdir(here)
    return folder


@hostile("folders inside folders")
def deep_folders(folder):
    w.lerobot_v2(folder)
    (folder / "/".join("d" * 50)).mkdir(parents=True)
    return folder


# HDF5 -----------------------------------------------------------------------------------------------------------------

def act(folder: Path, change: Callable[[h5py.File], object]) -> Path:
    """An ACT episode, changed."""
    w.act_hdf5(folder)
    with h5py.File(folder / "episode_0.hdf5", "a") as file:
        change(file)
    return folder


@hostile("another file")
def hdf5_external_storage(folder):
    outside = secret(folder)
    return act(folder, lambda file: file.create_dataset("observations/images/two", (2, 4, 4, 3), np.uint8,
                                                        external=[(str(outside), 0, 96)]))


@hostile("another file")
def hdf5_virtual_data(folder):
    with h5py.File(folder.parent / "other.h5", "w") as file:
        file["x"] = np.zeros((6, 7))
    layout = h5py.VirtualLayout((6, 7), np.float64)
    layout[:] = h5py.VirtualSource(str(folder.parent / "other.h5"), "x", (6, 7))

    def change(file):
        del file["action"]
        file.create_virtual_dataset("action", layout)

    return act(folder, change)


@hostile("links to another file")
def hdf5_external_link(folder):
    return act(folder, lambda file: file.__setitem__("observations/x", h5py.ExternalLink("/etc/passwd", "/x")))


@hostile("links to another file")
def hdf5_soft_link_through_an_external_link(folder):
    def change(file):
        file["zz"] = h5py.ExternalLink("/etc/passwd", "/")
        del file["action"]
        file["action"] = h5py.SoftLink("/zz/x")

    return act(folder, change)


def dag(file):
    """Twenty-six levels of two links to the same next group: 2 ** 26 ways, 27 groups."""
    below = file.create_group("g26")
    for level in range(25, -1, -1):
        group = file.create_group(f"g{level}")
        group["a"] = group["b"] = below
        below = group


@hostile("groups inside groups")
def hdf5_deep_groups(folder):
    return act(folder, lambda file: file.create_group("/".join("g" * 60)))


@hostile("pixels")
def hdf5_image_of_40000_pixels_a_side(folder):
    return act(folder, lambda file: file.create_dataset("observations/images/big", (1, 40_000, 40_000, 3), np.uint8,
                                                        chunks=(1, 64, 64, 3)))


@hostile("rows")
def hdf5_ten_thousand_million_rows(folder):
    def change(file):
        del file["action"]
        file.create_dataset("action", (10**10, 7), np.float32, chunks=(10, 7))

    return act(folder, change)


@hostile("chunk bytes")
def hdf5_huge_chunk(folder):
    return act(folder, lambda file: file.create_dataset("x", (10**5, 10**4), np.float64, chunks=(10**4, 10**4)))


@hostile("complex numbers")
def hdf5_complex_numbers(folder):
    def change(file):
        del file["action"]
        file["action"] = np.ones((6, 7), complex)

    return act(folder, change)


@hostile("expected numbers")
def hdf5_texts_for_numbers(folder):
    def change(file):
        del file["observations/qpos"]
        file["observations/qpos"] = np.array([["1.0"] * 7] * 6, dtype="S3")

    return act(folder, change)


@hostile("expected numbers")
def hdf5_group_for_numbers(folder):
    def change(file):
        del file["observations/qpos"]
        file.create_group("observations/qpos")

    return act(folder, change)


@hostile("leaves the data set")
def hdf5_names_an_image_outside(folder):
    return w.pika_hdf5(folder, image_name="../../../secret{}")


@hostile("hidden folder")
def hdf5_names_an_image_in_a_hidden_folder(folder):
    (folder / "episode0/.h").mkdir(parents=True)
    (folder / "episode0/.h/0").symlink_to("/etc/passwd")
    shutil.move(folder / "episode0/.h", folder / ".kept")
    shutil.rmtree(folder)
    return w.pika_hdf5(folder, image_name=".h/{}")


# LeRobot --------------------------------------------------------------------------------------------------------------

INFO = {
    "chunks size a text": ({"chunks_size": "abc"}, "chunks_size"), "chunks size 0": ({"chunks_size": 0}, "chunks_size"),
    "features a list": ({"features": ["x"]}, "features"), "feature a text": ({"features": {"action": "x"}}, "features"),
    "no features": ({"features": None}, "features"), "data path a number": ({"data_path": 5}, "data_path"),
    "data path a list": ({"data_path": ["x"]}, "data_path"), "fps a text": ({"fps": "fast"}, "fps"),
    "fps true": ({"fps": True}, "fps"),
    "chunks size true": ({"chunks_size": True}, "chunks_size"),
    "a robot with markup": ({"robot_type": "piper<img src=x>"}, "markup"),
    "a robot turned round": ({"robot_type": "piper\u202eabc"}, "control characters"),
    "fps below 0": ({"fps": -1}, "fps"), "video path a mapping": ({"video_path": {}}, "video_path"),
    "version a number": ({"codebase_version": 2.1}, "codebase_version"),
    "a name as a number": ({"video_path": "videos/{video_key:03d}.mp4"}, "as a number"),
    "a field of an object": ({"data_path": "{episode_index.__class__}"}, "path template"),
    "data path outside": ({"data_path": "../{episode_index:06d}.parquet"}, "leaves the data set"),
    "data path absolute": ({"data_path": "/etc/{episode_index}"}, "leaves the data set"),
    "data path hidden": ({"data_path": ".git/{episode_index}"}, "hidden folder"),
}


def informed(change: dict) -> Callable[[Path], Path]:
    """A LeRobot v2.1 data set whose info.json says something else."""
    def make(folder: Path) -> Path:
        with_video(folder)
        path = folder / "meta/info.json"
        path.write_text(json.dumps(json.loads(path.read_text()) | change))
        return folder

    return make


for info_name, (info_change, info_word) in INFO.items():
    REAL[f"info.json: {info_name}"] = (info_word, informed(info_change))

TEXTS = {
    "chunks size endless": ('{"codebase_version": "v2.1", "features": {}, "chunks_size": 1e999}', "chunks_size"),
    "fps endless": ('{"codebase_version": "v2.1", "features": {}, "fps": 1e999}', "fps"), "null": ("null", "NoneType"),
    "a number": ("5", "JSON int"), "nothing": ("", "expected"), "deep": ("[" * 100_000, "RecursionError"),
    "rather deep": ('{"features":' + "[" * 60 + "]" * 60 + "}", "values inside values"),
    "17 MB of blanks": (" " * 17_000_000, "json bytes"), "no text": ("\udcff", "expected"),
}


def worded(name: str, text: str) -> Callable[[Path], Path]:
    """A LeRobot v2.1 data set with a text in place of a file."""
    def make(folder: Path) -> Path:
        w.lerobot_v2(folder)
        (folder / name).write_bytes(text.encode(errors="surrogateescape"))
        return folder

    return make


for text_name, (text, text_word) in TEXTS.items():
    REAL[f"info.json: {text_name}"] = (text_word, worded("meta/info.json", text))
for text_name, (text, text_word) in {
        "a list": ("[1]", "JSON list"), "a text for a length": ('{"episode_index": 0, "length": "x"}', "length is 'x'"),
        "a huge length": (f'{{"episode_index": 0, "length": {10**400}}}', "rows"),
        "a huge number": (f'{{"episode_index": {10**4000}, "length": 1}}', "characters"),
        "endless": ('{"episode_index": 1e999, "length": 1}', "whole number"),
        "a part of a length": ('{"episode_index": 0, "length": 5.5}', "whole number"),
        "true for a number": ('{"episode_index": true, "length": 6}', "whole number"),
        "one twice": ('{"episode_index": 0, "length": 6}\n' * 2, "episode 0 is listed twice"),
        "a key twice": ('{"episode_index": 0, "length": 6, "length": 7}', "'length' is given twice"),
        "too many": ('{"episode_index": 0, "length": 1}\n' * 100_001, "episodes"),
}.items():
    REAL[f"episodes.jsonl: {text_name}"] = (text_word, worded("meta/episodes.jsonl", text))
for text_name, text in {"a text": '"x"', "0": "0", "endless": "1e999", "huge": str(10**400), "true": "true",
                        "null": "null"}.items():
    REAL[f"SIMULATED.json: metres_per_pixel {text_name}"] = (
        "metres_per_pixel", worded("SIMULATED.json", f'{{"simulated": true, "metres_per_pixel": {text}}}'))


@hostile("episode 1 is listed twice")
def episodes_table_with_one_twice(folder):
    w.lerobot_v3(folder)
    path = folder / "meta/episodes/chunk-000/file-000.parquet"
    rows = pq.read_table(path)
    pq.write_table(pa.concat_tables([rows, rows.slice(1, 1)]), path)
    return folder


@hostile("name 'aaaa.* has 5000 characters")
def very_long_name_in_a_template(folder):
    return informed({"data_path": "a" * 5000})(folder)


def table(folder: Path, columns: dict, **options) -> Path:
    """A LeRobot v2.1 data set of one episode with another table."""
    w.lerobot_v2(folder, episodes=1)
    pq.write_table(pa.table(columns), folder / TABLE, **options)
    return folder


def one_row_of_many(values: int) -> pa.Array:
    return pa.ListArray.from_arrays(pa.array([0, values]), pa.array(np.zeros(values, np.int8)))


@hostile("rows")
def parquet_of_three_million_rows(folder):
    return table(folder, {"action": np.zeros(3_000_000, np.int8)})


@hostile("columns")
def parquet_row_of_10000_numbers(folder):
    return table(folder, {"action": one_row_of_many(10_000)})


@hostile("expected numbers")
def parquet_texts_for_numbers(folder):
    return table(folder, {"observation.state": ["1", "2"], "action": [["x"], ["y"]]})


@hostile("expected numbers")
def parquet_of_time_as_text(folder):
    w.lerobot_v2(folder, episodes=1)
    w.change_table(folder / TABLE, timestamp=[f"0.{n}" for n in range(w.STEPS)])
    return folder


@hostile("expected numbers")
def parquet_of_true_and_false(folder):
    return table(folder, {"observation.state": pa.array([[True] * 7] * 6)})


@hostile("at least one timestep")
def parquet_without_columns_in_the_action(folder):
    return table(folder, {"action": pa.array([[], []], pa.list_(pa.float32()))})


@hostile("expected")
def parquet_that_is_json(folder):
    w.lerobot_v2(folder, episodes=1)
    (folder / TABLE).write_text("{}")
    return folder


@hostile("json bytes")
def parquet_with_a_long_footer(folder):
    w.lerobot_v2(folder, episodes=1)
    with (folder / TABLE).open("r+b") as file:
        file.truncate(10**9)
        file.seek(-8, 2)
        file.write(struct.pack("<I", 10**9 - 100) + b"PAR1")
    return folder


def imaged(folder: Path, images: list) -> Path:
    """A LeRobot v2.1 data set whose images are in its table."""
    w.lerobot_v2(folder, episodes=1, image_column=True)
    old = pq.read_table(folder / TABLE)
    kind = pa.struct([("bytes", pa.binary()), ("path", pa.string())])
    pq.write_table(old.set_column(old.column_names.index("observation.images.front"), "observation.images.front",
                                  pa.array(images, kind)), folder / TABLE)
    return folder


@hostile("leaves the data set")
def parquet_names_an_image_outside(folder):
    return imaged(folder, [{"bytes": None, "path": "/etc/passwd"}] * w.STEPS)


@hostile("expected images")
def images_of_two_sizes(folder):
    sizes = [8, 9, 8, 9, 8, 9]
    return imaged(folder, [{"bytes": png(size, size, rows=size), "path": None} for size in sizes])


@hostile("pixels")
def png_of_20000_pixels_a_side(folder):
    return imaged(folder, [{"bytes": png(20_000, 20_000, rows=3), "path": None}] * w.STEPS)


@hostile("expected images")
def playlist_for_an_image(folder):
    return imaged(folder, [{"bytes": b"#EXTM3U\n#EXTINF:1,\nfile:///etc/passwd\n", "path": None}] * w.STEPS)


@hostile("image bytes")
def image_file_of_a_million_million_bytes(folder):
    w.pika_hdf5(folder)
    os.truncate(folder / "episode0/camera/color/cam/0.jpg", 10**12)
    return folder


def png(width: int, height: int, rows: int) -> bytes:
    """A black PNG whose data end after some rows."""
    def piece(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    data = zlib.compress(bytes((width + 1) * rows))
    return b"\x89PNG\r\n\x1a\n" + piece(b"IHDR", head) + piece(b"IDAT", data) + piece(b"IEND", b"")


@hostile("expected")
def video_whose_frames_are_larger_than_it_says(folder):
    with_video(folder)
    with av.open(str(folder / VIDEO), "w", format="mov") as container:
        stream = container.add_stream("png", rate=10)
        stream.width = stream.height = 64
        stream.pix_fmt = "gray"
        for packet in stream.encode(av.VideoFrame.from_ndarray(np.zeros((64, 64), np.uint8), format="gray")):
            large = av.Packet(png(12_000, 12_000, rows=12_000))
            large.pts, large.dts, large.time_base, large.stream = packet.pts, packet.dts, packet.time_base, stream
            container.mux(large)
    return folder


@hostile("expected")
def video_in_another_container(folder):
    with_video(folder)
    with av.open(str(folder / VIDEO), "w", format="avi") as container:
        stream = container.add_stream("mpeg4", rate=10)
        stream.width = stream.height = 64
        container.mux(stream.encode(av.VideoFrame.from_ndarray(np.zeros((64, 64, 3), np.uint8), format="rgb24")))
        container.mux(stream.encode())
    return folder


@hostile("expected")
def list_of_files_for_a_video(folder):
    with_video(folder)
    (folder / VIDEO).write_text("ffconcat version 1.0\nfile ../../../../secret\n")
    return folder


@hostile("parts")
def too_many_parts(folder):
    for number in range(201):
        (folder / f"{number}/meta").mkdir(parents=True)
        (folder / f"{number}/meta/info.json").write_text("{}")
    return folder


# Pika -----------------------------------------------------------------------------------------------------------------

def synced(line: str) -> Callable[[Path], Path]:
    """A Pika raw tree whose sync.txt names something else first."""
    def make(folder: Path) -> Path:
        w.pika_tree(folder)
        path = folder / "episode0/arm/jointState/puppet/sync.txt"
        path.write_text("\n".join([line, *path.read_text().splitlines()[1:]]))
        return folder

    return make


REAL["sync.txt names a file outside"] = ("leaves the data set", synced("../../../../../secret"))
REAL["sync.txt names an absolute file"] = ("leaves the data set", synced("/etc/passwd"))
REAL["sync.txt names a missing file"] = ("expected", synced("5.json"))


def sensed(text: str) -> Callable[[Path], Path]:
    """A Pika raw tree with one reading that is something else."""
    def make(folder: Path) -> Path:
        w.pika_tree(folder)
        next(iter((folder / "episode0/arm/jointState/puppet").glob("*.json"))).write_text(text)
        return folder

    return make


REAL["a reading that is a list"] = ("JSON list", sensed("[1]"))
REAL["a reading without its value"] = ("KeyError", sensed("{}"))
REAL["a reading of true and false"] = ("expected numbers", sensed('{"position": [true, 0, 0, 0, 0, 0, 0]}'))
REAL["a reading with a key twice"] = ("given twice", sensed('{"position": [1], "position": [2]}'))
REAL["a reading of texts"] = ("expected", sensed('{"position": ["a"]}'))


# names that a reader would see ---------------------------------------------------------------------------------------

NAMES = {"an image": "static<img src=x onerror=alert(1)>", "an entity": "static&lt;b", "a quote": 'static"x',
         "an apostrophe": "static'x", "a backtick": "static`x", "an escape": "static\x1b[31m", "a line": "static\nx",
         "a turn": "static\u202ex", "nothing seen": "static\u200bx"}


def named(part: str) -> Callable[[Path], Path]:
    """A LeRobot v2.1 data set in a folder of that name."""
    def make(folder: Path) -> Path:
        w.lerobot_v2(folder / part)
        return folder

    return make


for odd_name, odd in NAMES.items():
    REAL[f"part with {odd_name}"] = ("markup", named(odd))


@hostile("markup")
def folder_with_markup(folder):
    return w.act_hdf5(folder.parent / "set<b>")


@hostile("markup")
def hdf5_camera_with_markup(folder):
    return act(folder, lambda file: file.create_dataset("observations/images/<script>", (6, 4, 4, 3), np.uint8))


@hostile("markup")
def zarr_array_with_markup(folder):
    path = store(folder)
    shutil.copytree(path / "data/action", path / "data/<i>")
    return path


@hostile("markup")
def action_names_with_markup(folder):
    features = w.info("v2.1")["features"]
    features["action"]["names"] = ["<b>", *w.NAMES[1:]]
    return informed({"features": features})(folder)


@hostile("markup")
def feature_with_markup(folder):
    w.lerobot_v2(folder)
    features = w.info("v2.1", cameras={"observation.images.<script>": "image"})["features"]
    w.change_json(folder / "meta/info.json", features=features)
    return folder


# zarr: what both readers refuse ---------------------------------------------------------------------------------------

def store(folder: Path, **arrays: np.ndarray) -> Path:
    """A replay buffer in format 2 of two episodes; `arrays` replace or add to what is in data/."""
    rng = np.random.default_rng(0)
    given = {"keypoints": rng.normal(size=(6, 5)).astype(np.float32), "action": np.zeros((6, 4), np.float32)} | arrays
    folder.mkdir(parents=True)
    group = zarr.create_group(folder / "replay_buffer.zarr", zarr_format=2)
    for name, values in given.items():
        group.create_array(f"data/{name}", data=values, chunks=tuple(max(1, n) for n in values.shape),
                           config={"write_empty_chunks": True})
    group.create_array("meta/episode_ends", data=np.array([4, 6]))
    return folder / "replay_buffer.zarr"


def described(**change: object) -> Callable[[Path], Path]:
    """A buffer whose description of the actions says something else; nothing else is written."""
    def make(folder: Path) -> Path:
        path = store(folder) / "data/action/.zarray"
        path.write_text(json.dumps(json.loads(path.read_text()) | change))
        return folder / "replay_buffer.zarr"

    return make


ZARR = {
    "chunks of 0": ({"chunks": [0, 4]}, "chunks"), "chunks a text": ({"chunks": "x"}, "chunks"),
    "shape below 0": ({"shape": [-1, 4]}, "shape"), "shape of parts": ({"shape": [6.5, 4]}, "shape"),
    "shape of other axes": ({"shape": [6]}, "shape"), "10 ** 10 rows": ({"shape": [10**10, 4]}, "rows"),
    "a huge chunk": ({"shape": [60, 4 * 10**9], "chunks": [60, 4 * 10**9]}, "chunk bytes"),
    "too many chunks": ({"shape": [200_000, 4], "chunks": [1, 1]}, "chunks"),
    "objects": ({"dtype": "|O"}, "data type"), "a structure": ({"dtype": [["a", "<f4"]]}, "data type"),
    "no data type": ({"dtype": "nonsense"}, "data type"), "texts": ({"dtype": "<U9"}, "data type"),
    "the pickle codec": ({"compressor": {"id": "pickle"}}, "codecs pickle"),
    "vlen and pickle": ({"filters": [{"id": "vlen-utf8"}], "compressor": {"id": "pickle"}}, "codecs vlen-utf8"),
    "gzip": ({"compressor": {"id": "gzip", "level": 1}}, "codecs gzip"),
    "codec a text": ({"compressor": "x"}, "codecs x"),
    "filter a number": ({"filters": 5}, "codecs 5"),
}
for zarr_name, (zarr_change, zarr_word) in ZARR.items():
    REAL[f"zarr: {zarr_name}"] = STORED[zarr_name] = (zarr_word, described(**zarr_change))


def both(word: str):
    """Enter a function into both tables."""
    def enter(write):
        return hostile(word, REAL)(hostile(word, STORED)(write))

    return enter


@both("codecs pickle")
def the_pickle_codec_in_other_letters(folder):
    path = described(filters=[{"id": "pickle"}])(folder)
    place = path / "data/action/.zarray"
    place.write_text(place.read_text().replace("pickle", "pickl\\u0065"))
    return path


@both("codecs sharding_indexed")
def format_3_with_another_codec(folder):
    w.zarr_buffer(folder, zarr_format=3)
    place = folder / "replay_buffer.zarr/data/action/zarr.json"
    about = json.loads(place.read_text())
    about["codecs"] = [{"name": "bytes"}, {"name": "sharding_indexed"}]
    place.write_text(json.dumps(about))
    return folder / "replay_buffer.zarr"


@both("of 2 and of 3")
def two_descriptions(folder):
    path = store(folder)
    (path / "zarr.json").write_text('{"zarr_format": 3, "node_type": "group"}')
    return path


@both("decodes to")
def chunk_that_is_more_than_it_says(folder):
    path = store(folder)
    (path / "data/action/0.0").write_bytes(Blosc(cname="zstd").encode(bytes(10**6)))
    return path


@both("decodes to")
def chunk_of_two_frames(folder):
    path = described(compressor={"id": "zstd", "level": 0})(folder)
    (path / "data/action/0.0").write_bytes(Zstd().encode(bytes(96)) + Zstd().encode(bytes(10**8)))
    return path


@both("bytes on disk")
def chunk_of_a_million_million_bytes(folder):
    path = store(folder)
    os.truncate(path / "data/action/0.0", 10**12)
    return path


@both("json bytes")
def attributes_of_17_MB(folder):
    path = store(folder)
    (path / ".zattrs").write_text(" " * 17_000_000)
    return path


@both("given twice")
def description_with_a_key_twice(folder):
    place = store(folder) / "data/action/.zarray"
    place.write_text(place.read_text().replace('{', '{"shape": [3, 4],', 1))
    return folder / "replay_buffer.zarr"


@both("complex numbers")
def complex_actions(folder):
    return store(folder, action=np.ones((6, 4), np.complex64))


@both("action")
def actions_without_columns(folder):
    return store(folder, action=np.zeros((6, 0), np.float32))


REAL["complex actions"] = ("expected real numbers", complex_actions)


def zipped(folder: Path, member: str, data: bytes) -> Path:
    """A zarr.zip with one member replaced."""
    path = store(folder)
    with zipfile.ZipFile(folder / "x.zarr.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted(file for file in path.rglob("*") if file.is_file()):
            name = file.relative_to(path).as_posix()
            archive.writestr(name, data if name == member else file.read_bytes())
    shutil.rmtree(path)
    return folder


@hostile("json bytes")
def zip_with_attributes_of_17_MB(folder):
    return zipped(folder, ".zattrs", b" " * 17_000_000)


@hostile("bytes on disk")
def zip_with_a_large_chunk(folder):
    return zipped(folder, "data/action/0.0", bytes(10**7))


@hostile("expected a zip file")
def zip_that_is_none(folder):
    folder.mkdir()
    (folder / "x.zarr.zip").write_bytes(b"PK" + io.BytesIO(bytes(99)).read())
    return folder


@hostile("episodes")
def five_million_episodes(folder):
    path = store(folder)
    shutil.rmtree(path / "meta/episode_ends")
    zarr.open_group(path, mode="a", zarr_format=2).create_array("meta/episode_ends", data=np.arange(1, 1_500_000))
    return path


STORED["too many episodes"] = ("episodes", five_million_episodes)


@hostile("at least one timestep")
def a_stream_of_no_rows(folder):
    return store(folder, timestamp=np.zeros((0,), np.float64))


@hostile("whole numbers")
def ends_that_are_no_whole_numbers(folder):
    path = store(folder)
    shutil.rmtree(path / "meta/episode_ends")
    zarr.open_group(path, mode="a", zarr_format=2).create_array("meta/episode_ends", data=np.array([4.5, 6]))
    return path


@hostile("expected real numbers")
def joints_of_true_and_false(folder):
    return store(folder, robot_joint=np.ones((6, 6), bool))


@hostile("columns")
def pose_of_seven_columns(folder):
    return store(folder, robot_eef_pose=np.zeros((6, 7)))


# what training refuses ------------------------------------------------------------------------------------------------

@hostile("true and false", STORED)
def bool_actions(folder):
    return store(folder, action=np.ones((6, 4), bool))


@hostile("at least one number", STORED)
def no_observation_columns(folder):
    return store(folder, keypoints=np.zeros((6, 0), np.float32))


@hostile("infinity", STORED)
def infinite_actions(folder):
    return store(folder, action=np.full((6, 4), np.inf, np.float32))


@hostile("infinity", STORED)
def actions_beyond_float32(folder):
    return store(folder, action=np.full((6, 4), 1e300))


@hostile("infinity", STORED)
def actions_that_are_no_numbers(folder):
    return store(folder, action=np.full((6, 4), np.nan, np.float32))


@hostile("columns", STORED)
def four_million_columns_in_29_kB(folder):
    path = store(folder)
    shutil.rmtree(path / "data/keypoints")
    shutil.copytree(path / "data/action", path / "data/keypoints")
    about = json.loads((path / "data/keypoints/.zarray").read_text())
    about |= {"shape": [60, 4_000_000], "chunks": [4, 4_000_000]}
    (path / "data/keypoints/.zarray").write_text(json.dumps(about))
    for number in range(15):
        (path / f"data/keypoints/{number}.0").write_bytes(Blosc(cname="zstd").encode(bytes(64_000_000)))
    return path


@hostile("symbolic link", STORED)
def array_that_is_a_link(folder):
    path = store(folder)
    shutil.move(path / "data/action", folder / "outside")
    (path / "data/action").symlink_to(folder / "outside")
    return path


@hostile("symbolic link", STORED)
def chunk_that_is_a_link(folder):
    path = store(folder)
    shutil.move(path / "data/action/0.0", folder / "outside")
    (path / "data/action/0.0").symlink_to(folder / "outside")
    return path


@hostile("a pipe", STORED)
def chunk_that_is_a_pipe(folder):
    path = store(folder)
    (path / "data/action/0.0").unlink()
    os.mkfifo(path / "data/action/0.0")
    return path
