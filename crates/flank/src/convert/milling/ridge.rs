//! The highest that blocks leave near some places: on the ridge between blocks, wherever these run.
//!
//! What is left is the least of what single blocks leave, each a smooth function of the place. So a step goes to where the least of their tangent
//! planes is highest within reach: along a ridge, or into the corner of three blocks.

use flank_solver::{SpacePlace, SweptCutter};
use rayon::prelude::*;

use super::plan::{LeftAt, higher};
use super::target::Fields;

/// Steps from a place go so far at the most at first and at last, in cells of the map, ...
const SEARCH: [f64; 2] = [0.5, 0.02];
/// ... and so far from the highest that was found: what a height bends within the last is below 1e-5 um of a ball of 1 mm.
const END: [f64; 2] = [0.02, 3e-4];
/// They are so much shorter where one has led no higher.
const SHORTER: f64 = 0.25;
/// Steps at the most from one place.
const MOST_STEPS: usize = 60;
/// Places beside the highest so far are so many cells away, ...
const HOP: f64 = 1.0;
/// ... and are gone to as often, if they lead higher by more than this, mm.
const MOST_HOPS: usize = 20;
const HIGHER: f64 = 1e-9;
/// How far places lie apart that tell how a height changes, in cells.
const APART: f64 = 1e-4;

/// What blocks leave in a space; places are told in cells of a map.
pub(super) struct Ridges<'s> {
    pub(super) fields: &'s Fields,
    pub(super) swept: &'s SweptCutter,
    pub(super) stands: SpacePlace,
    /// Rows and columns of cells.
    pub(super) cells: [usize; 2],
    /// What is to be left, mm.
    pub(super) stock: f64,
}

/// What one block leaves beside a place: a height, and how it changes.
#[derive(Clone, Copy)]
struct Plane {
    height: f64,
    slope: [f64; 2],
}

impl Ridges<'_> {
    /// The highest place that is come to from some, and from places beside it as long as that is higher.
    pub(super) fn highest(&self, starts: &[LeftAt]) -> Option<LeftAt> {
        let cell = |left: &LeftAt| [0, 1].map(|k| left.shares[k] * self.cells[k] as f64);
        let highest = |starts: &[[f64; 2]]| {
            let all: Vec<Option<LeftAt>> = starts.par_iter().map(|start| self.climbed(*start, SEARCH)).collect();
            all.into_iter().flatten().reduce(higher)
        };
        let mut best = highest(&starts.iter().map(cell).collect::<Vec<[f64; 2]>>())?;
        for _ in 0..MOST_HOPS {
            let beside: Vec<[f64; 2]> = self.around(cell(&best), HOP).collect();
            match highest(&beside).filter(|next| next.height > best.height + HIGHER) {
                Some(next) => best = next,
                None => break,
            }
        }
        self.climbed(cell(&best), END)
    }

    /// The places so far off in both directions and along both at once, within the ends.
    fn around(&self, at: [f64; 2], reach: f64) -> impl Iterator<Item = [f64; 2]> {
        let ways = (0..9).map(|k| [k / 3, k % 3]).filter(|way| *way != [1, 1]);
        let most = self.cells.map(|count| count as f64);
        ways.map(move |way| [0, 1].map(|k| (at[k] + (f64::from(way[k]) - 1.0) * reach).clamp(0.0, most[k])))
    }

    fn shares(&self, at: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| at[k] / self.cells[k] as f64)
    }

    fn line(&self, at: [f64; 2]) -> [f64; 6] {
        self.stands.placed(&self.fields.surface.at(self.shares(at)))
    }

    /// Up from a place until steps are short.
    fn climbed(&self, start: [f64; 2], [mut reach, last]: [f64; 2]) -> Option<LeftAt> {
        let left = |at: [f64; 2]| self.swept.left(&self.line(at)).map(|left| (at, left));
        let mut best = left(start)?;
        for _ in 0..MOST_STEPS {
            let beside: Vec<_> = self.around(best.0, reach).filter_map(left).collect();
            let mut blocks: Vec<usize> = beside.iter().chain([&best]).map(|(_, left)| left.way).collect();
            blocks.sort_unstable();
            blocks.dedup();
            let planes: Vec<Plane> = blocks.iter().filter_map(|block| self.plane(*block, best.0)).collect();
            let room = [0, 1].map(|k| [(-reach).max(-best.0[k]), reach.min(self.cells[k] as f64 - best.0[k])]);
            let step = highest_of(&planes, room);
            let tried = left([0, 1].map(|k| best.0[k] + step[k]));
            let next = tried.into_iter().chain(beside).max_by(|a, b| a.1.height.total_cmp(&b.1.height));
            match next.filter(|next| next.1.height > best.1.height) {
                Some(next) => best = next,
                None if reach < last => break,
                None => reach *= SHORTER,
            }
        }
        Some(LeftAt { shares: self.shares(best.0), height: best.1.height - self.stock })
    }

    /// `None` where the block does not pass.
    fn plane(&self, block: usize, at: [f64; 2]) -> Option<Plane> {
        let height = |at: [f64; 2]| self.swept.left_by(block, &self.line(at));
        let slope = |k: usize| -> Option<f64> {
            let [before, behind] = [-APART, APART].map(|by| {
                let mut at = at;
                at[k] += by;
                height(at)
            });
            Some((behind? - before?) / (2.0 * APART))
        };
        Some(Plane { height: height(at)?, slope: [slope(0)?, slope(1)?] })
    }
}

/// Where the least of planes is highest, within ends along both directions: at a corner, where two meet at an end, or where three do.
fn highest_of(planes: &[Plane], room: [[f64; 2]; 2]) -> [f64; 2] {
    let least = |at: [f64; 2]| {
        let heights = planes.iter().map(|plane| plane.height + plane.slope[0] * at[0] + plane.slope[1] * at[1]);
        heights.fold(f64::INFINITY, f64::min)
    };
    let corners = room[0].iter().flat_map(|x| room[1].iter().map(|y| [*x, *y]));
    let pairs = (0..planes.len()).flat_map(|i| (0..i).map(move |j| [i, j]));
    // height and slope of the one over the other
    let over = |[i, j]: [usize; 2]| {
        let [a, b] = [planes[i], planes[j]];
        (a.height - b.height, [0, 1].map(|k| a.slope[k] - b.slope[k]))
    };
    let at_ends = pairs.clone().flat_map(|pair| {
        let (height, slope) = over(pair);
        [0, 1].into_iter().flat_map(move |k| {
            room[k].map(|end| {
                let other = -(height + slope[k] * end) / slope[1 - k];
                if k == 0 { [end, other] } else { [other, end] }
            })
        })
    });
    let corners_of_three = pairs.flat_map(|[i, j]| (0..j).map(move |k| [i, j, k])).map(|[i, j, k]| {
        let ((f, [a, b]), (g, [c, d])) = (over([i, j]), over([i, k]));
        let whole = a * d - b * c;
        [(b * g - d * f) / whole, (c * f - a * g) / whole]
    });
    let is_within = |at: &[f64; 2]| (0..2).all(|k| room[k][0] <= at[k] && at[k] <= room[k][1]);
    let all = corners.chain(at_ends).chain(corners_of_three).filter(is_within);
    all.max_by(|a, b| least(*a).total_cmp(&least(*b))).unwrap_or([0.0; 2])
}
