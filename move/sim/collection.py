"""What to collect, as data: everything that decides a data set but for the seed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Annotated, Any, Self

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationInfo, field_validator, model_validator

from move.choices import Drawing, ExpertName, Place, Protocol, SpeedLaw
from move.sim.methods import METHODS, single_methods
from move.sim.motion.adc import Jumping
from move.sim.motion.wrappers import PARTS, SPEEDS, Motions, Part, movable
from move.sim.observe import IMAGE_SIZE, ObservationKind, ObservationSpec
from move.sim.placement import Placement
from move.sim.tasks import FACTORS, TASKS, Task, get_task

ANY_HAND = "object+hand"  # the factors under which a prescribed grasp is begun anywhere in the hand's range
FASTEST = 0.3  # metres per step: across the object's range in one step
FASTEST_TURN = math.radians(20)  # radians per step: a half circle in nine steps
Speed = Annotated[float, Field(gt=0, le=FASTEST, allow_inf_nan=False)]
Share = Annotated[float, Field(gt=0, lt=1, allow_inf_nan=False)]
Turn = Annotated[float, Field(gt=0, le=FASTEST_TURN, allow_inf_nan=False)]


def _single(method: str) -> str:
    """Refuse what is no method, or a mixture itself."""
    if method not in single_methods():
        raise ValueError(f"allowed are {', '.join(single_methods())}")
    return method


class Collection(BaseModel):
    """Everything that decides a data set, but for the seed.

    A motion that is chosen as it is anyway counts as not chosen, so that the same data have one hash.
    """

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid")

    task: str = Field(description="a name in move.sim.tasks.TASKS")
    method: str = Field(description="how it is collected: a name in move.sim.methods.METHODS")
    timesteps: int = Field(gt=0, le=10**8, description="the budget, in steps of the environment")
    observation: ObservationKind = Field(default="keypoints", description="what is kept of each timestep")
    image_size: int = Field(default=IMAGE_SIZE, ge=16, le=512, description="pixels along a side")
    factors: str = Field(default="all", description="what is random: a name in move.sim.tasks.FACTORS")
    protocol: Protocol = Field(default="random", description="where it grasps")
    placement: Placement | None = Field(default=None, description="the places of the protocol placed")
    demonstrations: int | None = Field(
        default=None, gt=0, le=10**6, description="after how many it ends, though the budget is not full; None: then"
    )
    expert: ExpertName = Field(default="phase", description="who demonstrates")
    motions: Motions = Field(default=Motions(), description="MOVE's motions before the choices below")
    jumping: Jumping = Field(default=Jumping(), description="when ADC's object and target jump")
    keep_failures: bool = Field(default=False, description="whether failed demonstrations are kept too")
    hand_spread: float = Field(
        default=0.0, ge=0, allow_inf_nan=False, description="metres; half-side of the box around the task's fixed hand "
        "in which the hand starts where the grasp point is prescribed, within the hand's limits; 0: all start alike"
    )
    fixed: Place = Field(default="package", description="whose camera and target, where they are not random")
    drawing: Drawing = Field(
        default="plain", description="of images; full: with shadows, reflections, sky and multisampling"
    )
    object_steps: int | None = Field(
        default=None, gt=0, le=200, description="how long the object moves, in steps; None: as the task says"
    )
    shares: tuple[tuple[Annotated[str, AfterValidator(_single)], Share], ...] = Field(
        default=(), description="of a mixture: each method's share of the timesteps, sum 1; a mapping may be given"
    )
    moving: tuple[Part, ...] | None = Field(default=None, description="what moves; None: all that the method can move")
    object_speed: Speed | None = Field(default=None, description="the largest; metres per step; None: that of motions")
    target_speed: Speed | None = Field(default=None, description="the same of the target")
    camera_speed: Turn | None = Field(default=None, description="the same of the camera; radians per step")
    yaw_speed: Turn | None = Field(
        default=None, description="the same of the object's rotation; radians per step, before the task's scale"
    )
    speed_law: SpeedLaw | None = Field(
        default=None, description="how an episode draws each speed below the largest; None: that of motions"
    )

    @field_validator("task", "method", "factors")
    @classmethod
    def _known(cls, name: str, info: ValidationInfo) -> str:
        tables: dict[str, Iterable[str]] = {"task": TASKS, "method": METHODS, "factors": FACTORS}
        known = list(tables[str(info.field_name)])
        if name not in known:
            raise ValueError(f"allowed are {', '.join(known)}")
        return name

    @field_validator("shares", "moving", mode="before")
    @classmethod
    def _as_yaml_and_json_write_it(cls, value: Any) -> Any:
        if isinstance(value, Mapping):
            return tuple(value.items())
        if isinstance(value, list):
            return tuple(tuple(item) if isinstance(item, list) else item for item in value)
        return value

    @field_validator("shares")
    @classmethod
    def _in_the_order_of_methods(cls, shares: tuple[tuple[str, float], ...]) -> tuple[tuple[str, float], ...]:
        return tuple(sorted(shares, key=lambda share: list(METHODS).index(share[0])))

    @field_validator("moving", *SPEEDS.values(), "speed_law")
    @classmethod
    def _of_what_moves(cls, value: Any, info: ValidationInfo) -> Any:
        if value is None or not {"task", "method", "factors", "motions", "shares"} <= info.data.keys():
            return value  # the first problem is an earlier field's
        name, able = str(info.field_name), _able_to_move(info.data)
        if name == "moving":
            if not value or len(set(value)) < len(value) or set(value) - set(able):
                raise ValueError(f"{', '.join(value) or 'nothing'} given; allowed are one or more of "
                                 f"{', '.join(able)}, each once")
            return None if set(value) == set(able) else tuple(part for part in able if part in value)
        able = info.data.get("moving") or able
        part = next((part for part, field in SPEEDS.items() if field == name), None)
        if part and part not in able:
            raise ValueError(f"the {part} does not move; allowed are speeds of {', '.join(able)}")
        return None if value == getattr(Motions(), name) else value

    @model_validator(mode="after")
    def _nothing_without_effect(self) -> Self:
        if self.hand_spread and (self.protocol == "random" or self.factors == ANY_HAND):
            raise ValueError(f"hand_spread {self.hand_spread} with protocol {self.protocol!r} and factors "
                             f"{self.factors!r}; allowed there is 0, for the hand's start is one of the factors")
        if (self.placement is None) == (self.protocol == "placed"):
            raise ValueError(f"placement {'none' if self.placement is None else 'given'} with protocol "
                             f"{self.protocol!r}; allowed is one with 'placed', and with it alone")
        if self.demonstrations and self.shares:
            raise ValueError("demonstrations given for a mixture; allowed is its budget of timesteps")
        if self.drawing != "plain" and self.observation != "rgb":
            raise ValueError(f"drawing {self.drawing!r} with keypoints; allowed with rgb")
        self.scene_task  # noqa: B018, refuses places that are not known
        for name, default in _without_effect(self.method, *self.methods).items():
            if getattr(self, name) != default:
                allowed = [method.name for method in METHODS.values() if name in method.settings]
                raise ValueError(f"{name} given for method {self.method!r}; allowed with {', '.join(allowed)}")
        return self

    @model_validator(mode="after")
    def _shares_make_a_whole(self) -> Self:
        if METHODS[self.method].wrap:
            return self
        names = [name for name, _ in self.shares]
        if len(names) < 2 or len(set(names)) < len(names):
            raise ValueError(f"a mixture of {', '.join(names) or 'nothing'}; allowed are shares of two methods or more")
        if not math.isclose(total := math.fsum(share for _, share in self.shares), 1, abs_tol=1e-9):
            raise ValueError(f"shares add up to {total:g}; allowed is 1")
        if min(steps := self._steps()) < 1:
            raise ValueError(f"shares give {', '.join(map(str, steps))} of {self.timesteps} timesteps; allowed is one "
                             "each at least")
        return self

    @property
    def observed(self) -> ObservationSpec:
        """What is kept of each timestep, with the size of an image."""
        return ObservationSpec(self.observation, self.image_size, self.drawing)

    @property
    def scene_task(self) -> Task:
        """The task with the places and the steps of this collection."""
        return get_task(self.task).variant(self.fixed, self.object_steps)

    @property
    def methods(self) -> tuple[str, ...]:
        """The methods of its parts: one, but for a mixture."""
        return tuple(name for name, _ in self.shares) or (self.method,)

    @property
    def parts(self) -> tuple[Collection, ...]:
        """The collections that it is made of: of a mixture one a method, with its share of the timesteps; else itself.

        Shares are rounded down to whole timesteps; the last part has the rest.
        """
        if not self.shares:
            return (self,)
        return tuple(self.model_copy(update={**_without_effect(name), "method": name, "timesteps": steps})
                     for name, steps in zip(self.methods, self._steps(), strict=True))

    def _steps(self) -> list[int]:
        first = [math.floor(share * self.timesteps + 1e-9) for _, share in self.shares[:-1]]
        return [*first, self.timesteps - sum(first)]

    @property
    def motions_used(self) -> Motions:
        """The motions with the choices of this collection: their law, the largest speeds, 0 of what stands still."""
        chosen = {name: value for name in (*SPEEDS.values(), "speed_law") if (value := getattr(self, name)) is not None}
        moves = METHODS[self.method].moves
        still = {SPEEDS[part]: 0.0 for part in PARTS if part not in moves or part not in (self.moving or moves)}
        return self.motions.model_copy(update=chosen | still)


def _without_effect(*methods: str) -> dict[str, Any]:
    """The fields of a collection that none of some methods reads, though others do, with their defaults."""
    read = {name for method in methods for name in METHODS[method].settings}
    fields = dict.fromkeys(name for method in METHODS.values() for name in method.settings if name not in read)
    return {name: Collection.model_fields[name].default for name in fields}


def _able_to_move(chosen: dict[str, Any]) -> tuple[Part, ...]:
    """What moves at speeds that may be chosen, in a collection of which the first fields are."""
    methods = [name for name, _ in chosen["shares"]] or [chosen["method"]]
    moves = {part for name in methods for part in METHODS[name].moves}
    if not moves:
        allowed = [method.name for method in METHODS.values() if method.moves]
        raise ValueError(f"nothing moves at a speed under {' and '.join(methods)}; allowed with {', '.join(allowed)}")
    if chosen["motions"] != Motions():
        raise ValueError("motions are given too; allowed is one of the two")
    return tuple(part for part in movable(get_task(chosen["task"]), chosen["factors"]) if part in moves)
