"""A policy tried in a scene in motion: table 2's configurations, everything moving as in demonstrations of MOVE."""

import functools

import numpy as np
import pytest

from move.learn.agents import Expert, Nothing
from move.learn.evaluate import evaluate
from move.learn.evaluation import Evaluation, starts
from move.sim.tasks import get_task

TASK = get_task("pick-place")


@functools.cache
def paths(chosen: str, factors: str = "all", batch_size: int = 4) -> list[list]:
    """The configuration after each step of four episodes in which nobody acts."""
    seen: list[list] = [[] for _ in range(4)]
    evaluate(Nothing(), TASK, Evaluation(starts=chosen, episodes=4, factors=factors), batch_size=batch_size,
             callback=lambda number, scene: seen[number].append(scene.configuration))
    return seen


def test_it_begins_where_table_2_begins_and_then_moves():
    still, moving = paths("random"), paths("moving")
    for one, other in zip(still, moving, strict=True):
        assert one[0] == other[0] and len(set(one)) == 1
        gone = [np.hypot(*np.subtract(after.object_position, other[0].object_position)[:2]) for after in other]
        assert max(gone) > 0.005 and len({after.camera_angle for after in other}) > 100
        assert len({after.object_position for after in other}) <= TASK.object_steps + 1
    assert starts(TASK, Evaluation(starts="moving"))[0].group == "moving"


def test_an_episodes_motion_depends_on_its_number_alone():
    assert paths("moving") == paths("moving", batch_size=3)
    first, second, *_ = paths("moving")
    assert first[-1].object_position != second[-1].object_position


def test_only_what_is_random_moves():
    for one in paths("moving", factors="object"):
        assert len({after.camera_angle for after in one}) == len({after.target_position for after in one}) == 1
        assert len({after.object_position for after in one}) > 5


@pytest.mark.parametrize("layout", ["random", "moving"])
def test_the_expert_grasps_what_moves(layout):
    rows = evaluate(Expert("phase"), TASK, Evaluation(starts=layout, episodes=10))
    assert np.mean([row["success"] for row in rows]) >= 0.9 and {row["group"] for row in rows} == {layout}
