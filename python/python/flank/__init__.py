"""Tooth surfaces of any machine, from text specs.

A job is loaded, solved and compared; results are arrays of numpy and documents with the names of `--json`. Lengths are mm, angles degrees,
normals point out of the material. No file is written unless a call names one.

>>> import flank
>>> job = flank.load("specs/bevel/pinion_19x62.chain")
>>> job.solve()["concave"].xyz.shape
(15, 31, 3)
"""

from __future__ import annotations

import json as _json
import os as _os
from typing import Any as _Any

from flank import _flank
from flank._asked import Asked as _Asked
from flank._errors import (
    ConversionError,
    Error,
    FileError,
    InputError,
    InternalError,
    NotSolved,
    SpecError,
    UnknownName,
)
from flank._job import Job, Surface
from flank._machines import Bricks, Derivation, Milling, Motion, Settings, Solids
from flank._pages import Page, Plot, Report
from flank._parameters import Parameter, Parameters
from flank._points import SurfacePoints
from flank._quantities import count as _count
from flank._quantities import encodable as _encodable
from flank._results import (
    Contact,
    Deviation,
    Fit,
    MeasuringGrid,
    Points,
    Result,
    Sensitivity,
    Synthesis,
    Tolerance,
)
from flank._specs import Imported, import_rexs, new, templates
from flank._study import Study, sweep

__all__ = [
    "Bricks",
    "Contact",
    "ConversionError",
    "Derivation",
    "Deviation",
    "Error",
    "FileError",
    "Fit",
    "Imported",
    "InputError",
    "InternalError",
    "Job",
    "MeasuringGrid",
    "Milling",
    "Motion",
    "NotSolved",
    "Page",
    "Parameter",
    "Parameters",
    "Plot",
    "Points",
    "Report",
    "Result",
    "Sensitivity",
    "Settings",
    "Solids",
    "SpecError",
    "Study",
    "Surface",
    "SurfacePoints",
    "Synthesis",
    "Tolerance",
    "UnknownName",
    "check",
    "codes",
    "deviation",
    "evaluator",
    "explain",
    "format",
    "import_rexs",
    "load",
    "load_all",
    "loads",
    "new",
    "schemas",
    "sweep",
    "templates",
    "test",
    "threads",
]

__version__ = _flank.VERSION

_Path = str | _os.PathLike[str]


def load(path: _Path, job: str | None = None) -> Job:
    """A job of a spec file; it is named where the file holds several.

    Raises `SpecError` with all that is wrong with the spec.

    >>> import flank
    >>> flank.load("specs/hobbing/helical_gear.chain").parameters["teeth"].value
    31.0
    """
    return _one(_flank.load(_os.fspath(path), [], job), job)


def loads(text: str, job: str | None = None, *, name: str = "text.chain") -> Job:
    """A job of a text, which is taken for the file `name`: what it uses is looked for from there.

    >>> import flank
    >>> text = open("specs/hobbing/helical_gear.chain").read()
    >>> flank.loads(text, name="specs/hobbing/mine.chain").name
    'helical_gear'
    """
    return _one(_flank.load(name, [(name, _encodable(text, "the spec"))], job), job)


def load_all(path: _Path) -> dict[str, Job]:
    """All jobs of a spec file by their names.

    >>> import flank
    >>> list(flank.load_all("specs/bevel/ease_off_19x62.chain"))
    ['pinion', 'basic', 'conjugate']
    """
    return {native.name: Job(native) for native in _flank.load(_os.fspath(path), [])}


def _one(found: list[_flank.Job], wanted: str | None) -> Job:
    if len(found) != 1:
        known = ", ".join(native.name for native in found)
        raise InputError(f"the spec holds several jobs: name one with `job=`, of {known}")
    return Job(found[0])


def deviation(surface: Surface, from_: Surface, *, align: bool = True) -> Deviation:
    """How far a surface lies off another one of the same body, um along the normal of the latter, plus is material: the ease-off.

    The surface is turned about z, a rack's shifted along y, to meet the other in the middle of its grid, unless `align` is false. Both may be of jobs with different
    values or specs.

    Raises `NotSolved` if no point of one has a place on the other.

    >>> import flank
    >>> jobs = flank.load_all("specs/bevel/ease_off_19x62.chain")
    >>> e = flank.deviation(jobs["pinion"]["concave"], from_=jobs["basic"]["concave"])
    >>> e.counts, round(e.rms, 2)
    ((25, 45), 25.77)
    """
    for what, of in (("surface", surface), ("from_", from_)):
        if not isinstance(of, Surface):
            raise TypeError(f'`{what}` is {of!r}: it is a surface of a job, for example job["concave"]')
    options = {"reference": from_.name, "no_align": not align}
    asked = _Asked(_flank.deviation, surface.job, options, (surface.name,), from_.job)
    return Deviation(asked({}), asked)._given()


def check(*specs: _Path, text: str | None = None) -> dict[str, _Any]:
    """What is wrong with spec files, or with a text: the document of `flank check --json`.

    >>> import flank
    >>> flank.check("specs/bevel/pinion_19x62.chain")["files"][0]["ok"]
    True
    """
    if text is not None:
        name = _os.fspath(specs[0]) if specs else "text.chain"
        answer = _flank.check([(name, _encodable(text, "the spec"))])
    else:
        answer = _flank.check([(_os.fspath(spec), None) for spec in specs])
    document: dict[str, _Any] = _json.loads(answer.document())
    return document


def format(text: str, *, name: str = "text.chain") -> str:
    """A spec's text as it is laid out.

    >>> import flank
    >>> flank.format("machine m{axis C:rotary}")
    'machine m { axis C : rotary }\\n'
    """
    return _flank.layout(name, _encodable(text, "the spec"))


def test(*paths: _Path, filter: str | None = None, snapshot: bool = True) -> dict[str, _Any]:
    """Checks what specs expect: the document of `flank test --json`.

    >>> import flank
    >>> flank.test("specs/hobbing/helical_gear.chain")["failed"]
    0
    """
    answer = _flank.test([_os.fspath(path) for path in paths], filter, snapshot)
    document: dict[str, _Any] = _json.loads(answer.document())
    return document


# a function of users, and no test of ours
setattr(test, "__test__", False)


def codes() -> list[dict[str, str]]:
    """All codes of findings with `severity` and `title`.

    >>> import flank
    >>> flank.codes()[0]["code"]
    'E0001'
    """
    found: list[dict[str, str]] = _json.loads(_flank.codes())
    return found


def explain(code: str) -> str:
    """The page about a code of findings, Markdown.

    >>> import flank
    >>> flank.explain("E0301").splitlines()[0]
    '# E0301: a value has the wrong dimension'
    """
    page = _flank.explain(code)
    if page is None:
        raise InputError(f"there is no code `{code}`; there is: {', '.join(one['code'] for one in codes())}")
    return page


def schemas() -> dict[str, dict[str, _Any]]:
    """The JSON schemas of all documents by their names.

    >>> import flank
    >>> "flank.solve/3" in flank.schemas()
    True
    """
    from importlib import resources

    # a file of the package: what makes them from types is a megabyte of code
    text = resources.files(__name__).joinpath("schemas.json").read_text("utf-8")
    return _json.loads(text)


def evaluator(*, machine_code: bool | None = None, boxes: int | None = None) -> dict[str, _Any]:
    """Sets how all operations of this process work numbers out from now on, and gives what it was. Without `machine_code` equations are
    interpreted, for systems that forbid executable memory; `boxes` is how many boxes a search for all branches examines. What is not given
    stays. No bit of a point depends on it.

    >>> import flank
    >>> flank.evaluator(machine_code=False)["machine_code"]
    True
    >>> flank.evaluator(machine_code=True)["machine_code"]
    False
    """
    was = _flank.evaluator(machine_code, _count(boxes, "boxes", 1, 10**12))
    return {"machine_code": was[0], "boxes": was[1]}


def threads(count: int | None = None) -> int:
    """Sets on how many threads an operation works, and gives the number before. 0, as at the beginning, shares all processors among all
    operations; 1 is for programs that parallelise outside. Without a number nothing changes. No bit of a result depends on it.

    >>> import flank
    >>> flank.threads()
    0
    """
    return _flank.threads(_count(count, "count", 0, 1024))
