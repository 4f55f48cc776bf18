"""A training run on disk: one folder, replaced in one step, without pickle.

    run.json                    settings, seed, sizes, step, and the name of the tensor file
    tensors-<step>.safetensors  averaged weights and limits; while unfinished also the network and AdamW's moments

A new tensor file is written first, then run.json is replaced in one step, then the old tensor file goes. Whenever
the writing stops, run.json names a complete tensor file.
"""

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from pydantic import ValidationError
from safetensors import SafetensorError
from safetensors.torch import load_file, save_file
from torch import Tensor

from move.errors import BadInput
from move.learn.diffusion import DiffusionPolicy
from move.learn.settings import Training

FORMAT = 1


@dataclass(frozen=True)
class Checkpoint:
    """Training after `step` gradient steps.

    tensors: by name "averaged/...", and while unfinished "network/...", "adam/...", "losses" (one a step so far).
    data: fingerprint of the demonstrations, so that other data are noticed.
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

    @property
    def finished(self) -> bool:
        """Whether all gradient steps are done."""
        return self.step == self.training.gradient_steps

    def group(self, name: str) -> dict[str, Tensor]:
        """The tensors below `name`, by the rest of their names."""
        start = f"{name}/"
        return {key.removeprefix(start): tensor for key, tensor in self.tensors.items() if key.startswith(start)}


def write(checkpoint: Checkpoint, folder: Path) -> None:
    """Make `folder` hold this checkpoint and no older one."""
    folder.mkdir(parents=True, exist_ok=True)
    name = f"tensors-{checkpoint.step:07d}.safetensors"
    _replace(folder / name, lambda path: save_file(checkpoint.tensors, path))
    record = {field: value for field, value in vars(checkpoint).items() if field not in ("training", "tensors")}
    record |= {"format": FORMAT, "training": checkpoint.training.model_dump(mode="json"), "tensors": name}
    _replace(folder / "run.json", lambda path: path.write_text(json.dumps(record, indent=1) + "\n"))
    for old in folder.glob("tensors-*"):
        if old.name != name:
            old.unlink()


def _replace(path: Path, write_to: Any) -> None:
    beside = path.with_name(f"{path.name}.part")
    write_to(beside)
    os.replace(beside, path)


def read(folder: Path, device: str = "cpu") -> Checkpoint | None:
    """The checkpoint in `folder`, None if there is none; raises BadInput if it is damaged."""
    folder = Path(folder)
    if not (folder / "run.json").exists():
        return None
    try:
        record = json.loads((folder / "run.json").read_text())
        if (found := record.pop("format")) != FORMAT:
            raise BadInput(f"format {found}, this version reads {FORMAT}")
        record["training"] = Training(**record["training"])
        record["tensors"] = load_file(folder / record["tensors"], device=device)
        record["observation_shape"] = tuple(record["observation_shape"])
        return Checkpoint(**record)
    except (OSError, KeyError, TypeError, ValueError, SafetensorError) as error:
        reason = error.errors()[0]["msg"] if isinstance(error, ValidationError) else " ".join(str(error).split())
        raise BadInput(f"cannot read the checkpoint in {folder}: {type(error).__name__}: {reason}") from error


def load_policy(folder: Path, device: str = "cpu") -> DiffusionPolicy:
    """The policy with averaged weights from a checkpoint, finished or not.

    Raises BadInput if the folder holds none, or a damaged one.
    """
    checkpoint = read(folder, device)
    if checkpoint is None:
        raise BadInput(f"no checkpoint in {folder}")
    return policy_of(checkpoint, device)


def policy_of(checkpoint: Checkpoint, device: str = "cpu") -> DiffusionPolicy:
    """The policy with averaged weights, ready to act."""
    with torch.random.fork_rng(devices=[]):  # the weights drawn here are overwritten
        policy = DiffusionPolicy(checkpoint.training, checkpoint.observation_shape, checkpoint.action_size)
    policy.load_state_dict(checkpoint.group("averaged"))
    return policy.to(device).eval().requires_grad_(False)
