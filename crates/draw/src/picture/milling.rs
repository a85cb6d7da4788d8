//! A flank that a cutter mills: the ridges between its passes, the cutter across them, and what happens along a pass.

use flank_export::text::{one_line, shown_unit, with_minus};
use flank_export::{Header, Patch};

use super::calls::{self, Call};
use super::chart::{self, Chart, Title};
use super::figure::{self, Figure, MARGIN};
use super::font;
use super::maps::{self, GAP, Panel, Style};
use super::occupancy::Occupancy;
use super::paint::{Anchor, Colour, Place, Rect, Sheet};
use super::palette::{self, GREY, INK, WHITE};
use super::values;

/// Above a chart: its name and the line below it.
pub(super) const HEAD: f64 = 66.0;
/// The key below the map with its numbers.
pub(super) const KEY: f64 = 12.0;
pub(super) const FOOT: f64 = 40.0;
/// Lines of passes are no nearer to each other, sheet units.
const APART: f64 = 7.0;
/// What is left in a section.
const STEEL: Colour = Colour([176, 186, 196]);
const DASHES: [f64; 2] = [5.0, 4.0];
const RING: f64 = 5.0;
/// The scale of a section whose heights are rounding, um.
const FLAT: f64 = 0.1;
/// How much of the sheet's width the map takes, and of its height the upper row.
const SHARES: [f64; 2] = [0.58, 0.58];

/// What is drawn of a milling.
#[derive(Debug, Clone)]
pub struct MillingDrawing {
    /// Where the numbers come from.
    pub header: Header,
    /// The title of the picture.
    pub title: String,
    /// What the picture shows, in sentences below it.
    pub note: String,
    /// The ridges, row by row from pass to pass, with their heights as the first field.
    pub ridges: Patch,
    /// The contacts of each pass, in the frame of the ridges.
    pub passes: Vec<Vec<[f64; 3]>>,
    /// The highest ridge, and what is written there; none where heights are rounding.
    pub highest: Option<([f64; 3], String)>,
    /// Across the passes at the highest ridge, or in the middle.
    pub section: RidgeSection,
    /// What happens along a pass.
    pub charts: Vec<PassChart>,
}

/// A section across the passes: mm along the surface, and heights over it, um.
#[derive(Debug, Clone)]
pub struct RidgeSection {
    /// Where it is.
    pub about: String,
    /// The cutter on each of some passes.
    pub passes: Vec<Vec<[f64; 2]>>,
    /// What all of them leave.
    pub left: Vec<[f64; 2]>,
    /// How high the ridge is, at nothing across the passes; none where heights are rounding.
    pub ridge: Option<f64>,
}

/// Numbers along a pass.
#[derive(Debug, Clone)]
pub struct PassChart {
    /// What they are.
    pub title: String,
    /// Which pass it is, and the like.
    pub about: String,
    /// What goes across, with its unit.
    pub over: String,
    /// The unit of what goes up.
    pub unit: String,
    /// Curves with their names.
    pub curves: Vec<(String, Vec<[f64; 2]>)>,
    /// Values that are not to be passed, with their names.
    pub limits: Vec<(f64, String)>,
}

/// Arranges it on a sheet of this size.
pub(super) fn compose(of: &MillingDrawing, [width, height]: [f64; 2]) -> Figure {
    let title = one_line(&of.title);
    let mut sheet = Sheet::default();
    figure::write_heading(&title, &of.header, width - 2.0 * MARGIN, &mut sheet);
    let area = Rect { left: MARGIN, top: 118.0, right: width - MARGIN, bottom: height - 92.0 };
    let upper = Rect { bottom: area.top + SHARES[1] * area.height(), ..area };
    let middle = area.left + SHARES[0] * area.width();
    let mut caption = one_line(&of.note);
    if let Some(every) = of.draw_map(Rect { right: middle - 0.5 * GAP, ..upper }, &mut sheet).filter(|every| *every > 1)
    {
        caption += &format!(" One of {every} passes is drawn.");
    }
    of.section.draw(of.is_one_pass(), Rect { left: middle + 0.5 * GAP, ..upper }, &mut sheet);
    let lower = Rect { top: upper.bottom + 0.5 * GAP, ..area };
    let count = of.charts.len().max(1) as f64;
    for (k, chart) in of.charts.iter().enumerate() {
        let room = (lower.width() + GAP) / count - GAP;
        let left = lower.left + k as f64 * (room + GAP);
        chart.draw(Rect { left, right: left + room, ..lower }, &mut sheet);
    }
    let caption = with_minus(&caption);
    figure::write_caption(&caption, [width, height], &mut sheet);
    Figure { title, caption, items: sheet.items }
}

pub(super) fn head(title: &str, about: &str, rect: Rect, sheet: &mut Sheet) {
    let room = rect.width();
    sheet.text([rect.left, rect.top + 15.0], Anchor::Start, 17.0, INK, &font::fitted(&one_line(title), 17.0, room));
    let about = with_minus(&one_line(about));
    sheet.text([rect.left, rect.top + 35.0], Anchor::Start, 13.0, GREY, &font::fitted(&about, 13.0, room));
}

impl MillingDrawing {
    /// A pass alone has no ridges.
    fn is_one_pass(&self) -> bool {
        self.passes.len() == 1
    }

    /// The ridges with the passes between them; one of how many passes is drawn.
    fn draw_map(&self, rect: Rect, sheet: &mut Sheet) -> Option<usize> {
        let panel = Panel::of_patch(&self.ridges, 0, Style::Bands)?;
        let chart = panel.chart(Rect { top: rect.top + HEAD, bottom: rect.bottom - FOOT, ..rect });
        let unit = shown_unit(&panel.field.unit);
        let about = format!("{}, {unit}; white: the contact on each pass; {}", self.ridges.name, panel.about(&chart));
        head(
            if self.is_one_pass() { "what the pass leaves" } else { "ridges between the passes" },
            &about,
            rect,
            sheet,
        );
        let titles = panel.projection.titles.each_ref();
        let numbered = panel.projection.is_in_mm();
        chart.draw_axes(titles.map(|text| Title { text, numbered }), sheet);
        let levels = panel.levels.as_ref()?;
        panel.draw_bands(&panel.grid(&chart), levels, sheet);
        let place = |position: &[f64; 3]| panel.projection.place(*position).map(|place| chart.place(place));
        let lines: Vec<Vec<Place>> = self
            .passes
            .iter()
            .map(|pass| pass.iter().filter_map(place).collect())
            .filter(|line: &Vec<_>| line.len() > 1)
            .collect();
        let every = every(&lines);
        lines.iter().step_by(every).for_each(|line| sheet.line(line, WHITE, 0.7));
        values::draw(&panel, &chart, levels, sheet);
        let top = chart.rect.bottom + chart::MARGINS[3] + 6.0;
        let key = Rect { left: chart.rect.left, top, right: rect.right, bottom: top + KEY };
        maps::draw_key(levels, &unit, key, sheet);
        panel.draw_words(&chart, &mut Occupancy::new(rect.right, rect.bottom), sheet);
        let highest = self.highest.as_ref().and_then(|(at, text)| Some((place(at)?, text)));
        if let Some((at, text)) = highest {
            sheet.polygon(&ring(at), WHITE, palette::RED, 2.0);
            // above the ring, where no values stand, or below it
            let is_right = at[0] > chart.rect.middle()[0];
            let down = if at[1] - 26.0 > chart.rect.top { -12.0 } else { 24.0 };
            let (anchor, aside) = if is_right { (Anchor::End, RING) } else { (Anchor::Start, -RING) };
            sheet.text([at[0] + aside, at[1] + down], anchor, 13.0, palette::RED, &one_line(text));
        }
        Some(every)
    }
}

/// One of how many lines is drawn, so that they are apart.
fn every(lines: &[Vec<Place>]) -> usize {
    let middle = |line: &Vec<Place>| line[line.len() / 2];
    let [first, last] = [lines.first(), lines.last()].map(|line| line.map_or([0.0; 2], middle));
    if lines.len() < 2 {
        return 1;
    }
    let room = (last[0] - first[0]).hypot(last[1] - first[1]);
    ((APART * lines.len() as f64 / room.max(1.0)).ceil() as usize).max(1)
}

fn ring(at: Place) -> Vec<Place> {
    let corner = |k: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / 20.0).sin_cos();
        [at[0] + RING * cos, at[1] + RING * sin]
    };
    (0..20).map(corner).collect()
}

impl RidgeSection {
    fn draw(&self, is_one_pass: bool, rect: Rect, sheet: &mut Sheet) {
        let title = match (is_one_pass, self.ridge) {
            (true, Some(_)) => "across the pass, where most is left",
            (true, None) => "across the pass, in its middle",
            (false, Some(_)) => "cutter across the passes, at the highest ridge",
            (false, None) => "cutter across the passes, in the middle",
        };
        head(title, &self.about, rect, sheet);
        let map = Rect { top: rect.top + HEAD, ..rect }.inside(chart::MARGINS);
        let [across, _] = chart::bounds(self.left.iter().copied());
        let height = self.ridge.unwrap_or(FLAT);
        let top = 2.2 * height;
        let chart = Chart::filling(map, [across, [-0.35 * height, top]]);
        let place = |point: &[f64; 2]| chart.place(*point);
        let mut steel: Vec<Place> = self.left.iter().map(place).collect();
        let ends = [across[1], across[0]].map(|x| [chart.place([x, 0.0])[0], map.bottom]);
        steel.extend(ends);
        sheet.polygon(&steel, STEEL, STEEL, 0.0);
        let mut taken = Occupancy::new(rect.right, rect.bottom);
        for (number, pass) in self.passes.iter().enumerate() {
            let colour = palette::of_patch(number).towards(INK, 0.25);
            let parts = pass.split(|point| point[1] > top);
            for part in parts.filter(|part| part.len() > 1) {
                let line: Vec<Place> = part.iter().map(place).collect();
                line.windows(2).for_each(|pair| taken.take_line([pair[0], pair[1]]));
                sheet.line(&line, colour, 1.8);
            }
        }
        let flank = [across[0], across[1]].map(|x| chart.place([x, 0.0]));
        sheet.dashes(&flank, DASHES, INK, 1.4);
        let titles = ["across the passes, mm along the flank", "over the flank, \u{b5}m"];
        chart.draw_axes(titles.map(|text| Title { text, numbered: true }), sheet);
        let call =
            |at: Place, text: String, colour: Colour| Call { at, text, size: 13.0, colour, rank: 0, farthest: 130.0 };
        let mut written = Vec::new();
        if let Some(height) = self.ridge {
            let at = chart.place([0.0, height]);
            sheet.polygon(&ring(at), WHITE, palette::RED, 2.0);
            written.push(call(at, format!("{} \u{b5}m", flank_export::fixed(height, 3)), palette::RED));
        }
        written.push(call([flank[0][0] + 40.0, flank[0][1]], "flank".to_string(), INK));
        calls::write(written, map, &mut taken, sheet);
    }
}

impl PassChart {
    pub(super) fn draw(&self, rect: Rect, sheet: &mut Sheet) {
        head(&self.title, &self.about, rect, sheet);
        let map = Rect { top: rect.top + HEAD, ..rect }.inside(chart::MARGINS);
        let curves = self.curves.iter().flat_map(|(_, points)| points.iter().copied());
        let [across, _] = chart::bounds(curves.clone());
        let limits = self.limits.iter().map(|(limit, _)| [across[0], *limit]);
        let [across, up] = chart::bounds(curves.chain(limits));
        let chart = Chart::filling(map, [across, chart::wider(up, 0.12)]);
        chart.draw_lines(sheet);
        let mut taken = Occupancy::new(rect.right, rect.bottom);
        let mut calls = Vec::new();
        let mut draw = |line: &[Place], colour: Colour, name: &str, is_limit: bool, sheet: &mut Sheet| {
            if is_limit {
                sheet.dashes(line, DASHES, colour, 1.6)
            } else {
                sheet.line(line, colour, 2.4)
            }
            line.windows(2).for_each(|pair| taken.take_line([pair[0], pair[1]]));
            let at = line[if is_limit { 0 } else { line.len() / 2 }];
            let at = if is_limit { [at[0] + 60.0, at[1]] } else { at };
            calls.push(Call {
                at,
                text: one_line(name),
                size: 13.0,
                colour,
                rank: u8::from(is_limit),
                farthest: 130.0,
            });
        };
        for (number, (name, points)) in self.curves.iter().enumerate() {
            let line: Vec<Place> = points.iter().map(|point| chart.place(*point)).collect();
            if line.len() > 1 {
                draw(&line, palette::of_patch(number + 3).towards(INK, 0.25), name, false, sheet);
            }
        }
        for (limit, name) in &self.limits {
            draw(&across.map(|x| chart.place([x, *limit])), palette::RED, name, true, sheet);
        }
        let titles = [&self.over, &shown_unit(&self.unit)].map(|text| one_line(text));
        chart.draw_axes(titles.each_ref().map(|text| Title { text, numbered: true }), sheet);
        calls::write(calls, map, &mut taken, sheet);
    }
}
