"""Pages of the book about Python: their examples are run, and what they print is compared."""

import doctest
import re
import shlex

import pytest
from conftest import ROOT


def _examples(page):
    """Blocks of Python, with fences as blank lines so that outputs end."""
    kept, inside = [], False
    for line in page.read_text().splitlines():
        if line.startswith("```"):
            inside = line == "```python"
            kept.append("")
        else:
            kept.append(line if inside else "")
    return "\n".join(kept) + "\n"


@pytest.mark.parametrize("page", ["docs/python.md", "docs/studies.md", "README.md"])
def test_examples_do_what_they_say(page, tmp_path, monkeypatch):
    text = _examples(ROOT / page)
    globs = {"out": tmp_path}
    test = doctest.DocTestParser().get_doctest(text, globs, page, page, 0)
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    report = []
    runner.run(test, out=report.append)
    assert runner.failures == 0, "".join(report)
    assert test.examples or page == "README.md"


def test_the_tolerance_study_of_the_page(tmp_path, monkeypatch, capsys):
    """Table, command and histogram of docs/studies.md, with fewer cases than there."""
    import flank

    page = (ROOT / "docs/studies.md").read_text().split("## A tolerance study of a bevel pair")[1]
    scripts = re.findall(r"```text\n((?:import|from) .*?)```", page, re.DOTALL)
    assert len(scripts) == 2 and "10_000" in scripts[0]
    (command,) = re.findall(r"^    flank sweep (.*)$", page, re.MULTILINE)
    spec, *options = shlex.split(command)
    options = dict(zip(options[::2], options[1::2]))
    assert set(options) == {"--cases", "--collect", "--out"}
    monkeypatch.chdir(tmp_path)
    scope = {}
    exec(scripts[0].replace("10_000", "60"), scope)
    cases, collect, out = (options[name] for name in ("--cases", "--collect", "--out"))
    study = flank.sweep(flank.load(ROOT / spec), cases, collect=collect, out=out)
    assert study.progress()["verdicts"] == {"done": 60}
    exec(scripts[1], scope)
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 10 and all(re.match(r" *[0-9.]+ \.\. +[0-9.]+ urad +[0-9]+", line) for line in lines), lines
    # as many as there are, about the mean that the page states
    assert scope["counts"].sum() == 60 and abs(scope["error"].mean() - 141.42) < 0.2


def test_matlab_names_what_there_is():
    """Names behind `py.flank` and methods in the page for MATLAB."""
    import flank

    # what follows goes through files
    page = (ROOT / "docs/matlab.md").read_text().split("## Through files")[0]
    names = set(re.findall(r"py\.flank\.(\w+)", page))
    assert names and all(hasattr(flank, name) for name in names), names
    known = {name for kind in vars(flank).values() if isinstance(kind, type) for name in dir(kind)}
    methods = set(re.findall(r"\b(?:job|other|points|concave|e|grid|found|fit|motion|contact|pair|picture)\.(\w+)", page))
    assert methods <= known, methods - known


def _as_python(line):
    """A line of MATLAB as Python: cells are lists, pairs of `pyargs` are keywords, arrays of numpy stay what they are."""
    for cell, listed in ("{", "["), ("}", "]"):
        line = line.replace(cell, listed)
    line = re.sub(r'pyargs\((.*?)\)(?=\))', r"**dict(pairs(\1))", line)
    line = re.sub(r"@\((.*?)\)", r"lambda \1:", re.sub(r"\bfrom\b", "of", line))
    return re.sub(r"\btrue\b", "True", line)


def test_the_calls_from_matlab_run(tmp_path, monkeypatch):
    """The ten jobs of the page for MATLAB, line by line, with what MATLAB itself does left out."""
    import operator

    import numpy as np

    import flank

    page = (ROOT / "docs/matlab.md").read_text().split("## Through files")[0]
    block = next(block for block in re.findall(r"```matlab\n(.*?)```", page, re.DOTALL) if "py.flank.load" in block)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "specs").symlink_to(ROOT / "specs")

    class Python:
        pass

    py = Python()
    py.flank, py.operator, py.dict = flank, operator, dict
    pairs = lambda *of: zip(of[::2], of[1::2])
    scope = {"py": py, "pairs": pairs, "int32": int, "double": lambda of: np.asarray(of, float), "logical": np.asarray, "string": str}
    calls = 0
    for line in block.splitlines():
        line = line.strip().rstrip(";")
        if not line or line.startswith(("%", "surf(", "column =", "T = table", "contourf(")):
            continue
        if "measured.csv" in line:
            made = scope["job"].with_values({"m.radial_distance": "98.02 mm"})
            made.measuring_grid("concave", 5, 9).write("measured.csv")
        exec(_as_python(line), scope)
        calls += 1
    assert calls > 20
    assert scope["xyz"].shape == (15, 31, 3) and scope["solved"].all()
    assert scope["axes_of_machine"].shape == (101, 6) and scope["program"].startswith("%")
    assert (tmp_path / "section.svg").is_file() and (tmp_path / "out/pinion_19x62.step").is_file()
