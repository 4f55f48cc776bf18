"""zarr replay buffer (format 2 or 3, folder or `.zarr.zip`): all episodes end to end, cut by `meta/episode_ends`.

    data/<key>           first axis: all timesteps of all episodes
    meta/episode_ends    int64, cumulative
    videos/<episode>/<camera>.mp4   beside a real robot's buffer

The authors' simulation data (img, state, full_state, action) are of this layout too: they hold no robot joints.
A buffer is fetched whole: its chunks are shared by neighbouring episodes.
"""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import closing, contextmanager
from pathlib import Path

import numpy as np
import zarr

from move.errors import BadInput
from move.realworld.episode import EpisodeRef, Part, Recording, make_recording
from move.realworld.frames import Frames, from_video
from move.realworld.untrusted_names import inside
from move.untrusted import reading

JOINTS, POSE = ("robot_joint", "joint", "joints", "qpos"), ("robot_eef_pose", "eef_pose", "end_pose")
GRIPPER, TIME = ("robot_gripper", "gripper", "gripper_width"), ("timestamp", "timestamps")
STATE, SIMULATION = ("state", "keypoints"), {"full_state", "state"}
_METADATA = (".zarray", ".zgroup", ".zattrs", ".zmetadata", "zarr.json")


def metadata(files: Sequence[str]) -> list[str]:
    """The small description files and the episode ends; a zip has them inside, so it is needed itself."""
    return [file for file in files if file.endswith((*_METADATA, ".zarr.zip")) or "meta/episode_ends/" in file]


def episodes(part: Part) -> list[EpisodeRef]:
    """One episode an entry of `meta/episode_ends`; all of them need the whole buffer."""
    with _opened(part) as group:
        ends = np.asarray(group["meta/episode_ends"][:], dtype=np.int64)
    starts = np.concatenate([[0], ends[:-1]])
    if (ends <= starts).any():
        raise BadInput(f"{part.root}: meta/episode_ends must increase; found {ends[:6].tolist()}")
    return [
        EpisodeRef(n, part.files, int(end - start), {"rows": (int(start), int(end))})
        for n, (start, end) in enumerate(zip(starts, ends, strict=True))
    ]


@contextmanager
def _opened(part: Part) -> Iterator[zarr.Group]:
    """Open the buffer for reading; every surprise inside becomes one line."""
    zipped = part.files[0].endswith(".zarr.zip")
    path = inside(part.root, part.files[0]) if zipped else part.root
    with reading(path, "a zarr replay buffer with meta/episode_ends and data/"):
        _refuse_pickle(path, part.files)
        if zipped:
            with closing(zarr.storage.ZipStore(path, mode="r")) as store:
                yield zarr.open_group(store, mode="r")
        else:
            yield zarr.open_group(str(path), mode="r")


def _descriptions(path: Path, files: Sequence[str]) -> Iterable[str]:
    """The text of every description file of a buffer, a zip or a folder of the given files."""
    if path.is_file():
        with zipfile.ZipFile(path) as archive:
            yield from (archive.read(n).decode("utf-8", "replace") for n in archive.namelist() if n.endswith(_METADATA))
    else:
        yield from (inside(path, file).read_text(encoding="utf-8", errors="replace")
                    for file in files
                    if file.endswith(_METADATA))


def _refuse_pickle(path: Path, files: Sequence[str]) -> None:
    """Refuse a buffer that asks for the pickle codec: reading it would run whatever it holds."""
    if any(re.search(r'"(id|name)"\s*:\s*"[^"]*pickle', text) for text in _descriptions(path, files)):
        raise BadInput(f"{path} uses the pickle codec, which runs code when read; only plain arrays are read")


def read(part: Part, ref: EpisodeRef) -> Recording:
    """Read the rows of one episode; images only when asked for."""
    with _opened(part) as group:
        data = group["data"]
        start, end = ref.place["rows"]

        def rows(names: Sequence[str]) -> np.ndarray | None:
            key = next((name for name in names if name in data), None)
            return None if key is None else np.asarray(data[key][start:end])

        gripper = rows(GRIPPER)
        streams = {
            "joints": rows(JOINTS), "end_effector": rows(POSE), "action": rows(("action",)),
            "gripper": None if gripper is None else gripper.reshape(len(gripper), -1)[:, 0], "timestamps_s": rows(TIME),
            "state": rows(STATE),
        }
        images = {key: _frames(part, key, start, end) for key, array in data.arrays() if array.ndim == 4}
        simulated = set(data.array_keys()) >= SIMULATION
        notes = ["simulation data: the state is not a robot's joints, and is kept as stored"] if simulated else []
    return make_recording(part, ref, streams, fps=30.0, source=part.root, cameras=images | _videos(part, ref),
                          notes=notes)


def _frames(part: Part, key: str, start: int, end: int) -> Frames:
    def load(numbers: Sequence[int]) -> Iterable[np.ndarray]:
        with _opened(part) as group:
            for number in numbers:
                yield np.asarray(group["data"][key][start + number])

    return Frames(f"{part.root}:data/{key}", lambda: end - start, load)


def _videos(part: Part, ref: EpisodeRef) -> dict[str, Frames]:
    """Videos of this episode beside the buffer."""
    folder = part.root.parent / "videos" / str(ref.index)
    return {path.stem: from_video(path) for path in sorted(folder.glob("*.mp4"))} if folder.is_dir() else {}
