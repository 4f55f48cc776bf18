"""Every number that decides how a policy is built and trained."""

from typing import Annotated, Literal, Self

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    NonNegativeFloat,
    NonNegativeInt,
    PositiveFloat,
    PositiveInt,
    model_validator,
)

Horizon = Annotated[int, Field(gt=0, le=1000)]
Width = Annotated[int, Field(gt=0, le=2**14)]  # features or channels
Depth = Annotated[int, Field(ge=0, le=200)]
Widths = Annotated[tuple[Width, ...], Field(strict=False, min_length=1, max_length=10)]  # YAML writes tuples as lists
GROUPS = 8  # of every group normalisation


class Training(BaseModel):
    """How to build and train one Diffusion Policy; what the paper's Table 4 gives is the default.

    Raises pydantic.ValidationError, a ValueError, for an unknown field, a wrong type or an impossible combination.

    >>> Training(encoder="keypoints", denoiser="mlp", gradient_steps=1000).batch_size
    128
    """

    model_config = ConfigDict(
        frozen=True, strict=True, extra="forbid", allow_inf_nan=False, hide_input_in_errors=True
    )

    encoder: Literal["keypoints", "small_cnn", "resnet18"] = Field(
        description="from one observation to features")
    denoiser: Literal["mlp", "unet"] = Field(description="from noisy actions to a prediction")
    target: Literal["sample", "noise"] = Field(default="sample", description="what the denoiser predicts")
    observation_horizon: Horizon = Field(default=2, description="timesteps observed")
    prediction_horizon: Horizon = Field(default=4, description="timesteps of actions predicted")
    action_horizon: Horizon = Field(default=3, description="timesteps of actions executed")
    diffusion_steps: PositiveInt = Field(default=100, le=10**4, description="noise levels in training")
    inference_steps: PositiveInt = Field(default=10, le=10**4, description="DDIM steps that make an action")
    gradient_steps: PositiveInt = Field(le=10**7, description="optimiser steps")
    batch_size: PositiveInt = Field(default=128, le=10**5, description="windows in a gradient step")
    noise_draws: PositiveInt = Field(default=1, le=1000, description="noise levels tried on each window of a batch")
    learning_rate: PositiveFloat = Field(default=1e-4, le=1, description="of AdamW, after the warm-up")
    beta1: float = Field(default=0.95, gt=0, lt=1, description="of AdamW, decay of the mean gradient")
    beta2: float = Field(default=0.999, gt=0, lt=1, description="of AdamW, decay of the mean squared gradient")
    weight_decay: NonNegativeFloat = Field(default=1e-6, description="of AdamW, share of the learning rate")
    warmup_steps: NonNegativeInt = Field(default=500, description="gradient steps of linear warm-up, before the cosine")
    ema_power: PositiveFloat = Field(
        default=0.75, description="decay of the averaged weights is 1 - (1 + step)^-power ..."
    )
    ema_decay: float = Field(default=0.9999, ge=0, lt=1, description="... but never above this")
    crop_pixels: PositiveInt | None = Field(
        default=None, description="side of the crop, random in training, pixels; or none"
    )
    learning_frames: PositiveInt | None = Field(
        default=None,
        description="newest frames of a window from which the encoder learns, the older ones pass it only; or all"
    )
    cnn_width: Width = Field(default=32, description="channels of small_cnn")
    cnn_blocks: Depth = Field(default=2, description="residual blocks of small_cnn")
    cnn_points: Width = Field(default=32, description="points that the spatial softmax locates")
    softmax_gain: PositiveFloat = Field(default=1.0, description="on the first weights of small_cnn's spatial softmax")
    mlp_width: Width = Field(default=256, description="features of the MLP denoiser")
    mlp_depth: Depth = Field(default=3, gt=0, description="residual blocks of the MLP denoiser")
    unet_widths: Widths = Field(
        default=(512, 1024, 2048), description="channels of the U-Net denoiser, finest level first"
    )
    precision: Literal["float32", "bfloat16"] = Field(
        default="float32", description="of training; bfloat16 where it is fast"
    )

    @model_validator(mode="after")
    def _refuse_the_impossible(self) -> Self:
        unet, shrink = self.denoiser == "unet", 2 ** (len(self.unet_widths) - 1)
        rules = [
            (self.predicted_horizon <= self.prediction_horizon,
             f"observation_horizon - 1 + action_horizon is {self.predicted_horizon}, "
             f"but only {self.prediction_horizon} timesteps are predicted"),
            (not unet or self.prediction_horizon % shrink == 0,
             f"prediction_horizon {self.prediction_horizon} is not a multiple of {shrink}, "
             f"which {len(self.unet_widths)} U-Net levels need"),
            (not unet or all(width % GROUPS == 0 for width in self.unet_widths),
             f"unet_widths {self.unet_widths} are not multiples of {GROUPS}, the groups of its normalisation"),
            (self.diffusion_steps % self.inference_steps == 0,
             f"diffusion_steps {self.diffusion_steps} is not a multiple of inference_steps {self.inference_steps}"),
            (self.warmup_steps <= self.gradient_steps,
             f"warmup_steps {self.warmup_steps} exceeds gradient_steps {self.gradient_steps}"),
            (self.encoder != "keypoints" or self.crop_pixels is None,
             f"crop_pixels {self.crop_pixels} with keypoints; only images are cropped"),
            (self.learning_frames is None or self.learning_frames < self.observation_horizon,
             f"learning_frames {self.learning_frames} is not below observation_horizon {self.observation_horizon}"),
        ]
        broken = [reason for holds, reason in rules if not holds]
        if broken:
            raise ValueError("; ".join(broken))
        return self

    @property
    def predicted_horizon(self) -> int:
        """Timesteps from the first one observed to the last one executed."""
        return self.observation_horizon - 1 + self.action_horizon

    @property
    def executed(self) -> slice:
        """Which of the predicted timesteps are executed."""
        return slice(self.observation_horizon - 1, self.predicted_horizon)
