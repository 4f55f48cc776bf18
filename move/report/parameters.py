"""What a notebook's parameters may be, checked before a kernel starts.

Those of an experiment are checked by it. All others are checked by their names, which mean the same in every notebook.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import AfterValidator, ConfigDict, Field, create_model

from move import experiments
from move.choices import refuse_unknown_parameters
from move.errors import BadInput
from move.experiments.registry import check_values
from move.sim.tasks import get_task
from move.study.profiles import Profile, load_profile
from move.validation import build

TaskName = Annotated[str, AfterValidator(lambda name: get_task(name).name)]
ProfileName = Annotated[str, AfterValidator(lambda name: load_profile(name).name)]
Share = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]
ALLOWED: dict[str, Any] = {
    "task": TaskName,
    "rotating_task": TaskName,
    "shown": TaskName,
    "tasks": list[TaskName],
    "compared": list[ProfileName],
    "timesteps": Annotated[int, Field(gt=0, le=10**8)],
    "episodes": Annotated[int, Field(gt=0, le=10**5)],
    "image_size": Annotated[int, Field(ge=16, le=512)],
    "covered_timesteps": Annotated[int, Field(gt=0, le=10**8)],
    "frames": Annotated[int, Field(ge=2, le=100)],
    "seed": Annotated[int, Field(ge=0, lt=2**32)],
    "seeds": Annotated[list[Annotated[int, Field(gt=0, le=1000)]], Field(min_length=1, max_length=20)],
    "deviations": Annotated[list[Share], Field(min_length=1, max_length=20)],
    "rate": Share,
    "draws": Annotated[int, Field(gt=0, le=10**6)],
    "data": str,
    "revision": Annotated[str, Field(pattern=r"^([0-9a-f]{40})?$")],
    "size_cap_gb": Annotated[float, Field(gt=0, le=10**5, allow_inf_nan=False)],
    "units_file": str,
    "sheet": str,
}


def check(notebook: str, profile: Profile, changes: dict[str, Any]) -> dict[str, Any]:
    """The parameters that `profile` and `changes` give `notebook`, with the profile's name, all of them allowed.

    Raises:
        BadInput: a parameter that its cell does not have, or a value that is not allowed.
    """
    given = {**profile.parameters(notebook), **changes}
    refuse_unknown_parameters(notebook, given)
    own = experiments.defaults(notebook) if notebook in experiments.EXPERIMENTS else {}
    if own:
        experiments.runs(notebook, profile, {name: value for name, value in changes.items() if name in own})
    others = {name: value for name, value in given.items() if name not in own}
    for name, value in others.items():
        check_values(name, value)
    fields: dict[str, Any] = {name: (ALLOWED[name], ...) for name in others}
    try:
        build(create_model("Parameters", __config__=ConfigDict(strict=True), **fields), **others)
    except BadInput as problem:
        raise BadInput(f"{notebook}: {problem}") from problem
    return {**given, "profile": profile.name}
