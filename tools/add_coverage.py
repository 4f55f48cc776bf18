"""Add to stored results what their data cover: each collection is made again, without images."""

import json
import sys
from pathlib import Path

from move.sim import coverage
from move.sim.tasks import get_task
from move.study.spec import run_spec_from_json
from move.study.stored import DIGEST, from_bytes, with_digest

known: dict = {}
for folder in sys.argv[1:]:
    for path in sorted(Path(folder).glob("*.json")):
        raw = path.read_bytes()
        content = json.loads(b"{" + raw[DIGEST.match(raw).end():])
        if not content["collection"] or content["collection"].get("covered"):
            continue
        spec = run_spec_from_json(json.dumps(content["spec"]))
        made = spec.collection.parts[0].model_copy(update={"observation": "keypoints"})
        key = (made.model_copy(update={"timesteps": 1, "image_size": 96}), spec.seed)
        most = min(coverage.MEASURED[-1], made.timesteps)
        if key not in known or len(known[key]) < most:
            known[key] = coverage.configurations(made.model_copy(update={"timesteps": most}), spec.seed)
        task = get_task(spec.task)
        content["collection"]["covered"] = {str(timesteps): coverage.shares(
            known[key][: min(timesteps, made.timesteps)], task) for timesteps in coverage.MEASURED}
        text = with_digest(content)
        from_bytes(text.encode())
        path.write_text(text)
        print(path.stem, flush=True)
