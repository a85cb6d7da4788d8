//! A spur gear in closed form.

use std::f64::consts::{FRAC_PI_2, PI};

/// A gear that a rack of 20 degrees and height 1.25 generates, by the involute and the trochoid in closed form.
pub(crate) struct Spur {
    pub(crate) module: f64,
    pub(crate) teeth: f64,
    pub(crate) shift: f64,
    /// Of the rack's tip, in modules.
    pub(crate) rounding: f64,
}

pub(crate) const ALPHA: f64 = PI / 9.0;

impl Spur {
    pub(crate) fn radius(&self) -> f64 {
        0.5 * self.module * self.teeth
    }

    /// Distance from the axis and angle from the middle of the space, where the rounding of the rack's tip touches at an angle.
    pub(crate) fn trochoid(&self, theta: f64) -> [f64; 2] {
        let (m, r) = (self.module, self.radius());
        let rounding = self.rounding * m;
        let across = PI * m / 4.0 - (1.25 * m - rounding) * ALPHA.tan() - rounding / ALPHA.cos();
        let depth = 1.25 * m - rounding - self.shift * m;
        // the normal goes through the pitch point
        let pitch_point = across - depth / theta.tan();
        let x = across + rounding * theta.cos() - pitch_point;
        let y = r - depth - rounding * theta.sin();
        [x.hypot(y), x.atan2(y) + pitch_point / r]
    }

    /// Half the angle of the space at a distance from the axis.
    pub(crate) fn involute(&self, rho: f64) -> f64 {
        let inv = |angle: f64| angle.tan() - angle;
        let at = (self.radius() * ALPHA.cos() / rho).acos();
        let tooth = FRAC_PI_2 / self.teeth + 2.0 * self.shift * ALPHA.tan() / self.teeth + inv(ALPHA) - inv(at);
        PI / self.teeth - tooth
    }

    /// Where the trochoid crosses the involute of a gear that is cut under: its angle, and the distance from the axis.
    pub(crate) fn undercut(&self) -> (f64, f64) {
        let differs = |theta: f64| {
            let [rho, angle] = self.trochoid(theta);
            angle - self.involute(rho)
        };
        // from the root up the fillet's space is the wider one, from where they cross on the flank's
        let base = self.radius() * ALPHA.cos();
        let thetas = (0..4000).map(|k| FRAC_PI_2 - f64::from(k) / 4000.0 * (FRAC_PI_2 - ALPHA));
        let mut above = thetas.filter(|theta| self.trochoid(*theta)[0] > base);
        let crossed = above.find(|theta| differs(*theta) < 0.0).expect("they cross");
        let (mut low, mut high) = (crossed, crossed + (FRAC_PI_2 - ALPHA) / 4000.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if differs(middle) < 0.0 { low = middle } else { high = middle }
        }
        (low, self.trochoid(low)[0])
    }

    /// The area of one space up to a tip radius: half the angle times twice ρ dρ, flank and fillet one after the other.
    pub(crate) fn space(&self, tip: f64) -> f64 {
        let [form, _] = self.trochoid(ALPHA);
        let flank = simpson(form, tip, |rho| 2.0 * self.involute(rho) * rho);
        flank + self.fillet(ALPHA)
    }

    /// The area of one space up to where the rounding of the rack's tip touches at an angle.
    pub(crate) fn fillet(&self, theta: f64) -> f64 {
        self.fillet_to([theta, FRAC_PI_2])
    }

    /// The same above where it touches at another one.
    pub(crate) fn fillet_to(&self, [theta, deepest]: [f64; 2]) -> f64 {
        let step = 1e-5;
        simpson(theta, deepest, |theta| {
            let [rho, angle] = self.trochoid(theta);
            let slope = (self.trochoid(theta + step)[0] - self.trochoid(theta - step)[0]) / (2.0 * step);
            -2.0 * angle * rho * slope
        })
    }
}

pub(crate) fn simpson(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    const STEPS: usize = 4000;
    let h = (to - from) / STEPS as f64;
    let weight = |k: usize| {
        if k == 0 || k == STEPS {
            1.0
        } else if k % 2 == 1 {
            4.0
        } else {
            2.0
        }
    };
    (0..=STEPS).map(|k| weight(k) * f(from + h * k as f64)).sum::<f64>() * h / 3.0
}

/// The angle whose involute is given.
pub(crate) fn arcinv(wanted: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.5);
    for _ in 0..60 {
        let middle: f64 = 0.5 * (low + high);
        if middle.tan() - middle < wanted { low = middle } else { high = middle }
    }
    low
}
