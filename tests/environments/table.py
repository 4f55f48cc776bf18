"""Print the table of docs/how-to/put_your_own_scene_in_motion.md, or the rows of the environments that are named.

    PYTHONPATH=. build/environments-venv/bin/python tests/environments/table.py [NAME ...]
"""

import sys
from importlib.metadata import version

import numpy as np
from cases import CASES, Case
from test_environments import PATHS, SLACK, cost, episode, inside

DISTRIBUTION = {"gym_aloha": "gym-aloha", "gymnasium_robotics": "gymnasium-robotics", "dm_control": "dm-control"}


def row(case: Case) -> str:
    """One line of the table, measured now."""
    half = case.steps // 2
    one, again = (episode(case.moving(phase=lambda scene: scene.steps >= half), case.steps, 3) for _ in range(2))
    far = 100 * np.abs(np.diff(one.put[:30], axis=0))
    moved = [f"object {np.hypot(far[:, 0], far[:, 1]).sum():.0f} cm"]
    if "target" in case.moves:
        ways = np.diff(one.put[:, 3:], axis=0)
        moved.append(f"target {100 * np.linalg.norm(ways, axis=1).sum():.0f} cm")
    if "camera" in case.moves:
        moved.append(f"camera {np.degrees(np.ptp(one.angle)):.0f}°")
    kept = inside(one.put, case.moves["within"], 1e-9) and inside(one.object[:30], case.moves["within"], SLACK)
    same = all(np.array_equal(getattr(one, name), getattr(again, name)) for name in PATHS)
    spent = cost(case)
    name = DISTRIBUTION.get(case.package, case.package)
    return (f"| {name} {version(name)} | {case.name.removeprefix('gym_aloha/').removeprefix('dm_control/')} | "
            f"{', '.join(moved)} | {'yes' if kept else 'no'} | {'yes' if same else 'no'} | "
            f"{100 * spent.share:.1f} % of {spent.microseconds / 1000:.2g} ms |")


if __name__ == "__main__":
    print("| package | environment | moved | inside | reproducible | cost |", "|---|---|---|---|---|---|", sep="\n")
    for each in CASES:
        if not sys.argv[1:] or any(word in each.name for word in sys.argv[1:]):
            print(row(each), flush=True)
