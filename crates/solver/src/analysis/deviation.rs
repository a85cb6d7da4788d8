//! How far one surface lies off another one, along the other's normals.

use flank_expr::geometry::Vector3;
use flank_expr::{Expr, LANES, TapeError};
use rayon::prelude::*;

use crate::analysis::alignment::Alignment;
use crate::equations::solution::{Outcome, Range};
use crate::equations::system::System;
use crate::newton::batch::LaneNewton;
use crate::newton::scalar::{LONGEST_STEP, solve};
use crate::surface::bound::BoundSurface;
use crate::surface::points::SurfacePoint;

/// Distances along a normal are looked for up to here, mm.
pub(crate) const FARTHEST: Range = Range { low: -200.0, high: 200.0 };
/// Points that a thread takes at a time.
const TILE: usize = 16 * LANES;

/// A surface that is compared with points of another one: of the same body in the same frame, but for
/// the motion that lays it onto its place.
#[derive(Clone, Debug)]
pub struct Deviation {
    /// Unknowns of the surface and a distance; the point, the normal and the motion are parameters.
    along_normal: System,
    /// Unknowns of the surface and the motion; the point is a parameter.
    onto_point: System,
    ranges: Vec<Range>,
    alignment: Alignment,
}

impl Deviation {
    /// Of a surface that lies anywhere on the way of this motion.
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown nor has a value.
    ///
    /// # Panics
    /// If the surface does not have two unknowns more than constraints.
    pub fn new<'g>(surface: &BoundSurface<'g>, alignment: Alignment) -> Result<Deviation, TapeError> {
        let bound = surface.surface();
        let graph = bound.position.0[0].graph();
        let vector = |names: [&str; 3]| Vector3(names.map(|name| graph.variable(name)));
        let (point, normal) = (vector(["point x", "point y", "point z"]), vector(["normal x", "normal y", "normal z"]));
        let (distance, by) = (graph.variable("distance"), graph.variable("motion"));
        let moved = alignment.moved_by(bound.position, by);
        let residuals = |apart: Vector3<'g>| surface.constrained(apart.0);
        let unknowns = |last: Expr<'g>| [bound.unknowns.as_slice(), &[last]].concat();
        let reached = point + normal.map(|part| part * distance);
        let parameters: Vec<Expr<'_>> = point.0.into_iter().chain(normal.0).chain([by]).collect();
        Ok(Deviation {
            along_normal: System::new(&residuals(moved - reached), &unknowns(distance), &parameters)?,
            onto_point: System::one_by_one(&residuals(moved - point), &unknowns(by), &point.0)?,
            ranges: surface.ranges().to_vec(),
            alignment,
        })
    }

    /// The same of a surface that was given while settings were open ([`Graph::with_settings`](flank_expr::Graph::with_settings)), with
    /// these values of them.
    #[must_use]
    pub fn with_settings(&self, values: &[f64]) -> Deviation {
        Deviation {
            along_normal: self.along_normal.with_settings(values),
            onto_point: self.onto_point.with_settings(values),
            ranges: self.ranges.clone(),
            alignment: self.alignment,
        }
    }

    /// Makes the machine code that those with other settings share.
    pub fn translate(&self) {
        self.along_normal.translate();
    }

    /// The motion in which the place of the surface is unknown.
    pub fn alignment(&self) -> Alignment {
        self.alignment
    }

    /// The motion that brings the surface to a point. `near` is a point of the surface from which it is looked for: one that the motion
    /// brings near to the point, such as one with the same z and distance from the axis. `None` if the surface does not come to the point
    /// within its ranges.
    pub fn motion_to(&self, point: [f64; 3], near: &SurfacePoint) -> Option<f64> {
        let start = self.alignment.apart(near.position, point);
        self.last_unknown(&self.onto_point, self.alignment.range(), &point, near, start)
    }

    /// How far the surface, moved by so much, lies off a point of another one: along the point's normal, mm, positive on the side to
    /// which it points, which is out of the body. `near` is as in [`Deviation::motion_to`]. `None` if the normal does not meet the surface
    /// within its ranges.
    pub fn along_normal(&self, from: &SurfacePoint, near: &SurfacePoint, by: f64) -> Option<f64> {
        let (start, parameters) = self.asked(from, near, by);
        self.last_unknown(&self.along_normal, FARTHEST, &parameters, near, start)
    }

    /// [`Deviation::along_normal`] at many points, many at once; `None` also where one of the two points is not solved. What needs
    /// care is solved alone.
    ///
    /// # Panics
    /// If there are not as many points of the one as of the other.
    pub fn map(&self, from: &[SurfacePoint], near: &[SurfacePoint], by: f64) -> Vec<Option<f64>> {
        assert_eq!(from.len(), near.len(), "one start for each point");
        let tiles = from.par_chunks(TILE).zip(near.par_chunks(TILE));
        tiles.flat_map_iter(|(from, near)| self.tile(from, near, by)).collect()
    }

    fn tile(&self, from: &[SurfacePoint], near: &[SurfacePoint], by: f64) -> Vec<Option<f64>> {
        let ranges = [&self.ranges[..], &[FARTHEST]].concat();
        let mut newton = LaneNewton::new(&self.along_normal, &ranges);
        let mut found = Vec::with_capacity(from.len());
        for (from, near) in from.chunks(LANES).zip(near.chunks(LANES)) {
            let is_solved = |point: &SurfacePoint| point.outcome == Outcome::Solved;
            let active: Vec<bool> =
                from.iter().zip(near).map(|(from, near)| is_solved(from) && is_solved(near)).collect();
            for lane in (0..active.len()).filter(|lane| active[*lane]) {
                let (start, parameters) = self.asked(&from[lane], &near[lane], by);
                newton.put(lane, near[lane].unknowns.iter().copied().chain([start]), &parameters);
            }
            newton.run(&active, true);
            found.extend((0..active.len()).map(|lane| {
                let is_near = newton.is_root(lane) && newton.moved(lane) <= LONGEST_STEP;
                match active[lane] {
                    false => None,
                    true if is_near && newton.outcome(lane) == Outcome::Solved => {
                        Some(newton.input(self.ranges.len())[lane])
                    }
                    true => self.along_normal(&from[lane], &near[lane], by),
                }
            }));
        }
        found
    }

    /// Where the distance along the normal of a point to the moved surface is looked for first, and the parameters of the system that says
    /// so.
    fn asked(&self, from: &SurfacePoint, near: &SurfacePoint, by: f64) -> (f64, [f64; 7]) {
        let ([x, y, z], [nx, ny, nz]) = (self.alignment.moved(near.position, by), from.normal);
        let [px, py, pz] = from.position;
        ((x - px) * nx + (y - py) * ny + (z - pz) * nz, [px, py, pz, nx, ny, nz, by])
    }

    fn last_unknown(
        &self,
        system: &System,
        range: Range,
        parameters: &[f64],
        near: &SurfacePoint,
        start: f64,
    ) -> Option<f64> {
        let ranges = [&self.ranges[..], &[range]].concat();
        let start = [&near.unknowns[..], &[start]].concat();
        let solution = solve(system, &ranges, parameters, &start);
        (solution.outcome == Outcome::Solved).then(|| solution.unknowns[self.ranges.len()])
    }
}

/// What a map of deviations is like: the parabola in both directions of the grid that fits it best, each direction running from
/// −1 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EaseOff {
    /// From the first row to the last, and from the first column to the last: rise from end to end.
    pub slopes: [f64; 2],
    /// In the same directions: drop from the middle to the ends. Positive for a crowned flank.
    pub crownings: [f64; 2],
    /// Rise along the columns in the last row, less that in the first one.
    pub bias: f64,
}

/// A term of the parabola of which less than this share is its own, over the points with a value, is not told from the others: rounding of
/// the squares leaves 1e-8 of a term that others make up, and three neighbours of a grid of 200 points a hundred times this share.
const INDEPENDENT: f64 = 1e-6;

impl EaseOff {
    /// Of the deviations of a grid whose rows and columns lie at even distances, as [`EaseOff::over_lines`] has it.
    ///
    /// # Panics
    /// If there are not `counts[0] · counts[1]` values.
    pub fn of_deviations(deviations: &[Option<f64>], counts: [usize; 2]) -> Option<EaseOff> {
        let [rows, columns] = counts.map(|count| (0..count).map(|k| k as f64).collect::<Vec<f64>>());
        EaseOff::over_lines(deviations, [&rows, &columns])
    }

    /// Of the deviations of a grid, row by row; `None` where there is none. `lines` says where the rows and where the columns lie on the way
    /// from the first to the last, in any unit. `None` if the deviations are too few or lie too much on a line to say.
    ///
    /// # Panics
    /// If there are not as many values as rows times columns.
    pub fn over_lines(deviations: &[Option<f64>], lines: [&[f64]; 2]) -> Option<EaseOff> {
        let [rows, columns] = lines.map(shares);
        assert_eq!(deviations.len(), rows.len() * columns.len(), "one value for each point of the grid");
        let known = deviations.iter().enumerate().filter_map(|(at, value)| Some((at, (*value)?)));
        let (mut normal, mut right) = (nalgebra::Matrix6::zeros(), nalgebra::Vector6::zeros());
        for (at, value) in known {
            let (v, u) = (rows[at / columns.len()], columns[at % columns.len()]);
            let terms = nalgebra::Vector6::new(1.0, v, u, v * v, v * u, u * u);
            normal += terms * terms.transpose();
            right += terms * value;
        }
        let independent = |l: nalgebra::Vector6<f64>| l.min() > INDEPENDENT * l.max();
        let factors = normal.cholesky().filter(|factors| independent(factors.l().diagonal()))?;
        let [_, v, u, vv, vu, uu] = factors.solve(&right).into();
        Some(EaseOff { slopes: [2.0 * v, 2.0 * u], crownings: [-vv, -uu], bias: 4.0 * vu })
    }
}

/// Places between the first, at −1, and the last, at 1; a single one, and all of them where there is no way between, at 0.
fn shares(places: &[f64]) -> Vec<f64> {
    let (Some(first), Some(last)) = (places.first(), places.last()) else { return Vec::new() };
    let way = last - first;
    places.iter().map(|place| if way == 0.0 { 0.0 } else { 2.0 * (place - first) / way - 1.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use flank_expr::Graph;
    use flank_expr::geometry::Surface;

    /// Two coaxial cylinders, radii 10 and 10.5 mm: everywhere 0.5 mm apart.
    #[test]
    fn a_cylinder_lies_off_a_smaller_one_by_the_difference_of_the_radii() {
        let graph = Graph::new();
        let (angle, height) = (graph.variable("angle"), graph.variable("height"));
        let cylinder = |radius: f64| {
            Surface::parametric([angle, height], Vector3([radius * angle.cos(), radius * angle.sin(), height]), false)
        };
        let ranges = vec![Range { low: -4.0, high: 4.0 }, Range { low: -50.0, high: 50.0 }];
        let deviation = Deviation::new(&BoundSurface::new(&cylinder(10.5), ranges, &[]), Alignment::Turn)
            .expect("nothing else is unknown");
        let point = |angle: f64, radius: f64| SurfacePoint {
            outcome: Outcome::Solved,
            unknowns: vec![angle, 7.0],
            position: [radius * angle.cos(), radius * angle.sin(), 7.0],
            normal: [angle.cos(), angle.sin(), 0.0],
            residual: 0.0,
        };
        for angle in [-3.0, -1.0, 0.2, 2.5] {
            let off = deviation.along_normal(&point(angle, 10.0), &point(angle + 0.1, 10.5), 0.0).expect("it is met");
            assert!((off - 0.5).abs() < 1e-13, "{off}");
            assert_eq!(deviation.motion_to([20.0, 0.0, 7.0], &point(angle, 10.5)), None, "it is farther out");
        }
    }

    /// A plane through the axis, turned against another: the turn is found, and the deviation is none after it.
    #[test]
    fn a_plane_through_the_axis_is_turned_onto_another() {
        let graph = Graph::new();
        let (radius, height) = (graph.variable("radius"), graph.variable("height"));
        let plane = Surface::parametric([radius, height], Vector3([radius, 0.0 * radius, height]), false);
        let ranges = vec![Range { low: 1.0, high: 50.0 }, Range { low: -50.0, high: 50.0 }];
        let deviation =
            Deviation::new(&BoundSurface::new(&plane, ranges, &[]), Alignment::Turn).expect("nothing else is unknown");
        let point = |turn: f64| SurfacePoint {
            outcome: Outcome::Solved,
            unknowns: vec![20.0, 3.0],
            position: [20.0 * turn.cos(), 20.0 * turn.sin(), 3.0],
            normal: [-turn.sin(), turn.cos(), 0.0],
            residual: 0.0,
        };
        let wanted = point(0.3);
        let turn = deviation.motion_to(wanted.position, &point(0.0)).expect("it reaches the point");
        assert!((turn - 0.3).abs() < 1e-14);
        let off = deviation.along_normal(&wanted, &point(0.0), turn).expect("it is met");
        assert!(off.abs() < 1e-12, "{off:e}");
        let as_it_lies = deviation.along_normal(&wanted, &point(0.0), 0.0).expect("it is met");
        assert!((as_it_lies + 20.0 * 0.3f64.tan()).abs() < 1e-12, "{as_it_lies}");
    }

    #[test]
    fn a_parabola_has_its_own_numbers() {
        let [rows, columns] = [7, 11];
        let value = |at: usize| {
            let (v, u) = ((at / columns) as f64 / 3.0 - 1.0, (at % columns) as f64 / 5.0 - 1.0);
            Some(5.0 + 2.0 * v - 3.0 * u - 50.0 * v * v - 25.0 * u * u + 1.5 * u * v)
        };
        let mut deviations: Vec<Option<f64>> = (0..rows * columns).map(value).collect();
        deviations[3] = None;
        let found = EaseOff::of_deviations(&deviations, [rows, columns]).expect("enough values");
        let wanted = EaseOff { slopes: [4.0, -6.0], crownings: [50.0, 25.0], bias: 6.0 };
        let numbers = |of: &EaseOff| [of.slopes[0], of.slopes[1], of.crownings[0], of.crownings[1], of.bias];
        assert!(numbers(&found).iter().zip(numbers(&wanted)).all(|(a, b)| (a - b).abs() < 1e-11), "{found:?}");
        assert_eq!(EaseOff::of_deviations(&[Some(1.0); 5], [1, 5]), None, "one row has no slope across");
    }

    /// The same parabola has the same numbers wherever its rows and columns lie, those that run downwards too: the fit leaves nothing, but the
    /// rounding of its squares.
    #[test]
    fn a_parabola_has_its_own_numbers_over_lines_at_any_distances() {
        let wanted = EaseOff { slopes: [4.0, -6.0], crownings: [50.0, 25.0], bias: 6.0 };
        let (rows, columns) = ([44.0, 45.0, 46.0, 47.0, 55.0], [20.0, -13.0, -14.0, -15.0]);
        let deviations = rows.iter().flat_map(|row| {
            let v = (row - 49.5) / 5.5;
            columns.iter().map(move |column| {
                let u = (2.5 - column) / 17.5;
                Some(5.0 + 2.0 * v - 3.0 * u - 50.0 * v * v - 25.0 * u * u + 1.5 * u * v)
            })
        });
        let found = EaseOff::over_lines(&deviations.collect::<Vec<_>>(), [&rows, &columns]).expect("enough values");
        let numbers = |of: &EaseOff| [of.slopes[0], of.slopes[1], of.crownings[0], of.crownings[1], of.bias];
        assert!(numbers(&found).iter().zip(numbers(&wanted)).all(|(a, b)| (a - b).abs() < 1e-10), "{found:?}");
    }
}
