"""What results remember of how they were asked for: enough to ask again, and nothing that a pickle cannot hold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from flank._arguments import Measured
from flank._errors import InputError

if TYPE_CHECKING:
    from flank._flank import Answer
    from flank._job import Job

Operation = Callable[..., Any]


@dataclass(frozen=True, slots=True)
class Asked:
    """An operation on a job: `names` stand before its options, the job of another surface behind them. Calling it asks with second_
    options."""

    operation: Operation
    job: Job
    options: dict[str, Any]
    names: tuple[str, ...] = ()
    other: Job | None = None
    place: int | None = None
    """Of the result among those of the operation; none where it has one."""

    def __call__(self, more: dict[str, Any]) -> Answer:
        behind = () if self.other is None else (self.other._native,)
        found = self.operation(self.job._native, *self.names, {**self.options, **more}, *behind)
        answer: Answer = found if self.place is None else found[self.place]
        return answer


@dataclass(frozen=True, slots=True)
class AskedOfMeasured:
    """The same about measured points, which are files for as long as the operation works."""

    asked: Asked
    measured: Any
    also: tuple[str, Any] | None = None

    def told(self, more: dict[str, Any]) -> tuple[Answer, str]:
        """The answer, and the folder that its texts name and that is gone."""
        first, second = Measured(self.measured), Measured(None if self.also is None else self.also[1], "also")
        with first as (file, inside), second as (other, _):
            files = {"measured": file, "and": None if self.also is None else (self.also[0], other)}
            try:
                return self.asked({**files, **more}), inside
            except InputError as error:
                raise InputError(second.named(first.named(str(error)))) from None

    def __call__(self, more: dict[str, Any]) -> Answer:
        return self.told(more)[0]
