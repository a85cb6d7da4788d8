"""Results: documents with the names of `--json`, arrays, files, pictures."""

import json

import numpy as np
import pytest
from conftest import PAIR

import flank


@pytest.fixture(scope="module")
def results(job):
    """One result of each kind."""
    pair = flank.load(PAIR)
    other = job.with_values({"m.radial_distance": "98 mm"})
    grid = job.measuring_grid("concave")
    measured = other.measuring_grid("concave").xyz
    return {
        "flank.solve/3": job.solve(geometry=True, sensitivity=True, limits=True),
        "flank.deviation/2": flank.deviation(other["concave"], from_=job["concave"]),
        "flank.measure/1": grid,
        "flank.fit/2": job.fit("concave", measured, vary="m.radial_distance"),
        "flank.contact/2": pair.contact("drive_side", sensitivity=True, vhj=True),
        "flank.synthesis/1": pair.synthesis("centred"),
        "flank.tolerance/1": job.tolerance("concave", scatter={"m.radial_distance": "5 um"}, sweep=10),
        "flank.convert/2": job.convert("specs/machines/free_form.chain", positions=11),
        "flank.settings/1": flank.load("specs/bevel/thesis_gear.chain").convert("specs/machines/cradle.chain", fit="work_offset"),
        "flank.solid/2": job.solid(),
        "flank.mesh/1": job.mesh(elements=(3, 4, 3)),
        "flank.mill/1": flank.load("specs/bevel/milled_pinion.chain").mill("finish"),
        "flank.plot/2": job.plot("machine"),
        "flank.view/2": job.view(),
        "flank.report/3": flank.load("specs/hobbing/helical_gear.chain").report(),
        "flank.derivation/2": job.derive(),
        "flank.cost/2": job.derive(cost=True),
    }


def _schema(name):
    base = name.split("/")[0]
    return next(schema for known, schema in flank.schemas().items() if known.split("/")[0] == base)


def test_documents_keep_their_schemas(results):
    jsonschema = pytest.importorskip("jsonschema")
    for name, result in results.items():
        document = json.loads(result.json())
        assert document["schema"].split("/")[0] == name.split("/")[0]
        schema = _schema(name)
        jsonschema.validate(document, schema)
        assert set(document) <= set(schema["properties"]), name
        assert document == result.document
    for document in [flank.check("specs/bevel/pinion_19x62.chain"), flank.test("specs/hobbing/spur_gear.chain")]:
        jsonschema.validate(document, _schema(document["schema"]))


def test_documents_are_copies(results):
    result = results["flank.deviation/2"]
    result.document["rms_um"] = 0.0
    assert result["rms_um"] > 0 and result["rms_um"] == result.rms
    with pytest.raises(KeyError, match="rms_um"):
        result["rms"]


def test_results_name_no_folder_that_is_gone(results):
    for name, result in results.items():
        assert "flank-" not in result.json() and "flank-" not in str(result), name
        assert str(result), name


def test_displays_are_small(results, job):
    for name, result in results.items():
        bundle = result._repr_mimebundle_()
        assert bundle["text/plain"], name
        # the page alone is large, and is shown only by `view` and `report`
        if name not in ("flank.view/2", "flank.report/3"):
            assert sum(map(len, bundle.values())) < 200_000 + len(bundle["text/plain"]), name
    for name in ["flank.solve/3", "flank.deviation/2", "flank.measure/1", "flank.fit/2", "flank.contact/2"]:
        svg = results[name]._repr_mimebundle_()["image/svg+xml"]
        assert svg.startswith("<svg") and svg.endswith("</svg>") and "nan" not in svg, name
    shown = job._repr_mimebundle_()
    assert "m.radial_distance" in shown["text/html"] and "<img" in shown["text/html"]
    assert len(shown["text/html"]) < 200_000
    assert "97.95940290780507 mm" in shown["text/plain"]
    assert "<table" in job.parameters._repr_mimebundle_()["text/html"]


def test_the_page_stands_in_a_frame(results):
    page = results["flank.view/2"]
    shown = page._repr_mimebundle_()["text/html"]
    assert shown.startswith("<iframe srcdoc=") and "allow-same-origin" not in shown
    assert page.html.lower().startswith("<!doctype html>")


def test_deviations_are_those_of_both_values(job):
    """The order of the surfaces turns the sign."""
    other = job.with_values({"m.radial_distance": "97.96 mm"})
    there = flank.deviation(other["concave"], from_=job["concave"], align=False)
    back = flank.deviation(job["concave"], from_=other["concave"], align=False)
    # of changes of some um the second order is below a thousandth
    assert np.nanmax(np.abs(there.um + back.um)) < 1e-3 * np.nanmax(np.abs(there.um))
    same = flank.deviation(job["concave"], from_=job["concave"], align=False)
    assert np.nanmax(np.abs(same.um)) < 1e-6


def test_an_array_has_its_rows_and_columns_where_nothing_was_measured(job):
    made = job.with_values({"m.radial_distance": "98.0 mm"})
    xyz = np.array(made.measuring_grid("concave", 5, 9).xyz)
    xyz[-1] = xyz[:, -1] = np.nan
    deviation = job.inspect("concave", xyz).um
    assert deviation.shape == (5, 9) and np.isfinite(deviation).sum() == 32
    for measured in (xyz, job.inspect("concave", xyz)):
        fit = job.fit("concave", measured, vary="m.radial_distance")
        assert fit["identification"]["settings"][0]["new"] == pytest.approx(98.0, abs=1e-4)


def test_what_is_masked_was_not_measured(job):
    """As if it were NaN: to the bit, in whatever way the mask comes."""
    xyz = np.array(job.with_values({"m.radial_distance": "98.0 mm"}).measuring_grid("concave", 5, 9).xyz)
    mask = np.zeros(xyz.shape, bool)
    mask[2, 4] = mask[-1, 3, 1] = True
    with_nan = np.where(mask, np.nan, xyz)
    # the number below the mask is far beside the flank
    masked = np.ma.masked_array(np.where(mask, xyz + 0.1, xyz), mask=mask)
    expected = job.inspect("concave", with_nan)
    assert np.isnan(expected.um).sum() == 2
    for measured in (masked, list(masked), masked.astype(object), np.ma.masked_invalid(with_nan)):
        found = job.inspect("concave", measured)
        assert np.array_equal(found.um, expected.um, equal_nan=True) and found.rms == expected.rms
    new = [job.fit("concave", of, vary="m.radial_distance")["identification"]["settings"] for of in (masked, with_nan)]
    assert new[0] == new[1]


def test_messages_about_positions_name_the_array(job):
    xyz = np.array(job.measuring_grid("concave", 5, 9).xyz)
    off = xyz.copy()
    off[3, 6] += 100
    for wrong, words in [
        (xyz + 1j, "`measured` is complex"),
        (off, r"^`measured\[3, 6\]` lies"),
        (np.full_like(xyz, np.nan), "^`measured` has no point that was measured: in each of 45"),
        (np.ma.masked_array(xyz, mask=True), "^`measured` has no point that was measured"),
        ([[[1.0, 2.0, 3.0]], [[1.0, 2.0]]], "^`measured` is no array of numbers"),
        ([[["a", "b", "c"]]], "^`measured` is no array of numbers"),
    ]:
        with pytest.raises(flank.InputError, match=words):
            job.inspect("concave", wrong)
    off = np.array(job.measuring_grid("convex", 5, 9).xyz)
    # so little that the position found for both flanks stays
    off[3, 6] += 5
    with pytest.raises(flank.InputError, match=r"^`also\[3, 6\]` lies"):
        job.fit("concave", xyz, vary="m.radial_distance", also=("convex", off))


def test_a_measured_flank_gives_its_settings(job, tmp_path):
    moved = job.with_values({"m.radial_distance": "98.05 mm", "m.machine_root_angle": "15.7 deg"})
    xyz = moved.measuring_grid("concave", 5, 9).xyz
    found = job.inspect("concave", xyz)
    assert found.um.shape == (5, 9) and found["measured"] == "measured.csv" and found.rms > 1
    fit = job.fit("concave", found, vary=["m.radial_distance", "m.machine_root_angle"])
    identified = {one["name"]: one["new"] for one in fit["identification"]["settings"]}
    assert identified["m.radial_distance"] == pytest.approx(98.05, abs=1e-4)
    assert identified["m.machine_root_angle"] == pytest.approx(15.7, abs=1e-4)
    assert np.nanmax(np.abs(fit.left_um)) < 1e-2 < np.nanmax(np.abs(fit.before_um))
    assert fit.table["name"] == ["m.radial_distance", "m.machine_root_angle"]
    # the correction goes the other way
    assert fit.job.parameters["m.radial_distance"].value < job.parameters["m.radial_distance"].value
    assert set(fit.standard_deviations) == set(identified)
    assert np.sqrt(np.diag(fit.covariance)) == pytest.approx(list(fit.standard_deviations.values()), rel=1e-12)
    hole = np.array(xyz)
    hole[0, 0] = np.nan
    assert np.isnan(job.inspect("concave", hole).um[0, 0])
    grid = job.measuring_grid("concave", rows=5, columns=9)
    path = grid.write(tmp_path / "nominal.csv")
    assert open(path).read().startswith("#")
    with pytest.raises(flank.InputError, match="csv"):
        grid.write(tmp_path / "nominal.txt")


def test_a_wanted_ease_off(job):
    vary = ["m.radial_distance", "m.machine_root_angle", "m.ratio_of_roll", "m.cradle_angle", "c.outside_point_radius"]
    fit = job.fit("concave", ease_off={"crowning": (0, 20)}, from_=job["concave"], order=2, vary=vary)
    reached = fit["ease_off"]["reached"]
    assert reached["crownings_um"][1] == pytest.approx(20, abs=0.5)
    with pytest.raises(flank.InputError, match="bias"):
        job.fit("concave", ease_off={"twist": 2}, from_=job["concave"])
    with pytest.raises(flank.InputError, match="measured"):
        job.fit("concave")


def test_contacts(results):
    contact = results["flank.contact/2"]
    assert set(contact.flanks) == set(contact.paths) == {"pinion_concave", "gear_convex"}
    assert contact.flanks["gear_convex"]["gap"].shape == contact.flanks["gear_convex"].counts
    assert contact.error.shape == contact.turn.shape and len(contact.turn) > 60
    # the error is that to its middle, where it is extreme
    assert abs(contact.error).min() < 1e-6
    pair = flank.load(PAIR)
    assert set(pair.contacts()) >= {"drive_side"}
    mounted = pair.contact("drive_side", errors={"m.E": "0.1 mm"})
    assert mounted["mounted"] == [{"axis": "m.E", "value": 0.1, "unit": "mm"}]
    with pytest.raises(flank.SpecError, match="E0301"):
        pair.contact("drive_side", errors={"m.E": 0.1})


def test_motions(results, tmp_path, job):
    motion = results["flank.convert/2"]
    assert motion.axes.shape == (11, 6) and motion.motions.shape == (11, 1) and not np.isnan(motion.axes).any()
    away = np.radians(motion.motions[:, 0]) - motion["polynomials"]["reference"]
    # the polynomials are about the middle of the motion, and angles among their values are degrees
    first = motion.polynomials[motion.names[0]]
    value = np.polynomial.polynomial.polyval(away, first)
    assert np.abs(value - motion.axes[:, 0]).max() <= motion["polynomials"]["remainders"]["seen"][motion.names[0]] * 1.01
    program = motion.nc("fanuc", time=20)
    assert "G1" in program or "G01" in program
    assert "double" in motion.function("c")
    written = motion.write(tmp_path, ["csv", "json"], nc="linuxcnc", time=20)
    assert sorted(name.rsplit(".", 1)[-1] for name in written) == ["csv", "json", "ngc"]
    with pytest.raises(flank.InputError, match="lathe"):
        motion.nc("lathe", time=20)


def test_another_machine_that_cannot(job, tmp_path):
    lathe = tmp_path / "lathe.chain"
    lathe.write_text("machine lathe { axis C : rotary frame bed frame work in bed = rotate_z(C) }")
    with pytest.raises(flank.ConversionError):
        job.convert(lathe)


def test_settings_of_another_machine(results):
    settings = results["flank.settings/1"]
    assert isinstance(settings, flank.Settings) and "work_offset" in settings.values


def test_bodies_and_bricks(results, tmp_path):
    body = results["flank.solid/2"]
    numbers = body.solids["pinion"]
    assert numbers["teeth"] == 19
    # the mesh is inside by its deviation at most
    assert numbers["mesh"]["volume_mm3"] == pytest.approx(numbers["volume_mm3"], abs=0.01 * numbers["area_mm2"])
    written = body.write(tmp_path, ["step", "stl"])
    assert sorted(name.rsplit(".", 1)[-1] for name in written) == ["step", "stl"]
    bricks = results["flank.mesh/1"].write(tmp_path, ["inp", "vtu"])
    assert sorted(name.rsplit(".", 1)[-1] for name in bricks) == ["inp", "vtu"]


def test_milling(results, tmp_path):
    milling = results["flank.mill/1"]
    assert milling["passes"] > 1 and milling["cusp"]["height_um"] > 0
    written = milling.write(tmp_path, "csv", nc="heidenhain", map="json")
    assert sorted(name.rsplit(".", 1)[-1] for name in written) == ["csv", "h", "json"]


def test_milling_options():
    job = flank.load("specs/bevel/milled_pinion.chain")
    found = job.mill("finish", rows=3, columns=4, clamp={"mill.work_z": ("20 mm", "120 mm")}, certify="5 um")
    assert (found["map"]["rows"], found["map"]["columns"], found["map"]["points"]) == (3, 4, 12)
    (setting,) = found["clamping"]["settings"]
    assert setting["name"] == "mill.work_z"
    (kept,) = found["clearances"]
    assert abs(kept["proven"]["limit"] - 0.095) < 1e-12 and kept["proven"]["proven"] == kept["proven"]["blocks"]
    for clamp, message in [({"mill.work_z": "20 mm"}, "write two values"), ({"mill.no": ("1 mm", "2 mm")}, "mill.no")]:
        with pytest.raises(flank.InputError, match=message):
            job.mill("finish", clamp=clamp)


def test_a_contact_with_a_milled_flank():
    pair = flank.load("specs/pairs/milled_pair.chain")
    plain, milled = pair.contact(), pair.contact(milled="finish")
    assert plain["milled"] is None and milled["milled"]["milling"] == "finish"


def test_pictures(job, tmp_path):
    picture = job.plot("section")
    assert picture.save(tmp_path / "s.svg") == str(tmp_path / "s.svg")
    assert (tmp_path / "s.svg").read_text() == picture.svg
    both = job.plot(["section", "machine"], formats="svg")
    assert list(both.pictures) == ["section", "machine"]
    with pytest.raises(flank.InputError, match="section, machine"):
        both.save(tmp_path / "both.svg")
    with pytest.raises(flank.InputError, match="pdf"):
        job.plot("section", formats="pdf")
    with pytest.raises(flank.InputError, match="drawing"):
        job.plot("drawing")


def test_reports_hold_the_numbers(results, tmp_path):
    report = results["flank.report/3"]
    path = report.save(tmp_path / "report.html")
    assert open(path).read() == report.html
    assert report["asked"] > 0


def test_derivations(job):
    assert "\\" in job.derive(latex=True).page
    cost = job.derive(cost=True)
    assert cost.page == "" and cost["jobs"][0]["surfaces"]


@pytest.mark.parametrize(
    "call",
    [
        lambda job: job.solid(deviation=0.01),
        lambda job: job.solid(deviation="0 um"),
        lambda job: job.solid(density=-1),
        lambda job: job.solid("half"),
        lambda job: job.mesh(teeth=0),
        lambda job: job.mesh(elements=(1, 1, 1)),
        lambda job: job.mesh(order=3),
        lambda job: job.measuring_grid("concave", rows=1),
        lambda job: job.measuring_grid("concave", margin=(0.6, 0.1)),
        lambda job: job.inspect("concave", [[1.0, 2.0, 3.0]]),
        lambda job: job.inspect("concave", np.zeros((5, 9, 3))),
        lambda job: job.fit("concave", "grid.csv", share=2),
        lambda job: job.fit("concave", "grid.csv", thickness="thin"),
        lambda job: job.tolerance("concave", scatter={"m.radial_distance": "5 furlongs"}),
        lambda job: job.tolerance("concave", correlations={("m.radial_distance", "c.blade_angle"): 1.0}),
        lambda job: job.contact(),
        lambda job: job.mill(),
        lambda job: job.plot("section", size=(1, 1)),
        lambda job: job.plot("section", size=(1000,)),
        lambda job: job.mesh(elements=(3, 4)),
        lambda job: job.mesh(elements=(3, 4, 3, 5)),
        lambda job: job.synthesis("centred"),
        lambda job: job.solve().write("x", "dwg"),
        lambda job: flank.explain("E9999"),
    ],
)
def test_what_does_not_go_together_is_told(job, call):
    with pytest.raises(flank.Error) as caught:
        call(job)
    assert not isinstance(caught.value, flank.InternalError) and str(caught.value)


def test_what_gives_nothing_raises_why(job):
    pair = flank.load(PAIR)
    for call in (pair.solid, pair.mesh, lambda: flank.deviation(job["concave"], from_=pair["gear_convex"])):
        with pytest.raises(flank.NotSolved) as caught:
            call()
        assert caught.value.not_done and caught.value.not_done[0]["message"] in str(caught.value)


def test_what_is_not_written_is_told():
    def answer(files, *missing):
        not_done = [{"kind": "no_body", "of": of, "place": None, "message": f"{of} is open", "details": ["close it"]} for of in missing]
        return flank._flank.Answer(json.dumps({"files": files, "not_done": not_done}), "bodies", None, [], [])

    def bodies(files, *missing):
        return flank.Solids(answer([], "known"), lambda more: answer(files, *missing))

    assert bodies(["a.stl"], "known").write("x") == ["a.stl"]
    with pytest.warns(UserWarning, match="b is open\n  close it"):
        assert bodies(["a.stl"], "known", "b").write("x") == ["a.stl"]
    with pytest.raises(flank.NotSolved, match="known is open\n  close it") as caught:
        bodies([], "known").write("x")
    assert caught.value.not_done[0]["of"] == "known"
    assert str(bodies([])) == "bodies\n\nknown is open\n  close it"


def test_what_is_not_done_is_shown(job):
    lacking = flank.load("specs/hobbing/undercut_gear.chain").solve()
    reason = lacking.not_done[0]["message"]
    assert reason in str(lacking) and reason in lacking._repr_mimebundle_()["text/plain"]
    assert "not solved" not in str(job.solve())


def test_reports_are_written_as_markdown(results, tmp_path):
    files = results["flank.report/3"].write(tmp_path, ["html", "md"])
    assert {name.rsplit(".", 1)[-1] for name in files} >= {"html", "md"}


def test_one_of_several_millings_is_drawn():
    job = flank.load("specs/bevel/milled_pinion.chain")
    names = {milling: job.plot("milling", milling=milling, formats="svg").svg for milling in ("finish", "other")}
    assert names["finish"] != names["other"]


def test_frames_of_another_machine(job):
    derived = job.derive(to="specs/machines/free_form.chain", tool_frame="cutter", work_frame="work")
    assert derived.page
    with pytest.raises(flank.Error, match="nowhere"):
        job.derive(to="specs/machines/free_form.chain", tool_frame="nowhere")
