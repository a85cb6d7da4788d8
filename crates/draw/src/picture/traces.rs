//! Profile and helix traces of flanks: a row for each, with the numbers of their evaluation.

use super::chart::{self, Chart, Title};
use super::figure::{self, Figure, MARGIN};
use super::font;
use super::paint::{Anchor, Colour, Place, Rect, Sheet};
use super::palette::{self, GREY, INK};
use flank_export::Header;
use flank_export::text::{one_line, with_minus};

const GAP: f64 = 36.0;
/// Above a chart: what it is, and its numbers.
const HEAD: f64 = 52.0;
/// No chart shows less than this from bottom to top, um: below that there is rounding.
const LEAST: f64 = 2.0;
/// The ground of what is evaluated.
const EVALUATED: Colour = Colour([240, 244, 248]);

/// Traces of some flanks.
#[derive(Debug, Clone, PartialEq)]
pub struct TraceDrawing {
    /// Where they come from.
    pub header: Header,
    /// What they are called.
    pub title: String,
    /// What is to be said of them; written below.
    pub note: String,
    /// A row of charts for each flank.
    pub flanks: Vec<Vec<TraceChart>>,
}

/// A trace.
#[derive(Debug, Clone, PartialEq)]
pub struct TraceChart {
    /// What it is of.
    pub name: String,
    /// What its lengths are.
    pub across: String,
    /// mm, growing.
    pub lengths: Vec<f64>,
    /// um, plus is material.
    pub deviations: Vec<f64>,
    /// Where its evaluation begins and ends.
    pub range: [f64; 2],
    /// Its mean line: the value in the middle of the range, um, and the rise, um per mm.
    pub mean: [f64; 2],
    /// What it is evaluated as, such as `Fα 3.1 µm`.
    pub numbers: Vec<String>,
}

/// Arranges the charts on a sheet of this size; one scale for all deviations.
pub(super) fn compose(drawing: &TraceDrawing, [width, height]: [f64; 2]) -> Figure {
    let title = one_line(&drawing.title);
    let mut sheet = Sheet::default();
    figure::write_heading(&title, &drawing.header, width - 2.0 * MARGIN, &mut sheet);
    let area = Rect { left: MARGIN, top: 112.0, right: width - MARGIN, bottom: height - 88.0 };
    let seen = |chart: &TraceChart| chart.deviations.iter().copied().chain(chart.mean_ends()).collect::<Vec<f64>>();
    let all = drawing.flanks.iter().flatten().flat_map(seen);
    let [_, up] = chart::bounds(all.chain([0.0]).map(|off| [0.0, off]));
    let middle = 0.5 * (up[0] + up[1]);
    let half = 0.55 * (up[1] - up[0]).max(LEAST);
    if drawing.flanks.is_empty() {
        sheet.text(area.middle(), Anchor::Middle, 20.0, GREY, "nothing to draw: no flank is an involute");
    }
    let rows = drawing.flanks.len() as f64;
    let high = (area.height() - GAP * (rows - 1.0)) / rows;
    for (row, charts) in drawing.flanks.iter().enumerate() {
        let top = area.top + row as f64 * (high + GAP);
        let count = charts.len() as f64;
        let wide = (area.width() - GAP * (count - 1.0)) / count;
        for (column, chart) in charts.iter().enumerate() {
            let left = area.left + column as f64 * (wide + GAP);
            let rect = Rect { left, top, right: left + wide, bottom: top + high };
            chart.draw(rect, [middle - half, middle + half], &mut sheet);
        }
    }
    let caption = with_minus(&one_line(&drawing.note));
    figure::write_caption(&caption, [width, height], &mut sheet);
    Figure { title, caption, items: sheet.items }
}

impl TraceChart {
    /// The mean line at both ends of the trace, um.
    fn mean_ends(&self) -> [f64; 2] {
        let middle = 0.5 * (self.range[0] + self.range[1]);
        let ends = [self.lengths.first(), self.lengths.last()].map(|length| length.copied().unwrap_or(middle));
        ends.map(|length| self.mean[0] + self.mean[1] * (length - middle))
    }

    fn draw(&self, rect: Rect, up: [f64; 2], sheet: &mut Sheet) {
        let room = rect.width();
        sheet.text(
            [rect.left, rect.top + 14.0],
            Anchor::Start,
            16.0,
            INK,
            &font::fitted(&one_line(&self.name), 16.0, room),
        );
        let numbers = with_minus(&one_line(&self.numbers.join("   ")));
        let size = (14.0 * room / font::width(&numbers, 14.0)).clamp(9.0, 14.0);
        sheet.text([rect.left, rect.top + 34.0], Anchor::Start, size, INK, &font::fitted(&numbers, size, room));
        let [across, _] = chart::bounds(self.lengths.iter().map(|length| [*length, 0.0]));
        let rect = Rect { top: rect.top + HEAD - 16.0, ..rect }.inside(chart::MARGINS);
        let chart = Chart::filling(rect, [chart::wider(across, 0.03), up]);
        let [from, to] = self.range.map(|length| chart.place([length, 0.0])[0].clamp(rect.left, rect.right));
        sheet.polygon(&Rect { left: from, right: to, ..rect }.corners(), EVALUATED, EVALUATED, 0.0);
        chart.draw_lines(sheet);
        let zero = chart.place([0.0, 0.0])[1];
        sheet.line(&[[rect.left, zero], [rect.right, zero]], INK, 1.0);
        let [first, last] = self.mean_ends();
        let mean = [[across[0], first], [across[1], last]].map(|at| chart.place(at));
        sheet.dashes(&mean, [8.0, 5.0], palette::of_patch(1), 1.4);
        let places = self.lengths.iter().zip(&self.deviations).map(|(length, off)| chart.place([*length, *off]));
        sheet.line(&places.collect::<Vec<Place>>(), palette::of_patch(3), 2.4);
        let across = one_line(&self.across);
        chart.draw_axes([&across, "\u{b5}m"].map(|text| Title { text, numbered: true }), sheet);
    }
}
