//! Which parts of the sheet are taken, so that labels find room.

use super::paint::{Place, Rect};

/// Side of one cell of the record, sheet units.
const CELL: f64 = 4.0;

/// How bad it is to write over what is there, from 0 to 1: bodies, their borders, lines, texts.
pub(super) const BODY: f64 = 0.04;
pub(super) const BORDER: f64 = 0.15;
pub(super) const LINE: f64 = 0.7;
pub(super) const TEXT: f64 = 1.0;

/// A coarse record of where something is drawn already.
pub(super) struct Occupancy {
    across: usize,
    down: usize,
    taken: Vec<f64>,
}

impl Occupancy {
    /// An empty sheet of a size in sheet units.
    pub(super) fn new(width: f64, height: f64) -> Self {
        let across = (width / CELL).ceil() as usize + 1;
        let down = (height / CELL).ceil() as usize + 1;
        Occupancy { across, down, taken: vec![0.0; across * down] }
    }

    /// Takes a rectangle.
    pub(super) fn take(&mut self, rect: &Rect) {
        self.take_as(TEXT, rect);
    }

    /// Takes a rectangle, unless something heavier is there.
    pub(super) fn take_as(&mut self, weight: f64, rect: &Rect) {
        for cell in self.cells(rect) {
            self.taken[cell] = self.taken[cell].max(weight);
        }
    }

    /// Takes what lies along a line.
    pub(super) fn take_line(&mut self, line: [Place; 2]) {
        for at in along(line) {
            self.take_as(LINE, &at);
        }
    }

    /// Takes the bounding box of a shape; right for small ones.
    pub(super) fn take_shape(&mut self, points: &[Place]) {
        self.take_shape_as(TEXT, points);
    }

    /// The same, unless something heavier is there.
    pub(super) fn take_shape_as(&mut self, weight: f64, points: &[Place]) {
        let Some(&[x, y]) = points.first() else {
            return;
        };
        let start = Rect { left: x, top: y, right: x, bottom: y };
        let bounds = points.iter().fold(start, |rect, &[x, y]| Rect {
            left: rect.left.min(x),
            top: rect.top.min(y),
            right: rect.right.max(x),
            bottom: rect.bottom.max(y),
        });
        self.take_as(weight, &bounds);
    }

    /// How much of a rectangle is taken, from 0 to 1.
    pub(super) fn share(&self, rect: &Rect) -> f64 {
        let cells = self.cells(rect);
        cells.iter().map(|&cell| self.taken[cell]).sum::<f64>() / cells.len().max(1) as f64
    }

    /// How much of a rectangle is taken, square sheet units.
    pub(super) fn load(&self, rect: &Rect) -> f64 {
        self.cells(rect).into_iter().map(|cell| self.taken[cell]).sum::<f64>() * CELL * CELL
    }

    /// How much of a rectangle text covers, square sheet units.
    pub(super) fn text_load(&self, rect: &Rect) -> f64 {
        self.cells(rect).into_iter().filter(|cell| self.taken[*cell] >= TEXT).count() as f64 * CELL * CELL
    }

    /// How much text lies under a line, sheet units.
    pub(super) fn text_under(&self, line: [Place; 2]) -> f64 {
        let cells = along(line).flat_map(|at| self.cells(&at));
        CELL * cells.filter(|&cell| self.taken[cell] >= TEXT).count() as f64
    }

    fn cells(&self, rect: &Rect) -> Vec<usize> {
        // A cast of a float to an integer saturates, so numbers off the sheet end at its edge.
        let column = |x: f64| ((x / CELL) as usize).min(self.across - 1);
        let row = |y: f64| ((y / CELL) as usize).min(self.down - 1);
        let mut cells = Vec::new();
        for y in row(rect.top)..=row(rect.bottom) {
            cells.extend((column(rect.left)..=column(rect.right)).map(|x| y * self.across + x));
        }
        cells
    }
}

/// Points of a line, a cell from each other.
fn along([from, to]: [Place; 2]) -> impl Iterator<Item = Rect> {
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    // A cast of a float to an integer saturates; no line on a sheet has more points.
    let steps = ((length / CELL).ceil() as usize).clamp(1, 10_000);
    (0..=steps).map(move |step| {
        let [x, y] = [0, 1].map(|k| from[k] + (to[k] - from[k]) * step as f64 / steps as f64);
        Rect { left: x, top: y, right: x, bottom: y }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_taken_is_counted() {
        let mut sheet = Occupancy::new(100.0, 100.0);
        let left = Rect { left: 0.0, top: 0.0, right: 49.0, bottom: 99.0 };
        sheet.take(&left);
        assert_eq!(sheet.share(&left), 1.0);
        assert_eq!(sheet.share(&Rect { left: 60.0, right: 90.0, ..left }), 0.0);
        let both = sheet.share(&Rect { left: 0.0, right: 99.0, ..left });
        assert!((0.4..0.6).contains(&both));
    }

    #[test]
    fn numbers_off_the_sheet_do_no_harm() {
        let mut sheet = Occupancy::new(10.0, 10.0);
        sheet.take_shape(&[[-1e300, 5.0], [f64::NAN, 1e300]]);
        sheet.take_shape(&[]);
    }
}
