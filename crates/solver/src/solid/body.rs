//! A blank with equal tooth spaces, each bounded by charts that share their borders.

use std::f64::consts::TAU;

use crate::solid::blank::Blank;
use crate::solid::chart::Chart;

/// Rows of each chart, and columns, at which a body is looked at before it is one.
const LOOKS: usize = 9;
/// How far a space may reach beyond its blank, mm: rounding of solved points.
const ON_BLANK: f64 = 1e-6;

/// A body of revolution with tooth spaces about its z axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    pub(crate) blank: Blank,
    pub(crate) teeth: u32,
    pub(crate) charts: Vec<Chart>,
    /// Whether the charts run against the order that they were given in.
    pub(crate) is_reversed: bool,
}

/// Why charts bound no body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BodyFault {
    /// The flanks of a tooth meet before the tip.
    Pointed {
        /// How far they reach into each other at the tip, mm.
        overlap: f64,
        /// How far that is from begin to end of the spaces, as a share.
        share: f64,
    },
    /// Neighbouring spaces run into each other below the tip.
    Overlap {
        /// How far, mm.
        overlap: f64,
        /// The distance from the axis, mm.
        rho: f64,
    },
    /// A space goes through the blank.
    Through {
        /// The segment of the outline, as an index.
        segment: usize,
        /// How far beyond it, mm.
        by: f64,
    },
}

/// A point about the axis: along it, from it, and the angle, which does not jump.
pub(crate) type Polar = [f64; 3];

pub(crate) fn position([z, rho, angle]: Polar) -> [f64; 3] {
    [rho * angle.cos(), rho * angle.sin(), z]
}

impl Body {
    /// Of the charts of one space, from one flank to the other: across from the tip to the tip, along from the beginning of the
    /// spaces to their end. Neighbours have the same points in the rows that they share, but for rounding.
    ///
    /// # Errors
    /// If teeth are pointed below the tip, spaces overlap, or a space goes through the blank.
    pub fn new(blank: Blank, teeth: u32, mut charts: Vec<Chart>) -> Result<Body, BodyFault> {
        for k in 1..charts.len() {
            let border = charts[k - 1].row(charts[k - 1].counts()[0] - 1).to_vec();
            charts[k] = charts[k].clone().with_row(0, &border);
        }
        let body = Body { blank, teeth, charts, is_reversed: false };
        let shares = Body::looks();
        let middle = body.lines(&vec![shares.clone(); body.charts.len()], &[0.5]).remove(0);
        let turned = middle.last().map_or(0.0, |end| end[2]) - middle[0][2];
        let body = if turned >= 0.0 {
            body
        } else {
            let charts = body.charts.iter().rev().map(Chart::reversed).collect();
            Body { charts, is_reversed: true, ..body }
        };
        body.checked()
    }

    fn looks() -> Vec<f64> {
        (0..LOOKS).map(|k| k as f64 / (LOOKS - 1) as f64).collect()
    }

    fn checked(self) -> Result<Body, BodyFault> {
        let shares = Body::looks();
        let lines = self.lines(&vec![shares.clone(); self.charts.len()], &shares);
        for (line, share) in lines.iter().zip(&shares) {
            let last = line.len() - 1;
            for i in 0..line.len() / 2 {
                let (a, b) = (line[i], line[last - i]);
                // where the tooth stands between this space and the next one
                let width = (a[2] + self.pitch() - b[2]) * 0.5 * (a[1] + b[1]);
                if width <= 0.0 && i == 0 {
                    return Err(BodyFault::Pointed { overlap: -width, share: *share });
                }
                if width <= 0.0 {
                    return Err(BodyFault::Overlap { overlap: -width, rho: a[1].max(b[1]) });
                }
            }
            for place in line.iter().map(|[z, rho, _]| [*z, *rho]) {
                if let Some((segment, by)) = self.blank.outline.beyond(place).filter(|(_, by)| *by > ON_BLANK) {
                    return Err(BodyFault::Through { segment, by });
                }
            }
        }
        Ok(self)
    }

    /// The angle from a tooth to the next.
    pub fn pitch(&self) -> f64 {
        TAU / f64::from(self.teeth)
    }

    /// How many teeth.
    pub fn teeth(&self) -> u32 {
        self.teeth
    }

    /// The blank.
    pub fn blank(&self) -> &Blank {
        &self.blank
    }

    /// The charts of one space, in the order of the angle, and whether that is against the order that they were given in.
    pub fn charts(&self) -> (&[Chart], bool) {
        (&self.charts, self.is_reversed)
    }

    /// Lines across a space, from tip to tip, at shares of the way along: of each chart the points at shares across, the border of two
    /// once. The angle grows from the first point to the last, and does not jump from line to line.
    pub(crate) fn lines(&self, across: &[Vec<f64>], along: &[f64]) -> Vec<Vec<Polar>> {
        let lattices: Vec<(usize, Vec<[f64; 3]>)> = self
            .charts
            .iter()
            .zip(across)
            .enumerate()
            .map(|(k, (chart, shares))| {
                let first = usize::from(k > 0 && shares[0] == 0.0);
                (shares.len() - first, chart.lattice(&shares[first..], along))
            })
            .collect();
        let columns = along.len();
        let rows: usize = lattices.iter().map(|(rows, _)| rows).sum();
        let mut before: Option<f64> = None;
        let mut line = |j: usize| {
            let points: Vec<[f64; 3]> =
                lattices.iter().flat_map(|(rows, lattice)| (0..*rows).map(move |i| lattice[i * columns + j])).collect();
            let middle = rows / 2;
            let near =
                |angle: f64, reference: f64| reference + (angle - reference + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
            let angle = |point: [f64; 3]| point[1].atan2(point[0]);
            let start = angle(points[middle]);
            let start = before.map_or(start, |before| near(start, before));
            before = Some(start);
            let mut angles = vec![start; rows];
            for i in middle + 1..rows {
                angles[i] = near(angle(points[i]), angles[i - 1]);
            }
            for i in (0..middle).rev() {
                angles[i] = near(angle(points[i]), angles[i + 1]);
            }
            points
                .iter()
                .zip(angles)
                .map(|(point, angle)| [point[2], point[0].hypot(point[1]), angle])
                .collect::<Vec<Polar>>()
        };
        (0..columns).map(&mut line).collect()
    }
}
