"""HDF5, one file an episode. Which of three dialects a file speaks follows from the groups inside it.

Pika (AgileX data_tools)   arm/ gripper/ localization/ camera/color/<camera>
ACT / ALOHA                observations/qpos, action, observations/images/<camera>
RoboMIND                   puppet/joint_position, master/..., observations/rgb_images/<camera>
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
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
PIKA_POSE = "end effector is the Pika's own localisation: its frame is the tracker's, not the arm's base"


def metadata(files: Sequence[str]) -> list[str]:
    """None: the names of files and folders list the episodes."""
    return []


def episodes(part: Part) -> list[EpisodeRef]:
    """One episode a file, by its number; images that lie in the file's own folder belong to it."""
    refs = []
    files = sorted((file for file in part.files if file.endswith(SUFFIXES)), key=natural)
    for index, file in zip(numbers_of(files), files, strict=True):
        folder = PurePosixPath(file).parent
        own = re.fullmatch(r"episode_?\d+", folder.name)
        images = [other for other in part.files if own and other.startswith(f"{folder}/camera/color/")]
        refs.append(EpisodeRef(index, (file, *images)))
    return refs


def natural(name: str) -> list:
    """Sort key that puts `episode2` before `episode10`."""
    return [int(piece) if piece.isdigit() else piece for piece in re.split(r"(\d+)", name)]


def numbers_of(names: Sequence[str]) -> list[int]:
    """The numbers of names that say `episode` and a number of their own each, else 0, 1, ...

    >>> numbers_of(["episode0/data.hdf5", "episode2/data.hdf5"]), numbers_of(["b3.hdf5", "c7.hdf5"])
    ([0, 2], [0, 1])
    """
    found = [re.findall(r"episode_?(\d{1,6})", name) for name in names]
    numbers = [int(each[-1]) for each in found if each]
    return numbers if len(set(numbers)) == len(names) else list(range(len(names)))


def lacking(part: Part, refs: Sequence[EpisodeRef]) -> list[str] | None:
    """Numbers between those of the first and the last episode that no file has."""
    numbers = {ref.index for ref in refs}
    absent = sorted(set(range(min(numbers, default=0), max(numbers, default=0))) - numbers)
    return [f"{part.name}: no episode {number}" for number in absent] or None


def read(part: Part, ref: EpisodeRef) -> Recording:
    """Read one episode in whichever dialect it speaks.

    Raises:
        BadInput: the groups of no known dialect; the message lists those found and those expected.
    """
    path = inside(part.root, ref.files[0])
    with reading(path, "an HDF5 file of one episode"), h5py.File(path, "r") as file:
        gaps, flag = _judge(file), file.attrs.get("sim")
        if "puppet" in file:
            recording = _robomind(part, ref, file, path)
        elif "observations/qpos" in file:
            recording = _act(part, ref, file, path)
        elif {"arm", "localization", "gripper"} & set(file):
            recording = _pika(part, ref, file, path)
        else:
            raise BadInput(f"cannot read {path}: found groups {sorted(file)[:8]}; expected arm/, gripper/ or "
                           "localization/ (Pika), observations/qpos (ACT) or puppet/ (RoboMIND)")
    simulated = bool(np.any(flag)) if np.asarray(flag).dtype.kind in "biu" and np.size(flag) else None
    return replace(recording, gaps=gaps, simulated=simulated)


def _judge(file: h5py.File) -> tuple[str, ...]:
    """Look at every link of a file once, before anything is read.

    Returns:
        Data sets of which a part was never written, and would be read as zeros.

    Refused are links to other files, and data kept in other files (external storage and virtual data sets): all three
    could name any file of this machine. Soft links stay inside the file: what they lead to is looked at where it is.
    """
    names: list[str] = []

    def look(name: str, link: object) -> str | None:
        if isinstance(link, h5py.ExternalLink):
            return f"{name} links to another file"
        if not isinstance(link, h5py.HardLink) or not isinstance(data := file[name], h5py.Dataset):
            return None
        names.append(name)
        return f"{name} keeps its numbers in another file" if data.external or data.is_virtual else None

    if problem := file.visititems_links(look):
        raise BadInput(f"{file.filename}: {problem}; only plain data are read")
    for name in names:
        within("rows", file[name].shape[0] if file[name].shape else 0, f"{file.filename}: {name}")
    return tuple(gap for name in names if (gap := _gap(file[name])))


def _gap(data: h5py.Dataset) -> str:
    """What was never written of a data set, or nothing."""
    if data.chunks:
        chunks = math.prod(-(-length // size) for length, size in zip(data.shape, data.chunks, strict=True))
        stored = data.id.get_num_chunks()
    else:
        chunks, stored = 1, int(data.id.get_storage_size() > 0 or not data.size)
    return f"{data.name} has {stored} of its {chunks} chunks" if stored < chunks else ""


def _values(file: h5py.File, key: str) -> np.ndarray:
    """All numbers of a data set; a group, or what is no real number, is refused."""
    data = file[key]
    if not isinstance(data, h5py.Dataset) or data.dtype.kind not in "biuf":
        kind = data.dtype if isinstance(data, h5py.Dataset) else "a group"
        raise BadInput(f"{file.filename}:{key}: found {kind}; expected real numbers")
    return data[()]


def _recorded(file: h5py.File, key: str) -> np.ndarray | None:
    return _values(file, key) if key in file else None


def pika_sensor(members: Iterable[str], order: Sequence[str], notes: list[str]) -> str | None:
    """The sensor to read: the first that is called or begins as the preferred ones do, else the first by its name.

    Args:
        notes: gets a line where there are others of the same kind, as of two arms, or where it is the leader's.
    """
    names = sorted(members)
    alike = next((found for word in order if (found := [name for name in names if name.startswith(word)])), names)
    chosen = next((name for name in alike if name in order), alike[0] if alike else None)
    if chosen not in order and len(alike) > 1:
        notes.append(f"of {', '.join(alike)} {chosen} is read")
    if chosen and chosen.startswith("master"):
        notes.append(f"{chosen}, the leader, is read: no arm that follows it is recorded")
    return chosen


def _first(file: h5py.File, folder: str, order: Sequence[str], notes: list[str]) -> np.ndarray | None:
    """The data of a sensor of a folder; None where there is none or it is empty."""
    name = pika_sensor(members := file.get(folder, {}), order, notes)
    return _values(file, f"{folder}/{name}") if name and members[name].size else None


def _pose(values: np.ndarray | None, notes: list[str]) -> np.ndarray | None:
    """The first six columns of a pose, which a gripper may follow; None, with a note, of one with a quaternion."""
    if values is None or values.ndim != 2 or values.shape[1] < 7:
        return values
    if np.allclose(np.linalg.norm(values[:, 3:7], axis=1), 1, atol=1e-2):
        notes.append("the pose has a quaternion: not read")
        return None
    return values[:, :6]


def _pika(part: Part, ref: EpisodeRef, file: h5py.File, path: Path) -> Recording:
    notes: list[str] = []
    hints = {"gripper": "m"}
    arm = pika_sensor(file.get("arm/jointStatePosition", {}), PIKA_ARMS, notes)
    position = _first(file, "arm/jointStatePosition", PIKA_ARMS, [])
    pose = _pose(_first(file, "arm/endPose", PIKA_ARMS, []), notes)
    if pose is None and (pose := _pose(_first(file, "localization/pose", ("pika",), notes), notes)) is not None:
        notes.append(PIKA_POSE)
    gripper = _first(file, "gripper/encoderDistance", PIKA_GRIPPERS, notes)
    if gripper is None:
        gripper, hints = _first(file, "gripper/encoderAngle", PIKA_GRIPPERS, notes), {"gripper": "pika_rad"}
    if gripper is None:
        hints = {}
        gripper = position[:, 6] if position is not None and position.shape[1] > 6 else None
    if any(data.dtype == np.uint8 and data.ndim == 4 for data in file.get("camera/depth", {}).values()):
        notes.append("depth is 8-bit, its metres are lost: not read")
    streams = {
        "joints": None if position is None else position[:, :6], "end_effector": pose, "gripper": gripper,
        "action": _recorded(file, f"arm/jointStatePosition/{str(arm).replace('puppet', 'master')}"),
        "timestamps": _recorded(file, "timestamp"),
    }
    colour = file.get("camera/color", {})
    cameras = {name: _pika_camera(path, data) for name, data in colour.items()}
    stamps = {f"camera {name}": times for name, data in colour.items() if (times := _pika_stamps(data)) is not None}
    stated = np.ravel(_values(file, "size"))[:1].tolist() if "size" in file else []
    return make_recording(part, replace(ref, timesteps=int(stated[0])) if stated else ref, streams, source=path,
                          cameras=cameras, notes=notes, hints=hints, own_times=stamps)


def _pika_camera(path: Path, data: h5py.Dataset) -> Frames:
    """Frames of one camera: pixels (blue first), or paths relative to the episode's folder."""
    if data.ndim > 1:
        return from_hdf5(path, data.name, bgr=True)
    if data.dtype.kind not in "OS":
        raise BadInput(f"{path}:{data.name}: found {data.dtype} {data.shape}; expected names of images")
    return from_files([inside(path.parent, name) for name in _image_names(data)])


def _image_names(data: h5py.Dataset) -> list[str]:
    return [name.decode() if isinstance(name, bytes) else str(name) for name in data]


def _pika_stamps(data: h5py.Dataset) -> np.ndarray | None:
    """The times that a camera's images are named by, (T,) s; None where their names are no numbers."""
    if data.ndim > 1:
        return None
    stems = [PurePosixPath(name).stem for name in _image_names(data)]
    return np.array(stems, float) if all(re.fullmatch(r"[1-9]\d{9}(\.\d+)?", stem) for stem in stems) else None


def _act(part: Part, ref: EpisodeRef, file: h5py.File, path: Path) -> Recording:
    state = _values(file, "observations/qpos")
    arm, _, notes, _ = arm_streams(state)
    names = (f"{group}timestamp{s}" for group in ("observations/", "") for s in ("", "s"))
    times = next((name for name in names if name in file), "timestamp")
    streams = {**arm, "action": _recorded(file, "action"), "state": state, "timestamps": _recorded(file, times)}
    cameras = {name: from_hdf5(path, data.name) for name, data in file.get("observations/images", {}).items()}
    notes += ["order of the colour channels is not recorded: red first assumed"] if cameras else []
    return make_recording(part, ref, streams, source=path, cameras=cameras, notes=notes)


def _robomind(part: Part, ref: EpisodeRef, file: h5py.File, path: Path) -> Recording:
    """The arm that moves most; the last joint of seven is the gripper."""
    arms = {name.removeprefix("joint_position"): _values(file, f"puppet/{name}") for name in file["puppet"]
            if name.startswith("joint_position")}
    travel = {side: float(np.nansum(np.abs(np.diff(position, axis=0)))) for side, position in arms.items()}
    side = max(travel, key=travel.__getitem__, default="")
    notes = [f"{len(arms)} arms recorded: the {side.strip('_')} one moves most and is read"] if side else []
    joints, gripper = arms.get(side), None
    if joints is not None and joints.shape[1] >= 7:
        joints, gripper = joints[:, :-1], joints[:, -1]
        notes.append("last joint taken as the gripper")
    pose = _pose(_recorded(file, f"puppet/end_effector{side}"), notes)
    streams = {"joints": joints, "gripper": gripper, "end_effector": pose,
               "action": _recorded(file, f"master/joint_position{side}")}
    cameras = {name: from_hdf5(path, data.name) for name, data in file.get("observations/rgb_images", {}).items()}
    return make_recording(part, ref, streams, assumed_fps=ROBOMIND_HZ, source=path, cameras=cameras, notes=notes)
