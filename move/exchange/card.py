"""The dataset card of an export: the README.md that the Hugging Face Hub shows and reads."""

from __future__ import annotations

from typing import Any

from move.sim.methods import METHODS
from move.sim.tasks import TASKS

SIZES = {1_000: "n<1K", 10_000: "1K<n<10K", 100_000: "10K<n<100K", 1_000_000: "100K<n<1M"}  # as the Hub has them
HOW = {
    "static": "Nothing moves within a demonstration but the arm.",
    "ADC": "Object and target jump to other places as the gripper comes near (adversarial data collection).",
    "MOVE": "Object, target and camera move while the expert demonstrates.",
    "mixture": "They are a mixture of several ways of collecting.",
}
"""What moved, by the method's title."""

BODY = """
# {title}

{episodes:,} demonstrations, {timesteps:,} timesteps at {fps} a second{origin}

| feature | type | shape | names |
|---|---|---|---|
{features}

Read them with [LeRobot](https://github.com/huggingface/lerobot):

    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    dataset = LeRobotDataset("OWNER/NAME", root="PATH/OF/THIS/FOLDER")

State a licence above (`license:`) before you publish them: it is yours to choose.
"""


COLLECTED = """, of a simulated robot arm (Meta-World's Sawyer in
MuJoCo) by a scripted expert. **No real robot was involved.** {how}

They were made by a reproduction of *MOVE* ([arXiv 2512.04813](https://arxiv.org/abs/2512.04813)), which is not by the
paper's authors. How each was collected, to the seed, is in `meta/move.json`."""

OF_OTHERS = """. The robot and the task are named in
`meta/info.json` and `meta/tasks.parquet`; say here who or what demonstrated, and whether a real robot was involved."""


def dataset_card(info: dict[str, Any], attributes: dict[str, Any]) -> str:
    """The card as text: front matter in YAML, then what the demonstrations are, in Markdown.

    Args:
        info: what `meta/info.json` holds.
        attributes: what was stored with the demonstrations; where they were not collected here, the card leaves to
            their owner what they are.
    """
    from huggingface_hub import DatasetCardData  # slow to import

    collection = attributes.get("collection", {})
    task, method = (found.title if (found := known.get(str(collection.get(name)))) else None
                    for name, known in (("task", TASKS), ("method", METHODS)))
    collected = task is not None
    title = (f"Simulated demonstrations of {task}" + f", collected by {method}" * bool(method) if collected
             else "Demonstrations of a task")
    origin = COLLECTED.format(how=HOW.get(method or "", "")) if collected else OF_OTHERS
    frames = info["total_frames"]
    size = next((name for most, name in SIZES.items() if frames < most), "1M<n<10M")
    front = DatasetCardData(
        pretty_name=title, task_categories=["robotics"], tags=["LeRobot", *["simulation", "metaworld"] * collected],
        size_categories=[size], configs=[{"config_name": "default", "data_files": "data/*/*.parquet"}])
    rows = [f"| `{name}` | {feature['dtype']} | {' x '.join(map(str, feature['shape']))} | {_names(feature['names'])} |"
            for name, feature in info["features"].items()]
    body = BODY.format(title=title, episodes=info["total_episodes"], timesteps=frames, fps=info["fps"],
                       features="\n".join(rows), origin=origin)
    return f"---\n{front.to_yaml()}\n---\n{body}"


def _names(names: list[str] | None) -> str:
    """At most six names of a feature's numbers."""
    return ", ".join(names[:6]) + ", ..." * (len(names) > 6) if names else ""
