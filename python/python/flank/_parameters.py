"""Parameters and settings of jobs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from flank import _display
from flank._errors import UnknownName


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter or a setting of a job."""

    name: str
    value: float
    """In its unit."""
    unit: str
    """`mm`, `deg`, products of mm and rad; empty for a plain number."""
    range: tuple[float, float] | None
    """Between which values it must lie, if that is stated."""
    step: float | None
    """What it is set in multiples of, if that is stated."""
    doc: str
    given_by: str
    """`the job`, `the caller`, or the machine or tool whose own value it is."""
    is_count: bool
    is_error: bool
    """Whether it says how a machine differs from the nominal one, in which it is zero."""

    def __repr__(self) -> str:
        return f"Parameter({self.shown}, given by {self.given_by})"

    @property
    def shown(self) -> str:
        """The value with its unit."""
        value = int(self.value) if self.is_count else self.value
        return f"{value!r} {self.unit}".strip()


class Parameters(Mapping[str, Parameter]):
    """The parameters and settings of a job by their names, each after those that it depends on."""

    def __init__(self, all_of_them: Iterable[Parameter]) -> None:
        self._all = {of.name: of for of in all_of_them}

    def __getitem__(self, name: str) -> Parameter:
        if name in self._all:
            return self._all[name]
        raise UnknownName(f"there is no parameter `{name}`; there is: {', '.join(self._all)}")

    def __iter__(self) -> Iterator[str]:
        return iter(self._all)

    def __len__(self) -> int:
        return len(self._all)

    def _rows(self) -> list[list[str]]:
        def row(of: Parameter) -> list[str]:
            ends = "" if of.range is None else " .. ".join(f"{end:g}" for end in of.range)
            return [of.name, of.shown, ends, of.given_by, " ".join(of.doc.split())]

        return [row(of) for of in self._all.values()]

    def __repr__(self) -> str:
        return _display.aligned(self._rows())

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:
        head = ["name", "value", "range", "given by", "meaning"]
        return {"text/plain": repr(self), "text/html": _display.table(self._rows(), head)}


def parameter(
    name: str,
    value: float,
    unit: str,
    ends: tuple[float, float] | None,
    step: float | None,
    doc: str,
    giver: str | None,
    is_count: bool,
    is_error: bool,
) -> Parameter:
    """A parameter as the native half tells it."""
    given_by = "the caller" if giver is None else giver or "the job"
    return Parameter(name, value, unit, ends, step, doc, given_by, is_count, is_error)
