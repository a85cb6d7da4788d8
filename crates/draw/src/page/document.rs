//! The page's data as it is embedded: for the program in the same page and for nobody else, so without name, version and schema.

use serde::Serialize;

use super::body::{self, BodyOut};
use super::contact::{self, ContactOut};
use super::milling::{self, MillingOut};
use super::scene::{PageMachine, PageMotion, PageParameter, PageSurface, PageTool, Scene};
use crate::base64::encoded;
use crate::picture::{patch_colours, scale_colours, signed_colours};
use flank_export::Tally;
use flank_export::conventions as sentences;
use flank_export::{Axis, Dataset, Field, Patch, Point, Values};

#[derive(Serialize)]
pub(super) struct Document<'a> {
    program: &'a str,
    spec: &'a str,
    spec_hash: &'a str,
    job: &'a str,
    doc: &'a [String],
    conventions: Vec<String>,
    notes: &'a [String],
    asked: usize,
    solved: usize,
    worst_residual: Option<f64>,
    /// Colours of surfaces, of a scale from its lowest to its highest value, and of one from minus by zero to plus.
    colours: Vec<String>,
    scale: Vec<String>,
    signed: Vec<String>,
    motions: &'a [PageMotion],
    parameters: &'a [PageParameter],
    definitions: Option<&'a str>,
    machines: &'a [PageMachine],
    tools: &'a [PageTool],
    surfaces: Vec<SurfaceOut<'a>>,
    lines: Vec<LineOut<'a>>,
    bodies: Vec<BodyOut<'a>>,
    contacts: Vec<ContactOut<'a>>,
    millings: Vec<MillingOut<'a>>,
}

#[derive(Serialize)]
struct SurfaceOut<'a> {
    name: &'a str,
    frame: &'a str,
    #[serde(flatten)]
    scene: &'a PageSurface,
    rows: &'a Axis,
    columns: &'a Axis,
    unknowns: Vec<UnknownOut<'a>>,
    /// Status words; the first is that of solved points.
    words: Vec<&'static str>,
    status: Vec<usize>,
    positions: String,
    normals: String,
    unknown_values: String,
    residuals: String,
    targets: String,
    fields: Vec<FieldOut<'a>>,
}

#[derive(Serialize)]
struct UnknownOut<'a> {
    name: &'a str,
    unit: &'static str,
    low: f64,
    high: f64,
    motion: Option<usize>,
}

#[derive(Serialize)]
struct FieldOut<'a> {
    name: &'a str,
    unit: &'a str,
    components: usize,
    meaning: &'a str,
    values: String,
}

/// A line on a surface, such as that where it is trimmed.
#[derive(Serialize)]
struct LineOut<'a> {
    name: &'a str,
    frame: &'a str,
    positions: String,
}

impl<'a> Document<'a> {
    pub(super) fn of_scene(dataset: &'a Dataset, scene: &'a Scene) -> Self {
        let header = &dataset.header;
        let (surfaces, lines) = dataset.patches.split_at(scene.surfaces.len().min(dataset.patches.len()));
        let tally = Tally::of_patches(surfaces);
        Document {
            program: &header.program,
            spec: &header.spec,
            spec_hash: &header.spec_hash,
            job: &header.job,
            doc: &scene.doc,
            conventions: sentences(&dataset.header),
            notes: &scene.notes,
            asked: tally.asked,
            solved: tally.solved,
            worst_residual: tally.worst_residual,
            colours: patch_colours(),
            scale: scale_colours(),
            signed: signed_colours(),
            motions: &scene.motions,
            parameters: &scene.parameters,
            definitions: scene.definitions.as_deref(),
            machines: &scene.machines,
            tools: &scene.tools,
            surfaces: surfaces.iter().zip(&scene.surfaces).map(|(patch, scene)| surface(patch, scene)).collect(),
            lines: lines.iter().map(line).collect(),
            bodies: scene.bodies.iter().map(body::out).collect(),
            contacts: scene.contacts.iter().map(|contact| contact::out(contact, surfaces)).collect(),
            millings: scene.millings.iter().map(milling::out).collect(),
        }
    }
}

fn surface<'a>(patch: &'a Patch, scene: &'a PageSurface) -> SurfaceOut<'a> {
    let mut words = vec!["solved"];
    let status = patch.points.iter().map(|point| number_of(point.outcome.word(), &mut words)).collect();
    let width = patch.unknowns.len();
    let of_unknown = patch.unknowns.iter().zip(&scene.ranges).zip(&scene.motions);
    SurfaceOut {
        name: &patch.name,
        frame: &patch.frame,
        scene,
        rows: &patch.rows,
        columns: &patch.columns,
        unknowns: of_unknown
            .map(|((unknown, &[low, high]), &motion)| UnknownOut {
                name: &unknown.name,
                unit: unknown.unit.symbol(),
                low,
                high,
                motion,
            })
            .collect(),
        words,
        status,
        positions: encoded(patch.points.iter().flat_map(shown_at)),
        normals: encoded(
            patch.points.iter().flat_map(|point| if point.is_solved() { point.normal } else { [f64::NAN; 3] }),
        ),
        unknown_values: encoded(patch.points.iter().flat_map(|point| {
            let value = |k: usize| point.unknowns.get(k).copied().filter(|_| point.is_solved()).unwrap_or(f64::NAN);
            (0..width).map(value)
        })),
        residuals: encoded(patch.points.iter().map(|point| point.residual)),
        targets: encoded(scene.targets.iter().flatten().copied()),
        fields: patch.fields.iter().map(field).collect(),
    }
}

/// Where a point is drawn; nowhere unless it is solved.
fn shown_at(point: &Point) -> [f64; 3] {
    if point.is_solved() { point.position } else { [f64::NAN; 3] }
}

fn number_of(word: &'static str, words: &mut Vec<&'static str>) -> usize {
    words.iter().position(|known| *known == word).unwrap_or_else(|| {
        words.push(word);
        words.len() - 1
    })
}

fn field(field: &Field) -> FieldOut<'_> {
    let values = match &field.values {
        Values::Scalars(values) => encoded(values.all_numbers()),
        Values::Vectors(values) => encoded(values.all_numbers()),
    };
    let components = field.columns().len();
    FieldOut { name: &field.name, unit: &field.unit, components, meaning: &field.meaning, values }
}

fn line(patch: &Patch) -> LineOut<'_> {
    let positions = encoded(patch.points.iter().flat_map(shown_at));
    LineOut { name: &patch.name, frame: &patch.frame, positions }
}
