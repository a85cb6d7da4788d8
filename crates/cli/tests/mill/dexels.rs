//! A program's moves of one tooth space, cut out of dexels: rays 20 um apart, each as long as no ball has entered it. Words, frames of the
//! machine and cutting are written here anew, in plain numbers.

use std::collections::HashMap;
use std::path::Path;

use serde_json::Value;

use crate::support::{folder, top};
use crate::{json, text_of};

type Point = [f64; 3];

/// Of the library's job `milled_pinion`: a ball of 1 mm, the work 60 mm above the centre of both rotary axes, which count the turns of the tool.
const RADIUS: f64 = 1.0;
const WORK_Z: f64 = 60.0;

/// Between dexels, mm.
const CELL: f64 = 0.02;
/// The centre of the ball goes straight for about so long, mm: on a curve of 100 mm it is then off by 0.02 um.
const STEP: f64 = 0.12;
/// Dexels are cut so near to where the ball may touch the flank, mm: a pass farther away leaves more than the one beside a dexel.
const REACH: f64 = 0.25;

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: Point) -> Point {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

/// The centre of the ball in the work, where the axes stand so: mm and degrees, as words have them.
fn center([x, y, z, a, c]: [f64; 5]) -> Point {
    // words count the tool against the work: the table turns the other way
    let (sa, ca) = (-a).to_radians().sin_cos();
    let (sc, cc) = (-c).to_radians().sin_cos();
    // from the bed into the trunnion, then into the table: a turn back about x, then about z
    let into = |v: Point| {
        let [x, y, z] = [v[0], ca * v[1] + sa * v[2], ca * v[2] - sa * v[1]];
        [cc * x + sc * y, cc * y - sc * x, z]
    };
    // the spindle stands upright in the bed, and the tip is a radius below the centre
    let at = into([x, y, z + RADIUS]);
    [at[0], at[1], at[2] - WORK_Z]
}

/// The positions of the axes at the ends of blocks that cut.
fn blocks(program: &str) -> Vec<[[f64; 5]; 2]> {
    let mut at: HashMap<char, f64> = HashMap::new();
    let mut found = Vec::new();
    let mut is_cutting = false;
    for line in program.lines() {
        let code = line.split(['(', ';']).next().unwrap_or_default();
        let before = at.clone();
        let words: Vec<(char, f64)> =
            code.split_whitespace().filter_map(|word| Some((word.chars().next()?, word[1..].parse().ok()?))).collect();
        for (letter, value) in &words {
            match letter {
                'G' if *value == 0.0 => is_cutting = false,
                'G' if *value == 1.0 => is_cutting = true,
                // all axes in the machine's own coordinates: away
                'X' | 'Y' | 'Z' | 'A' | 'C' => {
                    at.insert(*letter, *value);
                }
                _ => {}
            }
        }
        let of = |from: &HashMap<char, f64>| -> Option<[f64; 5]> {
            let each: Option<Vec<f64>> = "XYZAC".chars().map(|letter| from.get(&letter).copied()).collect();
            each?.try_into().ok()
        };
        let moves = words.iter().any(|(letter, _)| "XYZAC".contains(*letter));
        if let (true, true, Some(from), Some(to)) = (is_cutting, moves, of(&before), of(&at)) {
            found.push([from, to]);
        }
    }
    found
}

/// Rays along one direction, on a square grid across it.
struct Dexels {
    axes: [Point; 3],
    origin: [f64; 2],
    counts: [usize; 2],
    /// How far each ray still reaches, mm.
    tops: Vec<f64>,
}

impl Dexels {
    /// Over some places, along a direction out of the work.
    fn over(places: &[Point], out: Point) -> Dexels {
        let across = unit(cross(out, [0.0, 0.0, 1.0]));
        let axes = [across, cross(out, across), out];
        let ends = |k: usize| {
            let values = places.iter().map(|place| dot(*place, axes[k]));
            values.fold([f64::MAX, f64::MIN], |[low, high], x| [low.min(x), high.max(x)])
        };
        let [u, v] = [ends(0), ends(1)];
        let count = |[low, high]: [f64; 2]| ((high - low + 2.0 * REACH) / CELL).ceil() as usize + 2;
        let counts = [count(u), count(v)];
        Dexels { axes, origin: [u[0] - REACH, v[0] - REACH], counts, tops: vec![f64::INFINITY; counts[0] * counts[1]] }
    }

    /// Cuts with a ball that goes straight from one place to another, and touches about there.
    fn cut(&mut self, from: Point, to: Point, touched: [Point; 2]) {
        let way = [0, 1, 2].map(|k| to[k] - from[k]);
        let length = dot(way, way).sqrt();
        let along = if length > 0.0 { way.map(|x| x / length) } else { [0.0; 3] };
        let range = |k: usize| {
            let ends = touched.map(|at| (dot(at, self.axes[k]) - self.origin[k]) / CELL);
            let (low, high) = (ends[0].min(ends[1]) - REACH / CELL, ends[0].max(ends[1]) + REACH / CELL);
            (low.ceil().max(0.0) as usize, (high.floor().max(-1.0) + 1.0).min(self.counts[k] as f64) as usize)
        };
        let ((first, last), (left, right)) = (range(0), range(1));
        let out = self.axes[2];
        // how the ray goes along the way, and how fast it leaves it
        let slope = dot(out, along);
        for i in first..last {
            for j in left..right {
                let [u, v] = [self.origin[0] + i as f64 * CELL, self.origin[1] + j as f64 * CELL];
                let foot = [0, 1, 2].map(|k| u * self.axes[0][k] + v * self.axes[1][k]);
                // the ray enters the cylinder about the way, or the ball at the end of it that lies beyond
                let enters = |about: Point, slope: f64, along: Point| -> Option<(f64, f64)> {
                    let y = [0, 1, 2].map(|k| foot[k] - about[k]);
                    let ahead = dot(y, along);
                    let (a, b) = (1.0 - slope * slope, dot(y, out) - ahead * slope);
                    let c = dot(y, y) - ahead * ahead - RADIUS * RADIUS;
                    let root = b * b - a * c;
                    let at = (-b - root.max(0.0).sqrt()) / a;
                    (root >= 0.0).then_some((at, ahead + at * slope))
                };
                let cut = match enters(from, slope, along) {
                    Some((at, ahead)) if (0.0..=length).contains(&ahead) => Some(at),
                    Some((_, ahead)) => enters(if ahead < 0.0 { from } else { to }, 0.0, [0.0; 3]).map(|(at, _)| at),
                    None => None,
                };
                let top = &mut self.tops[i * self.counts[1] + j];
                *top = top.min(cut.unwrap_or(f64::INFINITY));
            }
        }
    }

    /// How high the steel stands over a point along its normal: where the line meets the tops of the four dexels about it.
    fn height(&self, point: Point, normal: Point) -> Option<f64> {
        let mut height = 0.0;
        for _ in 0..20 {
            let at = [0, 1, 2].map(|k| point[k] + height * normal[k]);
            let [u, v] = [0, 1].map(|k| (dot(at, self.axes[k]) - self.origin[k]) / CELL);
            let (i, j) = (u.floor() as usize, v.floor() as usize);
            let top = |i: usize, j: usize| self.tops.get(i * self.counts[1] + j).copied().filter(|top| top.is_finite());
            let (a, b) = (u - u.floor(), v - v.floor());
            let low = (1.0 - b) * top(i, j)? + b * top(i, j + 1)?;
            let high = (1.0 - b) * top(i + 1, j)? + b * top(i + 1, j + 1)?;
            let off = (1.0 - a) * low + a * high - dot(at, self.axes[2]);
            height += off / dot(normal, self.axes[2]);
            if off.abs() < 1e-9 {
                return Some(height);
            }
        }
        None
    }
}

/// The points of the map with their normals and what the program leaves there, um.
fn map(file: &Path) -> Vec<(Point, Point, f64)> {
    let text = text_of(file);
    let mut rows = text.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').collect::<Vec<_>>());
    let header = rows.next().expect("a header");
    let column = |name: &str| header.iter().position(|title| *title == name).expect("a column");
    let at = ["x", "y", "z", "nx", "ny", "nz", "left_by_program"].map(column);
    rows.map(|row| {
        let [x, y, z, nx, ny, nz, left] = at.map(|k| row[k].parse::<f64>().expect("a number"));
        ([x, y, z], [nx, ny, nz], left)
    })
    .collect()
}

#[test]
fn dexels_cut_by_the_program_stand_as_high_as_it_is_said_to_leave() {
    let out = folder("mill_dexels");
    let spec = top().join("specs/bevel/milled_pinion.chain");
    let spec = spec.to_str().expect("a plain path");
    json(spec, &out, &["finish", "--nc", "linuxcnc"]);
    let program = out.join("milled_pinion.finish.ngc");
    let read: Value = json(spec, &out, &["finish", "--verify", program.to_str().unwrap()]);
    let points = map(&out.join("milled_pinion.finish.left.csv"));
    assert_eq!(points.len(), 465);
    let mean = points.iter().fold([0.0; 3], |sum, (_, normal, _)| [0, 1, 2].map(|k| sum[k] + normal[k]));
    let places: Vec<Point> = points.iter().map(|(point, ..)| *point).collect();
    let mut dexels = Dexels::over(&places, unit(mean));
    let blocks = blocks(&text_of(&program));
    assert_eq!(blocks.len() as u64, read["verified"]["blocks"].as_u64().unwrap());
    let apart = |a: Point, b: Point| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    for [from, to] in &blocks {
        // all axes go straight
        let at = |share: f64| center([0, 1, 2, 3, 4].map(|k| from[k] + share * (to[k] - from[k])));
        let parts = (apart(at(0.0), at(1.0)) / STEP).ceil().max(1.0) as usize;
        let middle = at(0.5);
        let nearest = points.iter().min_by(|a, b| apart(a.0, middle).total_cmp(&apart(b.0, middle)));
        let (_, normal, _) = nearest.expect("points");
        let centers: Vec<Point> = (0..=parts).map(|part| at(part as f64 / parts as f64)).collect();
        for pair in centers.windows(2) {
            let touched = [pair[0], pair[1]].map(|at| [0, 1, 2].map(|k| at[k] - RADIUS * normal[k]));
            dexels.cut(pair[0], pair[1], touched);
        }
    }
    let cusp = read["cusp"]["height_um"].as_f64().unwrap();
    let left_by_blocks = read["blocks"][0]["height_um"].as_f64().unwrap();
    // between dexels the tops are taken as straight: a ball is bent by 20 um squared over 8 R; where a ridge runs between two, its sides, which rise
    // by up to 4 H per step of some 130 um to both sides, are cut off by a quarter of a cell at the most; and beyond the nearest
    // cells of a flank that leans against the rays cells are longer
    let bent = 1e3 * CELL * CELL / (8.0 * RADIUS);
    let kink = 4.0 * cusp * 1e-3 / 0.129 * 0.5 * 1e3 * CELL;
    let mut off: Vec<f64> = Vec::new();
    for (point, normal, left) in &points {
        let lean = dot(*normal, dexels.axes[2]);
        assert!(lean > 0.7, "the rays meet the flank: {lean}");
        let height = 1e3 * dexels.height(*point, *normal).expect("it is cut");
        let difference = height - left;
        assert!(
            difference.abs() < (2.0 * bent + kink) / lean.powi(3),
            "{height} um by dexels, {left} um told, at {point:?}"
        );
        assert!(
            height < cusp + left_by_blocks + 2.0 * bent / lean.powi(3),
            "{height} um, planned {cusp} and {left_by_blocks}"
        );
        off.push(difference.abs());
    }
    // most points lie on no ridge
    off.sort_by(f64::total_cmp);
    assert!(off[off.len() / 2] < 2.0 * bent, "{} um", off[off.len() / 2]);
}
