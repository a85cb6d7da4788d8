//! A machine as a kinematic diagram: frames, links and axes in space, and the chain as a list.

use std::f64::consts::TAU;

use super::calls::{self, Call};
use super::camera::{Camera, View};
use super::figure::{self, Figure, MARGIN};
use super::font;
use super::occupancy::{BODY, BORDER, LINE, Occupancy};
use super::paint::{Anchor, Colour, Item, Place, Rect, Sheet};
use super::palette::{FAINT, GREY, INK, RED};
use super::surface::{Detail, Layers, add_mesh};
use flank_export::shape::Mesh;
use flank_export::text::one_line;
use flank_export::text::with_minus;
use flank_export::vector::{Vector, add, cross, scale, unit};
use flank_export::{Header, Patch};

/// How wide the list is beside the diagram, and how high below it on a sheet that is higher than wide.
const COLUMN: f64 = 430.0;
const BELOW: f64 = 420.0;
const TOOL: Colour = Colour([196, 205, 214]);
const WORK: Colour = Colour([230, 159, 0]);
/// An axis that stands still.
const STILL: Colour = Colour([0, 90, 150]);
const DETAIL: Detail = Detail { smooth: 12, grid_spacing: f64::INFINITY, grid_width: 0.5, border_width: 0.9 };
/// Sheet units: the arrow of a linear axis, the ring of a rotary one, from the frame to the ring, a frame's axes.
const ARROW: f64 = 56.0;
const RING: f64 = 17.0;
const SHAFT: f64 = 46.0;
const TRIAD: f64 = 24.0;

/// A machine in one posture. Positions and directions are those in its root frame.
#[derive(Debug, Clone, PartialEq)]
pub struct MachineDrawing {
    /// Where it comes from.
    pub header: Header,
    /// The machine, as `m = cradle_generator`.
    pub name: String,
    /// In which posture, and what else is to be said; written below.
    pub note: String,
    /// Parents before children.
    pub frames: Vec<DrawnFrame>,
    /// Surfaces of the tool, and those of the work, which are drawn in front.
    pub tool: Vec<Patch>,
    /// Surfaces of the work.
    pub work: Vec<Patch>,
}

/// A frame of a machine.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnFrame {
    /// Its name.
    pub name: String,
    /// Index of the frame that it hangs on; none for the root.
    pub parent: Option<usize>,
    /// Its origin, mm.
    pub origin: [f64; 3],
    /// Its axes x, y, z: unit vectors.
    pub axes: [[f64; 3]; 3],
    /// What leads to it from its parent, in this order.
    pub links: Vec<MachineLink>,
}

/// A joint, or a transform that stands still.
#[derive(Debug, Clone, PartialEq)]
pub struct MachineLink {
    /// What it does.
    pub kind: LinkKind,
    /// The letter of an axis; the name of a setting, or what a number is along.
    pub name: String,
    /// Whether it moves while the surface is made.
    pub moves: bool,
    /// Along or about what, such as `along z`.
    pub direction_name: String,
    /// Its value in this posture with its unit.
    pub value: String,
    /// Where it begins, mm.
    pub origin: [f64; 3],
    /// Along or about which it goes: a unit vector.
    pub direction: [f64; 3],
    /// How far the next one is from here, mm.
    pub step: [f64; 3],
}

/// What a link does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinkKind {
    /// An axis that slides.
    Linear,
    /// An axis that turns.
    Rotary,
    /// A distance that stands still.
    Shift,
    /// An angle that stands still.
    Turn,
    /// A mirror.
    Mirror,
}

/// Arranges diagram and list on a sheet of this size.
pub(super) fn compose(machine: &MachineDrawing, [width, height]: [f64; 2]) -> Figure {
    let title = format!("{}: machine {}", one_line(&machine.header.job), one_line(&machine.name));
    let mut sheet = Sheet::default();
    figure::write_heading(&title, &machine.header, width - 2.0 * MARGIN, &mut sheet);
    let [right, bottom] = figure::useful(width, height);
    let whole = Rect { left: MARGIN, top: 118.0, right: right - MARGIN, bottom: bottom - 92.0 };
    let [main, list] = if height > width {
        let between = whole.bottom - BELOW;
        [Rect { bottom: between - 24.0, ..whole }, Rect { top: between, ..whole }]
    } else {
        let between = whole.right - COLUMN;
        [Rect { right: between - 24.0, ..whole }, Rect { left: between, ..whole }]
    };
    if machine.frames.is_empty() {
        sheet.text(main.middle(), Anchor::Middle, 20.0, GREY, "nothing to draw: the machine has no frame");
    } else {
        draw_space(machine, main, &mut sheet);
        draw_list(machine, list, &mut sheet);
    }
    let caption = with_minus(&one_line(&machine.note));
    figure::write_caption(&caption, [width, height], &mut sheet);
    Figure { title, caption, items: sheet.items }
}

/// The machine in space: bodies, links from frame to frame, frames, axes, and then their names where there is room.
fn draw_space(machine: &MachineDrawing, rect: Rect, sheet: &mut Sheet) {
    let meshes = |bodies: &[Patch]| bodies.iter().map(|body| Mesh::of_patch(body, 120)).collect::<Vec<Mesh>>();
    let [tool, work] = [&machine.tool, &machine.work].map(|bodies| meshes(bodies));
    let all = tool.iter().chain(&work);
    let of_bodies = all.flat_map(|mesh| mesh.nodes.iter().flatten().map(|node| node.position));
    let points: Vec<Vector> = machine.frames.iter().map(|frame| frame.origin).chain(of_bodies).collect();
    let camera = Camera::isometric();
    let view = View::fitting(camera, &points, rect.shrunk(SHAFT + RING + 34.0));
    let mut taken = Occupancy::new(rect.right, rect.bottom);
    for (bodies, colour) in [(&tool, TOOL), (&work, WORK)] {
        let mut layers = Layers::default();
        bodies.iter().for_each(|mesh| add_mesh(mesh, colour, &view, DETAIL, &mut layers));
        for shape in layers.shapes() {
            taken.take_shape_as(if shape.len() > 2 { BODY } else { BORDER }, shape);
        }
        layers.into_items().for_each(|item| sheet.push(item));
    }
    let mut calls = draw_links(machine, &view, &mut taken, sheet);
    calls.extend(draw_frames(machine, &view, &mut taken, sheet));
    calls.extend(draw_axes(machine, &view, &mut taken, sheet));
    calls::write(calls, rect, &mut taken, sheet);
}

/// Lines from frame to frame; distances that stand still carry their names.
fn draw_links(machine: &MachineDrawing, view: &View, taken: &mut Occupancy, sheet: &mut Sheet) -> Vec<Call> {
    let mut calls = Vec::new();
    for link in machine.frames.iter().flat_map(|frame| &frame.links) {
        let [from, to] = [view.place(link.origin), view.place(add(link.origin, link.step))];
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        if length < 2.0 {
            continue;
        }
        sheet.line(&[from, to], GREY, if link.kind == LinkKind::Linear { 5.0 } else { 2.6 });
        taken.take_line([from, to]);
        let middle = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
        if link.kind == LinkKind::Shift && length > 12.0 {
            calls.push(Call {
                at: middle,
                text: one_line(&link.name),
                size: 12.0,
                colour: INK,
                rank: 2,
                farthest: f64::INFINITY,
            });
        }
    }
    calls
}

/// Axes of all frames; those at one place share a name.
fn draw_frames(machine: &MachineDrawing, view: &View, taken: &mut Occupancy, sheet: &mut Sheet) -> Vec<Call> {
    let mut places: Vec<(Place, String)> = Vec::new();
    let (mut taken_by_triads, mut letters) = (Vec::new(), Vec::new());
    for (number, frame) in machine.frames.iter().enumerate() {
        let at = view.place(frame.origin);
        let same = |place: &Place| (place[0] - at[0]).hypot(place[1] - at[1]) < 6.0;
        match places.iter_mut().find(|(place, _)| same(place)) {
            Some((_, names)) => *names += &format!(" \u{b7} {}", one_line(&frame.name)),
            None => places.push((at, one_line(&frame.name))),
        }
        let is_last = !machine.frames.iter().any(|other| other.parent == Some(number));
        let is_clear = taken_by_triads.iter().all(|other: &Place| (other[0] - at[0]).hypot(other[1] - at[1]) > TRIAD);
        if (is_last || frame.parent.is_none()) && is_clear {
            taken_by_triads.push(at);
            letters.extend(draw_triad(frame, view, taken, sheet));
        }
        sheet.line(&[at, at], INK, 8.0);
        taken.take_as(LINE, &around(at, 5.0));
    }
    let names = places.into_iter().map(|(at, text)| Call {
        at,
        text,
        size: 14.0,
        colour: INK,
        rank: 1,
        farthest: f64::INFINITY,
    });
    letters.into_iter().chain(names).collect()
}

/// The three directions of a frame, and calls for their letters.
fn draw_triad(frame: &DrawnFrame, view: &View, taken: &mut Occupancy, sheet: &mut Sheet) -> Vec<Call> {
    let from = view.place(frame.origin);
    let arm = |(axis, name): (&Vector, &str)| {
        let [right, up, _] = view.camera.seen(*axis);
        let tip = [from[0] + TRIAD * right, from[1] - TRIAD * up];
        sheet.line(&[from, tip], INK, 1.8);
        taken.take_line([from, tip]);
        Call { at: tip, text: name.to_owned(), size: 12.0, colour: GREY, rank: 3, farthest: 16.0 }
    };
    frame.axes.iter().zip(["x", "y", "z"]).map(arm).collect()
}

/// Axes: an arrow with two heads along what slides, a ring with an arrow about what turns. Those about one line stand one behind
/// the other.
fn draw_axes(machine: &MachineDrawing, view: &View, taken: &mut Occupancy, sheet: &mut Sheet) -> Vec<Call> {
    let mut calls = Vec::new();
    let mut placed: Vec<(Place, Place)> = Vec::new();
    let axes = machine.frames.iter().flat_map(|frame| &frame.links);
    for link in axes.filter(|link| matches!(link.kind, LinkKind::Linear | LinkKind::Rotary)) {
        let at = view.place(add(link.origin, scale(0.5, link.step)));
        let [right, up, _] = view.camera.seen(link.direction);
        let along = [right, -up];
        let same = |(place, other): &&(Place, Place)| {
            (place[0] - at[0]).hypot(place[1] - at[1]) < 20.0 && (other[0] * along[1] - other[1] * along[0]).abs() < 0.3
        };
        let before = placed.iter().filter(same).count();
        placed.push((at, along));
        let colour = of_axis(link);
        let start = SHAFT * (1.0 + 0.8 * before as f64);
        let place = |by: f64| [at[0] + by * along[0], at[1] + by * along[1]];
        let end = if link.kind == LinkKind::Rotary {
            let ring = draw_ring(link.direction, place(start), colour, view, sheet);
            ring.windows(2).for_each(|pair| taken.take_line([pair[0], pair[1]]));
            let shaft = [place(-0.6 * SHAFT), place(start + 10.0)];
            sheet.dashes(&shaft, [9.0, 4.0], colour, 1.2);
            taken.take_line(shaft);
            place(start)
        } else {
            let (from, to) = if before == 0 { (-0.5 * ARROW, 0.5 * ARROW) } else { (start, start + ARROW) };
            draw_arrow([place(from), place(to)], colour, sheet);
            for end in [from, to] {
                taken.take_as(LINE, &around(place(end), 8.0));
            }
            taken.take_line([place(from), place(to)]);
            place(to)
        };
        let text = one_line(&link.name);
        calls.push(Call { at: end, text, size: 16.0, colour, rank: 0, farthest: f64::INFINITY });
    }
    calls
}

fn of_axis(link: &MachineLink) -> Colour {
    if link.moves { RED } else { STILL }
}

fn draw_arrow([from, to]: [Place; 2], colour: Colour, sheet: &mut Sheet) {
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    if length < 4.0 {
        // end on: it slides towards the eye
        sheet.line(&[from, from], colour, 9.0);
        return;
    }
    let along = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
    sheet.line(&[from, to], colour, 2.4);
    sheet.arrow_head([to[0] + 6.0 * along[0], to[1] + 6.0 * along[1]], along, 12.0, colour);
    sheet.arrow_head([from[0] - 6.0 * along[0], from[1] - 6.0 * along[1]], along.map(|x| -x), 12.0, colour);
}

/// Draws most of a circle about the axis, right-handed, and says where it runs.
fn draw_ring(axis: Vector, at: Place, colour: Colour, view: &View, sheet: &mut Sheet) -> Vec<Place> {
    let aside = if axis[2].abs() < 0.9 { [0.0, 0.0, 1.0] } else { [1.0, 0.0, 0.0] };
    let Some(first) = unit(cross(axis, aside)) else { return Vec::new() };
    let second = cross(axis, first);
    let place = |angle: f64| {
        let (sin, cos) = angle.sin_cos();
        let [right, up, _] = view.camera.seen(add(scale(cos, first), scale(sin, second)));
        [at[0] + RING * right, at[1] - RING * up]
    };
    let points: Vec<Place> = (0..=40).map(|k| place(0.8 * TAU * f64::from(k) / 40.0)).collect();
    sheet.line(&points, colour, 2.4);
    let (tip, before) = (points[40], points[38]);
    let length = (tip[0] - before[0]).hypot(tip[1] - before[1]).max(1e-9);
    let along = [(tip[0] - before[0]) / length, (tip[1] - before[1]) / length];
    let head = [tip[0] + 7.0 * along[0], tip[1] + 7.0 * along[1]];
    sheet.arrow_head(head, along, 12.0, colour);
    points.into_iter().chain([head]).collect()
}

/// A square about a place.
fn around([x, y]: Place, half: f64) -> Rect {
    Rect { left: x - half, top: y - half, right: x + half, bottom: y + half }
}

/// The chain, frame by frame: each with its parent and what leads to it.
fn draw_list(machine: &MachineDrawing, rect: Rect, sheet: &mut Sheet) {
    let lines: usize = machine.frames.iter().map(|frame| 1 + frame.links.len()).sum();
    let pitch = ((rect.height() - 30.0) / (lines as f64 + 0.4 * machine.frames.len() as f64)).min(22.0);
    let size = (0.68 * pitch).clamp(6.0, 14.0);
    let heading = "what leads to each frame; axes: red moving, blue standing still";
    sheet.text([rect.left, rect.top + 6.0], Anchor::Start, 12.0, GREY, &font::fitted(heading, 12.0, rect.width()));
    let columns = [rect.left + 34.0, rect.left + 0.58 * rect.width(), rect.right];
    let mut down = rect.top + 14.0 + pitch;
    for frame in &machine.frames {
        let parent = frame.parent.map_or("stands still".to_owned(), |at| format!("in {}", machine.frames[at].name));
        let name = format!("{} {}", one_line(&frame.name), one_line(&parent));
        sheet.text([rect.left, down], Anchor::Start, size, INK, &font::fitted(&name, size, rect.width()));
        down += pitch;
        for link in &frame.links {
            let is_axis = matches!(link.kind, LinkKind::Linear | LinkKind::Rotary);
            let colour = if is_axis { of_axis(link) } else { GREY };
            draw_symbol(link.kind, [rect.left + 18.0, down - 0.35 * size], (0.5 * size, colour), sheet);
            let name = if link.name.is_empty() { "fixed" } else { &link.name };
            let name = font::fitted(&one_line(name), size, columns[1] - columns[0] - 8.0);
            sheet.text([columns[0], down], Anchor::Start, size, colour, &name);
            sheet.text([columns[1], down], Anchor::Start, size, colour, &one_line(&link.direction_name));
            sheet.text([columns[2], down], Anchor::End, size, INK, &with_minus(&one_line(&link.value)));
            down += pitch;
        }
        sheet.line(&[[rect.left, down - 0.75 * pitch], [rect.right, down - 0.75 * pitch]], FAINT, 0.6);
        down += 0.4 * pitch;
    }
}

/// The sign of a kind of link: arrow, ring, dimension line, angle.
fn draw_symbol(kind: LinkKind, [x, y]: Place, (half, colour): (f64, Colour), sheet: &mut Sheet) {
    match kind {
        LinkKind::Linear => {
            sheet.line(&[[x - half, y], [x + half, y]], colour, 1.6);
            sheet.arrow_head([x + half + 3.0, y], [1.0, 0.0], 6.0, colour);
            sheet.arrow_head([x - half - 3.0, y], [-1.0, 0.0], 6.0, colour);
        }
        LinkKind::Rotary => {
            let at = |k: i32| {
                let (sin, cos) = (0.8 * TAU * f64::from(k) / 24.0).sin_cos();
                [x + half * cos, y + half * sin]
            };
            let ring: Vec<Place> = (0..=24).map(at).collect();
            sheet.line(&ring, colour, 1.6);
            let [from, to] = [ring[22], ring[24]];
            let length = (to[0] - from[0]).hypot(to[1] - from[1]).max(1e-9);
            sheet.arrow_head(to, [(to[0] - from[0]) / length, (to[1] - from[1]) / length], 6.0, colour);
        }
        LinkKind::Shift => {
            sheet.line(&[[x - half, y], [x + half, y]], colour, 1.0);
            for end in [x - half, x + half] {
                sheet.line(&[[end, y - 4.0], [end, y + 4.0]], colour, 1.0);
            }
        }
        LinkKind::Turn => {
            sheet.line(&[[x + half, y + half], [x - half, y + half], [x + 0.6 * half, y - half]], colour, 1.0);
        }
        LinkKind::Mirror => {
            sheet.push(Item::Line { points: vec![[x, y - half], [x, y + half]], colour, width: 1.0 });
            for side in [-half, half] {
                sheet.line(&[[x + side, y - 0.5 * half], [x + side, y + 0.5 * half]], colour, 1.0);
            }
        }
    }
}
