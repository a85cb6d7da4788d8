//! A flank as a milling leaves it, for whoever rolls on it.

use flank_chain_dsl::{Job, Milling};
use flank_draw::PageMilling;
use flank_solver::{PoseSeries, SweptCutter, cusp};

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

/// A milled flank. Lengths are mm, places are shares of the passes and along them, lines are position and normal in the frame of the flank.
pub(crate) struct MilledFlank {
    cutter: MillingCutter,
    fields: Fields,
    swept: SweptCutter,
    /// The shares of the passes, and the cutter on each.
    shares: Vec<f64>,
    passes: Vec<PoseSeries>,
    highest: f64,
    stock: f64,
    pub(crate) labels: [String; 2],
    /// What the milling does not do as it should, though it leaves this.
    pub(crate) not_done: Vec<NotDone>,
}

/// A place of a ridge.
pub(crate) struct RidgeAt {
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
        let most = milled.plan.cusp.or_else(|| map.highest());
        let (shares, passes, highest) = (milled.plan.shares[0].clone(), milled.ways, most.map_or(0.0, |at| at.height));
        let (labels, stock, not_done) = (target.labels(), target.milling.stock, result.not_done);
        Ok(MilledFlank { cutter, fields, swept, shares, passes, highest, stock, labels, not_done })
    }

    pub(crate) fn passes(&self) -> usize {
        self.passes.len()
    }

    /// The highest ridge beside the stock.
    pub(crate) fn highest(&self) -> f64 {
        self.highest
    }

    /// What is left everywhere.
    pub(crate) fn stock(&self) -> f64 {
        self.stock
    }

    /// A place of the ridge after a pass.
    pub(crate) fn ridge(&self, after: usize, along: f64) -> Option<RidgeAt> {
        let across = self.fields.surface.across(along);
        let shares = [after, after + 1].map(|pass| self.shares[pass]);
        let beside = [&self.passes[after], &self.passes[after + 1]];
        let found = cusp(&across, beside, shares, along, &self.cutter.cutting)?;
        Some(RidgeAt { line: across.at(found.share), height: found.height })
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
