//! Shape functions of bricks with eight and twenty nodes.

use crate::solid::bricks::BrickOrder;
use crate::solid::mass::gauss_legendre;

/// Corners and middles of edges from −1 to 1, in the order of C3D20.
pub(crate) const NODES: [[i8; 3]; 20] = [
    [-1, -1, -1],
    [1, -1, -1],
    [1, 1, -1],
    [-1, 1, -1],
    [-1, -1, 1],
    [1, -1, 1],
    [1, 1, 1],
    [-1, 1, 1],
    [0, -1, -1],
    [1, 0, -1],
    [0, 1, -1],
    [-1, 0, -1],
    [0, -1, 1],
    [1, 0, 1],
    [0, 1, 1],
    [-1, 0, 1],
    [-1, -1, 0],
    [1, -1, 0],
    [1, 1, 0],
    [-1, 1, 0],
];

/// The nodes of each face, S1 to S6 of C3D8 and C3D20: corners, then the middles of its edges.
pub(crate) const FACES: [[usize; 8]; 6] = [
    [0, 1, 2, 3, 8, 9, 10, 11],
    [4, 7, 6, 5, 15, 14, 13, 12],
    [0, 4, 5, 1, 16, 12, 17, 8],
    [1, 5, 6, 2, 17, 13, 18, 9],
    [2, 6, 7, 3, 18, 14, 19, 10],
    [3, 7, 4, 0, 19, 15, 16, 11],
];

/// The derivatives of all shape functions at a point of a brick, and the weight of the point.
pub(crate) struct GaussPoint {
    pub(crate) slopes: Vec<[f64; 3]>,
    pub(crate) weight: f64,
}

/// Three Gauss points in each direction; with these the volume is exact.
pub(crate) fn gauss_points(order: BrickOrder) -> Vec<GaussPoint> {
    let line: Vec<(f64, f64)> =
        gauss_legendre(3).into_iter().map(|(share, weight)| (2.0 * share - 1.0, 2.0 * weight)).collect();
    let mut points = Vec::new();
    for (x, by_x) in &line {
        for (y, by_y) in &line {
            for (z, by_z) in &line {
                points.push(GaussPoint { slopes: slopes(order, [*x, *y, *z]), weight: by_x * by_y * by_z });
            }
        }
    }
    points
}

/// The derivatives of the position at a point.
pub(crate) fn frame(slopes: &[[f64; 3]], nodes: &[[f64; 3]]) -> [[f64; 3]; 3] {
    let mut by = [[0.0; 3]; 3];
    for (slope, node) in slopes.iter().zip(nodes) {
        for (row, slope) in by.iter_mut().zip(slope) {
            (0..3).for_each(|k| row[k] += slope * node[k]);
        }
    }
    by
}

/// Their determinant.
pub(crate) fn jacobian(slopes: &[[f64; 3]], nodes: &[[f64; 3]]) -> f64 {
    let [a, b, c] = frame(slopes, nodes);
    a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/// The derivatives of all shape functions at a point.
pub(crate) fn slopes(order: BrickOrder, at: [f64; 3]) -> Vec<[f64; 3]> {
    NODES[..order.nodes()].iter().map(|node| slope(order, node.map(f64::from), at)).collect()
}

/// The derivatives of the shape function of a node.
fn slope(order: BrickOrder, node: [f64; 3], at: [f64; 3]) -> [f64; 3] {
    // a factor of each direction, and its derivative
    let factor = |k: usize| match node[k] {
        0.0 => (1.0 - at[k] * at[k], -2.0 * at[k]),
        end => (1.0 + end * at[k], end),
    };
    let factors = [factor(0), factor(1), factor(2)];
    let product = |k: usize| (0..3).map(|j| if j == k { factors[j].1 } else { factors[j].0 }).product::<f64>();
    let slopes = [product(0), product(1), product(2)];
    let is_corner = node.iter().all(|x| *x != 0.0);
    match (order, is_corner) {
        (BrickOrder::First, _) => slopes.map(|slope| slope / 8.0),
        (BrickOrder::Second, false) => slopes.map(|slope| slope / 4.0),
        (BrickOrder::Second, true) => {
            let whole: f64 = factors.iter().map(|(value, _)| value).product();
            let sum: f64 = (0..3).map(|k| node[k] * at[k]).sum::<f64>() - 2.0;
            [0, 1, 2].map(|k| (slopes[k] * sum + whole * node[k]) / 8.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The corners next to each corner, in the order of a right-handed frame.
    const BESIDE: [[usize; 3]; 8] =
        [[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]];

    /// Shape functions of either order give back any polynomial that they hold: here the determinant of a map with quadratic terms.
    #[test]
    fn the_jacobian_is_that_of_the_map() {
        let map = |[x, y, z]: [f64; 3]| [2.0 * x + 0.3 * y * z, y + 0.2 * x * z, 3.0 * z + 0.1 * x * y];
        let curved = |[x, y, z]: [f64; 3]| [2.0 * x + 0.3 * y * y, y + 0.2 * x * z, 3.0 * z + 0.1 * x * x];
        let at = [0.3, -0.4, 0.6];
        let nodes = |order: BrickOrder, map: &dyn Fn([f64; 3]) -> [f64; 3]| -> Vec<[f64; 3]> {
            NODES[..order.nodes()].iter().map(|node| map(node.map(f64::from))).collect()
        };
        for (order, map) in [(BrickOrder::First, &map as &dyn Fn([f64; 3]) -> [f64; 3]), (BrickOrder::Second, &curved)]
        {
            let step = 1e-5;
            let by = [0, 1, 2].map(|k| {
                let moved = |by: f64| {
                    let mut to = at;
                    to[k] += by;
                    map(to)
                };
                let (a, b) = (moved(step), moved(-step));
                [0, 1, 2].map(|j| (a[j] - b[j]) / (2.0 * step))
            });
            let exact = nalgebra::Matrix3::from_fn(|i, j| by[i][j]).determinant();
            let found = jacobian(&slopes(order, at), &nodes(order, map));
            assert!((found - exact).abs() < 1e-9, "{order:?}: {found} {exact}");
        }
    }

    #[test]
    fn faces_and_corners_turn_the_right_way() {
        let point = |node: usize| nalgebra::Vector3::from(NODES[node].map(f64::from));
        for face in FACES {
            let [a, b, c] = [0, 1, 2].map(|k| point(face[k]));
            let centre = 0.25 * (0..4).map(|k| point(face[k])).sum::<nalgebra::Vector3<f64>>();
            // Abaqus counts the corners of a face so that its normal points into the brick
            assert!((b - a).cross(&(c - b)).dot(&centre) < 0.0, "{face:?}");
            for k in 0..4 {
                let middle = 0.5 * (point(face[k]) + point(face[(k + 1) % 4]));
                assert_eq!(point(face[4 + k]), middle, "{face:?}");
            }
        }
        for (corner, beside) in BESIDE.iter().enumerate() {
            let [a, b, c] = beside.map(|other| point(other) - point(corner));
            assert!(a.cross(&b).dot(&c) > 0.0, "{corner}");
        }
    }
}
