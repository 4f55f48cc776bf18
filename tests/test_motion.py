"""Equations 1 to 3: properties that hold for every start, speed and time, and the distributions of the draws."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from move.errors import BadInput
from move.sim.configuration import Box, Disc, reflect
from move.sim.motion import equations

BOX = Box((-0.2, 0.5, 0.02), (0.1, 0.8, 0.02))
DISC = Disc((-0.05, 0.65), 0.15)
unit = st.floats(0, 1)
velocities = st.tuples(st.floats(-0.03, 0.03), st.floats(-0.03, 0.03)).map(lambda v: (*v, 0.0))
times = st.integers(-300, 300)


def inside_box(a: float, b: float) -> tuple[float, float, float]:
    return (-0.2 + 0.3 * a, 0.5 + 0.3 * b, 0.02)


def inside_disc(a: float, b: float) -> tuple[float, float, float]:
    radius, angle = 0.15 * math.sqrt(a), 2 * math.pi * b
    return (-0.05 + radius * math.cos(angle), 0.65 + radius * math.sin(angle), 0.02)


@given(unit, unit, velocities, times)
def test_translation_never_leaves_its_box(a, b, velocity, time):
    assert BOX.contains(equations.translate(inside_box(a, b), velocity, time, BOX))


@given(unit, unit, velocities, times)
def test_translation_never_leaves_its_disc(a, b, velocity, time):
    assert DISC.contains(equations.translate(inside_disc(a, b), velocity, time, DISC))


@given(unit, unit, velocities, st.integers(0, 100))
def test_speed_is_constant_between_bounces(a, b, velocity, time):
    here, there = (equations.translate(inside_box(a, b), velocity, t, BOX) for t in (time, time + 1))
    for axis in (0, 1):
        free = BOX.low[axis] + 0.031 < here[axis] < BOX.high[axis] - 0.031  # no bounce within one step
        step = abs(there[axis] - here[axis])
        assert step <= abs(velocity[axis]) + 1e-9
        assert not free or step == pytest.approx(abs(velocity[axis]), abs=1e-9)


@given(unit, unit, velocities, st.integers(0, 60))
def test_the_path_in_a_disc_is_a_straight_chord(a, b, velocity, time):
    start = inside_disc(a, b)
    x, y, z = equations.translate(start, velocity, time, DISC)
    across = (x - start[0]) * velocity[1] - (y - start[1]) * velocity[0]
    assert across == pytest.approx(0.0, abs=1e-9) and z == start[2]


@given(st.floats(0, 1), st.floats(-0.4, 0.4), st.integers(0, 50))
def test_reflect_agrees_with_bouncing_step_by_step(start, velocity, time):
    position, direction = start, velocity
    for _ in range(time):
        position += direction
        while not 0 <= position <= 1:
            position = -position if position < 0 else 2 - position
            direction = -direction
    assert reflect(start + time * velocity, 0.0, 1.0) == pytest.approx(position, abs=1e-9)


@given(unit, unit, velocities, st.integers(0, 60))
def test_traced_back_and_played_forward_it_arrives(a, b, velocity, steps):
    for inside, region in ((inside_box, BOX), (inside_disc, DISC)):
        grasp = inside(a, b)
        assert region.contains(equations.translate(grasp, velocity, -steps, region))
        assert equations.translate(grasp, velocity, 0, region) == pytest.approx(grasp)


@given(st.floats(0, math.pi), st.floats(-0.02, 0.02), times)
def test_angles_stay_in_their_range(start, velocity, time):
    assert -1e-9 <= equations.turn(start, velocity, time, 0.0, math.pi) <= math.pi + 1e-9


def test_speeds_follow_beta_2_5():
    rng = np.random.default_rng(0)
    speeds = np.array([equations.sample_speed(rng, 0.03) for _ in range(5000)]) / 0.03
    assert stats.kstest(speeds, stats.beta(2, 5).cdf).pvalue > 0.01


def test_other_laws_of_the_speed_have_the_same_mean():
    rng = np.random.default_rng(4)
    uniform = np.array([equations.sample_speed(rng, 0.03, "uniform") for _ in range(5000)]) / 0.03
    assert stats.kstest(uniform, stats.uniform(0, 4 / 7).cdf).pvalue > 0.01
    assert {equations.sample_speed(rng, 0.03, "constant") for _ in range(3)} == {0.03 * equations.MEAN_SPEED}
    assert stats.beta(*equations.BETA).mean() == pytest.approx(equations.MEAN_SPEED) == pytest.approx(2 / 7)


def test_directions_in_the_plane_are_uniform_unit_vectors():
    rng = np.random.default_rng(1)
    directions = np.array([equations.sample_direction(rng, 2) for _ in range(5000)])
    assert np.linalg.norm(directions, axis=1) == pytest.approx(1.0)
    angles = np.arctan2(directions[:, 1], directions[:, 0])
    assert stats.kstest(angles, stats.uniform(-np.pi, 2 * np.pi).cdf).pvalue > 0.01
    assert not directions[:, 2].any()


def test_directions_on_the_sphere_are_uniform_unit_vectors():
    rng = np.random.default_rng(2)
    directions = np.array([equations.sample_direction(rng, 3) for _ in range(5000)])
    assert np.linalg.norm(directions, axis=1) == pytest.approx(1.0)
    for axis in range(3):  # Archimedes: each coordinate of a uniform point on the sphere is uniform
        assert stats.kstest(directions[:, axis], stats.uniform(-1, 2).cdf).pvalue > 0.01


def test_signs_are_fair():
    rng = np.random.default_rng(3)
    signs = [equations.sample_sign(rng) for _ in range(2000)]
    assert set(signs) == {-1, 1} and stats.binomtest(signs.count(1), 2000).pvalue > 0.01


@pytest.mark.parametrize("make", [lambda: Box((1, 0, 0), (0, 1, 1)), lambda: Disc((0, 0), 0.0)])
def test_impossible_ranges_are_refused(make):
    with pytest.raises(BadInput, match="allowed"):
        make()
