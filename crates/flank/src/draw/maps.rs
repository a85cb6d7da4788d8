//! Numbers over flanks: maps, lines, reliefs.

use flank_chain_dsl::Dimension;
use flank_draw::{PictureOptions, comparable_maps, field_lines, field_maps, topography as relief};
use flank_export::{Dataset, Field, Patch, Values};
use flank_solver::Outcome;

use super::subject::Subject;
use super::traces as words;
use super::{Drawing, Unfit, counted};
use crate::compare::traces;
use crate::project::units;
use crate::solve::cut;
use crate::solve::sensitivity as influence;

/// Maps on one picture.
const MOST: usize = 9;

/// A picture of fields of the chosen surfaces.
struct Shown {
    dataset: Dataset,
    fields: Vec<(usize, usize)>,
}

impl Shown {
    /// The chosen surfaces with new fields.
    fn of_surfaces(subject: &Subject<'_, '_>, fields: impl Fn(usize) -> Vec<Field>) -> Shown {
        let patch = |&at: &usize| Patch { fields: fields(at), ..subject.dataset.patches[at].clone() };
        let patches: Vec<Patch> = subject.chosen.iter().map(patch).collect();
        let all = patches.iter().enumerate().flat_map(|(at, patch)| (0..patch.fields.len()).map(move |k| (at, k)));
        let fields = all.collect();
        Shown { dataset: Dataset { header: subject.dataset.header.clone(), patches }, fields }
    }

    /// Fields that the surfaces have already, by their places in each.
    fn existing(subject: &Subject<'_, '_>, places: impl Fn(&[Field]) -> Vec<usize>) -> Shown {
        Shown::of_surfaces(subject, |at| {
            let fields = &subject.dataset.patches[at].fields;
            places(fields).into_iter().filter_map(|place| fields.get(place).cloned()).collect()
        })
    }

    /// What is not shown for want of room, as a sentence.
    fn note(&self, note: &str) -> String {
        match self.fields.len().saturating_sub(MOST) {
            0 => note.to_string(),
            more => format!("{note} {} not shown: choose by surface.", counted(more, "more map")),
        }
    }

    fn first(&self) -> &[(usize, usize)] {
        &self.fields[..self.fields.len().min(MOST)]
    }

    /// Whether some point has a value.
    fn has_values(&self) -> bool {
        let values = |(patch, field): &(usize, usize)| match &self.dataset.patches[*patch].fields[*field].values {
            Values::Scalars(values) => values.iter().any(|value| value.is_some()),
            Values::Vectors(_) => false,
        };
        self.fields.iter().any(values)
    }
}

fn title(subject: &Subject<'_, '_>, of: &str) -> String {
    let names: Vec<&str> = subject.chosen.iter().map(|at| subject.solved[*at].surface.name.as_str()).collect();
    format!("{}: {of} of {}", subject.job.name, names.join(", "))
}

/// The four curvatures.
pub(super) fn curvature(subject: &Subject<'_, '_>, options: &PictureOptions) -> Result<Drawing, Unfit> {
    let of = |at: usize| {
        let fields = &subject.dataset.patches[at].fields;
        let values = |name: &str| {
            fields.iter().find(|field| field.name == name).and_then(|field| match &field.values {
                Values::Scalars(values) => Some((field.clone(), values)),
                Values::Vectors(_) => None,
            })
        };
        let Some(((k1, larger), (k2, smaller))) = values("k1").zip(values("k2")) else { return Vec::new() };
        let both = |of: fn(f64, f64) -> f64| {
            let pairs = larger.iter().zip(smaller.iter());
            Values::Scalars(pairs.map(|(a, b)| Some(of(a?, b?))).collect())
        };
        let field = |name: &str, unit: &str, meaning: &str, values: Values| Field {
            name: name.to_string(),
            unit: unit.to_string(),
            meaning: meaning.to_string(),
            values,
        };
        vec![
            k1,
            k2,
            field("Gaussian curvature", "1/mm^2", "k1 k2", both(|a, b| a * b)),
            field("mean curvature", "1/mm", "(k1 + k2) / 2", both(|a, b| 0.5 * (a + b))),
        ]
    };
    let shown = Shown::of_surfaces(subject, of);
    if !shown.has_values() {
        return Err("no point is solved, or none has curvatures".to_string());
    }
    let note = "k1 is the larger principal curvature, k2 the smaller one; positive where the body is convex.";
    let picture = field_maps(&shown.dataset, &title(subject, "curvature"), shown.first(), &shown.note(note), options);
    Ok(Drawing { picture, shows: "principal, Gaussian and mean curvature".to_string() })
}

/// Influences of parameters: those that are named, else those that do most.
pub(super) fn sensitivity(
    subject: &Subject<'_, '_>,
    of: &[String],
    options: &PictureOptions,
) -> Result<Drawing, Unfit> {
    let known = subject.first().sensitivity.as_ref().ok_or("it is asked for with option `what sensitivity`")?;
    let parameters: Vec<&str> = known.parameters().collect();
    let place = |name: &String| {
        let found = parameters.iter().position(|parameter| parameter == name);
        found.ok_or(format!(
            "there is no parameter or setting `{name}` with a derivative; there is: {}",
            parameters.join(", ")
        ))
    };
    let places = if of.is_empty() {
        known.most_moving(influence::MAPS)
    } else {
        of.iter().map(place).collect::<Result<Vec<usize>, String>>()?
    };
    if places.is_empty() {
        return Err("no parameter and no setting moves the surface".to_string());
    }
    let fields = |at: usize| subject.solved[at].sensitivity.as_ref().map_or(Vec::new(), |of| of.plain_fields(&places));
    let shown = Shown::of_surfaces(subject, fields);
    let title = title(subject, "what moves points");
    let picture = comparable_maps(&shown.dataset, &title, shown.first(), &shown.note(influence::NOTE), options);
    let names: Vec<&str> = places.iter().map(|place| parameters[*place]).collect();
    Ok(Drawing { picture, shows: format!("normal displacement for changes of {}", names.join(", ")) })
}

fn left_fields(subject: &Subject<'_, '_>) -> Result<Shown, Unfit> {
    let place = |fields: &[Field]| fields.iter().position(|field| field.name == "left").into_iter().collect();
    let mut shown = Shown::existing(subject, place);
    let all = shown.dataset.patches.iter_mut().flat_map(|patch| &mut patch.fields);
    all.for_each(|field| field.name = "left by single edges".to_string());
    if shown.fields.is_empty() {
        return Err("the job does not say with `cut … by …` which edges cut the surface".to_string());
    }
    Ok(shown)
}

/// What single edges leave.
pub(super) fn left(subject: &Subject<'_, '_>, options: &PictureOptions) -> Result<Drawing, Unfit> {
    let shown = left_fields(subject)?;
    let title = title(subject, "heights left by single edges");
    let picture = field_maps(&shown.dataset, &title, shown.first(), &shown.note(cut::NOTE), options);
    Ok(Drawing { picture, shows: "heights that single edges leave".to_string() })
}

/// What the solver leaves of its equations.
pub(super) fn residual(subject: &Subject<'_, '_>, options: &PictureOptions) -> Result<Drawing, Unfit> {
    let field = |at: usize| {
        let points = &subject.solved[at].points;
        vec![Field {
            name: "residual".to_string(),
            unit: "mm or mm/rad".to_string(),
            meaning: "largest residual of the equations".to_string(),
            values: Values::Scalars(
                points.iter().map(|point| Some(point.residual).filter(|x| x.is_finite())).collect(),
            ),
        }]
    };
    let shown = Shown::of_surfaces(subject, field);
    let note = "Largest residual of the solved equations: meshing, in mm per mm or radian of its motion, and the two \
        coordinates that the point was asked for by, in mm.";
    let picture = field_maps(&shown.dataset, &title(subject, "residual"), shown.first(), &shown.note(note), options);
    Ok(Drawing { picture, shows: "what the solved equations leave".to_string() })
}

/// Lines of equal values of each motion.
pub(super) fn contact_lines(subject: &Subject<'_, '_>, options: &PictureOptions) -> Result<Drawing, Unfit> {
    let motions = subject.motions();
    if motions.is_empty() {
        let first = subject.first().surface;
        return Err(format!("`{}` stands still while it makes `{}`", first.generation.tool_name, first.name));
    }
    let fields = |at: usize| {
        let solved = &subject.solved[at];
        let own = solved.surface.unknowns.iter().enumerate();
        let moving = own.filter(|(_, unknown)| solved.surface.generation.motions.contains(&unknown.variable));
        let values = |(k, unknown): (usize, &flank_chain_dsl::RangedVariable<'_>)| {
            let is_root = |point: &&flank_solver::SurfacePoint| point.outcome == Outcome::Solved;
            let values = solved.points.iter().map(|point| {
                Some(point).filter(is_root).map(|point| units::shown(unknown.dimension, point.unknowns[k]))
            });
            Field {
                name: unknown.name.clone(),
                unit: if unknown.dimension == Dimension::NUMBER { "1" } else { units::symbol(unknown.dimension) }
                    .to_string(),
                meaning: "the motion at which the point is made".to_string(),
                values: Values::Scalars(values.collect()),
            }
        };
        moving.map(values).collect()
    };
    let shown = Shown::of_surfaces(subject, fields);
    let note = if motions.len() == 1 {
        "Contact lines: on each, tool and work touch at the same moment."
    } else {
        "Lines on which a motion has the same value; tool and work touch at the point in which the values of all motions meet."
    };
    let picture =
        field_lines(&shown.dataset, &title(subject, "contact lines"), shown.first(), &shown.note(note), options);
    let names: Vec<&str> = motions.iter().map(|motion| motion.name.as_str()).collect();
    Ok(Drawing { picture, shows: format!("lines of equal {}", names.join(" and of equal ")) })
}

/// Heights: of what single edges leave, if the job has them, else over the involute of a cylindrical flank.
pub(super) fn topography(subject: &Subject<'_, '_>, options: &PictureOptions) -> Result<Drawing, Unfit> {
    if subject.first().sample.counts.contains(&1) {
        return Err(format!("`{}` is sampled on a line; a topography takes a grid", subject.first().surface.name));
    }
    let (shown, note, shows) = match left_fields(subject) {
        Ok(shown) => (shown, cut::NOTE.to_string(), "heights that single edges leave, above the measuring grid"),
        Err(_) => {
            let (_, reference) = traces::topography(subject.job, subject.first())
                .ok_or("its flank is no involute: say with option `reference` which surface it is held against")?;
            let shown = Shown::of_surfaces(subject, |at| over_involute(subject, at).into_iter().collect());
            let note = format!(
                "Along the normal from {}, zero in the middle, plus is material. The grid below is the flank turned into the axial plane.",
                words::involute(&reference)
            );
            (shown, note, "deviation from the involute")
        }
    };
    let picture = relief(&shown.dataset, &title(subject, "topography"), shown.first(), &shown.note(&note), options);
    Ok(Drawing { picture, shows: shows.to_string() })
}

/// How far the points of a surface lie off an involute helicoid.
fn over_involute(subject: &Subject<'_, '_>, at: usize) -> Option<Field> {
    let (values, _) = traces::topography(subject.job, &subject.solved[at])?;
    Some(Field {
        name: "deviation from the involute".to_string(),
        unit: "um".to_string(),
        meaning: "along the normal, plus is material".to_string(),
        values: Values::Scalars(values.into_iter().collect()),
    })
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The vector at length one; `None` where it has no direction.
pub(super) fn unit(a: [f64; 3]) -> Option<[f64; 3]> {
    let length = dot(a, a).sqrt();
    (length > 0.0 && length.is_finite()).then(|| a.map(|x| x / length))
}
