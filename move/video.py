"""Videos: the one way this package writes them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import cast

import av
import numpy as np
from av.video.stream import VideoStream

from move.files import written_aside


def write_video(path: Path, images: Iterable[np.ndarray], size: tuple[int, int], fps: int, pixel_format: str,
                options: Mapping[str, str], codec: str = "libx264") -> None:
    """Write an H.264 video: the same images give the same file.

    For that the encoder has one thread and no macroblock tree, with which the same images did not always give it.

    Args:
        images: each (height, width, 3) uint8.
        size: height, width in pixels.
        options: of the codec, such as its `crf`.
        codec: "libx264rgb" with the pixel format "rgb24" and qp 0 gives back exactly these images, on every machine.

    Raises:
        BadInput: it cannot be written, as on a full disk; what was there stays.
    """
    container_format = {"mkv": "matroska"}.get(path.suffix[1:], path.suffix[1:])
    with written_aside(path) as new, av.open(str(new), "w", format=container_format) as container:
        settings = {**options, "x264-params": "mbtree=0"}
        stream = cast(VideoStream, container.add_stream(codec, rate=fps, options=settings))
        stream.height, stream.width, stream.pix_fmt = *size, pixel_format
        stream.codec_context.thread_count = 1
        for image in images:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="rgb24")))
        container.mux(stream.encode())
