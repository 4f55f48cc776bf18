"""Gradient steps: batches, learning rate, AdamW, averaged weights, and going on after an interruption.

Batch order, crops, noise levels and noise are a pure function of (seed, step). On the CPU in float32, training
that stopped and went on from its checkpoint therefore ends with the same bits as training straight through.
"""

import math
import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from filelock import FileLock, Timeout
from torch import Tensor

from move.errors import BadInput
from move.learn import checkpoint as checkpoints
from move.learn.checkpoint import Checkpoint, UnusableCheckpoint
from move.learn.dataset import window_indices
from move.learn.diffusion import DiffusionPolicy, to_device
from move.learn.settings import Training
from move.machine import keep_freed_memory, one_thread, precision_used
from move.sim.demonstrations import Demonstrations

CURVE_POINTS = 50
READ_EVERY = 100  # gradient steps between two looks at the losses, for each of which a GPU has to finish its work
CHECKPOINT_SECONDS = 180.0  # between two checkpoints; the environment variable says otherwise
VARIABLE = "MOVE_CHECKPOINT_SECONDS"
OnStep = Callable[[int, int, Tensor], None]
"""Called with the gradient steps done, how many there are, and the loss; reading that makes a GPU finish its work."""


@dataclass(frozen=True)
class TrainingReport:
    """What training did.

    curve: about 50 pairs (gradient steps done, mean loss since the pair before).
    seconds: of training, over all parts if it was interrupted. precision: the one really used.
    parameters: numbers that training fits.
    """

    curve: tuple[tuple[int, float], ...]
    seconds: float
    precision: str
    parameters: int


def step_generator(seed: int, step: int) -> torch.Generator:
    """The randomness of one gradient step, a CPU generator; step -1 draws the initial weights."""
    (mixed,) = np.random.SeedSequence([seed, step + 1]).generate_state(1, np.uint64)
    return torch.Generator().manual_seed(int(mixed))


def learning_rate(training: Training, step: int) -> float:
    """Linear warm-up, then a half cosine down to 0 after the last step.

    >>> settings = Training(
    ...     encoder="keypoints", denoiser="mlp", gradient_steps=100, warmup_steps=10, learning_rate=1.0
    ... )
    >>> [round(learning_rate(settings, step), 3) for step in (0, 4, 9, 10, 55, 99)]
    [0.1, 0.5, 1.0, 1.0, 0.5, 0.0]
    """
    if step < training.warmup_steps:
        return training.learning_rate * (step + 1) / training.warmup_steps
    done = (step - training.warmup_steps) / (training.gradient_steps - training.warmup_steps)
    return training.learning_rate * 0.5 * (1 + math.cos(math.pi * done))


def ema_decay_at(training: Training, averaged_steps: int) -> float:
    """How much of the averaged weights stays in their next move: 1 - (1 + steps)^-power, capped.

    >>> settings = Training(encoder="keypoints", denoiser="mlp", gradient_steps=1000, ema_decay=0.999)
    >>> [round(ema_decay_at(settings, steps), 3) for steps in (0, 1, 15, 100_000)]
    [0.0, 0.405, 0.875, 0.999]
    """
    return min(training.ema_decay, 1 - (1 + averaged_steps) ** -training.ema_power)


class Batches:
    """The windows of the demonstrations as tensors; a batch is drawn with replacement."""

    def __init__(self, demonstrations: Demonstrations, training: Training, device: str) -> None:
        observed, predicted = window_indices(
            demonstrations.episode_ends, training.observation_horizon, training.prediction_horizon
        )
        self.observations = torch.from_numpy(demonstrations.observations).to(device)
        self.actions = torch.from_numpy(demonstrations.actions).to(device)
        self.observed, self.predicted = torch.from_numpy(observed).to(device), torch.from_numpy(predicted).to(device)
        self.size = training.batch_size

    def sample(self, generator: torch.Generator) -> tuple[Tensor, Tensor]:
        """Observations (B, To, ...) and actions (B, Tp, action_size) of random windows."""
        drawn = torch.randint(len(self.observed), (self.size,), generator=generator)
        chosen = to_device(drawn, self.observed.device)
        return _select(self.observations, self.observed[chosen]), _select(self.actions, self.predicted[chosen])


def _select(rows: Tensor, index: Tensor) -> Tensor:
    """rows[index], forty times faster for images."""
    return rows.index_select(0, index.flatten()).unflatten(0, index.shape)


class Trainer:
    """The state of a training run: policy, averaged policy, AdamW's moments, step and losses."""

    def __init__(self, demonstrations: Demonstrations, training: Training, seed: int, device: str, task: str = ""
                 ) -> None:
        self.training, self.seed, self.device, self.data = training, seed, device, demonstrations.fingerprint
        self.task = task
        self.step, self.ema_steps, self.seconds = 0, 0, 0.0
        self.precision = precision_used(training.precision, device)
        self.batches = Batches(demonstrations, training, device)
        self.policy, self.ema_policy = self._new_policy(demonstrations), self._new_policy(demonstrations)
        self.weights: list[Tensor] = list(self.policy.parameters())
        self.ema_weights: list[Tensor] = list(self.ema_policy.parameters())
        self.ema_policy.eval().requires_grad_(False)
        if device != "cpu":
            self.policy.encoder.compile()
            self.policy.denoiser.compile()
        self.losses = torch.zeros(training.gradient_steps, device=device)
        self.adam = torch.optim.AdamW(
            self.weights, lr=0.0, betas=(training.beta1, training.beta2), weight_decay=training.weight_decay, fused=True
        )

    def _new_policy(self, demonstrations: Demonstrations) -> DiffusionPolicy:
        observation_shape, action_size = demonstrations.observations.shape[1:], demonstrations.actions.shape[1]
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(step_generator(self.seed, -1).initial_seed())
            policy = DiffusionPolicy(self.training, observation_shape, action_size)
        policy.fit_normalizers(demonstrations)
        return policy.to(self.device)

    def take_step(self) -> Tensor:
        """One gradient step; returns its loss, a scalar on the device.

        Raises:
            BadInput: training has diverged, as is seen every hundred steps and at the end.
        """
        generator = step_generator(self.seed, self.step)
        with torch.autocast(self.device, torch.bfloat16, enabled=self.precision == "bfloat16"):
            loss = self.policy.loss(*self.batches.sample(generator), generator)
        self.adam.zero_grad()
        loss.backward()
        self.adam.param_groups[0]["lr"] = learning_rate(self.training, self.step)
        self.adam.step()
        with torch.no_grad():
            keep = ema_decay_at(self.training, self.ema_steps)
            torch._foreach_lerp_(self.ema_weights, self.weights, 1 - keep)
        self.losses[self.step] = loss.detach()
        self.step, self.ema_steps = self.step + 1, self.ema_steps + 1
        if self.step % READ_EVERY == 0 or self.step == self.training.gradient_steps:
            self._refuse_divergence()
        return loss.detach()

    def _refuse_divergence(self) -> None:
        losses = self.losses[:self.step].cpu()
        for step in (~losses.isfinite()).nonzero().flatten().tolist()[:1]:
            raise BadInput(f"training diverged: loss {losses[step]} at gradient step {step}; try a smaller "
                           "learning_rate")

    def checkpoint(self) -> Checkpoint:
        """What `resume` needs; once finished, only what acting and reporting need.

        Raises:
            BadInput: training has diverged.
        """
        self._refuse_divergence()
        tensors = {f"averaged/{name}": tensor for name, tensor in self.ema_policy.state_dict().items()}
        tensors["losses"] = self.losses[:self.step]
        if self.step < self.training.gradient_steps:
            tensors |= {f"network/{name}": tensor for name, tensor in self.policy.state_dict().items()}
            for i, moments in self.adam.state_dict()["state"].items():
                tensors |= {f"adam/{i}/{name}": tensor for name, tensor in moments.items()}
        return Checkpoint(
            self.training, self.seed, self.data, tuple(self.policy.observation_shape), self.policy.action_size,
            self.step, self.ema_steps, self.seconds, self.precision,
            {name: tensor.contiguous() for name, tensor in tensors.items()}, self.task,
        )

    def resume(self, saved: Checkpoint) -> None:
        """Go back to where a checkpoint of this same run was made."""
        self._check_same_run(saved)
        self.step, self.ema_steps, self.seconds = saved.step, saved.averaged_steps, saved.seconds
        self.ema_policy.load_state_dict(saved.group("averaged"))
        self.losses[:saved.step] = saved.tensors["losses"]
        if not saved.finished:
            self.policy.load_state_dict(saved.group("network"))
            moments = {i: _in_order_of(weight, saved.group(f"adam/{i}")) for i, weight in enumerate(self.weights)}
            self.adam.load_state_dict(self.adam.state_dict() | {"state": moments})

    def _check_same_run(self, saved: Checkpoint) -> None:
        here, there = ({**run.training.model_dump(), "seed": run.seed, "data": run.data, "task": run.task,
                        "precision used": run.precision} for run in (self, saved))
        differing = [f"{name} {there[name]} there, {here[name]} here" for name in here if here[name] != there[name]]
        if differing:
            raise UnusableCheckpoint(f"the checkpoint belongs to another run: {'; '.join(differing)}")

    def report(self) -> TrainingReport:
        """Loss curve, seconds, precision and size."""
        parts = np.array_split(self.losses[:self.step].cpu().numpy(), min(CURVE_POINTS, self.step))
        ends = np.cumsum([len(part) for part in parts])
        curve = tuple((int(end), float(part.mean())) for end, part in zip(ends, parts, strict=False))
        return TrainingReport(curve, self.seconds, self.precision, sum(weight.numel() for weight in self.weights))


def _in_order_of(weight: Tensor, moments: dict[str, Tensor]) -> dict[str, Tensor]:
    """AdamW's moments in the weight's memory order (channels-last for images), which its fused kernel relies on."""
    return {
        name: torch.empty_like(weight, requires_grad=False).copy_(moment) if name != "step" else moment
        for name, moment in moments.items()
    }


def train(
    demonstrations: Demonstrations,
    training: Training,
    seed: int,
    checkpoint: Path | None = None,
    checkpoint_every: int | None = None,
    on_step: OnStep | None = None,
    device: str = "cpu",
    task: str = "",
) -> tuple[DiffusionPolicy, TrainingReport]:
    """Train a policy; return it with averaged weights, and what training did.

    checkpoint: a folder, written every `checkpoint_every` gradient steps, or every three minutes, and at the end. If
    it holds this run, training goes on from there; if that is finished, it is returned. on_step(steps done, steps in
    all, loss) is called after each step. task: what the demonstrations show, for the checkpoint.

    Raises BadInput if MOVE_CHECKPOINT_SECONDS is no time, if the folder cannot be written or is being trained into, if
    the observations do not suit the settings, or if training diverges; its UnusableCheckpoint if the folder holds
    another run (other data, settings, seed, task or precision) or a damaged one.
    """
    keep_freed_memory()
    one_thread()
    seconds = _checkpoint_seconds()
    with _alone_in(checkpoint):
        saved = checkpoints.read(checkpoint, device) if checkpoint else None
        trainer = Trainer(demonstrations, training, seed, device, task)
        if saved:
            trainer.resume(saved)
        _take_steps(trainer, checkpoint, checkpoint_every, seconds, on_step)
    return trainer.ema_policy, trainer.report()


@contextmanager
def _alone_in(folder: Path | None) -> Iterator[None]:
    """Hold a training's folder, so that no other process trains into it."""
    if folder is None:
        yield
        return
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
        lock = FileLock(Path(folder) / "lock", timeout=0)
        lock.acquire()
    except Timeout as error:
        raise BadInput(f"{folder}: another training is writing there; allowed is a folder of its own") from error
    except OSError as error:
        raise BadInput(f"cannot write the checkpoint in {folder}: {error.strerror}") from error
    try:
        yield
    finally:
        lock.release()


def _checkpoint_seconds() -> float:
    text = os.environ.get(VARIABLE, str(CHECKPOINT_SECONDS))
    try:
        if (seconds := float(text)) >= 0:
            return seconds
    except ValueError:
        pass
    raise BadInput(f"{VARIABLE}: {text[:60]!r} given; allowed are seconds between two checkpoints, such as 180")


def _take_steps(trainer: Trainer, checkpoint: Path | None, checkpoint_every: int | None, checkpoint_seconds: float,
                on_step: OnStep | None) -> None:
    """Take the steps that are left, and write checkpoints meanwhile."""
    started = time.perf_counter() - trainer.seconds
    saved_at = trainer.seconds
    steps = trainer.training.gradient_steps
    while trainer.step < steps:
        loss = trainer.take_step()
        trainer.seconds = time.perf_counter() - started
        if checkpoint_every:
            due = trainer.step % checkpoint_every == 0
        else:
            due = trainer.seconds - saved_at > checkpoint_seconds
        if checkpoint and (due or trainer.step == steps):
            checkpoints.write(trainer.checkpoint(), Path(checkpoint))
            saved_at = trainer.seconds
        if on_step:
            on_step(trainer.step, steps, loss)
