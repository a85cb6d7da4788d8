//! What `flank deviation` found.

use std::fmt;

use flank_export::fixed;
use schemars::JsonSchema;
use serde::Serialize;

use crate::project::answer::{Answer, Timing};
use crate::project::remark::{NotDone, Remark};

/// How far one surface, or measured points, lie off a surface of the same body, of `flank deviation`: um along the normal of the latter, plus is material.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.deviation/2")]
pub struct DeviationResult {
    /// Null where measured points are compared with `from`.
    pub surface: Option<String>,
    /// The job of that surface.
    #[serde(skip)]
    pub job: Option<String>,
    /// Of the surface.
    pub frame: Option<String>,
    /// The file of measured points.
    pub measured: Option<String>,
    /// The surface that it is compared with.
    pub from: String,
    /// The job of the surface that it is compared with.
    #[serde(skip)]
    pub from_job: String,
    /// Laid onto `frame`.
    pub from_frame: String,
    /// Points.
    pub asked: usize,
    /// Points at which the deviation is known.
    pub known: usize,
    /// About z: until both meet in the middle of the grid, or the measured points lie nearest; null where they do not meet, and of a rack.
    pub turn_deg: Option<f64>,
    /// Whether the turn, or the shift, was done.
    pub turned: bool,
    /// The same on the circle through the middle of the grid.
    pub turn_mm: Option<f64>,
    /// Of a rack, whose spaces lie beside each other, along y instead of the turn; null of all else.
    pub shift_mm: Option<f64>,
    /// The smallest; null where nothing is known.
    pub lowest_um: Option<f64>,
    /// The largest.
    pub highest_um: Option<f64>,
    /// Root of the mean square.
    pub rms_um: Option<f64>,
    /// In the middle of the grid.
    pub middle_um: Option<f64>,
    /// The point of the grid that stands for its middle: of a list, and of measured points where no row or no column goes through the mean point.
    /// Null where the middle is the mean point, halfway between the first and the last value of both coordinates.
    pub middle_at: Option<GridPlace>,
    /// Along the rows and the columns of the grid: the plane and the parabolas that fit best; null where they are not known.
    pub directions: [Option<EaseOffDirection>; 2],
    /// The twist that fits best.
    pub bias_um: Option<f64>,
    /// Files written, in their order.
    pub files: Vec<String>,
    /// What was asked for and not done, as stderr has it; the exit code is 3 unless it is empty.
    pub not_done: Vec<NotDone>,
    /// What is to be known beside it, as stderr has it.
    pub remarks: Vec<Remark>,
    #[serde(skip)]
    pub(super) timing: Timing,
    #[serde(skip)]
    pub(super) counts: [usize; 2],
    #[serde(skip)]
    pub(super) positions: Vec<[f64; 3]>,
    #[serde(skip)]
    pub(super) deviations: Vec<f64>,
}

/// A point of a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct GridPlace {
    /// From 1.
    pub row: usize,
    /// From 1.
    pub column: usize,
}

impl GridPlace {
    /// A row and a column that are counted from 0.
    pub(crate) fn of([row, column]: [usize; 2]) -> GridPlace {
        GridPlace { row: row + 1, column: column + 1 }
    }
}

/// The middle of a grid in words: the point that stands for it, where one does.
pub(super) fn middle(stand_in: Option<GridPlace>) -> String {
    stand_in.map_or("the middle".to_string(), |GridPlace { row, column }| format!("row {row}, column {column}"))
}

/// Ease-off in one direction of a grid.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct EaseOffDirection {
    /// `from -> to`.
    pub direction: String,
    /// Rise over the grid.
    pub slope_um: f64,
    /// The same as an angle; null where its length is not known.
    pub slope_arcmin: Option<f64>,
    /// Of the parabola that fits best.
    pub crowning_um: f64,
}

impl DeviationResult {
    /// How far the surface is moved in the middle of the grid: turned, or shifted, mm.
    pub(crate) fn moved_mm(&self) -> Option<f64> {
        self.turn_mm.or(self.shift_mm)
    }

    /// Rows and columns of the grid.
    pub fn counts(&self) -> [usize; 2] {
        self.counts
    }

    /// The points of the surface that it is compared with, in its frame, mm, row by row.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// The deviation at each of them, um; NaN where it is not known.
    pub fn deviations(&self) -> &[f64] {
        &self.deviations
    }

    /// What is compared with the other: the surface with its job, or the file.
    fn held(&self) -> String {
        match (&self.job, &self.surface, &self.frame) {
            (Some(job), Some(surface), Some(frame)) => format!("{job}.{surface} ({frame})"),
            _ => self.measured.clone().unwrap_or_default(),
        }
    }
}

impl Answer for DeviationResult {
    fn not_done(&self) -> &[NotDone] {
        &self.not_done
    }

    fn remarks(&self) -> &[Remark] {
        &self.remarks
    }

    fn timing(&self) -> Option<Timing> {
        Some(self.timing)
    }
}

impl fmt::Display for DeviationResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let um = |value: f64| fixed(value, 3);
        let DeviationResult { from, from_job, from_frame, asked, known, .. } = self;
        writeln!(
            f,
            "deviation of {} from {from_job}.{from} ({from_frame}), um along the normal of the latter, plus is material\n",
            self.held()
        )?;
        writeln!(f, "  points       {known} of {asked}")?;
        let done = if self.turned { "" } else { " (not done)" };
        if let Some(shift) = self.shift_mm {
            writeln!(f, "  shift along y {} mm{done}", fixed(shift, 6))?;
        }
        if let (Some(turn), Some(way)) = (self.turn_deg, self.turn_mm) {
            let [turn, way] = [turn, way].map(|value| fixed(value, 6));
            writeln!(f, "  turn about z {turn} deg, {way} mm on the circle through {}{done}", middle(self.middle_at))?;
        }
        if let (Some(low), Some(high), Some(rms)) = (self.lowest_um, self.highest_um, self.rms_um) {
            let at = if self.middle_at.is_some() { "at" } else { "in" };
            let off = |off: f64| format!(", {at} {} {}", middle(self.middle_at), um(off));
            let middle = self.middle_um.map_or(String::new(), off);
            writeln!(f, "  range        {} .. {} um, rms {}{middle}", um(low), um(high), um(rms))?;
        }
        for of in self.directions.iter().flatten() {
            let angle = of.slope_arcmin.map_or(String::new(), |angle| format!(" ({} arcmin)", um(angle)));
            let [slope, crowning] = [of.slope_um, of.crowning_um].map(um);
            writeln!(f, "  {:12} slope {slope} um{angle}, crowning {crowning} um", of.direction)?;
        }
        if let Some(bias) = self.bias_um {
            writeln!(f, "  bias         {} um", um(bias))?;
        }
        writeln!(f, "\nwrote {}", self.files.join(", "))
    }
}
