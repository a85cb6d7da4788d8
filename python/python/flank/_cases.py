"""What differs from case to case, as the native half takes it."""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from flank._errors import InputError
from flank._quantities import Quantity, amounts, count, is_real, text


def is_path(cases: Any) -> bool:
    """Whether cases stand in a file."""
    return isinstance(cases, str | os.PathLike)


def table(cases: Any) -> str:
    """A dictionary of columns, or a frame, as the text of a table. What is no number stays for the program to refuse.

    >>> from flank._cases import table
    >>> table({"m.E [mm]": [0, 0.1]})
    'm.E [mm]\\n0.0\\n0.1\\n'
    """
    if isinstance(cases, Mapping):
        columns = {str(head): values for head, values in cases.items()}
    elif hasattr(cases, "columns") and hasattr(cases, "__getitem__"):
        heads = list(cases.columns)
        twice = [head for k, head in enumerate(heads) if head in heads[:k]]
        if twice:
            raise InputError(f"`cases` has the column `{twice[0]}` twice: leave one out")
        columns = {str(head): cases[head] for head in heads}
    else:
        kind = type(cases).__name__
        raise InputError(f"`cases` is a {kind}: it is a dictionary of columns, a frame of pandas or polars, or the path of a CSV file")
    if not columns:
        raise InputError("`cases` has no column: write one for each parameter, for example `m.radial_distance [mm]`")
    cells = [_cells(head, values) for head, values in columns.items()]
    lengths = {head: len(of) for head, of in zip(columns, cells)}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"`{head}` has {length}" for head, length in lengths.items())
        raise InputError(f"columns of `cases` have different lengths: {told}")
    lines = [",".join(_plain(head) for head in columns), *(",".join(row) for row in zip(*cells))]
    return "\n".join([*lines, ""])


def _cells(head: str, values: Any) -> list[str]:
    if isinstance(values, str | bytes) or not hasattr(values, "__iter__"):
        raise InputError(f"column `{head}` of `cases` is {values!r}: write a list of numbers")
    return [_cell(value) for value in values]


def _cell(value: Any) -> str:
    """A number as the shortest text that is the same number."""
    try:
        return repr(float(value)) if is_real(value) else _plain(repr(value))
    except (TypeError, ValueError):
        return _plain(repr(value))


def _plain(words: str) -> str:
    """Without what separates cells, rows and remarks."""
    return re.sub(r"[,\s#]+", " ", words).strip() or "''"


@contextlib.contextmanager
def told() -> Iterator[None]:
    """Says rows of a table in memory by their number from 0, as its owner counts them, instead of lines."""

    def row(match: re.Match[str]) -> str:
        line = int(match[1])
        return f"`cases`, row {line - 2}: " if line > 1 else "`cases`: "

    try:
        yield
    except InputError as error:
        raise InputError(re.sub(r"^cases:(\d+): ", row, str(error), flags=re.M)) from None


def ranges(vary: Mapping[str, tuple[Quantity, Quantity, int]]) -> list[tuple[str, list[str], int]]:
    """Two ends and how many values of each."""
    all_of_them = []
    for name, wanted in vary.items():
        if not isinstance(wanted, tuple | list) or len(wanted) != 3:
            example = '("97.9 mm", "98.1 mm", 21)'
            raise InputError(f"`vary[{name!r}]` is {wanted!r}: write two ends and how many values, for example {example}")
        low, high, many = wanted
        all_of_them.append((name, [text(end, f"`vary[{name!r}]`") for end in (low, high)], count(many, f"vary[{name!r}]", 1, 100_000_000) or 1))
    if not all_of_them:
        raise InputError("`vary` names nothing that differs from case to case")
    return all_of_them


def distributions(scatter: Mapping[str, Any]) -> dict[str, Any]:
    """Standard deviations, and which of them are half widths instead."""
    for name, wanted in scatter.items():
        if _is_named(wanted) and wanted[0] not in ("normal", "uniform"):
            raise InputError(f"`scatter[{name!r}]` is {wanted!r}: it is 'normal' or 'uniform', with an amount")
    if not scatter:
        raise InputError("`scatter` names nothing that differs from case to case")
    uniform = [name for name, wanted in scatter.items() if _is_named(wanted) and wanted[0] == "uniform"]
    return {"scatter": amounts(sizes(scatter), "scatter"), "uniform": uniform}


def sizes(scatter: Mapping[str, Any]) -> dict[str, Quantity]:
    """How far each scatters, without how."""
    return {name: wanted[1] if _is_named(wanted) else wanted for name, wanted in scatter.items()}


def _is_named(wanted: Any) -> bool:
    return isinstance(wanted, tuple) and len(wanted) == 2 and isinstance(wanted[0], str)
