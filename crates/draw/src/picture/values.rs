//! The values of a map in numbers, where some rows and columns of its grid meet.

use super::chart::{self, Chart};
use super::font;
use super::levels::Levels;
use super::maps::Panel;
use super::paint::{Anchor, Place, Sheet, text_rect};
use super::palette;
use flank_export::shape::rows_follow_profile;
use flank_export::text::levelled;

/// At so many places up and across.
const COUNTS: [usize; 2] = [5, 9];
const SIZE: f64 = 12.0;
/// Around a number, across and up.
const GAPS: [f64; 2] = [5.0, 5.0];

/// A value with where it stands among the lines that are shown, and on paper.
struct Number {
    line: [usize; 2],
    place: Place,
    value: f64,
    text: String,
}

/// Writes the values of a map that is filled with colours, if there is room.
pub(super) fn draw(panel: &Panel<'_>, chart: &Chart, levels: &Levels, sheet: &mut Sheet) {
    let lines = lines(panel);
    let numbers = numbers(panel, chart, &lines);
    let [[left, right], [top, bottom]] = chart::bounds(numbers.iter().map(|number| number.place));
    let widest = numbers.iter().map(|number| font::width(&number.text, SIZE)).fold(0.0, f64::max);
    let is_room = right - left > COUNTS[1] as f64 * (widest + 8.0) && bottom - top > COUNTS[0] as f64 * (SIZE + 6.0);
    if levels.single().is_some() || !is_room {
        return;
    }
    for number in &numbers {
        let [x, y] = inside(number, &lines, panel, chart);
        let at = [x, y + 0.35 * SIZE];
        let ground = levels.colour(levels.band(number.value));
        sheet.polygon(&text_rect(at, Anchor::Middle, SIZE, &number.text).corners(), ground, ground, 2.0);
        sheet.text(at, Anchor::Middle, SIZE, palette::on(ground), &number.text);
    }
}

/// Rows and columns that spread evenly over the grid, the outermost among them.
fn lines(panel: &Panel<'_>) -> [Vec<usize>; 2] {
    let picked = |count: usize, wanted: usize| {
        let parts = wanted.min(count).max(2) - 1;
        (0..=parts.min(count - 1)).map(|k| (2 * k * (count - 1) + parts) / (2 * parts)).collect()
    };
    let [up, across] = COUNTS;
    let by_rows = rows_follow_profile(panel.patch).unwrap_or(true);
    let wanted = if by_rows { [up, across] } else { [across, up] };
    [picked(panel.mesh.rows, wanted[0]), picked(panel.mesh.columns, wanted[1])]
}

fn numbers(panel: &Panel<'_>, chart: &Chart, lines: &[Vec<usize>; 2]) -> Vec<Number> {
    // three digits of the largest
    let grain = 0.01 * panel.values.iter().flatten().fold(0.0, |most: f64, value| most.max(value.abs()));
    let all = (0..lines[0].len()).flat_map(|k| (0..lines[1].len()).map(move |l| [k, l]));
    let number = |line: [usize; 2]| {
        let at = node(panel, lines, line)?;
        let value = panel.values[at]?;
        let place = chart.place(panel.projection.nodes[at]?);
        Some(Number { line, place, value, text: levelled(value, grain) })
    };
    all.filter_map(number).collect()
}

/// The number of a node of the mesh.
fn node(panel: &Panel<'_>, lines: &[Vec<usize>; 2], [k, l]: [usize; 2]) -> Option<usize> {
    Some(lines[0].get(k)? * panel.mesh.columns + lines[1].get(l)?)
}

/// Where a number stands: one on the border beside it, towards the next of its line.
fn inside(number: &Number, lines: &[Vec<usize>; 2], panel: &Panel<'_>, chart: &Chart) -> Place {
    let reach = [0.5 * font::width(&number.text, SIZE) + GAPS[0], 0.5 * SIZE + GAPS[1]];
    let mut place = number.place;
    for k in 0..2 {
        let [at, count] = [number.line[k], lines[k].len()];
        let next = match at {
            0 => 1,
            _ if at + 1 == count => at - 1,
            _ => continue,
        };
        let mut beside = number.line;
        beside[k] = next;
        let to = node(panel, lines, beside).and_then(|at| panel.projection.nodes[at]).map(|at| chart.place(at));
        let Some(to) = to else { continue };
        let way = [0, 1].map(|k| to[k] - number.place[k]);
        let far = (way[0].abs() / reach[0]).max(way[1].abs() / reach[1]);
        if far > 0.0 {
            place = [0, 1].map(|k| place[k] + way[k] / far);
        }
    }
    place
}
