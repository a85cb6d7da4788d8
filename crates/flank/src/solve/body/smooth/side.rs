//! Where a tooth or a space is cut off from the rest of its gear.
//!
//! The cut goes on inwards from a line along the space, so far on everywhere as that line is at the same share of the way along. Cuts of
//! neighbours fit each other.

use flank_export::{GearSide, spline_deviation};
use flank_solver::{Body, Chart, OutlineSegment};

use super::curve_off;

/// Rows and columns of a bent side that are tried.
const COUNTS: [usize; 5] = [9, 17, 33, 65, 129];
/// A line whose way differs by less lies in a plane.
const FLAT: f64 = 1e-9;
/// How far a side's surface goes beyond the rest of the outline, of the way to it.
const BEYOND: f64 = 0.05;
/// Halvings of a search along the space: as many as a number has binary digits.
const HALVINGS: usize = 60;

/// A line of a chart along the space, so far on, at which a part is cut off.
pub(super) struct Cut {
    pub(super) chart: Chart,
    pub(super) across: f64,
    pub(super) by: f64,
}

/// A cut as a surface: by how far along, and how far from its line to the rest of the outline.
struct Bent<'b> {
    body: &'b Body,
    cut: &'b Cut,
    /// Ends of the rest of the outline.
    corners: [[f64; 2]; 2],
    /// How far inwards the surface goes, of the way to the line between the corners.
    reach: f64,
}

/// A segment of the outline that a bent side does not reach: it lies beyond the ends of the spaces, as a shaft does that is longer than its teeth.
#[derive(Clone, Debug)]
pub(crate) struct BeyondEnds {
    pub(crate) segment: String,
    /// How far, mm.
    pub(crate) by: f64,
}

/// The sides of a part, and how far they are off at the most, mm.
///
/// # Errors
/// If the rest of the outline goes beyond the ends of a bent side.
pub(super) fn sides(body: &Body, cuts: &[Cut; 2], tolerance: f64) -> Result<([GearSide; 2], f64), BeyondEnds> {
    let [first, last] = [side(body, &cuts[0], tolerance)?, side(body, &cuts[1], tolerance)?];
    Ok(([first.0, last.0], first.1.max(last.1)))
}

fn side(body: &Body, cut: &Cut, tolerance: f64) -> Result<(GearSide, f64), BeyondEnds> {
    let ways = Chart::shares(cut.chart.counts()[1]).into_iter().map(|along| cut.place(body, along)[2]);
    let [low, high] = ways.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], way| [low.min(way), high.max(way)]);
    if high - low < FLAT {
        return Ok((GearSide::Flat, 0.0));
    }
    let bent = Bent::new(body, cut);
    let mut made = None;
    for count in COUNTS {
        let (points, counts) = (bent.lattice([count, count]), [count, count]);
        let mut off = spline_deviation(points.clone(), counts, &bent.lattice([2 * count - 1; 2]));
        let mut rest = Vec::new();
        for segment in body.blank().rest() {
            let line = bent.along(segment, count)?;
            off = off.max(curve_off(&line, &bent.along(segment, 2 * count - 1)?));
            rest.push(line);
        }
        made = Some((GearSide::Bent { points, counts, rest }, off));
        if off <= 0.5 * tolerance {
            break;
        }
    }
    Ok(made.expect("some counts are tried"))
}

impl Cut {
    /// Where it lies at a share of the way along: `[z, rho]`, and the way.
    fn place(&self, body: &Body, along: f64) -> [f64; 3] {
        let [z, rho, way] = body.arrangement().place(self.chart.at([self.across, along]));
        // from the middle on, so that it does not jump
        let middle = body.arrangement().place(self.chart.at([self.across, 0.5]))[2];
        let turns = if body.arrangement().is_closed() { ((middle - way) / std::f64::consts::TAU).round() } else { 0.0 };
        [z, rho, way + turns * std::f64::consts::TAU + self.by]
    }
}

impl<'b> Bent<'b> {
    fn new(body: &'b Body, cut: &'b Cut) -> Bent<'b> {
        let [begin, _, end] = body.blank().bounds();
        let mut bent = Bent { body, cut, corners: [begin.from, end.to], reach: 1.0 };
        let places = body.blank().rest().into_iter().flat_map(|segment| (0..9).map(|k| segment.at(f64::from(k) / 8.0)));
        let far = |place: [f64; 2]| {
            let (from, to) = bent.ends(bent.share(place).unwrap_or(0.5));
            let way = [to[0] - from[0], to[1] - from[1]];
            let off = [place[0] - from[0], place[1] - from[1]];
            (way[0] * off[0] + way[1] * off[1]) / (way[0] * way[0] + way[1] * way[1])
        };
        bent.reach = (1.0 + BEYOND) * places.map(far).fold(1.0, f64::max);
        bent
    }

    /// The line inwards at a share of the way along, from the cut's line to that between the corners.
    fn ends(&self, along: f64) -> ([f64; 2], [f64; 2]) {
        let [z, rho, _] = self.cut.place(self.body, along);
        let [a, b] = self.corners;
        ([z, rho], [0, 1].map(|k| (1.0 - along) * a[k] + along * b[k]))
    }

    fn lattice(&self, [rows, columns]: [usize; 2]) -> Vec<[f64; 3]> {
        let place = |i: usize, j: usize| {
            let along = j as f64 / (columns - 1) as f64;
            let (from, to) = self.ends(along);
            let share = self.reach * i as f64 / (rows - 1) as f64;
            let [z, rho] = [0, 1].map(|k| from[k] + share * (to[k] - from[k]));
            self.body.arrangement().position([z, rho, self.cut.place(self.body, along)[2]])
        };
        (0..rows).flat_map(|i| (0..columns).map(move |j| place(i, j))).collect()
    }

    /// On which line inwards a place `[z, rho]` lies; none beyond the first and the last.
    fn share(&self, place: [f64; 2]) -> Option<f64> {
        let aside = |along: f64| {
            let (from, to) = self.ends(along);
            (to[0] - from[0]) * (place[1] - from[1]) - (to[1] - from[1]) * (place[0] - from[0])
        };
        let (mut low, mut high) = (0.0, 1.0);
        let [a, b] = [aside(low), aside(high)];
        let size = |along: f64| {
            let (from, to) = self.ends(along);
            (to[0] - from[0]).hypot(to[1] - from[1])
        };
        // rounding at the ends
        if a.abs() <= 1e-9 * size(0.0) {
            return Some(0.0);
        }
        if b.abs() <= 1e-9 * size(1.0) {
            return Some(1.0);
        }
        if a * b > 0.0 {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if aside(middle) * a > 0.0 { low = middle } else { high = middle }
        }
        Some(0.5 * (low + high))
    }

    /// Points along a segment of the rest of the outline.
    fn along(&self, segment: &OutlineSegment, count: usize) -> Result<Vec<[f64; 3]>, BeyondEnds> {
        let point = |place: [f64; 2]| {
            let along = self.share(place).ok_or_else(|| self.beyond(segment))?;
            let [_, _, way] = self.cut.place(self.body, along);
            Ok(self.body.arrangement().position([place[0], place[1], way]))
        };
        (0..count).map(|k| point(segment.at(k as f64 / (count - 1) as f64))).collect()
    }

    /// How far a segment lies beyond the ends of the spaces.
    fn beyond(&self, segment: &OutlineSegment) -> BeyondEnds {
        let blank = self.body.blank();
        let by = [segment.from, segment.to].map(|place| blank.beyond_ends(place)).into_iter().fold(0.0, f64::max);
        BeyondEnds { segment: segment.name.clone(), by }
    }
}
