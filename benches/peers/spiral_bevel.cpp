// The job `flank` of spiral_bevel.chain as one would write it by hand for this machine: Newton with the derivatives worked out
// on paper, each point started from the one before.
//
// In the bed's frame the cradle turns the cutter about e_z and the work turns by R(phi) about a through O. With P and N a point
// of the cone and its normal, D = P - O:
//   f = N . (e_z x P) - R' N . (a x D),  z = a . D,  rho = sqrt(D . D - z^2).
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

struct Vector {
    double x, y, z;
};
static Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
static Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
static Vector operator*(double k, Vector a) { return {k * a.x, k * a.y, k * a.z}; }
static double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static Vector cross(Vector a, Vector b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static Vector about_z(Vector a) { return {-a.y, a.x, 0}; }

static const double degree = std::acos(-1.0) / 180;
static const double root = 15.9 * degree, blade = 20 * degree, ratio = 3.24;

struct Machine {
    double sin_blade = std::sin(blade), cos_blade = std::cos(blade);
    Vector axis{std::cos(root), 0, std::sin(root)}, across{std::sin(root), 0, -std::cos(root)};
    Vector origin{-std::cos(root), -4, 1 - std::sin(root)};
    Vector column[3];  // swivel and tilt
    Machine() {
        double cj = std::cos(30 * degree), sj = std::sin(30 * degree), ci = std::cos(2 * degree), si = std::sin(2 * degree);
        column[0] = {cj * ci, sj * ci, -si};
        column[1] = {-sj, cj, 0};
        column[2] = {cj * si, sj * si, ci};
    }
};

struct Point {
    double s, theta, phi;
    Vector d, normal;
    int evaluations;
};

static Point solve(const Machine& m, double s, double theta, double phi, double z_wanted, double rho_wanted) {
    for (int count = 1;; count++) {
        double st = std::sin(theta), ct = std::cos(theta), sq = std::sin(64 * degree + phi), cq = std::cos(64 * degree + phi);
        auto turned = [&](Vector a) { return Vector{cq * a.x - sq * a.y, sq * a.x + cq * a.y, a.z}; };
        double radius = 76 - s * m.sin_blade;
        Vector radial = turned(ct * m.column[0] + st * m.column[1]), tangent = turned(ct * m.column[1] - st * m.column[0]);
        Vector down = turned(m.column[2]);
        Vector p = radius * radial - (s * m.cos_blade) * down + Vector{74.8 * cq, 74.8 * sq, 0};
        Vector n = m.cos_blade * radial - m.sin_blade * down, d = p - m.origin;
        Vector p_s = (-m.sin_blade) * radial - m.cos_blade * down, p_t = radius * tangent, n_t = m.cos_blade * tangent;
        Vector p_f = about_z(p), n_f = about_z(n), a_d = cross(m.axis, d);
        double roll = ratio * (1 - phi * (0.02 + 0.015 * phi)), roll_f = -ratio * (0.02 + 0.03 * phi);
        double f = dot(n, p_f) - roll * dot(n, a_d), z = dot(m.axis, d), rho = std::sqrt(dot(d, d) - z * z);
        double r[3] = {f, z - z_wanted, rho - rho_wanted};
        if (std::fabs(r[0]) < 1e-11 && std::fabs(r[1]) < 1e-11 && std::fabs(r[2]) < 1e-11) return {s, theta, phi, d, n, count};
        if (count > 40) return {NAN, NAN, NAN, d, n, count};
        auto f_of = [&](Vector px, Vector nx) {
            return dot(nx, p_f) + dot(n, about_z(px)) - roll * (dot(nx, a_d) + dot(n, cross(m.axis, px)));
        };
        Vector px[3] = {p_s, p_t, p_f}, nx[3] = {{0, 0, 0}, n_t, n_f};
        double j[3][3];
        for (int k = 0; k < 3; k++) {
            j[0][k] = f_of(px[k], nx[k]);
            j[1][k] = dot(m.axis, px[k]);
            j[2][k] = (dot(d, px[k]) - z * j[1][k]) / rho;
        }
        j[0][2] -= roll_f * dot(n, a_d);
        double a = j[1][1] * j[2][2] - j[1][2] * j[2][1], b = j[1][2] * j[2][0] - j[1][0] * j[2][2];
        double c = j[1][0] * j[2][1] - j[1][1] * j[2][0], inverse = 1 / (j[0][0] * a + j[0][1] * b + j[0][2] * c);
        s -= inverse * (a * r[0] + (j[0][2] * j[2][1] - j[0][1] * j[2][2]) * r[1] + (j[0][1] * j[1][2] - j[0][2] * j[1][1]) * r[2]);
        theta -= inverse * (b * r[0] + (j[0][0] * j[2][2] - j[0][2] * j[2][0]) * r[1] + (j[0][2] * j[1][0] - j[0][0] * j[1][2]) * r[2]);
        phi -= inverse * (c * r[0] + (j[0][1] * j[2][0] - j[0][0] * j[2][1]) * r[1] + (j[0][0] * j[1][1] - j[0][1] * j[1][0]) * r[2]);
    }
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
    Machine m;
    std::vector<double> points(9 * (size_t)rows * columns);
    std::printf("{\"cand\":\"peer\",\"solve_s\":[");
    double evaluations = 0;
    for (int k = 0; k < repetitions; k++) {
        auto start = std::chrono::steady_clock::now();
        evaluations = 0;
        Point first{5.4, -2.45, -0.26, {}, {}, 0};
        for (int i = 0; i < rows; i++) {
            double h = 1 + 8.0 * i / (rows - 1);
            Point at = first;
            for (int c = 0; c < columns; c++) {
                double along = 72.5 + 25.0 * c / (columns - 1);
                at = solve(m, at.s, at.theta, at.phi, along * m.axis.x - h * m.axis.z, along * m.axis.z + h * m.axis.x);
                if (c == 0) first = at;
                evaluations += at.evaluations;
                double turn = ratio * at.phi * (1 - at.phi * (0.01 + 0.005 * at.phi)), sr = std::sin(turn), cr = std::cos(turn);
                Vector d = at.d, n = at.normal;
                double x = dot(m.across, d), nx = dot(m.across, n);
                double row[9] = {at.s, at.theta, at.phi, cr * x + sr * d.y, cr * d.y - sr * x, dot(m.axis, d),
                                 cr * nx + sr * n.y, cr * n.y - sr * nx, dot(m.axis, n)};
                std::memcpy(&points[9 * ((size_t)i * columns + c)], row, sizeof row);
            }
        }
        std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
        std::printf("%s%.9f", k ? "," : "", time.count());
    }
    std::printf("],\"evals_per_pt\":%.3f}\n", evaluations / ((double)rows * columns));
    if (!out.empty()) {
        FILE* file = std::fopen(out.c_str(), "wb");
        if (!file || std::fwrite(points.data(), 8, points.size(), file) != points.size()) return 1;
        std::fclose(file);
    }
}
