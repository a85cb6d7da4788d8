//! Two axes with round numbers around a rectangle.

use super::font;
use super::levels::round_up;
use super::paint::{Anchor, Place, Rect, Sheet};
use super::palette::{FAINT, GREY, INK};
use flank_export::text::levelled;

/// Room that numbers and titles need outside the rectangle: left, above, right, below.
pub(super) const MARGINS: [f64; 4] = [52.0, 22.0, 12.0, 42.0];

/// About so far apart are the numbers along an axis at least, across and up; sheet units.
const SPACING: [f64; 2] = [50.0, 27.0];
const SIZE: f64 = 13.0;

/// A rectangle of the sheet in which quantities go across and up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Chart {
    pub(super) rect: Rect,
    /// What lies in the lower left corner.
    low: [f64; 2],
    /// Sheet units per unit of what goes across, and of what goes up.
    pub(super) scale: [f64; 2],
}

/// What goes along an axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Title<'a> {
    pub(super) text: &'a str,
    /// Whether numbers stand beside it.
    pub(super) numbered: bool,
}

impl Chart {
    /// From the lowest to the highest of both quantities; one that does not change is put into the middle.
    pub(super) fn filling(rect: Rect, bounds: [[f64; 2]; 2]) -> Chart {
        let [across, up] = bounds.map(spread);
        let scale = [rect.width() / (across[1] - across[0]), rect.height() / (up[1] - up[0])];
        Chart { rect, low: [across[0], up[0]], scale }
    }

    /// The same with both quantities in mm and one scale, `stretch` times as large upwards, around the middle of the bounds.
    pub(super) fn in_proportion(rect: Rect, bounds: [[f64; 2]; 2], stretch: f64) -> Chart {
        let [across, up] = bounds.map(spread);
        let scale = (rect.width() / (across[1] - across[0])).min(rect.height() / (up[1] - up[0]) / stretch);
        let scale = [scale, scale * stretch];
        let half = [0.5 * rect.width() / scale[0], 0.5 * rect.height() / scale[1]];
        let low = [0.5 * (across[0] + across[1]) - half[0], 0.5 * (up[0] + up[1]) - half[1]];
        Chart { rect, low, scale }
    }

    /// The same scales in another rectangle, around the same middle.
    pub(super) fn moved_to(&self, rect: Rect) -> Chart {
        let more = [rect.width() - self.rect.width(), rect.height() - self.rect.height()];
        Chart { rect, low: [0, 1].map(|k| self.low[k] - 0.5 * more[k] / self.scale[k]), ..*self }
    }

    pub(super) fn place(&self, [across, up]: [f64; 2]) -> Place {
        [self.rect.left + self.scale[0] * (across - self.low[0]), self.rect.bottom - self.scale[1] * (up - self.low[1])]
    }

    /// Draws frame, numbers and titles: the one of what goes up stands above its axis.
    pub(super) fn draw_axes(&self, [across, up]: [Title<'_>; 2], sheet: &mut Sheet) {
        let Rect { left, top, right, bottom } = self.rect;
        if across.numbered {
            for (x, text) in self.ticks(0) {
                let at = self.place([x, self.low[1]])[0];
                sheet.line(&[[at, bottom], [at, bottom + 5.0]], INK, 1.0);
                sheet.text([at, bottom + 18.0], Anchor::Middle, SIZE, INK, &text);
            }
        }
        if up.numbered {
            for (y, text) in self.ticks(1) {
                let at = self.place([self.low[0], y])[1];
                sheet.line(&[[left - 5.0, at], [left, at]], INK, 1.0);
                sheet.text([left - 9.0, at + 0.35 * SIZE], Anchor::End, SIZE, INK, &text);
            }
        }
        sheet.line(&[[left, top], [right, top], [right, bottom], [left, bottom], [left, top]], INK, 1.0);
        let down = bottom + if across.numbered { 35.0 } else { 18.0 };
        sheet.text([0.5 * (left + right), down], Anchor::Middle, SIZE, GREY, across.text);
        let from = (left - if up.numbered { MARGINS[0] - 8.0 } else { 0.0 }).max(0.0);
        sheet.text([from, top - 11.0], Anchor::Start, SIZE, GREY, up.text);
    }

    /// Faint lines across the rectangle where the numbers stand.
    pub(super) fn draw_lines(&self, sheet: &mut Sheet) {
        let Rect { left, top, right, bottom } = self.rect;
        for (x, _) in self.ticks(0) {
            let at = self.place([x, self.low[1]])[0];
            sheet.line(&[[at, top], [at, bottom]], FAINT, 0.6);
        }
        for (y, _) in self.ticks(1) {
            let at = self.place([self.low[0], y])[1];
            sheet.line(&[[left, at], [right, at]], FAINT, 0.6);
        }
    }

    /// Round numbers along an axis with their texts.
    fn ticks(&self, axis: usize) -> Vec<(f64, String)> {
        let room = [self.rect.width(), self.rect.height()][axis];
        let (low, span) = (self.low[axis], room / self.scale[axis]);
        let mut step = round_up(span / (room / SPACING[axis]).max(1.0));
        // a single number is no scale
        while span / step < 2.0 {
            step = round_up(0.4 * step);
        }
        if !(step > 0.0 && step.is_finite() && (low / step).abs() < 1e12) {
            return Vec::new();
        }
        let (first, last) = ((low / step - 1e-6).ceil(), ((low + span) / step + 1e-6).floor());
        let ticks = (0..=(last - first).max(0.0) as usize).map(|k| (first + k as f64) * step);
        let texts: Vec<(f64, String)> = ticks.map(|x| (x, levelled(x, step))).collect();
        let widest = texts.iter().map(|(_, text)| font::width(text, SIZE)).fold(0.0, f64::max);
        let every = if axis == 0 { ((widest + 12.0) / (step * self.scale[0])).ceil().max(1.0) as usize } else { 1 };
        texts.into_iter().step_by(every).collect()
    }
}

/// The bounds, wider where they are the same or no numbers.
fn spread([low, high]: [f64; 2]) -> [f64; 2] {
    let grain = 1e-9 * (low.abs() + high.abs());
    if !(high - low).is_finite() {
        [0.0, 1.0]
    } else if high - low > grain {
        [low, high]
    } else {
        let more = 0.5 * low.abs().max(1.0);
        [low - more, high + more]
    }
}

/// The least and the greatest of each coordinate.
pub(super) fn bounds(places: impl Iterator<Item = [f64; 2]>) -> [[f64; 2]; 2] {
    let none = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    places.fold(none, |[across, up], [x, y]| [[across[0].min(x), across[1].max(x)], [up[0].min(y), up[1].max(y)]])
}

/// Bounds with a share of their width more on each side.
pub(super) fn wider([low, high]: [f64; 2], share: f64) -> [f64; 2] {
    let more = share * (high - low);
    [low - more, high + more]
}

#[cfg(test)]
mod tests {
    use super::*;

    const RECT: Rect = Rect { left: 100.0, top: 50.0, right: 500.0, bottom: 250.0 };

    #[test]
    fn proportion_is_kept_and_the_middle_stays() {
        let chart = Chart::in_proportion(RECT, [[-10.0, 10.0], [30.0, 32.0]], 2.0);
        assert_eq!(chart.place([0.0, 31.0]), [300.0, 150.0]);
        assert_eq!(chart.scale, [20.0, 40.0]);
    }

    #[test]
    fn numbers_are_round_and_apart() {
        let chart = Chart::filling(RECT, [[-0.31, 0.42], [1000.0, 1001.0]]);
        let texts: Vec<String> = chart.ticks(0).into_iter().map(|(_, text)| text).collect();
        let tenths = ["\u{2212}0.3", "\u{2212}0.2", "\u{2212}0.1", "0.0", "0.1", "0.2", "0.3", "0.4"];
        assert_eq!(texts, tenths, "55 units apart, as the widest of them is not");
        assert!(chart.ticks(1).len() >= 5);
    }

    #[test]
    fn no_bounds_do_harm() {
        for odd in [[f64::INFINITY, f64::NEG_INFINITY], [f64::NAN, 1.0], [5.0, 5.0], [0.0, 0.0], [1e300, 1e300]] {
            let chart = Chart::filling(RECT, [odd, odd]);
            assert!(chart.scale.iter().all(|scale| scale.is_finite() && *scale > 0.0), "{odd:?}");
            assert!(chart.ticks(0).len() < 20);
        }
    }
}
