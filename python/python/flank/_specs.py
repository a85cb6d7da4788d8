"""Specs that are made: of the library that flank brings, and of files of other programs."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from flank import _flank
from flank._quantities import Quantity, given
from flank._results import Path_, put


class Imported:
    """A job made of a machine summary: its `text`, its name `job`, and what is doubtful about the file."""

    __slots__ = ("doubts", "file", "job", "text")

    def __init__(self, file: str, job: str, text: str, doubts: list[str]) -> None:
        self.file = file
        self.job = job
        self.text = text
        self.doubts = doubts

    def save(self, path: Path_) -> str:
        """Writes the spec and gives its path."""
        put(Path(path), self.text.encode())
        return os.fspath(path)

    def __repr__(self) -> str:
        return f"<spec of {self.job} from {self.file}, {len(self.doubts)} doubts>"


def import_rexs(
    file: Path_,
    signs: str,
    *,
    coefficients: str | None = None,
    settings: str | None = None,
    outside: str | None = None,
    inside: str | None = None,
    name: str = "imported",
    library: str = "specs",
) -> Imported:
    """A job of a machine summary in REXS, as `flank import` makes it.

    `signs` says in which frames the file's signs are: `frames`, `left-hand-pinion` or `right-hand-gear`; `coefficients` what those of
    motions are, `taylor` or `polynomial`. `outside` and `inside` are the ids of the tools for the concave and for the convex flank, `settings`
    that of the settings where the file holds several. `library` is where the library lies, seen from the job's file.

    Raises `InputError` if the file is none, or leaves something open, and `SpecError` for what it says wrong.

    >>> import flank
    >>> try:
    ...     flank.import_rexs("summary.rexs", "frames", outside="21")
    ... except flank.Error as error:
    ...     "summary.rexs" in str(error)
    True
    """
    options: dict[str, Any] = {
        "signs": signs,
        "coefficients": None if coefficients is None else [coefficients],
        "settings": settings,
        "outside": outside,
        "inside": inside,
        "name": name,
        "library": library,
    }
    answer, doubts = _flank.import_rexs(os.fspath(file), options)
    made = json.loads(answer.document())
    return Imported(made["file"], made["job"], made["text"], doubts)


def templates() -> dict[str, Any]:
    """The jobs, machines and tools of the library that `new` can start from: the document of `flank new --json`.

    >>> import flank
    >>> sorted(flank.templates())[:3], len(flank.templates()["machines"]) > 10
    (['machines', 'schema', 'templates'], True)
    """
    document: dict[str, Any] = json.loads(_flank.templates().document())
    return document


def new(
    template: str, folder: Path_, *, name: str | None = None, values: Mapping[str, Quantity] | None = None
) -> dict[str, Any]:
    """Writes a job, a machine or a tool of the library into a folder, under a new name and with other values, and all that it uses: the
    document of `flank new NAME --json`, with `spec` and `files`. Nothing that stands in the folder is changed.

    >>> import flank, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     made = flank.new("helical_gear", folder, name="mine", values={"teeth": 25})
    ...     flank.load(made["spec"]).parameters["teeth"].value
    25.0
    """
    made: dict[str, Any] = json.loads(_flank.new_job(template, os.fspath(folder), name, list(given(values or {}).items())).document())
    return made
