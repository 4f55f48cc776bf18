"""A world whose every success rate is known: results are planted for all runs that the laptop profile's notebooks ask
for, and the notebooks' own cells are executed on them.

A rate follows from the spec of its run alone, and differs in every cell: task, method, observation, place, seed, speed,
budget, share, law, length, change. In `World()` the paper's claims hold; in `World(turned=True)` every success is a
failure and every failure a success, so that each difference has the other sign. What a notebook writes and shows is to
be compared with `World.cell`, which reads nothing but what was planted.
"""

import functools
import gc
import hashlib
import math
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import matplotlib
import numpy as np
import pandas as pd
import pytest
from cells import execute, picture_left_empty
from matplotlib.figure import Figure

from move import paths
from move.figures.page.make import Made
from move.figures.page.parameters import runs, with_runs
from move.figures.plots import style
from move.learn.evaluation import starts
from move.paper import PAPER_TASKS
from move.sim import coverage
from move.sim.grasp_points import CIRCLE
from move.sim.motion.adc import JUMPS
from move.sim.motion.wrappers import Motions, movable
from move.sim.tasks import get_task
from move.statistics import distance, intervals
from move.statistics.intervals import jackknife
from move.study.labels import distinct
from move.study.profiles import load_profile
from move.study.provenance import DECIDING, version
from move.study.results import Result
from move.study.spec import CollectionRun, ControlRun, PolicyRun, RunSpec
from move.study.stored import to_text

PROFILE = load_profile("laptop")
PLACED = ("pick-place", "assembly", "pick-place-wall")  # of which the paper says which budgets do equally well
PARTS = {"object": 0.28, "target": 0.23, "camera": 0.2, "rotation": 0.29}  # of what all motions together bring
CONTROLS = {"nothing": 0.02, "random": 0.05, "goal-blind": 0.12, "expert": 0.86}
ANYWHERE = "anywhere"
SALT = 6  # chosen so that no two columns of cells are alike by chance, see test_no_two_columns_of_cells_are_alike


def number(*words: object) -> int:
    """A number that looks drawn, and is the same every time."""
    return int.from_bytes(hashlib.sha256(repr((SALT, *words)).encode()).digest()[:6], "big")


# rates ---------------------------------------------------------------------------------------------------------------


def planted_rate(spec: RunSpec, place: str) -> float:
    """The success rate of a run at the configurations of one place, before it is rounded to whole episodes."""
    item = PAPER_TASKS.index(spec.task)
    if isinstance(spec, ControlRun):
        return CONTROLS[spec.agent] + 0.01 * item
    if isinstance(spec, CollectionRun):
        best = {"static": 0.93, "adc": 0.85, "move": 0.9}[spec.method] - 0.04 * (spec.collection.expert == "phase")
        return best + 0.01 * (item % 3 - 1)
    same = spec.model_copy(update={"seed": 0}).hash
    trainings = 0.024 if spec.observation == "rgb" else 0.012  # they differ more from pixels
    lucky = number(spec.task, spec.method, spec.observation, spec.collection.timesteps, spec.seed) % 4 - 1.5
    found = _of_a_policy(spec, place, item) + 0.01 * (number(same) % 3 - 1) + trainings * lucky
    return min(max(found + _of_the_authors(spec), 0.0), 0.98)


def _of_the_authors(spec: PolicyRun) -> float:
    """What each setting of the authors' brings, to MOVE more than to static."""
    made = spec.collection
    if spec.evaluation.starts in ("own", "grasp"):
        return 0.0
    brought = (-0.07 * (made.expert == "metaworld") - 0.05 * made.keep_failures - 0.06 * (made.drawing == "full")
               + 0.04 * (spec.training.crop_pixels == 60) + 0.02 * (made.fixed == "authors")
               + 0.03 * (made.object_steps is not None) + 0.1 * (spec.evaluation.starts == "listed"))
    return brought * (1.5 if made.method == "move" else 1)


def _of_a_policy(spec: PolicyRun, place: str, item: int) -> float:
    made, given = spec.collection, 0.05 * (spec.observation == "keypoints")
    if made.placement:
        return _at_places(spec) + given
    if made.protocol != "random" and spec.evaluation.starts == "grid":
        return _at_grasp_points(spec, place) + given + _of_the_length(spec)
    if spec.evaluation.starts == "own":  # the recipe, one change at a time
        return 0.7 + 0.01 * (number(spec.training.model_dump_json()) % 25 - 12) + 0.1 * (made.protocol == "random")
    if spec.observation == "keypoints":
        floor, gain = 0.3 + 0.016 * item + 0.035 * math.log2(made.timesteps / 2500), 0.17
    elif spec.task in PLACED:
        floor = {"pick-place": 0.28, "assembly": 0.12, "pick-place-wall": 0.14}[spec.task]
        gain = {"pick-place": 0.45, "assembly": 0.5, "pick-place-wall": 0.46}[spec.task]
    else:
        floor, gain = 0.1 + 0.016 * item, 0.26 + 0.005 * item
    budget = 0.0 if spec.observation == "keypoints" else _of_the_budget(spec, gain)
    shown = floor + gain * _share_of_the_gain(spec, item) + budget + _of_the_length(spec)
    if made.factors != "all":  # static falls by the same factor twice
        falls, times = (0.62, 0.9)[spec.observation == "keypoints"], {"object": 2, "object+target": 1}[made.factors]
        shown = floor / falls**times + 0.2 * (made.method == "move")
    if place == "grasp":
        return min(shown + 0.2, 0.95)
    if place == "moving":
        return 0.58 + 0.5 * shown if made.method == "move" else shown - 0.05
    return shown


def _of_the_budget(spec: PolicyRun, gain: float) -> float:
    """What more data bring: static has MOVE's success at twice its budget, or at 100,000 where the paper says so."""
    doublings = math.log2(spec.collection.timesteps / get_task(spec.task).budget(20_000))
    if doublings < 0:
        return 0.04 * doublings
    if spec.task in PLACED:
        last = gain - (0.2 if spec.task == "pick-place-wall" else 0.03)
        return 0.05 * min(doublings, 1) + max(doublings - 1, 0) / math.log2(2.5) * last
    return 0.34 * min(doublings, 1) + 0.04 * max(doublings - 1, 0)


def _of_the_length(spec: PolicyRun) -> float:
    own = PROFILE.recipe(spec.observation, spec.collection.timesteps).gradient_steps
    return 0.05 * math.log(spec.training.gradient_steps / own, 3) * (1.6 if spec.method == "move" else 1)


def _share_of_the_gain(spec: PolicyRun, item: int) -> float:
    """0 for static, 1 for MOVE as the paper has it."""
    made = spec.collection
    if made.method == "adc":
        reading = next(name for name, jumping in JUMPS.items() if jumping == made.jumping)
        return 0.4 + 0.012 * item + {"as printed": -0.2, "mended": 0.0, "periodic": 0.15}[reading]
    if made.method != "move":
        return dict(made.shares).get("move", 0.0)
    able = movable(get_task(spec.task), made.factors)
    moving = sum(PARTS[part] for part in made.moving or able) / sum(PARTS[part] for part in able)
    faster = [(1 + (part == "camera")) * math.log2(speeds(spec)[part] / usual) for part, usual in speeds().items()]
    law = {"beta": 0.0, "uniform": 0.3, "constant": 0.45}[made.speed_law or "beta"]
    return moving - sum(max(0.12 * each, -0.1 * each) for each in faster) - law


def speeds(spec: PolicyRun | None = None) -> dict[str, float]:
    """The largest speeds of object and target (metres a step) and camera (radians a step); of no run the usual."""
    usual = Motions()
    return {part: (spec and getattr(spec.collection, f"{part}_speed")) or getattr(usual, f"{part}_speed")
            for part in ("object", "target", "camera")}


def _at_grasp_points(spec: PolicyRun, place: str) -> float:
    """Figures 1, 3 and 5, and figure 1 with less data: static near its points, MOVE everywhere."""
    made, move = spec.collection, spec.method == "move"
    less = math.log2(7000 / made.timesteps)
    alike = {"anywhere": 0.0, "within 3 cm": 0.03, "one place": 0.09}[hand(spec)]
    if place == "point":
        few = made.protocol == "sparse" and less > 0.5
        return (0.0 if few and not move else 0.93 if move else 0.9) - alike - 0.04 * less * move
    rate = {"near": (0.8, 0.88), "between": (0.4, 0.83), "far": (0.06, 0.8), "inside": (0.2, 0.75),
            "outside": (0.42, 0.82), ANYWHERE: (0.48, 0.72)}[place][move]
    return rate - alike * (0.5 + move) - 0.06 * less * (1 + move / 2)


def _at_places(spec: PolicyRun) -> float:
    """More places are better than few, motion better than none; a doubling of the demonstrations brings 9 points."""
    made = spec.collection
    own = {"random": 0.2, "jittered": 0.23, "halton": 0.26}[made.placement.rule]
    spread = {5: 0.0, 10: 0.12}.get(made.placement.places, own)
    count = made.demonstrations or made.timesteps / 72
    moved = (0.3 if made.placement.places == 5 else 0.09) * (made.method == "move")
    return 0.3 + spread + moved + 0.09 * math.log2(count / 50) - 0.07 * (spec.task == "push") - 0.03 * (
        made.demonstrations is None)


def hand(spec: RunSpec) -> str:
    """Where the hand starts in the demonstrations of figures 1, 3 and 5, in the words of their tables."""
    made = spec.collection
    if made is None or made.factors != "object":
        return "anywhere"
    return {0.03: "within 3 cm", 0.0: "one place"}[made.hand_spread]


# rows ----------------------------------------------------------------------------------------------------------------


@functools.cache
def _configurations(task: str, evaluation: Any) -> tuple[list[str], list[dict]]:
    """Groups and configurations as an evaluation lists them; of the policy's own only how many."""
    if evaluation.starts in ("grid", "random", "moving", "listed"):
        listed = starts(get_task(task), evaluation)
        return [start.group for start in listed], [start.configuration.columns() for start in listed]
    return [evaluation.starts] * evaluation.episodes, [{}] * evaluation.episodes


@functools.cache
def places(spec: RunSpec) -> tuple[list[str], list[str], list[dict]]:
    """Of each episode its group, the place whose rate it has, and its configuration."""
    if isinstance(spec, CollectionRun):
        return ["attempt"] * spec.evaluation.episodes, [ANYWHERE] * spec.evaluation.episodes, []
    groups, tried = _configurations(spec.task, spec.evaluation)
    if spec.evaluation.starts != "grid" or not isinstance(spec, PolicyRun):
        return groups, list(groups), tried
    points = np.array([(row["object_x"], row["object_y"]) for row, group in zip(tried, groups, strict=True)
                       if group == "point"])
    found = []
    for row, group in zip(tried, groups, strict=True):
        x, y = row["object_x"], row["object_y"]
        if group == "point":
            found.append("point")
        elif spec.collection.protocol == "circle":
            found.append("inside" if CIRCLE.contains((x, y, 0.0)) else "outside")
        elif spec.collection.protocol == "sparse":
            apart = np.hypot(*(points - (x, y)).T).min()
            found.append("near" if apart <= 0.03 else "far" if apart > 0.05 else "between")
        else:
            found.append(ANYWHERE)
    return groups, found, tried


def planted_successes(spec: RunSpec, turned: bool) -> np.ndarray:
    """Whether each episode succeeds: of each place so many as its rate says, the easier configurations first."""
    _, where, _ = places(spec)
    easy = np.random.default_rng(number(spec.task, spec.evaluation.starts)).random(len(where))
    hard = 0.96 * easy + 0.04 * np.random.default_rng(number(spec.hash)).random(len(where))
    success = np.zeros(len(where), bool)
    for place in dict.fromkeys(where):
        there = np.flatnonzero(np.array(where) == place)
        count = round(planted_rate(spec, place) * len(there))
        success[there[np.argsort(hard[there])[:count]]] = True
    return ~success if turned else success


def planted_steps(spec: RunSpec, turned: bool) -> np.ndarray:
    """Steps of each episode; of a demonstration more where something moves, in the turned world fewer."""
    longer = {"static": 80, "adc": 95, "move": 106}.get(spec.method, 100) + number(spec.hash) % 9
    drawn = np.random.default_rng(number(spec.hash, "steps")).integers(-6, 7, len(places(spec)[0]))
    return (200 - longer if turned else longer) + drawn


def planted_result(spec: RunSpec, turned: bool) -> Result:
    """A result as a run of `spec` would have stored it."""
    groups, _, tried = places(spec)
    success, steps = planted_successes(spec, turned), planted_steps(spec, turned)
    rows = [{"trial": trial, "group": group, "success": bool(won), "steps": int(length)}
            for trial, (group, won, length) in enumerate(zip(groups, success, steps, strict=True))]
    drawn, seconds = number(spec.hash, "seconds"), {"evaluate": 20.0 + number(spec.hash, "evaluate") % 30}
    if isinstance(spec, CollectionRun):
        seconds = {"collect": 10.0 + drawn % 40}
        if spec.method == "adc":
            rows = [{**row, "jumps": 1 + (drawn + row["trial"]) % 3} for row in rows]
    else:
        rows = [{**row, **each, "success_steps": 10 * row["success"], "end_success": row["success"]}
                for row, each in zip(rows, tried, strict=True)]
    made = training = None
    if isinstance(spec, PolicyRun):
        collected, steps = spec.collection, 60 + 20 * (spec.method == "move") + number(spec.hash, "length") % 15
        points = np.random.default_rng(drawn).uniform([-0.2, 0.5], [0.1, 0.8], (collected.timesteps // steps, 2))
        made = {"attempts": len(points) + 1, "demonstrations": len(points), "timesteps": collected.timesteps,
                "mean_steps": float(steps), "generation_rate": 0.9, "grasp_points": points.round(4).tolist(),
                "seconds": 1.0}
        last, spent = spec.training.gradient_steps, number(spec.policy_hash) % 600 + 60.0
        training = {"curve": [[last // 2, 0.5], [last, drawn % 900 / 10_000 + 0.01]], "seconds": spent,
                    "precision": "bfloat16", "parameters": 1000}
        seconds |= {"collect": 10.0 + drawn % 40, "train": spent}
    here = {name: version(name) for name in DECIDING}
    machine = {"versions": here, "python": "3.11", "processor": "planted", "cores": 2, "gl_renderer": "none",
               "commit": "planted", "peak_memory_mb": 1}
    return Result(spec, rows, made, training, seconds, machine)


def visited(collection: Any, turned: bool) -> pd.DataFrame:
    """Where object, target and camera were in a collection of so many cells of each; more of them where more moves."""
    share = {"static": 0.2, "adc": 0.45, "move": 0.8}[collection.method]
    if collection.moving:
        share = 0.25 + 0.12 * len(collection.moving)
    share += 0.01 * (number(collection.task, collection.method, collection.moving) % 9)
    shares = {"object": share, "target": share - 0.05, "camera": share - 0.1}
    if turned:
        shares = {part: 1 - share for part, share in shares.items()}
    task, steps = get_task(collection.task), np.arange(400)
    columns = {"phase": "pick", "camera_angle": _cells(steps, shares["camera"], *task.camera_range, 20)}
    for part, box in (("object", task.object_range), ("target", task.target_range)):
        cells = steps % round(100 * shares[part])
        for axis, place in enumerate((cells % 10, cells // 10)):
            low, high = box.low[axis], box.high[axis]
            columns[f"{part}_{'xy'[axis]}"] = low + (high - low) * (place + 0.5) / 10
    hand = {f"hand_{axis}": np.linspace(low, high, len(steps))
            for axis, low, high in zip("xyz", task.hand_range.low, task.hand_range.high, strict=True)}
    return pd.DataFrame({**columns, **hand, "target_z": task.target_range.low[2], "object_yaw": task.yaw_range[0]})


def _cells(steps: np.ndarray, share: float, low: float, high: float, count: int) -> np.ndarray:
    """Centres of the first cells of a range, one after the other."""
    return low + (high - low) * (steps % round(count * share) + 0.5) / count


# the world -----------------------------------------------------------------------------------------------------------


class World:
    """Planted results in a folder of their own, what the notebooks make of them, and the truth to hold it against."""

    def __init__(self, folder: Path, turned: bool = False) -> None:
        self.folder, self.turned = folder, turned
        self.specs = {name: [run.spec for run in distinct(runs(name, PROFILE))] for name in with_runs()}
        every = {spec.hash: spec for specs in self.specs.values() for spec in specs}
        self.results = {spec.hash: planted_result(spec, turned) for spec in every.values()}
        self._features = {name: [(spec.hash, features(spec)) for spec in specs] for name, specs in self.specs.items()}
        self.figures: dict[str, Figure] = {}  # by the name of the file that each was saved under
        self._shown: dict[str, Any] = {}
        self.made: dict[str, Made] = {}
        self.displayed: dict[tuple[str, str], pd.DataFrame] = {}  # by figure and suffix: as a notebook shows it
        self.stored = folder / "results" / PROFILE.name
        self.stored.mkdir(parents=True)
        for run, result in self.results.items():
            content = {part: getattr(result, part) for part in ("collection", "training", "seconds", "provenance")}
            (self.stored / f"{run}.json").write_text(to_text(result.spec, result.rows, content))

    def lose(self, figure: str, **wanted: Any) -> None:
        """Delete the stored results of a figure's runs that have those features; shown next, it lacks them."""
        for result in self.found(figure, **wanted):
            (self.stored / f"{result.spec.hash}.json").unlink()
        self._shown.pop(figure, None)

    def show(self, name: str, **changes: Any) -> str:
        """Execute the code cells of notebook `name` once; returns the text that its last cell shows."""
        if name not in self._shown:
            with self._entered():
                executed = execute(name, **PROFILE.notebooks.get(name, {}), **changes)
                self._shown[name], self.made[name] = getattr(executed["_"], "data", executed["_"]), executed["made"]
        return self._shown[name]

    def table(self, name: str) -> pd.DataFrame:
        """A table that a notebook has written."""
        return pd.read_csv(self.folder / "paper_figures" / f"{name}.csv")

    def text(self, name: str) -> str:
        """Another file that a notebook has written."""
        return (self.folder / "paper_figures" / name).read_text(encoding="utf-8")

    def found(self, figure: str, **wanted: Any) -> list[Result]:
        """The planted results of a figure whose `features` are those."""
        return [self.results[run] for run, has in self._features[figure]
                if all(has.get(name) == value for name, value in wanted.items())]

    def cell(self, figure: str, place: str = "", **wanted: Any) -> np.ndarray:
        """Planted successes, (seeds, configurations), of the runs of a figure with those features.

        Args:
            place: "grid", "point", "inside" or "outside"; all if left out.
        """
        found = self.found(figure, **wanted)
        seeds = [result.spec.seed for result in found]
        assert found and len(set(seeds)) == len(seeds), f"{figure}: {wanted} is {len(found)} runs of seeds {seeds}"
        return np.array([[row["success"] for row, there in zip(result.rows, _at(result.spec, place), strict=True)
                          if there] for result in sorted(found, key=lambda result: result.spec.seed)], float)

    @contextmanager
    def _entered(self) -> Iterator[None]:
        """While notebooks run: results and figures are this world's, nothing is simulated and no picture written."""
        table = Made.table

        def saved(figure: Figure, name: str, folder: Path, caption: Any = None) -> None:
            self.figures[name] = figure
            picture_left_empty(figure, name, folder, caption)

        def displayed(made: Made, suffix: str = "") -> Any:
            shown = table(made, suffix)
            self.displayed[made.name, suffix] = getattr(shown, "data", shown)
            return shown

        def attempts(collection: Any, seed: int, env: None) -> Iterator[SimpleNamespace]:
            rows = visited(collection, self.turned).to_dict("records")
            seen = [(row.pop("phase"), SimpleNamespace(columns=row.copy)) for row in rows]
            while True:
                yield SimpleNamespace(succeeded=True, seen=seen)

        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(paths, "ROOT", self.folder)
            patch.setattr(paths, "BUILD", self.folder / "build")
            patch.setattr(paths, "RUNS", self.folder / "build" / "runs")
            patch.setattr(coverage, "attempts", attempts)
            patch.setattr(style, "save", saved)
            patch.setattr(Made, "table", displayed)
            patch.setattr(intervals, "jackknife", in_four_parts)
            patch.setattr(distance, "HOPS", 0)  # the fit has tests of its own
            patch.setattr(distance, "STARTS", 1)
            patch.setattr(gc, "collect", lambda *_: 0)  # statsmodels does after every adjustment, a second each time
            patch.setattr(Figure, "get_layout_engine", lambda figure: None)  # nobody looks at where the panels are
            patch.setenv("MOVE_STORED_ONLY", "1")
            with matplotlib.rc_context():
                _forget()
                yield
                _forget()


def in_four_parts(labels: np.ndarray, *statistic: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The jackknife, with four sets of labels left out in turn in place of each label: a tenth of the time."""
    return jackknife(np.unique(labels, return_inverse=True)[1] % 4, *statistic)


@functools.cache
def _at(spec: RunSpec, place: str) -> list[bool]:
    groups, where, _ = places(spec)
    return [not place or place in names for names in zip(groups, where, strict=True)]


def features(spec: RunSpec) -> dict[str, Any]:
    """What tells a run from the others, read from its spec and in the words of the tables."""
    found = {"task": spec.task, "method": spec.method, "observation": spec.observation, "kind": spec.kind,
             "seed": spec.seed, "group": spec.evaluation.starts, "factors": spec.evaluation.factors}
    if made := spec.collection:
        share = {"static": 0.0, "move": 1.0}.get(made.method, dict(made.shares).get("move"))
        found |= {"timesteps": made.timesteps, "protocol": made.protocol, "hand": hand(spec),
                  "placement": made.placement and (made.placement.rule, made.placement.places),
                  "demonstrations": made.demonstrations, "fixed": made.fixed, "object_steps": made.object_steps,
                  "keep_failures": made.keep_failures, "drawing": made.drawing, "expert": made.expert, "share": share,
                  "law": "static" if made.method == "static" else made.speed_law or "beta",
                  "moving": frozenset(
                      (made.moving or movable(get_task(spec.task), made.factors)) if made.method == "move" else ()),
                  "jumping": next(name for name, jumping in JUMPS.items() if jumping == made.jumping)}
    if isinstance(spec, PolicyRun):
        recipe = PROFILE.recipe(spec.observation, spec.collection.timesteps)
        found |= {"length": round(spec.training.gradient_steps / recipe.gradient_steps, 2)}
        found["cropped"] = spec.training.crop_pixels == 60
        chosen, usual = spec.training.model_dump(), recipe.model_dump()
        found["changed"] = tuple(sorted((name, value) for name, value in chosen.items() if value != usual[name]))
        if spec.method == "move":
            found |= {f"{part}_speed": round(speed, 6) for part, speed in speeds(spec).items()}
    return found


def _forget() -> None:
    """Empty what the package keeps between calls, for another world follows; the simulator's own stays."""
    for module in [module for name, module in sys.modules.items() if name.startswith(("move.claims",
                                                                                     "move.figures", "move.study"))]:
        for kept in list(vars(module).values()):
            if hasattr(kept, "cache_clear"):
                kept.cache_clear()
