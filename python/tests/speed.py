"""How long the package takes, beside what the program takes inside. Needs a release build.

    python python/tests/speed.py
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import flank

COMMON = "benches/spiral_bevel.chain"


def median(call: Callable[[], object], times: int) -> float:
    """The median of some calls, s."""
    took = []
    for _ in range(times):
        start = time.perf_counter()
        call()
        took.append(time.perf_counter() - start)
    return statistics.median(took)


def of_import(module: str) -> float:
    """A process that imports a module, s."""
    return median(lambda: subprocess.run([sys.executable, "-c", f"import {module}"], check=True), 11)


def beside_rust(job: flank.Job, times: int) -> tuple[float, float]:
    """Solving in Python, and the median of what the program took inside of the same calls, s."""
    whole, inside = [], []
    for _ in range(times):
        start = time.perf_counter()
        points = job.solve()
        points["flank"].xyz
        whole.append(time.perf_counter() - start)
        inside.append(points.seconds or float("nan"))
    return statistics.median(whole), statistics.median(inside)


def in_threads(count: int) -> tuple[float, float]:
    """Some jobs one after the other, and each on a thread of its own, s; each operation on one thread."""
    jobs = [
        flank.load(COMMON, "flank").with_values({"rows": 101, "columns": 101, "m.tilt": f"{2 + 0.1 * k} deg"})
        for k in range(count)
    ]

    def work(job: flank.Job) -> None:
        for _ in range(10):
            job.solve(geometry=True)

    def together() -> None:
        threads = [threading.Thread(target=work, args=(job,)) for job in jobs]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

    before = flank.threads(1)
    serial = median(lambda: [work(job) for job in jobs], 3)
    parallel = median(together, 3)
    flank.threads(before)
    return serial, parallel


def main() -> None:
    """Prints all."""
    # where there is no list of processors, their number has to do
    models = Path("/proc/cpuinfo")
    lines = models.read_text().splitlines() if models.exists() else []
    model = next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), "")
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")
    print(f"{os.cpu_count()} processors {model}, load {load:.1f}, Python {sys.version.split()[0]}")
    alone, numpy, package = of_import("sys"), of_import("numpy"), of_import("flank")
    print(f"import flank beside numpy: {1e3 * (package - numpy):.1f} ms (numpy {1e3 * (numpy - alone):.1f} ms; at most 60)")

    def common() -> None:
        flank.load(COMMON, "flank").solve()["flank"].xyz

    common()
    print(f"load and solve of the common job: {1e3 * median(common, 101):.2f} ms (at most 6)")
    large = flank.load(COMMON, "flank").with_values(rows=501, columns=501)
    whole, inside = beside_rust(large, 21)
    print(f"251,001 points: {1e3 * whole:.1f} ms, inside {1e3 * inside:.1f} ms: {whole / inside:.3f} times (at most 1.2)")
    count = os.cpu_count() or 1
    serial, parallel = in_threads(count)
    print(f"{count} threads with a job each: {parallel / serial:.2f} of the serial time (at most {1.2 / count:.2f})")


if __name__ == "__main__":
    main()
