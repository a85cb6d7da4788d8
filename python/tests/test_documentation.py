"""Pages of the book about Python: their examples are run, and what they print is compared."""

import doctest
import re

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
