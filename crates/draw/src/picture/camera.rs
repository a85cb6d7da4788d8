//! Where the eye stands, and how space falls onto the sheet. No perspective: lengths across the view are true.

use super::paint::{Place, Rect};
use flank_export::shape::Node;
use flank_export::vector::{Vector, across, add, cross, dot, length, scale, sub, unit};

const Z: Vector = [0.0, 0.0, 1.0];

/// How far z may rise, radians, the preferred angle first: a slight slope reads as space, a flank that lies askew is
/// brought to rest.
const ROLLS: [f64; 9] = [0.1, 0.0, 0.2, -0.1, 0.3, -0.2, 0.4, -0.3, 0.5];

/// Three directions of the sheet in space: an orthonormal, right-handed frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Camera {
    pub(super) right: Vector,
    pub(super) up: Vector,
    /// From the things seen to the eye.
    pub(super) towards: Vector,
}

/// A camera with a scale and a place on the sheet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct View {
    pub(super) camera: Camera,
    /// The point of space, mm, that falls onto `middle`.
    pub(super) centre: Vector,
    /// Sheet units per mm.
    pub(super) scale: f64,
    pub(super) middle: Place,
}

impl Camera {
    /// A camera that sees these nodes from the side their normals point to, a little from aside, with z to the right or
    /// upwards, whichever fills a sheet of this width and height better.
    pub(super) fn facing(nodes: &[Node], width: f64, height: f64) -> Self {
        let towards = eye_direction(nodes);
        let up_is_z = Camera::with_up(towards, across(Z, towards));
        let right_is_z = Camera { right: up_is_z.up, up: up_is_z.right.map(|x| -x), towards };
        let mut best = (0.0, right_is_z);
        for (camera, liking) in [(right_is_z, 1.0), (up_is_z, 0.87)] {
            for roll in ROLLS {
                let camera = camera.rolled(roll);
                let [wide, high] = camera.size_of(nodes.iter().map(|node| node.position));
                let merit = liking * (1.0 - 0.7 * (roll - ROLLS[0]).abs()) * (width / wide).min(height / high);
                if merit > best.0 {
                    best = (merit, camera);
                }
            }
        }
        best.1
    }

    /// Cameras that look down on the xy plane a little from aside, from minus y, then from plus y.
    pub(super) fn over() -> [Self; 4] {
        [[-0.24, -0.74], [0.24, -0.74], [0.24, 0.74], [-0.24, 0.74]].map(|[x, y]| {
            let towards = [x, y, 0.63];
            Camera::with_up(towards, across(Z, towards))
        })
    }

    /// A camera that sees x, y and z about equally long, z upwards.
    pub(super) fn isometric() -> Self {
        let towards = [0.62, -0.58, 0.53];
        Camera::with_up(towards, across(Z, towards))
    }

    /// A camera that looks from somewhere, with a direction upwards.
    pub(super) fn looking(towards: Vector, up: Vector) -> Self {
        let towards = unit(towards).unwrap_or(Z);
        Camera::with_up(towards, across(up, towards))
    }

    fn with_up(towards: Vector, up: Vector) -> Self {
        let towards = unit(towards).unwrap_or(Z);
        let up = unit(up).or_else(|| unit(across([0.0, 1.0, 0.0], towards))).unwrap_or([1.0, 0.0, 0.0]);
        Camera { right: cross(up, towards), up, towards }
    }

    /// The same view with the sheet turned by an angle, radians: what pointed right then points that much upwards.
    fn rolled(self, angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        let right = add(scale(cos, self.right), scale(-sin, self.up));
        Camera { right, up: add(scale(cos, self.up), scale(sin, self.right)), towards: self.towards }
    }

    /// A direction or position in the eye's frame: right, up, towards the eye.
    pub(super) fn seen(&self, v: Vector) -> Vector {
        [dot(v, self.right), dot(v, self.up), dot(v, self.towards)]
    }

    fn size_of(&self, points: impl Iterator<Item = Vector>) -> [f64; 2] {
        let [low, high] = self.bounds(points, [0.0; 3]);
        [(high[0] - low[0]).max(1e-9), (high[1] - low[1]).max(1e-9)]
    }

    /// Least and greatest coordinates across the view, relative to `centre`; zeros where there is no point.
    fn bounds(&self, points: impl Iterator<Item = Vector>, centre: Vector) -> [[f64; 2]; 2] {
        let mut bounds: Option<[[f64; 2]; 2]> = None;
        for point in points {
            let [x, y, _] = self.seen(sub(point, centre));
            let [low, high] = bounds.unwrap_or([[x, y]; 2]);
            bounds = Some([[low[0].min(x), low[1].min(y)], [high[0].max(x), high[1].max(y)]]);
        }
        bounds.unwrap_or_default()
    }
}

impl View {
    /// The view in which the points just fill the rectangle. A single point is shown as if it were 20 mm wide.
    pub(super) fn fitting(camera: Camera, points: &[Vector], rect: Rect) -> Self {
        let origin = points.first().copied().unwrap_or_default();
        let [low, high] = camera.bounds(points.iter().copied(), origin);
        let [wide, tall] = [high[0] - low[0], high[1] - low[1]];
        // Below this a difference of coordinates is rounding.
        let grain = 1e-12 * (1.0 + length(origin));
        let scale_to = if wide.max(tall) <= grain {
            rect.width().min(rect.height()) / 20.0
        } else {
            (rect.width() / wide.max(grain)).min(rect.height() / tall.max(grain))
        };
        let [x, y] = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
        let centre = add(origin, add(scale(x, camera.right), scale(y, camera.up)));
        View { camera, centre, scale: scale_to, middle: rect.middle() }
    }

    /// Where a point of space falls on the sheet.
    pub(super) fn place(&self, point: Vector) -> Place {
        let [x, y, _] = self.camera.seen(sub(point, self.centre));
        [self.middle[0] + self.scale * x, self.middle[1] - self.scale * y]
    }

    /// How near the eye a point is, mm; more is nearer.
    pub(super) fn depth(&self, point: Vector) -> f64 {
        dot(sub(point, self.centre), self.camera.towards)
    }
}

/// From where to look: along the average normal, from beyond the tips and from the side of plus z. Flanks that oppose
/// each other are looked at between them and more along z, where both can be distinguished.
fn eye_direction(nodes: &[Node]) -> Vector {
    let normals: Vec<Vector> = nodes.iter().filter_map(|node| node.normal).collect();
    let sum = normals.iter().fold([0.0; 3], |sum, &normal| add(sum, normal));
    let agreement = if normals.is_empty() { 0.0 } else { length(sum) / normals.len() as f64 };
    let outward = outward(nodes);
    let isometric = [0.577, -0.577, 0.577];
    let tilted = |main: Vector, to_z: f64, to_tip: f64| {
        let z = scale(to_z, clear(across(Z, main)));
        let tip = scale(to_tip, clear(across(across(outward, main), Z)));
        let aside = if length(add(z, tip)) > 0.1 { add(z, tip) } else { [-0.3, -0.45, 0.0] };
        unit(add(main, aside)).unwrap_or(isometric)
    };
    match unit(sum) {
        Some(main) if agreement > 0.75 => tilted(main, 0.42, 0.42),
        Some(main) if agreement > 0.12 => tilted(main, 0.85, 0.2),
        _ => isometric,
    }
}

/// The direction of a vector; zero where it is too short to have a clear one.
fn clear(a: Vector) -> Vector {
    if length(a) > 0.05 { unit(a).unwrap_or_default() } else { [0.0; 3] }
}

/// Away from the gear axis, on average; zero where the points surround it.
fn outward(nodes: &[Node]) -> Vector {
    let sum = nodes.iter().fold([0.0; 3], |sum, node| add(sum, node.position));
    unit([sum[0], sum[1], 0.0]).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nodes(normal: Vector) -> Vec<Node> {
        [[30.0, 0.0, 0.0], [30.0, 5.0, 0.0], [30.0, 5.0, 9.0]]
            .map(|position| Node { position, normal: Some(normal) })
            .into()
    }

    #[test]
    fn the_camera_is_a_right_handed_frame() {
        for normal in [[1.0, 0.0, 0.0], [0.0, 0.6, 0.8], [0.0, 0.0, -1.0], [0.0, 0.0, 1.0]] {
            let camera = Camera::facing(&nodes(normal), 4.0, 3.0);
            let third = cross(camera.right, camera.up);
            assert!(length(sub(third, camera.towards)) < 1e-12);
            assert!((length(camera.right) - 1.0).abs() < 1e-12);
            assert!(dot(camera.towards, normal) > 0.7);
        }
    }

    #[test]
    fn a_fitted_view_fills_its_rectangle() {
        let rect = Rect { left: 10.0, top: 20.0, right: 110.0, bottom: 70.0 };
        let points: Vec<Vector> = nodes([1.0, 0.0, 0.0]).iter().map(|node| node.position).collect();
        let view = View::fitting(Camera::facing(&nodes([1.0, 0.0, 0.0]), 100.0, 50.0), &points, rect);
        let places: Vec<Place> = points.iter().map(|&point| view.place(point)).collect();
        let span = |k: usize| {
            let all = places.iter().map(|place| place[k]);
            all.clone().fold(f64::MIN, f64::max) - all.fold(f64::MAX, f64::min)
        };
        assert!((span(0) - 100.0).abs() < 1e-9 || (span(1) - 50.0).abs() < 1e-9);
        assert!(span(0) < 100.0 + 1e-9 && span(1) < 50.0 + 1e-9);
    }
}
