"""The examples of other engines, each for the two chunks of a study."""

import importlib.util
import os
import subprocess
import sys
import textwrap

import pytest
from conftest import PINION, ROOT
from test_sweep import PROGRAM, chunks, emptied

import flank

EXAMPLES = ROOT / "python/examples"

pytestmark = pytest.mark.skipif(not PROGRAM.is_file(), reason="the program is not built")


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    scatter = {"m.radial_distance": "10 um"}
    study = flank.sweep(flank.load(ROOT / PINION), scatter=scatter, count=24, collect="at:concave[7,15]", out=folder / "a")
    return emptied(study, folder / "whole", 12).run()


def ran(folder, *arguments, **environment):
    """What a program prints in a folder, where engines put files of their own."""
    path = os.pathsep.join([str(PROGRAM.parent), os.environ["PATH"]])
    variables = {**os.environ, "PATH": path, **environment}
    run = subprocess.run([*map(str, arguments)], env=variables, cwd=folder, capture_output=True, text=True, timeout=120)
    assert run.returncode == 0, run.stderr
    return run.stdout


def has(package):
    return importlib.util.find_spec(package) is not None


@pytest.mark.parametrize(("chunks_of", "tasks"), [(12, 2), (12, 1), (10, 2), (24, 3)])
def test_an_array_of_slurm_as_its_tasks_see_it(whole, tmp_path, chunks_of, tasks):
    """The script with the variables that Slurm sets, for arrays that divide the chunks and others; Slurm itself does not run."""
    study, known = emptied(whole, tmp_path / "a", chunks_of), emptied(whole, tmp_path / "b", chunks_of).run()
    for task in range(5, 5 + tasks):
        variables = {"ID": task, "MIN": 5, "COUNT": tasks}
        ran(tmp_path, EXAMPLES / "sweep_slurm.sh", study.folder, **{f"SLURM_ARRAY_TASK_{k}": str(v) for k, v in variables.items()})
    assert chunks(study) == chunks(known) and study.progress()["done"] == len(chunks(known))


@pytest.mark.skipif(not has("ray"), reason="Ray is not installed: it is 600 MB")
def test_ray(whole, tmp_path):
    study = emptied(whole, tmp_path / "a", 12)
    assert "2 there" in ran(tmp_path, sys.executable, EXAMPLES / "sweep_ray.py", study.folder, RAY_USAGE_STATS_ENABLED="0")
    assert chunks(study) == chunks(whole)


@pytest.mark.skipif(not has("hyperqueue"), reason="HyperQueue is not installed")
def test_hyperqueue(whole, tmp_path):
    study = emptied(whole, tmp_path / "a", 12)
    served = f"""
        import subprocess, sys
        from hyperqueue.cluster import LocalCluster
        with LocalCluster({str(tmp_path)!r}) as cluster:
            cluster.start_worker()
            sys.exit(subprocess.call([sys.executable, {str(EXAMPLES / "sweep_hyperqueue.py")!r}, {study.folder!r}, {str(tmp_path)!r}]))
    """
    assert "2 there" in ran(tmp_path, sys.executable, "-c", textwrap.dedent(served))
    assert chunks(study) == chunks(whole)
