"""Arguments of jobs as the native half takes them."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from flank._errors import InputError
from flank._points import Floats
from flank._quantities import Quantity, errors, names, text

Path_ = str | os.PathLike[str]
R = TypeVar("R")
T = TypeVar("T")


def single(found: dict[str, R], what: str) -> R:
    """The one of some results."""
    if len(found) != 1:
        raise InputError(f"the job has several: name one {what} of {', '.join(found)}")
    return next(iter(found.values()))


def margin_shares(margin: tuple[float, float] | None) -> list[float] | None:
    """What is left out at each end of a grid."""
    if margin is None:
        return None
    shares = [float(share) for share in margin]
    if len(shares) != 2 or not all(0 <= share < 0.5 for share in shares):
        raise InputError(f"`margin` is {margin!r}: write two shares from 0 up to 0.5, from root to tip and along the tooth")
    return shares


def several(value: Sequence[T], what: str, *of: str) -> Sequence[T]:
    """As many values as there are things."""
    if not isinstance(value, tuple | list) or len(value) != len(of):
        raise InputError(f"`{what}` is {value!r}: write {len(of)} values, {', '.join(of[:-1])} and {of[-1]}")
    return value


def mounting_errors(values: Mapping[str, Quantity] | None) -> list[tuple[str, str, float]]:
    """Axes with how far they are off."""
    return errors(values or {}, "errors")


def ranges(values: Mapping[str, tuple[Quantity, Quantity]] | None) -> list[tuple[str, list[str]]]:
    """Settings with the two values that they may lie between.

    >>> from flank._arguments import ranges
    >>> ranges({"mill.work_z": ("20 mm", (120, "mm"))})
    [('mill.work_z', ['20 mm', '120 mm'])]
    """
    for name, ends in (values or {}).items():
        if not isinstance(ends, tuple | list) or len(ends) != 2:
            raise InputError(f"`clamp[{name!r}]` is {ends!r}: write two values, (\"20 mm\", \"120 mm\")")
    return [(name, [text(end, f"`clamp[{name!r}]`") for end in ends]) for name, ends in (values or {}).items()]


def chosen(value: str, what: str, known: tuple[str, ...]) -> str:
    """One of some words."""
    if value not in known:
        raise InputError(f"`{what}` is {value!r}: it is {' or '.join(known)}")
    return value


def correlation(value: float) -> float:
    """A number above -1 and below 1."""
    if not -1 < value < 1:
        raise InputError(f"a correlation is {value!r}: it is above -1 and below 1")
    return float(value)


def kept(keep: Mapping[str, str] | Iterable[str]) -> list[tuple[str, bool]]:
    """Surfaces that stay, each with whether it is kept along a line."""
    if isinstance(keep, Mapping):
        return [(name, chosen(place, "keep", ("middle", "line")) == "line") for name, place in keep.items()]
    return [(name, False) for name in names(keep)]


def parabola(wish: Mapping[str, float | tuple[float, float]]) -> list[float]:
    """A wanted ease-off: slopes, crownings, bias."""
    unknown = set(wish) - {"slope", "crowning", "bias"}
    if unknown:
        raise InputError(f"`ease_off` has `{sorted(unknown)[0]}`: it has slope, crowning and bias, um")

    def both(key: str) -> list[float]:
        value = wish.get(key, (0.0, 0.0))
        if not isinstance(value, tuple | list) or len(value) != 2:
            raise InputError(f"`ease_off` {key} is {value!r}: write two numbers, from root to tip and along the tooth, um")
        return [float(of) for of in value]

    bias = wish.get("bias", 0.0)
    if isinstance(bias, tuple | list):
        raise InputError(f"`ease_off` bias is {bias!r}: write one number, um")
    return [*both("slope"), *both("crowning"), float(bias)]


def positions(of: npt.ArrayLike, what: str) -> Floats:
    """Measured positions (rows, columns, 3), mm; NaN where nothing was measured, which a mask says as well."""
    try:
        # of an array in whatever coat, also of a list of rows with masks of their own
        given: np.ma.MaskedArray[Any, np.dtype[Any]] = np.ma.array(of, copy=False)
        if np.iscomplexobj(given):
            raise InputError(f"`{what}` is complex: measured positions are real numbers, mm")
        xyz: Floats = np.ma.filled(given.astype(float), np.nan)
    except (TypeError, ValueError) as error:
        raise InputError(f"`{what}` is no array of numbers: {error}") from None
    if xyz.ndim != 3 or xyz.shape[2] != 3:
        raise InputError(f"measured positions are an array of shape (rows, columns, 3), mm: not {xyz.shape}")
    return xyz


class Measured:
    """A file of measured points: as it is, or made of positions for as long as it is needed."""

    def __init__(self, of: Path_ | npt.ArrayLike | None, what: str = "measured") -> None:
        self._what = what
        self._path: str | None = None
        self._xyz: Floats | None = None
        if isinstance(of, str | os.PathLike):
            self._path = os.fspath(of)
        elif of is not None:
            self._xyz = positions(of, what)
        self._folder: tempfile.TemporaryDirectory[str] | None = None

    @property
    def counts(self) -> tuple[int | None, int | None]:
        """Rows and columns of positions, also where the last ones were not measured; what a file has is found out by its reader."""
        return (None, None) if self._xyz is None else (self._xyz.shape[0], self._xyz.shape[1])

    def __enter__(self) -> tuple[str | None, str]:
        if self._xyz is None:
            return self._path, ""
        is_measured = np.isfinite(self._xyz).all(axis=-1)
        if not is_measured.any():
            raise InputError(f"`{self._what}` has no point that was measured: in each of {is_measured.size}, x, y or z is NaN or masked")
        self._folder = tempfile.TemporaryDirectory(prefix="flank-")
        file = Path(self._folder.name) / "measured.csv"
        lines = [f"{i + 1},{j + 1},{','.join(repr(float(x)) for x in self._xyz[i, j])}" for i, j in np.argwhere(is_measured)]
        file.write_text("\n".join(["row,column,x,y,z", *lines, ""]))
        return str(file), self._folder.name

    def __exit__(self, *_: object) -> None:
        if self._folder is not None:
            self._folder.cleanup()

    def named(self, words: str) -> str:
        """A message about the file of positions as one about the array, whose owner counts from 0."""
        if self._folder is None:
            return words
        file = str(Path(self._folder.name) / "measured.csv")

        def place(match: re.Match[str]) -> str:
            return f"`{self._what}[{int(match[1]) - 1}, {int(match[2]) - 1}]` "

        words = re.sub(rf"{re.escape(file)}(?::\d+)?: row (\d+), column (\d+) ", place, words)
        return words.replace(file, f"`{self._what}`")
