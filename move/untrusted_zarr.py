"""A zarr group that came from elsewhere: only plain arrays of numbers are read of it.

zarr itself parses the descriptions. Of what they say, an array is refused that is no numbers, or that uses another
codec than those that run no code; what a chunk decodes to is bounded by the memory of `move.untrusted.reading`. zarr's
consolidated metadata, a second description of the same arrays, is not used.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import numcodecs
import zarr
from zarr.codecs import BloscCodec, BytesCodec, ZstdCodec
from zarr.errors import GroupNotFoundError
from zarr.storage import LocalStore, ZipStore

from move.errors import BadInput
from move.untrusted import within

CODECS = (numcodecs.Blosc, numcodecs.Zstd, BloscCodec, ZstdCodec, BytesCodec)
NUMBERS = "biufc"  # numpy's letters: bool, whole numbers, real numbers, complex numbers


@contextmanager
def opened_group(path: Path) -> Iterator[zarr.Group]:
    """Open a group, folder or zip, for reading.

    Raises:
        BadInput: there is none.
    """
    store = ZipStore(path, mode="r") if path.is_file() else LocalStore(path, read_only=True)
    with closing(store):
        try:
            group = zarr.open_group(store, mode="r", use_consolidated=False)
        except GroupNotFoundError:
            raise BadInput("this is no zarr group; docs/how-to/use_your_own_demonstrations.md makes one of other "
                           "layouts") from None
        yield group


def array_names(group: zarr.Group) -> list[str]:
    """Names such as "data/action" of all arrays of a group, sorted."""
    return sorted(name for name, member in group.members(max_depth=None) if isinstance(member, zarr.Array))


def plain_array(group: zarr.Group, name: str) -> zarr.Array:
    """An array of a group, of which nothing has been read yet.

    Raises:
        BadInput: no such array, no numbers, another codec than `CODECS`, or beyond the limits of `move.untrusted`.
    """
    if not isinstance(array := group.get(name), zarr.Array):
        raise BadInput(f"{name} is missing; found {', '.join(array_names(group)[:8]) or 'no array'}")
    if array.dtype.kind not in NUMBERS or not array.ndim:
        raise BadInput(f"{name} is {array.dtype} {array.shape}; allowed: numbers, at least one axis")
    codecs = [*array.filters, *array.compressors, *filter(None, [array.serializer])]
    if other := [type(codec).__name__ for codec in codecs if not isinstance(codec, CODECS)]:
        raise BadInput(f"{name} uses the codecs {', '.join(other)}; allowed are Blosc and Zstd: others can run code")
    within("rows", array.shape[0], name)
    within("files", array.nchunks if array.size else 0, f"{name}: its chunks")
    return array


def missing_chunks(name: str, array: zarr.Array) -> str:
    """Which chunks an array lacks, which zarr would read as zeros; "" where all are there."""
    stored, chunks = array.nchunks_initialized, array.nchunks
    return f"{name} has {stored} of its {chunks} chunks" if stored < chunks else ""
