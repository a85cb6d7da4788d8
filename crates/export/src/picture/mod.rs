//! Pictures as SVG and as PNG: all patches, shaded; or fields of theirs as maps.
//!
//! A dataset becomes a display list once; SVG and PNG are two ways to write that list, so they show the same. Order of
//! the files is the order of work: `mesh` and `camera` see the surfaces, `surface` turns them into faces and lines,
//! `figure` arranges them with labels, legend and inset, `maps` arranges fields, `svg` and `png` write.

mod axis;
mod camera;
mod figure;
mod font;
mod inset;
mod labels;
mod legend;
mod levels;
mod maps;
mod marks;
mod mesh;
mod missing;
mod occupancy;
mod paint;
mod palette;
mod png;
mod surface;
mod svg;

pub(crate) use palette::{patch_colours, scale_colours};

use crate::dataset::Dataset;
use crate::error::PictureError;
use paint::Item;

/// Size of the sheet that line widths and letters are made for.
const SHEET: [f64; 2] = [1200.0, 900.0];

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

/// Draws all patches of a dataset, looked at from the side their normals point to, with the gear axis, dimensions, the
/// directions of rows and columns, a scale, and what was solved.
///
/// There is a picture of any dataset: points without a finite position are left out, and a dataset with no point to draw
/// becomes a sheet that says so. Patches are drawn in one coordinate system, whatever frames they name.
///
/// ```
/// use flank_export::{Dataset, Header, PictureOptions, picture};
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
/// # Ok::<(), flank_export::PictureError>(())
/// ```
#[must_use]
pub fn picture(dataset: &Dataset, options: &PictureOptions) -> Picture {
    on_sheet(options, |[width, height]| figure::compose(dataset, width, height))
}

/// Draws fields of numbers as maps over their grids, side by side: `shown` names each by the index of its patch and its own
/// index among the patch's fields, `note` is written below.
///
/// Rows go up, columns to the right. Values are in bands with round bounds, the lower the darker, from blue to yellow: in
/// grey and for colour-blind readers the order is the same. A line divides minus from plus; a point without a value has a
/// red cross. What is not there, or has vectors, is left out.
///
/// ```
/// # use flank_export::{Axis, Dataset, Field, Header, Outcome, Patch, PictureOptions, Point, Values, field_maps};
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
///         values: Values::Scalars(vec![Some(0.03), Some(0.04)]),
///     }],
/// #   name: "side".into(),
/// #   frame: "m.table".into(),
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
    on_sheet(options, |size| maps::compose(dataset, title, shown, note, size))
}

/// A figure on a sheet of the size that is asked for.
fn on_sheet(options: &PictureOptions, compose: impl FnOnce([f64; 2]) -> figure::Figure) -> Picture {
    let width = options.width.clamp(*SIDES.start(), *SIDES.end());
    let height = options.height.clamp(*SIDES.start(), *SIDES.end());
    let unit = (f64::from(width) / SHEET[0]).min(f64::from(height) / SHEET[1]);
    let figure = compose([f64::from(width) / unit, f64::from(height) / unit]);
    Picture { width, height, unit, title: figure.title, description: figure.caption, items: figure.items }
}

impl Picture {
    /// The picture as an SVG document. It needs no font.
    #[must_use]
    pub fn svg(&self) -> String {
        svg::document(self)
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
