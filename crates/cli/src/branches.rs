//! What `flank solve` tells of branches: which there are where several qualify, and where none is excluded.

use std::fmt::Write;

use flank_chain_dsl::{Bounded, Coordinate, Dimension, GeneratedSurface};
use flank_export::fixed;
use flank_expr::{ScalarEvaluator, Tape};
use flank_solver::{Doubt, Outcome, Range, SurfacePoint};
use serde_json::{Value, json};

use crate::table::Solved;
use crate::units;

/// Of values in messages.
const DECIMALS: usize = 4;

/// The branches of each surface whose ranges hold several that qualify, with what would select each; empty if none does.
pub(crate) fn ambiguous(solved: &[Solved<'_, '_>]) -> String {
    let refused = |solved: &&Solved<'_, '_>| solved.summary.count(Outcome::Ambiguous) > 0;
    solved.iter().filter(refused).map(|solved| listed(solved.surface, &solved.branches, &anchor(solved))).collect()
}

/// The branches of a surface at a place, with what would select each.
pub(crate) fn listed(surface: &GeneratedSurface<'_>, branches: &[SurfacePoint], at: &str) -> String {
    let (name, unknowns) = (&surface.name, &surface.unknowns);
    let mut out = format!("ambiguous: the ranges of {name} hold {} branches at {at}\n", branches.len());
    let chosen = tells_apart(branches, unknowns);
    for (number, branch) in branches.iter().enumerate() {
        let values: Vec<String> = unknowns.iter().zip(&branch.unknowns).map(|(u, x)| named(u, *x)).collect();
        let [x, y, z] = branch.position.map(|x| fixed(x, DECIMALS));
        let _ = writeln!(out, "  {}: {}, at [{x}, {y}, {z}] mm", number + 1, values.join(", "));
        if let Some(unknown) = chosen {
            let (low, high) = around(branches, number, &unknowns[unknown], unknown);
            let of = &unknowns[unknown];
            let _ = writeln!(out, "     keep {}: {} .. {}", of.name, value(of, low), value(of, high));
        }
    }
    let _ = writeln!(
        out,
        "  which one is meant? Put its `keep` into `sample {name}`, or narrow the ranges. All are of the same tool: where it leaves \
         parts of several on the work, as with run-out, make a surface of each and `trim` them by each other"
    );
    out
}

/// The branches that the sample's `keep` does not take, where it takes none, with the values that it looks at, and what it takes:
/// `keep` leaves out all that is at …: roll 3 deg, …; nothing otherwise.
pub(crate) fn kept_out(solved: &Solved<'_, '_>) -> Option<String> {
    let (unknowns, keep) = (&solved.surface.unknowns, &solved.sample.keep);
    let is_unknown = |of: &Coordinate<'_>| unknowns.iter().any(|unknown| unknown.variable == of.value);
    let derived: Vec<&Coordinate<'_>> = keep.iter().map(|(of, _)| of).filter(|of| !is_unknown(of)).collect();
    let each = solved.kept_out.iter().map(|branch| {
        let known = unknowns.iter().zip(&branch.unknowns).map(|(u, x)| named(u, *x));
        let seen = derived.iter().zip(values_at(solved, &derived, branch));
        let seen = seen.map(|(of, x)| format!("{} {}", of.name, units::text(of.dimension, x, DECIMALS)));
        known.chain(seen).collect::<Vec<String>>().join(", ")
    });
    let each: Vec<String> = each.collect();
    let last = |count| if count == 1 { "the only branch" } else { "all branches" };
    let taken = keep.iter().map(|(of, (low, high))| {
        let [low, high] = [low, high].map(|x| units::digits(of.dimension, *x, DECIMALS));
        format!("{} {low} .. {high} {}", of.name, units::symbol(of.dimension)).trim_end().to_string()
    });
    let taken: Vec<String> = taken.collect();
    (!each.is_empty()).then(|| {
        let (which, place) = (last(each.len()), anchor(solved));
        format!("`keep` leaves out {which} at {place}: {}; it takes {}", each.join("; "), taken.join(", "))
    })
}

/// What some functions on a surface are at a point of it.
fn values_at(solved: &Solved<'_, '_>, of: &[&Coordinate<'_>], point: &SurfacePoint) -> Vec<f64> {
    let Some(first) = of.first() else { return Vec::new() };
    let values: Vec<_> = of.iter().map(|of| of.value).collect();
    let values = first.value.graph().substitute(&values, &solved.bindings);
    let tape =
        Tape::new(&values, &solved.surface.surface.unknowns).expect("a job without errors leaves nothing unbound");
    let mut out = vec![f64::NAN; values.len()];
    ScalarEvaluator::new(&tape).run(&point.unknowns, &mut out);
    out
}

/// Where the branch of a surface was not looked for as it is meant: in the middle of its grid, until it is found; empty if it was.
pub(crate) fn begun(solved: &[Solved<'_, '_>]) -> String {
    let mut out = String::new();
    for solved in solved {
        let (name, at) = (&solved.surface.name, anchor(solved));
        if solved.effort.is_kept_elsewhere {
            let _ = writeln!(
                out,
                "note: no branch of {name} has a point in the middle of its grid: what its `keep` asks for was looked at {at}"
            );
        }
        if solved.effort.is_given_up {
            let _ = writeln!(
                out,
                "note: no point of {name} was found at those of its sample that were tried ({} boxes looked at); a sample \
                 whose middle lies on the surface needs fewer",
                solved.effort.boxes
            );
        }
    }
    out
}

/// What could not be decided of the ranges of each surface; empty if everything could.
pub(crate) fn undecided(solved: &[Solved<'_, '_>]) -> String {
    let mut out = String::new();
    for solved in solved.iter().filter(|solved| !solved.effort.undecided.is_empty()) {
        let (count, boxes) = (solved.effort.undecided.len(), solved.effort.boxes);
        let name = &solved.surface.name;
        let many = if count == 1 { "a part" } else { "parts" };
        let _ = writeln!(
            out,
            "note: further branches of {name} are not excluded in {many} of its ranges at {} ({boxes} boxes looked at)",
            anchor(solved)
        );
        const SHOWN: usize = 3;
        for doubt in solved.effort.undecided.iter().take(SHOWN) {
            let sides = solved.surface.unknowns.iter().zip(&doubt.ranges);
            let sides: Vec<String> = sides
                .map(|(u, range)| format!("{} {} .. {}", u.name, value(u, range.low), value(u, range.high)))
                .collect();
            let _ = writeln!(out, "  {}: {}", sides.join(", "), why(doubt.why));
        }
        if count > SHOWN {
            let _ = writeln!(out, "  and {} more", count - SHOWN);
        }
    }
    out
}

/// The branches of a surface at the place where they were looked for, and what is not excluded there.
pub(crate) fn json(solved: &Solved<'_, '_>) -> Value {
    let unknowns = &solved.surface.unknowns;
    let range = |of: &Bounded<'_>, low: f64, high: f64| {
        let [low, high] = [low, high].map(|x| units::shown(of.dimension, x));
        json!({ "name": of.name, "unit": units::symbol(of.dimension), "low": low, "high": high })
    };
    let chosen = tells_apart(&solved.branches, unknowns).filter(|_| solved.branches.len() > 1);
    let branch = |(number, branch): (usize, &SurfacePoint)| {
        let values = unknowns.iter().zip(&branch.unknowns);
        let values: Vec<Value> = values
            .map(|(of, x)| json!({ "name": of.name, "unit": units::symbol(of.dimension), "value": units::shown(of.dimension, *x) }))
            .collect();
        let keep = chosen.map(|k| {
            let (low, high) = around(&solved.branches, number, &unknowns[k], k);
            range(&unknowns[k], low, high)
        });
        json!({ "unknowns": values, "position": branch.position, "keep": keep })
    };
    let sides = |ranges: &[Range]| {
        unknowns.iter().zip(ranges).map(|(of, side)| range(of, side.low, side.high)).collect::<Vec<Value>>()
    };
    let undecided = solved.effort.undecided.iter();
    let undecided = undecided.map(|doubt| json!({ "ranges": sides(&doubt.ranges), "why": why(doubt.why) }));
    json!({
        "boxes": solved.effort.boxes,
        "found": solved.branches.iter().enumerate().map(branch).collect::<Vec<Value>>(),
        "undecided": undecided.collect::<Vec<Value>>(),
    })
}

/// The place at which branches were looked for.
pub(crate) fn anchor(solved: &Solved<'_, '_>) -> String {
    place(&solved.sample.coordinates, solved.effort.anchor)
}

/// Two coordinates with their values.
pub(crate) fn place([a, b]: &[Coordinate<'_>; 2], [x, y]: [f64; 2]) -> String {
    let show = |name: &str, dimension: Dimension, x: f64| format!("{name} {}", units::text(dimension, x, DECIMALS));
    format!("{}, {}", show(&a.name, a.dimension, x), show(&b.name, b.dimension, y))
}

/// The unknown in which the nearest two branches are farthest apart, as a share of its range.
fn tells_apart(branches: &[SurfacePoint], unknowns: &[Bounded<'_>]) -> Option<usize> {
    let gap = |k: usize| {
        let mut values: Vec<f64> = branches.iter().map(|branch| branch.unknowns[k]).collect();
        values.sort_by(f64::total_cmp);
        let least = values.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
        least / (unknowns[k].high - unknowns[k].low)
    };
    // what the decimals can tell apart
    (0..unknowns.len()).filter(|&k| gap(k) > 1e-3).max_by(|&a, &b| gap(a).total_cmp(&gap(b)))
}

/// From halfway to the branch below to halfway to the one above.
fn around(branches: &[SurfacePoint], number: usize, of: &Bounded<'_>, unknown: usize) -> (f64, f64) {
    let at = branches[number].unknowns[unknown];
    let others = branches.iter().map(|branch| branch.unknowns[unknown]);
    let below = others.clone().filter(|x| *x < at).reduce(f64::max).map_or(of.low, |x| 0.5 * (x + at));
    let above = others.filter(|x| *x > at).reduce(f64::min).map_or(of.high, |x| 0.5 * (x + at));
    (below, above)
}

fn why(doubt: Doubt) -> &'static str {
    match doubt {
        Doubt::Singular => "the equations are singular there",
        Doubt::Undefined => "the equations are not smooth everywhere there",
        Doubt::Budget => "too many boxes; narrower ranges need fewer",
    }
}

fn named(of: &Bounded<'_>, x: f64) -> String {
    format!("{} {}", of.name, value(of, x))
}

fn value(of: &Bounded<'_>, x: f64) -> String {
    units::text(of.dimension, x, DECIMALS)
}
