//! Where a grid begins: the branch that is meant, found at one of its points.
//!
//! The branch counts by where it is in the middle of the rectangle that the grid covers, within the ranges or beyond them, however many
//! rows and columns there are. Where it has no point there and nothing is kept of several branches, other points are tried, ever
//! closer together.

use std::cmp::Ordering;
use std::collections::VecDeque;
use std::ops;

use rayon::iter::{IntoParallelRefIterator, ParallelIterator};

use crate::field::Field;
use crate::grid::{Effort, Grid};
use crate::path::Path;
use crate::reach::{Reach, back_into, follow_on, is_within, nearest_turn, settle};
use crate::roots::{MOST_BOXES, Roots, all_roots};
use crate::solution::{Outcome, Range, Solution, distance};
use crate::solvers::Solvers;
use crate::start::{WIDELY, scan};
use crate::survey::{course, surveyed, turned_copies};
use crate::system::System;
use crate::verdicts::{Keep, TangentPlanes};

/// Points that are tried beside the middle.
const MOST_ANCHORS: usize = 256;
/// Boxes that are looked at, at all of them together, before the search is given up.
const MOST_BOXES_OF_ALL: u64 = 10 * MOST_BOXES;
/// Where the branch that is meant is looked for first, as shares of the way across the grid.
const MIDDLE: [f64; 2] = [0.5; 2];
/// Roots that are nearer to each other than this share of the ranges are the same.
const SAME_ROOT: f64 = 1e-6;

/// Branches that are followed to see where they run, if several qualify.
const MOST_COURSES: usize = 8;

/// What is done where several branches qualify.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Several {
    /// No point is solved.
    Refuse,
    /// The one that reaches the most points is taken, of several such the one nearest the middle of the ranges.
    TakeWidest,
}

/// Which branch is meant.
pub(crate) struct Choice<'c> {
    /// All branches in ranges, at given targets.
    pub(crate) roots: &'c (dyn Fn(&[Range], &[f64; 2]) -> Roots + Sync),
    /// What tells branches apart, if anything does.
    pub(crate) keep: Option<Keep<'c>>,
    pub(crate) several: Several,
    /// Boxes that are looked at, at all points together, before the search is given up.
    pub(crate) most_boxes: u64,
    /// Where a branch is followed beyond its ranges; nowhere if there is none.
    pub(crate) reach: Option<&'c Reach>,
    /// Unknowns that mean the same after a turn.
    pub(crate) periodic: &'c [bool],
    /// Sees where the roots are no points of a surface; all are if there is none.
    pub(crate) planes: Option<TangentPlanes<'c>>,
}

impl Choice<'_> {
    /// Whether a branch with these unknowns in the middle qualifies.
    pub(crate) fn keeps(&self, unknowns: &[f64]) -> bool {
        self.keep.as_ref().is_none_or(|keep| keep.broken(unknowns).is_none())
    }

    /// Whether a root is a point of a surface at all.
    pub(crate) fn has_tangent_plane(&self, unknowns: &[f64]) -> bool {
        self.planes.is_none_or(|planes| !planes.is_collapsed(unknowns))
    }

    /// The verdicts on some points of a field that was settled in these ranges.
    pub(crate) fn judge(&self, field: &mut Field, points: ops::Range<usize>, ranges: &[Range]) {
        if let Some(planes) = &self.planes {
            planes.judge(field, points.clone());
        }
        if let Some(keep) = &self.keep {
            keep.judge(field, points, ranges, self.periodic);
        }
    }

    /// Those of some ranges in which a branch can qualify.
    pub(crate) fn kept(&self, ranges: &[Range]) -> Vec<Range> {
        let common = |(range, kept): (&Range, &Range)| range.common(*kept);
        self.keep.as_ref().map_or_else(|| ranges.to_vec(), |keep| ranges.iter().zip(keep.ranges).map(common).collect())
    }
}

/// The points of a grid as far as its branch was followed, before [`settle`].
pub(crate) struct Followed {
    pub(crate) field: Field,
    /// Whether that is beyond the ranges.
    pub(crate) is_beyond: bool,
}

/// Solves the system at each pair of targets of a grid (row by row); every point gets a verdict.
///
/// The system's parameters are the two targets. One point, the anchor, is looked for in the whole of the ranges, the middle
/// of the grid first. From there a lattice of few points is solved in steps short enough to stay on the branch; the gaps are
/// halved again and again, many points at once, each from a polynomial through its neighbours. What fails there is
/// solved alone, from neighbour to neighbour. So all points lie on one branch; a point where that branch leaves the ranges
/// is outside, even if another branch has a point there.
///
/// Results do not depend on the number of threads.
///
/// # Panics
/// If there are not `counts[0] · counts[1]` targets.
pub fn solve_grid(
    system: &System,
    ranges: &[Range],
    targets: &[[f64; 2]],
    counts: [usize; 2],
) -> (Vec<Solution>, Effort) {
    let roots = |ranges: &[Range], targets: &[f64; 2]| all_roots(system, ranges, targets, MOST_BOXES);
    let choice = Choice {
        roots: &roots,
        keep: None,
        several: Several::TakeWidest,
        most_boxes: MOST_BOXES_OF_ALL,
        reach: None,
        periodic: &[],
        planes: None,
    };
    let grid = Grid::new(system, ranges, (targets, counts), None);
    let (field, effort) = solve_settled(grid, None, &choice);
    let solution = |point| field.solution(point).unwrap_or_else(|| Solution::never_reached(ranges));
    ((0..targets.len()).map(solution).collect(), effort)
}

/// The same without an allocation for each point, with a choice among several branches; the branch may be given by a start
/// for the point in the middle, which is tried first.
pub(crate) fn solve_settled(mut grid: Grid<'_>, start: Option<&[f64]>, choice: &Choice<'_>) -> (Field, Effort) {
    let mut solvers = Solvers::new(grid.system, grid.ranges);
    let Followed { mut field, .. } = follow(&mut grid, &mut solvers, start, choice);
    let all = 0..field.len();
    settle(&mut grid, &mut field, &mut solvers.careful, all.clone(), choice.periodic);
    choice.judge(&mut field, all, grid.ranges);
    (field, grid.effort)
}

/// A grid as far as its branch can be followed from where it is found, with what is known of other branches.
pub(crate) fn follow(
    grid: &mut Grid<'_>,
    solvers: &mut Solvers<'_>,
    start: Option<&[f64]>,
    choice: &Choice<'_>,
) -> Followed {
    if grid.targets.is_empty() {
        return Followed { field: grid.field(), is_beyond: false };
    }
    if start.is_some() || choice.several == Several::TakeWidest {
        return follow_alone(grid, solvers, start, choice);
    }
    surveyed(grid, solvers, choice)
}

/// A grid as far as its branch can be followed from where it is found.
pub(crate) fn follow_alone(
    grid: &mut Grid<'_>,
    solvers: &mut Solvers<'_>,
    start: Option<&[f64]>,
    choice: &Choice<'_>,
) -> Followed {
    let within = |field| Followed { field, is_beyond: false };
    match begin(grid, solvers, start, choice) {
        Beginning::At(anchor, field) => match choice.reach.filter(|_| !field.is_complete()) {
            Some(reach) => follow_on(grid, reach, anchor, field),
            None => within(field),
        },
        Beginning::Beyond(field) => Followed { field, is_beyond: choice.reach.is_some() },
        Beginning::Ambiguous => within(grid.ambiguous()),
        Beginning::Nowhere => {
            let (middle, mut field) = (grid.middle(), grid.field());
            field.put(middle, &grid.failure(middle));
            field.place_loose(&mut solvers.careful);
            within(field)
        }
    }
}

/// What is found of the branch that is meant.
enum Beginning {
    /// A point in the ranges, and what was reached from there within them.
    At(usize, Field),
    /// What was reached beyond the ranges, too.
    Beyond(Field),
    Ambiguous,
    Nowhere,
}

fn begin(grid: &mut Grid<'_>, solvers: &mut Solvers<'_>, start: Option<&[f64]>, choice: &Choice<'_>) -> Beginning {
    let middle = grid.middle();
    if let Some(root) = start.and_then(|start| grid.root_from(&mut solvers.careful, middle, start)) {
        let field = grid.fill(solvers, middle, &root);
        grid.effort.anchor = grid.targets[middle];
        grid.effort.branches = vec![root];
        return Beginning::At(middle, field);
    }
    let mut last_resort = None;
    begin_within(grid, solvers, choice)
        .or_else(|| choice.reach.and_then(|reach| begin_beyond(grid, reach, choice, &mut last_resort)))
        .or_else(|| begin_elsewhere(grid, choice))
        .or_else(|| begin_cut_away(grid, solvers, choice))
        .or(last_resort)
        .unwrap_or(Beginning::Nowhere)
}

/// At the point in the middle, within the ranges.
fn begin_within(grid: &mut Grid<'_>, solvers: &mut Solvers<'_>, choice: &Choice<'_>) -> Option<Beginning> {
    let (middle, target) = (grid.middle(), grid.target_at(MIDDLE));
    let kept = choice.kept(grid.ranges);
    let mut found = (choice.roots)(&kept, &target);
    if !found.undecided.is_empty() && choice.several == Several::Refuse {
        found.unproven.extend(turned_copies(grid, &kept, &target, &found));
    }
    let mut branches = branches_of(found, grid, target, choice);
    branches.retain(|root| choice.keeps(&root.unknowns));
    grid.effort.branches.clone_from(&branches);
    match branches.len() {
        0 => None,
        2.. if choice.several == Several::Refuse => {
            for root in branches.iter().take(MOST_COURSES) {
                let from = grid.led_to(middle, target, root);
                let found = from.map(|root| course(&grid.fill(solvers, middle, &root)));
                grid.effort.courses.push(found.unwrap_or_default());
            }
            Some(Beginning::Ambiguous)
        }
        _ => {
            let mut leads = Leads::default();
            for root in branches {
                let Some(root) = grid.led_to(middle, target, &root) else { continue };
                let field = grid.fill(solvers, middle, &root);
                let solved = field.solved();
                leads.add(root, field, solved);
                if solved == grid.targets.len() {
                    break;
                }
            }
            leads.best.map(|(_, field)| Beginning::At(middle, field))
        }
    }
}

/// At the point in the middle beyond the ranges, if a branch there leads to points within them. What else it leads to is the
/// last resort: there is nothing within the ranges then, as far as branches can be followed.
fn begin_beyond(
    grid: &mut Grid<'_>,
    reach: &Reach,
    choice: &Choice<'_>,
    last_resort: &mut Option<Beginning>,
) -> Option<Beginning> {
    let (middle, ranges, target) = (grid.middle(), grid.ranges, grid.target_at(MIDDLE));
    // of the ranges themselves
    let undecided = std::mem::take(&mut grid.effort.undecided);
    let found = (choice.roots)(&choice.kept(&reach.searched), &target);
    let mut branches = branches_of(found, grid, target, choice);
    grid.effort.undecided = undecided;
    branches.retain(|root| choice.keeps(&root.unknowns));
    let off = |root: &Solution| {
        root.unknowns.iter().zip(ranges).map(|(x, range)| range.excess(*x) / range.width()).fold(0.0, f64::max)
    };
    branches.sort_by(|a, b| off(a).total_cmp(&off(b)));
    let mut follower = Follower::new(grid, Some(reach));
    let mut leads = Leads::default();
    for root in branches {
        let Some(root) = follower.grid.led_to(middle, target, &root) else { continue };
        let (field, inside) = follower.follow(middle, &root, (grid.ranges, choice.periodic));
        leads.add(root, field, inside);
    }
    grid.effort.evaluations += follower.grid.effort.evaluations;
    if leads.roots.is_empty() {
        *last_resort = leads.best.map(|(_, field)| Beginning::Beyond(field));
        return None;
    }
    leads.decided(grid, choice)
}

/// At the first other point that a branch which qualifies has in the ranges, on ever finer lattices. One that leads to the
/// point in the middle must qualify there.
fn begin_elsewhere(grid: &mut Grid<'_>, choice: &Choice<'_>) -> Option<Beginning> {
    let (middle, ranges) = (grid.middle(), grid.ranges);
    let undecided = std::mem::take(&mut grid.effort.undecided);
    let mut follower = Follower::new(grid, choice.reach);
    let points: Vec<usize> = anchors([grid.rows, grid.columns]).filter(|point| *point != middle).collect();
    let mut ahead = Ahead::default();
    for (number, point) in points.iter().copied().enumerate() {
        if grid.effort.boxes >= choice.most_boxes || number == MOST_ANCHORS {
            grid.effort.is_given_up = true;
            break;
        }
        let mut leads = Leads::default();
        let mut leads_to_middle = true;
        let found = ahead.roots(choice, ranges, grid.targets, &points[number..]);
        let target = grid.targets[point];
        for root in branches_of(found, grid, target, choice) {
            let (field, inside) = follower.follow(point, &root, (ranges, choice.periodic));
            let at_middle: Vec<f64> = field.unknowns(middle).collect();
            let has_middle = field.is_root(middle);
            let at = if has_middle { back_into(ranges, choice.periodic, &at_middle) } else { root.unknowns.clone() };
            if choice.keeps(&at) {
                leads.add(root, field, inside);
                leads_to_middle &= has_middle;
            }
        }
        if !leads.roots.is_empty() {
            grid.effort.is_kept_elsewhere = choice.keep.is_some() && !leads_to_middle;
            grid.effort.evaluations += follower.grid.effort.evaluations;
            return leads.decided(grid, choice);
        }
    }
    grid.effort.evaluations += follower.grid.effort.evaluations;
    grid.effort.anchor = grid.target_at(MIDDLE);
    grid.effort.undecided = undecided;
    None
}

/// At the point in the middle, within the ranges, on a branch that has no point which is looked for, as far as is known, but one
/// that is cut away: its points are told to be so rather than that there are none.
fn begin_cut_away(grid: &mut Grid<'_>, solvers: &mut Solvers<'_>, choice: &Choice<'_>) -> Option<Beginning> {
    let (middle, ranges) = (grid.middle(), grid.ranges);
    let center: Vec<f64> = ranges.iter().map(|range| range.middle()).collect();
    let off = |root: &Solution| distance(&root.unknowns, &center, ranges);
    let is_sought = |root: &Solution| matches!(root.outcome, Outcome::CutAway(_)) && choice.keeps(&root.unknowns);
    let found = grid.scanned(middle, is_sought).into_iter().filter(is_sought);
    let root = found.min_by(|a, b| off(a).total_cmp(&off(b)))?;
    grid.effort.is_given_up = false;
    Some(Beginning::At(middle, grid.fill(solvers, middle, &root)))
}

/// Roots at the points that are tried next, looked for on all threads at once; they count in the order of the points, so that results
/// do not depend on how many threads there are.
#[derive(Default)]
struct Ahead(VecDeque<Roots>);

impl Ahead {
    /// The roots at the first of the points that are left.
    fn roots(&mut self, choice: &Choice<'_>, ranges: &[Range], targets: &[[f64; 2]], points: &[usize]) -> Roots {
        if self.0.is_empty() {
            let next = &points[..points.len().min(rayon::current_num_threads())];
            let found: Vec<Roots> = next.par_iter().map(|&point| (choice.roots)(ranges, &targets[point])).collect();
            self.0.extend(found);
        }
        self.0.pop_front().expect("a point is left")
    }
}

/// What follows branches as far as they are followed at all.
struct Follower<'s> {
    grid: Grid<'s>,
    solvers: Solvers<'s>,
}

impl<'s> Follower<'s> {
    fn new(grid: &Grid<'s>, reach: Option<&'s Reach>) -> Follower<'s> {
        let ranges = reach.map_or(grid.ranges, |reach| &reach.ranges);
        Follower { grid: grid.within(ranges), solvers: Solvers::new(grid.system, ranges) }
    }

    /// Everything that can be reached from a point, and how much of it lies within ranges.
    fn follow(&mut self, from: usize, root: &Solution, (ranges, periodic): (&[Range], &[bool])) -> (Field, usize) {
        let field = self.grid.fill(&mut self.solvers, from, root);
        let is_inside = |point: &usize| {
            let unknowns: Vec<f64> = field.unknowns(*point).collect();
            field.is_root(*point) && is_within(&back_into(ranges, periodic, &unknowns), ranges)
        };
        let inside = (0..field.len()).filter(is_inside).count();
        (field, inside)
    }
}

/// What branches lead to.
#[derive(Default)]
struct Leads {
    /// What the one reaches that reaches the most points in the ranges, and how many.
    best: Option<(usize, Field)>,
    /// Those that reach any.
    roots: Vec<Solution>,
}

impl Leads {
    fn add(&mut self, root: Solution, field: Field, inside: usize) {
        if inside > 0 {
            self.roots.push(root);
        }
        if self.best.as_ref().is_none_or(|(most, _)| inside > *most) {
            self.best = Some((inside, field));
        }
    }

    fn decided(self, grid: &mut Grid<'_>, choice: &Choice<'_>) -> Option<Beginning> {
        let is_refused = self.roots.len() > 1 && choice.several == Several::Refuse;
        grid.effort.branches = self.roots;
        let (_, field) = self.best?;
        Some(if is_refused { Beginning::Ambiguous } else { Beginning::Beyond(field) })
    }
}

/// All branches among the roots at a point, the one nearest the middle of the ranges first; those that are the same after a turn once.
fn branches_of(found: Roots, grid: &mut Grid<'_>, target: [f64; 2], choice: &Choice<'_>) -> Vec<Solution> {
    let ranges = grid.ranges;
    let middle: Vec<f64> = ranges.iter().map(|range| range.middle()).collect();
    let off = |root: &Solution| distance(&root.unknowns, &middle, ranges);
    let proven = found.isolated.into_iter().map(|root| root.solution);
    let mut all: Vec<Solution> = proven.chain(found.unproven).collect();
    all.retain(|root| choice.has_tangent_plane(&root.unknowns));
    // of two that are the same the one that qualifies
    all.sort_by(|a, b| (!choice.keeps(&a.unknowns)).cmp(&!choice.keeps(&b.unknowns)).then(off(a).total_cmp(&off(b))));
    let mut branches: Vec<Solution> = Vec::new();
    for root in all {
        let is_same = |other: &Solution| is_same_root(&root.unknowns, &other.unknowns, ranges, choice.periodic);
        if !branches.iter().any(is_same) {
            branches.push(root);
        }
    }
    grid.effort.boxes += found.boxes;
    grid.effort.anchor = target;
    grid.effort.undecided = found.undecided;
    branches
}

/// Whether two roots at the same targets are one, but for turns of what is periodic.
pub(crate) fn is_same_root(root: &[f64], other: &[f64], ranges: &[Range], periodic: &[bool]) -> bool {
    distance(&nearest_turn(root, other, periodic), other, ranges) <= SAME_ROOT
}

/// The points that a grid may begin at: ever finer lattices, the middles of what the coarser ones leave.
fn anchors([rows, columns]: [usize; 2]) -> impl Iterator<Item = usize> {
    let finest = rows.max(columns).max(1).ilog2();
    (0..=finest).flat_map(move |level| {
        let of = move |count: usize| bisections(count).filter(move |(_, own)| *own <= level);
        of(rows).flat_map(move |(i, above)| {
            let beside = of(columns).filter(move |(_, own)| above.max(*own) == level);
            beside.map(move |(j, _)| i * columns + j)
        })
    })
}

/// The places on a line, each with the number of halvings that lead to it; the ends come with the first one.
fn bisections(count: usize) -> impl Iterator<Item = (usize, u32)> {
    (0..count).map(move |k| {
        let (mut low, mut high, mut level) = (0, count, 0);
        loop {
            let middle = usize::midpoint(low, high);
            match k.cmp(&middle) {
                Ordering::Equal => break,
                Ordering::Less => high = middle,
                Ordering::Greater => low = middle + 1,
            }
            level += 1;
        }
        (k, if k == 0 || k + 1 == count { level.min(1) } else { level })
    })
}

impl Grid<'_> {
    /// The point in the middle.
    fn middle(&self) -> usize {
        (self.rows / 2) * self.columns + self.columns / 2
    }

    /// The root at a point on the branch of a root at some targets near it.
    fn led_to(&mut self, point: usize, from: [f64; 2], root: &Solution) -> Option<Solution> {
        let to = self.targets[point];
        if from == to {
            return Some(root.clone());
        }
        let mut path = Path::new(&mut self.evaluation, self.ranges, [from, to]);
        let solution = path.follow(root.unknowns.clone(), root.unknowns.clone());
        self.effort.evaluations += path.evaluations;
        solution.is_root().then_some(solution)
    }

    /// Every point so.
    pub(crate) fn ambiguous(&mut self) -> Field {
        let mut field = self.field();
        let ambiguous = Solution { outcome: Outcome::Ambiguous, ..Solution::never_reached(self.ranges) };
        (0..field.len()).for_each(|point| field.put(point, &ambiguous));
        field
    }

    /// Why there is no root at a point, as far as a scan can tell.
    fn failure(&mut self, point: usize) -> Solution {
        let failure =
            self.scanned(point, Solution::is_solved).into_iter().next().filter(|solution| !solution.is_solved());
        failure.unwrap_or_else(|| Solution::never_reached(self.ranges))
    }

    fn scanned(&mut self, point: usize, is_sought: impl Fn(&Solution) -> bool) -> Vec<Solution> {
        self.evaluation.set_parameters(&self.targets[point]);
        let (found, evaluations) = scan(&mut self.evaluation, self.ranges, WIDELY, is_sought);
        self.effort.evaluations += evaluations;
        found
    }
}
