"""Noisy actions, diffusion time and condition to a prediction, (B, prediction_horizon, action_size).

ResidualMLP   all predicted timesteps at once; small and fast on a CPU
UNet          convolutions along time, FiLM conditioning; Diffusion Policy's own, at its own widths

A denoiser is built from the settings, the size of an action and the size of the condition.
"""

import math
from collections.abc import Callable

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from move.learn.settings import GROUPS, Training

TIME_FEATURES = 64


class TimeFeatures(nn.Module):
    """Sines and cosines of the diffusion time: (B,) int64 -> (B, TIME_FEATURES), looked up in a table."""

    table: Tensor

    def __init__(self, diffusion_steps: int) -> None:
        super().__init__()
        half = TIME_FEATURES // 2
        frequency = torch.exp(torch.arange(half) * (-math.log(10_000) / (half - 1)))
        angle = torch.arange(diffusion_steps)[:, None] * frequency
        self.register_buffer("table", torch.cat([angle.sin(), angle.cos()], -1), persistent=False)

    def forward(self, time: Tensor) -> Tensor:
        """Features of diffusion times: (B,) int64 -> (B, TIME_FEATURES) float32."""
        return self.table[time]


class ResidualMLP(nn.Module):
    """Blocks of layer norm, linear, SiLU, linear around a residual stream."""

    def __init__(self, training: Training, action_size: int, condition_size: int) -> None:
        super().__init__()
        size, width = training.prediction_horizon * action_size, training.mlp_width
        self.time = TimeFeatures(training.diffusion_steps)
        self.input_projection = nn.Linear(size + condition_size + TIME_FEATURES, width)
        self.blocks = nn.ModuleList(
            nn.Sequential(nn.LayerNorm(width), nn.Linear(width, 2 * width), nn.SiLU(), nn.Linear(2 * width, width))
            for _ in range(training.mlp_depth)
        )
        self.output_projection = nn.Sequential(nn.LayerNorm(width), nn.Linear(width, size))

    def forward(self, noisy: Tensor, time: Tensor, condition: Tensor) -> Tensor:
        """(B, T, action_size), (B,) int64 and (B, condition_size) to a prediction, (B, T, action_size)."""
        stream = self.input_projection(torch.cat([noisy.flatten(1), condition, self.time(time)], -1))
        for block in self.blocks:
            stream = stream + block(stream)
        return self.output_projection(stream).view_as(noisy)


class TimeConvolution(nn.Conv1d):
    """A convolution along few timesteps, padded to as many: (B, channels, T) -> (B, wider, T).

    On a CPU it is one matrix product: a convolution's gradient by millions of weights takes four times as long there.
    """

    def forward(self, x: Tensor) -> Tensor:
        """(B, channels, T) -> (B, wider, T)."""
        if x.device.type != "cpu":
            return super().forward(x)
        (taps,) = self.kernel_size
        windows = F.pad(x, (taps // 2, taps // 2)).unfold(2, taps, 1)  # (B, channels, T, taps)
        return F.linear(windows.transpose(1, 2).flatten(2), self.weight.flatten(1), self.bias).transpose(1, 2)


def convolution(channels: int, wider: int) -> nn.Sequential:
    """Convolution along time, group norm, SiLU: (B, channels, T) -> (B, wider, T)."""
    return nn.Sequential(TimeConvolution(channels, wider, 5, padding=2), nn.GroupNorm(GROUPS, wider), nn.SiLU())


class FilmBlock(nn.Module):
    """Two convolutions; the condition scales and shifts the channels between them (FiLM)."""

    def __init__(self, channels: int, wider: int, condition_size: int) -> None:
        super().__init__()
        self.first, self.second = convolution(channels, wider), convolution(wider, wider)
        self.film = nn.Sequential(nn.SiLU(), nn.Linear(condition_size, 2 * wider))
        self.shortcut = nn.Conv1d(channels, wider, 1) if channels != wider else nn.Identity()

    def forward(self, x: Tensor, condition: Tensor) -> Tensor:
        """(B, channels, T) under (B, condition_size) -> (B, wider, T)."""
        scale, shift = self.film(condition)[..., None].chunk(2, dim=1)
        return self.second(scale * self.first(x) + shift) + self.shortcut(x)


class FilmPair(nn.Module):
    """Two FiLM blocks, the first of which changes the width."""

    def __init__(self, channels: int, wider: int, condition_size: int) -> None:
        super().__init__()
        self.first, self.second = FilmBlock(channels, wider, condition_size), FilmBlock(wider, wider, condition_size)

    def forward(self, x: Tensor, condition: Tensor) -> Tensor:
        """(B, channels, T) under (B, condition_size) -> (B, wider, T)."""
        return self.second(self.first(x, condition), condition)


class UNet(nn.Module):
    """Conditional 1-D U-Net over the predicted timesteps, halved between its levels: 4, 2, 1 for three widths."""

    def __init__(self, training: Training, action_size: int, condition_size: int) -> None:
        super().__init__()
        widths = training.unet_widths
        size = condition_size + 4 * TIME_FEATURES
        self.time = nn.Sequential(
            TimeFeatures(training.diffusion_steps),
            nn.Linear(TIME_FEATURES, 16 * TIME_FEATURES), nn.SiLU(), nn.Linear(16 * TIME_FEATURES, 4 * TIME_FEATURES),
        )
        self.down = nn.ModuleList(FilmPair(a, b, size) for a, b in zip((action_size, *widths), widths, strict=False))
        self.downsample = nn.ModuleList(nn.Conv1d(w, w, 3, stride=2, padding=1) for w in widths[:-1])
        self.middle = FilmPair(widths[-1], widths[-1], size)
        self.up = nn.ModuleList(FilmPair(2 * b, a, size) for a, b in zip(widths, widths[1:], strict=False))
        self.upsample = nn.ModuleList(nn.ConvTranspose1d(w, w, 4, stride=2, padding=1) for w in widths[:-1])
        self.output_projection = nn.Sequential(convolution(widths[0], widths[0]), nn.Conv1d(widths[0], action_size, 1))

    def forward(self, noisy: Tensor, time: Tensor, condition: Tensor) -> Tensor:
        """(B, T, action_size), (B,) int64 and (B, condition_size) to a prediction, (B, T, action_size)."""
        condition = torch.cat([self.time(time), condition], -1)
        x, skips = noisy.transpose(1, 2), []
        for i, down in enumerate(self.down):
            x = down(x if i == 0 else self.downsample[i - 1](x), condition)
            skips.append(x)
        x = self.middle(x, condition)
        for i in reversed(range(len(self.up))):
            x = self.upsample[i](self.up[i](torch.cat([x, skips[i + 1]], 1), condition))
        return self.output_projection(x).transpose(1, 2)


DENOISERS: dict[str, Callable[[Training, int, int], nn.Module]] = {
    "mlp": ResidualMLP,
    "unet": UNet,
}
