// The jobs of spiral_bevel.chain as one would write them by hand for this machine: Newton with the derivatives worked out
// on paper, each point started from the one before. `flank` is sampled by z and rho, `grid` by phi and theta, with principal curvatures.
//
// In the bed's frame the cradle turns the cutter about e_z and the work turns by R(phi) about a through O. With P and N a point
// of the cone and its normal, D = P - O:
//   f = N . (e_z x P) - R' N . (a x D),  z = a . D,  rho = sqrt(D . D - z^2).
#include <cmath>
#include <cstring>

#include "peer.hpp"

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

// What a row of the grid has in common.
struct Cradle {
    double phi, sin, cos, roll, roll_f, turn_sin, turn_cos;
    explicit Cradle(double phi) : phi(phi) {
        sin = std::sin(64 * degree + phi), cos = std::cos(64 * degree + phi);
        roll = ratio * (1 - phi * (0.02 + 0.015 * phi)), roll_f = -ratio * (0.02 + 0.03 * phi);
        double turn = ratio * phi * (1 - phi * (0.01 + 0.005 * phi));
        turn_sin = std::sin(turn), turn_cos = std::cos(turn);
    }
};

// A point of the grid: s by Newton, then curvatures by the two fundamental forms. With v, the velocity of P in the work, tangents are
// p_t - (f_t / f_s) p_s and v - (f_phi / f_s) p_s; the normal does not depend on s.
static double curved(const Machine& m, const Cradle& c, double st, double ct, double s, double* row, double* evaluations) {
    auto turned = [&](Vector a) { return Vector{c.cos * a.x - c.sin * a.y, c.sin * a.x + c.cos * a.y, a.z}; };
    Vector radial = turned(ct * m.column[0] + st * m.column[1]), tangent = turned(ct * m.column[1] - st * m.column[0]);
    Vector down = turned(m.column[2]), slide{74.8 * c.cos, 74.8 * c.sin, 0};
    Vector n = m.cos_blade * radial - m.sin_blade * down, n_t = m.cos_blade * tangent;
    Vector p_s = (-m.sin_blade) * radial - m.cos_blade * down;
    auto velocity = [&](Vector at, Vector from) { return about_z(at) - c.roll * cross(m.axis, from); };
    double f_s = dot(n, velocity(p_s, p_s));
    Vector p, d, v;
    for (int count = 1;; count++) {
        p = 76.0 * radial + s * p_s + slide, d = p - m.origin, v = velocity(p, d);
        double f = dot(n, v);
        *evaluations += 1;
        if (std::fabs(f) < 1e-11) break;
        if (count > 40) return NAN;
        s -= f / f_s;
    }
    Vector p_t = (76 - s * m.sin_blade) * tangent, n_f = velocity(n, n), p_f = about_z(p);
    double f_t = dot(n_t, v) + dot(n, velocity(p_t, p_t));
    double f_f = dot(about_z(n), v) + dot(n, velocity(p_f, p_f)) - c.roll_f * dot(n, cross(m.axis, d));
    Vector one = p_t - (f_t / f_s) * p_s, two = v - (f_f / f_s) * p_s;
    double e = dot(one, one), g = dot(one, two), h = dot(two, two);
    double l = -dot(one, n_t), k = -dot(one, n_f), o = -dot(two, n_f), area = 1 / (e * h - g * g);
    double mean = 0.5 * (e * o - 2 * g * k + h * l) * area, gauss = (l * o - k * k) * area;
    double root_of = std::sqrt(std::fmax(mean * mean - gauss, 0));
    double x = dot(m.across, d), nx = dot(m.across, n), sr = c.turn_sin, cr = c.turn_cos;
    double found[9] = {s, cr * x + sr * d.y, cr * d.y - sr * x, dot(m.axis, d), cr * nx + sr * n.y, cr * n.y - sr * nx,
                       dot(m.axis, n), mean + root_of, mean - root_of};
    std::memcpy(row, found, sizeof found);
    return s;
}

static double grid(const Machine& m, int rows, int columns, double* points) {
    double evaluations = 0, s = 6;
    std::vector<double> sines(columns), cosines(columns);
    for (int j = 0; j < columns; j++) {
        double theta = -2.55 + 0.2 * j / (columns - 1);
        sines[j] = std::sin(theta), cosines[j] = std::cos(theta);
    }
    for (int i = 0; i < rows; i++) {
        Cradle cradle(-0.34 + 0.14 * i / (rows - 1));
        for (int j = 0; j < columns; j++)
            s = curved(m, cradle, sines[j], cosines[j], s, points + 9 * ((size_t)i * columns + j), &evaluations);
    }
    return evaluations;
}

static double flank(const Machine& m, int rows, int columns, double* points) {
    double evaluations = 0;
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
            std::memcpy(points + 9 * ((size_t)i * columns + c), row, sizeof row);
        }
    }
    return evaluations;
}

int main(int count, char** words) {
    Machine m;
    return run_peer(count, words, "peer", "--job", "flank", 9, [&](const std::string& job, int rows, int columns, double* points) {
        return (job == "grid" ? grid : flank)(m, rows, columns, points);
    });
}
