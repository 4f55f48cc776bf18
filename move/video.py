"""Videos: the one way this package writes them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

import av
import numpy as np


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
