"""What LeRobot v2.1 and v3.0 share: `meta/info.json`, feature names, and the columns of a parquet table."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pyarrow as pa
from pydantic import BaseModel, Field, ValidationError

from move.errors import BadInput
from move.realworld.episode import EpisodeRef, Part, Recording, make_recording
from move.realworld.frames import Frames, from_bytes, from_files
from move.realworld.parquet import is_numeric, numeric_names, read_columns
from move.realworld.state_columns import busiest, flat_names, split_columns, unit_hints
from move.realworld.untrusted_names import inside
from move.untrusted import read_json

STATE = ("observation.state", "observation.states", "states", "state")
ACTION = ("action", "actions")
POSE_WORDS = ("eef", "ee_pose", "end_pose", "endpose")
LEFT_OUT = ("timestamp", "frame_index", "episode_index", "index", "task_index")


class Info(BaseModel):
    """What is needed of `meta/info.json`; `null` stands for what is not told."""

    codebase_version: str
    features: dict[str, dict[str, Any]]
    chunks_size: Annotated[int, Field(ge=1)] | None = None
    fps: Annotated[float, Field(gt=0, allow_inf_nan=False)] | None = None
    data_path: str | None = None
    video_path: str | None = None

    def cameras(self, dtype: str) -> list[str]:
        """Names of the features that are a "video" or an "image"."""
        return [name for name, feature in self.features.items() if feature.get("dtype") == dtype]


def read_info(part: Part, version: str) -> Info:
    """Read `meta/info.json` and check its version.

    Args:
        version: what its `codebase_version` must start with, "v2" or "v3".

    Raises:
        BadInput: missing, not JSON, another version, or a value of the wrong type.
    """
    path = inside(part.root, "meta/info.json")
    content = read_json(path, "the info.json of a LeRobot data set")
    try:
        info = Info.model_validate(content)
    except ValidationError as error:
        first = error.errors()[0]
        raise BadInput(f"{path}: {'.'.join(map(str, first['loc']))}: {str(first['input'])[:60]!r} given; "
                       f"{first['msg'].lower()}; found keys {sorted(content)[:12]}") from error
    if not info.codebase_version.startswith(version):
        raise BadInput(f"{path}: codebase_version is {info.codebase_version!r}; its files look like {version}.x")
    return info


def names_of(feature: Mapping[str, Any]) -> list[str]:
    """Names of a feature's columns; older files write `name` for `names`."""
    return flat_names(feature.get("names", feature.get("name")))


def to_matrix(table: pa.Table, key: str) -> np.ndarray:
    """One column of a table as (T, k) float64, be it scalars, lists, fixed-size lists or an extension type.

    Raises:
        BadInput: rows of unequal length, or nulls.
    """
    column = table[key].combine_chunks()
    if isinstance(column, pa.ChunkedArray):
        column = pa.concat_arrays(column.chunks)
    rows = len(column)
    if not is_numeric(column.type):
        raise BadInput(f"column {key!r}: found {column.type}; expected numbers")
    while isinstance(column, pa.ExtensionArray) or pa.types.is_nested(column.type):
        column = column.storage if isinstance(column, pa.ExtensionArray) else column.flatten()
    if column.null_count or rows == 0 or len(column) % rows:
        raise BadInput(f"column {key!r}: {rows} rows, {len(column)} numbers, {column.null_count} nulls; "
                       "expected the same number of values in every row")
    return column.to_numpy(zero_copy_only=False).astype(np.float64).reshape(rows, -1)


def read_table(path: Path, info: Info, *, episode: int | None = None) -> pa.Table:
    """The numbers and the images of a table, of one episode or of all; whatever else it holds is not needed."""
    return read_columns(path, [*numeric_names(path), *info.cameras("image")], episode=episode)


def image_frames(part: Part, table: pa.Table, key: str, source: str) -> Frames:
    """Frames stored in a parquet column, as bytes or as paths inside the data set."""
    cells = table[key].to_pylist()
    if cells and all(isinstance(cell, dict) and cell.get("bytes") for cell in cells):
        return from_bytes([cell["bytes"] for cell in cells], f"{source}:{key}")
    return from_files([inside(part.root, cell["path"] if isinstance(cell, dict) else cell) for cell in cells])


def recording(part: Part, ref: EpisodeRef, info: Info, table: pa.Table, source,
              cameras: Mapping[str, Frames]) -> Recording:
    """Turn the rows of one episode into a recording.

    Args:
        table: the rows of this episode alone, in order of `frame_index`.
        cameras: frames that are not in the table (videos).
    """
    features = info.features
    state, names = _state(table, features)
    columns, hints, notes = None, {}, []
    joints = end_effector = gripper = None
    if state is not None:
        arms, note = split_columns(names, state.shape[1])
        notes += [note] if note else []
        if arms:
            columns, choice = busiest(arms, state)
            notes += [choice] if choice else []
            hints = unit_hints(names, columns) if len(names) == state.shape[1] else {}
            joints = state[:, columns.joints] if columns.joints else None
            end_effector = state[:, columns.pose] if columns.pose else None
            gripper = None if columns.gripper is None else state[:, columns.gripper]
    action = next((key for key in ACTION if key in table.column_names), None)
    images = {key: image_frames(part, table, key, str(source))
              for key in info.cameras("image") if key in table.column_names}
    streams = {
        "joints": joints, "end_effector": end_effector, "gripper": gripper,
        "action": to_matrix(table, action) if action else None, "state": state,
        "timestamps_s": to_matrix(table, "timestamp")[:, 0] if "timestamp" in table.column_names else None,
    }
    return make_recording(
        part, ref, streams, fps=info.fps or 30.0, source=source, hints=hints, notes=notes,
        action_names=tuple(names_of(features.get(action, {}))) if action else (),
        cameras={key.removeprefix("observation.images."): value for key, value in {**cameras, **images}.items()})


def _state(table: pa.Table, features: Mapping[str, Any]) -> tuple[np.ndarray | None, list[str]]:
    """The state vector and, where they are kept apart, pose vectors beside it."""
    keys = [next((key for key in STATE if key in table.column_names), None)]
    keys += [key for key in table.column_names if any(word in key for word in POSE_WORDS) and "action" not in key]
    blocks, names = [], []
    for key in filter(None, keys):
        block = to_matrix(table, key)
        own = names_of(features.get(key, {}))
        blocks.append(block)
        names += own if len(own) == block.shape[1] else [f"unnamed_{n}" for n in range(block.shape[1])]
    if not blocks:
        return None, []
    return np.hstack(blocks), [] if all(name.startswith("unnamed_") for name in names) else names
