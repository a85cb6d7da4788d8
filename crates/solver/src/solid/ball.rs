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
/// Shares across the lower flank about which a ball of a given size is looked for.
const STARTS: [f64; 5] = [0.5, 0.25, 0.75, 0.0625, 0.9375];
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
        let mut faults: Vec<(f64, BallFault)> = Vec::new();
        for share in STARTS {
            let (start, _) = self.beside_ball([share, 1.0 - share], Some(diameter));
            let Some(x) = self.touching(start, |x, _| x[6] - diameter) else { continue };
            let (gauge, centre) = self.gauge(&x, diameter);
            if faults.iter().any(|(rho, _)| (rho - gauge.centre_rho).abs() < TOUCHING) {
                continue;
            }
            match self.ball_fault(&gauge, centre) {
                None => return Ok(gauge),
                Some(fault) => faults.push((gauge.centre_rho, fault)),
            }
        }
        Err(faults.first().map_or(BallFault::NotTouching, |(_, fault)| *fault))
    }

    /// The ball, its centre half-way along, that touches both flanks at a distance from the axis, or one as much above it as the other below; it may
    /// lie in other surfaces. `None` where a flank does not reach there, or the space is no wider towards the tip.
    pub fn ball_touching(&self, depth: f64) -> Option<BallGauge> {
        let [low, high] = self.flanks();
        let (start, opens) = self.beside_ball([self.on_flank(low, depth)?, self.on_flank(high, depth)?], None);
        let mean = |_: &[f64], places: [Vector3<f64>; 2]| {
            places.map(|at| 0.5 * self.depth(self.arrangement.place(at.into()))).iter().sum::<f64>() - depth
        };
        let x = opens.then(|| self.touching(start, mean)).flatten()?;
        (x[6] > 0.0).then(|| self.gauge(&x, x[6]).0)
    }

    /// Why a ball that touches both flanks measures nothing.
    fn ball_fault(&self, gauge: &BallGauge, centre: Vector3<f64>) -> Option<BallFault> {
        let diameter = gauge.diameter;
        if gauge.over_balls - self.gauge_side() * diameter <= diameter {
            return Some(BallFault::InEachOther);
        }
        let pitch = self.pitch();
        let beside = [0.0, pitch, -pitch].map(|by| Vector3::from(self.arrangement.moved(centre.into(), by)));
        let room = |chart: &Chart| beside.iter().map(|centre| distance(chart, centre)).fold(f64::INFINITY, f64::min);
        let rooms = self.charts().iter().map(room).enumerate();
        let (chart, least) = rooms.min_by(|a, b| a.1.total_cmp(&b.1)).expect("a space has charts");
        (least < 0.5 * diameter - TOUCHING).then(|| {
            let chart = if self.is_reversed { self.charts().len() - 1 - chart } else { chart };
            BallFault::Inside { chart, by: 0.5 * diameter - least }
        })
    }

    /// What a ball adds to the distance between two: 1 over them, -1 between them.
    fn gauge_side(&self) -> f64 {
        if self.is_external() { 1.0 } else { -1.0 }
    }

    /// Where Newton's method begins with a ball that touches the flanks about these shares across them: shares of both places, the centre's x and y,
    /// and the diameter, which is the width of the space by the cosine of half the angle between the flanks where none is given. Also whether the
    /// space is wider there towards the tip.
    fn beside_ball(&self, [on_low, on_high]: [f64; 2], diameter: Option<f64>) -> (Vec<f64>, bool) {
        let [low, high] = self.flanks();
        let way = self.across_space([Some((low, on_low, 0.0)), Some((high, on_high, 0.0))]);
        let shift = way.map_or(0.0, |way| way.shift);
        let shares = [on_low, 0.5 + shift, on_high, 0.5 - shift];
        let (p, n) = touched(&self.charts()[low], [shares[0], shares[1]]);
        let (q, m) = touched(&self.charts()[high], [shares[2], shares[3]]);
        let across = q - p;
        let cosine = 0.5 * (n - m).dot(&across) / across.norm();
        let diameter = diameter.unwrap_or(across.norm() / cosine);
        let centre = 0.5 * (p + q + 0.5 * diameter * (n + m));
        ([&shares[..], &[centre.x, centre.y, diameter]].concat(), cosine > 0.0)
    }

    /// A ball, as [`Body::beside_ball`] has it, that touches both flanks and for which something else, of it and of where it touches, is zero.
    fn touching(&self, start: Vec<f64>, zero: impl Fn(&[f64], [Vector3<f64>; 2]) -> f64) -> Option<Vec<f64>> {
        if self.teeth() < 2 {
            return None;
        }
        let [low, high] = self.flanks().map(|k| &self.charts()[k]);
        let z = self.ball_z();
        let residual = |x: &[f64]| {
            let ((p, n), (q, m)) = (touched(low, [x[0], x[1]]), touched(high, [x[2], x[3]]));
            let centre = Vector3::new(x[4], x[5], z);
            let (a, b) = (p + 0.5 * x[6] * n - centre, q + 0.5 * x[6] * m - centre);
            vec![a.x, a.y, a.z, b.x, b.y, b.z, zero(x, [p, q])]
        };
        solved(residual, start)
    }

    /// Where the centre of a ball lies along the axis: half-way along.
    fn ball_z(&self) -> f64 {
        self.charts()[self.flanks()[0]].at([0.5; 2])[2]
    }

    /// What a ball measures that touches both flanks, and its centre.
    fn gauge(&self, x: &[f64], diameter: f64) -> (BallGauge, Vector3<f64>) {
        let [low, high] = self.flanks().map(|k| &self.charts()[k]);
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
        (gauge, Vector3::new(x[4], x[5], self.ball_z()))
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
