"""Which runs make which figure: one registered function a figure, from a profile and its parameters to labelled runs.

preliminary.py  figures 1, 3 and 5, table 1: Pick-Place, static and MOVE; figure 1 with fewer demonstrations
main.py         table 2, and the same policies at their own grasps and as images
ablations.py    the recipe for images, one change at a time; how long one trains; how ADC jumps
controls.py     from keypoints; what a demonstration costs
scaling.py      figure 4: success against timesteps
dimensions.py   figures 6 and 7: what moves, and how fast; by which law speeds are drawn
why.py          perception given or not; coverage; mixtures; equal demonstrations for timesteps
floors.py       floors and ceilings
budgets.py      tasks with the paper's budgets
gap.py          why rates here are not the paper's
noise.py        how much trainings differ, where a figure has too few seeds to say
registry.py     `@experiment`, and an experiment's runs by its name

The parameters are those of the notebook of the same name; a profile's YAML may change them. Static, ADC and MOVE get
the same budget, recipe, evaluation and seeds.
"""

# ruff: noqa: I001, the order of import is the order in which the experiments are listed and planned
from move.experiments.preliminary import (
    few_demonstrations,
    fig1_sparse,
    fig3_dense,
    fig5_circle,
    table1_spatial_factors,
)
from move.experiments.main import generalization, rollouts, table2_main
from move.experiments.scaling import fig4_scaling
from move.experiments.dimensions import fig6_dimensions, fig7_speed, fig_speed_law
from move.experiments.why import equal_demonstrations, fig_coverage, fig_mixture, fig_perception
from move.experiments.ablations import RECIPE_CHANGES, fig_training_length, table_adc, table_recipe
from move.experiments.controls import keypoint_control, table6_collection, table_keypoint_control
from move.experiments.gap import gap
from move.experiments.noise import known_noise
from move.experiments.registry import EXPERIMENTS, defaults, experiment, parameters, runs, specs

__all__ = [
    "EXPERIMENTS", "RECIPE_CHANGES", "defaults", "equal_demonstrations", "experiment",
    "few_demonstrations", "fig1_sparse", "fig3_dense", "fig4_scaling", "fig5_circle", "fig6_dimensions", "fig7_speed",
    "fig_coverage", "fig_mixture", "fig_perception", "fig_speed_law", "fig_training_length", "gap", "generalization",
    "keypoint_control", "known_noise", "parameters", "rollouts", "runs", "specs", "table1_spatial_factors",
    "table2_main", "table6_collection", "table_adc", "table_keypoint_control", "table_recipe",
]
