//! Settings with which a surface comes nearest to measured points.

use faer::Mat;

use super::shapes::Shapes;
use super::{AdjustableSurface, Foot, NearFoot, StartOfFoot};
use crate::analysis::alignment::Alignment;
use crate::newton::least_squares::{LeastSquares, LeastSquaresFit, Linearized, ScaledUnknown};

/// A search ends where no point moves by more, mm: a hundredth of what points are solved to, and far above rounding.
const SETTLED: f64 = 1e-10;

/// Points that a surface shall go through.
#[derive(Clone, Debug)]
pub struct WantedPoints<'s> {
    /// The surface.
    pub surface: &'s AdjustableSurface,
    /// mm
    pub points: Vec<[f64; 3]>,
    /// For each point where its foot is looked for.
    pub near: Vec<NearFoot>,
}

/// Settings that bring surfaces to points, and motions that lay the points onto their place.
#[derive(Clone, Debug)]
pub struct SettingsAdjustment<'s> {
    /// Surfaces of one body, all in the same settings.
    pub wanted: Vec<WantedPoints<'s>>,
    /// Further surfaces of the body that are to go through these points whatever the others do; the points move with the body.
    pub kept: Vec<WantedPoints<'s>>,
    /// The settings; of those that are held both ends of the range are the start.
    pub settings: Vec<ScaledUnknown>,
    /// In which motion the place of the points is unknown.
    pub alignment: Alignment,
    /// That of all points.
    pub motion: ScaledUnknown,
    /// By how much further the points of each wanted surface behind the first are moved, where each lies as it likes.
    pub further: Vec<ScaledUnknown>,
    /// The parts of the distances that are fitted; all of them where there is none.
    pub shapes: Option<Shapes>,
    /// As [`LeastSquares::resolution`], mm.
    pub resolution: f64,
    /// As [`LeastSquares::uses_weak`].
    pub uses_weak: bool,
}

/// Surfaces that are as near to points as their settings bring them.
#[derive(Clone, Debug)]
pub struct AdjustedSurfaces {
    /// Residuals are the distances of the points, mm, or their parts that are fitted; unknowns the settings, then the motion, then those of
    /// single surfaces.
    pub fit: LeastSquaresFit,
    /// Of each surface, for each point.
    pub feet: Vec<Vec<Foot>>,
    alignment: Alignment,
}

impl AdjustedSurfaces {
    /// The distances of all points, mm.
    #[must_use]
    pub fn distances(&self) -> Vec<f64> {
        self.feet.iter().flatten().map(|foot| foot.distance).collect()
    }

    /// Root of the mean square of the distances, mm.
    #[must_use]
    pub fn rms(&self) -> f64 {
        let squares: f64 = self.distances().iter().map(|off| off * off).sum();
        (squares / self.fit.residuals.len().max(1) as f64).sqrt()
    }

    /// What the distances change by per unit of an unknown. One for each point.
    #[must_use]
    pub fn effect(&self, unknown: usize) -> Vec<f64> {
        in_order(&self.feet).map(|foot| slope(foot, unknown, self.alignment)).collect()
    }
}

impl SettingsAdjustment<'_> {
    /// Settings and motion with the least sum of squared distances. `None` if a point has no foot with the settings of the start.
    ///
    /// # Panics
    /// If a surface has not as many settings.
    #[must_use]
    pub fn solve(&self) -> Option<AdjustedSurfaces> {
        let problem = LeastSquares {
            unknowns: self.settings.iter().chain([&self.motion]).chain(&self.further).copied().collect(),
            exact: self.kept.iter().map(|kept| kept.points.len()).sum(),
            resolution: self.resolution,
            uses_weak: self.uses_weak,
            settled: SETTLED,
            given_up: None,
        };
        let near: Vec<&[NearFoot]> = self.surfaces().map(|wanted| &wanted.near[..]).collect();
        // with the values that they are of
        let mut last: (Vec<f64>, Vec<Vec<Foot>>) = (Vec::new(), Vec::new());
        let fit = problem.solve(|values| {
            let feet = match &last.1[..] {
                [] => self.feet(values, &near)?,
                last => self.feet(values, last)?,
            };
            let (wanted, kept) = feet.split_at(self.wanted.len());
            let told = linearized([wanted, kept], (values.len(), self.alignment), self.shapes.as_ref());
            last = (values.to_vec(), feet);
            Some(told)
        })?;
        let (values, feet) = last;
        let mut feet = if values == fit.values { feet } else { self.feet(&fit.values, &feet)? };
        feet.truncate(self.wanted.len());
        Some(AdjustedSurfaces { fit, feet, alignment: self.alignment })
    }

    fn surfaces(&self) -> impl Iterator<Item = &WantedPoints<'_>> {
        self.wanted.iter().chain(&self.kept)
    }

    /// All feet with these settings and this motion; `None` if one is missing.
    fn feet<S: StartOfFoot>(&self, values: &[f64], near: &[impl AsRef<[S]>]) -> Option<Vec<Vec<Foot>>> {
        let (settings, motions) = values.split_at(self.settings.len());
        let of = |(surface, wanted): (usize, &WantedPoints<'_>)| {
            let is_further = surface > 0 && surface < self.wanted.len();
            let further = motions.get(surface).copied().filter(|_| is_further).unwrap_or_default();
            let points: Vec<[f64; 3]> =
                wanted.points.iter().map(|point| self.alignment.moved(*point, motions[0] + further)).collect();
            wanted.surface.at(settings).feet(&points, near[surface].as_ref()).into_iter().collect::<Option<Vec<Foot>>>()
        };
        self.surfaces().enumerate().map(of).collect()
    }
}

/// Of points that are wanted, then of those that are kept, by so many unknowns.
fn linearized(
    [wanted, kept]: [&[Vec<Foot>]; 2],
    (unknowns, alignment): (usize, Alignment),
    shapes: Option<&Shapes>,
) -> Linearized {
    let part = |of: Vec<f64>| shapes.map_or_else(|| of.clone(), |shapes| shapes.part(&of));
    let all = |of: &dyn Fn((usize, &Foot)) -> f64| -> Vec<f64> {
        let own = part(in_order(wanted).map(of).collect());
        // what is kept moves with all
        own.into_iter().chain(in_order(kept).map(|(_, foot)| of((0, foot)))).collect()
    };
    let residuals = all(&|(_, foot)| foot.distance);
    let mut jacobian = Mat::zeros(residuals.len(), unknowns);
    (0..unknowns).for_each(|k| jacobian.col_as_slice_mut(k).copy_from_slice(&all(&|foot| slope(foot, k, alignment))));
    Linearized { residuals, jacobian }
}

/// Each with the place of its surface.
fn in_order(feet: &[Vec<Foot>]) -> impl Iterator<Item = (usize, &Foot)> {
    feet.iter().enumerate().flat_map(|(surface, feet)| feet.iter().map(move |foot| (surface, foot)))
}

/// Along the normal at its foot a point recedes as the surface comes, and comes as it is moved; where the foot goes is square to that.
fn slope((surface, foot): (usize, &Foot), unknown: usize, alignment: Alignment) -> f64 {
    match unknown.checked_sub(foot.moved.len()) {
        None => -foot.moved[unknown],
        Some(motion) if motion == 0 || motion == surface => alignment.lever(foot.position, foot.normal),
        Some(_) => 0.0,
    }
}
