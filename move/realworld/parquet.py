"""Parquet tables that are not trusted: the footer is judged first, then only the columns asked for are read, in pieces.

A table of a few kilobytes can stand for billions of equal rows, or for one long text many times.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from move.errors import BadInput
from move.untrusted import limits, within

EPISODE = "episode_index"
_MOST_ROWS = 4_096  # read at a time


def read_columns(path: Path, columns: Sequence[str], *, episode: int | None = None) -> pa.Table:
    """Read some columns of a table.

    Args:
        columns: names; those that the table lacks are left out.
        episode: read only the rows whose `episode_index` is this.

    Raises:
        BadInput: beyond the limits of `move.untrusted`, or no table.
    """
    file = _opened(path)
    columns = [name for name in file.schema_arrow.names if name in columns]
    if episode is not None and EPISODE not in file.schema_arrow.names:
        raise BadInput(f"{path}: expected a column {EPISODE!r}; found {file.schema_arrow.names[:12]}")
    wanted = columns if episode is None else [*columns, *({EPISODE} - set(columns))]
    pieces, held = [], 0
    for batch in file.iter_batches(_rows_at_a_time(file), _row_groups(file, episode), wanted):
        if episode is not None:
            batch = batch.filter(pc.equal(batch[EPISODE], episode))
        held = within("memory_bytes", held + batch.nbytes, path)
        pieces.append(batch.select(columns))
    schema = pa.schema([file.schema_arrow.field(name) for name in columns])
    return pa.Table.from_batches(pieces, pieces[0].schema if pieces else schema)


def is_numeric(kind: pa.DataType) -> bool:
    """Whether a column holds numbers, alone or in lists; true and false are none."""
    while isinstance(kind, pa.BaseExtensionType) or pa.types.is_nested(kind):
        if isinstance(kind, pa.BaseExtensionType):
            kind = kind.storage_type
        elif pa.types.is_struct(kind) or pa.types.is_map(kind) or pa.types.is_union(kind):
            return False
        else:
            kind = kind.value_type
    return pa.types.is_integer(kind) or pa.types.is_floating(kind)


def numeric_names(path: Path, needed: Sequence[str] = ()) -> list[str]:
    """Names of the columns that hold numbers, alone or in lists.

    Raises:
        BadInput: a column of `needed` is there and holds something else.
    """
    kinds = {field.name: field.type for field in _opened(path).schema_arrow}
    for name in needed:
        if name in kinds and not is_numeric(kinds[name]):
            raise BadInput(f"{path}: column {name!r}: found {kinds[name]}; expected numbers")
    return [name for name, kind in kinds.items() if is_numeric(kind)]


def _opened(path: Path) -> pq.ParquetFile:
    """Open a table and hold what its footer declares against the limits."""
    with path.open("rb") as file:
        file.seek(max(0, path.stat().st_size - 8))
        length, mark = file.read(4), file.read(4)
    if mark == b"PAR1":
        within("json_bytes", int.from_bytes(length, "little"), f"{path}: its footer")
    table = pq.ParquetFile(path, thrift_container_size_limit=limits().files)
    within("rows", table.metadata.num_rows, path)
    for number in range(table.metadata.num_row_groups):
        group = table.metadata.row_group(number)
        values = sum(group.column(n).num_values for n in range(group.num_columns))
        within("memory_bytes", max(group.total_byte_size, 8 * values), f"{path}: row group {number}")
    return table


def _rows_at_a_time(file: pq.ParquetFile) -> int:
    """So few rows that even if each held the longest text of its column together they stay within the limit."""
    about = file.metadata
    largest = max((about.row_group(g).column(c).total_uncompressed_size for g in range(about.num_row_groups)
                   for c in range(about.num_columns)
                   if about.row_group(g).column(c).physical_type == "BYTE_ARRAY"), default=1)
    return max(1, min(_MOST_ROWS, limits().memory_bytes // (4 * max(largest, 1))))


def _row_groups(file: pq.ParquetFile, episode: int | None) -> list[int]:
    """The row groups that can hold an episode: told by their statistics, where they are kept."""
    about = file.metadata
    place = file.schema_arrow.get_field_index(EPISODE)
    if episode is None or file.schema_arrow.field(place).type != pa.int64():
        return list(range(about.num_row_groups))
    column = next(c for c in range(about.num_columns) if about.schema.column(c).path == EPISODE)
    ranges = [about.row_group(g).column(column).statistics for g in range(about.num_row_groups)]
    return [g for g, known in enumerate(ranges)
            if known is None or not known.has_min_max or known.min <= episode <= known.max]
