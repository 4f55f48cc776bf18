"""Training: what it learns, that it resumes bit for bit, and what it leaves on disk."""

import json
import os
import shutil

import numpy as np
import pytest
import recipes
import torch
from safetensors.torch import load_file, save_file

from move.errors import BadInput
from move.learn import checkpoint
from move.learn import train as train_module
from move.learn.checkpoint import UnusableCheckpoint, load_policy, read
from move.learn.diffusion import DiffusionPolicy
from move.learn.settings import Training
from move.learn.train import step_generator, train
from move.machine import precision_used
from move.sim.demonstrations import Demonstrations


def settings(**changes) -> Training:
    tiny = {"gradient_steps": 6, "warmup_steps": 2, "batch_size": 8, "mlp_width": 16, "mlp_depth": 1,
            "precision": "float32"}
    return recipes.keypoints(**{**tiny, **changes})


def image_settings(**changes) -> Training:
    tiny = {"gradient_steps": 6, "warmup_steps": 2, "batch_size": 8, "mlp_width": 16, "crop_pixels": 14,
            "cnn_points": 4, "precision": "float32"}
    return recipes.image_laptop(**{**tiny, **changes})


def keypoints(timesteps: int = 60) -> Demonstrations:
    """One state a timestep, and an action that is a smooth function of it."""
    state = np.random.default_rng(0).uniform(-1, 1, (timesteps, 2)).astype(np.float32)
    angle = np.arctan2(state[:, 1], state[:, 0])
    actions = np.stack([np.sin(angle), np.cos(angle), state.mean(1)], 1).astype(np.float32)
    return Demonstrations(np.concatenate([state, np.full((timesteps, 1), 0.7, np.float32)], 1), actions,
                          np.arange(1, timesteps + 1))


def images(timesteps: int = 60) -> Demonstrations:
    """A bright spot, and an action that says where it is."""
    rng = np.random.default_rng(0)
    place = rng.integers(3, 13, (timesteps, 2))
    frames = np.zeros((timesteps, 16, 16, 3), np.uint8)
    for frame, (y, x) in zip(frames, place, strict=False):
        frame[y - 1:y + 2, x - 1:x + 2] = 255
    return Demonstrations(frames, ((place - 7.5) / 5).astype(np.float32), np.arange(1, timesteps + 1))


def same(one: DiffusionPolicy, other: DiffusionPolicy) -> bool:
    return all(torch.equal(tensor, other.state_dict()[name]) for name, tensor in one.state_dict().items())


# what it learns

def error_at_the_data(policy: DiffusionPolicy, demonstrations: Demonstrations) -> float:
    observed = np.stack([demonstrations.observations] * 2, 1)  # every episode is one timestep long
    executed = policy.act(observed, torch.Generator().manual_seed(0))
    return float(np.abs(executed[:, 0] - demonstrations.actions).mean())


@pytest.mark.parametrize("target", ["sample", "noise"])
def test_it_reproduces_actions_that_are_a_function_of_keypoints(target):
    plan = settings(gradient_steps=500, batch_size=64, mlp_width=64, mlp_depth=2, target=target, learning_rate=3e-3)
    policy, report = train(keypoints(), plan, seed=0)
    assert error_at_the_data(policy, keypoints()) < (0.05 if target == "sample" else 0.25)
    assert report.curve[-1][1] < 0.3 * report.curve[0][1]


def test_it_reproduces_actions_that_are_a_function_of_images():
    plan = image_settings(gradient_steps=300, batch_size=32, mlp_width=64, crop_pixels=None, cnn_width=8,
                          cnn_blocks=1, cnn_points=8, learning_rate=3e-3)
    policy, _ = train(images(), plan, seed=0)
    assert error_at_the_data(policy, images()) < 0.1


def test_the_unet_learns():
    plan = settings(gradient_steps=150, batch_size=32, denoiser="unet", unet_widths=(16, 32))
    _, report = train(keypoints(), plan, seed=0)
    assert report.curve[-1][1] < 0.3 * report.curve[0][1]


def test_averaged_weights_are_the_average_of_the_weights(monkeypatch):
    seen, take_step = [], train_module.Trainer.take_step

    def watched(trainer):
        loss = take_step(trainer)
        seen.append([weight.detach().clone() for weight in trainer.weights])
        return loss

    monkeypatch.setattr(train_module.Trainer, "take_step", watched)
    policy, _ = train(keypoints(), settings(ema_decay=0.5, ema_power=0.75), seed=0)
    average = seen[0]
    for step, weights in enumerate(seen[1:], 1):
        keep = min(0.5, 1 - (1 + step) ** -0.75)
        average = [keep * a + (1 - keep) * w for a, w in zip(average, weights, strict=False)]
    for by_hand, returned in zip(average, policy.parameters(), strict=False):
        torch.testing.assert_close(returned, by_hand)


# randomness

def test_the_same_seed_gives_the_same_policy_and_another_seed_another():
    torch.manual_seed(1)
    one, _ = train(keypoints(), settings(), seed=0)
    torch.manual_seed(2)
    before = torch.random.get_rng_state()
    assert same(one, train(keypoints(), settings(), seed=0)[0])
    assert not same(one, train(keypoints(), settings(), seed=1)[0])
    assert torch.equal(torch.random.get_rng_state(), before)


def test_every_step_has_its_own_randomness():
    steps = [(seed, step) for seed in range(10) for step in range(-1, 50)]
    first = {torch.rand((), generator=step_generator(seed, step)).item() for seed, step in steps}
    assert len(first) == 510


# going on after an interruption

@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    folder = tmp_path_factory.mktemp("trained") / "run"
    return folder, *train(keypoints(), settings(), 3, folder)


@pytest.fixture
def finished(trained, tmp_path):
    """A copy of the checkpoint of a finished training."""
    return shutil.copytree(trained[0], tmp_path / "run")


def interrupt_after(step: int):
    def on_step(done: int, total: int, loss: float) -> None:
        if done == step:
            raise KeyboardInterrupt
    return on_step


@pytest.mark.parametrize("data, plan", [(keypoints(), settings()), (images(), image_settings())])
@pytest.mark.parametrize("stopped", [1, 4, 5])
def test_four_steps_and_two_more_are_six_bit_for_bit(tmp_path, data, plan, stopped):
    straight, report = train(data, plan, seed=3)
    with pytest.raises(KeyboardInterrupt):
        train(data, plan, seed=3, checkpoint=tmp_path / "run", checkpoint_every=2, on_step=interrupt_after(stopped))
    steps = []
    resumed, resumed_report = train(data, plan, 3, tmp_path / "run", on_step=lambda done, *_: steps.append(done))
    assert steps == list(range(stopped // 2 * 2 + 1, 7))
    assert same(straight, resumed)
    assert resumed_report.curve == report.curve


def test_a_finished_run_is_not_trained_again(trained):
    folder, policy, report = trained
    again, again_report = train(keypoints(), settings(), 3, folder, on_step=interrupt_after(1))
    assert same(policy, again)
    assert again_report == report


@pytest.mark.parametrize("step", [2, 6])
def test_the_policy_loads_and_acts_as_it_did(tmp_path, step):
    if step == 6:
        policy, _ = train(images(), image_settings(), 3, tmp_path)
    else:
        with pytest.raises(KeyboardInterrupt):
            train(images(), image_settings(), 3, tmp_path, checkpoint_every=2, on_step=interrupt_after(2))
        policy = load_policy(tmp_path)
    observed = np.stack([images().observations] * 2, 1)
    noise = torch.randn(60, 4, 2, generator=torch.Generator().manual_seed(0))
    assert np.array_equal(load_policy(tmp_path).act(observed, noise=noise), policy.act(observed, noise=noise))
    assert read(tmp_path).averaged_steps == step


def test_the_folder_holds_json_and_safetensors_and_nothing_old(tmp_path):
    with pytest.raises(KeyboardInterrupt):
        train(keypoints(), settings(), 3, tmp_path, checkpoint_every=2, on_step=interrupt_after(5))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["lock", "run.json", "tensors-0000004.safetensors"]
    unfinished = (tmp_path / "tensors-0000004.safetensors").stat().st_size
    train(keypoints(), settings(), 3, tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["lock", "run.json", "tensors-0000006.safetensors"]
    assert (tmp_path / "tensors-0000006.safetensors").stat().st_size < unfinished / 2


@pytest.mark.parametrize("die_at", ["tensors-0000004.safetensors", "run.json"])
def test_dying_while_writing_leaves_the_checkpoint_before(tmp_path, monkeypatch, die_at):
    replace = os.replace

    def dying(source, target):
        if str(target).endswith(die_at) and (tmp_path / "run.json").exists():
            raise KeyboardInterrupt
        replace(source, target)

    monkeypatch.setattr(os, "replace", dying)
    with pytest.raises(KeyboardInterrupt):
        train(keypoints(), settings(), 3, tmp_path, checkpoint_every=2)
    monkeypatch.undo()
    assert read(tmp_path).step == 2
    resumed, _ = train(keypoints(), settings(), 3, tmp_path)
    assert same(resumed, train(keypoints(), settings(), 3)[0])
    assert sorted(path.name for path in tmp_path.iterdir()) == ["lock", "run.json", "tensors-0000006.safetensors"]


@pytest.mark.parametrize("message, changes, seed, timesteps", [
    ("batch_size 8 there, 9 here", {"batch_size": 9}, 3, 60), ("seed 3 there, 4 here", {}, 4, 60), ("data", {}, 3, 61)])
def test_a_checkpoint_of_another_run_is_refused(finished, message, changes, seed, timesteps):
    with pytest.raises(BadInput, match=f"another run: {message}"):
        train(keypoints(timesteps), settings(**changes), seed, finished)


def test_a_loss_that_is_no_number_stops_training(monkeypatch):
    monkeypatch.setattr(DiffusionPolicy, "loss", lambda self, *a: sum(w.sum() for w in self.parameters()) * torch.nan)
    with pytest.raises(BadInput, match="diverged: loss nan at gradient step 0; try a smaller learning_rate"):
        train(keypoints(), settings(), 0)


def test_a_loss_that_is_no_number_is_named_by_its_step_and_never_saved(tmp_path, monkeypatch):
    loss, taken = DiffusionPolicy.loss, []

    def breaks(self, *given):
        taken.append(loss(self, *given))
        return taken[-1] * (torch.nan if len(taken) == 3 else 1)

    monkeypatch.setattr(DiffusionPolicy, "loss", breaks)
    with pytest.raises(BadInput, match="loss nan at gradient step 2"):
        train(keypoints(), settings(), 0, tmp_path, checkpoint_every=2)
    assert json.loads((tmp_path / "run.json").read_text())["step"] == 2


def test_a_missing_checkpoint_is_named(tmp_path):
    with pytest.raises(BadInput, match="no checkpoint in .*nowhere"):
        load_policy(tmp_path / "nowhere")


def change_tensors(folder, change, digest="kept"):
    """Edit the tensors by `change`; the digest is kept, made to fit, or taken away."""
    path = next(folder.glob("tensors-*"))
    tensors = load_file(path)
    change(tensors)
    save_file(tensors, path)
    change_record(folder, digest)


def change_record(folder, digest="kept", **changes):
    record = json.loads((folder / "run.json").read_text()) | changes
    if digest != "kept":
        del record["digest"]
    if digest == "fitting":
        record["digest"] = checkpoint._digest(record, folder)
    (folder / "run.json").write_text(json.dumps(record))


def flip_a_bit(folder):
    path = next(folder.glob("tensors-*"))
    content = bytearray(path.read_bytes())
    content[-7] ^= 1
    path.write_bytes(content)


NAN = {"averaged/action_normalizer.scale": torch.full((3,), torch.nan)}


def larger(**changes: int) -> dict:
    """Settings as JSON holds them, with what no settings can be."""
    return settings().model_dump() | changes


@pytest.mark.parametrize(("damage", "reason"), [
    (lambda folder: (folder / "tensors-0000006.safetensors").unlink(), "No such file"),
    (lambda folder: (folder / "tensors-0000006.safetensors").write_bytes(b"short"), "digest"),
    (lambda folder: (folder / "run.json").write_text("{"), "run.json: .*invalid json"),
    (lambda folder: (folder / "run.json").write_text("null"), "run.json: .*input should be an object"),
    (lambda folder: (folder / "run.json").write_text("5"), "run.json: .*input should be an object"),
    (lambda folder: (folder / "run.json").write_text("[" * 100_000), "run.json: .*invalid json"),
    (lambda folder: change_record(folder, format=99), "format: 99 given; input should be 2"),
    (lambda folder: change_record(folder, unknown=1), "unknown: 1 given; extra inputs"),
    (lambda folder: change_record(folder, training={"encoder": "keypoints"}), "training.denoiser: field required"),
    (lambda folder: change_record(folder, seed=4), "digest"),
    (lambda folder: change_record(folder, tensors="../tensors-0000006.safetensors"), "tensors: .*string should match"),
    (lambda folder: change_record(folder, step="abc"), "step: 'abc' given; input should be a valid integer"),
    (lambda folder: change_record(folder, step=-1), "step: -1 given; input should be greater"),
    (lambda folder: change_record(folder, "fitting", step=10**9), "step 1000000000 of 6"),
    (lambda folder: change_record(folder, "fitting", step=5), "losses: shape .6,. given, .5,. needed"),
    (lambda folder: change_record(folder, seconds="x"), "seconds: 'x' given; input should be a valid number"),
    (lambda folder: change_record(folder, action_size=-1), "action_size: -1 given; input should be greater than 0"),
    (lambda folder: change_record(folder, "fitting", action_size=4), "shape .3,. given, .4,. needed"),
    (lambda folder: change_record(folder, "fitting", observation_shape=[10**10]), "shape"),
    (lambda folder: change_record(folder, "fitting", observation_shape=[10**30]), "checkpoint"),
    (lambda folder: change_record(folder, "fitting", training=larger(mlp_width=10**7)), "mlp_width"),
    (lambda folder: change_record(folder, "fitting", training=larger(mlp_depth=200_000)), "mlp_depth"),
    (lambda folder: change_record(folder, "fitting", training=settings(mlp_depth=200).model_dump()), "more blocks"),
    (lambda folder: change_tensors(folder, lambda tensors: tensors.pop("losses"), "fitting"), "losses: shape None"),
    (lambda folder: change_tensors(folder, lambda tensors: tensors.update(NAN), "fitting"), "numbers are finite"),
    (lambda folder: change_record(folder, "none"), "digest: field required"),
    (flip_a_bit, "its content does not fit its digest"),
])
def test_a_damaged_checkpoint_is_refused_in_one_line(finished, damage, reason):
    damage(finished)
    with pytest.raises(UnusableCheckpoint, match=f"^cannot read the checkpoint in [^\n]*{reason}[^\n]*$"):
        load_policy(finished)


def test_an_unfinished_checkpoint_without_adams_moments_is_refused(tmp_path):
    with pytest.raises(KeyboardInterrupt):
        train(keypoints(), settings(), 3, tmp_path, checkpoint_every=2, on_step=interrupt_after(5))
    change_tensors(tmp_path, lambda tensors: tensors.pop("adam/0/exp_avg"), "fitting")
    with pytest.raises(UnusableCheckpoint, match="adam/0/exp_avg: shape None given"):
        read(tmp_path)


def test_a_policy_of_another_task_is_refused_and_of_an_unknown_one_not(tmp_path):
    train(keypoints(), settings(), 3, tmp_path / "known", task="push")
    train(keypoints(), settings(), 3, tmp_path / "unknown")
    for folder, task in (("known", "push"), ("known", ""), ("unknown", "push")):
        assert load_policy(tmp_path / folder, task=task)
    with pytest.raises(BadInput, match="task: 'basketball' given; the policy in .* learnt 'push'"):
        load_policy(tmp_path / "known", task="basketball")


def test_a_second_training_into_one_folder_is_told_so(tmp_path):
    def second(*arguments):
        with pytest.raises(BadInput, match="another training is writing there"):
            train(keypoints(), settings(), 3, tmp_path)

    train(keypoints(), settings(), 3, tmp_path, on_step=second)
    train(keypoints(), settings(), 3, tmp_path)


def test_a_folder_that_cannot_be_is_refused_before_training(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInput, match="cannot write the checkpoint in .*file"):
        train(keypoints(), settings(), 3, tmp_path / "file", on_step=lambda *step: 1 / 0)


# the report, precision, observations that do not suit

def test_the_report(tmp_path):
    losses = []
    policy, report = train(keypoints(), settings(gradient_steps=120), 0, on_step=lambda *step: losses.append(step))
    assert [(done, total) for done, total, _ in losses] == [(i, 120) for i in range(1, 121)]
    assert len(report.curve) == 50 and report.curve[-1][0] == 120
    assert report.curve[0][1] == pytest.approx(np.mean([loss for _, _, loss in losses[:3]]), rel=1e-6)
    assert report.parameters == sum(weight.numel() for weight in policy.parameters())
    assert report.seconds > 0 and report.precision == "float32"


@pytest.mark.parametrize("able, used", [
    ({"avx512_bf16": True}, "bfloat16"), ({"amx_bf16": True}, "bfloat16"),
    ({"avx512_bf16": False}, "float32"), ({}, "float32"),
])
def test_bfloat16_is_used_only_where_the_processor_has_it(monkeypatch, able, used):
    monkeypatch.setattr(torch.cpu, "get_capabilities", lambda: able)
    assert precision_used("bfloat16") == used
    assert precision_used("float32") == "float32"


@pytest.mark.parametrize("data, plan", [(keypoints(), settings), (images(), image_settings)])
def test_bfloat16_trains_about_as_float32_does(monkeypatch, data, plan):
    monkeypatch.setattr(train_module, "precision_used", lambda wanted, device="cpu": wanted)
    _, half = train(data, plan(precision="bfloat16"), 0)
    _, full = train(data, plan(precision="float32"), 0)
    assert half.precision == "bfloat16"
    assert half.curve[-1][1] == pytest.approx(full.curve[-1][1], rel=0.05)


def test_images_for_a_keypoint_policy_are_refused():
    with pytest.raises(BadInput, match="encoder 'keypoints'"):
        train(images(), settings(), 0)
