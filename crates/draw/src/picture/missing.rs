//! Crosses where points are not solved but their neighbours tell the place.

use std::collections::BTreeSet;

use super::camera::View;
use super::paint::{Place, Sheet};
use super::palette::{RED, WHITE};
use flank_export::Patch;
use flank_export::shape::node;
use flank_export::vector::{Vector, add, scale, sub};

const ARM: f64 = 4.0;

/// Marks unsolved points by red crosses; where they are dense, some of them stand for all.
pub(super) fn draw<'a>(patches: impl Iterator<Item = &'a Patch>, view: &View, sheet: &mut Sheet) {
    let mut crosses = Crosses::default();
    for patch in patches {
        for (i, j, point) in patch.numbered(0, &patch.points) {
            if point.is_solved() {
                continue;
            }
            if let Some(position) = likely_position(patch, i, j) {
                crosses.draw(view.place(position), sheet);
            }
        }
    }
}

/// Where crosses stand already.
#[derive(Default)]
pub(super) struct Crosses(BTreeSet<(i64, i64)>);

impl Crosses {
    /// Draws a cross unless one is there.
    pub(super) fn draw(&mut self, [x, y]: Place, sheet: &mut Sheet) {
        if self.0.insert(((x / (2.5 * ARM)) as i64, (y / (2.5 * ARM)) as i64)) {
            for (colour, width) in [(WHITE, 4.0), (RED, 1.8)] {
                sheet.line(&[[x - ARM, y - ARM], [x + ARM, y + ARM]], colour, width);
                sheet.line(&[[x - ARM, y + ARM], [x + ARM, y - ARM]], colour, width);
            }
        }
    }
}

/// Where a cross for the point belongs: between solved neighbours on both sides, else one step beyond two in a row; no
/// place where the grid around is empty.
pub(super) fn likely_position(patch: &Patch, i: usize, j: usize) -> Option<Vector> {
    let at = |di: isize, dj: isize| {
        let point = patch.point(i.checked_add_signed(di)?, j.checked_add_signed(dj)?)?;
        node(point).map(|node| node.position)
    };
    let opposite = [(1, 0), (0, 1), (1, 1), (1, -1)];
    let between = opposite.iter().filter_map(|&(di, dj)| Some(scale(0.5, add(at(di, dj)?, at(-di, -dj)?))));
    let steps = [(1, 0), (-1, 0), (0, 1), (0, -1)];
    let beyond = steps.iter().filter_map(|&(di, dj)| Some(sub(scale(2.0, at(di, dj)?), at(2 * di, 2 * dj)?)));
    mean(between).or_else(|| mean(beyond))
}

fn mean(positions: impl Iterator<Item = Vector>) -> Option<Vector> {
    let all: Vec<Vector> = positions.collect();
    let share = 1.0 / all.len() as f64;
    (!all.is_empty()).then(|| all.into_iter().fold([0.0; 3], |sum, position| add(sum, scale(share, position))))
}
