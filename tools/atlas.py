"""The site's atlas: figure 1's maps, and static's and MOVE's episode from the place that a reader chooses.

The films are made from what `tools/record_atlas.py` recorded, as sheets of frames that `docs/atlas.js` shows one after
the other; they stay in build/site-atlas until something that they are made of changes.
"""

from __future__ import annotations

import hashlib
import html
import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.colors import to_hex
from PIL import Image
from record_atlas import EVALUATION, EVERY, METHODS, PLACES, SIDE, filmed_runs

from move import paths
from move.errors import BadInput
from move.figures.page import parameters
from move.figures.page.data import load_or_run
from move.figures.plots.film import Where, marked, rings, taken, where
from move.figures.plots.style import NAMES
from move.files import written_aside
from move.learn.agents import Recorded
from move.learn.evaluation import Start, starts
from move.learn.rollout import roll_out
from move.machine import gl_problem
from move.sim.grasp_points import sparse_points
from move.sim.observe import KEYPOINTS
from move.sim.scene.scene import Scene
from move.sim.tasks import get_task
from move.study import policies
from move.study.profiles import Profile
from move.study.provenance import deciding

MADE = paths.BUILD / "site-atlas"
SIZE, STRIDE, COLUMNS, QUALITY = 192, 3, 8, 60  # pixels of a frame, timesteps between two, frames a row, of WebP
ENDS = {True: "succeeds", False: "fails"}
TASK = get_task("pick-place")


def page(profile: Profile, static: Path) -> str:
    """The page in Markdown; its films and script are copied into the folder `static`.

    Raises:
        BadInput: images cannot be drawn on this machine, or what was recorded is not there.
    """
    made, filmed = films(profile), filmed_runs(profile)
    shutil.copytree(MADE, static / "atlas", ignore=shutil.ignore_patterns("*.json"), dirs_exist_ok=True)
    shutil.copy(paths.ROOT / "docs/atlas.js", static)
    counts = {method: sum(place["films"][method]["succeeds"] for place in made["places"].values())
              for method in METHODS}
    runs = "; ".join(f"{NAMES[method]}: `move verify {spec.hash}`" for method, spec in filmed.items())
    said = ", ".join(f"{NAMES[method]} succeeds from {count}" for method, count in counts.items())
    found = shares(profile)
    blocks = "".join(_map(method, found[method], made) for method in METHODS)
    screens = "".join(
        f'<figure><canvas width="{SIZE}" height="{SIZE}" role="img" data-method="{method}" '
        f'aria-label="Film of {NAMES[method]}’s episode"></canvas><figcaption data-method="{method}"></figcaption>'
        "</figure>" for method in METHODS)
    return (
        "# Atlas: an episode from every place\n\n"
        "Choose a place on one of figure 1's two maps, with the mouse or with the arrow keys: both policies start with "
        f"the object there. In the films: {rings(TASK.name)}.\n\n"
        f'```{{raw}} html\n<div id="atlas"><div class="maps">{blocks}</div><div class="screens">{screens}</div>'
        '<p class="controls"><button type="button" id="atlas-play">Play</button> <label>timestep <input type="range" '
        'id="atlas-step" min="0" max="1" value="0"></label></p><p id="atlas-said" role="status"></p>'
        "<noscript><p>The films need JavaScript; their frames lie in _static/atlas/.</p></noscript></div>\n"
        f'<script type="application/json" id="atlas-data">{json.dumps(made)}</script>\n'
        '<script src="_static/atlas.js"></script>\n```\n\n'
        "**What the colours are.** Those of [figure 1](figures/fig1_sparse.ipynb), seen from above: how many of its "
        "seeds' policies succeed with the object there, from none (dark blue) to all (yellow). x runs from left to "
        "right, y from below, where the robot is, upwards. Its demonstrations grasp at nine points, the rings.\n\n"
        "**What the films are.** Not figure 1's policies, which are not shipped, but those of "
        "[table 2](figures/table2_main.ipynb) on Pick-Place, seed 0, from pixels: trained on 20,000 timesteps with "
        f"object, target, hand and camera anywhere. Of these {len(PLACES)} places {said}. Object and hand are where "
        "figure 1's evaluation has them, camera and target where this package has them, because these policies have "
        "never seen the camera of figure 1; so a film may end otherwise than the colours say. A tick or a cross says "
        f"how the film of that place ends. A film shows every {STRIDE}rd timestep at half the speed of the robot; it "
        "is over after ten successful steps, or after 200. What the policies did was recorded once and is played again "
        f"here. The runs: {runs}.\n")


def films(profile: Profile) -> dict[str, Any]:
    """The sheets of all films, made or as they are in build/site-atlas, as `docs/atlas.js` takes them.

    Raises:
        BadInput: images cannot be drawn on this machine, or what was recorded is not there.
    """
    if problem := gl_problem():
        raise BadInput(f"atlas: {problem}")
    runs = filmed_runs(profile)
    recorded = {method: policies.recorded_episodes(runs[method], profile, policies.ATLAS) for method in METHODS}
    if lacking := [method for method in METHODS if set(recorded[method]) != set(PLACES)]:
        raise BadInput(f"atlas: no episodes of {', '.join(lacking)} are recorded; tools/record_atlas.py records them")
    listed = starts(TASK, EVALUATION)
    places = {}
    for number in PLACES:
        x, y, _ = listed[number].configuration.object_position
        places[str(number)] = {"x": round(100 * x), "y": round(100 * y), "films": {
            method: film(method, number, recorded[method][number], listed[number]) for method in METHODS}}
    return {"size": SIZE, "stride": STRIDE, "columns": COLUMNS, "side": SIDE // EVERY,
            "names": {method: NAMES[method] for method in METHODS}, "places": places}


def film(method: str, number: int, actions: np.ndarray, start: Start) -> dict[str, Any]:
    """Play one recorded episode, unless its film is there, and write the sheet of its frames; what the page needs."""
    settings = json.dumps([SIZE, STRIDE, COLUMNS, QUALITY, start.configuration.columns(), deciding()])
    digest = hashlib.sha256(settings.encode() + actions.tobytes()).hexdigest()
    sheet, about = MADE / f"{method}_{number}.webp", MADE / f"{method}_{number}.json"
    if about.exists() and sheet.exists() and (known := json.loads(about.read_text()))["made_of"] == digest:
        return known["film"]
    frames: list[np.ndarray] = []
    seen: list[Where] = []

    def look(_: int, scene: Scene) -> None:
        if scene.steps % STRIDE == 0:
            frames.append(scene.render_image(SIZE))
            seen.append(where(scene))

    (rollout,) = roll_out(Recorded(actions), TASK, [start.configuration], KEYPOINTS, callback=look)
    whole = np.zeros((-(-len(frames) // COLUMNS) * SIZE, COLUMNS * SIZE, 3), np.uint8)
    for place, frame in enumerate(marked(taken(frames, seen, {}))):
        top, left = SIZE * (place // COLUMNS), SIZE * (place % COLUMNS)
        whole[top:top + SIZE, left:left + SIZE] = frame
    with written_aside(sheet) as new:
        Image.fromarray(whole).save(new, format="WEBP", quality=QUALITY)
    made = {"file": sheet.name, "frames": len(frames), "steps": rollout.scene.steps, "succeeds": rollout.successes > 0}
    with written_aside(about) as new:
        new.write_text(json.dumps({"made_of": digest, "film": made}))
    return made


def shares(profile: Profile) -> dict[str, pd.Series]:
    """Method -> the share of figure 1's seeds that succeed, by the object's place (x, y in metres), as in its maps."""
    runs = [run for run in parameters.runs("fig1_sparse", profile) if run.labels["hand"] == "anywhere"]
    rows = load_or_run(runs, profile, MADE).episodes
    cells = rows[rows.group == "grid"].groupby(["method", "object_x", "object_y"]).success.mean()
    return {method: cells[method] for method in METHODS}


def _map(method: str, cells: pd.Series, made: dict[str, Any]) -> str:
    """One map: figure 1's cells and grasp points, and a button over every nine cells."""
    colours = mpl.colormaps["cividis"]
    xs, ys = (sorted(cells.index.unique(level)) for level in ("object_x", "object_y"))
    squares = "".join(
        f'<rect x="{xs.index(x)}" y="{len(ys) - 1 - ys.index(y)}" width="1.02" height="1.02" '
        f'fill="{to_hex(colours(float(share)))}"/>' for (x, y), share in cells.items())
    low, high = TASK.object_range.low, TASK.object_range.high
    rings = "".join(f'<circle cx="{SIDE * (x - low[0]) / (high[0] - low[0]):.2f}" '
                    f'cy="{SIDE * (high[1] - y) / (high[1] - low[1]):.2f}" r=".38"/>'
                    for x, y, _ in sparse_points(TASK))
    buttons = "".join(_button(number, made["places"][str(number)], method) for number in _from_above())
    name = html.escape(NAMES[method])
    return (f'<div class="map"><p>{name}</p><div class="field"><svg viewBox="0 0 {SIDE} {SIDE}" aria-hidden="true">'
            f'{squares}{rings}</svg><div class="places" role="group" aria-label="{name}: places of the object">'
            f"{buttons}</div></div></div>")


def _from_above() -> Iterator[int]:
    """The filmed places row by row as the map shows them: from the largest y to the smallest, x from left to right."""
    side = SIDE // EVERY
    return (PLACES[side * x + y] for y in reversed(range(side)) for x in range(side))


def _button(number: int, place: dict[str, Any], method: str) -> str:
    succeeds = place["films"][method]["succeeds"]
    return (f'<button type="button" data-place="{number}" data-method="{method}" aria-pressed="false" tabindex="-1" '
            f'aria-label="x {place["x"]} cm, y {place["y"]} cm: {NAMES[method]} {ENDS[succeeds]}">'
            f'<span aria-hidden="true">{"✓" if succeeds else "✗"}</span></button>')
