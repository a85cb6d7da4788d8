//! Whether a fit is what was asked for, and what speaks against it.

use std::collections::BTreeSet;

use flank_export::fixed;
use flank_solver::{AdjustedSurfaces, linear_rest};

use super::fitting::{Fitting, rms};
use super::outliers::{Others, Outliers};
use super::result::{AdjustedSetting, FitResult, KeptSurface};
use super::words::NOTHING;
use crate::project::remark::{NotDone, NotDoneKind, Remark, RemarkKind};
use crate::project::requests::FitRequest;

/// Of a reversed grid that leaves less than this share it is asked whether it was meant.
const REVERSED: f64 = 0.5;
/// A surface that is left where it is to this, um, is kept.
const KEPT_UM: f64 = 1e-3;
/// Settings that leave more than this share of what chance leaves to as many unknowns explain nothing: one in a hundred times chance does
/// as much, over 45 points and 5 unknowns.
const CHANCE: f64 = 0.7;

/// The result with what speaks against it.
pub(super) fn judged(
    mut result: FitResult,
    fitting: &Fitting<'_, '_>,
    (request, free): (&FitRequest, &[usize]),
    (main, correction): (&AdjustedSurfaces, &AdjustedSurfaces),
) -> FitResult {
    let (surface, names) = (&fitting.aims[0].of.surface.name, fitting.names());
    let Outliers { points, remarks: outlying, others } = match request.is_wish() {
        true => Outliers::none(),
        false => Outliers::of(fitting, main, (free, request.order.is_some())),
    };
    result.outliers = points;
    result.without_outliers_um = others.as_ref().map(|of| 1e3 * of.left);
    // errors alone are identified, and nothing is to be set
    let corrected = if result.correction.settings.is_empty() { 0.0 } else { result.correction.left_um };
    let left = result.identification.as_ref().unwrap_or(&result.correction).left_um.max(corrected);
    if left > result.within_um {
        let message = format!("not met: {left:.3} um rms is left of {names}, more than {} um", result.within_um);
        let reasons = reasons(&result, (request, main));
        result.not_done.push(NotDone::new(NotDoneKind::NotMet, surface, message).with(reasons));
    }
    if left <= result.within_um && !is_settled(&result) {
        let message = format!("the search came to no end: other settings may make {names} as well");
        result.remarks.push(Remark::new(RemarkKind::NotShown, surface, message));
    }
    let unmet: usize =
        fitting.aims.iter().zip(&result.flanks).map(|(aim, of)| aim.points.iter().flatten().count() - of.known).sum();
    if unmet > 0 {
        let message =
            format!("no deviation at {unmet} points: no normal of {names} within its ranges goes through them");
        result.not_done.push(NotDone::new(NotDoneKind::NoDeviation, surface, message));
    }
    let (beyond, ends) = fitting.problem.beyond(correction);
    if beyond > 0 {
        let message = format!(
            "with the corrected settings {beyond} of {} points lie beyond the end of {names}, of the range of {}; the fit takes the surface to \
             go on there",
            fitting.problem.count(),
            ends.join(", ")
        );
        result.not_done.push(NotDone::new(NotDoneKind::NotMet, surface, message));
    }
    for kept in result.kept.iter().filter(|kept| kept.off_um > KEPT_UM) {
        let KeptSurface { surface: name, off_um, .. } = kept;
        let message = format!(
            "not kept: the corrected settings move {name} by {off_um:.3} um: they are too few to leave it where it is"
        );
        result.not_done.push(NotDone::new(NotDoneKind::NotMet, name, message));
    }
    result.remarks.extend(outlying);
    if let Some(remark) = not_shown(&result, fitting, (request, main), others.as_ref()) {
        result.remarks.push(remark);
    }
    result.remarks.extend(fitting.reversed(request, main));
    result.remarks.extend(
        fitting
            .aims
            .iter()
            .filter_map(|aim| Some(Remark::new(RemarkKind::OtherMounting, &aim.of.surface.name, aim.mounted()?))),
    );
    result
}

/// Whether no further step would leave less.
fn is_settled(result: &FitResult) -> bool {
    result.identification.iter().chain([&result.correction]).all(|of| of.is_settled)
}

/// Settings that take no more away than chance would.
fn not_shown(
    result: &FitResult,
    fitting: &Fitting<'_, '_>,
    (request, main): (&FitRequest, &AdjustedSurfaces),
    others: Option<&Others>,
) -> Option<Remark> {
    let surface = &fitting.aims[0].of.surface.name;
    let identified = result.identification.as_ref().map_or(0, |of| of.settings.len());
    if result.correction.settings.is_empty() && identified == 0 {
        let message =
            format!("no setting takes as much as 0.1 um of the {:.3} um rms away: none is changed", result.before_um);
        return Some(Remark::new(RemarkKind::NotShown, surface, message));
    }
    result.identification.as_ref()?;
    if let Some(noise) = request.noise.filter(|noise| fitting.now.rms() <= *noise) {
        let (before, noise) = (result.before_um, 1e3 * noise);
        let message = format!(
            "the deviation, {before:.3} um rms, is not larger than the measuring noise of {noise:.3} um: the changes mean nothing"
        );
        return Some(Remark::new(RemarkKind::NotShown, surface, message));
    }
    let (count, rank, before, left) = match others {
        Some(of) => (of.count, of.rank, of.before, of.left),
        None => (main.fit.residuals.len(), main.fit.rank(), fitting.now.rms(), main.rms()),
    };
    let without = if others.is_some() { "without the points that do not go with the others " } else { "" };
    // of scatter alone, unknowns take away their share
    let scatter = (count.saturating_sub(rank).max(1) as f64 / count.max(1) as f64).sqrt();
    let is_chance = count > rank && left > CHANCE.sqrt() * scatter * before;
    is_chance.then(|| {
        let message = format!(
            "{without}the settings take {} of {} um rms away, not much more than they would of measuring noise alone: the changes may mean nothing",
            fixed(1e3 * (before - left), 3),
            fixed(1e3 * before, 3)
        );
        Remark::new(RemarkKind::NotShown, surface, message)
    })
}

/// Why no settings do it.
fn reasons(result: &FitResult, (request, main): (&FitRequest, &AdjustedSurfaces)) -> Vec<String> {
    let mut reasons = Vec::new();
    let of_all = result.identification.iter().chain([&result.correction]).flat_map(|of| &of.settings);
    let named = |which: fn(&AdjustedSetting) -> bool| -> Vec<&str> {
        let (names, mut known) = (of_all.clone().filter(|of| which(of)).map(|of| of.name.as_str()), BTreeSet::new());
        names.filter(|name| known.insert(*name)).collect()
    };
    let (bound, stepped) = (named(|of| of.at_bound.is_some()), named(|of| of.is_rounded));
    if !bound.is_empty() {
        reasons.push(format!("bounds: {} stands at the end of its range", bound.join(", ")));
    }
    if !stepped.is_empty() {
        reasons.push(format!(
            "steps: {} stands on a step of option `round`: a smaller one comes nearer",
            stepped.join(", ")
        ));
    }
    // without steps the settings do it
    let is_by_steps =
        !stepped.is_empty() && result.identification.as_ref().is_some_and(|of| of.left_um <= result.within_um);
    if !result.kept.is_empty() {
        let kept: Vec<&str> = result.kept.iter().map(|of| of.surface.as_str()).collect();
        reasons.push(format!(
            "kept: what option `keep` says of {} is held first, and may take what the settings could do",
            kept.join(", ")
        ));
    }
    if !is_settled(result) {
        reasons.push("the search came to no end: the points may lie too far off to be reached".to_string());
    }
    if let Some(without) = result.without_outliers_um {
        reasons.push(format!(
            "outliers: of the points that go together the settings would leave {} um rms; the others stand in the notes",
            fixed(without, 3)
        ));
    }
    let is_enough = result.without_outliers_um.is_some_and(|without| without <= result.within_um);
    let unused = main.fit.directions.iter().filter(|of| !of.is_used).count();
    // what shows nothing shows nothing at a finer resolution
    let weak = main.fit.directions.iter().filter(|of| !of.is_used && of.size >= NOTHING).count();
    let all = main.fit.directions.len();
    if bound.is_empty() && !is_enough && !is_by_steps {
        let more = if request.vary.is_empty() { "" } else { "; more settings with option `vary` may" };
        let finer = match weak {
            0 => String::new(),
            _ => format!("; option `resolution` below {} um takes in more of them", request.resolution * 1e3),
        };
        reasons.push(match all {
            0 => format!("rank: what is held leaves the settings no direction in which to move the flank{more}"),
            _ => format!(
                "rank: the {} of {all} directions in which the settings move the flank do not reach the rest{more}{finer}",
                all - unused
            ),
        });
    }
    reasons
}

impl Fitting<'_, '_> {
    /// The surfaces.
    fn names(&self) -> String {
        let names: Vec<&str> = self.aims.iter().map(|aim| aim.of.surface.name.as_str()).collect();
        names.join(" and ")
    }

    /// Whether the same deviations from the other end, or upside down, go with the settings.
    fn reversed(&self, request: &FitRequest, main: &AdjustedSurfaces) -> Option<Remark> {
        // what a bound keeps back says nothing of the order of the points
        let is_bound = main.fit.held.iter().any(Option::is_some);
        if request.is_wish() || main.rms() < NOTHING || is_bound {
            return None;
        }
        let mut effects: Vec<Vec<f64>> = (0..self.problem.settings.len())
            .filter(|k| main.fit.values[*k] != self.problem.settings[*k].value)
            .map(|k| self.problem.part(self.now.effect(k)))
            .collect();
        effects.extend(self.motion_effects());
        let ways = [([false, true], "columns"), ([true, false], "rows"), ([true, true], "rows and columns")];
        let found = ways
            .into_iter()
            .filter_map(|(way, what)| Some((self.left_reversed(way, (&effects, request.resolution), main)?, what)));
        let found = found.filter(|([rest, left], _)| *rest < REVERSED * left);
        let ([rest, _], what) = found.reduce(|best, next| if next.0[0] < best.0[0] { next } else { best })?;
        let message = format!(
            "with the {what} in the other order {rest:.3} um would be left: is the grid that of this flank, from the same end?"
        );
        Some(Remark::new(RemarkKind::OtherOrder, &self.aims[0].of.surface.name, message))
    }

    /// What effects leave of the deviations in another order, um rms, and what the fit leaves of these points in theirs.
    fn left_reversed(
        &self,
        way: [bool; 2],
        (effects, resolution): (&[Vec<f64>], f64),
        main: &AdjustedSurfaces,
    ) -> Option<[f64; 2]> {
        let partners = self.partners(way);
        // of half as many unknowns chance alone would leave 0.7
        if partners.len() < 2 * effects.len() {
            return None;
        }
        let reversed: Vec<f64> = partners.iter().map(|(_, from)| self.now.fit.residuals[*from]).collect();
        let own = |of: &[f64]| partners.iter().map(|(at, _)| of[*at]).collect::<Vec<f64>>();
        let effects: Vec<Vec<f64>> = effects.iter().map(|of| own(of)).collect();
        Some([linear_rest(&reversed, &effects, resolution), rms(&own(&main.fit.residuals))].map(|left| 1e3 * left))
    }

    /// Of points the ones that stand at their places in the other order of rows, columns or both, where these were measured.
    fn partners(&self, [is_up, is_back]: [bool; 2]) -> Vec<(usize, usize)> {
        let (mut partners, mut first) = (Vec::new(), 0);
        for (aim, places) in self.aims.iter().zip(&self.problem.places) {
            let [rows, columns] = aim.counts;
            let turned = |at: usize, count: usize, is_turned: bool| if is_turned { count - 1 - at } else { at };
            partners.extend(places.iter().enumerate().filter_map(|(k, at)| {
                let from = turned(at / columns, rows, is_up) * columns + turned(at % columns, columns, is_back);
                Some((first + k, first + places.binary_search(&from).ok()?))
            }));
            first += places.len();
        }
        partners
    }
}
