"""Studies: rows, tables, what is refused, folders that move, workers of Dask that die."""

import csv
import io
import json
import math
import os
import pickle
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import sweep_dask
from conftest import PAIR, PINION, ROOT

import flank

PROGRAM = Path(os.environ.get("FLANK_PROGRAM", ROOT / "target/debug/flank"))
SCATTER = {"m.radial_distance": "10 um", "blade_angle": ("uniform", "1 arcmin")}
COLLECT = ["ease_off:concave", "points"]


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    job = flank.load(ROOT / PINION)
    return flank.sweep(job, scatter=SCATTER, count=96, seed=7, collect=COLLECT, out=tmp_path_factory.mktemp("study") / "a")


def emptied(study, folder, size):
    """The same study without a row, in chunks of so many cases."""
    shutil.copytree(study.folder, folder)
    for chunk in (folder / "chunks").iterdir():
        chunk.unlink()
    plan = json.loads((folder / "plan.json").read_text())
    (folder / "plan.json").write_text(json.dumps({**plan, "chunk": size}))
    return flank.Study(folder)


def chunks(study):
    """Names and bytes of all that is computed; nothing is still open."""
    assert not list((Path(study.folder) / "open").iterdir())
    return {chunk.name: chunk.read_bytes() for chunk in (Path(study.folder) / "chunks").iterdir()}


def command(*arguments):
    return subprocess.run([PROGRAM, "sweep", *map(str, arguments)], check=True, capture_output=True, text=True).stdout


@pytest.mark.skipif(not PROGRAM.is_file(), reason="the program is not built")
def test_rows_are_those_of_the_command(study, tmp_path):
    scatter = ["--scatter", "m.radial_distance=normal(10um)", "--scatter", "blade_angle=uniform(1arcmin)"]
    collect = [word for of in COLLECT for word in ("--collect", of)]
    command(PINION, *scatter, "--count", 96, "--seed", 7, *collect, "--out", tmp_path / "b")
    text = command("gather", tmp_path / "b")
    assert command("gather", study.folder) == text
    heads, *rows = csv.reader(io.StringIO(text))
    columns = study.columns()
    assert list(columns) == heads and len(rows) == 96
    for head, cells in zip(heads, zip(*rows)):
        of = columns[head]
        if of.dtype.kind == "U":
            assert of.tolist() == list(cells)
        else:
            assert of.tolist() == [float(cell) for cell in cells]


def test_frames_have_the_columns(study):
    pandas, polars = pytest.importorskip("pandas"), pytest.importorskip("polars")
    columns = study.columns()
    frame = study.frame()
    assert isinstance(frame, pandas.DataFrame) and list(frame) == list(columns) and len(frame) == 96
    other = study.frame("polars")
    assert isinstance(other, polars.DataFrame) and other.columns == list(columns)
    for head, values in columns.items():
        assert frame[head].tolist() == other[head].to_list() == values.tolist()
    assert frame["verdict"].eq("done").all() and frame["m.radial_distance [mm]"].dtype == float
    with pytest.raises(flank.InputError, match="'pandas' or 'polars'"):
        study.frame("arrow")


def test_tables_come_as_columns_frames_and_files(job, tmp_path):
    pandas, polars = pytest.importorskip("pandas"), pytest.importorskip("polars")
    table = {"m.radial_distance [um]": [97900, np.float64(98000.1), np.int64(98100)], "c.blade_angle [deg]": [20, 20.1, 1 / 3 + 20]}
    file = tmp_path / "cases.csv"
    pandas.DataFrame(table).to_csv(file, index=False)
    several = [table, pandas.DataFrame(table), polars.DataFrame({k: map(float, v) for k, v in table.items()}), file, str(file)]
    found = [flank.sweep(job, of, collect="at:concave[7,15]", out=tmp_path / str(k)) for k, of in enumerate(several)]
    texts = [chunks(study) for study in found]
    assert all(text == texts[0] for text in texts)
    for head, values in table.items():
        assert found[0].columns()[head].tolist() == [float(value) for value in values]


def test_ranges_are_all_combinations(job, tmp_path):
    vary = {"m.radial_distance": ("97.9 mm", (98.1, "mm"), 3), "c.blade_angle": ("20 deg", "20.5 deg", 2)}
    found = flank.sweep(job, vary=vary, collect="at:concave[7,15]", out=tmp_path / "a").columns()
    assert found["m.radial_distance [mm]"].tolist() == [97.9, 97.9, 98, 98, 98.1, 98.1]
    assert found["c.blade_angle [deg]"].tolist() == [20, 20.5] * 3


def test_what_a_case_lacks_is_told(tmp_path):
    disc = flank.load("specs/cycloidal/cycloidal_disc.chain")
    study = flank.sweep(disc, {"eccentricity [mm]": [1, 6]}, collect="at:side[0,0]", out=tmp_path / "a")
    assert study.failed() == [{"number": 1, "eccentricity [mm]": 6.0, "verdict": "spec wrong", "why": "E0309"}]
    assert study.progress()["verdicts"] == {"done": 1, "spec wrong": 1}
    assert math.isnan(list(study.columns().values())[-1][1])
    late = flank.sweep(disc, {"eccentricity [mm]": [1]}, collect="at:side[0,0]", limit=1e-9, out=tmp_path / "late")
    assert [one["verdict"] for one in late.failed()] == ["limit"]
    assert late.run(again="limit").failed()[0]["verdict"] == "limit"


def test_the_whole_table_is_looked_at_before_anything_runs(job, tmp_path):
    head = "m.radial_distance [mm]"
    refused = [
        ({"m.radial_distance": [98]}, "`cases`: column `m.radial_distance` has no unit: write `m.radial_distance [mm]`"),
        ({"m.radial_distance [deg]": [98]}, "`deg` is no unit of it"),
        ({"m.radial [mm]": [98]}, "has no parameter, setting or axis of a contact `m.radial`"),
        ({head: [98, "x", 50000]}, "`cases`, row 1: `'x'` is no number"),
        ({head: [98, "x", 50000]}, "`cases`, row 2: `m.radial_distance` is 50000 mm, outside its range"),
        ({head: [98, None]}, "`cases`, row 1: `None` is no number"),
        ({head: [math.nan]}, "no finite number"),
        ({head: np.ma.masked_array([98.0, 97.0], mask=[False, True])}, "row 1: `masked` is no number"),
        ({head: np.array([98.0, 98 + 1j])}, "row 0: `np.complex128(98+0j)` is no number"),
        ({head: [98, True, "98"]}, "row 1: `True` is no number"),
        ({head: [98, "", "1,2\n#"]}, "row 1: `''` is no number"),
        ({head: []}, "the study has no case"),
        ({head: [98], "c.blade_angle [deg]": [20, 21]}, "different lengths"),
        ({head: 98}, "write a list of numbers"),
        ({}, "has no column"),
        (98, "a dictionary of columns, a frame"),
    ]
    for table, known in refused:
        with pytest.raises(flank.InputError) as caught:
            flank.sweep(job, table, collect="points", out=tmp_path / "a")
        assert known in str(caught.value), str(caught.value)
        assert not (tmp_path / "a").exists()


@pytest.mark.skipif(not PROGRAM.is_file(), reason="the program is not built")
def test_rows_in_parquet_are_the_columns(study, tmp_path):
    polars = pytest.importorskip("polars")
    command("gather", study.folder, "--out", tmp_path / "rows.parquet")
    frame = polars.read_parquet(tmp_path / "rows.parquet")
    columns = study.columns()
    assert frame.columns == list(columns)
    assert all((frame[head].to_numpy() == of).all() for head, of in columns.items())


def test_a_run_does_not_look_at_other_chunks(study, tmp_path):
    """A study that is open computes chunk by chunk, and sees that its plan or its texts have changed."""
    begun = emptied(study, tmp_path / "a", 16)
    opened = flank._flank.OpenStudy(begun.folder)
    for chunk in (4, 1):
        document = json.loads(opened.run((chunk, chunk), [], 1).document())
        assert document["done"] == 1 and document["verdicts"] == {"done": 16}
    assert opened.is_current() and begun.progress()["done"] == 2
    text = Path(begun.folder) / "spec/bevel/pinion_19x62.chain"
    text.write_text(text.read_text() + "\n// changed\n")
    assert not opened.is_current()


def test_what_does_not_go_together_is_refused(job, tmp_path):
    ends = ("97.9 mm", "98.1 mm", 2)
    refused = [
        ({}, "say by one of `cases`, `vary` and `scatter`"),
        ({"vary": {"m.radial_distance": ends}, "scatter": {"m.radial_distance": "1 um"}}, "say by one of"),
        ({"vary": {"m.radial_distance": ends[:2]}}, "write two ends and how many values"),
        ({"vary": {"m.radial_distance": (*ends[:2], 0)}}, "whole number from 1"),
        ({"vary": {}}, "names nothing"),
        ({"scatter": {"m.radial_distance": 0.01}}, "error[E0301]: `m.radial_distance` must be a length"),
        ({"scatter": {"m.radial_distance": ("cauchy", "1 um")}}, "'normal' or 'uniform'"),
        ({"scatter": {"m.radial": "1 um"}}, "has no parameter"),
        ({"vary": {"m.radial_distance": ends}, "collect": "poinst"}, "write points, requirements, limits"),
        ({"vary": {"m.radial_distance": ends}, "collect": []}, "what becomes of each case"),
        ({"vary": {"m.radial_distance": ends}, "limit": 0}, "`limit` is 0"),
        ({"scatter": {"m.radial_distance": "1 um"}, "seed": -1}, "`seed` is -1"),
        ({"cases": tmp_path / "nothing.csv"}, "nothing.csv"),
    ]
    for arguments, known in refused:
        with pytest.raises(flank.Error) as caught:
            flank.sweep(job, **{"collect": "points", "out": tmp_path / "a", **arguments})
        assert known in str(caught.value), str(caught.value)
    # a value of the language is refused with its words
    with pytest.raises(flank.SpecError) as caught:
        flank.sweep(job, vary={"m.radial_distance": (97.9, 98.1, 2)}, collect="points", out=tmp_path / "a")
    assert caught.value.errors()[0]["code"] == "E0301"
    with pytest.raises(flank.InputError, match="is no study"):
        flank.Study(tmp_path / "a")


def test_a_study_moves_and_goes_on(study, tmp_path):
    whole = emptied(study, tmp_path / "whole", 16).run()
    begun = emptied(study, tmp_path / "begun", 16).run((0, 1)).run((3, 3), threads=1)
    with pytest.warns(UserWarning, match="3 of 6 chunks"):
        rows = begun.columns()
    assert rows["number"].tolist() == [*range(32), *range(48, 64)] and begun.progress()["done"] == 3
    shutil.move(begun.folder, tmp_path / "moved")
    moved = pickle.loads(pickle.dumps(flank.Study(tmp_path / "moved"))).run()
    assert chunks(moved) == chunks(whole) and len(chunks(moved)) == 6
    for wrong in [(0, 6), (2, 1)]:
        with pytest.raises(flank.InputError, match="the study has chunks 0 to 5"):
            moved.run(wrong)
    for wrong in [3, (0,), ("a", "b"), (-1, 2)]:
        with pytest.raises(flank.InputError, match="`chunks` is"):
            moved.run(wrong)
    plan = Path(moved.folder) / "plan.json"
    plan.write_text(plan.read_text().replace(flank.__version__, "9.9.9"))
    with pytest.raises(flank.InputError, match="was made by flank 9.9.9"):
        moved.run()


def test_a_damaged_chunk_is_told_and_computed_anew(study, tmp_path):
    whole = emptied(study, tmp_path / "whole", 16).run()
    damaged = flank.Study(shutil.copytree(whole.folder, tmp_path / "damaged"))
    chunk = next((Path(damaged.folder) / "chunks").iterdir())
    chunk.write_text("".join(chunk.read_text().splitlines(keepends=True)[:9]))
    assert damaged.progress()["done"] == 5 and len(damaged.progress()["damaged"]) == 1
    with pytest.warns(UserWarning, match="not counted: 1 of 6 chunks"):
        rows = damaged.columns()
    assert len(rows["number"]) == 80 and set(rows["verdict"]) == {"done"}
    assert chunks(damaged.run()) == chunks(whole)


def test_another_study_is_refused(job, study):
    with pytest.raises(flank.InputError, match="holds another study"):
        flank.sweep(job, scatter=SCATTER, count=96, seed=8, collect=COLLECT, out=study.folder)


def test_mounting_errors_of_a_contact(tmp_path):
    pair = flank.load(PAIR)
    study = flank.sweep(pair, {"m.E [mm]": [0, 0.02]}, collect="contact:drive_side", out=tmp_path / "a")
    found = study.columns()["contact:drive_side.peak_to_peak [urad]"]
    known = pair.contact("drive_side", errors={"m.E": "0.02 mm"}, positions=24)["error"]["peak_to_peak"]
    assert found[1] == pytest.approx(known, abs=1e-6)


def test_ctrl_c_ends_a_study_and_it_goes_on(study, tmp_path):
    begun = emptied(study, tmp_path / "begun", 8)

    def interrupt():
        while not list((Path(begun.folder) / "chunks").iterdir()):
            time.sleep(0.01)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        begun.run(threads=1)
    thread.join()
    assert 0 < begun.progress()["done"] < 12
    assert begun.run().frame("pandas")["number"].tolist() == list(range(96))


@pytest.fixture(scope="module")
def client():
    distributed = pytest.importorskip("distributed", exc_type=ImportError)
    cluster = distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0")
    with cluster, distributed.Client(cluster) as client:
        yield client


def test_dask_computes_the_same_bytes(job, study, tmp_path, client):
    there = flank.sweep(job, scatter=SCATTER, count=96, seed=7, collect=COLLECT, out=tmp_path / "a", on=client)
    assert all((there.columns()[head] == of).all() for head, of in study.columns().items())
    with pytest.raises(flank.InputError, match="is a client of Dask"):
        there.run(on="tcp://somewhere")
    # what a worker refuses is raised here
    (Path(there.folder) / "spec/bevel/pinion_19x62.chain").write_text("")
    with pytest.raises(flank.InputError, match="not those that the study was planned with"):
        there.run(on=client)


def test_workers_that_are_killed_lose_nothing(study, tmp_path, client):
    whole = emptied(study, tmp_path / "whole", 6).run()
    killed = emptied(study, tmp_path / "killed", 6)
    thread = threading.Thread(target=lambda: killed.run(on=client), daemon=True)
    thread.start()
    folder = Path(killed.folder)
    for done in (1, 4, 9):
        while len(list((folder / "chunks").iterdir())) < done or not list((folder / "open").iterdir()):
            assert thread.is_alive()
            time.sleep(0.002)
        # one of the two that work
        pid = next(iter(client.run(os.getpid).values()))
        os.kill(pid, signal.SIGKILL)
    thread.join(120)
    assert not thread.is_alive()
    assert killed.columns()["number"].tolist() == list(range(96))
    assert chunks(killed) == chunks(whole) and len(chunks(killed)) == 16


def test_dask_is_imported_only_by_who_has_a_client(tmp_path):
    code = "import sys, flank; flank.Study; sys.exit(any(name in sys.modules for name in ('dask', 'distributed', 'pandas')))"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


def test_a_case_that_ends_its_workers_is_a_row(tmp_path):
    distributed = pytest.importorskip("distributed", exc_type=ImportError)
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster:
        with distributed.Client(cluster) as client:
            study = sweep_dask.disturbed(100, tmp_path / "a", client)
    assert study.columns()["number"].tolist() == list(range(100))
    assert [(one["number"], one["verdict"]) for one in study.failed()] == [(97, "crashed")]


def test_workers_that_are_not_there_are_waited_for_and_told_of(study, tmp_path, monkeypatch):
    distributed = pytest.importorskip("distributed", exc_type=ImportError)
    monkeypatch.setattr(flank._dask, "_LOOKED", 0.05)
    waits = emptied(study, tmp_path / "a", 48)
    with distributed.LocalCluster(n_workers=0, threads_per_worker=1, dashboard_address=":0") as cluster:
        with distributed.Client(cluster) as client, pytest.warns(UserWarning, match="no worker of Dask is there"):
            threading.Timer(1.0, lambda: cluster.scale(1)).start()
            waits.run(on=client)
    assert waits.columns()["number"].tolist() == list(range(96))


def test_a_job_of_a_text_keeps_its_text(tmp_path):
    text = Path(PINION).read_text().replace("job pinion_19x62", "job mine")
    job = flank.loads(text, name="specs/bevel/not_there.chain")
    study = flank.sweep(job, {"m.radial_distance [mm]": [98]}, collect="points", out=tmp_path / "a")
    assert study.columns()["verdict"].tolist() == ["done"] and study.progress()["job"] == "mine"


def test_cases_that_come_again_keep_their_numbers(job, tmp_path):
    study = flank.sweep(job, {"m.radial_distance [mm]": [98] * 8}, collect="at:concave[7,15]", out=tmp_path / "a")
    again = emptied(study, tmp_path / "b", 2).run()
    assert again.columns()["number"].tolist() == list(range(8)) and len(chunks(again)) == 4


def test_parts_are_all_chunks_and_none_twice(study, tmp_path):
    from flank._study import _begun

    parted = emptied(study, tmp_path / "parted", 10)
    numbers = [list(_begun((part, 3), 10)) for part in range(3)]
    assert sum(numbers, []) == list(range(10))
    known = set()
    for part in range(3):
        parted.run(part=(part, 3))
        new = set(chunks(parted)) - known
        assert len(new) == len(numbers[part])
        known |= new
    assert len(known) == 10 and parted.progress()["verdicts"] == study.progress()["verdicts"]
    assert (parted.columns()["points.solved"] == study.columns()["points.solved"]).all()
    for wrong in ((3, 3), (0, 0), 1):
        with pytest.raises(flank.InputError, match="part"):
            parted.run(part=wrong)
    with pytest.raises(flank.InputError, match="leave one"):
        parted.run((0, 1), part=(0, 2))


def test_rows_are_written_as_the_command_gathers_them(study, tmp_path):
    polars = pytest.importorskip("polars")
    assert study.write(tmp_path / "rows.csv") == str(tmp_path / "rows.csv")
    rows = list(csv.DictReader(open(tmp_path / "rows.csv", newline="")))
    assert [float(row["points.solved"]) for row in rows] == study.columns()["points.solved"].tolist()
    table = polars.read_parquet(study.write(tmp_path / "rows.parquet"))
    assert table["points.solved"].to_list() == study.columns()["points.solved"].tolist()
    lacking = emptied(study, tmp_path / "lacking", 96)
    with pytest.warns(UserWarning, match="chunk"):
        lacking.write(tmp_path / "none.csv")


def test_a_study_without_a_folder_leaves_none(job, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    study = flank.sweep(job, {"m.radial_distance [mm]": [97.9, 98.1]}, collect="points", limit="60s")
    folder = Path(study.folder)
    assert folder.is_dir() and not list(tmp_path.iterdir())
    assert (pickle.loads(pickle.dumps(study)).columns()["points.solved"] == 1395).all()
    del study
    assert not folder.exists()
    with pytest.raises(flank.InputError, match="60s"):
        flank.sweep(job, {"m.radial_distance [mm]": [97.9]}, collect="points", limit="a minute")
