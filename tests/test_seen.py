"""What training saw: made again without images, kept, and how far tried configurations lie from it."""

import numpy as np
import pytest

from move import paths
from move.sim import coverage
from move.sim.collect import collect
from move.study import seen
from move.study.kinds import policy_run
from move.study.profiles import load_profile

LAPTOP = load_profile("laptop")


@pytest.fixture(autouse=True)
def build(tmp_path, monkeypatch):
    monkeypatch.setattr(paths, "BUILD", tmp_path)
    for kept in (seen._nearest_place, seen._nearest_timesteps):
        kept.cache_clear()
    yield tmp_path
    for kept in (seen._nearest_place, seen._nearest_timesteps):
        kept.cache_clear()


def run(method, **more):
    return policy_run(LAPTOP, **{"task": "pick-place", "method": method, "seed": 0, "timesteps": 300, "episodes": 20,
                                 **more})


def test_static_saw_the_places_of_its_grasps_and_move_many_more(build):
    grids = {"protocol": "sparse", "starts": "grid", "grid_side": 3, "factors": "object"}
    static, move = run("static", **grids), run("move", **grids)
    _, record = collect(seen._blind(static.collection), 0)
    places = np.unique(seen.before_grasp(static)["object"].round(5), axis=0)
    assert places == pytest.approx(np.unique(np.array(record.grasp_points, np.float32).round(5), axis=0), abs=1e-4)
    assert len(np.unique(seen.before_grasp(move)["object"], axis=0)) > 3 * len(places)
    tried = seen._tried(static.collection, static.evaluation)[["object_x", "object_y"]].to_numpy()
    slow = np.linalg.norm(tried[:, None] - places[None], axis=2).min(axis=1)
    assert seen.nearest_place(static) == pytest.approx(slow, abs=1e-4)


def test_it_is_collected_once_whatever_is_observed_and_again_where_the_file_is_damaged(build, monkeypatch):
    first = seen.before_grasp(run("static", observation="rgb"))
    (kept,) = (build / "seen").iterdir()
    collected = coverage.configurations
    monkeypatch.setattr(coverage, "configurations", lambda *_: pytest.fail("collected again"))
    again = seen.before_grasp(run("static", observation="keypoints"))
    assert all((again[name] == first[name]).all() for name in seen.FACTORS)
    kept.write_bytes(kept.read_bytes()[:100])
    monkeypatch.setattr(coverage, "configurations", collected)
    assert all((values == first[name]).all() for name, values in seen.before_grasp(run("static")).items())


def test_the_nearest_timestep_is_among_those_found_whatever_the_length_scales(build):
    spec = run("move", task="assembly", timesteps=600)
    saw, tried = seen.before_grasp(spec), seen._tried(spec.collection, spec.evaluation)
    apart = np.stack([np.linalg.norm(tried[list(columns)].to_numpy()[:, None] - saw[name][None], axis=2)
                      for name, columns in seen.FACTORS.items()], axis=2)
    found = seen.nearest_timesteps(spec)
    assert found.shape == (20, seen.SEARCHES, len(seen.FACTORS))
    for radii in ([0.1, 0.5, 0.1, 0.8, 0.3], [0.04, 3.0, 0.3, 0.3, 0.1], [0.2, 0.3, 0.06, 3.0, 0.5]):
        near, nearest = (np.sqrt(((each / radii) ** 2).sum(axis=2)).min(axis=1) for each in (found, apart))
        assert (near >= nearest - 1e-5).all() and (near / nearest).mean() < 1.05
