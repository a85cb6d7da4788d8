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
        if item.is_finite() {
            self.items.push(item);
        }
    }

    pub(super) fn line(&mut self, points: &[Place], colour: Colour, width: f64) {
        self.push(Item::Line { points: points.to_vec(), colour, width });
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
