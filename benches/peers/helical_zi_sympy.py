"""The job of helical_zi.chain as one would write it with SymPy: the chain as a product of 4 x 4 matrices, residuals with their Jacobian by
common subexpressions, printed as C++ on four lanes of AVX2, a row of the grid each. Each point is started from the one before, Newton's
4 x 4 step is solved by cofactors.

`helical_zi_sympy.py PROGRAM` derives and compiles the program, which takes the arguments of the other peers and prints the same line of
JSON. Needs g++."""

import math
import subprocess
import sys
import tempfile
from pathlib import Path

import sympy as sp
from sympy.printing.c import C99CodePrinter

WIDTH = 10


def rotated(axis, angle):
    c, s = sp.cos(angle), sp.sin(angle)
    if axis == "x":
        return sp.Matrix([[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1]])
    return sp.Matrix([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


def translated(x, y, z):
    matrix = sp.eye(4)
    matrix[:3, 3] = sp.Matrix([x, y, z])
    return matrix


def model():
    """Unknowns and targets, residuals, and what is written of a point."""
    module, teeth, starts, hob, shift, helix = 3, 31, 2, 38, 4.5, math.radians(22)
    reference = module * teeth / (2 * math.cos(helix))
    gamma = math.asin(starts * module / (2 * hob))
    pressure = math.atan(math.tan(math.radians(20)) / math.sin(gamma))
    base, lead = hob * math.cos(pressure), hob * math.tan(gamma)
    half = math.pi / (2 * starts) + math.tan(pressure) - pressure
    length = math.hypot(base, lead)

    xi, tau, spindle, feed, rho, z = unknowns = sp.symbols("xi tau spindle feed rho z")
    g = tau + half - xi
    point = sp.Matrix([base * (sp.cos(g) - xi * sp.sin(g)), base * (sp.sin(g) + xi * sp.cos(g)), lead * tau, 1])
    normal = sp.Matrix([lead / length * sp.sin(g), -lead / length * sp.cos(g), base / length, 0])
    table = -sp.Rational(starts, teeth) * spindle - math.tan(helix) / reference * feed
    chain = (
        rotated("z", -table) * translated(reference + 0.75 + hob, 0, feed) * rotated("x", gamma - helix)
        * translated(0, shift, 0) * rotated("x", -sp.pi / 2) * rotated("z", spindle)
    )
    position, direction = chain * point, chain * normal
    meshing = [direction.dot(chain.diff(motion) * point) for motion in (spindle, feed)]
    residuals = [*meshing, position[2] - z, sp.sqrt(position[0] ** 2 + position[1] ** 2) - rho]
    return unknowns, residuals, [xi, tau, spindle, feed, *position[:3], *direction[:3]]


class Printer(C99CodePrinter):
    def _print_Pow(self, power):
        if power.exp == -1:
            return f"(1.0 / {self.parenthesize(power.base, 50)})"
        if power.exp == sp.Rational(1, 2):
            return f"root({self._print(power.base)})"
        if power.exp == sp.Rational(-1, 2):
            return f"(1.0 / root({self._print(power.base)}))"
        if power.exp.is_Integer and power.exp > 0:
            return "(" + " * ".join([f"({self._print(power.base)})"] * int(power.exp)) + ")"
        return super()._print_Pow(power)

    def _print_sin(self, sine):
        return f"sin_of({self._print(sine.args[0])})"

    def _print_cos(self, cosine):
        return f"cos_of({self._print(cosine.args[0])})"

    def _print_Integer(self, number):
        return f"{int(number)}.0"

    def _print_Rational(self, number):
        return f"({number.p}.0 / {number.q}.0)"


def function(name, inputs, expressions):
    common, results = sp.cse(expressions, order="none")
    printer = Printer()
    lines = [f"static inline __attribute__((always_inline)) void {name}({', '.join(f'Lanes {x}' for x in inputs)}, Lanes* out) {{"]
    lines += [f"    Lanes {x} = {printer.doprint(e)};" for x, e in common]
    lines += [f"    out[{k}] = Lanes{{}} + {printer.doprint(e)};" for k, e in enumerate(results)]
    return "\n".join([*lines, "}\n"])


PRELUDE = """
#include <immintrin.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

typedef double Lanes __attribute__((vector_size(32)));
typedef long long Bits __attribute__((vector_size(32)));

static inline Lanes root(Lanes x) { return (Lanes)_mm256_sqrt_pd((__m256d)x); }
static inline Lanes chosen(Bits mask, Lanes yes, Lanes no) { return (Lanes)((mask & (Bits)yes) | (~mask & (Bits)no)); }

// to less than a unit in the last place: a quarter turn taken away in three parts, polynomials of the thirteenth and fourteenth degree
static inline __attribute__((always_inline)) void sincos_of(Lanes x, Lanes& sine, Lanes& cosine) {
    const double magic = 6755399441055744.0;
    Lanes shifted = x * 0.63661977236758134308 + magic, turns = shifted - magic;
    Bits quarter = (Bits)shifted;
    Lanes y = ((x - turns * 1.57079632673412561417e+00) - turns * 6.07710050630396597660e-11) - turns * 2.02226624879595063154e-21;
    Lanes z = y * y, w = z * z;
    Lanes s = y + y * z * ((-1.66666666666666324348e-01 + z * 8.33333333332248946124e-03)
        + w * (-1.98412698298579493134e-04 + z * 2.75573137070700676789e-06)
        + w * w * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10));
    Lanes c = 1.0 - (0.5 * z - w * ((4.16666666666666019037e-02 + z * -1.38888888888741095749e-03)
        + w * (2.48015872894767294178e-05 + z * -2.75573143513906633035e-07)
        + w * w * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)));
    Bits odd = -(quarter & 1);
    sine = (Lanes)((Bits)chosen(odd, c, s) ^ ((quarter & 2) << 62));
    cosine = (Lanes)((Bits)chosen(odd, s, c) ^ (((quarter + 1) & 2) << 62));
}
static inline __attribute__((always_inline)) Lanes sin_of(Lanes x) { Lanes s, c; sincos_of(x, s, c); return s; }
static inline __attribute__((always_inline)) Lanes cos_of(Lanes x) { Lanes s, c; sincos_of(x, s, c); return c; }
"""

LOOP = """
// x with A x = b, by the minors of the upper and of the lower two rows
static inline __attribute__((always_inline)) void solved(const Lanes* a, const Lanes* b, Lanes* x) {
    auto minor = [&](int row, int i, int j) { return a[row + i] * a[row + 4 + j] - a[row + j] * a[row + 4 + i]; };
    Lanes s0 = minor(0, 0, 1), s1 = minor(0, 0, 2), s2 = minor(0, 0, 3), s3 = minor(0, 1, 2), s4 = minor(0, 1, 3), s5 = minor(0, 2, 3);
    Lanes c0 = minor(8, 0, 1), c1 = minor(8, 0, 2), c2 = minor(8, 0, 3), c3 = minor(8, 1, 2), c4 = minor(8, 1, 3), c5 = minor(8, 2, 3);
    Lanes inverse = 1.0 / (s0 * c5 - s1 * c4 + s2 * c3 + s3 * c2 - s4 * c1 + s5 * c0);
    Lanes u0 = a[0] * b[1] - a[4] * b[0], u1 = a[1] * b[1] - a[5] * b[0], u2 = a[2] * b[1] - a[6] * b[0], u3 = a[3] * b[1] - a[7] * b[0];
    Lanes l0 = a[8] * b[3] - a[12] * b[2], l1 = a[9] * b[3] - a[13] * b[2], l2 = a[10] * b[3] - a[14] * b[2], l3 = a[11] * b[3] - a[15] * b[2];
    x[0] = inverse * (s3 * l3 - s4 * l2 + s5 * l1 + c3 * u3 - c4 * u2 + c5 * u1);
    x[1] = inverse * (s2 * l2 - s1 * l3 - s5 * l0 + c2 * u2 - c1 * u3 - c5 * u0);
    x[2] = inverse * (s0 * l3 - s2 * l1 + s4 * l0 + c0 * u3 - c2 * u1 + c4 * u0);
    x[3] = inverse * (s1 * l1 - s0 * l2 - s3 * l0 + c1 * u1 - c0 * u2 - c3 * u0);
    for (int k = 0; k < 4; k++) x[k] = -x[k];
}

static inline bool is_root(const Lanes* residuals) {
    Bits large = {};
    for (int k = 0; k < 4; k++) large |= ~((Lanes)((Bits)residuals[k] & 0x7fffffffffffffffLL) < 1e-11);
    return _mm256_movemask_pd((__m256d)large) == 0;
}

static void write(double* points, size_t stride, const Lanes* values) {
    for (int k = 0; k < 8; k += 4) {
        __m256d a = (__m256d)values[k], b = (__m256d)values[k + 1], c = (__m256d)values[k + 2], d = (__m256d)values[k + 3];
        __m256d p = _mm256_unpacklo_pd(a, b), q = _mm256_unpackhi_pd(a, b), r = _mm256_unpacklo_pd(c, d), s = _mm256_unpackhi_pd(c, d);
        _mm256_storeu_pd(points + k, _mm256_permute2f128_pd(p, r, 0x20));
        _mm256_storeu_pd(points + stride + k, _mm256_permute2f128_pd(q, s, 0x20));
        _mm256_storeu_pd(points + 2 * stride + k, _mm256_permute2f128_pd(p, r, 0x31));
        _mm256_storeu_pd(points + 3 * stride + k, _mm256_permute2f128_pd(q, s, 0x31));
    }
    __m256d e = (__m256d)values[8], f = (__m256d)values[9], low = _mm256_unpacklo_pd(e, f), high = _mm256_unpackhi_pd(e, f);
    _mm_storeu_pd(points + 8, _mm256_castpd256_pd128(low));
    _mm_storeu_pd(points + stride + 8, _mm256_castpd256_pd128(high));
    _mm_storeu_pd(points + 2 * stride + 8, _mm256_extractf128_pd(low, 1));
    _mm_storeu_pd(points + 3 * stride + 8, _mm256_extractf128_pd(high, 1));
}

static double solve(int rows, int columns, double* points) {
    double evaluations = 0;
    size_t stride = (size_t)WIDTH * columns;
    Lanes first[4] = {Lanes{} + 4.6, Lanes{} - 0.86, Lanes{} + 3.2, Lanes{}};
    for (int block = 0; block < rows; block += 4) {
        int row = std::min(block, rows - 4);
        Lanes u[4] = {first[0], first[1], first[2], first[3]}, rho;
        for (int k = 0; k < 4; k++) rho[k] = 48 + 5.8 * (row + k) / (rows - 1);
        for (int column = 0; column < columns; column++) {
            Lanes z = Lanes{} + (-10 + 20.0 * column / (columns - 1)), out[20], step[4];
            for (int count = 0; count < 40; count++) {
                residuals_and_jacobian(u[0], u[1], u[2], u[3], rho, z, out);
                evaluations += 4;
                if (is_root(out)) break;
                solved(out + 4, out, step);
                for (int k = 0; k < 4; k++) u[k] -= step[k];
            }
            Lanes values[WIDTH];
            point(u[0], u[1], u[2], u[3], values);
            write(points + stride * row + WIDTH * column, stride, values);
            if (column == 0) std::copy(u, u + 4, first);
        }
    }
    return evaluations;
}

int main(int count, char** words) {
    int rows = 31, columns = 61, repetitions = 3;
    std::string out;
    for (int k = 1; k + 1 < count; k += 2) {
        std::string key = words[k];
        if (key == "--n1") rows = std::atoi(words[k + 1]);
        if (key == "--n2") columns = std::atoi(words[k + 1]);
        if (key == "--reps") repetitions = std::atoi(words[k + 1]);
        if (key == "--out") out = words[k + 1];
    }
    std::vector<double> points(WIDTH * (size_t)rows * columns);
    std::printf("{\\"cand\\":\\"sympy\\",\\"job\\":\\"helical\\",\\"solve_s\\":[");
    double evaluations = 0;
    for (int k = 0; k < repetitions; k++) {
        auto start = std::chrono::steady_clock::now();
        evaluations = solve(rows, columns, points.data());
        std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
        std::printf("%s%.9f", k ? "," : "", time.count());
    }
    std::printf("],\\"evals_per_pt\\":%.3f}\\n", evaluations / ((double)rows * columns));
    if (!out.empty()) {
        FILE* file = std::fopen(out.c_str(), "wb");
        if (!file || std::fwrite(points.data(), 8, points.size(), file) != points.size()) return 1;
        std::fclose(file);
    }
}
"""


def main():
    unknowns, residuals, written = model()
    jacobian = [f.diff(x) for f in residuals for x in unknowns[:4]]
    functions = function("residuals_and_jacobian", unknowns, residuals + jacobian) + function("point", unknowns[:4], written)
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "helical_zi.cpp"
        source.write_text(PRELUDE + functions + LOOP.replace("WIDTH", str(WIDTH)))
        flags = ["-std=c++17", "-O3", "-march=native", "-ffp-contract=fast", "-fno-math-errno", "-fno-trapping-math", "-Wno-psabi"]
        subprocess.run(["g++", *flags, str(source), "-o", sys.argv[1]], check=True)


main()
