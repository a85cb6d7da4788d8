//! Screw compressor rotors and the wheels that grind them, against the law of gearing in the transverse section and against the condition
//! that the rotor's normal meets the wheel's axis.

use std::f64::consts::{PI, TAU};

use flank_expr::Graph;
use flank_solver::{Outcome, SurfacePoint};
use flank_tests::{assert_point, grid, job, turned};

const PAIR: &str = "specs/rotors/female_rotor.chain";
const GRINDING: &str = "specs/rotors/rotor_grinding.chain";

/// Lobes, distance of the axes, lead of the male rotor; the radii of its section, mm.
#[derive(Clone, Copy)]
struct Rotors {
    lobes: [f64; 2],
    distance: f64,
    lead: f64,
    wheel: f64,
}

/// Of a section: position, outward normal.
type Section = ([f64; 2], [f64; 2]);

/// Runs along the section, from the first value to the last.
type Piece = (&'static str, f64, f64);

/// Radius and height of the wheel's point that touches at a run along the section, and how its profile rises there.
type Touching<'a> = dyn Fn(f64) -> ([f64; 2], f64) + 'a;

impl Rotors {
    fn pitch(self) -> f64 {
        self.distance * self.lobes[0] / (self.lobes[0] + self.lobes[1])
    }

    fn twist(self) -> f64 {
        TAU / self.lead
    }

    /// Radius and centre of the lobe, radius and centre of the hollow, angle at which the lobe ends.
    fn arcs(self) -> (f64, f64, f64, [f64; 2], f64) {
        let r = self.pitch();
        let (lobe, hollow, root) = (0.6 * r, 0.1 * r, 0.97 * r);
        let center = 1.55 * r - lobe;
        let (far, between) = (root + hollow, lobe + hollow);
        let x = (center * center + far * far - between * between) / (2.0 * center);
        let y = (far * far - x * x).sqrt();
        (lobe, center, hollow, [x, y], y.atan2(x - center))
    }

    fn pieces(self) -> [Piece; 3] {
        let (lobe, _, hollow, [x, y], end) = self.arcs();
        let to_hollow = lobe * end;
        let to_root = to_hollow + hollow * (end - y.atan2(x));
        let to_end = to_root + 0.97 * self.pitch() * (PI / self.lobes[0] - y.atan2(x));
        [("lobe", 0.0, to_hollow), ("hollow", to_hollow, to_root), ("root", to_root, to_end)]
    }

    /// The male rotor's section at a run along it, on the side of +y.
    fn male(self, s: f64) -> Section {
        let (lobe, center, hollow, [x, y], end) = self.arcs();
        let [_, (_, to_hollow, to_root), _] = self.pieces();
        if s <= to_hollow {
            let (sin, cos) = (s / lobe).sin_cos();
            ([center + lobe * cos, lobe * sin], [cos, sin])
        } else if s <= to_root {
            let (sin, cos) = (end - (s - to_hollow) / hollow).sin_cos();
            // concave: the normal points from the arc to its centre, away from the solid
            ([x - hollow * cos, y - hollow * sin], [cos, sin])
        } else {
            let root = 0.97 * self.pitch();
            let (sin, cos) = (y.atan2(x) + (s - to_root) / root).sin_cos();
            ([root * cos, root * sin], [cos, sin])
        }
    }

    /// The female rotor's section at z = 0: the normal of the male one goes through the pitch point, the nearer of two.
    fn female(self, s: f64, side: f64) -> Section {
        let (p, n) = self.male(s);
        let (p, n) = ([p[0], side * p[1]], [n[0], side * n[1]]);
        let along = p[0] * n[0] + p[1] * n[1];
        let root = (along * along - (p[0] * p[0] + p[1] * p[1]) + self.pitch().powi(2)).sqrt();
        let to_pitch = if (root - along).abs() < (root + along).abs() { root - along } else { -root - along };
        let turn = -(p[1] + to_pitch * n[1]).atan2(p[0] + to_pitch * n[0]);
        let on_gear = |[x, y]: [f64; 2], away: f64| {
            let [x, y, _] = turned([x, y, 0.0], turn);
            let [x, y, _] = turned([x - away, y, 0.0], self.lobes[0] / self.lobes[1] * turn);
            [x, y]
        };
        (on_gear(p, self.distance), on_gear(n.map(|x| -x), 0.0))
    }

    fn female_twist(self) -> f64 {
        -self.lobes[0] / self.lobes[1] * self.twist()
    }

    fn set(self) -> Vec<(&'static str, String)> {
        vec![
            ("male_lobes", format!("{}", self.lobes[0])),
            ("female_lobes", format!("{}", self.lobes[1])),
            ("centre_distance", format!("{} mm", self.distance)),
            ("lead", format!("{} mm", self.lead)),
        ]
    }
}

/// A point and the outward normal of a rotor with this section, at a height.
fn helicoid((p, n): Section, twist: f64, z: f64) -> ([f64; 3], [f64; 3]) {
    let rise = -twist * (p[0] * n[1] - p[1] * n[0]);
    let length = rise.hypot(1.0);
    let [x, y, _] = turned([p[0], p[1], 0.0], twist * z);
    let normal = turned([n[0] / length, n[1] / length, rise / length], twist * z);
    ([x, y, z], normal)
}

/// Values within a piece, its ends included.
fn along((_, from, to): Piece, count: u32) -> Vec<f64> {
    (0..=count).map(|k| from + (to - from) * f64::from(k) / f64::from(count)).collect()
}

fn lattice(rows: &[f64], columns: &[f64]) -> Vec<[f64; 2]> {
    rows.iter().flat_map(|row| columns.iter().map(|column| [*row, *column])).collect()
}

const SHIPPED: Rotors = Rotors { lobes: [4.0, 6.0], distance: 100.0, lead: 200.0, wheel: 110.0 };
const OTHERS: [Rotors; 2] = [
    Rotors { lobes: [3.0, 5.0], distance: 80.0, lead: 260.0, wheel: 110.0 },
    Rotors { lobes: [4.0, 5.0], distance: 125.0, lead: 210.0, wheel: 110.0 },
];

#[test]
fn female_rotors_follow_the_law_of_gearing() {
    for rotors in [SHIPPED, OTHERS[0], OTHERS[1]] {
        let set = rotors.set();
        let set: Vec<(&str, &str)> = set.iter().map(|(name, value)| (*name, value.as_str())).collect();
        let graph = Graph::new();
        let job = job(&graph, PAIR, &set);
        for (name, side) in [("plus", 1.0), ("minus", -1.0)] {
            for piece in rotors.pieces() {
                let heights = [-45.0, -10.0, 0.0, 3.0, 55.0];
                let targets = lattice(&along(piece, 14), &heights);
                let surface = format!("{name}.{}", piece.0);
                let solved = grid(&job, &surface, ["s", "v"], &targets, heights.len());
                for ([s, v], point) in targets.iter().zip(&solved) {
                    // what a slice of the male rotor leaves is a slice of the female one
                    let (position, normal) = helicoid(rotors.female(*s, side), rotors.female_twist(), *v);
                    assert_point(point, position, normal, &format!("{surface} at {s}, {v} mm"));
                }
            }
        }
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The wheel's radius and height where it touches a rotor: of a helicoid with its space on +x, the height at which the normal meets the
/// wheel's axis, at a distance along x and swivelled about it.
fn ground_by(section: Section, twist: f64, [distance, swivel]: [f64; 2]) -> ([f64; 2], f64) {
    let axis = [0.0, -swivel.sin(), swivel.cos()];
    let from_axis = |z: f64| {
        let (p, n) = helicoid(section, twist, z);
        ([p[0] - distance, p[1], p[2]], n)
    };
    let miss = |z: f64| {
        let (p, n) = from_axis(z);
        dot(axis, [p[1] * n[2] - p[2] * n[1], p[2] * n[0] - p[0] * n[2], p[0] * n[1] - p[1] * n[0]])
    };
    // the place nearest to the middle, then halves of its neighbourhood
    let step = 0.25;
    let nearest = (0..200).flat_map(|k| [f64::from(k) * step, -f64::from(k + 1) * step]);
    let mut low = nearest.into_iter().find(|z| miss(*z) * miss(z + step) <= 0.0).expect("the wheel touches");
    let mut high = low + step;
    for _ in 0..80 {
        let middle = (low + high) / 2.0;
        if miss(low) * miss(middle) <= 0.0 { high = middle } else { low = middle }
    }
    let (p, n) = from_axis(low);
    let height = dot(p, axis);
    ([(dot(p, p) - height * height).sqrt(), height], -dot(n, axis))
}

fn turned_section((p, n): Section, angle: f64) -> Section {
    let flat = |[x, y]: [f64; 2]| {
        let [x, y, _] = turned([x, y, 0.0], angle);
        [x, y]
    };
    (flat(p), flat(n))
}

#[test]
fn wheels_touch_where_the_rotors_normal_meets_their_axis() {
    let rotors = SHIPPED;
    let [lobe, hollow, root] = rotors.pieces();
    let graph = Graph::new();
    let job = job(&graph, GRINDING, &[]);
    let lead_angle = (1.0 / (rotors.twist() * rotors.pitch())).atan();
    let female = |side: f64| {
        move |s: f64| {
            let section = turned_section(rotors.female(s, side), PI);
            let distance = rotors.wheel + rotors.distance - 1.55 * rotors.pitch();
            ground_by(section, rotors.female_twist(), [distance, -lead_angle])
        }
    };
    let male = |s: f64| {
        let section = turned_section(rotors.male(s), -PI / rotors.lobes[0]);
        ground_by(section, rotors.twist(), [rotors.wheel + 0.97 * rotors.pitch(), lead_angle])
    };
    let (plus, minus) = (female(1.0), female(-1.0));
    let wheels: [(&str, &Touching<'_>, &[Piece]); 3] = [
        ("female_plus_wheel", &plus, &[lobe, hollow]),
        ("female_minus_wheel", &minus, &[lobe, hollow]),
        ("male_wheel", &male, &[lobe, hollow, root]),
    ];
    for (wheel, touching, pieces) in wheels {
        for piece in pieces {
            // the wheel turned by them
            let angles = [-0.2, 0.0, 0.3];
            let targets = lattice(&along(*piece, 12), &angles);
            let surface = format!("{wheel}.{}", piece.0);
            let solved = grid(&job, &surface, ["s", "spindle"], &targets, angles.len());
            for ([s, _], point) in targets.iter().zip(&solved) {
                let ([radius, height], rise) = touching(*s);
                assert_on_wheel(point, radius, height, rise, &format!("{surface} at {s} mm"));
            }
        }
    }
}

fn assert_on_wheel(point: &SurfacePoint, radius: f64, height: f64, rise: f64, what: &str) {
    assert_eq!(point.outcome, Outcome::Solved, "{what}");
    let [x, y, z] = point.position;
    assert!((x.hypot(y) - radius).abs() < 1e-9, "{what}: {} mm from the axis instead of {radius} mm", x.hypot(y));
    assert!((z - height).abs() < 1e-9, "{what}: at the height {z} mm instead of {height} mm");
    assert!((point.normal[2] - rise).abs() < 1e-9, "{what}: the normal rises by {} instead of {rise}", point.normal[2]);
}

#[test]
fn the_wheel_of_a_rotor_leaves_this_rotor() {
    let rotors = SHIPPED;
    let graph = Graph::new();
    let job = job(&graph, GRINDING, &[]);
    let heights = [-9.0, -4.0, 0.0, 7.0];
    let targets = lattice(&along(rotors.pieces()[0], 16), &heights);
    for ([s, z], point) in targets.iter().zip(grid(&job, "ground.lobe", ["s", "z"], &targets, heights.len())) {
        let (position, normal) = helicoid(rotors.female(*s, 1.0), rotors.female_twist(), *z);
        assert_point(&point, position, normal, &format!("at {s}, {z} mm"));
    }
}
