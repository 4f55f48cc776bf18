"""Which runs make which figure: one function a figure, from its parameters to its list of specs.

The parameters are those of the notebook of the same name; a profile's YAML may change them. Static, ADC and MOVE get
the same budget, recipe, evaluation and seeds.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, validate_call

from move.errors import BadInput
from move.learn.evaluate import Evaluation
from move.sim.collect import METHODS, Collection
from move.sim.experts.phase import EXPERTS
from move.sim.motion.adc import JUMPS, MENDED, Jumping
from move.sim.scene.scene import EPISODE_STEPS
from move.sim.tasks import FACTORS, TASKS, get_task
from move.study.profiles import first_problem, load_profile
from move.study.spec import RunSpec


def checked(experiment: Callable[..., list[RunSpec]]) -> Callable[..., list[RunSpec]]:
    """Check the arguments of an experiment by their annotations; what does not fit is BadInput, in one line."""
    validated = validate_call(experiment)

    @functools.wraps(experiment)
    def call(*arguments: Any, **keywords: Any) -> list[RunSpec]:
        try:
            return validated(*arguments, **keywords)
        except ValidationError as error:
            raise BadInput(f"{experiment.__name__}: {first_problem(error)}") from error

    return call


Count = Annotated[int, Field(gt=0, strict=True)]
Multiple = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Seeds = Annotated[int, Field(ge=0, strict=True)]
ADC = MENDED  # how ADC jumps wherever it is compared: the stronger of those in table_adc
HAND_SPREAD = 0.03  # metres; how far to each side the hand starts in the demonstrations of figures 1, 3 and 5
Observation = Literal["rgb", "keypoints"]


@checked
def fig1_sparse(
    profile: str = "laptop", observation: Observation = "rgb", timesteps: Count = 7000, seeds: Count = 5,
    identical_starts: Seeds = 3, grid_side: Count = 12,
) -> list[RunSpec]:
    """Nine grasp points, static against MOVE, equal timesteps; a grid over the 30 x 30 cm object space (figure 1).

    Each demonstration starts with the hand a few centimetres elsewhere; the first `identical_starts` seeds are there
    once more with the hand always in one place, where static demonstrations of a point are all the same.
    """
    return _with_identical_starts("sparse", profile, observation, timesteps, seeds, identical_starts, grid_side)


@checked
def fig3_dense(
    profile: str = "laptop", observation: Observation = "rgb", timesteps: tuple[Count, ...] = (7000, 3500, 2000),
    seeds: Count = 3, identical_starts: Seeds = 3, grid_side: Count = 12,
) -> list[RunSpec]:
    """Grasp points anywhere, the same for static and MOVE, equal timesteps; a grid over the object space (figure 3).

    At each budget of `timesteps`; with the hand always in one place, as in figure 1, at the first alone.
    """
    first, *less = timesteps
    return [*_with_identical_starts("dense", profile, observation, first, seeds, identical_starts, grid_side),
            *(spec for budget in less
              for spec in _grasp_points("dense", profile, observation, budget, seeds, grid_side, HAND_SPREAD))]


@checked
def fig5_circle(
    profile: str = "laptop", observation: Observation = "rgb", timesteps: Count = 7000, seeds: Count = 5,
    identical_starts: Seeds = 3, grid_side: Count = 12,
) -> list[RunSpec]:
    """Twenty grasp points on a circle, motion inside it; a grid over the object space, in and out (figure 5)."""
    return _with_identical_starts("circle", profile, observation, timesteps, seeds, identical_starts, grid_side)


def _with_identical_starts(
    protocol: str, profile: str, observation: str, timesteps: int, seeds: int, identical_starts: int, grid_side: int
) -> list[RunSpec]:
    return [*_grasp_points(protocol, profile, observation, timesteps, seeds, grid_side, HAND_SPREAD),
            *_grasp_points(protocol, profile, observation, timesteps, identical_starts, grid_side, 0.0)]


def _grasp_points(
    protocol: str, profile: str, observation: str, timesteps: int, seeds: int, grid_side: int, hand_spread: float
) -> list[RunSpec]:
    settings = load_profile(profile)
    points = "none" if protocol == "dense" else protocol  # dense: every demonstration has a point of its own
    return [
        RunSpec(
            task="pick-place", seed=seed, training=settings.recipe(observation, timesteps),
            collection=Collection(task="pick-place", method=method, timesteps=timesteps, observation=observation,
                                  image_size=settings.image_size, factors="object", protocol=protocol,
                                  hand_spread=hand_spread),
            evaluation=Evaluation(layout="grid", grid_side=grid_side, factors="object", points=points),
        )
        for seed in range(seeds)
        for method in ("static", "move")
    ]


@checked
def table1_spatial_factors(
    profile: str = "laptop", observation: Observation = "rgb", timesteps: Count = 20_000, seeds: Count = 3,
    episodes: Count = 100,
) -> list[RunSpec]:
    """Pick-Place as its object, then its target, then camera and hand become random; static and MOVE (table 1)."""
    return [
        _policy("pick-place", method, seed, profile, observation, timesteps,
                Evaluation(episodes=episodes, factors=factors))
        for seed in range(seeds)
        for factors in FACTORS
        for method in ("static", "move")
    ]


@checked
def table2_main(
    profile: str = "laptop", seeds: Seeds = 1, control_seeds: Seeds = 1, episodes: Count = 100,
    most_timesteps: Count = 20_000,
) -> list[RunSpec]:
    """Every task, three methods, at the paper's budget but at `most_timesteps` (table 2); its floor and its ceiling.

    `seeds` from pixels and `control_seeds` from keypoints.
    """
    evaluation = Evaluation(episodes=episodes)
    policies = [
        _policy(name, method, seed, profile, observation, min(task.timesteps, most_timesteps), evaluation)
        for observation, count in (("rgb", seeds), ("keypoints", control_seeds))
        for seed in range(count)
        for name, task in TASKS.items()
        for method in METHODS
    ]
    return policies + [spec for name in TASKS for spec in controls(name, evaluation)]


RECIPE_CHANGES: dict[str, dict[str, Any]] = {
    "chosen": {},
    "one noise level a window": {"noise_draws": 1},
    "spatial softmax starts flat": {"softmax_gain": 1.0},
    "encoder learns from all frames": {"learning_frames": None},
    "32 channels": {"cnn_width": 32},
    "learning rate 1e-3": {"learning_rate": 1e-3},
    "learning rate 3e-3": {"learning_rate": 3e-3},
}
"""What the recipe for pictures was measured against: one change at a time."""


def recipe_change(spec: RunSpec, profile: str) -> str:
    """What a run of `table_recipe` changes about the recipe that the profile has for its data."""
    recipe = load_profile(profile).recipe("rgb", spec.collection.timesteps)
    for name, change in RECIPE_CHANGES.items():
        if spec.training == recipe.model_copy(update=change):
            return name
    return f"{spec.training.gradient_steps / recipe.gradient_steps:.2g} times as long"


@checked
def table_recipe(
    profile: str = "laptop", timesteps: tuple[Count, ...] = (7000, 20_000), episodes: Count = 60,
    lengths: tuple[Multiple, ...] = (2 / 3, 3),
) -> list[RunSpec]:
    """The recipe for pictures with one change at a time: static alone, at the configurations that it learnt from.

    The last runs of each budget train for the recipe's gradient steps times each of `lengths`. Nothing here compares
    methods. A profile whose policy is not the small CNN has no `timesteps` for it.
    """
    settings, specs = load_profile(profile), []
    for budget in timesteps:
        recipe = settings.recipe("rgb", budget)
        changes = [*RECIPE_CHANGES.values(), *({"gradient_steps": round(length * recipe.gradient_steps)}
                                               for length in lengths)]
        protocol, factors = ("sparse", "object") if budget == min(timesteps) else ("random", "all")
        collection = Collection(task="pick-place", method="static", timesteps=budget, observation="rgb",
                                image_size=settings.image_size, factors=factors, protocol=protocol)
        specs += [RunSpec(task="pick-place", seed=0, training=recipe.model_copy(update=change), collection=collection,
                          evaluation=Evaluation(layout="own", episodes=episodes)) for change in changes]
    return list(dict.fromkeys(specs))  # a change may be none in this profile


@checked
def generalization(
    profile: str = "laptop", tasks: tuple[str, ...] = tuple(TASKS), methods: tuple[str, ...] = METHODS,
    seeds: tuple[Seeds, ...] = (0,), own_episodes: Count = 60, episodes: Count = 100, most_timesteps: Count = 20_000,
) -> list[RunSpec]:
    """Policies of table 2 from pixels: where table 2 tries them, the same in motion, and at their own grasps.

    In motion everything moves as in demonstrations of MOVE. Every method's demonstrations show the scene as it is at
    the grasp, so the rates mean the same for all. A policy is trained once for all. No more of its own configurations
    are tried than its budget is sure to hold.
    """
    names = {get_task(task).name for task in tasks}
    table_2 = table2_main(profile, max(seeds, default=-1) + 1, 0, episodes, most_timesteps)
    runs = [spec for spec in table_2
            if spec.training and spec.task in names and spec.method in methods and spec.seed in seeds]
    moving = Evaluation(layout="moving", episodes=episodes)
    return [*runs, *(spec.model_copy(update={"evaluation": tried}) for spec in runs
                     for tried in (_own(spec, own_episodes), moving))]


def _own(spec: RunSpec, episodes: int) -> Evaluation:
    sure = max(1, spec.collection.timesteps // EPISODE_STEPS)
    return Evaluation(layout="grasp", episodes=min(episodes, sure))


@checked
def rollouts(
    profile: str = "laptop", observation: Observation = "rgb", task: str = "pick-place", timesteps: Count = 20_000,
    episodes: Count = 100,
) -> list[RunSpec]:
    """The first seed's policies of table 2 on one task, whose episodes are shown as pictures."""
    return [_policy(get_task(task).name, method, 0, profile, observation, timesteps, Evaluation(episodes=episodes))
            for method in METHODS]


def _policy(
    task: str, method: str, seed: int, profile: str, observation: str, timesteps: int, evaluation: Evaluation
) -> RunSpec:
    """A policy trained and tried with the same factors random."""
    settings = load_profile(profile)
    return RunSpec(
        task=task, seed=seed, training=settings.recipe(observation, timesteps), evaluation=evaluation,
        collection=Collection(task=task, method=method, timesteps=timesteps, observation=observation,
                              image_size=settings.image_size, factors=evaluation.factors, jumping=_jumping(method)),
    )


def _jumping(method: str) -> Jumping:
    return ADC if method == "adc" else Jumping()


@checked
def keypoint_control(
    profile: str = "laptop", timesteps: tuple[Count, ...] = (1250, 2500, 5000), seeds: Count = 5, episodes: Count = 100
) -> list[RunSpec]:
    """Pick-Place with all factors random and perception given: three methods at several budgets, and the expert."""
    settings = load_profile(profile)
    evaluation = Evaluation(episodes=episodes)
    policies = [
        RunSpec(
            task="pick-place", seed=seed, training=settings.recipe("keypoints", budget), evaluation=evaluation,
            collection=Collection(task="pick-place", method=method, timesteps=budget, jumping=_jumping(method)),
        )
        for budget in timesteps
        for method in METHODS
        for seed in range(seeds)
    ]
    return policies + controls("pick-place", evaluation)


@checked
def table6_collection(profile: str = "laptop", attempts: Count = 100) -> list[RunSpec]:
    """What a demonstration costs: attempts by each expert, static, ADC and MOVE, on every task (table 6)."""
    load_profile(profile)
    return [
        RunSpec(task=task, seed=0, player="collector", evaluation=Evaluation(episodes=attempts),
                collection=Collection(task=task, method=method, timesteps=1, expert=expert, jumping=_jumping(method)))
        for expert in EXPERTS
        for task in TASKS
        for method in METHODS
    ]


@checked
def table_keypoint_control(
    profile: str = "laptop", timesteps: Count = 2500, seeds: Count = 3, episodes: Count = 100,
    larger: Count = 10_000, larger_tasks: tuple[str, ...] = ("assembly", "hammer", "basketball"),
) -> list[RunSpec]:
    """Every task from keypoints, three methods at one budget, between each task's floor and ceiling.

    The tasks that stay near their floor, `larger_tasks`, get a `larger` budget as well, alike for all methods.
    """
    settings, evaluation = load_profile(profile), Evaluation(episodes=episodes)
    policies = [
        RunSpec(task=task, seed=seed, training=settings.recipe("keypoints", budget), evaluation=evaluation,
                collection=Collection(task=get_task(task).name, method=method, timesteps=budget,
                                      jumping=_jumping(method)))
        for seed in range(seeds)
        for budget, tasks in ((timesteps, TASKS), (larger, larger_tasks))
        for task in tasks
        for method in METHODS
    ]
    return policies + [spec for task in TASKS for spec in controls(task, evaluation)]


@checked
def table_adc(
    profile: str = "laptop", pixel_tasks: tuple[str, ...] = tuple(TASKS), tasks: tuple[str, ...] = tuple(TASKS),
    periodic_tasks: tuple[str, ...] = ("pick-place", "window-open"), timesteps: Count = 2500, seeds: Count = 3,
    episodes: Count = 100, most_timesteps: Count = 20_000,
) -> list[RunSpec]:
    """Which reading of ADC is the stronger baseline: one seed from pixels at table 2's budget, `seeds` from keypoints.

    Jumps twice a phase are tried on `periodic_tasks` from keypoints, and on the first of them from pixels.
    """
    evaluation, runs = Evaluation(episodes=episodes), []
    for name, jumping in JUMPS.items():
        few = name == "periodic"
        seen = [task for task in pixel_tasks if not few or task in periodic_tasks[:1]]
        given = [task for task in tasks if not few or task in periodic_tasks]
        cells = [("rgb", task, min(get_task(task).timesteps, most_timesteps), 0) for task in seen]
        cells += [("keypoints", task, timesteps, seed) for task in given for seed in range(seeds)]
        for observation, task, budget, seed in cells:
            run = _policy(get_task(task).name, "adc", seed, profile, observation, budget, evaluation)
            runs.append(run.model_copy(update={"collection": run.collection.model_copy(update={"jumping": jumping})}))
    return runs


@checked
def fig_training_length(
    profile: str = "laptop", tasks: tuple[str, ...] = ("pick-place", "push", "window-open"),
    lengths: tuple[Multiple, ...] = (1 / 3, 1, 3), seeds: Count = 2, episodes: Count = 100,
    most_timesteps: Count = 20_000,
) -> list[RunSpec]:
    """Does MOVE minus static depend on how long one trains? The recipe's gradient steps times each of `lengths`.

    Policies of table 2, from pixels; nothing is chosen by the answer.
    """
    runs = [_policy(get_task(task).name, method, seed, profile, "rgb", min(get_task(task).timesteps, most_timesteps),
                    Evaluation(episodes=episodes))
            for seed in range(seeds) for task in tasks for method in ("static", "move")]
    return [run.model_copy(update={"training": run.training.model_copy(
                update={"gradient_steps": round(length * run.training.gradient_steps)})})
            for length in lengths for run in runs]


def controls(task: str, evaluation: Evaluation) -> list[RunSpec]:
    """The floor and the ceiling of a task: doing nothing, random actions, the expert told a wrong goal, the expert."""
    players = ["nothing", "random", "expert"] + (["goal-blind"] if TASKS[task].has_target else [])
    return [RunSpec(task=task, seed=0, player=player, evaluation=evaluation) for player in players]


EXPERIMENTS: dict[str, Callable[..., list[RunSpec]]] = {
    "fig1_sparse": fig1_sparse,
    "fig3_dense": fig3_dense,
    "fig5_circle": fig5_circle,
    "table1_spatial_factors": table1_spatial_factors,
    "table2_main": table2_main,
    "table_recipe": table_recipe,
    "generalization": generalization,
    "fig_training_length": fig_training_length,
    "table_adc": table_adc,
    "rollouts": rollouts,
    "keypoint_control": keypoint_control,
    "table6_collection": table6_collection,
    "table_keypoint_control": table_keypoint_control,
}


def parameters(experiment: str, profile: str) -> dict[str, Any]:
    """The parameters of `experiment` in `profile`: the function's own defaults and what the YAML changes.

    Raises:
        BadInput: an unknown experiment or parameter.
    """
    if experiment not in EXPERIMENTS:
        raise BadInput(f"figure: {experiment!r} given; allowed are {', '.join(EXPERIMENTS)}")
    defaults = {name: parameter.default
                for name, parameter in inspect.signature(EXPERIMENTS[experiment]).parameters.items()}
    changed = load_profile(profile).parameters(experiment)
    if unknown := set(changed) - set(defaults):
        raise BadInput(f"profile {profile}: {experiment} has no parameter {', '.join(sorted(unknown))}; "
                       f"allowed are {', '.join(defaults)}")
    return {**defaults, **changed, "profile": profile}


def specs(experiment: str, profile: str) -> list[RunSpec]:
    """The runs of `experiment` in `profile`.

    Raises:
        BadInput: an unknown experiment, profile or parameter, or a value that is not allowed.
    """
    chosen = parameters(experiment, profile)
    return EXPERIMENTS[experiment](**chosen)
