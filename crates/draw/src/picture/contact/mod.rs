//! Contacts of flanks: the pattern as a rolling tester shows it, the least gap, the path, and the error of the pairs of teeth over the roll.

mod curves;
mod flank;

use super::figure::{self, Figure, MARGIN};
use super::maps::GAP;
use super::paint::{Anchor, Rect, Sheet};
use super::palette::GREY;
pub use curves::ErrorCurves;
use flank_export::text::{one_line, with_minus};
use flank_export::{Header, Patch};

/// Contacts side by side on one picture, at most.
pub const MOST_CONTACTS: usize = 4;

/// What a picture shows of contacts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactPicture {
    /// What the marking compound shows on both flanks, with the path of contact, ellipses and transfer points.
    Pattern,
    /// The error of the pairs of teeth over the roll.
    Error,
    /// The least gap over the roll on both flanks, with the line of the compound.
    Gap,
    /// The path of contact on both flanks with roll positions and ellipses.
    Path,
    /// The gap on both flanks and the error.
    Overview,
}

/// What is drawn of contacts.
#[derive(Debug, Clone)]
pub struct ContactDrawing {
    /// Where the numbers come from.
    pub header: Header,
    /// The title of the picture.
    pub title: String,
    /// What the picture shows, in sentences below it.
    pub note: String,
    /// Contacts that stand side by side: of drive and coast side.
    pub contacts: Vec<DrawnContact>,
}

/// A contact of two flanks.
#[derive(Debug, Clone)]
pub struct DrawnContact {
    /// The contact.
    pub name: String,
    /// Thickness of the marking compound, in the unit of the gaps.
    pub film: f64,
    /// Both flanks.
    pub flanks: [DrawnFlank; 2],
    /// The error over the roll.
    pub error: ErrorCurves,
}

/// A flank of a contact.
#[derive(Debug, Clone)]
pub struct DrawnFlank {
    /// Its points, with the least gap to the mate as the first field and the roll position of that as the second.
    pub patch: Patch,
    /// Where its tooth ends, in its frame; nothing where that is not known.
    pub outline: Vec<Vec<[f64; 3]>>,
    /// The path of contact in its frame as pieces, and whether an edge touches along each; nothing for contact along lines.
    pub path: Vec<(bool, Vec<[f64; 3]>)>,
    /// Where the contact is at round roll positions.
    pub stations: Vec<Station>,
    /// Where the contact is in the middle, and where pairs of teeth hand over.
    pub marks: Vec<ContactMark>,
}

/// The contact at a roll position, in the frame of a flank.
#[derive(Debug, Clone)]
pub struct Station {
    /// The roll position.
    pub label: String,
    /// What touches there.
    pub shape: StationShape,
}

/// What touches at a roll position.
#[derive(Debug, Clone)]
pub enum StationShape {
    /// A point, with the ellipse within the film; that may reach beyond the flank.
    Point {
        /// The point of contact.
        position: [f64; 3],
        /// The ellipse; empty where there is none.
        ellipse: Vec<[f64; 3]>,
    },
    /// The line on which the second field of the flank, the roll position of the least gap, has this value.
    Line(f64),
}

/// A place on the path.
#[derive(Debug, Clone)]
pub struct ContactMark {
    /// Whether it is where pairs of teeth hand over, and not the middle.
    pub is_transfer: bool,
    /// What it is.
    pub label: String,
    /// In the frame of the flank.
    pub position: [f64; 3],
}

/// Arranges a picture on a sheet of this size.
pub(super) fn compose(of: &ContactDrawing, kind: ContactPicture, [width, height]: [f64; 2]) -> Figure {
    let title = one_line(&of.title);
    let mut sheet = Sheet::default();
    figure::write_heading(&title, &of.header, width - 2.0 * MARGIN, &mut sheet);
    let area = Rect { left: MARGIN, top: 118.0, right: width - MARGIN, bottom: height - 92.0 };
    let contacts = &of.contacts[..of.contacts.len().min(MOST_CONTACTS)];
    if contacts.is_empty() {
        sheet.text(area.middle(), Anchor::Middle, 20.0, GREY, "nothing to draw");
    }
    let has_error = matches!(kind, ContactPicture::Error | ContactPicture::Overview);
    for (column, contact) in contacts.iter().enumerate() {
        let flanks = if kind == ContactPicture::Error { &[][..] } else { &contact.flanks[..] };
        let down = flanks.len() + usize::from(has_error);
        let rects = (0..down).map(|row| cell(area, [column, contacts.len()], [row, down]));
        for (row, rect) in rects.enumerate() {
            match flanks.get(row) {
                Some(flank) => flank::draw(contact, flank, kind, rect, &mut sheet),
                None => contact.error.draw(&contact.name, rect, &mut sheet),
            }
        }
    }
    let caption = with_minus(&one_line(&of.note));
    figure::write_caption(&caption, [width, height], &mut sheet);
    Figure { title, caption, items: sheet.items }
}

/// A cell of a table: its column among so many, and its row.
fn cell(area: Rect, [column, across]: [usize; 2], [row, down]: [usize; 2]) -> Rect {
    let size = |room: f64, count: usize| (room + GAP) / count as f64 - GAP;
    let (width, height) = (size(area.width(), across), size(area.height(), down));
    let (left, top) = (area.left + column as f64 * (width + GAP), area.top + row as f64 * (height + GAP));
    Rect { left, top, right: left + width, bottom: top + height }
}
