//! Numbers over grids, side by side: a map for each field that is asked for.

use super::figure::{self, Figure, MARGIN};
use super::font;
use super::levels::Levels;
use super::paint::{Anchor, Place, Rect, Sheet};
use super::palette::{self, GREY, INK, RED, WHITE};
use crate::conventions::one_line;
use crate::dataset::{Dataset, Field, Patch, Values};
use crate::number::levelled;

/// Cells that a map is painted in at least, up and across; a finer grid has one for each of its points, down to a least side.
const CELLS: [usize; 2] = [60, 90];
const LEAST_SIDE: f64 = 3.0;
const GAP: f64 = 40.0;
/// Above a map: its name and the line below it; below it: the key.
const HEAD: f64 = 50.0;
const FOOT: f64 = 44.0;
const KEY: f64 = 12.0;

/// One map.
struct Panel<'a> {
    patch: &'a Patch,
    field: &'a Field,
    values: &'a [Option<f64>],
    levels: Option<Levels>,
}

/// Arranges the maps of fields of numbers on a sheet of this size; fields of vectors are left out.
pub(super) fn compose(dataset: &Dataset, title: &str, shown: &[(usize, usize)], note: &str, size: [f64; 2]) -> Figure {
    let [width, height] = size;
    let title = one_line(title);
    let mut sheet = Sheet::default();
    figure::write_title(&title, dataset, width - 2.0 * MARGIN, &mut sheet);
    let panels: Vec<Panel<'_>> = shown.iter().filter_map(|&(patch, field)| Panel::of(dataset, patch, field)).collect();
    let area = Rect { left: MARGIN, top: 118.0, right: width - MARGIN, bottom: height - 92.0 };
    if panels.is_empty() {
        sheet.text(area.middle(), Anchor::Middle, 20.0, GREY, "nothing to draw");
    }
    for (panel, rect) in panels.iter().zip(places(panels.len(), area)) {
        panel.draw(rect, &mut sheet);
    }
    let caption = one_line(note);
    figure::write_caption(&caption, [width, height], &mut sheet);
    Figure { title, caption, items: sheet.items }
}

/// Equal rectangles, row by row, as near to landscape as their number allows.
fn places(count: usize, area: Rect) -> impl Iterator<Item = Rect> {
    let across = [(1, 1), (4, 2), (9, 3)].iter().find(|(most, _)| count <= *most).map_or(4, |(_, across)| *across);
    let down = count.div_ceil(across).max(1);
    let width = (area.width() + GAP) / across as f64 - GAP;
    let height = (area.height() + GAP) / down as f64 - GAP;
    (0..count).map(move |k| {
        let left = area.left + (k % across) as f64 * (width + GAP);
        let top = area.top + (k / across) as f64 * (height + GAP);
        Rect { left, top, right: left + width, bottom: top + height }
    })
}

impl<'a> Panel<'a> {
    fn of(dataset: &'a Dataset, patch: usize, field: usize) -> Option<Panel<'a>> {
        let patch = dataset.patches.get(patch)?;
        let field = patch.fields.get(field)?;
        let Values::Scalars(values) = &field.values else { return None };
        let count = patch.rows.count.checked_mul(patch.columns.count);
        let sound = count == Some(values.len()) && count == Some(patch.points.len());
        let known = || values.iter().zip(&patch.points).filter(|(_, point)| point.is_solved()).filter_map(|(v, _)| *v);
        sound.then(|| Panel { patch, field, values, levels: Levels::over(known()) })
    }

    fn draw(&self, rect: Rect, sheet: &mut Sheet) {
        let (room, left) = (rect.width(), rect.left);
        let name = one_line(&self.field.name);
        let size = (17.0 * room / font::width(&name, 17.0)).clamp(12.0, 17.0);
        sheet.text([left, rect.top + 15.0], Anchor::Start, size, INK, &font::fitted(&name, size, room));
        let about = font::fitted(&self.about(), 13.0, room);
        sheet.text([left, rect.top + 35.0], Anchor::Start, 13.0, GREY, &about);
        let map = Rect { top: rect.top + HEAD, bottom: rect.bottom - FOOT, ..rect };
        match &self.levels {
            Some(levels) => {
                self.draw_bands(levels, map, sheet);
                self.draw_missing(map, sheet);
                if let [low, high] = levels.bounds()[..] {
                    let text =
                        format!("all between {} and {}", levelled(low, levels.step()), levelled(high, levels.step()));
                    sheet.text(map.middle(), Anchor::Middle, 15.0, WHITE, &text);
                }
                draw_key(levels, Rect { top: map.bottom + 8.0, bottom: map.bottom + 8.0 + KEY, ..map }, sheet);
            }
            None => {
                sheet.text(map.middle(), Anchor::Middle, 15.0, GREY, "no point has a value");
            }
        }
        let frame = corners(map);
        sheet.line(&[frame[0], frame[1], frame[2], frame[3], frame[0]], INK, 1.0);
    }

    /// The unit, and what the two sides are.
    fn about(&self) -> String {
        let [rows, columns] = [&self.patch.rows, &self.patch.columns].map(|axis| one_line(&axis.label));
        let arrows = |label: String| label.replace("->", "\u{2192}");
        format!("{}; up: {}, right: {}", one_line(&self.field.unit), arrows(rows), arrows(columns))
    }

    fn value(&self, i: usize, j: usize) -> Option<f64> {
        let at = i * self.patch.columns.count + j;
        self.values[at].filter(|value| value.is_finite() && self.patch.points[at].is_solved())
    }

    /// The value between four points of the grid, at shares of its sides; `None` if one of them has none.
    fn between(&self, up: f64, right: f64) -> Option<f64> {
        let along = |share: f64, count: usize| {
            let at = share * count.saturating_sub(1) as f64;
            let from = (at.floor() as usize).min(count.saturating_sub(2));
            (from, (from + 1).min(count - 1), at - from as f64)
        };
        let (i, above, v) = along(up, self.patch.rows.count);
        let (j, beside, u) = along(right, self.patch.columns.count);
        let mix = |a: f64, b: f64, share: f64| a + share * (b - a);
        let lower = mix(self.value(i, j)?, self.value(i, beside)?, u);
        Some(mix(lower, mix(self.value(above, j)?, self.value(above, beside)?, u), v))
    }

    /// Bands of colour, in rows of cells so fine that their steps are small; neighbours of one colour are one shape.
    fn draw_bands(&self, levels: &Levels, map: Rect, sheet: &mut Sheet) {
        let cells = |points: usize, room: f64, least: usize| points.min((room / LEAST_SIDE) as usize).max(least);
        let rows = cells(self.patch.rows.count, map.height(), CELLS[0]);
        let columns = cells(self.patch.columns.count, map.width(), CELLS[1]);
        let place = |i: usize, j: usize| -> Place {
            let share = [j as f64 / columns as f64, i as f64 / rows as f64];
            [map.left + share[0] * map.width(), map.bottom - share[1] * map.height()]
        };
        let middle = |k: usize, count: usize| (k as f64 + 0.5) / count as f64;
        let value = |i: usize, j: usize| self.between(middle(i, rows), middle(j, columns));
        for i in 0..rows {
            let shares: Vec<Option<f64>> = (0..columns).map(|j| Some(levels.share(value(i, j)?))).collect();
            let mut from = 0;
            for run in shares.chunk_by(|a, b| a == b) {
                let to = from + run.len();
                if let Some(share) = run[0] {
                    let colour = palette::of_share(share);
                    let corners = [place(i, from), place(i, to), place(i + 1, to), place(i + 1, from)];
                    sheet.polygon(&corners, colour, colour, 1.0);
                }
                from = to;
            }
        }
        // where the sign changes
        let is_negative = |i: usize, j: usize| value(i, j).map(|value| value < 0.0);
        let differ = |a: Option<bool>, b: Option<bool>| a.zip(b).is_some_and(|(a, b)| a != b);
        for (i, j) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
            if j + 1 < columns && differ(is_negative(i, j), is_negative(i, j + 1)) {
                sheet.line(&[place(i, j + 1), place(i + 1, j + 1)], INK, 2.0);
            }
            if i + 1 < rows && differ(is_negative(i, j), is_negative(i + 1, j)) {
                sheet.line(&[place(i + 1, j), place(i + 1, j + 1)], INK, 2.0);
            }
        }
    }

    /// A red cross at each point without a value; not all of them where they are many.
    fn draw_missing(&self, map: Rect, sheet: &mut Sheet) {
        let [rows, columns] = [self.patch.rows.count, self.patch.columns.count];
        let every = |count: usize, most: usize| count.div_ceil(most).max(1);
        let share = |k: usize, count: usize| if count > 1 { k as f64 / (count - 1) as f64 } else { 0.5 };
        for i in (0..rows).step_by(every(rows, CELLS[0])) {
            for j in (0..columns).step_by(every(columns, CELLS[1])).filter(|&j| self.value(i, j).is_none()) {
                let [x, y] = [map.left + share(j, columns) * map.width(), map.bottom - share(i, rows) * map.height()];
                sheet.line(&[[x - 3.0, y - 3.0], [x + 3.0, y + 3.0]], RED, 1.2);
                sheet.line(&[[x - 3.0, y + 3.0], [x + 3.0, y - 3.0]], RED, 1.2);
            }
        }
    }
}

/// What the colours mean: bands with the numbers between them, as many as there is room for.
fn draw_key(levels: &Levels, key: Rect, sheet: &mut Sheet) {
    let bounds = levels.bounds();
    let bands = bounds.len() - 1;
    let place = |k: usize| key.left + key.width() * k as f64 / bands as f64;
    for (band, pair) in bounds.windows(2).enumerate() {
        let rect = Rect { left: place(band), right: place(band + 1), ..key };
        let colour = palette::of_share(levels.share(0.5 * (pair[0] + pair[1])));
        sheet.polygon(&corners(rect), colour, colour, 0.4);
    }
    let frame = corners(key);
    sheet.line(&[frame[0], frame[1], frame[2], frame[3], frame[0]], INK, 0.8);
    let texts: Vec<String> = bounds.iter().map(|bound| levelled(*bound, levels.step())).collect();
    let widest = texts.iter().map(|text| font::width(text, 12.0)).fold(0.0, f64::max) + 10.0;
    let every = (widest * bands as f64 / key.width()).ceil().max(1.0) as usize;
    // counted from zero, if it is there: its number is never left out
    let first = bounds.iter().position(|bound| *bound == 0.0).unwrap_or(0) % every;
    for (k, text) in texts.iter().enumerate().skip(first).step_by(every) {
        let width = if bounds[k] == 0.0 { 2.0 } else { 0.8 };
        sheet.line(&[[place(k), key.top], [place(k), key.bottom + 4.0]], INK, width);
        let half = 0.5 * font::width(text, 12.0);
        let middle = place(k).clamp(key.left + half - 4.0, key.right - half + 4.0);
        sheet.text([middle, key.bottom + 17.0], Anchor::Middle, 12.0, INK, text);
    }
}

fn corners(rect: Rect) -> [Place; 4] {
    [[rect.left, rect.top], [rect.right, rect.top], [rect.right, rect.bottom], [rect.left, rect.bottom]]
}
