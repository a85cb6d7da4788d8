//! A body of revolution as slices across its axis, one for each piece of its outline. Each is convex, so that the distance from it lies above
//! all of its tangents: what is known at one point bounds it at all others.

use crate::milling::outline::OutlinePiece;

/// What lies between a piece of an outline and the axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slice {
    low: [f64; 2],
    high: [f64; 2],
    /// Of an arc its centre and radius.
    arc: Option<([f64; 2], f64)>,
}

/// The distance of a point from a slice, and the direction from its nearest point: away from the axis, and along it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FromSlice {
    pub(crate) distance: f64,
    pub(crate) direction: [f64; 2],
}

impl Slice {
    /// `None` of a piece that goes down on its way outwards, or hangs over: what lies beside it is not convex.
    pub(crate) fn of_piece(piece: &OutlinePiece) -> Option<Slice> {
        match *piece {
            // an edge has its bottom
            OutlinePiece::Arc { center, radius: 0.0, .. } => Some(Slice { low: center, high: center, arc: None }),
            OutlinePiece::Arc { center, radius, between } => {
                let [low, high] =
                    between.map(|angle| [center[0] + radius * angle.sin(), center[1] - radius * angle.cos()]);
                (low[0] >= 0.0 && high[0] >= 0.0).then_some(Slice { low, high, arc: Some((center, radius)) })
            }
            OutlinePiece::Line { from, to } => {
                let (low, high) = if from[1] <= to[1] { (from, to) } else { (to, from) };
                let is_level = low[1] == high[1];
                let widest = if low[0] > high[0] { low } else { high };
                // the body lies on the left of the way: above a bottom and below a top
                let is_side = is_level || from[1] < to[1];
                let (low, high) = if is_level { (widest, widest) } else { (low, high) };
                is_side.then_some(Slice { low, high, arc: None })
            }
        }
    }

    /// The distance of a point (away from the axis, above the origin); zero within.
    pub(crate) fn from(&self, [rho, z]: [f64; 2]) -> FromSlice {
        let foot = self.nearest([rho, z]);
        let [out, up] = [rho - foot[0], z - foot[1]];
        let distance = out.hypot(up);
        FromSlice { distance, direction: if distance > 0.0 { [out / distance, up / distance] } else { [0.0; 2] } }
    }

    /// How far from the axis it reaches at a height.
    fn width(&self, z: f64) -> f64 {
        let [low, high] = [self.low, self.high];
        match self.arc {
            Some((center, radius)) => center[0] + (radius * radius - (z - center[1]).powi(2)).max(0.0).sqrt(),
            None if low[1] == high[1] => low[0],
            None => low[0] + (z - low[1]) / (high[1] - low[1]) * (high[0] - low[0]),
        }
    }

    /// The nearest of its points.
    fn nearest(&self, [rho, z]: [f64; 2]) -> [f64; 2] {
        let [low, high] = [self.low, self.high];
        if (low[1]..=high[1]).contains(&z) && rho <= self.width(z) {
            return [rho, z];
        }
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        let side = match self.arc {
            Some((center, radius)) => {
                let from_center = |end: [f64; 2]| [end[0] - center[0], end[1] - center[1]];
                let [out, up] = from_center([rho, z]);
                // the outline runs round the centre on its outer side
                let faces = cross(from_center(low), [out, up]) >= 0.0 && cross([out, up], from_center(high)) >= 0.0;
                let away = out.hypot(up);
                // from the centre itself no point of the arc is nearest
                (faces && away > 0.0).then(|| [center[0] + radius * out / away, center[1] + radius * up / away])
            }
            None => {
                let along = [high[0] - low[0], high[1] - low[1]];
                let from_low = [rho - low[0], z - low[1]];
                let square = along[0] * along[0] + along[1] * along[1];
                let share = (from_low[0] * along[0] + from_low[1] * along[1]) / square;
                let is_beside = (0.0..=1.0).contains(&share) && cross(from_low, along) > 0.0;
                is_beside.then(|| [low[0] + share * along[0], low[1] + share * along[1]])
            }
        };
        // beyond an end of the outline, its plane end is nearest, or the rim of that
        let squared = |foot: &[f64; 2]| (rho - foot[0]).powi(2) + (z - foot[1]).powi(2);
        let ends = [low, high].map(|end| [rho.min(end[0]), end[1]]);
        let all = ends.into_iter().chain(side);
        all.min_by(|a, b| squared(a).total_cmp(&squared(b))).expect("there are two ends")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The least distance from points of the outline and of both plane ends that are close to each other.
    fn scanned(piece: &OutlinePiece, [rho, z]: [f64; 2]) -> f64 {
        const COUNT: usize = 20_000;
        let at = |k: usize| {
            let share = k as f64 / COUNT as f64;
            match *piece {
                OutlinePiece::Line { from, to } => [0, 1].map(|i| from[i] + share * (to[i] - from[i])),
                OutlinePiece::Arc { center, radius, between: [a, b] } => {
                    let (s, c) = (a + share * (b - a)).sin_cos();
                    [center[0] + radius * s, center[1] - radius * c]
                }
            }
        };
        let plane = |end: [f64; 2]| (rho - rho.min(end[0])).hypot(z - end[1]);
        let outline = (0..=COUNT).map(|k| (rho - at(k)[0]).hypot(z - at(k)[1]));
        outline.chain([plane(at(0)), plane(at(COUNT))]).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn distances_and_directions_are_those_of_the_nearest_point() {
        let pieces = [
            OutlinePiece::Arc { center: [0.0, 2.0], radius: 2.0, between: [0.0, 1.5] },
            OutlinePiece::Arc { center: [3.0, 0.5], radius: 0.5, between: [0.0, std::f64::consts::FRAC_PI_2] },
            // a barrel
            OutlinePiece::Arc { center: [-40.0, 6.0], radius: 44.0, between: [1.5, 1.65] },
            OutlinePiece::Line { from: [2.0, 1.0], to: [3.0, 9.0] },
            OutlinePiece::Line { from: [3.0, 1.0], to: [2.0, 9.0] },
            OutlinePiece::Line { from: [0.0, 4.0], to: [3.0, 4.0] },
        ];
        for piece in &pieces {
            let slice = Slice::of_piece(piece).expect("it is convex");
            let mut outside = 0;
            for [rho, z] in (0..20).flat_map(|i| (0..20).map(move |j| [0.4 * f64::from(i), f64::from(j) - 5.0])) {
                let found = slice.from([rho, z]);
                if found.distance == 0.0 {
                    continue;
                }
                outside += 1;
                // points of the outline are half a thousandth apart at the most
                let scanned = scanned(piece, [rho, z]);
                assert!(
                    (found.distance - scanned).abs() < 1e-5 + 1e-6 / scanned,
                    "{piece:?} {rho} {z} {found:?} {scanned}"
                );
                // along the direction it changes by as much as the point moves
                let [out, up] = found.direction;
                let farther = slice.from([(rho + 1e-3 * out).abs(), z + 1e-3 * up]);
                assert!((farther.distance - found.distance - 1e-3).abs() < 1e-9, "{piece:?} {rho} {z}");
            }
            assert!(outside > 200, "{piece:?}");
        }
        assert!(Slice::of_piece(&OutlinePiece::Line { from: [2.0, 9.0], to: [8.0, 8.0] }).is_none());
    }
}
