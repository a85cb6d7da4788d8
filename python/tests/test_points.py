"""Points are arrays: without copies, read-only, with the bits of the program's files."""

import gc
import pickle

import numpy as np
import pytest
from conftest import PINION, ROOT

import flank


def test_arrays_have_the_shape_of_the_sample(job):
    points = job.solve(geometry=True)
    for name, surface in points.items():
        assert surface.counts == job[name].counts
        assert surface.xyz.shape == surface.normal.shape == (*surface.counts, 3)
        assert surface.xyz.dtype == np.float64
        # a unit vector, but for three rounded squares
        assert np.allclose(np.linalg.norm(surface.normal, axis=-1), 1, rtol=0, atol=1e-14)
    assert points["concave"]["k1"].shape == (15, 31)
    assert points["concave"]["d1"].shape == (15, 31, 3)
    assert points["concave"].units["roll"] == "deg"


def test_arrays_are_views_of_one_memory_and_cannot_be_written(job):
    concave = job.solve()["concave"]
    address = concave.xyz.__array_interface__["data"][0]
    assert concave.xyz.__array_interface__["data"][0] == address
    assert not concave.xyz.flags.owndata and not concave.xyz.flags.writeable
    with pytest.raises(ValueError):
        concave.xyz[0, 0, 0] = 1.0
    with pytest.raises(ValueError):
        concave.xyz.flags.writeable = True


def test_arrays_live_on_without_their_result(job):
    xyz = job.solve()["concave"].xyz
    before = xyz.copy()
    gc.collect()
    job.solve(sensitivity=True)
    assert (xyz == before).all()


def test_points_that_are_not_solved_are_data():
    points = flank.load("specs/hobbing/undercut_gear.chain").solve()
    lacking = [surface for surface in points.values() if not surface.solved.all()]
    assert lacking and not points.is_complete
    for surface in lacking:
        gone = surface.status == "out_of_range"
        assert np.isnan(surface.xyz[gone]).all()
        assert sum(surface.outcomes.values()) == len(surface)
        assert surface.why().startswith("not solved: ")
    with pytest.raises(flank.NotSolved) as caught:
        points.strict()
    assert caught.value.not_done[0]["kind"] == "not_solved"


def test_a_surface_with_a_dot_in_its_name_says_why():
    points = flank.load(ROOT / "specs/hobbing/ground_stock_gear.chain").solve()
    assert points["plus.flank"].outcomes["trimmed"] > 0 and "trim" in points["plus.flank"].why()
    for surface in (points[name] for name in points):
        assert bool(surface.why()) == (set(surface.outcomes) != {"solved"})


def test_large_surfaces_are_kept_unless_told_otherwise():
    large = flank.load("benches/spiral_bevel.chain", "flank").with_values(rows=300, columns=300)
    kept = large.solve(geometry=True)["flank"]
    assert kept.xyz.shape == (300, 300, 3) and kept["k1"].shape == (300, 300) and kept.solved.all()
    # the same points one by one: a coarse grid is a part of a fine one only where its rows are
    counted = large.solve(arrays=False)
    assert counted.document["surfaces"][0]["solved"] == 90_000
    with pytest.raises(flank.InputError, match="not kept"):
        counted["flank"].xyz


def test_columns_are_those_of_tables(job, tmp_path):
    points = job.solve(geometry=True)
    [path] = [file for file in job.solve().write(tmp_path, "csv")]
    plain = [line for line in open(path) if not line.startswith("#")]
    assert list(job.solve().columns()) == plain[0].strip().split(",")
    assert len(points.columns()["x"]) == 1395


def test_frames(job, tmp_path):
    polars = pytest.importorskip("polars")
    points = job.solve(geometry=True)
    frame = points.to_polars()
    assert frame.shape[0] == 1395 and frame["k1"].dtype == polars.Float64
    pandas = pytest.importorskip("pandas")
    table = points.to_pandas()
    assert table.attrs["units"]["k1"] == "1/mm" and table["x"].notna().all()
    written = points.write(tmp_path, "csv")
    read = pandas.read_csv(written[0], comment="#")
    assert (read["x"].to_numpy() == table["x"].to_numpy()).all()
    assert points["root"].to_pandas()["radius"].notna().all()


def test_xarray(job):
    pytest.importorskip("xarray")
    data = job.solve(geometry=True)["concave"].to_xarray()
    assert data["k1"].attrs["units"] == "1/mm" and data["xyz"].dims == ("i", "j", "axis")
    assert data.attrs["frame"] == "m.work"


def test_pyvista(job):
    pytest.importorskip("pyvista")
    concave = job.solve(geometry=True)["concave"]
    grid = concave.to_pyvista()
    assert grid.dimensions == (15, 31, 1)
    assert (grid.points[1] == concave.xyz[1, 0]).all() and (grid.points[15] == concave.xyz[0, 1]).all()
    assert grid.point_data["k1"][15] == concave["k1"][0, 1]


def test_files_are_written_where_they_are_asked_for(job, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    points = job.solve()
    assert list(tmp_path.iterdir()) == []
    written = points.write(tmp_path / "out", formats=["parquet", "step", "svg"])
    assert sorted(name.rsplit(".", 1)[-1] for name in written) == ["parquet", "png", "step", "svg"]
    (tmp_path / "taken").write_text("")
    with pytest.raises(flank.FileError):
        points.write(tmp_path / "taken")


def test_sensitivity_is_a_derivative(job):
    concave = job["concave"]
    step = 1e-3
    moved = job.with_values({"m.radial_distance": (concave.job.parameters["m.radial_distance"].value + step, "mm")})
    exact = concave.sensitivity("m.radial_distance")
    assert exact.units == ["um/mm"] and exact.shape == (15, 31, 1)
    found = flank.deviation(moved["concave"], from_=concave, align=False).um
    # the change of a thousandth has a second order of some 1e-3 of the first
    difference = np.nanmax(np.abs(found / step - exact["m.radial_distance"]))
    assert difference < 5e-3 * np.abs(exact.values).max()
    with pytest.raises(flank.InputError, match="m.tilting"):
        concave.sensitivity("m.tilting")


def test_names_that_are_not_there(job):
    points = job.solve(sensitivity=True)
    for of, name, known in [
        (job, "concav", "concave"),
        (job.parameters, "radial", "m.radial_distance"),
        (points, "concav", "convex"),
        (points["concave"], "k1", "roll"),
        (job["concave"].sensitivity("m.radial_distance"), "c.blade_angle", "m.radial_distance"),
    ]:
        with pytest.raises(KeyError, match=known) as caught:
            of[name]
        # an error of the package as well, and its text is no repr
        assert isinstance(caught.value, flank.InputError) and isinstance(caught.value, flank.UnknownName)
        assert f"`{name}`" in str(caught.value) and not str(caught.value).startswith(("'", '"'))
        assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)
    assert job.parameters.get("radial") is None


def test_a_relative_path_is_that_of_loading(tmp_path, monkeypatch):
    job = flank.load(PINION)
    monkeypatch.chdir(tmp_path)
    assert job.solve().is_complete
    assert job.with_values({"m.radial_distance": "98 mm"}).solve()["root"].counts == (5, 31)
