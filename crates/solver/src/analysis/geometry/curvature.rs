//! How a surface bends.

use nalgebra::{Matrix2, Matrix3x2, Vector2, Vector3};

/// Singular values below this share of their scale count as zero. A tangent that is known to about 1e-13 of its size has
/// lost more than half of its digits there.
const DEGENERATE: f64 = 1e-8;
/// Rounding of a shape operator, as a share of the terms that it is made of. Closer principal curvatures have no directions.
const ROUNDING: f64 = 1e-12;

/// Normal curvatures of a surface at a point, 1/mm, or the difference of those of two surfaces that touch.
///
/// Positive along a direction in which the body that owns the surface is convex: 1/R everywhere on a ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curvature {
    /// Orthonormal tangent vectors, as columns.
    tangents: Matrix3x2<f64>,
    /// The symmetric form in these.
    form: Matrix2<f64>,
    /// Principal curvatures that differ by less cannot be told apart.
    rounding: f64,
}

/// How the normal curvatures of a surface change with something else: the change of the form, in tangents that turn with the normal and not
/// about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CurvatureChange(Matrix2<f64>);

impl CurvatureChange {
    /// This one and that of a surface that touches in the same tangents.
    pub(crate) fn plus(&self, other: &CurvatureChange) -> CurvatureChange {
        CurvatureChange(self.0 + other.0)
    }
}

/// The extreme normal curvatures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principal {
    /// The larger one, 1/mm.
    pub k1: f64,
    /// The smaller one, 1/mm.
    pub k2: f64,
    /// Their unit directions d1 and d2. d1, d2 and the normal are right-handed; the last component of d1 that is not zero (z,
    /// else y, else x) is positive. `None` where both curvatures are the same and every direction is principal.
    pub directions: Option<[[f64; 3]; 2]>,
}

/// A vector component below this counts as zero when a direction's sign is chosen.
const NO_COMPONENT: f64 = 1e-9;

/// Two unit vectors square to a unit normal and to each other; with it right-handed.
pub(crate) fn tangents(normal: Vector3<f64>) -> Matrix3x2<f64> {
    let least = normal.iamin();
    let first = normal.cross(&Vector3::ith(least, 1.0)).normalize();
    Matrix3x2::from_columns(&[first, normal.cross(&first)])
}

/// A direction with the sign that [`Principal::directions`] states.
pub(super) fn oriented(direction: Vector3<f64>) -> Vector3<f64> {
    let leading = direction.iter().rev().find(|component| component.abs() > NO_COMPONENT);
    if leading.is_some_and(|component| *component < 0.0) { -direction } else { direction }
}

impl Curvature {
    /// From how position and normal change along two tangent directions of the parameters. `scales` are the sizes of what
    /// these changes were summed up from.
    ///
    /// `None` where the two changes of the position do not span the tangent plane: at a singular point.
    pub(super) fn new(
        tangents: Matrix3x2<f64>,
        along: Matrix3x2<f64>,
        turning: Matrix3x2<f64>,
        scales: [f64; 2],
    ) -> Option<Curvature> {
        let along = tangents.tr_mul(&along);
        let is_finite = along.iter().all(|entry| entry.is_finite());
        let least = if is_finite { along.singular_values().min() } else { 0.0 };
        let inverse = (least > DEGENERATE * scales[0]).then(|| along.try_inverse()).flatten()?;
        let form = tangents.tr_mul(&turning) * inverse;
        let form = 0.5 * (form + form.transpose());
        let rounding = ROUNDING * scales[1] / least;
        form.iter().all(|entry| entry.is_finite()).then_some(Curvature { tangents, form, rounding })
    }

    /// The same with its change, each of both with how it changes.
    ///
    /// Of F = B A⁻¹, with A how the position changes along both directions and B how the normal does, dF = (dB − F dA) A⁻¹. Tangents that
    /// turn with the normal change neither A nor B: along the normal both are zero.
    pub(super) fn changing(
        tangents: Matrix3x2<f64>,
        [along, along_rate]: [Matrix3x2<f64>; 2],
        [turning, turning_rate]: [Matrix3x2<f64>; 2],
        scales: [f64; 2],
    ) -> Option<(Curvature, CurvatureChange)> {
        let curvature = Curvature::new(tangents, along, turning, scales)?;
        let inverse = tangents.tr_mul(&along).try_inverse()?;
        let form = tangents.tr_mul(&turning) * inverse;
        let change = (tangents.tr_mul(&turning_rate) - form * tangents.tr_mul(&along_rate)) * inverse;
        let change = 0.5 * (change + change.transpose());
        change.iter().all(|entry| entry.is_finite()).then_some((curvature, CurvatureChange(change)))
    }

    /// Normal curvature along a direction in the surface's frame, of any length; what sticks out of the tangent plane is
    /// left away. `None` for a direction along the normal.
    pub fn along(&self, direction: [f64; 3]) -> Option<f64> {
        let direction = Vector3::from(direction);
        let tangent = self.tangents.tr_mul(&direction);
        let is_tangent = tangent.norm() > NO_COMPONENT * direction.norm();
        is_tangent.then(|| tangent.dot(&(self.form * tangent)) / tangent.norm_squared())
    }

    /// The principal curvatures and their directions.
    pub fn principal(&self) -> Principal {
        let [[a, _], [b, c]] = self.form.data.0;
        let (mean, half) = (0.5 * (a + c), 0.5 * (a - c));
        let radius = half.hypot(b);
        let directions = (2.0 * radius > self.rounding).then(|| {
            let angle = 0.5 * b.atan2(half);
            let first = oriented(self.tangents * Vector2::new(angle.cos(), angle.sin()));
            let normal = self.tangents.column(0).cross(&self.tangents.column(1));
            [first, normal.cross(&first)].map(<[f64; 3]>::from)
        });
        Principal { k1: mean + radius, k2: mean - radius, directions }
    }

    /// How the principal curvatures change, the larger one first. Where both are the same, and part with any change, it is that of their mean.
    pub(crate) fn principal_change(&self, by: &CurvatureChange) -> [f64; 2] {
        let parts = |form: &Matrix2<f64>| {
            let [[a, _], [b, c]] = form.data.0;
            [0.5 * (a + c), 0.5 * (a - c), b]
        };
        let ([_, half, mixed], [mean_rate, half_rate, mixed_rate]) = (parts(&self.form), parts(&by.0));
        let radius = half.hypot(mixed);
        let is_one = 2.0 * radius <= self.rounding;
        let radius_rate = if is_one { 0.0 } else { (half * half_rate + mixed * mixed_rate) / radius };
        [mean_rate + radius_rate, mean_rate - radius_rate]
    }

    /// Half the sum of the principal curvatures, 1/mm.
    pub fn mean(&self) -> f64 {
        0.5 * self.form.trace()
    }

    /// The product of the principal curvatures, 1/mm².
    pub fn gauss(&self) -> f64 {
        self.form.determinant()
    }

    /// This one and another one in the same tangents: how two surfaces part that touch, each bending away from the other.
    pub(crate) fn plus(&self, other: &Curvature) -> Curvature {
        Curvature { form: self.form + other.form, rounding: self.rounding.max(other.rounding), ..*self }
    }

    /// This one less another one in the same tangents.
    pub(super) fn minus(&self, other: &Curvature) -> Curvature {
        Curvature { form: self.form - other.form, rounding: self.rounding.max(other.rounding), ..*self }
    }
}
