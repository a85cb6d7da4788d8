//! Texts that belong to places, each beside its place where it covers the least.

use std::f64::consts::TAU;

use super::font;
use super::occupancy::Occupancy;
use super::paint::{Anchor, Colour, Place, Rect, Sheet, text_rect};
use super::palette::GREY;

/// How far from its place a text may stand, sheet units, and in how many directions.
const DISTANCES: [f64; 11] = [10.0, 16.0, 24.0, 36.0, 52.0, 72.0, 96.0, 130.0, 165.0, 200.0, 240.0];
const DIRECTIONS: u32 = 16;
/// From here on a thin line leads to the place.
const FAR: f64 = 30.0;
/// A letter over something is as bad as so many sheet units away from the place, over another letter as so many more; so is a line through so
/// much of a text.
const LETTER: f64 = 200.0;
const LETTER_OVER_LETTER: f64 = 2000.0;
const THROUGH: f64 = 12.0;

/// A text that belongs to a place.
pub(super) struct Call {
    pub(super) at: Place,
    pub(super) text: String,
    pub(super) size: f64,
    pub(super) colour: Colour,
    /// Those of the lowest rank choose first.
    pub(super) rank: u8,
    /// No farther from its place than this, sheet units.
    pub(super) farthest: f64,
}

/// A place for a text: the middle of its base line, what it covers, and the line that leads to it.
struct Candidate {
    base: Place,
    covered: Rect,
    leader: Option<[Place; 2]>,
}

/// Writes the texts one after the other, within a rectangle; one that fits nowhere is left out.
pub(super) fn write(mut calls: Vec<Call>, rect: Rect, taken: &mut Occupancy, sheet: &mut Sheet) {
    calls.sort_by_key(|call| call.rank);
    for call in &calls {
        let Some(Candidate { base, covered, leader }) = call.best(rect, taken) else { continue };
        if let Some(line) = leader {
            sheet.line(&line, GREY, 0.7);
            taken.take_line(line);
        }
        sheet.text(base, Anchor::Middle, call.size, call.colour, &call.text);
        taken.take(&covered);
    }
}

impl Call {
    fn best(&self, rect: Rect, taken: &Occupancy) -> Option<Candidate> {
        let mut best: Option<(f64, Candidate)> = None;
        for distance in DISTANCES.into_iter().filter(|distance| *distance <= self.farthest) {
            for step in 0..DIRECTIONS {
                let candidate = self.candidate(distance, TAU * f64::from(step) / f64::from(DIRECTIONS));
                if !rect.contains(&candidate.covered) {
                    continue;
                }
                let letter = 0.6 * self.size * self.size;
                let over = taken.load(&candidate.covered.shrunk(-2.0)) / letter;
                let over_text = taken.text_load(&candidate.covered) / letter;
                let through = candidate.leader.map_or(0.0, |line| taken.text_under(line));
                let cost = distance + LETTER * over + LETTER_OVER_LETTER * over_text + THROUGH * through;
                if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                    best = Some((cost, candidate));
                }
            }
        }
        best.map(|(_, candidate)| candidate)
    }

    fn candidate(&self, distance: f64, angle: f64) -> Candidate {
        let (sin, cos) = angle.sin_cos();
        let half = 0.5 * font::width(&self.text, self.size);
        let base = [self.at[0] + (distance + half) * cos, self.at[1] + distance * sin + 0.35 * self.size];
        let covered = text_rect(base, Anchor::Middle, self.size, &self.text);
        let near = [self.at[0].clamp(covered.left, covered.right), self.at[1].clamp(covered.top, covered.bottom)];
        Candidate { base, covered, leader: (distance > FAR).then_some([self.at, near]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::paint::Item;
    use crate::picture::palette::INK;

    #[test]
    fn texts_keep_off_each_other_and_off_lines() {
        let rect = Rect { left: 0.0, top: 0.0, right: 400.0, bottom: 300.0 };
        let mut taken = Occupancy::new(rect.right, rect.bottom);
        let line = [[50.0, 150.0], [350.0, 150.0]];
        taken.take_line(line);
        let call = |text: &str| Call {
            at: [200.0, 150.0],
            text: text.to_owned(),
            size: 14.0,
            colour: INK,
            rank: 0,
            farthest: 240.0,
        };
        let mut sheet = Sheet::default();
        write(["X", "tooth_turn", "slide", "Z", "A"].map(call).into(), rect, &mut taken, &mut sheet);
        let texts = sheet.items.iter().filter_map(|item| match item {
            Item::Text { at, size, text, .. } => Some(text_rect(*at, Anchor::Start, *size, text)),
            _ => None,
        });
        let texts: Vec<Rect> = texts.collect();
        assert_eq!(texts.len(), 5);
        for (k, a) in texts.iter().enumerate() {
            assert!(rect.contains(a) && (a.bottom < 150.0 || a.top > 150.0), "{a:?}");
            for b in &texts[..k] {
                let apart = a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;
                assert!(apart, "{a:?} over {b:?}");
            }
        }
    }
}
