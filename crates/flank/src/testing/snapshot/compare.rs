//! What differs between two snapshots of a spec, in the words of gears.

use flank_chain_dsl::Sample;
use flank_draw::{PictureOptions, field_maps};
use flank_export::{Axis, Dataset, Field, Header, Patch, Values};
use flank_solver::{Outcome, SurfacePoint};
use nalgebra::Vector3;

use crate::project::Project;
use crate::project::failure::Failure;
use crate::project::{shown_path, units};
use crate::solve::{cut, patch};
use crate::testing::explain::{Moved, explained};
use crate::testing::judge::{precise, significant};
use crate::testing::points::{Tested, place};
use crate::testing::snapshot::angles::turned;
use crate::testing::snapshot::text::{Kept, KeptSurface};

/// Nine digits of some hundred millimetres end here, mm.
const DIGITS: f64 = 2e-6;
/// Those of what edges leave, mm.
const LEFT_DIGITS: f64 = 2e-9;
/// The status of points that are found.
const SOLVED: &str = "solved";
/// Names of settings that are told.
const NAMED: usize = 3;

type Told = (Vec<String>, Option<String>);

/// What differs, a line each, and the map of the surface that moved most.
pub(super) fn told(
    jobs: &[Tested<'_, '_>],
    (before, now): (&[KeptSurface], &[KeptSurface]),
    project: &Project,
) -> Result<Told, Failure> {
    let (mut lines, mut picture) = (Vec::new(), None);
    let whole = |of: &KeptSurface| format!("{}.{}", of.job, of.name);
    for old in before.iter().filter(|old| !now.iter().any(|new| whole(new) == whole(old))) {
        lines.push(format!("{}: there is no such sampled surface any more", whole(old)));
    }
    for new in now.iter().filter(|new| !before.iter().any(|old| whole(new) == whole(old))) {
        lines.push(format!("{}: this surface is new", whole(new)));
    }
    for tested in jobs {
        let mut moved = Vec::new();
        for (index, surface) in tested.job.surfaces.iter().enumerate() {
            let name = format!("{}.{}", tested.job.name, surface.name);
            let both = (before.iter().find(|old| whole(old) == name), now.iter().find(|new| whole(new) == name));
            let (Some(old), Some(new)) = both else { continue };
            if old.is_same(new) {
                continue;
            }
            let beside = Beside::new(tested, index, old);
            lines.extend(beside.told(new));
            moved.extend(beside.moved());
            picture = picture.or_else(|| beside.picture(project));
        }
        lines.extend(settings(tested, &moved));
    }
    if lines.is_empty() {
        lines.push("only the order of jobs and surfaces differs".to_string());
    }
    Ok((lines, picture))
}

/// The settings that explain best how surfaces of a job moved.
fn settings(tested: &Tested<'_, '_>, moved: &[Moved]) -> Option<String> {
    if moved.is_empty() {
        return None;
    }
    let found = explained(tested, moved);
    let Some(best) = found.first() else {
        return Some(format!("{}: explained by none of its settings", tested.job.name));
    };
    let each = found.iter().take(NAMED).map(|one| {
        let by = precise(one.dimension, one.by);
        let sign = if one.by > 0.0 { "+" } else { "" };
        format!("{} {sign}{by} ({} %)", one.name, significant((1000.0 * one.share).round() / 10.0))
    });
    let each: Vec<String> = each.collect();
    let what = if best.share > 0.5 { "explained best by" } else { "explained by no single setting; nearest come" };
    Some(format!("{}: {what} {}", tested.job.name, each.join(", ")))
}

/// A surface at the places of its snapshot.
struct Beside<'t, 'j, 'g> {
    tested: &'t Tested<'j, 'g>,
    index: usize,
    old: &'t KeptSurface,
    /// As it is there now, if it has the coordinates.
    now: Option<(Sample<'g>, Vec<SurfacePoint>)>,
}

impl<'t, 'j, 'g> Beside<'t, 'j, 'g> {
    fn new(tested: &'t Tested<'j, 'g>, index: usize, old: &'t KeptSurface) -> Beside<'t, 'j, 'g> {
        let surface = tested.surface(index);
        let [first, second] = old.coordinates.each_ref().map(|name| surface.coordinate(name));
        let coordinates = first.zip(second).map(|(first, second)| [first, second]);
        let at: Vec<[f64; 2]> = old.points.iter().map(|point| point.at).collect();
        let now = coordinates.map(|coordinates| tested.generated(index, coordinates, at));
        Beside { tested, index, old, now }
    }

    /// How far each point is from where it was, along what the surface's normals there were and are together, and along the surface, mm.
    ///
    /// Of a point that slides along a curved surface the chord leaves the tangent plane; of the sum of both normals it does not, to second
    /// order, so that what slides does not move.
    fn ways(&self) -> Vec<Option<[f64; 2]>> {
        let Some((_, points)) = &self.now else { return Vec::new() };
        let ways = self.old.points.iter().zip(points).map(|(old, new)| {
            (old.is_solved() && new.outcome == Outcome::Solved).then(|| {
                let way = Vector3::from(new.position) - Vector3::from(old.position);
                let both = Vector3::from(old.normal) + Vector3::from(new.normal);
                let along = 0.5 * both.dot(&way);
                [along, (way.norm_squared() - along * along).max(0.0).sqrt()]
            })
        });
        ways.collect()
    }

    /// How far each point moved along its normal, mm.
    fn displacements(&self) -> Vec<Option<f64>> {
        self.ways().into_iter().map(|way| way.map(|[along, _]| along)).collect()
    }

    /// What moved by more than the digits of a snapshot show.
    fn moved(&self) -> Option<Moved> {
        let (_, points) = self.now.as_ref()?;
        let by = self.displacements();
        let is_moved = by.iter().flatten().any(|by| by.abs() > DIGITS);
        is_moved.then(|| Moved { surface: self.index, points: points.clone(), by })
    }

    fn told(&self, new: &KeptSurface) -> Vec<String> {
        let name = format!("{}.{}", self.old.job, self.old.name);
        let Some((sample, points)) = &self.now else {
            return vec![format!("{name}: it has no coordinates {} any more", self.old.coordinates.join(" and "))];
        };
        let mut lines = Vec::new();
        let by = self.displacements();
        let largest = by.iter().enumerate().filter_map(|(k, by)| by.map(|by| (k, by)));
        let largest = largest.reduce(|a, b| if b.1.abs() > a.1.abs() { b } else { a });
        if let Some((k, most)) = largest.filter(|(_, most)| most.abs() > DIGITS) {
            let known: Vec<f64> = by.iter().flatten().copied().collect();
            let rms = (known.iter().map(|x| x * x).sum::<f64>() / known.len() as f64).sqrt();
            lines.push(format!(
                "{name} moved along its normal by at most {} at {}, rms {}{}",
                precise(flank_chain_dsl::Dimension::LENGTH, most),
                place(sample, k),
                precise(flank_chain_dsl::Dimension::LENGTH, rms),
                self.angles(points)
            ));
        } else if let Some(slid) = self.slid(sample) {
            lines.push(format!("{name} is the same surface, along which {slid}"));
        }
        lines.extend(self.other_left(&name, new, (sample, points)));
        lines.extend(self.other_statuses(&name, new));
        lines.extend(self.other_branch(&name, points));
        lines.extend(self.other_sample(&name, new));
        if self.old.work != new.work && lines.is_empty() {
            let [[old, old_boxes], [new, new_boxes]] = [self.old.work, new.work];
            lines.push(format!(
                "{name}: the same points took {new} evaluations and {new_boxes} boxes instead of {old} and {old_boxes}"
            ));
        }
        if lines.is_empty() {
            lines.push(format!("{name}: its sample, its frame or its last digits differ"));
        }
        lines
    }

    /// What the edges leave that cut it, beside what they left.
    fn other_left(
        &self,
        name: &str,
        new: &KeptSurface,
        (sample, points): (&Sample<'_>, &[SurfacePoint]),
    ) -> Vec<String> {
        let by = match (&self.old.cut_by, &new.cut_by) {
            (None, None) => return Vec::new(),
            (None, Some(by)) => return vec![format!("{name}: the snapshot does not say what {by} leaves over it")],
            (Some(by), None) => return vec![format!("{name}: it is not cut by {by} any more")],
            (Some(_), Some(by)) => by,
        };
        let Tested { job, session, .. } = *self.tested;
        let Some(now) = cut::heights(job, self.tested.surface(self.index), points, session) else { return Vec::new() };
        let both =
            || self.old.points.iter().zip(&now).enumerate().filter(|(k, _)| points[*k].outcome == Outcome::Solved);
        let changes = both().filter_map(|(k, (old, now))| {
            let change = (*now)? - old.left;
            (change.abs() > LEFT_DIGITS).then_some((k, old.left, change))
        });
        let mut lines = Vec::new();
        if let Some((k, was, change)) = changes.reduce(|a, b| if b.2.abs() > a.2.abs() { b } else { a }) {
            let length = |value| precise(flank_chain_dsl::Dimension::LENGTH, value);
            lines.push(format!(
                "{name}: the edges of {by} leave {} over it instead of {}, most changed at {}",
                length(was + change),
                length(was),
                place(sample, k)
            ));
        }
        let differs =
            |(_, (old, now)): &(usize, (&Kept, &Option<f64>))| old.is_solved() && old.left.is_nan() == now.is_some();
        let known = both().filter(differs).count();
        if known > 0 {
            let count = units::counted(known, "point");
            lines.push(format!("{name}: at {count} what {by} leaves is known now and was not, or the other way round"));
        }
        lines
    }

    /// What became of points that were solved, and what those were that are solved now.
    fn other_statuses(&self, name: &str, new: &KeptSurface) -> Vec<String> {
        let Some((sample, points)) = &self.now else { return Vec::new() };
        // what is cut away in the end is known of the places of the sample alone
        let is_sampled = self.old.is_at_places_of(new);
        let now = |k: usize| if is_sampled { new.points[k].status.as_str() } else { points[k].outcome.word() };
        let was = |k: usize| self.old.points[k].status.as_str();
        let mut lines = Vec::new();
        for (before, after, what) in
            [(true, false, "no longer solved, but"), (false, true, "solved that were"), (false, false, "now")]
        {
            let differs = |k: &usize| {
                let is_so = self.old.points[*k].is_solved() == before && (now(*k) == SOLVED) == after;
                is_so && now(*k) != was(*k)
            };
            let changed: Vec<usize> = (0..points.len()).filter(differs).collect();
            let Some(first) = changed.first() else { continue };
            let other = |k: &usize| match (before, after) {
                (true, _) => now(*k).to_string(),
                (false, true) => was(*k).to_string(),
                (false, false) => format!("{} instead of {}", now(*k), was(*k)),
            };
            let mut kinds: Vec<String> = changed.iter().map(|k| other(k).replace('_', " ")).collect();
            kinds.sort();
            kinds.dedup();
            let count = format!("{} of {}", changed.len(), units::counted(points.len(), "point"));
            lines.push(format!(
                "{name}: {count} {what} {}, the first at {}",
                kinds.join(" or "),
                place(sample, *first)
            ));
        }
        let old = self.old;
        if old.asked == new.asked && old.solved != new.solved {
            lines.push(format!(
                "{name}: of {} that were looked at, {} are solved instead of {}",
                old.asked, new.solved, old.solved
            ));
        }
        lines
    }

    /// What differs in the places that are asked for.
    fn other_sample(&self, name: &str, new: &KeptSurface) -> Option<String> {
        let old = self.old;
        if old.coordinates != new.coordinates {
            let [before, now] = [old, new].map(|of| of.coordinates.join(" and "));
            Some(format!("{name}: its sample is by {now} instead of {before}"))
        } else if old.asked != new.asked {
            let now = units::counted(new.asked, "point");
            Some(format!("{name}: its sample is another one: {now} of it are looked at instead of {}", old.asked))
        } else if !old.is_at_places_of(new) {
            Some(format!("{name}: its sample has other places"))
        } else {
            None
        }
    }

    /// How far points slid along a surface that did not move.
    fn slid(&self, sample: &Sample<'_>) -> Option<String> {
        let along = self.ways().into_iter().enumerate().filter_map(|(k, way)| Some((k, way?[1])));
        let (k, most) = along.reduce(|a, b| if b.1 > a.1 { b } else { a }).filter(|(_, most)| *most > DIGITS)?;
        let most = precise(flank_chain_dsl::Dimension::LENGTH, most);
        Some(format!("points slid by at most {most} at {}", place(sample, k)))
    }

    /// By which angles of gears it turned.
    fn angles(&self, points: &[SurfacePoint]) -> String {
        // labels are not kept: those of today hold for the same coordinates
        let is_same =
            |sample: &&Sample<'_>| sample.coordinates.each_ref().map(|of| &of.name) == self.old.coordinates.each_ref();
        let sample = self.tested.surface(self.index).sample.as_ref().filter(is_same);
        sample.map_or(String::new(), |sample| turned(self.old, points, &sample.labels))
    }

    /// Whether unknowns are elsewhere at points that are the same.
    fn other_branch(&self, name: &str, points: &[SurfacePoint]) -> Option<String> {
        let surface = self.tested.surface(self.index);
        let jumped = self.old.points.iter().zip(points).find_map(|(old, new)| {
            let both = old.is_solved() && new.outcome == Outcome::Solved;
            let unknowns = old.unknowns.iter().zip(&new.unknowns).zip(&surface.unknowns);
            let far =
                unknowns.filter(|((old, new), unknown)| (*old - *new).abs() > FAR * (unknown.high - unknown.low).abs());
            far.map(|((old, new), unknown)| (unknown, *old, *new)).next().filter(|_| both)
        });
        let (unknown, old, new) = jumped?;
        let [old, new] = [old, new].map(|value| units::text(unknown.dimension, value, 3));
        Some(format!("{name}: {} is {new} instead of {old}: another branch?", unknown.name))
    }

    /// The map of what moved, in SVG.
    fn picture(&self, project: &Project) -> Option<String> {
        let (_, points) = self.now.as_ref()?;
        let by = self.displacements();
        let is_moved = by.iter().flatten().any(|by| by.abs() > DIGITS);
        let [rows, columns] = self.old.counts;
        if !is_moved || rows < 2 || columns < 2 {
            return None;
        }
        let surface = self.tested.surface(self.index);
        let sample = surface.sample.as_ref()?;
        let axis = |k: usize| Axis { label: sample.labels[k].clone(), count: self.old.counts[k] };
        let patch = patch(self.tested.job, &surface.name, surface, [axis(0), axis(1)], points);
        let field = Field {
            name: "moved".to_string(),
            unit: "um".to_string(),
            meaning: "along the normal, plus is material".to_string(),
            values: Values::Scalars(by.into_iter().map(|by| by.map(|by| 1e3 * by)).collect()),
        };
        let header = Header {
            program: concat!("flank ", env!("CARGO_PKG_VERSION")).to_string(),
            spec: shown_path(project.file()),
            spec_hash: String::new(),
            job: self.tested.job.name.clone(),
            conventions: Vec::new(),
        };
        let dataset = Dataset { header, patches: vec![Patch { fields: vec![field], ..patch }] };
        let title = format!("{}.{} beside its snapshot", self.old.job, self.old.name);
        Some(
            field_maps(&dataset, &title, &[(0, 0)], "along the normal, plus is material", &PictureOptions::default())
                .svg(),
        )
    }
}

/// An unknown that is farther away than this share of its range is another solution.
const FAR: f64 = 0.2;
