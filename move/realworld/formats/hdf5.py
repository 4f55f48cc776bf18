"""HDF5, one file an episode. Which of three dialects a file speaks is told by the groups inside it.

Pika (AgileX data_tools)   arm/ gripper/ localization/ camera/color/<camera>
ACT / ALOHA                observations/qpos, action, observations/images/<camera>
RoboMIND                   puppet/joint_position, master/..., observations/rgb_images/<camera>
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path, PurePosixPath

import h5py
import numpy as np

from move.errors import BadInput
from move.realworld.episode import EpisodeRef, Part, Recording, make_recording
from move.realworld.frames import Frames, from_files, from_hdf5
from move.realworld.state_columns import busiest, split_columns
from move.realworld.untrusted_names import inside
from move.untrusted import reading, within

SUFFIXES = (".hdf5", ".h5")
ROBOMIND_HZ = 10.0  # no timestamps in the file; the rate its own tools assume
ACT_HZ = 30.0  # no timestamps in the file; AgileX's cameras run at 30 Hz
PIKA_ARMS, PIKA_GRIPPERS = ("puppet", "master"), ("pikaGripper", "pika", "pikaSensor")


def metadata(files: Sequence[str]) -> list[str]:
    """None: an HDF5 file is read whole or not at all."""
    return []


def episodes(part: Part) -> list[EpisodeRef]:
    """One episode a file, in natural order; images that lie in the file's own folder belong to it."""
    found = sorted((file for file in part.files if file.endswith(SUFFIXES)), key=natural)
    return [EpisodeRef(index, (file, *_beside(part, file))) for index, file in enumerate(found)]


def natural(name: str) -> list:
    """Sort key that puts `episode2` before `episode10`."""
    return [int(piece) if piece.isdigit() else piece for piece in re.split(r"(\d+)", name)]


def _beside(part: Part, file: str) -> list[str]:
    folder = PurePosixPath(file).parent
    if not re.fullmatch(r"episode_?\d+", folder.name):
        return []
    return [other for other in part.files if other.startswith(f"{folder}/camera/color/")]


def read(part: Part, ref: EpisodeRef) -> Recording:
    """Read one episode in whichever dialect it speaks.

    Raises:
        BadInput: the groups of no known dialect; the message lists those found and those expected.
    """
    path = inside(part.root, ref.files[0])
    with reading(path, "an HDF5 file of one episode"), h5py.File(path, "r") as file:
        _judge(file)
        if "puppet" in file:
            return _robomind(part, ref, file, path)
        if "observations/qpos" in file:
            return _act(part, ref, file, path)
        if any(group in file for group in ("arm", "localization", "gripper")):
            return _pika(part, ref, file, path)
        raise BadInput(f"cannot read {path}: found groups {sorted(file)[:8]}; expected arm/, gripper/ or localization/ "
                       "(Pika), observations/qpos (ACT) or puppet/ (RoboMIND)")


def _judge(root: h5py.File) -> None:
    """Look at every group and data set once, by its address in the file, before anything is read.

    Refused are links to other files, data kept in other files (external storage and virtual data sets: both could name
    any file of this machine), and sizes beyond the limits. Soft links stay inside the file: what they lead to is
    looked at where it is.
    """
    where, seen, waiting = root.filename, set(), [(root["/"], 0)]
    while waiting:
        group, depth = waiting.pop()
        within("depth", depth, f"{where}: groups inside groups")
        for name in group:
            link = group.get(name, getlink=True)
            if isinstance(link, h5py.ExternalLink):
                raise BadInput(f"{where}: {group.name}/{name} links to another file; only plain data are read")
            if isinstance(link, h5py.SoftLink):
                continue
            member = group[name]
            address = h5py.h5o.get_info(member.id).addr
            if address not in seen:
                seen.add(address)
                within("files", len(seen), f"{where}: groups and data sets")
                if isinstance(member, h5py.Group):
                    waiting.append((member, depth + 1))
                elif isinstance(member, h5py.Dataset):
                    _judge_data(member, f"{where}:{member.name}")


def _judge_data(data: h5py.Dataset, where: str) -> None:
    """Refuse data of other files, and more in one row or chunk than is read at a time."""
    if data.external or data.is_virtual:
        raise BadInput(f"{where} keeps its numbers in another file; only plain data are read")
    if data.dtype.kind == "c":
        raise BadInput(f"{where} holds complex numbers, whose imaginary part would be lost; allowed: real numbers")
    within("chunk_bytes", math.prod(data.chunks or ()) * data.dtype.itemsize, f"{where}: its chunks")
    if data.ndim > 2:
        within("pixels", math.prod(data.shape[1:]) // 3, f"{where}: one image")
    if data.shape:
        within("rows", data.shape[0], where)
        within("image_bytes", math.prod(data.shape[1:]) * data.dtype.itemsize, f"{where}: one row")
    if data.dtype.kind == "O":  # values of any length, each at most as long as the file
        within("memory_bytes", Path(data.file.filename).stat().st_size, f"{data.file.filename}, with {data.name}")


def _values(data: h5py.Dataset) -> np.ndarray:
    """All numbers of a data set.

    Raises:
        BadInput: no numbers, or too many.
    """
    where = f"{data.file.filename}:{data.name}"
    if not isinstance(data, h5py.Dataset) or data.dtype.kind not in "biuf":
        raise BadInput(f"{where}: found {getattr(data, 'dtype', 'a group')}; expected numbers")
    within("memory_bytes", data.size * max(data.dtype.itemsize, 8), where)
    return data[()]


def _first(group: h5py.Group, folder: str, order: Sequence[str]) -> np.ndarray | None:
    """The data of the preferred member of a folder, else of the first; None where there is none or it is empty."""
    members = group.get(folder, {})
    names = [name for name in order if name in members] or sorted(members)
    return _values(members[names[0]]) if names and members[names[0]].size else None


def _pika(part: Part, ref: EpisodeRef, file: h5py.File, path) -> Recording:
    position = _first(file, "arm/jointStatePosition", PIKA_ARMS)
    pose = _first(file, "arm/endPose", PIKA_ARMS)
    notes = []
    if pose is None and (pose := _first(file, "localization/pose", ("pika",))) is not None:
        notes.append("end effector is the Pika's own localisation: its frame is the tracker's, not the arm's base")
    hint: str | None = "m"
    gripper = _first(file, "gripper/encoderDistance", PIKA_GRIPPERS)
    if gripper is None:
        gripper, hint = _first(file, "gripper/encoderAngle", PIKA_GRIPPERS), "pika_rad"
    if gripper is None and position is not None and position.shape[1] > 6:
        gripper, hint = position[:, 6], None
    if any(data.dtype == np.uint8 and data.ndim == 4 for data in file.get("camera/depth", {}).values()):
        notes.append("depth is 8-bit, its metres are lost: not read")
    streams = {
        "joints": None if position is None else position[:, :6], "end_effector": None if pose is None else pose[:, :6],
        "gripper": gripper, "action": _first(file, "arm/jointStatePosition",
                                             ("master",)) if "arm/jointStatePosition/master" in file else None,
        "timestamps_s": _values(file["timestamp"]) if "timestamp" in file else None,
    }
    cameras: dict[str, Frames] = {}
    for name, data in file.get("camera/color", {}).items():
        frames = _pika_camera(path, data)
        cameras |= {name: frames} if frames else {}
        notes += [] if frames else [f"camera {name}: the file names images that are not beside it"]
    return make_recording(part, ref, streams, fps=30.0, source=path, cameras=cameras, notes=notes,
                          hints={"gripper": hint} if gripper is not None and hint else {})


def _pika_camera(path, data: h5py.Dataset) -> Frames | None:
    """Frames of one camera: pixels (blue first), or paths relative to the episode's folder."""
    if data.ndim > 1:
        return from_hdf5(path, data.name, bgr=True)
    if data.dtype.kind not in "OS" or data.ndim != 1:
        raise BadInput(f"{path}:{data.name}: found {data.dtype} {data.shape}; expected names of images")
    within("files", len(data), f"{path}:{data.name}")
    within("columns", data.dtype.itemsize, f"{path}:{data.name}: letters of a name")
    files = [inside(path.parent, name.decode() if isinstance(name, bytes) else str(name)) for name in data]
    return from_files(files) if files and all(file.is_file() for file in files) else None


def _act(part: Part, ref: EpisodeRef, file: h5py.File, path) -> Recording:
    state = _values(file["observations/qpos"])
    arms, note = split_columns([], state.shape[1])
    notes = [note] if note else []
    streams = {"action": _values(file["action"]) if "action" in file else None}
    if arms:
        columns, choice = busiest(arms, state)
        notes += [choice] if choice else []
        streams["joints"] = state[:, columns.joints]
        streams["gripper"] = None if columns.gripper is None else state[:, columns.gripper]
    for key in ("timestamp", "timestamps", "observations/timestamp"):
        streams |= {"timestamps_s": _values(file[key])} if key in file else {}
    cameras = {name: from_hdf5(path, data.name) for name, data in file.get("observations/images", {}).items()}
    notes += ["order of the colour channels is not recorded: red first assumed"] if cameras else []
    return make_recording(part, ref, streams, fps=ACT_HZ, source=path, cameras=cameras, notes=notes)


def _robomind(part: Part, ref: EpisodeRef, file: h5py.File, path) -> Recording:
    side, note = _busy_side(file["puppet"])
    position = _member(file, f"puppet/joint_position{side}")
    pose = _member(file, f"puppet/end_effector{side}")
    joints, gripper = position, None
    if position is not None and position.shape[1] >= 7:
        joints, gripper = position[:, :-1], position[:, -1]
    streams = {
        "joints": joints, "gripper": gripper,
        "end_effector": None if pose is None else pose[:, :6], "action": _member(file, f"master/joint_position{side}"),
    }
    cameras = {name: from_hdf5(path, data.name) for name, data in file.get("observations/rgb_images", {}).items()}
    notes = ([note] if note else []) + ([] if gripper is None else ["last joint taken as the gripper"])
    return make_recording(part, ref, streams, fps=ROBOMIND_HZ, source=path, cameras=cameras, notes=notes)


def _member(file: h5py.File, key: str) -> np.ndarray | None:
    return _values(file[key]) if key in file else None


def _busy_side(puppet: Mapping) -> tuple[str, str | None]:
    """The suffix of the arm that moves most: "", "_left" or "_right"."""
    sides = [name.removeprefix("joint_position") for name in puppet if name.startswith("joint_position")]
    if not sides:
        return "", None
    side = max(sides, key=lambda s: float(np.abs(np.diff(_values(puppet[f"joint_position{s}"]), axis=0)).sum()))
    return side, f"{len(sides)} arms recorded: the {side.strip('_')} one moves most and is read" if side else None
