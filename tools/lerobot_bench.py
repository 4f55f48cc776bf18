"""What a gradient step and a chunk of actions of LeRobot's diffusion policy cost; run by LeRobot's Python.

    python -I lerobot_bench.py BATCH HORIZON PIXELS CROP INFERENCE_STEPS

Its own network at its own sizes, one camera, one thread of the CPU, made-up data. Prints JSON: parameters, and
CPU-seconds of a step (the better of two after one that is not counted) and of one episode's chunk.
"""

import json
import sys
import time
from collections.abc import Callable

import torch
from lerobot.configs.types import FeatureType, PolicyFeature
from lerobot.policies.diffusion.configuration_diffusion import DiffusionConfig
from lerobot.policies.diffusion.modeling_diffusion import DiffusionPolicy

STATE, CAMERA = "observation.state", "observation.images.camera"


def cpu_seconds(work: Callable[[], object]) -> float:
    """CPU-seconds of one call, of the system's too."""
    started = time.process_time()
    work()
    return time.process_time() - started


def main() -> None:
    """Measure and print."""
    torch.set_num_threads(1)
    batch, horizon, pixels, crop, inference_steps = map(int, sys.argv[1:])
    policy = DiffusionPolicy(DiffusionConfig(
        input_features={STATE: PolicyFeature(FeatureType.STATE, (2,)),
                        CAMERA: PolicyFeature(FeatureType.VISUAL, (3, pixels, pixels))},
        output_features={"action": PolicyFeature(FeatureType.ACTION, (4,))}, device="cpu", horizon=horizon,
        n_action_steps=3, crop_shape=(crop, crop), num_inference_steps=inference_steps))
    windows = {STATE: torch.zeros(batch, 2, 2), CAMERA: torch.rand(batch, 2, 3, pixels, pixels),
               "action": torch.rand(batch, horizon, 4) * 2 - 1,
               "action_is_pad": torch.zeros(batch, horizon, dtype=torch.bool)}
    adam = torch.optim.AdamW(policy.parameters(), lr=1e-4)

    def step() -> None:
        loss, _ = policy.forward(dict(windows))
        adam.zero_grad()
        loss.backward()
        adam.step()

    step()
    took = min(cpu_seconds(step) for _ in range(2))
    policy.eval()
    now = {STATE: torch.zeros(1, 2), CAMERA: torch.rand(1, 3, pixels, pixels)}
    with torch.inference_mode():
        policy.reset()
        chunk = cpu_seconds(lambda: policy.select_action(dict(now)))
    print(json.dumps({"parameters": sum(weight.numel() for weight in policy.parameters()), "step": took,
                      "chunk": chunk}))


if __name__ == "__main__":
    main()
