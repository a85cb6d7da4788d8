//! How the height of a side over a point changes with its pose, to the second order.

use nalgebra::Vector3;

use crate::milling::height::NormalLine;
use crate::milling::outline::StraightSide;

/// Slopes of a height in so many directions, and how these change with each of them.
pub(super) type Bent<const N: usize> = ([f64; N], [[f64; N]; N]);

/// A side in a pose, seen from a point of a surface.
struct Seen {
    /// Point and axis, from the origin of the cutter.
    y: Vector3<f64>,
    axis: Vector3<f64>,
    z: f64,
    /// From the axis.
    rho: f64,
    sine: f64,
    cosine: f64,
}

/// A change of point and axis as the cutter sees them.
type Moved = [Vector3<f64>; 2];

impl Seen {
    /// How z changes, and half the square of the distance from the axis.
    fn slope(&self, [y, axis]: &Moved) -> [f64; 2] {
        let z = y.dot(&self.axis) + self.y.dot(axis);
        [z, self.y.dot(y) - self.z * z]
    }

    /// How the distance from the side changes.
    fn distance(&self, moved: &Moved) -> f64 {
        let [z, half] = self.slope(moved);
        self.cosine * half / self.rho - self.sine * z
    }

    /// How that changes with another change.
    fn bend(&self, one: &Moved, other: &Moved) -> f64 {
        let [[z1, half1], [z2, half2]] = [self.slope(one), self.slope(other)];
        let z = one[0].dot(&other[1]) + other[0].dot(&one[1]);
        let half = one[0].dot(&other[0]) - z1 * z2 - self.z * z;
        self.cosine * (half - half1 * half2 / (self.rho * self.rho)) / self.rho - self.sine * z
    }
}

fn part(row: &[f64; 6], from: usize) -> Vector3<f64> {
    Vector3::new(row[from], row[from + 1], row[from + 2])
}

/// Of the height at which a side is met on a line, from how its pose changes in directions, and how those changes change.
pub(super) fn bent<const N: usize>(
    side: &StraightSide,
    (pose, line, height): (&[f64; 6], &NormalLine, f64),
    slopes: &[[f64; 6]; N],
    bends: &[[[f64; 6]; N]; N],
) -> Bent<N> {
    let normal = part(line, 3);
    let (y, axis) = (part(line, 0) + normal * height - part(pose, 0), part(pose, 3));
    let z = y.dot(&axis);
    let rho = (y.norm_squared() - z * z).max(0.0).sqrt();
    let (sine, cosine) = side.half_angle.sin_cos();
    let seen = Seen { y, axis, z, rho, sine, cosine };
    let changed = |row: &[f64; 6]| [-part(row, 0), part(row, 3)];
    let by_height = seen.distance(&[normal, Vector3::zeros()]);
    let first = slopes.map(|row| -seen.distance(&changed(&row)) / by_height);
    // the point stays on the side
    let moved: Vec<Moved> = slopes
        .iter()
        .zip(first)
        .map(|(row, rises)| {
            let [y, axis] = changed(row);
            [y + normal * rises, axis]
        })
        .collect();
    let second = |i: usize, j: usize| -> f64 {
        let bend = seen.bend(&moved[i], &moved[j]) + seen.distance(&changed(&bends[i][j]));
        -bend / by_height
    };
    (first, std::array::from_fn(|i| std::array::from_fn(|j| second(i, j))))
}
