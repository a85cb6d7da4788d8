//! The display list: what SVG and PNG are both made of.

use super::font;

/// A place on the sheet: right, down, in sheet units.
pub(super) type Place = [f64; 2];

/// A colour by its sRGB bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Colour(pub(super) [u8; 3]);

/// One thing to paint. Later ones cover earlier ones.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Item {
    /// A filled polygon with an outline; an outline in its own colour closes the seam to its neighbours.
    Polygon { points: Vec<Place>, fill: Colour, outline: Colour, width: f64 },
    /// A line with round ends.
    Line { points: Vec<Place>, colour: Colour, width: f64 },
    /// Text that begins at a point of its base line.
    Text { at: Place, size: f64, colour: Colour, text: String },
}

/// Which point of a text is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A rectangle on the sheet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rect {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

/// A sheet that is being painted.
#[derive(Debug, Clone, Default)]
pub(super) struct Sheet {
    pub(super) items: Vec<Item>,
}

impl Item {
    /// What a polygon covers, square sheet units; nothing for lines and text.
    #[cfg(test)]
    pub(super) fn area(&self) -> f64 {
        let Item::Polygon { points, .. } = self else { return 0.0 };
        let next = points.iter().cycle().skip(1);
        0.5 * points.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>().abs()
    }

    fn is_finite(&self) -> bool {
        match self {
            Item::Polygon { points, .. } | Item::Line { points, .. } => {
                points.iter().flatten().all(|number| number.is_finite())
            }
            Item::Text { at, .. } => at.iter().all(|number| number.is_finite()),
        }
    }
}

impl Sheet {
    /// Paints one more item. What has no place on paper (numbers without end) is left out.
    pub(super) fn push(&mut self, item: Item) {
        let is_empty = matches!(&item, Item::Polygon { points, .. } | Item::Line { points, .. } if points.is_empty());
        if item.is_finite() && !is_empty {
            self.items.push(item);
        }
    }

    pub(super) fn line(&mut self, points: &[Place], colour: Colour, width: f64) {
        self.push(Item::Line { points: points.to_vec(), colour, width });
    }

    /// A line of dashes: `pattern` is how long one is and the gap behind it, sheet units.
    pub(super) fn dashes(&mut self, points: &[Place], pattern: [f64; 2], colour: Colour, width: f64) {
        let mut dash: Vec<Place> = Vec::new();
        let (mut stroke, mut left) = (0, pattern[0]);
        for pair in points.windows(2) {
            let [from, to] = [pair[0], pair[1]];
            let length = (to[0] - from[0]).hypot(to[1] - from[1]);
            let at = |along: f64| [0, 1].map(|k| from[k] + (to[k] - from[k]) * along / length);
            let mut along = 0.0;
            // a line that long has no place on paper
            while length > 0.0 && length < 1e5 && along < length {
                let step = left.min(length - along);
                if stroke == 0 {
                    if dash.is_empty() {
                        dash.push(at(along));
                    }
                    dash.push(at(along + step));
                }
                along += step;
                left -= step;
                if left <= 1e-9 {
                    self.line(&std::mem::take(&mut dash), colour, width);
                    stroke = 1 - stroke;
                    left = pattern[stroke];
                }
            }
        }
        self.line(&dash, colour, width);
    }

    pub(super) fn polygon(&mut self, points: &[Place], fill: Colour, outline: Colour, width: f64) {
        self.push(Item::Polygon { points: points.to_vec(), fill, outline, width });
    }

    /// Writes a line of text and says which rectangle it covers.
    pub(super) fn text(&mut self, at: Place, anchor: Anchor, size: f64, colour: Colour, text: &str) -> Rect {
        let covered = text_rect(at, anchor, size, text);
        self.push(Item::Text { at: [covered.left, at[1]], size, colour, text: text.to_owned() });
        covered
    }

    /// A small arrow head at `tip`, pointing along `along` (a unit vector).
    pub(super) fn arrow_head(&mut self, tip: Place, along: Place, length: f64, colour: Colour) {
        let back = |side: f64| {
            let half = 0.32 * length * side;
            [tip[0] - length * along[0] - half * along[1], tip[1] - length * along[1] + half * along[0]]
        };
        self.polygon(&[tip, back(1.0), back(-1.0)], colour, colour, 0.5);
    }
}

impl Rect {
    pub(super) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(super) fn height(&self) -> f64 {
        self.bottom - self.top
    }

    pub(super) fn middle(&self) -> Place {
        [0.5 * (self.left + self.right), 0.5 * (self.top + self.bottom)]
    }

    /// The rectangle without so much on its left, top, right and bottom.
    pub(super) fn inside(&self, [left, top, right, bottom]: [f64; 4]) -> Rect {
        Rect { left: self.left + left, top: self.top + top, right: self.right - right, bottom: self.bottom - bottom }
    }

    pub(super) fn corners(&self) -> [Place; 4] {
        [[self.left, self.top], [self.right, self.top], [self.right, self.bottom], [self.left, self.bottom]]
    }

    pub(super) fn shrunk(&self, by: f64) -> Rect {
        Rect { left: self.left + by, top: self.top + by, right: self.right - by, bottom: self.bottom - by }
    }

    pub(super) fn contains(&self, other: &Rect) -> bool {
        self.left <= other.left && self.top <= other.top && other.right <= self.right && other.bottom <= self.bottom
    }
}

/// The rectangle that a line of text covers, from the height of its capitals to its descenders.
pub(super) fn text_rect(at: Place, anchor: Anchor, size: f64, text: &str) -> Rect {
    let width = font::width(text, size);
    let left = match anchor {
        Anchor::Start => at[0],
        Anchor::Middle => at[0] - 0.5 * width,
        Anchor::End => at[0] - width,
    };
    Rect { left, top: at[1] - 0.78 * size, right: left + width, bottom: at[1] + 0.24 * size }
}

/// The part of a segment inside a rectangle, as two shares of its length.
pub(super) fn clipped(from: Place, to: Place, rect: Rect) -> Option<(f64, f64)> {
    let (mut start, mut end) = (0.0_f64, 1.0_f64);
    let sides = [(0, rect.left, rect.right), (1, rect.top, rect.bottom)];
    for (k, low, high) in sides {
        let step = to[k] - from[k];
        if step.abs() < 1e-9 {
            if from[k] < low || from[k] > high {
                return None;
            }
            continue;
        }
        let (a, b) = ((low - from[k]) / step, (high - from[k]) / step);
        start = start.max(a.min(b));
        end = end.min(a.max(b));
    }
    (start < end).then_some((start, end))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_segment_is_clipped_to_a_rectangle() {
        let rect = Rect { left: 0.0, top: 0.0, right: 10.0, bottom: 10.0 };
        assert_eq!(clipped([-10.0, 5.0], [10.0, 5.0], rect), Some((0.5, 1.0)));
        assert_eq!(clipped([-10.0, 11.0], [10.0, 11.0], rect), None);
        assert_eq!(clipped([-10.0, 0.0], [0.0, 30.0], rect), None);
    }
}
