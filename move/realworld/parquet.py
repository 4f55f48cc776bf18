"""Parquet tables: only the columns that are asked for are read, and of a shared table only one episode's rows."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from move.errors import BadInput
from move.untrusted import within

EPISODE = "episode_index"
pa.set_memory_pool(pa.system_memory_pool())  # Arrow's own keeps address space that `move.untrusted` would not count


def read_columns(path: Path, columns: Sequence[str], *, episode: int | None = None) -> pa.Table:
    """Read some columns of a table, in the order of the file.

    Args:
        columns: names; those that the table lacks are left out.
        episode: read only the rows whose `episode_index` is this.

    Raises:
        BadInput: more rows than allowed, or no column `episode_index` where one is needed.
    """
    about = pq.read_metadata(path)
    within("rows", about.num_rows, path)
    there = about.schema.to_arrow_schema().names
    if episode is not None and EPISODE not in there:
        raise BadInput(f"{path}: expected a column {EPISODE!r}; found {there[:12]}")
    rows = None if episode is None else [(EPISODE, "==", episode)]
    wanted = [name for name in there if name in columns]
    return pq.read_table(path, columns=wanted, filters=rows, partitioning=None, use_threads=False)


def is_numeric(kind: pa.DataType) -> bool:
    """Whether a column holds numbers, alone or in lists; true and false are none."""
    if isinstance(kind, pa.BaseExtensionType):
        return is_numeric(kind.storage_type)
    if pa.types.is_list(kind) or pa.types.is_large_list(kind) or pa.types.is_fixed_size_list(kind):
        return is_numeric(kind.value_type)
    return pa.types.is_integer(kind) or pa.types.is_floating(kind)


def numeric_names(path: Path, needed: Sequence[str] = ()) -> list[str]:
    """Names of the columns that hold numbers, alone or in lists.

    Raises:
        BadInput: a column of `needed` is there and holds something else.
    """
    kinds = {field.name: field.type for field in pq.read_schema(path)}
    for name in needed:
        if name in kinds and not is_numeric(kinds[name]):
            raise BadInput(f"{path}: column {name!r}: found {kinds[name]}; expected numbers")
    return [name for name, kind in kinds.items() if is_numeric(kind)]
