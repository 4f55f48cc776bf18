"""A function's own source, so that an equation is shown next to the lines that compute it."""

from __future__ import annotations

import inspect
import textwrap
from typing import Any

from IPython.display import Code


def source(*objects: Any) -> Code:
    """The source of functions, methods or classes as they run, one below the other."""
    parts = [f"# {each.__module__}\n{textwrap.dedent(inspect.getsource(each))}" for each in objects]
    return Code("\n\n".join(parts), language="python")
