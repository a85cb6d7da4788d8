//! A flank of a contact laid flat.

use flank_export::text::{one_line, shown_unit};

use super::{ContactPicture, DrawnContact, DrawnFlank, StationShape};
use crate::picture::calls::{self, Call};
use crate::picture::chart::{self, Chart, Title};
use crate::picture::contours::ValueGrid;
use crate::picture::font;
use crate::picture::levels::Levels;
use crate::picture::maps::{self, Panel, Style};
use crate::picture::occupancy::Occupancy;
use crate::picture::paint::{Anchor, Colour, Place, Rect, Sheet, clipped};
use crate::picture::palette::{self, GREY, INK, PALE, WHITE};

/// Above a flank: what it is, and how it is laid flat.
const HEAD: f64 = 66.0;
/// The key below the gaps with its numbers.
const KEY: f64 = 12.0;
const FOOT: f64 = 40.0;

/// Where the compound is pressed away, and the edge of that.
const FILM: Colour = Colour([151, 202, 230]);
const FILM_EDGE: Colour = Colour([0, 114, 178]);
/// The path of contact: seen on each colour of the maps.
const PATH: Colour = palette::RED;
const DASHES: [f64; 2] = [5.0, 4.0];

/// Half of the size of a mark.
const MARK: f64 = 4.5;
/// A label stands no farther from its place, sheet units.
const FARTHEST: f64 = 130.0;

/// A flank on its axes.
struct FlankMap<'a> {
    flank: &'a DrawnFlank,
    panel: Panel<'a>,
    chart: Chart,
    /// The roll positions of the least gap, and the film.
    met: Option<Panel<'a>>,
    film: f64,
    /// All of the flank, whether it has a gap there or not.
    ground: ValueGrid,
}

pub(super) fn draw(contact: &DrawnContact, flank: &DrawnFlank, kind: ContactPicture, rect: Rect, sheet: &mut Sheet) {
    let Some(panel) = Panel::of_patch(&flank.patch, 0, Style::Bands).map(Panel::laid_flat) else { return };
    let is_gap = matches!(kind, ContactPicture::Gap | ContactPicture::Overview);
    let foot = if is_gap { FOOT } else { 0.0 };
    let chart = panel.chart(Rect { top: rect.top + HEAD, bottom: rect.bottom - foot, ..rect });
    let ground = panel.grid_of(&chart, |_| Some(0.0));
    let met = Panel::of_patch(&flank.patch, 1, Style::Lines);
    let map = FlankMap { flank, panel, chart, met, film: contact.film, ground };
    map.write_heading(&contact.name, rect, sheet);
    let titles = map.panel.projection.titles.each_ref();
    let numbered = map.panel.projection.is_in_mm();
    map.chart.draw_axes(titles.map(|text| Title { text, numbered }), sheet);
    let mut taken = Occupancy::new(rect.right, rect.bottom);
    map.draw_outline(&mut taken, sheet);
    map.ground.silhouette(PALE, sheet);
    let gaps = map.panel.grid(&map.chart);
    match (kind, &map.panel.levels) {
        (ContactPicture::Gap | ContactPicture::Overview, Some(levels)) => {
            map.panel.draw_bands(&gaps, levels, sheet);
            // seen on light and on dark bands
            for (colour, width) in [(INK, 4.0), (WHITE, 1.8)] {
                gaps.lines(contact.film).iter().for_each(|line| sheet.line(line, colour, width));
            }
            map.draw_key(levels, rect, sheet);
        }
        (ContactPicture::Pattern, _) => {
            gaps.fill_up_to(contact.film, FILM, sheet);
            gaps.lines(contact.film).iter().for_each(|line| sheet.line(line, FILM_EDGE, 1.6));
        }
        _ => {}
    }
    map.panel.draw_border(&map.ground, 1.2, sheet);
    if !is_gap {
        map.draw_stations(&mut taken, sheet);
    }
    map.draw_path(&mut taken, sheet);
    for side in map.ground.borders() {
        take(&mut taken, &side);
    }
    map.panel.draw_words(&map.chart, &mut taken, sheet);
    map.draw_marks(kind, &mut taken, sheet);
}

fn take(taken: &mut Occupancy, line: &[Place]) {
    line.windows(2).for_each(|pair| taken.take_line([pair[0], pair[1]]));
}

impl FlankMap<'_> {
    fn write_heading(&self, contact: &str, rect: Rect, sheet: &mut Sheet) {
        let room = rect.width();
        let name = one_line(&format!("{contact}: {}", self.flank.patch.name));
        let size = (17.0 * room / font::width(&name, 17.0)).clamp(12.0, 17.0);
        sheet.text([rect.left, rect.top + 15.0], Anchor::Start, size, INK, &font::fitted(&name, size, room));
        let about = one_line(&format!("{}; {}", self.flank.patch.frame, self.panel.about(&self.chart)));
        sheet.text([rect.left, rect.top + 35.0], Anchor::Start, 13.0, GREY, &font::fitted(&about, 13.0, room));
    }

    fn draw_key(&self, levels: &Levels, rect: Rect, sheet: &mut Sheet) {
        let top = self.chart.rect.bottom + chart::MARGINS[3] + 6.0;
        let key = Rect { left: self.chart.rect.left, top, right: rect.right, bottom: top + KEY };
        maps::draw_key(levels, &shown_unit(&self.panel.field.unit), key, sheet);
    }

    fn place(&self, position: [f64; 3]) -> Option<Place> {
        self.panel.projection.place(position).map(|place| self.chart.place(place))
    }

    fn places(&self, line: &[[f64; 3]]) -> Vec<Place> {
        line.iter().filter_map(|position| self.place(*position)).collect()
    }

    /// Where the tooth ends, as far as the chart shows it.
    fn draw_outline(&self, taken: &mut Occupancy, sheet: &mut Sheet) {
        if !self.panel.projection.is_axial() {
            return;
        }
        for line in &self.flank.outline {
            for pair in self.places(line).windows(2) {
                let [from, to] = [pair[0], pair[1]];
                let Some((start, end)) = clipped(from, to, self.chart.rect) else { continue };
                let at = |share: f64| [0, 1].map(|k| from[k] + share * (to[k] - from[k]));
                let part = [at(start), at(end)];
                sheet.line(&part, GREY, 1.0);
                take(taken, &part);
            }
        }
    }

    /// Ellipses and lines of contact, as far as they lie on the flank.
    fn draw_stations(&self, taken: &mut Occupancy, sheet: &mut Sheet) {
        let sides = self.ground.borders();
        for station in &self.flank.stations {
            match &station.shape {
                StationShape::Point { ellipse, .. } => {
                    let places = self.places(ellipse);
                    let parts = places.split(|place| !is_within(&sides, *place)).filter(|part| part.len() > 1);
                    for part in parts {
                        sheet.line(part, INK, 0.8);
                        take(taken, part);
                    }
                }
                StationShape::Line(roll) => {
                    for line in self.lines_of_contact(*roll) {
                        sheet.line(&line, INK, 0.8);
                        take(taken, &line);
                    }
                }
            }
        }
    }

    /// Where the flank is nearest to its mate at a roll position, within the film.
    fn lines_of_contact(&self, roll: f64) -> Vec<Vec<Place>> {
        let Some(met) = &self.met else { return Vec::new() };
        let value = |at: usize| met.values[at].filter(|_| self.panel.values[at].is_some_and(|gap| gap <= self.film));
        self.panel.grid_of(&self.chart, value).lines(roll)
    }

    fn draw_path(&self, taken: &mut Occupancy, sheet: &mut Sheet) {
        for (is_edge, line) in &self.flank.path {
            for places in shown(&self.places(line), self.chart.rect) {
                take(taken, &places);
                if *is_edge { sheet.dashes(&places, DASHES, PATH, 1.8) } else { sheet.line(&places, PATH, 2.4) }
            }
        }
    }

    /// The middle as a ring, transfers as dots, and round roll positions on the path, each with its label.
    fn draw_marks(&self, kind: ContactPicture, taken: &mut Occupancy, sheet: &mut Sheet) {
        let mut calls = Vec::new();
        let mut call = |at: Place, text: &str, rank: u8| {
            calls.push(Call { at, text: one_line(text), size: 13.0, colour: INK, rank, farthest: FARTHEST });
        };
        if kind == ContactPicture::Path {
            for station in &self.flank.stations {
                let at = match &station.shape {
                    StationShape::Point { position, .. } => self.place(*position),
                    StationShape::Line(roll) => self.lines_of_contact(*roll).first().map(|line| line[line.len() / 2]),
                };
                let Some(at) = at.filter(|at| is_shown(*at, self.chart.rect)) else { continue };
                sheet.polygon(&around(at, 2.2), PATH, PATH, 0.5);
                call(at, &station.label, 2);
            }
        }
        for mark in &self.flank.marks {
            let Some(at) = self.place(mark.position).filter(|at| is_shown(*at, self.chart.rect)) else { continue };
            let (fill, outline) = if mark.is_transfer { (INK, WHITE) } else { (WHITE, INK) };
            sheet.polygon(&around(at, MARK), fill, outline, 1.6);
            taken.take(&Rect { left: at[0], top: at[1], right: at[0], bottom: at[1] }.shrunk(-MARK - 2.0));
            if matches!(kind, ContactPicture::Pattern | ContactPicture::Path) {
                call(at, &mark.label, u8::from(mark.is_transfer));
            }
        }
        calls::write(calls, self.chart.rect, taken, sheet);
    }
}

/// The parts of a line that a rectangle shows: contact at an edge may run beyond the flank.
fn shown(line: &[Place], rect: Rect) -> Vec<Vec<Place>> {
    let mut parts: Vec<Vec<Place>> = Vec::new();
    for pair in line.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let Some((start, end)) = clipped(from, to, rect) else { continue };
        let at = |share: f64| if share == 1.0 { to } else { [0, 1].map(|k| from[k] + share * (to[k] - from[k])) };
        match parts.last_mut().filter(|part| start == 0.0 && part.last() == Some(&from)) {
            Some(part) => part.push(at(end)),
            None => parts.push(vec![at(start), at(end)]),
        }
    }
    parts
}

fn is_shown([x, y]: Place, rect: Rect) -> bool {
    (rect.left..=rect.right).contains(&x) && (rect.top..=rect.bottom).contains(&y)
}

/// A small circle.
fn around(at: Place, radius: f64) -> Vec<Place> {
    let corner = |k: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / 16.0).sin_cos();
        [at[0] + radius * cos, at[1] + radius * sin]
    };
    (0..16).map(corner).collect()
}

/// Whether a place lies within closed lines: a ray from there crosses them an odd number of times.
fn is_within(sides: &[Vec<Place>], [x, y]: Place) -> bool {
    let crosses = |pair: &&[Place]| {
        let [[ax, ay], [bx, by]] = [pair[0], pair[1]];
        (ay > y) != (by > y) && x < ax + (bx - ax) * (y - ay) / (by - ay)
    };
    sides.iter().flat_map(|side| side.windows(2)).filter(crosses).count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_drawn_as_far_as_its_frame_goes() {
        let rect = Rect { left: 0.0, top: 0.0, right: 10.0, bottom: 10.0 };
        let within = [[1.0, 1.0], [4.0, 7.0], [9.0, 2.0]];
        assert_eq!(shown(&within, rect), [within.to_vec()]);
        // out by the lower side, back by it, out by the right one
        let line = [[2.0, 8.0], [2.0, 12.0], [6.0, 12.0], [6.0, 8.0], [14.0, 8.0]];
        let parts = [vec![[2.0, 8.0], [2.0, 10.0]], vec![[6.0, 10.0], [6.0, 8.0], [10.0, 8.0]]];
        assert_eq!(shown(&line, rect), parts);
        assert_eq!(shown(&[[11.0, 1.0], [12.0, 3.0]], rect), Vec::<Vec<Place>>::new());
    }
}
