"""Quantities: `"98.1 mm"`, `(98.1, "mm")`, a quantity of pint, and bare numbers where a number has no unit."""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from flank import _flank
from flank._errors import InputError, SpecError, of_dimension

Quantity = Any
"""A text with a unit, a pair of number and unit, a quantity of pint, or a number."""

Amount = tuple[str, str, float]
"""A name, the kind of an amount, and its size: mm, radians, a number or a share."""

_LIKE = {"length": ("mm", "a length"), "angle": ("deg", "an angle"), "number": ("", "a number"), "share": ("%", "a share")}
_TEXT = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\S*)\s*")


def encodable(words: str, what: str) -> str:
    """A text that can be a file: half of a surrogate pair is no character."""
    if not isinstance(words, str):
        raise InputError(f"{what} is a text: not {words!r}")
    half = next((k for k, character in enumerate(words) if "\ud800" <= character <= "\udfff"), None)
    if half is not None:
        raise InputError(f"{what} holds {words[half]!r} at index {half}, which is half of a surrogate pair and no character")
    return words


def given(values: Mapping[str, Quantity]) -> dict[str, str]:
    """Settings with their values in the words of the language."""
    return {_name(name): text(value, f"`{name}`") for name, value in values.items()}


def _name(name: Any) -> str:
    return encodable(name, "the name of a parameter or setting")


def text(value: Quantity, what: str = "a value") -> str:
    """A quantity in the words of the language, which says what is wrong with it.

    >>> from flank._quantities import text
    >>> text((98.1, "mm")), text("98.1 mm"), text(17)
    ('98.1 mm', '98.1 mm', '17')
    """
    if isinstance(value, str):
        return encodable(value, what)
    if isinstance(value, tuple) and len(value) == 2:
        return f"{_number(value[0], what)} {encodable(value[1], f'the unit of {what}')}"
    if hasattr(value, "magnitude") and hasattr(value, "units"):
        return _of_pint(value, what)
    return _number(value, what)


def _number(value: Any, what: str) -> str:
    if not is_real(value):
        raise InputError(f"{what} is a text with a unit, a pair of number and unit, or a number: not {value!r}")
    number = float(value)
    if not math.isfinite(number):
        raise InputError(f"{what} is a finite number: not {value!r}")
    return str(int(number)) if number.is_integer() and abs(number) < 1e15 else repr(number)


def is_real(value: Any) -> bool:
    """Whether a value is one real number: no text, no array of several, no complex number, no masked one.

    >>> from flank._quantities import is_real
    >>> import numpy as np
    >>> [is_real(of) for of in (1, np.float32(2), np.array(3), True, "4", np.zeros(1), 5 + 0j, np.complex128(6), np.ma.masked)]
    [True, True, True, False, False, False, False, False, False]
    """
    is_number = hasattr(value, "__float__") and not isinstance(value, str | bool | np.bool_)
    return is_number and np.ndim(value) == 0 and not np.iscomplexobj(value) and not np.ma.is_masked(value)


def _of_pint(value: Any, what: str) -> str:
    # percent and um/mm are numbers, degrees are not
    root = value.to_root_units()
    powers = dict(root.unit_items())
    if not powers.keys() <= {"meter", "radian"} or any(power != int(power) for power in powers.values()):
        raise InputError(f"a length, an angle, a number or products of them are wanted: not {value}")
    size = float(root.magnitude) * 1e3 ** powers.get("meter", 0)
    if powers == {"meter": 1}:
        # as near as the unit itself leads
        size = value.to("mm").magnitude
    return f"{_number(size, what)} {_product(int(powers.get('meter', 0)), int(powers.get('radian', 0)))}".strip()


def _product(of_length: int, of_angle: int) -> str:
    """Powers of mm and rad as one unit of the language: `rad/mm`, `mm^-1`; nothing for a number.

    >>> from flank._quantities import _product
    >>> _product(1, 0), _product(-2, 1), _product(-1, 0), _product(0, 0)
    ('mm', 'rad/mm^2', 'mm^-1', '')
    """
    named = [(name, power) for name, power in (("mm", of_length), ("rad", of_angle)) if power]
    above = [(name, power) for name, power in named if power > 0]
    raised = [name if power == 1 else f"{name}^{power}" for name, power in above or named]
    below = [name if power == -1 else f"{name}^{-power}" for name, power in named if power < 0 and above]
    return "/".join(["*".join(raised), *below])


def _unit(name: str) -> tuple[str, float] | None:
    """What a unit is one of, and its size in mm, radians or 1; `None` if the language has no such unit."""
    if name in ("", "%"):
        return ("share", 1e-2) if name else ("number", 1.0)
    found = _flank.unit_size(name)
    if found is None:
        return None
    of_length, of_angle, size = found
    known = {(1, 0): "length", (0, 1): "angle", (0, 0): "number"}
    # a product of units by its powers of length and angle: 1/mm is "-1,0"
    return known.get((of_length, of_angle), f"{of_length},{of_angle}"), size


def _parsed(value: Quantity, what: str, example: str) -> tuple[str, float]:
    words = text(value, f"`{what}`")
    match = _TEXT.fullmatch(words)
    unit = _unit(match[2]) if match else None
    if match is None or unit is None:
        known = ", ".join(_flank.units())
        raise InputError(f"`{what}` is `{words}`: write a number with a unit, for example {example}; units are {known}")
    return unit[0], float(match[1]) * unit[1]


def _wrong(option: str, name: str, value: Quantity, *wanted: str) -> SpecError:
    """A value of another dimension than one of those that are wanted."""
    is_, _ = _parsed(value, name, "")
    words = text(value)
    unit = _LIKE[wanted[0]][0]
    example = f"{words} {unit}".strip() if is_ == "number" else {"mm": "0.1 mm", "deg": "2 arcmin"}.get(unit, "0.1")
    named = " or ".join(_LIKE[kind][1] for kind in wanted)
    found = _LIKE[is_][1] if is_ in _LIKE else "a product of units"
    return of_dimension(option, (name, words), (named, found), example)


def length(value: Quantity | None, what: str) -> float | None:
    """A length above zero in mm; `None` stays."""
    if value is None:
        return None
    kind, size = _parsed(value, what, '"0.1 um"')
    if kind != "length":
        raise _wrong(what, what, value, "length")
    if size <= 0:
        raise InputError(f"`{what}` is `{text(value)}`: a length above zero is needed")
    return size


def seconds(value: float | str | None, what: str) -> float | None:
    """A time above zero in seconds, `60` or `"60s"`; `None` stays.

    >>> from flank._quantities import seconds
    >>> seconds("60s", "limit"), seconds(0.5, "limit")
    (60.0, 0.5)
    """
    if isinstance(value, str):
        match = _TEXT.fullmatch(value)
        if match is None or match[2] not in ("", "s"):
            raise InputError(f"`{what}` is {value!r}: write seconds, for example 60 or \"60s\"")
        value = float(match[1])
    return number(value, what, 0.0, 1e9)


def amounts(values: Mapping[str, Quantity], what: str) -> list[Amount]:
    """Names with amounts above zero: `{"m.radial_distance": "5 um", "m.ratio_of_roll": "0.01 %"}`."""
    all_of_them = []
    for name, value in values.items():
        kind, size = _parsed(value, f"{what}[{name!r}]", '"5 um", "1 arcmin" or "0.01 %"')
        if size <= 0:
            raise InputError(f"`{what}[{name!r}]` is `{text(value)}`: an amount is above zero")
        all_of_them.append((_name(name), kind, size))
    return all_of_them


def errors(values: Mapping[str, Quantity], what: str) -> list[Amount]:
    """Axes with how far they are off: `{"m.E": "0.1 mm", "m.S": "2 arcmin"}`."""
    all_of_them = []
    for name, value in values.items():
        kind, size = _parsed(value, f"{what}[{name!r}]", '"0.1 mm" or "2 arcmin"')
        if kind not in ("length", "angle"):
            raise _wrong(what, name, value, "length", "angle")
        all_of_them.append((_name(name), kind, size))
    return all_of_them


_REFUSED = re.compile(r"option `(\w+) (\S+)`: this (?:takes|axis takes|step is) (?:an? |one in )?(length|angle|mm|deg|rad|plain number)(?![/*^])")
_KINDS = {"mm": "length", "deg": "angle", "rad": "angle", "plain number": "number"}


@contextlib.contextmanager
def dimensions(**options: Mapping[str, Quantity] | None) -> Iterator[None]:
    """Says as the language says it, E0301, that an amount of an option has another dimension than what it is one of: the program knows
    which that is."""
    try:
        yield
    except InputError as error:
        refused = _REFUSED.match(str(error))
        given = (options.get(refused[1]) or {}) if refused else {}
        if refused is None or refused[2] not in given:
            raise
        wanted = _KINDS.get(refused[3], refused[3])
        raise _wrong(refused[1], refused[2], given[refused[2]], wanted) from None


def count(value: int | None, what: str, low: int, high: int) -> int | None:
    """A whole number within a range; `None` stays."""
    if value is None:
        return None
    if isinstance(value, bool) or not hasattr(value, "__index__") or not low <= int(value) <= high:
        raise InputError(f"`{what}` is {value!r}: write a whole number from {low} to {high}")
    return int(value)


def number(value: float | None, what: str, low: float, high: float = math.inf) -> float | None:
    """A number above one end, and at the most the other; `None` stays."""
    if value is None:
        return None
    if not is_real(value) or not low < float(value) <= high:
        end = "" if high == math.inf else f" and at the most {high:g}"
        raise InputError(f"`{what}` is {value!r}: write a number above {low:g}{end}")
    return float(value)


def names(value: str | Iterable[str] | None) -> list[str]:
    """One name or several."""
    if value is None:
        return []
    return [value] if isinstance(value, str) else [str(name) for name in value]
