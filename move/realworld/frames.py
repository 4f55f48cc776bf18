"""Camera frames that are decoded only when asked for: video (PyAV), JPEG and PNG (Pillow), arrays in HDF5 or zarr.

OpenCV is not used: its wheel cannot read AV1, the codec LeRobot writes by default. A frame's size is known before it is
decoded: Pillow reads an image's header first, and FFmpeg is told how many pixels are allowed.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import av
import h5py
import numpy as np
from PIL import Image as Pillow

from move.errors import BadInput
from move.untrusted import limits, reading, within

IMAGES, VIDEOS = ("JPEG", "PNG"), "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm"
Image = np.ndarray | bytes


@dataclass(frozen=True)
class Frames:
    """The frames of one camera in one episode.

    `load` takes frame numbers in increasing order and yields an image for each: encoded bytes, or uint8 in
    HWC, CHW or HW order. `bgr` says that stored arrays are blue first.
    """

    source: str
    count: Callable[[], int]
    load: Callable[[Sequence[int]], Iterable[Image]]
    bgr: bool = False
    held_bytes: int = 0  # of encoded images that are already in memory

    def __len__(self) -> int:
        """Number of frames."""
        with reading(self.source, "the frames of a camera"):
            return self.count()

    def read(self, numbers: Sequence[int] | np.ndarray) -> np.ndarray:
        """Decode some frames.

        Args:
            numbers: frame numbers, 0-based, in increasing order.

        Returns:
            (len(numbers), height, width, 3) uint8, red first.

        Raises:
            BadInput: a number outside the episode, images that cannot be decoded, or too many of them at once.
        """
        numbers = [int(number) for number in numbers]
        total = len(self)
        if not numbers or numbers != sorted(set(numbers)) or numbers[0] < 0 or numbers[-1] >= total:
            raise BadInput(f"frames {numbers[:5]} of {self.source}: allowed are increasing numbers in 0..{total - 1}")
        images: list[np.ndarray] = []
        with reading(self.source, "images"):
            for image in self.load(numbers):
                images.append(as_rgb(image, self.source))
                within("memory_bytes", 2 * len(numbers) * images[-1].nbytes, f"{self.source}: {len(numbers)} frames")
            if len(images) != len(numbers):
                raise BadInput(f"{self.source}: asked for {len(numbers)} frames, found {len(images)}")
            stack = np.stack(images)
        return stack[..., ::-1] if self.bgr else stack


def as_rgb(image: Image, where: str) -> np.ndarray:
    """Turn encoded bytes or an array in HWC, CHW or HW order into (height, width, 3) uint8.

    Raises:
        BadInput: another dtype or shape.
    """
    if isinstance(image, bytes | np.void) or (image.dtype == np.uint8 and image.ndim == 1):
        return decode_image(image if isinstance(image, bytes) else image.tobytes(), where)
    within("pixels", image.size // 3, f"image in {where}")
    if image.dtype != np.uint8 or image.ndim not in (2, 3):
        raise BadInput(f"image in {where}: found {image.dtype} {image.shape}; expected uint8, HWC, CHW or HW")
    if image.ndim == 2:
        return np.repeat(image[..., None], 3, axis=2)
    if image.shape[2] != 3 and image.shape[0] == 3:
        image = np.moveaxis(image, 0, 2)
    if image.shape[2] != 3:
        raise BadInput(f"image in {where}: found shape {image.shape}; expected 3 channels")
    return image


def decode_image(data: bytes, where: str) -> np.ndarray:
    """Decode a JPEG or PNG to (height, width, 3) uint8, red first; zero padding behind the image is ignored."""
    within("image_bytes", len(data), f"image in {where}")
    with Pillow.open(io.BytesIO(data), formats=IMAGES) as image:
        within("pixels", image.width * image.height, f"image in {where}")
        return np.asarray(image.convert("RGB"))


def _opened(path: Path) -> av.container.InputContainer:
    """Open a video in a known container, which can name no other file, with frames of no more pixels than allowed."""
    options = {"protocol_whitelist": "file", "format_whitelist": VIDEOS, "max_pixels": str(limits().pixels)}
    return av.open(str(path.absolute()), options=options)


def _frames(container: av.container.InputContainer, where: Path) -> Iterable[av.VideoFrame]:
    """The frames of a video from where it stands, not more than are allowed."""
    stream = container.streams.video[0]
    within("pixels", stream.codec_context.width * stream.codec_context.height, where)
    stream.codec_context.options = {"max_pixels": str(limits().pixels)}
    for number, frame in enumerate(container.decode(stream), 1):
        within("rows", number, f"{where}: frames")
        yield frame


def from_video(path: Path, *, start_s: float = 0.0, count: int | None = None) -> Frames:
    """Frames of a video file in any codec PyAV decodes, AV1 and H.264 among them.

    Args:
        path: the video.
        start_s: where the episode starts in it, s (LeRobot v3.0 keeps many episodes in one file).
        count: number of frames; None: all of the file.
    """
    def number() -> int:
        if count is not None:
            return count
        with _opened(path) as container:
            return container.streams.video[0].frames or sum(1 for _ in _frames(container, path))

    return Frames(str(path), number, lambda numbers: _decode(path, start_s, numbers))


def _decode(path: Path, start_s: float, numbers: Sequence[int]) -> Iterable[np.ndarray]:
    """Yield the wanted frames in one pass from the key frame before the first of them."""
    with _opened(path) as container:
        stream = container.streams.video[0]
        if not stream.average_rate or not stream.time_base:
            raise BadInput(f"{path}: the video does not say how many frames a second it has")
        rate = float(stream.average_rate)
        origin = float((stream.start_time or 0) * stream.time_base) + start_s
        container.seek(int((origin + numbers[0] / rate) / stream.time_base), stream=stream, backward=True)
        wanted = iter(numbers)
        target: int | None = next(wanted)
        for frame in _frames(container, path):
            if round((frame.time - origin) * rate) == target:
                yield frame.to_ndarray(format="rgb24")
                target = next(wanted, None)
                if target is None:
                    return


def from_files(paths: Sequence[Path]) -> Frames:
    """One JPEG or PNG file a frame."""
    source = str(paths[0].parent) if paths else "no files"

    def load(numbers: Sequence[int]) -> Iterable[bytes]:
        for number in numbers:
            within("image_bytes", paths[number].stat().st_size, paths[number])
            yield paths[number].read_bytes()

    return Frames(source, lambda: len(paths), load)


def from_bytes(images: Sequence[bytes], source: str) -> Frames:
    """Encoded images already in memory, as in a parquet column."""
    return Frames(source, lambda: len(images), lambda numbers: (images[n] for n in numbers),
                  held_bytes=sum(map(len, images)))


def from_hdf5(path: Path, key: str, *, bgr: bool = False) -> Frames:
    """A dataset (T, H, W, 3), (T, 3, H, W), (T, padded JPEG bytes) or (T,) of encoded bytes in an HDF5 file."""
    def count() -> int:
        with h5py.File(path, "r") as file:
            return len(file[key])

    def load(numbers: Sequence[int]) -> Iterable[Image]:
        with h5py.File(path, "r") as file:
            for number in numbers:
                yield file[key][number]

    return Frames(f"{path}:{key}", count, load, bgr)
