//! Small functions for operations that the languages lack, emitted where they are used.

use std::collections::BTreeSet;

use super::Language;
use crate::symbolic::op::{INVOLUTE_SERIES, INVOLUTE_SERIES_BELOW};

/// An operation with a function of its own.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Helper {
    Sign,
    Min,
    Max,
    Arcinv,
    Curve,
    Pow,
}

impl Helper {
    pub(super) const ALL: [Helper; 6] =
        [Helper::Sign, Helper::Min, Helper::Max, Helper::Arcinv, Helper::Curve, Helper::Pow];

    /// What stands behind the name of the function that calls it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Helper::Sign => "sign",
            Helper::Min => "min",
            Helper::Max => "max",
            Helper::Arcinv => "arcinv",
            Helper::Curve => "curve",
            Helper::Pow => "pow",
        }
    }

    fn template(self, language: Language) -> &'static str {
        match (language, self) {
            (Language::C, Helper::Sign) => C_SIGN,
            (Language::C, Helper::Min) => C_MIN,
            (Language::C, Helper::Max) => C_MAX,
            (Language::C, Helper::Arcinv) => C_ARCINV,
            (Language::C, Helper::Curve) => C_CURVE,
            (Language::Rust, Helper::Sign) => RUST_SIGN,
            (Language::Rust, Helper::Min) => RUST_MIN,
            (Language::Rust, Helper::Max) => RUST_MAX,
            (Language::Rust, Helper::Arcinv) => RUST_ARCINV,
            (Language::Rust, Helper::Curve) => RUST_CURVE,
            (Language::JavaScript, Helper::Sign) => JAVASCRIPT_SIGN,
            (Language::JavaScript, Helper::Min) => JAVASCRIPT_MIN,
            (Language::JavaScript, Helper::Max) => JAVASCRIPT_MAX,
            (Language::JavaScript, Helper::Arcinv) => JAVASCRIPT_ARCINV,
            (Language::JavaScript, Helper::Curve) => JAVASCRIPT_CURVE,
            (Language::JavaScript, Helper::Pow) => JAVASCRIPT_POW,
            // their libraries have the right one
            (Language::C | Language::Rust, Helper::Pow) => "",
        }
    }
}

/// The helpers that a function calls.
#[derive(Default)]
pub(super) struct Helpers(BTreeSet<Helper>);

impl Helpers {
    pub(super) fn insert(&mut self, helper: Helper) {
        self.0.insert(helper);
    }

    /// What stands above the function: the header of the library and the helpers.
    pub(super) fn text(&self, language: Language, function: &str) -> String {
        let mut text = language.preamble().to_string();
        let series: Vec<String> = INVOLUTE_SERIES.iter().map(|c| language.number(*c)).collect();
        for helper in &self.0 {
            if language == Language::Rust {
                text += "#[allow(non_snake_case)]\n";
            }
            text += &helper
                .template(language)
                .replace("SERIES_BELOW", &language.number(INVOLUTE_SERIES_BELOW))
                .replace("SERIES", &series.join(", "))
                .replace("QUARTER_TURN", &language.number(std::f64::consts::FRAC_PI_2))
                .replace("NAME", function);
            text.push('\n');
        }
        text
    }
}

impl Language {
    /// What a text begins with.
    fn preamble(self) -> &'static str {
        match self {
            Language::C => "#include <math.h>\n\n",
            Language::Rust | Language::JavaScript => "",
        }
    }
}

const C_SIGN: &str = "\
static double NAME_sign(double x)
{
    return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : x + 0.0;
}
";

const RUST_SIGN: &str = "\
fn NAME_sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}
";

const JAVASCRIPT_SIGN: &str = "\
function NAME_sign(x) {
    return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : x + 0.0;
}
";

// not fmin and fmax, which drop a NaN
const C_MIN: &str = "\
static double NAME_min(double x, double y)
{
    return x < y || isnan(x) ? x : y;
}
";

const RUST_MIN: &str = "\
fn NAME_min(x: f64, y: f64) -> f64 {
    if x < y || x.is_nan() { x } else { y }
}
";

const JAVASCRIPT_MIN: &str = "\
function NAME_min(x, y) {
    return Math.min(x, y);
}
";

const C_MAX: &str = "\
static double NAME_max(double x, double y)
{
    return x > y || isnan(x) ? x : y;
}
";

const RUST_MAX: &str = "\
fn NAME_max(x: f64, y: f64) -> f64 {
    if x > y || x.is_nan() { x } else { y }
}
";

const JAVASCRIPT_MAX: &str = "\
function NAME_max(x, y) {
    return Math.max(x, y);
}
";

// Newton from above, where the involute function is convex; its series where the difference would cancel
const C_ARCINV: &str = "\
/* the angle a whose involute function tan(a) - a is x */
static double NAME_arcinv(double x)
{
    static const double series[] = { SERIES };
    const double target = fabs(x);
    double a = fmin(cbrt(3.0 * target), atan(target + QUARTER_TURN));
    if (target == 0.0 || isnan(target)) {
        return x;
    }
    for (int step = 0; step < 60; ++step) {
        const double tangent = tan(a), square = a * a;
        double involute = 0.0, next;
        for (int k = (int)(sizeof series / sizeof series[0]); k-- > 0;) {
            involute = involute * square + series[k];
        }
        involute = a > SERIES_BELOW ? tangent - a : a * square * involute;
        next = a - (involute - target) / (tangent * tangent);
        if (!(next > 0.0 && next < a)) {
            break;
        }
        a = next;
    }
    return copysign(a, x);
}
";

const RUST_ARCINV: &str = "\
/// The angle a whose involute function tan(a) - a is x.
fn NAME_arcinv(x: f64) -> f64 {
    let series = [SERIES];
    let target = x.abs();
    if target == 0.0 || target.is_nan() {
        return x;
    }
    let mut a = (3.0 * target).cbrt().min((target + QUARTER_TURN).atan());
    for _ in 0..60 {
        let (tangent, square) = (a.tan(), a * a);
        let sum = series.iter().rev().fold(0.0, |sum, c| sum * square + c);
        let involute = if a > SERIES_BELOW { tangent - a } else { a * square * sum };
        let next = a - (involute - target) / (tangent * tangent);
        if !(next > 0.0 && next < a) {
            break;
        }
        a = next;
    }
    a.copysign(x)
}
";

const JAVASCRIPT_ARCINV: &str = "\
/** The angle a whose involute function tan(a) - a is x. */
function NAME_arcinv(x) {
    const series = [SERIES];
    const target = Math.abs(x);
    if (target === 0.0 || Number.isNaN(target)) {
        return x;
    }
    let a = Math.min(Math.cbrt(3.0 * target), Math.atan(target + QUARTER_TURN));
    for (let step = 0; step < 60; ++step) {
        const tangent = Math.tan(a), square = a * a;
        const sum = series.reduceRight((sum, c) => sum * square + c, 0.0);
        const involute = a > SERIES_BELOW ? tangent - a : a * square * sum;
        const next = a - (involute - target) / (tangent * tangent);
        if (!(next > 0.0 && next < a)) {
            break;
        }
        a = next;
    }
    return x < 0.0 ? -a : a;
}
";

const C_CURVE: &str = "\
/* derivative of an order (0: the value) of a cubic spline; a piece is its left knot and its cubic in the distance from there */
static double NAME_curve(const double (*pieces)[5], int count, double low, double high, int order, double x)
{
    int first = 0, last = count - 1;
    if (!(x >= low && x <= high)) {
        return NAN;
    }
    while (first < last) {
        const int middle = (first + last + 1) / 2;
        if (pieces[middle][0] <= x) {
            first = middle;
        } else {
            last = middle - 1;
        }
    }
    {
        const double *piece = pieces[first];
        const double t = x - piece[0];
        switch (order) {
        case 0: return piece[1] + t * (piece[2] + t * (piece[3] + t * piece[4]));
        case 1: return piece[2] + t * (2.0 * piece[3] + t * 3.0 * piece[4]);
        case 2: return 2.0 * piece[3] + t * 6.0 * piece[4];
        case 3: return 6.0 * piece[4];
        default: return 0.0;
        }
    }
}
";

const RUST_CURVE: &str = "\
/// Derivative of an order (0: the value) of a cubic spline; a piece is its left knot and its cubic in the distance from there.
fn NAME_curve(pieces: &[[f64; 5]], low: f64, high: f64, order: u8, x: f64) -> f64 {
    if !(x >= low && x <= high) {
        return f64::NAN;
    }
    let [knot, a, b, c, d] = pieces[pieces.partition_point(|piece| piece[0] <= x).max(1) - 1];
    let t = x - knot;
    match order {
        0 => a + t * (b + t * (c + t * d)),
        1 => b + t * (2.0 * c + t * 3.0 * d),
        2 => 2.0 * c + t * 6.0 * d,
        3 => 6.0 * d,
        _ => 0.0,
    }
}
";

const JAVASCRIPT_CURVE: &str = "\
/** Derivative of an order (0: the value) of a cubic spline; a piece is its left knot and its cubic in the distance from there. */
function NAME_curve(pieces, low, high, order, x) {
    if (!(x >= low && x <= high)) {
        return NaN;
    }
    let first = 0, last = pieces.length - 1;
    while (first < last) {
        const middle = (first + last + 1) >> 1;
        if (pieces[middle][0] <= x) {
            first = middle;
        } else {
            last = middle - 1;
        }
    }
    const [knot, a, b, c, d] = pieces[first];
    const t = x - knot;
    switch (order) {
        case 0: return a + t * (b + t * (c + t * d));
        case 1: return b + t * (2.0 * c + t * 3.0 * d);
        case 2: return 2.0 * c + t * 6.0 * d;
        case 3: return 6.0 * d;
        default: return 0.0;
    }
}
";

// Math.pow has no number for powers of 1 and -1 that the standard of floating-point numbers has one for
const JAVASCRIPT_POW: &str = "\
function NAME_pow(x, y) {
    return x === 1.0 || (x === -1.0 && Math.abs(y) === Infinity) ? 1.0 : Math.pow(x, y);
}
";
