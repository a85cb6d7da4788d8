//! Settings that bring the vertex of a contact where it is wanted: local synthesis.

use faer::Mat;

use crate::contact::wish::{ContactWish, EVEN, Reading};
use crate::contact::{ContactChange, ContactPoint, ContactProblem};
use crate::equations::solution::{Range, verdict};
use crate::newton::least_squares::{LeastSquares, LeastSquaresFit, Linearized, ScaledUnknown, SearchEnd};

/// The search ends where no number changes by more than what is worth so much, mm.
const SETTLED: f64 = 1e-10;
/// The least change is known to this share of the scales: a search for it closes in by steps that shrink slowly.
const LEAST: f64 = 1e-4;
/// What conditions that need not hold exactly weigh beside those that do, where a search begins: exact ones give way to them by the square of
/// this.
const SOFT: f64 = 1e-4;
/// What is left where all that is wanted is there, in what is worth 1 mm.
const LEFT: f64 = 1e-8;
/// The way from what a contact is to what it shall be, where that is too long at once: shares of it that are gone at the most, and at the least
/// before it ends.
const LONGEST: f64 = 1.0 / 8.0;
const SHORTEST: f64 = 1.0 / 256.0;
/// A number that settings change by less than this share of what they changed it by at the beginning has come to its end.
const TURNED_BACK: f64 = 1e-3;
/// Trials at which the flanks do not touch: with more of them than so many, and so many times as many as there are others, a search creeps along the
/// border of where they do, and ends there. None that came to what it looked for had as many.
const LOST: usize = 12;
const LOST_TO_FOUND: usize = 2;
/// How often conditions that need not hold exactly are weighed anew so that each is near enough, as long as the one that is farthest off comes
/// nearer by more than a hundredth.
const MOST_WEIGHINGS: usize = 30;
const NO_NEARER: f64 = 0.99;
/// One that is off by less than this share of what it may be becomes no lighter for that: it would drift away.
const LIGHTEST: f64 = 0.1;

/// A contact whose settings are looked for.
#[derive(Clone, Debug)]
pub struct ContactSynthesis<'p> {
    /// The pair; what it is differentiated by are the settings.
    pub problem: &'p ContactProblem,
    /// The vertex of the lag with the values that the pair has.
    pub vertex: &'p ContactPoint,
    /// What is wanted of the vertex.
    pub wishes: Vec<ContactWish>,
    /// The settings, one for each parameter of the pair; of those that are held both ends of the range are the start.
    pub settings: Vec<ScaledUnknown>,
}

/// Settings with which a contact is what was wanted, or as near to that as they bring it.
#[derive(Clone, Debug)]
pub struct SynthesizedContact {
    /// Of the search that ended there; unknowns are the settings, then the roll.
    pub fit: LeastSquaresFit,
    /// The vertex: flank on flank, however far beyond their outlines and the ranges of their tools.
    pub vertex: ContactPoint,
    /// The share of the way from what the contact was to what is wanted, which was met; 1 for all of it, met or not.
    pub share: f64,
    /// The last place on the way at which all was met, with its share, where the way ends before.
    pub way: Option<(f64, ContactPoint)>,
}

impl ContactSynthesis<'_> {
    /// Settings and roll with which the contact is what is wanted: from where they are, or where that does not lead there, on the way from what
    /// the contact is to that. Where neither does, the flanks are taken to go on beyond the ranges of their tools, and the lag beyond its own:
    /// [`SynthesizedContact::vertex`] tells where they do not. Where that does not either, the vertex with the least squares of what is off.
    /// `None` if a number is not there at the start.
    ///
    /// # Panics
    /// If there are not as many settings as the pair has parameters.
    #[must_use]
    pub fn solve(&self) -> Option<SynthesizedContact> {
        let (within, beyond) = self.searched()?;
        match beyond {
            _ if self.is_met(&within.vertex) => Some(self.least_changed(within)),
            Some(beyond) if self.is_met(&beyond.vertex) => {
                let problem = self.problem.clone().beyond_ranges();
                let least = self.in_problem(&problem).least_changed(beyond);
                Some(SynthesizedContact { vertex: self.told(least.vertex.clone()), ..least })
            }
            beyond => {
                let beyond = beyond.and_then(|of| of.way).map(|(share, at)| (share, self.told(at)));
                let ways = within.way.clone().into_iter().chain(beyond);
                let way = ways.max_by(|a, b| a.0.total_cmp(&b.0));
                let nearest =
                    if self.holds(&within.vertex) { self.least_changed(within) } else { self.nearest_to_all(within) };
                Some(SynthesizedContact { way, ..nearest })
            }
        }
    }

    /// A contact at which all is as it is wanted, with whatever changes of settings a search comes to, within the ranges or beyond. `None` where no search
    /// comes to one.
    ///
    /// # Panics
    /// If there are not as many settings as the pair has parameters.
    #[must_use]
    pub fn met(&self) -> Option<ContactPoint> {
        let (within, beyond) = self.searched()?;
        let beyond = beyond.map(|of| self.told(of.vertex));
        [within.vertex].into_iter().chain(beyond).find(|at| self.is_met(at))
    }

    /// What is found within the ranges of tools and of the lag, and beyond them if that is not met. `None` if a number is not there at the start.
    fn searched(&self) -> Option<(SynthesizedContact, Option<SynthesizedContact>)> {
        let within = self.within_ranges()?;
        if self.is_met(&within.vertex) {
            return Some((within, None));
        }
        let problem = self.problem.clone().beyond_ranges();
        let beyond = self.in_problem(&problem).within_ranges();
        Some((within, beyond))
    }

    /// The same of a pair with other ranges.
    fn in_problem<'p>(&'p self, problem: &'p ContactProblem) -> ContactSynthesis<'p> {
        let ContactSynthesis { vertex, wishes, settings, .. } = self.clone();
        ContactSynthesis { problem, vertex, wishes, settings }
    }

    /// A contact with what the ranges of the pair say of it.
    fn told(&self, at: ContactPoint) -> ContactPoint {
        ContactPoint { outcome: verdict(&at.all_unknowns(), &self.problem.ranges, true, false), ..at }
    }

    /// The same within the ranges of tools and of the lag alone, and with whatever changes of settings the search comes to.
    fn within_ranges(&self) -> Option<SynthesizedContact> {
        let found = self.walked()?;
        let is_near = !self.holds(&found.vertex) || self.is_met(&found.vertex);
        Some(if is_near { found } else { self.weighed(&found).unwrap_or(found) })
    }

    /// The residuals of a contact, the vertex's own last; `None` where a number is not there.
    fn residuals(&self, at: &ContactPoint) -> Option<Vec<f64>> {
        let reading = Reading::of(at);
        let own = self.to_vertex() * at.lag_slopes[0];
        self.wishes.iter().map(|wish| wish.residual(&reading)).chain([Some(own)]).collect()
    }

    fn is_exact(&self, row: usize) -> bool {
        self.wishes.get(row).is_none_or(|wish| wish.within.is_none())
    }

    /// Whether a contact is at its vertex, and is exactly what is to be so.
    fn holds(&self, at: &ContactPoint) -> bool {
        let is_zero = |(row, off): (usize, &f64)| !self.is_exact(row) || off.abs() < LEFT;
        self.residuals(at).is_some_and(|of| of.iter().enumerate().all(is_zero))
    }

    /// Whether all is as near as it is wanted, too.
    fn is_met(&self, at: &ContactPoint) -> bool {
        let is_near = |(row, off): (usize, &f64)| self.is_exact(row) || off.abs() <= 1.0;
        self.holds(at) && self.residuals(at).is_some_and(|of| of.iter().enumerate().all(is_near))
    }

    /// How far off the one is that is farthest off, of those that need not hold exactly.
    fn farthest(&self, at: &ContactPoint) -> Option<f64> {
        let soft = self.residuals(at)?.into_iter().enumerate().filter(|(row, _)| !self.is_exact(*row));
        Some(soft.fold(0.0, |most: f64, (_, off)| most.max(off.abs())))
    }

    /// The sum of the squares that are left, each with its weight.
    fn left(&self, at: &ContactPoint) -> f64 {
        let square = |(row, off): (usize, f64)| (self.weight(row) * off).powi(2);
        self.residuals(at).map_or(f64::INFINITY, |of| of.into_iter().enumerate().map(square).sum())
    }

    fn weight(&self, row: usize) -> f64 {
        if self.is_exact(row) { 1.0 } else { SOFT }
    }

    /// Where settings are left free, of all that do as much for the wishes the ones that are changed least, by their scales. A search for the
    /// wishes alone leaves settings where its steps led.
    fn least_changed(&self, found: SynthesizedContact) -> SynthesizedContact {
        if found.fit.directions.iter().all(|of| of.is_used) {
            return found;
        }
        let changed = |values: &[f64]| -> Vec<f64> {
            self.settings.iter().zip(values).map(|(of, value)| (value - of.start) / of.scale).collect()
        };
        // what gave way stays where it came to
        let stays = |wish: &ContactWish| match wish.within {
            Some(_) => Some(ContactWish { wanted: wish.of.of(&found.vertex)?, within: None, ..*wish }),
            None => Some(*wish),
        };
        let Some(wishes) = self.wishes.iter().map(stays).collect::<Option<Vec<_>>>() else { return found };
        let count = self.settings.len();
        let from = self.from(&found, wishes.clone());
        let nearer = from.search((wishes.len() + 1, LEAST), |values, of| Linearized {
            residuals: changed(values).into_iter().chain(of.residuals).collect(),
            jacobian: Mat::from_fn(count + of.jacobian.nrows(), of.jacobian.ncols(), |row, k| match row {
                own if own < count => {
                    if own == k {
                        self.settings[k].scale.recip()
                    } else {
                        0.0
                    }
                }
                _ => of.jacobian[(row - count, k)],
            }),
        });
        let Some((fit, vertex)) = nearer else { return found };
        let near = SynthesizedContact { fit, vertex, ..found.clone() };
        // once more for the wishes alone: the least change is known to fewer digits than they are
        let last = self.from(&near, wishes);
        let ended = last.solve_at_once().filter(|of| last.is_met(&of.vertex));
        let size = |of: &SynthesizedContact| changed(&of.fit.values).iter().map(|x| x * x).sum::<f64>();
        match ended {
            Some(ended) if size(&ended) < size(&found) => SynthesizedContact { way: found.way, ..ended },
            _ => found,
        }
    }

    /// The vertex with the least squares of all that is off, from what was found or from where settings and contact are.
    fn nearest_to_all(&self, found: SynthesizedContact) -> SynthesizedContact {
        let starts = [self.from(&found, self.wishes.clone()), self.clone()];
        let ends = starts.into_iter().filter_map(|of| of.search((1, SETTLED), |_, of| self.weighted(of)));
        let is_vertex = |at: &ContactPoint| (self.to_vertex() * at.lag_slopes[0]).abs() < LEFT;
        let ends = ends.filter(|(_, vertex)| is_vertex(vertex));
        match ends.min_by(|a, b| self.left(&a.1).total_cmp(&self.left(&b.1))) {
            Some((fit, vertex)) => SynthesizedContact { fit, vertex, ..found },
            None => found,
        }
    }

    /// Conditions that need not hold exactly, where the least squares of them leave one farther off than it may be: weighed by how far each is off,
    /// again and again, as Lawson does for the least largest one. `None` where that does not bring all of them near enough.
    fn weighed(&self, found: &SynthesizedContact) -> Option<SynthesizedContact> {
        let mut wishes = self.wishes.clone();
        let (mut last, mut least) = (found.clone(), self.farthest(&found.vertex)?);
        for _ in 0..MOST_WEIGHINGS {
            let off = self.residuals(&last.vertex)?;
            for (wish, off) in wishes.iter_mut().zip(off) {
                // the square of a residual weighs as much more as it is off
                wish.within = wish.within.map(|within| within / off.abs().max(LIGHTEST).sqrt());
            }
            last = self.from(&last, wishes.clone()).solve_at_once()?;
            if self.is_met(&last.vertex) {
                return Some(SynthesizedContact { way: found.way.clone(), ..last });
            }
            let farthest = self.farthest(&last.vertex)?;
            if farthest > NO_NEARER * least {
                return None;
            }
            least = farthest;
        }
        None
    }

    /// At once or step by step, within the ranges of the problem.
    fn walked(&self) -> Option<SynthesizedContact> {
        let direct = self.solve_at_once()?;
        if self.is_met(&direct.vertex) {
            return Some(direct);
        }
        let is_whole = |of: &SynthesizedContact| of.share == 1.0;
        let followed = self.followed();
        let way = followed.as_ref().filter(|of| !is_whole(of)).map(|of| (of.share, of.vertex.clone()));
        let found = match followed {
            Some(followed) if is_whole(&followed) && self.left(&followed.vertex) < self.left(&direct.vertex) => {
                followed
            }
            // where no search ends, what was reached on the way is more than where it wandered to
            Some(followed) if direct.fit.end != SearchEnd::Settled && !is_whole(&followed) => followed,
            _ => direct,
        };
        Some(SynthesizedContact { way, ..found })
    }

    /// In steps, each from where the last one ends, as long as they are met: shorter ones where one is not.
    fn followed(&self) -> Option<SynthesizedContact> {
        let from = self.wishes.iter().map(|wish| wish.of.of(self.vertex)).collect::<Option<Vec<f64>>>()?;
        let mut last: Option<SynthesizedContact> = None;
        let mut step = LONGEST;
        while step >= SHORTEST {
            let gone = last.as_ref().map_or(0.0, |last| last.share);
            let share = (gone + step).min(1.0);
            let wished =
                |(wish, from): (&ContactWish, &f64)| ContactWish { wanted: from + share * wish.way(*from), ..*wish };
            let wishes = self.wishes.iter().zip(&from).map(wished).collect();
            let next = match &last {
                Some(last) => self.from(last, wishes),
                None => ContactSynthesis { wishes, ..self.clone() },
            };
            let found = next.solve_at_once().filter(|found| found.fit.end == SearchEnd::Settled);
            match found.filter(|found| next.holds(&found.vertex)) {
                Some(found) if share == 1.0 => return Some(found),
                Some(found) => (last, step) = (Some(SynthesizedContact { share, ..found }), LONGEST.min(2.0 * step)),
                None => step *= 0.5,
            }
        }
        last
    }

    /// The same from settings that were found.
    fn from<'a>(&'a self, found: &'a SynthesizedContact, wishes: Vec<ContactWish>) -> ContactSynthesis<'a> {
        let mut settings = self.settings.clone();
        settings.iter_mut().zip(&found.fit.values).for_each(|(of, value)| of.start = *value);
        ContactSynthesis { problem: self.problem, vertex: &found.vertex, wishes, settings }
    }

    /// How near one wish can be brought while the others hold, from where settings and contact are and from settings that were found: the nearest of
    /// what is an end, from which these settings bring it no nearer. `None` where no search comes to one.
    ///
    /// # Panics
    /// If there are not as many settings as the pair has parameters.
    #[must_use]
    pub fn nearest(&self, wish: usize, found: &SynthesizedContact) -> Option<ContactPoint> {
        let begun = self.effects()?.iter().map(|of| of.get(wish).map_or(0.0, |by| by * by)).sum::<f64>().sqrt();
        let ends = [self.clone(), self.from(found, self.wishes.clone())].into_iter();
        let ends = ends.filter_map(|of| of.end_of(wish, TURNED_BACK * begun));
        ends.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, vertex)| vertex)
    }

    /// How far off a wish stays while the others hold, with the vertex there: `None` unless free settings change it by less than a limit.
    fn end_of(&self, wish: usize, least: f64) -> Option<(f64, ContactPoint)> {
        // those that need not hold exactly stand with the one that gives way, the vertex's own with the exact ones
        let (exact, soft): (Vec<usize>, Vec<usize>) =
            (0..=self.wishes.len()).filter(|k| *k != wish).partition(|k| self.is_exact(*k));
        let order = [&[wish][..], &soft, &exact].concat();
        let (fit, vertex) = self.search((exact.len(), SETTLED), |_, of| in_order(&of, &order))?;
        let off = fit.residuals[0].abs();
        let free = fit.gradient.iter().zip(&fit.held).filter(|(_, held)| held.is_none()).map(|(slope, _)| slope);
        let slope = free.map(|slope| slope * slope).sum::<f64>().sqrt();
        let holds = fit.exact.iter().all(|off| off.abs() < LEFT);
        (holds && slope <= least * off).then_some((off, vertex))
    }

    /// The same from where settings and contact are, without a way: least squares, in which those that hold exactly outweigh the others, and from
    /// there, if there are others, the least squares of these with the exact ones as conditions.
    ///
    /// # Panics
    /// If there are not as many settings as the pair has parameters.
    #[must_use]
    pub fn solve_at_once(&self) -> Option<SynthesizedContact> {
        let found = |(fit, vertex)| SynthesizedContact { fit, vertex, share: 1.0, way: None };
        let begun = found(self.search((0, SETTLED), |_, of| self.weighted(of))?);
        let (exact, soft): (Vec<usize>, Vec<usize>) = (0..=self.wishes.len()).partition(|row| self.is_exact(*row));
        if soft.is_empty() {
            return Some(begun);
        }
        let order = [&soft[..], &exact].concat();
        let from = self.from(&begun, self.wishes.clone());
        let ended = from.search((exact.len(), SETTLED), |_, of| in_order(&of, &order)).map(found);
        Some(ended.filter(|ended| self.holds(&ended.vertex)).unwrap_or(begun))
    }

    fn weighted(&self, mut of: Linearized) -> Linearized {
        for row in 0..of.residuals.len() {
            let weight = self.weight(row);
            of.residuals[row] *= weight;
            of.jacobian.row_mut(row).iter_mut().for_each(|slope| *slope *= weight);
        }
        of
    }

    /// With so many residuals, the last ones as they are ordered for the values of settings and roll, that are to be zero; it ends where no residual
    /// changes by more than `settled`.
    fn search(
        &self,
        (exact, settled): (usize, f64),
        ordered: impl Fn(&[f64], Linearized) -> Linearized,
    ) -> Option<(LeastSquaresFit, ContactPoint)> {
        let unknowns = self.settings.iter().copied().chain([self.roll()]).collect();
        let problem = LeastSquares { unknowns, exact, resolution: 0.0, uses_weak: false, settled, given_up: None };
        // a step that is not taken leads to a contact, too
        let mut tried: Vec<(Vec<f64>, ContactPoint)> = Vec::new();
        let mut lost = 0;
        let fit = problem.solve(|values| {
            if lost > LOST + LOST_TO_FOUND * tried.len() {
                return None;
            }
            let near = tried.last().map_or(self.vertex, |(_, at)| at);
            let Some((at, linearized)) = self.linearized(near, values) else {
                lost += 1;
                return None;
            };
            tried.push((values.to_vec(), at));
            Some(ordered(values, linearized))
        })?;
        let (_, vertex) = tried.into_iter().rev().find(|(values, _)| *values == fit.values)?;
        Some((fit, vertex))
    }

    /// What each setting changes of the wishes' residuals at the start for its scale, and last the roll; `None` where a number is not there.
    #[must_use]
    pub fn effects(&self) -> Option<Vec<Vec<f64>>> {
        let unknowns: Vec<ScaledUnknown> = self.settings.iter().copied().chain([self.roll()]).collect();
        let start: Vec<f64> = unknowns.iter().map(|of| of.start).collect();
        let (_, Linearized { jacobian, .. }) = self.linearized(self.vertex, &start)?;
        let column = |(k, of): (usize, &ScaledUnknown)| jacobian.col(k).iter().map(|slope| slope * of.scale).collect();
        Some(unknowns.iter().enumerate().map(column).collect())
    }

    /// One mm of the path counts as much as the scale of a setting.
    fn roll(&self) -> ScaledUnknown {
        let everywhere = Range { low: f64::NEG_INFINITY, high: f64::INFINITY };
        ScaledUnknown { start: self.vertex.roll, scale: 1.0 / self.speed(), range: everywhere }
    }

    /// Of the point over the second flank, mm per radian of roll.
    fn speed(&self) -> f64 {
        self.vertex.path[1].iter().map(|x| x * x).sum::<f64>().sqrt().max(1.0)
    }

    /// The vertex is where the first derivative of the lag is zero: it is off by that over the second, along the path.
    fn to_vertex(&self) -> f64 {
        self.speed() / self.vertex.lag_slopes[1].abs().max(EVEN)
    }

    fn linearized(&self, near: &ContactPoint, values: &[f64]) -> Option<(ContactPoint, Linearized)> {
        let (settings, roll) = (&values[..self.settings.len()], values[self.settings.len()]);
        let problem = self.problem.with_values(settings);
        let at = problem.of_flanks(near, roll)?;
        let alone: Vec<Vec<(usize, f64)>> = (0..settings.len()).map(|k| vec![(k, 1.0)]).collect();
        let (by_roll, mut changes) = problem.changes(&at, &alone)?;
        changes.push(by_roll);
        let reading = Reading::of(&at);
        let to_vertex = self.to_vertex();
        let residuals = self.residuals(&at)?;
        let column = |change: &ContactChange| {
            let step = reading.step(change);
            let [before, after] = [-step, step].map(|step| reading.after(step, change));
            let slope = |wish: &ContactWish| Some((wish.residual(&after)? - wish.residual(&before)?) / (2.0 * step));
            self.wishes.iter().map(slope).chain([Some(to_vertex * change.lag_slope)]).collect::<Option<Vec<f64>>>()
        };
        let columns = changes.iter().map(column).collect::<Option<Vec<Vec<f64>>>>()?;
        let jacobian = Mat::from_fn(residuals.len(), columns.len(), |row, k| columns[k][row]);
        Some((at, Linearized { residuals, jacobian }))
    }
}

/// Some of the residuals, in an order.
fn in_order(of: &Linearized, rows: &[usize]) -> Linearized {
    Linearized {
        residuals: rows.iter().map(|row| of.residuals[*row]).collect(),
        jacobian: Mat::from_fn(rows.len(), of.jacobian.ncols(), |row, k| of.jacobian[(rows[row], k)]),
    }
}
