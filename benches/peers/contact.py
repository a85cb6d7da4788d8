"""The contact of specs/pairs/bevel_19x62.chain as one would write it by hand: seven equations for 101 positions of the pinion, each
started from the position before, the flanks alone, without ends, edges and pattern.

`--peer scipy` solves them by `scipy.optimize.fsolve` on functions of NumPy, `--peer casadi` by CasADi: exact derivatives, Newton and the
loop over positions as generated C. Prints a line of JSON; its lags are those of `flank contact`."""

import argparse
import json
import os
import subprocess
import tempfile
import time

import numpy as np

DEGREE = np.pi / 180
# radial distance, cradle angle, work offset, sliding base, root angle, centre to crossing point, roll coefficients; then the blade:
# side, point radius, angle, radius of its arc
PINION = (99.808, -51.522 * DEGREE, -1.8799, -1.3231, 15.64096727073747 * DEGREE, 4.9987,
          (3.4108, 0.092298, -0.27878), 1, 98.691, 19.882 * DEGREE, 233.84)
GEAR = (97.95367814746567, 52.801158062429394 * DEGREE, 0.0, 0.0, 75.6638280957449 * DEGREE, 0.0,
        (1.023367028989512, 0.0, 0.0), -1, 94.06073020913014, 20 * DEGREE, 500.0)
SHAFT = 95 * DEGREE
RATIO = 19 / 62
# from where the gear's tip takes over back over the mean point
TURNS = np.linspace(-25, 8, 101) * DEGREE
# along the blade in mm, place on the cutter, roll, of both; lag
START = [6.0, 1.9, 0.0, 2.0, -1.9, 0.0, 2.85 * DEGREE]
TOLERANCE = 1e-11


def turned(m, axis, angle, point):
    """A point or direction, turned about an axis of the frame."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    c, s = m.cos(angle), m.sin(angle)
    new = [point[0], point[1], point[2]]
    new[i], new[j] = c * point[i] - s * point[j], s * point[i] + c * point[j]
    return new


def cross_x(rate, at):
    return [0, -rate * at[2], rate * at[1]]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def flank(m, member, along, theta, roll):
    """Point and normal in the work's frame, and the equation of meshing, mm a radian of roll."""
    radial, cradle, offset, base, root, center, (ratio, c2, d6), side, point_radius, blade, arc = member
    beta = blade + along / arc
    radius = point_radius + side * arc * (np.cos(blade) - m.cos(beta))
    point = [radius * m.cos(theta), radius * m.sin(theta), -arc * (m.sin(beta) - np.sin(blade))]
    normal = [m.cos(beta) * m.cos(theta), m.cos(beta) * m.sin(theta), side * m.sin(beta)]
    # to the bed: a quarter turn, the eccentric, the cradle
    point, normal = turned(m, 1, -np.pi / 2, point), turned(m, 1, -np.pi / 2, normal)
    point = [point[0], point[1], point[2] + radial]
    point, normal = turned(m, 0, -(cradle + roll), point), turned(m, 0, -(cradle + roll), normal)
    velocity = cross_x(-1, point)
    # to the head: offset, sliding base, root angle, centre
    point = turned(m, 1, root, [point[0] + base, point[1] + offset, point[2]])
    point = [point[0], point[1], point[2] - center]
    normal, velocity = turned(m, 1, root, normal), turned(m, 1, root, velocity)
    # against the work, which turns
    rate = ratio * (1 - c2 * roll - d6 / 2 * roll**2)
    relative = [velocity[0] + rate * point[1], velocity[1] - rate * point[0], velocity[2]]
    work = ratio * (roll - c2 / 2 * roll**2 - d6 / 6 * roll**3)
    return turned(m, 2, -work, point), turned(m, 2, -work, normal), dot(normal, relative)


def residuals(m, unknowns, turn):
    first, second = unknowns[0:3], unknowns[3:6]
    p, n, meshing_p = flank(m, PINION, first[0], first[1], first[2])
    g, k, meshing_g = flank(m, GEAR, second[0], second[1], second[2])
    p, n = turned(m, 2, turn, p), turned(m, 2, turn, n)
    gear = np.pi - (RATIO * turn + unknowns[6])
    g, k = turned(m, 2, gear, g), turned(m, 2, gear, k)
    g, k = turned(m, 1, SHAFT, g), turned(m, 1, SHAFT, k)
    # the normals are parallel: two tangents of the one flank are perpendicular to the other's normal
    t = [n[1], -n[0], 0]
    b = [-n[2] * t[1], n[2] * t[0], n[0] * t[1] - n[1] * t[0]]
    return [meshing_p, meshing_g, p[0] - g[0], p[1] - g[1], p[2] - g[2], dot(k, t), dot(k, b)]


def by_scipy():
    from scipy.optimize import fsolve

    def equations(unknowns, turn):
        return residuals(np, unknowns, turn)

    start = fsolve(equations, START, args=(TURNS[50],), xtol=1e-14)

    def path():
        lags, unknowns = [], start
        for turn in TURNS[50:]:
            unknowns = fsolve(equations, unknowns, args=(turn,), xtol=1e-12)
            lags.append(unknowns[6])
        unknowns = start
        for turn in TURNS[49::-1]:
            unknowns = fsolve(equations, unknowns, args=(turn,), xtol=1e-12)
            lags.insert(0, unknowns[6])
        return lags

    return path


def by_casadi(folder):
    import casadi as ca

    unknowns, turn = ca.SX.sym("unknowns", 7), ca.SX.sym("turn")
    equations = ca.Function("equations", [unknowns, turn], [ca.vertcat(*residuals(ca, unknowns, turn))])
    options = {"abstol": TOLERANCE, "max_iter": 30}
    solver = ca.rootfinder("contact", "fast_newton", equations, options)
    first = np.array(solver(START, TURNS[50])).ravel()
    down, up = TURNS[50::-1], TURNS[50:]
    path = ca.MX.sym("start", 7)
    function = ca.Function("path", [path], [solver.mapaccum("up", 51)(path, up), solver.mapaccum("down", 51)(path, down)])
    here = os.getcwd()
    os.chdir(folder)
    function.generate("path.c")
    os.chdir(here)
    library = os.path.join(folder, "path.so")
    subprocess.run(["gcc", "-O3", "-march=native", "-shared", "-fPIC", os.path.join(folder, "path.c"), "-o", library, "-lm"], check=True)
    compiled = ca.external("path", library)

    def path():
        up, down = compiled(first)
        return [*np.array(down)[6, :0:-1], *np.array(up)[6]]

    return path


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--peer", choices=["scipy", "casadi"], required=True)
    parser.add_argument("--reps", type=int, default=5)
    arguments = parser.parse_args()
    began = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        path = by_scipy() if arguments.peer == "scipy" else by_casadi(folder)
        setup = time.perf_counter() - began
        times = []
        for _ in range(arguments.reps):
            began = time.perf_counter()
            lags = path()
            times.append(time.perf_counter() - began)
    lags = [float(lag) / DEGREE for lag in lags]
    print(json.dumps({"peer": arguments.peer, "setup_s": setup, "solve_s": times, "turns_deg": list(TURNS / DEGREE), "lags_deg": lags}))


main()
