"""Values of a .toml scene that several of its tables share."""

from itertools import pairwise
from typing import Annotated, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Discriminator, Field, Tag

Unit = Literal["m", "cm", "mm", "in", "ft"]
Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]


def listed(value):
    """A list; one entry becomes a list of one."""
    return [value] if isinstance(value, (int, float, str)) else value


def _one_or_three(value: list[float]) -> list[float]:
    if len(value) not in (1, 3):
        raise ValueError(f"expected one number or [red, green, blue], not {len(value)} numbers")
    return value


def ascending(value: list[float]) -> list[float]:
    if any(one >= other for one, other in pairwise(value)):
        raise ValueError("expected edges between bands in micrometres, ascending")
    return value


def clear(value: float) -> float:
    if value >= 1:
        raise ValueError("expected a share below 1; what lets all light through is not there: leave the surface out")
    return value


def pointing(value: list[float]) -> list[float]:
    if not any(value):
        raise ValueError("expected a direction, not three zeros")
    return value


Bands = Annotated[list[NotNegative], BeforeValidator(listed), AfterValidator(_one_or_three)]
Emissivities = Annotated[list[Annotated[float, Field(gt=0, le=1)]], Field(min_length=1), BeforeValidator(listed)]
ALIKE, OF_SIDES = "alike", "of sides"  # emissivities: those of both sides together, or of each
EmissivitiesOfSides = Annotated[
    Annotated[Emissivities, Tag(ALIKE)]
    | Annotated[Annotated[dict[Literal["front", "back"], Emissivities], Field(min_length=1)], Tag(OF_SIDES)],
    Discriminator(lambda value: OF_SIDES if isinstance(value, dict) else ALIKE),
]
Point = Annotated[list[float], Field(min_length=3, max_length=3)]
Direction = Annotated[Point, AfterValidator(pointing)]


class Table(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)
