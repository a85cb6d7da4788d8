//! A surface of a tooth space, and the lines on which it ends.

use std::borrow::Cow;
use std::cell::RefCell;
use std::rc::Rc;

use flank_chain_dsl::{GeneratedSurface, Job, Sample, Solid};
use flank_expr::geometry::{Axis, Chain, Step, Vector3};
use flank_expr::{Expr, InstructionSet};
use flank_solver::{Arrangement, Blank, BoundSurface, Outcome, Range, SurfacePoint, SurfacePoints, SurfaceProblem};

use crate::project::failure::Failure;
use crate::project::session::Session;
use crate::solve::body::refusal::{self, refused};
use crate::solve::sampled::{SOLVED, as_solved};
use crate::solve::surface::{bound, problem};

/// Rows and columns of a sample that are enough to know where a surface lies.
const MOST_LINES: usize = 9;
/// Boxes that a search for a point of a line looks at: where Newton's method does not reach it there is mostly none.
const BOXES: u64 = 200;
/// Rows of known points besides the nearest from which a line is looked for.
const MORE_ROWS: usize = 3;
/// Points of so many machine code pays for.
const MANY: usize = 64;
/// An unknown whose known values lie this near to a function of the way along, as a share of their variance, tells rows of a space apart
/// badly.
const SCATTER: f64 = 1e-3;
/// Points no farther apart are the same, mm: rounding of solved points.
pub(crate) const SAME_LINE: f64 = 1e-6;

/// A surface of a tooth space with some of its points.
#[derive(Clone)]
pub(crate) struct Piece<'j, 'g> {
    job: &'j Job<'g>,
    pub(crate) surface: Cow<'j, GeneratedSurface<'g>>,
    pub(crate) arrangement: Arrangement,
    session: Session<'j>,
    /// How far it is from the space that the job describes, about the work's axis or along its line.
    moved_by: f64,
    pub(crate) known: Vec<SurfacePoint>,
    /// The problems of coordinates that were asked for.
    problems: RefCell<Vec<([Expr<'g>; 2], Rc<SurfaceProblem>)>>,
}

/// A line of a surface on which one of its unknowns is at an end of its range.
#[derive(Clone, Debug)]
pub(crate) struct EndLine {
    /// The unknown, by its place.
    pub(crate) unknown: usize,
    pub(crate) value: f64,
    /// Points at the shares along that were asked for.
    pub(crate) points: Vec<[f64; 3]>,
}

/// Whose ranges' ends are looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EndsOf {
    Tool,
    Motions,
}

impl<'j, 'g> Piece<'j, 'g> {
    /// `before` are the same surface in the spaces before: its points are first looked for as these go on, and a search is spared.
    ///
    /// # Errors
    /// If the surface is not sampled, or no point of its sample is solved.
    pub(crate) fn new(
        job: &'j Job<'g>,
        (solid, surface, arrangement): (&Solid, &'j GeneratedSurface<'g>, Arrangement),
        session: Session<'j>,
        before: &[&Piece<'j, 'g>],
    ) -> Result<Piece<'j, 'g>, Failure> {
        let name = &surface.name;
        let sample = surface.sample.as_ref().ok_or_else(|| {
            let message = format!(
                "`{name}` bounds the spaces of `{}` and is not sampled: its sample says which branch is meant",
                solid.name
            );
            refused(solid, message, &[&format!("add `sample {name} {{ … }}`")])
        })?;
        let sample = thinned(sample);
        let coordinates = sample.functions();
        let problem = || problem(job, surface, coordinates, session);
        let piece = |known| {
            let surface = Cow::Borrowed(surface);
            Piece { job, surface, arrangement, session, moved_by: 0.0, known, problems: RefCell::default() }
        };
        if let Some(known) = led_to(before).and_then(|start| whole(&problem(), &sample, &start)) {
            return Ok(piece(known));
        }
        let solved = session.sample((job, surface), &sample, SOLVED, || as_solved(problem(), &sample));
        let is_solved = |point: &SurfacePoint| point.outcome == Outcome::Solved;
        if !solved.points.iter().any(is_solved) {
            let branches = solved.ambiguous(surface, &sample);
            return Err(refusal::unsolved(job, (solid, surface), &solved.points, branches));
        }
        Ok(piece(solved.points.into_iter().filter(is_solved).collect()))
    }

    /// The same surface in another space: farther on about the work's axis, or along its line.
    pub(crate) fn moved(&self, by: f64) -> Piece<'j, 'g> {
        let graph = self.surface.surface.position.0[0].graph();
        let amount = graph.constant(by);
        let step = match self.arrangement {
            Arrangement::Round => Step::Rotate(Axis::Z, amount),
            Arrangement::Straight { .. } => {
                let zero = graph.constant(0.0);
                Step::Translate(Vector3([zero, amount, zero]))
            }
        };
        let moved = self.surface.surface.moved(&Chain::new(graph, vec![step]));
        let known = self.known.iter().map(|point| SurfacePoint {
            position: self.arrangement.moved(point.position, by),
            normal: self.arrangement.turned(point.normal, by),
            ..point.clone()
        });
        Piece {
            known: known.collect(),
            surface: Cow::Owned(GeneratedSurface { surface: moved, ..self.surface.clone().into_owned() }),
            moved_by: self.moved_by + by,
            problems: RefCell::default(),
            ..*self
        }
    }

    /// Where a point of it lies in the space that the job describes.
    pub(crate) fn in_own_space(&self, point: [f64; 3]) -> [f64; 3] {
        if self.moved_by == 0.0 { point } else { self.arrangement.moved(point, -self.moved_by) }
    }

    /// The job that has it: where spaces differ, that of its space.
    pub(crate) fn job(&self) -> &'j Job<'g> {
        self.job
    }

    /// The two coordinates of the section of the outline.
    pub(crate) fn section(&self) -> [Expr<'g>; 2] {
        let [x, y, z] = self.surface.surface.position.0;
        match self.arrangement {
            Arrangement::Round => [z, (x * x + y * y).sqrt()],
            Arrangement::Straight { .. } => [z, x],
        }
    }

    /// How far along a space a point lies.
    pub(crate) fn along_of(&self, blank: &Blank, point: &SurfacePoint) -> f64 {
        Blank::share(blank.bounds(), self.arrangement.section(point.position))
    }

    /// How far along the space, and the angle about the axis from a place on.
    fn around(&self, [x, y, _]: [f64; 3], blank: &Blank) -> [Expr<'g>; 2] {
        let [own_x, own_y, _] = self.surface.surface.position.0;
        if !self.arrangement.is_closed() {
            return [blank.share_of(self.section()), own_y];
        }
        let (ahead, aside) = (own_x * x + own_y * y, own_y * x - own_x * y);
        [blank.share_of(self.section()), aside.atan2(ahead)]
    }

    /// The surface with the values of the job's parameters.
    pub(crate) fn bound(&self) -> BoundSurface<'g> {
        bound(self.job, &self.surface)
    }

    /// The unknown by which rows across the space are told apart best: the one that the tool's profile runs over, another one of the tool,
    /// or a motion, unless it says no more than how far along the space a point lies.
    pub(crate) fn across_tool(&self, blank: &Blank) -> Option<usize> {
        let made = &self.surface;
        let of_profile = made.unknowns.iter().position(|unknown| unknown.piece.is_some());
        of_profile.or_else(|| self.telling_rows(blank).next())
    }

    /// The unknowns that say more than how far along the space a point lies, those of the tool first.
    pub(crate) fn telling_rows(&self, blank: &Blank) -> impl Iterator<Item = usize> {
        let all = self.of(EndsOf::Tool).chain(self.of(EndsOf::Motions));
        all.filter(|unknown| self.tells_rows(*unknown, blank))
    }

    /// Whether an unknown is more than a linear function of the way along at the known points.
    fn tells_rows(&self, unknown: usize, blank: &Blank) -> bool {
        let pairs: Vec<[f64; 2]> =
            self.known.iter().map(|point| [self.along_of(blank, point), point.unknowns[unknown]]).collect();
        let count = pairs.len() as f64;
        let [along, value] = [0, 1].map(|k| pairs.iter().map(|pair| pair[k]).sum::<f64>() / count);
        let sum = |a: usize, b: usize| -> f64 {
            let mean = [along, value];
            pairs.iter().map(|pair| (pair[a] - mean[a]) * (pair[b] - mean[b])).sum()
        };
        sum(1, 1) * sum(0, 0) > 0.0 && sum(1, 1) - sum(0, 1).powi(2) / sum(0, 0) > SCATTER * sum(1, 1)
    }

    /// Its unknowns that are motions, or those that are not.
    fn of(&self, whose: EndsOf) -> impl Iterator<Item = usize> {
        let made = &self.surface;
        let is_motion = |k: &usize| made.generation.motions.contains(&made.unknowns[*k].variable);
        (0..made.unknowns.len()).filter(move |k| is_motion(k) == (whose == EndsOf::Motions))
    }

    /// Whether an unknown is one of the tool, and no motion.
    pub(crate) fn is_of_tool(&self, unknown: usize) -> bool {
        self.of(EndsOf::Tool).any(|other| other == unknown)
    }

    /// An unknown, and how far along the space a point lies.
    pub(crate) fn across(&self, unknown: usize, blank: &Blank) -> [Expr<'g>; 2] {
        [self.surface.surface.unknowns[unknown], blank.share_of(self.section())]
    }

    /// Points at values of two coordinates; the branch is that of the known point for which `far` is least.
    pub(crate) fn solved(
        &self,
        coordinates: [Expr<'g>; 2],
        (targets, counts): (&[[f64; 2]], [usize; 2]),
        far: impl Fn(&SurfacePoint) -> f64,
    ) -> SurfacePoints {
        let near = self.known.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
        self.solved_from(coordinates, (targets, counts), near)
    }

    /// The same of a line, from the nearest known point of another row where the branch that the nearest one lies on leaves the ranges: it may lie
    /// where two branches meet.
    pub(crate) fn solved_line(
        &self,
        coordinates: [Expr<'g>; 2],
        targets: &[[f64; 2]],
        (unknown, far): (usize, impl Fn(&SurfacePoint) -> f64),
    ) -> SurfacePoints {
        let counts = [1, targets.len()];
        let mut near: Vec<&SurfacePoint> = self.known.iter().collect();
        near.sort_by(|a, b| far(a).total_cmp(&far(b)));
        let mut rows: Vec<f64> = Vec::new();
        near.retain(|point| {
            let value = point.unknowns[unknown];
            let is_new = rows.iter().all(|row| (row - value).abs() > SAME_LINE);
            rows.extend(is_new.then_some(value));
            is_new
        });
        let first = self.solved_from(coordinates, (targets, counts), near.first().copied());
        if first.solved() == targets.len() {
            return first;
        }
        let others = near.iter().skip(1).take(MORE_ROWS);
        let mut others = others.map(|start| self.solved_from(coordinates, (targets, counts), Some(start)));
        others.find(|points| points.solved() == targets.len()).unwrap_or(first)
    }

    fn solved_from(
        &self,
        coordinates: [Expr<'g>; 2],
        (targets, counts): (&[[f64; 2]], [usize; 2]),
        near: Option<&SurfacePoint>,
    ) -> SurfacePoints {
        let (problem, start) = (self.problem(coordinates), near.map(|point| &point.unknowns[..]));
        if targets.len() >= MANY {
            return problem.solve_points(targets, counts, start, None).0;
        }
        let problem = SurfaceProblem::clone(&problem).with_instruction_set(InstructionSet::widest());
        problem.solve_points(targets, counts, start, None).0
    }

    fn problem(&self, coordinates: [Expr<'g>; 2]) -> Rc<SurfaceProblem> {
        let mut problems = self.problems.borrow_mut();
        if let Some((_, known)) = problems.iter().find(|(known, _)| *known == coordinates) {
            return Rc::clone(known);
        }
        let made = Rc::new(problem(self.job, &self.surface, coordinates, self.session).boxes(BOXES));
        problems.push((coordinates, Rc::clone(&made)));
        made
    }

    /// Points of a line on which an unknown has a value.
    pub(crate) fn on_line(&self, (unknown, value): (usize, f64), blank: &Blank, along: &[f64]) -> SurfacePoints {
        let targets: Vec<[f64; 2]> = along.iter().map(|share| [value, *share]).collect();
        let width = self.surface.unknowns[unknown].high - self.surface.unknowns[unknown].low;
        let far = |point: &SurfacePoint| {
            ((point.unknowns[unknown] - value) / width).abs() + (self.along_of(blank, point) - 0.5).abs()
        };
        self.solved(self.across(unknown, blank), (&targets, [1, along.len()]), far)
    }

    /// The lines on which an unknown is at an end of its range, as far as they run along the space.
    pub(crate) fn end_lines(&self, whose: EndsOf, blank: &Blank, along: &[f64]) -> Vec<EndLine> {
        let made = &self.surface;
        let ends = self.of(whose).flat_map(|k| [(k, made.unknowns[k].low), (k, made.unknowns[k].high)]);
        ends.filter(|(_, value)| value.is_finite())
            .filter_map(|(unknown, value)| {
                let points = self.on_line((unknown, value), blank, along);
                let is_whole = points.solved() == along.len();
                is_whole.then(|| EndLine { unknown, value, points: positions(&points) })
            })
            .collect()
    }

    /// The same of the unknown that tells rows apart, if it is one of the tool.
    pub(crate) fn ends_of_rows(&self, blank: &Blank, along: &[f64]) -> Vec<EndLine> {
        let Some(unknown) = self.across_tool(blank).filter(|unknown| self.is_of_tool(*unknown)) else {
            return Vec::new();
        };
        let Range { low, high } = self.bound().ranges()[unknown];
        let line = |value: f64| {
            let points = self.on_line((unknown, value), blank, along);
            let is_whole = points.solved() == along.len();
            is_whole.then(|| EndLine { unknown, value, points: positions(&points) })
        };
        [low, high].into_iter().filter(|value| value.is_finite()).filter_map(line).collect()
    }

    /// The unknowns whose ranges keep the lines on which its rows end from running all along the space, and by how much.
    pub(crate) fn beyond_ends(&self, blank: &Blank) -> Vec<(usize, f64)> {
        let Some(unknown) = self.across_tool(blank) else { return Vec::new() };
        let Range { low, high } = self.bound().ranges()[unknown];
        let ends = [low, high].into_iter().filter(|value| value.is_finite());
        // from the middle of what is known to both ends
        let known = self.known.iter().map(|point| self.along_of(blank, point)).sum::<f64>() / self.known.len() as f64;
        let along = [0.0, known, 1.0];
        let beyond = ends.map(|value| self.beyond(&self.on_line((unknown, value), blank, &along)));
        beyond.into_iter().find(|beyond| !beyond.is_empty()).unwrap_or_default()
    }

    /// The unknowns that would have to go beyond their ranges to reach points, and how far.
    pub(crate) fn beyond(&self, points: &SurfacePoints) -> Vec<(usize, f64)> {
        let mut most = vec![0.0_f64; self.surface.unknowns.len()];
        for outcome in (0..points.len()).map(|k| points.outcome(k)) {
            if let Outcome::Outside { unknown, by } = outcome {
                most[unknown] = most[unknown].max(by);
            }
        }
        most.into_iter().enumerate().filter(|(_, by)| *by > 0.0).collect()
    }

    /// The values of an unknown at points of a line along the space; `None` where one is no point of the surface.
    ///
    /// They are found by their place in the axial section, or, where that has a turning point (on the ground of a space), by their angle.
    pub(crate) fn values_at(&self, points: &[[f64; 3]], unknown: usize, blank: &Blank) -> Option<Vec<f64>> {
        let middle = points[points.len() / 2];
        let turned = |[x, y, z]: [f64; 3]| {
            let share = Blank::share(blank.bounds(), self.arrangement.section([x, y, z]));
            match self.arrangement {
                Arrangement::Round => [share, (y * middle[0] - x * middle[1]).atan2(x * middle[0] + y * middle[1])],
                Arrangement::Straight { .. } => [share, y],
            }
        };
        let sections: Vec<[f64; 2]> = points.iter().map(|point| self.arrangement.section(*point)).collect();
        let angles: Vec<[f64; 2]> = points.iter().map(|point| turned(*point)).collect();
        let tried = [(self.section(), sections), (self.around(middle, blank), angles)];
        tried.into_iter().find_map(|(coordinates, targets)| {
            let far = |point: &SurfacePoint| apart(point.position, middle);
            let found = self.solved(coordinates, (&targets, [1, targets.len()]), far);
            let is_whole = found.solved() == targets.len()
                && positions(&found).iter().zip(points).all(|(a, b)| apart(*a, *b) <= SAME_LINE);
            is_whole.then(|| (0..found.len()).map(|k| found.unknowns(k)[unknown]).collect())
        })
    }
}

/// Unknowns in the middle of a sample as those in the spaces before go on.
fn led_to(before: &[&Piece<'_, '_>]) -> Option<Vec<f64>> {
    let middle = |piece: &Piece<'_, '_>| piece.known[piece.known.len() / 2].unknowns.clone();
    match before {
        [] => None,
        [only] => Some(middle(only)),
        [.., last_but_one, last] => {
            let on = middle(last).into_iter().zip(middle(last_but_one));
            Some(on.map(|(last, before)| 2.0 * last - before).collect())
        }
    }
}

/// The points of a sample on the branch that a start leads to, if it has all of them.
fn whole(problem: &SurfaceProblem, sample: &Sample<'_>, start: &[f64]) -> Option<Vec<SurfacePoint>> {
    let (points, _) = problem.solve_points(&sample.targets(), sample.counts, Some(start), None);
    (points.solved() == points.len()).then(|| (0..points.len()).map(|k| points.point(k)).collect())
}

pub(crate) fn positions(points: &SurfacePoints) -> Vec<[f64; 3]> {
    (0..points.len()).map(|k| points.position_and_normal(k)).map(|[x, y, z, ..]| [x, y, z]).collect()
}

pub(crate) fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// A few rows and columns of a sample, the outermost among them.
fn thinned<'g>(sample: &Sample<'g>) -> Sample<'g> {
    let lines = sample.counts.map(|count| {
        let parts = MOST_LINES.min(count) - 1;
        (0..=parts).map(|part| part * (count - 1) / parts.max(1)).collect::<Vec<usize>>()
    });
    let counts = lines.each_ref().map(Vec::len);
    Sample { counts, grid: sample.grid.picked(&lines), ..sample.clone() }
}
