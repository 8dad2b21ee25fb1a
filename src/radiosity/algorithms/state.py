"""States of algorithms as typed records: what is needed to continue, and to read results.

A record is a frozen dataclass. Each field states the axes of its array (`array`) or the type of its number (`number`), so that
arrays of a file can be checked, and the rule that joins it with those of other replicates (`merging`). Files and
`Solution.state` hold the same arrays by name.
"""

from abc import abstractmethod
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar, Self

import numpy as np

from ..solution.books import exact_sum, exact_totals

Arrays = Mapping[str, np.ndarray]
KINDS = {int: "iu", float: "fiu", bool: "b", np.ndarray: "biuf"}  # of arrays that fields are made of
COUNTS, WHOLE = "u", "i"  # kinds of arrays of counts and of signed whole numbers
UPPER = "_upper"  # end of the names of optional arrays that hold the upper words of others, which are modulo 2^64


@dataclass(frozen=True)
class Sizes:
    """The numbers of replicates, of rows of a replicate (patches, then lights) and of groups of bands."""

    replicates: int
    rows: int
    groups: int

    def shape(self, axes: tuple[str | int, ...]) -> tuple[int, ...]:
        """Return the lengths of axes; -1 for "any". A slot is a row, or counts what escaped or was lost (see `LineTracer`)."""
        lengths = {
            "replicates": self.replicates,
            "rows": self.rows,
            "groups": self.groups,
            "slots": self.replicates * (self.rows + 2),
            "rows of halves": 2 * self.replicates * self.rows,
            "any": -1,
        }
        return tuple(axis if isinstance(axis, int) else lengths[axis] for axis in axes)


@dataclass(frozen=True)
class Layout:
    """The layout of an array.

    Attributes:
        axes: names or lengths of the axes.
        flat: True where the array has one axis, which runs through all of ``axes``.
    """

    axes: tuple[str | int, ...]
    flat: bool = False

    def fits(self, value: np.ndarray, sizes: Sizes) -> bool:
        """Return whether an array has this layout."""
        shape = sizes.shape(self.axes)
        if self.flat:
            known = abs(int(np.prod(shape)))
            return value.ndim == 1 and (value.size == known if -1 not in shape else value.size > 0 and value.size % known == 0)
        return len(shape) == value.ndim and all(wanted in (-1, have) for wanted, have in zip(shape, value.shape, strict=True))


Rule = Callable[[Layout | None, list, list[Any]], Any]  # layout, values of all states, and the records that have them


def array(
    *axes: str | int,
    flat: bool = False,
    optional: bool = False,
    merged: Rule | None = None,
    zeros: bool = False,
    kinds: str = KINDS[np.ndarray],
) -> Any:
    """Return a field that holds an array. Without a rule, states are joined along the replicates.

    Args:
        zeros: where the array is left out, all of it is zero.
        kinds: of numbers, as numpy names them.
    """
    facts = {"layout": Layout(axes, flat), "merged": merged, "zeros": zeros, "kinds": kinds}
    return field(**_default(optional), metadata=facts)


def number(kind: type, *, optional: bool = False, merged: Rule | None = None) -> Any:
    """Return a field that holds an int, a float or a bool. Without a rule, all merged states have the same value."""
    return field(**_default(optional), metadata={"kind": kind, "merged": merged})


def part(kind: type["Record"], prefix: str = "", *, optional: bool = False) -> Any:
    """Return a field that holds another record, whose arrays have names with a prefix."""
    return field(**_default(optional), metadata={"record": kind, "prefix": prefix})


def _default(optional: bool) -> dict:
    return {"default": None} if optional else {}


@dataclass(frozen=True, eq=False, kw_only=True)
class Record:
    """Arrays and numbers that belong together; a missing optional field is None."""

    sizes: Sizes

    def arrays(self) -> dict[str, np.ndarray]:
        """Return all arrays by name, not copied; numbers are arrays without axes."""
        found: dict[str, np.ndarray] = {}
        for one in fields(self)[1:]:
            value = getattr(self, one.name)
            if isinstance(value, Record):
                found |= {one.metadata["prefix"] + name: more for name, more in value.arrays().items()}
            elif value is not None:
                found[one.name] = np.asarray(value)
        return found

    def about(self, name: str, at: Any = ...) -> np.ndarray:
        """Return an array of words at some places: as it is, or in double precision where it has upper words."""
        low, upper = getattr(self, name)[at], getattr(self, name + UPPER)
        return low if upper is None else low + upper[at] * 2.0**64

    def exact(self, name: str, at: Any = ...) -> int:
        """Return the sum of an array of words at some places, without rounding."""
        low, upper = getattr(self, name)[at], getattr(self, name + UPPER)
        return exact_sum(low) + (0 if upper is None else exact_sum(upper[at]) << 64)

    def totals(self, name: str, at: Any, weight: np.ndarray) -> tuple[int, int]:
        """Return the sum of an array of words, and that of its products with weights, uint32, see `exact_totals`."""
        low, upper = getattr(self, name)[at], getattr(self, name + UPPER)
        total, weighted = exact_totals(low, weight)
        if upper is None:
            return total, weighted
        more, of_more = exact_totals(upper[at], weight)
        return total + (more << 64), weighted + (of_more << 64)

    @classmethod
    def read(cls, arrays: Arrays, sizes: Sizes, wanted: Collection[str] = (), prefix: str = "") -> Self:
        """Return the record from complete arrays. An optional field is read where it is wanted, or all of it is there."""
        values: dict[str, Any] = {"sizes": sizes}
        for one in fields(cls)[1:]:
            facts = one.metadata
            if not _taken(one, arrays, wanted, prefix):
                continue
            if "record" in facts:
                values[one.name] = facts["record"].read(arrays, sizes, prefix=prefix + facts["prefix"])
            else:
                value = arrays[prefix + one.name]
                values[one.name] = facts["kind"](value) if "kind" in facts else value
        return cls(**values)

    @classmethod
    def lacking(cls, arrays: Arrays, sizes: Sizes, wanted: Collection[str] = (), prefix: str = "") -> str:
        """Return what is missing, "other sizes or types" where arrays have other ones, or "" where `read` finds all."""
        missing = cls.missing(arrays, wanted, prefix)
        return ", ".join(missing) or ("" if cls.fits(arrays, sizes, wanted, prefix) else "other sizes or types")

    @classmethod
    def missing(cls, arrays: Arrays, wanted: Collection[str] = (), prefix: str = "") -> list[str]:
        """Return the names of arrays that are needed and missing, in order."""
        found = []
        for one in fields(cls)[1:]:
            needed = one.default is not None or one.name in wanted
            if needed and "record" in one.metadata:
                found += one.metadata["record"].missing(arrays, prefix=prefix + one.metadata["prefix"])
            elif needed and prefix + one.name not in arrays:
                found.append(prefix + one.name)
        return sorted(found)

    @classmethod
    def fits(cls, arrays: Arrays, sizes: Sizes, wanted: Collection[str] = (), prefix: str = "") -> bool:
        """Return whether all arrays that are there have their shape, and hold numbers of their kind."""
        for one in fields(cls)[1:]:
            facts = one.metadata
            if not _taken(one, arrays, wanted, prefix):
                continue
            if "record" in facts:
                if not facts["record"].fits(arrays, sizes, prefix=prefix + facts["prefix"]):
                    return False
                continue
            value, kinds = np.asarray(arrays[prefix + one.name]), facts["kinds"] if "kinds" in facts else KINDS[facts["kind"]]
            if value.dtype.kind not in kinds or not facts.get("layout", Layout(())).fits(value, sizes):
                return False
        return True


def _taken(one: Any, arrays: Arrays, wanted: Collection[str], prefix: str) -> bool:
    if one.default is not None or one.name in wanted:
        return True
    if "record" in one.metadata:
        return not one.metadata["record"].missing(arrays, prefix=prefix + one.metadata["prefix"])
    return prefix + one.name in arrays


@dataclass(frozen=True, eq=False, kw_only=True)
class AbstractState(Record):
    """What an algorithm needs to continue, and its tally to read results.

    Attributes:
        quanta: N of the stage that began last.
        alone: the reason why no states of other replicates can be merged with it; "" where they can.
        splits_within: True where a state within a stage can be split into those of parts of its replicates (`splitting`).
    """

    alone: ClassVar[str] = ""
    splits_within: ClassVar[bool] = False

    quanta: int = number(int)

    @property
    @abstractmethod
    def unfinished(self) -> bool:
        """True where the state was captured within a stage."""
