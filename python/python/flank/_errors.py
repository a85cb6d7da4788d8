"""Exceptions: why something was not done."""

from __future__ import annotations

import json
from typing import Any

class Error(Exception):
    """What ends an operation early. Points that are not solved do not: they are data."""


class SpecError(Error):
    """All that is wrong with a spec. Its text underlines the places, as the terminal shows them.

    >>> import flank
    >>> try:
    ...     flank.loads("machine m { param width : length = 20 axis C : rotary frame bed }")
    ... except flank.SpecError as error:
    ...     error.errors()[0]["code"]
    'E0301'
    """

    def __init__(self, rendered: str, findings: str = "[]") -> None:
        super().__init__(rendered)
        self._findings = findings

    def errors(self) -> list[dict[str, Any]]:
        """The findings: `code`, `severity`, `message`, `place`, `notes`, `help`, as `flank check --json` has them, and `url`.

        The `url` is that of the page about the code, within the book; `flank.explain` has its text.
        """
        findings: list[dict[str, Any]] = json.loads(self._findings)
        return [{**finding, "url": f"docs/errors/{finding['code']}.md"} for finding in findings]

    def json(self) -> str:
        """The same as JSON."""
        return self._findings

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self), (str(self), self._findings))


def of_dimension(option: str, given: tuple[str, str], kinds: tuple[str, str], instead: str) -> SpecError:
    """The finding of a value with a wrong dimension, as the language tells it of `set`: what was given, and what is wanted and found."""
    (name, value), (wanted, found) = given, kinds
    place = {"file": f"option `{option}`", "line": 1, "column": len(name) + 2, "text": value}
    finding = {
        "code": "E0301",
        "severity": "error",
        "message": f"`{name}` must be {wanted}, this is {found}",
        "place": place,
        "notes": [],
        "help": f"give it a unit: `{instead}`",
        "cures": [{"title": f"write `{instead}`", "place": place, "replacement": instead}],
    }
    under = " " * (len(name) + 1) + "^" * len(value)
    rendered = (
        f"error[E0301]: {finding['message']}\n --> {place['file']}:1:{place['column']}\n  |\n"
        f"1 | {name}={value}\n  | {under}\n  |\n  = help: {finding['help']}\n"
    )
    return SpecError(rendered, json.dumps([finding]))


class NotSolved(Error):
    """What was asked for cannot be solved: an operation has nothing to give, or `strict=True` was asked for."""

    def __init__(self, message: str, not_done: str = "[]") -> None:
        super().__init__(message)
        self._not_done = not_done

    @property
    def not_done(self) -> list[dict[str, Any]]:
        """What was not done: `kind`, `of`, `place`, `message`, `details`."""
        not_done: list[dict[str, Any]] = json.loads(self._not_done)
        return not_done

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self), (str(self), self._not_done))


class ConversionError(Error):
    """Another machine cannot do what a job does."""


class InputError(Error):
    """What is asked for does not go together, names something that there is not, or a file is not what it should be."""


class UnknownName(InputError, KeyError):
    """A job or a result has nothing of that name."""

    def __str__(self) -> str:
        # a KeyError shows its text in quotes
        return str(self.args[0])


class FileError(Error, OSError):
    """A file cannot be written. No file of the operation has its name."""


class InternalError(Error):
    """A fault of flank."""

    def __init__(self, reason: str) -> None:
        super().__init__(reason)

    def __str__(self) -> str:
        return (
            f"flank has a fault: {self.args[0]}\n"
            "please report it with the spec, the call and this message; your data are as they were"
        )
