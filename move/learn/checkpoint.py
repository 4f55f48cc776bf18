"""A training run on disk: one folder, replaced in one step, without pickle.

    run.json                    settings, seed, sizes, step, task, the name of the tensor file, and a digest of all that
    tensors-<step>.safetensors  averaged weights and limits; while unfinished also the network and AdamW's moments

A new tensor file is written first, then run.json is replaced in one step, then the old tensor file goes. Whenever
the writing stops, run.json names a complete tensor file. Whoever trains into the folder holds the file `lock`.
"""

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import torch
from pydantic import BaseModel, ConfigDict, Field, NonNegativeFloat, NonNegativeInt, PositiveInt
from safetensors import SafetensorError
from safetensors.torch import load_file, save_file
from torch import Tensor

from move.errors import BadInput
from move.files import put_away_all_remains, written_aside
from move.learn.diffusion import DiffusionPolicy
from move.learn.settings import Training
from move.validation import reason_of

FORMAT = 2


class UnusableCheckpoint(BadInput):
    """What a folder holds is damaged, or of another run."""


@dataclass(frozen=True)
class Checkpoint:
    """Training after `step` gradient steps.

    tensors: by name "averaged/...", and while unfinished "network/...", "adam/...", "losses" (one a step so far).
    data: fingerprint of the demonstrations, so that other data are noticed. precision: the one really used.
    task: what it learnt, "" where that is unknown.
    averaged_steps: how often the averaged weights have been moved, which decides their next decay.
    """

    training: Training
    seed: int
    data: str
    observation_shape: tuple[int, ...]
    action_size: int
    step: int
    averaged_steps: int
    seconds: float
    precision: str
    tensors: dict[str, Tensor]
    task: str = ""

    @property
    def finished(self) -> bool:
        """Whether all gradient steps are done."""
        return self.step == self.training.gradient_steps

    def group(self, name: str) -> dict[str, Tensor]:
        """The tensors below `name`, by the rest of their names."""
        start = f"{name}/"
        return {key.removeprefix(start): tensor for key, tensor in self.tensors.items() if key.startswith(start)}


class _Record(BaseModel):
    """The content of run.json."""

    model_config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False, hide_input_in_errors=True)

    format: Literal[2]  # FORMAT
    training: Training
    seed: NonNegativeInt
    data: str
    observation_shape: tuple[PositiveInt, ...]
    action_size: PositiveInt
    step: NonNegativeInt
    averaged_steps: NonNegativeInt
    seconds: NonNegativeFloat
    precision: str
    task: str
    tensors: Annotated[str, Field(pattern=r"^tensors-\d+\.safetensors$")]
    digest: str


def write(checkpoint: Checkpoint, folder: Path) -> None:
    """Make `folder` hold this checkpoint and no older one; raises BadInput where it cannot be written."""
    name = f"tensors-{checkpoint.step:07d}.safetensors"
    record = {field: value for field, value in vars(checkpoint).items() if field not in ("training", "tensors")}
    record |= {"format": FORMAT, "training": checkpoint.training.model_dump(mode="json"), "tensors": name}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        put_away_all_remains(folder)
        with written_aside(folder / name) as beside:
            save_file(checkpoint.tensors, beside)
        record = json.loads(json.dumps(record))
        record["digest"] = _digest(record, folder)
        with written_aside(folder / "run.json") as beside:
            beside.write_text(json.dumps(record, indent=1) + "\n")
        for old in folder.glob("tensors-*"):
            if old.name != name:
                old.unlink()
    except (OSError, SafetensorError) as error:
        raise BadInput(f"cannot write the checkpoint in {folder}: {' '.join(str(error).split())}") from error


def _digest(record: dict[str, Any], folder: Path) -> str:
    """Of the record without its digest, and of the file that it names."""
    with (folder / record["tensors"]).open("rb") as file:
        content = hashlib.file_digest(file, "sha256").hexdigest()
    rest = {name: value for name, value in record.items() if name != "digest"}
    return hashlib.sha256((json.dumps(rest, sort_keys=True) + content).encode()).hexdigest()


def read(folder: Path, device: str = "cpu") -> Checkpoint | None:
    """The checkpoint in `folder`, None if there is none; raises UnusableCheckpoint, a BadInput, if it is damaged."""
    folder = Path(folder)
    if not (folder / "run.json").exists():
        return None
    try:
        text = (folder / "run.json").read_text()
        record = _Record.model_validate_json(text)
        if record.digest != _digest(json.loads(text), folder):
            raise ValueError("its content does not fit its digest")
        tensors = load_file(folder / record.tensors, device=device)
        fields = {name: value for name, value in record if name not in ("format", "digest")}
        checkpoint = Checkpoint(**{**fields, "tensors": tensors})
        _check(checkpoint)
        return checkpoint
    except (OSError, ValueError, TypeError, OverflowError, RuntimeError, SafetensorError) as error:
        raise UnusableCheckpoint(f"cannot read the checkpoint in {folder}: {reason_of(error, 'run.json')}") from error


def _check(checkpoint: Checkpoint) -> None:
    """Refuse tensors that are not those of such a policy after so many steps, or not finite."""
    training, tensors = checkpoint.training, checkpoint.tensors
    if checkpoint.step > training.gradient_steps:
        raise ValueError(f"step {checkpoint.step} of {training.gradient_steps}")
    if max(training.mlp_depth, training.cnn_blocks) > len(tensors):  # else such a network would be laid out below
        raise ValueError(f"{len(tensors)} tensors for a network that has more blocks")
    found = {name: tuple(tensor.shape) for name, tensor in tensors.items()}
    needed = _shapes(checkpoint)
    for name in [*needed, *found]:
        if found.get(name) != needed.get(name):
            raise ValueError(f"{name}: shape {found.get(name)} given, {needed.get(name)} needed")
    for name, tensor in tensors.items():
        if not torch.isfinite(tensor).all():
            raise ValueError(f"{name}: not all numbers are finite")


def _shapes(checkpoint: Checkpoint) -> dict[str, tuple[int, ...]]:
    """The shape of each tensor of a checkpoint, by its name."""
    with torch.device("meta"):  # nothing is allocated
        policy = DiffusionPolicy(checkpoint.training, checkpoint.observation_shape, checkpoint.action_size)
    state = {name: tuple(tensor.shape) for name, tensor in policy.state_dict().items()}
    shapes = {f"averaged/{name}": shape for name, shape in state.items()} | {"losses": (checkpoint.step,)}
    if not checkpoint.finished:
        shapes |= {f"network/{name}": shape for name, shape in state.items()}
        for number, weight in enumerate(policy.parameters()):
            shapes |= {f"adam/{number}/{name}": tuple(weight.shape) for name in ("exp_avg", "exp_avg_sq")}
            shapes[f"adam/{number}/step"] = ()
    return shapes


def _existing(folder: Path) -> Checkpoint:
    checkpoint = read(folder)
    if checkpoint is None:
        raise BadInput(f"no checkpoint in {folder}")
    return checkpoint


def learnt_task(folder: Path) -> str:
    """The task that the policy in a checkpoint learnt, "" where it does not say; BadInput as for `load_policy`."""
    return _existing(folder).task


def load_policy(folder: Path, task: str = "") -> DiffusionPolicy:
    """The policy with averaged weights from a checkpoint, finished or not.

    Raises BadInput if the folder holds none, a damaged one, or one that says that it learnt another task than `task`.
    """
    checkpoint = _existing(folder)
    if task and checkpoint.task not in ("", task):
        raise BadInput(f"task: {task!r} given; the policy in {folder} learnt {checkpoint.task!r}, and is allowed there")
    return policy_of(checkpoint)


def policy_of(checkpoint: Checkpoint) -> DiffusionPolicy:
    """The policy with averaged weights, ready to act."""
    with torch.random.fork_rng(devices=[]):  # the weights drawn here are overwritten
        policy = DiffusionPolicy(checkpoint.training, checkpoint.observation_shape, checkpoint.action_size)
    policy.load_state_dict(checkpoint.group("averaged"))
    return policy.eval().requires_grad_(False)
