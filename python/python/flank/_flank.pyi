from typing import Any, final

import numpy as np
import numpy.typing as npt

__all__ = [
    "Answer",
    "Grid",
    "Job",
    "VERSION",
    "check",
    "codes",
    "contact",
    "convert",
    "derive",
    "deviation",
    "explain",
    "fit",
    "layout",
    "load",
    "measure",
    "mesh",
    "mill",
    "plot",
    "report",
    "schemas",
    "solid",
    "solve",
    "sweep_columns",
    "sweep_plan",
    "sweep_run",
    "sweep_status",
    "synthesis",
    "test",
    "threads",
    "tolerance",
    "view",
]

VERSION: str

_Options = dict[str, Any]
_Floats = npt.NDArray[np.float64]

@final
class Answer:
    grids: list[Grid]
    covariance: list[list[float]]
    def document(self) -> str: ...
    def text(self) -> str: ...
    def seconds(self) -> float | None: ...

@final
class Grid:
    name: str
    frame: str
    counts: tuple[int, int]
    labels: tuple[str, str]
    xyz: Any
    normal: Any
    status: Any
    words: list[str]
    residual: Any
    unknowns: dict[str, tuple[str, _Floats]]
    fields: dict[str, tuple[str, str, _Floats]]

@final
class Job:
    name: str
    file: str
    hash: str
    set: list[tuple[str, str]]
    texts: list[tuple[str, str]]
    doc: str
    warnings: str
    def parameters(
        self,
    ) -> list[tuple[str, float, str, tuple[float, float] | None, float | None, str, str | None, bool, bool]]: ...
    def surfaces(self) -> list[tuple[str, str, tuple[int, int] | None]]: ...

def load(
    path: str, texts: list[tuple[str, str]], name: str | None = None, set: list[tuple[str, str]] = ...
) -> list[Job]: ...
def solve(job: Job, options: _Options) -> list[Answer]: ...
def solid(job: Job, options: _Options) -> list[Answer]: ...
def mesh(job: Job, options: _Options) -> list[Answer]: ...
def plot(job: Job, options: _Options) -> list[Answer]: ...
def report(job: Job, options: _Options) -> list[Answer]: ...
def view(job: Job, options: _Options) -> list[Answer]: ...
def contact(job: Job, options: _Options) -> list[Answer]: ...
def mill(job: Job, options: _Options) -> list[Answer]: ...
def measure(job: Job, options: _Options) -> list[Answer]: ...
def deviation(job: Job, surface: str, options: _Options, other: Job | None = None) -> Answer: ...
def fit(job: Job, surface: str, options: _Options, other: Job | None = None) -> Answer: ...
def synthesis(job: Job, want: str, options: _Options) -> Answer: ...
def tolerance(job: Job, surface: str, options: _Options) -> Answer: ...
def convert(job: Job, to: str, options: _Options) -> Answer: ...
def derive(job: Job, options: _Options) -> Answer: ...
def check(specs: list[tuple[str, str | None]]) -> Answer: ...
def layout(path: str, text: str) -> str: ...
def test(paths: list[str], filter: str | None = None, snapshot: bool = True) -> Answer: ...
def codes() -> str: ...
def explain(code: str) -> str | None: ...
def schemas() -> list[tuple[str, str]]: ...
def sweep_plan(job: Job, options: _Options) -> Answer: ...
def sweep_run(
    study: str, chunks: tuple[int, int] | None = None, again: list[str] = ..., threads: int | None = None
) -> Answer: ...
def sweep_status(study: str) -> Answer: ...
def sweep_columns(study: str) -> tuple[Answer, dict[str, Any]]: ...
def threads(count: int | None = None) -> int: ...
