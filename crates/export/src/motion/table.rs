//! The positions of a machine's axes over a motion.

use crate::files::error::Malformed;
use crate::points::dataset::{Header, Unit, Unknown};
use crate::text::number::{degrees, plain, push_fixed};
use crate::text::one_line;

/// How positions of files of data are to be read.
pub(crate) const AS_IN_THE_SPEC: &str = "axes are named, signed and counted as in the machine's spec";

/// What each axis of a machine does while a motion runs. Inside all angles are radians; files have degrees.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionTable {
    /// Where it comes from.
    pub header: Header,
    /// What runs, such as the angle of a cradle.
    pub motion: Unknown,
    /// The axes, in the order of columns and words.
    pub axes: Vec<MachineAxis>,
    /// The positions, in the order in which they are passed.
    pub rows: Vec<MotionRow>,
    /// The axes as polynomials of the motion, where these are known.
    pub series: Option<Series>,
    /// How fast the axes move, if a cutting time is known.
    pub rates: Option<Rates>,
}

/// What the axes do per second, its square and its cube.
#[derive(Debug, Clone, PartialEq)]
pub struct Rates {
    /// From the first row to the last one.
    pub seconds: f64,
    /// For each row and axis velocity, acceleration and jerk, in mm or radians.
    pub rows: Vec<Vec<[f64; 3]>>,
}

/// An axis of a machine as its spec describes it.
#[derive(Debug, Clone, PartialEq)]
pub struct MachineAxis {
    /// Its name in the spec.
    pub name: String,
    /// How NC programs call it, such as `X` or `B1`.
    pub address: String,
    /// Whether NC programs count it the other way.
    pub reversed: bool,
    /// What NC programs say where it stands at zero, mm or radians.
    pub offset: f64,
    /// Whether its positions are angles, else lengths.
    pub is_rotary: bool,
    /// Decimals of its positions in NC programs, in mm or degrees.
    pub decimals: u8,
    /// Lowest and highest position that it can take, mm or radians.
    pub travel: Option<[f64; 2]>,
}

/// One position of all axes.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionRow {
    /// The value of the motion: mm, radians or a plain number.
    pub motion: f64,
    /// The position of each axis, mm or radians; angles go on beyond a turn.
    pub axes: Vec<f64>,
}

/// The axes as power series about a reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// The value of the motion about which they are.
    pub reference: f64,
    /// One for each axis, in the order of the axes.
    pub axes: Vec<AxisSeries>,
}

/// The polynomial of one axis.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisSeries {
    /// Factors of the powers of the distance from the reference, constant first: mm or radians by the unit of the motion.
    pub coefficients: Vec<f64>,
    /// A bound of what the polynomial leaves over the rows' range, mm or radians, where one is proven.
    pub remainder: Option<f64>,
}

impl MachineAxis {
    /// What its positions are written in.
    #[must_use]
    pub fn unit(&self) -> Unit {
        if self.is_rotary { Unit::Degree } else { Unit::Millimetre }
    }

    /// Two positions as NC programs have them, the lower one first.
    pub(crate) fn programmed_ends(&self, ends: [f64; 2]) -> [f64; 2] {
        let [a, b] = ends.map(|end| self.programmed(end));
        [a.min(b), a.max(b)]
    }

    /// Two positions as files of data have them, by their shortest text.
    pub(crate) fn written(&self, ends: [f64; 2]) -> [f64; 2] {
        ends.map(|end| plain(if self.is_rotary { degrees(end) } else { end }))
    }

    /// As the control counts it, mm or radians.
    pub(crate) fn programmed(&self, position: f64) -> f64 {
        if self.reversed { self.offset - position } else { self.offset + position }
    }

    /// A position as NC programs write it: as the control counts, with the axis's decimals, without a negative zero. Returns what stands there.
    pub(crate) fn print(&self, position: f64, text: &mut String) -> f64 {
        let programmed = self.unit().written(self.programmed(position));
        push_fixed(programmed, usize::from(self.decimals), text)
    }

    /// The same alone.
    pub(crate) fn printed(&self, position: f64) -> String {
        let mut text = String::new();
        self.print(position, &mut text);
        text
    }

    /// Between which numbers of NC programs it stays; infinite without a travel.
    pub(crate) fn printed_travel(&self) -> [f64; 2] {
        self.travel.map_or([f64::NEG_INFINITY, f64::INFINITY], |travel| self.written(self.programmed_ends(travel)))
    }
}

impl MotionTable {
    /// Whether every row and the series have one finite number for each axis. The writers refuse what fails.
    ///
    /// # Errors
    /// The first fault, by row.
    pub fn check(&self) -> Result<(), Malformed> {
        let named = self.axes.len();
        let mut counts = self.rows.iter().map(|row| row.axes.len()).enumerate();
        if let Some((row, given)) = counts.find(|(_, given)| *given != named) {
            return Err(Malformed::AxisCount { row, given, named });
        }
        if let Some(given) = self.series.as_ref().map(|series| series.axes.len()).filter(|given| *given != named) {
            return Err(Malformed::SeriesCount { given, named });
        }
        let rates = self.rates.iter().flat_map(|rates| rates.rows.iter().map(Vec::len)).enumerate();
        if let Some((row, given)) = rates.clone().find(|(_, given)| *given != named) {
            return Err(Malformed::AxisCount { row, given, named });
        }
        let mut of_rates =
            self.rates.iter().flat_map(|rates| rates.rows.iter().flatten().flatten().chain([&rates.seconds]));
        if self.rates.is_some() && rates.count() != self.rows.len() || !of_rates.all(|number| number.is_finite()) {
            return Err(Malformed::RateNumber);
        }
        let is_finite = |row: &MotionRow| row.axes.iter().chain([&row.motion]).all(|number| number.is_finite());
        if let Some(row) = self.rows.iter().position(|row| !is_finite(row)) {
            return Err(Malformed::MotionNumber { row });
        }
        let of_series = self.series.iter().flat_map(|series| {
            let of_axes = series.axes.iter().flat_map(|axis| axis.coefficients.iter().chain(&axis.remainder));
            of_axes.chain([&series.reference])
        });
        let travels = self.axes.iter().flat_map(|axis| axis.travel.iter().flatten().chain([&axis.offset]));
        if of_series.chain(travels).all(|number| number.is_finite()) { Ok(()) } else { Err(Malformed::AxisNumber) }
    }

    /// The lowest and the highest position of an axis, mm or radians; nothing without rows.
    pub(crate) fn extent(&self, axis: usize) -> Option<[f64; 2]> {
        let positions = self.rows.iter().map(|row| row.axes[axis]);
        Some([positions.clone().reduce(f64::min)?, positions.reduce(f64::max)?])
    }

    /// The polynomials in the units of files: powers of the distance as it is written give positions as they are written.
    pub(crate) fn written_series(&self) -> Option<Series> {
        let series = self.series.as_ref()?;
        let step = self.motion.unit.written(1.0);
        let axis = |(axis, own): (&MachineAxis, &AxisSeries)| AxisSeries {
            coefficients: (0..).zip(&own.coefficients).map(|(k, c)| axis.unit().written(*c) / step.powi(k)).collect(),
            remainder: own.remainder.map(|bound| axis.unit().written(bound)),
        };
        Some(Series {
            reference: self.motion.unit.written(series.reference),
            axes: self.axes.iter().zip(&series.axes).map(axis).collect(),
        })
    }

    /// The rates at a row in the units of files; nothing without rates.
    pub(crate) fn written_rates(&self, row: usize) -> Option<Vec<[f64; 3]>> {
        let rates = &self.rates.as_ref()?.rows[row];
        let written = |(axis, rates): (&MachineAxis, &[f64; 3])| rates.map(|rate| plain(axis.unit().written(rate)));
        Some(self.axes.iter().zip(rates).map(written).collect())
    }

    /// What a reader must know to use the numbers, beginning with how they are `counted`, then the caller's own sentences.
    pub(crate) fn sentences(&self, counted: &str) -> Vec<String> {
        let fixed = ["lengths in mm, angles in degrees, not reduced to one turn", counted];
        let own = self.header.conventions.iter().map(|sentence| one_line(sentence));
        fixed.iter().map(|&sentence| sentence.to_owned()).chain(own).collect()
    }
}
