//! The list of patches: colour, name, dimensions.

use super::figure::Drawn;
use super::font;
use super::mesh::node;
use super::paint::{Anchor, Rect, Sheet};
use super::palette::{self, GREY, INK};
use crate::conventions::one_line;
use crate::dataset::Patch;
use crate::number::dimension;
use crate::tally::Tally;
use crate::vector::Vector;

const ENTRY: f64 = 62.0;
const SWATCH: [f64; 2] = [24.0, 14.0];

/// Lists as many patches as there is room for, and says how many more there are.
pub(super) fn draw(drawn: &[Drawn<'_>], rect: Rect, sheet: &mut Sheet) {
    let room = (rect.height() / ENTRY).floor().max(1.0) as usize;
    let shown = if drawn.len() > room { room - 1 } else { drawn.len() };
    let several_frames = drawn.windows(2).any(|pair| pair[0].patch.frame != pair[1].patch.frame);
    for (line, drawn) in drawn.iter().take(shown).enumerate() {
        draw_entry(drawn, several_frames, [rect.left, rect.top + ENTRY * line as f64], rect.width(), sheet);
    }
    if shown < drawn.len() {
        let rest = format!("and {} more surfaces", drawn.len() - shown);
        sheet.text([rect.left, rect.top + ENTRY * shown as f64 + 13.0], Anchor::Start, 14.0, GREY, &rest);
    }
}

fn draw_entry(drawn: &Drawn<'_>, with_frame: bool, [left, top]: [f64; 2], width: f64, sheet: &mut Sheet) {
    let base = palette::of_patch(drawn.number);
    let (right, bottom) = (left + SWATCH[0], top + SWATCH[1]);
    let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
    sheet.polygon(&corners, base, base.towards(INK, 0.85), 1.4);
    let text_left = right + 12.0;
    let room = left + width - text_left;
    let name = one_line(&drawn.patch.name);
    let name = if with_frame { format!("{name} in {}", one_line(&drawn.patch.frame)) } else { name };
    sheet.text([text_left, top + 13.0], Anchor::Start, 17.0, INK, &font::fitted(&name, 17.0, room));
    for (line, text) in dimensions(drawn.patch).iter().enumerate() {
        let down = top + 32.0 + 17.0 * line as f64;
        sheet.text([text_left, down], Anchor::Start, 13.0, GREY, &font::fitted(text, 13.0, room));
    }
}

fn dimensions(patch: &Patch) -> Vec<String> {
    let positions: Vec<Vector> = patch.points.iter().filter_map(node).map(|node| node.position).collect();
    if positions.is_empty() {
        let tally = Tally::of([patch]);
        return vec![if tally.asked == 0 {
            "no points".into()
        } else {
            format!("none of {} points solved", tally.asked)
        }];
    }
    let range = |of: fn(&Vector) -> f64| {
        let low = positions.iter().map(of).fold(f64::MAX, f64::min);
        let high = positions.iter().map(of).fold(f64::MIN, f64::max);
        let (low, high) = (dimension(low), dimension(high));
        if low == high { format!("{low} mm") } else { format!("{low} to {high} mm") }
    };
    vec![format!("z {}", range(|p| p[2])), format!("radius {}", range(|p| p[0].hypot(p[1])))]
}
