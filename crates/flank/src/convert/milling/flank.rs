//! A flank as a milling leaves it, for whoever rolls on it.

use flank_chain_dsl::{Job, Milling};
use flank_draw::PageMilling;
use flank_solver::{PoseSeries, SweptCutter, cusp};
use rayon::prelude::*;

use super::cutter::MillingCutter;
use super::on_page::on_page;
use super::target::Fields;
use super::{Found, Worked, worked};
use crate::project::failure::Failure;
use crate::project::remark::NotDone;
use crate::project::requests::{JobSelection, MillRequest};
use crate::project::session::Session;

/// Steps of Newton's method for the place of a point.
const MOST_STEPS: usize = 20;
/// A step up to this, in shares, ends them.
const CLOSE: f64 = 1e-12;
/// So far beside the milled part a point still belongs to it, in shares: rounding.
const BESIDE: f64 = 1e-9;
/// A surface that reaches so much farther than the milled part, in shares, goes on beyond it.
const GOES_ON: f64 = 1e-3;
/// Rows of a pass with the side on which contacts are looked for, and places of each for its heights.
const ROWS: usize = 31;
const COLUMNS: usize = 41;

/// A milled flank. Lengths are mm, places are shares of the passes and along them, lines are position and normal in the frame of the flank.
pub(crate) struct MilledFlank {
    cutter: MillingCutter,
    fields: Fields,
    swept: SweptCutter,
    /// The shares of the passes, and the cutter on each.
    shares: Vec<f64>,
    passes: Vec<PoseSeries>,
    /// The most and the least that is left, beside the stock.
    ends: [f64; 2],
    stock: f64,
    pub(crate) labels: [String; 2],
    /// What the milling does not do as it should, though it leaves this.
    pub(crate) not_done: Vec<NotDone>,
}

/// A line of a milled flank on which a mate may touch it first, over shares from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Crest {
    /// The ridge after a pass.
    Ridge(usize),
    /// A row of what one pass leaves, which has no ridges: any number from zero to [`MilledFlank::rows`] less one.
    Row(f64),
    /// Where the milled part ends and the flank as generated begins: at the low or high end of one of both shares.
    Border { share: usize, is_high: bool },
}

/// A place of a crest.
pub(crate) struct MilledPlace {
    pub(crate) line: [f64; 6],
    /// How high it stands over the flank, with the stock.
    pub(crate) height: f64,
}

impl MilledFlank {
    /// Plans a milling; else why there is none.
    ///
    /// # Errors
    /// See [`worked`].
    pub(crate) fn planned(
        job: &Job<'_>,
        milling: &Milling<'_>,
        (jobs, session): (&JobSelection, Session<'_>),
    ) -> Result<Result<MilledFlank, Vec<NotDone>>, Failure> {
        let worked = worked(job, milling, &MillRequest::new(jobs.clone()), session)?;
        Ok(MilledFlank::of_worked(worked))
    }

    /// The same with the cutter on its passes for a page that has the surface in a place.
    ///
    /// # Errors
    /// See [`worked`].
    pub(crate) fn on_page(
        job: &Job<'_>,
        milling: &Milling<'_>,
        surface: usize,
        (jobs, session): (&JobSelection, Session<'_>),
    ) -> Result<Result<(MilledFlank, PageMilling), Vec<NotDone>>, Failure> {
        let worked = worked(job, milling, &MillRequest::new(jobs.clone()), session)?;
        let page = worked.found.as_ref().map(|found| on_page(job, &worked.target, found, surface)).transpose()?;
        Ok(MilledFlank::of_worked(worked).map(|flank| (flank, page.unwrap_or_default())))
    }

    fn of_worked(worked: Worked<'_, '_>) -> Result<MilledFlank, Vec<NotDone>> {
        let Worked { target, result, found } = worked;
        let Some(Found { cutter, fields, milled, swept, map, .. }) = found else { return Err(result.not_done) };
        let (shares, passes) = (milled.plan.shares[0].clone(), milled.ways);
        let ends = milled.plan.cusp.or_else(|| map.highest()).zip(map.deepest());
        let ends = ends.map_or([0.0; 2], |(most, (least, _))| [most.height, least.height]);
        let (labels, stock, not_done) = (target.labels(), target.milling.stock, result.not_done);
        let mut flank = MilledFlank { cutter, fields, swept, shares, passes, ends, stock, labels, not_done };
        if flank.has_one_pass() {
            // at its borders it may leave more than at the points of the map
            flank.ends = flank.ends_of_rows();
        }
        Ok(flank)
    }

    fn ends_of_rows(&self) -> [f64; 2] {
        let places: Vec<(usize, usize)> = (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |k| (row, k))).collect();
        let left = |(row, column): &(usize, usize)| {
            let place = self.place_of(Crest::Row(*row as f64), *column as f64 / (COLUMNS - 1) as f64)?;
            Some([place.height - self.stock; 2])
        };
        let all: Vec<[f64; 2]> = places.par_iter().filter_map(left).collect();
        all.into_iter().fold(self.ends, |[a, b], [c, d]| [a.max(c), b.min(d)])
    }

    pub(crate) fn passes(&self) -> usize {
        self.passes.len()
    }

    /// Whether one pass covers it, which leaves no ridges.
    pub(crate) fn has_one_pass(&self) -> bool {
        self.passes.len() == 1
    }

    /// The most and the least that is left, beside the stock: highest the ridges, where there are any.
    pub(crate) fn ends(&self) -> [f64; 2] {
        self.ends
    }

    /// What is left everywhere.
    pub(crate) fn stock(&self) -> f64 {
        self.stock
    }

    /// All lines on which a mate may touch first: ridges or, of one pass, rows, and the borders beyond which one of some points of the
    /// flank lies.
    pub(crate) fn crests(&self, points: impl Iterator<Item = [f64; 3]>) -> Vec<Crest> {
        let mut beyond = [[false; 2]; 2];
        for shares in points.filter_map(|point| self.place(point)) {
            for (beyond, share) in beyond.iter_mut().zip(shares) {
                beyond[0] |= share < -GOES_ON;
                beyond[1] |= share > 1.0 + GOES_ON;
            }
        }
        let borders = [0, 1].into_iter().flat_map(|share| [0, 1].map(|end| (share, end)));
        let borders = borders.filter(|(share, end)| beyond[*share][*end]);
        let borders = borders.map(|(share, end)| Crest::Border { share, is_high: end == 1 });
        let lines: Vec<Crest> = match self.has_one_pass() {
            true => (0..ROWS).map(|row| Crest::Row(row as f64)).collect(),
            false => (0..self.passes() - 1).map(Crest::Ridge).collect(),
        };
        lines.into_iter().chain(borders).collect()
    }

    /// How many rows stand for one pass.
    pub(crate) fn rows(&self) -> usize {
        ROWS
    }

    /// Where a crest lies among its like: the number of a ridge or row that goes through a share of the passes.
    pub(crate) fn number_at(&self, across: f64) -> f64 {
        match self.has_one_pass() {
            true => across * (ROWS - 1) as f64,
            false => across * (self.passes() - 1) as f64 - 0.5,
        }
    }

    /// A place of a crest; `None` where the cutter does not pass.
    pub(crate) fn place_of(&self, crest: Crest, along: f64) -> Option<MilledPlace> {
        match crest {
            Crest::Ridge(after) => {
                let across = self.fields.surface.across(along);
                let shares = [after, after + 1].map(|pass| self.shares[pass]);
                let beside = [&self.passes[after], &self.passes[after + 1]];
                let found = cusp(&across, beside, shares, along, &self.cutter.cutting)?;
                Some(MilledPlace { line: across.at(found.share), height: found.height })
            }
            Crest::Row(row) => {
                let line = self.fields.surface.at([row / (ROWS - 1) as f64, along]);
                Some(MilledPlace { line, height: self.swept.left(&line)?.height })
            }
            Crest::Border { share, is_high } => {
                let end = f64::from(u8::from(is_high));
                let shares = if share == 0 { [end, along] } else { [along, end] };
                Some(MilledPlace { line: self.fields.surface.at(shares), height: 0.0 })
            }
        }
    }

    /// A place of the contact of a pass.
    pub(crate) fn on_pass(&self, pass: usize, along: f64) -> [f64; 6] {
        self.fields.surface.at([self.shares[pass], along])
    }

    /// What is left over a point of the flank, with the stock; `None` beside the milled part.
    pub(crate) fn left(&self, position: [f64; 3]) -> Option<f64> {
        let shares = self.place(position)?;
        let is_within = |share: f64| (-BESIDE..=1.0 + BESIDE).contains(&share);
        let line = self.fields.surface.at(shares);
        shares.into_iter().all(is_within).then(|| self.swept.left(&line))?.map(|left| left.height)
    }

    /// The shares of the point of the flank that is nearest to a position, by the method of Gauss and Newton; these may lie beside the
    /// milled part.
    pub(crate) fn place(&self, position: [f64; 3]) -> Option<[f64; 2]> {
        const APART: f64 = 1e-5;
        let surface = &self.fields.surface;
        let off = |shares: [f64; 2]| {
            let at = surface.at(shares);
            [0, 1, 2].map(|k| at[k] - position[k])
        };
        let squared = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>();
        let nodes = self.fields.lattice.each();
        let (mut at, _) = nodes
            .map(|(shares, frame)| (shares, squared([0, 1, 2].map(|k| frame.position[k] - position[k]))))
            .min_by(|a, b| a.1.total_cmp(&b.1))?;
        for _ in 0..MOST_STEPS {
            let here = off(at);
            let slope = |k: usize| {
                let beside = |by: f64| off([0, 1].map(|l| if l == k { at[l] + by } else { at[l] }));
                let (after, before) = (beside(APART), beside(-APART));
                [0, 1, 2].map(|i| (after[i] - before[i]) / (2.0 * APART))
            };
            let [u, v] = [slope(0), slope(1)];
            let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
            let (uu, uv, vv) = (dot(u, u), dot(u, v), dot(v, v));
            let (f, g) = (dot(u, here), dot(v, here));
            let whole = uu * vv - uv * uv;
            let step = [(vv * f - uv * g) / whole, (uu * g - uv * f) / whole];
            at = [0, 1].map(|k| (at[k] - step[k]).clamp(-0.5, 1.5));
            if !at.iter().all(|share| share.is_finite()) {
                return None;
            }
            if step.iter().all(|step| step.abs() < CLOSE) {
                break;
            }
        }
        Some(at)
    }
}
