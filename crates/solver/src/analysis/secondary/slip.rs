//! The screw along which all pieces of a tool slide in themselves, as a hob's thread does: less a tool's turning along it, the work passes
//! slowly.

use nalgebra::{Matrix6, Rotation3, SymmetricEigen, Unit, Vector3, Vector6};

/// A thread shifts along its axis in a turn by more than this share of its size: what is once around lies apart.
const LEAST_LEAD: f64 = 1e-3;
/// By so little, as a share of the whole, a surface may leave itself; the least but one of the eigenvalues is more than this if it does
/// so along no other twist.
const EXACT: f64 = 1e-9;
const SINGLE: f64 = 1e-9;

/// A place of a tool's surface with its unit normal and its derivatives by either parameter, in the tool's frame.
#[derive(Clone, Copy)]
pub(super) struct Touch {
    pub(super) point: Vector3<f64>,
    pub(super) normal: Vector3<f64>,
    pub(super) slopes: [Vector3<f64>; 2],
}

/// A screw in the tool's frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slip {
    axis: Unit<Vector3<f64>>,
    /// A place on its axis.
    through: Vector3<f64>,
    /// mm of shift for each rad.
    pitch: f64,
}

impl Slip {
    /// The only twist that leads nowhere out of a surface, seen at some places of it, if it is a screw. Its velocity is square to all
    /// normals: `n · (ω × r + v) = 0` (H. Pottmann, J. Wallner: *Computational Line Geometry*, 2001, section 4.1).
    pub(super) fn of(touches: &[Touch]) -> Option<Slip> {
        let size = touches.iter().map(|touch| touch.point.norm()).fold(0.0, f64::max);
        let row = |touch: &Touch| {
            let moment = touch.point.cross(&touch.normal) / size;
            Vector6::new(moment.x, moment.y, moment.z, touch.normal.x, touch.normal.y, touch.normal.z)
        };
        let sum: Matrix6<f64> = touches.iter().map(|touch| row(touch) * row(touch).transpose()).sum();
        if touches.is_empty() || !sum.iter().all(|entry| entry.is_finite()) {
            return None;
        }
        let eigen = SymmetricEigen::new(sum / touches.len() as f64);
        let mut order = [0, 1, 2, 3, 4, 5];
        order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
        let twist = eigen.eigenvectors.column(order[0]);
        if eigen.eigenvalues[order[1]] < SINGLE || touches.iter().any(|touch| row(touch).dot(&twist).abs() > EXACT) {
            return None;
        }
        let (turn, shift) =
            (Vector3::new(twist[0], twist[1], twist[2]) / size, Vector3::new(twist[3], twist[4], twist[5]));
        let axis = Unit::try_new(turn, 1e-6 / size)?;
        let pitch = axis.dot(&shift) / turn.norm();
        let slip = Slip { axis, through: turn.cross(&shift) / turn.norm_squared(), pitch };
        (pitch.abs() > LEAST_LEAD * size).then_some(slip)
    }

    /// Of a point that slides along with it, by the angle.
    pub(super) fn velocity(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.axis.cross(&(point - self.through)) + self.pitch * *self.axis
    }

    /// Of a direction that turns along with it, by the angle.
    pub(super) fn turning(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        self.axis.cross(direction)
    }

    /// A point after an angle.
    pub(super) fn moved(&self, point: &Vector3<f64>, by: f64) -> Vector3<f64> {
        self.through + self.turned(&(point - self.through), by) + by * self.pitch * *self.axis
    }

    /// A direction after an angle.
    pub(super) fn turned(&self, direction: &Vector3<f64>, by: f64) -> Vector3<f64> {
        Rotation3::from_axis_angle(&self.axis, by) * direction
    }

    /// How the parameters of a surface run with the angle, if one alone does, and evenly.
    pub(super) fn along(&self, touches: &[Touch]) -> Option<[f64; 2]> {
        let rate = |touch: &Touch| {
            let velocity = self.velocity(&touch.point);
            let [u, v] = touch.slopes;
            let (uu, uv, vv) = (u.dot(&u), u.dot(&v), v.dot(&v));
            let (by_u, by_v) = (velocity.dot(&u), velocity.dot(&v));
            let area = uu * vv - uv * uv;
            [(vv * by_u - uv * by_v) / area, (uu * by_v - uv * by_u) / area]
        };
        let rates: Vec<[f64; 2]> = touches.iter().map(rate).collect();
        let most = |k: usize| rates.iter().map(|rate| rate[k].abs()).fold(0.0, f64::max);
        // the other one stands still, measured by what it moves
        let stands = |k: usize| {
            let all = touches.iter().zip(&rates);
            all.clone()
                .all(|(touch, rate)| (rate[k] * touch.slopes[k]).norm() <= EXACT * self.velocity(&touch.point).norm())
        };
        let along = if stands(0) { 1 } else { 0 };
        let own = rates.first()?[along];
        let is_even = stands(1 - along) && rates.iter().all(|rate| (rate[along] - own).abs() <= EXACT * most(along));
        let mut slide = [0.0; 2];
        slide[along] = own;
        is_even.then_some(slide)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places of a surface of two parameters, with derivatives by differences.
    fn touches(place: impl Fn([f64; 2]) -> Vector3<f64>) -> Vec<Touch> {
        let slope = |at: [f64; 2], k: usize| {
            let by = |step: f64| {
                let mut beside = at;
                beside[k] += step;
                place(beside)
            };
            // of sixth order
            let [a, b, c] = [1.0, 2.0, 3.0].map(|n| by(n * 1e-2) - by(-n * 1e-2));
            (45.0 * a - 9.0 * b + c) / 0.6
        };
        let touch = |k: usize| {
            let at = [0.5 * (k / 6) as f64, 0.3 * (k % 6) as f64];
            let slopes = [0, 1].map(|k| slope(at, k));
            Touch { point: place(at), normal: slopes[0].cross(&slopes[1]).normalize(), slopes }
        };
        (0..36).map(touch).collect()
    }

    /// A thread whose sides bend, about an axis that lies askew, through `(3, -2, 1)` along `(1, 2, 2) / 3`.
    fn thread(relief: f64, pitch: f64) -> impl Fn([f64; 2]) -> Vector3<f64> {
        let axis = Unit::new_normalize(Vector3::new(1.0, 2.0, 2.0));
        move |[turn, u]: [f64; 2]| {
            let profile = Vector3::new(2.0, -2.0, 1.0).normalize() * (20.0 + u - relief * turn)
                + *axis * (0.36 * u + 0.02 * u * u);
            Vector3::new(3.0, -2.0, 1.0) + Rotation3::from_axis_angle(&axis, turn) * profile + *axis * (pitch * turn)
        }
    }

    #[test]
    fn a_thread_slides_along_its_screw() {
        let own = touches(thread(0.0, 2.5));
        let slip = Slip::of(&own).expect("a screw");
        // in either sense: both the axis and the angle turn round
        let sense = slip.axis.dot(&Vector3::new(1.0, 2.0, 2.0)).signum();
        assert!((slip.pitch - 2.5).abs() < 1e-8, "{slip:?}");
        let slide = slip.along(&own).expect("the turn alone runs, and evenly");
        assert!((slide[0] - sense).abs() < 1e-8 && slide[1].abs() < 1e-8, "{slide:?}");
        let (from, to) = (thread(0.0, 2.5)([0.2, 0.7]), thread(0.0, 2.5)([1.5, 0.7]));
        assert!((slip.moved(&from, 1.3 * sense) - to).norm() < 1e-7);
    }

    /// A relieved thread leaves itself; a surface of revolution is the same once around; a plane slides along more than one twist.
    #[test]
    fn what_does_not_slide_along_one_screw_has_none() {
        assert!(Slip::of(&touches(thread(1e-3, 2.5))).is_none());
        assert!(Slip::of(&touches(thread(0.0, 0.0))).is_none());
        assert!(Slip::of(&touches(|[u, v]| Vector3::new(u, v, 0.3 * u - v))).is_none());
        assert!(Slip::of(&[]).is_none());
    }

    /// The parameters of a thread may run askew: then it is not one of them that runs along the screw.
    #[test]
    fn parameters_that_run_askew_are_told() {
        let askew = touches(|[turn, u]| thread(0.0, 2.5)([turn + 0.2 * u, u]));
        let slip = Slip::of(&askew).expect("a screw");
        assert!(slip.along(&askew).is_some(), "the other one stands still");
        let both = touches(|[a, b]| thread(0.0, 2.5)([a + b, a - b]));
        assert!(Slip::of(&both).expect("a screw").along(&both).is_none());
    }
}
