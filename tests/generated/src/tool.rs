//! Tools whose steel is known in closed form: the text of a spec, a point for two parameters, and for a point how far it is off the
//! steel and beside which parameters.

use std::f64::consts::TAU;

use crate::machine::Range;
use crate::pose::Vector;

/// The shapes; lengths in mm. `side` is 1 where the steel is convex or below, -1 where it is on the other side.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A cylinder along z whose axis passes (circle, 0): angle about it from the direction of x, height.
    Pin { circle: f64, radius: f64, side: f64 },
    /// z over x and y, a polynomial: a x² + b y² + c x y + d x + e y.
    Graph { of: [f64; 5], side: f64, thickness: f64 },
    /// A tube about a circle about z: angle about the tube, angle about z.
    Torus { circle: f64, tube: f64, side: f64 },
    /// Length along the cone, angle about z.
    Cone { circle: f64, slope: f64, side: f64 },
    /// The flank of a thread with straight axial section: distance from the axis, angle. Facing +z with side 1.
    Thread { reference: f64, half: f64, slope: f64, lead: f64, side: f64 },
    /// What a straight blade on a turning table leaves of a worm: length along the edge, turn of the worm. The steel is the blade's with
    /// side 1, the worm's with side -1.
    Turned { blade: Blade, side: f64 },
}

/// A straight edge in the plane of a table that turns beside a worm, which turns about z.
#[derive(Clone, Debug)]
pub struct Blade {
    /// Of the table's axis from the worm's, mm.
    pub distance: f64,
    /// Of the table's turn to the worm's.
    pub ratio: f64,
    /// Direction of the edge in the table, distance of its line from the table's axis, middle of the edge.
    pub direction: f64,
    pub base: f64,
    pub middle: f64,
    /// On which side of the edge its steel lies.
    pub side: f64,
}

/// Where a point lies beside the steel.
#[derive(Clone, Copy, Debug)]
pub struct Foot {
    pub at: [f64; 2],
    /// Height over the steel, mm, to first order; negative inside.
    pub height: f64,
}

impl Shape {
    /// Whether each of the two parameters is an angle.
    pub fn angles(&self) -> [bool; 2] {
        match self {
            Shape::Pin { .. } => [true, false],
            Shape::Graph { .. } => [false, false],
            Shape::Torus { .. } => [true, true],
            Shape::Cone { .. } | Shape::Thread { .. } | Shape::Turned { .. } => [false, true],
        }
    }

    /// How deep below the surface there is steel for sure, mm.
    pub fn thickness(&self) -> f64 {
        match self {
            Shape::Pin { radius, .. } => (0.8 * radius).min(2.0),
            Shape::Graph { thickness, .. } => *thickness,
            Shape::Cone { .. } => 1.0,
            Shape::Torus { tube, .. } => (0.8 * tube).min(1.0),
            Shape::Thread { half, .. } => 0.1 * half,
            Shape::Turned { .. } => 0.3,
        }
    }

    pub fn blade(&self) -> Option<&Blade> {
        match self {
            Shape::Turned { blade, .. } => Some(blade),
            _ => None,
        }
    }

    pub fn point(&self, [u, v]: [f64; 2]) -> Vector {
        match *self {
            Shape::Pin { circle, radius, .. } => [circle + radius * u.cos(), radius * u.sin(), v],
            Shape::Graph { of, .. } => [u, v, polynomial(of, u, v)],
            Shape::Torus { circle, tube, .. } => about_z(circle + tube * u.cos(), v, tube * u.sin()),
            Shape::Cone { circle, slope, .. } => about_z(circle + u * slope.sin(), v, -u * slope.cos()),
            Shape::Thread { reference, half, slope, lead, side } => {
                about_z(u, v, lead * v + side * (half - (u - reference) * slope.tan()))
            }
            Shape::Turned { ref blade, .. } => {
                let [x, y] = turned(blade.edge(u), blade.ratio * v);
                about_z(x - blade.distance, -v, y)
            }
        }
    }

    /// The places of the surface beside a point, those for which an angle is in a range, whole turns counted apart.
    pub fn feet(&self, [x, y, z]: Vector, ranges: [Range; 2], mut each: impl FnMut(Foot)) {
        match *self {
            Shape::Turned { ref blade, side } => {
                // the blade's plane goes through the worm's axis, the edge lies between it and the table's
                let out = -x.hypot(y);
                turns(std::f64::consts::PI - y.atan2(x), ranges[1], |v| {
                    let [along, across] = blade.beside(turned([out + blade.distance, z], -blade.ratio * v));
                    each(Foot { at: [along, v], height: side * across });
                });
            }
            Shape::Pin { circle, radius, side } => {
                let height = side * ((x - circle).hypot(y) - radius);
                turns(y.atan2(x - circle), ranges[0], |u| each(Foot { at: [u, z], height }));
            }
            Shape::Graph { of, side, .. } => {
                let [a, b, c, d, e] = of;
                let (fx, fy) = (2.0 * a * x + c * y + d, 2.0 * b * y + c * x + e);
                let height = side * (z - polynomial(of, x, y)) / (1.0 + fx * fx + fy * fy).sqrt();
                each(Foot { at: [x, y], height });
            }
            Shape::Torus { circle, tube, side } => {
                let out = x.hypot(y) - circle;
                let height = side * (out.hypot(z) - tube);
                turns(y.atan2(x), ranges[1], |v| turns(z.atan2(out), ranges[0], |u| each(Foot { at: [u, v], height })));
            }
            Shape::Cone { circle, slope, side } => {
                let out = x.hypot(y) - circle;
                let (along, height) = (out * slope.sin() - z * slope.cos(), out * slope.cos() + z * slope.sin());
                turns(y.atan2(x), ranges[1], |v| each(Foot { at: [along, v], height: side * height }));
            }
            Shape::Thread { reference, half, slope, lead, side } => {
                let rho = x.hypot(y);
                let limit = half - (rho - reference) * slope.tan();
                let steep = (slope.tan().powi(2) + 1.0 + (lead / rho).powi(2)).sqrt();
                turns(y.atan2(x), ranges[1], |v| {
                    each(Foot { at: [rho, v], height: (side * (z - lead * v) - limit) / steep });
                });
            }
        }
    }

    /// `tool NAME { surface face(…) … }`; of a turned worm its blade.
    pub fn text(&self, name: &str, ranges: [Range; 2]) -> String {
        let [u, v] = [0, 1].map(|k| {
            let (unit, Range { low, high }) = (if self.angles()[k] { "rad" } else { "mm" }, ranges[k]);
            let dimension = if self.angles()[k] { "angle" } else { "length" };
            format!("{}: {dimension} in {low} {unit} .. {high} {unit}", ["u", "v"][k])
        });
        let (at, body) = self.formulas();
        let parameters = if self.blade().is_some() { u } else { format!("{u}, {v}") };
        format!(
            "tool {name} {{\n    surface face({parameters}) {{\n        at = {at}\n        body towards {body}\n    }}\n}}\n"
        )
    }

    fn formulas(&self) -> (String, String) {
        match self {
            Shape::Pin { circle, radius, side } => (
                format!("[{circle} mm + {radius} mm * cos(u), {radius} mm * sin(u), v]"),
                format!("[{0} * cos(u), {0} * sin(u), 0]", -side),
            ),
            Shape::Graph { of: [a, b, c, d, e], side, .. } => (
                format!("[u, v, {a} * u^2 / 1 mm + {b} * v^2 / 1 mm + {c} * u * v / 1 mm + {d} * u + {e} * v]"),
                format!("[0, 0, {}]", -side),
            ),
            Shape::Torus { circle, tube, side } => {
                let out = format!("({circle} mm + {tube} mm * cos(u))");
                (
                    format!("[{out} * cos(v), {out} * sin(v), {tube} mm * sin(u)]"),
                    format!("[{0} * cos(u) * cos(v), {0} * cos(u) * sin(v), {0} * sin(u)]", -side),
                )
            }
            Shape::Cone { circle, slope, side } => {
                let out = format!("({circle} mm + u * sin({slope} rad))");
                (
                    format!("[{out} * cos(v), {out} * sin(v), -u * cos({slope} rad)]"),
                    format!("[{0} * cos(v), {0} * sin(v), 0]", -side),
                )
            }
            Shape::Thread { reference, half, slope, lead, side } => (
                format!(
                    "[u * cos(v), u * sin(v), {lead} mm * v + {side} * ({half} mm - (u - {reference} mm) * tan({slope} rad))]"
                ),
                format!("[0, 0, {}]", -side),
            ),
            Shape::Turned { blade, .. } => {
                let ([x, y], (s, c)) = (blade.edge(0.0), blade.direction.sin_cos());
                (
                    format!("[{x} mm + u * {c}, {y} mm + u * {s}, 0 mm]"),
                    format!("[{}, {}, 0]", blade.side * s, -blade.side * c),
                )
            }
        }
    }
}

impl Blade {
    /// The worm on its spindle and the blade on the table.
    pub fn machine(&self) -> String {
        let Blade { distance, ratio, .. } = self;
        format!(
            "machine turning {{\n    axis worm_turn : rotary\n    frame worm\n    frame blade in worm = rotate_z(-worm_turn) \
             rotate_x(90 deg) translate_x(-{distance} mm) rotate_z({ratio} * worm_turn)\n}}\n"
        )
    }

    /// A point of the edge in the table's plane.
    fn edge(&self, u: f64) -> [f64; 2] {
        let (s, c) = self.direction.sin_cos();
        [(self.middle + u) * c - self.base * s, (self.middle + u) * s + self.base * c]
    }

    /// Where a point of the table's plane lies along the edge, and how far it is out of the blade's steel.
    fn beside(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (s, c) = self.direction.sin_cos();
        [x * c + y * s - self.middle, self.side * (y * c - x * s - self.base)]
    }
}

fn turned([x, y]: [f64; 2], by: f64) -> [f64; 2] {
    let (s, c) = by.sin_cos();
    [x * c - y * s, x * s + y * c]
}

fn polynomial([a, b, c, d, e]: [f64; 5], x: f64, y: f64) -> f64 {
    a * x * x + b * y * y + c * x * y + d * x + e * y
}

fn about_z(rho: f64, angle: f64, z: f64) -> Vector {
    [rho * angle.cos(), rho * angle.sin(), z]
}

/// An angle with whole turns added, as often as it is in a range that is a little wider.
fn turns(angle: f64, range: Range, mut each: impl FnMut(f64)) {
    let wide = range.wider_by(0.02);
    let mut turned = angle + ((wide.low - angle) / TAU).ceil() * TAU;
    while turned <= wide.high {
        each(turned);
        turned += TAU;
    }
}
