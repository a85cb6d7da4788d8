// The job of helical_zi.chain by hand for this one gear, each point started from the one before. In the bed's frame, P is a point of the
// flank without the feed Z, N its unit normal, G = tau + spindle + half_base_angle - xi, and k1 and k2 are turns of the table for a turn of
// the hob and for a millimetre of feed:
//   M = Px Ny - Py Nx,  feed: Nz - k2 M = 0,  hob: -p N.axis - k1 M = 0 (the thread is a helicoid: its turn is a shift by -p),
//   rho: (Px^2 + Py^2 - rho^2) / 2 rho = 0,  z: Z = z - Pz.
// N depends on G alone, so that k1 feed - k2 hob does, too.
//
// `--variant newton` eliminates Z by z and G by that combination and solves two equations for xi and tau, with the derivatives worked out on
// paper. `--variant closed` knows that N is the same at all points: tau follows from M, xi from a quadratic equation, all once for a row;
// each point is tested all the same.
#include <cmath>
#include <cstring>

#include "peer.hpp"

static const double degree = std::acos(-1.0) / 180, tolerance = 1e-11;
static const int width = 10;  // xi, tau, spindle, feed, x, y, z, normal

struct Gear {
    double k1, k2, radial, shift = 4.5, sin_a, cos_a, base_radius, lead, half_base_angle, across, along;
    Gear() {
        double module = 3, teeth = 31, starts = 2, hob = 38, helix = 22 * degree;
        double reference = module * teeth / (2 * std::cos(helix)), gamma = std::asin(starts * module / (2 * hob));
        double pressure = std::atan(std::tan(20 * degree) / std::sin(gamma)), swivel = gamma - helix;
        radial = reference + 0.75 + hob, k1 = -starts / teeth, k2 = -std::tan(helix) / reference;
        sin_a = std::sin(swivel), cos_a = std::cos(swivel);
        base_radius = hob * std::cos(pressure), lead = hob * std::tan(gamma);
        half_base_angle = 90 * degree / starts + std::tan(pressure) - pressure;
        double length = std::hypot(base_radius, lead);
        across = lead / length, along = base_radius / length;
    }
};

// P without the feed, N and the residuals.
struct Place {
    double sg, cg, dx, dy, px, py, pz, nx, ny, nz, moment, feed, hob, rho;
    Place(const Gear& g, double xi, double tau, double turn, double wanted) {
        sg = std::sin(turn), cg = std::cos(turn);
        at(g, xi, tau, wanted);
    }
    void at(const Gear& g, double xi, double tau, double wanted) {
        dx = cg - xi * sg, dy = sg + xi * cg;
        double q = g.lead * tau + g.shift, r = g.base_radius * dy;
        px = g.radial + g.base_radius * dx, py = g.cos_a * q + g.sin_a * r, pz = g.sin_a * q - g.cos_a * r;
        nx = g.across * sg, ny = g.cos_a * g.along - g.sin_a * (g.across * cg), nz = g.sin_a * g.along + g.cos_a * (g.across * cg);
        moment = px * ny - py * nx;
        feed = nz - g.k2 * moment, hob = -g.lead * g.along - g.k1 * moment;
        rho = (px * px + py * py - wanted * wanted) / (2 * wanted);
    }
    bool is_root() const { return std::fabs(feed) < tolerance && std::fabs(hob) < tolerance && std::fabs(rho) < tolerance; }
};

struct Unknowns {
    double xi, tau, turn;
};

static Place solve(const Gear& g, Unknowns& u, double wanted, double* evaluations) {
    for (int count = 1;; count++) {
        Place p(g, u.xi, u.tau, u.turn, wanted);
        *evaluations += 1;
        if (p.is_root()) return p;
        if (count > 40) {
            u = {NAN, NAN, NAN};
            return p;
        }
        double nz_g = -g.cos_a * g.across * p.sg, nx_g = g.across * p.cg, ny_g = g.sin_a * g.across * p.sg;
        double turned = -(g.k1 * p.feed - g.k2 * p.hob) / (g.k1 * nz_g);
        double px_x = -g.base_radius * p.sg, py_x = g.sin_a * g.base_radius * p.cg, py_t = g.cos_a * g.lead;
        double px_g = -g.base_radius * p.dy, py_g = g.sin_a * g.base_radius * p.dx;
        double m_x = px_x * p.ny - py_x * p.nx, m_t = -py_t * p.nx;
        double m_g = px_g * p.ny - py_g * p.nx + p.px * ny_g - p.py * nx_g;
        double inverse = 1 / wanted, r_x = (p.px * px_x + p.py * py_x) * inverse, r_t = p.py * py_t * inverse;
        double r_g = (p.px * px_g + p.py * py_g) * inverse;
        double m = -p.hob / g.k1 + m_g * turned, r = p.rho + r_g * turned, over = 1 / (m_x * r_t - m_t * r_x);
        u.xi -= (r_t * m - m_t * r) * over;
        u.tau -= (m_x * r - r_x * m) * over;
        u.turn += turned;
    }
}

static void write(const Gear& g, const Unknowns& u, const Place& p, double z, double* point) {
    double feed = z - p.pz, spindle = u.turn - u.tau - (g.half_base_angle - u.xi), table = g.k1 * spindle + g.k2 * feed;
    double s = std::sin(table), c = std::cos(table);
    double found[width] = {u.xi, u.tau, spindle, feed, c * p.px + s * p.py, c * p.py - s * p.px, p.pz + feed,
                           c * p.nx + s * p.ny, c * p.ny - s * p.nx, p.nz};
    std::memcpy(point, found, sizeof found);
}

static double rho_of(int row, int rows) { return 48 + 5.8 * row / (rows - 1); }
static double z_of(int column, int columns) { return -10 + 20.0 * column / (columns - 1); }

// the middle of the flank, about
static const double start_xi = 4.6, start_tau = -0.86, start_spindle = 3.2;

static double newton(const Gear& g, int rows, int columns, double* points) {
    double evaluations = 0;
    Unknowns first{start_xi, start_tau, start_spindle + start_tau + g.half_base_angle - start_xi};
    for (int i = 0; i < rows; i++) {
        double wanted = rho_of(i, rows);
        Unknowns u = first;
        for (int k = 0; k < columns; k++) {
            Place place = solve(g, u, wanted, &evaluations);
            write(g, u, place, z_of(k, columns), points + width * ((size_t)i * columns + k));
            if (k == 0) first = u;
        }
    }
    return evaluations;
}

static double closed(const Gear& g, int rows, int columns, double* points) {
    double evaluations = 0, moment = -g.lead * g.along / g.k1;
    // Nz = k2 M; of both angles the one at the start
    double c = (g.k2 * moment - g.sin_a * g.along) / (g.cos_a * g.across), near = start_spindle + start_tau + g.half_base_angle - start_xi;
    double turn = std::acos(c) * (std::sin(near) < 0 ? -1 : 1);
    turn += std::round((near - turn) / (360 * degree)) * 360 * degree;
    for (int i = 0; i < rows; i++) {
        double wanted = rho_of(i, rows);
        Place at_zero(g, 0, 0, turn, wanted);
        double sg = at_zero.sg, cg = at_zero.cg, nx = at_zero.nx, ny = at_zero.ny;
        // with Px = a + b xi, Py = d + e xi from M, Py^2 + Px^2 = rho^2
        double a = g.radial + g.base_radius * cg, b = -g.base_radius * sg;
        double d = (a * ny - moment) / nx, e = b * ny / nx;
        double square = b * b + e * e, half = a * b + d * e, rest = a * a + d * d - wanted * wanted;
        double root = std::sqrt(half * half - square * rest), one = (-half + root) / square, other = (-half - root) / square;
        double xi = std::fabs(one - start_xi) < std::fabs(other - start_xi) ? one : other;
        double tau = ((d + e * xi - g.sin_a * g.base_radius * (sg + xi * cg)) / g.cos_a - g.shift) / g.lead;
        for (int k = 0; k < columns; k++) {
            Place place = at_zero;
            place.at(g, xi, tau, wanted);
            evaluations += 1;
            if (!place.is_root()) xi = NAN;
            write(g, {xi, tau, turn}, place, z_of(k, columns), points + width * ((size_t)i * columns + k));
        }
    }
    return evaluations;
}

int main(int count, char** words) {
    Gear gear;
    return run_peer(count, words, "peer", "--variant", "newton", width, [&](const std::string& variant, int rows, int columns, double* points) {
        return (variant == "closed" ? closed : newton)(gear, rows, columns, points);
    });
}
