"""The job `flank` of spiral_bevel.chain as one would write it with CasADi: the chain as a product of 4 x 4 matrices, its Jacobian by
automatic differentiation, the step of Newton as generated C, mapped over all points, from one start.

Prints the same line of JSON as the other peers."""

import argparse
import json
import os
import subprocess
import tempfile
import time

import casadi as ca
import numpy as np

TOLERANCE = 1e-11
START = [5.4, -2.45, -0.26]


def translated(x, y, z):
    matrix = ca.SX.eye(4)
    matrix[0, 3], matrix[1, 3], matrix[2, 3] = x, y, z
    return matrix


def turned(axis, angle):
    matrix = ca.SX.eye(4)
    i, j = [k for k in range(3) if k != axis]
    c, s = ca.cos(angle), ca.sin(angle)
    sign = -1 if axis == 1 else 1
    matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = c, -sign * s, sign * s, c
    return matrix


def step():
    """One step of Newton and the largest residual before it, as a function of unknowns and targets."""
    degree = np.pi / 180
    unknowns, targets = ca.SX.sym("p", 3), ca.SX.sym("target", 2)
    s, theta, phi = unknowns[0], unknowns[1], unknowns[2]
    blade, root = 20 * degree, 15.9 * degree
    radius = 76 - s * np.sin(blade)
    point = ca.vertcat(radius * ca.cos(theta), radius * ca.sin(theta), -s * np.cos(blade), 1)
    normal = ca.vertcat(np.cos(blade) * ca.cos(theta), np.cos(blade) * ca.sin(theta), -np.sin(blade), 0)
    work = 3.24 * (phi - 0.01 * phi**2 - 0.005 * phi**3)
    chain = turned(2, -work)
    for next_one in [
        turned(1, -90 * degree), translated(1, 0, 0), turned(1, root), translated(0, 0, -1), translated(0, 4, 0),
        turned(2, phi), turned(2, 64 * degree), translated(74.8, 0, 0), turned(2, 30 * degree), turned(1, 2 * degree),
    ]:
        chain = chain @ next_one
    position, direction = chain @ point, chain @ normal
    velocity = ca.jacobian(position, phi)
    meshing = ca.dot(direction[:3], velocity[:3])
    rho = ca.sqrt(position[0] ** 2 + position[1] ** 2)
    residuals = ca.vertcat(meshing, position[2] - targets[0], rho - targets[1])
    moved = unknowns - ca.solve(ca.jacobian(residuals, unknowns), residuals)
    placed = ca.vertcat(position[:3], direction[:3])
    return ca.Function("step", [unknowns, targets], [moved, ca.mmax(ca.fabs(residuals)), placed])


def compiled(function, folder):
    source = os.path.join(folder, "step.c")
    here = os.getcwd()
    os.chdir(folder)
    function.generate("step.c")
    os.chdir(here)
    library = os.path.join(folder, "step.so")
    subprocess.run(["gcc", "-O3", "-march=native", "-shared", "-fPIC", source, "-o", library, "-lm"], check=True)
    return ca.external("step", library)


def main():
    parser = argparse.ArgumentParser()
    for name in ["n1", "n2", "reps"]:
        parser.add_argument("--" + name, type=int, required=True)
    parser.add_argument("--job")
    arguments = parser.parse_args()
    began = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        one = compiled(step(), folder)
        rows, columns = arguments.n1, arguments.n2
        across, along = np.meshgrid(np.linspace(1, 9, rows), np.linspace(72.5, 97.5, columns), indexing="ij")
        root = 15.9 * np.pi / 180
        z, rho = along * np.cos(root) - across * np.sin(root), along * np.sin(root) + across * np.cos(root)
        targets = np.vstack([z.ravel(), rho.ravel()])
        every = one.map(rows * columns)
        setup = time.perf_counter() - began
        times = []
        for _ in range(arguments.reps):
            began = time.perf_counter()
            unknowns = np.tile(np.array(START)[:, None], rows * columns)
            for rounds in range(1, 20):
                moved, worst, _ = every(unknowns, targets)
                if float(ca.mmax(worst)) < TOLERANCE:
                    break
                unknowns = moved
            times.append(time.perf_counter() - began)
    report = {"cand": "casadi", "job": "flank", "setup_s": setup, "evals_per_pt": rounds, "solve_s": times}
    print(json.dumps(report, separators=(",", ":")))


main()
