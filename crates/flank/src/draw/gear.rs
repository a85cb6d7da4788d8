//! The gear that the surfaces of a job are of.

use flank_chain_dsl::Solid;
use flank_draw::{GearDrawing, GearFace, GearFaceKind, PictureOptions, gear as picture};
use flank_export::fixed;
use flank_solver::{Body, BodySheet, SheetFace};

use super::subject::Subject;
use super::{Drawing, Unfit, counted};
use crate::project::failure::Failure;
use crate::solve::body::shape::Shape;

pub(super) fn draw(subject: &Subject<'_, '_>, options: &PictureOptions) -> Result<Drawing, Unfit> {
    of_solid(subject, solid(subject)?, options)
}

/// One of the gears of a job.
pub(crate) fn of_solid(subject: &Subject<'_, '_>, solid: &Solid, options: &PictureOptions) -> Result<Drawing, Unfit> {
    let shape = Shape::of_solid(subject.job, solid, &subject.solved, subject.session).map_err(told)?;
    let teeth = shape.some();
    let drawing = GearDrawing {
        header: subject.dataset.header.clone(),
        title: match subject.job.solids.len() {
            1 => subject.job.name.clone(),
            _ => format!("{}: {}", subject.job.name, shape.name),
        },
        note: note(&shape),
        facts: facts(&shape),
        surfaces: shape.surfaces.clone(),
        whole: faces(&shape.whole()),
        directions: shape.directions(&teeth),
        teeth: faces(&teeth),
        shown: format!("{} of {} teeth", shape.shown(), shape.teeth),
        is_closed: shape.body.is_ok(),
    };
    let shows =
        format!("{} with {}, and {} of them large", shape.name, counted(shape.teeth as usize, "tooth"), shape.shown());
    Ok(Drawing { picture: picture(&drawing, options), shows })
}

/// The solid that the first of the chosen surfaces belongs to; of a job whose surfaces are not chosen, its first.
fn solid<'j>(subject: &Subject<'j, '_>) -> Result<&'j Solid, Unfit> {
    let solids = &subject.job.solids;
    let first = &subject.first().surface.name;
    let owner = solids.iter().find(|solid| solid.space.iter().any(|at| subject.job.surfaces[*at].name == *first));
    let is_chosen = subject.in_space.len() < subject.solved.len();
    owner.or(solids.first().filter(|_| !is_chosen)).ok_or_else(|| {
        "no `solid` of it says which gear its surfaces are of: `solid NAME in FRAME = turned(…)` does".to_string()
    })
}

fn told(failure: Failure) -> Unfit {
    match failure {
        Failure::Input(reason) | Failure::Request(reason) => reason,
        other => other.to_string(),
    }
}

fn note(shape: &Shape) -> String {
    let Err(reason) = &shape.body else {
        return format!(
            "The body of {} in {}: generated surfaces in colour, the blank in grey.",
            shape.name, shape.frame
        );
    };
    format!("The sampled points of one tooth space of {}, turned to all of them. No closed body: {reason}.", shape.name)
}

fn facts(shape: &Shape) -> Vec<(String, String)> {
    let fact = |name: &str, value: String| (name.to_string(), value);
    let mut facts = vec![fact("teeth", shape.teeth.to_string())];
    let Ok(body) = &shape.body else { return facts };
    if !body.arrangement().is_closed() {
        let [tip, root] = body.tip_and_root();
        let (depth, pitch) = ((tip - root).abs(), body.pitch());
        let lengths =
            [("pitch", pitch), ("depth of the teeth", depth), ("length of the tip", body.blank().bounds()[1].length())];
        facts.extend(lengths.map(|(name, value)| fact(name, format!("{} mm", fixed(value, 3)))));
        return facts;
    }
    facts.extend(diameters(body).into_iter().map(|(name, value)| fact(name, format!("{} mm", fixed(value, 3)))));
    facts
}

/// Half-way along the teeth, mm.
fn diameters(body: &Body) -> Vec<(&'static str, f64)> {
    let [tip, root] = body.tip_and_root();
    if body.distinct() > 1 {
        return vec![
            ("largest tip diameter", 2.0 * tip),
            ("smallest root diameter", 2.0 * root),
            ("length of the tip", body.blank().bounds()[1].length()),
        ];
    }
    let [first, last] = body.form();
    let deepest = if body.is_external() { first.max(last) } else { first.min(last) };
    let middle = 0.5 * (deepest + tip);
    let mut values = vec![("tip diameter", 2.0 * tip), ("form diameter", 2.0 * deepest), ("root diameter", 2.0 * root)];
    if let Some(tooth) = body.thickness(middle) {
        values.push(("mid-flank diameter", 2.0 * middle));
        values.push(("tooth thickness there", tooth.arc));
    }
    values.push(("length of the tip", body.blank().bounds()[1].length()));
    values
}

fn faces(sheets: &[BodySheet]) -> Vec<GearFace> {
    let face = |sheet: &BodySheet| GearFace {
        kind: match sheet.face {
            SheetFace::Surface(number) => GearFaceKind::Surface(number),
            SheetFace::Blank => GearFaceKind::Blank,
            SheetFace::Cut => GearFaceKind::Cut,
        },
        counts: sheet.counts,
        ends: sheet.ends,
        points: sheet.points.iter().map(|point| Some(*point).filter(|point| point[0].is_finite())).collect(),
        normals: sheet.normals.clone(),
    };
    sheets.iter().map(face).collect()
}
