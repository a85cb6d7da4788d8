//! Contact of two flanks: what the marking compound shows on each with the path of contact, and the error of the pairs of teeth over the
//! roll.

use super::chart::{self, Chart, Title};
use super::figure::{self, Figure, MARGIN};
use super::font;
use super::maps::{GAP, Panel, Style};
use super::paint::{Anchor, Colour, Place, Rect, Sheet};
use super::palette::{self, GREY, INK};
use flank_export::Dataset;
use flank_export::text::one_line;

/// What is drawn of a contact.
#[derive(Debug, Clone)]
pub struct ContactDrawing {
    /// Both flanks, each with its gaps as the first field.
    pub dataset: Dataset,
    /// The title of the picture.
    pub title: String,
    /// A sentence below.
    pub note: String,
    /// Thickness of the marking compound, in the unit of the gaps.
    pub film: f64,
    /// The path of contact on each flank, in its frame.
    pub paths: Vec<Vec<[f64; 3]>>,
    /// The error over the roll.
    pub error: ErrorCurves,
}

/// The error of each pair of teeth over the roll.
#[derive(Debug, Clone)]
pub struct ErrorCurves {
    /// The motion with its unit, `turn, deg`.
    pub over: String,
    /// The unit of the errors.
    pub unit: String,
    /// Pairs of teeth, each as pieces: roll positions and errors, and whether an edge touches.
    pub pairs: Vec<Vec<(bool, Vec<[f64; 2]>)>>,
    /// The pair that carries.
    pub composite: Vec<[f64; 2]>,
}

/// Arranges maps and chart on a sheet of this size.
pub(super) fn compose(of: &ContactDrawing, [width, height]: [f64; 2]) -> Figure {
    let title = one_line(&of.title);
    let mut sheet = Sheet::default();
    figure::write_heading(&title, &of.dataset.header, width - 2.0 * MARGIN, &mut sheet);
    let panels: Vec<Panel<'_>> =
        (0..of.dataset.patches.len()).filter_map(|at| Panel::of_field(&of.dataset, (at, 0), Style::Bands)).collect();
    let area = Rect { left: MARGIN, top: 118.0, right: width - MARGIN, bottom: height - 92.0 };
    let rects: Vec<Rect> = figure::places(panels.len() + 1, area, GAP).collect();
    for (at, (panel, rect)) in panels.iter().zip(&rects).enumerate() {
        if let Some(chart) = panel.draw(*rect, Style::Bands, &mut sheet) {
            for line in panel.grid(&chart).lines(of.film) {
                sheet.line(&line, INK, 2.4);
            }
            let path = of.paths.get(at).into_iter().flatten();
            let path: Vec<Place> = path.filter_map(|p| panel.projection.place(*p)).map(|p| chart.place(p)).collect();
            sheet.line(&path, PATH, 2.0);
        }
    }
    if let Some(rect) = rects.get(panels.len()) {
        of.error.draw(*rect, &mut sheet);
    }
    let caption = one_line(&of.note);
    figure::write_caption(&caption, [width, height], &mut sheet);
    Figure { title, caption, items: sheet.items }
}

/// The path of contact: seen on each colour of the maps.
const PATH: Colour = palette::RED;

impl ErrorCurves {
    fn draw(&self, rect: Rect, sheet: &mut Sheet) {
        let room = rect.width();
        sheet.text([rect.left, rect.top + 15.0], Anchor::Start, 17.0, INK, "error");
        let about = "each pair of teeth; thick the one that carries, dashed where an edge touches";
        sheet.text([rect.left, rect.top + 35.0], Anchor::Start, 13.0, GREY, &font::fitted(about, 13.0, room));
        let map = Rect { top: rect.top + 44.0, ..rect }.inside(chart::MARGINS);
        let pieces = || self.pairs.iter().flatten().flat_map(|(_, points)| points.iter().copied());
        let [across, up] = chart::bounds(pieces().chain(self.composite.iter().copied()));
        let chart = Chart::filling(map, [across, chart::wider(up, 0.06)]);
        chart.draw_lines(sheet);
        for (number, pair) in self.pairs.iter().enumerate() {
            let colour = palette::of_patch(number).towards(INK, 0.25);
            for (is_edge, points) in pair {
                let places: Vec<Place> = points.iter().map(|point| chart.place(*point)).collect();
                if *is_edge { sheet.dashes(&places, [5.0, 4.0], colour, 1.6) } else { sheet.line(&places, colour, 1.6) }
            }
        }
        let composite: Vec<Place> = self.composite.iter().map(|point| chart.place(*point)).collect();
        sheet.line(&composite, INK, 3.2);
        let titles = [&self.over, &self.unit].map(|text| one_line(text));
        chart.draw_axes(titles.each_ref().map(|text| Title { text, numbered: true }), sheet);
    }
}
