"""Pick-Place, static against MOVE: grasp points (figures 1, 3 and 5), and what is random (table 1)."""

from __future__ import annotations

from functools import partial

from move.experiments.registry import Count, Counts, Observation, Repeats, Seeds, experiment
from move.sim.tasks import FACTORS
from move.study.kinds import policy_run
from move.study.labels import LabelledRun, grid
from move.study.profiles import Profile

COMPARED = ("static", "move")
HAND_SPREAD = 0.03  # metres; how far to each side the hand starts in the demonstrations of figures 1, 3 and 5


@experiment
def fig1_sparse(
    profile: Profile, observation: Observation = "rgb", timesteps: Count = 7000, seeds: Repeats = 5,
    identical_starts: Seeds = 3, grid_side: Count = 12,
) -> list[LabelledRun]:
    """Nine grasp points, static against MOVE, equal timesteps; a grid over the 30 x 30 cm object space (figure 1).

    Each demonstration starts with the hand a few centimetres elsewhere; the first `identical_starts` seeds are there
    once more with the hand always in one place, where static demonstrations of a point are all the same.
    """
    base = partial(_grasp_points, profile, "sparse", observation, grid_side)
    return [*base(timesteps, seeds, HAND_SPREAD), *base(timesteps, identical_starts, 0.0)]


@experiment
def few_demonstrations(
    profile: Profile, observation: Observation = "rgb", timesteps: Counts = (1300, 3250, 7000), seeds: Repeats = 3,
    grid_side: Count = 12,
) -> list[LabelledRun]:
    """Figure 1 with less of it: in these budgets static makes about 2, 5 and 11 demonstrations at each of its points.

    The paper took 10, for with fewer "usually" no meaningful policy was learnt (section IV-A).
    """
    base = partial(_grasp_points, profile, "sparse", observation, grid_side)
    return [run for budget in timesteps for run in base(budget, seeds, HAND_SPREAD)]


@experiment
def fig3_dense(
    profile: Profile, observation: Observation = "rgb", timesteps: Counts = (7000, 3500, 2000),
    seeds: Repeats = 3, identical_starts: Seeds = 3, grid_side: Count = 12,
) -> list[LabelledRun]:
    """Grasp points anywhere, the same for static and MOVE, equal timesteps; a grid over the object space (figure 3).

    At each budget of `timesteps`; with the hand always in one place, as in figure 1, at the first alone.
    """
    first, *less = timesteps
    base = partial(_grasp_points, profile, "dense", observation, grid_side)
    return [*base(first, seeds, HAND_SPREAD), *base(first, identical_starts, 0.0),
            *(run for budget in less for run in base(budget, seeds, HAND_SPREAD))]


@experiment
def fig5_circle(
    profile: Profile, observation: Observation = "rgb", timesteps: Count = 7000, seeds: Repeats = 5,
    identical_starts: Seeds = 3, grid_side: Count = 12,
) -> list[LabelledRun]:
    """Twenty grasp points on a circle, motion inside it; a grid over the object space, in and out (figure 5)."""
    base = partial(_grasp_points, profile, "circle", observation, grid_side)
    return [*base(timesteps, seeds, HAND_SPREAD), *base(timesteps, identical_starts, 0.0)]


def _grasp_points(
    profile: Profile, protocol: str, observation: str, grid_side: int, timesteps: int, seeds: int, hand_spread: float
) -> list[LabelledRun]:
    points = "none" if protocol == "dense" else protocol  # dense: every demonstration has a point of its own
    base = partial(policy_run, profile, task="pick-place", observation=observation, factors="object",
                   protocol=protocol, starts="grid", grid_side=grid_side, points=points)
    return grid(base, timesteps=[timesteps], hand_spread=[hand_spread], seed=range(seeds), method=COMPARED)


@experiment
def table1_spatial_factors(
    profile: Profile, observation: Observation = "rgb", timesteps: Count = 20_000, seeds: Repeats = 3,
    episodes: Count = 100,
) -> list[LabelledRun]:
    """Pick-Place as its object, then its target, then camera and hand become random; static and MOVE (table 1)."""
    base = partial(policy_run, profile, task="pick-place", observation=observation, timesteps=timesteps,
                   episodes=episodes)
    return grid(base, seed=range(seeds), factors=list(FACTORS), method=COMPARED)
