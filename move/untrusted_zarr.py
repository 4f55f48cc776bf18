"""A zarr group that came from elsewhere: its own description files are read first, and judged, before zarr sees it.

Only plain arrays of numbers are read, with no filter and at most one of the `COMPRESSORS`. Each chunk says in its first
bytes how large it is decoded; one that is larger than the description says is refused, so nothing is decoded that was
not declared. zarr's consolidated metadata, a second description of the same arrays, is not used.
"""

from __future__ import annotations

import math
import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path, PurePosixPath
from typing import Any, Literal

import numpy as np
import zarr
from zarr.storage import LocalStore, ZipStore

from move.errors import BadInput
from move.untrusted import parse_json, plain_files, within

COMPRESSORS = ("blosc", "zstd")
KINDS = "biufc"  # numpy's letters: bool, whole numbers, real numbers, complex numbers
V2, V3 = (".zarray", ".zgroup", ".zattrs"), ("zarr.json",)
_ZSTD = 0xFD2FB528


@dataclass(frozen=True)
class PlainArray:
    """What a description file says of one array."""

    shape: tuple[int, ...]
    chunk_shape: tuple[int, ...]
    dtype: np.dtype
    compressor: str | None

    @property
    def row_bytes(self) -> int:
        """Bytes of one entry of the first axis, decoded."""
        return math.prod(self.shape[1:]) * self.dtype.itemsize

    @property
    def chunk_bytes(self) -> int:
        """Bytes of one chunk, decoded."""
        return math.prod(self.chunk_shape) * self.dtype.itemsize


@dataclass(frozen=True)
class PlainGroup:
    """A zarr group, folder or zip, that was judged and may be opened."""

    path: Path
    zarr_format: Literal[2, 3]
    arrays: Mapping[str, PlainArray]

    @contextmanager
    def opened(self) -> Iterator[zarr.Group]:
        """Open it for reading."""
        zipped = self.path.is_file()
        with closing(ZipStore(self.path, mode="r") if zipped else LocalStore(self.path, read_only=True)) as store:
            yield zarr.open_group(store, mode="r", zarr_format=self.zarr_format, use_consolidated=False)


def judge(path: Path) -> PlainGroup:
    """Read the description of a zarr group, folder or zip, and look at every chunk's first bytes.

    Raises:
        BadInput: no plain group of arrays of numbers, or one beyond the limits of `move.untrusted`.
    """
    if path.is_file():
        with path.open("rb") as file:
            _judge_directory(file, path)
        with zipfile.ZipFile(path) as archive:
            sizes = {item.filename: item.file_size for item in archive.infolist() if not item.is_dir()}
            within("files", len(sizes), path)
            return _judge(path, sizes, archive.read)
    return _judge(path, plain_files(path), lambda name: (path / name).read_bytes())


def _judge_directory(file: Any, path: Path) -> None:
    """Refuse a zip whose own list of names is too long; read by what zipfile itself reads it with."""
    end = zipfile._EndRecData(file)  # type: ignore[attr-defined]
    if end is None:
        raise BadInput(f"cannot read {path}: expected a zip file")
    within("json_bytes", end[5], f"{path}: its list of names")


def _judge(path: Path, sizes: Mapping[str, int], read: Callable[[str], bytes]) -> PlainGroup:
    described = {name: PurePosixPath(name) for name in sizes if PurePosixPath(name).name in V2 + V3}
    formats = {3 if name.name in V3 else 2 for name in described.values()}
    if len(formats) != 1:
        raise BadInput(f"cannot read {path}: expected the description files of zarr format 2 or of 3 (.zgroup or "
                       f"zarr.json); found those of {' and of '.join(map(str, sorted(formats))) or 'neither'}")
    arrays = {}
    for name, place in described.items():
        where = f"{path}: {name}"
        within("json_bytes", sizes[name], where)
        about = parse_json(read(name), where)
        if place.name == ".zarray" or about.get("node_type") == "array":
            arrays[place.parent.as_posix()] = _array(about, where)
    for name in sizes.keys() - described.keys():
        owner = next((folder for folder in map(str, PurePosixPath(name).parents) if folder in arrays), None)
        if owner is not None:
            _judge_chunk(arrays[owner], sizes[name], partial(read, name), f"{path}: {name}")
    return PlainGroup(path, 3 if 3 in formats else 2, arrays)


def _array(about: Mapping[str, Any], where: str) -> PlainArray:
    """One array's description, judged."""
    if "node_type" in about:
        grid = about.get("chunk_grid")
        settings = grid.get("configuration") if isinstance(grid, dict) and grid.get("name") == "regular" else None
        chunk_shape = settings.get("chunk_shape") if isinstance(settings, dict) else None
        compressor = _codecs_v3(about, where)
    else:
        chunk_shape, compressor = about.get("chunks"), _codecs_v2(about, where)
    shape = _numbers(about.get("shape"), 0, f"{where}: shape")
    chunk_shape = _numbers(chunk_shape, 1, f"{where}: chunks")
    if len(shape) != len(chunk_shape) or not shape:
        raise BadInput(f"{where}: shape {shape} in chunks of {chunk_shape}; allowed: one number each for every axis")
    array = PlainArray(shape, chunk_shape, _dtype(about.get("dtype", about.get("data_type")), where), compressor)
    within("rows", shape[0], where)
    within("chunk_bytes", array.chunk_bytes, where)
    within("chunks", math.prod(-(-length // chunk) for length, chunk in zip(shape, chunk_shape, strict=True)), where)
    return array


def _numbers(given: object, lowest: int, where: str) -> tuple[int, ...]:
    if not isinstance(given, list) or not all(type(number) is int and number >= lowest for number in given):
        raise BadInput(f"{where}: {given!r}; allowed: whole numbers from {lowest} on")
    return tuple(given)


def _dtype(name: object, where: str) -> np.dtype:
    try:
        dtype = np.dtype(name) if isinstance(name, str) else None
    except (TypeError, ValueError, SyntaxError):
        dtype = None
    if dtype is None or dtype.kind not in KINDS:
        raise BadInput(f"{where}: data type {name!r}; allowed: numbers")
    return dtype


def _codecs_v2(about: Mapping[str, Any], where: str) -> str | None:
    """The compressor of an array of format 2, whose description is {"filters": null, "compressor": {"id": ...}}."""
    if about.get("filters"):
        raise _refused([_name(each, "id") for each in _listed(about["filters"])], where)
    return None if about.get("compressor") is None else _allowed(_name(about["compressor"], "id"), where)


def _codecs_v3(about: Mapping[str, Any], where: str) -> str | None:
    """The compressor of an array of format 3, whose codecs are "bytes" and at most one more."""
    names = [_name(codec, "name") for codec in _listed(about.get("codecs"))]
    if names[:1] != ["bytes"] or len(names) > 2 or about.get("storage_transformers"):
        raise _refused(names, where)
    return _allowed(names[1], where) if names[1:] else None


def _listed(given: object) -> list:
    return given if isinstance(given, list) else [given]


def _name(codec: object, key: str) -> str:
    return str(codec.get(key) if isinstance(codec, dict) else codec)


def _allowed(name: str, where: str) -> str:
    if name not in COMPRESSORS:
        raise _refused([name], where)
    return name


def _refused(names: list[str], where: str) -> BadInput:
    return BadInput(f"{where} uses the codecs {', '.join(names)}; allowed are plain numbers, as they are or by "
                    f"{' or '.join(COMPRESSORS)} alone: other codecs can run code, or grow without bound")


def _judge_chunk(array: PlainArray, size: int, read: Callable[[], bytes], where: str) -> None:
    """Refuse a chunk that is larger, on disk or decoded, than its array's description says."""
    declared = array.chunk_bytes
    if size > 2 * declared + 4096:
        raise BadInput(f"{where}: {size:,} bytes on disk for a chunk of {declared:,}")
    if array.compressor:
        data = read()
        decoded = blosc_bytes(data) if array.compressor == "blosc" else zstd_bytes(data)
        if decoded is None or decoded > declared:
            shown = "an unknown number of" if decoded is None else f"{decoded:,}"
            raise BadInput(f"{where}: decodes to {shown} bytes; its description says {declared:,}")


def blosc_bytes(data: bytes) -> int | None:
    """Size of blosc data once decoded, told from their header; None where it is not a header of just these data.

    >>> from numcodecs import Blosc
    >>> blosc_bytes(Blosc().encode(bytes(70_000))), blosc_bytes(b"nothing of the kind")
    (70000, None)
    """
    decoded, _, encoded = (int.from_bytes(data[start:start + 4], "little") for start in (4, 8, 12))
    return decoded if encoded == len(data) else None


def zstd_bytes(data: bytes) -> int | None:
    """Size of zstd data once decoded, told from the headers of all frames (RFC 8878); None where they do not tell it.

    >>> from numcodecs import Zstd
    >>> zstd_bytes(Zstd().encode(bytes(70_000))), zstd_bytes(b"nothing of the kind")
    (70000, None)
    """
    total, here = 0, 0
    while here < len(data):
        flags = data[here + 4] if here + 4 < len(data) else 0
        single, content = flags >> 5 & 1, flags >> 6
        width = (single, 2, 4, 8)[content]
        start = here + 5 + (1 - single) + (0, 1, 2, 4)[flags & 3]
        if int.from_bytes(data[here:here + 4], "little") != _ZSTD or not width:
            return None
        total += int.from_bytes(data[start:start + width], "little") + (256 if width == 2 else 0)
        here, last = start + width, False
        while not last and here < len(data):
            header = int.from_bytes(data[here:here + 3], "little")
            here, last = here + 3 + (1 if header >> 1 & 3 == 1 else header >> 3), bool(header & 1)
        here += 4 * (flags >> 2 & 1)
    return total
