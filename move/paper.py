"""The paper's own numbers, as data (arXiv 2512.04813); nothing here was computed by this package."""

from __future__ import annotations

import pandas as pd

FIG1_SPARSE = {"static": 0.295, "move": 0.808}
FIG3_DENSE = {"static": 0.66, "move": 0.74}
FIG5_CIRCLE = {
    "inside": {"static": 0.213, "move": 0.437},
    "outside": {"static": 0.446, "move": 0.674},
}
TABLE1_SPATIAL_FACTORS = {"object": 0.675, "object+target": 0.447, "all": 0.317}
TABLE2_TASKS = (
    "pick-place", "push", "assembly", "box-close", "hammer", "pick-place-wall", "window-open", "faucet-open",
    "disassemble", "basketball",
)
TABLE2_MAIN = pd.DataFrame(
    {
        "static": (0.317, 0.163, 0.072, 0.351, 0.156, 0.066, 0.512, 0.289, 0.279, 0.011),
        "adc": (0.472, 0.335, 0.053, 0.383, 0.252, 0.237, 0.455, 0.345, 0.207, 0.025),
        "move": (0.673, 0.410, 0.131, 0.417, 0.309, 0.298, 0.705, 0.418, 0.447, 0.099),
    },
    index=pd.Index(TABLE2_TASKS, name="task"),
)
TABLE2_MEAN = {"static": 0.222, "adc": 0.276, "move": 0.391}
TABLE4_HYPERPARAMETERS = {
    "prediction horizon": (4, 8),
    "action horizon": (3, 8),
    "observation horizon": (2, 2),
    "gradient steps": ("220,000 in all", "200 an epoch"),
    "batch size": (128, 128),
    "denoising steps in training": (100, 50),
    "denoising steps in inference": (10, 10),
}
"""Simulation and real robot."""

TABLE5_DATA_SIZES = {
    "pick-place": 20_000, "push": 20_000, "assembly": 20_000, "box-close": 100_000, "hammer": 20_000,
    "pick-place-wall": 20_000, "window-open": 5_000, "faucet-open": 5_000, "disassemble": 20_000,
    "basketball": 20_000,
}
"""Timesteps of each task's data set."""

TABLE6_COLLECTION = {
    "static": {"mean_steps": 83.8, "generation_rate": 0.933},
    "move": {"mean_steps": 107.4, "generation_rate": 0.897},
}
"""Simulation; the paper gives no ADC."""

# The real robot: section 4 and the appendix. The counts are the only whole numbers that give the printed shares.
REAL_TRIALS = 30  # unseen positions, each tried once
REAL_POINTS = 3  # approach, pick up, put down: one point each
REAL_SIZES_TIMESTEPS = (35_000, 75_000)
REAL_RADIUS_M = 0.60  # the semicircular workspace, 0.5 * pi * 60 cm * 60 cm
TABLE3_REAL = pd.DataFrame(
    {
        "timesteps": (35_000, 35_000, 75_000, 75_000),
        "method": ("static", "move", "static", "move"),
        "successes": (1, 7, 7, 11),  # of REAL_TRIALS
        "score": (5, 28, 35, 47),  # of REAL_TRIALS * REAL_POINTS
        "printed_success_percent": (3.3, 23.3, 23.3, 36.7),
        "printed_score": (0.055, 0.311, 0.389, 0.522),  # 5/90 = 0.0556: cut, not rounded, in the paper
    }
)
TABLE6_REAL_MEAN_TIMESTEPS = {"static": 459.2, "move": 549.3}  # mean length of a demonstration
