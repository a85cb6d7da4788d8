//! Numbers over flanks, side by side: a panel for each field that is asked for. Maps lie flat, lines and reliefs in the axial plane.

use super::chart::{self, Chart, Title};
use super::contours::ValueGrid;
use super::figure::{self, Figure, MARGIN};
use super::font;
use super::labels::{self, Border};
use super::levels::{BANDS, LINES, Levels};
use super::missing;
use super::occupancy::Occupancy;
use super::paint::{Anchor, Place, Rect, Sheet, text_rect};
use super::palette::{GREY, INK, PALE, WHITE};
use super::projection::{Projection, middle};
use super::relief;
use super::values;
use flank_export::shape::{Mesh, node};
use flank_export::text::one_line;
use flank_export::text::{dimension, levelled, shown_unit, with_minus};
use flank_export::{Dataset, Field, Patch, Values};

/// A grid is drawn in at least so many cells, up and across, and in at most so many.
const CELLS: [usize; 2] = [40, 60];
const MOST_CELLS: usize = 200;
/// A relief has cells that lie behind each other, so it has fewer.
const MOST_OF_RELIEF: usize = 100;
pub(super) const GAP: f64 = 40.0;
/// Above a map: its name and the line below it; below it: the key.
const HEAD: f64 = 66.0;
const FOOT: f64 = 40.0;
const KEY: f64 = 12.0;
/// A map is drawn at least so wide and so high, where there is room.
const LEAST: f64 = 160.0;
/// A number of which all that it can change over a flank is so many units in the last place of 1 is rounding of the coordinates:
/// curvatures come out of some ten operations on derivatives, each good to one.
const UNITS_IN_LAST_PLACE: f64 = 64.0;
/// A height below what points are solved to is none, um.
const SOLVED_TO: f64 = 1e-6;
/// Times as large as across, z or the radius may be drawn upwards where a flank is long.
const STRETCHES: [f64; 5] = [10.0, 5.0, 3.0, 2.0, 1.0];
/// From line to line of what is said above a map.
const LINE: f64 = 18.0;

/// What a sheet of maps says.
pub(super) struct Words<'a> {
    pub(super) title: &'a str,
    pub(super) note: &'a str,
    /// What stands on the right above the first map, line by line.
    pub(super) numbers: &'a [String],
}

/// How the values of a field are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Style {
    /// Bands of colour with a key.
    Bands,
    /// The same, and one key for all values of a unit.
    BandsOfOneKey,
    /// Lines of equal values, each with its number.
    Lines,
    /// Heights above the grid, in bands of colour with a key.
    Relief,
}

/// One map.
pub(super) struct Panel<'a> {
    pub(super) patch: &'a Patch,
    pub(super) field: &'a Field,
    pub(super) mesh: Mesh,
    /// Values at the nodes of the mesh.
    pub(super) values: Vec<Option<f64>>,
    pub(super) levels: Option<Levels>,
    /// Whether all values are zero but for rounding; then they are taken as zero.
    is_rounding: bool,
    pub(super) projection: Projection,
    /// Whether it is as large as there is room, in either direction.
    fills: bool,
}

/// Arranges the maps of fields of numbers on a sheet of this size; fields of vectors are left out.
pub(super) fn compose(
    dataset: &Dataset,
    words: &Words<'_>,
    shown: &[(usize, usize)],
    (style, [width, height]): (Style, [f64; 2]),
) -> Figure {
    let title = one_line(words.title);
    let mut sheet = Sheet::default();
    figure::write_heading(&title, &dataset.header, width - 2.0 * MARGIN, &mut sheet);
    let mut panels: Vec<Panel<'_>> = shown.iter().filter_map(|at| Panel::of_field(dataset, *at, style)).collect();
    if style == Style::BandsOfOneKey {
        give_one_key(&mut panels);
    }
    let area = Rect { left: MARGIN, top: 118.0, right: width - MARGIN, bottom: height - 92.0 };
    if panels.is_empty() {
        sheet.text(area.middle(), Anchor::Middle, 20.0, GREY, "nothing to draw");
    }
    for (panel, rect) in panels.iter().zip(figure::places(panels.len(), area, GAP)) {
        panel.draw(rect, style, &mut sheet);
    }
    for (line, text) in words.numbers.iter().enumerate() {
        let at = [area.right, area.top + 15.0 + LINE * line as f64];
        sheet.text(at, Anchor::End, 14.0, INK, &with_minus(&one_line(text)));
    }
    let caption = with_minus(&caption(words.note, &panels));
    figure::write_caption(&caption, [width, height], &mut sheet);
    Figure { title, caption, items: sheet.items }
}

fn caption(note: &str, panels: &[Panel<'_>]) -> String {
    let thinned = panels.iter().filter_map(|panel| panel.mesh.thinned_from(panel.patch)).next();
    [Some(one_line(note)).filter(|note| !note.is_empty()), thinned].into_iter().flatten().collect::<Vec<_>>().join(" ")
}

/// Panels whose values have one unit get one key for all of them.
pub(super) fn give_one_key(panels: &mut [Panel<'_>]) {
    let of_unit = |unit: &str| {
        let values = panels.iter().filter(|panel| panel.field.unit == unit).flat_map(|panel| &panel.values);
        Levels::over(values.flatten().copied(), BANDS)
    };
    let levels: Vec<Option<Levels>> = panels.iter().map(|panel| of_unit(&panel.field.unit)).collect();
    panels.iter_mut().zip(levels).for_each(|(panel, levels)| panel.levels = levels);
}

impl<'a> Panel<'a> {
    fn of_field(dataset: &'a Dataset, (patch, field): (usize, usize), style: Style) -> Option<Panel<'a>> {
        Panel::of_patch(dataset.patches.get(patch)?, field, style)
    }

    pub(super) fn of_patch(patch: &'a Patch, field: usize, style: Style) -> Option<Panel<'a>> {
        let field = patch.fields.get(field)?;
        let Values::Scalars(values) = &field.values else { return None };
        let count = patch.rows.count.checked_mul(patch.columns.count);
        let sound = count == Some(values.len()) && count == Some(patch.points.len()) && count > Some(0);
        if !sound {
            return None;
        }
        let known = || values.iter().zip(&patch.points).filter(|(_, point)| point.is_solved()).filter_map(|(v, _)| v);
        let grain = grain(patch, field);
        let is_rounding = known().any(|value| value != 0.0) && known().all(|value| value.abs() <= grain);
        let taken = |value: f64| if is_rounding { 0.0 } else { value };
        let mesh = Mesh::of_patch(patch, if style == Style::Relief { MOST_OF_RELIEF } else { MOST_CELLS });
        let flat = Projection::laid_flat(patch, &mesh);
        // a surface without root and tip has neither length nor profile
        let has_profile = flat.words.iter().any(|(_, word)| word == "root" || word == "tip");
        let fills = has_profile && matches!(style, Style::Bands | Style::BandsOfOneKey);
        let projection = if fills { flat } else { Projection::of_patch(patch, &mesh) };
        let known_at =
            |at: usize| values.at(at).filter(|value| value.is_finite() && patch.points[at].is_solved()).map(taken);
        let picked = mesh.picked(patch).map(known_at).collect();
        Some(Panel {
            patch,
            field,
            values: picked,
            is_rounding,
            levels: Levels::over(known().map(taken), if style == Style::Lines { LINES } else { BANDS }),
            projection,
            fills,
            mesh,
        })
    }

    /// The same laid flat as the side of a tooth: its length to the right, its tip up.
    pub(super) fn laid_flat(self) -> Panel<'a> {
        Panel { projection: Projection::laid_flat(self.patch, &self.mesh), fills: false, ..self }
    }

    /// The same as large as there is room, in either direction.
    pub(super) fn filling(self) -> Panel<'a> {
        Panel { fills: true, ..self.laid_flat() }
    }

    /// Draws it.
    fn draw(&self, rect: Rect, style: Style, sheet: &mut Sheet) {
        let (room, left) = (rect.width(), rect.left);
        let name = one_line(&self.field.name);
        let size = (17.0 * room / font::width(&name, 17.0)).clamp(12.0, 17.0);
        sheet.text([left, rect.top + 15.0], Anchor::Start, size, INK, &font::fitted(&name, size, room));
        let map = Rect { top: rect.top + HEAD, ..rect };
        let key = Rect { top: rect.bottom - FOOT + 6.0, bottom: rect.bottom - FOOT + 6.0 + KEY, ..rect };
        let about = match (&self.levels, style) {
            (Some(levels), Style::Relief) => {
                relief::draw(self, levels, Rect { bottom: rect.bottom - FOOT, ..map }, sheet);
                draw_key(levels, &shown_unit(&self.field.unit), key, sheet);
                "heights above the grid".to_owned()
            }
            _ => {
                let below = if style == Style::Lines { 0.0 } else { FOOT };
                let chart = self.chart(Rect { bottom: rect.bottom - below, ..map });
                self.draw_on(&chart, style, sheet);
                if let Some(levels) =
                    self.levels.as_ref().filter(|levels| style != Style::Lines && levels.single() != Some(0.0))
                {
                    let top = chart.rect.bottom + chart::MARGINS[3] + 6.0;
                    let key = Rect { left: chart.rect.left, top, right: key.right, bottom: top + KEY };
                    draw_key(levels, &shown_unit(&self.field.unit), key, sheet);
                }
                self.about(&chart)
            }
        };
        let about = match style {
            Style::BandsOfOneKey => format!("{} on {}", one_line(&self.field.meaning), one_line(&self.patch.name)),
            _ => format!("{}, {}; {about}", one_line(&self.patch.name), shown_unit(&self.field.unit)),
        };
        sheet.text([left, rect.top + 35.0], Anchor::Start, 13.0, GREY, &font::fitted(&about, 13.0, room));
    }

    fn draw_on(&self, chart: &Chart, style: Style, sheet: &mut Sheet) {
        let titles = self.projection.titles.each_ref();
        chart.draw_axes(titles.map(|text| Title { text, numbered: self.projection.is_in_mm() }), sheet);
        let grid = self.grid(chart);
        match &self.levels {
            Some(levels) if levels.single() == Some(0.0) => {
                grid.silhouette(PALE, sheet);
                self.draw_border(&grid, 1.2, sheet);
            }
            Some(levels) if style == Style::Lines => self.draw_lines(&grid, levels, chart.rect, sheet),
            Some(levels) => {
                self.draw_bands(&grid, levels, sheet);
                values::draw(self, chart, levels, sheet);
            }
            None => {
                sheet.text(chart.rect.middle(), Anchor::Middle, 15.0, GREY, "no point has a value");
            }
        }
        if let Some(value) = self.levels.as_ref().and_then(Levels::single) {
            let text = match self.is_rounding {
                true => "0 within rounding".to_owned(),
                false => format!("{} everywhere", dimension(value)),
            };
            let known = self.projection.nodes.iter().flatten().map(|place| chart.place(*place)).collect::<Vec<Place>>();
            let ground = if style == Style::Lines || value == 0.0 { INK } else { WHITE };
            let [x, y] = middle(&known);
            let [[left, right], _] = chart::bounds(known.into_iter());
            let size = (15.0 * 0.6 * (right - left) / font::width(&text, 15.0)).clamp(11.0, 15.0);
            sheet.text([x, y + 5.0], Anchor::Middle, size, ground, &text);
        }
        if self.levels.is_some() {
            self.draw_missing(chart, sheet);
        }
        self.draw_words(chart, &mut Occupancy::new(chart.rect.right, chart.rect.bottom), sheet);
    }

    /// The axes, with room around the flank for words.
    pub(super) fn chart(&self, rect: Rect) -> Chart {
        let rect = rect.inside([chart::MARGINS[0], 0.0, 0.0, chart::MARGINS[3]]);
        let bounds = chart::bounds(self.projection.nodes.iter().flatten().copied());
        let widest = self.projection.words.iter().map(|(_, word)| font::width(word, labels::WORD)).fold(0.0, f64::max);
        let aside = (widest + 26.0).min(0.24 * rect.width());
        let above = 30.0_f64.min(0.2 * rect.height());
        let room = rect.inside([aside, above, aside, above]);
        if !self.projection.is_in_mm() || self.fills {
            return Chart::filling(room, bounds).moved_to(rect);
        }
        let [across, up] = bounds.map(|[low, high]| (high - low).max(1e-9));
        let fits = |stretch: &&f64| room.height() / (up * **stretch) >= 0.8 * room.width() / across;
        let stretch = STRETCHES.iter().find(fits).copied().unwrap_or(1.0);
        let inner = Chart::in_proportion(room, bounds, stretch);
        // no farther than words stand
        let wide = (inner.scale[0] * across + 2.0 * aside).clamp(LEAST.min(rect.width()), rect.width());
        let high = (inner.scale[1] * up + 2.0 * above).clamp(LEAST.min(rect.height()), rect.height());
        inner.moved_to(Rect { right: rect.left + wide, bottom: rect.top + high, ..rect })
    }

    /// How the flank is laid flat.
    pub(super) fn about(&self, chart: &Chart) -> String {
        let stretch = chart.scale[1] / chart.scale[0];
        if self.fills && self.projection.is_in_mm() {
            format!("laid flat, upwards {stretch:.1} times larger")
        } else if !self.projection.is_axial() {
            if self.projection.is_in_mm() {
                "laid by the lengths of rows and columns"
            } else {
                "laid by rows and columns"
            }
            .to_owned()
        } else if stretch > 1.5 {
            format!("in the axial plane, upwards {stretch:.0} times larger")
        } else {
            "in the axial plane".to_owned()
        }
    }

    pub(super) fn grid(&self, chart: &Chart) -> ValueGrid {
        self.grid_of(chart, |at| self.values[at])
    }

    /// Other values over the same nodes.
    pub(super) fn grid_of(&self, chart: &Chart, value: impl Fn(usize) -> Option<f64>) -> ValueGrid {
        let parts = [(self.mesh.rows, CELLS[0]), (self.mesh.columns, CELLS[1])]
            .map(|(count, least)| least.div_ceil(count.saturating_sub(1).max(1)).max(1));
        let node = |i: usize, j: usize| {
            let at = i * self.mesh.columns + j;
            Some((chart.place(self.projection.nodes[at]?), value(at)?))
        };
        ValueGrid::refined([self.mesh.rows, self.mesh.columns], node, parts)
    }

    /// Bands of colour, thin lines between them: dashed below zero, thick at zero.
    pub(super) fn draw_bands(&self, grid: &ValueGrid, levels: &Levels, sheet: &mut Sheet) {
        grid.fill(levels, sheet);
        let bounds = levels.bounds();
        for &level in bounds.iter().take(bounds.len() - 1).skip(1) {
            for line in grid.lines(level) {
                if level < 0.0 && levels.is_signed() {
                    sheet.dashes(&line, [5.0, 4.0], INK, 0.7);
                } else {
                    sheet.line(&line, INK, if level == 0.0 { 2.0 } else { 0.5 });
                }
            }
        }
        self.draw_border(grid, 1.2, sheet);
    }

    /// Lines of equal values on the pale flank, each with its number where there is room.
    fn draw_lines(&self, grid: &ValueGrid, levels: &Levels, rect: Rect, sheet: &mut Sheet) {
        let mut taken = Occupancy::new(rect.right, rect.bottom);
        grid.silhouette(PALE, sheet);
        self.draw_border(grid, 1.2, sheet);
        let lines: Vec<(f64, Vec<Place>)> = levels
            .bounds()
            .into_iter()
            .flat_map(|level| grid.lines(level).into_iter().map(move |line| (level, line)))
            .collect();
        for (_, line) in &lines {
            sheet.line(line, INK, 1.4);
        }
        for (level, line) in &lines {
            let text = levelled(*level, levels.step());
            let places =
                [0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8].map(|share| line[((line.len() - 1) as f64 * share) as usize]);
            let covered = |[x, y]: Place| text_rect([x, y + 5.0], Anchor::Middle, 13.0, &text);
            let free = |place: &Place| rect.contains(&covered(*place)) && taken.share(&covered(*place)) == 0.0;
            if let Some([x, y]) = places.into_iter().find(free) {
                let ground = covered([x, y]).shrunk(-2.0);
                sheet.polygon(&ground.corners(), WHITE, WHITE, 0.0);
                taken.take(&ground.shrunk(-6.0));
                sheet.text([x, y + 5.0], Anchor::Middle, 13.0, INK, &text);
            }
        }
    }

    pub(super) fn draw_border(&self, grid: &ValueGrid, width: f64, sheet: &mut Sheet) {
        grid.borders().iter().for_each(|side| sheet.line(side, INK, width));
    }

    /// A red cross at each point without a value; not all of them where they are many.
    fn draw_missing(&self, chart: &Chart, sheet: &mut Sheet) {
        let share = |k: usize, count: usize| if count > 1 { k as f64 / (count - 1) as f64 } else { 0.5 };
        let (rows, columns) = (self.mesh.rows, self.mesh.columns);
        let mut crosses = missing::Crosses::default();
        for (at, k) in self.mesh.picked(self.patch).enumerate().filter(|(at, _)| self.values[*at].is_none()) {
            let (i, j) = (k / self.patch.columns.count, k % self.patch.columns.count);
            let place = if self.projection.is_axial() {
                let known = node(&self.patch.points[k]).map(|node| node.position);
                known.or_else(|| missing::likely_position(self.patch, i, j)).and_then(|p| self.projection.place(p))
            } else {
                Some([share(at % columns, columns), share(at / columns, rows)])
            };
            if let Some(place) = place {
                crosses.draw(chart.place(place), sheet);
            }
        }
    }

    /// What the sides are, in words beside them.
    pub(super) fn draw_words(&self, chart: &Chart, taken: &mut Occupancy, sheet: &mut Sheet) {
        let all: Vec<Place> = self.projection.nodes.iter().flatten().map(|place| chart.place(*place)).collect();
        for (side, word) in &self.projection.words {
            let line = self.projection.side(*side).into_iter().filter_map(|at| self.projection.nodes[at]);
            let points: Vec<Place> = line.map(|place| chart.place(place)).collect();
            if let Some(border) = Border::new(points, &all) {
                labels::word_beside(&border, word, chart.rect, taken, sheet);
            }
        }
    }
}

/// What a value can be by rounding alone: a curvature that bends the patch by less than its coordinates are rounded is none, nor is a
/// product of curvatures that turns its normals by less than a direction is rounded. Zero where the unit has no such bound.
fn grain(patch: &Patch, field: &Field) -> f64 {
    let solved = patch.points.iter().filter(|point| point.is_solved());
    let size = solved.flat_map(|point| point.position).fold(0.0, |size: f64, x| size.max(x.abs()));
    let power = match field.unit.as_str() {
        "1/mm" => 1,
        "1/mm^2" => 2,
        "um" => return SOLVED_TO,
        _ => return 0.0,
    };
    // where nothing is away from the origin there is no curvature to bound
    if size == 0.0 {
        return 0.0;
    }
    UNITS_IN_LAST_PLACE * f64::EPSILON / size.powi(power)
}

/// What the colours mean: bands with the numbers between them, as many as there is room for, and the unit.
pub(super) fn draw_key(levels: &Levels, unit: &str, key: Rect, sheet: &mut Sheet) {
    let bounds = levels.bounds();
    let texts: Vec<String> = bounds.iter().map(|bound| levelled(*bound, levels.step())).collect();
    let widest = texts.iter().map(|text| font::width(text, 12.0)).fold(0.0, f64::max);
    let key = Rect { right: key.right - font::width(unit, 13.0) - 0.5 * widest - 12.0, ..key };
    sheet.text([key.right + 0.5 * widest + 10.0, key.bottom + 17.0], Anchor::Start, 13.0, INK, unit);
    let bands = bounds.len() - 1;
    let place = |k: usize| key.left + key.width() * k as f64 / bands as f64;
    for band in 0..bands {
        let rect = Rect { left: place(band), right: place(band + 1), ..key };
        sheet.polygon(&rect.corners(), levels.colour(band), levels.colour(band), 0.4);
    }
    let frame = key.corners();
    sheet.line(&[frame[0], frame[1], frame[2], frame[3], frame[0]], INK, 0.8);
    let every = ((widest + 10.0) * bands as f64 / key.width()).ceil().max(1.0) as usize;
    // counted from zero, if it is there: its number is never left out
    let first = bounds.iter().position(|bound| *bound == 0.0).unwrap_or(0) % every;
    for (k, text) in texts.iter().enumerate().skip(first).step_by(every) {
        let width = if bounds[k] == 0.0 { 2.0 } else { 0.8 };
        sheet.line(&[[place(k), key.top], [place(k), key.bottom + 4.0]], INK, width);
        sheet.text([place(k), key.bottom + 17.0], Anchor::Middle, 12.0, INK, text);
    }
}
