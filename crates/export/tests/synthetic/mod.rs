//! Surfaces in closed form, to be written to files in tests. Lengths are mm, angles radians.
#![allow(dead_code, reason = "each test binary uses some of them")]

use flank_export::{Axis, Dataset, Field, Header, Outcome, Patch, Point, Unit, Unknown, Values};

type Vector = [f64; 3];

pub(crate) fn dataset(job: &str, patches: Vec<Patch>) -> Dataset {
    let header = Header {
        program: "flank 0.1.0".into(),
        spec: "specs/jobs/synthetic.flank".into(),
        spec_hash: "9f2c1e7a55d0b3c4".into(),
        job: job.into(),
        conventions: vec!["the datum face is at z = -10".into()],
    };
    Dataset { header, patches }
}

/// A grid over `[0, 1]²`; `surface` gives position, normal and two unknowns (an angle and a length).
pub(crate) fn grid(
    name: &str,
    labels: [&str; 2],
    [rows, columns]: [usize; 2],
    surface: impl Fn(f64, f64) -> Point,
) -> Patch {
    let share = |at: usize, count: usize| {
        if count > 1 { at as f64 / (count - 1) as f64 } else { 0.5 }
    };
    let points = (0..rows * columns).map(|at| surface(share(at / columns, rows), share(at % columns, columns)));
    let axis = |label: &str, count| Axis { label: label.into(), count };
    Patch {
        name: name.into(),
        frame: "m.table".into(),
        layout: flank_export::Layout::Round,
        rows: axis(labels[0], rows),
        columns: axis(labels[1], columns),
        unknowns: vec![
            Unknown { name: "phi".into(), unit: Unit::Degree },
            Unknown { name: "s".into(), unit: Unit::Millimetre },
        ],
        points: points.collect(),
        fields: Vec::new(),
    }
}

/// The patch with a scalar field (the number of each point; not defined for the first) and a vector field.
pub(crate) fn with_fields(mut patch: Patch) -> Patch {
    let count = patch.points.len();
    let field = |name: &str, unit: &str, values| Field {
        name: name.into(),
        unit: unit.into(),
        meaning: format!("{name} of the tests"),
        values,
    };
    patch.fields = vec![
        field("k1", "1/mm", Values::Scalars((0..count).map(|at| (at > 0).then_some(at as f64)).collect())),
        field("d1", "1", Values::Vectors((0..count).map(|at| Some([0.0, -0.0, at as f64])).collect())),
    ];
    patch
}

pub(crate) fn point(position: Vector, normal: Vector, unknowns: [f64; 2]) -> Point {
    let residual = 1e-15 * (1.0 + position[2].abs());
    Point {
        outcome: Outcome::Solved,
        position,
        normal: unit(normal),
        unknowns: unknowns.into(),
        residual,
        reason: String::new(),
    }
}

/// A gear that a rack generates: module 3, 24 teeth, pressure angle 20°, addendum 1, dedendum 1.25, tip radius 0.38.
pub(crate) struct Gear {
    pub(crate) helix: f64,
    pub(crate) width: f64,
}

const PITCH_RADIUS: f64 = 36.0;
const ALPHA: f64 = 0.349_065_850_398_865_9;
const TIP_RADIUS: f64 = 1.14;
/// Of the centre of the rack's tip round below the pitch line.
const DEPTH: f64 = 2.61;
/// Of that centre along the pitch line, which puts the tooth on the x axis.
const ASIDE: f64 = -4.40;

impl Gear {
    /// The involute: `z` along rows, root to tip along columns.
    pub(crate) fn flank(&self, name: &str, size: [usize; 2]) -> Patch {
        grid(name, ["z", "root -> tip"], size, |s, t| {
            let (sin, cos) = ALPHA.sin_cos();
            let out = [-sin, cos];
            let along = t * 5.0;
            let x = -DEPTH + TIP_RADIUS * out[0] + along * cos;
            let y = ASIDE + TIP_RADIUS * out[1] + along * sin;
            let shift = -x / ALPHA.tan() - y;
            self.placed(s, [x, y], [-out[0], -out[1]], shift, along)
        })
    }

    /// The trochoid below it, where the round of the rack's tip has been.
    pub(crate) fn fillet(&self, name: &str, size: [usize; 2]) -> Patch {
        grid(name, ["z", "root -> tip"], size, |s, t| {
            let shift = t * DEPTH / ALPHA.tan() - ASIDE;
            let centre = [-DEPTH, ASIDE + shift];
            let long = centre[0].hypot(centre[1]);
            let out = centre.map(|x| x / long);
            let at = [centre[0] + TIP_RADIUS * out[0], centre[1] - shift + TIP_RADIUS * out[1]];
            self.placed(s, at, out.map(|x| -x), shift, t)
        })
    }

    /// A contact point of the rack, relative to the pitch point at rest, as a point of the gear.
    fn placed(&self, s: f64, at: [f64; 2], normal: [f64; 2], shift: f64, unknown: f64) -> Point {
        let phi = shift / PITCH_RADIUS;
        let z = (s - 0.5) * self.width;
        let twist = self.helix.tan() / PITCH_RADIUS;
        let [x, y] = turned([PITCH_RADIUS + at[0], at[1] + shift], twist * z - phi);
        let [nx, ny] = turned(normal, twist * z - phi);
        point([x, y, z], [nx, ny, twist * (nx * y - ny * x)], [phi, unknown])
    }
}

/// The patch on the other side of the plane y = 0: the opposite flank of the same tooth.
pub(crate) fn mirrored(patch: &Patch, name: &str) -> Patch {
    let mut other = patch.clone();
    other.name = name.into();
    for point in &mut other.points {
        point.position[1] *= -1.0;
        point.normal[1] *= -1.0;
    }
    other
}

/// The patch turned about the gear axis.
pub(crate) fn turned_patch(patch: &Patch, angle: f64, name: &str) -> Patch {
    let mut other = patch.clone();
    other.name = name.into();
    for point in &mut other.points {
        for v in [&mut point.position, &mut point.normal] {
            [v[0], v[1]] = turned([v[0], v[1]], angle);
        }
    }
    other
}

/// A curved flank far from the origin: z 90 to 127, radius 26 to 43.
pub(crate) fn bevel(size: [usize; 2]) -> Patch {
    let position = |s: f64, t: f64| {
        let (cone, height) = (94.0 + 36.0 * s, (t - 0.4) * (5.0 + 2.5 * s));
        let (sin, cos) = 0.29_f64.sin_cos();
        let (radius, z) = (cone * sin + height * cos, cone * cos - height * sin);
        let angle = 0.5 + 0.42 * s - 0.12 * s * s + 0.09 * t + 0.02 * t * t;
        [radius * angle.cos(), radius * angle.sin(), z]
    };
    grid("concave flank", ["toe -> heel", "root -> tip"], size, |s, t| {
        let step = 1e-5;
        let across = |a: Vector, b: Vector| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
        let along = across(position(s + step, t), position(s - step, t));
        let up = across(position(s, t + step), position(s, t - step));
        point(position(s, t), cross(up, along), [s, t])
    })
}

/// A plane far smaller or larger than a gear.
pub(crate) fn plane(size: [usize; 2], origin: Vector, side: f64) -> Patch {
    grid("plane", ["u", "v"], size, |s, t| {
        point([origin[0] + side * s, origin[1] + side * t, origin[2]], [0.0, 0.0, 1.0], [s, t])
    })
}

/// The patch with the points that `lost` picks unsolved.
pub(crate) fn without(mut patch: Patch, lost: impl Fn(usize, usize) -> Option<&'static str>) -> Patch {
    let columns = patch.columns.count;
    for (at, point) in patch.points.iter_mut().enumerate() {
        if let Some(why) = lost(at / columns, at % columns) {
            *point = Point::unsolved(why, 0.25, format!("{why}, as the test wants it"));
        }
    }
    patch
}

/// The patch with the points of some rows cut away, and one of them undecided: they keep their numbers.
pub(crate) fn undercut(mut patch: Patch, rows: std::ops::Range<usize>) -> Patch {
    let columns = patch.columns.count;
    for point in &mut patch.points[rows.start * columns..rows.end * columns] {
        (point.outcome, point.reason) = (Outcome::Undercut, "by the tool itself".to_string());
    }
    patch.points[rows.start * columns].outcome = Outcome::Undecided;
    patch
}

/// A corner of the grid is outside, and one point is singular.
pub(crate) fn holes(i: usize, j: usize) -> Option<&'static str> {
    match (i, j) {
        _ if i + 2 * j < 9 => Some("out_of_range"),
        (12, 7) => Some("singular"),
        (16..=18, 10..=11) => Some("not_converged"),
        _ => None,
    }
}

pub(crate) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: Vector) -> Vector {
    let length = a.iter().map(|x| x * x).sum::<f64>().sqrt();
    a.map(|x| x / length)
}

fn turned([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

/// Every dataset a picture has to cope with, by name.
pub(crate) fn gallery() -> Vec<(&'static str, Dataset)> {
    let spur = Gear { helix: 0.0, width: 20.0 };
    let flank = spur.flank("right flank", [25, 15]);
    let helical = Gear { helix: 0.4, width: 30.0 };
    let tooth = vec![
        spur.flank("right flank", [21, 15]),
        spur.fillet("right fillet", [21, 9]),
        mirrored(&spur.flank("", [21, 15]), "left flank"),
        mirrored(&spur.fillet("", [21, 9]), "left fillet"),
    ];
    let ring = |k: usize| turned_patch(&flank, 2.0 * std::f64::consts::PI * k as f64 / 24.0, &format!("flank {k}"));
    vec![
        ("spur", dataset("spur flank with fillet", vec![flank.clone(), spur.fillet("fillet", [25, 9])])),
        ("fields", dataset("flank with fields", vec![with_fields(without(flank.clone(), holes)), bevel([3, 2])])),
        ("helical", dataset("helical flank", vec![helical.flank("right flank", [41, 25])])),
        ("bevel", dataset("bevel flank", vec![bevel([21, 11])])),
        ("holes", dataset("flank with holes", vec![without(spur.flank("right flank", [25, 15]), holes)])),
        ("tooth", dataset("both sides of a tooth", tooth)),
        ("ring", dataset("all teeth", (0..24).map(ring).collect())),
        ("dense", dataset("dense helical flank", vec![helical.flank("right flank", [150, 120])])),
        ("coarse", dataset("coarse bevel flank", vec![bevel([5, 3])])),
        ("row", dataset("a single row", vec![spur.flank("right flank", [1, 15])])),
        ("column", dataset("a single column", vec![bevel([9, 1])])),
        ("point", dataset("a single point", vec![spur.flank("right flank", [1, 1])])),
        ("empty", dataset("nothing asked for", Vec::new())),
        (
            "undercut",
            dataset("flank with undercut", vec![undercut(with_fields(spur.flank("right flank", [25, 15])), 0..8)]),
        ),
        ("unsolved", dataset("nothing solved", vec![without(flank, |_, _| Some("out_of_range"))])),
        ("tiny", dataset("a micrometre", vec![plane([3, 3], [1.0, 2.0, 3.0], 1e-3)])),
        ("face", dataset("a plane across the axis", vec![plane([9, 9], [-20.0, -20.0, 0.0], 40.0)])),
    ]
}
