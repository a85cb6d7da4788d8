//! How far the faces of bricks are off the charts that they lie on.

use nalgebra::Vector3;

use crate::solid::body::Body;
use crate::solid::bricks::{BrickOrder, Stations};
use crate::solid::chart::Chart;

/// Places of a face where it is held against its chart, from 0 to 1 both ways: the middle, where straight edges are off the most, and
/// those where parabolas are.
const TRIED: [[usize; 2]; 5] = [[2, 2], [1, 1], [3, 1], [1, 3], [3, 3]];

/// The largest distance of faces from their charts, along the normal, mm.
pub(crate) fn deviation(body: &Body, stations: &Stations, order: BrickOrder) -> f64 {
    let along = quartered(&stations.along, order);
    let of_chart = |(k, chart): (usize, &Chart)| {
        let across = quartered(&stations.across[k], order);
        let columns = along.len();
        let exact = chart.lattice(&across, &along);
        let at = |i: usize, j: usize| Vector3::from(exact[i * columns + j]);
        let mut most: f64 = 0.0;
        for i in (0..across.len() - 1).step_by(4) {
            for j in (0..columns - 1).step_by(4) {
                let node = |row: usize, column: usize| at(i + 2 * row, j + 2 * column);
                let normal = (node(2, 2) - node(0, 0)).cross(&(node(2, 0) - node(0, 2))).normalize();
                for [row, column] in TRIED {
                    let share = [row, column].map(|k| k as f64 / 2.0 - 1.0);
                    let off = at(i + row, j + column) - on_face(order, share, &node);
                    most = most.max(off.dot(&normal).abs());
                }
            }
        }
        most
    };
    body.spaces().iter().flat_map(|charts| charts.iter().enumerate()).map(of_chart).fold(0.0, f64::max)
}

/// Stations with three more between any two corners, at the quarters of what the shape functions make of the shares.
fn quartered(stations: &[f64], order: BrickOrder) -> Vec<f64> {
    let steps = order.steps();
    let quarter = |k: usize| {
        let (cell, at) = (k / 4 * steps, (k % 4) as f64 / 2.0 - 1.0);
        if k.is_multiple_of(4) {
            return stations[cell];
        }
        let (from, to) = (stations[cell], stations[cell + steps]);
        let middle = if order == BrickOrder::First { 0.5 * (from + to) } else { stations[cell + 1] };
        middle + 0.5 * at * (to - from) + at * at * (0.5 * (from + to) - middle)
    };
    (0..=(stations.len() - 1) / steps * 4).map(quarter).collect()
}

/// The point of a face with four or eight nodes, which `node` gives by row and column from 0 to 2.
fn on_face(order: BrickOrder, [x, y]: [f64; 2], node: &dyn Fn(usize, usize) -> Vector3<f64>) -> Vector3<f64> {
    let mut point = Vector3::zeros();
    for (row, column) in (0..3).flat_map(|row| (0..3).map(move |column| (row, column))) {
        let [a, b] = [row as f64 - 1.0, column as f64 - 1.0];
        let value = match (order, row == 1, column == 1) {
            (_, true, true) => 0.0,
            (BrickOrder::First, false, false) => 0.25 * (1.0 + a * x) * (1.0 + b * y),
            (BrickOrder::First, ..) => 0.0,
            (BrickOrder::Second, false, false) => 0.25 * (1.0 + a * x) * (1.0 + b * y) * (a * x + b * y - 1.0),
            (BrickOrder::Second, true, false) => 0.5 * (1.0 - x * x) * (1.0 + b * y),
            (BrickOrder::Second, false, true) => 0.5 * (1.0 + a * x) * (1.0 - y * y),
        };
        point += value * node(row, column);
    }
    point
}
