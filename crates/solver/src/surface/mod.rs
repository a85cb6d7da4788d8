//! Points of one surface at given values of two coordinates.

pub(crate) mod bands;
pub(crate) mod body;
pub(crate) mod bound;
pub(crate) mod certify;
pub(crate) mod family;
pub(crate) mod points;

use std::convert::Infallible;

use flank_expr::{Expr, InstructionSet, LaneTape, ScalarEvaluator, Tape, TapeError};

use crate::continuation::choice::{Choice, Several, kept};
use crate::continuation::field::Field;
use crate::continuation::follow::solve_settled;
use crate::continuation::grid::{Grid, GridReport};
use crate::continuation::reach::{Reach, periodic_in};
use crate::continuation::verdicts::{Keep, TangentPlanes};
use crate::equations::solution::{Outcome, Range, Solution, verdict};
use crate::equations::system::System;
use crate::roots::angles::SearchSystem;
use crate::roots::known::KnownRoots;
use crate::roots::{MOST_BOXES, Roots, all_roots};
use crate::surface::bands::{Band, Targets, solve_in_bands};
use crate::surface::bound::{BoundSurface, PointEquations};
use crate::surface::points::{SurfacePoint, SurfacePoints};

/// Grids of more points are solved in bands of rows, see [`SurfaceProblem::in_bands`].
pub const MOST_AT_ONCE: usize = 1 << 20;
/// Boxes that are looked at for a line on a surface: at one of its points, and at all points together before the search is given up. A
/// surface has such lines mostly beyond what it is used for, or none; those of the library's jobs are found at the first four points.
const MOST_BOXES_OF_LINE: u64 = 400;
const MOST_BOXES_OF_WHOLE_LINE: u64 = 5 * MOST_BOXES_OF_LINE;
/// Boxes that are looked at at all points of a surface together, as many times those of one point.
const BOXES_OF_ALL: u64 = 10;
/// Bands that a grid which is just too large for one piece makes.
const BANDS: usize = 4;

/// A surface under constraint with two coordinates that points are asked for by.
#[derive(Clone, Debug)]
pub struct SurfaceProblem {
    system: System,
    search: Option<SearchSystem>,
    /// Position and normal.
    point: Tape,
    /// The unknowns that the coordinates are, where they are unknowns.
    asked: [Option<usize>; 2],
    /// The Jacobian of the equations row by row, then the derivatives of the position by each unknown.
    slopes: LaneTape,
    ranges: Vec<Range>,
    several: Several,
    /// Functions of the unknowns, and between which values they lie on the branch that is meant.
    keep: (Tape, LaneTape, Vec<Range>),
    /// Where the unknowns of that branch are.
    kept_ranges: Vec<Range>,
    /// Unknowns that mean the same after a turn.
    periodic: Vec<bool>,
    /// Where a branch is followed beyond its ranges.
    reach: Option<Reach>,
    /// Points of the largest grid that is solved in one piece.
    at_once: usize,
    /// Boxes that a search for all roots looks at.
    most_boxes: u64,
    tells_others: bool,
}

impl SurfaceProblem {
    /// Points of `surface` at which two `coordinates` (functions of its unknowns) have given values.
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown nor has a value.
    ///
    /// # Panics
    /// If the surface does not have two unknowns more than constraints.
    pub fn new<'g>(surface: &BoundSurface<'g>, coordinates: [Expr<'g>; 2]) -> Result<SurfaceProblem, TapeError> {
        SurfaceProblem::clear_of_tool(surface, coordinates, false)
    }

    /// The same, with the principal curvatures at each point of a grid
    /// ([`SurfacePoints::principal_curvatures`](crate::SurfacePoints::principal_curvatures)).
    ///
    /// # Errors
    /// As for [`SurfaceProblem::new`].
    ///
    /// # Panics
    /// As for [`SurfaceProblem::new`].
    pub fn with_curvatures<'g>(
        surface: &BoundSurface<'g>,
        coordinates: [Expr<'g>; 2],
    ) -> Result<SurfaceProblem, TapeError> {
        SurfaceProblem::clear_of_tool(surface, coordinates, true)
    }

    /// A surface whose points the tool does not cut away again, with curvatures or without.
    fn clear_of_tool<'g>(
        surface: &BoundSurface<'g>,
        coordinates: [Expr<'g>; 2],
        is_curved: bool,
    ) -> Result<SurfaceProblem, TapeError> {
        let conditions = surface.surface().clearance_minors();
        SurfaceProblem::with_conditions(surface, (coordinates, is_curved), &conditions, Several::Refuse)
    }

    /// Points of the line on `surface` on which `quantity` is zero, at given values of one more coordinate: solve it with
    /// targets `[0, value]`. The singular line has the last of [`clearance_minors`](flank_expr::geometry::Surface::clearance_minors) as its quantity, the limit of
    /// the contact on the tool [`contact_limit`](flank_expr::geometry::Surface::contact_limit).
    ///
    /// Of several such lines in the ranges the one is taken that reaches the most points; [`GridReport`] tells of the others. No
    /// point of the line is cut away or singular by the clearance's Hessian: the line is where that changes. The rest is
    /// as for [`SurfaceProblem::new`].
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown nor has a value.
    ///
    /// # Panics
    /// If the surface does not have two unknowns more than constraints.
    pub fn line<'g>(
        surface: &BoundSurface<'g>,
        quantity: Expr<'g>,
        along: Expr<'g>,
    ) -> Result<SurfaceProblem, TapeError> {
        SurfaceProblem::with_conditions(surface, ([quantity, along], false), &[], Several::TakeWidest)
    }

    fn with_conditions<'g>(
        surface: &BoundSurface<'g>,
        (coordinates, is_curved): ([Expr<'g>; 2], bool),
        conditions: &[Expr<'g>],
        several: Several,
    ) -> Result<SurfaceProblem, TapeError> {
        let (bound, ranges) = (surface.surface(), surface.ranges().to_vec());
        let PointEquations { targets, coordinates, residuals } = surface.equations_at(coordinates);
        let point: Vec<Expr<'g>> = bound.position.0.into_iter().chain(bound.normal.0).collect();
        let curvatures = if is_curved { bound.principal_curvatures(coordinates) } else { None };
        let extras: Vec<Expr<'g>> = point.iter().copied().chain(curvatures.into_iter().flatten()).collect();
        let inputs: Vec<Expr<'g>> = bound.unknowns.iter().copied().chain(targets).collect();
        let asked = coordinates.map(|coordinate| bound.unknowns.iter().position(|unknown| *unknown == coordinate));
        let decisive = residuals.len() + conditions.len() + point.len();
        let system = System::new(&residuals, &bound.unknowns, &targets)?
            .with_conditions(&residuals, conditions, &extras, &inputs)?;
        let point = Tape::new(&point, &bound.unknowns)?;
        let jacobian = residuals.iter().flat_map(|f| bound.unknowns.iter().map(|unknown| f.derivative(*unknown)));
        let moved = bound.unknowns.iter().flat_map(|unknown| bound.position.derivative(*unknown).0);
        let slopes = Tape::new(&jacobian.chain(moved).collect::<Vec<Expr<'g>>>(), &inputs)?;
        Ok(SurfaceProblem {
            periodic: periodic_in(&system.lanes.checked, decisive, &ranges),
            reach: None,
            search: SearchSystem::new(&residuals, &bound.unknowns, &targets, conditions)?,
            system,
            point,
            asked,
            slopes: LaneTape::new(&slopes),
            kept_ranges: vec![Range::EVERYTHING; ranges.len()],
            ranges,
            several,
            at_once: MOST_AT_ONCE,
            most_boxes: MOST_BOXES,
            tells_others: true,
            keep: kept_by(&[], &bound.unknowns, Vec::new())?,
        })
    }

    /// The same problem, for whose grids only these instructions are used; see [`System::with_instruction_set`].
    pub fn with_instruction_set(self, instructions: InstructionSet) -> SurfaceProblem {
        SurfaceProblem { system: self.system.with_instruction_set(instructions), ..self }
    }

    /// The same problem, where a grid is solved in bands of rows if it has more points than this. It sets how much memory a grid
    /// takes that is handed over band by band, and which of its points are solved before which: their last digits may differ.
    pub fn at_once(self, points: usize) -> SurfaceProblem {
        SurfaceProblem { at_once: points, ..self }
    }

    /// The same problem, whose searches for all roots look at so many boxes before they leave the rest undecided; [`MOST_BOXES`]
    /// otherwise.
    pub fn boxes(self, most: u64) -> SurfaceProblem {
        SurfaceProblem { most_boxes: most, ..self }
    }

    /// The same problem, where nothing but points is asked for: further branches, which [`GridReport::elsewhere`] tells of otherwise, are
    /// not looked for unless the points depend on whether there are any.
    pub fn points_alone(self) -> SurfaceProblem {
        SurfaceProblem { tells_others: false, ..self }
    }

    /// The same problem with other numbers for the settings of its tapes.
    pub(crate) fn with_settings(&self, values: &[f64]) -> SurfaceProblem {
        SurfaceProblem {
            system: self.system.with_settings(values),
            search: self.search.as_ref().map(|search| search.with_settings(values)),
            point: self.point.with_settings(values),
            slopes: self.slopes.with_settings(values),
            keep: (self.keep.0.with_settings(values), self.keep.1.with_settings(values), self.keep.2.clone()),
            asked: self.asked,
            ranges: self.ranges.clone(),
            several: self.several,
            kept_ranges: self.kept_ranges.clone(),
            periodic: self.periodic.clone(),
            reach: self.reach.clone(),
            at_once: self.at_once,
            most_boxes: self.most_boxes,
            tells_others: self.tells_others,
        }
    }

    /// Which unknowns mean the same after a turn.
    pub fn periodic(&self) -> &[bool] {
        &self.periodic
    }

    /// The system that is solved for each point.
    pub fn system(&self) -> &System {
        &self.system
    }

    /// Position and normal as functions of the unknowns.
    pub(crate) fn point_tape(&self) -> &Tape {
        &self.point
    }

    /// Every point of the surface with given values of the two coordinates: all roots in the ranges (and in what is kept of them),
    /// proven.
    pub fn all_points(&self, target: [f64; 2]) -> Roots {
        self.roots(&kept(&self.ranges, &self.kept_ranges, &self.periodic), &target)
    }

    fn roots(&self, ranges: &[Range], target: &[f64]) -> Roots {
        let most_boxes = if self.is_line() { MOST_BOXES_OF_LINE } else { self.most_boxes };
        match &self.search {
            Some(search) => search.all_roots(ranges, target, most_boxes),
            None => all_roots(&self.system, ranges, target, most_boxes),
        }
    }

    /// The same problem, where only those branches qualify on which functions of the unknowns lie in ranges at the place
    /// that is looked at first, and of these only the points at which they do: others are [`Outcome::NotKept`].
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown nor has a value.
    pub fn keeping<'g>(
        self,
        surface: &BoundSurface<'g>,
        keep: &[(Expr<'g>, Range)],
    ) -> Result<SurfaceProblem, TapeError> {
        let unknowns = &surface.surface().unknowns;
        let values: Vec<Expr<'g>> = keep.iter().map(|(value, _)| *value).collect();
        let values = surface.with_values(&values);
        let ranges = keep.iter().map(|(_, range)| *range).collect();
        let mut kept_ranges = self.kept_ranges;
        for (kept, unknown) in kept_ranges.iter_mut().zip(unknowns) {
            keep.iter().filter(|(value, _)| value == unknown).for_each(|(_, range)| *kept = kept.common(*range));
        }
        Ok(SurfaceProblem { keep: kept_by(&values, unknowns, ranges)?, kept_ranges, ..self })
    }

    /// The same problem, whose branch is followed through wider ranges than its own: where it has no point in its ranges at the
    /// middle of a grid, or leaves them and comes back. Only points within its own count as solved; of the others
    /// [`Outcome::Outside`] tells by how much they miss them.
    ///
    /// # Panics
    /// If `wider` has not one range for each unknown.
    pub fn following_beyond(self, wider: Vec<Range>) -> SurfaceProblem {
        assert_eq!(wider.len(), self.ranges.len(), "one range for each unknown");
        // a turn of what is periodic is all there is
        let searched = wider.iter().zip(&self.ranges).zip(&self.periodic);
        let searched = searched.map(|((wider, own), is_periodic)| if *is_periodic { own.turn() } else { *wider });
        let searched = searched.collect();
        SurfaceProblem { reach: Some(Reach { ranges: wider, searched }), ..self }
    }

    /// Solves a grid of targets, row by row; every point gets a verdict. If the ranges hold several branches that qualify,
    /// every point is [`Outcome::Ambiguous`], and [`GridReport::branches`] lists them.
    ///
    /// # Panics
    /// If there are not `counts[0] · counts[1]` targets.
    pub fn solve(&self, targets: &[[f64; 2]], counts: [usize; 2]) -> (Vec<SurfacePoint>, GridReport) {
        let (points, effort) = self.solve_points(targets, counts, None, None);
        ((0..points.len()).map(|k| points.point(k)).collect(), effort)
    }

    /// The same for very many points. `start`, if there is one, tells the branch: unknowns from which Newton reaches it at the
    /// point in the middle of the grid (near it, in a grid of more than [`MOST_AT_ONCE`] points). If it does not, the branch is looked for as without. `memory` may be points that are
    /// not needed any more: those of a grid of the same size give their memory to the new ones.
    ///
    /// # Panics
    /// If there are not `counts[0] · counts[1]` targets, or `start` has not one number for each unknown.
    pub fn solve_points(
        &self,
        targets: &[[f64; 2]],
        counts: [usize; 2],
        start: Option<&[f64]>,
        memory: Option<SurfacePoints>,
    ) -> (SurfacePoints, GridReport) {
        assert_eq!(targets.len(), counts[0] * counts[1], "one target for each point of the grid");
        let memory = memory.map(|points| points.field);
        let (mut field, effort) = if targets.len() <= self.at_once {
            let grid = Grid::new(&self.system, &self.ranges, (targets, counts), memory);
            self.choosing(|choice| solve_settled(grid, start, choice))
        } else {
            self.assembled(targets, counts, start, memory)
        };
        self.tell_asked_outside(&mut field, 0..targets.len(), |point| targets[point]);
        (self.with_middle(field), effort)
    }

    /// A large grid in one piece, as its bands make it.
    fn assembled(
        &self,
        targets: &[[f64; 2]],
        counts: [usize; 2],
        start: Option<&[f64]>,
        memory: Option<Field>,
    ) -> (Field, GridReport) {
        let mut whole = Field::new(&self.ranges, counts, self.system.extra_count(), memory);
        let target = |i: usize, j: usize| targets[i * counts[1] + j];
        let taken = self.fields(Targets { target: &target, counts }, start, &mut |rows, field, line| {
            let [first, from] = [rows.start, line].map(|row| row * counts[1]);
            (0..rows.len() * counts[1]).for_each(|k| whole.copy(first + k, &field, from + k));
            Ok::<_, Infallible>(field)
        });
        let Ok(effort) = taken;
        (whole, effort)
    }

    /// Solves a grid of any size and hands its points over in bands of rows, in order; the memory it takes does not grow with the
    /// number of rows, but for one in 64 of them (more of them where rows have more than 4,096 points). The points are those of
    /// [`SurfaceProblem::solve_points`], bit for bit. `target` tells the values of the coordinates in a row and a column; `start`
    /// is as there, for a point near the middle.
    ///
    /// # Errors
    /// What `each` gives; nothing more is solved then.
    ///
    /// # Panics
    /// If `start` has not one number for each unknown.
    pub fn in_bands<E>(
        &self,
        target: impl Fn(usize, usize) -> [f64; 2],
        counts: [usize; 2],
        start: Option<&[f64]>,
        mut each: impl FnMut(&Band<'_>) -> Result<(), E>,
    ) -> Result<GridReport, E> {
        self.fields(Targets { target: &target, counts }, start, &mut |rows, mut field, line| {
            let first = line * counts[1];
            let asked = |point: usize| target(rows.start + (point - first) / counts[1], (point - first) % counts[1]);
            self.tell_asked_outside(&mut field, first..first + rows.len() * counts[1], asked);
            let points = self.with_middle(field);
            each(&Band::new(&points, rows, counts[1], line * counts[1]))?;
            Ok(points.field)
        })
    }

    fn fields<E>(
        &self,
        wanted: Targets<'_>,
        start: Option<&[f64]>,
        each: &mut dyn FnMut(std::ops::Range<usize>, Field, usize) -> Result<Field, E>,
    ) -> Result<GridReport, E> {
        let (system, ranges) = (&self.system, &self.ranges);
        self.choosing(|choice| {
            if wanted.len() > self.at_once {
                return solve_in_bands(system, ranges, wanted, start, choice, self.at_once / BANDS, each);
            }
            let targets = wanted.all();
            let grid = Grid::new(system, ranges, (&targets, wanted.counts), None);
            let (field, effort) = solve_settled(grid, start, choice);
            each(0..wanted.counts[0], field, 0).map(|_| effort)
        })
    }

    /// Calls something with the choice among branches that this problem makes.
    fn choosing<R>(&self, solve: impl FnOnce(&Choice<'_>) -> R) -> R {
        let (tape, in_lanes, between) = &self.keep;
        let known = KnownRoots::default();
        let roots = |ranges: &[Range], target: &[f64; 2]| known.find(ranges, target, || self.roots(ranges, target));
        let planes = TangentPlanes { slopes: &self.slopes, ranges: &self.ranges };
        let keep = Keep { tape, in_lanes, between, ranges: &self.kept_ranges };
        solve(&Choice {
            roots: &roots,
            keep: Some(keep).filter(|_| !between.is_empty()),
            // on a singular line there is none
            planes: Some(planes).filter(|_| self.several == Several::Refuse),
            several: self.several,
            tells_others: self.tells_others,
            most_boxes: if self.is_line() { MOST_BOXES_OF_WHOLE_LINE } else { BOXES_OF_ALL * self.most_boxes },
            reach: self.reach.as_ref(),
            periodic: &self.periodic,
        })
    }

    /// A point that is asked for at a value of an unknown beyond the unknown's range lies outside by just that, whether or not
    /// a branch was followed so far.
    fn tell_asked_outside(
        &self,
        field: &mut Field,
        points: std::ops::Range<usize>,
        target: impl Fn(usize) -> [f64; 2],
    ) {
        if self.asked == [None; 2] || field.is_complete() {
            return;
        }
        for point in points {
            let is_open = !field.is_root(point) && field.outcome(point) != Some(Outcome::Ambiguous);
            let target = if is_open { target(point) } else { continue };
            let mut unknowns: Vec<f64> = self.ranges.iter().map(|range| range.middle()).collect();
            let asked = self.asked.iter().zip(target).filter_map(|(unknown, value)| Some(((*unknown)?, value)));
            // what is periodic has no ends
            asked
                .filter(|(unknown, _)| !self.periodic[*unknown])
                .for_each(|(unknown, value)| unknowns[unknown] = value);
            let outcome = verdict(&unknowns, &self.ranges, true, false);
            if matches!(outcome, Outcome::Outside { .. }) {
                field.put_alone(point, &Solution { outcome, unknowns, residual: f64::NAN, iterations: 0 });
            }
        }
    }

    /// Whether it is of a line on the surface.
    fn is_line(&self) -> bool {
        self.several == Several::TakeWidest
    }

    fn with_middle(&self, field: Field) -> SurfacePoints {
        SurfacePoints { field, middle: self.ranges.iter().map(|range| range.middle()).collect() }
    }

    /// The points of the surface at solutions of its system.
    pub fn points(&self, solutions: &[Solution]) -> Vec<SurfacePoint> {
        let mut evaluator = ScalarEvaluator::new(&self.point);
        let mut out = [0.0; 6];
        let point = |solution: &Solution| {
            evaluator.run(&solution.unknowns, &mut out);
            SurfacePoint {
                outcome: solution.outcome.of_placed(&out),
                unknowns: solution.unknowns.clone(),
                position: [out[0], out[1], out[2]],
                normal: [out[3], out[4], out[5]],
                residual: solution.residual,
            }
        };
        solutions.iter().map(point).collect()
    }
}

/// Functions of the unknowns with the ranges that they are to lie in.
fn kept_by<'g>(
    values: &[Expr<'g>],
    unknowns: &[Expr<'g>],
    ranges: Vec<Range>,
) -> Result<(Tape, LaneTape, Vec<Range>), TapeError> {
    let tape = Tape::new(values, unknowns)?;
    let in_lanes = LaneTape::new(&tape);
    Ok((tape, in_lanes, ranges))
}
