//! What `flank mesh` says of bricks.

use std::fmt;

use flank_export::BrickSet;
use flank_solver::{Body, BrickCounts, BrickMesh, BrickOrder, BrickQuality, ShaftCounts};
use schemars::JsonSchema;
use serde::Serialize;

use crate::project::answer::Answer;
use crate::project::remark::NotDone;
use crate::project::units;

/// Bodies of a job as bricks, of `flank mesh`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.mesh/1")]
pub struct MeshResult {
    /// The job of the spec.
    pub job: String,
    /// As it was given, with forward slashes.
    pub spec: String,
    /// In the order of the spec; those that could not be built are not among them.
    pub solids: Vec<BrickNumbers>,
    /// Files written, in their order.
    pub files: Vec<String>,
    /// What was asked for and not done, as stderr has it; the exit code is 3 unless it is empty.
    pub not_done: Vec<NotDone>,
}

/// The bricks of a body.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct BrickNumbers {
    /// Of the solid.
    pub name: String,
    /// Of all positions.
    pub frame: String,
    /// Of the whole gear.
    pub teeth: u32,
    /// Teeth that are cut into bricks, each from the middle of a space to the middle of the next.
    pub meshed_teeth: u32,
    /// `C3D8` or `C3D20R`.
    pub element: &'static str,
    /// How many.
    pub bricks: usize,
    /// Shared ones once.
    pub nodes: usize,
    /// How a tooth is cut.
    pub elements: ElementCounts,
    /// How far faces on the generated surfaces are off these at the most; their nodes lie on them.
    pub deviation_mm: f64,
    /// Of all bricks.
    pub volume_mm3: f64,
    /// Of the same teeth by the exact surfaces; null of some teeth of a gear whose spaces differ.
    pub exact_volume_mm3: Option<f64>,
    /// At the corners and in the middle of bricks: 1 in a box, not above 0 in a folded brick.
    pub least_scaled_jacobian: f64,
    /// At three Gauss points in each direction, of the mean of the brick.
    pub least_jacobian: f64,
    /// Named parts of the surface.
    pub sets: Vec<SetNumbers>,
    #[serde(skip)]
    mesh: BrickMesh,
    #[serde(skip)]
    parts: Vec<BrickSet>,
}

/// Into how many bricks a tooth is cut.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct ElementCounts {
    /// Across each surface of a space.
    pub across: Vec<usize>,
    /// Layers along flanks, fillets and roots.
    pub band: usize,
    /// Between the layers of both flanks.
    pub core: usize,
    /// From the layers of the root to the rest of the outline.
    pub rim: usize,
    /// Along the tooth.
    pub along: usize,
    /// Of a shaft that goes on beyond the teeth, where it has bricks of its own; else null.
    pub shaft: Option<ShaftElements>,
}

/// Into how many bricks a shaft is cut, as far as it belongs to a tooth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct ShaftElements {
    /// From below the teeth to the bore.
    pub rows: usize,
    /// Along what goes on before the beginning of the teeth and behind their end.
    pub ends: [usize; 2],
}

/// A named part of the surface.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct SetNumbers {
    /// As the files have it.
    pub name: String,
    /// Faces of bricks.
    pub faces: usize,
    /// Nodes of these.
    pub nodes: usize,
}

/// Of some teeth of a body, mm³; nothing of some of a gear whose spaces differ.
pub(super) fn exact_volume(body: &Body, teeth: u32) -> Option<f64> {
    let is_share = body.distinct() == 1 || teeth == body.teeth();
    is_share.then(|| body.mass_properties().volume * f64::from(teeth) / f64::from(body.teeth()))
}

impl BrickNumbers {
    pub(crate) fn new(
        (name, frame): (&str, &str),
        body: &Body,
        counts: &BrickCounts,
        (mesh, quality): (BrickMesh, BrickQuality),
        parts: Vec<BrickSet>,
    ) -> BrickNumbers {
        let set =
            |set: &BrickSet| SetNumbers { name: set.name.clone(), faces: set.faces.len(), nodes: set.nodes.len() };
        BrickNumbers {
            name: name.to_string(),
            frame: frame.to_string(),
            teeth: body.teeth(),
            meshed_teeth: mesh.teeth as u32,
            element: if mesh.order == BrickOrder::First { "C3D8" } else { "C3D20R" },
            bricks: mesh.len(),
            nodes: mesh.nodes.len(),
            elements: ElementCounts {
                across: counts.charts.clone(),
                band: counts.band,
                core: counts.core,
                rim: counts.rim,
                along: counts.along,
                shaft: counts.shaft.map(|ShaftCounts { rows, ends }| ShaftElements { rows, ends }),
            },
            deviation_mm: mesh.deviation,
            volume_mm3: quality.volume,
            exact_volume_mm3: exact_volume(body, mesh.teeth as u32),
            least_scaled_jacobian: quality.least_scaled_jacobian,
            least_jacobian: quality.least_jacobian,
            sets: parts.iter().map(set).collect(),
            mesh,
            parts,
        }
    }

    /// Positions of the nodes, mm.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.mesh.nodes
    }

    /// The nodes of each brick, from 0, in the order of C3D8 and C3D20.
    pub fn connectivity(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        self.mesh.bricks.chunks_exact(self.mesh.order.nodes())
    }

    /// The faces of a named part of the surface, each as its brick and its face, both from 0; faces are those of C3D8.
    pub fn set_faces(&self, name: &str) -> Option<&[(u32, u8)]> {
        self.parts.iter().find(|set| set.name == name).map(|set| &set.faces[..])
    }

    /// The nodes of a named part of the surface, from 0.
    pub fn set_nodes(&self, name: &str) -> Option<&[u32]> {
        self.parts.iter().find(|set| set.name == name).map(|set| &set.nodes[..])
    }
}

impl Answer for MeshResult {
    fn not_done(&self) -> &[NotDone] {
        &self.not_done
    }
}

impl fmt::Display for MeshResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "job {} ({})", self.job, self.spec)?;
        self.solids.iter().try_for_each(|solid| write!(f, "\n{solid}"))?;
        if self.files.is_empty() { Ok(()) } else { writeln!(f, "\nwrote {}", self.files.join(", ")) }
    }
}

impl fmt::Display for BrickNumbers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let BrickNumbers { name, frame, teeth, meshed_teeth, element, bricks, nodes, .. } = self;
        let meshed = if meshed_teeth == teeth { "all".to_string() } else { meshed_teeth.to_string() };
        writeln!(f, "solid {name} ({frame}): {meshed} of {teeth} teeth")?;
        let ElementCounts { across, band, core, rim, along, shaft } = &self.elements;
        let across: Vec<String> = across.iter().map(usize::to_string).collect();
        writeln!(f, "  bricks   {bricks} {element} with {nodes} nodes")?;
        writeln!(
            f,
            "  a tooth  {} across its space, {along} along, {band} + {core} + {band} from flank to flank, {rim} below",
            across.join(" + ")
        )?;
        if let Some(ShaftElements { rows, ends: [before, behind] }) = shaft {
            writeln!(f, "  a shaft  {rows} below the teeth, {before} along it before them and {behind} behind")?;
        }
        writeln!(f, "  faces    off the generated surfaces by at most {}", units::off(self.deviation_mm))?;
        let against = match self.exact_volume_mm3 {
            Some(exact) => {
                let off = 1e6 * (self.volume_mm3 / exact - 1.0);
                format!("{off:+.1} ppm from {exact:.4} mm³ by the exact surfaces")
            }
            None => "of teeth that differ: no side is the other one turned".to_string(),
        };
        writeln!(f, "  volume   {:.4} mm³, {against}", self.volume_mm3)?;
        writeln!(
            f,
            "  shape    least scaled Jacobian {:.3}, least Jacobian {:.3} of a brick's mean",
            self.least_scaled_jacobian, self.least_jacobian
        )?;
        let of_others = |name: &str| (2..=*meshed_teeth).any(|tooth| name.ends_with(&format!("_T{tooth}")));
        let names: Vec<&str> = self.sets.iter().map(|set| set.name.as_str()).filter(|name| !of_others(name)).collect();
        let others = match meshed_teeth {
            1 => String::new(),
            2 => "; _T2 on the other tooth".to_string(),
            _ => format!("; _T2 to _T{meshed_teeth} on the other teeth"),
        };
        writeln!(f, "  sets     {}{others}", names.join(", "))
    }
}
