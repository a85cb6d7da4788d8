//! Flanks held against involute helicoids, as gear measuring machines hold them, and the traces that they plot evaluated.

/// A mean line is told from fewer points than these only by chance.
const LEAST: usize = 3;

/// An involute helicoid about the z axis but for its turn about it: what cylindrical gears are measured against.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InvoluteHelicoid {
    /// mm
    pub base_radius: f64,
    /// Turn per length along z, radians per mm; positive for a right-hand helix, zero for a spur gear.
    pub twist: f64,
}

/// How a flank lies about the z axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Side {
    /// Whether the angle of its involute grows or falls with the distance from the axis.
    winding: f64,
    /// Whether its material is on the side of smaller or of greater angles.
    outward: f64,
}

/// A flank held against a helicoid, turned so that both meet in one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InvoluteReference {
    helicoid: InvoluteHelicoid,
    side: Side,
    /// Angle of the helicoid where it leaves its base circle at z 0, radians.
    origin: f64,
}

impl InvoluteHelicoid {
    /// The one with a position and a normal of a flank: the transverse normals of an involute touch its base circle, and the helix runs
    /// square to the normal. `None` on the axis, and where the normal is axial or goes through the axis.
    pub fn touching(position: [f64; 3], normal: [f64; 3]) -> Option<InvoluteHelicoid> {
        let moment = position[0] * normal[1] - position[1] * normal[0];
        let base_radius = moment.abs() / normal[0].hypot(normal[1]);
        let twist = -normal[2] / moment;
        (base_radius > 0.0 && base_radius.is_finite() && twist.is_finite())
            .then_some(InvoluteHelicoid { base_radius, twist })
    }

    /// Of the base cylinder, radians; positive for a right-hand helix.
    pub fn base_helix_angle(&self) -> f64 {
        (self.twist * self.base_radius).atan()
    }

    /// Length of roll at a distance from the axis, mm: from the base circle to the involute along its tangent. `None` below it.
    pub fn roll_length(&self, rho: f64) -> Option<f64> {
        let square = rho * rho - self.base_radius * self.base_radius;
        (square >= 0.0).then(|| square.sqrt())
    }

    /// The distance from the axis at a length of roll, mm.
    pub fn rho(&self, roll_length: f64) -> f64 {
        self.base_radius.hypot(roll_length)
    }

    /// The polar angle of the involute less that of its start on the base circle, radians.
    fn angle(&self, rho: f64) -> Option<f64> {
        let roll = self.roll_length(rho)? / self.base_radius;
        Some(roll - roll.atan())
    }

    /// Turned so that a point of a flank lies on it; `None` below the base circle, and where the normal does not tell the side of the tooth.
    pub fn through(&self, position: [f64; 3], normal: [f64; 3]) -> Option<InvoluteReference> {
        let [x, y, z] = position;
        let rho = x.hypot(y);
        let (radial, tangential) = (x * normal[0] + y * normal[1], x * normal[1] - y * normal[0]);
        let side = Side { winding: -(radial * tangential).signum(), outward: tangential.signum() };
        let origin = y.atan2(x) - side.winding * self.angle(rho)? - self.twist * z;
        (radial != 0.0 && tangential != 0.0).then_some(InvoluteReference { helicoid: *self, side, origin })
    }
}

impl InvoluteReference {
    /// The helicoid.
    pub fn helicoid(&self) -> InvoluteHelicoid {
        self.helicoid
    }

    /// How far a point lies off it along the tangent to the base circle in the transverse plane, mm; plus is material. `None` below the base
    /// circle. An involute that is turned by an angle is everywhere off by the angle times the base radius.
    pub fn deviation(&self, [x, y, z]: [f64; 3]) -> Option<f64> {
        let InvoluteHelicoid { base_radius, twist } = self.helicoid;
        let angle = self.helicoid.angle(x.hypot(y))?;
        let off = y.atan2(x) - self.origin - self.side.winding * angle - twist * z;
        let turns = (off / std::f64::consts::TAU).round();
        Some(base_radius * self.side.outward * (off - std::f64::consts::TAU * turns))
    }
}

/// What a trace of deviations is like, as ISO 1328-1:2013 evaluates it, against a design that is a straight line. In the unit of the deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceEvaluation {
    /// Fα or Fβ: between the parallels to the design that enclose the trace.
    pub total: f64,
    /// ffα or ffβ: between the parallels to its mean line that enclose the trace.
    pub form: f64,
    /// fHα or fHβ: the rise of its mean line over the whole trace.
    pub slope: f64,
    /// Cα or Cβ: how high the parabola that fits best stands in the middle of the range over its ends.
    pub crowning: f64,
    /// The mean line: its value in the middle of the range, and its rise per length.
    pub mean: [f64; 2],
}

impl TraceEvaluation {
    /// Of deviations at lengths that grow, evaluated within a range. Beyond it material that stands out counts too, nothing else does.
    /// Means are those of least squares. `None` with fewer than three points within the range.
    pub fn of_trace(lengths: &[f64], deviations: &[f64], [low, high]: [f64; 2]) -> Option<TraceEvaluation> {
        let middle = 0.5 * (low + high);
        let half = 0.5 * (high - low);
        let all = || lengths.iter().zip(deviations).map(|(length, off)| (*length, *off));
        // a length on an end of the range is in it, whatever its rounding
        let is_within = |length: f64| (length - middle).abs() <= half * (1.0 + 1e-9);
        let within =
            || all().filter(|(length, _)| is_within(*length)).map(|(length, off)| ((length - middle) / half, off));
        let count = within().count();
        if count < LEAST {
            return None;
        }
        let (mut normal, mut right) = (nalgebra::Matrix3::zeros(), nalgebra::Vector3::zeros());
        for (share, off) in within() {
            let terms = nalgebra::Vector3::new(1.0, share, share * share);
            normal += terms * terms.transpose();
            right += terms * off;
        }
        let parabola = normal.cholesky()?.solve(&right);
        let line =
            normal.fixed_view::<2, 2>(0, 0).into_owned().cholesky()?.solve(&right.fixed_rows::<2>(0).into_owned());
        let mean = [line[0], line[1] / half];
        let spread = |of: &dyn Fn(f64, f64) -> f64| {
            let least =
                all().filter(|(length, _)| is_within(*length)).map(|(x, off)| of(x, off)).fold(f64::INFINITY, f64::min);
            let most = all().map(|(x, off)| of(x, off)).fold(f64::NEG_INFINITY, f64::max);
            most - least
        };
        let whole = lengths.last()? - lengths.first()?;
        Some(TraceEvaluation {
            total: spread(&|_, off| off),
            form: spread(&|length, off| off - mean[0] - mean[1] * (length - middle)),
            slope: mean[1] * whole,
            crowning: -parabola[2],
            mean,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HELICOID: InvoluteHelicoid = InvoluteHelicoid { base_radius: 30.0, twist: 0.012 };

    /// A point of a helicoid at a roll angle and a height, and the normal of its flank on the side of greater angles or of smaller ones.
    fn point(of: InvoluteHelicoid, roll: f64, z: f64, outward: f64) -> ([f64; 3], [f64; 3]) {
        let winding = -outward;
        let start = of.twist * z;
        let turn = start + winding * roll;
        let base = of.base_radius;
        let (sin, cos) = turn.sin_cos();
        // from the base circle back along its tangent by the length that was unrolled
        let position = [base * (cos + winding * roll * sin), base * (sin - winding * roll * cos), z];
        let axial = -of.twist * base;
        let size = 1.0_f64.hypot(axial);
        (position, [-outward * sin / size, outward * cos / size, outward * axial / size])
    }

    #[test]
    fn a_helicoid_is_read_off_any_of_its_points() {
        for outward in [1.0, -1.0] {
            let (from, normal) = point(HELICOID, 0.4, -3.0, outward);
            let found = InvoluteHelicoid::touching(from, normal).expect("it is no plane");
            assert!((found.base_radius - HELICOID.base_radius).abs() < 1e-12, "{found:?}");
            assert!((found.twist - HELICOID.twist).abs() < 1e-14, "{found:?}");
            let reference = found.through(from, normal).expect("it is above the base circle");
            for (roll, z) in [(0.1, 5.0), (0.4, 9.0), (0.7, -11.0)] {
                let off = reference.deviation(point(HELICOID, roll, z, outward).0).expect("it is too");
                assert!(off.abs() < 1e-12, "{off:e}");
            }
        }
    }

    /// Turned towards its normal a flank has more material: the angle times the base radius, everywhere.
    #[test]
    fn a_turned_flank_is_off_by_the_same_everywhere() {
        let (from, normal) = point(HELICOID, 0.4, 0.0, -1.0);
        let reference = HELICOID.through(from, normal).expect("it is above the base circle");
        let (sin, cos) = (-1e-4_f64).sin_cos();
        for (roll, z) in [(0.15, 5.0), (0.6, -7.0)] {
            let [x, y, z] = point(HELICOID, roll, z, -1.0).0;
            let off = reference.deviation([cos * x - sin * y, sin * x + cos * y, z]).expect("it is above it");
            assert!((off - 3e-3).abs() < 1e-12, "{off:e}");
        }
    }

    #[test]
    fn a_parabola_on_a_slope_is_evaluated_by_its_own_numbers() {
        let lengths: Vec<f64> = (0..=2000).map(|k| 5.0 + 0.01 * f64::from(k)).collect();
        let share = |length: f64| (length - 15.0) / 10.0;
        let off: Vec<f64> = lengths.iter().map(|x| 3.0 + 4.0 * share(*x) - 6.0 * share(*x).powi(2)).collect();
        let found = TraceEvaluation::of_trace(&lengths, &off, [5.0, 25.0]).expect("there are points");
        assert!((found.slope - 8.0).abs() < 1e-9 && (found.crowning - 6.0).abs() < 1e-9, "{found:?}");
        // the parabola less its mean: from -4 at the ends to 2 in the middle
        assert!((found.form - 6.0).abs() < 1e-9, "{found:?}");
        // the highest point lies at a third of the half: 3 + 2/3; the lowest at the lower end
        assert!((found.total - (3.0 + 2.0 / 3.0 + 7.0)).abs() < 1e-4, "{found:?}");
        let short = TraceEvaluation::of_trace(&lengths, &off, [5.0, 15.0]).expect("there are points");
        assert!((short.crowning - 1.5).abs() < 1e-9, "a quarter of it over half the length: {short:?}");
        assert_eq!(TraceEvaluation::of_trace(&lengths[..2], &off[..2], [5.0, 25.0]), None);
    }
}
