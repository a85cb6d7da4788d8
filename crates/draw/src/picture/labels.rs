//! What rows and columns run over, written along the borders of the patches.

use super::camera::View;
use super::figure::Drawn;
use super::font;
use super::occupancy::Occupancy;
use super::paint::{Anchor, Place, Rect, Sheet, text_rect};
use super::palette::{GREY, INK};
use super::projection::middle;
use flank_export::shape::Mesh;
use flank_export::text::one_line;

const SIZE: f64 = 16.0;
/// Of words beside maps.
pub(super) const WORD: f64 = 14.0;
const ARROW: f64 = 46.0;

/// A border of a patch on the sheet, in the direction of growing index.
pub(super) struct Border {
    points: Vec<Place>,
    /// The middle of the patch.
    inside: Place,
    /// Number of the patch.
    patch: usize,
}

/// A way to write a label: texts by their middle, perhaps an arrow.
struct Candidate {
    texts: Vec<(Place, String)>,
    arrow: Option<[Place; 2]>,
    cost: f64,
}

/// Writes each distinct label once, at the border with the most room: `toe -> heel` as two words at the ends, any other
/// with an arrow.
pub(super) fn draw(drawn: &[&Drawn<'_>], view: &View, rect: Rect, taken: &mut Occupancy, sheet: &mut Sheet) {
    let mut labels: Vec<&str> = Vec::new();
    for drawn in drawn {
        for label in [&drawn.patch.columns.label, &drawn.patch.rows.label] {
            if !label.trim().is_empty() && !labels.contains(&label.as_str()) {
                labels.push(label);
            }
        }
    }
    for label in labels {
        let borders = drawn.iter().flat_map(|drawn| borders_named(drawn, label, view));
        let candidates = borders.flat_map(|border| candidates(&border, label, rect, taken));
        if let Some(best) = candidates.min_by(|a, b| a.cost.total_cmp(&b.cost)) {
            write(&best, taken, sheet);
        }
    }
}

fn borders_named(drawn: &Drawn<'_>, label: &str, view: &View) -> Vec<Border> {
    let Mesh { rows, columns, ref nodes, is_joined } = drawn.mesh;
    if !is_joined {
        return Vec::new();
    }
    let mut lines: Vec<Vec<usize>> = Vec::new();
    if drawn.patch.rows.label == label && columns > 0 {
        lines.extend([0, columns - 1].map(|j| (0..rows).map(|i| i * columns + j).collect()));
    }
    if drawn.patch.columns.label == label && rows > 0 {
        lines.extend([0, rows - 1].map(|i| (0..columns).map(|j| i * columns + j).collect()));
    }
    let all: Vec<Place> = nodes.iter().flatten().map(|node| view.place(node.position)).collect();
    let on_sheet = |line: Vec<usize>| {
        let points = line.into_iter().filter_map(|at| nodes[at]).map(|node| view.place(node.position)).collect();
        Some(Border { patch: drawn.number, ..Border::new(points, &all)? })
    };
    lines.into_iter().filter_map(on_sheet).collect()
}

fn candidates(border: &Border, label: &str, rect: Rect, taken: &Occupancy) -> Vec<Candidate> {
    let cut = |text: &str| font::fitted(&one_line(text.trim()), SIZE, 220.0);
    let ends = label.split_once("->").or_else(|| label.split_once('\u{2192}'));
    let ends = ends.filter(|(from, to)| !from.trim().is_empty() && !to.trim().is_empty());
    let mut found = Vec::new();
    for gap in [12.0, 22.0, 36.0, 54.0] {
        match ends {
            Some((from, to)) => found.push(at_ends(border, [cut(from), cut(to)], gap)),
            None => found.extend([0.5, 0.35, 0.65, 0.2, 0.8].map(|t| beside(border, cut(label), t, gap))),
        }
    }
    for candidate in &mut found {
        candidate.cost += crowding(candidate, rect, taken);
    }
    found
}

/// A word beside each end of the border.
fn at_ends(border: &Border, [from, to]: [String; 2], gap: f64) -> Candidate {
    let word = |t: f64, text: String| {
        let (place, _, outward) = border.at(t);
        (beyond(place, outward, gap, &text), text)
    };
    Candidate { texts: vec![word(0.04, from), word(0.96, to)], arrow: None, cost: 0.02 * gap + border.rank() }
}

/// An arrow along the border, its name beyond.
fn beside(border: &Border, text: String, t: f64, gap: f64) -> Candidate {
    let (place, along, outward) = border.at(t);
    let middle = moved(place, outward, gap);
    let arrow = [moved(middle, along, -0.5 * ARROW), moved(middle, along, 0.5 * ARROW)];
    let cost = 0.02 * gap + (t - 0.5).abs() + border.rank();
    Candidate { texts: vec![(beyond(middle, outward, 8.0, &text), text)], arrow: Some(arrow), cost }
}

/// What it costs that something is there already, or that the sheet ends.
fn crowding(candidate: &Candidate, rect: Rect, taken: &Occupancy) -> f64 {
    let texts = candidate.texts.iter().map(|(place, text)| centred(*place, text));
    let arrows = candidate.arrow.iter().map(|&[a, b]| Rect {
        left: a[0].min(b[0]),
        top: a[1].min(b[1]),
        right: a[0].max(b[0]),
        bottom: a[1].max(b[1]),
    });
    let cost =
        |covered: Rect| 0.05 * taken.load(&covered.shrunk(-2.0)) + if rect.contains(&covered) { 0.0 } else { 100.0 };
    texts.chain(arrows).map(cost).sum()
}

fn write(candidate: &Candidate, taken: &mut Occupancy, sheet: &mut Sheet) {
    for (place, text) in &candidate.texts {
        let base_line = [place[0], place[1] + 0.27 * SIZE];
        taken.take(&sheet.text(base_line, Anchor::Middle, SIZE, INK, text));
    }
    if let Some([from, to]) = candidate.arrow {
        let along = [(to[0] - from[0]) / ARROW, (to[1] - from[1]) / ARROW];
        sheet.line(&[from, moved(to, along, -6.0)], GREY, 1.5);
        sheet.arrow_head(to, along, 10.0, GREY);
        taken.take_shape(&[from, to]);
    }
}

/// The middle of a text that keeps a gap to a place.
fn beyond(place: Place, outward: Place, gap: f64, text: &str) -> Place {
    let half_width = 0.5 * font::width(text, SIZE);
    moved(place, outward, gap + half_width * outward[0].abs() + 0.5 * SIZE * outward[1].abs())
}

fn centred(place: Place, text: &str) -> Rect {
    text_rect([place[0], place[1] + 0.27 * SIZE], Anchor::Middle, SIZE, text)
}

fn moved(place: Place, direction: Place, by: f64) -> Place {
    [place[0] + by * direction[0], place[1] + by * direction[1]]
}

/// Writes a word beside the middle of a border, or where else along it the rectangle has room and nothing else stands.
pub(super) fn word_beside(border: &Border, word: &str, rect: Rect, taken: &mut Occupancy, sheet: &mut Sheet) {
    let place = |distance: f64, share: f64| {
        let (place, _, outward) = border.at(share);
        let half = 0.5 * font::width(word, WORD);
        let [x, y] = moved(place, outward, distance + half * outward[0].abs() + 0.5 * WORD * outward[1].abs());
        [x, y + 0.27 * WORD]
    };
    let covered = |base: &Place| text_rect(*base, Anchor::Middle, WORD, word);
    let along = [0.5, 0.35, 0.65, 0.2, 0.8, 0.08, 0.92];
    let all = [8.0, 22.0].into_iter().flat_map(|distance| along.map(|share| place(distance, share)));
    let fitting: Vec<Place> = all.filter(|base| rect.contains(&covered(base))).collect();
    let load = |base: &&Place| taken.share(&covered(base));
    // the first of those that cover the least
    if let Some(base) = fitting.iter().min_by(|a, b| load(a).total_cmp(&load(b))) {
        taken.take(&sheet.text(*base, Anchor::Middle, WORD, INK, word));
    }
}

impl Border {
    /// A border along some points of a patch, all of whose points are given; `None` for a single point.
    pub(super) fn new(points: Vec<Place>, all: &[Place]) -> Option<Border> {
        (points.len() > 1).then(|| Border { points, inside: middle(all), patch: 0 })
    }

    /// The place at a share of the border's length, the direction along it there, and the one away from the patch.
    fn at(&self, t: f64) -> (Place, Place, Place) {
        let lengths = self.points.windows(2).map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]));
        let mut left = t * lengths.clone().sum::<f64>();
        let mut found = (self.points[0], [1.0, 0.0]);
        for (pair, length) in self.points.windows(2).zip(lengths) {
            if length > 0.0 {
                let along = [(pair[1][0] - pair[0][0]) / length, (pair[1][1] - pair[0][1]) / length];
                found = (moved(pair[0], along, left.min(length)), along);
            }
            if left <= length {
                break;
            }
            left -= length;
        }
        let (place, along) = found;
        let aside = [-along[1], along[0]];
        let away = [place[0] - self.inside[0], place[1] - self.inside[1]];
        let outward = if aside[0] * away[0] + aside[1] * away[1] < -1e-6 { aside.map(|x| -x) } else { aside };
        (place, along, outward)
    }

    /// The first patch is the one that matters; below and to the left are where a reader looks first.
    fn rank(&self) -> f64 {
        let (_, _, outward) = self.at(0.5);
        0.4 - 0.3 * outward[1] + 0.1 * outward[0] + if self.patch == 0 { 0.0 } else { 5.0 }
    }
}
