"""How much a rate varies from training to training, for cells that have too few seeds of their own to say."""

from __future__ import annotations

from move.experiments.controls import table_keypoint_control
from move.experiments.main import table2_main
from move.paths import results
from move.statistics.cells import training_noise
from move.statistics.estimates import UNKNOWN, TrainingNoise
from move.study.profiles import Profile
from move.study.results import split, table


def known_noise(profile: Profile, observation: str) -> TrainingNoise:
    """How much a rate varies from training to training, from the profile's stored runs with everything random.

    For a cell that has fewer than three seeds itself: from pixels all seeds of table 2 that are stored, from keypoints
    those of its control at the smaller budget. Nothing is known where no cell has two, or without such a recipe.
    """
    if observation not in profile.training:
        return UNKNOWN
    runs = table2_main(profile, seeds=3, control_seeds=0) if observation == "rgb" else table_keypoint_control(profile)
    episodes = table(split([run.spec for run in runs if run.spec.training], results(profile))[0])
    return training_noise(episodes, ["task", "method", "timesteps"]) if len(episodes) else UNKNOWN
