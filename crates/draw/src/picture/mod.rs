//! Pictures as SVG and as PNG: all patches, shaded; fields of theirs as maps, lines or a relief; sections; machines; axes over
//! motions.
//!
//! A dataset becomes a display list once; SVG and PNG are two ways to write that list, so they show the same. Order of
//! the files is the order of work: `mesh` and `camera` see the surfaces, `surface` turns them into faces and lines, `projection`
//! lays them flat, `contours` turns values into bands and lines. `figure` arranges surfaces with labels, legend and inset, `maps`
//! arranges fields (`relief` those that are heights), `contact` those of a pair with its error, `milling` ridges and passes, `section`, `machine` and `positions` the rest, on the axes of `chart` where
//! there are some. `svg` and `png` write.

mod axis;
mod calls;
mod camera;
mod chart;
mod contact;
mod contours;
mod convex;
mod error;
mod figure;
mod font;
mod gear;
mod inset;
mod labels;
mod legend;
mod levels;
mod machine;
mod maps;
mod marks;
mod milled_pair;
mod milling;
mod missing;
mod occupancy;
mod paint;
mod palette;
mod png;
mod positions;
mod projection;
mod relief;
mod section;
mod surface;
mod svg;
mod traces;
mod values;

pub(crate) use palette::{patch_colours, scale_colours, signed_colours};

pub use contact::{
    ContactDrawing, ContactMark, ContactPicture, DrawnContact, DrawnFlank, ErrorCurves, MOST_CONTACTS, Station,
    StationShape,
};
pub use error::PictureError;
use flank_export::Dataset;
use flank_export::MotionTable;
pub use gear::{GearDrawing, GearFace, GearFaceKind};
pub use machine::{DrawnFrame, LinkKind, MachineDrawing, MachineLink};
use maps::{Style, Words};
pub use milled_pair::MilledPairDrawing;
pub use milling::{MillingDrawing, PassChart, RidgeSection};
use paint::Item;
pub use section::{Section, SectionCircle, SectionLine, ToolPosition};
pub use traces::{TraceChart, TraceDrawing};

/// Sizes of the sheets that line widths and letters are made for: wide and high ones.
const SHEETS: [[f64; 2]; 2] = [[1200.0, 900.0], [900.0, 1200.0]];

/// Sides that are drawn as they are asked for, pixels; others are brought to the nearest end.
const SIDES: std::ops::RangeInclusive<u32> = 64..=16_384;

/// How large a picture is.
///
/// Lines and letters grow with it: 2400 x 1800 is the same figure as 1200 x 900, twice as fine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PictureOptions {
    /// Pixels across; 64 to 16384.
    pub width: u32,
    /// Pixels down; 64 to 16384.
    pub height: u32,
}

impl Default for PictureOptions {
    fn default() -> Self {
        PictureOptions { width: 1200, height: 900 }
    }
}

/// A finished picture.
#[derive(Debug, Clone)]
pub struct Picture {
    width: u32,
    height: u32,
    /// Pixels per sheet unit.
    unit: f64,
    title: String,
    description: String,
    items: Vec<Item>,
}

/// Draws all patches of a dataset, looked at from the side their normals point to, with the axis z, dimensions, the
/// directions of rows and columns, a scale, and what was solved.
///
/// There is a picture of any dataset: points without a finite position are left out, and a dataset with no point to draw
/// becomes a sheet that says so. Patches of each frame have a view of their own.
///
/// ```
/// use flank_draw::{PictureOptions, picture};
/// use flank_export::{Dataset, Header};
///
/// let header = Header {
///     program: "flank 0.1.0".into(),
///     spec: "gear.flank".into(),
///     spec_hash: "5e1f".into(),
///     job: "flanks".into(),
///     conventions: Vec::new(),
/// };
/// let picture = picture(&Dataset { header, patches: Vec::new() }, &PictureOptions::default());
/// assert!(picture.svg().contains("nothing to draw"));
/// assert!(picture.png()?.starts_with(b"\x89PNG"));
/// # Ok::<(), flank_draw::PictureError>(())
/// ```
#[must_use]
pub fn picture(dataset: &Dataset, options: &PictureOptions) -> Picture {
    on_sheet(options, |[width, height]| figure::compose(dataset, width, height))
}

/// Draws a gear: some of its teeth large, their tips up, the whole of it beside them with its data and the names of its surfaces.
#[must_use]
pub fn gear(gear: &GearDrawing, options: &PictureOptions) -> Picture {
    on_sheet(options, |size| gear::compose(gear, size))
}

/// Draws fields of numbers as maps over their grids, side by side: `shown` names each by the index of its patch and its own
/// index among the patch's fields, `note` is written below.
///
/// A flank lies flat, its length to the right and its tip up, as large as there is room, and its sides are named: root and tip by the
/// way it leans, toe and heel, or the faces. Where there is room the values stand in it in numbers.
///
/// Values are in bands with round bounds, the lower the darker, from blue to yellow: in grey and for colour-blind readers the
/// order is the same. Where there are both signs, blue is minus and orange plus, and lines between bands are dashed below zero,
/// thick at zero. A point without a value has a red cross. What is not there, or has vectors, is left out.
///
/// ```
/// # use flank_draw::{PictureOptions, field_maps};
/// # use flank_export::{Axis, Dataset, Field, Header, Outcome, Patch, Point, Values};
/// # let header = Header {
/// #     program: "flank 0.1.0".into(),
/// #     spec: "gear.flank".into(),
/// #     spec_hash: "5e1f".into(),
/// #     job: "flanks".into(),
/// #     conventions: Vec::new(),
/// # };
/// # let at = |z| Point {
/// #     outcome: Outcome::Solved,
/// #     position: [30.0, 0.0, z],
/// #     normal: [1.0, 0.0, 0.0],
/// #     unknowns: Vec::new(),
/// #     residual: 0.0,
/// #     reason: String::new(),
/// # };
/// let patch = Patch {
///     fields: vec![Field {
///         name: "k1".into(),
///         unit: "1/mm".into(),
///         meaning: "larger principal curvature".into(),
///         values: Values::Scalars([Some(0.03), Some(0.04)].into()),
///     }],
/// #   name: "side".into(),
/// #   frame: "m.table".into(),
/// #   layout: Default::default(),
/// #   rows: Axis { label: "z".into(), count: 2 },
/// #   columns: Axis { label: "rho".into(), count: 1 },
/// #   unknowns: Vec::new(),
/// #   points: vec![at(0.0), at(1.0)],
///     // and the grid of points
/// };
/// let dataset = Dataset { header, patches: vec![patch] };
/// let picture = field_maps(&dataset, "curvatures", &[(0, 0)], "", &PictureOptions::default());
/// assert!(picture.svg().contains("aria-label=\"k1\""));
/// ```
#[must_use]
pub fn field_maps(
    dataset: &Dataset,
    title: &str,
    shown: &[(usize, usize)],
    note: &str,
    options: &PictureOptions,
) -> Picture {
    on_sheet(options, |size| maps::compose(dataset, &Words { title, note, numbers: &[] }, shown, (Style::Bands, size)))
}

/// The same with one scale for all fields of a unit, so that they can be held against each other; the meaning of a field stands below its
/// name.
#[must_use]
pub fn comparable_maps(
    dataset: &Dataset,
    title: &str,
    shown: &[(usize, usize)],
    note: &str,
    options: &PictureOptions,
) -> Picture {
    let words = Words { title, note, numbers: &[] };
    on_sheet(options, |size| maps::compose(dataset, &words, shown, (Style::BandsOfOneKey, size)))
}

/// Draws one field as [`field_maps`] does, with lines that sum it up above it on the right: its slopes, its crownings.
#[must_use]
pub fn deviation_map(
    dataset: &Dataset,
    title: &str,
    shown: (usize, usize),
    (note, numbers): (&str, &[String]),
    options: &PictureOptions,
) -> Picture {
    let words = Words { title, note, numbers };
    on_sheet(options, |size| maps::compose(dataset, &words, &[shown], (Style::Bands, size)))
}

/// Draws fields of numbers as lines of equal values over their flanks, each with its number: contact lines are those of equal
/// values of a motion. The rest is as for [`field_maps`].
#[must_use]
pub fn field_lines(
    dataset: &Dataset,
    title: &str,
    shown: &[(usize, usize)],
    note: &str,
    options: &PictureOptions,
) -> Picture {
    on_sheet(options, |size| maps::compose(dataset, &Words { title, note, numbers: &[] }, shown, (Style::Lines, size)))
}

/// Draws fields of numbers as heights above their flanks, seen from aside: a topography. The largest of them is
/// drawn as high as a fifth of the flank's length. The rest is as for [`field_maps`].
#[must_use]
pub fn topography(
    dataset: &Dataset,
    title: &str,
    shown: &[(usize, usize)],
    note: &str,
    options: &PictureOptions,
) -> Picture {
    on_sheet(options, |size| maps::compose(dataset, &Words { title, note, numbers: &[] }, shown, (Style::Relief, size)))
}

/// Draws a section through a tooth space: the work with strokes on its side of the steel, circles about its axis, the tool in each of
/// its positions, in the colour of the moment, dots where they touch, and a detail of it.
///
/// ```
/// use flank_draw::{PictureOptions, Section, SectionLine, ToolPosition, section};
/// use flank_export::Header;
///
/// let header = Header {
///     program: "flank 0.1.0".into(),
///     spec: "groove.flank".into(),
///     spec_hash: "5e1f".into(),
///     job: "groove".into(),
///     conventions: Vec::new(),
/// };
/// let parabola = |x: f64| [x, x * x];
/// let tangent = |at: f64| vec![[at - 1.0, at * at - 2.0 * at], [at + 1.0, at * at + 2.0 * at]];
/// let drawn = section(
///     &Section {
///         header,
///         note: "across the groove".into(),
///         surfaces: vec![SectionLine {
///             name: "bottom".into(),
///             points: (-10..=10).map(|k| parabola(0.1 * f64::from(k))).collect(),
///             normals: (-10..=10).map(|k| [-0.2 * f64::from(k), 1.0]).collect(),
///         }],
///         circles: Vec::new(),
///         motion: "turn, deg".into(),
///         tools: vec![ToolPosition {
///             value: 3.0,
///             lines: vec![tangent(0.5)],
///             contacts: vec![parabola(0.5)],
///         }],
///     },
///     &PictureOptions::default(),
/// );
/// assert!(drawn.svg().contains("aria-label=\"tool at turn, deg\""));
/// ```
#[must_use]
pub fn section(section: &Section, options: &PictureOptions) -> Picture {
    on_sheet(options, |size| section::compose(section, size))
}

/// Draws profile and helix traces of flanks with their mean lines and the numbers of their evaluation, on one scale.
#[must_use]
pub fn traces(drawing: &TraceDrawing, options: &PictureOptions) -> Picture {
    on_sheet(options, |size| traces::compose(drawing, size))
}

/// Draws a machine as a kinematic diagram: on the left its frames, links and axes where they are in space, an arrow along what
/// slides and a ring about what turns; on the right what leads to each frame, with numbers.
#[must_use]
pub fn machine(machine: &MachineDrawing, options: &PictureOptions) -> Picture {
    on_sheet(options, |size| machine::compose(machine, size))
}

/// Draws the positions of axes over motions: a chart for each axis that moves along no straight line with a motion, with how far it is off
/// one, and a table of the others.
#[must_use]
pub fn axis_positions(tables: &[MotionTable], options: &PictureOptions) -> Picture {
    on_sheet(options, |size| positions::compose(tables, size))
}

/// Draws contacts of two flanks side by side, each flank laid flat with its length to the right and its tip up.
#[must_use]
pub fn contact(kind: ContactPicture, drawing: &ContactDrawing, options: &PictureOptions) -> Picture {
    on_sheet(options, |size| contact::compose(drawing, kind, size))
}

/// Draws a flank that a cutter mills: the ridges between its passes laid flat, the cutter across the highest of them, and below what happens
/// along a pass.
#[must_use]
pub fn milling(drawing: &MillingDrawing, options: &PictureOptions) -> Picture {
    on_sheet(options, |size| milling::compose(drawing, size))
}

/// Draws a milled flank against its mate: the least gap beside that of the generated flank, and numbers over the roll.
#[must_use]
pub fn milled_pair(drawing: &MilledPairDrawing, options: &PictureOptions) -> Picture {
    on_sheet(options, |size| milled_pair::compose(drawing, size))
}

/// The next of 1, 2, 5, 10, 20, … tenths and so on: a step that numbers on a scale have.
#[must_use]
pub fn round_step(value: f64) -> f64 {
    levels::round_up(value)
}

/// The letters of pictures that are elements of one page, once for all of them.
pub(crate) fn letters<'a>(pictures: impl IntoIterator<Item = &'a Picture>) -> String {
    svg::letters(pictures)
}

/// A figure on a sheet of the size that is asked for.
fn on_sheet(options: &PictureOptions, compose: impl FnOnce([f64; 2]) -> figure::Figure) -> Picture {
    let width = options.width.clamp(*SIDES.start(), *SIDES.end());
    let height = options.height.clamp(*SIDES.start(), *SIDES.end());
    let [wide, high] = SHEETS[usize::from(height > width)];
    let unit = (f64::from(width) / wide).min(f64::from(height) / high);
    let figure = compose([f64::from(width) / unit, f64::from(height) / unit]);
    Picture { width, height, unit, title: figure.title, description: figure.caption, items: figure.items }
}

impl Picture {
    /// The picture as an SVG document. It needs no font.
    #[must_use]
    pub fn svg(&self) -> String {
        svg::document(self)
    }

    /// The picture as an element of an HTML page that holds its [`letters`].
    pub(crate) fn element(&self) -> String {
        svg::element(self)
    }

    /// What it is called.
    pub(crate) fn title(&self) -> &str {
        &self.title
    }

    /// The same picture as a PNG file, with a white ground.
    ///
    /// # Errors
    /// When there is no memory for the pixels.
    pub fn png(&self) -> Result<Vec<u8>, PictureError> {
        png::file(self)
    }

    /// The sheet in its own units, in which all items are placed.
    fn sheet_size(&self) -> [f64; 2] {
        [f64::from(self.width) / self.unit, f64::from(self.height) / self.unit]
    }
}
