//! Surfaces whose points are handed over in bands of rows: there may be more of them than memory holds.

use crate::files::error::WriteError;
use crate::points::dataset::{Dataset, Header, Patch, Point, miscounted};
use crate::points::tally::Tally;

/// What takes the points of some rows.
pub type Taker<'t> = &'t mut dyn FnMut(&[Point]) -> Result<(), WriteError>;

/// A surface that hands over its points as often as it is asked to, the same each time.
pub trait Banded {
    /// The surface with its name, frame, axes and unknowns; its points are not looked at, its fields are those of the points that
    /// are handed over.
    fn outline(&self) -> &Patch;

    /// Hands over all points, whole rows at a time, in order.
    ///
    /// # Errors
    /// What `take` gives.
    fn bands(&self, take: Taker<'_>) -> Result<(), WriteError>;
}

/// In one piece.
impl Banded for Patch {
    fn outline(&self) -> &Patch {
        self
    }

    fn bands(&self, take: Taker<'_>) -> Result<(), WriteError> {
        take(&self.points)
    }
}

/// Surfaces to be written, with where they come from.
#[derive(Clone)]
pub struct Surfaces<'b> {
    /// Stated at the head of every file.
    pub header: &'b Header,
    /// In the order they appear in files.
    pub list: Vec<&'b dyn Banded>,
}

impl Dataset {
    /// Its patches as surfaces in one piece.
    #[must_use]
    pub fn surfaces(&self) -> Surfaces<'_> {
        Surfaces { header: &self.header, list: self.patches.iter().map(|patch| patch as &dyn Banded).collect() }
    }
}

impl<'b> Surfaces<'b> {
    pub(crate) fn outlines(&self) -> impl Iterator<Item = &'b Patch> {
        self.list.iter().map(|surface| surface.outline())
    }
}

/// What is known of surfaces once all their points have been seen.
pub(crate) struct Seen {
    /// Of each surface.
    pub(crate) tallies: Vec<Tally>,
    pub(crate) all: Tally,
    /// Whether a point has a reason.
    pub(crate) told: bool,
}

impl Seen {
    /// Looks at all points.
    ///
    /// # Errors
    /// If a surface is malformed, or cannot be handed over.
    pub(crate) fn of_surfaces(surfaces: &Surfaces<'_>) -> Result<Seen, WriteError> {
        let (mut all, mut told) = (Tally::default(), false);
        let mut tallies = Vec::new();
        for surface in &surfaces.list {
            let (outline, mut tally) = (surface.outline(), Tally::default());
            let count = outline.rows.count.checked_mul(outline.columns.count);
            outline.check_fields(count.unwrap_or(usize::MAX))?;
            surface.bands(&mut |points| {
                if count.is_none_or(|count| points.len() > count - tally.asked) {
                    return Err(miscounted(outline, tally.asked + points.len()).into());
                }
                outline.check_points(tally.asked, points)?;
                told |= points.iter().any(|point| !point.reason.is_empty());
                points.iter().for_each(|point| tally.count(point));
                Ok(())
            })?;
            if count != Some(tally.asked) {
                return Err(miscounted(outline, tally.asked).into());
            }
            all.add(&tally);
            tallies.push(tally);
        }
        Ok(Seen { tallies, all, told })
    }
}
