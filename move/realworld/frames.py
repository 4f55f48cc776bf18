"""Camera frames that are decoded only when asked for: video (PyAV), JPEG and PNG (Pillow), arrays in HDF5 or zarr.

A frame of a video belongs to a timestep by its time: it is the nearest one, and none where the nearest is more than
half a frame away. A stored image belongs to the timestep of its number.

OpenCV is not used: its wheel cannot read AV1, the codec LeRobot writes by default.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import av
import h5py
import numpy as np
from PIL import Image as Pillow

from move.errors import BadInput
from move.untrusted import reading, within

IMAGES, VIDEOS = ("JPEG", "PNG"), "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm"
CLOCK_S = 1e-4  # rounding of a time stamp in float32, or in a video's own unit of time
Image = np.ndarray | bytes


@dataclass(frozen=True)
class Frames:
    """The frames of one camera in one episode.

    `load` takes numbers of stored images in increasing order and yields an image for each: encoded bytes, or uint8 in
    HWC, CHW or HW order. `bgr` says that stored arrays are blue first. `place` turns the times of timesteps (T,), s,
    into numbers of stored images (T,), -1 where there is none; None: image n is that of timestep n.
    """

    source: str
    count: Callable[[], int]  # of stored images
    load: Callable[[Sequence[int]], Iterable[Image]]
    bgr: bool = False
    place: Callable[[np.ndarray], np.ndarray] | None = None
    times_s: np.ndarray | None = None  # (T,) of the timesteps, NaN where unknown; None: as many as images

    def __len__(self) -> int:
        """Number of stored images."""
        with reading(self.source, "the frames of a camera"):
            return self.count()

    def at(self, times_s: np.ndarray) -> Frames:
        """The same camera for timesteps at these times, (T,) s, in the clock of the data set."""
        return replace(self, times_s=times_s)

    def numbers(self) -> np.ndarray:
        """Number of the stored image of each timestep, (T,) int64; -1 where it has none.

        Raises:
            BadInput: the images cannot be read, or it is unclear which belong to this episode.
        """
        with reading(self.source, "the frames of a camera"):
            if self.place is not None and self.times_s is not None:
                return self.place(self.times_s)
            total = self.count()
            steps = np.arange(total if self.times_s is None else len(self.times_s))
            return np.where(steps < total, steps, -1)

    def read(self, steps: Sequence[int] | np.ndarray) -> np.ndarray:
        """Decode the frames of some timesteps.

        Args:
            steps: timesteps, 0-based, in increasing order.

        Returns:
            (len(steps), height, width, 3) uint8, red first.

        Raises:
            BadInput: a timestep outside the episode or without a frame, images that cannot be decoded, or too many of
                them at once.
        """
        steps = [int(step) for step in steps]
        numbers = self.numbers()
        if not steps or steps != sorted(set(steps)) or steps[0] < 0 or steps[-1] >= len(numbers):
            raise BadInput(f"frames {steps[:5]} of {self.source}: allowed are increasing numbers in "
                           f"0..{len(numbers) - 1}")
        if (numbers[steps] < 0).any():
            lacking = steps[int(np.argmax(numbers[steps] < 0))]
            raise BadInput(f"{self.source}: timestep {lacking} has no frame within half a frame of its time")
        wanted, places = np.unique(numbers[steps], return_inverse=True)
        with reading(self.source, "images"):
            images = [_as_rgb(image, self.source) for image in self.load(wanted.tolist())]
            if len(images) != len(wanted):
                raise BadInput(f"{self.source}: asked for {len(wanted)} frames, found {len(images)}")
            stack = np.stack(images)[places]
        return stack[..., ::-1] if self.bgr else stack


def _as_rgb(image: Image, where: str) -> np.ndarray:
    """Encoded bytes, or an array in HWC, CHW or HW order, as (height, width, 3) uint8."""
    if isinstance(image, bytes | np.void) or (image.dtype == np.uint8 and image.ndim == 1):
        data = io.BytesIO(image if isinstance(image, bytes) else image.tobytes())  # zeros behind the image are ignored
        with Pillow.open(data, formats=IMAGES) as picture:
            return np.asarray(picture.convert("RGB"))
    if image.dtype != np.uint8 or image.ndim not in (2, 3):
        raise BadInput(f"image in {where}: found {image.dtype} {image.shape}; expected uint8, HWC, CHW or HW")
    if image.ndim == 2:
        return np.repeat(image[..., None], 3, axis=2)
    if image.shape[2] != 3 and image.shape[0] == 3:
        image = np.moveaxis(image, 0, 2)
    if image.shape[2] != 3:
        raise BadInput(f"image in {where}: found shape {image.shape}; expected 3 channels")
    return image


def nearest(stamps: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Number of the stamp nearest to each time, (T,); the stamps increasing, at least one."""
    right = np.clip(np.searchsorted(stamps, times), 0, len(stamps) - 1)
    left = np.maximum(right - 1, 0)
    return np.where(np.abs(stamps[left] - times) <= np.abs(stamps[right] - times), left, right)


def _opened(path: Path) -> av.container.InputContainer:
    """Open a video in a known container, which can name no other file."""
    return av.open(str(path.absolute()), options={"protocol_whitelist": "file", "format_whitelist": VIDEOS})


def from_video(path: Path, *, start_s: float | None = 0.0, earlier: int = 0, total: int | None = None) -> Frames:
    """Frames of a video file in any codec PyAV decodes, AV1 and H.264 among them; its frame rate may vary.

    Args:
        path: the video.
        start_s: where time 0 of the episode is in it, s (LeRobot v3.0 keeps many episodes in one file); None: the
            first timestep is at the first frame.
        earlier: timesteps of the episodes that come before this one in the file.
        total: timesteps of all episodes in the file; None: this one is alone in it.
    """
    def place(times_s: np.ndarray) -> np.ndarray:
        stamps = _stamps_s(path)
        whole = len(times_s) if total is None else total
        if np.isnan(times_s).all():
            if len(stamps) != whole:
                raise BadInput(f"{path}: {len(stamps)} frames for {whole} timesteps, whose times are not known")
            return earlier + np.arange(len(times_s))
        if start_s is None:
            times_s, stamps = times_s - times_s[np.isfinite(times_s)][0], stamps - stamps[0]
        else:
            times_s = times_s + start_s
        numbers = nearest(stamps, times_s)
        gaps = np.diff(stamps if len(stamps) > 1 else times_s)
        half = np.median(gaps) / 2 if gaps.size else 0.0
        numbers[~(np.abs(stamps[numbers] - times_s) <= half + CLOCK_S)] = -1
        _refuse_another_place(path, numbers, len(stamps), earlier, whole)
        return numbers

    return Frames(str(path), lambda: len(_stamps_s(path)), lambda numbers: _decode(path, numbers), place=place)


def _refuse_another_place(path: Path, numbers: np.ndarray, frames: int, earlier: int, total: int) -> None:
    """Refuse an episode whose time in a video is not where the lengths of the episodes before it put it."""
    ratio = frames / total
    whole = max(1, round(ratio))
    each = whole if abs(ratio / whole - 1) <= 0.2 else ratio  # frames a timestep; a video may end a little later
    known = np.flatnonzero(numbers >= 0)[:1]
    if (np.abs(numbers[known] - each * (earlier + known)) > each / 2).any():
        raise BadInput(f"{path}: by its time stamps the episode's timestep {known[0]} is frame {numbers[known][0]}, by "
                       f"the lengths of the episodes before it frame {each * (earlier + known[0]):.0f}")


def _stamps_s(path: Path) -> np.ndarray:
    """Times of a video's frames, (frames,) s, increasing; nothing is decoded."""
    about = path.stat()
    ticks, unit_s = _ticks(path, about.st_mtime_ns, about.st_size)
    return ticks * unit_s


@lru_cache(maxsize=8)
def _ticks(path: Path, modified_ns: int, size_bytes: int) -> tuple[np.ndarray, float]:
    """Presentation times of a video's frames in its own unit of time, and that unit in s."""
    with _opened(path) as container:
        stream, ticks = container.streams.video[0], []
        for packet in container.demux(stream):
            if packet.pts is not None and packet.size and not packet.is_discard:
                ticks.append(packet.pts)
                within("rows", len(ticks), f"{path}: frames")
        if not ticks or not stream.time_base:
            raise BadInput(f"{path}: the video holds no frame with a time")
        return np.unique(ticks), float(stream.time_base)


def _decode(path: Path, numbers: Sequence[int]) -> Iterable[np.ndarray]:
    """Yield the wanted frames in one pass from the key frame before the first of them."""
    about = path.stat()
    ticks = _ticks(path, about.st_mtime_ns, about.st_size)[0][list(numbers)].tolist()
    with _opened(path) as container:
        stream = container.streams.video[0]
        container.seek(ticks[0], stream=stream, backward=True)
        wanted = set(ticks)
        for frame in container.decode(stream):
            if frame.pts in wanted:
                yield frame.to_ndarray(format="rgb24")
                wanted.remove(frame.pts)
                if not wanted:
                    return


def from_files(paths: Sequence[Path]) -> Frames:
    """One JPEG or PNG file a timestep."""
    source = str(paths[0].parent) if paths else "no files"

    def count() -> int:
        lacking = [path for path in paths if not path.is_file()]
        if lacking:
            raise BadInput(f"{lacking[0]}: no such image; {len(lacking)} of {len(paths)} are missing")
        return len(paths)

    return Frames(source, count, lambda numbers: (paths[number].read_bytes() for number in numbers))


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
