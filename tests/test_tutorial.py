"""The tutorial notebooks run at small sizes, write nothing outside build/, and their exercises can be solved."""

import asyncio
import json
import os
import re
import runpy
from pathlib import Path

import nbformat
import numpy as np
import pytest
from jupyter_client.manager import KernelManager
from jupyter_server.services.contents.largefilemanager import AsyncLargeFileManager
from nbclient import NotebookClient
from papermill.iorw import load_notebook_node
from papermill.parameterize import parameterize_notebook
from traitlets.config import PyFileConfigLoader

import move
from move import paths
from move.errors import BadInput
from move.sim.collect import Collection, attempts, collect
from move.sim.coverage import configurations
from move.sim.motion.wrappers import Motions, ObjectTranslation, with_motions
from move.sim.scene.scene import Scene
from move.sim.tasks import get_task
from move.teaching import exercises, lab, marking, methods
from move.teaching import paths as traces
from move.teaching.marking import SMALL

TUTORIAL = paths.NOTEBOOKS / "tutorial"
SOLUTIONS = paths.ROOT / "docs/solutions"  # away from what students open
WRONG = {"1.1": 90, "1.2": lambda start, velocity, time, low, high: start + velocity * time, "1.3": "target",
         "2.1": lambda seen, angle: seen, "2.2": 2497, "2.3": lambda t, first, last: ([t - 1, t], [t, t, t, t]),
         "3.1": lambda actions, noise, alpha_bar: alpha_bar * actions + (1 - alpha_bar) * noise,
         "3.2": lambda x, eps, alpha_bar, alpha_bar_next: x - eps, "3.3": 2000, "4.1": 100,
         "4.2": lambda first, second: (first.mean() - second.mean(), 0.01), "4.3": 30,
         "5.1": "acting", "5.2": ObjectTranslation, "5.3": Collection(task="push", method="move", timesteps=10)}


def notebook(name: str) -> nbformat.NotebookNode:
    return nbformat.read(TUTORIAL / f"{name}.ipynb", as_version=4)


def code(name: str) -> list[nbformat.NotebookNode]:
    """The code cells but for the one that is for Colab."""
    return [cell for cell in notebook(name).cells
            if cell.cell_type == "code" and "colab" not in cell.metadata.get("tags", [])]


def asked(name: str) -> dict[str, str]:
    """Each exercise of a notebook: its number, and the name that its answer has."""
    found = re.findall(r'check\("([\d.]+)", (\w+)\)', "\n".join(cell.source for cell in code(name)))
    assert len(found) == len(dict(found))
    return dict(found)


SOLVED = [(name, number, answer) for name in SMALL for number, answer in asked(name).items()]


@pytest.fixture(scope="module")
def root(tmp_path_factory) -> Path:
    """A root of its own, with what a tutorial may read."""
    folder = tmp_path_factory.mktemp("tutorials")
    for name in ("profiles", "results", "notebooks"):
        (folder / name).symlink_to(paths.ROOT / name)
    return folder


@pytest.fixture(scope="module")
def kernel(root):
    """One kernel for all tutorials, for what it imports takes longer than what they do; emptied before each."""
    manager = KernelManager(kernel_name="python3")
    manager.start_kernel(cwd=str(root), env=os.environ | {
        "MOVE_ROOT": str(root), "PYTHONPATH": str(Path(move.__file__).parent.parent),
        "MPLBACKEND": "module://matplotlib_inline.backend_inline"})
    yield manager
    manager.shutdown_kernel(now=True)


@pytest.mark.parametrize("name", SMALL)
def test_a_tutorial_runs_and_leaves_nothing_outside_build(name, root, kernel):
    done = parameterize_notebook(load_notebook_node(str(TUTORIAL / f"{name}.ipynb")), SMALL[name])
    done.cells.insert(0, nbformat.v4.new_code_cell("%reset -f"))
    NotebookClient(done, km=kernel, timeout=300).execute()
    assert all(cell.execution_count for cell in done.cells if cell.cell_type == "code" and cell.source)
    said = str([cell.outputs for cell in done.cells if cell.cell_type == "code"])
    assert said.count("has no answer yet") + said.count("returns nothing yet") >= len(asked(name))
    assert {path.name for path in root.iterdir()} <= {"profiles", "results", "notebooks", "build"}


@pytest.mark.parametrize("name", ["1_a_scene_that_moves", "2_collect_and_look", "3_a_diffusion_policy"])
def test_without_gl_a_tutorial_goes_on_and_says_that_it_cannot_draw(name, monkeypatch, tmp_path):
    """In this process, cell by cell: starting another kernel would tell nothing new."""
    monkeypatch.setenv("MUJOCO_GL", "disable")
    monkeypatch.setattr(paths, "BUILD", tmp_path)
    cells, space = code(name), {}
    changes = "\n".join(f"{key} = {value!r}" for key, value in SMALL[name].items())
    said = ""
    for source in (cells[0].source, changes, *(cell.source for cell in cells[1:])):
        last = source.rsplit("\n\n", 1)[-1]
        if last.startswith(("films.", "lessons.draw_pictures")) or last == "shown":
            said += eval(last, space).data
        else:
            exec(source, space)
            said += space["shown"].data if "shown" in space else ""
    assert "libegl1" in said and not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", SMALL)
def test_a_tutorial_is_clean_and_its_lines_are_short(name):
    one, cells = notebook(name), code(name)
    nbformat.validate(one)
    assert all(not cell.outputs and cell.execution_count is None for cell in cells)
    tagged = [cell for cell in cells if "parameters" in cell.metadata.get("tags", [])]
    assert len(tagged) == 1 and set(SMALL[name]) <= set(re.findall(r"^(\w+) = ", tagged[0].source, re.M))
    assert max(len(line) for cell in one.cells for line in cell.source.splitlines()) <= 90
    told = "\n".join(cell.source for cell in one.cells)
    assert "It takes" in told and "What to try next" in told and "Predict, then look" in told
    assert all(f"Exercise {number}" in told for number in asked(name))


def test_the_tutorials_are_all_tested_and_every_exercise_is_asked_once():
    assert sorted(path.stem for path in TUTORIAL.glob("*.ipynb")) == list(SMALL)
    assert [number for _, number, _ in SOLVED] == list(exercises.EXERCISES)


@pytest.mark.parametrize("name, number, answer", SOLVED)
def test_the_solution_passes_its_check_and_a_wrong_answer_does_not(name, number, answer):
    solution = runpy.run_path(str(SOLUTIONS / f"{name}.py"))[answer]
    assert exercises.check(number, solution).right, exercises.check(number, solution)
    verdict = exercises.check(number, WRONG[number])
    assert not verdict.right and len(verdict.text) > 30
    assert "no answer yet" in str(exercises.check(number, ...))
    assert not exercises.check(number, None).right


@pytest.mark.parametrize("number, answer, hint", [
    ("1.2", lambda start, velocity, time, low, high: abs(start + velocity * time) % 1, "bounce"),
    ("1.2", lambda start, velocity, time, low, high: 1 / 0, "ZeroDivisionError"),
    ("3.2", lambda x, eps, alpha_bar, alpha_bar_next: (x - (1 - alpha_bar) ** 0.5 * eps) / alpha_bar**0.5, "elsewhere"),
    ("4.1", 4000, "more than needed"), ("4.3", 400, "enough and more"), ("1.3", "table", "allowed are"),
    ("5.1", "both", "allowed are"),
])
def test_a_half_right_answer_gets_a_hint(number, answer, hint):
    verdict = exercises.check(number, answer)
    assert not verdict.right and hint in verdict.text


@pytest.mark.parametrize("number", [number for _, number, _ in SOLVED])
@pytest.mark.parametrize("answer", [None, {"a": 1}, 10_000_000, 1e300, float("nan"), -1, "text", [1, 2], object()])
def test_whatever_is_answered_gets_a_kind_line_at_once(number, answer):
    verdict = exercises.check(number, answer)
    assert not verdict.right and len(verdict.text) > 30
    assert not any(raw in verdict.text for raw in ("stopped with", "object has no", "argument", "TiB", "Error"))


def test_a_tutorial_takes_as_long_wherever_it_is_told_and_the_paths_fit():
    start = (paths.NOTEBOOKS / "start.md").read_text(encoding="utf-8")
    found = re.findall(r"\]\((?:tutorial/)?(\w+)\.ipynb\) \| (\d+) \|", start)
    minutes = {name: int(told) for name, told in found}
    for name in SMALL:
        told = re.search(r"It takes\*\* about (\d+) minutes", notebook(name).cells[0].source)
        assert int(told[1]) == minutes[name], name
    three = sum(minutes[name] for name in ("fig1_sparse", "table2_main", "claims"))
    by_number = [minutes[name] for name in SMALL]
    assert by_number[0] + by_number[3] + three <= 45 and sum(by_number[:4]) + three <= 90
    page = (paths.ROOT / "docs/teaching.md").read_text(encoding="utf-8")
    assert all(f"{path} minutes" in start and f"| {path} |" in page for path in (45, 90))


@pytest.mark.parametrize("name", SMALL)
def test_a_tutorial_is_slides_and_begins_with_a_cell_for_colab_alone(name):
    cells = notebook(name).cells
    kinds = [cell.metadata.slideshow.slide_type for cell in cells]
    headings = [cell.source.startswith("#") for cell in cells]
    assert [kind == "slide" for kind in kinds] == headings and set(kinds) <= {"slide", "subslide", "fragment", "skip"}
    (first,) = [cell for cell in cells if "colab" in cell.metadata.get("tags", [])]
    assert first is next(cell for cell in cells if cell.cell_type == "code")
    assert "nobody has tried it" in first.source
    exec(first.source, {})  # elsewhere it does nothing


# marking --------------------------------------------------------------------------------------------------------------


@pytest.fixture
def handed_in(tmp_path) -> Path:
    """Tutorial 4 as four students hand it in: solved in part, an endless loop, no notebook, another notebook."""
    folder = tmp_path / "handed_in"
    (folder / "group 1").mkdir(parents=True)
    cells = ["draws = 5000", "from move.teaching.exercises import check", "import os\nprint('noise'); os.chdir('/')",
             "1 / 0", 'trials_needed = 385\ncheck("4.1", trials_needed)', 'check("4.2", None)',
             'assert draws == 10\ncheck("4.3", ...)\ncheck("4.3", 10_000_000)']
    mine = nbformat.v4.new_notebook(cells=list(map(nbformat.v4.new_code_cell, cells)))
    mine.cells[0].metadata["tags"] = ["parameters"]
    nbformat.write(mine, folder / "group 1" / "mine.ipynb")
    mine.cells.insert(-1, nbformat.v4.new_code_cell("while True: pass"))
    nbformat.write(mine, folder / "endless.ipynb")
    (folder / "broken.ipynb").write_text("{")
    nbformat.write(nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell("1")]), folder / "other.ipynb")
    return folder


def test_marking_runs_what_was_handed_in_apart_and_within_its_time(handed_in):
    before = sorted(handed_in.rglob("*"))
    rows = {row["notebook"]: row for row in marking.mark(handed_in, minutes=0.05)}
    assert sorted(handed_in.rglob("*")) == before and set(rows) == {
        "group 1/mine.ipynb", "endless.ipynb", "broken.ipynb", "other.ipynb"}
    mine, endless = rows["group 1/mine.ipynb"], rows["endless.ipynb"]
    assert (mine["right"], mine["of"]) == (1, 3) and mine["exercises"]["4.1"] == ""
    assert "None" in mine["exercises"]["4.2"] and "million" in mine["exercises"]["4.3"]
    assert mine["remark"].startswith("cell ") and "ZeroDivisionError" in mine["remark"]
    assert endless["right"] == 1 and endless["exercises"]["4.3"] == "not reached"
    assert endless["remark"] == "stopped after 0.05 minutes of computing"
    assert "not readable" in rows["broken.ipynb"]["remark"] and "no exercise" in rows["other.ipynb"]["remark"]


def test_marking_refuses_a_folder_without_notebooks(tmp_path):
    for folder in (tmp_path, tmp_path / "none"):
        with pytest.raises(BadInput, match="folder"):
            marking.mark(folder)


# what a browser saves -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", sorted(paths.NOTEBOOKS.rglob("*.ipynb")), ids=lambda path: path.stem)
def test_saving_a_used_notebook_leaves_it_as_git_has_it(path):
    used = nbformat.read(path, 4)
    for number, cell in enumerate(cell for cell in used.cells if cell.cell_type == "code"):
        cell.outputs, cell.execution_count = [nbformat.v4.new_output("stream", text="seen")], number
        cell.metadata |= {"execution": {"iopub.status.idle": "now"}, "collapsed": True}
    used.metadata |= {"language_info": {"name": "python", "version": "3.13.1"}, "widgets": {"state": {}}}
    model = {"type": "notebook", "content": used}
    lab.without_outputs(model, f"notebooks/{path.relative_to(paths.NOTEBOOKS)}")
    assert nbformat.writes(nbformat.from_dict(model["content"])) + "\n" == path.read_text(encoding="utf-8")
    other = {"type": "notebook", "content": used}
    lab.without_outputs(other, "my_notebooks/mine.ipynb")
    assert other["content"].cells == used.cells and other["content"].metadata == used.metadata


def test_the_labs_settings_make_jupyters_own_manager_save_no_outputs(tmp_path):
    settings = PyFileConfigLoader("config.py", str(paths.ROOT / "docs/lab")).load_config()
    (tmp_path / "notebooks").mkdir()
    manager = AsyncLargeFileManager(root_dir=str(tmp_path), config=settings)
    committed = paths.NOTEBOOKS / "statistics.ipynb"
    used = nbformat.read(committed, 4)
    used.cells[1].outputs = [nbformat.v4.new_output("stream", text="seen")]
    model = {"type": "notebook", "format": "json", "content": used}
    asyncio.run(manager.save(model, "notebooks/statistics.ipynb"))
    assert (tmp_path / "notebooks/statistics.ipynb").read_text() == committed.read_text()
    assert f"--config={Path('docs/lab/config.py')}" in (paths.ROOT / "Makefile").read_text()
    news = json.loads((paths.ROOT / "docs/lab/overrides.json").read_text())
    assert news["@jupyterlab/apputils-extension:notification"] == {"fetchNews": "false"}


# the room's own functions ---------------------------------------------------------------------------------------------


def test_traced_paths_keep_to_their_ranges_and_cover_more_with_speed():
    task = get_task("assembly")
    seen = traces.traced(task, 0.03, 0.02, 0.02, demonstrations=4, seed=0)
    assert all(task.object_range.contains((row.object_x, row.object_y, task.object_range.low[2]))
               for row in seen.itertuples())
    assert seen.object_yaw.between(*task.yaw_range).all() and seen.camera_angle.between(*task.camera_range).all()
    picked = seen[(seen.timestep >= task.object_steps)].groupby("episode")
    assert (picked.object_x.nunique() == 1).all()  # in the hand
    still = traces.traced(task, 0.0, 0.0, 0.0, demonstrations=4, seed=0)
    assert (still.groupby("episode").object_x.nunique() == 1).all()
    assert {part: share > traces.shares(still, task)[part] for part, share in traces.shares(seen, task).items()} == {
        "object": True, "target": True, "camera": True, "yaw": True}


def test_a_motion_moves_as_it_is_traced():
    """The equations alone give a path of the simulated object: same law, same range, same number of steps."""
    motion = ObjectTranslation(Scene("pick-place"), 0.03)
    episode = next(attempts(Collection(task="pick-place", method="static", timesteps=1), 0, motion))
    assert episode.succeeded and motion.moves == get_task("pick-place").object_steps


def test_a_method_of_ones_own_is_collected_without_editing_the_package():
    plan = Collection(task="pick-place", method="static", timesteps=150)
    plain, _ = collect(plan, 0)
    same, _ = collect(plan, 0, env=Scene("pick-place"))
    assert np.array_equal(plain.observations, same.observations)
    move_too, _ = collect(plan, 0, env=with_motions(Scene("pick-place"), Motions(), "all"))
    as_move, _ = collect(plan.model_copy(update={"method": "move"}), 0)
    assert np.array_equal(move_too.actions, as_move.actions) and not np.array_equal(move_too.actions, plain.actions)
    seen = configurations(plan, 0, with_motions(Scene("pick-place"), Motions(), "all"))
    assert seen.groupby("episode").object_x.nunique().max() > 1


def test_one_scene_for_the_parts_of_a_mixture_is_refused():
    mixture = Collection(task="pick-place", method="mixture", timesteps=100, shares={"static": 0.5, "move": 0.5})
    with pytest.raises(BadInput, match="env: one given for a mixture"):
        collect(mixture, 0, env=Scene("pick-place"))


def test_a_measured_method_is_a_row_of_the_table():
    from move.teaching.lessons import keypoint_training

    mixture = Collection(task="pick-place", method="mixture", timesteps=100, shares={"static": 0.5, "move": 0.5})
    row = methods.measure("both", mixture, keypoint_training(100, 5), episodes=2)
    table = methods.compared([row])
    assert table.index.tolist() == ["both"] and row["low"] <= row["success"] <= row["high"]
    assert table["object cells (%)"].iloc[0] == round(100 * row["object"]) > 0


def test_a_kernel_of_the_tests_imports_this_package():
    assert Path(move.__file__).is_relative_to(paths.ROOT) or "MOVE_ROOT" in os.environ
