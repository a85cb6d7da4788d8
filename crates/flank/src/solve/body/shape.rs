//! A gear as it looks: the sheets of its body, or, where there is none, the sampled points of one tooth space turned about the axis.

use std::f64::consts::TAU;

use flank_chain_dsl::{Job, Solid};
use flank_solver::{Arrangement, Body, BodyPart, BodySheet, Fineness, Outcome, SheetFace};

use crate::project::failure::Failure;
use crate::project::session::Session;
use crate::solve::blank;
use crate::solve::body::{refusal, space};
use crate::solve::solved::Solved;

/// Teeth that are shown large.
const SOME: u32 = 3;
/// How far facets may lie off the body, as a share of the size of what is shown: less than half a pixel.
const WHOLE: f64 = 1.0 / 600.0;
const LARGE: f64 = 1.0 / 2000.0;
/// Cells along the teeth of a whole gear at the most; more are not seen.
const MOST_ALONG: usize = 12;
/// A tooth that turns through more about the axis is seen to be bent, and has as many cells as its curves need.
const BENT: f64 = TAU / 12.0;
/// Rows and columns of turned samples.
const MOST_LINES: usize = 9;

/// A gear as it looks.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    pub(crate) name: String,
    pub(crate) frame: String,
    pub(crate) teeth: u32,
    /// The surfaces of a space, in the order that [`SheetFace::Surface`] counts them in.
    pub(crate) surfaces: Vec<String>,
    /// The body, or why there is none.
    pub(crate) body: Result<Body, String>,
    arrangement: Arrangement,
    /// The sampled points of one space.
    space: Vec<BodySheet>,
}

impl Shape {
    /// # Errors
    /// If the work is cancelled, or no point of the solid's surfaces is solved.
    pub(crate) fn of_solid<'j, 'g>(
        job: &'j Job<'g>,
        solid: &'j Solid,
        solved: &[Solved<'j, 'g>],
        session: Session<'j>,
    ) -> Result<Shape, Failure> {
        let body = match space::body(job, solid, session) {
            Ok(space) => Ok(space.body),
            Err(failure) => Err(refusal::no_body(solid, failure)?.message),
        };
        let space = sampled(job, solid, solved);
        if body.is_err() && space.is_empty() {
            return Err(format!("no point of the surfaces of `{}` is solved", solid.name).into());
        }
        Ok(Shape {
            name: solid.name.clone(),
            frame: solid.frame.clone(),
            teeth: solid.teeth,
            surfaces: solid.space.iter().map(|at| job.surfaces[*at].name.clone()).collect(),
            body,
            arrangement: blank::arrangement(solid),
            space,
        })
    }

    /// All of it.
    pub(crate) fn whole(&self) -> Vec<BodySheet> {
        match &self.body {
            Ok(body) => body.sheets(body.teeth(), &whole(body)),
            Err(_) => repeated(&self.space, self.teeth, (self.arrangement, self.teeth)),
        }
    }

    /// Some teeth next to each other, for a large picture.
    pub(crate) fn some(&self) -> Vec<BodySheet> {
        match &self.body {
            Ok(body) => body.sheets(SOME, &large(body)),
            Err(_) => repeated(&self.space, self.shown(), (self.arrangement, self.teeth)),
        }
    }

    /// How many these are.
    pub(crate) fn shown(&self) -> u32 {
        SOME.min(self.teeth)
    }

    /// What a closed body consists of when it is turned about its axis so many times: one tooth, from the middle of a space to the middle of
    /// the next, or all of it.
    pub(crate) fn repeated(&self) -> (Vec<BodySheet>, u32) {
        let Ok(body) = &self.body else { return (Vec::new(), self.teeth) };
        if !body.arrangement().is_closed() || body.distinct() > 1 {
            return (self.whole(), 1);
        }
        let sheets = body.sheets(1, &whole(body)).into_iter().filter(|sheet| sheet.face != SheetFace::Cut);
        (sheets.collect(), self.teeth)
    }

    /// In the middle of some sheets: along the teeth, towards the heel or upwards, and from root to tip; unit vectors. The generated surfaces
    /// face the tip, on average.
    pub(crate) fn directions(&self, sheets: &[BodySheet]) -> [[f64; 3]; 2] {
        let generated = sheets.iter().filter(|sheet| matches!(sheet.face, SheetFace::Surface(_)));
        let points = generated.flat_map(|sheet| sheet.points.iter().zip(&sheet.normals));
        let points = points.filter(|(point, _)| point[0].is_finite());
        let (mut sum, mut middle) = ([0.0; 2], [0.0; 2]);
        for ([x, y, _], [u, v, w]) in points {
            let rho = x.hypot(*y).max(f64::MIN_POSITIVE);
            let out = if self.arrangement.is_closed() { (x * u + y * v) / rho } else { *u };
            sum = [sum[0] + w, sum[1] + out];
            middle = [middle[0] + x, middle[1] + y];
        }
        let size = sum[0].hypot(sum[1]);
        let [tip_z, tip_rho] = if size > 0.0 { sum.map(|x| x / size) } else { [0.0, 1.0] };
        let side = if tip_z.abs() > 0.05 { -tip_z.signum() } else { tip_rho.signum() };
        let [along_z, along_rho] = [side * tip_rho, -side * tip_z];
        let far = middle[0].hypot(middle[1]);
        let is_around = far > 0.0 && self.arrangement.is_closed();
        let [cos, sin] = if is_around { middle.map(|x| x / far) } else { [1.0, 0.0] };
        [[along_rho * cos, along_rho * sin, along_z], [tip_rho * cos, tip_rho * sin, tip_z]]
    }
}

fn widest(body: &Body) -> f64 {
    body.blank().outline.segments().iter().map(|segment| segment.from[1].max(segment.to[1])).fold(0.0, f64::max)
}

fn whole(body: &Body) -> Fineness {
    let size = match body.arrangement() {
        Arrangement::Round => 2.0 * widest(body),
        Arrangement::Straight { pitch } => pitch * f64::from(body.teeth()),
    };
    let fineness = body.fineness(BodyPart::Gear, WHOLE * size);
    let coarse = Fineness { tooth: 2, rim: 1, along: fineness.along.min(MOST_ALONG), ..fineness.clone() };
    bent(body, fineness, coarse)
}

/// So many cells as a bent tooth needs, or else as coarse as straight ones are drawn.
fn bent(body: &Body, fine: Fineness, coarse: Fineness) -> Fineness {
    let [across, along] = body.turns(&fine);
    let tooth = if across > BENT { fine.tooth.max(coarse.tooth) } else { coarse.tooth };
    let along = if along > BENT { fine.along.max(coarse.along) } else { coarse.along };
    Fineness { tooth, along, ..coarse }
}

fn large(body: &Body) -> Fineness {
    let [_, tip, _] = body.blank().bounds();
    let width = match body.arrangement() {
        Arrangement::Round => body.pitch().min(TAU / 6.0) * widest(body),
        Arrangement::Straight { pitch } => pitch,
    };
    let size = (f64::from(SOME) * width).max(tip.length());
    let fineness = body.fineness(BodyPart::Tooth, LARGE * size);
    let coarse = Fineness { tooth: 4, rim: 2, ..fineness.clone() };
    bent(body, fineness, coarse)
}

/// The sampled points of the surfaces of a space.
fn sampled(job: &Job<'_>, solid: &Solid, solved: &[Solved<'_, '_>]) -> Vec<BodySheet> {
    let sheet = |(number, at): (usize, &usize)| {
        let solved = solved.iter().find(|solved| solved.surface.name == job.surfaces[*at].name)?;
        let counts = solved.counts();
        let lines = counts.map(|count| {
            let parts = MOST_LINES.min(count).max(2) - 1;
            (0..=parts).map(|part| part * (count - 1) / parts).collect::<Vec<usize>>()
        });
        let [rows, columns] = &lines;
        let points = || rows.iter().flat_map(|i| columns.iter().map(move |j| &solved.points[i * counts[1] + j]));
        let is_known = |outcome: &Outcome| *outcome == Outcome::Solved;
        let [nowhere, none] = [[f64::NAN; 3], [0.0; 3]];
        Some(BodySheet {
            face: SheetFace::Surface(number),
            counts: [rows.len(), columns.len()],
            ends: [true; 4],
            points: points().map(|point| if is_known(&point.outcome) { point.position } else { nowhere }).collect(),
            normals: points().map(|point| if is_known(&point.outcome) { point.normal } else { none }).collect(),
        })
    };
    let sheets = solid.space.iter().enumerate().filter_map(sheet);
    sheets.filter(|sheet| sheet.points.iter().any(|point| point[0].is_finite())).collect()
}

/// The same space so many times, next to each other, of `teeth`.
fn repeated(space: &[BodySheet], count: u32, (arrangement, teeth): (Arrangement, u32)) -> Vec<BodySheet> {
    let copy = |k: u32| {
        let by = arrangement.pitch(teeth) * (f64::from(k) - f64::from(count / 2));
        space.iter().map(move |sheet| BodySheet {
            points: sheet.points.iter().map(|point| arrangement.moved(*point, by)).collect(),
            normals: sheet.normals.iter().map(|normal| arrangement.turned(*normal, by)).collect(),
            ..sheet.clone()
        })
    };
    (0..count).flat_map(copy).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use flank_expr::Graph;

    use super::*;
    use crate::project::Project;
    use crate::project::monitor::Unwatched;
    use crate::project::requests::JobSelection;
    use crate::project::session::EvaluatorOptions;
    use crate::project::spec;

    /// What sheets enclose, mm³, and the least cosine between the normals of their points and those of their cells.
    fn enclosed(sheets: &[BodySheet]) -> (f64, f64) {
        let (mut volume, mut least) = (0.0, f64::INFINITY);
        for sheet in sheets {
            let [rows, columns] = sheet.counts;
            for (i, j) in (1..rows).flat_map(|i| (1..columns).map(move |j| (i, j))) {
                let at = i * columns + j;
                let corners = [at - columns - 1, at - columns, at, at - 1];
                let [a, b, c, d] = corners.map(|k| nalgebra::Vector3::from(sheet.points[k]));
                let area = 0.5 * (c - a).cross(&(d - b));
                volume += 0.25 * (a + b + c + d).dot(&area) / 3.0;
                let normals = corners.map(|k| nalgebra::Vector3::from(sheet.normals[k]));
                if area.norm() > 1e-9 {
                    least = normals.iter().map(|normal| normal.dot(&area.normalize())).fold(least, f64::min);
                }
            }
        }
        (volume, least)
    }

    /// All sheets together are the closed surface, and face out of the body: the gear's, and as much of it as there are teeth. Facets leave
    /// out less than 1 %, and normals at the borders of cells are less than 40 deg off those of the cells.
    #[test]
    fn sheets_enclose_the_body() {
        for file in ["bevel/pinion_19x62", "pairs/spur_pair"] {
            let path = format!("{}/../../specs/{file}.chain", env!("CARGO_MANIFEST_DIR"));
            let which = JobSelection::all(Project::open(path, Arc::new(flank_chain_dsl::Disk)));
            let graph = Graph::new();
            let (_, jobs) = spec::jobs(&graph, &which, &Unwatched).expect("it is shipped");
            let session = Session::new(EvaluatorOptions::default(), &Unwatched);
            let shape = Shape::of_solid(&jobs[0], &jobs[0].solids[0], &[], session).expect("it has a body");
            let volume = shape.body.as_ref().expect("it is closed").mass_properties().volume;
            let (whole, facing) = enclosed(&shape.whole());
            assert!((whole / volume - 1.0).abs() < 0.01 && facing > 0.76, "{file}: {whole} {volume} {facing}");
            let (some, facing) = enclosed(&shape.some());
            let share = f64::from(shape.shown()) / f64::from(shape.teeth);
            assert!((some / volume / share - 1.0).abs() < 0.01 && facing > 0.76, "{file}: {some} {facing}");
        }
    }
}
