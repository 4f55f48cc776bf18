"""What a claim is about, as findings: each function takes the evidence, a quantity of `claims.yaml` and an experiment.

`QUANTITIES`, at the end, has them by the names that the file gives them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
import pandas as pd

from move import paper
from move.claims import collected
from move.claims.claims import FILE, Claim, Quantity, Where
from move.claims.evidence import Evidence, chosen, over_seeds, runs_of
from move.errors import BadInput
from move.figures.page.parameters import with_runs
from move.realworld.trials import compare
from move.sim.tasks import TASKS, get_task
from move.statistics.cells import by_budget, successes
from move.statistics.data_efficiency import Efficiency, data_efficiency
from move.statistics.estimates import (
    Estimate,
    contrast,
    difference,
    mean_difference,
    of_configurations,
    relative_gain,
    success_rate,
    unpaired_difference,
)
from move.statistics.intervals import CONFIDENCE
from move.statistics.needed import Trials
from move.statistics.training_noise import as_cell
from move.statistics.verdicts import NAN, Contradiction, Finding, Item, Missing, Untested


def findings(claim: Claim, evidence: Evidence) -> list[Item]:
    """Everything that a claim is decided by.

    Raises:
        BadInput: it names a quantity or a column that is not there.
    """
    items: list[Item] = []
    for each in claim.findings:
        experiment = each.experiment or claim.figure
        if each.quantity not in QUANTITIES:
            raise BadInput(f"{FILE.name}: claim {claim.number}, quantity: {each.quantity!r} given; allowed are "
                           f"{', '.join(QUANTITIES)}")
        named = {*each.where, *each.one, *each.other, *each.each}
        there = evidence.columns(experiment) if named and experiment in with_runs() else set()
        if there and (unknown := sorted(named - there)):
            raise BadInput(f"{FILE.name}: claim {claim.number}, column {unknown[0]!r} of {experiment} given; allowed "
                           f"are {', '.join(sorted(there))}")
        items += QUANTITIES[each.quantity](evidence, each, experiment)
    return items


def rates(evidence: Evidence, each: Quantity, experiment: str, failing: bool) -> list[Item]:
    """Success rates, or shares of episodes that fail."""
    items: list[Item] = []
    for place, where in enumerate(each.repetitions):
        what, rows = each.named(where), evidence.rows(experiment, each.where, each.one, where)
        asked = {**each.where, **each.one, **where}
        if _lacks(evidence, each, experiment, rows, asked):
            items.append(evidence.missing(what, experiment, asked))
            continue
        cells = 1 - successes(rows) if failing else successes(rows)
        found = success_rate(cells, evidence.noise(experiment))
        item = evidence.finding(what, found, rows, each, **each.paper.of_one(place))
        fixed = float(of_configurations([as_cell(cells)], [1.0]).half_width)
        items.append(evidence.with_seeds(item, experiment, rows, fixed))
    return items


def _lacks(evidence: Evidence, each: Quantity, experiment: str, rows: pd.DataFrame, asked: Where) -> bool:
    """Whether none of the runs that are asked for is stored; with the option `whole`, whether one is not."""
    return rows.empty or bool(each.options.get("whole")
                              and not chosen(evidence.asked(experiment), asked).stored.all())


def _sides(
    evidence: Evidence, each: Quantity, experiment: str, where: Where
) -> tuple[pd.DataFrame, pd.DataFrame] | Missing:
    """The episodes of both sides, or which of their runs are missing."""
    sides = [{**each.where, **where, **side} for side in (each.one, each.other)]
    one, other = (evidence.rows(experiment, side) for side in sides)
    lacking = [side for side, rows in zip(sides, (one, other), strict=True)
               if _lacks(evidence, each, experiment, rows, side)]
    return evidence.missing(each.named(where), experiment, *lacking) if lacking else (one, other)


def differences(evidence: Evidence, each: Quantity, experiment: str) -> list[Item]:
    """Differences of rates, paired by configuration unless the option `paired` is false."""
    estimate = difference if each.options.get("paired", True) else unpaired_difference
    items: list[Item] = []
    for place, where in enumerate(each.repetitions):
        sides = _sides(evidence, each, experiment, where)
        if isinstance(sides, Missing):
            items.append(sides)
            continue
        one, other = sides
        found = estimate(successes(one), successes(other), evidence.noise(experiment))
        item = evidence.finding(each.named(where), found, pd.concat(sides), each,
                                room=1 - float(other.success.mean()), **each.paper.of_one(place))
        items.append(evidence.with_design(item, experiment, sides))
    return items


def over_all(
    evidence: Evidence, each: Quantity, experiment: str, estimate: Callable[..., Estimate]
) -> list[Item]:
    """The mean of differences over fixed things, or the mean rate of one side over that of the other, minus 1."""
    sides = [_sides(evidence, each, experiment, where) for where in each.repetitions]
    there = [one for one in sides if not isinstance(one, Missing)]
    if len(there) < len(sides):
        return [evidence.missing(each.what, experiment, *({**each.where, **where, **side} for where in each.repetitions
                                                          for side in (each.one, each.other)))]
    gain = estimate is relative_gain
    if gain and not all(any(side.success.any() for side in part) for part in zip(*there, strict=True)):
        return []  # nothing to be relative to
    found = estimate([(successes(one), successes(other)) for one, other in there], evidence.noise(experiment))
    room = NAN if gain else 1 - float(np.mean([other.success.mean() for _, other in there]))
    theirs = each.paper.of_mean(gain)
    rows = pd.concat([part for pair in there for part in pair])
    item = evidence.finding(each.what, found, rows, each, room=room, **theirs)
    return [evidence.with_seeds(item, experiment, rows)]


def budgets(evidence: Evidence, each: Quantity, experiment: str) -> list[Item]:
    """A difference at every budget that both sides are asked at."""
    asked = evidence.asked(experiment)
    if asked.empty:
        return [evidence.missing(each.what.format(task="", timesteps=""), experiment, each.where)]
    both = asked[asked.method == each.one["method"]].merge(asked[asked.method == each.other["method"]],
                                                           on=["task", "timesteps"])
    points = both[["task", "timesteps"]].drop_duplicates()
    return differences(evidence, each.model_copy(update={"each": points.to_dict("list")}), experiment)


def efficiencies(evidence: Evidence, each: Quantity, experiment: str) -> list[Item]:
    """How many times MOVE's timesteps static needs; with the option `trend` their geometric mean as well."""
    items: list[Item] = []
    factors: list[Efficiency] = []
    for place, where in enumerate(each.repetitions):
        rows, budget = evidence.rows(experiment, each.where, where), get_task(where["task"]).budget(20_000)
        curves, what = by_budget(rows), each.named(where)
        if min(map(len, curves.values())) < 3 or budget not in curves["move"]:
            items.append(evidence.missing(what, experiment, where))
            continue
        found = data_efficiency(curves["static"], curves["move"], budget, evidence.noise(experiment))
        value, low, high = (found.surely(ratio, each.margin) for ratio in (found.ratio, found.low, found.high))
        items.append(Finding(what, value, low, high, each.margin, p_value=found.p_value(each.margin),
                             runs=runs_of(rows), text=str(found), **each.paper.of_one(place)))
        factors.append(found)
    return [*items, _mean_factor(factors, each.margin)] if each.options.get("trend") and factors else items


def _mean_factor(factors: Sequence[Efficiency], above: float) -> Finding:
    """The geometric mean of factors; one that is "more than" counts as that bound, which makes the mean smaller."""
    value = np.exp(np.mean([np.log(min(found.ratio, found.most)) for found in factors]))
    draws = np.exp(np.mean([np.log(np.minimum(found.draws, found.most)) for found in factors], axis=0))
    low, high = np.quantile(draws, [(1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2])
    return Finding(f"geometric mean of {len(factors)}, \"more than\" taken as the bound", float(value), float(low),
                   float(high), above, trend=True)


def near_minus_far(evidence: Evidence, each: Quantity, experiment: str) -> list[Item]:
    """Success where `one` holds minus that where `other` does, at other places of the same trainings."""
    rows = evidence.rows(experiment, each.where)
    if rows.seed.nunique() < 3 or _lacks(evidence, each, experiment, rows, each.where):
        return [evidence.missing(each.what, experiment, each.where)]
    near, far = (evidence.rows(experiment, each.where, side).groupby("seed").success.mean()
                 for side in (each.one, each.other))
    return [evidence.with_seeds(over_seeds(each.what, list(near - far), each, runs_of(rows)), experiment, rows)]


def decay(evidence: Evidence, each: Quantity, experiment: str) -> list[Item]:
    """The factor from the first of `factors` to the second minus that from the second to the third, seed by seed."""
    rows = evidence.rows(experiment, each.where)
    rates = rows.groupby(["seed", "factors"]).success.mean().unstack() if len(rows) else pd.DataFrame()
    first, second, third = each.options["factors"]
    if len(rates) < 3 or not {first, second, third} <= set(rates):
        return [evidence.missing(each.what, experiment, each.where)]
    steps = rates[second] / rates[first] - rates[third] / rates[second]
    what = f"{each.what} (with the {first} alone at {rates[first].mean():.2f})"
    return [evidence.with_seeds(over_seeds(what, list(steps), each, runs_of(rows)), experiment, rows)]


def ladder(evidence: Evidence, each: Quantity, experiment: str) -> list[Item]:
    """Each rung against the one before, and for each task the slope over all rungs as the trend."""
    items: list[Item] = []
    asked = evidence.asked(experiment)
    for where in each.repetitions:
        task = TASKS[where["task"]].title
        mine = asked[asked.task == where["task"]].moves.unique() if len(asked) else []
        rungs = [name for name in mine if "alone" not in name]
        rows = {rung: evidence.rows(experiment, where, {"moves": rung}) for rung in rungs}
        if not rungs or any(part.empty for part in rows.values()):
            return [evidence.missing(f"{task}, {each.what}", experiment, where)]
        for less, more in zip(rungs, rungs[1:], strict=False):
            step = each.model_copy(update={"one": {"moves": more}, "other": {"moves": less}, "where": where,
                                           "each": {}, "what": f"{task}, {more} minus {less}"})
            items += differences(evidence, step, experiment)
        cells, weights = [successes(rows[rung]) for rung in rungs], _slope(np.arange(len(rungs)))
        found = contrast(cells, weights, evidence.noise(experiment))
        items.append(evidence.finding(f"{task}, slope a rung", found, pd.concat(rows.values()), each, trend=True))
    return items


def _slope(places: np.ndarray) -> list[float]:
    """The weights with which values at `places` give the slope of a straight line through them."""
    centred = places - places.mean()
    return list(centred / (centred**2).sum())


def speeds(evidence: Evidence, each: Quantity, experiment: str) -> list[Item]:
    """How much success changes from the slowest to the fastest, along a straight line over the logarithm."""
    items: list[Item] = []
    for where in each.repetitions:
        rows, what = evidence.rows(experiment, each.where, where), each.named(where)
        asked = evidence.asked(experiment)
        wanted = sorted(asked[(asked.task == where["task"]) & (asked.part == where["part"])].speed.unique()
                        ) if len(asked) else []
        there = {speed: successes(part) for speed, part in rows.groupby("speed")} if len(rows) else {}
        if len(there) < 3 or set(wanted) - set(there):
            items.append(evidence.missing(what, experiment, where))
            continue
        logs = np.log(sorted(there))
        weights = [(logs[-1] - logs[0]) * weight for weight in _slope(logs)]
        cells = [as_cell(there[speed]) for speed in sorted(there)]
        found = contrast(cells, weights, evidence.noise(experiment))
        fixed = float(of_configurations(cells, weights).half_width)
        items.append(evidence.with_seeds(evidence.finding(what, found, rows, each), experiment, rows, fixed))
    return items


def robot(evidence: Evidence, each: Quantity, experiment: str) -> list[Item]:
    """A difference of two cells of table 3: Newcombe's interval decides, and Barnard's exact p is reported."""
    counts = paper.TABLE3_REAL.astype({"timesteps": int}).set_index(["timesteps", "method"]).successes
    one, other = (int(counts[side["timesteps"], side["method"]]) for side in (each.one, each.other))
    found = compare((other, paper.REAL_TRIALS), (one, paper.REAL_TRIALS))
    what = (f"{each.what} in the paper's own counts, {one} and {other} of {paper.REAL_TRIALS} trials, "
            f"Barnard's exact p {found['barnard']:.3f}")
    return [Finding(what, found["difference"], found["low"], found["high"], **each.region,
                    design=Trials(one / paper.REAL_TRIALS, other / paper.REAL_TRIALS))]


def printed_ratio(evidence: Evidence, each: Quantity, experiment: str) -> list[Item]:
    """A ratio that the paper says and those that its table of scores gives."""
    scores = paper.published("table3_real", "score").set_index(["condition", "method"]).value
    ratios = tuple(float(scores[size, "move"] / scores[size, "static"]) for size in ("35000", "75000"))
    return [Contradiction(each.paper.value[0], ratios, each.what)]


def untested(evidence: Evidence, each: Quantity, experiment: str) -> list[Item]:
    """Why nothing here decides it."""
    return [Untested(each.what, bool(each.options.get("testable")))]


QUANTITIES: dict[str, Callable[[Evidence, Quantity, str], list[Item]]] = {
    "rate": partial(rates, failing=False),
    "failure": partial(rates, failing=True),
    "difference": differences,
    "mean_difference": partial(over_all, estimate=mean_difference),
    "relative_gain": partial(over_all, estimate=relative_gain),
    "budgets": budgets,
    "data_efficiency": efficiencies,
    "near_minus_far": near_minus_far,
    "decay": decay,
    "ladder": ladder,
    "speeds": speeds,
    "coverage": collected.coverage,
    "lengths": collected.lengths,
    "generation": collected.generation,
    "robot": robot,
    "printed_ratio": printed_ratio,
    "untested": untested,
}
