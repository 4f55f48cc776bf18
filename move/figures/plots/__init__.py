"""Plot functions of rates: a tidy DataFrame and an Axes in, marks on the Axes out; nothing is read from disk.

Rates and differences are shares of 1 in the tables and on the axes, and are written in per cent and in points. A row
whose value is NaN is drawn as missing. Maps and frames are in `move.figures.plots.maps`.
"""

from move.figures.plots.axes import log_ticks, points_axis, pooled_entry, short
from move.figures.plots.bars import cost_entries, costs, grouped_rates, ladder
from move.figures.plots.curves import (
    coverages,
    curve,
    entries,
    half_widths,
    level,
    printed_points,
    reference,
    reference_entry,
)
from move.figures.plots.points import (
    READINGS,
    VERDICT_COLOURS,
    changes,
    covered,
    differences,
    efficiencies,
    forest,
    forest_entries,
    gains,
    own_and_elsewhere,
    readings,
    task_rates,
)
