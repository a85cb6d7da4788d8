//! The patches on their body: with its axis and the circles they lie between, in true proportion.

use std::f64::consts::PI;

use super::axis;
use super::camera::{Camera, View};
use super::figure::Drawn;
use super::font;
use super::occupancy::Occupancy;
use super::paint::{Anchor, Item, Place, Rect, Sheet};
use super::palette::{self, FAINT, GREY, INK};
use super::surface::{Detail, Layers, add_mesh};
use flank_export::shape::Node;
use flank_export::vector::Vector;

const DETAIL: Detail = Detail { smooth: 8, grid_spacing: f64::INFINITY, grid_width: 0.5, border_width: 1.0 };

/// Smaller cells nobody sees.
const CELLS: usize = 24;

/// A patch this small on the sheet gets a ring around it.
const SMALL: f64 = 14.0;

/// An arc around the axis z: radius and height, mm; middle and half its angle, radians.
struct Arc {
    radius: f64,
    height: f64,
    middle: f64,
    half: f64,
}

/// Draws the inset in a thin frame.
pub(super) fn draw(drawn: &[&Drawn<'_>], nodes: &[Node], camera: Camera, rect: Rect, sheet: &mut Sheet) {
    let title = draw_frame(rect, sheet);
    let arcs = arcs(nodes);
    let (low, high) = axis_ends(nodes);
    let mut points: Vec<Vector> = nodes.iter().map(|node| node.position).collect();
    points.extend([[0.0, 0.0, low], [0.0, 0.0, high]]);
    points.extend(arcs.iter().flat_map(Arc::points));
    let inner = Rect { top: rect.top + 34.0, ..rect }.shrunk(22.0);
    let view = View::fitting(camera, &points, Rect { top: inner.top - 16.0, ..inner });
    let mut layers = Layers::default();
    for arc in &arcs {
        arc.add(&view, &mut layers);
    }
    for drawn in drawn {
        add_mesh(&drawn.mesh.coarser(CELLS), palette::of_patch(drawn.number), &view, DETAIL, &mut layers);
    }
    let mut taken = Occupancy::new(rect.right, rect.bottom);
    taken.take(&title);
    layers.shapes().for_each(|shape| taken.take_shape(shape));
    axis::add_between(&view, low, high, &mut layers);
    let ends = [view.place([0.0, 0.0, low]), view.place([0.0, 0.0, high])];
    taken.take_line(ends);
    layers.into_items().for_each(|item| sheet.push(item));
    ring_if_small(nodes, &view, sheet);
    axis::label(ends, rect.shrunk(6.0), &mut taken, sheet);
}

/// Draws the frame and says where its title stands.
fn draw_frame(rect: Rect, sheet: &mut Sheet) -> Rect {
    let corners = [[rect.left, rect.top], [rect.right, rect.top], [rect.right, rect.bottom], [rect.left, rect.bottom]];
    sheet.polygon(&corners, palette::WHITE, FAINT, 1.0);
    let at = [rect.left + 12.0, rect.top + 21.0];
    let title = font::fitted("place about the z axis, true proportion", 13.0, rect.width() - 24.0);
    sheet.text(at, Anchor::Start, 13.0, GREY, &title)
}

/// The part of the axis that is shown: the heights of the patches and some more.
fn axis_ends(nodes: &[Node]) -> (f64, f64) {
    let low = nodes.iter().map(|node| node.position[2]).fold(f64::MAX, f64::min);
    let high = nodes.iter().map(|node| node.position[2]).fold(f64::MIN, f64::max);
    let radius = nodes.iter().map(|node| radius(node.position)).fold(0.0, f64::max);
    let more = (0.45 * radius.max(high - low)).max(1.0);
    (low - more, high + more)
}

/// Arcs at the least and the greatest radius, over the angle of the patches and somewhat beyond.
fn arcs(nodes: &[Node]) -> Vec<Arc> {
    let least = nodes.iter().map(|node| radius(node.position)).fold(f64::MAX, f64::min);
    let most = nodes.iter().map(|node| radius(node.position)).fold(0.0, f64::max);
    // Of many points at the same radius, the lowest for the inner arc and the highest for the outer one: further apart.
    let near = |wanted: f64| move |node: &&Node| (radius(node.position) - wanted).abs() <= 1e-6 * most;
    let by_height = |a: &&Node, b: &&Node| a.position[2].total_cmp(&b.position[2]);
    let inner = nodes.iter().filter(near(least)).min_by(by_height);
    let outer = nodes.iter().filter(near(most)).max_by(by_height);
    let sum = nodes.iter().fold([0.0; 2], |sum, node| [sum[0] + node.position[0], sum[1] + node.position[1]]);
    let middle = sum[1].atan2(sum[0]);
    let off = |node: &Node| (node.position[1].atan2(node.position[0]) - middle + 9.0 * PI).rem_euclid(2.0 * PI) - PI;
    let half = nodes.iter().map(|node| off(node).abs()).fold(0.0, f64::max);
    let half = (half + 0.9).min(PI);
    let arc = |node: &Node| Arc { radius: radius(node.position), height: node.position[2], middle, half };
    [inner, outer].into_iter().flatten().map(arc).filter(|arc| arc.radius > 0.0).collect()
}

fn radius(position: Vector) -> f64 {
    position[0].hypot(position[1])
}

impl Arc {
    fn points(&self) -> Vec<Vector> {
        let at = |step: i32| {
            let (sin, cos) = (self.middle + self.half * f64::from(step) / 32.0).sin_cos();
            [self.radius * cos, self.radius * sin, self.height]
        };
        (-32..=32).map(at).collect()
    }

    fn add(&self, view: &View, layers: &mut Layers) {
        for pair in self.points().windows(2) {
            let points = pair.iter().map(|&point| view.place(point)).collect();
            layers.push(view.depth(pair[0]), Item::Line { points, colour: GREY, width: 1.0 });
        }
    }
}

/// A patch of a few pixels is lost on a large gear.
fn ring_if_small(nodes: &[Node], view: &View, sheet: &mut Sheet) {
    let places: Vec<Place> = nodes.iter().map(|node| view.place(node.position)).collect();
    let range = |k: usize| {
        let low = places.iter().map(|place| place[k]).fold(f64::MAX, f64::min);
        (low, places.iter().map(|place| place[k]).fold(f64::MIN, f64::max))
    };
    let ((left, right), (top, bottom)) = (range(0), range(1));
    if (right - left).max(bottom - top) < SMALL {
        let middle = [0.5 * (left + right), 0.5 * (top + bottom)];
        let at = |step: i32| {
            let (sin, cos) = (2.0 * PI * f64::from(step) / 36.0).sin_cos();
            [middle[0] + SMALL * cos, middle[1] + SMALL * sin]
        };
        let ring: Vec<Place> = (0..=36).map(at).collect();
        sheet.line(&ring, INK, 1.2);
    }
}
