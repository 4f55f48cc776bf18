"""Writes what the radius says of placements that nobody has trained on yet, before they are: results/predicted.csv.

For each way of placing fifty demonstrations of Push: the share of the places tried whose success is left at their
distance to the nearest place seen, by the curve fitted to Pick-Place with hands within 3 cm (radius_radii.csv in
paper_figures), mean over the three repetitions that are to be trained. Nothing of Push's success enters. The figure
`fifty_demonstrations` sets the measured rates next to it. A minute: each collection is made again without images.
"""

from __future__ import annotations

import numpy as np
import pandas as pd

from move.figures import fifty_demonstrations
from move.files import written_aside
from move.paths import ROOT
from move.study.profiles import load_profile
from move.study.seen import nearest_place

HAND = "hand within 3 cm"  # as in these runs


def main() -> None:
    """Predict and write."""
    profile = load_profile("laptop")
    (curve,) = pd.read_csv(profile.figures / "radius_radii.csv").query(
        "setting == @HAND and observation == 'rgb'").itertuples()
    rows = []
    for run in fifty_demonstrations.runs(profile, demonstrations=()):
        apart = nearest_place(run.spec)
        left = curve.top / (1 + (apart / curve.radius) ** curve.steepness)
        rows.append({**{name: run.labels[name] for name in ("task", "equal", "demonstrations", "arm")},
                     "predicted": float(np.mean(left))})
    table = pd.DataFrame(rows).groupby(["task", "equal", "demonstrations", "arm"], sort=False, as_index=False).mean()
    with written_aside(ROOT / "results/predicted.csv") as new:
        table.to_csv(new, index=False, float_format="%.4f")


if __name__ == "__main__":
    main()
