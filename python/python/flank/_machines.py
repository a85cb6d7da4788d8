"""Results that machines and solids take: axes, settings, passes, bodies, bricks, derivations."""

from __future__ import annotations

import copy
import json
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from flank._errors import NotSolved
from flank._points import Floats
from flank._quantities import Quantity, length, names
from flank._results import Path_, Result


class Motion(Result):
    """How the axes of another machine move for the same work.

    >>> import flank
    >>> job = flank.load("specs/bevel/pinion_19x62.chain")
    >>> motion = job.convert("specs/machines/free_form.chain", positions=11)
    >>> motion.axes.shape, motion.names
    ((11, 6), ['X', 'Y', 'Z', 'A', 'B', 'C'])
    """

    @property
    def names(self) -> list[str]:
        """The axes, in the order of `axes`."""
        return [one["name"] for one in self._read()["axes"]]

    @property
    def units(self) -> list[str]:
        """Their units."""
        return [one["unit"] for one in self._read()["axes"]]

    @property
    def axes(self) -> Floats:
        """Positions of the axes: (positions, axes), NaN where no posture was found."""
        return np.array([one["axes"] for one in self._read()["positions"]], dtype=float)

    @property
    def motions(self) -> Floats:
        """Values of the job's motions at these: (positions, motions)."""
        return np.array([one["motions"] for one in self._read()["positions"]], dtype=float)

    @property
    def polynomials(self) -> dict[str, Floats]:
        """Of each axis the factors of the powers of the motion less `document["polynomials"]["reference"]`, constant first."""
        found = self._read()["polynomials"]
        return {} if found is None else {name: np.array(factors) for name, factors in found["coefficients"].items()}

    def nc(self, control: str, time: float) -> str:
        """A program for a control (fanuc, siemens, linuxcnc, heidenhain) that runs the motion in a time, s."""
        return self._text(nc=[control], time=float(time))

    def function(self, language: str, form: str = "polynomials") -> str:
        """A function in c, rust or javascript that computes the axes, by `polynomials` or in `exact` closed form."""
        return self._text(emit=[language], emit_form=[form])

    def _text(self, **options: Any) -> str:
        with tempfile.TemporaryDirectory(prefix="flank-") as folder:
            files = self._write(folder, **options)
            if not files:
                raise NotSolved(str(self._answer.text()), json.dumps(self.not_done))
            return Path(files[0]).read_text()

    def write(
        self,
        folder: Path_,
        formats: str | Iterable[str] = ("csv",),
        *,
        nc: str | Iterable[str] = (),
        time: float | None = None,
        emit: str | Iterable[str] = (),
        emit_form: str | Iterable[str] = ("polynomials",),
    ) -> list[str]:
        """Writes positions and polynomials (csv, json), programs and functions."""
        options: dict[str, Any] = {"format": names(formats) or None}
        if names(nc):
            options |= {"nc": names(nc), "time": time}
        if names(emit):
            options |= {"emit": names(emit), "emit_form": names(emit_form)}
        return self._write(folder, **options)


class Settings(Result):
    """Settings of another machine with which it does the same."""

    @property
    def values(self) -> dict[str, str]:
        """The settings with their units, as `with_values` takes them."""
        return {one["name"]: f"{one['value']!r} {one['unit']}".strip() for one in self._read()["settings"]}


class Milling(Result):
    """Passes of a cutter over a surface, what they leave, and what a machine's axes do."""

    def write(
        self,
        folder: Path_,
        formats: str | Iterable[str] = ("csv",),
        *,
        nc: str | Iterable[str] = (),
        map: str | Iterable[str] = (),
    ) -> list[str]:
        """Writes cutter locations (csv, apt), programs (fanuc, siemens, linuxcnc, heidenhain) and the `map` of what is left (csv, …)."""
        return self._write(folder, format=names(formats), nc=names(nc), map=names(map))


class _Bodies(Result):
    def _is_nothing(self) -> bool:
        return not self._read()["solids"]

    @property
    def solids(self) -> dict[str, dict[str, Any]]:
        """The numbers of each body by its name."""
        return {one["name"]: copy.deepcopy(one) for one in self._read()["solids"]}


class Solids(_Bodies):
    """Bodies: volume, mass, inertia, what gauges find."""

    def write(self, folder: Path_, formats: str | Iterable[str] = ("step",), *, step: Quantity = "0.1 um") -> list[str]:
        """Writes closed meshes (stl, obj, 3mf) and smooth bodies (step, `step` near to the exact surfaces)."""
        wanted = names(formats)
        faces = length(step, "step") if "step" in wanted else None
        return self._write(folder, format=[name for name in wanted if name != "step"], step=faces)


class Bricks(_Bodies):
    """Bodies cut into bricks for finite elements."""

    def write(self, folder: Path_, formats: str | Iterable[str] = ("inp",)) -> list[str]:
        """Writes input of CalculiX and Abaqus (inp) and of ParaView (vtu)."""
        return self._write(folder, format=names(formats))


class Derivation(Result):
    """What was built from a job, stage by stage."""

    @property
    def page(self) -> str:
        """The whole derivation, as text or LaTeX; empty of a table of operations."""
        jobs = self._read()["jobs"]
        return "\n".join(one["page"] for one in jobs if "page" in one)
