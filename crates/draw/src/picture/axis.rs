//! The axis z, dash-dotted as in a drawing.

use super::camera::View;
use super::occupancy::Occupancy;
use super::paint::{Anchor, Item, Place, Rect, Sheet, clipped, text_rect};
use super::palette::{GREY, INK};
use super::surface::Layers;

const LABEL: &str = "z axis";
const SIZE: f64 = 14.0;

/// Dash, gap, dot, gap; sheet units.
const PATTERN: [f64; 4] = [16.0, 5.0, 2.0, 5.0];

/// No sheet is as long, in its own units; more dashes than that are not drawn.
const LONGEST: f64 = 1e6;

/// Adds the part of the axis that crosses a rectangle and says where it begins and ends; `None` where it does not cross,
/// or points to the eye.
pub(super) fn add_through(view: &View, rect: Rect, layers: &mut Layers) -> Option<[Place; 2]> {
    let reach = 2.0 * (rect.width() + rect.height()) / view.scale;
    let height = view.centre[2];
    let [low, high] = [height - reach, height + reach];
    let (from, to) = (view.place([0.0, 0.0, low]), view.place([0.0, 0.0, high]));
    let (start, end) = clipped(from, to, rect)?;
    let at = |t: f64| low + t * (high - low);
    let ends = [view.place([0.0, 0.0, at(start)]), view.place([0.0, 0.0, at(end)])];
    if distance(ends[0], ends[1]) < 60.0 {
        return None;
    }
    add_between(view, at(start), at(end), layers);
    Some(ends)
}

/// Adds the axis between two heights, mm.
pub(super) fn add_between(view: &View, low: f64, high: f64, layers: &mut Layers) {
    let (from, to) = (view.place([0.0, 0.0, low]), view.place([0.0, 0.0, high]));
    let length = distance(from, to);
    if length < PATTERN[0] {
        // Seen end on.
        layers.push(view.depth([0.0, 0.0, high]), Item::Line { points: vec![from, from], colour: INK, width: 5.0 });
        return;
    }
    if length > LONGEST {
        return;
    }
    let at = |along: f64| [0.0, 0.0, low + (high - low) * (along / length).min(1.0)];
    let mut along = 0.0;
    for (number, stroke) in PATTERN.iter().cycle().enumerate() {
        if along >= length {
            break;
        }
        if number % 2 == 0 {
            let points = vec![view.place(at(along)), view.place(at(along + stroke))];
            layers.push(view.depth(at(along)), Item::Line { points, colour: INK, width: 1.3 });
        }
        along += stroke;
    }
}

/// A place for the axis's name: the start of its base line, and the end of the axis it belongs to.
struct Candidate {
    place: Place,
    end: Place,
    cost: f64,
    /// Too far away to be understood without a line to the axis.
    led: bool,
}

/// Writes the axis's name near one of its ends, or in a corner of the rectangle with a thin line to it, wherever there is
/// most room.
pub(super) fn label(ends: [Place; 2], rect: Rect, taken: &mut Occupancy, sheet: &mut Sheet) {
    let [low, high] = ends;
    let near = [(high, low, 0.0), (low, high, 0.05)].into_iter().flat_map(|(end, other, dislike)| {
        let from = [0, 1].map(|k| end[k] + 0.06 * (other[k] - end[k]));
        nearby().into_iter().map(move |(anchor, [dx, dy])| {
            let covered = text_rect([from[0] + dx, from[1] + dy], anchor, SIZE, LABEL);
            Candidate { place: [covered.left, from[1] + dy], end, cost: dislike, led: false }
        })
    });
    let corners = corners(rect).into_iter().map(|place| {
        let end = if distance(place, low) < distance(place, high) { low } else { high };
        Candidate { place, end, cost: 0.12, led: true }
    });
    let mut best: Option<Candidate> = None;
    for mut candidate in near.chain(corners) {
        let covered = text_rect(candidate.place, Anchor::Start, SIZE, LABEL);
        candidate.cost += taken.share(&covered);
        let better = best.as_ref().is_none_or(|best| candidate.cost < best.cost - 1e-9);
        if rect.contains(&covered) && better {
            best = Some(candidate);
        }
    }
    if let Some(Candidate { place, end, led, .. }) = best {
        let covered = sheet.text(place, Anchor::Start, SIZE, INK, LABEL);
        if led {
            let [x, _] = covered.middle();
            let y = if end[1] < covered.top { covered.top - 2.0 } else { covered.bottom + 2.0 };
            sheet.line(&[[x, y], end], GREY, 0.8);
        }
        taken.take(&covered);
    }
}

/// Where the name may stand around a point.
fn nearby() -> Vec<(Anchor, Place)> {
    let mut offsets = Vec::new();
    for dy in [-10.0, 20.0, 5.0, -26.0, 36.0] {
        for (anchor, dx) in [(Anchor::Start, 10.0), (Anchor::Middle, 0.0), (Anchor::End, -10.0)] {
            offsets.push((anchor, [dx, dy]));
        }
    }
    offsets
}

/// Where the name starts in each corner of a rectangle.
fn corners(rect: Rect) -> [Place; 4] {
    let right = text_rect([rect.right - 4.0, 0.0], Anchor::End, SIZE, LABEL).left;
    let (left, top, bottom) = (rect.left + 4.0, rect.top + 16.0, rect.bottom - 8.0);
    [[right, bottom], [left, bottom], [right, top], [left, top]]
}

fn distance(a: Place, b: Place) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
