"""What Dask adds to a study of chunks of about a second on one worker: python python/tests/dask_overhead.py

The log of the study has the time that each chunk took where it was computed. What the whole took longer is overhead: sending and compiling.
Beside it the same without Dask, in turns. The least of each counts: other work on the machine only adds.
"""

import json
import sys
import tempfile
import time
from pathlib import Path

import flank
from flank._cases import distributions

SPEC = "benches/spiral_bevel.chain"
CHUNKS, ROUNDS = 20, 3
# of the wall time
MOST = 0.02


def planned(folder, cases):
    """A study of so many chunks."""
    job = flank.load(SPEC, job="flank")
    scatter = distributions({"m.radial_distance": "10 um"})
    flank._flank.sweep_plan(job._native, {**scatter, "count": cases * CHUNKS, "collect": ["points"], "out": str(folder)})
    plan = json.loads((folder / "plan.json").read_text())
    (folder / "plan.json").write_text(json.dumps({**plan, "chunk": cases}))
    return flank.Study(folder)


def emptied(study):
    """The same without a row."""
    folder = Path(study.folder)
    for chunk in (folder / "chunks").iterdir():
        chunk.unlink()
    (folder / "log").unlink(missing_ok=True)


def overhead(study, run):
    """How much longer a run took than its chunks, as a share of that, and seconds of a chunk."""
    emptied(study)
    start = time.perf_counter()
    run()
    took = time.perf_counter() - start
    chunks = [json.loads(line)["seconds"] for line in (Path(study.folder) / "log").read_text().splitlines()]
    assert len(chunks) == CHUNKS
    return took / sum(chunks) - 1, sum(chunks) / CHUNKS


def main():
    from distributed import Client, LocalCluster

    with tempfile.TemporaryDirectory() as folder:
        tried = planned(Path(folder) / "tried", 10)
        tried.run((0, 1), threads=1)
        log = (Path(tried.folder) / "log").read_text().splitlines()
        each = min(json.loads(line)["seconds"] for line in log) / 10
        study = planned(Path(folder) / "study", max(1, round(1 / each)))
        with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=":0") as cluster, Client(cluster) as client:
            ways = {"without Dask": lambda: study.run(threads=1), "on one worker of Dask": lambda: study.run(on=client)}
            found = {way: [] for way in ways}
            for _ in range(ROUNDS):
                for way, run in ways.items():
                    found[way].append(overhead(study, run))
    for way, rounds in found.items():
        print(f"{way}: {100 * min(rounds)[0]:.2f} % over chunks of {min(of for _, of in rounds):.2f} s")
    return 0 if min(found["on one worker of Dask"])[0] <= MOST else 1


if __name__ == "__main__":
    sys.exit(main())
