//! The elementary functions against correctly rounded values, over the whole range of arguments.

mod support;

use std::f64::consts::{FRAC_PI_2, PI};

use flank_expr::{Binary, Unary};
use support::Random;

/// A correctly rounded function of one number.
type Oracle = fn(f64) -> f64;

/// Each function and its correctly rounded peer.
const FUNCTIONS: [(Unary, Oracle); 8] = [
    (Unary::Sin, core_math::sin),
    (Unary::Cos, core_math::cos),
    (Unary::Tan, core_math::tan),
    (Unary::Asin, core_math::asin),
    (Unary::Acos, core_math::acos),
    (Unary::Atan, core_math::atan),
    (Unary::Exp, core_math::exp),
    (Unary::Ln, core_math::log),
];

/// How many numbers lie between two, the signs of zeros included.
fn apart(a: f64, b: f64) -> u64 {
    let place = |x: f64| {
        let bits = (x.to_bits() & !(1 << 63)) as i64;
        if x.is_sign_negative() { -bits - 1 } else { bits }
    };
    if a.is_nan() || b.is_nan() {
        return if a.is_nan() && b.is_nan() { 0 } else { u64::MAX };
    }
    place(a).abs_diff(place(b))
}

/// An error below one unit in the last place gives the correctly rounded number or one beside it.
fn check(op: Unary, correct: fn(f64) -> f64, x: f64) {
    let (found, expected) = (op.apply(x), correct(x));
    assert!(apart(found, expected) <= 1, "{}({x:e}) = {found:e}, correctly rounded {expected:e}", op.name());
}

fn check_all(x: f64) {
    for (op, correct) in FUNCTIONS {
        check(op, correct, x);
    }
}

/// Any bits: every exponent is as likely.
fn any(random: &mut Random) -> f64 {
    let word = |random: &mut Random| random.below(1 << 32) as u64;
    f64::from_bits(word(random) << 32 | word(random))
}

#[test]
fn any_number_at_all() {
    let mut random = Random(11);
    for _ in 0..400_000 {
        check_all(any(&mut random));
    }
}

#[test]
fn numbers_of_everyday_size() {
    let mut random = Random(12);
    for _ in 0..400_000 {
        for size in [1.0, 7.0, 1000.0] {
            let x = random.between(-size, size);
            check_all(x);
        }
    }
}

/// Where a multiple of π/2 is nearly met the result is all cancellation; by name the worst of all doubles.
#[test]
fn neighbourhoods_of_quarter_turns() {
    let mut random = Random(13);
    let trigonometric = &FUNCTIONS[..3];
    let check_around = |x: f64| {
        let (mut below, mut above) = (x, x);
        for _ in 0..8 {
            for &(op, correct) in trigonometric {
                for x in [below, above, -below, -above] {
                    check(op, correct, x);
                }
            }
            (below, above) = (below.next_down(), above.next_up());
        }
    };
    for k in 0..30_000 {
        check_around(f64::from(k) * FRAC_PI_2);
        check_around(f64::from(k) * FRAC_PI_2 + 0.5 * FRAC_PI_2);
    }
    for power in 0..1000 {
        check_around((random.between(1.0, 2.0) * 2f64.powi(power) / FRAC_PI_2).round() * FRAC_PI_2);
    }
    // 6381956970095103 · 2⁷⁹⁷ is nearer to a multiple of π/2 than any other double
    check_around(6381956970095103.0 * 2f64.powi(797));
    for edge in [500_000.0, 1e22, f64::MAX, 2f64.powi(120) * PI] {
        check_around(edge);
    }
}

#[test]
fn edges_of_ranges_and_of_domains() {
    let edges = [0.0, 5e-324, 1e-310, f64::MIN_POSITIVE, 1e-300, 1e-160, 1e-9, 1e-8, 0.25, 7.0 / 16.0, 0.5, 0.67434]
        .into_iter()
        .chain([0.71875, 0.5f64.sqrt(), PI / 4.0, 1.0, 1.3913, 2f64.sqrt(), 2.0, 4.0, 709.782712893384, 710.0])
        .chain([745.1332191019411, 745.2, 750.0, 1e10, 1e160, 1e300, f64::MAX, f64::INFINITY, f64::NAN]);
    for edge in edges {
        let (mut below, mut above) = (edge, edge);
        for _ in 0..200 {
            for x in [below, above, -below, -above] {
                check_all(x);
            }
            (below, above) = (below.next_down(), above.next_up());
        }
    }
}

#[test]
fn exponentials_of_every_size_and_logarithms_near_one() {
    let mut random = Random(14);
    for _ in 0..500_000 {
        check(Unary::Exp, core_math::exp, random.between(-746.0, 710.0));
        check(Unary::Ln, core_math::log, random.between(0.5, 2.0));
    }
}

#[test]
fn angles_of_points() {
    let mut random = Random(15);
    let check = |y: f64, x: f64| {
        let (found, expected) = (Binary::Atan2.apply(y, x), core_math::atan2(y, x));
        assert!(apart(found, expected) <= 1, "atan2({y:e}, {x:e}) = {found:e}, correctly rounded {expected:e}");
    };
    for _ in 0..400_000 {
        check(random.between(-1.0, 1.0), random.between(-1.0, 1.0));
        check(any(&mut random), any(&mut random));
        let size = any(&mut random);
        check(size, size * random.between(0.0, 5.0));
    }
    let special = [0.0, 5e-324, 1e-310, 1e-300, 1.0, 1.5, 1e150, 1e300, f64::MAX, f64::INFINITY, f64::NAN];
    let both: Vec<f64> = special.into_iter().flat_map(|x| [x, -x]).collect();
    for &y in &both {
        both.iter().for_each(|&x| check(y, x));
    }
}
