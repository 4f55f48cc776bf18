"""Table 4: hyperparameters, ours and the paper's."""

from __future__ import annotations

import pandas as pd

from move import paper
from move.figures.page.captions import Words
from move.figures.page.data import Data
from move.figures.page.parameters import ProfileName
from move.figures.page.printed import readable
from move.sim.tasks import TASKS
from move.study.profiles import load_profile

FIELDS = {
    "prediction horizon": "prediction_horizon", "action horizon": "action_horizon",
    "observation horizon": "observation_horizon", "gradient steps": "gradient_steps", "batch size": "batch_size",
    "denoising steps in training": "diffusion_steps", "denoising steps in inference": "inference_steps",
    "target": "target", "encoder": "encoder", "denoiser": "denoiser", "crop (pixels)": "crop_pixels",
    "learning rate": "learning_rate",
}
SIMULATION, ROBOT = "paper, simulation", "paper, real robot"


def tables(data: Data, *, compared: tuple[ProfileName, ...] = ("laptop", "paper")) -> dict[str, pd.DataFrame]:
    """One row a hyperparameter, the recipes of `compared` for images next to the paper's two columns.

    The recipes are those for Pick-Place's budget of table 5.
    """
    recipes = {name: load_profile(name).recipe("rgb", TASKS["pick-place"].timesteps) for name in compared}
    return {"": pd.DataFrame([
        {"hyperparameter": shown, **{name: getattr(recipe, field) for name, recipe in recipes.items()},
         SIMULATION: paper.TABLE4_HYPERPARAMETERS.get(shown, ("", ""))[0],
         ROBOT: paper.TABLE4_HYPERPARAMETERS.get(shown, ("", ""))[1]}
        for shown, field in FIELDS.items()
    ]).astype(str)}


def source(data: Data) -> str:
    """Nothing but the profiles."""
    return ""


def printed(tables: dict[str, pd.DataFrame], data: Data, *, compared: tuple[str, ...]) -> dict[str, pd.DataFrame]:
    """The profiles' columns under a heading that says what they are."""
    return {"": readable(tables[""].rename(columns={name: f"profile {name}" for name in compared}))}


def answer(tables: dict[str, pd.DataFrame], data: Data, *, compared: tuple[str, ...]) -> str:
    """How many settings are the paper's, word for word."""
    table = tables[""]
    alike = table[table[SIMULATION] != ""]
    same = ", ".join(f"the profile {name} has {(alike[name] == alike[SIMULATION]).sum()} of them word for word"
                     for name in compared)
    return (f"**The paper** prints {len(alike)} of these {len(table)} settings. **Here:** {same}. **How sure:** the "
            "columns are read from the profiles that the runs use.")


WORDS = Words(tables={
    "": "Table 4: hyperparameters, ours beside the paper's.",
})
