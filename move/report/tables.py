"""Tables: from episodes to rates with intervals, tidy and ready to be drawn, written or read aloud."""

from __future__ import annotations

import numpy as np
import pandas as pd

from move import paper
from move.errors import BadInput
from move.paper import PAPER_METHODS, PAPER_TASKS
from move.report.printed import ABSENT, as_markdown, readable, shown
from move.report.style import NAMES
from move.sim.collection import METHODS
from move.sim.tasks import TASKS
from move.sim.tasks.task import acceptance_rate
from move.statistics.cells import inside_and_outside, successes, training_noise
from move.statistics.estimates import UNKNOWN, TrainingNoise, difference, success_rate
from move.statistics.intervals import wilson_interval
from move.study.labels import LabelledRun
from move.study.profiles import Profile
from move.study.results import Result
from move.study.spec import CollectionRun, PolicyRun

__all__ = ["as_markdown", "inside_and_outside", "readable", "shown"]  # besides what stands here: a notebook's tables


def rate_table(episodes: pd.DataFrame, by: list[str], known: TrainingNoise = UNKNOWN) -> pd.DataFrame:
    """One row a group: success rate, 95 % interval, each seed's own rate, episodes, what the interval knows.

    The training noise is `known`, else what the groups tell. Column `trainings` is as in
    `move.statistics.estimates.Estimate`, and "none" for an agent that is not trained.

    Args:
        episodes: rows as `move.study.results.table` gives them, with the columns `by`.
        known: the training noise of like cells elsewhere, known from more cells than this table has.
    """
    noise, rows = training_noise(episodes, by, known), []
    for key, group in episodes.groupby(by, sort=False):
        per_seed, trained = successes(group), group.method.isin(METHODS).all()
        rate = success_rate(per_seed, noise if trained else UNKNOWN)
        rows.append({**dict(zip(by, key, strict=True)), "value": rate.value, "low": rate.low, "high": rate.high,
                     "seeds": per_seed.mean(axis=1).round(4).tolist(), "episodes": rate.episodes,
                     "trainings": rate.trainings if trained else "none"})
    return pd.DataFrame(rows, columns=[*by, "value", "low", "high", "seeds", "episodes", "trainings"])


def with_paper(table: pd.DataFrame, experiment: str, on: list[str], metric: str = "success", column: str = "paper",
               **where: str) -> pd.DataFrame:
    """`table` with the paper's value beside each row, NaN where the paper gives none.

    Args:
        on: the columns of `table` that tell rows apart in the paper: its task, method or baseline; one column of
            another name holds the paper's condition.
        metric: as in `move.paper.PAPER`, or "difference": MOVE's success minus that of the method in column `baseline`.
        column: the name of the new column.
        where: what else the paper's rows must be, such as condition="simulation".

    Raises:
        BadInput: the paper has no such value, or several for one row of `table`.
    """
    rows = paper.published(experiment, metric, **where)
    names = {name if name in rows else "condition": name for name in on}
    if len(names) < len(on) or rows.duplicated(list(names)).any():
        raise BadInput(f"on: {on} given; allowed are columns that tell the paper's values of {experiment} apart, with "
                       "at most one for its condition")
    values = rows.rename(columns=names).set_index(on).value.rename(column)
    return table.join(values, on=on)


def grasp_points(results: list[Result]) -> pd.DataFrame:
    """Where each demonstration of each run grasped the object: method, seed, object_x, object_y (metres)."""
    return pd.DataFrame([
        {"method": result.spec.method, "seed": result.spec.seed, "object_x": x, "object_y": y}
        for result in results if result.collection
        for x, y in result.collection["grasp_points"]
    ])


def demonstrations_made(results: list[Result], by: str) -> pd.DataFrame:
    """How many demonstrations a data set has, one row a value of the label `by` and method: the mean of the seeds."""
    rows = pd.DataFrame([{by: result.labels[by], "method": result.spec.method,
                          "demonstrations": result.collection["demonstrations"],
                          "timesteps": result.spec.collection.timesteps} for result in results
                         if isinstance(result.spec, PolicyRun) and result.collection])
    return rows.groupby([by, "method"], sort=False).mean().reset_index()


def printed_success(tasks: list[str]) -> pd.DataFrame:
    """The paper's success of table 2 at the budgets of its table 5: task, method, timesteps, value."""
    budgets = paper.published("table5_data_sizes", "timesteps").set_index("task").value.rename("timesteps")
    rates = paper.published("table2_main")[["task", "method", "value"]]
    return rates[rates.task.isin(tasks)].join(budgets, on="task")


def run_costs(results: list[Result]) -> pd.DataFrame:
    """Core-minutes of the runs' parts: one row a method and budget, the median run, and how many runs there are.

    Args:
        results: of runs that train a policy.
    """
    rows = pd.DataFrame([
        {"method": result.spec.method, "timesteps": result.spec.collection.timesteps,
         **{part: seconds / 60 for part, seconds in result.seconds.items()},
         "whole": sum(result.seconds.values()) / 60}
        for result in results if result.spec.training
    ])
    if rows.empty:
        return pd.DataFrame(columns=["timesteps", "method", "whole", "runs", "all_runs"])
    groups = rows.groupby(["timesteps", "method"], sort=False)
    return groups.median().round(1).assign(runs=groups.size(), all_runs=groups.whole.sum().round(0)).reset_index()


def recipe_table(results: list[Result]) -> pd.DataFrame:
    """One row a run of the recipe's experiment: what was changed, minutes of training, success at its own places.

    Columns timesteps, change, train_minutes (one core), loss (mean of the last fiftieth of the steps), value, low,
    high, episodes; gain, gain_low, gain_high: success minus the chosen recipe's, paired, NaN where that is missing.

    Args:
        results: with the labels timesteps and change of their experiment.
    """
    runs = [(result, result.labels["timesteps"], result.labels["change"]) for result in results]
    chosen = {timesteps: _outcomes(result) for result, timesteps, change in runs if change == "chosen"}
    rows = []
    for result, timesteps, change in runs:
        training = result.training or {"curve": [[0, np.nan]]}
        outcomes = _outcomes(result)
        rate = success_rate(outcomes)
        found = difference(outcomes, chosen[timesteps]) if timesteps in chosen else None
        gain = (found.value, found.low, found.high) if found else (np.nan,) * 3
        rows.append({"timesteps": timesteps, "change": change,
                     "train_minutes": result.seconds["train"] / 60, "loss": training["curve"][-1][1],
                     "value": rate.value, "low": rate.low, "high": rate.high, "episodes": rate.episodes,
                     **dict(zip(("gain", "gain_low", "gain_high"), gain, strict=True))})
    return pd.DataFrame(rows)


def _outcomes(result: Result) -> np.ndarray:
    """One run's successes, shape (1, episodes)."""
    return np.array([[row["success"] for row in result.rows]], float)


def own_and_elsewhere(rates: pd.DataFrame) -> pd.DataFrame:
    """One row a task and method: rates at its own grasps, elsewhere (what is `lost`), and elsewhere in motion.

    Args:
        rates: as `rate_table` gives them by task, method and group ("grasp", "random" or "moving"); a missing one
            becomes NaN.
    """
    keys, names = ["task", "method"], {"grasp": "own", "random": "elsewhere", "moving": "in_motion"}
    wide = rates.pivot(index=keys, columns="group", values="value").reindex(columns=list(names))
    wide = rates[keys].drop_duplicates().join(wide, on=keys).rename(columns=names)
    return wide.assign(lost=wide.own - wide.elsewhere).reset_index(drop=True)


def collection_costs(results: list[Result]) -> pd.DataFrame:
    """One row a task, method and expert: attempts, share that succeeded with its interval, mean steps of those.

    Column `jumps` is the mean number of jumps of a demonstration, NaN for a method that has none.

    Args:
        results: of runs whose agent is "collector".
    """
    rows = []
    for result, spec in [(result, result.spec) for result in results if isinstance(result.spec, CollectionRun)]:
        attempts = len(result.rows)
        kept = [row for row in result.rows if row["success"]]
        rate, steps = len(kept) / attempts, [row["steps"] for row in kept]
        low, high = wilson_interval(rate, attempts)
        jumps = [row["jumps"] for row in kept if "jumps" in row]
        rows.append({"task": spec.task, "method": spec.method, "expert": spec.collection.expert,
                     "attempts": attempts, "generation_rate": rate, "low": low, "high": high,
                     "mean_steps": float(np.mean(steps)) if steps else np.nan,
                     "jumps": float(np.mean(jumps)) if jumps else np.nan})
    return pd.DataFrame(rows)


def floors_and_ceilings(episodes: pd.DataFrame) -> pd.DataFrame:
    """Success rate of each control on each task: one row a task, one column a control."""
    controls = episodes[episodes.kind == "control"]
    return controls.pivot_table("success", "task", "method", aggfunc="mean", sort=False)


def with_level(rates: pd.DataFrame, controls: pd.DataFrame) -> pd.DataFrame:
    """`rates` with a column `level`: where a rate lies from what a goal-blind expert scores (0) to the expert (1).

    A policy that ignores the target is near 0, however often that succeeds by chance; below it lies one that does not
    get so far. NaN for a task without a target, or where a control is missing.

    Args:
        rates: with the columns task and value.
        controls: as `floors_and_ceilings` gives them.
    """
    blind, expert = (rates.task.map(controls[name] if name in controls else {}) for name in ("goal-blind", "expert"))
    return rates.assign(level=(rates.value - blind) / (expert - blind))


def with_missing(rates: pd.DataFrame, runs: list[LabelledRun], by: list[str]) -> pd.DataFrame:
    """`rates` with a row for everything that `runs` were to tell, NaN where it is missing, in the order of the runs.

    Args:
        rates: as `rate_table` gives them by `by`.
    """
    wanted = pd.DataFrame([{**run.labels, "task": run.spec.task, "method": run.spec.method,
                            "observation": run.spec.observation, "timesteps": run.spec.collection.timesteps}
                           for run in runs if run.spec.collection])
    table = wanted[by].drop_duplicates().merge(rates, on=by, how="left")
    return table.assign(seeds=[seeds if isinstance(seeds, list) else [] for seeds in table.seeds])


def beside(rates: pd.DataFrame, controls: pd.DataFrame, means: pd.DataFrame | None = None) -> pd.DataFrame:
    """A table for print: one row a task, for each method its rate, the paper's beside it; floor, ceiling, mean row.

    Args:
        rates: task, method, value, low, high; paper where the paper gives any.
        controls: as `floors_and_ceilings` gives them.
        means: method, value and, where the paper gives any, paper: the last row.
    """
    if rates.empty:
        return readable(rates)
    text = readable(rates).assign(task=rates.task, method=rates.method)
    printed = [name for name in ("Success (%)", "Paper (%)") if name in text]
    wide = text.pivot(index="task", columns="method", values=printed).reindex(rates.task.unique())
    names = {"Success (%)": "here", "Paper (%)": "paper"}
    columns = {(NAMES[method], names[kind]): wide[kind, method] for method in rates.method.unique() for kind in printed}
    for control in ("expert", "goal-blind"):
        values = controls[control].reindex(wide.index) if control in controls else pd.Series(np.nan, wide.index)
        columns[NAMES[control], ""] = values.map(lambda value: ABSENT if pd.isna(value) else f"{100 * value:.1f}")
    table = pd.DataFrame(columns).fillna(ABSENT)
    table.insert(0, ("Task", ""), [TASKS[task].title for task in table.index])
    if means is not None:
        last = readable(means).assign(method=means.method).set_index("method")
        row = {(NAMES[method], names[kind]): last.loc[method, kind] for method in last.index for kind in printed}
        table.loc["mean"] = pd.Series({("Task", ""): f"mean of {len(table)}", **row}).reindex(table.columns)
    return table.fillna(ABSENT).reset_index(drop=True)


def hyperparameters(profiles: list[Profile]) -> pd.DataFrame:
    """Table 4: one row a hyperparameter, the profiles' recipes for images beside the paper's two columns.

    The recipes are those for Pick-Place's budget of table 5.
    """
    recipes = {profile.name: profile.recipe("rgb", TASKS["pick-place"].timesteps) for profile in profiles}
    rows = {
        "prediction horizon": "prediction_horizon", "action horizon": "action_horizon",
        "observation horizon": "observation_horizon", "gradient steps": "gradient_steps", "batch size": "batch_size",
        "denoising steps in training": "diffusion_steps", "denoising steps in inference": "inference_steps",
        "target": "target", "encoder": "encoder", "denoiser": "denoiser", "crop (pixels)": "crop_pixels",
        "learning rate": "learning_rate",
    }
    return pd.DataFrame([
        {"hyperparameter": shown, **{name: getattr(recipe, field) for name, recipe in recipes.items()},
         "paper, simulation": paper.TABLE4_HYPERPARAMETERS.get(shown, ("", ""))[0],
         "paper, real robot": paper.TABLE4_HYPERPARAMETERS.get(shown, ("", ""))[1]}
        for shown, field in rows.items()
    ]).astype(str)


def data_sizes(costs: pd.DataFrame) -> pd.DataFrame:
    """Table 5: timesteps of each task, the registry's beside the paper's, and how many demonstrations they are.

    Args:
        costs: as `collection_costs` gives them.
    """
    steps = costs[costs.expert == "phase"].pivot(index="task", columns="method", values="mean_steps").reindex(
        index=PAPER_TASKS, columns=PAPER_METHODS)
    sizes = pd.DataFrame([{"task": name, "timesteps": TASKS[name].timesteps} for name in PAPER_TASKS])
    sizes = with_paper(sizes, "table5_data_sizes", ["task"], "timesteps").astype({"paper": int})
    return sizes.assign(task=[TASKS[name].title for name in sizes.task], **{
        f"{method} demonstrations": (sizes.timesteps / steps[method].to_numpy()).round().astype("Int64")
        for method in PAPER_METHODS})


def acceptance_rates(rng: np.random.Generator, configurations: int = 1000) -> pd.DataFrame:
    """For each task the share of random configurations that its reach and clearance filter keeps.

    The same filter serves static starts, ADC's jumps, MOVE's motions and evaluation.
    """
    return pd.DataFrame([{"task": name, "acceptance_rate": acceptance_rate(TASKS[name], rng, configurations)}
                         for name in PAPER_TASKS])


def printed_trials(table: pd.DataFrame) -> pd.DataFrame:
    """Table 3 as it is printed: counts, per cent with the exact interval, scores with the range they could have.

    Args:
        table: from `move.realworld.trials.real_table`.
    """
    rows = [
        {"Timesteps": f"{row.timesteps:,}", "Method": NAMES[row.method], "Successes": f"{row.successes}/{row.trials}",
         "Success (%)": f"{100 * row.rate:.1f}", "95 % interval": f"{100 * row.low:.1f} to {100 * row.high:.1f}",
         "Score (%)": f"{100 * row.normalised:.1f}",
         "Score that the successes allow": f"{100 * row.score_low:.1f} to {100 * row.score_high:.1f}"}
        for row in table.itertuples()
    ]
    return pd.DataFrame(rows)


def printed_pairs(table: pd.DataFrame) -> pd.DataFrame:
    """Pairs of cells with the methods' display names, from `move.realworld.trials.comparisons`."""
    cells = {column: [cell.split() for cell in table[column]] for column in ("first", "second")}
    return table.assign(**{column: [f"{NAMES[method]} {size}" for method, size in cell]
                           for column, cell in cells.items()})
