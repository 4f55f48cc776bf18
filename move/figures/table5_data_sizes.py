"""Table 5: timesteps of each task, and how many demonstrations they are."""

from __future__ import annotations

import pandas as pd

from move.figures.page import parameters
from move.figures.page.captions import Words
from move.figures.page.data import Data
from move.figures.tables import collection_costs, with_paper
from move.paper import PAPER_METHODS, PAPER_TASKS
from move.sim.tasks import TASKS
from move.study.labels import LabelledRun
from move.study.profiles import Profile

TRAINS = False


def runs(profile: Profile) -> list[LabelledRun]:
    """Those of table 6, whose demonstrations say how long one is."""
    return parameters.runs("table6_collection", profile)


def tables(data: Data) -> dict[str, pd.DataFrame]:
    """Timesteps of each task here and in the paper, and how many demonstrations of each method they are."""
    costs = collection_costs(data.results)
    steps = costs[costs.expert == "phase"].pivot(index="task", columns="method", values="mean_steps").reindex(
        index=PAPER_TASKS, columns=PAPER_METHODS)
    sizes = pd.DataFrame([{"task": name, "timesteps": TASKS[name].timesteps} for name in PAPER_TASKS])
    sizes = with_paper(sizes, "table5_data_sizes", ["task"], "timesteps").astype({"paper": int})
    return {"": sizes.assign(task=[TASKS[name].title for name in sizes.task], **{
        f"{method} demonstrations": (sizes.timesteps / steps[method].to_numpy()).round().astype("Int64")
        for method in PAPER_METHODS})}


def answer(tables: dict[str, pd.DataFrame], data: Data) -> str:
    """Whether the timesteps are the paper's, and MOVE's demonstrations for one of static."""
    table = tables[""]
    both = table.dropna(subset=["move demonstrations", "static demonstrations"])
    made = (f"{both['move demonstrations'].sum() / both['static demonstrations'].sum():.2f} demonstrations"
            if len(both) else "a number of demonstrations that is not computed yet")
    return (
        f"**The paper** gives {table.timesteps.sum():,} timesteps to {len(table)} tasks. **Here:** the registry has "
        f"the same number for {(table.timesteps == table.paper).sum()} of {len(table)}; in them MOVE makes {made} for "
        f"one of static. **How sure:** from the mean lengths of table 6. {data.sample_size}")


WORDS = Words(tables={
    "": "Table 5: timesteps of each task, and how many demonstrations they are.",
})
