"""zarr replay buffer (format 2 or 3, folder or `.zarr.zip`): all episodes end to end, cut by `meta/episode_ends`.

    data/<key>           first axis: all timesteps of all episodes
    meta/episode_ends    int64, cumulative
    videos/<episode>/<camera>.mp4   next to a real robot's buffer

The authors' simulation data (img, state, full_state, action) are of this layout too: they hold no robot joints.
A buffer is fetched whole: its chunks are shared by neighbouring episodes.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from move.errors import BadInput
from move.realworld.episode import EpisodeRef, Part, Recording, make_recording
from move.realworld.frames import Frames, from_video
from move.realworld.untrusted_names import inside
from move.untrusted import reading, within
from move.untrusted_zarr import array_names, missing_chunks, opened_group, plain_array

STREAMS = {  # stream -> names that it goes by
    "joints": ("robot_joint", "joint", "joints", "qpos"), "end_effector": ("robot_eef_pose", "eef_pose", "end_pose"),
    "action": ("action",), "gripper": ("robot_gripper", "gripper", "gripper_width"),
    "timestamps": ("timestamp", "timestamps"), "state": ("state", "keypoints"),
}
SIMULATION = {"full_state", "state"}
EXPECTED = "a zarr replay buffer with meta/episode_ends and data/"
_METADATA = (".zarray", ".zgroup", ".zattrs", ".zmetadata", "zarr.json")


def metadata(files: Sequence[str]) -> list[str]:
    """The small description files and the episode ends; a zip has them inside, so it is needed itself."""
    return [file for file in files if file.endswith((*_METADATA, ".zarr.zip")) or "meta/episode_ends/" in file]


def episodes(part: Part) -> list[EpisodeRef]:
    """One episode an entry of `meta/episode_ends`; all of them need the whole buffer."""
    path = _store(part)
    with reading(path, EXPECTED), opened_group(path) as group:
        stored = plain_array(group, "meta/episode_ends")
        within("episodes", stored.shape[0], path)
        ends = np.asarray(stored[:])
        if ends.ndim != 1 or ends.dtype.kind not in "iu":
            raise BadInput(f"{path}: meta/episode_ends is {ends.dtype} {ends.shape}; expected whole numbers")
        arrays = {name: plain_array(group, name) for name in array_names(group)}
        place = {"arrays": {name.removeprefix("data/"): array.shape for name, array in arrays.items()
                            if name.startswith("data/")},
                 "gaps": tuple(filter(None, (missing_chunks(name, array) for name, array in arrays.items())))}
    if not len(ends):
        raise BadInput(f"{part.root}: meta/episode_ends is empty; allowed is at least one episode")
    ends = ends.astype(np.int64)
    starts = np.concatenate([[0], ends[:-1]])
    if (ends <= starts).any():
        raise BadInput(f"{part.root}: meta/episode_ends must increase; found {ends[:6].tolist()}")
    return [EpisodeRef(n, part.files, int(end - start), place | {"rows": slice(int(start), int(end))})
            for n, (start, end) in enumerate(zip(starts, ends, strict=True))]


def lacking(part: Part, refs: Sequence[EpisodeRef]) -> list[str] | None:
    """Arrays that do not end with the last episode."""
    end = refs[-1].place["rows"].stop if refs else 0
    arrays: dict[str, tuple[int, ...]] = refs[-1].place["arrays"] if refs else {}
    return [f"{part.name}: data/{name} has {shape[0]} timesteps, the episodes end at {end}"
            for name, shape in arrays.items() if shape[0] != end]


def _store(part: Part) -> Path:
    return inside(part.root, part.files[0]) if part.files[0].endswith(".zarr.zip") else part.root


def read(part: Part, ref: EpisodeRef) -> Recording:
    """Read the rows of one episode; images only when asked for."""
    path, arrays, rows = _store(part), ref.place["arrays"], ref.place["rows"]
    streams: dict[str, np.ndarray | None] = {}
    with reading(path, EXPECTED), opened_group(path) as group:
        for stream, names in STREAMS.items():
            if key := next((name for name in names if name in arrays), None):
                streams[stream] = np.asarray(plain_array(group, f"data/{key}")[rows])
    notes = []
    if "robot_eef_pose" in arrays:
        notes.append("the rotation in robot_eef_pose is taken as roll, pitch, yaw")
    joints = streams.get("joints")
    if joints is not None and joints.shape[1:] > (6,) and "gripper" not in streams:
        notes.append(f"all {joints.shape[1]} columns of the joints are taken as joints, none as a gripper")
    if (fingers := streams.get("gripper")) is not None and fingers.size:
        fingers = fingers.reshape(len(fingers), -1)
        alike = fingers.shape[1] == 1 or (
            fingers.dtype.kind in "iuf" and np.allclose(fingers, fingers[:, :1], rtol=1e-6, equal_nan=True))
        streams["gripper"] = fingers[:, 0] if alike else None
        if not alike:
            notes.append(f"a gripper of {fingers.shape[1]} columns that differ: not read")
    cameras = {key: _frames(path, key, range(shape[0])[rows]) for key, shape in arrays.items() if len(shape) == 4}
    simulated, videos = set(arrays) >= SIMULATION, _videos(part, ref)
    notes += ["simulation data: the state is not a robot's joints, and is kept as stored"] if simulated else []
    notes += ["videos begin at their episode's first timestep: assumed"] if videos else []
    return make_recording(part, ref, streams, source=part.root, cameras=cameras | videos, notes=notes,
                          gaps=ref.place["gaps"], simulated=simulated or None)


def _frames(path: Path, key: str, rows: range) -> Frames:
    """The images of an episode, which are these rows of an array."""
    def load(numbers: Sequence[int]) -> Iterable[np.ndarray]:
        with opened_group(path) as group:
            array = plain_array(group, f"data/{key}")
            for number in numbers:
                yield np.asarray(array[rows[number]])

    return Frames(f"{path}:data/{key}", lambda: len(rows), load)


def _videos(part: Part, ref: EpisodeRef) -> dict[str, Frames]:
    """Videos of this episode next to the buffer, where that is inside the data set."""
    zipped = part.files[0].endswith(".zarr.zip")
    folder = (part.root if zipped else part.root.parent) / "videos" / str(ref.index)
    known = part.name != "." and folder.is_dir()
    return {path.stem: from_video(path, start_s=None) for path in sorted(folder.glob("*.mp4"))} if known else {}
