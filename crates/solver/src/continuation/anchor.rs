//! Where a grid begins: the branch that is meant, found at one of its points.
//!
//! The branch counts by where it is in the middle of the rectangle that the grid covers, within the ranges or beyond them, however many
//! rows and columns there are. Where it has no point there and nothing is kept of several branches, other points are tried, ever
//! closer together.

use std::cmp::Ordering;
use std::collections::VecDeque;
use std::f64::consts::TAU;

use rayon::iter::{IntoParallelRefIterator, ParallelIterator};

use crate::continuation::choice::{Choice, Several, is_same_root};
use crate::continuation::field::Field;
use crate::continuation::grid::{Followed, Grid};
use crate::continuation::path::Path;
use crate::continuation::reach::{Reach, back_into, follow_on, is_within};
use crate::equations::solution::{Outcome, Range, Solution, distance};
use crate::newton::multistart::{WIDELY, scan};
use crate::newton::scalar::solve_with;
use crate::newton::solvers::Solvers;
use crate::roots::Roots;

/// Points that are tried beside the middle.
const MOST_ANCHORS: usize = 256;
/// Evaluations that branches may take to be followed from such points, and more of them for each point of the grid.
const MOST_FOLLOWED: [u64; 2] = [100_000, 100];
/// Where the branch that is meant is looked for first, as shares of the way across the grid.
const MIDDLE: [f64; 2] = [0.5; 2];
/// Points of a branch that tell where it runs, about.
const COURSE: usize = 64;
/// Turns of each unknown that a root is looked for again at.
const TURNS: i32 = 2;

/// Branches that are followed to see where they run, if several qualify.
const MOST_COURSES: usize = 8;
/// Branches that did not qualify and are known again at further points: the last ones, of grids that are no larger than this.
const MOST_KNOWN: usize = 8;
const MOST_KNOWN_POINTS: usize = 65_536;

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
    let most_followed = MOST_FOLLOWED[0] + MOST_FOLLOWED[1] * grid.targets.len() as u64;
    let is_too_much = |follower: &Follower<'_>| follower.grid.effort.evaluations >= most_followed;
    for (number, point) in points.iter().copied().enumerate() {
        if grid.effort.boxes >= choice.most_boxes || number == MOST_ANCHORS || is_too_much(&follower) {
            grid.effort.is_given_up = true;
            break;
        }
        let mut leads = Leads::default();
        let mut leads_to_middle = true;
        let found = ahead.roots(choice, ranges, grid.targets, &points[number..]);
        let target = grid.targets[point];
        for root in branches_of(found, grid, target, choice) {
            if leads.roots.is_empty() && is_too_much(&follower) {
                grid.effort.is_given_up = true;
                break;
            }
            let (field, inside) = follower.follow_once(point, &root, (ranges, choice.periodic));
            let at_middle: Vec<f64> = field.unknowns(middle).collect();
            let has_middle = field.is_root(middle);
            let at = if has_middle { back_into(ranges, choice.periodic, &at_middle) } else { root.unknowns.clone() };
            if choice.keeps(&at) {
                leads.add(root, field, inside);
                leads_to_middle &= has_middle;
            } else if field.len() <= MOST_KNOWN_POINTS {
                follower.known.push_back((field, inside));
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
    /// What was followed from earlier points and did not qualify.
    known: VecDeque<(Field, usize)>,
}

impl<'s> Follower<'s> {
    fn new(grid: &Grid<'s>, reach: Option<&'s Reach>) -> Follower<'s> {
        let ranges = reach.map_or(grid.ranges, |reach| &reach.ranges);
        Follower { grid: grid.within(ranges), solvers: Solvers::new(grid.system, ranges), known: VecDeque::new() }
    }

    /// What [`Follower::follow`] gives, of a branch that is known without the work of following it once more.
    fn follow_once(&mut self, from: usize, root: &Solution, within: (&[Range], &[bool])) -> (Field, usize) {
        let is_on = |field: &Field| {
            let own: Vec<f64> = field.unknowns(from).collect();
            field.is_root(from) && is_same_root(&root.unknowns, &own, within.0, within.1)
        };
        if let Some(number) = self.known.iter().position(|(field, _)| is_on(field)) {
            return self.known.remove(number).expect("it was found there");
        }
        if self.known.len() == MOST_KNOWN {
            self.known.pop_front();
        }
        self.follow(from, root, within)
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

/// The unknowns of a branch at points spread over a grid.
pub(crate) fn course(field: &Field) -> Vec<Vec<f64>> {
    let solved: Vec<usize> = (0..field.len()).filter(|point| field.is_solved(*point)).collect();
    let step = solved.len().div_ceil(COURSE).max(1);
    solved.into_iter().step_by(step).map(|point| field.unknowns(point).collect()).collect()
}

/// Roots that are whole turns of some unknowns away from those that are known, or nearly so: a thread comes by again when spindle or
/// thread have turned once more, and the search may not have come so far.
pub(crate) fn turned_copies(grid: &mut Grid<'_>, ranges: &[Range], target: &[f64; 2], found: &Roots) -> Vec<Solution> {
    let known: Vec<Solution> =
        found.isolated.iter().map(|root| root.solution.clone()).chain(found.unproven.iter().cloned()).collect();
    let turning: Vec<usize> = (0..ranges.len()).filter(|k| ranges[*k].width() > 0.5 * TAU).collect();
    let mut turns: Vec<Vec<(usize, i32)>> = Vec::new();
    let all = || (-TURNS..=TURNS).filter(|turn| *turn != 0);
    for (number, k) in turning.iter().enumerate() {
        turns.extend(all().map(|turn| vec![(*k, turn)]));
        for other in &turning[number + 1..] {
            turns.extend(all().map(|turn| vec![(*k, turn), (*other, -turn)]));
        }
    }
    let mut copies = Vec::new();
    grid.evaluation.set_parameters(target);
    for root in &known {
        for turn in &turns {
            let mut start = root.unknowns.clone();
            turn.iter().for_each(|(k, turns)| start[*k] += TAU * f64::from(*turns));
            if start.iter().zip(ranges).any(|(x, range)| range.excess(*x) > 0.5 * TAU) {
                continue;
            }
            let solution = solve_with(&mut grid.evaluation, grid.ranges, &start);
            grid.effort.evaluations += u64::from(solution.iterations);
            if solution.is_solved() {
                copies.push(solution);
            }
        }
    }
    copies
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
        let path = Path::new(self.ranges, [from, to], root.unknowns.clone(), root.unknowns.clone());
        let (solution, evaluations) = path.follow(&mut self.evaluation);
        self.effort.evaluations += evaluations;
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
