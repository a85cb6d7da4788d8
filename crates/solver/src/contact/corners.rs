//! Places on a flank as shares between the corners of its blank.

use nalgebra::{Matrix2, Vector2, Vector3};

/// Steps until the shares of a point are settled, and the step at which they are.
const MOST_STEPS: usize = 30;
const SETTLED: f64 = 1e-14;

/// The corners of a tooth in its axial section `[z, rho]`, mm: toe root, heel root, toe tip, heel tip. Shares between them are the first from
/// root to tip, the second from toe to heel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlankCorners(pub [[f64; 2]; 4]);

/// Directions on a flank at one of its points, in its frame, of unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlankDirections {
    /// Along the row through the point, towards the heel.
    pub lengthwise: [f64; 3],
    /// Square to that, towards the tip.
    pub profilewise: [f64; 3],
}

impl FlankCorners {
    /// The point `[z, rho]` at shares.
    #[must_use]
    pub fn at(&self, [v, u]: [f64; 2]) -> [f64; 2] {
        let [toe_root, heel_root, toe_tip, heel_tip] = self.0;
        [0, 1].map(|k| {
            (1.0 - v) * ((1.0 - u) * toe_root[k] + u * heel_root[k]) + v * ((1.0 - u) * toe_tip[k] + u * heel_tip[k])
        })
    }

    /// How the point moves with each of the shares: in columns.
    fn slopes(&self, [v, u]: [f64; 2]) -> Matrix2<f64> {
        let [toe_root, heel_root, toe_tip, heel_tip] = self.0.map(Vector2::from);
        let by_v = (1.0 - u) * (toe_tip - toe_root) + u * (heel_tip - heel_root);
        let by_u = (1.0 - v) * (heel_root - toe_root) + v * (heel_tip - toe_tip);
        Matrix2::from_columns(&[by_v, by_u])
    }

    /// The shares at a point `[z, rho]`; `None` where it has none.
    #[must_use]
    pub fn shares(&self, point: [f64; 2]) -> Option<[f64; 2]> {
        let mut shares = [0.5, 0.5];
        for _ in 0..MOST_STEPS {
            let here = self.at(shares);
            let off = Vector2::new(point[0] - here[0], point[1] - here[1]);
            let step = self.slopes(shares).try_inverse()? * off;
            shares = [shares[0] + step.x, shares[1] + step.y];
            if step.amax() < SETTLED {
                break;
            }
        }
        shares.iter().all(|share| share.is_finite()).then_some(shares)
    }

    /// Directions of the rows, on which the share from root to tip stays, at a point of the flank with its normal; `None` where the flank has
    /// none, as in a transverse plane.
    #[must_use]
    pub fn directions(&self, point: [f64; 3], normal: [f64; 3]) -> Option<FlankDirections> {
        let [x, y, z] = point;
        let rho = x.hypot(y);
        // rows of the inverse: how each share grows with z and rho
        let grows = self.slopes(self.shares([z, rho])?).try_inverse()?;
        let gradient = |row: usize| {
            let [by_z, by_rho] = [grows[(row, 0)], grows[(row, 1)]];
            Vector3::new(by_rho * x / rho, by_rho * y / rho, by_z)
        };
        let (normal, to_tip) = (Vector3::from(normal), gradient(0));
        let along = to_tip.cross(&normal).try_normalize(0.0)?;
        let lengthwise = along * along.dot(&gradient(1)).signum();
        let up = normal.cross(&lengthwise).normalize();
        let profilewise = up * up.dot(&to_tip).signum();
        let is_known = lengthwise.iter().chain(&profilewise).all(|part| part.is_finite());
        is_known.then(|| FlankDirections { lengthwise: lengthwise.into(), profilewise: profilewise.into() })
    }
}

impl FlankDirections {
    /// The angle of a way on the flank against the rows, above −π/2 and up to π/2: positive where it comes nearer to the tip on its way to
    /// the heel.
    #[must_use]
    pub fn angle(&self, way: [f64; 3]) -> f64 {
        let along = |direction: [f64; 3]| Vector3::from(way).dot(&Vector3::from(direction));
        let (up, ahead) = (along(self.profilewise), along(self.lengthwise));
        if ahead < 0.0 { (-up).atan2(-ahead) } else { up.atan2(ahead) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: FlankCorners = FlankCorners([[0.0, 10.0], [5.0, 18.0], [1.0, 14.0], [7.0, 24.0]]);

    #[test]
    fn shares_come_back() {
        for shares in [[0.5, 0.5], [0.0, 1.0], [0.3, 0.9], [1.2, -0.1]] {
            let found = CORNERS.shares(CORNERS.at(shares)).expect("it has shares");
            assert!((0..2).all(|k| (found[k] - shares[k]).abs() < 1e-13), "{found:?}");
        }
    }

    /// On a cone about the axis through a row, the row is a line of the cone.
    #[test]
    fn a_row_keeps_its_share() {
        let [z, rho] = CORNERS.at([0.4, 0.5]);
        let ahead = CORNERS.at([0.4, 0.9]);
        let along = Vector3::new(ahead[1] - rho, 0.0, ahead[0] - z).normalize();
        // any normal that is square to the row
        let normal = along.cross(&Vector3::new(0.2, 0.9, -0.3)).normalize();
        let found = CORNERS.directions([rho, 0.0, z], normal.into()).expect("a flank");
        assert!((Vector3::from(found.lengthwise) - along).norm() < 1e-9);
        let up = Vector3::from(found.profilewise);
        assert!(up.dot(&along).abs() < 1e-12 && up.dot(&normal).abs() < 1e-12);
        assert!((found.angle((along + up).into()) - 0.25 * std::f64::consts::PI).abs() < 1e-9);
        assert!((found.angle((-along + up).into()) + 0.25 * std::f64::consts::PI).abs() < 1e-9);
    }
}
