"""Writes README's results, between its markers, from the figures' own tables: `python tools/results_table.py`.

The verdict of a row is that of the rule of all verdicts (`move/statistics/verdicts.py`); nobody words it. Below the
tables are how many of the paper's claims have which verdict, and figure 4 as one number.
"""

from __future__ import annotations

import pandas as pd

from move import paper, paths
from move.claims.claims import Paper
from move.claims.ledger import Ledger
from move.figures.fig4_scaling import efficiency_text
from move.figures.tables import points
from move.figures.tables.differences import difference_verdict
from move.files import written_aside
from move.statistics.verdicts import VERDICTS
from move.study.profiles import load_profile

HANDS = ("anywhere", "one place")  # where it starts: as in the authors' code; where all demonstrations begin alike
LESS_DATA = 36  # the claim that is about all tasks' data efficiency
FAR = 0.1  # between our two rates and the paper's, on the mean, from which a verdict says so
START, END = "<!-- results: written by tools/results_table.py -->", "<!-- end of results -->"
README = paths.ROOT / "README.md"


def table() -> str:
    """The results in Markdown, one number a cell: static and MOVE, and below them what compares another pair."""
    main = [
        *(_difference(f"Figure 1, hand {hand}", "fig1_sparse", "difference", hand)
          for hand in HANDS),
        *(_difference(f"Figure 3, hand {hand}", "fig3_dense", "difference", hand)
          for hand in HANDS),
        *(_difference(f"Figure 5 {where}, hand {hand}", "fig5_circle", "differences", hand, where)
          for where in ("inside", "outside") for hand in HANDS),
        _tasks("static"),
    ]
    return (f"{_head('static', 'MOVE')}\n" + "\n".join(main) + f"\n\n{_head('ADC', 'MOVE')}\n{_tasks('adc')}\n\n"
            f"{_head('object random', 'all random')}\n{_factors()}\n")


def sentences() -> str:
    """Data efficiency (figure 4) and the verdicts on the paper's claims, a line each."""
    counts = _read("claims").verdict.value_counts()
    counted = "; ".join(f"{counts[name]} {name}" for name in VERDICTS if name in counts)
    median = efficiency_text(_read("fig4_scaling_efficiency")).rpartition("Median task ")[2]
    ledger = Ledger.model_validate_json((load_profile("laptop").figures / "claims.json").read_text())
    (mean,) = (number for one in ledger.claims if one.number == LESS_DATA for number in one.numbers if number.trend)
    robots = ", ".join(str(one.number) for one in ledger.claims if one.figure == "table3_real")
    return (f"**The paper's {counts.sum()} claims.** {counted}. Of these {robots} are about a robot and judged by the "
            "paper's own numbers.\n\n**Data efficiency (figure 4).** Static's timesteps over MOVE's "
            f"for the same success: {mean.value:.1f} [{mean.low:.1f}, {mean.high:.1f}], the geometric mean "
            f"of ten tasks (\"more than\" taken as the bound); in the median task {median}\n")


def with_results(text: str) -> str:
    """`text` with what stands between the two markers replaced by the table and the sentences."""
    before, rest = text.split(START)
    return f"{before}{START}\n{table()}\n{sentences()}{END}{rest.split(END)[1]}"


def _read(name: str) -> pd.DataFrame:
    return pd.read_csv(load_profile("laptop").figures / f"{name}.csv")


def _seeds(rates: object) -> int:
    """How many single seeds' rates a cell of the column `seeds` holds."""
    return len(str(rates).split())


def _head(one: str, other: str) -> str:
    """The two lines that begin a table; a gain is `other` minus `one`. Short words: ten columns, as wide as a page."""
    columns = [one, other, "gain", "95 %", "seeds", f"{one}, paper", f"{other}, paper", "gain, paper", "verdict"]
    return f"| what | {' | '.join(columns)} |\n|---|{'---:|' * (len(columns) - 1)}---|"


def _line(what: str, ours: tuple[float, float], found: pd.Series, seeds: int | str, published: tuple[float, float],
          half: float = 0.0) -> str:
    """A row of the table; `found` is the second of the two rates minus the first, and so is the paper's."""
    theirs = published[1] - published[0]
    judged = difference_verdict(_rising(found, theirs), ours[0 if theirs >= 0 else 1], half) + _levels(ours, published)
    return (f"| {what} | {ours[0]:.2f} | {ours[1]:.2f} | {points(found.difference)} | {points(found.low)} to "
            f"{points(found.high)} | {seeds} | {_printed(published)} | {judged} |")


def _printed(published: tuple[float, float]) -> str:
    """The paper's two rates and their difference, a cell each."""
    return f"{published[0]:.3f} | {published[1]:.3f} | {points(published[1] - published[0])}"


def _levels(ours: tuple[float, float], published: tuple[float, float]) -> str:
    """What a verdict on a difference does not say: that both rates lie elsewhere than the paper's."""
    apart = sum(ours) / 2 - sum(published) / 2
    return f"; levels {'higher' if apart > 0 else 'lower'}" if abs(apart) > FAR else ""


def _rising(found: pd.Series, theirs: float) -> pd.Series:
    """A difference with the paper's, both the other way round where the paper's is a fall."""
    row = {"difference": found.difference, "low": found.low, "high": found.high, "paper": theirs}
    if theirs < 0:
        row = {"difference": -found.difference, "low": -found.high, "high": -found.low, "paper": -theirs}
    return pd.Series(row)


def _difference(what: str, figure: str, suffix: str, hand: str, where: str = "") -> str:
    """A row of figure 1, 3 or 5, or that it is missing."""
    ours, found = (rows[rows.hand == hand] for rows in (_read(f"{figure}_hand"), _read(f"{figure}_{suffix}")))
    if where:
        ours, found = ours[ours["where"] == where], found[found["where"] == where]
    printed = paper.published(figure, condition=where).set_index("method").value
    theirs = printed["static"], printed["move"]
    if found.empty:
        return f"| {what} | | | | | | {_printed(theirs)} | not computed yet |"
    ours = ours.set_index("method")
    return _line(what, (ours.value["static"], ours.value["move"]), found[found.baseline == "static"].iloc[0],
                 _seeds(ours.seeds["move"]), theirs)


def _factors() -> str:
    """Static with one factor and with all, as the notebook's table of what static loses gives it."""
    ours = _read("table1_spatial_factors").query("method == 'static'").set_index("factors")
    one, every = ours.loc["object"], ours.loc["all"]
    printed = paper.published("table1_spatial_factors").set_index("condition").value
    lost = _read("table1_spatial_factors_lost").set_index("factors").loc["all"]
    return _line("Table 1, static", (one.value, every.value), lost, _seeds(every.seeds),
                 (printed["object"], printed["all"]),
                 Paper(episodes=paper.EPISODES_A_RATE).half_width([printed["object"]], [printed["all"]]))


def _tasks(other: str) -> str:
    rates, found = _read("table2_main"), _read("table2_main_differences_mean").set_index("baseline").loc[other]
    ours = rates.groupby("method").value.mean()
    printed = {method: list(rows.paper) for method, rows in rates.groupby("method")}  # of the tasks that are there
    seeds = sorted(set(rates[rates.method.isin([other, "move"])].seeds.map(_seeds)))
    what = f"Table 2, mean of {found['items']:.0f} tasks"
    means = tuple(sum(printed[method]) / len(printed[method]) for method in (other, "move"))
    repeated = " to ".join(map(str, dict.fromkeys((seeds[0], seeds[-1]))))
    return _line(what, (ours[other], ours["move"]), found, repeated, means,
                 Paper(episodes=paper.EPISODES_A_RATE).half_width(printed["move"], printed[other]))


if __name__ == "__main__":
    with written_aside(README) as new:
        new.write_text(with_results(README.read_text()))
