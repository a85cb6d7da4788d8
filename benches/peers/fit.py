#!/usr/bin/env python3
"""The settings of a measured flank by other solvers: SciPy's `least_squares` on the same residuals, and Ipopt on points and settings together, as
SpyGO has it. Ten measured grids of the 19 x 62 pinion, each with other deviations, noise and settings; then an ease-off of 11 x 22 points, crownings of
50 and 25 um from the flank itself.

    python3 benches/peers/fit.py target/release/flank

Times are of the processor: of flank the whole process, of the others the search alone. Needs NumPy, SciPy and CasADi. The flank is written here
once more, from the frames of specs/machines/cradle.chain and the blade of specs/tools/face_mill.chain; only the nominal points come from the program.
"""
import csv
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import casadi as ca
import numpy as np
from scipy.optimize import least_squares

SPEC = "specs/bevel/pinion_19x62.chain"
# name in the spec, value in mm, rad or 1, and the scale in which flank counts it
MINUTES = np.radians(1 / 6)
SETTINGS = {
    "m.radial_distance": (97.95940290780507, 0.1),
    "m.cutter_tilt": (0.0, MINUTES),
    "m.work_offset": (0.0, 0.1),
    "m.sliding_base": (0.0, 0.1),
    "m.machine_root_angle": (np.radians(15.64096727073747), MINUTES),
    "m.machine_center_to_crossing_point": (-0.001306176586991889, 0.1),
    "m.ratio_of_roll": (3.339685914944047, 0.0334),
    "m.modified_roll_2c": (0.0, 0.01),
    "c.blade_angle": (np.radians(20), MINUTES),
}
CRADLE_ANGLE = np.radians(-52.79674678267486)
POINT_RADIUS, BLADE_RADIUS = 95.9517390193892, 2e6
JOBS = [
    ["m.radial_distance", "m.machine_root_angle", "m.work_offset"],
    ["m.radial_distance", "m.work_offset", "m.ratio_of_roll"],
    ["m.machine_root_angle", "m.ratio_of_roll"],
    ["m.radial_distance", "m.sliding_base", "m.ratio_of_roll"],
    ["m.work_offset", "m.machine_center_to_crossing_point"],
    ["m.radial_distance", "m.machine_root_angle", "c.blade_angle"],
    ["m.ratio_of_roll", "c.blade_angle"],
    ["m.radial_distance", "m.ratio_of_roll", "c.blade_angle"],
    ["m.cutter_tilt", "m.ratio_of_roll"],
    ["m.machine_root_angle", "m.work_offset", "m.ratio_of_roll"],
]
OF_EASE_OFF = ["m.radial_distance", "m.ratio_of_roll", "c.blade_angle"]


def rotation(axis, angle):
    c, s = ca.cos(angle), ca.sin(angle)
    rows = {
        "x": [[1, 0, 0], [0, c, -s], [0, s, c]],
        "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
    }[axis]
    return ca.vertcat(*[ca.horzcat(*row) for row in rows])


def flank(names):
    """Position and normal in the work frame, of blade turn (times its radius), theta and roll."""
    s, theta, roll = ca.SX.sym("s"), ca.SX.sym("theta"), ca.SX.sym("roll")
    x = ca.SX.sym("x", len(names))
    value = lambda name: x[names.index(name)] if name in names else SETTINGS[name][0]
    lean = value("c.blade_angle")
    turn = s / BLADE_RADIUS
    chord = 2 * BLADE_RADIUS * ca.sin(turn / 2)
    radius, height = POINT_RADIUS + chord * ca.sin(lean + turn / 2), -chord * ca.cos(lean + turn / 2)
    along = lean + turn
    point = ca.vertcat(radius * ca.cos(theta), radius * ca.sin(theta), height)
    normal = ca.vertcat(ca.cos(along) * ca.cos(theta), ca.cos(along) * ca.sin(theta), ca.sin(along))
    to_swivel = rotation("x", -(CRADLE_ANGLE + roll))
    in_cutter = rotation("z", value("m.cutter_tilt")) @ rotation("y", -np.pi / 2)
    bed = to_swivel @ (in_cutter @ point + ca.vertcat(0, 0, value("m.radial_distance")))
    normal = to_swivel @ (in_cutter @ normal)
    shifted = bed + ca.vertcat(value("m.sliding_base"), value("m.work_offset"), 0)
    head = rotation("y", value("m.machine_root_angle")) @ shifted - ca.vertcat(0, 0, value("m.machine_center_to_crossing_point"))
    work = -value("m.ratio_of_roll") * (roll - value("m.modified_roll_2c") * roll**2 / 2)
    position = rotation("z", work) @ head
    normal = rotation("z", work) @ (rotation("y", value("m.machine_root_angle")) @ normal)
    return (s, theta, roll), x, position, normal


class Problem:
    """Feet of points on the flank: unknowns s, theta, roll and the distance d along the normal."""

    def __init__(self, names, points, starts):
        self.names, self.points, self.starts = names, points, starts
        (s, theta, roll), x, position, normal = flank(names)
        distance, turn, point = ca.SX.sym("d"), ca.SX.sym("t"), ca.SX.sym("p", 3)
        unknowns = ca.vertcat(s, theta, roll, distance)
        turned = rotation("z", turn) @ point
        meshing = ca.dot(normal, ca.jacobian(position, roll))
        self.equations = ca.vertcat(position + distance * normal - turned, meshing)
        self.foot = ca.Function("foot", [unknowns, x, turn, point], [self.equations])
        slopes = ca.jacobian(self.equations, unknowns)
        count = len(points)
        self.step = ca.Function("step", [unknowns, x, turn, point], [self.equations, slopes]).map(count)
        along = [-ca.jacobian(position, x).T @ normal, ca.dot(normal, ca.jacobian(turned, turn))]
        self.slopes = ca.Function("slopes", [unknowns, x, turn, point], [ca.vertcat(*along)]).map(count)
        self.values = starts.copy()

    def feet(self, x):
        count = len(self.points)
        arguments = [np.tile(x[:-1], (count, 1)).T, np.full((1, count), x[-1]), self.points.T]
        for _ in range(30):
            off, slopes = self.step(self.values.T, *arguments)
            matrices = np.array(slopes).T.reshape(count, 4, 4).transpose(0, 2, 1)
            by = np.linalg.solve(matrices, np.array(off).T[:, :, None])[:, :, 0]
            self.values = self.values - by
            if np.abs(by).max() < 1e-13:
                break
        return arguments

    def residuals(self, x):
        self.feet(x)
        return self.values[:, 3].copy()

    def jacobian(self, x):
        arguments = self.feet(x)
        return np.array(self.slopes(self.values.T, *arguments)).T

    def scipy(self):
        start = np.array([SETTINGS[name][0] for name in self.names] + [0.0])
        scales = np.array([SETTINGS[name][1] for name in self.names] + [0.1 / 34])
        self.values = self.starts.copy()
        begin = time.process_time()
        found = least_squares(
            self.residuals, start, jac=self.jacobian, method="trf", x_scale=scales, xtol=1e-15, ftol=1e-15, gtol=1e-15
        )
        return found.x, np.sqrt(np.mean(found.fun**2)), time.process_time() - begin

    def ipopt(self):
        count = len(self.points)
        x, turn, unknowns = ca.MX.sym("x", len(self.names)), ca.MX.sym("t"), ca.MX.sym("u", 4, count)
        scales = np.array([SETTINGS[name][1] for name in self.names])
        start = np.array([SETTINGS[name][0] for name in self.names])
        settings = start + scales * x
        equations = self.foot.map(count)(unknowns, ca.repmat(settings, 1, count), ca.repmat(turn, 1, count), self.points.T)
        cost = 1e6 * ca.sumsqr(unknowns[3, :])
        nlp = {"x": ca.vertcat(x, turn, ca.vec(unknowns)), "f": cost, "g": ca.vec(equations)}
        options = {"ipopt.print_level": 0, "print_time": 0, "ipopt.tol": 1e-14, "ipopt.sb": "yes"}
        solver = ca.nlpsol("fit", "ipopt", nlp, options)
        first = np.concatenate([np.zeros(len(self.names) + 1), self.starts.reshape(-1)])
        begin = time.process_time()
        found = solver(x0=first, lbg=0, ubg=0)
        elapsed = time.process_time() - begin
        distances = np.array(found["x"]).reshape(-1)[len(self.names) + 1 :].reshape(count, 4)[:, 3]
        return np.sqrt(np.mean(distances**2)), elapsed, solver.stats()["iter_count"]


def nominal(program, folder, counts):
    rows, columns = (str(count) for count in counts)
    command = [program, "measure", SPEC, "--surface", "concave", "--rows", rows, "--columns", columns, "--out", folder]
    subprocess.run(command, check=True, capture_output=True)
    lines = [line for line in (Path(folder) / "pinion_19x62.grid.csv").read_text().splitlines() if not line.startswith("#")]
    rows = [row for row in csv.DictReader(lines) if row.get("part", "grid") == "grid"]
    take = lambda names: np.array([[float(row[name]) for name in names] for row in rows])
    return [(row["row"], row["column"]) for row in rows], take(["x", "y", "z"]), take(["nx", "ny", "nz"])


def starts(points):
    """Feet of the nominal points, by Newton from places all over the blade."""
    (s, theta, roll), x, position, normal = flank([])
    unknowns = ca.vertcat(s, theta, roll)
    point = ca.SX.sym("p", 3)
    off = ca.vertcat(position - point)
    step = ca.Function("step", [unknowns, point], [off, ca.jacobian(off, unknowns)])
    meshing = ca.Function("meshing", [unknowns], [ca.dot(normal, ca.jacobian(position, roll))])
    found = []
    for p in points:
        for begin in [(5, t, r) for t in np.radians([90, 105, 120, 135, 150]) for r in [-0.15, 0.0, 0.15]]:
            at = np.array(begin, float)
            for _ in range(40):
                f, slopes = (np.array(part) for part in step(at, p))
                by = np.linalg.lstsq(slopes, f[:, 0], rcond=None)[0]
                at = at - by
                if np.abs(by).max() < 1e-12:
                    break
            if np.abs(np.array(step(at, p)[0])).max() < 1e-7 and abs(float(meshing(at))) < 1e-5 and 0 < at[0] < 14:
                found.append([*at, 0.0])
                break
        else:
            sys.exit(f"no start leads to {p}")
    return np.array(found)


class Grid:
    """The nominal points of a grid, their feet, and their places from -1 to 1 in both directions."""

    def __init__(self, program, folder, counts):
        self.places, self.points, self.normals = nominal(program, folder, counts)
        self.starts = starts(self.points)
        places = np.array([[int(row), int(column)] for row, column in self.places])
        self.v, self.u = ((2 * (places[:, k] - 1) / (counts[k] - 1) - 1) for k in range(2))


def of_children():
    """Seconds of the processor that ended processes took."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def compared(program, folder, grid, names, off):
    """Of points that lie off by so much, um: what flank leaves beside SciPy, as a share, with a line of all numbers."""
    table = Path(folder) / "measured.csv"
    lines = [f"{row},{column},{value!r}" for (row, column), value in zip(grid.places, off.tolist())]
    table.write_text("row,column,deviation_um\n" + "\n".join(lines) + "\n")
    command = [program, "fit", SPEC, "concave", "--measured", str(table), "--vary", ",".join(names), "--json", "--within", "1mm"]
    begin = of_children()
    told = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    elapsed = of_children() - begin
    problem = Problem(names, grid.points + 1e-3 * off[:, None] * grid.normals, grid.starts)
    _, by_scipy, scipy_time = problem.scipy()
    by_ipopt, ipopt_time, iterations = problem.ipopt()
    by_flank = told["identification"]["left_um"]
    apart = abs(by_flank / (1e3 * by_scipy) - 1)
    name = ",".join(name.split(".")[1][:10] for name in names)
    print(
        f"{name:32} {by_flank:13.9f}  {1e3 * by_scipy:13.9f}  {1e3 * by_ipopt:13.9f}  {apart:9.1e}  {elapsed:8.3f} {scipy_time:8.3f} "
        f"{ipopt_time:8.3f} ({iterations})"
    )
    return apart


def main():
    program = sys.argv[1]
    random = np.random.default_rng(21)
    with tempfile.TemporaryDirectory() as folder:
        grid = Grid(program, folder, [5, 9])
        v, u = grid.v, grid.u
        print("settings                          flank um       SciPy um       Ipopt um     share off   flank s  SciPy s  Ipopt s (iterations)")
        worst = 0.0
        for names in JOBS:
            c = random.normal(size=5) * [6, 6, 3, 3, 3]
            off = c[0] * v + c[1] * u + c[2] * v * v + c[3] * u * u + c[4] * u * v + 0.5 * random.normal(size=len(v))
            worst = max(worst, compared(program, folder, grid, names, off))
        grid = Grid(program, folder, [11, 22])
        worst = max(worst, compared(program, folder, grid, OF_EASE_OFF, -50 * grid.v**2 - 25 * grid.u**2))
    print(f"largest difference of a minimum from SciPy's: {worst:.1e}")
    sys.exit(1 if worst > 1e-9 else 0)


if __name__ == "__main__":
    main()
