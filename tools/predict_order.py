"""Writes what the radius says of placements that nobody has trained on yet, before they are: results/predicted.csv.

For each way of placing fifty demonstrations of Push: the share of the places tried whose success is left at their
distance to the nearest place seen, by the curve fitted to Pick-Place with hands within 3 cm (radius_radii.csv in
paper_figures), mean over the three repetitions that are to be trained. Nothing of Push's success enters. The figure
`fifty_demonstrations` sets the measured rates next to it. A minute: each collection is made again without images.
"""

from __future__ import annotations

import pandas as pd

from move.figures import fifty_demonstrations, radius
from move.files import written_aside
from move.paths import ROOT
from move.study.profiles import load_profile
from move.study.seen import nearest_place


def main() -> None:
    """Predict and write."""
    curve, *_ = radius.measured(radius.NEAR)  # hands start within 3 cm in these runs
    arm = fifty_demonstrations.BY[:4]
    rows = [{**{name: run.labels[name] for name in arm},
             "predicted": float(curve.top * curve.left(nearest_place(run.spec)).mean())}
            for run in fifty_demonstrations.runs(load_profile("laptop"), demonstrations=())]
    table = pd.DataFrame(rows).groupby(arm, sort=False, as_index=False).mean()
    with written_aside(ROOT / "results/predicted.csv") as new:
        table.to_csv(new, index=False, float_format="%.4f")


if __name__ == "__main__":
    main()
