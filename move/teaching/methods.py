"""A way of collecting, measured: what its demonstrations show, and what a policy learns from them."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import pandas as pd

from move.learn.agents import PolicyAgent
from move.learn.evaluate import evaluate
from move.learn.evaluation import Evaluation
from move.learn.settings import Training
from move.learn.train import train
from move.sim.collect import collect
from move.sim.collection import Collection
from move.sim.coverage import configurations
from move.sim.tasks import get_task
from move.statistics.estimates import success_rate
from move.teaching.paths import shares


def measure(name: str, collection: Collection, training: Training, episodes: int, seed: int = 0,
            env: gymnasium.Env | None = None) -> dict[str, Any]:
    """Collect, look, train and evaluate: one row of a table.

    Args:
        collection: task and budget; of a method of one's own with method "static", whose motion is then `env`'s.
        episodes: evaluation configurations, the same for every method.
        env: as `move.sim.collect.collect` takes it.

    Returns:
        The name, demonstrations, shares of the object's, target's and camera's cells, success with its interval, and
        `rows`: the evaluation's episodes.
    """
    task = get_task(collection.task)
    demonstrations, record = collect(collection, seed, env=env)
    policy, _ = train(demonstrations, training, seed)
    rows = evaluate(PolicyAgent(policy, seed), task, Evaluation(episodes=episodes))
    found = success_rate(np.array([[row["success"] for row in rows]]))
    seen = pd.concat([configurations(part, seed, env) for part in collection.parts])
    return {"method": name, "demonstrations": record.demonstrations, **shares(seen, task),
            "success": found.value, "low": found.low, "high": found.high, "rows": rows}


def compared(rows: list[dict[str, Any]]) -> pd.DataFrame:
    """Rows of `measure` as a table for people, per cent."""
    return pd.DataFrame([{
        "method": row["method"], "demonstrations": row["demonstrations"],
        **{f"{part} cells (%)": round(100 * row[part]) for part in ("object", "target", "camera")},
        "success (%)": round(100 * row["success"]), "95 %": f"{100 * row['low']:.0f} to {100 * row['high']:.0f}",
    } for row in rows]).set_index("method")
