"""The paper's own scale: its recipe, and one run of each kind from end to end on a CPU with three gradient steps.

The kinds differ by what is seen and where demonstrations grasp, so their U-Net is narrower; the network at the paper's
size is built and asked once here, and trained with the paper's batch by `make test-slow`.
"""

import shutil
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from move.figures.page import parameters
from move.learn import rollout
from move.learn.checkpoint import load_policy
from move.learn.diffusion import DiffusionPolicy
from move.learn.evaluation import Evaluation
from move.machine import gl_problem
from move.study import plan, results, run
from move.study.profiles import load_profile
from move.study.results import hand_start
from move.study.spec import RunSpec


def protocol(spec: RunSpec) -> str:
    """Where the run's demonstrations grasp; a control has none."""
    return spec.collection.protocol if spec.collection else "none"


@cache
def kinds() -> dict[str, RunSpec]:
    """One run of each kind: who plays, what is seen, where it grasps; the methods in turn."""
    found: dict[str, list[RunSpec]] = {}
    for figure in parameters.with_runs():
        for spec in parameters.specs(figure, load_profile("paper")):
            found.setdefault(f"{spec.agent}-{spec.observation}-{protocol(spec)}", []).append(spec)
    return {kind: specs[index % len(specs)] for index, (kind, specs) in enumerate(found.items())}


NARROW = (64, 128, 256)  # channels


def cut(spec: RunSpec, **training: Any) -> RunSpec:
    """The same run with three gradient steps, few timesteps, one evaluation episode and other settings of training."""
    changes = {"evaluation": Evaluation(episodes=1, factors=spec.evaluation.factors)}
    if spec.collection:
        changes["collection"] = spec.collection.model_copy(update={"timesteps": 40})
    if spec.training:
        changes["training"] = spec.training.model_copy(
            update={"gradient_steps": 3, "warmup_steps": 1, "batch_size": 4, **training})
    return spec.model_copy(update=changes)


def test_the_kinds_cover_every_agent_and_protocol():
    specs = kinds().values()
    assert {spec.agent for spec in specs} == {"policy", "collector", "nothing", "random", "expert", "goal-blind"}
    assert {protocol(spec) for spec in specs if spec.observation == "rgb"} == {
        "sparse", "dense", "circle", "random", "placed"}
    assert {spec.method for spec in specs if spec.training} >= {"static", "move"}


@pytest.mark.parametrize("name", kinds())
def test_a_run_of_each_kind_passes_from_end_to_end(name, tmp_path, monkeypatch):
    monkeypatch.setattr(rollout, "EPISODE_STEPS", 6)
    pass_from_end_to_end(cut(kinds()[name], unet_widths=NARROW), tmp_path)


@pytest.mark.slow(reason="minutes on a CPU; `make test-slow`")
def test_a_run_with_the_papers_batch_passes_from_end_to_end(tmp_path, monkeypatch):
    monkeypatch.setattr(rollout, "EPISODE_STEPS", 6)
    pass_from_end_to_end(cut(kinds()["policy-rgb-random"], batch_size=128), tmp_path)


def test_the_network_at_the_papers_size_gives_a_chunk_of_actions():
    training = load_profile("paper").training["rgb"]
    policy = DiffusionPolicy(training, (128, 128, 3), 4).eval()
    assert sum(weights.numel() for weights in policy.parameters()) > 60_000_000
    seen = np.zeros((1, training.observation_horizon, 128, 128, 3), np.uint8)
    actions = policy.act(seen, torch.Generator().manual_seed(0))
    assert actions.shape == (1, training.action_horizon, 4) and np.isfinite(actions).all()


def pass_from_end_to_end(spec: RunSpec, tmp_path: Path) -> None:
    """Collect, train and evaluate, and look at what is left of it."""
    if spec.observation == "rgb" and gl_problem():
        pytest.skip(gl_problem())
    result = run.run(spec, tmp_path / "results", scratch=tmp_path / "runs")
    assert results.load(spec, tmp_path / "results").rows == result.rows and len(result.rows) == 1
    if spec.training:
        curve = result.training["curve"]
        assert [step for step, _ in curve] == [1, 2, 3] and all(loss > 0 for _, loss in curve)
        policy = load_policy(tmp_path / "runs" / spec.policy_hash / "policy")
        assert policy.training_settings == spec.training
        assert (result.training["parameters"] > 60_000_000) == (spec.training.unet_widths != NARROW)
        shutil.rmtree(tmp_path / "runs")  # a gigabyte


def test_the_recipe_is_the_papers():
    recipe = load_profile("paper").training["rgb"]
    expected = {"encoder": "resnet18", "denoiser": "unet", "batch_size": 128, "gradient_steps": 220_000,
                "learning_rate": 1e-4, "crop_pixels": 80, "prediction_horizon": 4, "action_horizon": 3,
                "observation_horizon": 2, "diffusion_steps": 100, "inference_steps": 10, "noise_draws": 1,
                "learning_frames": None, "unet_widths": (512, 1024, 2048)}
    assert {name: getattr(recipe, name) for name in expected} == expected
    assert load_profile("paper").image_size == 128


def test_the_plan_turns_a_measured_step_into_hours(monkeypatch):
    profile = load_profile("paper")
    monkeypatch.setattr(plan, "step_seconds", lambda training, demonstrations: 0.5)
    specs = [spec for spec in parameters.specs("fig1_sparse", profile) if hand_start(spec) == "one place"]
    (row,) = plan.plan_rows(profile, {"fig1_sparse": specs})
    assert row["missing"] == 6 and row["hours_left"] == pytest.approx(6 * 220_000 * 0.5 / 3600, abs=0.01)
    assert ("GPU-hours" if torch.cuda.is_available() else "no GPU here") in plan.plan_title(profile)


def test_a_step_is_measured_by_making_it():
    training = load_profile("laptop").training["keypoints"]
    (spec, *_) = parameters.specs("keypoint_control", load_profile("laptop"))
    assert 1e-4 < plan.step_seconds(training, plan._example(spec, 96)) < 5
