"""Shipped policies: what they did in the episodes of the films, recorded beside them."""

import json
import shutil

import numpy as np
import pandas as pd
import pytest
from safetensors.numpy import save_file
from shared import move, needs_gl

from move import paths
from move.errors import BadInput
from move.figures.page import parameters
from move.figures.plots import film
from move.learn.agents import PolicyAgent, Recorded
from move.learn.evaluation import Evaluation, starts
from move.sim.tasks import get_task
from move.study import policies, seals
from move.study.profiles import Profile, load_profile

LAPTOP = load_profile("laptop")
SPECS = parameters.specs("rollouts", LAPTOP)


@needs_gl
def test_the_films_shown_are_what_the_shipped_policies_did_and_other_episodes_are_played_anew():
    listed = pd.read_csv(paths.ROOT / "paper_figures/rollouts.csv")
    for spec in SPECS:
        acting = policies.acting(spec, LAPTOP)
        for row in listed[listed.method == spec.method].itertuples():
            assert isinstance(acting(row.episode), Recorded)
            again, taken = film.episode_take(acting(row.episode), spec, row.episode, 16)
            assert ("success" if again["success"] else "failure", again["steps"]) == (row.outcome, row.steps)
            assert len(taken.frames) == row.steps + 1
        assert isinstance(acting(1), PolicyAgent) and 1 not in policies.recorded_episodes(spec, LAPTOP)


@needs_gl
def test_the_policy_of_a_stored_run_is_tried_elsewhere_without_training(capsys):
    spec = next(spec for spec in SPECS if spec.method == "move")
    code, out, _ = move(capsys, "evaluate", "--run", spec.hash, "--episodes", "2", "--json")
    found = json.loads(out)
    assert code == 0
    assert (found["agent"], found["task"], found["episodes"]) == (spec.hash, spec.task, 2)
    tried = starts(get_task(spec.task), Evaluation(episodes=2))
    assert [row["camera_angle"] for row in found["rows"]] == [start.configuration.camera_angle for start in tried]


@pytest.mark.parametrize("given, why", [
    (["0" * 16], "run: '0000000000000000' given; allowed is the hash of a run"),
    (["../x"], "allowed is the hash of a run"),
    ([SPECS[0].hash, "--task", "push"], "task: 'push' given for a policy of pick-place"),
    ([SPECS[0].hash, "--agent", "expert"], "agent: more than one given"),
    ([parameters.specs("table2_main", LAPTOP)[-1].hash], "allowed are runs that trained a policy"),
])
def test_a_run_whose_policy_cannot_be_tried_is_one_line(given, why, capsys):
    code, _, err = move(capsys, "evaluate", "--run", *given)
    assert code == 2 and why in err


@pytest.mark.parametrize("content", [b"", b"not safetensors", {"a": np.zeros((2, 4))}, {"3": np.full((2, 4), np.nan)},
                                     {"3": np.zeros((0, 4))}, {"3": np.zeros(4)}])
def test_a_damaged_record_of_episodes_is_one_clear_line(content, tmp_path, monkeypatch):
    spec = SPECS[0]
    path = tmp_path / "policies" / spec.policy_hash / policies.EPISODES
    shutil.copytree(LAPTOP.results / "policies" / spec.policy_hash, path.parent)
    monkeypatch.setattr(Profile, "results", property(lambda profile: tmp_path))
    save_file(content, path) if isinstance(content, dict) else path.write_bytes(content)
    seals.seal(spec, path.parent)
    with pytest.raises(BadInput, match=r"episodes.safetensors: .*; allowed is what tools/record_episodes.py writes"):
        policies.recorded_episodes(spec, LAPTOP)
