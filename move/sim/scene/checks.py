"""What a scene is asked for, checked; each refusal is one line that says what was given and what is allowed."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from move.errors import BadInput, one_of
from move.sim.configuration import SpatialConfiguration
from move.sim.tasks import FACTORS

LARGEST_PICTURE = 4096  # pixels along a side
OPTIONS = ("configuration", "factors")  # of a reset


def picture_side(pixels: int) -> int:
    """A number of pixels along the side of an image; BadInput for what is no size."""
    if isinstance(pixels, int | np.integer) and not isinstance(pixels, bool) and 1 <= pixels <= LARGEST_PICTURE:
        return int(pixels)
    raise BadInput(f"image_size: {pixels!r} given; allowed are whole numbers from 1 to {LARGEST_PICTURE}")


def reset_options(options: dict[str, Any] | None) -> dict[str, Any]:
    """The options of a reset: a configuration, or which factors are random, or nothing; BadInput for anything else."""
    options = options or {}
    for name in options:
        one_of("options", name, OPTIONS)
    one_of("options: factors", options.get("factors"), (None, *FACTORS))
    configuration = options.get("configuration")
    if not isinstance(configuration, SpatialConfiguration | None):
        raise BadInput(f"options: configuration {configuration!r} given; allowed is a SpatialConfiguration")
    return options


def action_numbers(action: np.ndarray, size: int) -> list[float]:
    """The numbers of an action, as given; BadInput for other than `size` finite numbers in a row."""
    try:
        numbers = np.asarray(action, float).tolist()
        if len(numbers) == size and math.isfinite(sum(numbers)):
            return numbers
    except (TypeError, ValueError):  # no numbers, or not in a row
        pass
    raise BadInput(f"action: {' '.join(str(action).split()):.80} given; allowed are {size} finite numbers")
