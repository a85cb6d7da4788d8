"""Units of options are those of the language, and what misses one is told as the language tells it."""

import pytest
from conftest import PAIR

import flank
from flank import _flank
from flank._quantities import _parsed


def test_units_are_those_of_the_language(job):
    """Whatever `with_values` takes, options take, of the same size."""
    units = _flank.units()
    assert {"mm", "inch", "cm", "rev", "arcsec"} <= set(units)
    for unit in units:
        kind, size = _parsed(f"0.25 {unit}", "x", "")
        name, factor = ("m.radial_distance", 1.0) if kind == "length" else ("m.cradle_angle", 57.29577951308232)
        try:
            value = job.with_values({name: f"0.25 {unit}"}).parameters[name].value
        except flank.SpecError as error:
            # beyond a range, and no other fault
            assert {one["code"] for one in error.errors()} == {"E0307"}, unit
            continue
        assert value == pytest.approx(size * factor, rel=1e-14), unit
    sizes = {unit: _parsed(f"1 {unit}", "x", "") for unit in units}
    assert sizes["inch"] == ("length", 25.4) and sizes["cm"] == ("length", 10.0) and sizes["um"] == ("length", 1e-3)
    assert sizes["rev"][0] == "angle" and sizes["rev"][1] == pytest.approx(6.283185307179586)
    # products by their powers of length and angle, as results show them and as the language writes them
    assert _parsed("2/mm", "x", "") == _parsed("2 1/mm", "x", "") == _parsed("2 mm^-1", "x", "") == ("-1,0", 2.0)
    assert _parsed("2 mm/rad", "x", "") == ("1,-1", 2.0) and _parsed("2 mm*rad", "x", "") == ("1,1", 2.0)
    # the Greek letter is read alike
    assert _parsed("1 μm", "x", "") == ("length", 1e-3)


@pytest.mark.parametrize("amount", ["0.001 m", "0.001 in", "1 nm", "5 furlongs"])
def test_other_units_are_refused_with_those_that_there_are(job, amount):
    with pytest.raises(flank.InputError, match="units are mm, um, .*inch"):
        job.tolerance("concave", scatter={"m.radial_distance": amount})


def test_lengths_of_the_language_scatter(job):
    found = [
        job.tolerance("concave", scatter={"m.radial_distance": amount}).standard_deviations["bias"]
        for amount in ("0.001 inch", "0.00254 cm", "25.4 um")
    ]
    assert found == pytest.approx([found[0]] * 3, rel=1e-12)


@pytest.mark.parametrize(
    ("call", "option", "name"),
    [
        (lambda job, pair: job.tolerance("concave", scatter={"m.radial_distance": 5}), "scatter", "m.radial_distance"),
        (lambda job, pair: job.tolerance("concave", scatter={"m.radial_distance": "5 deg"}), "scatter", "m.radial_distance"),
        (lambda job, pair: job.tolerance("concave", budget={"bias": 3}), "budget", "bias"),
        (lambda job, pair: pair.tolerance("pinion_concave", scatter={"m.E": 5}), "scatter", "m.E"),
        (lambda job, pair: pair.contact("drive_side", errors={"m.E": 0.1}), "errors", "m.E"),
        (lambda job, pair: pair.contact("drive_side", errors={"m.E": "2 arcmin"}), "error", "m.E"),
        (lambda job, pair: pair.plot("gap", errors={"m.E": 0.1}), "errors", "m.E"),
        (
            lambda job, pair: flank.sweep(job, scatter={"m.radial_distance": ("uniform", 5)}, collect="points", count=2),
            "scatter",
            "m.radial_distance",
        ),
        (lambda job, pair: flank.sweep(pair, scatter={"m.E": 5}, collect="contact:drive_side", count=2), "scatter", "m.E"),
        (
            lambda job, pair: job.fit(
                "concave",
                ease_off={"crowning": (0, 20)},
                from_=job["concave"],
                vary="m.radial_distance",
                round={"m.radial_distance": 0.1},
            ),
            "round",
            "m.radial_distance",
        ),
        (lambda job, pair: job.solid(deviation=0.01), "deviation", "deviation"),
        (lambda job, pair: job.convert("specs/machines/free_form.chain", tolerance=0.1), "tolerance", "tolerance"),
        (lambda job, pair: pair.contact("drive_side", compound="1 deg"), "compound", "compound"),
    ],
)
def test_what_misses_a_unit_is_a_finding(job, call, option, name):
    with pytest.raises(flank.SpecError, match="E0301") as caught:
        call(job, flank.load(PAIR))
    (finding,) = caught.value.errors()
    assert finding["code"] == "E0301" and finding["message"].startswith(f"`{name}` must be a")
    assert finding["place"]["file"] == f"option `{option}`" and finding["help"]
    assert f" --> option `{option}`:1:{finding['place']['column']}" in str(caught.value)


def test_findings_of_options_read_as_those_of_values(job):
    texts, findings = [], []
    for call in (lambda: job.with_values({"m.radial_distance": 98.5}), lambda: job.tolerance("concave", scatter={"m.radial_distance": 98.5})):
        with pytest.raises(flank.SpecError) as caught:
            call()
        texts.append(str(caught.value))
        findings.append(caught.value.errors()[0])
    assert set(findings[0]) == set(findings[1])
    assert findings[0]["help"] == findings[1]["help"] == "give it a unit: `98.5 mm`"
    own, other = (text.rstrip().replace("option `set`", "").replace("option `scatter`", "") for text in texts)
    assert own.replace("`radial_distance`", "`m.radial_distance`") == other
