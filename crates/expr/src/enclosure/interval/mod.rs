//! Numbers known to lie between two floats.
//!
//! Sums, differences, products, quotients and square roots are correctly rounded by IEEE 754, elementary functions by
//! `core-math`; the next float outward therefore is a proven bound. (A ready interval crate was weighed: the sound ones need
//! GMP and MPFR from source and a processor flag, and take forty times as long for a sine.)

mod curve;
mod elementary;
mod evaluate;

pub use evaluate::IntervalEvaluator;

/// All values that a function may take on a box.
///
/// An operation on intervals contains what the operation makes of any numbers in them, in real arithmetic as well as in the
/// floats of [`ScalarEvaluator`](crate::ScalarEvaluator). Arguments outside a function's domain add nothing; they only cost
/// the claim of continuity.
///
/// ```
/// use flank_expr::Interval;
///
/// let x = Interval::new(-1.0, 4.0);
/// let root = x.sqrt();
/// assert!(root.contains(2.0) && root.lo == 0.0 && !root.continuous);
/// assert!(x.squared().lo == 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub lo: f64,
    /// Upper end; below the lower end where there is no value at all.
    pub hi: f64,
    /// Whether the function is shown to be defined, bounded and continuous on the whole box: without that no root may be
    /// concluded from its signs.
    pub continuous: bool,
}

/// The nearest float below what was rounded to nearest.
#[inline]
fn down(x: f64) -> f64 {
    x.next_down()
}

#[inline]
fn up(x: f64) -> f64 {
    x.next_up()
}

/// Lower and upper bound of a sum; the float itself where it is the sum (Knuth's two-sum gives the rounding error exactly).
#[inline]
fn sum_bounds(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    let error = (a - (sum - b_part)) + (b - b_part);
    // a NaN (infinite ends) moves both
    (if error >= 0.0 { sum } else { down(sum) }, if error <= 0.0 { sum } else { up(sum) })
}

/// What [`down`] and [`up`] are of a number that is finite and not zero, without a branch; the number itself unless `moves`.
#[inline]
fn down_if(moves: bool, x: f64) -> f64 {
    let bits = x.to_bits();
    // one unit of the last place towards zero or away from it
    let step = ((bits >> 63) << 1).wrapping_sub(1);
    f64::from_bits(bits.wrapping_add(step.wrapping_mul(u64::from(moves))))
}

#[inline]
fn up_if(moves: bool, x: f64) -> f64 {
    -down_if(moves, -x)
}

/// A sum and the sign of its rounding error, of numbers whose sum is finite: whether the sum itself is more, and whether it is less.
#[inline]
fn rounded_sum(a: f64, b: f64) -> (f64, bool, bool) {
    let sum = a + b;
    let b_part = sum - a;
    let error = (a - (sum - b_part)) + (b - b_part);
    (sum, error < 0.0, error > 0.0)
}

/// Lower and upper bound of a product of ends. Zero times an infinite end is zero: the end stands for numbers.
#[inline]
fn product_bounds(a: f64, b: f64) -> (f64, f64) {
    if a == 0.0 || b == 0.0 {
        return (0.0, 0.0);
    }
    let product = a * b;
    (down(product), up(product))
}

impl Interval {
    /// No value at all.
    pub const EMPTY: Interval = Interval { lo: f64::INFINITY, hi: f64::NEG_INFINITY, continuous: false };
    /// Nothing is known.
    pub const WHOLE: Interval = Interval { lo: f64::NEG_INFINITY, hi: f64::INFINITY, continuous: false };

    /// The numbers from `lo` to `hi`; a NaN makes it [`Interval::WHOLE`].
    pub fn new(lo: f64, hi: f64) -> Interval {
        if lo.is_nan() || hi.is_nan() {
            return Interval::WHOLE;
        }
        Interval { lo, hi, continuous: true }.bounded()
    }

    /// One number; NaN makes it [`Interval::WHOLE`].
    pub fn point(x: f64) -> Interval {
        Interval::new(x, x)
    }

    /// Infinite ends stand for numbers that are too large; then nothing is claimed.
    #[inline]
    fn bounded(self) -> Interval {
        if self.lo >= f64::MIN && self.hi <= f64::MAX {
            return self;
        }
        Interval { lo: self.lo.min(f64::MAX), hi: self.hi.max(f64::MIN), continuous: false }
    }

    #[inline]
    fn with(lo: f64, hi: f64, continuous: bool) -> Interval {
        Interval { lo, hi, continuous }.bounded()
    }

    fn partial(self) -> Interval {
        Interval { continuous: false, ..self }
    }

    /// Whether there is no value.
    #[inline]
    pub fn is_empty(self) -> bool {
        self.lo > self.hi
    }

    /// Whether a number lies in it.
    pub fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    /// Difference of the ends, rounded up.
    pub fn width(self) -> f64 {
        sum_bounds(self.hi, -self.lo).1
    }

    /// A float near the middle, inside if there is one.
    pub fn middle(self) -> f64 {
        let middle = 0.5 * self.lo + 0.5 * self.hi;
        if middle.is_nan() { 0.0 } else { middle.clamp(self.lo.min(self.hi), self.hi.max(self.lo)) }
    }

    /// Largest absolute value.
    pub fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// What both have in common.
    pub fn intersection(self, other: Interval) -> Interval {
        let (lo, hi) = (self.lo.max(other.lo), self.hi.min(other.hi));
        if lo > hi { Interval::EMPTY } else { Interval { lo, hi, continuous: self.continuous && other.continuous } }
    }

    /// The smallest interval that holds both.
    pub fn hull(self, other: Interval) -> Interval {
        Interval {
            lo: self.lo.min(other.lo),
            hi: self.hi.max(other.hi),
            continuous: self.continuous && other.continuous,
        }
    }

    /// The product with a number: that of [`Interval::point`], bit for bit.
    #[inline]
    pub fn times(self, number: f64) -> Interval {
        let (a, b) = (self.lo * number, self.hi * number);
        let (low, high) = if a < b { (a, b) } else { (b, a) };
        let is_finite = (low > f64::MIN) & (high < f64::MAX);
        if is_finite & (low != 0.0) & (high != 0.0) & (self.lo <= self.hi) {
            return Interval { lo: down_if(true, low), hi: up_if(true, high), continuous: self.continuous };
        }
        self.product_with_care(Interval::point(number))
    }

    /// x².
    pub fn squared(self) -> Interval {
        if self.is_empty() {
            return self;
        }
        let (small, large) = if self.lo >= 0.0 {
            (self.lo, self.hi)
        } else if self.hi <= 0.0 {
            (self.hi, self.lo)
        } else {
            (0.0, self.magnitude())
        };
        Interval::with(product_bounds(small, small).0.max(0.0), product_bounds(large, large).1, self.continuous)
    }

    /// √x.
    pub fn sqrt(self) -> Interval {
        if self.is_empty() || self.hi < 0.0 {
            return Interval::EMPTY;
        }
        let lower = if self.lo > 0.0 { down(self.lo.sqrt()) } else { 0.0 };
        let upper = if self.hi > 0.0 { up(self.hi.sqrt()) } else { 0.0 };
        Interval::with(lower, upper, self.continuous && self.lo >= 0.0)
    }

    /// |x|.
    pub fn abs(self) -> Interval {
        if self.lo >= 0.0 || self.is_empty() {
            self
        } else if self.hi <= 0.0 {
            -self
        } else {
            Interval { lo: 0.0, hi: self.magnitude(), continuous: self.continuous }
        }
    }

    /// −1, 0 or 1.
    pub fn sign(self) -> Interval {
        if self.is_empty() {
            return self;
        }
        let of = |x: f64| if x == 0.0 { 0.0 } else { x.signum() };
        Interval { lo: of(self.lo), hi: of(self.hi), continuous: self.continuous && !self.contains(0.0) }
    }

    /// The smaller of two.
    pub fn min(self, other: Interval) -> Interval {
        if self.is_empty() || other.is_empty() {
            return Interval::EMPTY;
        }
        Interval {
            lo: self.lo.min(other.lo),
            hi: self.hi.min(other.hi),
            continuous: self.continuous && other.continuous,
        }
    }

    /// The larger of two.
    pub fn max(self, other: Interval) -> Interval {
        -(-self).min(-other)
    }
}

impl std::ops::Neg for Interval {
    type Output = Interval;

    fn neg(self) -> Interval {
        Interval { lo: -self.hi, hi: -self.lo, continuous: self.continuous }
    }
}

impl std::ops::Add for Interval {
    type Output = Interval;

    #[inline(always)]
    fn add(self, other: Interval) -> Interval {
        let ((lo, is_more, _), (hi, _, is_less)) = (rounded_sum(self.lo, other.lo), rounded_sum(self.hi, other.hi));
        // neither end is infinite, nor the largest number; a sum of zero has no error
        if (lo.abs() < f64::MAX) & (hi.abs() < f64::MAX) & (self.lo <= self.hi) & (other.lo <= other.hi) {
            let continuous = self.continuous & other.continuous;
            return Interval { lo: down_if(is_more, lo), hi: up_if(is_less, hi), continuous };
        }
        self.sum_with_care(other)
    }
}

impl std::ops::Sub for Interval {
    type Output = Interval;

    #[inline(always)]
    fn sub(self, other: Interval) -> Interval {
        self + -other
    }
}

impl std::ops::Mul for Interval {
    type Output = Interval;

    #[inline(always)]
    fn mul(self, other: Interval) -> Interval {
        let (a, b) = (self, other);
        let products = [a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi];
        let least = |a: f64, b: f64| if a < b { a } else { b };
        let most = |a: f64, b: f64| if a > b { a } else { b };
        let low = least(least(products[0], products[1]), least(products[2], products[3]));
        let high = most(most(products[0], products[1]), most(products[2], products[3]));
        // where one is infinite or no number, so is their sum
        let is_finite = products.iter().sum::<f64>().is_finite() & (low > f64::MIN) & (high < f64::MAX);
        if is_finite & (low != 0.0) & (high != 0.0) & (a.lo <= a.hi) & (b.lo <= b.hi) {
            let (lo, hi) = (down_if(true, low), up_if(true, high));
            return Interval { lo, hi, continuous: a.continuous & b.continuous };
        }
        self.product_with_care(other)
    }
}

impl Interval {
    /// The sum of any intervals.
    #[cold]
    #[inline(never)]
    fn sum_with_care(self, other: Interval) -> Interval {
        if self.is_empty() || other.is_empty() {
            return Interval::EMPTY;
        }
        let (lo, hi) = (sum_bounds(self.lo, other.lo).0, sum_bounds(self.hi, other.hi).1);
        Interval::with(lo, hi, self.continuous && other.continuous)
    }

    /// The product of any intervals.
    #[inline(never)]
    fn product_with_care(self, other: Interval) -> Interval {
        if self.is_empty() || other.is_empty() {
            return Interval::EMPTY;
        }
        let (a, b) = (self, other);
        // which ends make the smallest and the largest product
        let ((la, lb), (ha, hb)) = match (a.lo >= 0.0, a.hi <= 0.0, b.lo >= 0.0, b.hi <= 0.0) {
            (true, _, true, _) => ((a.lo, b.lo), (a.hi, b.hi)),
            (true, _, _, true) => ((a.hi, b.lo), (a.lo, b.hi)),
            (true, ..) => ((a.hi, b.lo), (a.hi, b.hi)),
            (_, true, true, _) => ((a.lo, b.hi), (a.hi, b.lo)),
            (_, true, _, true) => ((a.hi, b.hi), (a.lo, b.lo)),
            (_, true, ..) => ((a.lo, b.hi), (a.lo, b.lo)),
            (_, _, true, _) => ((a.lo, b.hi), (a.hi, b.hi)),
            (_, _, _, true) => ((a.hi, b.lo), (a.lo, b.lo)),
            _ => {
                let lower = product_bounds(a.lo, b.hi).0.min(product_bounds(a.hi, b.lo).0);
                let upper = product_bounds(a.lo, b.lo).1.max(product_bounds(a.hi, b.hi).1);
                return Interval::with(lower, upper, a.continuous && b.continuous);
            }
        };
        Interval::with(product_bounds(la, lb).0, product_bounds(ha, hb).1, a.continuous && b.continuous)
    }
}

impl std::ops::Div for Interval {
    type Output = Interval;

    fn div(self, other: Interval) -> Interval {
        if self.is_empty() || other.is_empty() {
            return Interval::EMPTY;
        }
        // at zero itself floats make it infinite
        if other.lo <= 0.0 && other.hi >= 0.0 {
            return self.divided_by_ends_at_zero(other);
        }
        // largest and smallest quotient by the signs of both
        let (a, b) = (self, other);
        let (low, high) = if b.lo > 0.0 {
            (
                quotient_bounds(a.lo, if a.lo >= 0.0 { b.hi } else { b.lo }).0,
                quotient_bounds(a.hi, if a.hi >= 0.0 { b.lo } else { b.hi }).1,
            )
        } else {
            (
                quotient_bounds(a.hi, if a.hi >= 0.0 { b.hi } else { b.lo }).0,
                quotient_bounds(a.lo, if a.lo >= 0.0 { b.lo } else { b.hi }).1,
            )
        };
        Interval::with(low, high, a.continuous && b.continuous)
    }
}

/// Lower and upper bound of a quotient of ends, the divisor not zero.
fn quotient_bounds(a: f64, b: f64) -> (f64, f64) {
    if a == 0.0 {
        return (0.0, 0.0);
    }
    if a.is_infinite() && b.is_infinite() {
        return if (a > 0.0) == (b > 0.0) { (0.0, f64::INFINITY) } else { (f64::NEG_INFINITY, 0.0) };
    }
    let quotient = a / b;
    (down(quotient), up(quotient))
}

impl Interval {
    /// By an interval that holds zero: half a line where only its end is zero and this one is on one side.
    ///
    /// The quotient by zero itself counts with either sign only where both ends are zero: −0 and 0 are one number.
    fn divided_by_ends_at_zero(self, other: Interval) -> Interval {
        let one_sided = (other.lo == 0.0) != (other.hi == 0.0) && !self.contains(0.0);
        if !one_sided {
            return Interval::WHOLE;
        }
        let far = if other.hi > 0.0 { other.hi } else { other.lo };
        let near = if self.lo > 0.0 { self.lo } else { self.hi };
        let (lower, upper) = quotient_bounds(near, far);
        if (near > 0.0) == (far > 0.0) {
            Interval { lo: lower, hi: f64::INFINITY, continuous: false }
        } else {
            Interval { lo: f64::NEG_INFINITY, hi: upper, continuous: false }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ends of all kinds, and numbers between them from a linear congruence.
    fn ends() -> Vec<f64> {
        let special = [0.0, f64::from_bits(1), f64::MIN_POSITIVE, 1e-160, 1.0, 1e160, f64::MAX, f64::INFINITY];
        let mut state = 5u64;
        let drawn = (0..12).map(|_| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 51) as f64 - 2.0
        });
        special.into_iter().flat_map(|end| [end, -end]).chain(drawn).collect()
    }

    #[test]
    fn sums_and_products_are_those_of_the_careful_way() {
        let ends = ends();
        let sorted = ends.iter().flat_map(|lo| ends.iter().filter(move |hi| lo <= *hi).map(move |hi| (*lo, *hi)));
        let mut all: Vec<Interval> = sorted.map(|(lo, hi)| Interval::new(lo, hi)).collect();
        all.extend([Interval::EMPTY, Interval::WHOLE, Interval::new(2.0, 1.0), Interval::new(0.5, 0.75).partial()]);
        for a in &all {
            for b in &all {
                for (fast, careful) in [(*a + *b, a.sum_with_care(*b)), (*a * *b, a.product_with_care(*b))] {
                    assert_eq!(fast, careful, "{a:?} and {b:?}");
                }
            }
            for number in ends.iter().copied().chain([f64::NAN]) {
                assert_eq!(a.times(number), a.product_with_care(Interval::point(number)), "{a:?} and {number}");
            }
        }
    }
}
