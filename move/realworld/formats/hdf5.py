"""HDF5, one file an episode. Which of three dialects a file speaks is told by the groups inside it.

Pika (AgileX data_tools)   arm/ gripper/ localization/ camera/color/<camera>
ACT / ALOHA                observations/qpos, action, observations/images/<camera>
RoboMIND                   puppet/joint_position, master/..., observations/rgb_images/<camera>
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path, PurePosixPath

import h5py
import numpy as np

from move.errors import BadInput
from move.realworld.episode import EpisodeRef, Part, Recording, make_recording
from move.realworld.frames import Frames, from_files, from_hdf5
from move.realworld.state_columns import arm_streams
from move.realworld.untrusted_names import inside
from move.untrusted import reading, within

SUFFIXES = (".hdf5", ".h5")
ROBOMIND_HZ = 10.0  # no timestamps in the file; the rate its own tools assume
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
        gaps, flag = _judge(file), file.attrs.get("sim")
        simulated = bool(flag) if isinstance(flag, bool | np.bool_ | int | np.integer) else None
        for groups, dialect in ((("puppet",), _robomind), (("observations/qpos",), _act),
                                (("arm", "localization", "gripper"), _pika)):
            if any(group in file for group in groups):
                return replace(dialect(part, ref, file, path), gaps=gaps, simulated=simulated)
        raise BadInput(f"cannot read {path}: found groups {sorted(file)[:8]}; expected arm/, gripper/ or localization/ "
                       "(Pika), observations/qpos (ACT) or puppet/ (RoboMIND)")


def _judge(root: h5py.File) -> tuple[str, ...]:
    """Look at every group and data set once, by its address in the file, before anything is read.

    Returns:
        Data sets of which a part was never written, and would be read as zeros.

    Refused are links to other files, data kept in other files (external storage and virtual data sets: both could name
    any file of this machine), and sizes beyond the limits. Soft links stay inside the file: what they lead to is
    looked at where it is.
    """
    where, seen, waiting, gaps = root.filename, set(), [(root["/"], 0)], []
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
                    if gap := _gap(member):
                        gaps.append(gap)
    return tuple(gaps)


def _gap(data: h5py.Dataset) -> str:
    """What was never written of a data set, or nothing."""
    if data.chunks:
        chunks = math.prod(-(-length // size) for length, size in zip(data.shape, data.chunks, strict=True))
        stored = data.id.get_num_chunks()
    else:
        chunks, stored = 1, int(data.id.get_storage_size() > 0 or not data.size)
    return f"{data.name} has {stored} of its {chunks} chunks" if stored < chunks else ""


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
        "timestamps": _values(file["timestamp"]) if "timestamp" in file else None,
    }
    cameras = {name: _pika_camera(path, data) for name, data in file.get("camera/color", {}).items()}
    return make_recording(part, ref, streams, source=path, cameras=cameras, notes=notes,
                          hints={"gripper": hint} if gripper is not None and hint else {})


def _pika_camera(path, data: h5py.Dataset) -> Frames:
    """Frames of one camera: pixels (blue first), or paths relative to the episode's folder."""
    if data.ndim > 1:
        return from_hdf5(path, data.name, bgr=True)
    if data.dtype.kind not in "OS" or data.ndim != 1:
        raise BadInput(f"{path}:{data.name}: found {data.dtype} {data.shape}; expected names of images")
    within("files", len(data), f"{path}:{data.name}")
    within("columns", data.dtype.itemsize, f"{path}:{data.name}: letters of a name")
    return from_files([inside(path.parent, name.decode() if isinstance(name, bytes) else str(name)) for name in data])


def _act(part: Part, ref: EpisodeRef, file: h5py.File, path) -> Recording:
    state = _values(file["observations/qpos"])
    arm, _, notes = arm_streams(state)
    streams = {**arm, "action": _values(file["action"]) if "action" in file else None, "state": state}
    for key in ("timestamp", "timestamps", "observations/timestamp"):
        streams |= {"timestamps": _values(file[key])} if key in file else {}
    cameras = {name: from_hdf5(path, data.name) for name, data in file.get("observations/images", {}).items()}
    notes += ["order of the colour channels is not recorded: red first assumed"] if cameras else []
    return make_recording(part, ref, streams, source=path, cameras=cameras, notes=notes)


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
    return make_recording(part, ref, streams, assumed_fps=ROBOMIND_HZ, source=path, cameras=cameras, notes=notes)


def _member(file: h5py.File, key: str) -> np.ndarray | None:
    return _values(file[key]) if key in file else None


def _busy_side(puppet: Mapping) -> tuple[str, str | None]:
    """The suffix of the arm that moves most: "", "_left" or "_right"."""
    sides = [name.removeprefix("joint_position") for name in puppet if name.startswith("joint_position")]
    if not sides:
        return "", None
    side = max(sides, key=lambda s: float(np.nansum(np.abs(np.diff(_values(puppet[f"joint_position{s}"]), axis=0)))))
    return side, f"{len(sides)} arms recorded: the {side.strip('_')} one moves most and is read" if side else None
