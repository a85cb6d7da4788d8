//! What passes, or the blocks of a program, leave over the milled part of a surface.

use flank_chain_dsl::Job;
use flank_export::{Axis, Dataset, Field, Header, Patch, Values};
use flank_solver::{LeftOver, SpacePlace, SweptCutter};
use rayon::prelude::*;

use super::left_at;
use super::plan::{LeftAt, higher};
use super::result::HeightMap;
use super::target::{Fields, Target};
use crate::project::remark::{NotDone, NotDoneKind};
use crate::solve;

/// What is less deep, mm, is rounding.
const DEEP: f64 = 1e-6;

/// Heights at the middles of equal cells, on no pass in particular.
pub(super) struct LeftMap {
    pub(super) counts: [usize; 2],
    /// Row by row, less the stock; none where the cutter does not pass.
    left: Vec<Option<LeftOver>>,
}

/// The shares of the middles of equal cells.
fn middles([rows, columns]: [usize; 2]) -> [Vec<f64>; 2] {
    [rows, columns].map(|count| (0..count).map(|at| (at as f64 + 0.5) / count as f64).collect())
}

impl LeftMap {
    /// What a cutter leaves at so many rows and columns of points.
    pub(super) fn of_cutter(
        target: &Target<'_, '_>,
        fields: &Fields,
        swept: &SweptCutter,
        counts: [usize; 2],
    ) -> LeftMap {
        LeftMap::in_space(target, fields, swept, (counts, SpacePlace::default(), f64::NEG_INFINITY))
    }

    /// The same where the surface stands in another space; of what is not above `enough`, mm, any height that is not.
    pub(super) fn in_space(
        target: &Target<'_, '_>,
        fields: &Fields,
        swept: &SweptCutter,
        (counts, stands, enough): ([usize; 2], SpacePlace, f64),
    ) -> LeftMap {
        let [rows, columns] = middles(counts);
        let stock = target.milling.stock;
        let at = |place: usize| {
            let line = fields.surface.at([rows[place / counts[1]], columns[place % counts[1]]]);
            swept
                .left_until(&stands.placed(&line), stock + enough)
                .map(|left| LeftOver { height: left.height - stock, ..left })
        };
        LeftMap { counts, left: (0..counts[0] * counts[1]).into_par_iter().map(at).collect() }
    }

    fn places(&self) -> impl Iterator<Item = LeftAt> {
        let [rows, columns] = middles(self.counts);
        let count = self.counts[1];
        self.left.iter().enumerate().filter_map(move |(k, left)| {
            Some(LeftAt { shares: [rows[k / count], columns[k % count]], height: left.as_ref()?.height })
        })
    }

    /// Where most is left.
    pub(super) fn highest(&self) -> Option<LeftAt> {
        self.places().reduce(|a, b| if b.height > a.height { b } else { a })
    }

    /// Where most is left in each of so many parts by so many.
    pub(super) fn highest_of_parts(&self, parts: usize) -> Vec<LeftAt> {
        let part = |left: &LeftAt| left.shares.map(|share| (share * parts as f64) as usize);
        let all = (0..parts * parts).map(|k| [k / parts, k % parts]);
        let highest = |of: [usize; 2]| self.places().filter(|left| part(left) == of).reduce(higher);
        all.filter_map(highest).collect()
    }

    /// Where least is left, and the number of the way that leaves it.
    pub(super) fn deepest(&self) -> Option<(LeftAt, usize)> {
        let ways = self.left.iter().flatten().map(|left| left.way);
        self.places().zip(ways).reduce(|a, b| if b.0.height < a.0.height { b } else { a })
    }

    /// The same where another cutter cuts, too.
    pub(super) fn cut_by(mut self, other: &LeftMap) -> LeftMap {
        for (left, other) in self.left.iter_mut().zip(&other.left) {
            let lower = other.filter(|other| other.height < left.map_or(0.0, |left| left.height));
            *left = lower.or(*left);
        }
        self
    }

    pub(super) fn untouched(&self) -> usize {
        self.left.iter().filter(|left| left.is_none()).count()
    }

    pub(super) fn points(&self) -> usize {
        self.left.len()
    }

    pub(super) fn result(&self, target: &Target<'_, '_>) -> HeightMap {
        let most = self.highest();
        let least = self.deepest().map(|(left, _)| left);
        HeightMap {
            rows: self.counts[0],
            columns: self.counts[1],
            left: most.zip(least).map(|ends| [ends.0, ends.1].map(|end| left_at(target, end))),
            untouched: self.untouched(),
            points: self.left.len(),
            heights_um: self.left.iter().map(|left| left.map(|left| 1e3 * left.height)).collect(),
        }
    }

    /// That the cutter does not pass everywhere.
    pub(super) fn missing(&self, target: &Target<'_, '_>) -> Option<NotDone> {
        let (untouched, all) = (self.untouched(), self.left.len());
        let message = format!(
            "what is left is unknown at {untouched} of {all} points of {}: no pass goes over them",
            target.name()
        );
        let way = "set passes closer together, or take a cutter with a longer cutting arc".to_string();
        (untouched > 0).then(|| NotDone::new(NotDoneKind::HeightUnknown, target.name(), message).with(vec![way]))
    }

    /// That a pass cuts too deep with another part of the cutter than that which touches.
    pub(super) fn too_deep(&self, target: &Target<'_, '_>) -> Option<NotDone> {
        let (deepest, way) = self.deepest().filter(|(left, _)| left.height < -DEEP)?;
        let message = format!(
            "{} cuts {:.4} mm into {} at {}",
            target.milling.cutter_name,
            -deepest.height,
            target.name(),
            target.place(deepest.shares)
        );
        let why = format!("pass {} does, away from where the cutter touches", way + 1);
        let way = "lean the cutter otherwise with `lead` or `tilt`, or take a smaller or shorter one".to_string();
        Some(NotDone::new(NotDoneKind::TooDeep, target.name(), message).with(vec![why, way]))
    }

    fn values(&self, of: impl Fn(&LeftOver) -> f64) -> Values {
        Values::Scalars(self.left.iter().map(|left| left.as_ref().map(&of)).collect())
    }

    fn height(&self, name: &str, by: &str) -> Field {
        Field {
            name: name.to_string(),
            unit: "um".to_string(),
            meaning: format!(
                "height of what {by} leaves over the surface beside the stock, along its normal; plus is material"
            ),
            values: self.values(|left| 1e3 * left.height),
        }
    }

    /// The points with what is left there; `read` is what a program that was read back leaves at the same points.
    pub(super) fn dataset(
        &self,
        job: &Job<'_>,
        target: &Target<'_, '_>,
        header: Header,
        read: Option<&LeftMap>,
    ) -> Dataset {
        let milling = target.milling;
        let points = target.points(&middles(self.counts));
        let labels = target.labels();
        let axes = [0, 1].map(|k| Axis { label: labels[k].clone(), count: self.counts[k] });
        let patch = solve::patch(job, target.name(), target.surface(), axes, &points);
        let mut fields = vec![
            self.height("left", &format!("{} in {}", milling.cutter_name, milling.name)),
            Field {
                name: "left_by_pass".to_string(),
                unit: "1".to_string(),
                meaning: "the pass that leaves it".to_string(),
                values: self.values(|left| (left.way + 1) as f64),
            },
        ];
        fields.extend(read.map(|read| read.height("left_by_program", "the program that was read back")));
        Dataset { header, patches: vec![Patch { fields, ..patch }] }
    }
}
