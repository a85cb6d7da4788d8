//! What a fit comes to: the settings that are chosen, and what is known of them.

use flank_chain_dsl::Parameter;
use flank_solver::{
    AdjustedSurfaces, Alignment, EaseOff, Range, RangeEnd, ScaledUnknown, SearchEnd, SingularDirection,
    least_dispensable, linear_rest, most_effective,
};

use super::aim::Aim;
use super::problem::{self, Problem};
use super::result::{
    AdjustedSetting, AdjustedSettings, EaseOffNumbers, FitResult, FittedEaseOff, FittedFlank, RangeBound,
    SettingChange, SettingsChoice, SettingsDirection,
};
use super::words::{self, SHARE, Unknown, What, motion_name};
use super::{corrected, keep, settings};
use crate::project::answer::Timing;
use crate::project::failure::Failure;
use crate::project::remark::{Remark, RemarkKind};
use crate::project::requests::{FitRequest, WantedEaseOff};
use crate::project::{shown_path, units};

/// A setting whose scale moves the flank by less, mm, moves nothing: a thousandth of what points are solved to.
const NOTHING: f64 = 1e-12;
/// Settings are chosen among those whose scale moves the flank by so much, mm, ...
const CANDIDATE: f64 = 1e-3;
/// ... until the next would lower what is left by less than this, mm.
const LEAST: f64 = 1e-4;

/// Which settings are looked for and what comes of it.
pub(super) struct Fitting<'a, 'g> {
    pub(super) aims: &'a [Aim<'a, 'g>],
    pub(super) problem: &'a Problem<'a, 'g>,
    /// The surfaces as they are.
    pub(super) now: &'a AdjustedSurfaces,
}

impl<'a, 'g> Fitting<'a, 'g> {
    /// The settings that are looked for, by their places among the open ones, and of which they were chosen.
    ///
    /// # Errors
    /// If there are fewer points than unknowns.
    pub(super) fn chosen(&self, request: &FitRequest) -> Result<(Vec<usize>, Option<SettingsChoice>), Failure> {
        let effects = self.effects(self.now);
        let all = 0..self.problem.settings.len();
        let (free, choice) = if request.vary.is_empty() {
            let candidates: Vec<usize> = all.filter(|k| rms(&effects[*k]) >= CANDIDATE).collect();
            let mut own: Vec<Vec<f64>> = candidates.iter().map(|k| effects[*k].clone()).collect();
            let (off, motions) = (&self.now.fit.residuals, self.motion_effects());
            own.extend(motions.iter().cloned());
            let all_leave = linear_rest(off, &own, request.resolution);
            // a wish does not scatter
            let of_points = || scatter(all_leave, off.len(), own.len());
            let noise = request.noise.unwrap_or_else(|| if request.is_wish() { 0.0 } else { of_points() });
            own.truncate(candidates.len());
            let mut taken = most_effective(off, &own, &motions, LEAST, noise);
            let rest = |of: &[usize]| {
                let effects: Vec<Vec<f64>> =
                    of.iter().map(|k| own[*k].clone()).chain(motions.iter().cloned()).collect();
                linear_rest(off, &effects, request.resolution)
            };
            // several may do together what none of them does by itself
            let one_by_one = rest(&taken);
            if one_by_one - all_leave >= LEAST {
                let others = least_dispensable(off, (&own, &motions), request.resolution, (LEAST, noise));
                if one_by_one - rest(&others) >= LEAST {
                    taken = others;
                }
            }
            let mut free: Vec<usize> = taken.into_iter().map(|k| candidates[k]).collect();
            free.sort_unstable();
            let choice = SettingsChoice {
                candidates: candidates.iter().map(|k| self.problem.settings[*k].name.clone()).collect(),
                all_leave_um: 1e3 * all_leave,
                noise_um: 1e3 * noise,
            };
            (free, Some(choice))
        } else {
            (all.filter(|k| rms(&effects[*k]) > NOTHING).collect(), None)
        };
        let unknowns = free.len() + self.problem.further.len() + usize::from(!request.as_it_lies);
        let points = self.problem.count();
        if points < unknowns {
            return Err(Failure::Input(format!(
                "{} do not tell {}, the {} among them: measure more points, or name fewer settings with option `vary`",
                units::counted(points, "point"),
                units::counted(unknowns, "unknown"),
                motion_name(self.problem.alignment)
            )));
        }
        Ok((free, choice))
    }

    /// What each setting does to the distances for its scale, mm.
    fn effects(&self, of: &AdjustedSurfaces) -> Vec<Vec<f64>> {
        let unknowns = self.problem.unknowns.iter().enumerate();
        unknowns.map(|(k, unknown)| self.problem.part(scaled(of.effect(k), unknown.scale))).collect()
    }

    /// The same of each motion; nothing where it is held.
    pub(super) fn motion_effects(&self) -> Vec<Vec<f64>> {
        let motions = [&self.problem.motion].into_iter().chain(&self.problem.further).enumerate();
        let effect = |(k, motion): (usize, &ScaledUnknown)| {
            let scale = if motion.range.low < motion.range.high { motion.scale } else { 0.0 };
            self.problem.part(scaled(self.now.effect(self.problem.settings.len() + k), scale))
        };
        motions.map(effect).collect()
    }

    /// By how much the tooth that was measured is thicker than the nominal one, mm on the circle, or the line, through the middle of the points.
    fn thicker(&self, arc: f64) -> Option<f64> {
        let further = self.problem.motions(self.now).get(1)?;
        // moved so far the points come to the surface: they lay off it by the contrary
        let off: f64 = self.now.effect(self.problem.settings.len() + 1).iter().sum();
        Some(-arc * further * off.signum())
    }

    /// The value of a setting as a spec has it.
    pub(super) fn new_value(&self, k: usize, of: &AdjustedSurfaces) -> (String, String) {
        let setting = self.problem.settings[k];
        (setting.name.clone(), corrected::value(setting.dimension, of.fit.values[k]))
    }

    pub(super) fn result(
        &self,
        request: &FitRequest,
        (free, choice): (&[usize], Option<SettingsChoice>),
        (identification, correction): (Option<&AdjustedSurfaces>, &AdjustedSurfaces),
    ) -> FitResult {
        let main = identification.unwrap_or(correction);
        let unknowns = self.unknowns();
        let predicted = self.predicted(request, correction);
        let motion = (!request.as_it_lies).then(|| self.problem.motions(self.now)[0]);
        let (turn, shift) = match self.problem.alignment {
            Alignment::Turn => (motion, None),
            Alignment::Shift => (None, motion),
        };
        let arc = self.problem.motion.scale.recip() * problem::MOTION;
        let is_wish = request.is_wish();
        FitResult {
            job: self.aims[0].of.job.name.clone(),
            spec: shown_path(request.jobs.file()),
            flanks: self.flanks(main, &predicted, is_wish),
            turn_deg: turn.map(f64::to_degrees),
            turn_mm: turn.map(|turn| arc * turn),
            shift_mm: shift,
            thicker_mm: self.thicker(arc),
            before_um: 1e3 * self.now.rms(),
            identification: identification.map(|of| self.adjusted(of, free)),
            correction: self.adjusted(correction, &self.problem.settable(free)),
            ease_off: request.ease_off.map(|wish| self.ease_off(wish, &predicted)),
            share: request.share,
            order: request.order,
            predicted_um: 1e3 * rms(&predicted),
            within_um: 1e3 * request.within,
            directions: main
                .fit
                .directions
                .iter()
                .filter(|of| of.size > 0.0 || !of.is_used)
                .map(|of| told(of, &unknowns))
                .collect(),
            untold: words::untold(&main.fit.directions, &unknowns),
            choice,
            scatter_um: variance(main).map(|variance| 1e3 * variance.sqrt()),
            // of points one by one nothing is asked where only shapes are fitted
            leave_out_um: self.leave_out(main).filter(|_| request.order.is_none()).map(|error| 1e3 * error),
            kept: keep::told(&self.problem.keeps, &correction.fit.exact),
            outliers: Vec::new(),
            without_outliers_um: None,
            corrected: None,
            files: Vec::new(),
            not_done: self.aims.iter().flat_map(|aim| aim.missing.clone()).collect(),
            remarks: self.idle(request),
            timing: Timing::default(),
        }
    }

    /// What is wanted, and what comes of it: what is predicted is off from what was wanted.
    fn ease_off(&self, wish: WantedEaseOff, predicted: &[f64]) -> FittedEaseOff {
        let aim = &self.aims[0];
        let mut reached = vec![None; aim.points.len()];
        for (at, off) in self.problem.places[0].iter().zip(predicted) {
            let place = [at / aim.counts[1], at % aim.counts[1]];
            reached[*at] = Some(wish.at(place, aim.counts) + 1e3 * off);
        }
        let reached = EaseOff::of_deviations(&reached, aim.counts);
        FittedEaseOff {
            wanted: EaseOffNumbers { slopes_um: wish.slopes, crownings_um: wish.crownings, bias_um: wish.bias },
            reached: reached.map(|of| EaseOffNumbers {
                slopes_um: of.slopes,
                crownings_um: of.crownings,
                bias_um: of.bias,
            }),
        }
    }

    /// Settings that were named and move nothing.
    fn idle(&self, request: &FitRequest) -> Vec<Remark> {
        if request.vary.is_empty() {
            return Vec::new();
        }
        let (effects, surface) = (self.effects(self.now), &self.aims[0].of.surface.name);
        let idle = self.problem.settings.iter().zip(effects).filter(|(_, effect)| rms(effect) <= NOTHING);
        let remark = |of: &Parameter<'_>| {
            Remark::new(
                RemarkKind::MovesNothing,
                &of.name,
                format!(
                    "`{}` does not move {surface}{}: it stays as it is",
                    of.name,
                    settings::beside(self.aims[0].of.job, &self.problem.settings, of)
                ),
            )
        };
        idle.map(|(of, _)| remark(of)).collect()
    }

    fn unknowns(&self) -> Vec<Unknown<'a, 'g>> {
        let settings = self.problem.settings.iter().zip(&self.problem.unknowns);
        let settings = settings.map(|(of, unknown)| Unknown { what: What::Setting(of), scale: unknown.scale });
        let motion = Unknown { what: What::Motion(self.problem.alignment), scale: self.problem.motion.scale };
        let names = self.aims.iter().skip(1).map(|aim| aim.of.surface.name.as_str());
        let further = self.problem.further.iter().zip(names);
        let further =
            further.map(|(of, name)| Unknown { what: What::Further(self.problem.alignment, name), scale: of.scale });
        settings.chain([motion]).chain(further).collect()
    }

    fn adjusted(&self, of: &AdjustedSurfaces, free: &[usize]) -> AdjustedSettings {
        let (variance, is_settled) = (variance(of), of.fit.end == SearchEnd::Settled);
        let setting = |&k: &usize| {
            let setting = self.problem.settings[k];
            let shown = |value: f64| units::shown(setting.dimension, value);
            let (change, held) = (of.fit.values[k] - setting.value, of.fit.held[k]);
            // what is held at no end stands on a step
            let Range { low, high } = self.problem.unknowns[k].range;
            let at_end = held.filter(|_| of.fit.values[k] <= low || of.fit.values[k] >= high);
            let is_told = of.fit.directions.iter().filter(|of| !of.is_used).all(|of| of.shares[k].abs() <= SHARE);
            let uncertain = variance.map(|variance| (variance * of.fit.covariance[k][k]).abs().sqrt());
            AdjustedSetting {
                name: setting.name.clone(),
                is_error: setting.is_error,
                step: self.problem.steps[k].map(shown),
                unit: units::whole_symbol(setting.dimension),
                now: shown(setting.value),
                change: shown(change),
                new: shown(of.fit.values[k]),
                at_bound: at_end.map(|end| match end {
                    RangeEnd::Low => RangeBound::Low,
                    RangeEnd::High => RangeBound::High,
                }),
                is_rounded: held.is_some() && at_end.is_none(),
                moves_um: 1e3 * change.abs() * rms(&of.effect(k)),
                uncertain_by: uncertain.filter(|_| held.is_none() && is_told && is_settled).map(shown),
            }
        };
        let scale = |k: usize| units::shown(self.problem.settings[k].dimension, 1.0);
        let covariance = |variance: f64| {
            let row =
                |&i: &usize| free.iter().map(|&k| variance * of.fit.covariance[i][k] * scale(i) * scale(k)).collect();
            free.iter().map(row).collect()
        };
        AdjustedSettings {
            settings: free.iter().map(setting).collect(),
            left_um: 1e3 * rms(&of.fit.residuals),
            steps: of.fit.steps,
            is_settled,
            covariance: variance.map_or(Vec::new(), covariance),
        }
    }

    /// The deviations to be expected after the correction, mm.
    fn predicted(&self, request: &FitRequest, correction: &AdjustedSurfaces) -> Vec<f64> {
        let left = &correction.distances();
        match request.is_wish() {
            true => left.iter().map(|off| -off).collect(),
            false => {
                self.now.distances().iter().zip(left).map(|(off, left)| (1.0 - request.share) * off - left).collect()
            }
        }
    }

    /// Distances of points are deviations of what was measured; of a wish they are those of the surface, the other way round.
    fn flanks(&self, main: &AdjustedSurfaces, predicted: &[f64], is_wish: bool) -> Vec<FittedFlank> {
        let sign = if is_wish { -1e3 } else { 1e3 };
        let mut from = 0;
        let flank = |(aim, places): (&Aim<'_, '_>, &Vec<usize>)| {
            let own = from..from + places.len();
            from = own.end;
            let on_grid = |values: &[f64], size: f64| {
                let mut grid = vec![None; aim.points.len()];
                places.iter().zip(&values[own.clone()]).for_each(|(at, off)| grid[*at] = Some(size * off));
                grid
            };
            FittedFlank {
                surface: aim.of.surface.name.clone(),
                frame: aim.of.surface.frame.clone(),
                wanted: aim.wanted.clone(),
                counts: aim.counts,
                known: places.len(),
                before_um: on_grid(&self.now.distances(), sign),
                left_um: on_grid(&main.distances(), sign),
                predicted_um: on_grid(predicted, 1e3),
            }
        };
        self.aims.iter().zip(&self.problem.places).map(flank).collect()
    }

    /// The error with which rows and columns are predicted, mm.
    fn leave_out(&self, of: &AdjustedSurfaces) -> Option<f64> {
        let model = of.fit.linear_model();
        let errors: Vec<f64> = self.lines().iter().filter_map(|line| model.left_out(&line.points)).flatten().collect();
        (!errors.is_empty()).then(|| rms(&errors))
    }

    /// Rows and columns with their points, of each surface those first.
    pub(super) fn lines(&self) -> Vec<GridLine> {
        let (mut lines, mut from) = (Vec::new(), 0);
        for (surface, (aim, places)) in self.aims.iter().zip(&self.problem.places).enumerate() {
            let columns = aim.counts[1].max(1);
            let mut rows = vec![Vec::new(); aim.counts[0]];
            let mut across = vec![Vec::new(); columns];
            for (k, at) in places.iter().enumerate() {
                rows[at / columns].push(from + k);
                across[at % columns].push(from + k);
            }
            let of = |is_row: bool| move |(at, points)| GridLine { surface, is_row, at, points };
            lines.extend(rows.into_iter().enumerate().map(of(true)));
            lines.extend(across.into_iter().enumerate().map(of(false)));
            from += places.len();
        }
        lines.retain(|line| !line.points.is_empty());
        lines
    }
}

/// A row or a column of a grid.
pub(super) struct GridLine {
    pub(super) surface: usize,
    pub(super) is_row: bool,
    /// From 0.
    pub(super) at: usize,
    /// By their places among all points.
    pub(super) points: Vec<usize>,
}

/// What residuals scatter by of which so many unknowns leave this, root of the mean square.
fn scatter(left: f64, residuals: usize, unknowns: usize) -> f64 {
    let free = residuals.saturating_sub(unknowns).max(1);
    left * (residuals as f64 / free as f64).sqrt()
}

/// Of the distances that a fit leaves, of which one is taken by each direction that is used.
fn variance(of: &AdjustedSurfaces) -> Option<f64> {
    let distances = of.distances();
    let free = distances.len().checked_sub(of.fit.rank()).filter(|free| *free > 0)?;
    Some(distances.iter().map(|off| off * off).sum::<f64>() / free as f64)
}

fn told(of: &SingularDirection, unknowns: &[Unknown<'_, '_>]) -> SettingsDirection {
    let parts = unknowns.iter().zip(&of.shares).filter(|(_, share)| share.abs() > SHARE);
    let changes = parts.map(|(unknown, share)| SettingChange {
        name: unknown.name(),
        unit: units::whole_symbol(unknown.dimension()),
        by: units::shown(unknown.dimension(), share * unknown.scale),
        share: share.abs(),
    });
    SettingsDirection { moves_um: 1e3 * of.size, is_used: of.is_used, changes: changes.collect() }
}

pub(super) fn rms(of: &[f64]) -> f64 {
    (of.iter().map(|x| x * x).sum::<f64>() / of.len().max(1) as f64).sqrt()
}

fn scaled(of: Vec<f64>, by: f64) -> Vec<f64> {
    of.into_iter().map(|x| x * by).collect()
}
