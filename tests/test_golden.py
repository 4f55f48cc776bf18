"""Golden test: data sets of every task by every method, and Pick-Place's protocols and evaluations, byte for byte.

A failure means that stored results no longer belong to this code. If the change is meant, raise RESULTS_VERSION in
move/study/spec.py, write the digests printed by the failing assertions here, and say why in the commit's message.
"""

import hashlib
import json

import pytest

from move.learn.agents import Expert
from move.learn.evaluate import evaluate
from move.learn.evaluation import Evaluation, starts
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
    ("random", "none", "object"): "c41af81bc7a885be",
    ("random", "none", "object+target"): "cc9c64c3b412fb9e",
    ("random", "none", "all"): "262502a0ce26f915",
    ("grid", "sparse", "all"): "0d581baf4f800aaa",
    ("grid", "circle", "all"): "e926838e59f6c0f2",
}
EVERY_TASK = {
    ("pick-place", "static"): "c1e396b858e8d321",
    ("pick-place", "adc"): "47fb5112d68bb2fa",
    ("pick-place", "move"): "d8c790ac7b125e83",
    ("push", "static"): "7506e0fa9bdf10fd",
    ("push", "adc"): "f818fcc4a79d01c9",
    ("push", "move"): "b02b57f928c13a1e",
    ("assembly", "static"): "a37bcd36786b856b",
    ("assembly", "adc"): "1e553424d773fa27",
    ("assembly", "move"): "6e8e355280dcb2ea",
    ("box-close", "static"): "b75457211b1543d7",
    ("box-close", "adc"): "c7dff13b58b56443",
    ("box-close", "move"): "2685a23ea05a13dd",
    ("hammer", "static"): "8a9eed82f975e8ad",
    ("hammer", "adc"): "1751d482ec075a8c",
    ("hammer", "move"): "800b29fc2b92f4ac",
    ("pick-place-wall", "static"): "0c98c7298fb08b4e",
    ("pick-place-wall", "adc"): "81ef0bb59886e501",
    ("pick-place-wall", "move"): "a893f7559cc4b79e",
    ("window-open", "static"): "3c6f5f9020b9626e",
    ("window-open", "adc"): "3563768de820d055",
    ("window-open", "move"): "ef072f521f513a65",
    ("faucet-open", "static"): "1b33e66062d241f4",
    ("faucet-open", "adc"): "3aeee06529cee9ad",
    ("faucet-open", "move"): "a757bd72ef05a0c6",
    ("disassemble", "static"): "7a6e3c4196c4df1c",
    ("disassemble", "adc"): "44994cbf0c23d05c",
    ("disassemble", "move"): "f927c230a2329f35",
    ("basketball", "static"): "6123f0fab4946b26",
    ("basketball", "adc"): "56be9ce04cbe4d45",
    ("basketball", "move"): "257257a993d99599",
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


@pytest.mark.parametrize("task, method", EVERY_TASK)
def test_data_sets_of_every_task_stay(task: str, method: str) -> None:
    made, record = collect(Collection(task=task, method=method, timesteps=200), seed=0)
    found = digest(made.observations.tobytes(), made.actions.tobytes(), made.episode_ends.tobytes(),
                   repr(record.grasps).encode())
    assert found == EVERY_TASK[task, method]


@pytest.mark.parametrize("chosen, points, factors", TRIED)
def test_starts_stay(chosen: str, points: str, factors: str) -> None:
    listed = starts(get_task("pick-place"), Evaluation(starts=chosen, points=points, factors=factors))
    found = repr([(start.group, start.configuration) for start in listed])
    assert digest(found.encode()) == TRIED[chosen, points, factors]


def test_rows_stay() -> None:
    rows = evaluate(Expert("phase"), get_task("pick-place"), Evaluation(episodes=20))
    kept = ("trial", "group", "object_x", "object_y", "success", "success_steps", "steps")
    assert digest(json.dumps([{name: row[name] for name in kept} for row in rows]).encode()) == PLAYED
