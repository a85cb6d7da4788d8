//! `flank solve` with option `solid`: closed bodies.

pub(crate) mod borders;
pub(crate) mod bricks;
pub(crate) mod bricks_result;
pub(crate) mod course;
pub(crate) mod ends;
pub(crate) mod gauges;
pub(crate) mod mounted;
pub(crate) mod piece;
pub(crate) mod refusal;
pub(crate) mod result;
pub(crate) mod shape;
pub(crate) mod smooth;
pub(crate) mod space;
pub(crate) mod uncut;

use flank_chain_dsl::{Job, Solid};
use flank_export::{BodyMesh, GearBody, Header, PlacedBody, PlacedFrame};
use flank_expr::Graph;
use flank_solver::{Body, BodyPart, ClosedMesh};

use crate::project::choices::{Choice, MeshFormat, SolidPart};
use crate::project::failure::Failure;
use crate::project::files::Folder;
use crate::project::monitor::Monitor;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::requests::SolidRequest;
use crate::project::session::Session;
use crate::project::shown_path;
use crate::project::spec;
use crate::project::spec::Origin;
use crate::project::units;
use crate::solve::body::mounted::{MountedSolid, Mounting};
use crate::solve::body::result::{SolidNumbers, SolidResult};
use crate::solve::dataset::header;

/// Bytes that a mesh may take: what machines of today can spare.
const MOST_BYTES: usize = 1 << 30;
/// Bytes of a triangle with its share of the vertices, while they are made and written.
const OF_TRIANGLE: usize = 75;
/// How many times as many triangles it may take where diagonals are not near enough: twice as many in both directions.
const DOUBLED: usize = 4;

/// Builds the bodies of jobs, measures them and writes their closed surfaces. `each` is given the result of each job.
///
/// # Errors
/// What is wrong with the spec, that it has no solid, or that a file cannot be written.
pub fn solid(request: &SolidRequest, monitor: &dyn Monitor, each: &mut dyn FnMut(SolidResult)) -> Result<(), Failure> {
    let graph = Graph::new();
    let (compilation, jobs) = spec::jobs(&graph, &request.jobs, monitor)?;
    let origin = Origin::of_compilation(&compilation);
    let session = Session::new(request.evaluator, monitor).with_points_alone();
    for job in space::with_solids(&jobs)? {
        each(built(job, (request, &origin), session)?);
    }
    Ok(())
}

fn built(
    job: &Job<'_>,
    (request, origin): (&SolidRequest, &Origin),
    session: Session<'_>,
) -> Result<SolidResult, Failure> {
    let header = header(&[job], &request.jobs, origin);
    let mut folder = Folder::at(&request.out, origin, session.monitor());
    let (mut solids, mut not_done, mut made) = (Vec::new(), Vec::new(), Vec::new());
    for solid in &job.solids {
        let _working = session.begin(format!("building {}", solid.name))?;
        match one(job, solid, (request, &header), (&mut folder, session)) {
            Ok((numbers, shapes, told)) => {
                not_done.extend(told);
                let too_far = numbers.step_deviation_mm.zip(request.step).filter(|(off, allowed)| off > allowed);
                not_done.extend(too_far.map(|(off, allowed)| {
                    let message = format!(
                        "the faces of `{}` would be off by {:.2e} um, {:.2e} um is allowed: no STEP file of it is written",
                        solid.name,
                        1e3 * off,
                        1e3 * allowed
                    );
                    NotDone::new(NotDoneKind::FaceInexact, &solid.name, message)
                }));
                let is_coarse = numbers.mesh.deviation_mm > request.deviation;
                not_done.extend(is_coarse.then(|| {
                    let message = format!(
                        "the mesh of `{}` is off by {}, and {} is asked for: it cannot be finer",
                        solid.name,
                        units::off(numbers.mesh.deviation_mm),
                        units::off(request.deviation)
                    );
                    NotDone::new(NotDoneKind::FaceInexact, &solid.name, message)
                }));
                let no_ball = request.ball.filter(|_| numbers.gauges.balls.is_none());
                not_done
                    .extend(no_ball.map(|ball| gauges::no_ball(&solid.name, (&shapes.body, &numbers.surfaces), ball)));
                solids.push(numbers);
                made.push(shapes);
            }
            Err(failure) => {
                let formats = request.format.iter().map(|format| format.name());
                let older = folder.older(&file_of(job, solid), formats.chain(request.step.map(|_| "step")));
                not_done.push(refusal::no_body(solid, failure)?.with_more(older));
            }
        }
    }
    let is_pair = request.part == SolidPart::Gear && made.len() > 1;
    let mounting = if is_pair { mounted::mounting(job, session) } else { Ok(None) };
    let mounting = mounting.unwrap_or_else(|reason| {
        let message = format!("the bodies of {} are not put together: {reason}", job.name);
        not_done.push(NotDone::new(NotDoneKind::NoContact, &job.name, message));
        None
    });
    let mounting = mounting.map(|(mounting, reaches_in)| {
        not_done.extend(reaches_in);
        mounting
    });
    if let Some(mounting) = &mounting {
        together(job, (mounting, &made), (request, &header), &mut folder)?;
    }
    Ok(SolidResult {
        job: job.name.clone(),
        spec: shown_path(request.jobs.file()),
        solids,
        mounting,
        files: folder.finish()?,
        not_done: origin.located(&[job], not_done),
    })
}

fn one(
    job: &Job<'_>,
    solid: &Solid,
    (request, header): (&SolidRequest, &Header),
    (folder, session): (&mut Folder<'_>, Session<'_>),
) -> Result<(SolidNumbers, Shapes, Vec<NotDone>), Failure> {
    let space = space::body(job, solid, session)?;
    let (uncut, mut not_done) = space.uncut(job, solid, session)?;
    let space::Space { body, names, off: error, into_steel, .. } = space;
    let part = match request.part {
        // from the middle of its space to the middle of the same one a gear of one tooth goes all around
        _ if body.teeth() == 1 && body.arrangement().is_closed() => BodyPart::Gear,
        SolidPart::Gear => BodyPart::Gear,
        SolidPart::Tooth => BodyPart::Tooth,
        SolidPart::Space => BodyPart::Space,
    };
    let (mesh, off) = meshed(&solid.name, (&body, part), request.deviation)?;
    let numbers = SolidNumbers::new((&solid.name, &solid.frame, names), (&body, error), request.density, (&mesh, off));
    if let Some(apart) = numbers.volumes_apart((&body, part)) {
        return Err(refusal::contradicted(solid, apart));
    }
    let file = file_of(job, solid);
    let written =
        BodyMesh { name: &solid.name, frame: &solid.frame, vertices: &mesh.vertices, triangles: &mesh.triangles };
    for format in &request.format {
        match format {
            MeshFormat::Stl => folder.body_stl(&file, header, &written)?,
            MeshFormat::Obj => folder.body_obj(&file, header, &written)?,
            MeshFormat::ThreeMf => folder.body_3mf(&file, header, &[(written, PlacedFrame::default())])?,
        }
    }
    let faces = request.step.map(|tolerance| smooth::gear(&solid.name, &numbers.surfaces, (&body, part), tolerance));
    let faces = faces.transpose().unwrap_or_else(|beyond| {
        let older = request.step.map(|_| folder.older(&file, ["step"].into_iter())).unwrap_or_default();
        not_done.push(refusal::no_sides(solid, &beyond).with_more(older));
        None
    });
    if let Some(faces) = faces.as_ref().filter(|faces| request.step.is_some_and(|allowed| faces.deviation <= allowed)) {
        folder.body_step(&file, header, faces)?;
    }
    let numbers = SolidNumbers {
        step_deviation_mm: faces.as_ref().map(|faces| faces.deviation),
        gauges: gauges::measured(&body, request.ball),
        into_steel,
        cut_away_mm: uncut::deepest(&uncut),
        left_out: uncut::left_out(&uncut),
        ..numbers
    };
    let faces = faces.filter(|faces| request.step.is_some_and(|allowed| faces.deviation <= allowed));
    Ok((numbers, Shapes { name: solid.name.clone(), frame: solid.frame.clone(), body, mesh, faces }, not_done))
}

/// The closed surface of a part, and how far it is off.
///
/// # Errors
/// If it would take more memory than there is to spare.
fn meshed(name: &str, (body, part): (&Body, BodyPart), tolerance: f64) -> Result<(ClosedMesh, f64), Failure> {
    let most = MOST_BYTES / OF_TRIANGLE;
    body.mesh(part, tolerance, most).map_err(|triangles| {
        let fits = |deviation: &f64| body.triangles(part, &body.fineness(part, *deviation)) <= most / DOUBLED;
        let possible = (0..).map(|step| rounded_up(tolerance, step)).find(fits).unwrap_or(tolerance);
        Failure::TooLarge(format!(
            "the mesh of `{name}` within {} would have {triangles} triangles or more: that would take about {:.1} GB, and {:.1} GB is the \
             most; {} is possible with option `deviation`",
            units::off(tolerance),
            (triangles * OF_TRIANGLE) as f64 / 1e9,
            MOST_BYTES as f64 / 1e9,
            units::off(possible)
        ))
    })
}

/// Of the numbers 1, 2 and 5 with any power of ten the one that is so many steps above another number.
fn rounded_up(number: f64, step: i32) -> f64 {
    let power = number.log10().floor() as i32 + step / 3;
    [1.0, 2.0, 5.0][(step % 3) as usize] * 10.0_f64.powi(power)
}

/// What the files of a solid are called.
fn file_of(job: &Job<'_>, solid: &Solid) -> String {
    if job.solids.len() == 1 { job.name.clone() } else { format!("{}.{}", job.name, solid.name) }
}

/// A body as it is written.
struct Shapes {
    name: String,
    frame: String,
    body: Body,
    mesh: ClosedMesh,
    faces: Option<GearBody>,
}

/// Files in which the members of a pair stand as they mesh.
fn together(
    job: &Job<'_>,
    (mounting, made): (&Mounting, &[Shapes]),
    (request, header): (&SolidRequest, &Header),
    folder: &mut Folder<'_>,
) -> Result<(), Failure> {
    let of = |member: &MountedSolid| made.iter().find(|shapes| shapes.name == member.solid);
    let places = |member: &MountedSolid| PlacedFrame { origin: member.origin_mm, axes: member.axes };
    let Some(pair) =
        mounting.members.iter().map(|member| Some((of(member)?, places(member)))).collect::<Option<Vec<_>>>()
    else {
        return Ok(());
    };
    let faces: Option<Vec<PlacedBody<'_>>> =
        pair.iter().map(|(shapes, place)| Some(PlacedBody { body: shapes.faces.as_ref()?, place: *place })).collect();
    if let Some(faces) = faces {
        folder.body_assembly(&job.name, header, &faces)?;
    }
    if request.format.contains(&MeshFormat::ThreeMf) {
        let meshes: Vec<(BodyMesh<'_>, PlacedFrame)> =
            pair.iter().map(|(shapes, place)| (shapes.mesh(), *place)).collect();
        folder.body_3mf(&job.name, header, &meshes)?;
    }
    Ok(())
}

impl Shapes {
    fn mesh(&self) -> BodyMesh<'_> {
        let ClosedMesh { vertices, triangles } = &self.mesh;
        BodyMesh { name: &self.name, frame: &self.frame, vertices, triangles }
    }
}
