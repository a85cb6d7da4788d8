"""Jobs: what a spec generates, with its values."""

from __future__ import annotations

import html
import json
import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from flank import _display, _flank, _machines, _pages, _results
from flank._arguments import (
    Measured,
    Path_,
    chosen,
    correlation,
    kept,
    margin_shares,
    mounting_errors,
    parabola,
    ranges,
    several,
    single,
)
from flank._asked import Asked, AskedOfMeasured, Operation
from flank._errors import InputError, UnknownName
from flank._parameters import Parameters, parameter
from flank._quantities import Quantity, amounts, count, dimensions, given, length, names, number


class Surface:
    """A surface of a job."""

    __slots__ = ("counts", "frame", "job", "name")

    def __init__(self, job: Job, name: str, frame: str, counts: tuple[int, int] | None) -> None:
        self.job = job
        self.name = name
        self.frame = frame
        """The frame that it is in."""
        self.counts = counts
        """Rows and columns of its sample, if it is sampled."""

    def sensitivity(self, of: str | Iterable[str] | None = None) -> _results.Sensitivity:
        """How far its points move along the normal with parameters; all that are no counts, if none is named.

        >>> import flank
        >>> concave = flank.load("specs/bevel/pinion_19x62.chain")["concave"]
        >>> J = concave.sensitivity(["m.radial_distance", "m.ratio_of_roll"])
        >>> J.shape, J.units
        ((15, 31, 2), ['um/mm', 'um/0.001'])
        """
        points = self.job.solve(sensitivity=True)
        if self.name not in points:
            raise InputError(f"`{self.name}` is not sampled: add `sample {self.name} {{ … }}`")
        grid = points[self.name]
        known = {name.removeprefix("d_normal/d_"): name for name in grid.fields if name.startswith("d_normal/d_")}
        wanted = list(known) if of is None else names(of)
        for name in wanted:
            if name not in known:
                raise InputError(f"nothing is known of `{name}`; parameters with a derivative: {', '.join(known)}")
        values = np.stack([grid[known[name]] for name in wanted], axis=-1) if wanted else np.empty((*grid.counts, 0))
        return _results.Sensitivity(values, wanted, [grid.units[known[name]] for name in wanted])

    def __repr__(self) -> str:
        sample = "not sampled" if self.counts is None else f"{self.counts[0]} x {self.counts[1]} points"
        return f"<surface {self.name} of {self.job.name} in {self.frame}, {sample}>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Surface) and (self.job, self.name) == (other.job, other.name)

    def __hash__(self) -> int:
        return hash((self.job, self.name))


class Job:
    """A job of a spec with its values. It is frozen and holds all texts that it is made of: threads share it, and a pickle has all.

    `flank.load`, `flank.loads` and `flank.load_all` make jobs.

    >>> import flank
    >>> job = flank.load("specs/bevel/pinion_19x62.chain")
    >>> job.parameters["m.radial_distance"]
    Parameter(97.95940290780507 mm, given by the job)
    >>> job["concave"]
    <surface concave of pinion_19x62 in m.work, 15 x 31 points>
    """

    __slots__ = ("_native", "_parameters", "_surfaces")

    def __init__(self, native: _flank.Job) -> None:
        self._native = native
        self._parameters: Parameters | None = None
        self._surfaces = {name: Surface(self, name, frame, counts) for name, frame, counts in native.surfaces()}

    @property
    def name(self) -> str:
        """As the spec has it."""
        return self._native.name

    @property
    def file(self) -> str:
        """The file of its spec, as it was named."""
        return self._native.file

    @property
    def doc(self) -> str:
        """Its doc comment."""
        return self._native.doc

    @property
    def hash(self) -> str:
        """SHA-256 of all its texts and of the values that were set from outside, as files say it."""
        return self._native.hash

    @property
    def overrides(self) -> dict[str, str]:
        """Values that were set from outside the text."""
        return dict(self._native.set)

    @property
    def text(self) -> str:
        """The text of its spec; where values were set from outside, that of a variant of the job with these, as it stands beside it.

        >>> import flank
        >>> job = flank.load("specs/bevel/pinion_19x62.chain").with_values({"m.radial_distance": "98.1 mm"})
        >>> print(job.text)
        use "pinion_19x62.chain"
        <BLANKLINE>
        job pinion_19x62_changed = pinion_19x62(m.radial_distance: 98.1 mm)
        <BLANKLINE>
        """
        return self._text_in(os.path.dirname(self._path))

    def save(self, path: Path_) -> str:
        """Writes its `text` and gives the path. A variant uses the job's file, and lies in the same project.

        Raises `SpecError` if what it uses is not found from there.

        >>> import flank, shutil, tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     spec = shutil.copy("specs/tutorial/first_gear.chain", folder)
        ...     fine = flank.load(spec, "first_gear").with_values({"module": "2 mm"})
        ...     flank.load(fine.save(f"{folder}/fine.chain")).parameters["module"]
        Parameter(2.0 mm, given by the job)
        """
        target = os.path.abspath(path)
        text = self._text_in(os.path.dirname(target))
        if target == os.path.abspath(self._path) and text != self._native.texts[0][1]:
            raise InputError(f"`{os.fspath(path)}` is the spec of the job: a variant stands in a file of its own")
        _flank.load(target, [(target, text)])
        _results.put(Path(path), text.encode())
        return os.fspath(path)

    @property
    def _path(self) -> str:
        """Of its spec: relative names stay as they were given as long as they lead to the same file."""
        first = self._native.texts[0][0]
        return self.file if os.path.realpath(self.file) == first else first

    def _text_in(self, folder: str) -> str:
        if not self.overrides:
            return self._native.texts[0][1]
        used = os.path.relpath(self._path, folder or ".").replace(os.sep, "/")
        values = ", ".join(f"{name.removeprefix(self.name + '.')}: {value}" for name, value in self.overrides.items())
        text = f'use "{used}"\n\njob {self.name}_changed = {self.name}({values})\n'
        return _flank.layout(os.path.join(folder, f"{self.name}_changed.chain"), text)

    @property
    def warnings(self) -> list[dict[str, Any]]:
        """What is doubtful in its spec: `code`, `message`, `place`, `help`."""
        findings: list[dict[str, Any]] = json.loads(self._native.warnings)
        return findings

    @property
    def parameters(self) -> Parameters:
        """Parameters and settings by their names."""
        if self._parameters is None:
            self._parameters = Parameters(parameter(*of) for of in self._native.parameters())
        return self._parameters

    @property
    def surfaces(self) -> dict[str, Surface]:
        """Its surfaces by their names, in the order of the spec."""
        return dict(self._surfaces)

    def __getitem__(self, name: str) -> Surface:
        if name in self._surfaces:
            return self._surfaces[name]
        raise UnknownName(f"there is no surface `{name}`; there is: {', '.join(self._surfaces)}")

    def __contains__(self, name: object) -> bool:
        return name in self._surfaces

    def __iter__(self) -> Iterator[str]:
        return iter(self._surfaces)

    def with_values(self, values: Mapping[str, Quantity] | None = None, /, **more: Quantity) -> Job:
        """A new job with other values for parameters and settings.

        A length or an angle has its unit: `"98.1 mm"`, `(98.1, "mm")`, or a quantity of pint. A bare number is a plain number.

        Raises `SpecError`: E0301 where a unit is missing, E0201 for a name that there is not, E0307 beyond a range.

        >>> import flank
        >>> job = flank.load("specs/bevel/pinion_19x62.chain")
        >>> other = job.with_values({"m.radial_distance": "98.1 mm", "c.blade_angle": (20.5, "deg")})
        >>> other.parameters["m.radial_distance"]
        Parameter(98.1 mm, given by the caller)
        >>> other == job
        False
        """
        changed = {**self.overrides, **given({**(values or {}), **more})}
        return Job(_flank.load(self._path, self._native.texts, self.name, sorted(changed.items()))[0])

    def solve(
        self,
        *,
        geometry: bool = False,
        sensitivity: bool = False,
        limits: bool = False,
        certify: bool = False,
        boxes: int | None = None,
        arrays: bool = True,
        strict: bool = False,
    ) -> _results.Points:
        """Solves all sampled surfaces.

        `geometry` adds curvatures, contact lines, sliding velocities and the metric; `sensitivity` how far points move with parameters;
        `limits` lines where surfaces turn back and contact ends; `certify` a proof of each point. `boxes` bounds the search for all
        branches. Without `arrays`, surfaces of more than 65,536 points are counted and not kept. Points that are not solved are data;
        `strict` makes them raise `NotSolved`.

        >>> import flank
        >>> c = flank.load("specs/bevel/pinion_19x62.chain").solve(geometry=True)["concave"]
        >>> c.xyz.shape, c.normal.shape, c["k1"].shape, c.outcomes
        ((15, 31, 3), (15, 31, 3), (15, 31), {'solved': 465})
        """
        options = {
            "geometry": geometry,
            "sensitivity": sensitivity,
            "limits": limits,
            "certify": certify,
            "boxes": count(boxes, "boxes", 1, 10**12),
            "arrays": arrays,
        }
        points = _results.Points(*self._asked(_flank.solve, options))
        return points.strict() if strict else points

    def solid(
        self,
        part: str = "gear",
        *,
        deviation: Quantity = "10 um",
        density: float = 7850.0,
        ball: Quantity | None = None,
    ) -> _machines.Solids:
        """Closed bodies: of the whole `gear`, one `tooth` or one `space`.

        `deviation` is how far the middles of a mesh's edges may lie off the exact surfaces, `density` is kg/m³, `ball` the diameter of
        the balls that the gear is measured over.

        >>> import flank
        >>> gear = flank.load("specs/bevel/pinion_19x62.chain").solid()
        >>> round(gear.solids["pinion"]["volume_mm3"])
        71368
        """
        options = {
            "part": part,
            "deviation": length(deviation, "deviation"),
            "density": number(density, "density", 0.0),
            "ball": length(ball, "ball"),
        }
        return _machines.Solids(*self._asked(_flank.solid, options))._given()

    def mesh(
        self, teeth: int | None = 1, *, elements: tuple[int, int, int] = (8, 12, 6), order: int = 1
    ) -> _machines.Bricks:
        """Bodies as bricks for finite elements: some neighbouring teeth, all of them with `teeth=None`.

        `elements` are bricks up a flank, along the tooth, and from flank to flank; `order` is 1 or 2.

        >>> import flank
        >>> flank.load("specs/bevel/pinion_19x62.chain").mesh(elements=(3, 4, 3)).solids["pinion"]["element"]
        'C3D8'
        """
        lows = (1, 1, 3)
        of = several(elements, "elements", "up a flank", "along the tooth", "from flank to flank")
        sides = [count(size, f"elements[{k}]", lows[k], 1000) for k, size in enumerate(of)]
        options = {
            "teeth": 0 if teeth is None else count(teeth, "teeth", 1, 10_000),
            "elements": sides,
            "order": str(order),
        }
        return _machines.Bricks(*self._asked(_flank.mesh, options))._given()

    def plot(
        self,
        what: str | Iterable[str] = (),
        *,
        surface: str | Iterable[str] = (),
        reference: str | None = None,
        of: str | Iterable[str] = (),
        contact: str | Iterable[str] = (),
        milling: str | None = None,
        errors: Mapping[str, Quantity] | None = None,
        positions: int | None = None,
        compound: Quantity | None = None,
        size: tuple[int, int] = (1200, 900),
        formats: str | Iterable[str] = ("svg", "png"),
        no_origin: bool = False,
    ) -> _pages.Plot:
        """Draws pictures: gear, surface, topography, traces, curvature, sensitivity, deviation, left, residual, contact-lines, section,
        machine, motion, pattern, error, gap, path, milling. Without a kind, the first three that fit. `milling` names the one of several.

        >>> import flank
        >>> list(flank.load("specs/bevel/pinion_19x62.chain").plot("section").pictures)
        ['section']
        """
        sides = [count(side, f"size[{k}]", 100, 10_000) for k, side in enumerate(several(size, "size", "width", "height"))]
        options = {
            "what": names(what),
            "surface": names(surface),
            "reference": reference,
            "of": names(of),
            "contact": names(contact),
            "milling": milling,
            "errors": mounting_errors(errors),
            "positions": count(positions, "positions", 4, 10_000),
            "compound": length(compound, "compound"),
            "size": tuple(sides),
            "format": names(formats),
            "no_origin": no_origin,
        }
        with tempfile.TemporaryDirectory(prefix="flank-") as folder, dimensions(error=errors):
            answer, again = self._asked(_flank.plot, {**options, "out": folder})
            files = _pages.read(folder)
        return _pages.Plot(answer, again, folder, files)

    def view(self, height: int = 600) -> _pages.Page:
        """A page of the job in 3-D with sliders. A notebook shows it in a frame of this height; nothing is loaded from elsewhere.

        >>> import flank
        >>> flank.load("specs/bevel/pinion_19x62.chain").view().html[:15].lower()
        '<!doctype html>'
        """
        return _pages.Page(*self._page(_flank.view, {}), height)

    def report(
        self,
        *,
        certify: bool = False,
        step: Quantity | None = None,
        date: str | None = None,
        height: int = 800,
    ) -> _pages.Report:
        """A page about the job to attach to an order. Its document has all numbers; `write` gives it as Markdown, too.

        >>> import flank
        >>> report = flank.load("specs/hobbing/helical_gear.chain").report()
        >>> report["asked"] == report["solved"]
        True
        """
        options = {"certify": certify, "step": length(step, "step"), "date": date, "format": ["html"]}
        return _pages.Report(*self._page(_flank.report, options), height)

    def _page(self, operation: Operation, options: dict[str, Any]) -> tuple[_flank.Answer, _results.Again, str, str]:
        with tempfile.TemporaryDirectory(prefix="flank-") as folder:
            answer, again = self._asked(operation, {**options, "out": folder})
            page = next((file.read_text() for file in Path(folder).glob("*.html")), "")
        return answer, again, folder, page

    def measuring_grid(
        self,
        surface: str,
        rows: int = 5,
        columns: int = 9,
        *,
        margin: tuple[float, float] | None = None,
        lines: int | None = None,
    ) -> _results.MeasuringGrid:
        """Nominal points of a flank: `rows` from root to tip, `columns` along the tooth, without `margin` at each end (shares).

        >>> import flank
        >>> flank.load("specs/bevel/pinion_19x62.chain").measuring_grid("concave").points.labels
        ('root -> tip', 'toe -> heel')
        """
        options = {
            "surface": [self[surface].name],
            "rows": count(rows, "rows", 2, 1000),
            "columns": count(columns, "columns", 2, 1000),
            "margin": margin_shares(margin),
            "lines": count(lines, "lines", 2, 1000),
        }
        return _results.MeasuringGrid(*self._asked(_flank.measure, options))

    def inspect(
        self,
        surface: str,
        measured: Path_ | npt.ArrayLike,
        *,
        rows: int | None = None,
        columns: int | None = None,
        margin: tuple[float, float] | None = None,
        align: bool = True,
    ) -> _results.Deviation:
        """How far measured points lie off a surface, um along the normal, plus is material.

        `measured` is a file, or positions (rows, columns, 3), mm, from root to tip and along the tooth, NaN or
        masked where nothing was measured.

        >>> import flank
        >>> job = flank.load("specs/bevel/pinion_19x62.chain")
        >>> made = job.with_values({"m.radial_distance": "98.0 mm"})
        >>> job.inspect("concave", made.measuring_grid("concave", 5, 9).xyz).um.shape
        (5, 9)
        """
        known = Measured(measured).counts
        options = {
            "rows": count(known[0] if rows is None else rows, "rows", 1, 10_000),
            "columns": count(known[1] if columns is None else columns, "columns", 1, 10_000),
            "margin": margin_shares(margin),
            "no_align": not align,
        }
        asked = AskedOfMeasured(Asked(_flank.deviation, self, options, (self[surface].name,)), measured)
        answer, inside = asked.told({})
        return _results.Deviation(answer, asked, inside, measured)._given()

    def fit(
        self,
        surface: str,
        measured: Path_ | npt.ArrayLike | _results.Deviation | None = None,
        *,
        vary: str | Iterable[str] = (),
        also: tuple[str, Path_ | npt.ArrayLike] | None = None,
        rows: int | None = None,
        columns: int | None = None,
        margin: tuple[float, float] | None = None,
        ease_off: Mapping[str, float | tuple[float, float]] | Path_ | None = None,
        from_: Surface | str | None = None,
        order: int | None = None,
        noise: Quantity | None = None,
        round: Mapping[str, Quantity] | None = None,
        keep: Mapping[str, str] | Iterable[str] = (),
        as_it_lies: bool = False,
        thickness: str = "fitted",
        share: float = 1.0,
        within: Quantity = "1 um",
        resolution: Quantity = "0.1 um",
    ) -> _results.Fit:
        """The settings that made a measured flank and those that correct it, within their ranges; or those of a wanted ease-off.

        `measured` is a file, positions as for `inspect`, or what `inspect` gave. `vary` names the settings; without it some are chosen.
        `also` is a further surface that was measured in the same position. `ease_off` has `crowning`, `slope` (each from root to tip, along
        the tooth) and `bias`, um, from the surface `from_`. `keep` names surfaces that stay, in the `middle` or along their `line`.

        >>> import flank
        >>> job = flank.load("specs/bevel/pinion_19x62.chain")
        >>> made = job.with_values({"m.radial_distance": "98.0 mm"})
        >>> fit = job.fit("concave", made.measuring_grid("concave", 5, 9).xyz, vary="m.radial_distance")
        >>> round(fit["identification"]["settings"][0]["new"], 4)
        98.0
        """
        of = measured._measured if isinstance(measured, _results.Deviation) else measured
        known, second_known = Measured(of).counts, Measured(None if also is None else also[1], "also").counts
        # both have one grid, or each its own
        known = known if also is None or known == second_known else (None, None)
        base: dict[str, Any] = {
            "vary": names(vary),
            "rows": count(known[0] if rows is None else rows, "rows", 1, 10_000),
            "columns": count(known[1] if columns is None else columns, "columns", 1, 10_000),
            "margin": margin_shares(margin),
            "order": count(order, "order", 1, 2),
            "noise": length(noise, "noise"),
            "round": amounts(round or {}, "round"),
            "keep": kept(keep),
            "as_it_lies": as_it_lies,
            "is_thickness_free": chosen(thickness, "thickness", ("fitted", "free")) == "free",
            "share": number(share, "share", 0.0, 1.0),
            "within": length(within, "within"),
            "resolution": length(resolution, "resolution"),
        }
        other = self._reference(from_, base, "from") if from_ is not None else None
        if isinstance(ease_off, Mapping):
            base["ease_off"] = parabola(ease_off)
        elif ease_off is not None:
            base["ease_off_table"] = os.fspath(ease_off)
        asked = AskedOfMeasured(Asked(_flank.fit, self, base, (self[surface].name,), other), of, also)
        with dimensions(round=round):
            answer, inside = asked.told({})
        return _results.Fit(answer, asked, self, inside)

    def synthesis(
        self, want: str, *, vary: str | Iterable[str] = (), round: Mapping[str, Quantity] | None = None
    ) -> _results.Synthesis:
        """The settings with which a contact is where the job wants it (`want NAME in CONTACT = vertex(…)`).

        >>> import flank
        >>> flank.load("specs/pairs/bevel_19x62.chain").synthesis("centred")["surface"]
        'gear_convex'
        """
        options = {"vary": names(vary), "round": amounts(round or {}, "round")}
        asked = Asked(_flank.synthesis, self, options, (want,))
        with dimensions(round=round):
            return _results.Synthesis(asked({}), asked, self)

    def tolerance(
        self,
        surface: str,
        *,
        scatter: Mapping[str, Quantity] | None = None,
        correlations: Mapping[tuple[str, str], float] | None = None,
        budget: Mapping[str, Quantity] | None = None,
        limits: float = 3.0,
        align: bool = True,
        sweep: int | None = None,
    ) -> _results.Tolerance:
        """How the ease-off of a surface, and contacts that it takes part in, scatter with settings and mounting errors.

        `scatter` and `budget` are standard deviations: `{"m.radial_distance": "5 um", "m.ratio_of_roll": "0.01 %"}`. `sweep` solves so
        many random cases beside.

        >>> import flank
        >>> found = flank.load("specs/bevel/pinion_19x62.chain").tolerance("concave", scatter={"m.radial_distance": "5 um"})
        >>> sorted(found.standard_deviations)[:3]
        ['bias', 'crowning_lengthwise', 'crowning_profilewise']
        """
        pairs = [((a, b), correlation(of)) for (a, b), of in (correlations or {}).items()]
        options = {
            "scatter": amounts(scatter or {}, "scatter"),
            "correlations": pairs,
            "budget": amounts(budget or {}, "budget"),
            "limits": number(limits, "limits", 0.0),
            "no_align": not align,
            "sweep": count(sweep, "sweep", 10, 1_000_000),
        }
        asked = Asked(_flank.tolerance, self, options, (self[surface].name,))
        with dimensions(scatter=scatter, budget=budget):
            return _results.Tolerance(asked({}), asked)

    def contacts(
        self,
        name: str | None = None,
        *,
        errors: Mapping[str, Quantity] | None = None,
        positions: int = 60,
        compound: Quantity = "6.35 um",
        sensitivity: bool = False,
        vhj: bool = False,
        certify: bool = False,
        milled: str | None = None,
    ) -> dict[str, _results.Contact]:
        """All contacts of the job, or one, by their names. Arguments as for `contact`.

        >>> import flank
        >>> list(flank.load("specs/pairs/bevel_19x62.chain").contacts())
        ['drive_side']
        """
        options = {
            "contact": name,
            "errors": mounting_errors(errors),
            "positions": count(positions, "positions", 4, 10_000),
            "compound": length(compound, "compound"),
            "sensitivity": sensitivity,
            "vhj": vhj,
            "certify": certify,
            "milled": milled,
        }
        with dimensions(error=errors):
            found = _flank.contact(self._native, options)
        return {
            json.loads(answer.document())["contact"]: _results.Contact(answer, Asked(_flank.contact, self, options, place=k))
            for k, answer in enumerate(found)
        }

    def contact(
        self,
        name: str | None = None,
        *,
        errors: Mapping[str, Quantity] | None = None,
        positions: int = 60,
        compound: Quantity = "6.35 um",
        sensitivity: bool = False,
        vhj: bool = False,
        certify: bool = False,
        milled: str | None = None,
    ) -> _results.Contact:
        """Rolls two flanks on each other: where they touch, transmission error, marking pattern.

        `errors` are mounting errors by axis: `{"m.E": "0.1 mm", "m.S": "2 arcmin"}`; `positions` are those over a pitch; `compound` is the
        thickness of the marking compound. `sensitivity` adds what each axis and setting does, `vhj` the mountings that bring the contact to
        toe, middle and heel, `certify` proofs, `milled` the pair with the flank that a milling of the job leaves.

        >>> import flank
        >>> contact = flank.load("specs/pairs/bevel_19x62.chain").contact("drive_side", errors={"m.E": "0.1 mm"})
        >>> round(contact["error"]["peak_to_peak"], 2)
        140.08
        """
        found = self.contacts(
            name,
            errors=errors,
            positions=positions,
            compound=compound,
            sensitivity=sensitivity,
            vhj=vhj,
            certify=certify,
            milled=milled,
        )
        return single(found, "contact")

    def millings(
        self,
        name: str | None = None,
        *,
        tool_centre_control: bool = False,
        feed: float = 600.0,
        spindle: float | None = None,
        approach: Quantity = "5 mm",
        spaces: int = 1,
        verify: Path_ | None = None,
        rows: int = 15,
        columns: int = 31,
        clamp: Mapping[str, tuple[Quantity, Quantity]] | None = None,
        certify: Quantity | None = None,
    ) -> dict[str, _machines.Milling]:
        """All millings of the job, or one, by their names. Arguments as for `mill`.

        >>> import flank
        >>> list(flank.load("specs/bevel/milled_pinion.chain").millings())
        ['finish', 'other']
        """
        options = {
            "milling": name,
            "tool_centre_control": tool_centre_control,
            "feed": number(feed, "feed", 0.0),
            "spindle": number(spindle, "spindle", 0.0),
            "approach": length(approach, "approach"),
            "spaces": count(spaces, "spaces", 1, 1_000_000),
            "verify": None if verify is None else os.fspath(verify),
            "rows": count(rows, "rows", 1, 1000),
            "columns": count(columns, "columns", 1, 1000),
            "clamp": ranges(clamp),
            "certify": length(certify, "certify"),
        }
        return {
            json.loads(answer.document())["milling"]: _machines.Milling(answer, Asked(_flank.mill, self, options, place=k))
            for k, answer in enumerate(_flank.mill(self._native, options))
        }

    def mill(
        self,
        name: str | None = None,
        *,
        tool_centre_control: bool = False,
        feed: float = 600.0,
        spindle: float | None = None,
        approach: Quantity = "5 mm",
        spaces: int = 1,
        verify: Path_ | None = None,
        rows: int = 15,
        columns: int = 31,
        clamp: Mapping[str, tuple[Quantity, Quantity]] | None = None,
        certify: Quantity | None = None,
    ) -> _machines.Milling:
        """Passes of an end mill over a surface on a five-axis machine: ridges, blocks, axes; programs by `write`.

        `feed` is mm/min, `spindle` 1/min; `verify` is a program that is read back; what is left is known at `rows` times `columns` points.
        `clamp` are settings of the milling machine that may lie between two values, so that its axes go slower:
        `{"mill.work_z": ("20 mm", "120 mm")}`. `certify` proves that the cutter stays clear between its positions, too, but for so much.

        >>> import flank
        >>> flank.load("specs/bevel/milled_pinion.chain").mill("finish")["passes"]
        57
        """
        found = self.millings(
            name,
            tool_centre_control=tool_centre_control,
            feed=feed,
            spindle=spindle,
            approach=approach,
            spaces=spaces,
            verify=verify,
            rows=rows,
            columns=columns,
            clamp=clamp,
            certify=certify,
        )
        return single(found, "milling")

    def convert(
        self,
        to: Path_,
        *,
        surface: str | None = None,
        tool_frame: str | None = None,
        work_frame: str | None = None,
        fit: str | Iterable[str] = (),
        starts: int | None = None,
        positions: int = 101,
        order: int | None = None,
        tolerance: Quantity | None = None,
    ) -> _machines.Motion | _machines.Settings:
        """Carries the job over to another machine: positions of its axes and polynomials, or settings that do the same.

        `tolerance` takes the smallest order of polynomials that keeps the flank so near. `fit` names settings that are looked for.

        Raises `ConversionError` if the machine has not what it takes.

        >>> import flank
        >>> job = flank.load("specs/bevel/pinion_19x62.chain")
        >>> job.convert("specs/machines/free_form.chain", positions=11).axes.shape
        (11, 6)
        """
        options = {
            "surface": surface,
            "tool_frame": tool_frame,
            "work_frame": work_frame,
            "fit": names(fit),
            "starts": count(starts, "starts", 1, 1_000_000),
            "positions": count(positions, "positions", 1, 1_000_000),
            "order": count(order, "order", 0, 30),
            "tolerance": length(tolerance, "tolerance"),
        }
        asked = Asked(_flank.convert, self, options, (os.fspath(to),))
        answer = asked({})
        is_motion = json.loads(answer.document())["schema"].startswith("flank.convert/")
        return (_machines.Motion if is_motion else _machines.Settings)(answer, asked)

    def derive(
        self,
        *,
        latex: bool = False,
        cost: bool = False,
        to: Path_ | None = None,
        surface: str | None = None,
        tool_frame: str | None = None,
        work_frame: str | None = None,
    ) -> _machines.Derivation:
        """The derivation, stage by stage, as text or LaTeX; the axes of the machine in `to` in closed form, whose frames of tool and work
        are `tool_frame` and `work_frame`; or how many operations a point takes (`cost`).

        >>> import flank
        >>> "equation of meshing" in flank.load("specs/bevel/pinion_19x62.chain").derive().page
        True
        """
        options = {
            "latex": latex,
            "cost": cost,
            "to": None if to is None else os.fspath(to),
            "surface": surface,
            "tool_frame": tool_frame,
            "work_frame": work_frame,
        }
        asked = Asked(_flank.derive, self, options)
        return _machines.Derivation(asked({}), asked)

    def _asked(self, operation: Operation, options: dict[str, Any]) -> tuple[_flank.Answer, _results.Again]:
        answers = operation(self._native, options)
        if not answers:
            raise InputError(f"job {self.name} has nothing of that")
        return answers[0], Asked(operation, self, options, place=0)

    def _reference(self, of: Surface | str, options: dict[str, Any], key: str) -> Job | None:
        """Names the other surface in options, and gives its job if that is another one."""
        if isinstance(of, str):
            options[key] = self[of].name
            return None
        if not isinstance(of, Surface):
            raise TypeError(f"`{key}_` is {of!r}: it is a surface of a job, or its name in this one")
        options[key] = of.name
        return None if of.job is self else of.job

    def __repr__(self) -> str:
        surfaces = ", ".join(self._surfaces)
        return f"<job {self.name} ({self.file}): {surfaces}>"

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:
        surfaces = [
            [of.name, of.frame, "" if of.counts is None else f"{of.counts[0]} x {of.counts[1]}"]
            for of in self._surfaces.values()
        ]
        rows = self.parameters._rows()
        plain = f"{self!r}\n\n{_display.aligned(surfaces)}\n\n{_display.aligned(rows)}"
        parts = [
            f"<b>{html.escape(self.name)}</b> <code>{html.escape(self.file)}</code>",
            f"<p>{html.escape(self.doc)}</p>" if self.doc else "",
            self._section(),
            _display.table(surfaces, ["surface", "frame", "points"]),
            _display.table(rows, ["name", "value", "range", "given by", "meaning"]),
        ]
        return {"text/plain": plain, "text/html": "".join(parts)}

    def _section(self) -> str:
        """The section as a small picture, or the surfaces where there is none."""
        try:
            bundle = self.plot("section", size=(600, 450), formats="png")._repr_mimebundle_()
        except Exception:
            # a job without a section is shown without one
            return ""
        image = bundle.get("image/png")
        return f'<p><img alt="section" width="600" src="data:image/png;base64,{image}"/></p>' if image else ""

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Job) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def _key(self) -> tuple[Any, ...]:
        return (self.name, self.hash, tuple(sorted(self._native.set)))

    def __reduce__(self) -> tuple[Any, ...]:
        texts = self._native.texts
        return (_restored, (texts[0][0], texts, self.name, self._native.set))


def _restored(file: str, texts: list[tuple[str, str]], name: str, overrides: list[tuple[str, str]]) -> Job:
    return Job(_flank.load(file, texts, name, overrides)[0])
