"""What every notebook does around its picture: gather the runs, say where the numbers come from, write the files."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace

import pandas as pd
from matplotlib.figure import Figure

from move import paths
from move.errors import BadInput
from move.report import style
from move.study.cells import training_noise
from move.study.execute import execute
from move.study.experiments import table2_main, table_keypoint_control
from move.study.labels import LabelledRun
from move.study.profiles import Profile
from move.study.results import Result, missing_in_words, split, table
from move.study.spec import RunSpec
from move.study.statistics import UNKNOWN, TrainingNoise


@dataclass(frozen=True)
class Gathered:
    """The runs of one figure: what is stored, as results and as episodes, and what is missing."""

    profile: Profile
    results: list[Result]
    episodes: pd.DataFrame
    missing: list[tuple[RunSpec, str]]

    @property
    def source(self) -> str:
        """One line on observation, budget, seeds, missing runs and the profile's purpose."""
        trained = [result.spec for result in self.results if result.spec.training]
        seen = sorted({f"{spec.observation} {spec.collection.image_size} px" if spec.observation == "rgb"
                       else spec.observation for spec in trained})
        budgets = sorted({spec.collection.timesteps for spec in trained})
        seeds = len({result.spec.seed for result in self.results})
        seconds = {(part, result.spec.policy_hash if part == "train" else result.spec.hash): spent
                   for result in self.results for part, spent in result.seconds.items()}  # runs may share a training
        minutes = sum(seconds.values()) / 60
        parts = [", ".join(seen), ", ".join(f"{budget:,}" for budget in budgets) + " timesteps"] if trained else []
        parts += [f"{seeds} seed{'s' * (seeds != 1)}",
                  f"{len(self.results)} runs, {minutes:.0f} minutes in all, one core each"]
        parts += [f"{len(self.missing)} RUNS MISSING: {missing_in_words(self.missing)}"] if self.missing else []
        return "; ".join(parts) + f". {self.profile.purpose}"


def gather(runs: list[LabelledRun], profile: Profile) -> Gathered:
    """Compute what is missing of `runs`, unless MOVE_STORED_ONLY is set, and return all there is, with its labels.

    Raises:
        BadInput: there is nothing at all to draw; the message says why.
    """
    if not runs:
        raise BadInput(f"profile {profile.name}: has no runs of this figure; allowed is another profile")
    style.use_style()
    stored_only = os.environ.get("MOVE_STORED_ONLY") == "1"
    there, missing = (split if stored_only else execute)([run.spec for run in runs], paths.results(profile))
    if not there:
        raise BadInput(f"none of the {len(runs)} runs of this figure is stored; the first one: {missing[0][1]}")
    stored = {result.spec.hash: result for result in there}
    results = [replace(stored[run.spec.hash], labels=run.labels) for run in runs if run.spec.hash in stored]
    return Gathered(profile, results, table(results), missing)


def known_noise(profile: Profile, observation: str) -> TrainingNoise:
    """How much a rate varies from training to training, from the profile's stored runs with everything random.

    For a cell that has fewer than three seeds itself: from pixels all seeds of table 2 that are stored, from keypoints
    those of its control at the smaller budget. Nothing is known where no cell has two, or without such a recipe.
    """
    if observation not in profile.training:
        return UNKNOWN
    runs = table2_main(profile, seeds=3, control_seeds=0) if observation == "rgb" else table_keypoint_control(profile)
    episodes = table(split([run.spec for run in runs if run.spec.training], paths.results(profile))[0])
    return training_noise(episodes, ["task", "method", "timesteps"]) if len(episodes) else UNKNOWN


def publish(name: str, figure: Figure | None, tables: dict[str, pd.DataFrame], gathered: Gathered) -> None:
    """Write the figure (PDF, PNG) and the tables (CSV, LaTeX) of a notebook."""
    publish_alone(name, figure, tables, gathered.profile, gathered.source)


def publish_alone(
    name: str, figure: Figure | None, tables: dict[str, pd.DataFrame], profile: Profile, source: str = ""
) -> None:
    """`publish` for a notebook that needs no runs; `source` is the small print under the figure."""
    write(name, figure, tables, profile, source)


def write(name: str, figure: Figure | None, tables: dict[str, pd.DataFrame], profile: Profile, source: str) -> None:
    """Write one figure and its tables into the profile's folder; for notebooks with several of them.

    Args:
        tables: suffix of the file's name ("" for none) -> table.
        source: where the numbers come from, one line under the figure.
    """
    folder = paths.figures(profile)
    if figure is not None:
        style.footnote(figure, source)
        if profile.stamp:
            style.stamp(figure, profile.stamp, "red", 80)
        style.save(figure, name, folder)
    for suffix, content in tables.items():
        style.save_table(content, name if suffix == "" else f"{name}_{suffix}", folder)
