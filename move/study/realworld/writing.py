"""Writing what LeRobot reads: columns of vectors, the scalar columns of every frame, and videos."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import av
import numpy as np
import pyarrow as pa

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


def write_video(path: Path, images: Iterable[np.ndarray], size: tuple[int, int], fps: int, pixel_format: str,
                options: Mapping[str, str]) -> None:
    """Write an H.264 video: the same images give the same file.

    For that the encoder has one thread and no macroblock tree, with which the same images did not always give it.

    Args:
        images: each (height, width, 3) uint8.
        size: height, width in pixels.
        options: of libx264, such as its `crf`.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=fps, options={**options, "x264-params": "mbtree=0"})
        stream.height, stream.width, stream.pix_fmt = *size, pixel_format
        stream.codec_context.thread_count = 1
        for image in images:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="rgb24")))
        container.mux(stream.encode())
