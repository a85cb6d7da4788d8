"""Studies: many cases of a job, as a folder of chunks that any number of processes fill."""

from __future__ import annotations

import csv
import json
import os
import tempfile
import warnings
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import numpy.typing as npt

from flank import _flank
from flank._cases import distributions, is_path, ranges, sizes, table, told
from flank._errors import InputError
from flank._points import needed
from flank._quantities import Quantity, count as whole, dimensions, names, seconds

if TYPE_CHECKING:
    from flank._job import Job

Path_ = str | os.PathLike[str]

_WORDS = ("case", "verdict", "why", "branch")


class Study:
    """The folder of a study: its plan, the texts of its spec, and chunks of rows. It may be moved and copied.

    `flank.sweep` makes one, `flank.Study(folder)` opens one.

    Raises `InputError` if there is no study. One that a program of another version has made is read; no rows are added to it.

    >>> import flank, tempfile
    >>> job = flank.load("specs/bevel/pinion_19x62.chain")
    >>> with tempfile.TemporaryDirectory() as out:
    ...     made = flank.sweep(job, cases={"m.radial_distance [mm]": [97.9, 98.1]}, collect="points", out=out)
    ...     flank.Study(out).columns()["points.solved"]
    array([1395., 1395.])
    """

    def __init__(self, folder: Path_) -> None:
        self._folder = os.path.abspath(folder)
        self._temporary: tempfile.TemporaryDirectory[str] | None = None
        _flank.sweep_chunks(self._folder)

    def __reduce__(self) -> tuple[Any, ...]:
        return (Study, (self._folder,))

    @property
    def folder(self) -> str:
        """Its absolute path."""
        return self._folder

    def progress(self) -> dict[str, Any]:
        """How far it is: the document of `flank sweep status --json`, with `cases`, `chunks`, `done` and `verdicts`."""
        document: dict[str, Any] = json.loads(_flank.sweep_status(self._folder).document())
        return document

    def run(
        self,
        chunks: tuple[int, int] | None = None,
        *,
        part: tuple[int, int] | None = None,
        again: str | Iterable[str] = (),
        on: Any = None,
        threads: int | None = None,
    ) -> Self:
        """Computes what is missing, or the chunks from the first to the last of two numbers, counted from 0, or a `part` of all: `(3, 10)` is
        the fourth of ten. Gives itself.

        Cases with a verdict in `again`, `"crashed"` or `"limit"`, are computed anew. `on` is a client of Dask: its workers compute, a chunk
        for a task. They see the folder under the same path. `threads` is how many threads work here; all processors otherwise.
        """
        all_of_them = _flank.sweep_chunks(self._folder)
        wanted = _chunks(chunks, all_of_them - 1) if chunks is not None else None
        share = _part(part) if part is not None else None
        if wanted and share:
            raise InputError("`chunks` and `part` both say which chunks: leave one of them out")
        if on is not None:
            from flank import _dask

            first, end = wanted or (0, all_of_them - 1)
            of = range(first, end + 1) if share is None else _begun(share, all_of_them)
            _dask.run(on, self._folder, of, names(again))
        else:
            study = _flank.OpenStudy(self._folder)
            study.run(wanted, names(again), whole(threads, "threads", 1, 1024), share)
        return self

    def columns(self) -> dict[str, npt.NDArray[Any]]:
        """The rows that are there by their columns, in the order of the cases.

        `case` (a hash), `number` from 0, the inputs with their units, `verdict`, `why`, `branch`, then what is collected. Numbers that are
        not known are NaN. A warning says which chunks are missing.
        """
        answer, columns = _flank.sweep_columns(self._folder)
        _warn_of_missing(answer)
        return {head: np.asarray(values, dtype=np.str_) if head in _WORDS else values for head, values in columns.items()}

    def write(self, path: Path_) -> str:
        """Writes the rows that are there into a file and gives its path: a table of Parquet where its name ends with .parquet, else CSV.
        A warning says which chunks are missing.

        >>> import flank, tempfile
        >>> job = flank.load("specs/bevel/pinion_19x62.chain")
        >>> study = flank.sweep(job, cases={"m.radial_distance [mm]": [97.9, 98.1]}, collect="points")
        >>> with tempfile.TemporaryDirectory() as out:
        ...     len(open(study.write(f"{out}/rows.csv")).readlines())
        3
        """
        _warn_of_missing(_flank.sweep_gather(self._folder, os.fspath(path)))
        return os.fspath(path)

    def frame(self, engine: str = "pandas") -> Any:
        """The columns as a frame of `"pandas"` or `"polars"`."""
        if engine not in ("pandas", "polars"):
            raise InputError(f"`engine` is {engine!r}: it is 'pandas' or 'polars'")
        return needed(engine, "frame").DataFrame(self.columns())

    def failed(self) -> list[dict[str, Any]]:
        """Of each case that is there and whose verdict is not `done`: `number`, inputs, `verdict`, `why`."""
        columns = self.columns()
        heads = ["number", *self.progress()["inputs"], "verdict", "why"]
        rows = np.flatnonzero(columns["verdict"] != "done")
        return [{head: columns[head][row].item() for head in heads} for row in rows]

    def points(self, number: int) -> dict[str, dict[str, npt.NDArray[Any]]]:
        """The points of a case that were kept, by their surfaces: `xyz` and `normal` (rows, columns, 3), `status`, `residual` and the unknowns.

        `number` is that of the case, from 0. Positions are mm, unknowns mm or degrees; what is not known is NaN.

        Raises `InputError` where the study keeps no points or the case has none.

        >>> import flank, tempfile
        >>> job = flank.load("specs/bevel/pinion_19x62.chain")
        >>> table = {"m.radial_distance [mm]": [97.9, 98.1]}
        >>> with tempfile.TemporaryDirectory() as out:
        ...     study = flank.sweep(job, table, collect="limits", keep="points", out=out)
        ...     study.points(1)["concave"]["xyz"].shape
        (15, 31, 3)
        """
        columns = self.columns()
        row = np.flatnonzero(columns["number"] == whole(number, "number", 0, 2**62))
        file = os.path.join(self._folder, "points", f"{columns['case'][row[0]]}.csv") if len(row) else ""
        if not os.path.isfile(file):
            raise InputError(f"there are no points of case {number} in {self._folder}: keep='points' keeps those of cases that are solved")
        return _kept(file)

    def __repr__(self) -> str:
        return _flank.sweep_status(self._folder).text().rstrip()


def _warn_of_missing(answer: _flank.Answer) -> None:
    for missing in json.loads(answer.document())["not_done"]:
        warnings.warn(missing["message"], stacklevel=3)


def _kept(file: str) -> dict[str, dict[str, npt.NDArray[Any]]]:
    """The points in a file, by surface and column."""
    with open(file, encoding="utf-8", newline="") as lines:
        head, *rows = csv.reader(line for line in lines if not line.startswith("#"))
    surfaces: dict[str, list[list[str]]] = {}
    for row in rows:
        surfaces.setdefault(row[0], []).append(row)
    return {surface: _arrays(head, of) for surface, of in surfaces.items()}


def _arrays(head: list[str], rows: list[list[str]]) -> dict[str, npt.NDArray[Any]]:
    counts = tuple(int(last) + 1 for last in rows[-1][1:3])
    cells = dict(zip(head, zip(*rows)))

    def numbers(*names: str) -> npt.NDArray[Any]:
        values = [[float(cell or "nan") for cell in cells[name]] for name in names]
        return np.array(values).T.reshape(*counts, len(names))

    # an unknown that the surface does not have has no number anywhere
    other = [name for name in head[9:] if name != "status" and any(cells[name])]
    return {
        "xyz": numbers("x", "y", "z"),
        "normal": numbers("nx", "ny", "nz"),
        "status": np.array(cells["status"], dtype=np.str_).reshape(counts),
    } | {name: numbers(name)[..., 0] for name in other}


def _chunks(chunks: Any, last: int) -> tuple[int, int]:
    if not isinstance(chunks, tuple | list) or len(chunks) != 2:
        raise InputError(f"`chunks` is {chunks!r}: write the first and the last of them, for example (0, {last})")
    # whole numbers; the program says which there are
    first, end = (whole(of, "chunks", 0, 2**62) for of in chunks)
    return first or 0, end or 0


def _part(part: Any) -> tuple[int, int]:
    if not isinstance(part, tuple | list) or len(part) != 2:
        raise InputError(f"`part` is {part!r}: write which part, from 0, and of how many, for example (3, 10)")
    parts = whole(part[1], "parts", 1, 2**62) or 1
    return whole(part[0], "part", 0, parts - 1) or 0, parts


def _begun(part: tuple[int, int], chunks: int) -> range:
    """The chunks of a part, as the program divides them."""
    first, end = (which * chunks // part[1] for which in (part[0], part[0] + 1))
    return range(first, end)


def sweep(
    job: Job,
    cases: Any = None,
    *,
    vary: Mapping[str, tuple[Quantity, Quantity, int]] | None = None,
    scatter: Mapping[str, Any] | None = None,
    count: int = 1000,
    seed: int = 0,
    sobol: bool = False,
    collect: str | Iterable[str],
    keep: str | None = None,
    out: Path_ | None = None,
    limit: float | str | None = None,
    on: Any = None,
) -> Study:
    """Solves many cases of a job and keeps a row of numbers for each, as `flank sweep` does, in the folder `out`; without one in a folder
    that is gone when nothing holds the study any more.

    One of three says what differs from case to case. `cases` is a table, with units in its heads (`m.radial_distance [mm]`): a dictionary
    of columns, a frame of pandas or polars, or the path of a CSV file. `vary` has two ends and how many values of each, of which all
    combinations are taken: `{"m.radial_distance": ("97.9 mm", "98.1 mm", 21)}`. `scatter` has standard deviations about the job's own values,
    `"10 um"`, or `("uniform", "10 um")` for at most so far; `count`, `seed` and `sobol` belong to it. `collect` has words such as `points` or
    `ease_off:SURFACE`. With `keep="points"` the points of each case are kept, too, as files: see `Study.points`. A case may take `limit`
    seconds, `60` or `"60s"`.

    It works on all processors, or on those of `on`, a client of Dask. A study that was killed goes on where it stopped.

    Raises `InputError` with all that is wrong in the table, and `SpecError` for a value without its unit, before anything is computed.

    >>> import flank, tempfile
    >>> job = flank.load("specs/bevel/pinion_19x62.chain")
    >>> with tempfile.TemporaryDirectory() as out:
    ...     study = flank.sweep(job, scatter={"m.radial_distance": "10 um"}, count=4, seed=7, collect="ease_off:concave", out=out)
    ...     list(study.columns()["verdict"]) == ["done"] * 4
    True
    """
    given = [what for what, of in (("cases", cases), ("vary", vary), ("scatter", scatter)) if of is not None]
    if len(given) != 1:
        raise InputError("say by one of `cases`, `vary` and `scatter` what differs from case to case")
    if keep not in (None, "points"):
        raise InputError(f"`keep` is {keep!r}: it is 'points' or None")
    options: dict[str, Any] = {
        "collect": names(collect),
        "keep_points": keep == "points",
        "limit": seconds(limit, "limit"),
        "count": whole(count, "count", 1, 100_000_000),
        "seed": whole(seed, "seed", 0, 2**64 - 1),
        "sobol": bool(sobol),
    }
    if cases is not None:
        options |= {"cases": os.fspath(cases)} if is_path(cases) else {"table": table(cases)}
    elif vary is not None:
        options["vary"] = ranges(vary)
    else:
        options |= distributions(scatter or {})
    temporary = tempfile.TemporaryDirectory(prefix="flank-study-") if out is None else None
    folder = temporary.name if temporary is not None else os.fspath(out or "")
    with told(), dimensions(scatter=sizes(scatter or {})):
        _flank.sweep_plan(job._native, {**options, "out": folder})
    study = Study(folder)
    study._temporary = temporary
    return study.run(on=on)
