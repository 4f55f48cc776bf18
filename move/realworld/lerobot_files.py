"""What LeRobot's data sets share: the names of their files, columns of vectors, the scalar columns of every frame."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyarrow as pa

V2, V3 = "lerobot_v2", "lerobot_v3"
DATA = {V2: "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet",
        V3: "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"}
VIDEO = {V2: "videos/chunk-{episode_chunk:03d}/{video_key}/episode_{episode_index:06d}.mp4",
         V3: "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"}
SCALARS = {
    "timestamp": "float32", "frame_index": "int64", "episode_index": "int64", "index": "int64", "task_index": "int64",
}


def vectors(values: np.ndarray) -> pa.Array:
    """An array (T, n) as a column of vectors of fixed length."""
    return pa.FixedSizeListArray.from_arrays(pa.array(values.ravel()), values.shape[1])


def scalar_columns(lengths: np.ndarray, fps: float, *, first_episode: int = 0, first_index: int = 0) -> dict[str, Any]:
    """The columns of `SCALARS` for episodes that follow one another; time restarts with each of them.

    Args:
        lengths: (episodes,) timesteps of each.
        fps: timesteps a second.
        first_episode, first_index: number of the first episode and of its first frame in the data set.
    """
    total = int(lengths.sum())
    frames = np.arange(total) - np.repeat(np.cumsum(lengths) - lengths, lengths)
    columns = {"timestamp": frames / fps, "frame_index": frames,
               "episode_index": np.repeat(np.arange(len(lengths)), lengths) + first_episode,
               "index": np.arange(total) + first_index, "task_index": np.zeros(total)}
    return {name: columns[name].astype(dtype) for name, dtype in SCALARS.items()}


def scalar_features() -> dict[str, dict[str, Any]]:
    """What `meta/info.json` says of the columns of `SCALARS`."""
    return {name: {"dtype": dtype, "shape": [1], "names": None} for name, dtype in SCALARS.items()}
