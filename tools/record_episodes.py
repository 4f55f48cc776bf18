"""Records what shipped policies do in the episodes that the rollouts show: `python tools/record_episodes.py`.

Their films are then the same on every machine: physics and images are, but a policy's rounding is not.
"""

from __future__ import annotations

import json

import numpy as np
from record_atlas import Recorder

from move.figures.page import parameters
from move.figures.plots import film
from move.study import policies
from move.study.profiles import load_profile

SEED = 0  # of the notebook


def main() -> None:
    """Play, record, and say what came of it."""
    profile = load_profile("laptop")
    for spec in parameters.specs("rollouts", profile):
        policy, played = policies.trained_policy(spec, profile), {}

        def acting(number: int, policy=policy, played=played, seed=spec.seed) -> Recorder:
            return played.setdefault(number, Recorder(policy, seed))

        shown = [row for row, _ in film.one_of_each(acting, spec, np.random.default_rng(SEED), 16)]
        made = {number: np.stack(*agent.made.values()) for number, agent in played.items()}
        path = policies.record_episodes(spec, profile, made)
        print(json.dumps({"file": str(path), "played": sorted(played), "shown": [row["trial"] for row in shown]}))


if __name__ == "__main__":
    main()
