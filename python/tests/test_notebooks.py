"""The notebooks run, print what they hold, and are read as pages of the book."""

import re

import pytest
from conftest import ROOT

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")

NOTEBOOKS = sorted((ROOT / "python/notebooks").glob("*.ipynb"))


def _texts(cell):
    # how a stream is cut into pieces depends on the clock
    yield "".join("".join(output.text) for output in cell.get("outputs", []) if output.output_type == "stream")
    for output in cell.get("outputs", []):
        if "data" in output and "text/plain" in output.data:
            yield "".join(output.data["text/plain"])


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path):
    kept = nbformat.read(path, as_version=4)
    again = nbformat.read(path, as_version=4)
    nbclient.NotebookClient(again, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(ROOT)}}).execute()
    for before, after in zip(kept.cells, again.cells):
        if before.cell_type == "code":
            assert list(_texts(before)) == list(_texts(after)), before.source
    pictures = [output for cell in again.cells for output in cell.get("outputs", []) if "image/svg+xml" in output.get("data", {})]
    assert pictures and all(len("".join(output.data["image/svg+xml"])) < 200_000 for output in pictures)
    assert path.stat().st_size < 600_000


def test_each_notebook_is_a_page():
    from make_pages import page

    assert len(NOTEBOOKS) == 3
    summary = (ROOT / "docs/SUMMARY.md").read_text()
    for path in NOTEBOOKS:
        kept = ROOT / "docs/notebooks" / f"{path.stem}.md"
        pictures = []
        assert kept.read_text() == page(path, pictures), f"{kept.name}: python python/tests/make_pages.py renews it"
        for number, picture in enumerate(pictures, 1):
            assert (ROOT / f"docs/images/{path.stem}_{number}.svg").read_text() == picture
        assert re.search(rf"\(notebooks/{path.stem}\.md\)", summary)
