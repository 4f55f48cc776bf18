"""Every run that the profiles ask for keeps its hash, so that stored results stay theirs.

A failure means that a stored result would no longer be found. If new runs are meant, `python tests/test_hashes.py`
writes the list anew; look at its difference before committing it: lines may be added, and only what was withdrawn goes.
"""

import json
from pathlib import Path

from move.figures import names
from move.figures.page.parameters import specs
from move.study import profiles

LISTED = Path(__file__).with_name("hashes.json")


def hashes() -> dict[str, list[str]]:
    """The hashes of all runs of each profile, sorted."""
    return {
        chosen.name: sorted({spec.hash for name in names() for spec in specs(name, chosen)})
        for chosen in map(profiles.load_profile, profiles.names())
    }


def test_every_run_of_every_profile_keeps_its_hash() -> None:
    assert hashes() == json.loads(LISTED.read_text())


if __name__ == "__main__":
    LISTED.write_text(json.dumps(hashes(), indent=0) + "\n")
