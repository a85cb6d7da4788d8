//! The whole sheet: what goes where.

use super::axis;
use super::camera::{Camera, View};
use super::font;
use super::inset;
use super::labels;
use super::legend;
use super::marks;
use super::mesh::{Mesh, Node};
use super::missing;
use super::occupancy::Occupancy;
use super::paint::{Anchor, Item, Rect, Sheet};
use super::palette::{self, GREY, INK};
use super::surface::{Detail, Layers, add_mesh};
use crate::conventions::one_line;
use crate::dataset::{Dataset, Header, Patch};
use crate::number;
use crate::tally::Tally;
use crate::vector::Vector;

pub(super) const MARGIN: f64 = 48.0;
const COLUMN: f64 = 300.0;
const DETAIL: Detail = Detail { smooth: 28, grid_spacing: 22.0, grid_width: 0.9, border_width: 2.4 };

/// A composed sheet.
pub(super) struct Figure {
    pub(super) title: String,
    pub(super) caption: String,
    pub(super) items: Vec<Item>,
}

/// A patch with what is drawn of it.
pub(super) struct Drawn<'a> {
    pub(super) number: usize,
    pub(super) patch: &'a Patch,
    pub(super) mesh: Mesh,
}

/// The parts of the sheet.
struct Regions {
    sheet: Rect,
    surfaces: Rect,
    legend: Rect,
    inset: Rect,
    foot: Rect,
}

/// Arranges the figure on a sheet of this size.
pub(super) fn compose(dataset: &Dataset, width: f64, height: f64) -> Figure {
    let regions = Regions::of(width, height);
    let drawn = meshes(dataset);
    let nodes: Vec<Node> = drawn.iter().flat_map(|drawn| drawn.mesh.nodes.iter().flatten().copied()).collect();
    let title = one_line(if dataset.header.job.is_empty() { "surfaces" } else { &dataset.header.job });
    let mut sheet = Sheet::default();
    write_heading(&title, &dataset.header, width - 2.0 * MARGIN, &mut sheet);
    legend::draw(&drawn, regions.legend, &mut sheet);
    let room = regions.surfaces.shrunk(60.0);
    let camera = Camera::facing(&nodes, room.width(), room.height());
    let caption = caption(dataset, &drawn, &nodes, &camera);
    write_caption(&caption, [width, height], &mut sheet);
    if nodes.is_empty() {
        let why = if dataset.patches.is_empty() { "no surface was asked for" } else { "no point was solved" };
        let text = format!("nothing to draw: {why}");
        sheet.text(regions.surfaces.middle(), Anchor::Middle, 20.0, GREY, &text);
    } else {
        draw_surfaces(&drawn, &nodes, camera, &regions, &mut sheet);
    }
    Figure { title, caption, items: sheet.items }
}

impl Regions {
    fn of(width: f64, height: f64) -> Self {
        let column = width - MARGIN - COLUMN;
        Regions {
            sheet: Rect { left: 0.0, top: 0.0, right: width, bottom: height },
            surfaces: Rect { left: MARGIN, top: 122.0, right: column - 36.0, bottom: height - 196.0 },
            legend: Rect { left: column, top: 130.0, right: width - MARGIN, bottom: height - 440.0 },
            inset: Rect { left: column, top: height - 410.0, right: width - MARGIN, bottom: height - 104.0 },
            foot: Rect { left: MARGIN, top: height - 190.0, right: column - 36.0, bottom: height - 84.0 },
        }
    }
}

/// The more patches there are, the fewer cells each may have: a page shows some ten thousand faces at most.
fn meshes(dataset: &Dataset) -> Vec<Drawn<'_>> {
    let many = dataset.patches.len().max(1) as f64;
    let cells = (110.0 / many.sqrt()).clamp(3.0, 72.0) as usize;
    let mesh = |(number, patch)| Drawn { number, patch, mesh: Mesh::of(patch, cells) };
    dataset.patches.iter().enumerate().map(mesh).collect()
}

/// The title and where everything comes from.
pub(super) fn write_heading(title: &str, header: &Header, room: f64, sheet: &mut Sheet) {
    sheet.text([MARGIN, 66.0], Anchor::Start, 26.0, INK, &font::fitted(title, 26.0, room));
    if header.spec.is_empty() {
        return;
    }
    let hash: String = header.spec_hash.chars().take(16).collect();
    let origin = one_line(&format!("{} \u{b7} hash {hash} \u{b7} {}", header.spec, header.program));
    sheet.text([MARGIN, 94.0], Anchor::Start, 15.0, GREY, &font::fitted(&origin, 15.0, room));
}

fn caption(dataset: &Dataset, drawn: &[Drawn<'_>], nodes: &[Node], camera: &Camera) -> String {
    let tally = Tally::of(&dataset.patches);
    let mut text = format!("Solved {} of {} points asked for", tally.solved, tally.asked);
    // how it was computed goes with where it comes from: a book's picture stays the same when rounding changes
    if let Some(worst) = tally.worst_residual.filter(|_| !dataset.header.spec.is_empty()) {
        text += &format!("; worst residual {}", number::residual(worst));
    }
    text.push('.');
    if tally.solved < tally.asked {
        let crosses = if nodes.is_empty() { "" } else { " (red crosses beside solved ones)" };
        text += &format!(" Not solved{crosses}: {}.", one_line(&tally.reasons()));
    }
    let all_points = |drawn: &Drawn<'_>| drawn.mesh.thinned_from(drawn.patch);
    text.extend(drawn.iter().find_map(all_points).map(|sentence| format!(" {sentence}")));
    let from_inside = |node: &Node| node.normal.is_some_and(|normal| camera.seen(normal)[2] < 0.0);
    if nodes.iter().any(from_inside) {
        text += " Greyer where seen from inside the body, against the normal.";
    }
    text
}

pub(super) fn write_caption(caption: &str, [width, height]: [f64; 2], sheet: &mut Sheet) {
    let room = width - 2.0 * MARGIN;
    for (line, text) in font::wrapped(caption, 15.0, room).iter().take(2).enumerate() {
        let down = height - 56.0 + 22.0 * line as f64;
        sheet.text([MARGIN, down], Anchor::Start, 15.0, INK, text);
    }
}

fn draw_surfaces(drawn: &[Drawn<'_>], nodes: &[Node], camera: Camera, regions: &Regions, sheet: &mut Sheet) {
    let places: Vec<Vector> = nodes.iter().map(|node| node.position).collect();
    let view = View::fitting(camera, &places, regions.surfaces.shrunk(60.0));
    let mut layers = Layers::default();
    let detail = Detail { smooth: if drawn.len() > 4 { 12 } else { DETAIL.smooth }, ..DETAIL };
    for drawn in drawn {
        add_mesh(&drawn.mesh, palette::of_patch(drawn.number), &view, detail, &mut layers);
    }
    let mut taken = Occupancy::new(regions.sheet.right, regions.sheet.bottom);
    layers.shapes().for_each(|shape| taken.take_shape(shape));
    let shown_axis = axis::add_through(&view, regions.surfaces, &mut layers);
    if let Some(ends) = shown_axis {
        axis::take_line(ends, &mut taken);
    }
    layers.into_items().for_each(|item| sheet.push(item));
    missing::draw(drawn.iter().map(|drawn| drawn.patch), &view, sheet);
    labels::draw(drawn, &view, regions.surfaces, &mut taken, sheet);
    if let Some(ends) = shown_axis {
        axis::label(ends, regions.surfaces, &mut taken, sheet);
    }
    marks::draw_triad(&camera, &frames(drawn), regions.foot, sheet);
    marks::draw_scale(view.scale, regions.foot, sheet);
    inset::draw(drawn, nodes, camera, regions.inset, sheet);
}

/// The frames of the patches, each once.
fn frames(drawn: &[Drawn<'_>]) -> String {
    let mut names: Vec<String> = Vec::new();
    for drawn in drawn {
        let name = one_line(&drawn.patch.frame);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let word = if names.len() == 1 { "frame" } else { "frames" };
    format!("{word} {}", names.join(", "))
}
