//! The whole sheet: what goes where.

use super::axis;
use super::camera::{Camera, View};
use super::font;
use super::inset;
use super::labels;
use super::legend;
use super::marks;
use super::missing;
use super::occupancy::Occupancy;
use super::paint::{Anchor, Item, Rect, Sheet};
use super::palette::{self, GREY, INK};
use super::surface::{Detail, Layers, add_mesh};
use flank_export::Tally;
use flank_export::shape::{Mesh, Node};
use flank_export::text as number;
use flank_export::text::one_line;
use flank_export::vector::Vector;
use flank_export::{Dataset, Header, Patch};

pub(super) const MARGIN: f64 = 48.0;
const COLUMN: f64 = 300.0;
/// Below the surfaces of a frame, or beside them where that leaves more: its directions and the scale.
const FOOT: f64 = 112.0;
const ASIDE: f64 = 210.0;
/// Around the surfaces, for labels.
const EDGE: f64 = 60.0;
/// Width over height that a part of a sheet has best.
const LANDSCAPE: f64 = 1.4;
const SLENDEREST: f64 = 2.4;
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
    views: Rect,
    legend: Rect,
    insets: Rect,
}

/// The patches of one frame, and where they are drawn.
struct Group<'a> {
    frame: String,
    drawn: Vec<&'a Drawn<'a>>,
    nodes: Vec<Node>,
    camera: Camera,
    view: Rect,
    inset: Rect,
}

/// Arranges the figure on a sheet of this size.
pub(super) fn compose(dataset: &Dataset, width: f64, height: f64) -> Figure {
    let regions = Regions::of_sheet(width, height);
    let drawn = meshes(dataset);
    let groups = groups(&drawn, &regions);
    let title = one_line(if dataset.header.job.is_empty() { "surfaces" } else { &dataset.header.job });
    let mut sheet = Sheet::default();
    write_heading(&title, &dataset.header, width - 2.0 * MARGIN, &mut sheet);
    legend::draw(&drawn, regions.legend, &mut sheet);
    let caption = caption(dataset, &drawn, &groups);
    write_caption(&caption, [width, height], &mut sheet);
    if groups.is_empty() {
        let why = if dataset.patches.is_empty() { "no surface was asked for" } else { "no point was solved" };
        let text = format!("nothing to draw: {why}");
        sheet.text(regions.views.middle(), Anchor::Middle, 20.0, GREY, &text);
    }
    for group in &groups {
        group.draw([width, height], groups.len() > 1, &mut sheet);
    }
    Figure { title, caption, items: sheet.items }
}

impl Regions {
    /// Legend and insets stand beside the views; below them on a sheet that is higher than wide.
    fn of_sheet(width: f64, height: f64) -> Self {
        let [width, height] = useful(width, height);
        let (right, bottom) = (width - MARGIN, height - 84.0);
        if height > width {
            let (top, middle) = (bottom - 350.0, 0.5 * width);
            return Regions {
                views: Rect { left: MARGIN, top: 122.0, right, bottom: top - 40.0 },
                legend: Rect { left: MARGIN, top, right: middle - 20.0, bottom },
                insets: Rect { left: middle + 20.0, top, right, bottom: bottom - 20.0 },
            };
        }
        let column = right - COLUMN;
        Regions {
            views: Rect { left: MARGIN, top: 122.0, right: column - 36.0, bottom },
            legend: Rect { left: column, top: 130.0, right, bottom: height - 440.0 },
            insets: Rect { left: column, top: height - 410.0, right, bottom: bottom - 20.0 },
        }
    }
}

/// As much of a very wide or very high sheet as parts that belong together may lie apart.
pub(super) fn useful(width: f64, height: f64) -> [f64; 2] {
    [width.min(SLENDEREST * height), height.min(SLENDEREST * width)]
}

/// The patches that have something to draw, frame by frame: what stands in different frames has no place in one space.
fn groups<'a>(drawn: &'a [Drawn<'a>], regions: &Regions) -> Vec<Group<'a>> {
    let mut groups: Vec<Group<'a>> = Vec::new();
    for drawn in drawn.iter().filter(|drawn| drawn.mesh.nodes.iter().any(Option::is_some)) {
        let frame = one_line(&drawn.patch.frame);
        let nodes = drawn.mesh.nodes.iter().flatten().copied();
        match groups.iter_mut().find(|group| group.frame == frame) {
            Some(group) => {
                group.drawn.push(drawn);
                group.nodes.extend(nodes);
            }
            None => groups.push(Group {
                frame,
                drawn: vec![drawn],
                nodes: nodes.collect(),
                camera: Camera::isometric(),
                view: regions.views,
                inset: regions.insets,
            }),
        }
    }
    let views: Vec<Rect> = places(groups.len(), regions.views, 24.0).collect();
    let insets = places(groups.len(), regions.insets, 10.0);
    for (group, (view, inset)) in groups.iter_mut().zip(views.into_iter().zip(insets)) {
        (group.view, group.inset) = (view, inset);
        let room = group.parts()[0].shrunk(EDGE);
        group.camera = Camera::facing(&group.nodes, room.width(), room.height());
    }
    groups
}

/// The more patches there are, the fewer cells each may have: a page shows some ten thousand faces at most.
fn meshes(dataset: &Dataset) -> Vec<Drawn<'_>> {
    let many = dataset.patches.len().max(1) as f64;
    let cells = (110.0 / many.sqrt()).clamp(3.0, 72.0) as usize;
    let mesh = |(number, patch)| Drawn { number, patch, mesh: Mesh::of_patch(patch, cells) };
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

fn caption(dataset: &Dataset, drawn: &[Drawn<'_>], groups: &[Group<'_>]) -> String {
    let tally = Tally::of_patches(&dataset.patches);
    let mut text = format!("Solved {} of {} points asked for", tally.solved, tally.asked);
    // how it was computed goes with where it comes from: a book's picture stays the same when rounding changes
    if let Some(worst) = tally.worst_residual.filter(|_| !dataset.header.spec.is_empty()) {
        text += &format!("; worst residual {}", number::residual(worst));
    }
    text.push('.');
    if tally.solved < tally.asked {
        let crosses = if groups.is_empty() { "" } else { " (red crosses beside solved ones)" };
        text += &format!(" Not solved{crosses}: {}.", one_line(&tally.reasons()));
    }
    let all_points = |drawn: &Drawn<'_>| drawn.mesh.thinned_from(drawn.patch);
    text.extend(drawn.iter().find_map(all_points).map(|sentence| format!(" {sentence}")));
    if groups.iter().any(Group::shows_inside) {
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

impl Group<'_> {
    /// Where the surfaces stand, the directions of the frame, and the scale.
    fn parts(&self) -> [Rect; 3] {
        let view = self.view;
        if view.width() > 2.0 * view.height() {
            let beside = Rect { left: view.right - ASIDE, ..view };
            let triad = Rect { top: view.bottom - 180.0, bottom: view.bottom - 66.0, ..beside };
            return [Rect { right: beside.left, ..view }, triad, Rect { top: triad.bottom, ..beside }];
        }
        let foot = Rect { top: view.bottom - FOOT + 6.0, ..view };
        [Rect { bottom: view.bottom - FOOT, ..view }, foot, foot]
    }

    /// Whether some face, not a mere line, is seen against its normal.
    fn shows_inside(&self) -> bool {
        let from_inside = |node: &Node| node.normal.is_some_and(|normal| self.camera.seen(normal)[2] < 0.0);
        let has_faces = self.drawn.iter().filter(|drawn| drawn.mesh.rows > 1 && drawn.mesh.columns > 1);
        has_faces.flat_map(|drawn| drawn.mesh.nodes.iter().flatten()).any(from_inside)
    }

    /// `is_named` where there are several: then the frame stands above its surfaces.
    fn draw(&self, [width, height]: [f64; 2], is_named: bool, sheet: &mut Sheet) {
        let Group { drawn, nodes, camera, .. } = self;
        let [surfaces, triad, scale] = self.parts();
        let places: Vec<Vector> = nodes.iter().map(|node| node.position).collect();
        let view = View::fitting(*camera, &places, surfaces.shrunk(EDGE));
        let mut layers = Layers::default();
        let detail = Detail { smooth: if drawn.len() > 4 { 12 } else { DETAIL.smooth }, ..DETAIL };
        for drawn in drawn {
            add_mesh(&drawn.mesh, palette::of_patch(drawn.number), &view, detail, &mut layers);
        }
        let mut taken = Occupancy::new(width, height);
        layers.shapes().for_each(|shape| taken.take_shape(shape));
        if is_named {
            let at = [surfaces.left, surfaces.top + 14.0];
            taken.take(&sheet.text(at, Anchor::Start, 16.0, INK, &format!("in {}", self.frame)));
        }
        let shown_axis = axis::add_through(&view, surfaces, &mut layers);
        if let Some(ends) = shown_axis {
            taken.take_line(ends);
        }
        layers.into_items().for_each(|item| sheet.push(item));
        missing::draw(drawn.iter().map(|drawn| drawn.patch), &view, sheet);
        labels::draw(drawn, &view, surfaces, &mut taken, sheet);
        if let Some(ends) = shown_axis {
            axis::label(ends, surfaces, &mut taken, sheet);
        }
        marks::draw_triad(camera, &format!("frame {}", self.frame), triad, sheet);
        marks::draw_scale(view.scale, scale, sheet);
        inset::draw(drawn, nodes, *camera, self.inset, sheet);
    }
}

/// Equal rectangles, row by row, each as near to landscape as their number allows.
pub(super) fn places(count: usize, area: Rect, gap: f64) -> impl Iterator<Item = Rect> {
    let size = move |across: usize| {
        let down = count.div_ceil(across).max(1);
        let width = (area.width() + gap) / across as f64 - gap;
        [width, (area.height() + gap) / down as f64 - gap]
    };
    let off = |across: &usize| {
        let [width, height] = size(*across).map(|side| side.max(1.0));
        (width / height / LANDSCAPE).ln().abs()
    };
    let across = (1..=count).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(1);
    let [width, height] = size(across);
    (0..count).map(move |k| {
        let left = area.left + (k % across) as f64 * (width + gap);
        let top = area.top + (k / across) as f64 * (height + gap);
        Rect { left, top, right: left + width, bottom: top + height }
    })
}
