"""The command line: move collect | export | train | evaluate | run | plan | verify | figure | doctor.

Bad input ends with one line on standard error and exit code 2; a run that failed ends with exit code 1.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Optional

import typer
from rich.console import Console
from rich.table import Table
from typer._click.exceptions import ClickException  # typer's own copy of click, whose usage errors these are

from move.errors import BadInput

if TYPE_CHECKING:
    from move.study.profiles import Profile
    from move.study.spec import RunSpec

app = typer.Typer(add_completion=False, no_args_is_help=True, rich_markup_mode=None, pretty_exceptions_enable=False,
                  help="MOVE, reproduced: collect demonstrations, train policies, evaluate them, rebuild the paper.")

INTERRUPTED = 130  # exit code after Ctrl-C
Json = Annotated[bool, typer.Option("--json", help="print JSON for machines instead of a table for people")]
Seed = Annotated[int, typer.Option(min=0, help="decides every random number")]
ClipActions = Annotated[bool, typer.Option("--clip-actions", help="clip actions to -1..1 as Meta-World does")]
ProfileName = Annotated[str, typer.Option(help="a settings file under profiles/")]
Figure = Annotated[Optional[list[str]], typer.Option("--figure", help="a figure; may be repeated (default: all)")]


def show(content: dict[str, Any] | list[dict[str, Any]], as_json: bool, title: str) -> None:
    """Print a record, or a list of records with the same keys, as JSON or as a table."""
    if as_json:
        return typer.echo(json.dumps(content, default=str))
    table = Table(title=title, title_justify="left")
    if isinstance(content, dict):
        content = [{"what": key, "value": value} for key, value in content.items()]
    for name in content[0] if content else ["nothing"]:
        table.add_column(str(name))
    for record in content:
        table.add_row(*(f"{value:.4g}" if isinstance(value, float) else str(value) for value in record.values()))
    Console(width=None if sys.stdout.isatty() else 140).print(table)


@contextmanager
def progress(label: str) -> Iterator[Callable[..., None]]:
    """A callable (done, total, ...) that draws a bar with the time left on standard error."""
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True, disable=not sys.stderr.isatty()) as bars:
        bar = bars.add_task(label, total=None)
        yield lambda done, total, *rest: bars.update(bar, completed=done, total=total)


@app.command()
def collect(
    out: Annotated[Optional[Path], typer.Option(help="zarr folder to write (default: under build/data)")] = None,
    task: Annotated[str, typer.Option(help="the task")] = "pick-place",
    method: Annotated[str, typer.Option(help="static, adc, move or mixture")] = "move",
    timesteps: Annotated[int, typer.Option(help="budget in steps of the environment")] = 2500,
    observation: Annotated[str, typer.Option(help="keypoints or rgb")] = "keypoints",
    image_size: Annotated[int, typer.Option(help="pixels along a side")] = 96,
    factors: Annotated[str, typer.Option(help="what is random: object, object+target or all")] = "all",
    protocol: Annotated[str, typer.Option(help="where it grasps: random, sparse, dense or circle")] = "random",
    expert: Annotated[str, typer.Option(help="phase or metaworld")] = "phase",
    object_speed: Annotated[Optional[float], typer.Option(help="the largest under MOVE, metres per step")] = None,
    target_speed: Annotated[Optional[float], typer.Option(help="the largest under MOVE, metres per step")] = None,
    camera_speed: Annotated[Optional[float], typer.Option(help="the largest under MOVE, radians per step")] = None,
    moving: Annotated[Optional[str], typer.Option(help="what moves, such as object,target (default: all)")] = None,
    shares: Annotated[Optional[str], typer.Option(help="of a mixture, such as static=0.5,move=0.5")] = None,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Collect demonstrations under an exact budget of timesteps."""
    from move import paths
    from move.learn import dataset
    from move.sim import collect as collecting
    from move.validation import build

    chosen = build(collecting.Collection, task=task, method=method, timesteps=timesteps, observation=observation,
                   image_size=image_size, factors=factors, protocol=protocol, expert=expert,
                   object_speed=object_speed, target_speed=target_speed, camera_speed=camera_speed,
                   moving=moving.split(",") if moving is not None else None, shares=_shares(shares))
    path = out or paths.BUILD / "data" / f"{task}-{method}-{protocol}-{observation}-{timesteps}-{seed}.zarr"
    with progress("collect") as report:
        demonstrations, record = collecting.collect(chosen, seed, report)
    attributes = collecting.record_attributes(chosen, seed, record)
    dataset.save(demonstrations, path, attributes)
    content = {"path": str(path), "task": task, "method": method, **attributes["record"]}
    content["steps_per_second"] = record.attempts * record.mean_steps / record.seconds
    if not as_json:
        content = {name: value for name, value in content.items() if name not in ("grasp_points", "starts", "grasps")}
    show(content, as_json, "Demonstrations")


def _shares(text: str | None) -> dict[str, float]:
    """`static=0.5,move=0.5` as a mapping."""
    try:
        return {name: float(share) for name, share in (part.split("=") for part in text.split(","))} if text else {}
    except ValueError as error:
        raise BadInput(f"shares: {text!r} given; allowed are methods with numbers, such as static=0.5,move=0.5"
                       ) from error


@app.command()
def export(
    data: Annotated[Path, typer.Argument(help="zarr folder that `move collect` wrote")],
    out: Annotated[Path, typer.Argument(help="new folder to write")],
    form: Annotated[str, typer.Option("--format", help="lerobot (v3.0) or zarr (diffusion_policy)")] = "lerobot",
    clip_actions: ClipActions = False,
    whole_episodes: Annotated[bool, typer.Option("--whole-episodes", help="without the one cut by the budget")] = False,
    as_json: Json = False,
) -> None:
    """Write collected demonstrations as another program's data set."""
    from move.study.export import export as write

    show(write(data, out, form, clip_actions, whole_episodes), as_json, "Exported")


@app.command()
def train(
    data: Annotated[Path, typer.Argument(help="zarr folder: of `move collect`, or another replay buffer with images")],
    out: Annotated[Path, typer.Argument(help="folder for the checkpoint; training goes on from what it holds")],
    profile: ProfileName = "laptop",
    gradient_steps: Annotated[Optional[int], typer.Option(help="instead of the profile's")] = None,
    clip_actions: ClipActions = False,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Train a diffusion policy on collected demonstrations."""
    from move.learn import dataset
    from move.learn import train as training
    from move.learn.settings import Training
    from move.study.profiles import load_profile
    from move.validation import build

    demonstrations, attributes = dataset.load(data, clip_actions)
    observation = "rgb" if demonstrations.has_images else "keypoints"
    recipe = load_profile(profile).recipe(observation, demonstrations.timesteps).model_dump()
    if gradient_steps is not None:
        recipe |= {"gradient_steps": gradient_steps, "warmup_steps": min(recipe["warmup_steps"], gradient_steps // 2)}
    with progress("train") as report:
        _, trained = training.train(demonstrations, build(Training, **recipe), seed, checkpoint=out, on_step=report,
                                    task=dataset.task_of(attributes))
    show({"checkpoint": str(out), "gradient_steps": recipe["gradient_steps"], "loss": trained.curve[-1][1],
          "seconds": trained.seconds, "precision": trained.precision, "parameters": trained.parameters}, as_json,
         "Policy")


@app.command()
def evaluate(
    checkpoint: Annotated[Optional[Path], typer.Argument(help="folder that `move train` wrote")] = None,
    agent: Annotated[str, typer.Option(help="policy, nothing, random, expert or goal-blind")] = "policy",
    task: Annotated[str, typer.Option(help="the task")] = "pick-place",
    starts: Annotated[str, typer.Option(help="random, moving or grid")] = "random",
    episodes: Annotated[int, typer.Option(help="number of random configurations")] = 100,
    factors: Annotated[str, typer.Option(help="what is random: object, object+target or all")] = "all",
    lerobot: Annotated[Optional[Path], typer.Option(help="instead: a policy that lerobot-train wrote")] = None,
    lerobot_python: Annotated[Optional[Path], typer.Option(help="a Python that has LeRobot (default: under build/)"
                                                           )] = None,
    seed: Seed = 0,
    as_json: Json = False,
) -> None:
    """Evaluate a policy, or a control, on the fixed configurations of a task."""
    import numpy as np

    from move.intervals import wilson_interval
    from move.learn import agents
    from move.learn import evaluate as evaluating
    from move.learn.checkpoint import load_policy
    from move.sim.observe import KEYPOINTS
    from move.sim.tasks import FACTORS, get_task
    from move.validation import build

    if factors not in FACTORS:
        raise BadInput(f"factors: {factors!r} given; allowed are {', '.join(FACTORS)}")
    plan = build(evaluating.Evaluation, starts=starts, episodes=episodes, factors=factors)
    if agent not in ("policy", *agents.CONTROLS):
        raise BadInput(f"agent: {agent!r} given; allowed are policy, {', '.join(agents.CONTROLS)}")
    if lerobot is not None and (checkpoint is not None or agent != "policy"):
        raise BadInput(f"lerobot: {lerobot} given beside another agent; allowed is one of them")
    if agent == "policy" and checkpoint is None and lerobot is None:
        raise BadInput("checkpoint: none given; a policy needs the folder that `move train` wrote")
    with ExitStack() as stack:
        who: agents.Agent
        seen = KEYPOINTS
        if lerobot is not None:
            from move.study.lerobot_policy import PYTHON, LeRobotAgent

            served = stack.enter_context(LeRobotAgent(lerobot, lerobot_python or PYTHON, seed))
            who, seen, agent = served, served.observation, "lerobot"
        elif checkpoint and agent == "policy":
            policy = load_policy(checkpoint, task=task)
            who, seen = agents.PolicyAgent(policy, seed), policy.observation
        else:
            who = agents.CONTROLS[agent](seed)
        report = stack.enter_context(progress("evaluate"))
        rows = evaluating.evaluate(who, get_task(task), plan, seen, report)
    rate = float(np.mean([row["success"] for row in rows]))
    low, high = wilson_interval(rate, len(rows))
    content = {"agent": agent, "task": task, "episodes": len(rows), "success_rate": rate, "low": low,
               "high": high, "mean_steps": float(np.mean([row["steps"] for row in rows]))}
    show(content | ({"rows": rows} if as_json else {}), as_json, "Evaluation (95 % Wilson interval)")


def chosen_specs(profile: Profile, figures: list[str] | None) -> dict[str, list[RunSpec]]:
    """The specs of the figures asked for, or of all, by figure."""
    from move.study import experiments

    return {figure: experiments.specs(figure, profile) for figure in figures or experiments.EXPERIMENTS}


@app.command()
def run(
    profile: ProfileName = "laptop",
    figure: Figure = None,
    workers: Annotated[Optional[int], typer.Option(min=1, help="processes (default: one a core, or one a GPU)")] = None,
    cluster: Annotated[Optional[str], typer.Option(help="address of a Dask scheduler, tcp://host:8786")] = None,
    results: Annotated[Optional[Path], typer.Option(help="results folder (default: the profile's)")] = None,
    as_json: Json = False,
) -> None:
    """Compute the runs that are missing; what exists is reused, what was interrupted goes on."""
    from move import paths
    from move.study.execute import execute
    from move.study.profiles import load_profile

    chosen = load_profile(profile)
    specs = [spec for listed in chosen_specs(chosen, figure).values() for spec in listed]
    there, missing = execute(specs, results or paths.results(chosen), cluster, workers, quiet=not sys.stderr.isatty())
    problems = [{"hash": spec.hash, "run": spec.label, "why": why} for spec, why in missing]
    if as_json:
        show({"profile": profile, "stored": len(there), "missing": problems}, True, "")
    else:
        show({"profile": profile, "stored": len(there), "missing": len(problems)}, False, "Runs")
        if problems:
            show(problems, False, "Missing")
    if problems:
        raise typer.Exit(1)


@app.command()
def plan(profile: ProfileName = "laptop", figure: Figure = None, as_json: Json = False) -> None:
    """Show what would run, how long it would take and why, without running anything."""
    from move.study.plan import plan_rows, plan_title
    from move.study.profiles import load_profile

    chosen = load_profile(profile)
    rows = plan_rows(chosen, chosen_specs(chosen, figure))
    show(rows, as_json, plan_title(chosen))


@app.command()
def verify(
    profile: ProfileName = "laptop",
    figure: Figure = None,
    sample: Annotated[int, typer.Option(min=1, help="how many results to recompute")] = 2,
    seed: Annotated[Optional[int], typer.Option(min=0, help="draws the sample; fresh each time if left out")] = None,
    every: Annotated[bool, typer.Option("--all", help="check every stored file, recompute nothing")] = False,
    as_json: Json = False,
) -> None:
    """Recompute a drawn sample of the stored results and compare; any difference ends with exit code 1."""
    import numpy as np

    from move import paths
    from move.study import verify as verifying
    from move.study.profiles import load_profile

    chosen = load_profile(profile)
    if every:
        rows = verifying.check_files(paths.results(chosen))
        shown = [row for row in rows if not row["same"]] or [{"files": len(rows), "same": "all"}]
        show(rows if as_json else shown, as_json, "Checked")
    else:
        seed = int(np.random.SeedSequence().generate_state(1)[0]) if seed is None else seed
        typer.echo(f"verify: --seed {seed} draws this sample again", err=True)
        specs = [spec for listed in chosen_specs(chosen, figure).values() for spec in listed]
        rows = verifying.verify(specs, paths.results(chosen), sample, np.random.default_rng(seed))
        show(rows, as_json, "Recomputed")
    if not all(row["same"] for row in rows):
        raise typer.Exit(1)


@app.command()
def figure(
    names: Annotated[Optional[list[str]], typer.Argument(help="names (default: all of the profile)")] = None,
    profile: ProfileName = "laptop",
    parameter: Annotated[Optional[list[str]], typer.Option("-p", help="name=value, over the profile's own")] = None,
    stored_only: Annotated[bool, typer.Option("--stored-only", help="run nothing; show what is missing")] = False,
    as_json: Json = False,
) -> None:
    """Execute notebooks, which run what is missing and write their figures and tables."""
    from move.report import notebooks
    from move.report.changes import change
    from move.study.profiles import load_profile

    chosen, changes = load_profile(profile), dict(_assignment(text) for text in parameter or [])
    names = names or notebooks.of_profile(chosen)
    for name in names:  # all of them are checked before the first one runs
        notebooks.notebook_parameters(name, chosen, changes)
    rows = []
    for name in names:
        typer.echo(f"notebook {name} ({profile}) ...", err=True)
        try:
            executed = notebooks.run_notebook(name, chosen, changes, stored_only)
        except notebooks.NotebookFailed as failure:
            typer.echo(f"move: {failure}", err=True)
            raise typer.Exit(1) from failure
        written = change(name, chosen, changes).folder
        rows.append({"notebook": name, "executed": str(executed), "written_to": str(written)})
    show(rows, as_json, "Notebooks")


def _assignment(text: str) -> tuple[str, Any]:
    """`name=value` with the value read as YAML reads it."""
    import yaml

    from move.study.profiles import refuse_text_numbers

    name, equals, value = text.partition("=")
    if not equals:
        raise BadInput(f"-p {text!r}: allowed is name=value")
    content = yaml.safe_load(value)
    refuse_text_numbers(content, f"-p {name}")
    return name, content


@app.command()
def doctor(as_json: Json = False) -> None:
    """Say what is missing on this machine, and the one line that mends it."""
    from move.study.doctor import examine

    checks = examine()
    show(checks, as_json, "This machine")
    if any(check["outcome"] == "broken" for check in checks):
        raise typer.Exit(1)


def main() -> None:
    """Run the command line; turn every kind of bad input into one line and exit code 2."""
    try:
        code = app(standalone_mode=False)
    except BadInput as problem:
        code = _refuse(str(problem))
    except ClickException as problem:
        code = _refuse(" ".join(problem.format_message().split()))
    except (typer.Abort, KeyboardInterrupt):
        code = INTERRUPTED
    if code == INTERRUPTED:  # which is also what typer makes of Ctrl-C
        typer.echo("move: interrupted; the same command goes on from here", err=True)
    sys.exit(code if isinstance(code, int) else 0)


def _refuse(line: str) -> int:
    typer.echo(f"move: {line}", err=True)
    return 2


if __name__ == "__main__":
    main()
