//! Bands of values with round bounds.

/// About how many bands a map has.
const BANDS: f64 = 8.0;

/// Bands of equal width; zero is one of the bounds or outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Levels {
    step: f64,
    /// The lowest bound and the highest, in steps.
    ends: [f64; 2],
}

impl Levels {
    /// Bands that hold all the finite ones among some values; `None` if there is none.
    pub(super) fn over(values: impl Iterator<Item = f64>) -> Option<Levels> {
        let finite = values.filter(|value| value.is_finite());
        let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        if low > high {
            return None;
        }
        // values that are all the same have a band around them
        let size = low.abs().max(high.abs());
        let span = (high - low).max(if size > 0.0 { 1e-2 * size } else { 1.0 });
        let step = round_up(span / BANDS);
        let ends = [(low / step).floor(), (high / step).ceil()];
        let ends = if ends[0] == ends[1] { [ends[0], ends[0] + 1.0] } else { ends };
        (step > 0.0 && step.is_finite() && ends.iter().all(|end| end.is_finite())).then_some(Levels { step, ends })
    }

    pub(super) fn step(&self) -> f64 {
        self.step
    }

    /// The bounds of the bands, from the lowest to the highest.
    pub(super) fn bounds(&self) -> Vec<f64> {
        let count = (self.ends[1] - self.ends[0]) as usize;
        (0..=count).map(|k| (self.ends[0] + k as f64) * self.step).collect()
    }

    /// Where the band of a value lies among all: 0 for the lowest, 1 for the highest.
    pub(super) fn share(&self, value: f64) -> f64 {
        let last = self.ends[1] - self.ends[0] - 1.0;
        let band = ((value / self.step).floor() - self.ends[0]).clamp(0.0, last);
        if last > 0.0 { band / last } else { 0.5 }
    }
}

/// The next of 1, 2, 5, 10, 20, … tenths and so on.
fn round_up(value: f64) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    let factors = [1.0, 2.0, 5.0, 10.0];
    power * factors.into_iter().find(|factor| factor * power >= value * (1.0 - 1e-9)).unwrap_or(10.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_round_and_hold_all() {
        let levels = Levels::over([-3.1, f64::NAN, 12.7].into_iter()).expect("numbers");
        assert_eq!(levels.bounds(), [-4.0, -2.0, 0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0]);
        assert_eq!((levels.share(-3.1), levels.share(12.7), levels.share(-0.1)), (0.0, 1.0, 0.125));
        assert_eq!(Levels::over(std::iter::empty()), None);
    }

    #[test]
    fn one_value_has_a_band() {
        for value in [0.0, 5.0, -1e-9, 3e12] {
            let levels = Levels::over([value].into_iter()).expect("a number");
            let bounds = levels.bounds();
            assert!(bounds[0] <= value && value <= bounds[bounds.len() - 1] && bounds.len() < 12, "{bounds:?}");
        }
    }
}
