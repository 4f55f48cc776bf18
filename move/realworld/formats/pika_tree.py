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
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from move.errors import BadInput
from move.realworld.episode import EpisodeRef, Part, Recording, make_recording
from move.realworld.formats.hdf5 import PIKA_ARMS, PIKA_GRIPPERS, natural
from move.realworld.frames import from_files, nearest
from move.realworld.state_columns import POSE
from move.realworld.untrusted_names import inside
from move.untrusted import read_json, read_text, reading


def metadata(files: Sequence[str]) -> list[str]:
    """None: the folders' names tell the episodes."""
    return []


def episodes(part: Part) -> list[EpisodeRef]:
    """One episode a folder `episodeN`; depth images and point clouds are not needed."""
    groups: dict[str, list[str]] = {}
    for file in part.files:
        match = re.match(r"(episode_?\d+)/", file)
        if match and not re.search(r"/camera/(depth|pointCloud)/", file):
            groups.setdefault(match.group(1), []).append(file)
    return [
        EpisodeRef(n, tuple(groups[name]), place={"folder": name}) for n, name in enumerate(sorted(groups, key=natural))
    ]


def read(part: Part, ref: EpisodeRef) -> Recording:
    """Read one episode, aligned by `sync.txt`, or by time where that is missing."""
    folder = inside(part.root, ref.place["folder"])
    with reading(folder, "an episode folder of the Pika raw tree"):
        sensors = {
            "joints": _choose(folder / "arm/jointState",
                              PIKA_ARMS), "action": _choose(folder / "arm/jointState", ("master",), only=True),
            "end_effector": _choose(folder / "arm/endPose",
                                    PIKA_ARMS), "gripper": _choose(folder / "gripper/encoder", PIKA_GRIPPERS),
        }
        notes = []
        if sensors["end_effector"] is None and (pose := _choose(folder / "localization/pose", ("pika",))):
            sensors["end_effector"] = pose
            notes.append("end effector is the Pika's own localisation: its frame is the tracker's, not the arm's base")
        colour = folder / "camera/color"
        cameras = {f"camera {name}": colour / name for name in _folders(colour)}
        files, times, note = _align({k: v for k, v in {**sensors, **cameras}.items() if v is not None})
        notes += [note] if note else []
        streams = {"timestamps": times} | {name: _VALUES[name](files[name]) for name in sensors if name in files}
        streams, hints = _split_gripper(streams)
        frames = {name.removeprefix("camera "): from_files(files[name]) for name in cameras if name in files}
        own_times = {name: np.array([_stamp(path) for path in paths]) for name, paths in files.items()}
        return make_recording(part, ref, streams, source=folder, cameras=frames, hints=hints | {"time": "s"},
                              notes=notes, own_times=own_times)


def _choose(folder: Path, order: Sequence[str], *, only: bool = False) -> Path | None:
    """The preferred sensor of a folder, else (unless `only`) the first."""
    names = _folders(folder)
    chosen = [name for name in order if name in names] or ([] if only else names)
    return folder / chosen[0] if chosen else None


def _folders(folder: Path) -> list[str]:
    """Names of the folders in a folder, hidden ones left out, sorted; none where there is no such folder."""
    found = (child for child in folder.iterdir() if child.is_dir()) if folder.is_dir() else ()
    return sorted(child.name for child in found if not child.name.startswith("."))


def _stamp(path: Path) -> float:
    return float(path.stem)


def _align(sensors: dict[str, Path]) -> tuple[dict[str, list[Path]], np.ndarray, str | None]:
    """One file a timestep for every sensor, the times of the steps (s), and a note where `sync.txt` is missing."""
    synced = {name: folder / "sync.txt" for name, folder in sensors.items()}
    if all(path.is_file() for path in synced.values()):
        files = {
            name: [inside(path.parent, line.strip())
                   for line in read_text(path).splitlines()
                   if line.strip()]
            for name, path in synced.items()
        }
        first = next((name for name in files if name.startswith("camera ")), next(iter(files)))
        return files, np.array([_stamp(path) for path in files[first]]), None
    raw = {
        name: sorted((path for path in folder.iterdir() if re.fullmatch(r"\d+(\.\d+)?", path.stem)),
                     key=_stamp) for name, folder in sensors.items()
    }
    raw = {name: paths for name, paths in raw.items() if paths}
    slowest = min(raw, key=lambda name: len(raw[name]))
    times = np.array([_stamp(path) for path in raw[slowest]])
    files = {
        name: [paths[i] for i in nearest(np.array([_stamp(p) for p in paths]), times)] for name, paths in raw.items()
    }
    return files, times, "no sync.txt: streams aligned by the nearest time stamp"


def _numbers(files: Sequence[Path], keys: Sequence[str]) -> np.ndarray:
    """The numbers under some keys of each file, (files, numbers) float64; a key's numbers may be a list."""
    rows = []
    for path in files:
        told = read_json(path, "a JSON file of one sensor reading")
        row = [number for key in keys for number in (told[key] if isinstance(told[key], list) else [told[key]])]
        if not all(type(number) in (int, float) for number in row):
            raise BadInput(f"{path}: {str(row)[:60]}; expected numbers")
        rows.append(row)
    return np.array(rows, dtype=np.float64)


_VALUES: dict[str, Callable[[Sequence[Path]], np.ndarray]] = {
    "joints": partial(_numbers, keys=("position",)), "action": partial(_numbers, keys=("position",)),
    "end_effector": partial(_numbers, keys=POSE), "gripper": lambda files: _numbers(files, ("distance",))[:, 0]}


def _split_gripper(streams: dict[str, np.ndarray]) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """Keep six joints; a seventh is the gripper where no encoder was recorded."""
    if "gripper" in streams:
        hints = {"gripper": "m"}
    else:
        hints = {}
        if "joints" in streams and streams["joints"].shape[1] > 6:
            streams = {**streams, "gripper": streams["joints"][:, 6]}
    if "joints" in streams:
        streams = {**streams, "joints": streams["joints"][:, :6]}
    return streams, hints
