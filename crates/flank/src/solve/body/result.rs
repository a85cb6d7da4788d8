//! What `flank solve` says of bodies.

use std::fmt;

use flank_solver::{Body, BodyPart, ClosedMesh, MassProperties};
use schemars::JsonSchema;
use serde::Serialize;

use crate::project::answer::Answer;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::units;
use crate::solve::body::mounted::Mounting;

/// Bodies of a job, of `flank solve` with option `solid`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.solid/2")]
pub struct SolidResult {
    /// The job of the spec.
    pub job: String,
    /// As it was given, with forward slashes.
    pub spec: String,
    /// In the order of the spec; those that could not be built are not among them.
    pub solids: Vec<SolidNumbers>,
    /// Where the members of a pair stand as they mesh, in the file that has both; null unless the job has a contact of two whole gears.
    pub mounting: Option<Mounting>,
    /// Files written, in their order.
    pub files: Vec<String>,
    /// What was asked for and not done, as stderr has it; the exit code is 3 unless it is empty.
    pub not_done: Vec<NotDone>,
}

/// A body by its exact surfaces, and its mesh.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SolidNumbers {
    /// Its name.
    pub name: String,
    /// Of all positions.
    pub frame: String,
    /// How many.
    pub teeth: u32,
    /// The surfaces of one space, in the order of the spec.
    pub surfaces: Vec<String>,
    /// Those of them whose normals point into the body, as those of a tool do that is shown by `move`. Where such a surface is measured, right
    /// and left flank, and material and its lack, are in each other's place.
    pub into_steel: Vec<String>,
    /// How deep its surfaces lie at the most in steel that their tools take away in other positions, mm: a body that they do not leave. Null
    /// where they take none away.
    pub cut_away_mm: Option<f64>,
    /// Surfaces of the job that the body leaves out, in whose tools its own surfaces lie.
    pub left_out: Vec<LeftOut>,
    /// How far the polynomials through exact points, by which everything below is measured, are off between these at the most, mm.
    pub error_mm: f64,
    /// Of the whole gear, as for all that follows.
    pub volume_mm3: f64,
    /// Of the whole surface.
    pub area_mm2: f64,
    /// As asked for.
    pub density_kg_m3: f64,
    /// Volume times density.
    pub mass_kg: f64,
    /// Of mass.
    pub centre_mm: [f64; 3],
    /// Inertia tensor about the centre of mass, kg mm².
    pub inertia_kg_mm2: [[f64; 3]; 3],
    /// The closed surface of the part that was asked for.
    pub mesh: MeshNumbers,
    /// How far the faces of the STEP file are off the exact surfaces between their points at the most, or would be; null where none is
    /// asked for.
    pub step_deviation_mm: Option<f64>,
    /// What gauges and calipers find half-way along the teeth.
    pub gauges: GaugeNumbers,
}

/// A surface that a body leaves out, as the tip of a tool may be whose roundings cross before it.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LeftOut {
    /// The surface.
    pub surface: String,
    /// How deep surfaces of the body lie at the most in its tool, mm.
    pub depth_mm: f64,
}

/// A closed mesh.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MeshNumbers {
    /// Corners.
    pub vertices: usize,
    /// Triangles.
    pub triangles: usize,
    /// How far the middles of its edges lie off the exact surfaces at the most, mm; measured.
    pub deviation_mm: f64,
    /// What it encloses.
    pub volume_mm3: f64,
    /// Of its surface.
    pub area_mm2: f64,
}

/// What gauges and calipers find on a body, half-way along its teeth.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct GaugeNumbers {
    /// Of the tip; where teeth differ, the largest. Null of a bar.
    pub tip_diameter_mm: Option<f64>,
    /// Of the deepest point of a space, of all. Null of a bar.
    pub root_diameter_mm: Option<f64>,
    /// Where the flanks end towards the root, the first one of the space and the last. Null of a bar, and where teeth differ.
    pub form_diameters_mm: Option<[f64; 2]>,
    /// How far the edges in which pointed teeth end lie below the tip of the blank; null where teeth have lands.
    pub edge_below_tip_mm: Option<f64>,
    /// Of a gear with teeth on its face, where the depth is measured along the axis; else null.
    pub face: Option<FaceNumbers>,
    /// Of a bar with teeth, where the depth is measured along x; else null.
    pub bar: Option<BarNumbers>,
    /// Of the tooth, from the form diameter to the tip.
    pub thickness: Vec<ThicknessNumbers>,
    /// Over some teeth of a cylindrical gear, all that planes can touch.
    pub spans: Vec<SpanNumbers>,
    /// Over balls, or between them in an internal gear; null where no ball of the size touches both flanks, or none fits in if no size is asked for,
    /// and unless the tip is a cylinder.
    pub balls: Option<BallNumbers>,
    /// Whether no ball fits in of a cylindrical gear for which no size is asked for: one that touches both flanks within their ends and nothing
    /// else, and stands out beyond the tip.
    pub no_ball_fits: bool,
}

/// Places along the axis of a gear with teeth on its face.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FaceNumbers {
    /// Of the tip.
    pub tip_z_mm: f64,
    /// Of the deepest point of a space.
    pub root_z_mm: f64,
    /// Where the flanks end towards the root, the first one of the space and the last.
    pub form_z_mm: [f64; 2],
}

/// Places along the x axis of a bar with teeth.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct BarNumbers {
    /// From one space to the next.
    pub pitch_mm: f64,
    /// Of the tip.
    pub tip_x_mm: f64,
    /// Of the deepest point of a space.
    pub root_x_mm: f64,
    /// Where the flanks end towards the root, the first one of the space and the last.
    pub form_x_mm: [f64; 2],
}

/// The thickness of a tooth on a circle, or of a bar at an x.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ThicknessNumbers {
    /// Of the circle; null of a bar.
    pub diameter_mm: Option<f64>,
    /// Of a bar where it is measured; else null.
    pub x_mm: Option<f64>,
    /// Its place along the axis.
    pub z_mm: f64,
    /// Along the circle.
    pub arc_mm: f64,
    /// As a tooth caliper measures it: the shortest way between the flank lines on both sides that lie on this circle half-way along the teeth.
    /// It is square to them, so of helical gears and worms it is the normal chord. Null where flanks end before.
    pub chord_mm: Option<f64>,
    /// From the tip down to the middle of the chord, which may lie above the tip of an internal gear.
    pub chord_height_mm: Option<f64>,
}

/// The width over teeth.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SpanNumbers {
    /// How many.
    pub teeth: u32,
    /// Between parallel planes that touch the outer flanks.
    pub width_mm: f64,
    /// On which circles they touch.
    pub diameters_mm: [f64; 2],
}

/// The dimension over balls in opposite spaces.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct BallNumbers {
    /// Of the ball.
    pub ball_mm: f64,
    /// Over both balls, or between them.
    pub over_balls_mm: f64,
    /// On which circles it touches the flanks.
    pub diameters_mm: [f64; 2],
}

impl SolidNumbers {
    pub(crate) fn new(
        (name, frame, surfaces): (&str, &str, Vec<String>),
        (body, error): (&Body, f64),
        density: f64,
        (mesh, deviation): (&ClosedMesh, f64),
    ) -> SolidNumbers {
        let MassProperties { volume, area, centre, inertia } = body.mass_properties();
        // kg/m³ to kg/mm³
        let density_mm = 1e-9 * density;
        SolidNumbers {
            name: name.to_string(),
            frame: frame.to_string(),
            teeth: body.teeth(),
            surfaces,
            into_steel: Vec::new(),
            cut_away_mm: None,
            left_out: Vec::new(),
            error_mm: error,
            volume_mm3: volume,
            area_mm2: area,
            density_kg_m3: density,
            mass_kg: density_mm * volume,
            centre_mm: centre,
            inertia_kg_mm2: inertia.map(|row| row.map(|part| density_mm * part)),
            mesh: MeshNumbers {
                vertices: mesh.vertices.len(),
                triangles: mesh.triangles.len(),
                deviation_mm: deviation,
                volume_mm3: mesh.volume(),
                area_mm2: mesh.area(),
            },
            step_deviation_mm: None,
            gauges: GaugeNumbers::default(),
        }
    }
}

/// How many times as far as the middles of its edges the triangles of a mesh lie off the body at the most.
const BEYOND_EDGES: f64 = 2.0;
/// What is left of a volume by the rounding of its sums, as a share.
const ROUNDING: f64 = 1e-9;

impl SolidNumbers {
    /// The volume of a part by its exact surfaces and by its mesh, where there is more between them than lies between these surfaces and the
    /// mesh: then they bound no body. Nothing of a part whose share of the volume is not known, as where teeth differ.
    pub(crate) fn volumes_apart(&self, (body, part): (&Body, BodyPart)) -> Option<[f64; 2]> {
        let share = match part {
            BodyPart::Gear => 1.0,
            BodyPart::Tooth | BodyPart::Space if body.distinct() == 1 => 1.0 / f64::from(body.teeth()),
            BodyPart::Tooth | BodyPart::Space => return None,
        };
        let exact = share * self.volume_mm3;
        let skin = BEYOND_EDGES * (self.mesh.deviation_mm + self.error_mm) * self.mesh.area_mm2;
        // not so of what is no number, either
        let is_near = (self.mesh.volume_mm3 - exact).abs() <= skin + ROUNDING * exact.abs();
        (!is_near).then_some([exact, self.mesh.volume_mm3])
    }
}

impl SolidResult {
    /// Whether the members of the pair reach into each other.
    fn is_in_each_other(&self) -> bool {
        self.not_done.iter().any(|told| told.kind == NotDoneKind::Penetration)
    }
}

impl Answer for SolidResult {
    fn not_done(&self) -> &[NotDone] {
        &self.not_done
    }
}

impl fmt::Display for SolidResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "job {} ({})", self.job, self.spec)?;
        self.solids.iter().try_for_each(|solid| write!(f, "\n{solid}"))?;
        if let Some(Mounting { contact, members, .. }) = &self.mounting {
            let names: Vec<&str> = members.iter().map(|member| member.solid.as_str()).collect();
            let (how, beside) =
                if self.is_in_each_other() { ("", " and reach into each other") } else { ("as they mesh ", "") };
            writeln!(f, "\n{} stand {how}in the middle of contact {contact}{beside}", names.join(" and "))?;
        }
        if self.files.is_empty() { Ok(()) } else { writeln!(f, "\nwrote {}", self.files.join(", ")) }
    }
}

impl fmt::Display for SolidNumbers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let SolidNumbers { name, frame, teeth, mesh, .. } = self;
        writeln!(f, "solid {name} ({frame}): {teeth} spaces of {}", self.surfaces.join(", "))?;
        writeln!(f, "  volume   {:.4} mm³", self.volume_mm3)?;
        writeln!(f, "  area     {:.4} mm²", self.area_mm2)?;
        writeln!(f, "  mass     {:.6} kg at {} kg/m³", self.mass_kg, self.density_kg_m3)?;
        let [x, y, z] = self.centre_mm.map(rounded);
        writeln!(f, "  centre   {x:.6}, {y:.6}, {z:.6} mm")?;
        let [[xx, ..], [_, yy, _], [.., zz]] = self.inertia_kg_mm2;
        writeln!(f, "  inertia  {xx:.4}, {yy:.4}, {zz:.4} kg mm² about x, y, z through the centre")?;
        writeln!(
            f,
            "  mesh     {} triangles off by at most {}, {:.4} mm³",
            mesh.triangles,
            units::off(mesh.deviation_mm),
            mesh.volume_mm3
        )?;
        if !self.into_steel.is_empty() {
            writeln!(
                f,
                "  normals  of {} point into the steel, as those of a tool do: `envelope(…)`, over no motion where the tool has the form, points out of it",
                self.into_steel.join(", ")
            )?;
        }
        if let Some(depth) = self.cut_away_mm {
            writeln!(f, "  cut away in other positions of the tool, by up to {depth:.6} mm: no tool leaves this body")?;
        }
        for LeftOut { surface, depth_mm } in &self.left_out {
            writeln!(
                f,
                "  left out {surface}, in whose tool other surfaces lie by up to {depth_mm:.6} mm: right if that has no such piece"
            )?;
        }
        let told = |step: f64| format!("  faces    off by at most {} in the STEP file\n", units::off(step));
        f.write_str(&self.step_deviation_mm.map(told).unwrap_or_default())?;
        write!(f, "{}", self.gauges)
    }
}

impl fmt::Display for GaugeNumbers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(FaceNumbers { tip_z_mm, root_z_mm, form_z_mm: [first, last] }) = &self.face {
            let diameter = self.tip_diameter_mm.unwrap_or_default();
            writeln!(f, "  tip      z {tip_z_mm:.4} mm, root z {root_z_mm:.4} mm at {diameter:.4} mm in diameter")?;
            writeln!(f, "  form     z {first:.4} mm and z {last:.4} mm")?;
        } else if let Some(BarNumbers { pitch_mm, tip_x_mm, root_x_mm, form_x_mm: [first, last] }) = &self.bar {
            writeln!(f, "  tip      x {tip_x_mm:.4} mm, root x {root_x_mm:.4} mm, pitch {pitch_mm:.4} mm")?;
            writeln!(f, "  form     x {first:.4} mm and x {last:.4} mm")?;
        } else {
            if let Some((tip, root)) = self.tip_diameter_mm.zip(self.root_diameter_mm) {
                writeln!(f, "  tip      {tip:.4} mm in diameter, root {root:.4} mm")?;
            }
            if let Some([first, last]) = self.form_diameters_mm {
                writeln!(f, "  form     {first:.4} mm and {last:.4} mm in diameter")?;
            }
        }
        if let Some(below) = self.edge_below_tip_mm {
            writeln!(f, "  edge     teeth are pointed: they end {} of the blank", beside_tip(below))?;
        }
        for of in &self.thickness {
            let ThicknessNumbers { diameter_mm, x_mm, arc_mm, chord_mm, chord_height_mm, .. } = of;
            let place = match diameter_mm {
                Some(diameter) => format!("{diameter:.3} mm"),
                None => format!("x {:.3} mm", x_mm.map(rounded).unwrap_or_default()),
            };
            let height = chord_height_mm.map(beside_tip).unwrap_or_default();
            let chord = chord_mm.map(|chord| format!(", chord {chord:.4} mm {height}")).unwrap_or_default();
            writeln!(f, "  tooth    {arc_mm:.4} mm thick at {place}{chord}")?;
        }
        for SpanNumbers { teeth, width_mm, diameters_mm: [a, b] } in &self.spans {
            writeln!(f, "  span     {width_mm:.4} mm over {teeth} teeth, touching at {a:.3} mm and {b:.3} mm")?;
        }
        if let Some(BallNumbers { ball_mm, over_balls_mm, diameters_mm: [a, b] }) = &self.balls {
            writeln!(
                f,
                "  balls    {over_balls_mm:.4} mm by balls of {ball_mm} mm, touching at {a:.3} mm and {b:.3} mm"
            )?;
        }
        if self.no_ball_fits {
            let why = "touches both flanks within their ends and nothing else, and stands out beyond the tip";
            writeln!(f, "  balls    none {why}")?;
        }
        Ok(())
    }
}

/// Where a height below the tip is, by four digits.
fn beside_tip(below: f64) -> String {
    match below {
        _ if below.abs() < 5e-5 => "at the tip".to_string(),
        _ if below < 0.0 => format!("{:.4} mm above the tip", -below),
        _ => format!("{below:.4} mm below the tip"),
    }
}

/// Without what rounding leaves of zero.
fn rounded(mm: f64) -> f64 {
    if mm.abs() < 5e-7 { 0.0 } else { mm }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use flank_expr::Graph;

    use super::*;
    use crate::project::Project;
    use crate::project::monitor::Unwatched;
    use crate::project::requests::JobSelection;
    use crate::project::session::{EvaluatorOptions, Session};
    use crate::project::spec;
    use crate::solve::body::space;

    /// A mesh that is 10 um off leaves out less than a skin as thick; what encloses a few hundredths less bounds another body.
    #[test]
    fn volumes_that_contradict_each_other_are_noticed() {
        let path = format!("{}/../../specs/pairs/spur_pair.chain", env!("CARGO_MANIFEST_DIR"));
        let which = JobSelection::all(Project::open(path, Arc::new(flank_chain_dsl::Disk)));
        let graph = Graph::new();
        let (_, jobs) = spec::jobs(&graph, &which, &Unwatched).expect("it is shipped");
        let session = Session::new(EvaluatorOptions::default(), &Unwatched);
        let solid = &jobs[0].solids[0];
        let space::Space { body, names, off, .. } = space::body(&jobs[0], solid, session).expect("it has a body");
        for part in [BodyPart::Gear, BodyPart::Tooth, BodyPart::Space] {
            let (mesh, deviation) = body.mesh(part, 0.01, 1 << 24).expect("there is room");
            let numbers = SolidNumbers::new(("", "", names.clone()), (&body, off), 7850.0, (&mesh, deviation));
            assert_eq!(numbers.volumes_apart((&body, part)), None, "{part:?}");
            for other in [0.98, 1.02, 3.0, f64::NAN] {
                let wrong = SolidNumbers { volume_mm3: other * numbers.volume_mm3, ..numbers.clone() };
                assert!(wrong.volumes_apart((&body, part)).is_some(), "{part:?} {other}");
            }
        }
    }
}
