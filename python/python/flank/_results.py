"""Results of operations: what `--json` prints as data, arrays, files where a call asks for them."""

from __future__ import annotations

import copy
import json
import os
import tempfile
import warnings
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import numpy.typing as npt

from flank import _display
from flank._errors import InputError, NotSolved, UnknownName
from flank._points import Floats, SurfacePoints, column_units, joined, needed
from flank._quantities import Quantity, length, names

if TYPE_CHECKING:
    import pandas as _pandas  # type: ignore[import-untyped,import-not-found,unused-ignore]
    import polars as _polars  # type: ignore[import-untyped,import-not-found,unused-ignore]

    from flank._flank import Answer
    from flank._job import Job

Path_ = str | os.PathLike[str]
Again = Callable[[dict[str, Any]], "Answer"]
"""Asks for a result again, with further options."""

PICTURES = {"png", "svg"}


class Result:
    """A result. Its document has the names, units and signs of `--json`: `result["name"]`, `result.document`, `result.json()`.

    `print(result)` gives the text of the program.
    """

    _again: Again

    def __init__(self, answer: Answer, again: Again, inside: str = "") -> None:
        self._answer = answer
        self._again = again
        # files of a folder that is gone have no path
        self._inside = json.dumps(inside + "/")[1:-1] if inside else ""
        self._document: dict[str, Any] | None = None

    def __getstate__(self) -> dict[str, Any]:
        # the document is read again from its text
        return {**self.__dict__, "_document": None}

    def json(self) -> str:
        """The document as JSON, as `--json` prints it."""
        text = self._answer.document()
        return text.replace(self._inside, "") if self._inside else text

    @property
    def document(self) -> dict[str, Any]:
        """The document as nested dictionaries and lists; a copy."""
        return copy.deepcopy(self._read())

    def _read(self) -> dict[str, Any]:
        if self._document is None:
            self._document = json.loads(self.json())
        return self._document

    def __getitem__(self, key: str) -> Any:
        document = self._read()
        if key not in document:
            raise UnknownName(f"there is no `{key}`; there is: {', '.join(document)}")
        return copy.deepcopy(document[key])

    def keys(self) -> list[str]:
        """The names of the document."""
        return list(self._read())

    @property
    def not_done(self) -> list[dict[str, Any]]:
        """What was asked for and not done: `kind`, `of`, `place`, `message`, `details`; empty if all was."""
        return copy.deepcopy(self._read().get("not_done", []))

    @property
    def remarks(self) -> list[dict[str, Any]]:
        """What is to be known beside it."""
        return copy.deepcopy(self._read().get("remarks", []))

    @property
    def is_complete(self) -> bool:
        """Whether all was done that was asked for."""
        return not self._read().get("not_done", [])

    @property
    def seconds(self) -> float | None:
        """How long the program worked from the request to the result; `None` where it does not measure that. Documents leave it out."""
        return self._answer.seconds()

    def strict(self) -> Self:
        """Itself.

        Raises `NotSolved` if something that was asked for was not done.
        """
        if not self.is_complete:
            raise _not_solved(self._read()["not_done"])
        return self

    def _is_nothing(self) -> bool:
        """Whether nothing at all was found of what was asked for."""
        return False

    def _given(self) -> Self:
        """Itself, unless there is nothing to give."""
        return self.strict() if self._is_nothing() else self

    def _write(self, folder: Path_, **options: Any) -> list[str]:
        document = json.loads(self._again({"out": os.fspath(folder), **options}).document())
        files: list[str] = document["files"]
        missing: list[dict[str, Any]] = document.get("not_done", [])
        if missing and not files:
            raise _not_solved(missing)
        known = [one["message"] for one in self._read().get("not_done", [])]
        for one in missing:
            if one["message"] not in known:
                warnings.warn(told([one]), stacklevel=3)
        return files

    def __str__(self) -> str:
        text = self._answer.text()
        lines = (text.replace(self._inside, "") if self._inside else text).rstrip().splitlines()
        # no file was asked for
        shown = "\n".join(line for line in lines if line.strip() != "wrote").rstrip()
        missing = told(self._read().get("not_done", []))
        return f"{shown}\n\n{missing}" if missing else shown

    def __repr__(self) -> str:
        return str(self)

    def _picture(self) -> str | None:
        return None

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:
        return _display.bundle(str(self), self._picture())


def told(missing: list[dict[str, Any]]) -> str:
    """What was not done, and why."""
    return "\n".join("\n  ".join([one["message"], *one["details"]]) for one in missing)


def _not_solved(missing: list[dict[str, Any]]) -> NotSolved:
    return NotSolved(told(missing), json.dumps(missing))


class Points(Result):
    """Solved surfaces by their names, and lines on them. `points["concave"]` has arrays.

    >>> import flank
    >>> points = flank.load("specs/bevel/pinion_19x62.chain").solve()
    >>> list(points)
    ['concave', 'concave_fillet', 'convex', 'convex_fillet', 'root']
    >>> points["concave"].counts, points.is_complete
    ((15, 31), True)
    """

    def __init__(self, answer: Answer, again: Again) -> None:
        super().__init__(answer, again)
        told = json.loads(answer.document()) if any(_is_lacking(grid) for grid in answer.grids) else {"not_done": []}

        def why(name: str) -> list[dict[str, Any]]:
            return [reason for reason in told["not_done"] if reason["of"] in (name, f"{told['job']}.{name}")]

        self._grids = {grid.name: SurfacePoints(grid, why(grid.name)) for grid in answer.grids}

    def __getitem__(self, name: str) -> Any:
        if name in self._grids:
            return self._grids[name]
        known = ", ".join(self._grids)
        raise UnknownName(f"there is no surface `{name}`; there is: {known}")

    def __iter__(self) -> Iterator[str]:
        return iter(self._grids)

    def __len__(self) -> int:
        return len(self._grids)

    def __contains__(self, name: object) -> bool:
        return name in self._grids

    def keys(self) -> list[str]:
        """The names of surfaces and lines."""
        return list(self._grids)

    def values(self) -> list[SurfacePoints]:
        """The points of each."""
        return list(self._grids.values())

    def items(self) -> list[tuple[str, SurfacePoints]]:
        """Both."""
        return list(self._grids.items())

    def columns(self) -> dict[str, npt.NDArray[Any]]:
        """The columns of tables over all surfaces: `surface`, `i`, `j`, `x`, …, `status`, then the fields. What a surface has not is NaN."""
        return joined(self._grids)

    def to_pandas(self) -> _pandas.DataFrame:
        """The columns as a frame of pandas; units are in `attrs["units"]`."""
        frame: _pandas.DataFrame = needed("pandas", "to_pandas").DataFrame(self.columns())
        frame.attrs["units"] = column_units(self.values())
        return frame

    def to_polars(self) -> _polars.DataFrame:
        """The columns as a frame of polars."""
        frame: _polars.DataFrame = needed("polars", "to_polars").DataFrame(self.columns())
        return frame

    def write(self, folder: Path_, formats: str | Iterable[str] = ("csv",), *, step: Quantity = "0.1 um") -> list[str]:
        """Writes files into a folder, all or none, and gives their paths.

        Formats: csv, json, parquet, stl, obj, 3mf, vtp, step (smooth faces, `step` near to the exact surfaces), and png and svg, which come
        together. The job is solved again for that; the points are the same bits.
        """
        wanted = names(formats)
        points = [name for name in wanted if name not in PICTURES | {"step"}]
        faces = length(step, "step") if "step" in wanted else None
        return self._write(folder, format=points, step=faces, picture=bool(PICTURES & set(wanted)), arrays=False)

    def _picture(self) -> str | None:
        sampled = [grid for grid in self._grids.values() if min(grid.counts) > 1]
        return _display.outline(sampled) if sampled else None


def _is_lacking(grid: Any) -> bool:
    return grid.status is None or bool(np.any(grid.status != grid.words.index("solved")))


class Deviation(Result):
    """How far one surface, or measured points, lie off a surface: um along its normal, plus is material.

    >>> import flank
    >>> job = flank.load("specs/bevel/pinion_19x62.chain")
    >>> other = job.with_values({"m.radial_distance": "98.0 mm"})
    >>> e = flank.deviation(other["concave"], from_=job["concave"])
    >>> e.um.shape, round(e.crowning_length, 2)
    ((15, 31), 0.34)
    """

    def __init__(self, answer: Answer, again: Again, inside: str = "", measured: Any = None) -> None:
        super().__init__(answer, again, inside)
        self._measured = measured

    def _is_nothing(self) -> bool:
        return not self._read()["known"]

    @property
    def um(self) -> Floats:
        """The deviation at each point of the grid, um: (rows, columns), NaN where it is not known."""
        values: Floats = self._answer.grids[0].fields["deviation"][2]
        return values

    @property
    def xyz(self) -> Floats:
        """The points of the surface that it is compared with, in its frame, mm: (rows, columns, 3)."""
        xyz: Floats = self._answer.grids[0].xyz
        return xyz

    @property
    def counts(self) -> tuple[int, int]:
        """Rows and columns."""
        return self._answer.grids[0].counts

    @property
    def labels(self) -> tuple[str, str]:
        """What rows and columns run over."""
        return self._answer.grids[0].labels

    def _along(self, of: str, words: tuple[str, ...], place: int) -> float:
        directions = self._read()["directions"]
        named = [one for one in directions if one and any(word in one["direction"] for word in words)]
        found = named[0] if named else directions[place]
        return float("nan") if found is None else float(found[of])

    @property
    def crowning_length(self) -> float:
        """Drop from the middle to both ends of the tooth, um."""
        return self._along("crowning_um", ("toe", "heel"), 1)

    @property
    def crowning_profile(self) -> float:
        """Drop from the middle to root and tip, um."""
        return self._along("crowning_um", ("root", "tip"), 0)

    @property
    def slope_length(self) -> float:
        """Rise along the tooth, um."""
        return self._along("slope_um", ("toe", "heel"), 1)

    @property
    def slope_profile(self) -> float:
        """Rise from root to tip, um."""
        return self._along("slope_um", ("root", "tip"), 0)

    @property
    def bias(self) -> float:
        """The twist that fits best, um."""
        return _known(self._read()["bias_um"])

    @property
    def rms(self) -> float:
        """Root of the mean square, um."""
        return _known(self._read()["rms_um"])

    @property
    def turn(self) -> float:
        """About z, deg: until both meet in the middle of the grid, or the measured points lie nearest."""
        return _known(self._read()["turn_deg"])

    def write(self, folder: Path_, formats: str | Iterable[str] = ("csv",)) -> list[str]:
        """Writes points with their deviation (csv, json, parquet, stl, obj, 3mf, vtp) and the map (png and svg, together)."""
        wanted = names(formats)
        points = [name for name in wanted if name not in PICTURES]
        return self._write(folder, format=points, picture=bool(PICTURES & set(wanted)))

    def _picture(self) -> str | None:
        document = self._read()
        title = f"{document['surface'] or document['measured']} from {document['from']}"
        return _display.heights(self.um, "um", self.labels, title)


def _known(value: float | None) -> float:
    return float("nan") if value is None else float(value)


class Sensitivity:
    """How far points move along the normal with parameters, exact derivatives; plus is material.

    `values` is (rows, columns, parameters), `units` says per what: `um/mm`, `um/arcmin`, `um/0.001`.
    """

    __slots__ = ("names", "units", "values")

    def __init__(self, values: Floats, of: list[str], units: list[str]) -> None:
        values.flags.writeable = False
        self.values = values
        self.names = of
        self.units = units

    def __reduce__(self) -> tuple[Any, ...]:
        return (Sensitivity, (self.values, self.names, self.units))

    @property
    def shape(self) -> tuple[int, ...]:
        """Rows, columns, parameters."""
        return self.values.shape

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Floats:
        return np.array(self.values, dtype=dtype, copy=copy)

    def __getitem__(self, place: Any) -> Any:
        if isinstance(place, str):
            if place not in self.names:
                raise UnknownName(f"there is no parameter `{place}`; there is: {', '.join(self.names)}")
            return self.values[..., self.names.index(place)]
        return self.values[place]

    def __repr__(self) -> str:
        of = ", ".join(f"{name} [{unit}]" for name, unit in zip(self.names, self.units))
        return f"<sensitivity {self.shape} to {of}>"


class MeasuringGrid(Result):
    """Nominal points of a flank for a measuring machine.

    >>> import flank
    >>> grid = flank.load("specs/bevel/pinion_19x62.chain").measuring_grid("concave", rows=5, columns=9)
    >>> grid.xyz.shape, grid.normal.shape
    ((5, 9, 3), (5, 9, 3))
    """

    @property
    def points(self) -> SurfacePoints:
        """The grid."""
        return SurfacePoints(self._answer.grids[0], self.not_done)

    @property
    def xyz(self) -> Floats:
        """Positions, mm: (rows, columns, 3). Rows run from root to tip, columns along the tooth."""
        return self.points.xyz

    @property
    def normal(self) -> Floats:
        """Unit normals out of the material: (rows, columns, 3)."""
        return self.points.normal

    def write(self, path: Path_) -> str:
        """Writes the grid into one file, CSV or JSON as its name ends, and gives its path."""
        target = Path(path)
        kind = target.suffix.lower().lstrip(".")
        if kind not in ("csv", "json"):
            raise InputError(f"`{target}` ends in neither .csv nor .json")
        with tempfile.TemporaryDirectory(prefix="flank-") as folder:
            file = Path(self._write(folder, format=[kind])[0])
            put(target, file.read_bytes())
        return str(target)

    def _picture(self) -> str | None:
        return _display.outline([self.points])


def put(path: Path, content: bytes) -> None:
    """Writes a file that is whole or not there."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        part.write_bytes(content)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


class _WithSettings(Result):
    """A result that says what settings are to be."""

    def __init__(self, answer: Answer, again: Again, job: Job, inside: str = "") -> None:
        super().__init__(answer, again, inside)
        self._job = job

    def _changed(self) -> list[dict[str, Any]]:
        raise NotImplementedError

    @property
    def job(self) -> Job:
        """The job with the settings that were found."""
        values = {one["name"]: (one["new"], one["unit"]) for one in self._changed() if not one.get("is_error")}
        return self._job.with_values({name: _with_unit(*value) for name, value in values.items()})

    @property
    def text(self) -> str:
        """The text of a spec with the settings that were found, as it stands beside the job's: a variant of the job."""
        beside = str(Path(self._job.file).parent / f"{self._job.name}_corrected.chain")
        text: str | None = json.loads(self._again({"write": beside, "dry": True}).document())["corrected"]
        if text is None:
            raise self._uncorrected()
        return text

    def write(self, path: Path_) -> str:
        """Writes a spec with the settings that were found, a variant of the job, and gives its path. It uses the job's file, and lies in the
        same project."""
        files: list[str] = json.loads(self._again({"write": os.fspath(path)}).document())["files"]
        if not files:
            raise self._uncorrected()
        return files[0]

    def _uncorrected(self) -> NotSolved:
        return NotSolved("no setting is corrected, so there is no spec with corrected settings", json.dumps(self.not_done))

    @property
    def table(self) -> dict[str, list[Any]]:
        """The settings as columns: `name`, `unit`, `now`, `change`, `new`, …"""
        rows = self._changed()
        return {key: [row[key] for row in rows] for key in rows[0]} if rows else {}


def _with_unit(value: float, unit: str) -> str:
    return f"{value!r} {unit}".strip() if unit in ("", "mm", "deg") else f"{value!r} * 1 {unit}"


class Fit(_WithSettings):
    """The settings that made a measured flank (`identification`), and those that correct it or give a wanted ease-off (`correction`)."""

    def _changed(self) -> list[dict[str, Any]]:
        settings: list[dict[str, Any]] = self._read()["correction"]["settings"]
        return settings

    @property
    def left_um(self) -> Floats:
        """What the settings leave at each point of the first flank, um: (rows, columns), NaN where it is not known."""
        return self._map("left_um")

    @property
    def before_um(self) -> Floats:
        """How far the points lie off the surface as it is, um: (rows, columns)."""
        return self._map("before_um")

    @property
    def predicted_um(self) -> Floats:
        """The deviations that are to be expected after the correction, um: (rows, columns)."""
        return self._map("predicted_um")

    @property
    def covariance(self) -> Floats:
        """How the settings that were found scatter together, in their units and the order of `standard_deviations`; empty where nothing
        tells how the points scatter."""
        return np.array(self._answer.covariance, dtype=float)

    def _map(self, name: str) -> Floats:
        flank = self._read()["flanks"][0]
        return np.array(flank[name], dtype=float).reshape(flank["counts"])

    @property
    def standard_deviations(self) -> dict[str, float]:
        """One standard deviation of each setting that was found, in its unit; NaN where the points do not determine it."""
        found = self._read()["identification"] or self._read()["correction"]
        return {one["name"]: _known(one["uncertain_by"]) for one in found["settings"]}

    def _picture(self) -> str | None:
        flank = self._read()["flanks"][0]
        return _display.heights(self.before_um, "um", ("root -> tip", "toe -> heel"), f"{flank['surface']}, before")


class Synthesis(_WithSettings):
    """Settings with which a contact is where a job wants it."""

    def _changed(self) -> list[dict[str, Any]]:
        settings: list[dict[str, Any]] = self._read()["settings"]
        return settings


class Tolerance(Result):
    """How ease-off and contacts scatter with settings and mounting errors."""

    @property
    def changes(self) -> Floats:
        """What one standard deviation of each cause changes of each result: (results, causes)."""
        return np.array([one["changes"] for one in self._read()["results"]], dtype=float)

    @property
    def standard_deviations(self) -> dict[str, float]:
        """One standard deviation of each result, in its unit."""
        return {one["name"]: float(one["standard_deviation"]) for one in self._read()["results"]}


class Contact(Result):
    """Where two flanks touch while a pair rolls, and how evenly they turn each other.

    >>> import flank
    >>> contact = flank.load("specs/pairs/bevel_19x62.chain").contact("drive_side")
    >>> round(contact["error"]["peak_to_peak"], 3), contact["error"]["unit"]
    (141.42, 'urad')
    >>> contact.error.shape == contact.turn.shape
    True
    """

    def __init__(self, answer: Answer, again: Again) -> None:
        super().__init__(answer, again)
        self._grids = {grid.name: SurfacePoints(grid, []) for grid in answer.grids}

    @property
    def flanks(self) -> dict[str, SurfacePoints]:
        """The points of both flanks with the least `gap` to the mate, um, by their names."""
        return {name: grid for name, grid in self._grids.items() if not name.endswith(".path")}

    @property
    def paths(self) -> dict[str, SurfacePoints]:
        """The path of contact on both flanks with `turn`, `error`, `composite`, `gap_k1`, …; one row each."""
        return {name.removesuffix(".path"): grid for name, grid in self._grids.items() if name.endswith(".path")}

    def _on_path(self, name: str) -> Floats:
        of_first = next(iter(self.paths.values()), None)
        return of_first[name].ravel() if of_first is not None else np.empty(0)

    @property
    def turn(self) -> Floats:
        """Roll positions along the path, in the unit of the roll."""
        return self._on_path("turn")

    @property
    def error(self) -> Floats:
        """The transmission error of one pair of teeth at these, urad or um."""
        return self._on_path("error")

    def write(self, folder: Path_, formats: str | Iterable[str] = ("csv",)) -> list[str]:
        """Writes gaps and paths (csv, json, parquet, …) and a picture (png and svg, together)."""
        wanted = names(formats)
        points = [name for name in wanted if name not in PICTURES]
        return self._write(folder, format=points, picture=bool(PICTURES & set(wanted)))

    def _picture(self) -> str | None:
        grid = next(iter(self.flanks.values()), None)
        return None if grid is None else _display.heights(grid["gap"], "um", grid.labels, f"gap on {grid.name}")
