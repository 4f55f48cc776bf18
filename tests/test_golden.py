"""Golden test: Pick-Place's data sets and evaluations, byte for byte.

A failure means that stored results no longer belong to this code. If the change is meant, raise RESULTS_VERSION in
move/study/spec.py, write the digests printed by the failing assertions here, and say why in the commit's message.
"""

import hashlib
import json

import pytest

from move.learn.agents import Expert
from move.learn.evaluate import Evaluation, evaluate, trials
from move.sim.collect import Collection, collect
from move.sim.tasks import get_task

TIMESTEPS = 2000
COLLECTED = {
    ("static", "random", "all"): "eeaac44e8415cc9d",
    ("adc", "random", "all"): "588937c88c04fe7a",
    ("move", "random", "all"): "ed3a091c8df3b2f2",
    ("static", "sparse", "object"): "b039d37a76b96f06",
    ("static", "dense", "object"): "3d40d9d3e8bd563c",
    ("static", "circle", "object"): "aa987692ba0427b0",
    ("move", "sparse", "object"): "073523515a9ebc26",
    ("move", "dense", "object"): "7f6310a1f7aa7175",
    ("move", "circle", "object"): "efc0d163bda8731a",
    ("move", "random", "object"): "cda932b342b1c18a",
    ("adc", "random", "object+target"): "f1d6e24da281ed0a",
}
TRIED = {
    ("random", "none", "object"): "eb25aad946bf99a5",
    ("random", "none", "object+target"): "aa769e5e11acbfee",
    ("random", "none", "all"): "e70ed28e649fb7a1",
    ("grid", "sparse", "all"): "12d16aee7432fedc",
    ("grid", "circle", "all"): "04b090260dae0aeb",
}
PLAYED = "b42758b2ebdcf051"


def digest(*parts: bytes) -> str:
    """First 16 hexadecimal digits of the sha256 of `parts` laid end to end."""
    return hashlib.sha256(b"".join(parts)).hexdigest()[:16]


@pytest.mark.parametrize("method, protocol, factors", COLLECTED)
def test_data_sets_stay(method: str, protocol: str, factors: str) -> None:
    collection = Collection(task="pick-place", method=method, timesteps=TIMESTEPS, protocol=protocol, factors=factors)
    made, _ = collect(collection, seed=0)
    found = digest(made.observations.tobytes(), made.actions.tobytes(), made.episode_ends.tobytes())
    assert found == COLLECTED[method, protocol, factors]


@pytest.mark.parametrize("layout, points, factors", TRIED)
def test_trials_stay(layout: str, points: str, factors: str) -> None:
    listed = trials(get_task("pick-place"), Evaluation(layout=layout, points=points, factors=factors))
    assert digest(repr(listed).encode()) == TRIED[layout, points, factors]


def test_rows_stay() -> None:
    rows = evaluate(Expert("phase"), get_task("pick-place"), Evaluation(episodes=20))
    kept = ("trial", "group", "object_x", "object_y", "success", "success_steps", "steps")
    assert digest(json.dumps([{name: row[name] for name in kept} for row in rows]).encode()) == PLAYED
