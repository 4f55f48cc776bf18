"""A LeRobot policy that answers over standard input and output; run by a Python that has LeRobot, which this has not.

    python -I lerobot_server.py CHECKPOINT SEED   (started by move.exchange.lerobot_policy; imports nothing of move)

A message is the length of its header (four bytes, little-endian), the header (JSON), and the bytes of the arrays that
the header's "arrays" describes. The server begins with "hello", then answers each "act" with "actions"; a "reset" has
no answer. What goes wrong in it is an "error" with one line. It ends when its input does.
"""

from __future__ import annotations

import json
import os
import struct
import sys
from collections.abc import Mapping
from typing import Any, BinaryIO, Protocol

import numpy as np

LENGTH = struct.Struct("<I")
KINDS = ("<f4", "|u1")  # what an array may hold: float32 or uint8
LARGEST_HEADER = 1 << 20  # bytes

Message = tuple[dict[str, Any], dict[str, np.ndarray]]


class Served(Protocol):
    """A policy that can be served; `inputs` has the shape of one timestep of each named observation."""

    inputs: dict[str, tuple[int, ...]]
    action_size: int

    def reset(self, task: str) -> None:
        """Begin all episodes anew."""

    def act(self, observations: dict[str, np.ndarray]) -> np.ndarray:
        """The next action of each episode, (episodes, action_size), by its newest observation."""


def write_message(stream: BinaryIO, header: Mapping[str, Any], arrays: Mapping[str, np.ndarray] | None = None) -> None:
    """Write one message; arrays are float32 or uint8."""
    arrays = arrays or {}
    described = {name: [array.dtype.str, list(array.shape)] for name, array in arrays.items()}
    text = json.dumps({**header, "arrays": described}).encode()
    stream.write(LENGTH.pack(len(text)) + text)
    for array in arrays.values():
        stream.write(np.ascontiguousarray(array).tobytes())
    stream.flush()


def read_message(stream: BinaryIO) -> Message:
    """Read one message: its header and its arrays.

    Raises:
        EOFError: the stream ended.
        ValueError: what came is no message.
    """
    (length,) = LENGTH.unpack(_exactly(stream, LENGTH.size))
    if length > LARGEST_HEADER:
        raise ValueError(f"a header of {length} bytes")
    header = json.loads(_exactly(stream, length))
    arrays = {}
    for name, (kind, shape) in header.pop("arrays").items():
        if kind not in KINDS or any(side < 0 for side in shape):
            raise ValueError(f"an array {name} of {kind} {shape}")
        content = _exactly(stream, int(np.prod(shape, dtype=np.int64)) * np.dtype(kind).itemsize)
        arrays[name] = np.frombuffer(content, kind).reshape(shape)
    return header, arrays


def _exactly(stream: BinaryIO, size: int) -> bytes:
    content = stream.read(size)
    if len(content) < size:
        raise EOFError(f"{len(content)} of {size} bytes")
    return content


def serve(policy: Served, source: BinaryIO, sink: BinaryIO) -> None:
    """Answer until `source` ends."""
    inputs = {name: list(shape) for name, shape in policy.inputs.items()}
    write_message(sink, {"what": "hello", "inputs": inputs, "action_size": policy.action_size})
    while True:
        try:
            header, arrays = read_message(source)
        except EOFError:
            return
        if header["what"] == "reset":
            policy.reset(header["task"])
        else:
            write_message(sink, {"what": "actions"}, {"actions": policy.act(arrays).astype(np.float32)})


class LeRobotPolicy:
    """A policy of any of LeRobot's kinds with the pre- and post-processing that was saved beside it."""

    def __init__(self, folder: str, seed: int) -> None:
        import torch
        from lerobot.configs.policies import PreTrainedConfig
        from lerobot.policies.factory import get_policy_class, make_pre_post_processors

        torch.manual_seed(seed)
        config = PreTrainedConfig.from_pretrained(folder)
        config.device = "cuda" if torch.cuda.is_available() else "cpu"
        self.policy = get_policy_class(config.type).from_pretrained(folder, config=config)
        self.policy.eval()
        self.before, self.after = make_pre_post_processors(
            config, pretrained_path=folder, preprocessor_overrides={"device_processor": {"device": config.device}})
        self.inputs = {name: tuple(feature.shape) for name, feature in config.input_features.items()}
        self.action_size = config.output_features["action"].shape[0]
        self.task = ""

    def reset(self, task: str) -> None:
        """Forget the episodes before."""
        self.task = task
        self.policy.reset()

    def act(self, observations: dict[str, np.ndarray]) -> np.ndarray:
        """One action an episode, as LeRobot's own evaluation asks for it."""
        import torch

        batch: dict[str, Any] = {name: _tensor(values) for name, values in observations.items()}
        batch["task"] = [self.task] * len(next(iter(observations.values())))
        with torch.inference_mode():
            return self.after(self.policy.select_action(self.before(batch))).cpu().numpy()


def _tensor(values: np.ndarray) -> Any:
    """Numbers as they are; images (n, height, width, 3) uint8 as (n, 3, height, width) in [0, 1]."""
    import torch

    tensor = torch.from_numpy(values.copy())
    return tensor if values.ndim == 2 else tensor.permute(0, 3, 1, 2).float() / 255


def main() -> None:
    """Serve the policy of a checkpoint; what libraries print goes to standard error."""
    sink = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    try:
        serve(LeRobotPolicy(sys.argv[1], int(sys.argv[2])), sys.stdin.buffer, sink)
    except Exception as error:  # whatever it is, the other side has to be told
        write_message(sink, {"what": "error", "line": " ".join(f"{type(error).__name__}: {error}".split())[:500]})


if __name__ == "__main__":
    main()
