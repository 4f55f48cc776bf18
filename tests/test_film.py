"""Films: which frames are shown, what stands over them, what is shown of a policy, and that what is written plays."""

from types import SimpleNamespace

import av
import numpy as np
import pytest
from shared import needs_gl

from move.figures.plots import film
from move.paper import PAPER_TASKS
from move.sim.collect import attempts
from move.sim.motion.wrappers import Motions
from move.sim.scene import camera


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


def take(count: int, value: int = 0, size: int = 320, jumps: dict | None = None, **places) -> film.Take:
    """A grey take; places are (count, 3) metres, by default the object where the camera looks and no target."""
    places = places or {"object": np.tile(camera.LOOK_AT, (count, 1))}
    return film.Take(frames(count, value, size), places, np.zeros(count), jumps or {})


def test_a_title_stands_over_the_frames_and_covers_none_of_them():
    filmed = take(3)
    made = film.titled(filmed, "MOVE", "push")
    assert made.shape == (3, 320 + film.BAND, 320, 3)
    assert np.array_equal(made[:, film.BAND:], film.marked(filmed))
    assert all((band < 128).any() and (band > 250).mean() > 0.7 for band in made[:, :film.BAND]), "black on white"


def test_a_title_tells_the_step_and_what_the_rings_are_and_the_outcome_only_when_all_is_over():
    upper, lower = slice(0, film.BAND // 2), slice(film.BAND // 2, film.BAND)
    plain, ended = (film.titled(take(2), "MOVE", "push", *outcome) for outcome in ((), ("failure",)))
    assert not np.array_equal(plain[0, upper], plain[1, upper]), "the step changes"
    assert not np.array_equal(plain[0, upper], film.titled(take(2), "ADC", "push")[0, upper])
    assert len(ended) == 2 + film.LAST and np.array_equal(ended[:2], plain), "nothing is told before"
    assert (ended[2:] == ended[2]).all() and not np.array_equal(ended[2, upper], plain[1, upper])
    assert np.array_equal(ended[2, film.BAND:], plain[1, film.BAND:]), "the last image is held"
    won = film.titled(take(2), "MOVE", "push", "success")
    assert not np.array_equal(won[2, upper], ended[2, upper])
    one = film.titled(take(2), "MOVE", "faucet-open")  # which has no target
    assert (one[0, lower] < 128).sum() < (plain[0, lower] < 128).sum()


@pytest.mark.parametrize("task", PAPER_TASKS)
def test_no_title_is_cut_off(task):
    band = film.titled(take(1), "static, episode 100", task, "success")[:, :film.BAND]
    assert not (band[:, :, -4:] < 100).all(axis=3).any() and not (band[:, -2:] < 100).all(axis=3).any()


def coloured(image: np.ndarray, part: str) -> np.ndarray:
    """Row and column of every pixel of a part's ring or trail, (n, 2)."""
    return np.argwhere((np.abs(image.astype(int) - film.RINGS[part]) < 90).all(axis=2))


def test_rings_are_round_object_and_target_where_the_camera_sees_them():
    middle, near = np.array(camera.LOOK_AT), camera.position(0.0) * 0.3 + np.array(camera.LOOK_AT) * 0.7
    right = near + 0.1 * camera.axes(0.0)[0]
    (image,) = film.marked(take(1, object=middle[None], target=right[None]))
    yellow, white = coloured(image, "object"), coloured(image, "target")
    assert yellow.mean(axis=0) == pytest.approx([159.5, 159.5], abs=0.6)
    assert white.mean(axis=0)[0] == pytest.approx(159.5, abs=0.6) and white.mean(axis=0)[1] > 200
    assert np.ptp(white[:, 1]) > 1.2 * np.ptp(yellow[:, 1]), "what is nearer has a larger ring"
    assert (image[155:165, 155:165] == 0).all(), "what is in a ring stays to be seen"


def test_a_trail_shows_the_way_as_the_camera_sees_it_now_and_ends_where_the_object_is():
    way = np.array(camera.LOOK_AT) + np.linspace(-0.2, 0.2, 60)[:, None] * camera.axes(0.0)[0]
    images = film.marked(take(60, object=way))
    for step in (10, 59):
        columns = coloured(images[step], "object")[:, 1]
        places, _ = film.pixels(way[[max(0, step - film.TRAIL)]], 0.0, 320)
        assert columns.min() == pytest.approx(min(places[0, 0], columns.max() - np.ptp(columns)), abs=3)
    rows = coloured(images[59], "object")
    assert (np.abs(rows[rows[:, 1] < 200][:, 0] - 159.5) < 3).all(), "a straight line"


def test_a_word_stands_in_the_image_for_a_while_after_a_jump_and_the_trail_begins_anew():
    here, there = (np.array(camera.LOOK_AT) + side * camera.axes(0.0)[0] for side in (-0.15, 0.15))
    way = np.vstack([np.tile(here, (10, 1)), np.tile(there, (40, 1))])
    jumped, calm = (film.marked(take(50, jumps=jumps, object=way)) for jumps in ({10: "object"}, {}))
    lit = [len(coloured(image, "object")) for image in jumped]
    assert np.array_equal(jumped[:10], calm[:10]) and lit[10] > 1.5 * lit[9], "from the jump on"
    assert lit[9 + film.WORD] == lit[10] and lit[10 + film.WORD] == lit[49] < lit[10]
    assert coloured(jumped[49], "object")[:, 1].min() > 160, "no trail from where it jumped"


@needs_gl
def test_a_demonstration_of_adc_tells_its_jumps():
    shown = film.demonstration_take(film.demonstration("pick-place", "adc", image_size=16), 0)
    assert sorted(shown.jumps.values()) == ["object", "target"], "as the study compares it"
    for step, part in shown.jumps.items():
        steps = np.linalg.norm(np.diff(shown.places[part], axis=0), axis=1)
        assert steps[step - 1] > 0.03 > np.median(steps)


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
        return {"success": outcomes[len(played) - 1], "trial": number}, take(1, size=8)

    monkeypatch.setattr(film, "episode_take", play)
    spec = SimpleNamespace(evaluation=SimpleNamespace(episodes=50))
    found = film.one_of_each(lambda number: None, spec, np.random.default_rng(0), 64)
    assert [row["success"] for row, _ in found] == shown
    both = {True, False} <= set(outcomes)
    assert len(played) == (outcomes.index(not outcomes[0]) + 1 if both else 20), "as few as it takes, twenty at most"
    assert played == list(np.random.default_rng(0).permutation(50))[:len(played)]
    assert found[0][0]["trial"] == played[outcomes.index(shown[0])], "the first of its kind"


def test_a_written_film_plays_with_as_many_frames_of_the_same_size(tmp_path):
    path = film.write_film(film.titled(take(12, 90, 96), "MOVE", "push"), tmp_path / "a.mp4")
    with av.open(str(path)) as video:
        stream = video.streams.video[0]
        decoded = [frame.to_ndarray(format="rgb24") for frame in video.decode(stream)]
        assert stream.average_rate == film.FRAMES_PER_SECOND and stream.codec_context.name == "h264"
    assert len(decoded) == 12 and decoded[0].shape == (96 + film.BAND, 96, 3)
    assert abs(int(decoded[-1][film.BAND + 40, 40, 0]) - 90) < 8


@needs_gl
def test_a_demonstrations_film_is_that_of_the_first_one_that_succeeds():
    collection = film.demonstration("window-open", "move", image_size=32)
    shown = film.demonstration_take(collection, 3)
    first = next(episode for episode in attempts(collection, 3) if episode.succeeded)
    assert shown.frames.shape == (len(first.actions), 32, 32, 3) and shown.jumps == {}
    assert np.array_equal(shown.frames, np.stack(first.observations)) and set(shown.places) == {"object"}
    assert shown.angles.tolist() == [where.camera_angle for _, where in first.seen]
