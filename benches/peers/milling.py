"""The concave flank of specs/bevel/milled_pinion.chain milled with a ball of 1 mm: by OpenCAMLib, which drops the cutter along one fixed axis
onto triangles, and by `flank mill`, whose cutter leans and whose flank is exact.

    python3 benches/peers/milling.py target/release/flank

OpenCAMLib (`pip install opencamlib`) is given the triangles of `flank solve --format stl`, turned so that the mean normal of the flank points
up, and as many places as `flank mill` has positions. Prints a line of JSON: seconds of both, of `flank mill` those of its whole process with passes,
ridges, blocks, axes and clearances."""

import json
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import opencamlib

SPEC = "specs/bevel/milled_pinion.chain"
RADIUS = 1.0


def triangles(file):
    """A binary STL file: normals and corners."""
    data = file.read_bytes()
    (count,) = struct.unpack_from("<I", data, 80)
    rows = np.frombuffer(data, dtype=np.dtype([("numbers", "<f4", 12), ("rest", "<u2")]), count=count, offset=84)
    numbers = rows["numbers"].astype(float).reshape(count, 4, 3)
    return numbers[:, 0], numbers[:, 1:]


def turned(normals, corners):
    """Corners in a frame whose z is the mean normal."""
    up = normals.mean(axis=0)
    up /= np.linalg.norm(up)
    across = np.cross(up, [1.0, 0.0, 0.0])
    across /= np.linalg.norm(across)
    return corners @ np.array([np.cross(across, up), across, up]).T


def surface(corners):
    found = opencamlib.STLSurf()
    for corner in corners:
        found.addTriangle(opencamlib.Triangle(*(opencamlib.Point(*map(float, point)) for point in corner)))
    return found


def dropped(corners, places):
    """Heights of the tip over places, and seconds without the making of triangles."""
    flank = surface(corners)
    start = time.perf_counter()
    drop = opencamlib.BatchDropCutter()
    drop.setSTL(flank)
    drop.setCutter(opencamlib.BallCutter(2 * RADIUS, 20.0))
    drop.setThreads(1)
    for x, y in places:
        drop.appendPoint(opencamlib.CLPoint(float(x), float(y), -1000.0))
    drop.run()
    return np.array([point.z for point in drop.getCLPoints()]), time.perf_counter() - start


def main():
    program = sys.argv[1]
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        command = [program, "mill", SPEC, "finish", "--out", folder, "--json"]
        milled = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        whole = time.perf_counter() - start
        subprocess.run([program, "solve", SPEC, "--format", "stl", "--no-picture", "--out", folder], check=True, capture_output=True)
        (file,) = Path(folder).glob("*concave*.stl")
        corners = turned(*triangles(file))
    low, high = corners.reshape(-1, 3)[:, :2].min(axis=0), corners.reshape(-1, 3)[:, :2].max(axis=0)
    middle, half = 0.5 * (low + high), 0.35 * (high - low)
    counts = milled["passes"], milled["positions"]
    axes = [np.linspace(middle[k] - half[k], middle[k] + half[k], counts[k]) for k in (0, 1)]
    places = [(x, y) for x in axes[0] for y in axes[1]]
    heights, seconds = dropped(corners, places)
    told = {
        "places": len(places),
        "triangles": len(corners),
        "opencamlib_seconds": round(seconds, 4),
        "flank_mill_seconds": round(whole, 4),
        "found": int((heights > -999).sum()),
    }
    print(json.dumps(told))


if __name__ == "__main__":
    main()
