//! What a pass leaves over points.

use crate::milling::height::{NormalLine, lowest};
use crate::milling::outline::{Cutter, meridian};
use crate::milling::series::PoseSeries;

/// Places of the way that are looked at before the lowest one is solved.
const LOOKED_AT: usize = 97;

/// Where on a way a cutter comes nearest to points, among places that are evenly spread.
pub(super) fn nearest_shares(way: &PoseSeries, cutter: &Cutter, points: &[NormalLine]) -> Vec<f64> {
    let shares: Vec<f64> = (0..LOOKED_AT).map(|k| k as f64 / (LOOKED_AT - 1) as f64).collect();
    let poses: Vec<[f64; 6]> = shares.iter().map(|share| way.at(*share)).collect();
    let nearest = |line: &NormalLine| {
        let gaps = poses.iter().map(|pose| cutter.gap(pose, [line[0], line[1], line[2]]));
        let least = gaps.zip(&shares).min_by(|a, b| a.0.total_cmp(&b.0));
        *least.expect("there are shares").1
    };
    points.iter().map(nearest).collect()
}

/// What a cutter leaves over points of a surface on its whole way, mm, and at which height above its origin and share it was lowest; `None`
/// where it does not pass.
pub fn left_on_way(way: &PoseSeries, cutter: &Cutter, points: &[NormalLine]) -> Vec<Option<LeftOnWay>> {
    let near = nearest_shares(way, cutter, points);
    let at = |(line, near): (&NormalLine, &f64)| {
        let found = lowest(way, cutter, line, *near)?;
        let place = [0, 1, 2].map(|k| line[k] + found.height * line[3 + k]);
        let [_, above] = meridian(&way.at(found.share), place);
        Some(LeftOnWay { height: found.height, share: found.share, above })
    };
    points.iter().zip(&near).map(at).collect()
}

/// What a way leaves over a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOnWay {
    /// mm along the normal.
    pub height: f64,
    /// Of the way, where the cutter is lowest.
    pub share: f64,
    /// How high above its origin the cutter passes there, mm.
    pub above: f64,
}
