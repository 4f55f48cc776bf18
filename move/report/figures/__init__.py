"""Whole figures, laid out from the pieces of `plots` and `maps`: tables in, a Figure out; nothing is read from disk.

One function a figure, named as its notebook. Every figure is one or two columns wide, its panels have letters, and what
a row says is missing is drawn as missing.

preliminary   figures 1, 3 and 5, table 1, figure 1 with fewer demonstrations
main          table 2, ADC, keypoints, generalisation
ablations     figures 4, 6 and 7, the law of the speeds
why           mixtures, length of training, equal demonstrations, coverage, perception
around        figure 2, rollouts, collection, the recipe, statistics, claims
gap           the distance to the paper, setting by setting
panels        what they share
"""

from move.report.figures.ablations import (
    fig4_efficiency,
    fig4_scaling,
    fig6_dimensions,
    fig7_speed,
    fig_speed_law,
)
from move.report.figures.around import claims, fig2_overview, rollouts, statistics, table6_collection, table_recipe
from move.report.figures.gap import gap
from move.report.figures.main import generalization, keypoint_control, table2_main, table_adc, table_keypoint_control
from move.report.figures.preliminary import (
    few_demonstrations,
    fig1_sparse,
    fig3_dense,
    fig5_circle,
    table1_spatial_factors,
)
from move.report.figures.why import (
    equal_demonstrations,
    fig_coverage,
    fig_mixture,
    fig_perception,
    fig_training_length,
)

__all__ = [
    "claims", "equal_demonstrations", "few_demonstrations", "fig1_sparse", "fig2_overview", "fig3_dense",
    "fig4_efficiency", "fig4_scaling", "fig5_circle", "fig6_dimensions", "fig7_speed", "fig_coverage", "fig_mixture",
    "fig_perception", "fig_speed_law", "fig_training_length", "gap", "generalization", "keypoint_control",
    "rollouts", "statistics", "table1_spatial_factors", "table2_main", "table6_collection", "table_adc",
    "table_keypoint_control", "table_recipe",
]
