"""The concave flank of specs/bevel/milled_pinion.chain milled with a ball of 1 mm: by OpenCAMLib, which drops the cutter along one fixed axis
onto triangles, and by `flank mill`, whose cutter leans and whose flank is exact.

    python3 benches/peers/milling.py target/release/flank

OpenCAMLib (`pip install opencamlib`) is given the triangles of the flank that `flank solve --format obj` writes, turned so that their mean normal
points up, and as many places on them as `flank mill` has positions; then the same with each triangle in sixteen, as many as chords take that
are a sixteenth as far off. Both run on one thread, in turns. Prints a line of JSON: the least seconds of some rounds, of `flank mill` those
of its whole process with the flank, passes, ridges, what is left at 465 points, blocks, axes, clearances and files."""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import opencamlib

SPEC = "specs/bevel/milled_pinion.chain"
SURFACE = "concave"
RADIUS = 1.0
ROUNDS = 5
ALONE = {**os.environ, "RAYON_NUM_THREADS": "1"}


def triangles(file):
    """Corners of the triangles of the flank, and their normals."""
    points, normals, faces, name = [], [], [], ""
    for line in file.read_text().splitlines():
        word, _, rest = line.partition(" ")
        if word == "o":
            name = rest
        elif word == "v":
            points.append([float(x) for x in rest.split()])
        elif word == "vn":
            normals.append([float(x) for x in rest.split()])
        elif word == "f" and name == SURFACE:
            faces.append([int(corner.split("/")[0]) - 1 for corner in rest.split()])
    points, normals, faces = np.array(points), np.array(normals), np.array(faces)
    return points[faces], normals[faces].mean(axis=1)


def turned(corners, normals):
    """Corners in a frame whose z is the mean normal."""
    up = normals.mean(axis=0)
    up /= np.linalg.norm(up)
    across = np.cross(up, [1.0, 0.0, 0.0])
    across /= np.linalg.norm(across)
    return corners @ np.array([np.cross(across, up), across, up]).T


def finer(corners):
    """Each triangle in sixteen, in its own plane."""
    for _ in range(2):
        a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
        d, e, f = (a + b) / 2, (b + c) / 2, (c + a) / 2
        corners = np.concatenate([np.stack(of, axis=1) for of in [(a, d, f), (d, b, e), (f, e, c), (d, e, f)]])
    return corners


def spread(corners, count):
    """So many places on the triangles, evenly: each a little beside a middle."""
    which = np.arange(count) * len(corners) // count
    shares = 1 / 3 + 0.25 * np.stack([np.sin(np.arange(count)), np.cos(np.arange(count))], axis=1)
    weights = np.column_stack([shares, 1 - shares.sum(axis=1)])
    return np.einsum("ij,ijk->ik", weights, corners[which])[:, :2]


def surface(corners):
    found = opencamlib.STLSurf()
    for corner in corners:
        found.addTriangle(opencamlib.Triangle(*(opencamlib.Point(*map(float, point)) for point in corner)))
    return found


def dropped(flank, places):
    """Heights of the tip over places, and seconds without the making of triangles and points."""
    drop = opencamlib.BatchDropCutter()
    drop.setSTL(flank)
    # the library keeps no reference of its own
    cutter = opencamlib.BallCutter(2 * RADIUS, 20.0)
    drop.setCutter(cutter)
    drop.setThreads(1)
    for x, y in places:
        drop.appendPoint(opencamlib.CLPoint(float(x), float(y), -1000.0))
    start = time.perf_counter()
    drop.run()
    seconds = time.perf_counter() - start
    return np.array([point.z for point in drop.getCLPoints()]), seconds


def milled(program, folder):
    """What `flank mill` tells, and seconds of its process."""
    command = [program, "mill", SPEC, "finish", "--out", folder, "--json"]
    start = time.perf_counter()
    run = subprocess.run(command, check=True, capture_output=True, text=True, env=ALONE)
    return json.loads(run.stdout), time.perf_counter() - start


def main():
    program = sys.argv[1]
    with tempfile.TemporaryDirectory() as folder:
        found, _ = milled(program, folder)
        solve = [program, "solve", SPEC, "--format", "obj", "--no-picture", "--out", folder]
        subprocess.run(solve, check=True, capture_output=True, env=ALONE)
        corners = turned(*triangles(Path(folder) / "milled_pinion.obj"))
        places = spread(corners, found["passes"] * found["positions"])
        flanks = [(len(of), surface(of)) for of in (corners, finer(corners))]
        peers, own = [[] for _ in flanks], []
        for _ in range(ROUNDS):
            own.append(milled(program, folder)[1])
            for times, (_, flank) in zip(peers, flanks):
                heights, seconds = dropped(flank, places)
                times.append(seconds)
    told = {
        "places": len(places),
        "found": int((heights > -999).sum()),
        "flank_mill_seconds": round(min(own), 4),
        "opencamlib": [
            {"triangles": count, "seconds": round(min(times), 4), "flank_mill_times_as_long": round(min(own) / min(times), 2)}
            for (count, _), times in zip(flanks, peers)
        ],
    }
    print(json.dumps(told))


if __name__ == "__main__":
    main()
