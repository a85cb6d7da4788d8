"""A study on two workers of Dask: one is killed while chunks are computed, one case ends each worker that tries it. Every case has one row.

python python/tests/sweep_dask.py [CASES]
"""

import json
import os
import resource
import signal
import sys
import tempfile
import threading
import time
from pathlib import Path

import flank

SPEC = "specs/cycloidal/cycloidal_disc.chain"
# points along the profile; a case of so many asks for more memory than a worker gets
USUAL, DEADLY = 24, 600_000
# what a worker may take beyond what it has when it begins
ROOM = 1 << 30


def plugin():
    """Limits the memory of each worker, also of those that take the place of one that died."""
    from distributed import WorkerPlugin

    class Limited(WorkerPlugin):
        def setup(self, worker):
            size = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
            resource.setrlimit(resource.RLIMIT_AS, (size + ROOM, size + ROOM))

    return Limited()


def planned(cases, folder):
    """A study of 20 chunks whose last case but two is deadly. The first cases, which are tried when it is planned, are not."""
    text = Path(SPEC).read_text().replace("param pins :", "param fine : count in 2 .. 1000000 = 24\n    param pins :")
    job = flank.loads(text.replace("24 * lobes + 1", "fine * lobes + 1"), name="specs/cycloidal/fine_disc.chain")
    table = "\n".join(["fine", *[str(USUAL)] * (cases - 3), str(DEADLY), *[str(USUAL)] * 2])
    flank._flank.sweep_plan(job._native, {"table": table, "collect": ["points"], "out": str(folder)})
    plan = json.loads((folder / "plan.json").read_text())
    (folder / "plan.json").write_text(json.dumps({**plan, "chunk": cases // 20}))
    return flank.Study(folder)


def disturbed(cases, folder, client):
    """The study after one worker was killed in the middle of a chunk."""
    study = planned(cases, folder)
    client.register_plugin(plugin())
    thread = threading.Thread(target=lambda: study.run(on=client), daemon=True)
    thread.start()
    while not list((folder / "chunks").iterdir()) or not list((folder / "open").iterdir()):
        if not thread.is_alive():
            raise SystemExit("the study ended before a worker could be killed")
        time.sleep(0.001)
    os.kill(next(iter(client.run(os.getpid).values())), signal.SIGKILL)
    thread.join(600)
    if thread.is_alive():
        raise SystemExit(f"the study does not end: {client.scheduler_info()}")
    return study


def main():
    from distributed import Client, LocalCluster

    cases = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    with tempfile.TemporaryDirectory() as folder:
        with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster, Client(cluster) as client:
            study = disturbed(cases, Path(folder), client)
        print(study)
        numbers = study.columns()["number"].tolist()
        verdicts = study.progress()["verdicts"]
    return 0 if numbers == list(range(cases)) and verdicts == {"done": cases - 1, "crashed": 1} else 1


if __name__ == "__main__":
    sys.exit(main())
