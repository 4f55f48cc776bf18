"""Every run that the profiles ask for keeps its hash, so that stored results stay theirs.

A failure means that a stored result would no longer be found. If new runs are meant, `python tests/test_hashes.py`
writes the list anew; look at its difference before committing it: lines may be added, and only what was withdrawn goes.
"""

import json
from pathlib import Path

import pytest
from shared import plan

from move.figures import names
from move.figures.page.parameters import specs
from move.sim.collection import Collection
from move.sim.motion.adc import MENDED, PERIODIC
from move.study import profiles
from move.study.spec import CollectionRun

LISTED = Path(__file__).with_name("hashes.json")


def hashes() -> dict[str, list[str]]:
    """The hashes of all runs of each profile, sorted."""
    return {
        chosen.name: sorted({spec.hash for name in names() for spec in specs(name, chosen)})
        for chosen in map(profiles.load_profile, profiles.names())
    }


def test_every_run_of_every_profile_keeps_its_hash() -> None:
    assert hashes() == json.loads(LISTED.read_text())


@pytest.mark.parametrize("name, chosen", [
    ("hand_spread", [0.03, 0.05]), ("jumping", [MENDED, PERIODIC]), ("keep_failures", [True]), ("fixed", ["authors"]),
    ("drawing", ["full"]), ("object_steps", [35])])
def test_a_choice_enters_the_hash_and_what_is_so_anyway_does_not(name, chosen):
    def hash_of(**choice) -> str:
        collection = plan(method="adc" if name == "jumping" else "move", protocol="sparse", factors="object",
                          observation="rgb", **choice)
        return CollectionRun(task="pick-place", seed=0, collection=collection).hash

    usual = Collection.model_fields[name].default
    assert hash_of() == hash_of(**{name: usual})
    assert len({hash_of(**{name: value}) for value in (usual, *chosen)}) == 1 + len(chosen)


if __name__ == "__main__":
    LISTED.write_text(json.dumps(hashes(), indent=0) + "\n")
