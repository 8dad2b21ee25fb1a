"""Option types that several commands share."""

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from . import amounts


def _by(parse):
    def converter(_, tokens):
        return parse(tokens[0].value)

    return converter


def _point(text: str) -> str:
    amounts.numbers(text, 3)
    return text


def _pair(text: str) -> str:
    amounts.numbers(text, 2)
    return text


def _seed(text: str) -> int:
    return amounts.count(text, least=0)


Count = Annotated[int | None, Parameter(converter=_by(amounts.count))]
Seed = Annotated[int, Parameter(converter=_by(_seed))]
Stops = Annotated[float | None, Parameter(converter=_by(amounts.stops))]
DeviceName = Literal["auto", "cpu", "cuda"]
Seconds = Annotated[float | None, Parameter(converter=_by(amounts.seconds))]
Share = Annotated[float | None, Parameter(converter=_by(amounts.share))]
Length = Annotated[float | None, Parameter(converter=_by(amounts.length))]
Height = Annotated[float | None, Parameter(converter=_by(amounts.height), allow_leading_hyphen=True)]
Density = Annotated[float | None, Parameter(converter=_by(amounts.density))]
Point = Annotated[str | None, Parameter(converter=_by(_point), allow_leading_hyphen=True)]  # -1,0,2 is a point, not an option
Pair = Annotated[str | None, Parameter(converter=_by(_pair), allow_leading_hyphen=True)]
Chosen = Annotated[bool | None, Parameter(negative=(), show_default=False)]
Flag = Annotated[bool, Parameter(negative=(), show_default=False)]
Outputs = Annotated[
    tuple[Path, ...], Parameter(name=["--output", "-o"], consume_multiple=(1, None), negative=(), show_default=False)
]
Folder = Annotated[Path, Parameter(name=["--output", "-o"])]
