"""Points of surfaces, measuring grids and lines."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from flank import _display
from flank._errors import InputError, UnknownName

if TYPE_CHECKING:
    import pandas as _pandas  # type: ignore[import-untyped,import-not-found,unused-ignore]
    import polars as _polars  # type: ignore[import-untyped,import-not-found,unused-ignore]
    import pyvista as _pyvista  # type: ignore[import-untyped,import-not-found,unused-ignore]
    import xarray as _xarray  # type: ignore[import-untyped,import-not-found,unused-ignore]

    from flank._flank import Grid

Floats = npt.NDArray[np.float64]


def needed(package: str, call: str) -> Any:
    """A package that a call names, or how to get it."""
    import importlib

    try:
        return importlib.import_module(package)
    except ModuleNotFoundError as missing:
        if missing.name != package:
            raise
        raise ModuleNotFoundError(f"`{call}` needs {package}: pip install {package}", name=package) from None


class SurfacePoints:
    """The points of a surface, row by row, in arrays that cannot be written.

    Positions are mm in the frame `frame`, normals are unit vectors out of the material, unknowns are mm or degrees. What is not known of a
    point is NaN; `status` says what became of it.

    >>> import flank
    >>> points = flank.load("specs/bevel/pinion_19x62.chain").solve(geometry=True)
    >>> concave = points["concave"]
    >>> concave.xyz.shape, concave["k1"].shape, concave.units["k1"]
    ((15, 31, 3), (15, 31), '1/mm')
    """

    __slots__ = ("_grid", "_reasons", "_status")

    def __init__(self, grid: Grid, reasons: list[dict[str, Any]]) -> None:
        self._grid = grid
        self._reasons = reasons
        self._status: npt.NDArray[np.str_] | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        return (SurfacePoints, (self._grid, self._reasons))

    @property
    def name(self) -> str:
        """Of the surface."""
        return self._grid.name

    @property
    def frame(self) -> str:
        """Of positions, normals and vectors."""
        return self._grid.frame

    @property
    def counts(self) -> tuple[int, int]:
        """Rows and columns; a line is one row."""
        return self._grid.counts

    @property
    def labels(self) -> tuple[str, str]:
        """What rows and columns run over: `root -> tip`, `z`."""
        return self._grid.labels

    @property
    def xyz(self) -> Floats:
        """Positions, mm: (rows, columns, 3)."""
        xyz: Floats = self._there(self._grid.xyz)
        return xyz

    @property
    def normal(self) -> Floats:
        """Unit normals out of the material: (rows, columns, 3)."""
        normal: Floats = self._there(self._grid.normal)
        return normal

    @property
    def residual(self) -> Floats:
        """The largest absolute residual: (rows, columns)."""
        residual: Floats = self._there(self._grid.residual)
        return residual

    @property
    def status(self) -> npt.NDArray[np.str_]:
        """`solved`, or why not, in the words of tables: (rows, columns)."""
        if self._status is None:
            status = np.array(self._grid.words)[self._there(self._grid.status)]
            status.flags.writeable = False
            self._status = status
        return self._status

    @property
    def solved(self) -> npt.NDArray[np.bool_]:
        """Where points are solved: (rows, columns)."""
        solved: npt.NDArray[np.bool_] = self._there(self._grid.status) == self._grid.words.index("solved")
        return solved

    @property
    def outcomes(self) -> dict[str, int]:
        """Number of points by their status."""
        return dict(sorted(Counter(self.status.ravel().tolist()).items()))

    @property
    def unknowns(self) -> dict[str, Floats]:
        """The unknowns of the equations, mm or degrees: (rows, columns) each."""
        return {name: values for name, (_, values) in self._grid.unknowns.items()}

    @property
    def fields(self) -> dict[str, Floats]:
        """What more is known of solved points: (rows, columns), of vectors (rows, columns, 3)."""
        return {name: values for name, (_, _, values) in self._grid.fields.items()}

    @property
    def units(self) -> dict[str, str]:
        """The unit of each unknown and each field; `1` for a plain number or a direction."""
        unknowns = {name: unit or "1" for name, (unit, _) in self._grid.unknowns.items()}
        return unknowns | {name: unit for name, (unit, _, _) in self._grid.fields.items()}

    @property
    def meanings(self) -> dict[str, str]:
        """What each field is, with its sign."""
        return {name: meaning for name, (_, meaning, _) in self._grid.fields.items()}

    def __getitem__(self, name: str) -> Floats:
        """A field or an unknown by its name."""
        if name in self._grid.fields:
            return self._grid.fields[name][2]
        if name in self._grid.unknowns:
            return self._grid.unknowns[name][1]
        known = ", ".join([*self._grid.fields, *self._grid.unknowns])
        raise UnknownName(f"{self.name} has no `{name}`; it has: {known}")

    def __len__(self) -> int:
        rows, columns = self.counts
        return rows * columns

    def why(self) -> str:
        """Where points are not solved, why, and what would reach them; empty if all are.

        >>> import flank
        >>> flank.load("specs/bevel/pinion_19x62.chain").solve()["root"].why()
        ''
        """
        return "\n".join("\n  ".join([reason["message"], *reason["details"]]) for reason in self._reasons)

    def columns(self) -> dict[str, npt.NDArray[Any]]:
        """The columns of tables, point by point: `surface`, `i`, `j`, `x`, …, `status`, then the fields.

        >>> import flank
        >>> list(flank.load("specs/bevel/pinion_19x62.chain").solve()["root"].columns())[:6]
        ['surface', 'i', 'j', 'x', 'y', 'z']
        """
        rows, columns = self.counts
        i, j = np.divmod(np.arange(rows * columns), max(columns, 1))
        table: dict[str, npt.NDArray[Any]] = {"surface": np.full(rows * columns, self.name), "i": i, "j": j}
        table |= _components("", ("x", "y", "z"), self.xyz)
        table |= _components("n", ("x", "y", "z"), self.normal)
        table |= {name: values.ravel() for name, values in self.unknowns.items()}
        table["residual"] = self.residual.ravel()
        table["status"] = self.status.ravel()
        for name, values in self.fields.items():
            if values.ndim == 3:
                table |= _components(f"{name}_", ("x", "y", "z"), values)
            else:
                table[name] = values.ravel()
        return table

    def to_pandas(self) -> _pandas.DataFrame:
        """The columns as a frame of pandas; units are in `attrs["units"]`."""
        frame: _pandas.DataFrame = needed("pandas", "to_pandas").DataFrame(self.columns())
        frame.attrs["units"] = column_units([self])
        return frame

    def to_polars(self) -> _polars.DataFrame:
        """The columns as a frame of polars."""
        frame: _polars.DataFrame = needed("polars", "to_polars").DataFrame(self.columns())
        return frame

    def to_xarray(self) -> _xarray.Dataset:
        """A dataset of xarray over `i` and `j` (and `axis` of vectors), with units as attributes."""
        package = needed("xarray", "to_xarray")
        shape = ("i", "j")
        variables: dict[str, Any] = {
            "xyz": ((*shape, "axis"), self.xyz, {"units": "mm", "frame": self.frame}),
            "normal": ((*shape, "axis"), self.normal, {"units": "1", "frame": self.frame}),
            "residual": (shape, self.residual, {"units": "1"}),
            "status": (shape, self.status),
        }
        units = self.units
        for name, values in {**self.unknowns, **self.fields}.items():
            place = (*shape, "axis") if values.ndim == 3 else shape
            variables[name] = (place, values, {"units": units[name], "meaning": self.meanings.get(name, "")})
        attributes = {"surface": self.name, "frame": self.frame, "i": self.labels[0], "j": self.labels[1]}
        dataset: _xarray.Dataset = package.Dataset(variables, {"axis": ["x", "y", "z"]}, attributes)
        return dataset

    def to_pyvista(self) -> _pyvista.StructuredGrid:
        """A structured grid of pyvista with normals, status and fields at its points, mm. Points that are not there are NaN."""
        package = needed("pyvista", "to_pyvista")
        rows, columns = self.counts
        # the first index runs fastest
        turned = self.xyz.transpose(1, 0, 2).reshape(-1, 3)
        grid: _pyvista.StructuredGrid = package.StructuredGrid()
        grid.points = turned
        grid.dimensions = (rows, columns, 1)
        flat = {"normal": self.normal, "status": self._grid.status, "residual": self.residual}
        for name, values in {**flat, **self.unknowns, **self.fields}.items():
            if values is not None:
                swapped = np.swapaxes(values, 0, 1)
                grid.point_data[name] = swapped.reshape(rows * columns, *values.shape[2:])
        return grid

    def _there(self, values: Any) -> Any:
        if values is None or self.counts == (0, 0):
            raise InputError(f"the points of {self.name} are not kept: leave out `arrays=False`")
        return values

    def __repr__(self) -> str:
        rows, columns = self.counts
        found = ", ".join(f"{count} {status}" for status, count in self.outcomes.items()) if len(self) else "no points"
        return f"<{self.name}: {rows} x {columns} points in {self.frame}, {found}>"

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:
        return _display.bundle(repr(self), _display.outline([self]) if len(self) else None)


def _components(before: str, axes: tuple[str, str, str], values: Floats) -> dict[str, Floats]:
    return {f"{before}{axis}": values[..., k].ravel() for k, axis in enumerate(axes)}


def column_units(grids: list[SurfacePoints]) -> dict[str, str]:
    """The units of columns that have one."""
    units = {"x": "mm", "y": "mm", "z": "mm"}
    for grid in grids:
        units |= grid.units
    return units


def joined(grids: Mapping[str, SurfacePoints]) -> dict[str, npt.NDArray[Any]]:
    """The columns of several surfaces one below the other; what one has not is NaN."""
    tables = [grid.columns() for grid in grids.values()]
    names = list(dict.fromkeys(name for table in tables for name in table))
    behind = ["residual", "status"]
    # unknowns of all surfaces stand before the residual, as in files
    fields = list(dict.fromkeys(name for grid in grids.values() for name in _field_columns(grid)))
    order = [name for name in names if name not in behind and name not in fields] + behind + fields
    table_of: dict[str, npt.NDArray[Any]] = {}
    for name in order if tables else []:
        parts = [table.get(name, np.full(len(table["i"]), np.nan)) for table in tables]
        table_of[name] = np.concatenate(parts)
    return table_of


def _field_columns(grid: SurfacePoints) -> list[str]:
    of = []
    for name, values in grid.fields.items():
        of += [f"{name}_{axis}" for axis in "xyz"] if values.ndim == 3 else [name]
    return of
