//! All points of a grid: its branch is found, followed, and judged.

use crate::continuation::anchor::follow_alone;
use crate::continuation::choice::{Choice, Several};
use crate::continuation::field::Field;
use crate::continuation::grid::{Followed, Grid, GridReport};
use crate::continuation::reach::settle;
use crate::continuation::survey::surveyed;
use crate::equations::solution::{Range, Solution};
use crate::equations::system::System;
use crate::newton::solvers::Solvers;
use crate::roots::{MOST_BOXES, all_roots};

/// Boxes that are looked at, at all of them together, before the search is given up.
const MOST_BOXES_OF_ALL: u64 = 10 * MOST_BOXES;

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
) -> (Vec<Solution>, GridReport) {
    let roots = |ranges: &[Range], targets: &[f64; 2]| all_roots(system, ranges, targets, MOST_BOXES);
    let choice = Choice {
        roots: &roots,
        keep: None,
        several: Several::TakeWidest,
        tells_others: true,
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
pub(crate) fn solve_settled(mut grid: Grid<'_>, start: Option<&[f64]>, choice: &Choice<'_>) -> (Field, GridReport) {
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
