"""Results leave their process: pickles and copies have the same values, and can still be written."""

import concurrent.futures
import copy
import multiprocessing
import pickle

import numpy as np
import pytest
from conftest import PAIR, PINION

import flank


def _solved(path):
    return flank.load(path).solve(geometry=True)


def _results(job):
    other = job.with_values({"m.radial_distance": "98 mm"})
    grid = other.measuring_grid("concave")
    found = job.inspect("concave", grid.xyz)
    return {
        "points": job.solve(geometry=True),
        "deviation": flank.deviation(other["concave"], from_=job["concave"]),
        "grid": grid,
        "inspected": found,
        "fit": job.fit("concave", found, vary="m.radial_distance"),
        "contact": flank.load(PAIR).contact("drive_side"),
        "tolerance": job.tolerance("concave", scatter={"m.radial_distance": "5 um"}),
        "motion": job.convert("specs/machines/free_form.chain", positions=5),
        "plot": job.plot("machine", formats="svg"),
        "derivation": job.derive(),
    }


@pytest.mark.parametrize("copied", [lambda of: pickle.loads(pickle.dumps(of)), copy.deepcopy], ids=["pickle", "deepcopy"])
def test_results_are_the_same(job, copied):
    for name, result in _results(job).items():
        again = copied(result)
        assert type(again) is type(result), name
        assert again.json() == result.json() and str(again) == str(result), name
        assert again.seconds == result.seconds and again.is_complete == result.is_complete, name
        shown, before = again._repr_mimebundle_(), result._repr_mimebundle_()
        assert shown == before, name


def test_arrays_have_the_same_bits_and_cannot_be_written(job):
    points = job.solve(geometry=True)
    again = pickle.loads(pickle.dumps(points))
    for name, grid in points.items():
        for arrays, others in [(grid.fields, again[name].fields), (grid.unknowns, again[name].unknowns)]:
            assert list(arrays) == list(others)
            for key, values in arrays.items():
                assert np.array_equal(values, others[key], equal_nan=True) and values.dtype == others[key].dtype
        assert np.array_equal(grid.xyz, again[name].xyz) and (grid.status == again[name].status).all()
        assert again[name].units == grid.units and again[name].meanings == grid.meanings and again[name].labels == grid.labels
        with pytest.raises(ValueError):
            again[name].xyz[0, 0, 0] = 1.0
        with pytest.raises(ValueError):
            again[name].fields["k1"].flags.writeable = True
    one = pickle.loads(pickle.dumps(points["concave"]))
    assert one.outcomes == points["concave"].outcomes and not one.status.flags.writeable
    gaps = flank.load(PAIR).contact("drive_side")
    assert np.array_equal(pickle.loads(pickle.dumps(gaps)).error, gaps.error, equal_nan=True)
    sensitivity = job["concave"].sensitivity("m.radial_distance")
    again = pickle.loads(pickle.dumps(sensitivity))
    assert np.array_equal(again.values, sensitivity.values) and again.units == sensitivity.units
    assert not again.values.flags.writeable


def test_what_a_surface_lacks_stays_known():
    points = flank.load("specs/hobbing/undercut_gear.chain").solve()
    again = pickle.loads(pickle.dumps(points))
    assert again["flank_plus"].why() == points["flank_plus"].why() != ""
    uncounted = pickle.loads(pickle.dumps(flank.load(PINION).solve()))
    assert uncounted["concave"].why() == ""


def _rows(file):
    """Without the heads, which name the folder that measured points lay in."""
    return [line for line in file.read_text().splitlines() if not line.startswith("#")][1:]


def test_a_copy_is_written_as_the_result_is(job, tmp_path):
    results = _results(job)
    for name in ("points", "deviation", "inspected", "contact"):
        folders = [tmp_path / name / kind for kind in ("own", "copy")]
        for folder, result in zip(folders, (results[name], pickle.loads(pickle.dumps(results[name])))):
            assert result.write(folder, "csv"), name
        own, copied = ({file.name: _rows(file) for file in folder.iterdir()} for folder in folders)
        assert own == copied, name
    fit = pickle.loads(pickle.dumps(results["fit"]))
    assert fit.job == results["fit"].job


def test_results_come_back_from_processes():
    context = multiprocessing.get_context("spawn")
    with concurrent.futures.ProcessPoolExecutor(1, mp_context=context) as pool:
        points = pool.submit(_solved, PINION).result()
    here = _solved(PINION)
    assert np.array_equal(points["concave"].xyz, here["concave"].xyz)
