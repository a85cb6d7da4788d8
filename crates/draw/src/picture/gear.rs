//! A gear as its maker knows it: three of its teeth large, tips up, the whole of it beside them.

use super::axis;
use super::camera::{Camera, View};
use super::figure::{self, Figure, MARGIN};
use super::font;
use super::legend;
use super::marks;
use super::paint::{Anchor, Colour, Item, Rect, Sheet};
use super::palette::{self, GREY, INK};
use super::surface::Layers;
use flank_export::Header;
use flank_export::text::{one_line, with_minus};
use flank_export::vector::{Vector, add, cross, scale, unit};

const COLUMN: f64 = 300.0;
/// From fact to fact.
const PITCH: f64 = 21.0;
const SIZE: f64 = 14.0;
/// What is turned and not generated, and where teeth are cut off that are not shown.
const STEEL: Colour = Colour([205, 210, 216]);
const CUT: Colour = Colour([236, 228, 214]);
/// Pieces overlap their neighbours by half of this; they are small, and what is behind them near.
const SEAM: f64 = 1.6;
/// How far lines are drawn in front of their faces, sheet units.
const LIFT: f64 = 7.0;
/// How much of the view's direction lies along the teeth, towards their tips, and across both.
const ASKEW: [f64; 3] = [0.52, 0.56, 0.64];

/// A gear, or several in the frames in which they were made.
#[derive(Debug, Clone, PartialEq)]
pub struct GearDrawing {
    /// Where it comes from.
    pub header: Header,
    /// What it is called.
    pub title: String,
    /// What is to be said of it; written below.
    pub note: String,
    /// Its data, each with a name.
    pub facts: Vec<(String, String)>,
    /// The names of its generated surfaces.
    pub surfaces: Vec<String>,
    /// All of it.
    pub whole: Vec<GearFace>,
    /// Some of its teeth.
    pub teeth: Vec<GearFace>,
    /// What the teeth are called that are shown large.
    pub shown: String,
    /// In the middle of the teeth that are shown: along them, and from root to tip; unit vectors.
    pub directions: [[f64; 3]; 2],
    /// Whether the faces bound a body, so that those that face away from the eye are hidden.
    pub is_closed: bool,
}

/// A face of a gear as a grid of points.
#[derive(Debug, Clone, PartialEq)]
pub struct GearFace {
    /// What it is.
    pub kind: GearFaceKind,
    /// Rows and columns.
    pub counts: [usize; 2],
    /// Whether it ends at its first row, its last row, its first column and its last column, or goes on beyond.
    pub ends: [bool; 4],
    /// Row by row, mm; none where nothing is known.
    pub points: Vec<Option<[f64; 3]>>,
    /// Out of the material.
    pub normals: Vec<[f64; 3]>,
}

/// What a face of a gear is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GearFaceKind {
    /// A generated surface, by its place among the names.
    Surface(usize),
    /// A face of the blank.
    Blank,
    /// Where teeth that are not shown are cut off.
    Cut,
}

/// Arranges the figure on a sheet of this size.
pub(super) fn compose(gear: &GearDrawing, [width, height]: [f64; 2]) -> Figure {
    let title = one_line(&gear.title);
    let mut sheet = Sheet::default();
    figure::write_heading(&title, &gear.header, width - 2.0 * MARGIN, &mut sheet);
    let [large, small, list] = parts(width, height);
    if gear.teeth.is_empty() {
        sheet.text(large.middle(), Anchor::Middle, 20.0, GREY, "nothing to draw: no point is solved");
    } else {
        draw_teeth(gear, large, &mut sheet);
        draw_whole(gear, small, &mut sheet);
        draw_list(gear, list, &mut sheet);
    }
    let caption = with_minus(&one_line(&gear.note));
    figure::write_caption(&caption, [width, height], &mut sheet);
    Figure { title, caption, items: sheet.items }
}

/// Some teeth, the whole gear, and the list: beside the teeth, or below them on a sheet that is higher than wide.
fn parts(width: f64, height: f64) -> [Rect; 3] {
    let [width, height] = figure::useful(width, height);
    let (right, bottom) = (width - MARGIN, height - 84.0);
    if height > width {
        let (top, middle) = (bottom - 0.36 * height, 0.5 * width);
        return [
            Rect { left: MARGIN, top: 112.0, right, bottom: top - 20.0 },
            Rect { left: MARGIN, top, right: middle - 10.0, bottom },
            Rect { left: middle + 10.0, top, right, bottom },
        ];
    }
    let column = right - COLUMN;
    let middle = (112.0 + COLUMN + 40.0).min(0.55 * height);
    [
        Rect { left: MARGIN, top: 112.0, right: column - 24.0, bottom },
        Rect { left: column, top: 112.0, right, bottom: middle },
        Rect { left: column, top: middle + 24.0, right, bottom },
    ]
}

fn draw_teeth(gear: &GearDrawing, rect: Rect, sheet: &mut Sheet) {
    let [along, tip] = gear.directions;
    let aside = cross(tip, along);
    let mixed = |shares: [f64; 3]| add(add(scale(shares[0], along), scale(shares[1], tip)), scale(shares[2], aside));
    let camera = Camera::looking(mixed(ASKEW), tip);
    let foot = Rect { bottom: rect.bottom - 48.0, ..rect };
    let view = draw_body(&gear.teeth, camera, foot, true, gear, sheet);
    let below = Rect { left: rect.left, right: rect.left + 260.0, ..rect };
    marks::draw_scale(view.scale, below, sheet);
    let at = [below.right + 24.0, rect.bottom - 20.0];
    let shown = font::fitted(&one_line(&gear.shown), SIZE, rect.right - at[0]);
    sheet.text(at, Anchor::Start, SIZE, GREY, &shown);
}

/// The whole gear with its axis upwards, or downwards where its teeth are seen from below.
fn draw_whole(gear: &GearDrawing, rect: Rect, sheet: &mut Sheet) {
    let [_, tip] = gear.directions;
    let side = if tip[2] < -0.1 { -1.0 } else { 1.0 };
    let camera = Camera::looking([0.5, -0.62, 0.6 * side], [0.0, 0.0, side]);
    draw_body(&gear.whole, camera, rect, false, gear, sheet);
}

/// Draws faces so that they fill a rectangle.
fn draw_body(
    faces: &[GearFace],
    camera: Camera,
    rect: Rect,
    is_large: bool,
    gear: &GearDrawing,
    sheet: &mut Sheet,
) -> View {
    let places: Vec<Vector> = faces.iter().flat_map(|face| face.points.iter().flatten().copied()).collect();
    let view = View::fitting(camera, &places, rect.shrunk(6.0));
    let mut layers = Layers::default();
    for face in faces {
        face.add(&view, (gear.is_closed, is_large), &mut layers);
    }
    if !is_large {
        let heights = places.iter().map(|place| place[2]);
        let (low, high) = heights.fold((f64::MAX, f64::MIN), |(low, high), z| (low.min(z), high.max(z)));
        let more = 0.12 * (high - low).max(rect.height() / view.scale);
        axis::add_between(&view, low - more, high + more, &mut layers);
    }
    layers.into_items().for_each(|item| sheet.push(item));
    view
}

impl GearFace {
    fn colour(&self) -> Colour {
        match self.kind {
            GearFaceKind::Surface(number) => palette::of_patch(number),
            GearFaceKind::Blank => STEEL,
            GearFaceKind::Cut => CUT,
        }
    }

    fn add(&self, view: &View, (is_closed, is_large): (bool, bool), layers: &mut Layers) {
        let base = self.colour();
        let [rows, columns] = self.counts;
        let mut is_seen = vec![false; rows * columns];
        for (i, j) in (1..rows).flat_map(|i| (1..columns).map(move |j| (i, j))) {
            let at = i * columns + j;
            let corners = [at - columns - 1, at - columns, at, at - 1];
            let Some(points) = corners.iter().map(|k| self.points[*k]).collect::<Option<Vec<Vector>>>() else {
                continue;
            };
            let normal = corners.iter().fold([0.0; 3], |sum, k| add(sum, self.normals[*k]));
            let seen = unit(normal).map(|normal| view.camera.seen(normal));
            if is_closed && seen.is_some_and(|seen| seen[2] <= 0.0) {
                continue;
            }
            is_seen[at] = true;
            let fill = seen.map_or(base, |seen| palette::shaded(base, seen));
            let middle = points.iter().fold([0.0; 3], |sum, point| add(sum, scale(0.25, *point)));
            let points = points.iter().map(|point| view.place(*point)).collect();
            layers.push(view.depth(middle), Item::Polygon { points, fill, outline: fill, width: SEAM });
        }
        self.add_borders(view, (&is_seen, is_large), layers);
    }

    /// Lines along the sides of cells that are seen, where the face ends.
    fn add_borders(&self, view: &View, (is_seen, is_large): (&[bool], bool), layers: &mut Layers) {
        let [rows, columns] = self.counts;
        let (colour, width) = (self.colour().towards(INK, 0.75), if is_large { 1.4 } else { 0.6 });
        let node = |i: usize, j: usize| i * columns + j;
        // a cell has the number of its last corner
        let across = |cell: usize, row: usize| {
            (1..columns).map(move |j| (node(cell, j), [node(row, j - 1), node(row, j)])).collect::<Vec<_>>()
        };
        let down = |cell: usize, column: usize| {
            (1..rows).map(move |i| (node(i, cell), [node(i - 1, column), node(i, column)])).collect::<Vec<_>>()
        };
        let sides = [across(1, 0), across(rows - 1, rows - 1), down(1, 0), down(columns - 1, columns - 1)];
        let lines = sides.into_iter().zip(self.ends).filter(|(_, ends)| *ends).flat_map(|(side, _)| side);
        for (_, ends) in lines.filter(|(cell, _)| is_seen[*cell]) {
            let [Some(from), Some(to)] = ends.map(|end| self.points[end]) else { continue };
            let lift = LIFT / view.scale;
            let depth = view.depth(scale(0.5, add(from, to))) + lift;
            layers.push(depth, Item::Line { points: vec![view.place(from), view.place(to)], colour, width });
        }
    }
}

/// Data of the gear, then the colours of its surfaces.
fn draw_list(gear: &GearDrawing, rect: Rect, sheet: &mut Sheet) {
    let mut down = rect.top + SIZE;
    for (name, value) in &gear.facts {
        let value = with_minus(&one_line(value));
        let room = rect.width() - font::width(&value, SIZE) - 12.0;
        sheet.text([rect.left, down], Anchor::Start, SIZE, GREY, &font::fitted(&one_line(name), SIZE, room));
        sheet.text([rect.right, down], Anchor::End, SIZE, INK, &value);
        down += PITCH;
    }
    let names = gear.surfaces.iter().enumerate().map(|(k, name)| (palette::of_patch(k), one_line(name)));
    legend::draw_names(names, Rect { top: down + 8.0, ..rect }, sheet);
}
