"""Each sampled job of specs/: positions in Python and in the CSV of `flank solve` have the same bits.

    python python/tests/same_bits.py [PROGRAM]

PROGRAM is `flank` as it was built; without it, files come from `write` of the package, which takes the same way as the program.
"""

from __future__ import annotations

import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import flank


def written(spec: Path, job: str, folder: str, program: str | None) -> Path:
    """The CSV of a job."""
    if program is None:
        return Path(next(file for file in flank.load(spec, job).solve(arrays=False).write(folder, "csv")))
    command = [program, "solve", str(spec), "--job", job, "--no-picture", "--out", folder]
    # 3 says that points are not solved, which is compared as well
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 3):
        raise RuntimeError(done.stderr)
    return Path(folder) / f"{job}.csv"


def positions(path: Path) -> dict[str, np.ndarray]:
    """Of each surface its positions point by point, NaN where a point has none."""
    with open(path, newline="") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        found: dict[str, list[list[float]]] = {}
        for row in rows:
            found.setdefault(row["surface"], []).append([float(row[axis] or "nan") for axis in "xyz"])
    return {name: np.array(of) for name, of in found.items()}


def compared(spec: Path, name: str, job: flank.Job, program: str | None) -> tuple[int, int]:
    """Points of a job, and those whose bits differ."""
    points = job.solve()
    with tempfile.TemporaryDirectory() as folder:
        of_file = positions(written(spec, name, folder, program))
    # a line that takes nothing has no rows
    surfaces = {surface: grid.xyz.reshape(-1, 3) for surface, grid in points.items() if len(grid)}
    if set(surfaces) != set(of_file):
        raise AssertionError(f"{spec}, {name}: surfaces {sorted(surfaces)} and {sorted(of_file)}")
    count = different = 0
    for surface, xyz in surfaces.items():
        other = of_file[surface]
        if xyz.shape != other.shape:
            raise AssertionError(f"{spec}, {name}, {surface}: {xyz.shape} and {other.shape}")
        # no NaN equals another; of all else the bits count, also those of a negative zero
        same = (xyz.view(np.uint64) == np.ascontiguousarray(other).view(np.uint64)) | (np.isnan(xyz) & np.isnan(other))
        count, different = count + len(xyz), different + int((~same.all(axis=1)).sum())
    return count, different


def main(program: str | None = None) -> int:
    """Compares all, and says how many."""
    jobs = points = wrong = 0
    for spec in sorted(Path("specs").rglob("*.chain")):
        if not any(line.startswith("job ") for line in spec.read_text().splitlines()):
            continue
        for name, job in flank.load_all(spec).items():
            if all(surface.counts is None for surface in job.surfaces.values()):
                continue
            count, different = compared(spec, name, job, program)
            jobs, points, wrong = jobs + 1, points + count, wrong + different
            if different:
                print(f"{spec}, {name}: {different} of {count} points differ")
    print(f"{jobs} jobs, {points} points, {wrong} differ")
    return int(wrong > 0 or jobs == 0)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
