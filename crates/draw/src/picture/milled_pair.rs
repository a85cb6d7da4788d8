//! A flank that a cutter has milled against its mate: the pattern beside that of the generated flank, and what the ridges do to the error.

use flank_export::text::{one_line, shown_unit, with_minus};
use flank_export::{Header, Patch};

use super::chart::{self, Title};
use super::figure::{self, Figure, MARGIN};
use super::maps::{self, GAP, Panel, Style};
use super::milling::{FOOT, HEAD, KEY, PassChart, head};
use super::paint::{Place, Rect, Sheet, clipped};
use super::palette::{INK, RED, WHITE};

/// How much of the sheet's height the maps take.
const UPPER: f64 = 0.58;

/// What is drawn of a pair with a milled flank.
#[derive(Debug, Clone)]
pub struct MilledPairDrawing {
    /// Where the numbers come from.
    pub header: Header,
    /// The title of the picture.
    pub title: String,
    /// What the picture shows, in sentences below it.
    pub note: String,
    /// Thickness of the marking compound, in the unit of the gaps.
    pub film: f64,
    /// The flank as generated and as milled, with the least gap to the mate as the first field.
    pub flanks: [Patch; 2],
    /// The path of contact, in the frame of the flank.
    pub path: Vec<Vec<[f64; 3]>>,
    /// Numbers over the roll.
    pub charts: Vec<PassChart>,
}

/// Arranges it on a sheet of this size.
pub(super) fn compose(of: &MilledPairDrawing, [width, height]: [f64; 2]) -> Figure {
    let title = one_line(&of.title);
    let mut sheet = Sheet::default();
    figure::write_heading(&title, &of.header, width - 2.0 * MARGIN, &mut sheet);
    let area = Rect { left: MARGIN, top: 118.0, right: width - MARGIN, bottom: height - 92.0 };
    let upper = Rect { bottom: area.top + UPPER * area.height(), ..area };
    let lower = Rect { top: upper.bottom + 0.5 * GAP, ..area };
    let panel = |patch| Panel::of_patch(patch, 0, Style::Bands).map(Panel::filling);
    let mut panels: Vec<Panel<'_>> = of.flanks.iter().filter_map(panel).collect();
    maps::give_one_key(&mut panels);
    for (panel, rect) in panels.iter().zip(beside(panels.len(), upper)) {
        of.draw_map(panel, rect, &mut sheet);
    }
    for (chart, rect) in of.charts.iter().zip(beside(of.charts.len(), lower)) {
        chart.draw(rect, &mut sheet);
    }
    let caption = with_minus(&one_line(&of.note));
    figure::write_caption(&caption, [width, height], &mut sheet);
    Figure { title, caption, items: sheet.items }
}

/// So many rectangles side by side.
fn beside(count: usize, rect: Rect) -> impl Iterator<Item = Rect> {
    let room = (rect.width() + GAP) / count.max(1) as f64 - GAP;
    (0..count).map(move |k| {
        let left = rect.left + k as f64 * (room + GAP);
        Rect { left, right: left + room, ..rect }
    })
}

impl MilledPairDrawing {
    fn draw_map(&self, panel: &Panel<'_>, rect: Rect, sheet: &mut Sheet) {
        let chart = panel.chart(Rect { top: rect.top + HEAD, bottom: rect.bottom - FOOT, ..rect });
        let unit = shown_unit(&panel.field.unit);
        head(&panel.patch.name, &format!("least gap, {unit}; {}", panel.about(&chart)), rect, sheet);
        let titles = panel.projection.titles.each_ref();
        let numbered = panel.projection.is_in_mm();
        chart.draw_axes(titles.map(|text| Title { text, numbered }), sheet);
        let Some(levels) = &panel.levels else { return };
        let gaps = panel.grid(&chart);
        gaps.fill(levels, sheet);
        panel.draw_border(&gaps, 1.2, sheet);
        // seen on light and on dark bands
        for (colour, width) in [(INK, 3.0), (WHITE, 1.4)] {
            gaps.lines(self.film).iter().for_each(|line| sheet.line(line, colour, width));
        }
        let place = |position: &[f64; 3]| panel.projection.place(*position).map(|place| chart.place(place));
        for line in &self.path {
            let places: Vec<Place> = line.iter().filter_map(place).collect();
            for pair in places.windows(2) {
                let Some((start, end)) = clipped(pair[0], pair[1], chart.rect) else { continue };
                let at = |share: f64| [0, 1].map(|k| pair[0][k] + share * (pair[1][k] - pair[0][k]));
                sheet.line(&[at(start), at(end)], RED, 2.0);
            }
        }
        let top = chart.rect.bottom + chart::MARGINS[3] + 6.0;
        let key = Rect { left: chart.rect.left, top, right: rect.right, bottom: top + KEY };
        maps::draw_key(levels, &unit, key, sheet);
    }
}
