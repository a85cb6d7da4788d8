//! What `flank solve` tells of branches: which there are where several qualify, and where none is excluded.

use std::fmt::Write;

use flank_chain_dsl::{Coordinate, Dimension, GeneratedSurface, RangedVariable};
use flank_export::fixed;
use flank_expr::{ScalarEvaluator, Tape};
use flank_solver::{Doubt, Outcome, Range, SurfacePoint};

use crate::project::not_done::{NotDone, NotDoneKind};
use crate::project::quantity::{Extent, NamedValue};
use crate::project::units;
use crate::solve::keep::{self, Keep};
use crate::solve::result::{BranchPoint, BranchSearch, OpenRanges};
use crate::solve::table::Solved;

/// Of values in messages.
const DECIMALS: usize = 4;

/// The branches of each surface whose ranges hold several that qualify, with what would select each.
pub(crate) fn ambiguous(solved: &[Solved<'_, '_>]) -> Vec<NotDone> {
    let refused = |solved: &&Solved<'_, '_>| solved.summary.count(Outcome::Ambiguous) > 0;
    let told = |solved: &Solved<'_, '_>| {
        let places = &solved.effort.places;
        let at = if places.is_empty() { anchor(solved) } else { "different places of its sample".to_string() };
        listed_with(solved.surface, &solved.branches, &proposed(solved), &at, |number| {
            let at = places.get(number).map(|target| place(&solved.sample.coordinates, *target));
            at.map_or_else(String::new, |at| format!("{at}: "))
        })
    };
    solved.iter().filter(refused).map(told).collect()
}

/// What would select each of the branches of a surface.
fn proposed(solved: &Solved<'_, '_>) -> Vec<Keep> {
    keep::proposed(&solved.surface.unknowns, &solved.branches, &solved.effort.courses)
}

/// The branches of a surface at a place, with what would select each.
pub(crate) fn listed(surface: &GeneratedSurface<'_>, branches: &[SurfacePoint], at: &str) -> NotDone {
    let keeps = keep::proposed(&surface.unknowns, branches, &[]);
    listed_with(surface, branches, &keeps, at, |_| String::new())
}

/// The same with what selects each, and where each is.
fn listed_with(
    surface: &GeneratedSurface<'_>,
    branches: &[SurfacePoint],
    keeps: &[Keep],
    at: &str,
    place: impl Fn(usize) -> String,
) -> NotDone {
    let (name, unknowns) = (&surface.name, &surface.unknowns);
    let mut out = format!("ambiguous: the ranges of {name} hold {} branches at {at}\n", branches.len());
    for (number, branch) in branches.iter().enumerate() {
        let values: Vec<String> = unknowns.iter().zip(&branch.unknowns).map(|(u, x)| named(u, *x)).collect();
        let [x, y, z] = branch.position.map(|x| fixed(x, DECIMALS));
        let place = place(number);
        let _ = writeln!(out, "  {}: {place}{}, at [{x}, {y}, {z}] mm", number + 1, values.join(", "));
        if let Some(keep) = keeps.get(number) {
            let _ = writeln!(out, "     {}", keep.text());
        }
    }
    let _ = writeln!(
        out,
        "  which one is meant? Put its `keep` into `sample {name}`, or narrow the ranges. All are of the same tool: where it leaves \
         parts of several on the work, as with run-out, make a surface of each and `trim` them by each other"
    );
    NotDone::new(NotDoneKind::Ambiguous, name, out)
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

/// Branches that have points in the ranges at other places of the sample, and none of the points; empty if none is known.
pub(crate) fn elsewhere(solved: &[Solved<'_, '_>]) -> String {
    let mut out = String::new();
    for solved in solved.iter().filter(|solved| !solved.elsewhere.is_empty()) {
        let (name, unknowns) = (&solved.surface.name, &solved.surface.unknowns);
        let many = if solved.elsewhere.len() == 1 {
            "another branch".to_string()
        } else {
            format!("{} other branches", solved.elsewhere.len())
        };
        let _ = writeln!(
            out,
            "note: the ranges of {name} hold {many} that {} not among its points",
            if solved.elsewhere.len() == 1 { "is" } else { "are" }
        );
        for (told, (root, beside)) in solved.effort.elsewhere.iter().zip(&solved.elsewhere) {
            let values: Vec<String> = unknowns.iter().zip(&root.unknowns).map(|(u, x)| named(u, *x)).collect();
            let [x, y, z] = root.position.map(|x| fixed(x, DECIMALS));
            let _ = writeln!(
                out,
                "  at {}: {}, at [{x}, {y}, {z}] mm",
                place(&solved.sample.coordinates, told.place),
                values.join(", ")
            );
            if let Some(keep) = selecting(solved, root, beside.as_ref()) {
                let _ = writeln!(out, "     {} would select it", keep.text());
            }
        }
    }
    out
}

/// What selects a branch at another place: against the point of the surface's own branch there, else against any solved one.
fn selecting(solved: &Solved<'_, '_>, root: &SurfacePoint, beside: Option<&SurfacePoint>) -> Option<Keep> {
    let own = beside.or(solved.points.iter().find(|point| point.outcome == Outcome::Solved))?;
    keep::against(&solved.surface.unknowns, own, root)
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
        let _ = writeln!(out, "  {}", what_decides(solved));
    }
    out
}

/// What would decide whether there are further branches.
fn what_decides(solved: &Solved<'_, '_>) -> String {
    let unknowns = &solved.surface.unknowns;
    let share = |k: usize| {
        let widest = solved.effort.undecided.iter().map(|doubt| doubt.ranges[k].high - doubt.ranges[k].low);
        widest.fold(0.0, f64::max) / (unknowns[k].high - unknowns[k].low)
    };
    // of what was hardly divided, the widest
    let open: Vec<&str> = (0..unknowns.len()).filter(|&k| share(k) > 0.5).map(|k| unknowns[k].name.as_str()).collect();
    let narrower = match open[..] {
        [] => String::new(),
        _ => format!("a narrower range of {}, ", open.join(" or ")),
    };
    let more = if solved.effort.undecided.iter().any(|doubt| doubt.why == Doubt::Budget) {
        format!(" or a longer search, the option `boxes {}`,", 10 * solved.effort.boxes.max(1))
    } else {
        String::new()
    };
    format!("{narrower}a `keep` of one of them{more} would decide it")
}

/// The branches of a surface at the place where they were looked for, and what is not excluded there.
pub(crate) fn search(solved: &Solved<'_, '_>) -> BranchSearch {
    let unknowns = &solved.surface.unknowns;
    let keeps = proposed(solved);
    let branch = |branch: &SurfacePoint, keep: Option<&Keep>| {
        let values = unknowns.iter().zip(&branch.unknowns);
        BranchPoint {
            unknowns: values.map(|(of, x)| NamedValue::new(&of.name, of.dimension, *x)).collect(),
            position: branch.position,
            keep: keep.map(Keep::extent),
        }
    };
    let found = solved.branches.iter().enumerate().map(|(number, root)| branch(root, keeps.get(number)));
    let elsewhere = solved.elsewhere.iter();
    let elsewhere = elsewhere.map(|(root, beside)| branch(root, selecting(solved, root, beside.as_ref()).as_ref()));
    let sides = |ranges: &[Range]| {
        let sides = unknowns.iter().zip(ranges);
        sides.map(|(of, side)| Extent::new(&of.name, of.dimension, Some((side.low, side.high)))).collect()
    };
    let undecided = solved.effort.undecided.iter();
    let undecided = undecided.map(|doubt| OpenRanges { ranges: sides(&doubt.ranges), why: why(doubt.why) });
    BranchSearch {
        boxes: solved.effort.boxes,
        found: found.collect(),
        undecided: undecided.collect(),
        elsewhere: elsewhere.collect(),
    }
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

fn why(doubt: Doubt) -> &'static str {
    match doubt {
        Doubt::Singular => "the equations are singular there",
        Doubt::Undefined => "the equations are not smooth everywhere there",
        Doubt::Budget => "too many boxes",
    }
}

fn named(of: &RangedVariable<'_>, x: f64) -> String {
    format!("{} {}", of.name, value(of, x))
}

fn value(of: &RangedVariable<'_>, x: f64) -> String {
    units::text(of.dimension, x, DECIMALS)
}
