"""When does motion pay? Success against the distance to what training saw, and whether motion does more than cover.

The rule is `move.statistics.motion_is_coverage`.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any, NamedTuple

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from move.errors import BadInput
from move.figures.fig1_sparse import PRELIMINARY, grasp_runs
from move.figures.page.captions import INTERVALS, RATES, Words
from move.figures.page.data import Data
from move.figures.page.make import steps
from move.figures.page.parameters import Count, Observation, Repeats, Seeds
from move.figures.plots import distance as plots
from move.figures.plots.panels import empty_panel
from move.figures.plots.style import PAGE_WIDTH, titles
from move.figures.tables import controls, points, rate_table
from move.figures.tables.ranks import RANKS, ranks
from move.paper import PAPER_METHODS, PAPER_TASKS
from move.sim.tasks import TASKS
from move.statistics import distance, intervals, motion_is_coverage
from move.statistics.distance import Curve, HeldOut, Tries
from move.study.axes import budgets
from move.study.kinds import control_run, policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile, load_profile
from move.study.results import Result
from move.study.spec import PolicyRun

SIMULATES = True

TEN = "ten tasks"
NOWHERE = 10.0  # metres or radians: no scene is as large
INCOMPLETE = "not decided yet: runs are missing"
AT_HOME = "hand in one place"  # as of a robot that begins each demonstration at home
NEAR = "hand within 3 cm"
DECIDES = "hand anywhere"  # of figures 1, 3 and 5: as in the paper
ASKED = "window-open"  # of which the paper says most and where least came out
SEEN = {"rgb": "pixels", "keypoints": "keypoints"}
FINDINGS = ["setting", "observation", "finding", "estimate", "low", "high", "limit", "answer", "verdict"]
SCORES = {"distance to what was seen": "predicted", "spread of places": "spread"}
"""Of the data: the rate predicted from the other cells or tasks, and the standard deviation of the object's places."""

RADII = ["setting", "observation", "factor", "radius", "low", "high", "unit", "farthest", "top", "steepness"]


def runs(
    profile: Profile, timesteps: Count = 7000, seeds: Repeats = 3, near_hands: Seeds = 3, identical_starts: Seeds = 3,
    grid_side: Count = 15, earlier_grid_side: Count = 12, tasks: tuple[str, ...] = PAPER_TASKS,
    table_seeds: Seeds = 1, episodes: Count = 100, most_timesteps: Count = 20_000,
    observations: tuple[Observation, ...] = ("rgb", "keypoints"),
) -> list[LabelledRun]:
    """Policies of figures 1, 3 and 5, and of table 2 with its experts; the label `experiment` says which.

    From keypoints with hands anywhere alone.
    """
    found: list[LabelledRun] = []
    for observation in observations:
        hands = {"anywhere": (seeds, grid_side)}
        if observation == "rgb":
            hands |= {"within 3 cm": (near_hands, earlier_grid_side),
                      "one place": (identical_starts, earlier_grid_side)}
        for name, protocol in PRELIMINARY.items():
            for hand, (repeats, side) in hands.items():
                found += [run.labelled(experiment=name) for run in grasp_runs(
                    profile, protocol, observation, hand, repeats, side, timesteps)]
        found += [run.labelled(experiment=TEN) for run in grid(
            partial(policy_run, profile, observation=observation, episodes=episodes), seed=range(table_seeds),
            task=budgets(tasks, most_timesteps), method=PAPER_METHODS)]
    experts = grid(partial(control_run, episodes=episodes), task=tasks, agent=["expert"] * bool(table_seeds))
    return found + [run.labelled(experiment=TEN) for run in experts]


class Tried(NamedTuple):
    """Of one setting what was tried, the curve, and the rates that were predicted without their own cells."""

    tries: Tries
    curve: Curve
    held_out: HeldOut

    @property
    def on_grids(self) -> bool:
        """Whether it is of figures 1, 3 and 5."""
        return self.tries.apart.ndim == 1


def seen(data: Data) -> dict[tuple[str, str], Tried]:
    """Each setting and observation that has both methods in three figures or tasks or more.

    What training saw is collected again without images, in seconds a run; it is kept under build/.
    """
    experts = controls(data.episodes).get("expert", pd.Series(dtype=float))
    parts: dict[tuple[str, str], list[Tries]] = {}
    for result in steps([result for result in data.results if result.spec.training], "collections"):
        parts.setdefault((_setting(result.labels), result.spec.observation), []).append(
            _tries(result, float(experts.get(result.spec.task, 1.0))))
    settings = {key: Tries(**{name: np.concatenate([vars(part)[name] for part in each]) for name in vars(each[0])})
                for key, each in parts.items()}
    return {key: Tried(tries, distance.fit(tries), distance.held_out(tries)) for key, tries in settings.items()
            if len(np.unique(tries.group)) > 2 and {0.0, 1.0} <= set(tries.move)}


def _setting(labels: Mapping[str, Any]) -> str:
    ten = labels["experiment"] == TEN
    return TEN if ten else {"one place": AT_HOME}.get(hand := str(labels["hand"]), f"hand {hand}")


def _tries(result: Result, ceiling: float) -> Tries:
    """A run's episodes, those at the grasp points of its data left out, and how far from its data they were."""
    from move.study.seen import nearest_place, nearest_timesteps

    spec = result.spec
    assert isinstance(spec, PolicyRun)
    rows = [row for row in result.rows if row["group"] != "point"]
    ten, where = result.labels["experiment"] == TEN, result.labels["experiment"]
    apart = (nearest_timesteps if ten else nearest_place)(spec)[[row["trial"] for row in rows]]
    cell = f"{spec.task if ten else where}, {spec.method}"
    run, cells, group, move, ceilings = (np.full(len(rows), label) for label in (
        spec.hash, cell, spec.task if ten else cell, {"static": 0.0, "move": 1.0}.get(spec.method, np.nan), ceiling))
    return Tries(apart, np.array([row["success"] for row in rows]), run, cells, group, move, ceilings)


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """What the rule asks, radii, every cell's rate and what it was predicted to be, MOVE minus static, and bins."""
    findings, radii, cells, leads, ranked = [], [], [], [], []
    missing = {spec for spec, _ in data.missing}
    lacking = {(_setting(run.labels), run.spec.observation) for run in data.runs if run.spec in missing}
    for (setting, observation), found in data.seen.items():
        named = {"setting": setting, "observation": observation}
        asked = (motion_is_coverage.findings_on_grids(found.tries) if found.on_grids else
                 motion_is_coverage.findings_over_tasks(found.tries, found.held_out, found.curve))
        verdict = INCOMPLETE if (setting, observation) in lacking else motion_is_coverage.verdict(asked)
        findings += [{**named, "finding": one.what, "estimate": one.value, "low": one.low, "high": one.high,
                      "limit": one.below, "answer": one.answer, "verdict": verdict} for one in asked]
        radii += [{**named, **row} for row in _radii(found)]
        cells.append(_cells(data, found).assign(**named))
        left_out = cells[-1].index.to_numpy() if found.on_grids else cells[-1]["where"].to_numpy()
        ranked += [{**named, **row} for row in ranks(cells[-1], SCORES, left_out)]
        equal = next(one for one in asked if one.what == motion_is_coverage.EQUAL)
        for compared, (value, low, high) in (("all places", motion_is_coverage.lead(found.tries)),
                                             ("equal distance", (equal.value, equal.low, equal.high))):
            leads.append({**named, "compared": compared, "difference": value, "low": low, "high": high})
    order = ["setting", "observation"]
    whole = pd.concat(cells, ignore_index=True) if cells else pd.DataFrame(columns=[*order, "where", "method", "value"])
    return {"": pd.DataFrame(findings, columns=FINDINGS), "radii": pd.DataFrame(radii, columns=RADII),
            "cells": whole[[*order, *(name for name in whole if name not in order)]],
            "leads": pd.DataFrame(leads, columns=[*order, "compared", "difference", "low", "high"]),
            "ranks": pd.DataFrame(ranked, columns=[*order, *RANKS]),
            "distance": _bins(data.seen.get((DECIDES, "rgb")))}


def _radii(found: Tried) -> list[dict[str, Any]]:
    """A row a factor: its radius, with its interval over runs, or over tasks where those were left out.

    `farthest` is the largest distance that was tried, NaN where there are several factors. A radius beyond `NOWHERE`
    is infinite: no distance in a scene is as large, so the factor decides nothing.
    """
    from move.study.seen import FACTORS

    labels, curve = found.tries.run if found.on_grids else found.tries.group, found.curve
    _, low, high = intervals.jackknife(labels, lambda mask: np.log(distance.fit(found.tries.where(mask)).radii))
    farthest = found.tries.apart.max() if found.on_grids else np.nan
    units = {"object": "m", "target": "m", "hand": "m"}
    radii, low, high = (np.where(np.asarray(ends) > NOWHERE, np.inf, ends) for ends in (
        curve.radii, np.exp(low), np.exp(high)))
    return [{"factor": factor, "radius": radius, "low": low[place], "high": high[place],
             "unit": units.get(factor, "rad"), "farthest": farthest, "top": curve.top, "steepness": curve.steepness}
            for place, (factor, radius) in enumerate(zip(FACTORS, radii, strict=False))]


def _cells(data: Data, found: Tried) -> pd.DataFrame:
    """Rates as in their own figures, what they were predicted to be, and how far away their configurations are.

    `distance` is the median in radii, `beyond` the share of configurations that are farther away than a radius,
    `spread` the standard deviation of the object's places in the data, in metres.
    """
    from move.study.seen import before_grasp

    rows = data.episodes[data.episodes.run.isin(np.unique(found.tries.run)) & (data.episodes.group != "point")]
    rows = rows.assign(where=rows.task if not found.on_grids else rows.experiment)
    rates = rate_table(rows, ["where", "method"], data.noise(rows.observation.iloc[0], grid=found.on_grids))
    names = [f"{where}, {method}" for where, method in zip(rates["where"], rates.method, strict=True)]
    scaled, held = found.curve.scaled(found.tries.apart), found.held_out
    place = {name: number for number, name in enumerate(held.cell)}
    own = [scaled[found.tries.cell == name] for name in names]
    specs = {result.spec.hash: result.spec for result in data.results if isinstance(result.spec, PolicyRun)}
    spread = [np.mean([np.sqrt(before_grasp(specs[run])["object"].var(axis=0).sum())
                       for run in np.unique(found.tries.run[found.tries.cell == name])]) for name in names]
    return rates.assign(spread=spread, predicted=[held.predicted[place[name]] for name in names],
                        without=[held.without[place[name]] for name in names],
                        distance=[np.median(each) for each in own], beyond=[(each > 1).mean() for each in own])


def _bins(found: Tried | None) -> pd.DataFrame:
    """Success from pixels by distance, hands anywhere: one row a method and centimetre with fifty episodes."""
    rows: list[dict[str, Any]] = []
    for method, code in (("static", 0.0), ("move", 1.0)) if found else ():
        assert found is not None
        own = found.tries.where(found.tries.move == code)
        binned = np.floor(100 * own.apart)
        for each in np.unique(binned):
            tries = own.where(binned == each)
            if len(tries.success) >= 50 and len(np.unique(tries.run)) > 1:
                value, low, high = map(float, intervals.jackknife(tries.run, partial(_rate, tries.success)))
                rows.append({"method": method, "distance": 100 * tries.apart.mean(), "value": value,
                             "low": max(low, 0.0), "high": min(high, 1.0), "episodes": len(tries.success)})
    return pd.DataFrame(rows, columns=["method", "distance", "value", "low", "high", "episodes"])


def _rate(success: np.ndarray, mask: np.ndarray) -> float:
    return float(success[mask].mean())


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """Success by distance, cells and tasks predicted without themselves, and MOVE minus static at equal distance."""
    figure, axes = plt.subplots(2, 2, figsize=(PAGE_WIDTH, 5.4))
    cells, leads = tables["cells"], tables["leads"]
    curve = tables["radii"].query("setting == @DECIDES and observation == 'rgb'")
    parts = [tables["distance"], cells[cells.setting == DECIDES], cells[cells.setting == TEN], leads]
    for ax, rows in zip(axes.flat, parts, strict=True):
        if rows.empty:
            empty_panel("missing", ax)
    if len(parts[0]):
        plots.by_distance(parts[0], axes[0, 0])
        (row,) = curve.itertuples()
        plots.fitted(row.top, 100 * row.radius, row.steepness, (100 * row.low, 100 * row.high), axes[0, 0])
    for ax, rows in zip(axes.flat[1:3], parts[1:3], strict=True):
        if len(rows):
            plots.predicted(rows, motion_is_coverage.LARGEST_ERROR, ax)
    if len(leads):
        each = leads[["setting", "observation"]].drop_duplicates()
        plots.leads(leads, [f"{setting},\n{SEEN[seen]}" for setting, seen in each.itertuples(index=False)],
                    motion_is_coverage.SAME, axes[1, 1])
        axes[1, 1].legend(loc="lower right")
    titles(list(axes.flat), ["hand anywhere, from pixels", "figures 1, 3 and 5, each cell from the others",
                             "ten tasks, each from the others", "MOVE minus static"])
    figure.legend(handles=plots.entries(list(dict.fromkeys(cells.method))), ncol=4, loc="outside upper center")
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """The rule's verdicts, MOVE minus static at equal distance, and why motion does not pay on Window-Open."""
    settings = tables[""].drop_duplicates(["setting", "observation"])
    decided = "; ".join(f"{row.setting} {row.verdict}" for row in settings.itertuples()
                        if row.observation == "rgb" and row.setting in (DECIDES, TEN))
    parts = [f"is motion coverage and nothing besides? {decided}.", _lead_text(tables), _asked_text(tables)]
    return (f"**The paper:** motion works because it shows more of space. **Here:** "
            f"{' '.join(filter(None, parts)) if decided else 'nothing is computed yet.'} "
            f"**How sure:** {data.sample_size}")


def _lead_text(tables: dict[str, pd.DataFrame]) -> str:
    """MOVE minus static at equal distance where it decides, in points."""
    rows = tables["leads"].query("compared == 'equal distance' and setting == @DECIDES and observation == 'rgb'")
    return "".join(f"At equal distance MOVE minus static is {points(row.difference)} [{points(row.low)}, "
                   f"{points(row.high)}] points." for row in rows.itertuples())


def _asked_text(tables: dict[str, pd.DataFrame]) -> str:
    """What distance predicts of MOVE's gain on Window-Open, and what it is."""
    cells = tables["cells"]
    own = cells[(cells["where"] == ASKED) & (cells.observation == "rgb")].set_index("method")
    if not {"static", "move"} <= set(own.index):
        return ""
    gain, expected = (own[name].move - own[name].static for name in ("value", "predicted"))
    return (f"On {TASKS[ASKED].title} distance predicts a gain of {points(expected)}; MOVE gains {points(gain)}.")


def measured(setting: str) -> list[Curve]:
    """Success against distance from pixels in one of the settings of figures 1, 3 and 5, as shipped.

    Returns:
        The curve, then the curves with the ends of its radius' interval.

    Raises:
        BadInput: the shipped table of radii is not there, or has no such row.
    """
    path = load_profile("laptop").figures / "radius_radii.csv"
    try:
        rows = pd.read_csv(path).query("setting == @setting and observation == 'rgb'")
        (row,) = rows.itertuples()
    except (OSError, ValueError) as error:
        raise BadInput(f"{path} has no row of {setting!r}; make radius writes it") from error
    return [Curve(row.top, (radius,), row.steepness) for radius in (row.radius, row.low, row.high)]


WORDS = Words(
    title="When does motion pay? Success against the distance to what training saw",
    shown=(
        "(a) Success by the distance from the place tried to the nearest place that training saw, Pick-Place from "
        "pixels, one curve for both methods; the dashed line and its band are the radius, at which half is left, and "
        "its interval. (b) Rates of figures 1, 3 and 5 and (c) of ten tasks over what was predicted from the others "
        "alone, triangles MOVE, hollow marks from keypoints; the grey band is 8 points on each side. (d) MOVE "
        f"minus static over all places (crosses) and at equal distance (diamonds). {INTERVALS}"),
    alt="A falling curve through points, two scatter plots around a diagonal, and differences with intervals.",
    tables={
        "": "What the rule asks: each number with its 95 % interval, its limit, and whether it is kept.",
        "radii": "The distance at which half of the success is left, by factor, in metres or radians.",
        "cells": f"Rates, and what they were predicted to be without themselves. {RATES}",
        "leads": "MOVE minus static in points, over all places and at equal distance, with 95 % intervals.",
        "ranks": (
            "Spearman's correlation of two scores of the data with measured success: the success that distance "
            "predicts without the cell or task itself, and the standard deviation of the object's places."),
        "distance": "Success from pixels by distance in centimetres to the nearest place seen, hands anywhere.",
    },
)
