"""Settings, encoders, denoisers, the noise schedule and the policy's shapes and randomness."""

import math
from typing import get_args

import numpy as np
import pytest
import recipes
import torch
from pydantic import ValidationError

from move.errors import BadInput
from move.learn.denoisers import DENOISERS, ResidualMLP, TimeConvolution, UNet
from move.learn.diffusion import DiffusionPolicy, MinMaxNormalizer, crop, noise_schedule
from move.learn.encoders import ENCODERS, ResNet18, SmallCNN, SpatialSoftmax
from move.learn.settings import Training
from move.sim.collect import Collection, collect
from move.sim.demonstrations import Demonstrations


def keypoint_settings(**changes) -> Training:
    return recipes.keypoints(**{"mlp_width": 32, "mlp_depth": 1, **changes})


def image_settings(**changes) -> Training:
    small = {"mlp_width": 32, "cnn_points": 4, "crop_pixels": 28, "precision": "float32"}
    return recipes.image_laptop(**{**small, **changes})


def generator(seed: int = 0) -> torch.Generator:
    return torch.Generator().manual_seed(seed)


def policy(settings: Training, shape: tuple[int, ...]) -> DiffusionPolicy:
    with torch.random.fork_rng():
        torch.manual_seed(0)
        return DiffusionPolicy(settings, shape, 4).eval()


def windows(settings: Training, batch: int) -> tuple[torch.Tensor, torch.Tensor]:
    shape = (batch, settings.observation_horizon)
    observations = torch.randn((*shape, 6), generator=generator())
    if settings.encoder != "keypoints":
        observations = torch.randint(0, 256, (*shape, 32, 32, 3), generator=generator(), dtype=torch.uint8)
    actions = torch.rand((batch, settings.prediction_horizon, 4), generator=generator()) * 2 - 1
    return observations, actions


# settings

def test_every_name_in_the_settings_can_be_built():
    assert set(get_args(Training.model_fields["encoder"].annotation)) == set(ENCODERS)
    assert set(get_args(Training.model_fields["denoiser"].annotation)) == set(DENOISERS)


@pytest.mark.parametrize("message, changes", [
    ("is 5, but only 4 timesteps are predicted", {"action_horizon": 4}),
    ("100 is not a multiple of inference_steps 30", {"inference_steps": 30}),
    ("warmup_steps 200 exceeds gradient_steps 100", {"gradient_steps": 100}),
    ("crop_pixels 88 with keypoints", {"crop_pixels": 88}),
    ("not a multiple of 8, which 4 U-Net levels need", {"denoiser": "unet", "unet_widths": (8, 8, 8, 8)}),
    ("not multiples of 8", {"denoiser": "unet", "unet_widths": (12,)}),
    ("learning_frames 2 is not below", {"learning_frames": 2}),
    ("Extra inputs", {"learning_rat": 1e-3}),
    ("valid number", {"learning_rate": "1e-3"}),
    ("finite number", {"learning_rate": float("inf")}),
    ("valid integer", {"batch_size": 64.5}),
    ("Input should be 'keypoints'", {"encoder": "resnet"}),
])
def test_impossible_settings_are_refused(message, changes):
    with pytest.raises(ValidationError, match=message):
        recipes.keypoints(**changes)


def test_settings_survive_json():
    settings = recipes.keypoints(denoiser="unet", unet_widths=[16, 32])
    assert Training(**settings.model_dump(mode="json")) == settings
    assert Training.model_validate_json(settings.model_dump_json()) == settings


def test_every_setting_says_what_it_means():
    assert [name for name, field in Training.model_fields.items() if not field.description] == []


# schedule

def squared_cosine_abar(steps: int) -> list[float]:
    """Product of 1 - beta over the squared-cosine schedule, written out."""
    level = [math.cos((i / steps + 0.008) / 1.008 * math.pi / 2) ** 2 for i in range(steps + 1)]
    alpha_bar, product = [], 1.0
    for i in range(steps):
        product *= 1 - min(1 - level[i + 1] / level[i], 0.999)
        alpha_bar.append(product)
    return alpha_bar


@pytest.mark.parametrize("target", ["sample", "noise"])
@pytest.mark.parametrize("time", [90, 50, 0])
def test_a_step_is_equation_5(target, time):
    schedule, alpha_bar = noise_schedule(keypoint_settings(target=target)), squared_cosine_abar(100)
    now, before = alpha_bar[time], alpha_bar[time - 10] if time else 1.0
    clean = torch.rand((3, 4, 4), generator=generator(), dtype=torch.float64) - 0.5  # the clip does not act
    eps = torch.randn((3, 4, 4), generator=generator(1), dtype=torch.float64)
    x = math.sqrt(now) * clean + math.sqrt(1 - now) * eps
    by_hand = math.sqrt(before) * (x - math.sqrt(1 - now) * eps) / math.sqrt(now) + math.sqrt(1 - before) * eps
    step = schedule.step(clean if target == "sample" else eps, time, x).prev_sample
    torch.testing.assert_close(step, by_hand, rtol=0, atol=2e-5)


def test_noise_is_added_as_the_docstring_says():
    schedule, alpha_bar = noise_schedule(keypoint_settings()), torch.tensor(squared_cosine_abar(100))
    clean, noise = torch.randn((100, 4, 4), generator=generator()), torch.randn((100, 4, 4), generator=generator(1))
    level = alpha_bar[:, None, None]
    noisy = schedule.add_noise(clean, noise, torch.arange(100))
    torch.testing.assert_close(noisy, level.sqrt() * clean + (1 - level).sqrt() * noise, rtol=0, atol=1e-5)


def test_acting_takes_ten_steps_down_to_zero():
    assert noise_schedule(keypoint_settings()).timesteps.tolist() == [90, 80, 70, 60, 50, 40, 30, 20, 10, 0]


# parts

def test_limits_map_the_data_to_one_and_back():
    values = np.random.default_rng(0).normal(size=(50, 3)).astype(np.float32) * [1, 10, 0.1] + [5, 0, 0]
    limits = MinMaxNormalizer(3)
    limits.fit(values.astype(np.float32))
    mapped = limits(torch.from_numpy(values.astype(np.float32)))
    torch.testing.assert_close(mapped.amin(0), -torch.ones(3), rtol=0, atol=1e-4)
    torch.testing.assert_close(mapped.amax(0), torch.ones(3), rtol=0, atol=1e-4)
    torch.testing.assert_close(limits.inverse(mapped).numpy(), values.astype(np.float32), rtol=0, atol=1e-4)


def test_a_coordinate_that_never_changed_stays_moderate():
    values = np.full((50, 2), 0.3, np.float32)
    values[0, 1] += 2e-7  # seven steps of float32
    limits = MinMaxNormalizer(2)
    limits.fit(values)
    assert limits(torch.from_numpy(values)).abs().max() < 1e-5
    assert limits(torch.tensor([[0.8, 0.8]])).abs().max() <= 0.51


def collected(task: str, **changes) -> Demonstrations:
    return collect(Collection(task=task, timesteps=150, **{"method": "move", **changes}), 0)[0]


@pytest.mark.parametrize("task, changes", [
    ("pick-place", {}), ("pick-place", {"protocol": "sparse", "factors": "object"}), ("faucet-open", {}),
    ("assembly", {"method": "static", "factors": "object"}), ("hammer", {"method": "adc"})])
def test_the_limits_of_collections_are_to_the_bit_what_they_were_with_a_millimetre_as_constant(task, changes):
    made = collected(task, **changes)
    for values in (made.observations, made.actions):
        low, high = torch.from_numpy(values.min(0)), torch.from_numpy(values.max(0))
        scale = torch.where(high - low > 1e-3, 2 / (high - low).clamp(min=1e-3), 1.0)
        limits = MinMaxNormalizer(values.shape[1])
        limits.fit(values)
        assert torch.equal(limits.scale, scale) and torch.equal(limits.offset, -scale * (low + high) / 2)
    bounds = MinMaxNormalizer(made.actions.shape[1])
    bounds.fit(made.actions)
    assert [set(bound.tolist()) for bound in bounds.limits()] == [{-1.0}, {1.0}]


@pytest.mark.parametrize("size", [4e-4, 1e-5, 1e-12, 1e-30, 0.3, 25.0, 1e6])
@pytest.mark.parametrize("centre", [0.0, 1.0, -3.0])
def test_a_motion_of_any_size_is_normalised_and_given_back(size, centre):
    values = (np.linspace(-1, 1, 50)[:, None] * [size, 2 * size] + centre * size).astype(np.float32)
    limits = MinMaxNormalizer(2)
    limits.fit(values)
    mapped = limits(torch.from_numpy(values))
    torch.testing.assert_close(mapped.aminmax(dim=0), (-torch.ones(2), torch.ones(2)), rtol=0, atol=1e-5)
    torch.testing.assert_close(limits.inverse(mapped), torch.from_numpy(values), rtol=1e-4, atol=1e-5 * size)
    low, high = limits.limits()
    reached = torch.from_numpy(values)
    assert (reached.clamp(low, high) - reached).abs().max() <= 1e-5 * size
    assert low.max() <= -1 and high.min() >= 1


@pytest.mark.parametrize("low, high, expected", [
    (0.0, 2.0, (-1, 2)), (1.0, 1.0, (-1, 1)), (0.5, 0.5, (-1, 1)), (5.0, 5.0, (-1, 5)), (-1.0, 1.0, (-1, 1)),
    (-2.0, 0.0, (-2, 1)), (-0.5, 0.25, (-1, 1)), (-7.0, 9.0, (-7, 9)), (0.0, 0.0, (-1, 1))])
def test_what_a_policy_does_stays_within_one_or_the_demonstrations(low, high, expected):
    limits = MinMaxNormalizer(1)
    limits.fit(np.array([[low], [high]], np.float32))
    assert [bound.item() for bound in limits.limits()] == pytest.approx(expected, abs=1e-5)


def test_spatial_softmax_finds_a_bright_spot():
    softmax = SpatialSoftmax(1, 1, height=5, width=9)
    with torch.no_grad():
        softmax.keypoint_logits.weight.fill_(100)
        maps = torch.zeros(1, 1, 5, 9)
        maps[0, 0, 4, 2] = 1  # the lowest row, a quarter from the left
        assert softmax(maps).tolist() == [[pytest.approx(-0.5), pytest.approx(1.0)]]


@pytest.mark.parametrize("pixels", [16, 27, 88])
def test_small_cnn_takes_any_size(pixels):
    encoder = SmallCNN(image_settings(), (pixels, pixels, 3))
    assert encoder(torch.randn(2, 3, pixels, pixels)).shape == (2, encoder.features)


@pytest.mark.parametrize("pixels", [33, 80])
def test_resnet18_has_the_size_of_resnet18(pixels):
    encoder = ResNet18(image_settings(cnn_points=32), (pixels, pixels, 3))
    assert encoder(torch.randn(2, 3, pixels, pixels)).shape == (2, 64)
    size = sum(weight.numel() for weight in encoder.backbone.parameters())
    assert size == 11_176_512  # torchvision's, without its head


@pytest.mark.parametrize("horizon, widths", [(4, (16, 32, 64)), (4, (16,)), (8, (16, 24, 32, 40)), (16, (8, 16))])
def test_unet_shapes(horizon, widths):
    settings = keypoint_settings(denoiser="unet", prediction_horizon=horizon, unet_widths=widths)
    predicted = UNet(settings, 4, 10)(torch.randn(5, horizon, 4), torch.arange(5), torch.randn(5, 10))
    assert predicted.shape == (5, horizon, 4)


@pytest.mark.parametrize("denoiser", [ResidualMLP, UNet])
def test_a_denoiser_uses_actions_time_and_condition(denoiser):
    network = denoiser(keypoint_settings(unet_widths=(16, 32)), 4, 10)
    noisy, time, condition = torch.randn(3, 4, 4), torch.tensor([1, 50, 99]), torch.randn(3, 10)
    plain = network(noisy, time, condition)
    assert not torch.allclose(plain, network(noisy + 1, time, condition))
    assert not torch.allclose(plain, network(noisy, time - 1, condition))
    assert not torch.allclose(plain, network(noisy, time, condition + 1))


def test_crops():
    images = torch.arange(6 * 2 * 5 * 5 * 3, dtype=torch.int32).view(6, 2, 5, 5, 3)
    assert torch.equal(crop(images, 3), images[:, :, 1:4, 1:4])
    random = crop(images, 3, generator())
    places = [(y, x) for i in range(6) for y in range(3) for x in range(3)
              if torch.equal(random[i], images[i, :, y:y + 3, x:x + 3])]  # both frames of a window at one place
    assert len(places) == 6 and len(set(places)) > 1


# policy

CASES = [keypoint_settings(), keypoint_settings(denoiser="unet", unet_widths=(16, 32), target="noise"),
         keypoint_settings(observation_horizon=3, prediction_horizon=8, action_horizon=5), image_settings(),
         image_settings(denoiser="unet", unet_widths=(16, 32), crop_pixels=None)]


@pytest.mark.parametrize("settings", CASES)
def test_loss_and_actions_of_every_kind_of_policy(settings):
    observations, actions = windows(settings, 5)
    made = policy(settings, tuple(observations.shape[2:]))
    loss = made.loss(observations, actions, generator())
    assert loss.shape == () and 0 < loss.item() < 10
    loss.backward()
    assert all(weight.grad is not None for weight in made.parameters())
    executed = made.act(observations.numpy(), generator())
    assert executed.shape == (5, settings.action_horizon, 4) and executed.dtype == np.float32
    assert np.abs(executed).max() <= 1


@pytest.mark.parametrize("settings", CASES)
def test_an_episode_does_not_depend_on_who_else_is_in_the_batch(settings):
    observations, _ = windows(settings, 5)
    made = policy(settings, tuple(observations.shape[2:]))
    noise = torch.randn((5, settings.prediction_horizon, 4), generator=generator())
    together = made.act(observations.numpy(), noise=noise)
    for i in range(5):
        alone = made.act(observations[i:i + 1].numpy(), noise=noise[i:i + 1])
        np.testing.assert_allclose(alone[0], together[i], rtol=0, atol=1e-4)


@pytest.mark.parametrize("settings", [keypoint_settings(), image_settings()])
def test_randomness_is_the_generator_and_nothing_else(settings):
    observations, actions = windows(settings, 5)
    made = policy(settings, tuple(observations.shape[2:]))
    before = torch.random.get_rng_state()
    losses = [made.loss(observations, actions, generator(seed)).item() for seed in (0, 0, 1)]
    executed = [made.act(observations.numpy(), generator(seed)) for seed in (0, 0, 1)]
    assert losses[0] == losses[1] != losses[2]
    assert np.array_equal(executed[0], executed[1]) and not np.array_equal(executed[0], executed[2])
    assert torch.equal(torch.random.get_rng_state(), before)


def test_executed_actions_are_the_prediction_from_the_last_observed_timestep_on():
    settings = keypoint_settings()
    made = policy(settings, (6,))
    prediction = torch.linspace(-0.8, 0.8, 16).view(1, 4, 4)
    made.denoiser.forward = lambda noisy, time, condition: prediction.expand_as(noisy)
    executed = made.act(np.zeros((1, 2, 6), np.float32), generator())
    np.testing.assert_allclose(executed[0], prediction[0, 1:4], atol=1e-5)


def test_limits_come_from_the_demonstrations():
    rng = np.random.default_rng(0)
    actions = rng.uniform(-0.2, 0.1, (40, 4)).astype(np.float32)
    made = policy(keypoint_settings(), (6,))
    made.fit_normalizers(Demonstrations(rng.normal(size=(40, 6)).astype(np.float32), actions, np.array([40])))
    executed = made.act(np.zeros((64, 2, 6), np.float32), generator())
    assert executed.min() >= actions.min() - 1e-5 and executed.max() <= actions.max() + 1e-5


@pytest.mark.parametrize("message, settings, shape", [
    ("'keypoints'", keypoint_settings(), (32, 32, 3)),
    ("'small_cnn'", image_settings(), (6,)),
    ("crop_pixels 28 from images of", image_settings(), (20, 32, 3)),
])
def test_observations_that_do_not_suit_the_settings_are_refused(message, settings, shape):
    with pytest.raises(BadInput, match=message):
        DiffusionPolicy(settings, shape, 4)


def test_acting_on_the_wrong_shape_is_refused():
    with pytest.raises(BadInput, match=r"expects \(batch, 2, 6\)"):
        policy(keypoint_settings(), (6,)).act(np.zeros((1, 2, 7), np.float32), generator())


# what makes the laptop recipe fast

def test_observations_are_encoded_once_for_all_noise_draws(monkeypatch):
    settings = image_settings(noise_draws=5)
    one, encoded = policy(settings, (32, 32, 3)), []
    monkeypatch.setattr(one.encoder, "forward", lambda images, real=one.encoder.forward: (
        encoded.append(len(images)), real(images))[1])
    denoised = []
    monkeypatch.setattr(one.denoiser, "forward", lambda noisy, time, condition, real=one.denoiser.forward: (
        denoised.append((len(noisy), len(set(time.tolist())), condition)), real(noisy, time, condition))[1])
    one.loss(*windows(settings, 3), generator())
    assert sum(encoded) == 6
    rows, levels, condition = denoised[0]
    assert rows == 15 and levels > 5  # every draw has its own noise level ...
    assert torch.equal(condition[:3], condition[12:])  # ... and its window's condition


def test_many_noise_draws_average_to_the_same_loss():
    few, many = (policy(keypoint_settings(noise_draws=draws), (6,)) for draws in (1, 400))
    observations, actions = windows(keypoint_settings(), 8)
    singles = np.mean([few.loss(observations, actions, generator(seed)).item() for seed in range(400)])
    assert many.loss(observations, actions, generator()).item() == pytest.approx(singles, rel=0.05)


def test_the_encoder_learns_from_the_newest_frames_alone_but_sees_all():
    def gradients_and_loss(learning: int | None, observations: torch.Tensor) -> tuple[torch.Tensor, float]:
        one = policy(image_settings(learning_frames=learning), (32, 32, 3))
        loss = one.loss(observations, actions, generator())
        loss.backward()
        return one.encoder.backbone[0].weight.grad, loss.item()

    observations, actions = windows(image_settings(), 3)
    black = observations.clone()
    black[:, 0] = 0
    every, whole = gradients_and_loss(None, observations)
    newest, same = gradients_and_loss(1, observations)
    _, other = gradients_and_loss(1, black)
    assert same == pytest.approx(whole) != other  # the older frame is seen ...
    assert not torch.allclose(newest, every, rtol=0.01)  # ... but not learnt from


def test_a_large_gain_gives_every_pattern_a_place_of_its_own():
    maps = torch.randn(1, 16, 22, 22, generator=generator())
    spread = []
    for gain in (1.0, 16.0):
        with torch.random.fork_rng():
            torch.manual_seed(0)
            spread.append(SpatialSoftmax(16, 32, 22, 22, gain)(maps).std().item())
    assert spread[1] > 2 * spread[0]


@pytest.mark.parametrize("timesteps, taps", [(1, 5), (2, 5), (4, 5), (3, 3)])
def test_a_convolution_along_time_is_pytorchs_with_its_gradients(timesteps, taps):
    ours = TimeConvolution(6, 8, taps, padding=taps // 2)
    theirs = torch.nn.Conv1d(6, 8, taps, padding=taps // 2)
    theirs.load_state_dict(ours.state_dict())
    seen, wanted = torch.randn(3, 6, timesteps), torch.randn(3, 8, timesteps)
    for network in (ours, theirs):
        ((network(seen) - wanted) ** 2).sum().backward()
    torch.testing.assert_close(ours(seen), theirs(seen))
    torch.testing.assert_close(ours.weight.grad, theirs.weight.grad)
    torch.testing.assert_close(ours.bias.grad, theirs.bias.grad)
