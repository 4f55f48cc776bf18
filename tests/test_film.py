"""Films: which frames are shown, what stands over them, what is shown of a policy, and that what is written plays."""

from types import SimpleNamespace

import av
import numpy as np
import pytest

from move.figures.plots import film
from move.machine import gl_problem
from move.paper import PAPER_TASKS
from move.sim.collect import attempts
from move.sim.motion.wrappers import Motions


def frames(count: int, value: int | None = None, size: int = 64) -> np.ndarray:
    """Frames of one grey each: their own number, or `value`."""
    greys = np.arange(count) if value is None else np.full(count, value)
    return np.repeat(greys.astype(np.uint8), size * size * 3).reshape(count, size, size, 3)


def test_a_strip_shows_the_first_and_the_last_frame_and_even_steps_between():
    shown, steps = film.strip(frames(101), 5)
    assert steps == [0, 25, 50, 75, 100] and shown[:, 0, 0, 0].tolist() == steps
    assert film.strip(frames(10), 4)[1] == [0, 3, 6, 9]


def test_a_strip_of_more_frames_than_there_are_repeats_some_and_leaves_none_out():
    assert sorted(set(film.strip(frames(3), 8)[1])) == [0, 1, 2]


def test_a_title_stands_over_the_frames_and_covers_none_of_them():
    made = film.titled(frames(3, size=320), "MOVE", "push", "success")
    assert made.shape == (3, 320 + film.BAND, 320, 3)
    assert np.array_equal(made[:, film.BAND:], frames(3, size=320))
    assert all((band < 128).any() and (band > 250).mean() > 0.7 for band in made[:, :film.BAND]), "black on white"


def test_a_title_tells_the_step_the_outcome_and_what_is_what():
    upper, lower = slice(0, film.BAND // 2), slice(film.BAND // 2, film.BAND)
    two = frames(2, 0, size=320)
    plain, ended = film.titled(two, "MOVE", "no task"), film.titled(two, "MOVE", "no task", "failure")
    assert not np.array_equal(plain[0, upper], plain[1, upper]), "the step changes"
    assert not np.array_equal(plain[0, upper], film.titled(two, "ADC", "no task")[0, upper])
    assert (ended[0, upper] < 128).sum() > (plain[0, upper] < 128).sum(), "more letters with an outcome"
    assert (plain[:, lower] == 255).all() and (film.titled(two, "MOVE", "push")[0, lower] < 250).any()


def test_every_task_of_the_paper_says_what_is_what_in_its_images():
    assert set(film.SEEN) >= set(PAPER_TASKS) and all("object" in text for text in film.SEEN.values())


def test_films_side_by_side_keep_their_order_and_the_shorter_one_its_last_frame():
    both = film.side_by_side([frames(2, size=10), frames(5, size=10)])
    assert both.shape == (5, 10, 10 + 8 + 10, 3)
    assert both[:, 0, 0, 0].tolist() == [0, 1, 1, 1, 1] and both[:, 0, -1, 0].tolist() == [0, 1, 2, 3, 4]
    assert (both[:, :, 10:18] == 255).all(), "a white gap between them, none before or after"
    assert np.array_equal(film.side_by_side([frames(3)]), frames(3))


def test_only_one_part_moves_and_the_title_says_how_much_faster():
    fields = {"translation": "object_speed", "rotation": "yaw_speed", "camera": "camera_speed"}
    for part, field in fields.items():
        speeds = film.only(part).model_dump(exclude={"speed_law"})
        assert {name for name, speed in speeds.items() if speed} == {field}
    assert film.pace("translation") == "as fast as in the data"
    assert film.pace("camera") == f"{0.07 / Motions().camera_speed:.2g} times as fast as in the data"


@pytest.mark.parametrize("outcomes, shown", [
    ([True, True, False, True], [True, False]), ([False, True], [True, False]), ([True] * 30, [True]),
    ([False] * 30, [False])])
def test_one_success_and_one_failure_are_shown_the_success_first_and_the_search_ends(monkeypatch, outcomes, shown):
    played = []

    def play(policy, spec, number, image_size):
        played.append(number)
        return {"success": outcomes[len(played) - 1], "trial": number}, frames(1)

    monkeypatch.setattr(film, "episode_frames", play)
    spec = SimpleNamespace(evaluation=SimpleNamespace(episodes=50))
    found = film.one_of_each(lambda number: None, spec, np.random.default_rng(0), 64)
    assert [row["success"] for row, _ in found] == shown
    both = {True, False} <= set(outcomes)
    assert len(played) == (outcomes.index(not outcomes[0]) + 1 if both else 20), "as few as it takes, twenty at most"
    assert len(set(played)) == len(played) and max(played) < 50
    assert found[0][0]["trial"] == played[outcomes.index(shown[0])], "the first of its kind"


def test_a_written_film_plays_with_as_many_frames_of_the_same_size(tmp_path):
    path = film.write_film(film.titled(frames(12, 90, 96), "MOVE", "push"), tmp_path / "a.mp4")
    with av.open(str(path)) as video:
        stream = video.streams.video[0]
        decoded = [frame.to_ndarray(format="rgb24") for frame in video.decode(stream)]
        assert stream.average_rate == film.FRAMES_PER_SECOND and stream.codec_context.name == "h264"
    assert len(decoded) == 12 and decoded[0].shape == (96 + film.BAND, 96, 3)
    assert abs(int(decoded[-1][film.BAND + 40, 40, 0]) - 90) < 8


@pytest.mark.skipif(bool(gl_problem()), reason=f"images cannot be drawn here: {gl_problem()}")
def test_a_demonstrations_film_is_that_of_the_first_one_that_succeeds():
    collection = film.demonstration("window-open", "move", image_size=32)
    shown = film.demonstration_frames(collection, 3)
    first = next(episode for episode in attempts(collection, 3) if episode.succeeded)
    assert shown.shape == (len(first.actions), 32, 32, 3) and np.array_equal(shown, np.stack(first.observations))
