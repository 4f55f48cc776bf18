"""The seal of a policy: of which run it is, and the sha256 of every other file of its folder.

It is `policy.json` next to a finished policy. Without it, or where something does not fit, the policy is refused.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

from move.errors import BadInput
from move.files import written_aside
from move.study.spec import RunSpec
from move.untrusted import read_json

SEAL = "policy.json"


def seal(spec: RunSpec, folder: Path) -> None:
    """Write next to a policy of which run it is, and what its files are."""
    with written_aside(folder / SEAL) as beside:
        beside.write_text(json.dumps({"run": spec.policy_hash, "sha256": _digests(folder)}, indent=1) + "\n")


def _digests(folder: Path) -> dict[str, str]:
    """The sha256 of each file of a policy's folder, but for the seal and what a training leaves while it lasts."""
    files = (path for path in sorted(folder.iterdir()) if path.suffix in (".json", ".safetensors") and path.name != SEAL
             and not path.name.startswith("."))
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def refuse_another(spec: RunSpec, folder: Path) -> None:
    """Refuse a folder that is not, to the last bit, what was sealed as the finished policy of the run `spec`.

    Raises:
        BadInput: no seal, that of another run, a file that is missing, more, or changed, or a policy of other settings.
    """
    path = folder / SEAL
    about = read_json(path, "of which run a policy is, and its files' digests") if path.exists() else {}
    sealed, there = about.get("sha256"), _digests(folder)
    if about.get("run") != spec.policy_hash or not isinstance(sealed, dict):
        raise BadInput(f"{folder} is not the policy of {spec.label}, run {spec.policy_hash}: its {SEAL} says "
                       f"{about.get('run', 'nothing')}")
    if differing := sorted(name for name in there.keys() | sealed.keys() if there.get(name) != sealed.get(name)):
        raise BadInput(f"{folder / differing[0]} does not fit its digest in {SEAL}: damaged, or another policy's")
    record = read_json(folder / "run.json", "a policy's settings")
    wanted = {"training": spec.training and spec.training.model_dump(mode="json"), "seed": spec.seed, "task": spec.task,
              "step": spec.training and spec.training.gradient_steps}
    if {name: record.get(name) for name in wanted} != wanted:
        raise BadInput(f"{folder}: other settings, seed or task than those of {spec.label}, or unfinished")
