//! Bands of values with round bounds.

use super::paint::Colour;
use super::palette;

/// About how many bands a map has, and between how many lines.
pub(super) const BANDS: f64 = 8.0;
pub(super) const LINES: f64 = 16.0;

/// Values that differ by less than this share of their size are one.
const ROUNDING: f64 = 1e-9;

/// Bands of equal width; zero is one of the bounds or outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Levels {
    step: f64,
    /// The lowest bound and the highest, in steps.
    ends: [f64; 2],
    /// The value, where there is one only.
    single: Option<f64>,
}

impl Levels {
    /// About so many bands that hold all the finite ones among some values; `None` if there is none.
    pub(super) fn over(values: impl Iterator<Item = f64>, bands: f64) -> Option<Levels> {
        let finite = values.filter(|value| value.is_finite());
        let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        if low > high {
            return None;
        }
        // values that are all the same have a band around them
        let size = low.abs().max(high.abs());
        let span = (high - low).max(if size > 0.0 { 1e-2 * size } else { 1.0 });
        let step = round_up(span / bands);
        // a value that is beyond a bound by rounding is at it
        let ends = [(low / step + ROUNDING).floor(), (high / step - ROUNDING).ceil()];
        let ends = if ends[0] == ends[1] { [ends[0], ends[0] + 1.0] } else { ends };
        // rounding on both sides of a bound is one band about it
        let middle = (0.5 * (low + high) / step).round();
        let single = (high - low <= ROUNDING * size).then_some(0.5 * (low + high));
        let is_bound = single.is_some() && middle != 0.0 && (0.5 * (low + high) / step - middle).abs() < 0.01;
        let ends = if is_bound { [middle - 0.5, middle + 0.5] } else { ends };
        (step > 0.0 && step.is_finite() && ends.iter().all(|end| end.is_finite())).then_some(Levels {
            step,
            ends,
            single,
        })
    }

    pub(super) fn step(&self) -> f64 {
        self.step
    }

    /// The bounds of the bands, from the lowest to the highest.
    pub(super) fn bounds(&self) -> Vec<f64> {
        let count = (self.ends[1] - self.ends[0]) as usize;
        (0..=count).map(|k| (self.ends[0] + k as f64) * self.step).collect()
    }

    /// The value, where there is one only.
    pub(super) fn single(&self) -> Option<f64> {
        self.single
    }

    /// The number of the band that a value lies in, from the lowest.
    pub(super) fn band(&self, value: f64) -> usize {
        let last = self.ends[1] - self.ends[0] - 1.0;
        ((value / self.step).floor() - self.ends[0]).clamp(0.0, last) as usize
    }

    /// The bounds of one band; the first and the last one hold whatever lies beyond.
    pub(super) fn ends_of(&self, band: usize) -> [f64; 2] {
        let low = (self.ends[0] + band as f64) * self.step;
        let last = self.ends[0] + band as f64 + 1.0 >= self.ends[1];
        [if band == 0 { f64::NEG_INFINITY } else { low }, if last { f64::INFINITY } else { low + self.step }]
    }

    /// Whether there are values of both signs.
    pub(super) fn is_signed(&self) -> bool {
        self.ends[0] < 0.0 && self.ends[1] > 0.0
    }

    /// The colour of a band: by its share of the way from the lowest to the highest; where there are both signs, by its share
    /// of the way from zero to the end that is farther.
    pub(super) fn colour(&self, band: usize) -> Colour {
        if self.is_signed() {
            let farthest = self.ends[1].max(-self.ends[0]);
            return palette::of_signed((self.ends[0] + band as f64 + 0.5) / (farthest - 0.5));
        }
        let last = self.ends[1] - self.ends[0] - 1.0;
        palette::of_share(if last > 0.0 { band as f64 / last } else { 0.5 })
    }
}

/// The next of 1, 2, 5, 10, 20, … tenths and so on.
pub(super) fn round_up(value: f64) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    let factors = [1.0, 2.0, 5.0, 10.0];
    power * factors.into_iter().find(|factor| factor * power >= value * (1.0 - 1e-9)).unwrap_or(10.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_round_and_hold_all() {
        let levels = Levels::over([-3.1, f64::NAN, 12.7].into_iter(), BANDS).expect("numbers");
        assert_eq!(levels.bounds(), [-4.0, -2.0, 0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0]);
        assert_eq!((levels.band(-3.1), levels.band(12.7), levels.band(-0.1), levels.band(99.0)), (0, 8, 1, 8));
        assert_eq!((levels.ends_of(0), levels.ends_of(1)), ([f64::NEG_INFINITY, -2.0], [-2.0, 0.0]));
        assert_eq!(Levels::over(std::iter::empty(), BANDS), None);
        let touching = Levels::over([-7e-12, 34.2].into_iter(), BANDS).expect("numbers");
        assert!(!touching.is_signed() && touching.band(-7e-12) == 0, "{:?}", touching.bounds());
    }

    #[test]
    fn one_value_has_a_band() {
        let noise = Levels::over([1000.0, 1000.0 - 1e-10, 1000.0 + 1e-10].into_iter(), BANDS).expect("numbers");
        assert_eq!(noise.bounds(), [999.0, 1001.0]);
        for value in [0.0, 5.0, -1e-9, 3e12] {
            let levels = Levels::over([value].into_iter(), BANDS).expect("a number");
            let bounds = levels.bounds();
            assert!(bounds[0] <= value && value <= bounds[bounds.len() - 1] && bounds.len() < 12, "{bounds:?}");
        }
    }
}
