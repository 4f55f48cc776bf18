"""Coverage of configurations, and films: what figure 2 counts and shows."""

import numpy as np
import pandas as pd
import pytest
from recipes import tiny_run
from shared import needs_gl

from move.figures.plots import film
from move.learn import rollout
from move.learn.agents import PolicyAgent, Recorded
from move.learn.evaluation import Evaluation
from move.learn.train import train
from move.paper import PAPER_TASKS
from move.sim import coverage
from move.sim.collect import Collection, collect
from move.sim.tasks import get_task

TASK = get_task("pick-place")


@pytest.fixture(scope="module")
def seen() -> dict[str, pd.DataFrame]:
    return {method: coverage.configurations(Collection(task="pick-place", method=method, timesteps=500), 0)
            for method in ("static", "adc", "move")}


def test_it_notes_the_timesteps_of_the_data_set(seen):
    for method, rows in seen.items():
        demonstrations, _ = collect(Collection(task="pick-place", method=method, timesteps=500), 0)
        assert len(rows) == demonstrations.timesteps
        assert rows.groupby("episode").size().tolist() == demonstrations.lengths.tolist()


def test_static_demonstrations_show_one_configuration_each(seen):
    places = seen["static"].groupby("episode")[["object_x", "target_x", "camera_angle"]].nunique()
    assert (places == 1).all().all()


def test_adc_shows_two_places_each_and_move_many(seen):
    whole = {method: rows[(rows.phase == "pick") & (rows.episode < rows.episode.max())]  # the last one is cut
             for method, rows in seen.items()}
    places = {method: rows.groupby("episode").object_x.nunique() for method, rows in whole.items()}
    assert (places["adc"] == 2).all()
    assert (places["move"] > 10).all()


def test_the_share_counts_cells_once():
    low, high = TASK.object_range.low, TASK.object_range.high
    rows = pd.DataFrame({"phase": ["pick"] * 4 + ["place"], "object_x": [low[0], low[0], high[0], low[0], 0.0],
                         "object_y": [low[1], low[1], high[1], high[1], 0.7], "target_x": 0.0, "target_y": 0.85,
                         "camera_angle": [0.0, 0.01, 1.6, 3.14, 3.14]})
    assert coverage.visited_share(rows, TASK, "object") == 3 / 100  # three corners; the last row is in the hand
    assert coverage.visited_share(rows, TASK, "target") == 1 / 100
    assert coverage.visited_share(rows, TASK, "camera") == 3 / 20


@pytest.mark.parametrize("task", PAPER_TASKS)
def test_a_share_lies_between_0_and_1_and_a_task_without_target_has_none(task):
    rows = coverage.configurations(Collection(task=task, method="static", timesteps=250), 0)
    for part in coverage.PARTS:
        share = coverage.visited_share(rows, get_task(task), part)
        absent = part == "target" and task in ("window-open", "faucet-open", "disassemble")
        assert np.isnan(share) if absent else 0 < share <= 1


def test_joint_cells_hold_a_position_from_an_angle():
    low, high = TASK.object_range.low, TASK.object_range.high
    rows = pd.DataFrame({"phase": ["pick"] * 3 + ["place"], "object_x": [low[0], low[0], high[0], high[0]],
                         "object_y": [low[1], low[1], high[1], high[1]], "camera_angle": [0.0, 3.1, 0.0, 3.1]})
    assert coverage.visited_joint_share(rows, TASK, side=2, angles=2) == 3 / 8  # of four; the last one is in the hand
    assert coverage.visited_joint_share(rows[:1], TASK, side=2, angles=2) == 1 / 8


def test_moving_scenes_cover_more(seen):
    for part in coverage.PARTS:
        shares = {method: coverage.visited_share(rows, TASK, part) for method, rows in seen.items()}
        assert shares["move"] > 2 * shares["static"]


@needs_gl
def test_an_episode_is_filmed_as_a_policy_plays_it_and_as_it_was_recorded(monkeypatch):
    spec = tiny_run(evaluation=Evaluation(episodes=6))
    policy, _ = train(collect(spec.collection, 0)[0], spec.training, 0)
    monkeypatch.setattr(rollout, "EPISODE_STEPS", 6)
    row, taken = film.episode_take(PolicyAgent(policy, 0), spec, 4, 32)
    frames = taken.frames
    assert row["trial"] == 4 and frames.shape == (7, 32, 32, 3) and taken.places["target"].shape == (7, 3)
    moved = np.full((3, 4), 0.5, np.float32)
    again = film.episode_take(Recorded(moved), spec, 4, 32)[1].frames
    assert again.shape == frames.shape and np.array_equal(again[0], frames[0]) and not np.array_equal(again, frames)


def test_the_same_frames_are_the_same_film_every_time(tmp_path):
    colours = np.random.default_rng(0).integers(0, 256, (20, 20, 3), dtype=np.uint8)
    blocks = np.kron(colours, np.ones((8, 8, 1), np.uint8))
    frames = np.stack([np.roll(blocks, shift, axis=1) for shift in range(200)])
    assert len({film.write_film(frames, tmp_path / f"{copy}.mp4").read_bytes() for copy in range(4)}) == 1
