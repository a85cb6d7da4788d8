//! The motion of the cutter from one position to the next.

use flank_solver::PoseSeries;

use super::machine::{FreeAxes, Machine};
use super::plan::length;

/// Points through which the motion of one block is known.
const POINTS_OF_BLOCK: usize = 9;

/// What goes straight and evenly from position to position.
#[derive(Clone, Copy)]
pub(super) enum Straight<'p> {
    /// The tip, and the direction on a great circle: no axes are known.
    Cutter,
    /// All axes.
    Axes(&'p FreeAxes),
    /// The tip and the rotary axes: tool-centre control.
    Tip(&'p FreeAxes),
}

impl<'p> Straight<'p> {
    pub(super) fn of_machine(machine: Option<&'p Machine<'_, '_>>, tool_centre_control: bool) -> Straight<'p> {
        machine.map_or(Straight::Cutter, |machine| Straight::of_axes(&machine.axes, tool_centre_control))
    }

    pub(super) fn of_axes(axes: &'p FreeAxes, tool_centre_control: bool) -> Straight<'p> {
        if tool_centre_control { Straight::Tip(axes) } else { Straight::Axes(axes) }
    }

    /// The motions between positions on a pass.
    pub(super) fn blocks(self, path: &PoseSeries, along: &[f64]) -> Vec<PoseSeries> {
        let poses: Vec<[f64; 6]> = along.iter().map(|share| path.at(*share)).collect();
        let rows = self.axes().map_or_else(Vec::new, |axes| axes.along(&poses));
        (1..poses.len()).map(|k| self.block(&poses[k - 1..=k], rows.get(k - 1..=k).unwrap_or_default())).collect()
    }

    /// The motion from the first of two positions to the second: their poses, and their axes where these are known.
    pub(super) fn block(self, poses: &[[f64; 6]], rows: &[Vec<f64>]) -> PoseSeries {
        match self {
            Straight::Cutter => great_circle(poses[0], poses[1]),
            Straight::Axes(axes) => axes.straight(&rows[0], &rows[1]),
            Straight::Tip(axes) => axes.straight_tip(&rows[0], &rows[1]),
        }
    }

    /// How far the axis of the cutter is from the pole at the nearer end of a block, radians.
    pub(super) fn least_from_pole(self, path: &PoseSeries, ends: [f64; 2]) -> Option<f64> {
        let axes = self.axes()?;
        let [first, last] = ends.map(|share| axes.angle_from_pole(&path.at(share)));
        Some(first.min(last))
    }

    fn axes(self) -> Option<&'p FreeAxes> {
        match self {
            Straight::Cutter => None,
            Straight::Axes(axes) | Straight::Tip(axes) => Some(axes),
        }
    }
}

/// The origin goes straight, the axis along a great circle, both evenly.
fn great_circle(from: [f64; 6], to: [f64; 6]) -> PoseSeries {
    let [a, b] = [from, to].map(|row| [row[3], row[4], row[5]]);
    let dot: f64 = (0..3).map(|k| a[k] * b[k]).sum();
    let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let angle = length(cross).atan2(dot);
    let at = |share: f64| {
        // of no turn the limit
        let [u, w] = if angle < 1e-8 {
            [1.0 - share, share]
        } else {
            [((1.0 - share) * angle).sin() / angle.sin(), (share * angle).sin() / angle.sin()]
        };
        let place = |k: usize| from[k] + share * (to[k] - from[k]);
        let axis = |k: usize| u * a[k] + w * b[k];
        [place(0), place(1), place(2), axis(0), axis(1), axis(2)]
    };
    PoseSeries::sampled(POINTS_OF_BLOCK, at)
}
