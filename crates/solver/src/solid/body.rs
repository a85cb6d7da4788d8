//! A blank with equal tooth spaces, each bounded by charts that share their borders.

use std::f64::consts::TAU;

use crate::solid::blank::Blank;
use crate::solid::chart::Chart;

/// Rows of each chart, and columns, at which a body is looked at before it is one.
const LOOKS: usize = 9;
/// Rows of a land's chart: enough for half a turn.
const LAND_ROWS: usize = 17;
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
    /// Whether the last chart of a space ends in the line where the first one of the next space begins: an edge, and no land.
    pub(crate) has_edge: bool,
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
        /// Whether they do all along the teeth.
        is_whole: bool,
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
    /// spaces to their end. Neighbours have the same points in the rows that they share, but for rounding. With `has_edge` the last row of the
    /// last chart is the first one of the first chart in the next space.
    ///
    /// # Errors
    /// If teeth are pointed below the tip, spaces overlap, or a space goes through the blank.
    pub fn new(blank: Blank, teeth: u32, mut charts: Vec<Chart>, has_edge: bool) -> Result<Body, BodyFault> {
        for k in 1..charts.len() {
            let border = charts[k - 1].row(charts[k - 1].counts()[0] - 1).to_vec();
            charts[k] = charts[k].clone().with_row(0, &border);
        }
        let mut body = Body { blank, teeth, charts, is_reversed: false, has_edge };
        let shares = Body::looks();
        let middle = body.lines(&vec![shares.clone(); body.charts.len()], &[0.5]).remove(0);
        let turned = middle.last().map_or(0.0, |end| end[2]) - middle[0][2];
        if turned < 0.0 {
            let charts = body.charts.iter().rev().map(Chart::reversed).collect();
            body = Body { charts, is_reversed: true, ..body };
        }
        if has_edge {
            let (sin, cos) = body.pitch().sin_cos();
            let next = body.charts[0].row(0).iter().map(|[x, y, z]| [cos * x - sin * y, sin * x + cos * y, *z]);
            let (next, last) = (next.collect::<Vec<_>>(), body.charts.len() - 1);
            let row = body.charts[last].counts()[0] - 1;
            body.charts[last] = body.charts[last].clone().with_row(row, &next);
        }
        body.checked()
    }

    fn looks() -> Vec<f64> {
        (0..LOOKS).map(|k| k as f64 / (LOOKS - 1) as f64).collect()
    }

    fn checked(self) -> Result<Body, BodyFault> {
        let shares = Body::looks();
        let lines = self.lines(&vec![shares.clone(); self.charts.len()], &shares);
        self.check_tips(&lines, &shares)?;
        for line in &lines {
            let last = line.len() - 1;
            for i in 1..line.len() / 2 {
                if let Some(overlap) =
                    Some(-self.tooth_width(line[i], line[last - i])).filter(|overlap| *overlap >= 0.0)
                {
                    return Err(BodyFault::Overlap { overlap, rho: line[i][1].max(line[last - i][1]) });
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

    fn check_tips(&self, lines: &[Vec<Polar>], shares: &[f64]) -> Result<(), BodyFault> {
        if self.has_edge {
            return Ok(());
        }
        let overlaps = lines.iter().map(|line| -self.tooth_width(line[0], line[line.len() - 1]));
        let overlaps: Vec<(f64, f64)> = overlaps.zip(shares.iter().copied()).collect();
        let is_whole = overlaps.iter().all(|(overlap, _)| *overlap >= 0.0);
        match overlaps.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((overlap, share)) if overlap >= 0.0 => Err(BodyFault::Pointed { overlap, share, is_whole }),
            _ => Ok(()),
        }
    }

    /// How wide the tooth is between a place on the lower side of a space and one on its upper side.
    fn tooth_width(&self, low: Polar, high: Polar) -> f64 {
        (low[2] + self.pitch() - high[2]) * 0.5 * (low[1] + high[1])
    }

    /// Whether teeth end in an edge, and not in a land of the blank.
    pub fn has_edge(&self) -> bool {
        self.has_edge
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

    /// The land of the tooth between a space and the next as a chart: across from the last row of one to the first row of the other, along as
    /// they are. Nothing where teeth end in an edge.
    pub fn land(&self) -> Option<Chart> {
        let columns = self.charts[0].counts()[1];
        let along = Chart::shares(columns);
        let lines = self.lines(&vec![vec![0.0, 0.5, 1.0]; self.charts.len()], &along);
        let place = |across: f64, j: usize| {
            let [z, rho] = self.blank.tip(along[j]);
            let (from, to) = (lines[j][lines[j].len() - 1][2], lines[j][0][2] + self.pitch());
            position([z, rho, (1.0 - across) * from + across * to])
        };
        let points = Chart::shares(LAND_ROWS).into_iter().flat_map(|across| (0..columns).map(move |j| (across, j)));
        let chart = Chart::through(points.map(|(across, j)| place(across, j)).collect(), [LAND_ROWS, columns]);
        let (sin, cos) = self.pitch().sin_cos();
        let next = |[x, y, z]: &[f64; 3]| [cos * x - sin * y, sin * x + cos * y, *z];
        let last = &self.charts[self.charts.len() - 1];
        let chart = chart.with_row(0, last.row(last.counts()[0] - 1));
        let next: Vec<[f64; 3]> = self.charts[0].row(0).iter().map(next).collect();
        (!self.has_edge).then(|| chart.with_row(LAND_ROWS - 1, &next))
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
