"""One observation to features: keypoints as they are, or an image through a CNN.

Keypoints   (N, coordinates) as they are
SmallCNN    (N, 3, H, W), a few convolutions and a spatial softmax, small enough for a CPU
ResNet18    (N, 3, H, W), the paper's scale: ResNet-18 with group norm, spatial softmax, 64 features

An encoder is built from the settings and the shape of one observation, and says in `features` what it returns.
"""

from collections.abc import Callable

import torch
from torch import Tensor, nn

from move.learn.settings import Training


class Encoder(nn.Module):
    """One observation (N, ...) to `features` numbers."""

    features: int


class Keypoints(Encoder):
    """Hands keypoints on as they are, (N, coordinates) float32 in [-1, 1]."""

    def __init__(self, training: Training, observation_shape: tuple[int, ...]) -> None:
        super().__init__()
        (self.features,) = observation_shape

    def forward(self, observation: Tensor) -> Tensor:
        """(N, coordinates) float32, unchanged."""
        return observation


class SpatialSoftmax(nn.Module):
    """Where in a feature map each of `points` learned keypoints lies.

    (N, channels, H, W) -> (N, 2 * points) float32: x, then y, in [-1, 1] of each keypoint's centre of mass. `gain`
    multiplies the first weights: at 1 every keypoint starts spread over the whole image, and learns slowly. All of it
    stays in channels-last order, in which the convolutions before it work; a change of order costs more than they do.
    """

    grid: Tensor

    def __init__(self, channels: int, points: int, height: int, width: int, gain: float = 1.0) -> None:
        super().__init__()
        self.keypoint_logits = nn.Linear(channels, points)
        with torch.no_grad():
            self.keypoint_logits.weight.mul_(gain)
        y, x = torch.meshgrid(torch.linspace(-1, 1, height), torch.linspace(-1, 1, width), indexing="ij")
        self.register_buffer("grid", torch.stack([x.flatten(), y.flatten()]), persistent=False)  # (2, H * W)

    def forward(self, maps: Tensor) -> Tensor:
        """(N, channels, H, W) -> (N, 2 * points) float32."""
        mass = self.keypoint_logits(maps.permute(0, 2, 3, 1).flatten(1, 2)).float().softmax(1)  # (N, H * W, points)
        with torch.autocast(maps.device.type, enabled=False):  # a place needs more digits than bfloat16 has
            return torch.bmm(self.grid.expand(len(mass), -1, -1), mass).flatten(1)


class ResidualBlock(nn.Module):
    """x + two 3 x 3 convolutions of x, at the same resolution and width."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.residual = nn.Sequential(
            nn.SiLU(), nn.Conv2d(channels, channels, 3, padding=1),
            nn.SiLU(), nn.Conv2d(channels, channels, 3, padding=1),
        )

    def forward(self, maps: Tensor) -> Tensor:
        """(N, channels, H, W) -> the same shape."""
        return maps + self.residual(maps)


class SmallCNN(Encoder):
    """One strided convolution, residual blocks, spatial softmax: (N, 3, H, W) in [-1, 1] -> (N, 2 * points).

    The first convolution sees overlapping patches of 8 pixels, one every 4: a cheap way to a quarter of the
    resolution, at which an object of 4 pixels still has a place of its own.
    """

    def __init__(self, training: Training, observation_shape: tuple[int, ...]) -> None:
        super().__init__()
        height, width, channels = observation_shape
        patches = nn.Conv2d(channels, training.cnn_width, 8, stride=4, padding=2)
        blocks = [ResidualBlock(training.cnn_width) for _ in range(training.cnn_blocks)]
        self.backbone = nn.Sequential(patches, *blocks, nn.SiLU())
        self.spatial_softmax = SpatialSoftmax(training.cnn_width, training.cnn_points, height // 4, width // 4,
                                     training.softmax_gain)
        self.features = 2 * training.cnn_points

    def forward(self, image: Tensor) -> Tensor:
        """(N, 3, H, W) in [-1, 1] -> (N, features)."""
        return self.spatial_softmax(self.backbone(image))


class BasicBlock(nn.Module):
    """ResNet's block of two 3 x 3 convolutions, with group norm in the place of batch norm."""

    def __init__(self, channels: int, wider: int, stride: int) -> None:
        super().__init__()
        self.residual = nn.Sequential(
            nn.Conv2d(channels, wider, 3, stride, padding=1, bias=False), _group_norm(wider), nn.ReLU(),
            nn.Conv2d(wider, wider, 3, padding=1, bias=False), _group_norm(wider),
        )
        self.shortcut: nn.Module = nn.Identity()
        if stride != 1 or channels != wider:
            self.shortcut = nn.Sequential(nn.Conv2d(channels, wider, 1, stride, bias=False), _group_norm(wider))

    def forward(self, maps: Tensor) -> Tensor:
        """(N, channels, H, W) -> (N, wider, H / stride, W / stride), rounded up."""
        return torch.relu(self.residual(maps) + self.shortcut(maps))


def _group_norm(channels: int) -> nn.GroupNorm:
    return nn.GroupNorm(channels // 16, channels)


class ResNet18(Encoder):
    """ResNet-18 from scratch, then spatial softmax and a linear layer: (N, 3, H, W) in [-1, 1] -> (N, 64)."""

    features = 64

    def __init__(self, training: Training, observation_shape: tuple[int, ...]) -> None:
        super().__init__()
        height, width, channels = observation_shape
        stages, before = [], 64
        for wider, stride in ((64, 1), (128, 2), (256, 2), (512, 2)):
            stages += [BasicBlock(before, wider, stride), BasicBlock(wider, wider, 1)]
            before = wider
        stem = nn.Conv2d(channels, 64, 7, stride=2, padding=3, bias=False)
        self.backbone = nn.Sequential(stem, _group_norm(64), nn.ReLU(), nn.MaxPool2d(3, 2, padding=1), *stages)
        self.spatial_softmax = SpatialSoftmax(512, training.cnn_points, -(-height // 32), -(-width // 32))
        self.output_projection = nn.Linear(2 * training.cnn_points, self.features)

    def forward(self, image: Tensor) -> Tensor:
        """(N, 3, H, W) in [-1, 1] -> (N, 64)."""
        return self.output_projection(self.spatial_softmax(self.backbone(image)))


ENCODERS: dict[str, Callable[[Training, tuple[int, ...]], Encoder]] = {
    "keypoints": Keypoints,
    "small_cnn": SmallCNN,
    "resnet18": ResNet18,
}
