"""One observation to features: keypoints as they are, or an image through a small CNN.

Keypoints   (N, coordinates) as they are
SmallCNN    (N, 3, H, W), a few convolutions and a spatial softmax, small enough for a CPU

An encoder is built from the settings and the shape of one observation, and says in `features` what it returns.
"""

from collections.abc import Callable

import torch
from torch import Tensor, nn

from move.learn.settings import Training


class Keypoints(nn.Module):
    """Hands keypoints on as they are, (N, coordinates) float32 in [-1, 1]."""

    def __init__(self, training: Training, observation_shape: tuple[int, ...]) -> None:
        super().__init__()
        (self.features,) = observation_shape

    def forward(self, observation: Tensor) -> Tensor:
        return observation


class SpatialSoftmax(nn.Module):
    """Where in a feature map each of `points` learned patterns lies.

    (N, channels, H, W) -> (N, 2 * points) float32: x, then y, in [-1, 1] of each pattern's centre of mass. All of it
    stays in channels-last order, in which the convolutions before it work; a change of order costs more than they do.
    """

    def __init__(self, channels: int, points: int, height: int, width: int) -> None:
        super().__init__()
        self.pattern = nn.Linear(channels, points)
        y, x = torch.meshgrid(torch.linspace(-1, 1, height), torch.linspace(-1, 1, width), indexing="ij")
        self.register_buffer("grid", torch.stack([x.flatten(), y.flatten()]), persistent=False)  # (2, H * W)

    def forward(self, maps: Tensor) -> Tensor:
        mass = self.pattern(maps.permute(0, 2, 3, 1).flatten(1, 2)).float().softmax(1)  # (N, H * W, points)
        with torch.autocast(maps.device.type, enabled=False):  # a place needs more digits than bfloat16 has
            return torch.bmm(self.grid.expand(len(mass), -1, -1), mass).flatten(1)


class ResidualBlock(nn.Module):
    """x + two 3 x 3 convolutions of x, at the same resolution and width."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.change = nn.Sequential(
            nn.SiLU(), nn.Conv2d(channels, channels, 3, padding=1),
            nn.SiLU(), nn.Conv2d(channels, channels, 3, padding=1),
        )

    def forward(self, maps: Tensor) -> Tensor:
        return maps + self.change(maps)


class SmallCNN(nn.Module):
    """Strided convolutions, residual blocks, spatial softmax: (N, 3, H, W) in [-1, 1] -> (N, 2 * points)."""

    def __init__(self, training: Training, observation_shape: tuple[int, ...]) -> None:
        super().__init__()
        height, width, channels = observation_shape
        layers: list[nn.Module] = []
        for i, wider in enumerate(training.cnn_widths):
            kernel = 5 if i == 0 else 3
            layers += [nn.Conv2d(channels, wider, kernel, stride=2, padding=kernel // 2), nn.SiLU()]
            channels, height, width = wider, -(-height // 2), -(-width // 2)
        layers.pop()  # a residual block begins with one
        layers += [ResidualBlock(channels) for _ in range(training.cnn_blocks)]
        self.maps = nn.Sequential(*layers, nn.SiLU())
        self.places = SpatialSoftmax(channels, training.cnn_points, height, width)
        self.features = 2 * training.cnn_points

    def forward(self, image: Tensor) -> Tensor:
        return self.places(self.maps(image))


ENCODERS: dict[str, Callable[[Training, tuple[int, ...]], nn.Module]] = {
    "keypoints": Keypoints,
    "small_cnn": SmallCNN,
}
