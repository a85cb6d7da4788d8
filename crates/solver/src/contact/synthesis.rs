//! Settings that bring the vertex of a contact where it is wanted: local synthesis.

use faer::Mat;

use crate::contact::corners::FlankCorners;
use crate::contact::{ContactChange, ContactPoint, ContactProblem};
use crate::equations::solution::{Range, verdict};
use crate::newton::least_squares::{LeastSquares, LeastSquaresFit, Linearized, ScaledUnknown, SearchEnd};

/// The search ends where no number changes by more than what is worth so much, mm.
const SETTLED: f64 = 1e-10;
/// What conditions weigh that need not hold exactly: exact ones give way to them by the square of this.
const SOFT: f64 = 1e-4;
/// Numbers are differenced over a change of the contact by this share: its square, and rounding over it, are below 1e-10.
const STEP: f64 = 1e-5;
/// What is left where all that is wanted is there, in what is worth 1 mm.
const LEFT: f64 = 1e-8;
/// The way from what a contact is to what it shall be, where that is too long at once: shares of it that are gone at the most, and at the least
/// before it ends.
const LONGEST: f64 = 1.0 / 8.0;
const SHORTEST: f64 = 1.0 / 256.0;
/// A number that settings change by less than this share of what they changed it by at the beginning has come to its end.
const TURNED_BACK: f64 = 1e-3;
/// An angle of a path that is worth 1 mm, radians.
const ANGLE: f64 = 0.1;
/// Of the derivatives of the lag, where it is almost even, a curvature that counts.
const EVEN: f64 = 1e-9;

/// A number of a contact at its vertex, on the second flank. Lengths are mm, angles radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContactNumber {
    /// Along the axis of the member.
    Z,
    /// Distance from that axis.
    Rho,
    /// Share of the way from toe to heel.
    Lengthwise(FlankCorners),
    /// Share of the way from root to tip.
    Profilewise(FlankCorners),
    /// Angle of the path against the rows.
    Path(FlankCorners),
    /// Length of the ellipse within a film: its longer axis.
    Ellipse {
        /// How thick the film is.
        film: f64,
    },
    /// Second derivative of the lag by the roll.
    Curvature,
}

/// What a number of a contact shall be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactWish {
    /// The number.
    pub of: ContactNumber,
    /// Its value.
    pub wanted: f64,
    /// How far it may be off: then it counts as least squares weigh it, beside those that hold exactly.
    pub within: Option<f64>,
}

/// What is read of a contact.
#[derive(Clone, Copy, Debug)]
struct Reading {
    point: [f64; 3],
    normal: [f64; 3],
    path: [f64; 3],
    /// The smaller curvature of the gap.
    gap: Option<f64>,
    curvature: f64,
}

impl Reading {
    fn of(at: &ContactPoint) -> Reading {
        Reading {
            point: at.in_members[1],
            normal: at.normals[1],
            path: at.path[1],
            gap: at.gap.as_ref().map(|gap| gap.k2),
            curvature: at.lag_slopes[1],
        }
    }

    /// After a step of a change.
    fn after(&self, step: f64, by: &ContactChange) -> Reading {
        let add = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| a[k] + step * b[k]);
        Reading {
            point: add(self.point, by.moved[1]),
            normal: add(self.normal, by.normals[1]),
            path: add(self.path, by.path[1]),
            gap: self.gap.zip(by.gap).map(|(gap, by)| gap + step * by[1]),
            curvature: self.curvature + step * by.lag_curvature,
        }
    }

    /// The step by which a change makes a small share of what is there.
    fn step(&self, by: &ContactChange) -> f64 {
        let size = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let gap = self.gap.zip(by.gap).map_or(0.0, |(gap, by)| by[1] / gap);
        let shares = [
            size(by.moved[1]) / size(self.point),
            size(by.normals[1]),
            size(by.path[1]) / size(self.path),
            gap,
            by.lag_curvature / self.curvature,
        ];
        let fastest = shares.into_iter().filter(|share| share.is_finite()).fold(0.0, |most: f64, x| most.max(x.abs()));
        if fastest > 0.0 { STEP / fastest } else { STEP }
    }
}

impl ContactNumber {
    /// Of a contact of flanks; `None` where it has no such number.
    #[must_use]
    pub fn of(&self, at: &ContactPoint) -> Option<f64> {
        self.read(&Reading::of(at))
    }

    fn read(&self, of: &Reading) -> Option<f64> {
        let [x, y, z] = of.point;
        let rho = x.hypot(y);
        match self {
            ContactNumber::Z => Some(z),
            ContactNumber::Rho => Some(rho),
            ContactNumber::Lengthwise(corners) => Some(corners.shares([z, rho])?[1]),
            ContactNumber::Profilewise(corners) => Some(corners.shares([z, rho])?[0]),
            ContactNumber::Path(corners) => Some(corners.directions(of.point, of.normal)?.angle(of.path)),
            ContactNumber::Ellipse { film } => Some(2.0 * (2.0 * film / of.gap.filter(|gap| *gap > 0.0)?).sqrt()),
            ContactNumber::Curvature => Some(of.curvature),
        }
    }
}

impl ContactWish {
    /// How far a contact is from it, in what is worth 1 mm.
    fn off(&self, of: &Reading) -> Option<f64> {
        let (value, wanted) = (self.of.read(of)?, self.wanted);
        let apart = value - wanted;
        Some(match self.of {
            ContactNumber::Z | ContactNumber::Rho => apart,
            ContactNumber::Lengthwise(corners) => apart * span(&corners, [[0.5, 0.0], [0.5, 1.0]]),
            ContactNumber::Profilewise(corners) => apart * span(&corners, [[0.0, 0.5], [1.0, 0.5]]),
            // a path has no sense
            ContactNumber::Path(_) => {
                let half = std::f64::consts::PI;
                (apart - half * (apart / half).round()) / ANGLE
            }
            // the gap's curvature goes through zero where the ellipse has no end: its logarithm is less bent
            ContactNumber::Ellipse { .. } => wanted * (value / wanted).ln(),
            ContactNumber::Curvature => apart / wanted.abs().max(EVEN),
        })
    }

    /// From a value to what is wanted; of a path the shorter way round.
    fn way(&self, from: f64) -> f64 {
        let way = self.wanted - from;
        match self.of {
            ContactNumber::Path(_) => way - std::f64::consts::PI * (way / std::f64::consts::PI).round(),
            _ => way,
        }
    }

    /// The same as least squares weigh it.
    fn residual(&self, of: &Reading) -> Option<f64> {
        let Some(within) = self.within else { return self.off(of) };
        let wanted = match self.of {
            ContactNumber::Path(_) => self.off(of)? * ANGLE,
            _ => self.of.read(of)? - self.wanted,
        };
        Some(SOFT * wanted / within)
    }
}

fn span(corners: &FlankCorners, ends: [[f64; 2]; 2]) -> f64 {
    let [a, b] = ends.map(|shares| corners.at(shares));
    (b[0] - a[0]).hypot(b[1] - a[1])
}

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
    /// Residuals are those of the wishes, each in what is worth 1 mm, and last the vertex's own; unknowns the settings, then the roll.
    pub fit: LeastSquaresFit,
    /// The vertex: flank on flank, however far beyond their outlines and the ranges of their tools.
    pub vertex: ContactPoint,
    /// The share of the way from what the contact was to what is wanted, which was met; 1 for all of it, met or not.
    pub share: f64,
    /// The last place on the way at which all was met, with its share, where the way ends before.
    pub way: Option<(f64, ContactPoint)>,
}

impl SynthesizedContact {
    /// The sum of the squares that are left.
    fn left(&self) -> f64 {
        self.fit.residuals.iter().map(|off| off * off).sum()
    }

    fn is_met(&self) -> bool {
        self.left() < LEFT * LEFT
    }
}

impl ContactSynthesis<'_> {
    /// Settings and roll with the least squares: from where they are, or where that does not lead to what is wanted, on the way from what the
    /// contact is to that. Where neither does, the flanks are taken to go on beyond the ranges of their tools, and the lag beyond its own:
    /// [`SynthesizedContact::vertex`] tells where they do not. `None` if a number is not there at the start.
    ///
    /// # Panics
    /// If there are not as many settings as the pair has parameters.
    #[must_use]
    pub fn solve(&self) -> Option<SynthesizedContact> {
        let within = self.walked()?;
        if within.is_met() {
            return Some(self.least_changed(within));
        }
        let problem = self.problem.clone().beyond_ranges();
        let ContactSynthesis { vertex, wishes, settings, .. } = self.clone();
        let beyond = ContactSynthesis { problem: &problem, vertex, wishes, settings }.walked();
        let told = |at: ContactPoint| ContactPoint {
            outcome: verdict(&at.all_unknowns(), &self.problem.ranges, true, false),
            ..at
        };
        match beyond {
            Some(beyond) if beyond.is_met() => {
                let least = ContactSynthesis { problem: &problem, ..self.clone() }.least_changed(beyond);
                Some(SynthesizedContact { vertex: told(least.vertex.clone()), ..least })
            }
            beyond => {
                let beyond = beyond.and_then(|of| of.way).map(|(share, at)| (share, told(at)));
                let ways = within.way.clone().into_iter().chain(beyond);
                Some(SynthesizedContact { way: ways.max_by(|a, b| a.0.total_cmp(&b.0)), ..within })
            }
        }
    }

    /// Where more settings than wishes are free, of all that meet the wishes the ones that are changed least, by their scales. A search for the wishes
    /// alone leaves settings where its steps led.
    fn least_changed(&self, found: SynthesizedContact) -> SynthesizedContact {
        let free = self.settings.iter().filter(|of| of.range.low < of.range.high).count();
        if free <= self.wishes.len() || self.wishes.iter().any(|wish| wish.within.is_some()) {
            return found;
        }
        let changed = |values: &[f64]| -> Vec<f64> {
            self.settings.iter().zip(values).map(|(of, value)| (value - of.start) / of.scale).collect()
        };
        let count = self.settings.len();
        let from = self.from(&found, self.wishes.clone());
        let nearer = from.search(self.wishes.len() + 1, |values, of| Linearized {
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
        let ended = self.from(&near, self.wishes.clone()).solve_at_once().filter(SynthesizedContact::is_met);
        let size = |of: &SynthesizedContact| changed(&of.fit.values).iter().map(|x| x * x).sum::<f64>();
        match ended {
            Some(ended) if size(&ended) < size(&found) => SynthesizedContact { way: found.way, ..ended },
            _ => found,
        }
    }

    /// At once or step by step, within the ranges of the problem.
    fn walked(&self) -> Option<SynthesizedContact> {
        let direct = self.solve_at_once()?;
        if direct.is_met() {
            return Some(direct);
        }
        let is_whole = |of: &SynthesizedContact| of.share == 1.0;
        let followed = self.followed();
        let way = followed.as_ref().filter(|of| !is_whole(of)).map(|of| (of.share, of.vertex.clone()));
        let found = match followed {
            Some(followed) if is_whole(&followed) && followed.left() < direct.left() => followed,
            // where no search ends, what was reached on the way is more than where it wandered to
            Some(followed) if direct.fit.end != SearchEnd::Settled && !is_whole(&followed) => followed,
            _ => direct,
        };
        Some(SynthesizedContact { way, ..found })
    }

    /// In steps, each from where the last one ends, as long as they are met: shorter ones where one is not.
    fn followed(&self) -> Option<SynthesizedContact> {
        let from = self.wishes.iter().map(|wish| wish.of.of(self.vertex)).collect::<Option<Vec<f64>>>()?;
        let is_exact = self.wishes.iter().all(|wish| wish.within.is_none());
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
            match found.filter(|found| found.is_met() || !is_exact) {
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
        let is_exact = |k: &usize| *k != wish && self.wishes.get(*k).is_none_or(|wish| wish.within.is_none());
        // those that need not hold exactly stand with the one that gives way, the vertex's own with the exact ones
        let (exact, soft): (Vec<usize>, Vec<usize>) =
            (0..=self.wishes.len()).filter(|k| *k != wish).partition(is_exact);
        let order = [&[wish][..], &soft, &exact].concat();
        let (fit, vertex) = self.search(exact.len(), |_, of: Linearized| Linearized {
            residuals: order.iter().map(|row| of.residuals[*row]).collect(),
            jacobian: Mat::from_fn(order.len(), of.jacobian.ncols(), |row, k| of.jacobian[(order[row], k)]),
        })?;
        let off = fit.residuals[0].abs();
        let free = fit.gradient.iter().zip(&fit.held).filter(|(_, held)| held.is_none()).map(|(slope, _)| slope);
        let slope = free.map(|slope| slope * slope).sum::<f64>().sqrt();
        let holds = fit.exact.iter().all(|off| off.abs() < LEFT);
        (holds && slope <= least * off).then_some((off, vertex))
    }

    /// The same from where settings and contact are, without a way.
    ///
    /// # Panics
    /// If there are not as many settings as the pair has parameters.
    #[must_use]
    pub fn solve_at_once(&self) -> Option<SynthesizedContact> {
        let (fit, vertex) = self.search(0, |_, linearized| linearized)?;
        Some(SynthesizedContact { fit, vertex, share: 1.0, way: None })
    }

    /// With so many residuals, the last ones as they are ordered for the values of settings and roll, that are to be zero.
    fn search(
        &self,
        exact: usize,
        ordered: impl Fn(&[f64], Linearized) -> Linearized,
    ) -> Option<(LeastSquaresFit, ContactPoint)> {
        let unknowns = self.settings.iter().copied().chain([self.roll()]).collect();
        let problem =
            LeastSquares { unknowns, exact, resolution: 0.0, uses_weak: false, settled: SETTLED, given_up: None };
        // a step that is not taken leads to a contact, too
        let mut tried: Vec<(Vec<f64>, ContactPoint)> = Vec::new();
        let fit = problem.solve(|values| {
            let near = tried.last().map_or(self.vertex, |(_, at)| at);
            let (at, linearized) = self.linearized(near, values)?;
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

    fn linearized(&self, near: &ContactPoint, values: &[f64]) -> Option<(ContactPoint, Linearized)> {
        let (settings, roll) = (&values[..self.settings.len()], values[self.settings.len()]);
        let problem = self.problem.with_values(settings);
        let at = problem.of_flanks(near, roll)?;
        let alone: Vec<Vec<(usize, f64)>> = (0..settings.len()).map(|k| vec![(k, 1.0)]).collect();
        let (by_roll, mut changes) = problem.changes(&at, &alone)?;
        changes.push(by_roll);
        let reading = Reading::of(&at);
        // the vertex is where the first derivative is zero: it is off by that over the second, along the path
        let to_vertex = self.speed() / self.vertex.lag_slopes[1].abs().max(EVEN);
        let own = self.wishes.iter().map(|wish| wish.residual(&reading));
        let residuals = own.chain([Some(to_vertex * at.lag_slopes[0])]).collect::<Option<Vec<f64>>>()?;
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
