//! The list of patches: colour, name, dimensions.

use super::figure::Drawn;
use super::font;
use super::paint::{Anchor, Colour, Rect, Sheet};
use super::palette::{self, GREY, INK};
use flank_export::Patch;
use flank_export::Tally;
use flank_export::shape::node;
use flank_export::text::dimension;
use flank_export::text::one_line;
use flank_export::vector::Vector;

/// From entry to entry, the roomiest first: with dimensions on two lines, on one, without them; sheet units.
const ENTRIES: [f64; 3] = [62.0, 33.0, 25.0];
const SWATCH: [f64; 2] = [24.0, 14.0];

/// Lists as many patches as there is room for, and says how many more there are.
pub(super) fn draw(drawn: &[Drawn<'_>], rect: Rect, sheet: &mut Sheet) {
    let room = |entry: f64| (rect.height() / entry).floor().max(1.0) as usize;
    let fitting = (0..ENTRIES.len() - 1).find(|at| room(ENTRIES[*at]) >= drawn.len()).unwrap_or(ENTRIES.len() - 1);
    let (entry, lines) = (ENTRIES[fitting], ENTRIES.len() - 1 - fitting);
    let shown = if drawn.len() > room(entry) { room(entry) - 1 } else { drawn.len() };
    let several_frames = drawn.windows(2).any(|pair| pair[0].patch.frame != pair[1].patch.frame);
    for (line, drawn) in drawn.iter().take(shown).enumerate() {
        let place = [rect.left, rect.top + entry * line as f64];
        draw_entry(drawn, several_frames, place, (rect.width(), lines), sheet);
    }
    if shown < drawn.len() {
        let rest = format!("and {} more surfaces", drawn.len() - shown);
        sheet.text([rect.left, rect.top + entry * shown as f64 + 13.0], Anchor::Start, 14.0, GREY, &rest);
    }
}

/// Lists names with their colours, as close as their number asks for.
pub(super) fn draw_names(names: impl ExactSizeIterator<Item = (Colour, String)>, rect: Rect, sheet: &mut Sheet) {
    let pitch = (rect.height() / names.len().max(1) as f64).clamp(15.0, 22.0);
    let most = (rect.height() / pitch).max(1.0) as usize;
    let count = names.len();
    let shown = if count > most { most.saturating_sub(1) } else { count };
    let left = rect.left + SWATCH[0] + 12.0;
    let size = 0.65 * pitch;
    let mut top = rect.top;
    for (colour, name) in names.take(shown) {
        let swatch = Rect { left: rect.left, top, right: rect.left + SWATCH[0], bottom: top + 0.65 * pitch };
        sheet.polygon(&swatch.corners(), colour, colour.towards(INK, 0.85), 1.2);
        let text = font::fitted(&name, size, rect.right - left);
        sheet.text([left, swatch.bottom - 0.1 * pitch], Anchor::Start, size, INK, &text);
        top += pitch;
    }
    if shown < count {
        let rest = format!("and {} more surfaces", count - shown);
        sheet.text([left, top + 0.55 * pitch], Anchor::Start, size, GREY, &rest);
    }
}

/// `lines` is on how many the dimensions stand below the name.
fn draw_entry(
    drawn: &Drawn<'_>,
    with_frame: bool,
    [left, top]: [f64; 2],
    (width, lines): (f64, usize),
    sheet: &mut Sheet,
) {
    let base = palette::of_patch(drawn.number);
    let (right, bottom) = (left + SWATCH[0], top + SWATCH[1]);
    let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
    sheet.polygon(&corners, base, base.towards(INK, 0.85), 1.4);
    let text_left = right + 12.0;
    let room = left + width - text_left;
    let name = one_line(&drawn.patch.name);
    let name = if with_frame { format!("{name} in {}", one_line(&drawn.patch.frame)) } else { name };
    let size = if lines > 1 { 17.0 } else { 15.0 };
    sheet.text([text_left, top + 13.0], Anchor::Start, size, INK, &font::fitted(&name, size, room));
    let dimensions = dimensions(drawn.patch);
    let texts =
        if lines == 1 { vec![dimensions.join(", ").replacen(" mm", "", dimensions.len() - 1)] } else { dimensions };
    for (line, text) in texts.iter().take(lines).enumerate() {
        let down = top + if lines > 1 { 32.0 + 17.0 * line as f64 } else { 27.0 };
        let size = (13.0 * room / font::width(text, 13.0)).clamp(10.0, if lines > 1 { 13.0 } else { 12.0 });
        sheet.text([text_left, down], Anchor::Start, size, GREY, &font::fitted(text, size, room));
    }
}

fn dimensions(patch: &Patch) -> Vec<String> {
    let positions: Vec<Vector> = patch.points.iter().filter_map(node).map(|node| node.position).collect();
    if positions.is_empty() {
        let tally = Tally::of_patches([patch]);
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
