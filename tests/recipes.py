"""The profiles' recipes with changes, for tests that need a smaller one."""

from typing import Any

from move.learn.settings import Training
from move.study.profiles import load_profile


def recipe(profile: str, observation: str, **changes: Any) -> Training:
    """A profile's recipe with some fields changed, validated anew."""
    return Training(**{**load_profile(profile).training[observation].model_dump(), **changes})


def keypoints(**changes: Any) -> Training:
    """The laptop profile's recipe for keypoints."""
    return recipe("laptop", "keypoints", **changes)


def image_laptop(**changes: Any) -> Training:
    """The laptop profile's recipe for images."""
    return recipe("laptop", "rgb", **changes)


def paper(**changes: Any) -> Training:
    """The paper's recipe for images."""
    return recipe("paper", "rgb", **changes)
