//! Random numbers of cases: each depends on the seed, the number of the case and the name of what scatters alone.

use flank_expr::Unary;
use sha2::{Digest, Sha256};

/// Settings that points of Sobol's sequence can scatter.
pub(super) const MOST_SOBOL: usize = 21;
/// No normal number is farther from its mean, in standard deviations: shares have [`DIGITS`] binary digits.
pub(super) const FARTHEST: f64 = 8.3;
/// Binary digits of a point.
const DIGITS: usize = 52;
/// Degree and coefficients of the primitive polynomials of dimensions 2 to 21, and the first direction numbers (Joe, Kuo 2008,
/// `new-joe-kuo-6`).
const DIRECTIONS: [(u32, u64, &[u64]); MOST_SOBOL - 1] = [
    (1, 0, &[1]),
    (2, 1, &[1, 3]),
    (3, 1, &[1, 3, 1]),
    (3, 2, &[1, 1, 1]),
    (4, 1, &[1, 1, 3, 3]),
    (4, 4, &[1, 3, 5, 13]),
    (5, 2, &[1, 1, 5, 5, 17]),
    (5, 4, &[1, 1, 5, 5, 5]),
    (5, 7, &[1, 1, 7, 11, 19]),
    (5, 11, &[1, 1, 5, 1, 1]),
    (5, 13, &[1, 1, 1, 3, 11]),
    (5, 14, &[1, 3, 5, 5, 31]),
    (6, 1, &[1, 3, 3, 9, 7, 49]),
    (6, 13, &[1, 1, 1, 15, 21, 21]),
    (6, 16, &[1, 3, 1, 13, 27, 49]),
    (6, 19, &[1, 1, 1, 15, 7, 5]),
    (6, 22, &[1, 3, 1, 15, 13, 25]),
    (6, 25, &[1, 1, 5, 5, 19, 61]),
    (7, 1, &[1, 3, 7, 11, 23, 15, 103]),
    (7, 4, &[1, 3, 7, 13, 13, 15, 69]),
];

/// Above 0 and below 1: an independent number for each case and name.
pub(super) fn independent(seed: u64, case: u64, name: &str) -> f64 {
    let mut hash = Sha256::new();
    hash.update(seed.to_le_bytes());
    hash.update(case.to_le_bytes());
    hash.update(name.as_bytes());
    let bytes: [u8; 32] = hash.finalize().into();
    let [a, b, c, d, e, f, g, h, ..] = bytes;
    within(u64::from_le_bytes([a, b, c, d, e, f, g, h]) >> (64 - DIGITS))
}

/// The same of a point of Sobol's sequence, shifted by an amount that the seed and the name give (Cranley, Patterson 1976): coordinate
/// `dimension` of point `case`.
///
/// # Panics
/// If there are not so many dimensions.
pub(super) fn sobol(seed: u64, case: u64, (dimension, name): (usize, &str)) -> f64 {
    let digits = directions(dimension).into_iter().enumerate();
    let gray = case ^ (case >> 1);
    let chosen = digits.filter(|(k, _)| *k < 64 && gray >> k & 1 == 1);
    let point = chosen.fold(0, |point, (_, direction)| point ^ direction);
    let shift = (independent(seed, u64::MAX, name) * (1u64 << DIGITS) as f64) as u64;
    within((point + shift) & ((1 << DIGITS) - 1))
}

/// A number of so many binary digits in the middle of its cell.
fn within(digits: u64) -> f64 {
    (digits as f64 + 0.5) / (1u64 << DIGITS) as f64
}

/// The direction numbers of a dimension, counted from 0.
fn directions(dimension: usize) -> [u64; DIGITS] {
    let mut found = [0; DIGITS];
    let Some((degree, coefficients, first)) = dimension.checked_sub(1).map(|k| DIRECTIONS[k]) else {
        found.iter_mut().enumerate().for_each(|(k, direction)| *direction = 1 << (DIGITS - 1 - k));
        return found;
    };
    let degree = degree as usize;
    for k in 0..DIGITS {
        found[k] =
            match first.get(k) {
                Some(odd) => odd << (DIGITS - 1 - k),
                None => {
                    let far = found[k - degree];
                    let own = far ^ (far >> degree);
                    (1..degree).fold(own, |sum, j| {
                        if coefficients >> (degree - 1 - j) & 1 == 1 { sum ^ found[k - j] } else { sum }
                    })
                }
            };
    }
    found
}

/// The number below which a share of all normal ones of mean zero and variance one lies (Wichura 1988, algorithm AS 241, to 16 digits);
/// its logarithm has the same bits on every machine.
pub(super) fn normal(share: f64) -> f64 {
    let from_middle = share - 0.5;
    if from_middle.abs() <= 0.425 {
        let r = 0.180_625 - from_middle * from_middle;
        return from_middle * ratio(r, &MIDDLE);
    }
    let r = (-Unary::Ln.apply(share.min(1.0 - share))).sqrt();
    let size = if r <= 5.0 { ratio(r - 1.6, &TAIL) } else { ratio(r - 5.0, &FAR) };
    if from_middle < 0.0 { -size } else { size }
}

/// Of two polynomials of the seventh degree, the constants last.
fn ratio(r: f64, [above, below]: &[[f64; 8]; 2]) -> f64 {
    let value = |polynomial: &[f64; 8]| polynomial.iter().fold(0.0, |sum, coefficient| sum * r + coefficient);
    value(above) / value(below)
}

#[expect(clippy::excessive_precision, reason = "as they are published")]
const MIDDLE: [[f64; 8]; 2] = [
    [
        2.509_080_928_730_122_6e3,
        3.343_057_558_358_812_8e4,
        6.726_577_092_700_870_1e4,
        4.592_195_393_154_987_1e4,
        1.373_169_376_550_946_1e4,
        1.971_590_950_306_551_4e3,
        1.331_416_678_917_843_8e2,
        3.387_132_872_796_366_6,
    ],
    [
        5.226_495_278_852_854_6e3,
        2.872_908_573_572_194_3e4,
        3.930_789_580_009_271e4,
        2.121_379_430_158_659_6e4,
        5.394_196_021_424_751e3,
        6.871_870_074_920_579_1e2,
        4.231_333_070_160_091_1e1,
        1.0,
    ],
];
#[expect(clippy::excessive_precision, reason = "as they are published")]
const TAIL: [[f64; 8]; 2] = [
    [
        7.745_450_142_783_414_1e-4,
        2.272_384_498_926_918_5e-2,
        2.417_807_251_774_506_1e-1,
        1.270_458_252_452_368_4,
        3.647_848_324_763_204_6,
        5.769_497_221_460_691_4,
        4.630_337_846_156_545_3,
        1.423_437_110_749_683_6,
    ],
    [
        1.050_750_071_644_416_8e-9,
        5.475_938_084_995_345e-4,
        1.519_866_656_361_645_7e-2,
        1.481_039_764_274_800_7e-1,
        6.897_673_349_851_000_5e-1,
        1.676_384_830_183_803_8,
        2.053_191_626_637_758_8,
        1.0,
    ],
];
#[expect(clippy::excessive_precision, reason = "as they are published")]
const FAR: [[f64; 8]; 2] = [
    [
        2.010_334_399_292_288_1e-7,
        2.711_555_568_743_487_6e-5,
        1.242_660_947_388_078_4e-3,
        2.653_218_952_657_612_3e-2,
        2.965_605_718_285_048_9e-1,
        1.784_826_539_917_291_3,
        5.463_784_911_164_114_4,
        6.657_904_643_501_103_8,
    ],
    [
        2.044_263_103_389_939_8e-15,
        1.421_511_758_316_445_9e-7,
        1.846_318_317_510_054_7e-5,
        7.868_691_311_456_132_6e-4,
        1.487_536_129_085_061_5e-2,
        1.369_298_809_227_358_1e-1,
        5.998_322_065_558_879_4e-1,
        1.0,
    ],
];

#[cfg(test)]
mod tests {
    use super::*;

    /// The first points as Joe and Kuo print them: in one dimension 0, 1/2, 3/4, 1/4, 3/8, 7/8, 5/8, 1/8.
    #[test]
    fn points_are_those_of_the_sequence() {
        let unshifted = |case: u64, dimension: usize| {
            let gray = case ^ (case >> 1);
            let found = directions(dimension).into_iter().enumerate().filter(|(k, _)| gray >> k & 1 == 1);
            found.fold(0, |sum, (_, direction)| sum ^ direction) as f64 / (1u64 << DIGITS) as f64
        };
        let first: Vec<[f64; 3]> = (0..8).map(|case| [0, 1, 2].map(|dimension| unshifted(case, dimension))).collect();
        let known = [
            [0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5],
            [0.75, 0.25, 0.25],
            [0.25, 0.75, 0.75],
            [0.375, 0.375, 0.625],
            [0.875, 0.875, 0.125],
            [0.625, 0.125, 0.875],
            [0.125, 0.625, 0.375],
        ];
        assert_eq!(first, known);
    }

    /// Each dimension puts one of 2^k points into each of 2^k cells, whatever the shift.
    #[test]
    fn points_of_every_dimension_are_spread_evenly() {
        for dimension in 0..MOST_SOBOL {
            let mut cells = [0; 256];
            (0..256).for_each(|case| cells[(sobol(3, case, (dimension, "x")) * 256.0) as usize] += 1);
            // a shift moves points over the borders of cells, by at most one point a cell
            assert!(cells.iter().all(|count| *count <= 2), "{dimension}: {cells:?}");
            let cells: Vec<u64> = (0..256).map(|case| directions_point(case, dimension) >> (DIGITS - 8)).collect();
            let mut sorted = cells.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, (0..256).collect::<Vec<u64>>(), "{dimension}");
        }
    }

    fn directions_point(case: u64, dimension: usize) -> u64 {
        let gray = case ^ (case >> 1);
        let found = directions(dimension).into_iter().enumerate().filter(|(k, _)| gray >> k & 1 == 1);
        found.fold(0, |sum, (_, direction)| sum ^ direction)
    }

    /// Quantiles of the normal distribution to 16 digits, from tables: 0.975, 0.999, 1e-10.
    #[test]
    fn quantiles_are_those_of_tables() {
        for (share, known) in [
            (0.5, 0.0),
            (0.975, 1.959_963_984_540_054),
            (0.999, 3.090_232_306_167_813_5),
            (1e-10, -6.361_340_902_404_056),
        ] {
            assert!((normal(share) - known).abs() <= 2e-15 * known.abs().max(1.0), "{share}: {}", normal(share));
        }
    }

    #[test]
    fn no_normal_number_is_farther_than_the_farthest() {
        let ends = [within(0), within((1 << DIGITS) - 1)].map(normal);
        assert!(ends.iter().all(|end| end.abs() < FARTHEST && end.abs() > FARTHEST - 0.2), "{ends:?}");
    }

    #[test]
    fn numbers_depend_on_seed_case_and_name_alone() {
        assert_eq!(independent(1, 5, "m.a").to_bits(), independent(1, 5, "m.a").to_bits());
        let others = [independent(2, 5, "m.a"), independent(1, 6, "m.a"), independent(1, 5, "m.b")];
        assert!(others.iter().all(|other| *other != independent(1, 5, "m.a")));
        let mean = (0..10_000).map(|case| independent(7, case, "x")).sum::<f64>() / 1e4;
        // four standard errors: 4 / (√12 · 100)
        assert!((mean - 0.5).abs() < 0.0116, "{mean}");
    }
}
