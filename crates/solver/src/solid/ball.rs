//! The dimension over balls in opposite spaces of a body.

use nalgebra::Vector3;

use crate::solid::body::Body;
use crate::solid::chart::Chart;
use crate::solid::gauge::{TOUCHES, rho, solved, touched};

/// Rows and columns of a chart from whose nearest point the foot of a ball's centre is looked for.
const ROWS: usize = 17;
const COLUMNS: usize = 65;
/// Halvings of the steps with which it is looked for.
const HALVINGS: usize = 30;
/// What a ball may have less than its radius to a surface, mm: what is left of the equations by which it touches flanks.
const TOUCHING: f64 = 10.0 * TOUCHES;

/// A ball in a space, touching both flanks in the middle of the teeth's length and nothing else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallGauge {
    /// mm
    pub diameter: f64,
    /// Of the ball's centre, from the axis, mm.
    pub centre_rho: f64,
    /// Over two balls in opposite spaces, or between them in an internal gear, mm.
    pub over_balls: f64,
    /// Where it touches, from the axis, mm.
    pub rho: [f64; 2],
    /// How far it stands out beyond the tip, where an anvil reaches it, mm.
    pub beyond_tip: f64,
}

/// Why balls of a size measure no body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BallFault {
    /// None touches both flanks within their ends, or there is no space opposite.
    NotTouching,
    /// Where it touches both flanks, it reaches into the steel beyond a surface.
    Inside {
        /// The surface's chart, in the order that charts were given in.
        chart: usize,
        /// How deep, mm.
        by: f64,
    },
    /// Those in opposite spaces lie in each other.
    InEachOther,
}

impl Body {
    /// A ball that touches both flanks, its centre half-way along.
    ///
    /// # Errors
    /// If none of the size does within their ends and stays clear of all else; of a single space, which has none opposite.
    pub fn ball(&self, diameter: f64) -> Result<BallGauge, BallFault> {
        let (gauge, centre) = self.touching_ball(diameter).ok_or(BallFault::NotTouching)?;
        if gauge.over_balls - self.gauge_side() * diameter <= diameter {
            return Err(BallFault::InEachOther);
        }
        let pitch = self.pitch();
        let beside = [0.0, pitch, -pitch].map(|by| Vector3::from(self.arrangement.moved(centre.into(), by)));
        let room = |chart: &Chart| beside.iter().map(|centre| distance(chart, centre)).fold(f64::INFINITY, f64::min);
        let rooms = self.charts().iter().map(room).enumerate();
        let (chart, least) = rooms.min_by(|a, b| a.1.total_cmp(&b.1)).expect("a space has charts");
        if least < 0.5 * diameter - TOUCHING {
            let chart = if self.is_reversed { self.charts().len() - 1 - chart } else { chart };
            return Err(BallFault::Inside { chart, by: 0.5 * diameter - least });
        }
        Ok(gauge)
    }

    /// What a ball adds to the distance between two: 1 over them, -1 between them.
    fn gauge_side(&self) -> f64 {
        if self.is_external() { 1.0 } else { -1.0 }
    }

    fn touching_ball(&self, diameter: f64) -> Option<(BallGauge, Vector3<f64>)> {
        if self.teeth() < 2 {
            return None;
        }
        let flanks = self.flanks();
        let shift = self.across_space(flanks.map(|k| Some((k, 0.5, 0.0)))).map_or(0.0, |way| way.shift);
        let [low, high] = flanks.map(|k| &self.charts()[k]);
        let z = low.at([0.5; 2])[2];
        let starts = [touched(low, [0.5, 0.5 + shift]), touched(high, [0.5, 0.5 - shift])];
        let start = 0.5 * (starts[0].0 + starts[1].0 + 0.5 * diameter * (starts[0].1 + starts[1].1));
        let residual = |x: &[f64]| {
            let centre = Vector3::new(x[4], x[5], z);
            let off = |chart: &Chart, shares: [f64; 2]| {
                let (p, n) = touched(chart, shares);
                p + 0.5 * diameter * n - centre
            };
            let (a, b) = (off(low, [x[0], x[1]]), off(high, [x[2], x[3]]));
            vec![a.x, a.y, a.z, b.x, b.y, b.z]
        };
        let x = solved(residual, vec![0.5, 0.5 + shift, 0.5, 0.5 - shift, start.x, start.y])?;
        let centre_rho = x[4].hypot(x[5]);
        // of an odd number of spaces none is opposite another
        let across = if self.teeth().is_multiple_of(2) { 1.0 } else { (0.25 * self.pitch()).cos() };
        let gauge = BallGauge {
            diameter,
            centre_rho,
            over_balls: 2.0 * centre_rho * across + self.gauge_side() * diameter,
            rho: [rho(low.at([x[0], x[1]])), rho(high.at([x[2], x[3]]))],
            beyond_tip: self.gauge_side() * (centre_rho - self.tip()) + 0.5 * diameter,
        };
        Some((gauge, Vector3::new(x[4], x[5], z)))
    }
}

/// How far a chart is from a point, mm: from the nearest of its points on, in steps that are halved where none leads nearer.
fn distance(chart: &Chart, from: &Vector3<f64>) -> f64 {
    let even = |count: usize| (0..count).map(|k| k as f64 / (count - 1) as f64).collect::<Vec<f64>>();
    let (rows, columns) = (even(ROWS), even(COLUMNS));
    let away = |point: [f64; 3]| (Vector3::from(point) - from).norm();
    let points = chart.lattice(&rows, &columns).into_iter().map(away).enumerate();
    let (at, mut least) = points.min_by(|a, b| a.1.total_cmp(&b.1)).expect("a lattice has points");
    let mut shares = [rows[at / COLUMNS], columns[at % COLUMNS]];
    let mut steps = [rows[1], columns[1]];
    for _ in 0..HALVINGS {
        let beside = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]
            .map(|way| [0, 1].map(|k| (shares[k] + way[k] * steps[k]).clamp(0.0, 1.0)));
        let nearer = beside.map(|shares| (away(chart.at(shares)), shares));
        let (nearest, place) = nearer.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).expect("there are four");
        match nearest < least {
            true => (least, shares) = (nearest, place),
            false => steps = steps.map(|step| 0.5 * step),
        }
    }
    least
}
