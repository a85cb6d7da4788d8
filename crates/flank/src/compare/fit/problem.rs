//! The settings of surfaces, and points that these shall go through, as least squares.

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use flank_chain_dsl::{GeneratedSurface, Parameter};
use flank_solver::{
    AdjustableSurface, AdjustedSurfaces, Alignment, BoundSurface, Foot, NearFoot, Range, ScaledUnknown,
    SettingsAdjustment, Shapes, WantedPoints,
};

use super::aim::{Aim, Aimed};
use super::keep::Keep;
use super::settings::{held, unknown};
use crate::compare::map::Named;
use crate::project::failure::Failure;
use crate::project::requests::FitRequest;
use crate::project::units;
use crate::solve;

/// What is beyond an end by this share of a range stands on it: points are asked for at ends.
const ON_THE_END: f64 = 1e-9;
/// The motion's scale is what moves the points by so much, mm: as much as the scale of a length.
pub(super) const MOTION: f64 = 0.1;

/// Surfaces in open settings, with the points that have a foot on them.
pub(super) struct Problem<'p, 'g> {
    pub(super) settings: Vec<&'p Parameter<'g>>,
    /// The settings as unknowns.
    pub(super) unknowns: Vec<ScaledUnknown>,
    /// What each setting is set in steps of.
    pub(super) steps: Vec<Option<f64>>,
    surfaces: Vec<AdjustableSurface>,
    /// Of each surface, of each of its unknowns.
    ends: Vec<Vec<End>>,
    /// Of each surface the places of its points in the grid.
    pub(super) places: Vec<Vec<usize>>,
    points: Vec<Vec<Aimed>>,
    /// In which motion the place of the points is unknown.
    pub(super) alignment: Alignment,
    pub(super) motion: ScaledUnknown,
    /// Of each surface behind the first by how much further it is moved, where its points lie as they like.
    pub(super) further: Vec<ScaledUnknown>,
    /// What corrected settings leave where it is.
    pub(super) keeps: Vec<Keep>,
    /// The parts of the distances that are fitted.
    shapes: Option<Shapes>,
    resolution: f64,
    /// A measured flank comes from settings, a wanted one need not.
    is_measured: bool,
}

impl<'p, 'g> Problem<'p, 'g> {
    /// # Errors
    /// If no point has a foot, or a step is none of its setting.
    pub(super) fn new(
        aims: &[Aim<'_, 'g>],
        settings: Vec<&'p Parameter<'g>>,
        keeps: Vec<Keep>,
        request: &FitRequest,
    ) -> Result<Problem<'p, 'g>, Failure> {
        let steps = super::settings::steps(&settings, &request.round)?;
        let surfaces: Vec<AdjustableSurface> = aims.iter().map(|aim| adjustable(aim.of, &settings)).collect();
        let (as_it_lies, resolution) = (request.as_it_lies, request.resolution);
        let alone = |k: usize| Aim::first_motion(&aims[k..=k]);
        let start = match () {
            () if as_it_lies => 0.0,
            () if request.is_thickness_free => alone(0),
            () => Aim::first_motion(aims),
        };
        let further = |k: usize| if request.is_thickness_free && k > 0 { alone(k) - start } else { 0.0 };
        // surfaces of one body
        let alignment = aims.first().map(|aim| aim.of.alignment()).unwrap_or_default();
        let now: Vec<f64> = settings.iter().map(|of| of.value).collect();
        let (mut places, mut points) = (Vec::new(), Vec::new());
        let (mut squares, mut count) = (vec![0.0; settings.len()], 0.0);
        for (k, (aim, surface)) in aims.iter().zip(&surfaces).enumerate() {
            let known: Vec<(usize, &Aimed)> =
                aim.points.iter().enumerate().filter_map(|(at, point)| Some((at, point.as_ref()?))).collect();
            let positions: Vec<[f64; 3]> =
                known.iter().map(|(_, point)| alignment.moved(point.position, start + further(k))).collect();
            let near: Vec<NearFoot> = known.iter().map(|(_, point)| point.near.clone()).collect();
            let feet = surface.at(&now).feet(&positions, &near);
            for foot in feet.iter().flatten() {
                squares.iter_mut().zip(&foot.moved).for_each(|(sum, moved)| *sum += moved * moved);
                count += 1.0;
            }
            let met = known.into_iter().zip(feet).filter(|(_, foot)| foot.is_some());
            let (own, aimed): (Vec<usize>, Vec<Aimed>) = met.map(|((at, point), _)| (at, point.clone())).unzip();
            places.push(own);
            points.push(aimed);
        }
        let arcs: Vec<f64> = points.iter().flatten().map(|of| alignment.arc(of.position)).collect();
        if arcs.is_empty() {
            let name = aims.first().map_or("", |aim| &aim.of.surface.name);
            return Err(Failure::Unsolved(format!(
                "no normal of `{name}` within its ranges goes through any of the points"
            )));
        }
        let arc = arcs.iter().sum::<f64>() / arcs.len() as f64;
        let most = match alignment {
            _ if as_it_lies => 0.0,
            Alignment::Turn => 2.0 * TAU,
            Alignment::Shift => f64::INFINITY,
        };
        let range = Range { low: -most, high: most };
        let motion = ScaledUnknown { start, scale: MOTION / arc.max(MOTION), range };
        let each = if request.is_thickness_free { 1..aims.len() } else { 0..0 };
        let further = each.map(|k| ScaledUnknown { start: further(k), ..motion }).collect();
        let moved = squares.iter().map(|sum: &f64| (sum / count).sqrt());
        let unknowns = settings.iter().zip(moved).map(|(of, moved)| unknown(of, moved)).collect();
        let ends = aims.iter().map(|aim| ends(aim.of.surface)).collect();
        let shapes = request.order.map(|order| shapes(aims, &places, order));
        Ok(Problem {
            settings,
            unknowns,
            steps,
            surfaces,
            ends,
            places,
            points,
            alignment,
            motion,
            further,
            keeps,
            shapes,
            resolution,
            is_measured: !request.is_wish(),
        })
    }

    /// The part of distances that is fitted.
    pub(super) fn part(&self, of: Vec<f64>) -> Vec<f64> {
        self.shapes.as_ref().map_or_else(|| of.clone(), |shapes| shapes.part(&of))
    }

    /// Shapes of deviations that are smooth over each surface: at the most squares in rows and columns, in fewer lines less, so that each line is
    /// predicted by two more than it takes.
    pub(super) fn smooth(&self, aims: &[Aim<'_, '_>]) -> Vec<Vec<f64>> {
        let powers = |surface: usize| {
            let columns = aims[surface].counts[1];
            let most = |line: &dyn Fn(&usize) -> usize| {
                let lines: BTreeSet<usize> = self.places[surface].iter().map(line).collect();
                lines.len().saturating_sub(3).min(2) as i32
            };
            let [along_v, along_u] = [most(&|at| at / columns), most(&|at| at % columns)];
            (0..=along_v).flat_map(|v| (0..=along_u).map(move |u| [v, u])).collect()
        };
        products(aims, &self.places, powers)
    }

    /// Of settings, by their places, those that somebody can set: an error of the machine stays what it is.
    pub(super) fn settable(&self, free: &[usize]) -> Vec<usize> {
        free.iter().copied().filter(|k| !self.settings[*k].is_error).collect()
    }

    /// How many points there are.
    pub(super) fn count(&self) -> usize {
        self.points.iter().map(Vec::len).sum()
    }

    /// How many feet lie beyond the ends of their surfaces, and by which of their unknowns.
    pub(super) fn beyond(&self, of: &AdjustedSurfaces) -> (usize, Vec<&str>) {
        let (mut count, mut names) = (0, Vec::new());
        for (feet, ends) in of.feet.iter().zip(&self.ends) {
            let is_off = |foot: &Foot, k: usize| ends[k].range.is_some_and(|range| !is_in(range, foot.unknowns[k]));
            let places = 0..ends.len();
            count += feet.iter().filter(|foot| places.clone().any(|k| is_off(foot, k))).count();
            let off = places.filter(|k| feet.iter().any(|foot| is_off(foot, *k)));
            names.extend(off.map(|k| ends[k].name.as_str()));
        }
        names.dedup();
        (count, names)
    }

    /// The settings as they are: only the motion is looked for.
    ///
    /// # Errors
    /// If a point loses its foot.
    pub(super) fn as_it_is(&self) -> Result<AdjustedSurfaces, Failure> {
        let motions: Vec<f64> = [&self.motion].into_iter().chain(&self.further).map(|of| of.start).collect();
        self.fitted((&self.points, &[]), &motions, (&[], &[]))
    }

    /// The motions of a fit: that of all points, then by how much further those of each surface behind the first are moved.
    pub(super) fn motions<'a>(&self, of: &'a AdjustedSurfaces) -> &'a [f64] {
        &of.fit.values[self.settings.len()..]
    }

    /// Of the points of a surface.
    pub(super) fn motion_of(&self, fit: &AdjustedSurfaces, surface: usize) -> f64 {
        let motions = self.motions(fit);
        motions[0] + motions.get(surface).filter(|_| surface > 0).copied().unwrap_or_default()
    }

    /// With some settings free, from where the points lie nearest to the surface as it is.
    ///
    /// # Errors
    /// If a point loses its foot.
    pub(super) fn identified(&self, now: &AdjustedSurfaces, free: &[usize]) -> Result<AdjustedSurfaces, Failure> {
        self.fitted((&self.points, &[]), self.motions(now), (free, &[]))
    }

    /// The same without some of the points, by their places among all: the surfaces as they are and with some settings free. `None` if a point loses
    /// its foot.
    pub(super) fn without(
        &self,
        now: &AdjustedSurfaces,
        (left_out, free): (&[usize], &[usize]),
    ) -> Option<[AdjustedSurfaces; 2]> {
        let mut from = 0;
        let of_surface = |points: &Vec<Aimed>| -> Vec<Aimed> {
            let own = points.iter().enumerate().filter(|(k, _)| !left_out.contains(&(from + k)));
            let kept = own.map(|(_, point)| point.clone()).collect();
            from += points.len();
            kept
        };
        let points: Vec<Vec<Aimed>> = self.points.iter().map(of_surface).collect();
        let before = self.fitted((&points, &[]), self.motions(now), (&[], &[])).ok()?;
        let left = self.fitted((&points, &[]), self.motions(&before), (free, &[])).ok()?;
        Some([before, left])
    }

    /// All points with the settings and the motions of a fit. `None` if one loses its foot.
    pub(super) fn all_at(&self, fit: &AdjustedSurfaces) -> Option<AdjustedSurfaces> {
        let at = |of: &ScaledUnknown, value: &f64| held(ScaledUnknown { start: *value, ..*of });
        let motions = self.motions(fit);
        let adjustment = self.adjustment((&self.points, &[]), motions, (&[], &[]));
        let settled = SettingsAdjustment {
            settings: self.unknowns.iter().zip(&fit.fit.values).map(|(of, value)| at(of, value)).collect(),
            motion: at(&self.motion, &motions[0]),
            further: self.further.iter().zip(&motions[1..]).map(|(of, value)| at(of, value)).collect(),
            ..adjustment
        };
        settled.solve()
    }

    /// What the directions that a fit uses do to the distances of points.
    pub(super) fn directions(&self, fit: &AdjustedSurfaces, points: &AdjustedSurfaces) -> Vec<Vec<f64>> {
        let unknowns = self.unknowns.iter().chain([&self.motion]).chain(&self.further);
        let effects: Vec<(f64, Vec<f64>)> = unknowns.enumerate().map(|(k, of)| (of.scale, points.effect(k))).collect();
        let along = |shares: &Vec<f64>| {
            let mut sum = vec![0.0; self.count()];
            for (share, (scale, effect)) in shares.iter().zip(&effects) {
                sum.iter_mut().zip(effect).for_each(|(sum, of)| *sum += share * scale * of);
            }
            sum
        };
        fit.fit.directions.iter().filter(|of| of.is_used).map(|of| along(&of.shares)).collect()
    }

    /// The same for points that lie on the other side of the surface by a share of the way.
    ///
    /// # Errors
    /// If a point loses its foot.
    pub(super) fn corrected(
        &self,
        now: &AdjustedSurfaces,
        free: &[usize],
        share: f64,
    ) -> Result<AdjustedSurfaces, Failure> {
        let mirrored = now.feet.iter().map(|feet| {
            let point = |foot: &Foot| {
                let off = -share * foot.distance;
                let position = std::array::from_fn(|k| foot.position[k] + off * foot.normal[k]);
                Aimed { position, near: NearFoot { unknowns: foot.unknowns.clone(), distance: off } }
            };
            feet.iter().map(point).collect()
        });
        let mirrored: Vec<Vec<Aimed>> = mirrored.collect();
        self.rounded(&mirrored, &vec![0.0; 1 + self.further.len()], free)
    }

    /// A wanted surface: that of the points themselves.
    ///
    /// # Errors
    /// If a point loses its foot.
    pub(super) fn reached(&self, now: &AdjustedSurfaces, free: &[usize]) -> Result<AdjustedSurfaces, Failure> {
        self.rounded(&self.points, self.motions(now), free)
    }

    /// Settings that have a step are brought onto it one by one, and the others are fitted again.
    fn rounded(&self, points: &[Vec<Aimed>], motions: &[f64], free: &[usize]) -> Result<AdjustedSurfaces, Failure> {
        let mut fixed = Vec::new();
        let mut found = self.fitted((points, &self.keeps), motions, (free, &fixed))?;
        for &k in free {
            let Some(step) = self.steps[k] else { continue };
            let Range { low, high } = self.unknowns[k].range;
            let whole = (found.fit.values[k] / step).round();
            let inside = whole.max((low / step).ceil()).min((high / step).floor());
            fixed.push((k, inside * step));
            found = self.fitted((points, &self.keeps), motions, (free, &fixed))?;
        }
        Ok(found)
    }

    /// From these motions, with settings free, some of which are fixed at values; all others stay as they are.
    fn fitted(
        &self,
        points: (&[Vec<Aimed>], &[Keep]),
        motions: &[f64],
        settings: (&[usize], &[(usize, f64)]),
    ) -> Result<AdjustedSurfaces, Failure> {
        let lost =
            "the points have no feet on the surface where they lie nearest to it: are they points of this flank?";
        let solved = if self.count() > 0 { self.adjustment(points, motions, settings).solve() } else { None };
        solved.ok_or(Failure::Unsolved(lost.to_string()))
    }

    fn adjustment<'s>(
        &'s self,
        (points, keeps): (&[Vec<Aimed>], &'s [Keep]),
        motions: &[f64],
        (free, fixed): (&[usize], &[(usize, f64)]),
    ) -> SettingsAdjustment<'s> {
        let kept = keeps.iter().map(|keep| (&keep.surface, &keep.points)).map(wanted);
        let settings = self.unknowns.iter().enumerate();
        let settings = settings.map(|(k, of)| match fixed.iter().find(|(at, _)| *at == k) {
            Some((_, value)) => held(ScaledUnknown { start: *value, ..*of }),
            None if free.contains(&k) => *of,
            None => held(*of),
        });
        SettingsAdjustment {
            wanted: self.surfaces.iter().zip(points).map(wanted).collect(),
            kept: kept.collect(),
            settings: settings.collect(),
            alignment: self.alignment,
            motion: ScaledUnknown { start: motions[0], ..self.motion },
            further: self
                .further
                .iter()
                .zip(&motions[1..])
                .map(|(of, at)| ScaledUnknown { start: *at, ..*of })
                .collect(),
            shapes: self.shapes.clone(),
            resolution: self.resolution,
            uses_weak: self.is_measured,
        }
    }
}

/// Of each surface a constant, the slopes in both directions of its grid and, of the second order, their squares and their product.
fn shapes(aims: &[Aim<'_, '_>], places: &[Vec<usize>], order: u8) -> Shapes {
    let terms: &[[i32; 2]] = &[[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]];
    let terms = &terms[..if order == 1 { 3 } else { 6 }];
    Shapes::new(&products(aims, places, |_| terms.to_vec()))
}

/// Of each surface the products of powers of the places of its points, from -1 to 1 in rows and in columns.
fn products(aims: &[Aim<'_, '_>], places: &[Vec<usize>], powers: impl Fn(usize) -> Vec<[i32; 2]>) -> Vec<Vec<f64>> {
    let all: usize = places.iter().map(Vec::len).sum();
    let mut from = 0;
    let mut found = Vec::new();
    for (surface, (aim, places)) in aims.iter().zip(places).enumerate() {
        let share = |at: usize, count: usize| if count > 1 { 2.0 * at as f64 / (count - 1) as f64 - 1.0 } else { 0.0 };
        for [along_v, along_u] in powers(surface) {
            let mut shape = vec![0.0; all];
            for (value, at) in shape[from..].iter_mut().zip(places) {
                let [v, u] = [share(at / aim.counts[1], aim.counts[0]), share(at % aim.counts[1], aim.counts[1])];
                *value = v.powi(along_v) * u.powi(along_u);
            }
            found.push(shape);
        }
        from += places.len();
    }
    found
}

/// Where a surface ends in one of its unknowns.
struct End {
    name: String,
    /// None of an angle that goes all around, and comes back to where it was.
    range: Option<Range>,
}

fn ends(surface: &GeneratedSurface<'_>) -> Vec<End> {
    let ranges = solve::ranges(surface).into_iter().zip(&surface.unknowns);
    let end = ranges.map(|(range, of)| {
        let has_ends = !units::is_angle(of.dimension) || range.high - range.low < TAU - ON_THE_END;
        End { name: of.name.clone(), range: has_ends.then_some(range) }
    });
    end.collect()
}

fn is_in(range: Range, value: f64) -> bool {
    let margin = ON_THE_END * (range.high - range.low);
    value >= range.low - margin && value <= range.high + margin
}

fn wanted<'s>((surface, points): (&'s AdjustableSurface, &Vec<Aimed>)) -> WantedPoints<'s> {
    let near = points.iter().map(|point| point.near.clone()).collect();
    WantedPoints { surface, points: points.iter().map(|point| point.position).collect(), near }
}

/// A surface with these settings open; what follows them does so. Feet are looked for beyond its ranges, which may move with the settings.
pub(super) fn adjustable<'g>(of: Named<'_, 'g>, settings: &[&Parameter<'g>]) -> AdjustableSurface {
    let open: Vec<_> = settings.iter().map(|of| of.variable).collect();
    let Named { job, surface } = of;
    let bound = BoundSurface::new(&surface.surface, solve::followed(surface), &job.bindings_beside(&open));
    AdjustableSurface::new(&bound, &open).expect("a job without errors leaves nothing unbound")
}
