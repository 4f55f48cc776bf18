"""Claims that their first runs left undecided, asked again with new seeds and at more configurations."""

from __future__ import annotations

from functools import partial
from typing import Any

import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.figure import Figure

from move.figures.page.captions import DIFFERENCES, INTERVALS, RATES, Words
from move.figures.page.data import Data
from move.figures.page.parameters import Count, Seeds
from move.figures.plots.axes import errors, lines_axis, points_axis
from move.figures.plots.style import COLUMN_WIDTH, GREY
from move.figures.tables import rate_table
from move.figures.tables.differences import difference_brief, variant_table
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile

BY = ["claim", "variant", "method"]
FIRST_SEED = 10
"""Seeds below this made the runs that left the claims open; none of those counts here."""

ROTATING: dict[str, Any] = {"task": "assembly", "method": "move", "timesteps": 20_000}
SPEEDS: dict[str, Any] = {"task": "pick-place", "method": "move", "timesteps": 20_000}
CASES: dict[int, dict[str, dict[str, Any]]] = {
    7: {"MOVE, 20,000": SPEEDS, "static, 50,000": {**SPEEDS, "method": "static", "timesteps": 50_000}},
    25: {"Beta": SPEEDS, **{law: {**SPEEDS, "speed_law": law} for law in ("uniform", "constant")}},
    26: {"with rotation": ROTATING, "without": {**ROTATING, "moving": ("object", "target", "camera")}},
}
"""By number of the claim (`claims.yaml`, whose findings, directions and margins hold): the first is claimed to be above
the others, or for claim 7 no more than ten points below. Committed before any of these runs."""


def runs(
    profile: Profile, seeds_7: Seeds = 3, seeds_25: Seeds = 5, seeds_26: Seeds = 6, episodes: Count = 400,
    most_timesteps: Count = 50_000,
) -> list[LabelledRun]:
    """The variants of each claim with new seeds, about as many as the ledger then asked for; labels claim, variant."""
    found: list[LabelledRun] = []
    for (claim, variants), seeds in zip(CASES.items(), (seeds_7, seeds_25, seeds_26), strict=True):
        base = partial(policy_run, profile, episodes=episodes)
        limited = {name: {**chosen, "timesteps": min(chosen["timesteps"], most_timesteps)}
                   for name, chosen in variants.items()}
        found += grid(base, claim={claim: {}}, seed=range(FIRST_SEED, FIRST_SEED + seeds), variant=limited)
    return found


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """Rates, and the first variant of each claim minus the others; of claims whose runs are all there.

    Looking at a part of them, and again at more, would favour whatever the numbers were when the looking stopped.
    """
    missing = {spec.hash for spec, _ in data.missing}
    begun = {run.labels["claim"] for run in data.runs if run.spec.hash in missing}
    episodes, noise = data.episodes[~data.episodes.claim.isin(begun)], data.noise()
    return {
        "": rate_table(episodes, BY, noise),
        "differences": variant_table(episodes, ["claim"], "variant", lambda rows: _pairs(rows.claim.iloc[0]), noise),
    }


def _pairs(claim: int) -> list[tuple[str, str]]:
    first, *others = CASES[claim]
    return [(first, other) for other in others]


def pairs() -> pd.DataFrame:
    """Which variant of each claim is held against which."""
    return pd.DataFrame([(claim, *pair) for claim in CASES for pair in _pairs(claim)],
                        columns=["claim", "variant", "baseline"])


def draw(tables: dict[str, pd.DataFrame], data: Data) -> Figure:
    """One line a difference; a question mark where a run of its claim is missing."""
    figure, ax = plt.subplots(figsize=(COLUMN_WIDTH, 1.8))
    shown = pairs().merge(tables["differences"], how="left", on=["claim", "variant", "baseline"])
    for place, row in enumerate(shown.itertuples()):
        if pd.isna(row.difference):
            ax.annotate("?", (0, place), (4, 0), textcoords="offset points", va="center", color=GREY)
        else:
            ax.errorbar(row.difference, place, xerr=errors(row, "difference"), fmt="o", ms=3.5, lw=1, capsize=1.5,
                        color="black")
    lines_axis([f"{row.claim}: {row.variant} \N{MINUS SIGN} {row.baseline}" for row in shown.itertuples()], ax)
    points_axis(ax, "difference of success (points)")
    return figure


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """Each difference with its interval."""
    each = "; ".join(f"claim {row.claim}, {row.variant} minus {row.baseline}: {difference_brief(row)}"
                     for _, row in tables["differences"].iterrows())
    return (f"**The paper** prints no rates. **Here**, with new seeds, in points: "
            f"{each or 'nothing is computed yet'}. **How sure:** {data.sample_size}")


WORDS = Words(
    title="Claims asked again, with new seeds",
    shown=(f"Differences in success between the two sides of claims that a first look left open: new seeds, about as "
           f"many as the ledger then asked for, at 400 configurations, a hundred of which are the first look's. A "
           f"question mark: a run of the claim is missing. MOVE matches static (claim 7) where its interval is above "
           f"\N{MINUS SIGN}10. {INTERVALS}"),
    alt="One line a difference with its interval.",
    tables={"": f"Claims asked again. {RATES}", "differences": f"Claims asked again. {DIFFERENCES}"},
)
