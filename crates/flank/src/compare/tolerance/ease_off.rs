//! The ease-off of a surface from itself when settings change.

use flank_chain_dsl::Parameter;
use flank_solver::{
    AdjustableSurface, Alignment, BoundSurface, EaseOff, Foot, FootSearch, NearFoot, Outcome, SurfacePoint,
};

use super::quantity::Quantity;
use crate::compare::map::Named;
use crate::compare::measure::Placed;
use crate::project::failure::Failure;
use crate::project::session::Session;
use crate::solve;
use crate::solve::centre::Centre;

/// Numbers of an ease-off, in the order of [`numbers`].
const NAMES: [&str; 6] =
    ["slope_profilewise", "slope_lengthwise", "crowning_profilewise", "crowning_lengthwise", "bias", "position"];
/// The motion in which the place is unknown moves the middle along its normal by at least this share of the way.
const MOVES: f64 = 1e-3;
/// Steps until the middle is met.
const MOST_STEPS: usize = 20;
/// It is met within this distance, mm: what points are solved to.
const MET: f64 = 1e-9;

/// A surface in open settings over the grid of its sample, rows from root to tip.
pub(super) struct Flank {
    surface: AdjustableSurface,
    pub(super) counts: [usize; 2],
    /// The points as they are.
    feet: Vec<Option<Foot>>,
    middle: Option<Foot>,
    /// The motion that is done until both meet in the middle, if one is.
    alignment: Option<Alignment>,
}

impl Flank {
    /// # Errors
    /// If the surface has no grid, several branches, or no middle.
    pub(super) fn new<'g>(
        of: Named<'_, 'g>,
        settings: &[&Parameter<'g>],
        (is_aligned, session): (bool, Session<'_>),
    ) -> Result<Flank, Failure> {
        let placed = Placed::new(of.job, of.surface, [0.0; 2], session)?;
        let counts = placed.counts();
        let [profile, length] = placed.shares(counts);
        let (sample, centre) = Centre::of_sample(&placed.sample(&profile, &length));
        let points = placed.solved(&sample)?;
        let open: Vec<_> = settings.iter().map(|setting| setting.variable).collect();
        let bindings = of.job.bindings_beside(&open);
        let bound = BoundSurface::new(&of.surface.surface, solve::followed(of.surface), &bindings);
        let surface = AdjustableSurface::new(&bound, &open).expect("a job without errors leaves nothing unbound");
        let values: Vec<f64> = settings.iter().map(|setting| setting.value).collect();
        let now = surface.at(&values);
        let near = |unknowns: &[f64]| NearFoot { unknowns: unknowns.to_vec(), distance: 0.0 };
        let foot = |point: &SurfacePoint| {
            let is_solved = point.outcome == Outcome::Solved;
            let feet = is_solved.then(|| now.feet(&[point.position], &[near(&point.unknowns)]));
            feet?.pop()?
        };
        let feet: Vec<Option<Foot>> = points.iter().map(foot).collect();
        let alignment = is_aligned.then(|| of.alignment());
        let middle = feet[centre.middle()].clone();
        let flank = Flank { feet: centre.own(&feet), middle, surface, counts, alignment };
        flank.check_middle(&of.surface.name)?;
        Ok(flank)
    }

    fn check_middle(&self, name: &str) -> Result<(), Failure> {
        let Some(alignment) = self.alignment else { return Ok(()) };
        let (motion, moved) = match alignment {
            Alignment::Turn => ("turn", "turned about z"),
            Alignment::Shift => ("shift", "shifted along y"),
        };
        let way_out = format!("the option `no_align` does without the {motion} that brings both to meet there");
        let refused = |why: &str| Err(Failure::Unsolved(format!("`{name}` {why}; {way_out}")));
        match &self.middle {
            None => refused("has no point in the middle of its grid"),
            Some(middle) if lever(alignment, middle).abs() < MOVES * alignment.arc(middle.position) => {
                refused(&format!("does not move along its normal in the middle of its grid when it is {moved}"))
            }
            Some(_) => Ok(()),
        }
    }

    /// Points at which it is known.
    pub(super) fn known(&self) -> usize {
        self.feet.iter().flatten().count()
    }

    /// What scatters, each with its change by a unit of each setting; `None` if the points are too few for a parabola.
    pub(super) fn quantities(&self, settings: usize) -> Option<Vec<Quantity>> {
        let by_setting = (0..settings).map(|k| {
            let by = match self.alignment.zip(self.middle.as_ref()) {
                Some((alignment, middle)) => -middle.moved[k] / lever(alignment, middle),
                None => 0.0,
            };
            let aligned = |foot: &Foot| self.alignment.map_or(0.0, |alignment| by * lever(alignment, foot));
            let off = self.feet.iter().map(|foot| foot.as_ref().map(|foot| foot.moved[k] + aligned(foot)));
            self.numbers(&off.collect::<Vec<_>>(), by)
        });
        let by_setting = by_setting.collect::<Option<Vec<[f64; 6]>>>()?;
        let count = self.count();
        let quantity = |(at, name): (usize, &&str)| {
            let gradient = by_setting.iter().map(|numbers| numbers[at]).collect();
            Quantity { name: (*name).to_string(), unit: "um", size: 1e-3, gradient }
        };
        Some(NAMES[..count].iter().enumerate().map(quantity).collect())
    }

    /// The same numbers with other values of the settings, um; `None` if a point has no foot then, or the middle is not met.
    pub(super) fn with(&self, values: &[f64]) -> Option<Vec<f64>> {
        let (positions, near): (Vec<[f64; 3]>, Vec<NearFoot>) = self.feet.iter().flatten().map(beside).unzip();
        let changed = self.surface.at(values);
        let (alignment, by) = match self.alignment {
            Some(alignment) => (alignment, self.met(&changed, alignment)?),
            None => (Alignment::default(), 0.0),
        };
        let moved: Vec<[f64; 3]> = positions.into_iter().map(|point| alignment.moved(point, -by)).collect();
        let mut feet = changed.feet(&moved, &near).into_iter();
        // a point lies off the changed surface the other way than that lies off the point
        let off = self.feet.iter().map(|foot| match foot {
            Some(_) => feet.next().flatten().map(|foot| Some(-foot.distance)),
            None => Some(None),
        });
        let numbers = self.numbers(&off.collect::<Option<Vec<_>>>()?, by)?;
        Some(numbers.iter().take(self.count()).map(|number| 1e3 * number).collect())
    }

    /// How many numbers there are: the position only of what is moved.
    fn count(&self) -> usize {
        if self.alignment.is_some() { NAMES.len() } else { NAMES.len() - 1 }
    }

    /// The motion of the changed surface that brings it through the middle.
    fn met(&self, changed: &FootSearch, alignment: Alignment) -> Option<f64> {
        let (position, mut near) = beside(self.middle.as_ref()?);
        let mut by = 0.0;
        for _ in 0..MOST_STEPS {
            let foot = changed.feet(&[alignment.moved(position, -by)], std::slice::from_ref(&near)).pop()??;
            if foot.distance.abs() < MET {
                return Some(by);
            }
            by += foot.distance / lever(alignment, &foot);
            near = NearFoot { unknowns: foot.unknowns, distance: 0.0 };
        }
        None
    }

    /// Of deviations, mm, and the motion that they take.
    fn numbers(&self, off: &[Option<f64>], by: f64) -> Option<[f64; 6]> {
        let EaseOff { slopes, crownings, bias } = EaseOff::of_deviations(off, self.counts)?;
        let way = self.middle.as_ref().zip(self.alignment).map_or(0.0, |(middle, of)| -by * of.arc(middle.position));
        Some([slopes[0], slopes[1], crownings[0], crownings[1], bias, way])
    }
}

fn lever(alignment: Alignment, foot: &Foot) -> f64 {
    alignment.lever(foot.position, foot.normal)
}

fn beside(foot: &Foot) -> ([f64; 3], NearFoot) {
    (foot.position, NearFoot { unknowns: foot.unknowns.clone(), distance: 0.0 })
}
