//! What a page shows beside the points: machines that move, their tools, and the functions that say how.

use serde::Serialize;

use flank_export::Unit;

use super::body::PageBody;
use super::contact::PageContact;
use super::milling::PageMilling;

/// Everything of a page that is not in its dataset.
///
/// Angles are radians here, as in the functions; the page shows degrees. Each function takes its numbers one by one, then an array
/// that it fills.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    /// What the job says of itself.
    pub doc: Vec<String>,
    /// What moves.
    pub motions: Vec<PageMotion>,
    /// Job parameters and settings, each after those that its value depends on.
    pub parameters: Vec<PageParameter>,
    /// The machines.
    pub machines: Vec<PageMachine>,
    /// The tools that stand on them.
    pub tools: Vec<PageTool>,
    /// For each surface what is known beside its points.
    pub surfaces: Vec<PageSurface>,
    /// The gears that they are of.
    pub bodies: Vec<PageBody>,
    /// Pairs of them that roll on each other.
    pub contacts: Vec<PageContact>,
    /// Cutters on their passes.
    pub millings: Vec<PageMilling>,
    /// JavaScript functions, each an `export function`.
    pub functions: String,
    /// Their names.
    pub function_names: Vec<String>,
    /// The function of all parameters that gives what each is by its definition; none without parameters.
    pub definitions: Option<String>,
    /// What a reader of the page must know.
    pub notes: Vec<String>,
}

/// A motion and where its slider goes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PageMotion {
    /// Its name.
    pub name: String,
    /// The unit that it is shown in.
    #[serde(serialize_with = "symbol")]
    pub unit: Unit,
    /// Where its slider begins.
    pub low: f64,
    /// Where it ends.
    pub high: f64,
    /// Lowest and highest value that it takes.
    pub limits: [f64; 2],
    /// Where it stands at first.
    pub start: f64,
    /// Whether it takes whole numbers only.
    pub is_count: bool,
}

/// A parameter of the job and between which values it can be moved.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PageParameter {
    /// Its name, as `--set` takes it.
    pub name: String,
    /// The unit that it is shown in: `mm`, `deg`, `1`, or another one of mm and radians.
    pub unit: String,
    /// Its value in the job.
    pub value: f64,
    /// Where its slider begins and ends; `None` if it stays.
    pub range: Option<[f64; 2]>,
    /// Lowest and highest value that it takes, infinite where there is none.
    pub limits: [f64; 2],
}

/// A machine: a tree of frames.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PageMachine {
    /// Its name in the job.
    pub name: String,
    /// The machine that it is one of.
    pub definition: String,
    /// Parents before children; the first is the root.
    pub frames: Vec<PageFrame>,
    /// Where axes move things, in the order of the frames.
    pub joints: Vec<PageJoint>,
    /// Its axes.
    pub axes: Vec<PageAxis>,
    /// The function of motions and parameters that gives, in the root frame: of each frame the upper three rows of its pose, of
    /// each joint a point and a direction, then the positions of the axes.
    pub poses: String,
}

/// A frame of a machine.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PageFrame {
    /// Its name.
    pub name: String,
    /// The frame that it hangs on.
    pub parent: Option<usize>,
}

/// A place at which a moving axis acts.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PageJoint {
    /// The axis, by its place in the machine.
    pub axis: usize,
    /// Whether it turns.
    pub is_rotary: bool,
}

/// An axis of a machine.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PageAxis {
    /// Its name.
    pub name: String,
    /// The unit that it is shown in.
    #[serde(serialize_with = "symbol")]
    pub unit: Unit,
    /// What it follows: `driven`, `coupled`, `fixed`.
    pub law: String,
    /// Its travel.
    pub travel: Option<[f64; 2]>,
}

/// A tool, or a part of one, in a frame of a machine.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PageTool {
    /// Its name.
    pub name: String,
    /// The machine, by its place.
    pub machine: usize,
    /// The frame, by its place in the machine.
    pub frame: usize,
    /// What it looks like.
    pub form: ToolForm,
}

/// What a tool looks like.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum ToolForm {
    /// A surface: the function of two parameters, then the job's parameters, gives a position.
    Surface {
        /// The function.
        position: String,
        /// Values of the first parameter.
        u: Vec<f64>,
        /// Values of the second one.
        v: Vec<f64>,
        /// The axis that it is a surface of revolution about, for the job's own values.
        axis: Option<Revolution>,
    },
    /// An edge: the same of one parameter.
    Edge {
        /// The function.
        position: String,
        /// Values of the parameter.
        u: Vec<f64>,
    },
    /// That part of it which touches the points of a surface.
    Contact {
        /// The surface, by its place.
        surface: usize,
    },
}

/// An axis of revolution, in the frame of its surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Revolution {
    /// A point of it, mm.
    pub through: [f64; 3],
    /// Its unit direction.
    pub direction: [f64; 3],
    /// Which parameter of the surface runs around it.
    pub around: usize,
}

/// What is known of a surface beside its points.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PageSurface {
    /// The machine of its frame, by its place.
    pub machine: usize,
    /// Its frame, by its place in the machine.
    pub frame_index: usize,
    /// The frame of the tool.
    pub tool_frame: usize,
    /// The unknowns that are motions of its own envelope, by their places: where one has the value of now, the tool touches.
    pub contact: Vec<usize>,
    /// What points are asked for by.
    pub coordinates: [String; 2],
    /// The values of these at each point.
    #[serde(skip)]
    pub targets: Vec<[f64; 2]>,
    /// How far each row, and each column, is from the first to the last one that is asked for, as a share.
    pub shares: [Vec<f64>; 2],
    /// The function of the parameters that gives both coordinates at the first row's first and last point, then at the last row's.
    pub corners: String,
    /// Where each unknown is looked for.
    #[serde(skip)]
    pub ranges: Vec<[f64; 2]>,
    /// Of each unknown the motion that it is, by its place; of the tool's parameters none.
    #[serde(skip)]
    pub motions: Vec<Option<usize>>,
    /// The function of unknowns, two targets and parameters that gives residuals and Jacobian, row by row.
    pub equations: String,
    /// The function of unknowns and parameters that gives position, normal, conditions, and perhaps both principal curvatures.
    pub point: String,
    /// How many conditions there are: at a point of the work all are positive.
    pub conditions: usize,
    /// Whether there are curvatures.
    pub curvatures: bool,
    /// Names of the surfaces that cut points of it away.
    pub trimmed_by: Vec<String>,
}

fn symbol<S: serde::Serializer>(unit: &Unit, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(unit.symbol())
}
