"""AgileX Pika raw tree: one folder an episode, one small file a sensor and a time stamp.

    episodeN/camera/color/<camera>/<unix seconds>.jpg   sync.txt
    episodeN/arm/jointState/<arm>/<t>.json              {"position": [...]}
    episodeN/arm/endPose/<arm>/<t>.json                 {"x", "y", "z", "roll", "pitch", "yaw"[, "grasper"]}
    episodeN/localization/pose/pika/<t>.json            {"x", ..., "yaw"}
    episodeN/gripper/encoder/<gripper>/<t>.json         {"angle", "distance"}

`sync.txt` names one file a synchronised frame, the same number of lines in every sensor's folder. Without it
the streams are not aligned: each is then taken at the time nearest to the slowest stream's, and that is noted.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from move.errors import BadInput
from move.realworld.episode import EpisodeRef, Part, Recording, make_recording
from move.realworld.formats import hdf5
from move.realworld.frames import from_files, nearest
from move.realworld.state_columns import POSE
from move.realworld.untrusted_names import inside
from move.untrusted import read_json, read_text, reading

metadata, lacking = hdf5.metadata, hdf5.lacking  # the episodes of both are numbered by their names


def episodes(part: Part) -> list[EpisodeRef]:
    """One episode a folder `episodeN`; depth images and point clouds are not needed."""
    groups: dict[str, list[str]] = {}
    for file in part.files:
        match = re.match(r"(episode_?\d+)/", file)
        if match and not re.search(r"/camera/(depth|pointCloud)/", file):
            groups.setdefault(match.group(1), []).append(file)
    names = sorted(groups, key=hdf5.natural)
    return [EpisodeRef(number, tuple(groups[name]), place={"folder": name})
            for number, name in zip(hdf5.numbers_of(names), names, strict=True)]


def read(part: Part, ref: EpisodeRef) -> Recording:
    """Read one episode, aligned by `sync.txt`, or by time where that is missing."""
    folder = inside(part.root, ref.place["folder"])
    with reading(folder, "an episode folder of the Pika raw tree"):
        sensors, notes = _sensors(folder)
        files, times, note = _align(sensors)
        streams = {"timestamps": times}
        if "joints" in files:
            position = _numbers(files["joints"], ("position",))
            streams["joints"] = position[:, :6]
            if "gripper" not in files and position.shape[1] > 6:
                streams["gripper"] = position[:, 6]
        if "action" in files:
            streams["action"] = _numbers(files["action"], ("position",))
        if "end_effector" in files:
            streams["end_effector"] = _numbers(files["end_effector"], POSE)
        if "gripper" in files:
            streams["gripper"] = _numbers(files["gripper"], ("distance",))[:, 0]
        hints = {"time": "s"} | ({"gripper": "m"} if "gripper" in files else {})
        cameras = {name.removeprefix("camera "): from_files(paths) for name, paths in files.items()
                   if name.startswith("camera ")}
        own_times = {name: np.array([_stamp(path) for path in paths]) for name, paths in files.items()}
        return make_recording(part, ref, streams, source=folder, cameras=cameras, hints=hints, own_times=own_times,
                              notes=[*notes, note] if note else notes)


def _sensors(folder: Path) -> tuple[dict[str, Path], list[str]]:
    """The folder of each stream and each camera, and a note where the pose is not the arm's."""
    notes: list[str] = []
    arm = _choose(folder / "arm/jointState", hdf5.PIKA_ARMS, notes)
    leader = arm and arm.with_name(arm.name.replace("puppet", "master"))
    found = {
        "joints": arm, "action": leader if leader and leader.is_dir() else None,
        "end_effector": _choose(folder / "arm/endPose", hdf5.PIKA_ARMS, []),
        "gripper": _choose(folder / "gripper/encoder", hdf5.PIKA_GRIPPERS, notes),
    }
    if found["end_effector"] is None and (pose := _choose(folder / "localization/pose", ("pika",), notes)):
        found["end_effector"] = pose
        notes.append(hdf5.PIKA_POSE)
    colour = folder / "camera/color"
    found |= {f"camera {name}": colour / name for name in _folders(colour)}
    return {name: place for name, place in found.items() if place is not None}, notes


def _choose(folder: Path, order: Sequence[str], notes: list[str]) -> Path | None:
    """The sensor of a folder that is read."""
    name = hdf5.pika_sensor(_folders(folder), order, notes)
    return folder / name if name else None


def _folders(folder: Path) -> list[str]:
    """Names of the folders in a folder, hidden ones left out, sorted; none where there is no such folder."""
    found = [child.name for child in folder.iterdir() if child.is_dir()] if folder.is_dir() else []
    return sorted(name for name in found if not name.startswith("."))


def _stamp(path: Path) -> float:
    return float(path.stem)


def _align(sensors: dict[str, Path]) -> tuple[dict[str, list[Path]], np.ndarray, str | None]:
    """One file a timestep for every sensor, the times of the steps (s), and a note where `sync.txt` is missing."""
    if all((folder / "sync.txt").is_file() for folder in sensors.values()):
        files = {}
        for name, folder in sensors.items():
            lines = read_text(folder / "sync.txt").splitlines()
            files[name] = [inside(folder, line.strip()) for line in lines if line.strip()]
        first = next((name for name in files if name.startswith("camera ")), next(iter(files)))
        return files, np.array([_stamp(path) for path in files[first]]), None
    raw, stamps = {}, {}
    for name, folder in sensors.items():
        found = [path for path in folder.iterdir() if re.fullmatch(r"\d+(\.\d+)?", path.stem)]
        if found:
            raw[name] = sorted(found, key=_stamp)
            stamps[name] = np.array([_stamp(path) for path in raw[name]])
    times = min(stamps.values(), key=len)
    files = {name: [paths[n] for n in nearest(stamps[name], times)] for name, paths in raw.items()}
    return files, times, "no sync.txt: streams aligned by the nearest time stamp"


def _numbers(files: Sequence[Path], keys: Sequence[str]) -> np.ndarray:
    """The numbers under some keys of each file, (files, numbers) float64; a key's numbers may be a list."""
    rows = []
    for path in files:
        reading = read_json(path, "a JSON file of one sensor reading")
        row: list = []
        for key in keys:
            row += reading[key] if isinstance(reading[key], list) else [reading[key]]
        if not all(type(number) in (int, float) for number in row):
            raise BadInput(f"{path}: {str(row)[:60]}; expected numbers")
        rows.append(row)
    return np.array(rows, dtype=np.float64)
