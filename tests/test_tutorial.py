"""The tutorial notebooks run at small sizes, write nothing outside build/, and their exercises can be solved."""

import os
import re
import runpy
from pathlib import Path

import matplotlib
import nbformat
import numpy as np
import pytest
from jupyter_client.manager import KernelManager
from nbclient import NotebookClient
from papermill.iorw import load_notebook_node
from papermill.parameterize import parameterize_notebook

import move
from move import paths
from move.errors import BadInput
from move.sim.collect import Collection, attempts, collect
from move.sim.coverage import configurations
from move.sim.motion.wrappers import Motions, ObjectTranslation, with_motions
from move.sim.scene.scene import Scene
from move.sim.tasks import get_task
from move.teaching import exercises, methods
from move.teaching import paths as traces

TUTORIAL = paths.NOTEBOOKS / "tutorial"
SMALL = {
    "1_a_scene_that_moves": {"demonstrations": 3, "timesteps": 200, "image_size": 48},
    "2_collect_and_look": {"timesteps": 200, "image_size": 32},
    "3_a_diffusion_policy": {"timesteps": 200, "gradient_steps": 40, "episodes": 2, "image_size": 48},
    "4_what_a_success_rate_can_say": {"draws": 10},
    "5_change_the_method": {"timesteps": 150, "gradient_steps": 20, "episodes": 2},
}
WRONG = {"1.1": 90, "1.2": lambda start, velocity, time, low, high: start + velocity * time, "1.3": "target",
         "2.1": lambda seen, angle: seen, "2.2": 2497, "2.3": lambda t, first, last: ([t - 1, t], [t, t, t, t]),
         "3.1": lambda actions, noise, alpha_bar: alpha_bar * actions + (1 - alpha_bar) * noise,
         "3.2": lambda x, eps, alpha_bar, alpha_bar_next: x - eps, "3.3": 2000, "4.1": 100,
         "4.2": lambda first, second: (first.mean() - second.mean(), 0.01), "4.3": 30,
         "5.1": "acting", "5.2": ObjectTranslation, "5.3": Collection(task="push", method="move", timesteps=10)}


def notebook(name: str) -> nbformat.NotebookNode:
    return nbformat.read(TUTORIAL / f"{name}.ipynb", as_version=4)


def code(name: str) -> list[nbformat.NotebookNode]:
    return [cell for cell in notebook(name).cells if cell.cell_type == "code"]


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
    matplotlib.use("Agg")
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
    solution = runpy.run_path(str(TUTORIAL / "solutions" / f"{name}.py"))[answer]
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
