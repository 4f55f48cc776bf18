"""The study: run, plan, verify, figure, doctor."""

from __future__ import annotations

import re
import sys
from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Optional

import typer

from move import figures as listed
from move import paths, yaml_text
from move.choices import HASH
from move.cli.options import LARGEST_SEED, Figures, Json, Parameters, ProfileName, app, examples
from move.cli.output import progress, show, show_paths
from move.errors import BadInput
from move.files import refuse_unwritable

if TYPE_CHECKING:
    from move.study.profiles import Profile
    from move.study.spec import RunSpec

SAMPLE = 2  # results that `verify` recomputes
SCHEDULER = re.compile(r"(tcp|tls|ucx|wss?)://[^/\s:]+:\d+")


def chosen_specs(
    profile: Profile, figures: list[str] | None, changes: dict[str, Any] | None = None
) -> dict[str, list[RunSpec]]:
    """The specs of the figures asked for, or of all, by figure, with `changes` of their parameters.

    Raises:
        BadInput: a figure that needs no runs, or a parameter that it does not have.
    """
    from move.figures.page.parameters import specs, with_runs

    if changes and not figures:
        raise BadInput(f"-p {next(iter(changes))}: given for all figures; allowed with the figures that it is for")
    if without := [name for name in figures or [] if name not in with_runs()]:
        raise BadInput(f"figure: {without[0]!r} given, which needs no runs; allowed are {', '.join(with_runs())}")
    return {figure: specs(figure, profile, changes) for figure in figures or with_runs()}


def _asked(profile: str, figures: list[str] | None) -> tuple[Profile, list[str]]:
    """The profile and the whole names of the figures; quick, so that a bad name is refused at once."""
    from move.study.profiles import load_profile

    paths.refuse_outside_checkout()
    return load_profile(profile), list(dict.fromkeys(listed.named(name) for name in figures or []))


def read_parameters(given: list[str], texts: Collection[str] = ()) -> dict[str, Any]:
    """The parameters that `-p` gives as `name=value`, each value read as YAML reads it.

    Args:
        texts: the names of those that are texts, whose values are taken as they stand.

    Raises:
        BadInput: no such assignment, or a name given twice; the profile, which has an option of its own; a text with
            characters that cannot be printed.

    >>> read_parameters(["seeds=2", "timesteps=[100, 200]", "data=2024-10-01 #2"], ["data"])
    {'seeds': 2, 'timesteps': [100, 200], 'data': '2024-10-01 #2'}
    """
    read: dict[str, Any] = {}
    for text in given:
        name, equals, value = text.partition("=")
        if not equals or not name.isidentifier():
            raise BadInput(f"-p {text[:60]!r}: allowed is name=value")
        if name == "profile":
            raise BadInput(f"-p profile: allowed is --profile {value[:60]}")
        if name in read:
            raise BadInput(f"-p {name}: given twice; allowed is once")
        if name in texts and not value.isprintable():
            raise BadInput(f"-p {name}: {value[:60]!r} given; allowed are characters that can be printed")
        read[name] = value if name in texts else yaml_text.read(value, f"-p {name}")
    return read


def _changes(given: list[str] | None, names: list[str]) -> dict[str, Any]:
    """What `-p` changes of the parameters of these figures, each of which has them."""
    if not given:
        return {}
    from move.figures.page.parameters import refuse_unknown, texts

    changes = read_parameters(given, {text for name in names for text in texts(name)})
    for name in names:
        refuse_unknown(name, changes)
    return changes


@app.command(epilog=examples("move run fig1", "move run --profile smoke --workers 2",
                             "move run --cluster tcp://host:8786"))
def run(
    figures: Figures = None,
    profile: ProfileName = "laptop",
    workers: Annotated[Optional[int], typer.Option(
        min=1, max=1024, help="processes (default: one a core, or one a GPU)")] = None,
    cluster: Annotated[Optional[str], typer.Option(help="address of a Dask scheduler, tcp://host:8786")] = None,
    results: Annotated[Optional[str], typer.Option(help="results folder (default: the profile's)")] = None,
    as_json: Json = False,
) -> None:
    """Compute the runs that are missing; what exists is reused, what was interrupted goes on."""
    chosen, names = _asked(profile, figures)
    if results == "":
        raise BadInput("results: '' given; allowed is a folder's name")
    folder = Path(results) if results else chosen.results
    refuse_unwritable(folder / "result.json")
    if cluster is not None and not SCHEDULER.fullmatch(cluster):
        raise BadInput(f"cluster: {cluster[:60]!r} given; allowed is an address such as tcp://host:8786")
    from move.study.execute import execute

    specs = [spec for listed in chosen_specs(chosen, names).values() for spec in listed]
    there, missing = execute(specs, folder, cluster, workers, quiet=not sys.stderr.isatty())
    problems = [{"hash": spec.hash, "run": spec.label, "why": why} for spec, why in missing]
    content = {"profile": profile, "stored": len(there), "folder": str(folder.absolute())}
    if as_json:
        show(content | {"missing": problems}, True, "")
    else:
        show(content | {"missing": len(problems)}, False, "Runs")
        if problems:
            show(problems, False, "Missing")
    if problems:
        raise typer.Exit(1)


@app.command(epilog=examples("move plan", "move plan fig1 -p timesteps=3500", "move plan --profile paper"))
def plan(figures: Figures = None, profile: ProfileName = "laptop", parameter: Parameters = None,
         as_json: Json = False) -> None:
    """Show what would run, how long it would take and why, without running anything."""
    chosen, names = _asked(profile, figures)
    changes = _changes(parameter, names)
    from move.study.plan import plan_rows, plan_title

    rows = plan_rows(chosen, chosen_specs(chosen, names, changes))
    show(rows, as_json, plan_title(chosen))


@app.command(epilog=examples("move verify fig1 --sample 1", "move verify 2514a6c230291265", "move verify --seed 7",
                             "move verify --all"))
def verify(
    figures: Annotated[Optional[list[str]], typer.Argument(
        metavar="[FIGURE | HASH]...", help="figures whose runs are drawn from (default: all of the profile), or the "
        "hashes of the runs to recompute")] = None,
    profile: ProfileName = "laptop",
    sample: Annotated[Optional[int], typer.Option(
        min=1, max=10**4, help=f"how many results to recompute (default: {SAMPLE})")] = None,
    seed: Annotated[Optional[int], typer.Option(
        min=0, max=LARGEST_SEED, help="draws the sample; fresh each time if left out")] = None,
    every: Annotated[bool, typer.Option("--all", help="check every stored file, recompute nothing")] = False,
    as_json: Json = False,
) -> None:
    """Recompute a drawn sample of the stored results, or named ones, and compare; a difference ends with code 1."""
    hashes = list(dict.fromkeys(name for name in figures or [] if HASH.fullmatch(name)))
    for name in figures or []:
        if name not in hashes and re.fullmatch("[0-9a-fA-F]{4,}", name):
            raise BadInput(f"verify: {name!r} given; allowed is the whole hash of a run, 16 digits")
    chosen, names = _asked(profile, [name for name in figures or [] if name not in hashes])
    if every and (names or hashes):
        raise BadInput(f"figure: {(names + hashes)[0]!r} given with --all, which checks every file; allowed is one of "
                       "the two")
    if hashes and (names or sample or seed is not None):
        other = names[0] if names else "--sample or --seed"
        raise BadInput(f"verify: the run {hashes[0]} given with {other}, of which a sample is drawn; allowed is one of "
                       "the two")
    import numpy as np

    from move.study import verify as verifying
    from move.study.results import find

    if every:
        rows = verifying.check_files(chosen.results)
        shown = [row for row in rows if not row["same"]] or [{"files": len(rows), "same": "all"}]
        show(rows if as_json else shown, as_json, "Checked")
    elif hashes:
        stored = [find(name, [chosen.results, chosen.own_results]) for name in hashes]
        with progress("verify") as report:
            rows = verifying.recompute(stored, report)
        show(rows, as_json, "Recomputed")
    else:
        seed = int(np.random.SeedSequence().generate_state(1)[0]) if seed is None else seed
        specs = [spec for listed in chosen_specs(chosen, names).values() for spec in listed]
        with progress(f"verify --seed {seed}") as report:
            rows = verifying.verify(specs, chosen.results, sample or SAMPLE, np.random.default_rng(seed), report)
        typer.echo(f"verify: --seed {seed} draws this sample again", err=True)
        show(rows, as_json, "Recomputed")
    if not all(row["same"] for row in rows):
        raise typer.Exit(1)


@app.command(epilog=examples("move figure fig1", "move figure fig1 -p timesteps=3500 -p seeds=1",
                             "move figure table3 -p sheet=/path/to/sheet.csv", "move figure --stored-only"))
def figure(
    figures: Figures = None,
    profile: ProfileName = "laptop",
    parameter: Parameters = None,
    stored_only: Annotated[bool, typer.Option("--stored-only", help="run nothing; show what is missing")] = False,
    as_json: Json = False,
) -> None:
    """Execute notebooks, which run what is missing and write their figures and tables."""
    chosen, names = _asked(profile, figures)
    changes = _changes(parameter, names)
    for place in (chosen.figures, paths.BUILD / "notebooks" / profile):
        refuse_unwritable(place / "figure.png")
    from move.figures.page import kernels
    from move.figures.page.changes import change
    from move.figures.page.kept import files_of
    from move.figures.page.parameters import runs

    names = names or kernels.of_profile(chosen, stored_only)
    for name in names:  # all of them are checked before the first one runs
        runs(name, chosen, changes)
    rows: list[dict[str, Any]] = []
    failed: list[str] = []
    begun: list[str] = []
    with progress("figures") as report:
        def on_progress(under_way: list[str], done: float, of_runs: int, asked: int) -> None:
            for name in [name for name in under_way if name not in begun]:
                begun.append(name)
                if not sys.stderr.isatty():
                    more = f", {asked} runs to compute" if asked else ""
                    typer.echo(f"notebook {name} ({len(begun)} of {len(names)}) ({profile}){more} ...", err=True)
            report(done, len(names), text=", ".join(under_way) + (f": {of_runs} of {asked} runs" if asked else ""))

        for done in kernels.run_notebooks(names, chosen, changes, stored_only, on_progress):
            if done.problem is not None:  # what can be drawn is
                if len(names) == 1 and isinstance(done.problem, BadInput):
                    raise done.problem
                failed.append(done.name)
                said = str(done.problem)
                typer.echo(f"move: {said if done.name in said else f'{done.name}: {said}'}", err=True)
                continue
            files = files_of(done.name, change(done.name, chosen, changes).folder)
            rows.append({"notebook": done.name, "files": files, "executed": done.executed})
    if as_json:
        show(rows, True, "")
    else:
        show_paths([path for row in rows for path in (*row["files"], row["executed"])])
    if failed:
        if len(names) > 1:
            typer.echo(f"move: {len(failed)} of {len(names)} not drawn: {', '.join(failed)}", err=True)
        raise typer.Exit(1)


@app.command(epilog=examples("move doctor"))
def doctor(as_json: Json = False) -> None:
    """Say what is missing on this machine, and the one line that mends it."""
    paths.refuse_outside_checkout()
    from move.study.doctor import examine

    checks = examine()
    show(checks, as_json, "This machine")
    if any(check["outcome"] == "broken" for check in checks):
        raise typer.Exit(1)
