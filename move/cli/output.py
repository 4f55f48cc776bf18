"""What the commands print: a table for people or JSON for machines, bars on standard error, whole paths."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

Report = Callable[..., None]
"""Called with what is done, how much there is, and whatever else, which is not shown."""


def show(content: dict[str, Any] | list[dict[str, Any]], as_json: bool, title: str) -> None:
    """Print a record, or a list of records with the same keys, as JSON or as a table."""
    if as_json:
        return typer.echo(json.dumps(_without_nan(content), default=str))
    table = Table(title=title, title_justify="left")
    if isinstance(content, dict):
        content = [{"what": key, "value": value} for key, value in content.items()]
    for name in content[0] if content else ["nothing"]:
        table.add_column(str(name), overflow="fold")
    for record in content:
        table.add_row(*(Text(_shown(value)) for value in record.values()))
    Console(width=None if sys.stdout.isatty() else 140).print(table)


def _without_nan(value: Any) -> Any:
    """The same with null for what is no finite number, for which JSON has no word."""
    if isinstance(value, dict):
        return {key: _without_nan(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [_without_nan(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _shown(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


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
