"""What notebooks show of jobs and results: no text of a spec is HTML, and every picture is small enough."""

import base64
import re

import pytest
from conftest import PAIR, PINION, ROOT

import flank


def test_texts_of_specs_are_no_html():
    text = (ROOT / PINION).read_text()
    (line,) = re.findall(r"^job pinion_19x62\b.*", text, re.M)
    wild = "/// radius < 5 & more <script>alert(1)</script>\n"
    job = flank.loads(text.replace(line, wild + line), name="specs/bevel/a&b<i>.chain")
    shown = job._repr_mimebundle_()["text/html"]
    assert "<script" not in shown and "<i>" not in shown
    assert "radius &lt; 5 &amp; more &lt;script&gt;" in shown and "a&amp;b&lt;i&gt;.chain" in shown


def test_texts_about_parameters_are_no_html():
    text = (ROOT / "specs/hobbing/helical_gear.chain").read_text()
    line = re.search(r"^ *param teeth\b.*", text, re.M)[0]
    job = flank.loads(text.replace(line, "    /// <b>many</b>\n" + line), name="specs/hobbing/mine.chain")
    assert job.parameters["teeth"].doc.endswith("<b>many</b>")
    for shown in (job, job.parameters):
        assert "<b>many" not in shown._repr_mimebundle_()["text/html"]


def _pictures(bundle):
    """The bytes of each picture of a bundle."""
    if "image/svg+xml" in bundle:
        return [bundle["image/svg+xml"].encode()]
    if "image/png" in bundle:
        return [base64.b64decode(bundle["image/png"])]
    found = re.findall(r'src="data:image/[^;]+;base64,([^"]+)"', bundle.get("text/html", ""))
    return [base64.b64decode(picture) for picture in found]


@pytest.mark.parametrize(
    ("spec", "kinds"),
    [
        (PINION, [(), "gear", "section"]),
        (PAIR, [(), "gap", "surface"]),
        ("specs/bevel/milled_pinion.chain", ["gear", "milling"]),
        ("specs/hobbing/helical_gear.chain", [(), "section", "machine"]),
    ],
)
def test_every_picture_is_shown(spec, kinds):
    job = flank.load(spec)
    for what in kinds:
        plot = job.plot(what)
        bundle = plot._repr_mimebundle_()
        assert len(_pictures(bundle)) == len(plot["pictures"]), what
        assert sum(map(len, bundle.values())) < 200_000 + len(bundle["text/plain"]), what
        for picture in _pictures(bundle):
            assert picture.startswith(b"\x89PNG") or b"<svg" in picture


def test_pictures_of_several_kinds_are_all_shown(job):
    plot = job.plot(["machine", "surface", "section"], formats="svg")
    assert max(map(len, plot._files.values())) > 400_000
    assert len(_pictures(plot._repr_mimebundle_())) == len(plot["pictures"])
