"""The Diffusion Policy: from two observations to three actions by denoising.

Training adds noise of a random strength t to the actions that the expert took (alpha_bar falls from 1 to 0 with t),

    noisy = sqrt(abar_t) * actions + sqrt(1 - abar_t) * noise

and the denoiser learns to say from `noisy`, t and the observations what the actions were (target "sample") or
what the noise was (target "noise"). Acting starts from noise alone and takes DDIM steps down to t = 0 (paper,
equation 5); the two targets take the same step, since either follows from the other:

    x_{t-1} = sqrt(abar_{t-1}) * (x_t - sqrt(1 - abar_t) * eps) / sqrt(abar_t) + sqrt(1 - abar_{t-1}) * eps
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np
import torch
from torch import IntTensor, Tensor, nn
from torch.nn import functional as F

from move.errors import BadInput
from move.learn.denoisers import DENOISERS
from move.learn.encoders import ENCODERS
from move.learn.settings import Training
from move.sim.demonstrations import Demonstrations
from move.sim.observe import KEYPOINTS, ObservationSpec

if TYPE_CHECKING:
    from diffusers.schedulers.scheduling_ddim import DDIMScheduler, DDIMSchedulerOutput

PREDICTION_TYPE = {"sample": "sample", "noise": "epsilon"}
RESOLUTION = 1e-6  # of a coordinate's size, eight steps of float32: what differs by less in all the data is constant
SMALLEST = 1e-36  # in any unit: below it float32 holds no scale


def noise_schedule(training: Training) -> DDIMScheduler:
    """Squared-cosine noise schedule with deterministic DDIM steps; predictions of actions clipped to [-1, 1]."""
    from diffusers.schedulers.scheduling_ddim import DDIMScheduler  # slow to import, and most commands build no policy

    schedule = DDIMScheduler(
        num_train_timesteps=training.diffusion_steps,
        beta_schedule="squaredcos_cap_v2",
        clip_sample=True,
        prediction_type=PREDICTION_TYPE[training.target],
    )
    schedule.set_timesteps(training.inference_steps)
    return schedule


class MinMaxNormalizer(nn.Module):
    """Maps each coordinate from its limits in the training data to [-1, 1], and back with `inverse`.

    A coordinate that never changed is centred and keeps its unit, so that a new value stays a moderate number. However
    small a motion is in its unit, it is one.
    """

    scale: Tensor
    offset: Tensor

    def __init__(self, size: int) -> None:
        super().__init__()
        self.register_buffer("scale", torch.ones(size))
        self.register_buffer("offset", torch.zeros(size))

    def fit(self, values: np.ndarray) -> None:
        """Take the limits from values (timesteps, size) float32."""
        low, high = torch.from_numpy(values.min(0)), torch.from_numpy(values.max(0))
        extent = high - low
        moves = extent > (RESOLUTION * torch.maximum(low.abs(), high.abs())).clamp(min=SMALLEST)
        scale = torch.where((extent == 2) & (low != -high), 1 - RESOLUTION, 2 / extent)  # 1 is for what is constant
        self.scale.copy_(torch.where(moves, scale, 1.0))
        self.offset.copy_(-self.scale * (low + high) / 2)

    def forward(self, values: Tensor) -> Tensor:
        """Data to [-1, 1]: (..., size) -> (..., size) float32."""
        return torch.addcmul(self.offset, values, self.scale)

    def inverse(self, values: Tensor) -> Tensor:
        """From [-1, 1] back to the data's own units: (..., size) -> (..., size) float32."""
        return (values - self.offset) / self.scale

    def limits(self) -> tuple[Tensor, Tensor]:
        """The lowest and the highest value of each coordinate, (size,) each; -1 and 1 where they are within these."""
        centre, unit = self.inverse(torch.zeros_like(self.scale)), self.scale.new_tensor([[-1.0], [1.0]])
        ends = torch.where(self.scale == 1, centre, self.inverse(unit))
        low, high = torch.where(ends.abs() > 1 + RESOLUTION, ends, unit)
        return low.clamp(max=-1), high.clamp(min=1)


class Pixels(nn.Module):
    """Images (N, H, W, 3) uint8 to (N, 3, H, W) in [-1, 1], in the precision that training runs in."""

    def forward(self, images: Tensor) -> Tensor:
        """(N, H, W, 3) uint8 -> (N, 3, H, W) in [-1, 1]."""
        device = images.device.type
        dtype = torch.get_autocast_dtype(device) if torch.is_autocast_enabled(device) else torch.float32
        return images.permute(0, 3, 1, 2).to(dtype).div_(127.5).sub_(1)  # stays in channels-last order


def crop(images: Tensor, pixels: int, generator: torch.Generator | None = None) -> Tensor:
    """Square cut-outs of windows of images, one place a window: random with a generator, else the centre.

    images (B, To, H, W, 3) -> (B, To, pixels, pixels, 3).
    """
    spare_y, spare_x = images.shape[2] - pixels, images.shape[3] - pixels
    if generator is None:
        y, x = spare_y // 2, spare_x // 2
        return images[:, :, y:y + pixels, x:x + pixels]
    windows, frames, height, width, channels = images.shape
    ys = torch.randint(spare_y + 1, (windows, 1, 1), generator=generator)
    xs = torch.randint(spare_x + 1, (windows, 1, 1), generator=generator)
    frame = torch.arange(windows * frames).view(windows, frames, 1)
    firsts = ((frame * height + ys + torch.arange(pixels)) * width + xs) * channels  # of each row of each cut-out
    rows = images.flatten().unfold(0, pixels * channels, 1)  # a view: as many numbers as a row has, from each number on
    return rows.index_select(0, to_device(firsts.flatten(), images.device)).view(
        windows, frames, pixels, pixels, channels)


def to_device(tensor: Tensor, device: torch.device) -> Tensor:
    """A CPU tensor on `device`; on the way to a GPU nobody waits for it."""
    return tensor.pin_memory().to(device, non_blocking=True) if device.type == "cuda" else tensor


class DiffusionPolicy(nn.Module):
    """Denoises actions under the condition of a few observations.

    observation_shape: of one timestep, (coordinates,) for keypoints or (H, W, 3) for images.
    Raises BadInput where it does not suit the encoder or the crop. The weights are drawn from torch's global
    generator, which `move.learn.train.train` seeds.
    """

    def __init__(self, training: Training, observation_shape: tuple[int, ...], action_size: int) -> None:
        super().__init__()
        seen = _seen_shape(training, observation_shape)
        self.training_settings, self.observation_shape, self.action_size = training, observation_shape, action_size
        self.observation_normalizer: MinMaxNormalizer | Pixels = (
            MinMaxNormalizer(seen[0]) if len(seen) == 1 else Pixels())
        self.action_normalizer = MinMaxNormalizer(action_size)
        self.encoder = ENCODERS[training.encoder](training, seen)
        self.encoder.to(memory_format=torch.channels_last)  # type: ignore[call-overload]  # torch leaves it untyped
        condition_size = training.observation_horizon * self.encoder.features
        self.denoiser = DENOISERS[training.denoiser](training, action_size, condition_size)
        self.schedule = noise_schedule(training)

    @property
    def observation(self) -> ObservationSpec:
        """What the policy has to be shown of each timestep."""
        image = len(self.observation_shape) == 3
        return ObservationSpec("rgb", self.observation_shape[0]) if image else KEYPOINTS

    def fit_normalizers(self, demonstrations: Demonstrations) -> None:
        """Take the limits of keypoints and actions from the training data."""
        self.action_normalizer.fit(demonstrations.actions)
        if isinstance(self.observation_normalizer, MinMaxNormalizer):
            self.observation_normalizer.fit(demonstrations.observations)

    def loss(self, observations: Tensor, actions: Tensor, generator: torch.Generator) -> Tensor:
        """Mean squared error of the denoiser at random noise levels, a scalar.

        Observations are encoded once and serve `noise_draws` noise levels: with images the encoder is what costs.

        observations (B, To, coordinates) float32 or (B, To, H, W, 3) uint8, actions (B, Tp, action_size) float32.
        The generator is a CPU one on every device, and gives crops, noise levels and noise in this order.
        """
        if self.training_settings.crop_pixels:
            observations = crop(observations, self.training_settings.crop_pixels, generator)
        draws = self.training_settings.noise_draws
        clean = self.action_normalizer(actions).repeat(draws, 1, 1)
        levels = torch.randint(self.training_settings.diffusion_steps, (len(clean),), generator=generator)
        time = to_device(levels, actions.device)
        noise = to_device(torch.randn(clean.shape, generator=generator), actions.device)
        noisy = self.schedule.add_noise(clean, noise, cast(IntTensor, time))
        condition = self._condition(observations).repeat(draws, 1)
        predicted = self.denoiser(noisy, time, condition)
        return F.mse_loss(predicted.float(), clean if self.training_settings.target == "sample" else noise)

    @torch.no_grad()
    def act(
        self, observations: np.ndarray, generator: torch.Generator | None = None, noise: Tensor | None = None
    ) -> np.ndarray:
        """The actions to execute next, (B, action_horizon, action_size) float32, for B episodes at once.

        They are in [-1, 1], or within the limits of the demonstrations where those go beyond.

        observations (B, To, ...) as in `loss`. The noise (B, Tp, action_size) to start from is drawn from the CPU
        generator, or given: then an episode's actions do not depend on which others are in the batch.
        """
        observed = torch.from_numpy(observations).to(self.action_normalizer.scale.device)
        self._check_observed(observed)
        if self.training_settings.crop_pixels:
            observed = crop(observed, self.training_settings.crop_pixels)
        if noise is None:
            shape = len(observed), self.training_settings.prediction_horizon, self.action_size
            noise = torch.randn(shape, generator=generator)
        actions = self._denoise(noise.to(observed.device), self._condition(observed))
        executed = self.action_normalizer.inverse(actions[:, self.training_settings.executed])
        return executed.clamp(*self.action_normalizer.limits()).cpu().numpy()

    def _condition(self, observations: Tensor) -> Tensor:
        """Features of all observations of a window side by side, (B, To * features)."""
        learning = self.training_settings.learning_frames
        if learning is None or not torch.is_grad_enabled():
            return self._encode(observations)
        with torch.no_grad():
            older = self._encode(observations[:, :-learning])
        return torch.cat([older, self._encode(observations[:, -learning:])], -1)

    def _encode(self, observations: Tensor) -> Tensor:
        each = self.encoder(self.observation_normalizer(observations.flatten(0, 1)))
        return each.view(len(observations), -1)

    def _denoise(self, actions: Tensor, condition: Tensor) -> Tensor:
        for time in self.schedule.timesteps:
            predicted = self.denoiser(actions, time.to(actions.device).expand(len(actions)), condition)
            actions = cast("DDIMSchedulerOutput", self.schedule.step(predicted, time, actions)).prev_sample
        return actions

    def _check_observed(self, observed: Tensor) -> None:
        expected = (self.training_settings.observation_horizon, *self.observation_shape)
        if tuple(observed.shape[1:]) != expected:
            raise BadInput(f"observations {tuple(observed.shape)}; this policy expects (batch, "
                           f"{', '.join(map(str, expected))})")


def _seen_shape(training: Training, observation_shape: tuple[int, ...]) -> tuple[int, ...]:
    """Shape of what the encoder sees of one observation, after the crop."""
    dimensions = 1 if training.encoder == "keypoints" else 3
    if len(observation_shape) != dimensions:
        raise BadInput(f"observations of shape {observation_shape} for encoder {training.encoder!r}; "
                       f"it takes {'(coordinates,)' if dimensions == 1 else '(height, width, 3)'}")
    if dimensions == 1:
        return observation_shape
    height, width, channels = observation_shape
    if training.crop_pixels:
        if training.crop_pixels > min(height, width):
            raise BadInput(f"crop_pixels {training.crop_pixels} from images of {height, width} pixels")
        height = width = training.crop_pixels
    return height, width, channels
