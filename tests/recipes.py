"""The profiles' recipes with changes, and a run so small that nothing is learnt."""

from typing import Any

from shared import plan

from move.learn.evaluation import Evaluation
from move.learn.settings import Training
from move.study.profiles import load_profile
from move.study.spec import PolicyRun


def keypoints(observation: str = "keypoints", **changes: Any) -> Training:
    """The laptop profile's recipe with some fields changed, validated anew."""
    return Training(**{**load_profile("laptop").training[observation].model_dump(), **changes})


def image_laptop(**changes: Any) -> Training:
    """The laptop profile's recipe for images."""
    return keypoints("rgb", **changes)


def tiny(gradient_steps: int = 3, **changes: Any) -> Training:
    """A few small steps from keypoints."""
    return keypoints(**{"gradient_steps": gradient_steps, "warmup_steps": 1, "batch_size": 8, **changes})


def tiny_run(seed: int = 0, method: str = "static", observation: str = "keypoints", **changes: Any) -> PolicyRun:
    """100 timesteps, three gradient steps and three episodes of Pick-Place."""
    collection = plan(method=method, timesteps=100, observation=observation)
    return PolicyRun(**{"task": "pick-place", "seed": seed, "collection": collection, "training": tiny(),
                        "evaluation": Evaluation(episodes=3), **changes})
