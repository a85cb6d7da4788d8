//! What `flank solve` reports of branches: which there are where several qualify, and where none is excluded.

use flank_chain_dsl::{Coordinate, Dimension, GeneratedSurface, RangedVariable};
use flank_export::fixed;
use flank_expr::{ScalarEvaluator, Tape};
use flank_solver::{Doubt, Outcome, Range, SurfacePoint, Undecided};

use crate::project::quantity::{Extent, NamedValue};
use crate::project::remark::{NotDone, NotDoneKind, Remark, RemarkKind};
use crate::project::units;
use crate::solve::keep::{self, Keep};
use crate::solve::result::{BranchPoint, BranchSearch, OpenRanges};
use crate::solve::solved::Solved;

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
    keep::proposed((&solved.surface.unknowns, &solved.periodic), &solved.branches, &solved.effort.courses)
}

/// The branches of a surface at a place, with what would select each. `courses` are those of a [`GridReport`](flank_solver::GridReport).
pub(crate) fn listed(
    surface: &GeneratedSurface<'_>,
    periodic: &[bool],
    (branches, courses): (&[SurfacePoint], &[Vec<Vec<f64>>]),
    at: &str,
) -> NotDone {
    let keeps = keep::proposed((&surface.unknowns, periodic), branches, courses);
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
    let each = branches.iter().enumerate().map(|(number, branch)| {
        let values: Vec<String> = unknowns.iter().zip(&branch.unknowns).map(|(u, x)| named(u, *x)).collect();
        let [x, y, z] = branch.position.map(|x| fixed(x, DECIMALS));
        let keep = keeps.get(number).map_or_else(String::new, |keep| format!(": `{}`", keep.text()));
        let is_in = unknowns.iter().zip(&branch.unknowns).all(|(u, x)| (u.low..=u.high).contains(x));
        let outside = if is_in { "" } else { ", outside of the ranges there" };
        format!("{}: {}{}, at [{x}, {y}, {z}] mm{outside}{keep}", number + 1, place(number), values.join(", "))
    });
    let choice = match keeps {
        [] => "No `keep` of an unknown tells them apart: narrow the ranges".to_string(),
        _ => format!("Put its `keep` into `sample {name}`, or narrow the ranges"),
    };
    let way_out = format!(
        "which one is meant? {choice}. All are of the same tool: where it leaves parts of several on the work, as with run-out, make a \
         surface of each and `trim` them by each other"
    );
    let message = format!("ambiguous: the ranges of {name} hold {} branches at {at}", branches.len());
    NotDone::new(NotDoneKind::Ambiguous, name, message).with(each.chain([way_out]).collect())
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
    if let Some([one, other]) = disjoint(solved) {
        let (one, other) = (&taken[one], &taken[other]);
        return Some(format!("`keep` takes nothing: {one} and {other} are about the same value, and none is in both"));
    }
    (!each.is_empty()).then(|| {
        let (which, place) = (last(each.len()), anchor(solved));
        format!("`keep` leaves out {which} at {place}: {}; it takes {}", each.join("; "), taken.join(", "))
    })
}

/// Two conditions of a sample's `keep` on one value that no value meets, by their numbers; of a periodic unknown it might be a turn further on.
fn disjoint(solved: &Solved<'_, '_>) -> Option<[usize; 2]> {
    let keep = &solved.sample.keep;
    let known = || solved.surface.unknowns.iter().zip(&solved.periodic);
    let is_periodic = |of: &Coordinate<'_>| known().any(|(unknown, is)| *is && unknown.variable == of.value);
    let pairs = (0..keep.len()).flat_map(|a| (a + 1..keep.len()).map(move |b| [a, b]));
    pairs.into_iter().find(|pair| {
        let [(one, (low, high)), (other, (other_low, other_high))] = pair.map(|k| &keep[k]);
        one.value == other.value && !is_periodic(one) && (high < other_low || other_high < low)
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

/// Where the branch of a surface was not looked for as it is meant: in the middle of its grid, until it is found.
pub(crate) fn begun(solved: &[Solved<'_, '_>]) -> Vec<Remark> {
    let mut out = Vec::new();
    for solved in solved {
        let (name, at) = (&solved.surface.name, anchor(solved));
        if solved.effort.is_kept_elsewhere {
            let message = format!(
                "no branch of {name} was found in the middle of its grid: what its `keep` asks for was looked at {at}"
            );
            out.push(Remark::new(RemarkKind::BegunElsewhere, name, message));
        }
        if solved.effort.is_given_up {
            let message = format!(
                "no point of {name} was found at those of its sample that were tried ({} boxes looked at)",
                solved.effort.boxes
            );
            out.push(Remark::new(RemarkKind::SearchGivenUp, name, message));
        }
    }
    out
}

/// Branches that have points in the ranges at other places of the sample, and none of the points.
pub(crate) fn elsewhere(solved: &[Solved<'_, '_>]) -> Vec<Remark> {
    let told = |solved: &Solved<'_, '_>| {
        let (name, unknowns) = (&solved.surface.name, &solved.surface.unknowns);
        let many = match solved.elsewhere.len() {
            1 => "another branch that is".to_string(),
            count => format!("{count} other branches that are"),
        };
        let each = solved.effort.elsewhere.iter().zip(&solved.elsewhere).map(|(told, (root, beside))| {
            let values: Vec<String> = unknowns.iter().zip(&root.unknowns).map(|(u, x)| named(u, *x)).collect();
            let [x, y, z] = root.position.map(|x| fixed(x, DECIMALS));
            let keep = selecting(solved, root, beside.as_ref());
            let keep = keep.map_or_else(String::new, |keep| format!("; `{}` would select it", keep.text()));
            let at = place(&solved.sample.coordinates, told.place);
            format!("at {at}: {}, at [{x}, {y}, {z}] mm{keep}", values.join(", "))
        });
        let message = format!("the ranges of {name} hold {many} not among its points");
        Remark::new(RemarkKind::OtherBranches, name, message).with(each.collect())
    };
    solved.iter().filter(|solved| !solved.elsewhere.is_empty()).map(told).collect()
}

/// What selects a branch at another place: against the point of the surface's own branch there, else against any solved one.
fn selecting(solved: &Solved<'_, '_>, root: &SurfacePoint, beside: Option<&SurfacePoint>) -> Option<Keep> {
    let own = beside.or(solved.points.iter().find(|point| point.outcome == Outcome::Solved))?;
    keep::against((&solved.surface.unknowns, &solved.periodic), own, root)
}

/// What could not be decided of the ranges of each surface.
pub(crate) fn undecided(solved: &[Solved<'_, '_>]) -> Vec<Remark> {
    const SHOWN: usize = 3;
    let told = |solved: &Solved<'_, '_>| {
        let (count, boxes) = (solved.effort.undecided.len(), solved.effort.boxes);
        let name = &solved.surface.name;
        let many = if count == 1 { "a part" } else { "parts" };
        let part = |doubt: &Undecided| {
            let sides = solved.surface.unknowns.iter().zip(&doubt.ranges);
            let sides: Vec<String> = sides
                .map(|(u, range)| format!("{} {} .. {}", u.name, value(u, range.low), value(u, range.high)))
                .collect();
            format!("{}: {}", sides.join(", "), why(doubt.why))
        };
        let parts = solved.effort.undecided.iter().take(SHOWN).map(part);
        let more = (count > SHOWN).then(|| format!("and {} more", count - SHOWN));
        let message = format!(
            "further branches of {name} are not excluded in {many} of its ranges at {} ({boxes} boxes looked at)",
            anchor(solved)
        );
        let details = parts.chain(more).chain([what_decides(solved)]).collect();
        Remark::new(RemarkKind::BranchesNotExcluded, name, message).with(details)
    };
    solved.iter().filter(|solved| !solved.effort.undecided.is_empty()).map(told).collect()
}

/// What may decide whether there are further branches.
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
    format!("{narrower}a `keep` of one of them{more} may decide it")
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
            keep: keep.and_then(Keep::extent),
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
