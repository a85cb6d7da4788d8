"""Jobs: values, errors, equality, pickles, threads, signals, forks."""

import concurrent.futures
import multiprocessing
import os
import pickle
import re
import signal
import subprocess
import sys
import textwrap
import threading
import time
import zlib
from pathlib import Path

import numpy as np
import pytest
from conftest import PAIR, PINION, ROOT

import flank


def test_values_have_units(job):
    pint = pytest.importorskip("pint")
    units = pint.UnitRegistry()
    value = job.parameters["c.blade_angle"]
    given = ["21 deg", (21, "deg"), units.Quantity(21, "degree"), (np.float64(21), "deg")]
    values = [job.with_values({"c.blade_angle": of}).parameters["c.blade_angle"].value for of in given]
    assert values == pytest.approx([21] * 4, rel=1e-15) and value.unit == "deg"
    length = job.with_values({"m.radial_distance": units.Quantity(9.81, "cm")}).parameters["m.radial_distance"]
    assert length.value == pytest.approx(98.1, rel=1e-15)
    with pytest.raises(flank.InputError, match="a length, an angle, a number or products of them"):
        job.with_values({"c.blade_angle": units.Quantity(1, "kg")})
    # so are products: one over a length, and an angle over a length
    gear = flank.load(ROOT / "specs/double_envelope/shaped_ring_gear.chain")
    curved = [gear.with_values({"parabola": of}).parameters["parabola"].value for of in [units.Quantity(5, "1/m"), "0.005 mm^-1"]]
    assert curved == pytest.approx([0.005] * 2, rel=1e-15)
    skived = flank.load(ROOT / "specs/hobbing/skived_internal_gear.chain")
    twisted = [skived.with_values({"m.twist": of}).parameters["m.twist"].value for of in [units.Quantity(2, "deg/m"), "0.002 deg/mm"]]
    assert twisted[0] == pytest.approx(twisted[1], rel=1e-15) and twisted[0] != 0
    # a number is one in whatever unit, and no angle
    ratios = [units.Quantity(335, "percent"), units.Quantity(3350, "um/mm"), units.Quantity(3.35, "")]
    values = [job.with_values({"m.ratio_of_roll": of}).parameters["m.ratio_of_roll"].value for of in ratios]
    assert values == pytest.approx([3.35] * 3, rel=1e-15)
    with pytest.raises(flank.SpecError, match="E0301"):
        job.with_values({"c.blade_angle": units.Quantity(35, "percent")})


def test_a_value_has_a_name(job):
    for name in ("", " "):
        with pytest.raises(flank.InputError, match="without a name"):
            job.with_values({name: "1 mm"})


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"m.radial_distance": np.array([1.0, 2.0])}, "`m.radial_distance` is a text with a unit"),
        ({"m.radial_distance": (np.array([1.0]), "mm")}, "`m.radial_distance` is a text with a unit"),
        ({"m.radial_distance": np.complex128(98)}, "`m.radial_distance` is a text with a unit"),
        ({"m.radial_distance": (np.ma.masked, "mm")}, "`m.radial_distance` is a text with a unit"),
        ({"m.radial_distance": (98, None)}, "the unit of `m.radial_distance` is a text"),
        ({"m.radial_distance": (float("nan"), "mm")}, "`m.radial_distance` is a finite number"),
        ({"m.radial_distance": "98 mm \ud800"}, "`m.radial_distance` holds .* at index 6"),
        ({3: "98 mm"}, "the name of a parameter or setting is a text: not 3"),
    ],
)
def test_values_that_are_none_are_told_with_their_names(job, values, words):
    with pytest.raises(flank.InputError, match=words):
        job.with_values(values)


@pytest.mark.parametrize("call", [flank.loads, flank.format, lambda text: flank.check(text=text)])
def test_a_spec_is_a_text_of_characters(call):
    with pytest.raises(flank.InputError, match="index 3, which is half of a surrogate pair"):
        call("// \ud800")
    with pytest.raises(flank.InputError, match="the spec is a text: not b'x'"):
        call(b"x")


def test_a_job_has_the_names_of_its_surfaces(job):
    assert list(job) == list(job.surfaces) and "concave" in job and "concav" not in job


@pytest.mark.parametrize(
    ("values", "code"),
    [
        ({"m.radial_distance": 98.1}, "E0301"),
        ({"m.radial_distance": "98.1"}, "E0301"),
        ({"m.radial_distance": "98.1 deg"}, "E0301"),
        ({"m.radial_distence": "98.1 mm"}, "E0201"),
        ({"m.radial_distance": "98.1 mm ("}, "E0101"),
    ],
)
def test_wrong_values_are_errors_of_the_language(job, values, code):
    with pytest.raises(flank.SpecError) as caught:
        job.with_values(values)
    first = caught.value.errors()[0]
    assert first["code"] == code and first["message"] and first["place"]["line"] >= 1
    assert first["url"] == f"docs/errors/{code}.md" and (ROOT / first["url"]).is_file()
    assert code in str(caught.value)


def test_all_findings_come_at_once():
    text = "machine m { axis A : rotary frame f in g = rotate_z(B) }\njob j { sample s { } }"
    with pytest.raises(flank.SpecError) as caught:
        flank.loads(text)
    errors = caught.value.errors()
    assert len(errors) > 1 and len({(e["place"]["line"], e["place"]["column"]) for e in errors}) > 1
    again = pickle.loads(pickle.dumps(caught.value))
    assert again.errors() == errors and str(again) == str(caught.value)


def _wrong_texts():
    """Of each page about an error its wrong text, which a test of the project holds to have it."""
    for page in sorted((ROOT / "docs/errors").glob("E*.md")):
        kind, text = re.search(r"```chain,wrong([^\n]*)\n(.*?)```", page.read_text(), re.S).groups()
        yield pytest.param(page.stem, text, "files" in kind, id=page.stem)


def _files(text, is_several, folder):
    """The specs of a block; each of several files begins with its name."""
    parts = re.split(r"^// (\S+\.(?:chain|csv))\n", text, flags=re.M)[1:] if is_several else ["example.chain", text]
    for name, content in zip(parts[::2], parts[1::2]):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(content)
    return [folder / name for name in parts[::2] if name.endswith(".chain")]


@pytest.mark.parametrize(("code", "text", "is_several"), list(_wrong_texts()))
def test_every_code_is_raised(code, text, is_several, tmp_path):
    specs = _files(text, is_several, tmp_path)
    if code.startswith("E06"):
        # what a spec expects is looked at by `check` and `test` alone
        found = {finding["code"] for spec in flank.check(*specs)["files"] for finding in spec["findings"]}
        assert code in found and [flank.load(spec) for spec in specs]
        return
    codes = set()
    for spec in specs:
        try:
            flank.load(spec)
        except flank.SpecError as error:
            codes |= {finding["code"] for finding in error.errors()}
    assert code in codes


def test_jobs_are_equal_by_text_and_values(job):
    same = flank.load(PINION)
    assert same == job and hash(same) == hash(job)
    other = job.with_values({"m.radial_distance": "98.1 mm"})
    assert other != job and other.with_values({"m.radial_distance": "98.1 mm"}) == other
    assert other.overrides == {"m.radial_distance": "98.1 mm"}
    assert len({job, same, other}) == 2
    assert job["concave"] == same["concave"] and job["concave"] != other["concave"]


def test_jobs_are_frozen(job):
    with pytest.raises(AttributeError):
        job.name = "other"
    with pytest.raises(AttributeError):
        job.parameters["c.blade_angle"].value = 3.0


def test_parameters_are_told(job):
    swivel = flank.load(PAIR).parameters
    assert job.parameters["m.radial_distance"].given_by == "the job"
    assert job.with_values({"c.blade_angle": "21 deg"}).parameters["c.blade_angle"].given_by == "the caller"
    assert any(of.given_by not in ("the job", "the caller") for of in job.parameters.values())
    assert any(of.doc for of in swivel.values())
    with pytest.raises(KeyError, match="m.radial_distance"):
        job.parameters["radial"]


def test_a_pickle_is_text_and_values(job, tmp_path):
    folder = tmp_path / "specs"
    subprocess.run(["cp", "-r", str(ROOT / "specs"), str(folder)], check=True)
    own = flank.load(folder / "bevel/pinion_19x62.chain").with_values({"m.radial_distance": "98 mm"})
    packed = pickle.dumps(own)
    expected = own.solve()["concave"].xyz
    subprocess.run(["rm", "-r", str(folder)], check=True)
    again = pickle.loads(packed)
    assert again == own and (again.solve()["concave"].xyz == expected).all()


def test_several_jobs_are_named():
    jobs = flank.load_all("specs/bevel/ease_off_19x62.chain")
    assert list(jobs) == ["pinion", "basic", "conjugate"]
    with pytest.raises(flank.InputError, match="pinion, basic, conjugate"):
        flank.load("specs/bevel/ease_off_19x62.chain")
    assert flank.load("specs/bevel/ease_off_19x62.chain", "basic") == jobs["basic"]
    with pytest.raises(flank.SpecError) as caught:
        flank.load("specs/bevel/ease_off_19x62.chain", "gear")
    assert caught.value.errors()[0]["code"] == "E0507"
    with pytest.raises(flank.SpecError) as caught:
        flank.load("nowhere.chain")
    assert caught.value.errors()[0]["code"] == "E0001"


def test_threads_share_a_job(job):
    expected = job.solve()["concave"].xyz
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda _: job.solve()["concave"].xyz, range(8)))
    assert all((xyz == expected).all() for xyz in found)


def test_other_threads_go_on(job):
    """While an operation works, Python counts."""
    job = flank.load(PAIR)
    counted, done = [0], threading.Event()

    def count():
        while not done.is_set():
            counted[0] += 1
            time.sleep(0.001)

    other = threading.Thread(target=count)
    other.start()
    start = time.perf_counter()
    job.contact("drive_side", sensitivity=True)
    took = time.perf_counter() - start
    done.set()
    other.join()
    # a thread that sleeps a millisecond at a time is behind where processors are busy, and stands still where the interpreter is held
    assert counted[0] > 100 * took


@pytest.mark.parametrize("count", [1, 3])
def test_threads_change_no_bit(job, count):
    expected = job.solve()["concave"].xyz
    before = flank.threads(count)
    try:
        assert flank.threads() == count
        assert (job.solve()["concave"].xyz == expected).all()
    finally:
        flank.threads(before)
    with pytest.raises(flank.InputError, match="count"):
        flank.threads(-1)


def _solved(job):
    return job.solve()["concave"].xyz


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_fork_works(job):
    """The threads of a process are not there in its forks."""
    expected = _solved(job)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert all((xyz == expected).all() for xyz in pool.map(_solved, [job, job], chunksize=1))


LONG = """
    import time, flank, signal
    job = flank.load("benches/spiral_bevel.chain", "flank").with_values(rows=4000, columns=4000)
    print("begun", flush=True)
    try:
        job.solve(arrays=False)
    except KeyboardInterrupt:
        print("interrupted", flush=True)
    print(len(flank.load("specs/bevel/pinion_19x62.chain").solve()), flush=True)
"""


def test_ctrl_c_ends_a_long_solve(tmp_path):
    program = [sys.executable, "-c", textwrap.dedent(LONG)]
    with subprocess.Popen(program, stdout=subprocess.PIPE, text=True, cwd=ROOT) as process:
        assert process.stdout.readline() == "begun\n"
        time.sleep(0.2)
        start = time.perf_counter()
        process.send_signal(signal.SIGINT)
        assert process.stdout.readline() == "interrupted\n"
        took = time.perf_counter() - start
        assert process.stdout.readline() == "5\n"
        assert process.wait() == 0
    # signals are looked at each 50 ms; the rest is for a machine that has other work
    assert took < 2.0


def test_import_brings_numpy_alone():
    program = "import sys, numpy; before = set(sys.modules); import flank; print(*sorted({m.split('.')[0] for m in set(sys.modules) - before}))"
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout.split()
    assert not set(found) - set(sys.stdlib_module_names) - {"flank", "numpy"}


def test_nothing_but_data_on_the_way_out(job, capfd):
    job.solve()
    job.plot("section")
    assert capfd.readouterr() == ("", "")


def test_a_fault_is_an_exception_of_its_own():
    error = flank.InternalError("index out of bounds")
    assert isinstance(error, Exception) and "report" in str(error)
    assert issubclass(flank.FileError, OSError) and issubclass(flank.InternalError, flank.Error)


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="no /proc")
def test_memory_stays(job):
    """1,000 times load, solve, drop."""

    def resident():
        return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    common = "benches/spiral_bevel.chain"

    def cycle(times):
        for _ in range(times):
            flank.load(common, "flank").solve()

    cycle(100)
    before = resident()
    cycle(1000)
    assert resident() - before < 5e6


def test_numbers_do_not_depend_on_how_they_are_worked_out(job):
    before = flank.evaluator(machine_code=False, boxes=1000)
    try:
        assert flank.evaluator() == {"machine_code": False, "boxes": 1000}
        interpreted = job.solve()
    finally:
        flank.evaluator(**before)
    assert flank.evaluator() == before and before["machine_code"]
    compiled = job.solve()
    assert interpreted.document["instructions"] != compiled.document["instructions"]
    for name, surface in compiled.items():
        assert np.array_equal(interpreted[name].xyz, surface.xyz, equal_nan=True)
    with pytest.raises(flank.InputError, match="boxes"):
        flank.evaluator(boxes=0)


@pytest.mark.parametrize("of", [("a", "b"), (None, "b")])
def test_a_deviation_is_one_of_surfaces(job, of):
    with pytest.raises(TypeError, match="`surface` is .*: it is a surface of a job"):
        flank.deviation(*of)
    with pytest.raises(TypeError, match="`from_` is 'concave'"):
        flank.deviation(job["concave"], from_="concave")


@pytest.mark.skipif(not flank._flank.IS_RELEASE, reason="not built as wheels are")
def test_a_wheel_is_small():
    library = Path(flank._flank.__file__).read_bytes()
    assert len(zlib.compress(library)) < 8_000_000
