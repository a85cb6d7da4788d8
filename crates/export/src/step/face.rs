//! A surface as one smooth face, and how far it is off.

use super::spline::SplineSurface;
use crate::points::dataset::{Patch, Point};
use crate::vector::{cross, dot};

/// A smooth face through points of a patch.
#[derive(Debug, Clone)]
pub struct Face {
    pub(super) name: String,
    pub(super) frame: String,
    pub(super) spline: SplineSurface,
    /// Whether the spline's own normal points into the body.
    pub(super) is_turned: bool,
    /// First row, first column of the patch's points.
    first: [usize; 2],
    /// Points of the patch beyond the face: not solved, or beside one that is not.
    pub left_out: usize,
    /// How far it is off, as far as that has been measured.
    pub deviation: Option<Deviation>,
}

/// How far a face is from exact points that it was not made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// The largest distance along the exact normal, mm.
    pub largest: f64,
    /// How many points it was measured at.
    pub points: usize,
    /// Points that should have been measured at and were not: not solved, or with a normal that does not meet the face.
    pub missing: usize,
}

impl Face {
    /// The face through the largest rectangle of solved points of a grid; `None` where there is none of two rows and two columns.
    #[must_use]
    pub fn through(patch: &Patch) -> Option<Face> {
        let (first, counts) = largest_rectangle(patch)?;
        let at = |k: usize| &patch.points[(first[0] + k / counts[1]) * patch.columns.count + first[1] + k % counts[1]];
        let points: Vec<&Point> = (0..counts[0] * counts[1]).map(at).collect();
        let spline = SplineSurface::through(points.iter().map(|point| point.position).collect(), counts);
        let middle = [counts[0] / 2, counts[1] / 2];
        let [_, by_u, by_v] = spline.at(middle[0] as f64, middle[1] as f64);
        let is_turned = dot(cross(by_u, by_v), points[middle[0] * counts[1] + middle[1]].normal) < 0.0;
        Some(Face {
            name: patch.name.clone(),
            frame: patch.frame.clone(),
            spline,
            is_turned,
            first,
            left_out: patch.points.len() - points.len(),
            deviation: None,
        })
    }

    /// Measures it at the points of a grid of the same surface with one more row between any two and one more column between any two.
    #[must_use]
    pub fn measured(self, finer: &Patch) -> Face {
        let mut deviation = Deviation { largest: 0.0, points: 0, missing: 0 };
        let end = self.spline.directions.each_ref().map(|direction| 2 * (direction.count - 1));
        for (i, j, point) in finer.numbered(0, &finer.points) {
            let inside = [i.checked_sub(2 * self.first[0]), j.checked_sub(2 * self.first[1])];
            let [Some(i), Some(j)] = inside else { continue };
            if i > end[0] || j > end[1] || (i % 2 == 0 && j % 2 == 0) {
                continue;
            }
            let start = [i as f64 / 2.0, j as f64 / 2.0];
            let off = if point.is_solved() { self.spline.distance(point.position, point.normal, start) } else { None };
            match off {
                Some(off) => {
                    deviation.points += 1;
                    deviation.largest = deviation.largest.max(off.abs());
                }
                None => deviation.missing += 1,
            }
        }
        Face { deviation: Some(deviation), ..self }
    }

    /// The frame that it is in.
    #[must_use]
    pub fn frame(&self) -> &str {
        &self.frame
    }

    /// How many rows and columns of points it goes through.
    #[must_use]
    pub fn counts(&self) -> [usize; 2] {
        self.spline.directions.each_ref().map(|direction| direction.count)
    }

    /// The four corners' poles are points of the patch: where rows and columns begin and end.
    pub(super) fn pole(&self, row: usize, column: usize) -> usize {
        row * self.spline.directions[1].count + column
    }
}

/// First row and column, and how many of each, of the largest rectangle of solved points with at least two of each.
fn largest_rectangle(patch: &Patch) -> Option<([usize; 2], [usize; 2])> {
    let columns = patch.columns.count;
    let mut above = vec![0; columns];
    let mut best = None;
    let mut most = 0;
    for i in 0..patch.rows.count {
        for (j, above) in above.iter_mut().enumerate() {
            *above = if patch.point(i, j).is_some_and(Point::is_solved) { *above + 1 } else { 0 };
        }
        // the widest rectangle that ends in this row and is as high as the column with the fewest rows above
        let mut open: Vec<(usize, usize)> = Vec::new();
        for j in 0..=columns {
            let height = above.get(j).copied().unwrap_or(0);
            let mut from = j;
            while let Some((start, high)) = open.pop_if(|(_, high)| *high > height) {
                from = start;
                let wide = j - start;
                if high >= 2 && wide >= 2 && high * wide > most {
                    most = high * wide;
                    best = Some(([i + 1 - high, start], [high, wide]));
                }
            }
            open.push((from, height));
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::dataset::{Axis, Layout, Outcome};

    fn patch(rows: &[&str]) -> Patch {
        let axis = |count| Axis { label: String::new(), count };
        let point = |(at, letter): (usize, char)| match letter {
            'x' => Point {
                outcome: Outcome::Solved,
                position: [(at / rows[0].len()) as f64, (at % rows[0].len()) as f64, 0.0],
                normal: [0.0, 0.0, -1.0],
                unknowns: Vec::new(),
                residual: 0.0,
                reason: String::new(),
            },
            _ => Point::unsolved("out_of_range", f64::NAN, String::new()),
        };
        Patch {
            name: "flank".into(),
            frame: "work".into(),
            layout: Layout::Round,
            rows: axis(rows.len()),
            columns: axis(rows[0].len()),
            unknowns: Vec::new(),
            points: rows.concat().chars().enumerate().map(point).collect(),
            fields: Vec::new(),
        }
    }

    #[test]
    fn the_largest_rectangle_is_found() {
        let found = |rows: &[&str]| largest_rectangle(&patch(rows));
        assert_eq!(found(&["xxx", "xxx"]), Some(([0, 0], [2, 3])));
        assert_eq!(found(&["..xx.", ".xxxx", "xxxxx", "xxx.."]), Some(([1, 1], [2, 4])));
        assert_eq!(found(&["x.xx", ".x.x", "x..."]), None);
        assert_eq!(found(&["xx"]), None);
    }

    #[test]
    fn the_side_of_the_body_is_that_of_the_normals() {
        let face = Face::through(&patch(&["xxx", "xxx", "xx."])).expect("a rectangle");
        assert!(face.is_turned);
        assert_eq!((face.counts(), face.left_out), ([2, 3], 3));
    }
}
