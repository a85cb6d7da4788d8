//! The error of the pairs of teeth over the roll.

use flank_export::text::{one_line, shown_unit};

use crate::picture::calls::{self, Call};
use crate::picture::chart::{self, Chart, Title};
use crate::picture::font;
use crate::picture::occupancy::Occupancy;
use crate::picture::paint::{Anchor, Place, Rect, Sheet};
use crate::picture::palette::{self, GREY, INK};

/// An error that changes by less, in its unit, is none: rounding.
const NOTHING: f64 = 1e-6;
const DASHES: [f64; 2] = [5.0, 4.0];
const MARK: f64 = 4.0;

/// The error of each pair of teeth over the roll.
#[derive(Debug, Clone)]
pub struct ErrorCurves {
    /// The motion with its unit, `turn, deg`.
    pub over: String,
    /// The unit of the errors.
    pub unit: String,
    /// Pairs of teeth, each as pieces: roll positions and errors, and whether an edge touches.
    pub pairs: Vec<Vec<(bool, Vec<[f64; 2]>)>>,
    /// The pair that carries; nothing where there is one pair alone.
    pub composite: Vec<[f64; 2]>,
    /// Where one pair hands over to the next: roll position, error and what is written there.
    pub transfers: Vec<([f64; 2], String)>,
    /// The least and the greatest error of what carries, and how it is called.
    pub peaks: Option<([f64; 2], String)>,
}

impl ErrorCurves {
    pub(super) fn draw(&self, contact: &str, rect: Rect, sheet: &mut Sheet) {
        let room = rect.width();
        let name = one_line(&format!("{contact}: error"));
        sheet.text([rect.left, rect.top + 15.0], Anchor::Start, 17.0, INK, &font::fitted(&name, 17.0, room));
        let about = "each pair of teeth; thick the one that carries, dashed where an edge touches";
        sheet.text([rect.left, rect.top + 35.0], Anchor::Start, 13.0, GREY, &font::fitted(about, 13.0, room));
        let map = Rect { top: rect.top + 44.0, ..rect }.inside(chart::MARGINS);
        let chart = Chart::filling(map, self.bounds());
        chart.draw_lines(sheet);
        let places = |points: &[[f64; 2]]| points.iter().map(|point| chart.place(*point)).collect::<Vec<Place>>();
        let mut taken = Occupancy::new(map.right, map.bottom);
        let mut take = |line: &[Place]| line.windows(2).for_each(|pair| taken.take_line([pair[0], pair[1]]));
        for (number, pair) in self.pairs.iter().enumerate() {
            let colour = palette::of_patch(number).towards(INK, 0.25);
            for (is_edge, points) in pair {
                let places = places(points);
                take(&places);
                if *is_edge { sheet.dashes(&places, DASHES, colour, 1.6) } else { sheet.line(&places, colour, 1.6) }
            }
        }
        let composite = places(&self.composite);
        take(&composite);
        sheet.line(&composite, INK, 3.2);
        let titles = [&self.over, &format!("error, {}", shown_unit(&self.unit))].map(|text| one_line(text));
        chart.draw_axes(titles.each_ref().map(|text| Title { text, numbered: true }), sheet);
        let mut calls = self.draw_peaks(&chart, &mut taken, sheet);
        calls.extend(self.draw_transfers(&chart, &mut taken, sheet));
        calls::write(calls, map, &mut taken, sheet);
    }

    /// With room around; errors that differ by rounding alone lie on one line.
    fn bounds(&self) -> [[f64; 2]; 2] {
        let pieces = self.pairs.iter().flatten().flat_map(|(_, points)| points.iter().copied());
        let [across, up] = chart::bounds(pieces.chain(self.composite.iter().copied()));
        let up = if up[1] - up[0] < NOTHING { [0.5 * (up[0] + up[1]) - 1.0, 0.5 * (up[0] + up[1]) + 1.0] } else { up };
        [across, chart::wider(up, 0.12)]
    }

    /// Lines at the least and the greatest error with an arrow between them.
    fn draw_peaks(&self, chart: &Chart, taken: &mut Occupancy, sheet: &mut Sheet) -> Vec<Call> {
        let Some((ends, text)) = &self.peaks else { return Vec::new() };
        let Rect { left, right, .. } = chart.rect;
        let [low, high] = ends.map(|error| chart.place([0.0, error])[1]);
        for at in [low, high] {
            sheet.dashes(&[[left, at], [right, at]], [2.0, 4.0], GREY, 1.0);
            taken.take_line([[left, at], [right, at]]);
        }
        let at = left + 0.06 * chart.rect.width();
        if low - high > 18.0 {
            sheet.line(&[[at, low], [at, high]], GREY, 1.2);
            sheet.arrow_head([at, low], [0.0, 1.0], 8.0, GREY);
            sheet.arrow_head([at, high], [0.0, -1.0], 8.0, GREY);
        }
        taken.take_line([[at, low], [at, high]]);
        let middle = [at, 0.5 * (low + high)];
        vec![Call { at: middle, text: one_line(text), size: 14.0, colour: INK, rank: 0, farthest: 240.0 }]
    }

    fn draw_transfers(&self, chart: &Chart, taken: &mut Occupancy, sheet: &mut Sheet) -> Vec<Call> {
        let draw = |(point, text): &([f64; 2], String)| {
            let at = chart.place(*point);
            let half = [[-MARK, 0.0], [0.0, -MARK], [MARK, 0.0], [0.0, MARK]];
            let corners = half.map(|off| [at[0] + 1.4 * off[0], at[1] + 1.4 * off[1]]);
            sheet.dashes(&[at, [at[0], chart.rect.bottom]], [2.0, 4.0], GREY, 1.0);
            sheet.polygon(&corners, INK, INK, 1.0);
            taken.take_line([at, [at[0], chart.rect.bottom]]);
            Call { at, text: one_line(text), size: 13.0, colour: INK, rank: 1, farthest: 130.0 }
        };
        self.transfers.iter().map(draw).collect()
    }
}
