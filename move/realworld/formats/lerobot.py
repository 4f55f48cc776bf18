"""LeRobot v2.1 (and v2.0): one parquet file and one video a camera for every episode; v3.0: many episodes share them.

v2.1   meta/info.json  meta/episodes.jsonl (index and length of each episode)
       data/chunk-000/episode_000000.parquet
       videos/chunk-000/observation.images.<camera>/episode_000000.mp4
v3.0   meta/info.json  meta/episodes/chunk-000/file-000.parquet (also which file and which rows hold an episode)
       data/chunk-000/file-000.parquet
       videos/observation.images.<camera>/chunk-000/file-000.mp4
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from pydantic import BaseModel, Field

from move.errors import BadInput
from move.realworld.episode import EpisodeRef, Part, Recording, make_recording
from move.realworld.frames import Frames, from_files, from_video
from move.realworld.lerobot_files import DATA, V2, V3, VIDEO
from move.realworld.piper import is_piper
from move.realworld.state_columns import arm_streams, flat_names
from move.realworld.untrusted_names import fill_template, inside
from move.untrusted import parse_json, read_json, read_text, reading, within
from move.validation import validated

STATE = ("observation.state", "observation.states", "states", "state")
ACTION = ("action", "actions")
POSE_WORDS = ("eef", "ee_pose", "end_pose", "endpose")
NUMBERING = ("episode_index", "frame_index", "index")
pa.set_memory_pool(pa.system_memory_pool())  # Arrow's own keeps address space that `move.untrusted` would not count


class _Info(BaseModel):
    """What is needed of `meta/info.json`; `null` stands for what is not given."""

    codebase_version: str
    features: dict[str, dict[str, Any]]
    robot_type: str | None = None
    chunks_size: Annotated[int, Field(ge=1, strict=True)] | None = None
    fps: Annotated[float, Field(gt=0, allow_inf_nan=False, strict=True)] | None = None
    data_path: str | None = None
    video_path: str | None = None
    total_episodes: Annotated[int, Field(ge=0, strict=True)] | None = None
    total_frames: Annotated[int, Field(ge=0, strict=True)] | None = None

    def cameras(self, dtype: str) -> list[str]:
        """Names of the features that are a "video" or an "image"."""
        return [name for name, feature in self.features.items() if feature.get("dtype") == dtype]


def metadata(files: Sequence[str]) -> list[str]:
    """Everything under `meta/`, but the statistics, which grow with the data and are not needed."""
    return [file for file in files if file.startswith("meta/") and "stats" not in file]


def episodes(part: Part) -> list[EpisodeRef]:
    """List the episodes by their number, with the frames that lie before each in its videos.

    `meta/episodes.jsonl` or `meta/episodes/` holds them, or, where v2.1 lacks that file, the parquet files' names do.
    """
    info = _read_info(part)
    with reading(part.root, "the episode table of a LeRobot data set"):
        rows = _rows_v2(part) if part.layout == V2 else _rows_v3(part)
        refs = [_ref(part, info, row) for row in sorted(rows, key=lambda row: _whole(row, "episode_index"))]
    totals: Counter[str] = Counter()
    videos = [(ref, video) for ref in refs for video in ref.place["videos"].values()]
    for ref, video in videos:  # in the order in which their frames lie in the files
        video["earlier"] = totals[video["path"]]
        totals[video["path"]] += ref.timesteps or 0
    for _, video in videos:
        video["total"] = totals[video["path"]] or None
    return refs


def lacking(part: Part, refs: Sequence[EpisodeRef]) -> list[str] | None:
    """Numbers of `meta/info.json` that the episode table does not have, and data files of no listed episode."""
    info, lengths = _read_info(part), [ref.timesteps for ref in refs]
    listed = {"episodes": len(refs), "timesteps": None if None in lengths else sum(length or 0 for length in lengths)}
    stated = {"episodes": info.total_episodes, "timesteps": info.total_frames}
    if part.layout == V2 and "meta/episodes.jsonl" not in part.files and not any(stated.values()):
        return None
    lines = [f"{part.name}: {stated[name]} {name} are stated, {number} are listed" for name, number in listed.items()
             if None not in (number, stated[name]) and number != stated[name]]
    known = {ref.place["data"] for ref in refs}
    return lines + [f"{part.name}: {file} is of no listed episode" for file in part.files
                    if file.startswith("data/") and file.endswith(".parquet") and file not in known]


def _rows_v2(part: Part) -> list[dict[str, Any]]:
    path = inside(part.root, "meta/episodes.jsonl")
    if not path.is_file():
        found = (re.fullmatch(r"data/.*episode_(\d+)\.parquet", file) for file in part.files)
        return [{"episode_index": int(match.group(1))} for match in found if match]
    with reading(path, "one JSON object a line with episode_index and length"):
        lines = [line for line in read_text(path).splitlines() if line.strip()]
        within("episodes", len(lines), path)
        return [parse_json(line, path) for line in lines]


def _rows_v3(part: Part) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = []
    for name in sorted(file for file in part.files if file.startswith("meta/episodes/") and file.endswith(".parquet")):
        path = inside(part.root, name)
        with reading(path, "the episode table of a LeRobot v3.0 data set"):
            rows += _read_table(path, ()).to_pylist()
    return rows


def _ref(part: Part, info: _Info, row: dict[str, Any]) -> EpisodeRef:
    """Turn one row of the episode table into a reference: the table's path, and of each camera path and start (s)."""
    index = _whole(row, "episode_index")

    def fill(template: str, prefix: str, **more: str) -> str:
        values: dict[str, int | str] = {"episode_chunk": index // (info.chunks_size or 1000), "episode_index": index}
        if part.layout == V3:
            values = {name: _whole(row, f"{prefix}/{name}") for name in ("chunk_index", "file_index")}
        return fill_template(template, values | more, str(part.root))

    data = fill(info.data_path or DATA[part.layout], "data")
    videos: dict[str, dict[str, Any]] = {
        key: {"path": fill(info.video_path or VIDEO[part.layout], f"videos/{key}", video_key=key),
              "start_s": 0.0 if part.layout == V2 else float(row[f"videos/{key}/from_timestamp"])}
        for key in info.cameras("video")}
    files = (data, *(video["path"] for video in videos.values()))
    length = _whole(row, "length") if part.layout == V3 or "length" in row else None
    within("rows", length or 0, f"{part.root}: episode {index}")
    return EpisodeRef(index, files, length, {"data": data, "videos": videos})


def read(part: Part, ref: EpisodeRef) -> Recording:
    """Read one episode; videos are opened only when frames are asked for."""
    info, path = _read_info(part), inside(part.root, ref.place["data"])
    with reading(path, "a parquet table of LeRobot episodes"):
        table = _read_table(path, info.cameras("image"), episode=ref.index if part.layout == V3 else None)
        return _recording(part, ref, info, table, path)


def _read_info(part: Part) -> _Info:
    """Read `meta/info.json` and check its version."""
    path, version = inside(part.root, "meta/info.json"), part.layout.removeprefix("lerobot_")
    content = read_json(path, "the info.json of a LeRobot data set")
    info = validated(_Info, content, str(path), f"; found keys {sorted(content)[:12]}")
    if not info.codebase_version.startswith(version):
        raise BadInput(f"{path}: codebase_version is {info.codebase_version!r}; its files look like {version}.x")
    return info


def _whole(row: Mapping[str, Any], key: str) -> int:
    """A number of an episode table that has to be a whole one."""
    if type(value := row.get(key)) is not int:
        raise BadInput(f"{key} is {str(value)[:40]!r}; expected a whole number")
    return value


def _names_of(feature: Mapping[str, Any]) -> list[str]:
    """Names of a feature's columns; older files write `name` for `names`."""
    return flat_names(feature.get("names", feature.get("name")))


def _read_table(path: Path, images: Sequence[str], *, episode: int | None = None) -> pa.Table:
    """The columns of numbers and of images, in the order of the file, of one episode or of all."""
    about = pq.read_metadata(path)
    within("rows", about.num_rows, path)
    kinds = {field.name: field.type for field in about.schema.to_arrow_schema()}
    for name in (*STATE, *ACTION, "timestamp", *NUMBERING):
        if name in kinds and not _is_numeric(kinds[name]):
            raise BadInput(f"{path}: column {name!r}: found {kinds[name]}; expected numbers")
    if episode is not None and "episode_index" not in kinds:
        raise BadInput(f"{path}: expected a column 'episode_index'; found {list(kinds)[:12]}")
    wanted = [name for name, kind in kinds.items()
              if name in images or _is_numeric(kind) and not name.startswith("stats/")]
    rows = None if episode is None else [("episode_index", "==", episode)]
    return pq.read_table(path, columns=wanted, filters=rows, partitioning=None, use_threads=False)


def _is_numeric(kind: pa.DataType) -> bool:
    """Whether a column holds numbers, alone or in lists; true and false are none."""
    if isinstance(kind, pa.BaseExtensionType):
        return _is_numeric(kind.storage_type)
    if pa.types.is_list(kind) or pa.types.is_large_list(kind) or pa.types.is_fixed_size_list(kind):
        return _is_numeric(kind.value_type)
    return pa.types.is_integer(kind) or pa.types.is_floating(kind)


def _matrix(table: pa.Table, key: str) -> np.ndarray:
    """One column of a table as (T, k) float64, be it numbers or lists of them; what is null becomes NaN."""
    values = np.array(table[key].to_pylist(), dtype=np.float64)
    return values.reshape(len(values), -1)


def _image_frames(part: Part, table: pa.Table, key: str, source: Path) -> Frames:
    """Frames stored in a parquet column, as bytes or as paths inside the data set; none where there is no column."""
    cells = table[key].to_pylist() if key in table.column_names else []
    if all(isinstance(cell, dict) and cell.get("bytes") for cell in cells):
        return Frames(f"{source}:{key}", lambda: len(cells), lambda numbers: (cells[n]["bytes"] for n in numbers))
    return from_files([inside(part.root, cell["path"] if isinstance(cell, dict) else cell) for cell in cells])


def _recording(part: Part, ref: EpisodeRef, info: _Info, table: pa.Table, source: Path) -> Recording:
    """Turn the rows of one episode into a recording, in the order of `frame_index`."""
    notes = []
    there = table.column_names
    if "frame_index" in there and (np.diff(_matrix(table, "frame_index")[:, 0]) < 0).any():
        table = table.sort_by("frame_index")
        notes.append("rows were not in the order of frame_index: sorted")
    state, names = _state(table, info.features)
    piper = not info.robot_type or is_piper(info.robot_type)
    arm, hints, more, joints = ({}, {}, [], ()) if state is None else arm_streams(state, names, piper_order=piper)
    action = next((key for key in ACTION if key in there), None)
    streams = {
        **arm, "action": _matrix(table, action) if action else None, "state": state,
        "timestamps": _matrix(table, "timestamp")[:, 0] if "timestamp" in there else None,
    }
    cameras = {key: from_video(**(video | {"path": inside(part.root, video["path"])}))
               for key, video in ref.place["videos"].items()}
    cameras |= {key: _image_frames(part, table, key, source) for key in info.cameras("image")}
    return make_recording(
        part, ref, streams, fps=info.fps, source=source, hints=hints, notes=notes + more, robot=info.robot_type,
        numbering={key: _matrix(table, key)[:, 0] for key in NUMBERING if key in there},
        joint_names=joints, action_names=tuple(_names_of(info.features.get(action, {}))) if action else (),
        cameras={key.removeprefix("observation.images."): frames for key, frames in cameras.items()})


def _state(table: pa.Table, features: Mapping[str, Any]) -> tuple[np.ndarray | None, list[str]]:
    """The state vector and, where they are kept apart, pose vectors next to it; their names, where there are any."""
    keys = [key for key in STATE if key in table.column_names][:1]
    keys += [key for key in table.column_names if any(word in key for word in POSE_WORDS) and "action" not in key]
    blocks, names, named = [_matrix(table, key) for key in keys], [], False
    for key, block in zip(keys, blocks, strict=True):
        own = _names_of(features.get(key, {}))
        fit = len(own) == block.shape[1]
        names += own if fit else [f"unnamed_{n}" for n in range(block.shape[1])]
        named = named or fit or len(own) > 1  # one name is that of the vector; another number names no column
    return np.hstack(blocks) if blocks else None, names if named else []
