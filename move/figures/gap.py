"""Why are rates here not the paper's? The package's protocol with one thing at a time as the authors have it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Annotated, Any

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from pydantic import Field

from move import paper
from move.figures import plots
from move.figures.fig1_sparse import ANYWHERE, COMPARED, TRACED_BACK
from move.figures.page.captions import DIFFERENCES, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Multiple, Repeats, Seeds
from move.figures.page.printed import readable
from move.figures.plots import style
from move.figures.plots.axes import errors, lines_axis, per_cent
from move.figures.plots.panels import empty_panel
from move.figures.plots.style import COLOURS, GREY, PAGE_WIDTH, titles
from move.figures.tables import points
from move.figures.tables.differences import difference_table
from move.learn.evaluation import Evaluation
from move.sim.tasks import TASKS
from move.sim.tasks.listed import COUNT
from move.statistics.cells import successes, training_noise
from move.statistics.estimates import Estimate, difference, success_rate, unpaired_difference
from move.statistics.training_noise import TrainingNoise
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
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

Listed = Annotated[int, Field(gt=0, le=COUNT, strict=True)]
DRAWN = {"shadows, sky, reflections": {"drawing": "full"}}
LENGTH = " times the steps"
SETTINGS = (PACKAGE, *AT_GRASPS, LISTED, *EVERYWHERE, *FAILURES, *DRAWN,
            *(f"{times}{LENGTH}" for times in ("0.33", "3", "10")), TOGETHER)
"""All there are, in the order in which they are shown. Lengths of training are no step to the paper: the authors train
longer than any, and `TOGETHER` has the recipe's."""

INTERACTION, UNEXPLAINED, PAPER = "more together than alone", "not explained", "the paper"
RATE_COLUMNS = ["case", "method", "setting", "value", "low", "high", "seeds", "episodes", "trainings", "effect",
                "effect_low", "effect_high"]


def runs(
    profile: Profile, tasks: tuple[str, ...] = ("pick-place", "push"), drawn_tasks: tuple[str, ...] = ("pick-place",),
    failing_tasks: tuple[str, ...] = ("push",), long_tasks: tuple[str, ...] = ("pick-place",), seeds: Repeats = 2,
    episodes: Count = 400, length_episodes: Count = 100, listed: Listed = COUNT, timesteps: Count = 20_000,
    grasp_timesteps: Count = 7000, grasp_seeds: Seeds = 2, grid_side: Count = 12,
    lengths: tuple[Multiple, ...] = (1 / 3, 3), longest: Multiple = 10,
) -> list[LabelledRun]:
    """Static and MOVE under the package's protocol, under it with one setting of the authors' each, and with all.

    Labels: `case`, figure 1 or a task of table 2, and `setting`. Where a setting is tried on fewer configurations than
    the protocol, they are its first ones.

    Args:
        drawn_tasks: drawn with shadows as well; an image then takes ten times as long.
        failing_tasks: where Meta-World's expert's failures are kept as well.
        long_tasks: trained for `longest` times the recipe's steps as well, one seed.
        length_episodes: configurations tried after other lengths of training.
        listed: how many of the authors' 20 configurations are tried.
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
            chosen.append((f"{longest:.2g}{LENGTH}", for_long, range(1)))
        for name, changes, of_seeds in chosen:
            for seed in of_seeds:
                for method in COMPARED:
                    runs += _run(profile, case, name, method, seed, grid_side, listed, {**tried, **changes})
    return runs


def _settings(
    case: str, more: dict[str, dict[str, Any]], lengths: tuple[float, ...], length_episodes: int
) -> dict[str, dict[str, Any]]:
    """What each setting changes of the protocol of `case`; `more` are those that not every case has."""
    own = AT_GRASPS if case == GRASPS else {LISTED: {}}
    together = {"expert": "metaworld", "keep_failures": True, "crop_share": CROP, "drawing": "full",
                **(ANYWHERE | {"object_steps": TRACED_BACK, "hand_spread": 0.0} if case == GRASPS else {})}
    fewer = {} if case == GRASPS else {"episodes": length_episodes}
    longer = {f"{length:.2g}{LENGTH}": {"length": length, **fewer} for length in lengths}
    return {PACKAGE: {}, **own, **EVERYWHERE, **more, **longer, TOGETHER: together}


def _run(
    profile: Profile, case: str, name: str, method: str, seed: int, grid_side: int, listed: int,
    settings: dict[str, Any],
) -> list[LabelledRun]:
    """The run, or none of a profile without a recipe for images."""
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
    runs = grid(partial(base, **settings), case={case: {}}, setting={name: {}}, seed={seed: {}}, method={method: {}})
    if name != LISTED and (name != TOGETHER or case == GRASPS):
        return runs
    tried = Evaluation(starts="listed") if listed == COUNT else Evaluation(starts="listed", episodes=listed)
    return [run.tried(tried) for run in runs]


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """Success under each setting and what switching it does, the steps to the paper, and MOVE's lead."""
    tried = data.episodes[data.episodes.group != "point"]
    theirs, noises = published_rates(tried), {case: data.noise(grid=case == GRASPS) for case in tried.case.unique()}
    rates = gap_table(tried, noises).merge(theirs, on=["case", "method"])
    return {"": rates, "steps": waterfall(rates), "leads": lead_table(tried, theirs, noises)}


def gap_table(episodes: pd.DataFrame, noises: Mapping[str, TrainingNoise]) -> pd.DataFrame:
    """One row a case, method and setting: success under it, and what switching it alone does to success.

    `effect` is the rate under the setting minus that under the package's protocol, paired at the configurations that
    both were tried on; a setting that changes the configurations themselves is compared unpaired.

    Args:
        episodes: as `move.study.results.table` gives them, with the labels `case` and `setting`; no training points.
        noises: how much trainings vary, by case; unknown where the profile's runs do not say.
    """
    rows: list[dict] = []
    for (case, method), group in episodes.groupby(["case", "method"], sort=False):
        noise = training_noise(episodes, ["case", "setting", "method"], noises[case])
        cells = {name: successes(part) for name, part in group.groupby("setting", sort=False)}
        for name in sorted(cells, key=_order):
            rate = success_rate(cells[name], noise)
            rows.append({"case": case, "method": method, "setting": name, "value": rate.value, "low": rate.low,
                         "high": rate.high, "seeds": cells[name].mean(axis=1).round(4).tolist(),
                         "episodes": rate.episodes, "trainings": rate.trainings, **_effect(cells, name, noise)})
    return pd.DataFrame(rows, columns=RATE_COLUMNS)


def _order(setting: str) -> tuple[bool, int]:
    """Where a setting is shown: as `SETTINGS` lists them, other lengths of training after them, all together last."""
    return setting == TOGETHER, SETTINGS.index(setting) if setting in SETTINGS else len(SETTINGS)


def _effect(cells: dict[str, np.ndarray], name: str, noise: TrainingNoise) -> dict[str, float]:
    if name == PACKAGE or PACKAGE not in cells:
        return {}
    found = _compared(cells[name], cells[PACKAGE], name in (LISTED, TOGETHER), noise)
    return {"effect": found.value, "effect_low": found.low, "effect_high": found.high}


def _compared(one: np.ndarray, other: np.ndarray, elsewhere: bool, noise: TrainingNoise) -> Estimate:
    """`one` minus `other`, at the first configurations where one was tried on fewer; 0 where they are the same."""
    if np.array_equal(one, other):
        return Estimate(0.0, 0.0, 0.0, len(one), one.size, "none")
    if elsewhere:
        return unpaired_difference(one, other, noise)
    return difference(one, other[:, : one.shape[1]], noise)


def published_rates(episodes: pd.DataFrame) -> pd.DataFrame:
    """The paper's rates of the cases and methods in `episodes`: case, method, paper."""
    grasps, tasks = paper.published("fig1_sparse").assign(case=GRASPS), paper.published("table2_main")
    rows = pd.concat([grasps, tasks.assign(case=tasks.task)])
    return rows[rows.case.isin(episodes.case)][["case", "method", "value"]].rename(columns={"value": "paper"})


def waterfall(table: pd.DataFrame) -> pd.DataFrame:
    """Steps from the rate here to the paper's, one row a case, method and step: where it starts, how far it goes.

    The effects of the settings alone, then what all of them together do more than their sum, then what is not
    explained: the paper's rate minus that under all of them. After them lengths of training, each from the rate here.
    Columns case, method, step, start, change, low, high (of the change; NaN where no interval is known). A case without
    the package's protocol or without all of them together has what there is of it.

    Args:
        table: as `gap_table` gives it, with the paper's rate in `paper`.
    """
    rows: list[dict] = []
    for (case, method), group in table.groupby(["case", "method"], sort=False):
        by_setting, theirs = group.set_index("setting"), group.paper.iloc[0]
        if PACKAGE not in by_setting.index:
            continue
        level = first = by_setting.value[PACKAGE]
        alone = by_setting.drop(index=[PACKAGE, TOGETHER], errors="ignore")
        lengths = alone.index.str.endswith(LENGTH)
        for name, row in alone[~lengths].iterrows():
            rows.append({"case": case, "method": method, "step": name, "start": level, "change": row.effect,
                         "low": row.effect_low, "high": row.effect_high})
            level += row.effect
        if TOGETHER in by_setting.index:
            together = by_setting.loc[TOGETHER]
            rows.append({"case": case, "method": method, "step": INTERACTION, "start": level,
                         "change": together.value - level})
            rest = theirs - together.value
            rows.append({"case": case, "method": method, "step": UNEXPLAINED, "start": together.value, "change": rest,
                         "low": theirs - together.high, "high": theirs - together.low})
        rows += [{"case": case, "method": method, "step": name, "start": first, "change": row.effect,
                  "low": row.effect_low, "high": row.effect_high} for name, row in alone[lengths].iterrows()]
    return pd.DataFrame(rows, columns=["case", "method", "step", "start", "change", "low", "high"])


def lead_table(
    episodes: pd.DataFrame, theirs: pd.DataFrame, noises: Mapping[str, TrainingNoise]
) -> pd.DataFrame:
    """MOVE minus static under each setting, paired: the columns of `difference_table`, with case, and paper's in paper.

    Args:
        theirs: as `published_rates` gives them.
        noises: as in `gap_table`.
    """
    published = theirs.pivot(index="case", columns="method", values="paper")
    parts = [difference_table(group, "setting", noises[case]).assign(
        case=case, paper=published.move[case] - published.static[case])
        for case, group in episodes.groupby("case", sort=False)]
    return pd.concat(parts, ignore_index=True)


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """One row a case: static from the rate here to the paper's, step by step, and MOVE's lead under each setting."""
    steps, rates, leads = tables["steps"], tables[""], tables["leads"]
    cases = list(dict.fromkeys(run.labels["case"] for run in data.runs))
    size = PAGE_WIDTH, 0.4 + 2.3 * len(cases)
    figure, axes = plt.subplots(len(cases), 2, figsize=size, squeeze=False, sharey="row", width_ratios=[1.3, 1])
    for row, case in zip(axes, cases, strict=True):
        static = rates[(rates.case == case) & (rates.method == "static")].set_index("setting")
        if PACKAGE not in static.index:
            for ax in row:
                empty_panel("missing", ax)
            continue
        own = steps[(steps.case == case) & (steps.method == "static")].set_index("step")
        lengths = [name for name in own.index if name.endswith(LENGTH)]
        lines = [PACKAGE, *(name for name in own.index if name not in (UNEXPLAINED, *lengths)),
                 *([TOGETHER, UNEXPLAINED] if UNEXPLAINED in own.index else []), PAPER, *lengths]
        _waterfall(own, static, lines, row[0])
        _leads(leads[leads.case == case].set_index("setting"), lines, row[1])
    names = [case if case not in TASKS else TASKS[case].title for case in cases]
    titles(list(axes.ravel()), [text for name in names for text in (f"{name}: static", f"{name}: MOVE minus static")])
    return figure


def _waterfall(steps: pd.DataFrame, rates: pd.DataFrame, lines: Sequence[str], ax: Axes) -> None:
    """From the rate here to the paper's: levels as whole bars, steps as hanging ones with their length's interval."""
    levels = {PACKAGE: rates.value.get(PACKAGE), TOGETHER: rates.value.get(TOGETHER), PAPER: rates.paper.iloc[0]}
    for place, name in enumerate(lines):
        if name in levels:
            ax.barh(place, levels[name], color=COLOURS["static"], alpha=0.85 if name != PAPER else 0.4, height=0.7)
        elif not np.isnan(steps.change[name]):
            row = steps.loc[name]
            strength = 0.5 if name == INTERACTION else 0.9
            ax.barh(place, row.change, left=row.start, color=GREY, alpha=strength, height=0.7)
            if not np.isnan(row.low):
                ax.errorbar(row.start + row.change, place, xerr=errors(row, "change"), color="black", capsize=2,
                            lw=0.9)
    lines_axis(lines, ax)
    ax.set_xlabel("success (%)")
    ax.xaxis.set_major_formatter(per_cent)


def _leads(leads: pd.DataFrame, lines: Sequence[str], ax: Axes) -> None:
    """MOVE minus static under each setting, a point with its interval a line; the paper's as a diamond."""
    colour, marker = style.DIFFERENCES["static"]
    for place, name in enumerate(lines):
        if name in leads.index:
            row = leads.loc[name]
            ax.errorbar(row.difference, place, xerr=errors(row, "difference"), fmt=marker, color=colour, ms=4,
                        capsize=2, lw=0.9)
    if len(leads):
        ax.plot(leads.paper.iloc[0], lines.index(PAPER), "D", color="black", mfc="white", ms=4.5)
    plots.points_axis(ax, "points")
    ax.tick_params(labelleft=False)


def printed(tables: dict[str, pd.DataFrame], data: Data) -> dict[str, pd.DataFrame]:
    """Case by case the largest single step of static towards the paper."""
    rows, steps = [], tables["steps"]
    for case, group in steps[steps.method == "static"].groupby("case", sort=False):
        steps_alone = ~(group.step.isin([INTERACTION, UNEXPLAINED]) | group.step.str.endswith(LENGTH))
        known = group[steps_alone].dropna(subset="change")
        if len(known):
            row = known.loc[known.change.idxmin()]
            rows.append({"case": case, "Largest single step of static": row.step,
                         "Change (points)": f"{points(row.change)} [{points(row.low)}, {points(row.high)}]"})
    return {"largest": readable(pd.DataFrame(rows))}


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """What the settings explain of static's distance to the paper, case by case."""
    said = []
    for case, group in tables[""][tables[""].method == "static"].groupby("case", sort=False):
        level, theirs = group.set_index("setting").value, group.paper.iloc[0]
        if PACKAGE not in level:
            said.append(f"{case}: {PACKAGE} not computed yet")
            continue
        left = f", with all settings {level[TOGETHER]:.0%}" if TOGETHER in level else ""
        said.append(f"{case}: static {level[PACKAGE]:.0%} here{left}, {theirs:.0%} in the paper")
    return f"**Here:** {'; '.join(said) or 'static is not computed yet'}. **How sure:** {data.sample_size}"


WORDS = Words(
    title="Why rates here are not the paper's, setting by setting",
    shown=(
        "Left: static's success from the package's protocol (figure 1's is its earlier one: hand within 3 cm) to the "
        "paper's value. Grey bars are what one setting of the authors' does when it alone is switched; the light one "
        "is what all of them together do more than their sum; what is left is not explained. Below the paper, bars "
        "from the rate here: lengths of training, which are no step to the authors', who train longer. Right: MOVE "
        "minus static under each setting; the diamond is the paper's. Error bars are 95 % intervals that include how "
        "trainings and configurations differ."),
    alt="One row a case: a waterfall of bars from a high rate to a low one, and points with intervals.",
    tables={
        "": f"Success under each setting, and what switching it alone does, in points. {RATES}",
        "steps": "The steps from the package's rate to the paper's, each with the interval of its length.",
        "leads": f"MOVE minus static under each setting. {DIFFERENCES}",
    },
)
