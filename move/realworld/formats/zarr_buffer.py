"""zarr replay buffer (format 2 or 3, folder or `.zarr.zip`): all episodes end to end, cut by `meta/episode_ends`.

    data/<key>           first axis: all timesteps of all episodes
    meta/episode_ends    int64, cumulative
    videos/<episode>/<camera>.mp4   beside a real robot's buffer

The authors' simulation data (img, state, full_state, action) are of this layout too: they hold no robot joints.
A buffer is fetched whole: its chunks are shared by neighbouring episodes.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
import zarr

from move.errors import BadInput
from move.realworld.episode import EpisodeRef, Part, Recording, make_recording
from move.realworld.frames import Frames, from_video
from move.realworld.untrusted_names import inside
from move.untrusted import reading, within
from move.untrusted_zarr import PlainArray, PlainGroup, judge

JOINTS, POSE = ("robot_joint", "joint", "joints", "qpos"), ("robot_eef_pose", "eef_pose", "end_pose")
GRIPPER, TIME = ("robot_gripper", "gripper", "gripper_width"), ("timestamp", "timestamps")
STATE, SIMULATION = ("state", "keypoints"), {"full_state", "state"}
EXPECTED = "a zarr replay buffer with meta/episode_ends and data/"
_METADATA = (".zarray", ".zgroup", ".zattrs", ".zmetadata", "zarr.json")


def metadata(files: Sequence[str]) -> list[str]:
    """The small description files and the episode ends; a zip has them inside, so it is needed itself."""
    return [file for file in files if file.endswith((*_METADATA, ".zarr.zip")) or "meta/episode_ends/" in file]


def episodes(part: Part) -> list[EpisodeRef]:
    """One episode an entry of `meta/episode_ends`; all of them need the whole buffer, which is judged here, once."""
    zipped = part.files[0].endswith(".zarr.zip")
    path = inside(part.root, part.files[0]) if zipped else part.root
    with reading(path, EXPECTED):
        buffer = judge(path)
        ends_name = "meta/episode_ends"
        within("episodes", _array(buffer, ends_name).shape[0], f"{path}: {ends_name}")
        with buffer.opened() as group:
            ends = np.asarray(_stored(group, ends_name)[:])
            gaps = tuple(filter(None, (_gap(name, _stored(group, name)) for name in sorted(buffer.arrays))))
        if ends.ndim != 1 or ends.dtype.kind not in "iu":
            raise BadInput(f"{path}: {ends_name} is {ends.dtype} {ends.shape}; expected whole numbers (episodes,)")
        ends = ends.astype(np.int64)
    starts = np.concatenate([[0], ends[:-1]])
    if (ends <= starts).any():
        raise BadInput(f"{part.root}: meta/episode_ends must increase; found {ends[:6].tolist()}")
    return [
        EpisodeRef(n, part.files, int(end - start), {"rows": (int(start), int(end)), "buffer": buffer, "gaps": gaps})
        for n, (start, end) in enumerate(zip(starts, ends, strict=True))
    ]


def _array(buffer: PlainGroup, name: str) -> PlainArray:
    if name not in buffer.arrays:
        raise BadInput(f"{buffer.path}: {name} is missing; found {sorted(buffer.arrays)[:8]}")
    return buffer.arrays[name]


def _stored(group: zarr.Group, name: str) -> zarr.Array:
    """An array that was judged before."""
    array = group[name]
    assert isinstance(array, zarr.Array)
    return array


def _gap(name: str, array: zarr.Array) -> str:
    """The chunks that an array lacks, which are read as zeros, or nothing."""
    stored, chunks = array.nchunks_initialized, array.nchunks
    return f"{name} has {stored} of its {chunks} chunks" if stored < chunks else ""


def read(part: Part, ref: EpisodeRef) -> Recording:
    """Read the rows of one episode; images only when asked for."""
    buffer: PlainGroup = ref.place["buffer"]
    start, end = ref.place["rows"]
    names = {name.removeprefix("data/"): about for name, about in buffer.arrays.items() if name.startswith("data/")}
    with reading(buffer.path, EXPECTED), buffer.opened() as group:

        def rows(choices: Sequence[str]) -> np.ndarray | None:
            key = next((name for name in choices if name in names), None)
            if key is None:
                return None
            within("memory_bytes", (end - start) * names[key].row_bytes, f"{buffer.path}: data/{key}")
            return np.asarray(_stored(group, f"data/{key}")[start:end])

        gripper = rows(GRIPPER)
        streams = {
            "joints": rows(JOINTS), "end_effector": rows(POSE), "action": rows(("action",)),
            "gripper": None if gripper is None else gripper.reshape(len(gripper), -1)[:, 0], "timestamps": rows(TIME),
            "state": rows(STATE),
        }
    images = {key: _frames(buffer, key, start, end) for key, about in names.items() if len(about.shape) == 4}
    simulated = set(names) >= SIMULATION
    notes = ["simulation data: the state is not a robot's joints, and is kept as stored"] if simulated else []
    videos = _videos(part, ref)
    notes += ["videos begin at their episode's first timestep: assumed"] if videos else []
    return make_recording(part, ref, streams, source=part.root, cameras=images | videos, notes=notes,
                          gaps=ref.place["gaps"], simulated=simulated or None)


def _frames(buffer: PlainGroup, key: str, start: int, end: int) -> Frames:
    def load(numbers: Sequence[int]) -> Iterable[np.ndarray]:
        with buffer.opened() as group:
            for number in numbers:
                yield np.asarray(_stored(group, f"data/{key}")[start + number])

    stored = max(0, min(end, buffer.arrays[f"data/{key}"].shape[0]) - start)
    return Frames(f"{buffer.path}:data/{key}", lambda: stored, load)


def _videos(part: Part, ref: EpisodeRef) -> dict[str, Frames]:
    """Videos of this episode beside the buffer, where that is inside the data set."""
    zipped = part.files[0].endswith(".zarr.zip")
    folder = (part.root if zipped else part.root.parent) / "videos" / str(ref.index)
    known = part.name != "." and folder.is_dir()
    return {path.stem: from_video(path, start_s=None) for path in sorted(folder.glob("*.mp4"))} if known else {}
