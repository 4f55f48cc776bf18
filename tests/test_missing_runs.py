"""Every figure is drawn, and its paragraph written, where one method's runs are not there, or a profile has few."""

import re
from types import SimpleNamespace

import cells
import matplotlib.pyplot as plt
import pandas as pd
import pytest

from move.errors import BadInput
from move.figures import decided, decided_places, fig_coverage, table1_spatial_factors
from move.figures.page.parameters import specs, with_runs
from move.figures.plots import style
from move.statistics.training_noise import UNKNOWN
from move.study.profiles import Profile, load_profile

LAPTOP = load_profile("laptop")
SLOW = {"fig_coverage", "radius"}  # collect anew what their policies learnt from: only words are tried here
WITH_RUNS = with_runs()
READING = [name for name in (*WITH_RUNS, "claims") if name not in SLOW]


@pytest.fixture
def figures(tmp_path, monkeypatch):
    """Where the figures go, drawn but not written; nothing is run."""
    def drawn(figure, *others):
        figure.set_layout_engine("none")  # whose time would be most of it
        figure.draw_without_rendering()
        cells.picture_left_empty(figure, *others)

    monkeypatch.setattr(style, "save", drawn)
    monkeypatch.setenv("MOVE_STORED_ONLY", "1")
    monkeypatch.setattr(Profile, "figures", property(lambda profile: tmp_path / "figures"))
    yield tmp_path / "figures"
    plt.close("all")


@pytest.fixture(scope="module", params=["static", "move"])
def alone(request, tmp_path_factory):
    """A folder with the shipped results of one method alone."""
    folder = tmp_path_factory.mktemp(request.param)
    for spec in (spec for name in WITH_RUNS for spec in specs(name, LAPTOP)):
        stored = LAPTOP.results / f"{spec.hash}.json"
        if spec.collection and spec.method == request.param and stored.exists():
            (folder / stored.name).unlink(missing_ok=True)
            (folder / stored.name).symlink_to(stored)
    return request.param, folder


@pytest.mark.parametrize("name", READING)
def test_a_figure_is_drawn_where_only_one_method_is_there(name, alone, figures, monkeypatch):
    method, folder = alone
    monkeypatch.setattr(Profile, "results", property(lambda profile: folder))
    own = specs(name, LAPTOP) if name in WITH_RUNS else []
    if own and not any((folder / f"{spec.hash}.json").exists() for spec in own):
        with pytest.raises(BadInput, match=f"none of the {len(own)} runs"):
            cells.execute(name)
        return
    made = cells.execute(name)["made"]
    assert "nan" not in made.answer.data and list(figures.glob(f"{name}*"))
    assert not re.search(r":\*\* ?[.;]", made.answer.data), "nothing is said"
    if missing := len(made.data.missing):
        told = f"{missing} of {len({run.spec for run in made.data.runs})} runs are missing"
        assert told in made.answer.data and told in made.data.remark


@pytest.mark.parametrize("name", ["claims", "table2_main"])
def test_what_a_profile_without_images_has_of_a_figure_is_drawn(name, figures):
    made = cells.execute(name, profile="laptop-keypoints")["made"]
    assert "nan" not in made.answer.data and list(figures.glob(f"{name}*"))


def test_a_claim_that_is_asked_again_is_shown_once_its_last_run_is_there():
    runs = decided.runs(LAPTOP, seeds_7=1, seeds_25=1, seeds_26=1)
    last = next(run.spec for run in runs if run.labels == {"claim": 26, "seed": 10, "variant": "without"})
    episodes = pd.DataFrame([
        {**run.labels, "run": run.spec.hash, "method": run.spec.method, "trial": trial, "success": trial % 3 > 0,
         "group": ""} for run in runs if run.spec != last for trial in range(30)])
    data = SimpleNamespace(runs=runs, missing=[(last, "not computed yet")], episodes=episodes,
                           noise=lambda: UNKNOWN)
    assert [set(table.claim) for table in decided.tables(data).values()] == [{7, 25}] * 2


@pytest.mark.parametrize("missing", [[], ["the last run"]])
def test_places_that_are_asked_again_are_shown_once_their_last_run_is_there(missing):
    episodes = pd.DataFrame({"run": "a", "method": "static", "seed": 10, "trial": range(20), "success": True,
                             "group": ["point", "grid"] * 10, "object_x": 0.0,
                             "object_y": [0.6, 0.6, 0.6, 0.64, 0.6, 0.66, *[0.6] * 14]})
    data = SimpleNamespace(missing=missing, episodes=episodes, noise=lambda grid: UNKNOWN)
    counted = decided_places.tables(data)[""].set_index("group").episodes.to_dict()
    assert counted == ({} if missing else {"point": 10, "near": 8, "far": 1, "grid": 10})


def test_coverage_is_told_where_nothing_has_a_counterpart():
    rows = [{"task": task, "moves": moves, "joint": place / 9, "value": place / 12}
            for place, (task, moves) in enumerate((task, moves) for task in ("push", "hammer")
                                                  for moves in ("all", "object", "camera"))]
    assert "MOVE's gains" not in fig_coverage.coverage_text(pd.DataFrame(rows))


def test_what_static_loses_is_as_sure_as_the_trainings_of_both_methods_where_nothing_else_is_known():
    """All cells of static have the same rates; how trainings differ is seen in MOVE's."""
    shares = {"static": (0.5, 0.5, 0.5), "move": (0.2, 0.5, 0.8)}
    episodes = pd.DataFrame([
        {"method": method, "factors": factors, "seed": seed, "trial": trial, "group": "", "run": f"{method}{seed}",
         "success": (trial * 7) % 100 < 100 * share}
        for method, each in shares.items() for factors in ("object", "object+target", "all")
        for seed, share in enumerate(each) for trial in range(100)])
    widths = []
    for part in (episodes, episodes[episodes.method == "static"]):
        data = SimpleNamespace(episodes=part, results=[], noise=lambda observation: UNKNOWN)
        lost = table1_spatial_factors.tables(data, observation="rgb")["lost"]
        widths.append(float((lost.high - lost.low).mean()))
    assert widths[0] > 2 * widths[1]
