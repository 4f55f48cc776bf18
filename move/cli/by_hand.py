"""By hand: collect, placements, export, train, evaluate, compare."""

from __future__ import annotations

import math
import re
import time
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, Optional

import typer

from move.choices import Control, ExpertName, ExportFormat, Factors, PlacementRule, Protocol, SpeedLaw
from move.cli.options import ClipActions, Json, MethodName, ProfileName, Seed, TaskName, app, examples
from move.cli.output import progress, show, show_paths
from move.errors import BadInput
from move.files import refuse_existing, refuse_unwritable
from move.sim.configuration import Box
from move.sim.observe import IMAGE_SIZE, ObservationKind, ObservationSpec

if TYPE_CHECKING:
    from move.learn.agents import Agent

Speed = Annotated[Optional[float], typer.Option(help="the largest, metres per step")]
Turn = Annotated[Optional[float], typer.Option(help="the largest, radians per step")]
OF_A_CHECKPOINT = re.compile(r"run\.json|tensors-\d+\.safetensors|\.?[\w.-]+\.(part|old|lock)|lock")


@app.command(epilog=examples(
    "move collect --task push --method adc --timesteps 5000",
    "move collect --observation rgb --image-size 64 --out push.zarr --overwrite",
    "move collect --object-speed 0.06 --moving object,target",
    "move collect --protocol placed --placement jittered --places 50 --demonstrations 50 --timesteps 10000",
    "move collect --method mixture --shares static=0.5,move=0.5"))
def collect(
    out: Annotated[Optional[Path], typer.Option(help="zarr folder to write (default: under build/data)")] = None,
    task: Annotated[TaskName, typer.Option(help="the task")] = "pick-place",
    method: Annotated[MethodName, typer.Option(help="how it is collected")] = "move",
    timesteps: Annotated[int, typer.Option(help="budget in steps of the environment")] = 2500,
    observation: Annotated[ObservationKind, typer.Option(help="what is kept of each timestep")] = "keypoints",
    image_size: Annotated[Optional[int], typer.Option(help=f"of rgb, pixels along a side ({IMAGE_SIZE})")] = None,
    factors: Annotated[Optional[Factors], typer.Option(
        help="what is random (all; the object under a protocol)")] = None,
    protocol: Annotated[Protocol, typer.Option(help="where it grasps")] = "random",
    placement: Annotated[PlacementRule, typer.Option(help="how protocol placed chooses its places")] = "jittered",
    places: Annotated[Optional[int], typer.Option(help="how many places protocol placed has")] = None,
    demonstrations: Annotated[Optional[int], typer.Option(help="after how many it ends, if the budget allows")] = None,
    expert: Annotated[ExpertName, typer.Option(help="who demonstrates")] = "phase",
    object_speed: Speed = None,
    target_speed: Speed = None,
    camera_speed: Turn = None,
    yaw_speed: Turn = None,
    speed_law: Annotated[Optional[SpeedLaw], typer.Option(help="how speeds below the largest are drawn (beta)")] = None,
    moving: Annotated[Optional[str], typer.Option(help="what moves, such as object,target (default: all)")] = None,
    shares: Annotated[Optional[str], typer.Option(help="of a mixture, such as static=0.5,move=0.5")] = None,
    seed: Seed = 0,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace the data set that is there")] = False,
    as_json: Json = False,
) -> None:
    """Collect demonstrations under an exact budget of timesteps."""
    from move import paths
    from move.learn import dataset
    from move.sim import collect as collecting
    from move.validation import build

    if image_size is not None and observation != "rgb":
        raise BadInput(f"image_size: {image_size} given with keypoints; allowed with --observation rgb")
    if protocol != "random" and factors not in (None, "object"):
        raise BadInput(f"factors: {factors!r} given with protocol {protocol!r}, which prescribes where all begins but "
                       "the object; allowed is object")
    if (places is None) == (protocol == "placed"):
        given = "none" if places is None else places
        raise BadInput(f"places: {given} given with protocol {protocol!r}; allowed are 1 or more with 'placed', and "
                       "with it alone")
    placed = {"rule": placement, "places": places} if places is not None else None
    chosen = build(collecting.Collection, task=task, method=method, timesteps=timesteps, observation=observation,
                   image_size=IMAGE_SIZE if image_size is None else image_size,
                   factors=factors or ("all" if protocol == "random" else "object"), protocol=protocol, expert=expert,
                   placement=placed, demonstrations=demonstrations,
                   object_speed=object_speed, target_speed=target_speed, camera_speed=camera_speed,
                   yaw_speed=yaw_speed, speed_law=speed_law, shares=_shares(shares),
                   moving=moving.split(",") if moving is not None else None)
    path = out or paths.BUILD / "data" / f"{task}-{method}-{protocol}-{observation}-{timesteps}-{seed}.zarr"
    dataset.check_place(path, overwrite)
    with progress("collect") as report:
        made, record = collecting.collect(chosen, seed, report)
    attributes = collecting.record_attributes(chosen, seed, record)
    dataset.save(made, path, attributes, overwrite)
    content = {"path": str(path.absolute()), "task": task, "method": method, **attributes["record"]}
    content["wall_seconds"] = content.pop("seconds")
    content["steps_per_second"] = record.attempts * record.mean_steps / record.seconds
    if not as_json:
        per_demonstration = ("grasp_points", "starts", "grasps", "jumps")
        content = {name: value for name, value in content.items() if name not in per_demonstration}
    show(content, as_json, "Demonstrations")


def _shares(text: str | None) -> dict[str, float]:
    """`static=0.5,move=0.5` as a mapping."""
    try:
        parts = [part.split("=") for part in text.split(",")] if text else []
        shares = {name: float(share) for name, share in parts}
        if len(shares) < len(parts) or "_" in "".join(share for _, share in parts):
            raise ValueError
        return shares
    except ValueError as error:
        raise BadInput(f"shares: {text!r} given; allowed are methods, each once, with numbers, such as "
                       "static=0.5,move=0.5") from error


@app.command(epilog=examples("move placements --places 50", "move placements --within 0,0,40,30 --places 10",
                             "move placements --places 50 --speed 3 --out sheet.csv"))
def placements(
    places: Annotated[int, typer.Option(min=1, max=10_000, help="how many places there are")] = 50,
    rule: Annotated[PlacementRule, typer.Option(help="how they are chosen")] = "jittered",
    within: Annotated[str, typer.Option(help="corners of the table's part: x,y,x,y in cm")] = "0,0,30,30",
    demonstrations: Annotated[Optional[int], typer.Option(
        min=1, max=10_000, help="rows; places are taken again in order (default: each place once)")] = None,
    speed: Annotated[float, typer.Option(min=0, max=100, help="of MOVE, the largest, cm per second; 0: static")] = 0.0,
    seconds: Annotated[Optional[float], typer.Option(
        min=0.1, max=60, help="how long MOVE's object moves to its place (default: 3)")] = None,
    seed: Seed = 0,
    out: Annotated[Optional[Path], typer.Option(help="CSV file to write instead")] = None,
    as_json: Json = False,
) -> None:
    """A sheet for a real table: where to put the object for each demonstration, in order; for MOVE, how it moves.

    MOVE's object starts at its start, moves at its speed in its direction (from x towards y) for so many seconds, turns
    back where it meets a side of the table's part, and is then at x, y.
    """
    from move.files import written_aside
    from move.sim.placement import Placement, sheet

    if seconds is not None and not speed:
        raise BadInput(f"seconds: {seconds:g} given, and nothing moves; allowed with --speed")
    if out is not None:
        refuse_existing(out)
    rows = sheet(Placement(rule=rule, places=places), rectangle(within), seed, demonstrations or places, speed,
                 seconds or 3.0)
    units = {"x": "x (cm)", "y": "y (cm)", "start_x": "start x (cm)", "start_y": "start y (cm)",
             "direction": "direction (deg from x to y)", "speed": "speed (cm/s)", "seconds": "for (s)"}
    shown = [{units.get(name, name): value for name, value in row.items()} for row in rows]
    if out is None:
        return show(rows if as_json else shown, as_json,
                    f"Placements: {rule}, {places} places within {within} cm, seed {seed}")
    import pandas as pd

    with written_aside(out) as beside:
        pd.DataFrame(shown).to_csv(beside, index=False, lineterminator="\r\n")
    show_paths([out.absolute()])


def rectangle(text: str) -> Box:
    """`x,y,x,y` as a flat box, in the same unit."""
    try:
        x, y, far_x, far_y = (float(part) for part in text.split(","))
        if "_" in text or not (math.isfinite(x + y + far_x + far_y) and x < far_x and y < far_y):
            raise ValueError
    except ValueError:
        raise BadInput(f"within: {text!r} given; allowed are the low and the high corner in cm, such as 0,0,40,30"
                       ) from None
    return Box((x, y, 0.0), (far_x, far_y, 0.0))


@app.command(epilog=examples("move export build/data/NAME.zarr build/lerobot/NAME",
                             "move export build/data/NAME.zarr copy.zarr --format zarr"))
def export(
    data: Annotated[Path, typer.Argument(help="zarr folder that `move collect` wrote")],
    out: Annotated[Path, typer.Argument(help="new folder to write")],
    form: Annotated[ExportFormat, typer.Option("--format", help="LeRobot's v3.0, or diffusion_policy's zarr")
                    ] = "lerobot",
    clip_actions: ClipActions = False,
    whole_episodes: Annotated[bool, typer.Option("--whole-episodes", help="without the one cut by the budget")] = False,
    as_json: Json = False,
) -> None:
    """Write collected demonstrations as another program's data set."""
    from move.exchange.export import export as write

    show(write(data, out, form, clip_actions, whole_episodes), as_json, "Exported")


@app.command(epilog=examples("move train build/data/NAME.zarr build/policy",
                             "move train build/data/NAME.zarr build/policy --gradient-steps 600 --seed 1"))
def train(
    data: Annotated[Path, typer.Argument(help="zarr folder: of `move collect`, or another replay buffer with images")],
    out: Annotated[Path, typer.Argument(help="folder for the checkpoint; training goes on from what it holds")],
    profile: ProfileName = "laptop",
    gradient_steps: Annotated[Optional[int], typer.Option(help="instead of the profile's")] = None,
    clip_actions: ClipActions = False,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Train a diffusion policy on collected demonstrations, on one thread."""
    from move.study.profiles import load_profile

    chosen = load_profile(profile)
    _refuse_other_content(out)
    from move.learn import dataset
    from move.learn import train as training
    from move.learn.settings import Training
    from move.validation import build

    demonstrations, attributes = dataset.load(data, clip_actions)
    low, high = float(demonstrations.actions.min()), float(demonstrations.actions.max())
    if low < -1 or high > 1:
        typer.echo(f"move: actions from {low:.4g} to {high:.4g} are learnt within these limits; --clip-actions clips "
                   "them to -1..1, as Meta-World does", err=True)
    observation = "rgb" if demonstrations.has_images else "keypoints"
    recipe = chosen.recipe(observation, demonstrations.timesteps).model_dump()
    if gradient_steps is not None:
        recipe |= {"gradient_steps": gradient_steps,
                   "warmup_steps": max(0, min(recipe["warmup_steps"], gradient_steps // 2))}
    began = time.process_time()
    with progress("train") as report:
        _, trained = training.train(demonstrations, build(Training, **recipe), seed, checkpoint=out, on_step=report,
                                    task=dataset.task_of(attributes))
    show({"checkpoint": str(out.absolute()), "gradient_steps": recipe["gradient_steps"], "loss": trained.curve[-1][1],
          "wall_seconds": trained.seconds, "cpu_seconds_now": time.process_time() - began,
          "precision": trained.precision, "parameters": trained.parameters}, as_json, "Policy")


def _refuse_other_content(folder: Path) -> None:
    """Refuse a folder for a checkpoint that cannot be written, or holds what is not of one."""
    refuse_unwritable(folder / "run.json")
    other = sorted(path.name for path in folder.iterdir()) if folder.is_dir() else []
    if strange := [name for name in other if not OF_A_CHECKPOINT.fullmatch(name)]:
        raise BadInput(f"{folder} holds {', '.join(strange[:3])}, not of a checkpoint; allowed is a new or empty "
                       "folder, or one that `move train` wrote")


@app.command(epilog=examples("move evaluate build/policy --task push",
                             "move evaluate build/policy --starts grid",
                             "move evaluate --run 179c29dcf0c06657 --starts listed",
                             "move evaluate --agent expert --episodes 20"))
def evaluate(
    checkpoint: Annotated[Optional[Path], typer.Argument(help="folder that `move train` wrote")] = None,
    agent: Annotated[Literal["policy", Control], typer.Option(help="who acts")] = "policy",
    run: Annotated[Optional[str], typer.Option(help="instead: the policy of a stored run, by its hash")] = None,
    task: Annotated[Optional[TaskName], typer.Option(help="the task (the policy's, else pick-place)")] = None,
    starts: Annotated[Literal["random", "moving", "grid", "listed"], typer.Option(
        help="where its episodes begin; listed: the authors' 20 configurations")] = "random",
    episodes: Annotated[Optional[int], typer.Option(help="how many, of random or moving starts (100)")] = None,
    factors: Annotated[Optional[Factors], typer.Option(help="what is random, unless starts are a grid (all)")] = None,
    seed: Seed = 0,
    profile: ProfileName = "laptop",
    as_json: Json = False,
) -> None:
    """Evaluate a policy, or a control, on the fixed configurations of a task."""
    if sum((checkpoint is not None, run is not None, agent != "policy")) > 1:
        raise BadInput("agent: more than one given; allowed is one of CHECKPOINT, --agent and --run")
    if agent == "policy" and checkpoint is None and run is None:
        raise BadInput("checkpoint: none given; a policy needs the folder that `move train` wrote")
    given = {name: value for name, value in (("episodes", episodes), ("factors", factors)) if value is not None}
    if starts in ("grid", "listed") and given:
        raise BadInput(f"{', '.join(given)}: given with starts {starts!r}, which fixes them; allowed with random or "
                       "moving")
    import numpy as np

    from move.learn.evaluate import evaluate as tried
    from move.learn.evaluation import Evaluation
    from move.machine import one_thread
    from move.sim.tasks import get_task
    from move.statistics.intervals import wilson_interval
    from move.study.provenance import provenance
    from move.validation import build

    plan = build(Evaluation, starts=starts, **given)
    one_thread()
    who, task, seen = _who_acts(checkpoint, agent, run, task, seed, profile)
    with progress("evaluate") as report:
        rows = tried(who, get_task(task), plan, seen, report)
    rate = float(np.mean([row["success"] for row in rows]))
    low, high = wilson_interval(rate, len(rows))
    content = {"agent": run or agent, "task": task, "episodes": len(rows), "success_rate": rate, "low": low,
               "high": high, "mean_steps": float(np.mean([row["steps"] for row in rows]))}
    if as_json:
        content |= {"rows": rows, "provenance": provenance(draws=seen.kind == "rgb")}
    show(content, as_json, "Evaluation (95 % Wilson interval)")


def _who_acts(
    checkpoint: Path | None, agent: str, run: str | None, task: str | None, seed: int, profile: str
) -> tuple[Agent, str, ObservationSpec]:
    """Who acts, on which task, and what it sees: a stored run's policy, one of a folder, or a control.

    Raises:
        BadInput: no such policy or profile; a task that is not the policy's, or none where it names none.
    """
    from move.learn.agents import CONTROLS, PolicyAgent
    from move.learn.checkpoint import learnt_task, load_policy
    from move.sim.observe import KEYPOINTS
    from move.study import policies
    from move.study.profiles import load_profile

    chosen = load_profile(profile)
    if run is not None:
        spec, policy = policies.of_run(run, chosen)
        if task not in (None, spec.task):
            raise BadInput(f"task: {task!r} given for a policy of {spec.task}; allowed is that task")
        return PolicyAgent(policy, spec.seed), spec.task, spec.collection.observed
    if checkpoint is None:
        return CONTROLS[agent](seed), task or "pick-place", KEYPOINTS
    task = task or learnt_task(checkpoint)
    if not task:
        raise BadInput(f"{checkpoint}: learnt from data that name no task; --task says where it is tried")
    policy = load_policy(checkpoint, task=task)
    return PolicyAgent(policy, seed), task, policy.observation


@app.command(epilog=examples("move evaluate build/policy --json > A.json", "move compare A.json B.json",
                             "move compare 03087b0257085c0d 0378a71339f78e21"))
def compare(
    first: Annotated[str, typer.Argument(help="what `move evaluate --json` printed, or the hash of a stored run")],
    second: Annotated[str, typer.Argument(help="another one, at the same configurations")],
    profile: ProfileName = "laptop",
    as_json: Json = False,
) -> None:
    """Compare two evaluations at the same configurations: the paired difference, its 95 % interval and test."""
    from move.study import compare as comparing
    from move.study.profiles import load_profile

    chosen = load_profile(profile)
    folders = [chosen.results, chosen.own_results]
    found = comparing.compare(*(comparing.read_evaluation(given, folders) for given in (first, second)))
    show(asdict(found), True, "") if as_json else typer.echo(str(found))
