//! Where a solved surface meets a plane.

use flank_expr::geometry::Vector3;
use flank_expr::{Expr, ScalarEvaluator, Tape, TapeError};

use crate::equations::solution::Outcome;
use crate::equations::system::System;
use crate::newton::scalar::solve;
use crate::surface::bound::BoundSurface;
use crate::surface::points::SurfacePoint;

/// A plane with two directions in it, all in the frame of the surfaces that it cuts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionPlane {
    /// A point of the plane, mm.
    pub point: [f64; 3],
    /// Its unit normal.
    pub normal: [f64; 3],
    /// Two unit vectors in the plane, square to each other: the axes of the section.
    pub axes: [[f64; 3]; 2],
}

impl SectionPlane {
    /// The distance of a place from the plane, mm; plus on the side of the normal.
    pub fn height(&self, place: [f64; 3]) -> f64 {
        dot(self.normal, self.off_point(place))
    }

    /// A place in the axes of the section, mm.
    pub fn in_axes(&self, place: [f64; 3]) -> [f64; 2] {
        self.axes.map(|axis| dot(axis, self.off_point(place)))
    }

    fn off_point(&self, place: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| place[k] - self.point[k])
    }

    /// The points in which a surface meets the plane, in order along the line that they make: `count` of them, spread evenly in the axis
    /// along which the line is longer, each solved to rounding. `points` is a solved grid of `counts` rows and columns of the surface; its
    /// lines that cross the plane give the ends and the starts. A place at which no point is solved has none.
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown nor has a value.
    pub fn cut(
        &self,
        surface: &BoundSurface<'_>,
        (points, counts): (&[SurfacePoint], [usize; 2]),
        count: usize,
    ) -> Result<Vec<SurfacePoint>, TapeError> {
        let starts = self.starts(points, counts);
        let Some((low, high)) = starts.first().zip(starts.last()).map(|(low, high)| (low.place, high.place)) else {
            return Ok(Vec::new());
        };
        let axis = usize::from((high[0] - low[0]).abs() <= (high[1] - low[1]).abs());
        let cutting = Cutting::new(self, surface, axis)?;
        let spaced = (0..count).map(|step| {
            let share = step as f64 / (count.max(2) - 1) as f64;
            low[axis] + share * (high[axis] - low[axis])
        });
        let found = spaced.filter_map(|target| {
            let off = |start: &Start| (start.place[axis] - target).abs();
            let near = starts.iter().min_by(|a, b| off(a).total_cmp(&off(b)))?;
            cutting.point(target, &near.unknowns)
        });
        Ok(found.collect())
    }

    /// Where the lines of a grid cross the plane: of rows and columns those that do so more often.
    fn starts(&self, points: &[SurfacePoint], [rows, columns]: [usize; 2]) -> Vec<Start> {
        let mut best: Vec<Vec<Start>> = Vec::new();
        for along_rows in [true, false] {
            let (lines, steps) = if along_rows { (columns, rows) } else { (rows, columns) };
            let crossings = |line: usize| -> Vec<Start> {
                let at = |step: usize| if along_rows { step * columns + line } else { line * columns + step };
                (1..steps).filter_map(|step| self.between(&points[at(step - 1)], &points[at(step)])).collect()
            };
            let found: Vec<Vec<Start>> = (0..lines).map(crossings).filter(|found| !found.is_empty()).collect();
            if found.len() > best.len() {
                best = found;
            }
        }
        beside_each_other(best)
    }

    fn between(&self, from: &SurfacePoint, to: &SurfacePoint) -> Option<Start> {
        let height = |point: &SurfacePoint| (point.outcome == Outcome::Solved).then(|| self.height(point.position));
        let (low, high) = (height(from)?, height(to)?);
        let share = low / (low - high);
        let mix = |a: f64, b: f64| a + share * (b - a);
        ((low <= 0.0) != (high <= 0.0)).then(|| Start {
            place: self.in_axes([0, 1, 2].map(|k| mix(from.position[k], to.position[k]))),
            unknowns: from.unknowns.iter().zip(&to.unknowns).map(|(a, b)| mix(*a, *b)).collect(),
        })
    }
}

/// Where a line of a grid crosses the plane, between two of its points.
struct Start {
    /// In the axes of the section.
    place: [f64; 2],
    unknowns: Vec<f64>,
}

impl Start {
    /// How far it is from a place in the axes of the section.
    fn off(&self, place: [f64; 2]) -> f64 {
        (self.place[0] - place[0]).hypot(self.place[1] - place[1])
    }
}

/// One crossing of each line, beginning with that nearest to the point of the plane: a thread passes the plane once in each turn.
fn beside_each_other(mut crossings: Vec<Vec<Start>>) -> Vec<Start> {
    let least = |of: &Vec<Start>| of.iter().map(|start| start.off([0.0; 2])).fold(f64::INFINITY, f64::min);
    let middle = (0..crossings.len()).min_by(|a, b| least(&crossings[*a]).total_cmp(&least(&crossings[*b])));
    let Some(middle) = middle else { return Vec::new() };
    let after = crossings.split_off(middle);
    let follow = |lines: &mut dyn Iterator<Item = Vec<Start>>, mut place: [f64; 2]| -> Vec<Start> {
        let nearest = |of: Vec<Start>, place| of.into_iter().min_by(|a, b| a.off(place).total_cmp(&b.off(place)));
        let next = |of: Vec<Start>| nearest(of, place).inspect(|start| place = start.place);
        lines.filter_map(next).collect()
    };
    let after = follow(&mut after.into_iter(), [0.0; 2]);
    let before = follow(&mut crossings.into_iter().rev(), after[0].place);
    before.into_iter().rev().chain(after).collect()
}

/// Points of a surface in the plane at given values along one of its axes.
struct Cutting<'s, 'g> {
    surface: &'s BoundSurface<'g>,
    system: System,
    /// Position and normal.
    point: Tape,
}

impl<'s, 'g> Cutting<'s, 'g> {
    fn new(plane: &SectionPlane, surface: &'s BoundSurface<'g>, axis: usize) -> Result<Cutting<'s, 'g>, TapeError> {
        let bound = surface.surface();
        let graph = bound.position.0[0].graph();
        let vector = |parts: [f64; 3]| Vector3::constant(graph, parts);
        let along = |direction| (bound.position - vector(plane.point)).dot(vector(direction));
        let target = graph.variable("target");
        let residuals = surface.constrained([along(plane.normal), along(plane.axes[axis]) - target]);
        let outputs: Vec<Expr<'g>> = bound.position.0.into_iter().chain(bound.normal.0).collect();
        Ok(Cutting {
            surface,
            system: System::new(&residuals, &bound.unknowns, &[target])?,
            point: Tape::new(&outputs, &bound.unknowns)?,
        })
    }

    fn point(&self, target: f64, start: &[f64]) -> Option<SurfacePoint> {
        let solution = solve(&self.system, self.surface.ranges(), &[target], start);
        let is_solved = solution.outcome == Outcome::Solved;
        is_solved.then(|| {
            let mut out = [0.0; 6];
            ScalarEvaluator::new(&self.point).run(&solution.unknowns, &mut out);
            let [x, y, z, nx, ny, nz] = out;
            SurfacePoint {
                outcome: solution.outcome,
                unknowns: solution.unknowns,
                position: [x, y, z],
                normal: [nx, ny, nz],
                residual: solution.residual,
            }
        })
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use flank_expr::Graph;
    use flank_expr::geometry::Surface;

    use super::*;
    use crate::equations::solution::Range;
    use crate::surface::SurfaceProblem;

    /// A cylinder of radius 10 cut obliquely: an ellipse of half axes 10 and 10/cos(slope), whose points are checked in closed form.
    #[test]
    fn an_oblique_section_of_a_cylinder_is_an_ellipse() {
        let graph = Graph::new();
        let [angle, z] = ["angle", "z"].map(|name| graph.variable(name));
        let cylinder = Surface::parametric([angle, z], Vector3([angle.cos() * 10.0, angle.sin() * 10.0, z]), false);
        let ranges = vec![Range { low: -1.0, high: 1.0 }, Range { low: -20.0, high: 20.0 }];
        let surface = BoundSurface::new(&cylinder, ranges, &[]);
        let targets: Vec<[f64; 2]> =
            (0..121).map(|k| [-0.5 + 0.1 * (k / 11) as f64, -15.0 + 3.0 * (k % 11) as f64]).collect();
        let problem = SurfaceProblem::new(&surface, [angle, z]).expect("nothing is unbound");
        let (points, _) = problem.solve(&targets, [11, 11]);
        let (sine, cosine) = 0.4f64.sin_cos();
        let plane = SectionPlane {
            point: [10.0, 0.0, 0.0],
            normal: [0.0, -sine, cosine],
            axes: [[1.0, 0.0, 0.0], [0.0, cosine, sine]],
        };
        let line = plane.cut(&surface, (&points, [11, 11]), 31).expect("nothing is unbound");
        assert_eq!(line.len(), 31);
        for point in &line {
            let [x, y] = plane.in_axes(point.position);
            let on_ellipse = ((x + 10.0) / 10.0).powi(2) + (y * cosine / 10.0).powi(2) - 1.0;
            // a residual of 1e-14 mm on an ellipse of 10 mm
            assert!(on_ellipse.abs() < 1e-14 && plane.height(point.position).abs() < 1e-13, "{point:?}");
        }
        let away = SectionPlane { point: [0.0, 0.0, 30.0], normal: [0.0, 0.0, 1.0], ..plane };
        assert!(away.cut(&surface, (&points, [11, 11]), 31).expect("nothing is unbound").is_empty());
    }

    /// A helicoid of four turns passes its axial plane twice in each: the section is the straight line of the turn in the middle.
    #[test]
    fn a_section_of_a_thread_stays_in_one_turn() {
        let graph = Graph::new();
        let [out, turn] = ["out", "turn"].map(|name| graph.variable(name));
        let thread = Surface::parametric([out, turn], Vector3([out * turn.cos(), out * turn.sin(), turn * 2.0]), false);
        let ends = [(10.0, 14.0), (-12.5, 12.5)];
        let ranges = ends.map(|(low, high)| Range { low, high });
        let surface = BoundSurface::new(&thread, ranges.to_vec(), &[]);
        let targets: Vec<[f64; 2]> =
            (0..5 * 61).map(|k| [ranges[0].at((k / 61) as f64 / 4.0), ranges[1].at((k % 61) as f64 / 60.0)]).collect();
        let problem = SurfaceProblem::new(&surface, [out, turn]).expect("nothing is unbound");
        let (points, _) = problem.solve(&targets, [5, 61]);
        let plane =
            SectionPlane { point: [12.0, 0.0, 0.0], normal: [0.0, 1.0, 0.0], axes: [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]] };
        let line = plane.cut(&surface, (&points, [5, 61]), 9).expect("nothing is unbound");
        assert_eq!(line.len(), 9);
        for (k, point) in line.iter().enumerate() {
            // an angle is solved to 1e-13 on a radius of 14 mm
            let [along, up] = plane.in_axes(point.position);
            assert!(along.abs() < 1e-11 && (up + 2.0 - 0.5 * k as f64).abs() < 1e-11, "{point:?}");
        }
    }
}
