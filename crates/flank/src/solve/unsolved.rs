//! Why points of a surface were not solved, and where they are.

use flank_chain_dsl::{GeneratedSurface, Job};
use flank_solver::{CutBy, Outcome, SurfacePoint};

use crate::project::spec::Origin;
use crate::project::units;
use crate::solve::branches;
use crate::solve::reach;
use crate::solve::reasons::{amount, by_what, outside_keep};
use crate::solve::secondary;
use crate::solve::solved::Solved;
use crate::solve::summary::Places;
use crate::solve::surface::bound;
use crate::solve::touching;

/// Why points of a surface were not solved, with the number of points for each reason. `all` are the surfaces of the job that are sampled.
pub(crate) fn reasons(
    (job, origin): (&Job<'_>, Option<&Origin>),
    solved: &Solved<'_, '_>,
    all: &[Solved<'_, '_>],
) -> Vec<String> {
    let summary = &solved.summary;
    let mut reasons = Vec::new();
    let mut tell = |count: usize, text: String| {
        if count > 0 {
            reasons.push(format!("{count}: {text}"));
        }
    };
    for (unknown, outside) in solved.surface.unknowns.iter().zip(&summary.outside) {
        let (most, place) = (amount(unknown, outside.most), whereabouts(solved, &outside.places));
        tell(outside.places.count, format!("{} outside its range, by up to {most}{place}", unknown.name));
    }
    for (condition, count) in &summary.not_kept {
        tell(*count, outside_keep(solved.surface, *condition));
    }
    let trims = summary.trimmed.iter().map(|(number, count)| (CutBy::Other(*number), *count));
    let elsewhere = summary.cut_elsewhere.iter().map(|(by, count)| (CutBy::ItsToolElsewhere(*by), *count));
    let blanks = summary.beyond_blank.iter().map(|(segment, count)| (CutBy::Blank(*segment), *count));
    let own = [(CutBy::ItsTool, summary.cut_by_tool)].into_iter();
    for (cutter, count) in own.chain(elsewhere).chain(trims).chain(blanks) {
        let is_whole = count == summary.asked;
        // the others lie outside of the ranges, or are not found
        let is_most = summary.solved() == 0 && 2 * count > summary.asked;
        let turned = || is_most.then(|| turned_body((job, origin), solved.surface, &solved.points)).flatten();
        let side = match cutter {
            CutBy::ItsTool if is_whole && all.iter().any(|other| is_left_of_body(solved, other)) => {
                "; nothing of the surface stays, though the same `body` leaves other pieces of it: on this work it cuts in the free"
                    .to_string()
            }
            CutBy::ItsTool => turned().map_or_else(String::new, |body| format!("; {body}")),
            CutBy::ItsToolElsewhere(_) if is_whole => {
                "; nothing of the surface stays: surfaces of the tool may cross within their ranges, and what lies beyond the crossing cuts"
                    .to_string()
            }
            _ => String::new(),
        };
        let depth = match cutter {
            CutBy::ItsToolElsewhere(by) => secondary::depth(&solved.positions, by),
            CutBy::ItsTool | CutBy::Other(_) | CutBy::Blank(_) => String::new(),
        };
        let cut = if matches!(cutter, CutBy::Blank(_)) { "" } else { "cut away " };
        tell(count, format!("{cut}{}{depth}{side}", by_what(job, solved.surface, cutter)));
    }
    tell(
        summary.count(Outcome::Undecided),
        "undecided, the lines of the grid disagree on what a trim leaves of them, or several branches of what trims lie beside them"
            .to_string(),
    );
    let singular =
        "singular, the equations do not fix a single point there, or the surface has no normal or no tangent plane";
    tell(summary.count(Outcome::Singular), singular.to_string());
    let least = summary.least_residual;
    let near = if least.is_nan() { String::new() } else { format!(" (smallest residual {least:.1e})") };
    // the others may end where the surface turns back
    let ends = if summary.solved() > 0 { "; the option `limits` shows where the surface ends" } else { "" };
    tell(
        summary.count(Outcome::NotConverged { iterations: 0 }),
        format!("not converged{near}: no point of this branch was found there{ends}"),
    );
    if summary.count(Outcome::NotConverged { iterations: 0 }) > 0 {
        reasons.extend(short_tables(solved));
        reasons.extend(profile_ends(solved.surface));
    }
    reasons.extend(branches::kept_out(solved));
    if solved.needed.is_empty() && summary.has_unreached() {
        reasons.extend(reach::beside_piece(job, solved.surface));
    }
    reasons.extend(solved.needed.iter().map(|needed| needed.text(job, solved.surface)));
    reasons.extend(touching::told(job, solved.surface, &solved.points));
    reasons
}

/// What may be wrong with a surface, as far as its points tell without what it took to find them.
pub(crate) fn hints(
    of: (&Job<'_>, Option<&Origin>),
    surface: &GeneratedSurface<'_>,
    points: &[SurfacePoint],
) -> Vec<String> {
    let is_cut = |point: &&SurfacePoint| point.outcome == Outcome::CutAway(CutBy::ItsTool);
    let is_solved = points.iter().any(|point| point.outcome == Outcome::Solved);
    let is_most = !is_solved && 2 * points.iter().filter(is_cut).count() > points.len();
    let body = is_most.then(|| turned_body(of, surface, points)).flatten();
    let is_lost = |point: &SurfacePoint| matches!(point.outcome, Outcome::NotConverged { .. });
    let ends = if points.iter().any(is_lost) { profile_ends(surface) } else { Vec::new() };
    let needed = reach::needed(surface, points);
    let needed = needed.iter().map(|needed| needed.text(of.0, surface));
    body.into_iter().chain(ends).chain(needed).chain(touching::told(of.0, surface, points)).collect()
}

/// Whether another surface has points, which is made by another piece of the same surface of the tool: their steel lies on one side.
fn is_left_of_body(solved: &Solved<'_, '_>, other: &Solved<'_, '_>) -> bool {
    let of = |solved: &Solved<'_, '_>| {
        let is_piece = solved.surface.unknowns.iter().any(|unknown| unknown.piece.is_some());
        let whole = solved.surface.generation.tool_name.rsplit_once('.').map(|(whole, _)| whole.to_string());
        whole.filter(|_| is_piece)
    };
    other.summary.solved() > 0 && of(solved).is_some_and(|whole| of(other) == Some(whole))
}

/// That the `body` of the tool may lie on the wrong side, and where it is written, if those of its points speak of that which the tool cuts away.
fn turned_body(
    (job, origin): (&Job<'_>, Option<&Origin>),
    surface: &GeneratedSurface<'_>,
    points: &[SurfacePoint],
) -> Option<String> {
    let cut: Vec<SurfacePoint> =
        points.iter().filter(|point| point.outcome == Outcome::CutAway(CutBy::ItsTool)).cloned().collect();
    let is_turned = flank_solver::is_inside_out(&bound(job, surface), &cut);
    let place = origin.zip(surface.generation.body).map_or_else(String::new, |(origin, body)| {
        let place = origin.place(body);
        let text = place.text.lines().next().unwrap_or_default().trim_end().to_string();
        format!(", line {} of {}: `{text}`", place.line, place.file)
    });
    is_turned
        .expect("a job without errors leaves nothing unbound")
        .then(|| format!("nothing of the surface stays: the tool's `body` may lie on the wrong side{place}"))
}

/// The curves through tables that end within the range of the unknown that they are asked for: beyond, the surface has no points.
fn short_tables(solved: &Solved<'_, '_>) -> Vec<String> {
    let unknowns = &solved.surface.unknowns;
    let position = solved.surface.surface.position.0;
    let curves = position[0].graph().curves_in(&position);
    let short = curves.into_iter().filter_map(|(curve, at)| {
        let of = unknowns.iter().find(|unknown| unknown.variable == at)?;
        let (low, high) = curve.ends();
        let text = |x: f64| units::as_given(of.dimension, x);
        let (name, own) = (&of.name, format!("{} .. {}", text(of.low), text(of.high)));
        (low > of.low || high < of.high).then(|| {
            format!(
                "the table of `{}` covers {name} {} .. {}, the range of {name} is {own}: beyond its ends there are no points",
                curve.name(),
                text(low),
                text(high)
            )
        })
    });
    short.collect()
}

/// The splines at which profiles end: unlike lines and arcs they do not go on, so that no point out of range is found there.
fn profile_ends(surface: &GeneratedSurface<'_>) -> Vec<String> {
    let position = surface.surface.position.0;
    let graph = position[0].graph();
    let curves = graph.curves_in(&position);
    let ended = surface.unknowns.iter().filter_map(|of| {
        let piece = of.piece.as_ref()?;
        let run = of.variable.as_variable()?;
        let is_spline = curves.iter().any(|(_, at)| graph.variables_of(&[*at]).contains(&run));
        let ends = [0, 1].into_iter().filter(|k| piece.beside[*k].is_none());
        let ends: Vec<String> = ends.map(|k| units::text(of.dimension, [of.low, of.high][k], 4)).collect();
        (is_spline && !ends.is_empty()).then(|| {
            format!(
                "the profile that {} runs along ends with the spline {}, at {}: beyond there are no points",
                of.name,
                piece.name,
                ends.join(" and ")
            )
        })
    });
    ended.collect()
}

/// At which ends of the grid points lie: `, at the toe and the tip`. An end has at least half of its line among them; where none
/// has, all of them lie in the third of the grid next to it.
pub(crate) fn whereabouts(solved: &Solved<'_, '_>, places: &Places) -> String {
    let [rows, columns] = solved.sample.counts;
    let ends = [1, 0].into_iter().filter(|&k| solved.sample.counts[k] > 2).filter_map(|k| {
        let (first, last) = solved.sample.labels[k].split_once(" -> ")?;
        let (count, length) = (solved.sample.counts[k], [columns, rows][k]);
        let third = count / 3;
        let end = |name, line: usize, from: usize| {
            (name, 2 * places.on_lines(k, line..line + 1) >= length, places.on_lines(k, from..from + third))
        };
        Some([end(first, 0, 0), end(last, count - 1, count - third)])
    });
    let ends: Vec<(&str, bool, usize)> = ends.flatten().collect();
    let has_most = |end: &&(&str, bool, usize)| end.1;
    let names: Vec<&str> = if ends.iter().any(|end| end.1) {
        ends.iter().filter(has_most).map(|end| end.0).collect()
    } else {
        ends.iter().filter(|end| end.2 == places.count).map(|end| end.0).collect()
    };
    // all round is nowhere in particular
    if names.is_empty() || names.len() == 4 { String::new() } else { format!(", at the {}", names.join(" and the ")) }
}
