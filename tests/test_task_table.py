"""The ten tasks against a table written down by hand from the authors' settings; what differs on purpose is named."""

import math

import pytest

from move.paper import PAPER_TASKS
from move.sim.tasks import TASKS

HALF, SIDE = (0.0, 180.0), (-60.0, 120.0)  # camera angles, degrees
WIDE = ((-0.3, 0.5, 0.2), (0.3, 0.6, 0.4))  # start of the hand, metres

# name: object low xy, high xy; target low xyz, high xyz (None without one); hand; camera; yaw (degrees)
RANGES = {
    "pick-place": ((-0.2, 0.5), (0.1, 0.8), ((-0.1, 0.8, 0.05), (0.1, 0.9, 0.3)), WIDE, HALF, (0, 0)),
    "push": ((-0.2, 0.5), (0.1, 0.8), ((-0.1, 0.8, 0.01), (0.1, 0.9, 0.02)), WIDE, SIDE, (0, 0)),
    "assembly": ((-0.35, 0.5), (0.0, 0.7), ((-0.3, 0.75, 0.1), (0.15, 0.9, 0.1)), WIDE, HALF, (-60, 60)),
    "box-close": ((-0.3, 0.4), (0.3, 0.5), ((-0.25, 0.75, 0.133), (0.25, 0.85, 0.133)),
                  ((0.3, 0.5, 0.2), (0.5, 0.6, 0.4)), HALF, (-45, 45)),
    "hammer": ((-0.3, 0.4), (0.3, 0.5), ((-0.24, 0.87, 0.0), (0.24, 0.95, 0.0)),
               ((-0.4, 0.4, 0.1), (0.4, 0.6, 0.4)), HALF, (-60, 60)),
    # the authors' wide class is not published; this is as wide as the wall allows
    "pick-place-wall": ((-0.2, 0.5), (0.1, 0.68), ((-0.1, 0.8, 0.05), (0.1, 0.9, 0.3)), WIDE, HALF, (0, 0)),
    # window and faucet: yaw beyond +60 degrees is the window's own, and the faucet turns away from the arm
    "window-open": ((-0.1, 0.6), (0.1, 0.9), None, ((-0.3, 0.45, 0.2), (0.3, 0.55, 0.4)), SIDE, (-60, 90)),
    "faucet-open": ((-0.2, 0.6), (0.2, 0.85), None, WIDE, (-90.0, 90.0), (-180, 0)),
    "disassemble": ((-0.35, 0.5), (0.1, 0.7), None, WIDE, SIDE, (-60, 90)),
    "basketball": ((-0.3, 0.5), (0.3, 0.7), ((-0.3, 0.8, 0.0), (0.3, 0.9, 0.0)), WIDE, SIDE, (0, 0)),
}
# name: separation (metres), object steps, target steps, yaw speed scale, parts of an action, timesteps of table 5
# target steps: Box-Close 120 for the authors' 90 and Hammer 100 for 80, which are over before most grasps
NUMBERS = {
    "pick-place": (0.15, 30, 90, 1.0, 4, 20_000),
    "push": (0.15, 30, 90, 1.0, 4, 20_000),
    "assembly": (0.10, 20, 90, 1.0, 5, 20_000),
    "box-close": (0.25, 30, 120, 0.1, 4, 100_000),
    "hammer": (0.15, 30, 100, 0.1, 5, 20_000),
    "pick-place-wall": (0.15, 30, 90, 1.0, 4, 20_000),
    "window-open": (None, 35, None, 1.0, 4, 5_000),
    "faucet-open": (None, 35, None, 1.0, 4, 5_000),
    "disassemble": (None, 20, None, 1.0, 5, 20_000),
    "basketball": (0.15, 30, 140, 1.0, 4, 20_000),
}


def test_every_task_of_the_paper_stands_in_both_tables() -> None:
    assert list(PAPER_TASKS) == list(RANGES) == list(NUMBERS) and set(PAPER_TASKS) <= set(TASKS)


@pytest.mark.parametrize("name", RANGES)
def test_what_is_random_is_random_over_the_authors_ranges(name: str) -> None:
    task = TASKS[name]
    low, high, target, hand, camera, yaw = RANGES[name]
    assert (task.object_range.low[:2], task.object_range.high[:2]) == (low, high)
    assert task.object_range.low[2] == task.object_range.high[2]  # it stands on the table
    assert task.has_target == (target is not None)
    if target:
        assert (task.target_range.low, task.target_range.high) == target
    assert (task.hand_range.low, task.hand_range.high) == hand
    assert [math.degrees(angle) for angle in task.camera_range] == pytest.approx(camera)
    assert [math.degrees(angle) for angle in task.yaw_range] == pytest.approx(yaw)


@pytest.mark.parametrize("name", NUMBERS)
def test_how_long_and_how_fast_things_move_is_as_written_down(name: str) -> None:
    task = TASKS[name]
    separation, object_steps, target_steps, yaw_scale, parts, timesteps = NUMBERS[name]
    assert (task.object_steps, task.yaw_speed_scale, task.action_size, task.timesteps) == (
        object_steps, yaw_scale, parts, timesteps)
    if task.has_target:
        assert (task.separation, task.target_steps) == (separation, target_steps)
