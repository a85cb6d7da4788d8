//! What two neighbouring passes leave between them, and what a straight block leaves along its pass.

use crate::milling::height::lowest;
use crate::milling::outline::Cutter;
use crate::milling::series::PoseSeries;

/// Steps of a bracketed root at the most.
const MOST_STEPS: u32 = 200;
/// A root is as near as this share of its bracket.
const CLOSE: f64 = 1e-15;
/// What lies within this share of an end of a block is beside it.
const ENDS: f64 = 0.05;
/// Steps of a search for a peak at the most ...
const SECTIONS: u32 = 60;
/// ... which is as near as this share of the way between its ends: the value then lacks the square of that.
const SECTION: f64 = 1e-7;
/// Steps of a search beside a pass, and by how much they get shorter.
const STEPS_BESIDE: u32 = 6;
const NEARER: f64 = 0.25;
/// It ends where a parabola brings less than this, mm.
const LOWER: f64 = 1e-12;

/// The ridge between two passes at a place along them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cusp {
    /// The share across all passes at which both are equally high.
    pub share: f64,
    /// How high it stands, mm.
    pub height: f64,
}

/// The ridge between the passes at two shares, on the line `across` the surface at the share `along` of each pass: where both leave the same.
///
/// `None` if a pass does not reach that far.
pub fn cusp(
    across: &PoseSeries,
    passes: [&PoseSeries; 2],
    shares: [f64; 2],
    along: f64,
    cutter: &Cutter,
) -> Option<Cusp> {
    let mut near = [along; 2];
    // a pass that does not reach leaves all
    let mut heights = |share: f64| -> Option<[f64; 2]> {
        let line = across.at(share);
        let mut out = [f64::INFINITY; 2];
        for k in [0, 1] {
            if let Some(found) = lowest(passes[k], cutter, &line, near[k]) {
                (out[k], near[k]) = (found.height, found.share);
            }
        }
        out.iter().any(|height| height.is_finite()).then_some(out)
    };
    let [mut low, mut high] = shares;
    let difference = |[a, b]: [f64; 2]| a - b;
    let (mut at_low, mut at_high) = (difference(heights(low)?), difference(heights(high)?));
    // passes that cut too deep beside themselves are higher where they are
    let sign = if at_low <= 0.0 && at_high >= 0.0 { 1.0 } else { -1.0 };
    (at_low, at_high) = (sign * at_low, sign * at_high);
    if !(at_low <= 0.0 && at_high >= 0.0) {
        // one pass digs in beside the other: it is lower all the way, and leaves most at one end
        let ends = shares.map(|share| heights(share).map(|[a, b]| Cusp { share, height: a.min(b) }));
        let is_known = at_low.is_finite() && at_high.is_finite();
        return ends.into_iter().flatten().max_by(|a, b| a.height.total_cmp(&b.height)).filter(|_| is_known);
    }
    let mut side = 0;
    let (mut share, mut height) = (low, 0.0);
    for _ in 0..MOST_STEPS {
        let whole = at_high - at_low;
        let is_known = whole > 0.0 && whole.is_finite();
        share = if is_known { (low * at_high - high * at_low) / whole } else { 0.5 * (low + high) };
        let found = heights(share)?;
        height = 0.5 * (found[0] + found[1]);
        let off = sign * difference(found);
        if off.abs() < 1e-14 * (1.0 + height.abs()) || (high - low).abs() < CLOSE {
            break;
        }
        // the Illinois rule: an end that stays counts half
        if off < 0.0 {
            (low, at_low) = (share, off);
            if side == -1 {
                at_high *= 0.5;
            }
            side = -1;
        } else {
            (high, at_high) = (share, off);
            if side == 1 {
                at_low *= 0.5;
            }
            side = 1;
        }
    }
    height.is_finite().then_some(Cusp { share, height })
}

/// What a block leaves along its pass, with the share of the pass: the extreme farther from `stock`, mm.
///
/// `surface` is the pass on the surface, `block` the cutter from the one share to the other. `None` if the cutter is not found there.
pub fn left_by_block(
    surface: &PoseSeries,
    block: &PoseSeries,
    [from, to]: [f64; 2],
    cutter: &Cutter,
    stock: f64,
) -> Option<Cusp> {
    let left = |share: f64| {
        let near = (share - from) / (to - from);
        lowest(block, cutter, &surface.at(share), near).map(|found| found.height - stock)
    };
    // the middle tells which way it goes
    let middle = left(0.5 * (from + to))?;
    let sign = if middle < 0.0 { -1.0 } else { 1.0 };
    // an edge meets what lies beside an end of its block in the next one; at the ends a block is where it should be
    let is_end = |share: f64| (share - from).min(to - share) < ENDS * (to - from);
    let value = |share: f64| match left(share) {
        None if is_end(share) => Some(f64::NEG_INFINITY),
        left => left.map(|left| sign * left),
    };
    let found = peak([from, to], value)?;
    Some(Cusp { share: found.0, height: stock + sign * found.1 })
}

/// The lowest that a block passes over the line `across` the surface, with the share of that line: from one share on, in steps that begin with `apart`.
///
/// A block that goes straight where its pass bends within the surface lies beside it, and is deepest there. Heights across a pass are nearly
/// those of a parabola, from three of which the next is found.
pub fn lowest_beside(
    across: &PoseSeries,
    block: &PoseSeries,
    (start, mut apart): (f64, f64),
    near: f64,
    cutter: &Cutter,
) -> Option<Cusp> {
    let height = |share: f64| lowest(block, cutter, &across.at(share), near).map(|found| found.height);
    let mut best = Cusp { share: start, height: height(start)? };
    for _ in 0..STEPS_BESIDE {
        let [before, after] = [-apart, apart].map(|by| height(best.share + by));
        let (Some(before), Some(after)) = (before, after) else {
            // so far away the cutter does not pass
            apart *= NEARER;
            continue;
        };
        let (slope, bend) = (0.5 * (after - before), before - 2.0 * best.height + after);
        let by = if bend > 0.0 { (-slope / bend).clamp(-1.0, 1.0) } else { -slope.signum() };
        let found = height(best.share + by * apart).map(|height| Cusp { share: best.share + by * apart, height });
        let lower = found.map(|found| best.height - found.height);
        best = found.filter(|found| found.height < best.height).unwrap_or(best);
        if by.abs() < 1.0 && lower.is_some_and(|lower| lower.abs() < LOWER) {
            break;
        }
        apart *= if by.abs() < 1.0 { NEARER } else { 1.0 };
    }
    Some(best)
}

/// The largest value of a function with one peak between two ends, and where: by parabolas through the best three places, with golden sections
/// where these do not close in (Brent's method).
pub fn peak([mut low, mut high]: [f64; 2], value: impl Fn(f64) -> Option<f64>) -> Option<(f64, f64)> {
    let golden = 0.5 * (3.0 - 5.0f64.sqrt());
    let close = SECTION * (high - low);
    let first = low + golden * (high - low);
    let [mut best, mut second, mut third] = [(first, value(first)?); 3];
    // the step before, and the one before that
    let mut steps = [0.0f64; 2];
    for _ in 0..SECTIONS {
        let middle = 0.5 * (low + high);
        if (best.0 - middle).abs() <= 2.0 * close - 0.5 * (high - low) {
            break;
        }
        let to_end = if best.0 < middle { high - best.0 } else { low - best.0 };
        let by_parabola = vertex([second, best, third]).filter(|place| {
            let is_inside = low + 2.0 * close <= *place && *place <= high - 2.0 * close;
            is_inside && (place - best.0).abs() < 0.5 * steps[1].abs()
        });
        let step = by_parabola.map_or(golden * to_end, |place| place - best.0);
        steps = [step, if by_parabola.is_some() { steps[0] } else { to_end }];
        let share = best.0 + if step.abs() < close { close.copysign(step) } else { step };
        let found = (share, value(share)?);
        if found.1 >= best.1 {
            (low, high) = if share >= best.0 { (best.0, high) } else { (low, best.0) };
            (best, second, third) = (found, best, second);
            continue;
        }
        (low, high) = if share < best.0 { (share, high) } else { (low, share) };
        if found.1 >= second.1 || second.0 == best.0 {
            (second, third) = (found, second);
        } else if found.1 >= third.1 || third.0 == best.0 || third.0 == second.0 {
            third = found;
        }
    }
    Some(best)
}

/// Where the parabola through three places has its peak, if it has one.
fn vertex([a, b, c]: [(f64, f64); 3]) -> Option<f64> {
    let [before, behind] = [a, c].map(|(share, _)| share - b.0);
    let [left, right] = [behind * (b.1 - a.1), before * (b.1 - c.1)];
    let by = 0.5 * (before * right - behind * left) / (right - left);
    by.is_finite().then_some(b.0 + by)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::milling::outline::OutlinePiece;

    /// Far from where it is lowest a small ball does not pass over the line at all.
    #[test]
    fn a_block_is_lowest_beside_places_that_it_does_not_pass() {
        let across = PoseSeries::sampled(3, |share| [4.0 * share - 2.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        let block = PoseSeries::sampled(3, |share| [0.3, share - 0.5, -0.02, 0.0, 0.0, 1.0]);
        let ball = OutlinePiece::Arc { center: [0.0, 1.0], radius: 1.0, between: [0.0, std::f64::consts::FRAC_PI_2] };
        let cutter = Cutter { pieces: vec![ball] };
        for apart in [0.5, 0.3, 0.1] {
            let found = lowest_beside(&across, &block, (0.5, apart), 0.5, &cutter).expect("it passes");
            assert!((found.height + 0.02).abs() < 1e-9 && (found.share - 0.575).abs() < 1e-4, "{apart}: {found:?}");
        }
    }

    #[test]
    fn a_peak_is_found_within_its_ends_and_at_them() {
        let between = [0.2, 0.21];
        let off = |place: f64, value: &dyn Fn(f64) -> f64| {
            let calls = std::cell::Cell::new(0);
            let found = peak(between, |share| {
                calls.set(calls.get() + 1);
                Some(value(share))
            });
            let (share, height) = found.expect("it has values");
            assert!((share - place).abs() < 3e-9 && height == value(share), "{share} {place}");
            calls.get()
        };
        let bow = |share: f64| 0.3 * (share - 0.2) * (0.21 - share) + (share - 0.2).powi(3);
        // 0.3 (0.01 - 2 x) + 3 x^2 = 0
        assert!(off(0.2 + (0.6 - (0.36f64 - 0.036).sqrt()) / 6.0, &bow) < 15);
        assert!(off(0.21, &|share| 5.0 * share) < 60);
        assert!(off(0.2, &|share| -share.powi(3)) < 60);
        // a place that no cutter comes to, as deep as can be
        let cut = |share: f64| if share < 0.2003 { f64::NEG_INFINITY } else { -(share - 0.2071).abs() };
        assert!(off(0.2071, &cut) < 60);
        assert_eq!(peak(between, |_| None), None);
    }
}
