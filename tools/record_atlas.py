"""Records what shipped policies do at 25 places of figure 1's map: `python tools/record_atlas.py`.

The site's atlas shows it. The policies are table 2's on Pick-Place, from pixels. The object lies at every third place
of figure 1's grid, the hand where figure 1's evaluation has it; camera and target are this package's, for these
policies have never seen the authors' camera. What is recorded are actions: with them the films are the same on every
machine.
"""

from __future__ import annotations

import json
import time

import numpy as np

from move.figures.page import parameters
from move.learn.agents import PolicyAgent
from move.learn.diffusion import DiffusionPolicy
from move.learn.evaluate import evaluate
from move.learn.evaluation import Evaluation
from move.machine import one_thread
from move.sim.scene.scene import Scene
from move.sim.tasks import get_task
from move.study import policies
from move.study.profiles import Profile, load_profile
from move.study.spec import PolicyRun

METHODS = ("static", "move")
SIDE, EVERY = 15, 3  # of figure 1's grid: cells along a side, and which of them are filmed
EVALUATION = Evaluation(starts="grid", grid_side=SIDE, factors="object+hand")
PLACES = tuple(SIDE * x + y for x in range(EVERY // 2, SIDE, EVERY) for y in range(EVERY // 2, SIDE, EVERY))
"""The numbers of the filmed places in the grid, x slowest."""


class Recorder(PolicyAgent):
    """A policy that keeps what it does in every episode."""

    def __init__(self, policy: DiffusionPolicy, seed: int) -> None:
        super().__init__(policy, seed)
        self.made: dict[int, list[np.ndarray]] = {}

    def act(self, running: list[int], scenes: list[Scene], observations: np.ndarray | None) -> np.ndarray:
        """The policy's actions."""
        actions = super().act(running, scenes, observations)
        for number, chunk in zip(running, actions, strict=True):
            self.made.setdefault(number, []).extend(chunk)
        return actions


def filmed_runs(profile: Profile) -> dict[str, PolicyRun]:
    """Method -> the run whose shipped policy is filmed."""
    return {spec.method: spec for spec in parameters.specs("rollouts", profile)
            if isinstance(spec, PolicyRun) and spec.method in METHODS}


def main() -> None:
    """Play, record, and say what came of it."""
    one_thread()
    profile = load_profile("laptop")
    for method, spec in filmed_runs(profile).items():
        agent, began = Recorder(policies.trained_policy(spec, profile), spec.seed), time.process_time()
        rows = evaluate(agent, get_task(spec.task), EVALUATION, spec.collection.observed, indices=set(PLACES),
                        batch_size=SIDE**2)
        path = policies.record_episodes(spec, profile, {number: np.stack(made) for number, made in agent.made.items()},
                                        policies.ATLAS)
        print(json.dumps({"file": str(path), "method": method, "episodes": len(rows),
                          "successes": sum(row["success"] for row in rows),
                          "cpu_seconds": round(time.process_time() - began)}), flush=True)


if __name__ == "__main__":
    main()
