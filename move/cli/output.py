"""What the commands print: a table for people or JSON for machines, bars on standard error, whole paths."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import typer
from pydantic_core import to_jsonable_python
from rich.console import Console
from rich.table import Table
from rich.text import Text

Report = Callable[..., None]
"""Called with what is done, how much there is, and whatever else, which is not shown."""


def show(content: dict[str, Any] | list[dict[str, Any]], as_json: bool, title: str) -> None:
    """Print a record, or a list of records with the same keys, as JSON or as a table."""
    if as_json:
        finite = to_jsonable_python(content, inf_nan_mode="null", fallback=str)
        return typer.echo(json.dumps(finite))
    table = Table(title=title, title_justify="left")
    if isinstance(content, dict):
        content = [{"what": key, "value": value} for key, value in content.items()]
    for name in content[0] if content else ["nothing"]:
        table.add_column(str(name), overflow="fold")
    for record in content:
        table.add_row(*(Text(f"{cell:.4g}" if isinstance(cell, float) else str(cell))
                        for cell in record.values()))
    Console(width=None if sys.stdout.isatty() else 140).print(table)


def show_paths(paths: list[Path]) -> None:
    """Print whole paths, one a line; in a terminal each is a link."""
    console = Console(soft_wrap=True, highlight=False)
    for path in paths:
        console.print(Text(str(path), style=f"link {path.as_uri()}"))


@contextmanager
def progress(label: str) -> Iterator[Report]:
    """A callable (done, total, ...) that draws a bar with the time left on standard error.

    `text=` changes the words next to the bar.
    """
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True, disable=not sys.stderr.isatty()) as bars:
        bar = bars.add_task(label, total=None)
        yield lambda done, total, *rest, text=None: bars.update(bar, completed=done, total=total, description=text)
