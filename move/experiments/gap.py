"""Why are rates here not the paper's? The package's protocol with one thing at a time as the authors have it."""

from __future__ import annotations

from functools import partial
from typing import Any

from move.experiments.preliminary import ANYWHERE, COMPARED, TRACED_BACK
from move.experiments.registry import Count, Multiple, Repeats, Seeds, experiment
from move.learn.evaluation import Evaluation
from move.study.kinds import policy_run
from move.study.labels import LabelledRun
from move.study.profiles import Profile

GRASPS = "figure 1"
PACKAGE, LISTED, TOGETHER = "the package's protocol", "their 20 configurations", "all of them together"
CROP = 80 / 128  # of an image's side, as the authors crop
EVERYWHERE: dict[str, dict[str, Any]] = {
    "Meta-World's expert": {"expert": "metaworld"},
    "crop as theirs, 5/8": {"crop_share": CROP},
}
"""Settings that every case has; each is switched alone."""

FAILURES: dict[str, dict[str, Any]] = {"its failures kept too": {"expert": "metaworld", "keep_failures": True}}
"""Only where Meta-World's expert fails at times: on Pick-Place it does not, and the data would be the same."""

AT_GRASPS: dict[str, dict[str, Any]] = {
    "hand anywhere": {"factors": "object+hand", "hand_spread": 0.0},
    "camera and target": {"fixed": "authors"},
    "35 steps traced back": {"object_steps": TRACED_BACK},
}
"""Settings of figure 1 alone."""

DRAWN = {"shadows, sky, reflections": {"drawing": "full"}}
SETTINGS = (PACKAGE, *AT_GRASPS, LISTED, *EVERYWHERE, *FAILURES, *DRAWN, "0.33 times the steps", "3 times the steps",
            "10 times the steps", TOGETHER)
"""All there are, in the order in which they are shown."""


@experiment
def gap(
    profile: Profile, tasks: tuple[str, ...] = ("pick-place", "push"), drawn_tasks: tuple[str, ...] = ("pick-place",),
    failing_tasks: tuple[str, ...] = ("push",), long_tasks: tuple[str, ...] = ("pick-place",), seeds: Repeats = 2,
    episodes: Count = 400, length_episodes: Count = 100, timesteps: Count = 20_000, grasp_timesteps: Count = 7000,
    grasp_seeds: Seeds = 2, grid_side: Count = 12, lengths: tuple[Multiple, ...] = (1 / 3, 3), longest: Multiple = 10,
) -> list[LabelledRun]:
    """Static and MOVE under the package's protocol, under it with one setting of the authors' each, and with all.

    Labels: `case`, figure 1 or a task of table 2, and `setting`. Where a setting is tried on fewer configurations than
    the protocol, they are its first ones.

    Args:
        drawn_tasks: drawn with shadows as well; an image then takes eight times as long.
        failing_tasks: where Meta-World's expert's failures are kept as well.
        long_tasks: trained for `longest` times the recipe's steps as well, one seed.
        length_episodes: configurations tried after other lengths of training.
        grasp_seeds: repetitions of figure 1; its hands start within 3 cm, as in the package's earlier variant.
    """
    runs: list[LabelledRun] = []
    for case in (GRASPS, *tasks) if grasp_seeds else tasks:
        more = {**(FAILURES if case in failing_tasks else {}), **(DRAWN if case in (GRASPS, *drawn_tasks) else {})}
        settings = _settings(case, more, lengths, length_episodes)
        tried = {"timesteps": grasp_timesteps} if case == GRASPS else {"timesteps": timesteps, "episodes": episodes}
        count = grasp_seeds if case == GRASPS else seeds
        chosen = [(name, changes, range(count)) for name, changes in settings.items()]
        if case in long_tasks:
            for_long = {"length": longest, "episodes": length_episodes}
            chosen.append((f"{longest:.2g} times the steps", for_long, range(1)))
        for name, changes, of_seeds in chosen:
            runs += [_run(profile, case, name, method, seed, grid_side, {**tried, **changes})
                     for seed in of_seeds for method in COMPARED]
    return runs


def _settings(
    case: str, more: dict[str, dict[str, Any]], lengths: tuple[float, ...], length_episodes: int
) -> dict[str, dict[str, Any]]:
    """What each setting changes of the protocol of `case`; `more` are those that not every case has."""
    own = AT_GRASPS if case == GRASPS else {LISTED: {}}
    together = {"expert": "metaworld", "keep_failures": True, "crop_share": CROP, "drawing": "full",
                **(ANYWHERE | {"object_steps": TRACED_BACK, "hand_spread": 0.0} if case == GRASPS else {})}
    fewer = {} if case == GRASPS else {"episodes": length_episodes}
    longer = {f"{length:.2g} times the steps": {"length": length, **fewer} for length in lengths}
    return {PACKAGE: {}, **own, **EVERYWHERE, **more, **longer, TOGETHER: together}


def _run(
    profile: Profile, case: str, name: str, method: str, seed: int, grid_side: int, settings: dict[str, Any]
) -> LabelledRun:
    settings = dict(settings)
    if method == "static":
        settings.pop("object_steps", None)
    if share := settings.pop("crop_share", None):
        settings["crop_pixels"] = round(share * profile.image_size)
    base = partial(policy_run, profile, task=case, method=method, seed=seed)
    if case == GRASPS:
        base = partial(base, **{"task": "pick-place", "protocol": "sparse", "points": "sparse", "starts": "grid",
                                "grid_side": grid_side})
        settings = {"factors": "object", "hand_spread": 0.03, **settings}
    run = LabelledRun(base(**settings), {"case": case, "setting": name, "seed": seed, "method": method})
    listed = name == LISTED or (name == TOGETHER and case != GRASPS)
    return run.tried(Evaluation(starts="listed")) if listed else run
