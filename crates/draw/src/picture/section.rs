//! A section through a tooth space, with the tool where it touches.

use super::chart::{self, Chart, Title};
use super::figure::{self, Figure, MARGIN};
use super::font;
use super::levels::round_up;
use super::paint::{Anchor, Colour, Place, Rect, Sheet, clipped, text_rect};
use super::palette::{self, GREY, INK, WHITE};
use flank_export::Header;
use flank_export::text::one_line;
use flank_export::text::{levelled, with_minus};

const COLUMN: f64 = 300.0;
/// From name to name in the list, and how high the bar of colours is.
const PITCH: f64 = 22.0;
const BAR: f64 = 14.0;
/// Pieces of the bar.
const SHADES: usize = 48;
/// Between the strokes on the side of the steel, and how long they are; sheet units.
const HATCH: [f64; 2] = [9.0, 10.0];
/// How many distances between neighbouring contacts the detail is wide.
const DETAIL: f64 = 1.4;

/// A plane section through a tooth space, and the tool in it in some of the positions in which it makes the surfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Where it comes from.
    pub header: Header,
    /// Where the plane lies, and what else is to be said; written below.
    pub note: String,
    /// The surfaces of the work.
    pub surfaces: Vec<SectionLine>,
    /// Circles about the axis that the plane cuts, such as those of tip and root.
    pub circles: Vec<SectionCircle>,
    /// The motion that the tool's positions differ by, with its unit.
    pub motion: String,
    /// The tool, position by position.
    pub tools: Vec<ToolPosition>,
}

/// Where a surface of revolution meets the plane.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionCircle {
    /// What stands beside it.
    pub name: String,
    /// Whether it stands above.
    pub is_above: bool,
    /// Points across and up in the plane, mm.
    pub points: Vec<[f64; 2]>,
}

/// Where a surface of the work meets the plane.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionLine {
    /// Its name.
    pub name: String,
    /// Points across and up in the plane, mm.
    pub points: Vec<[f64; 2]>,
    /// Out of the steel, for each point; of any length.
    pub normals: Vec<[f64; 2]>,
}

/// A tool where it stands at one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolPosition {
    /// The motion at that moment, in its unit.
    pub value: f64,
    /// Where its surfaces meet the plane, mm.
    pub lines: Vec<Vec<[f64; 2]>>,
    /// Where it touches the work there.
    pub contacts: Vec<[f64; 2]>,
}

/// Arranges section, detail and list on a sheet of this size.
pub(super) fn compose(section: &Section, [width, height]: [f64; 2]) -> Figure {
    let title = format!("{}: section", one_line(&section.header.job));
    let mut sheet = Sheet::default();
    figure::write_heading(&title, &section.header, width - 2.0 * MARGIN, &mut sheet);
    let [main, list, side] = parts(width, height);
    let points: Vec<[f64; 2]> = section.surfaces.iter().flat_map(|line| line.points.iter().copied()).collect();
    if points.is_empty() {
        sheet.text(main.middle(), Anchor::Middle, 20.0, GREY, "nothing to draw: the plane meets no solved surface");
    } else {
        let bounds = chart::bounds(points.into_iter()).map(|ends| chart::wider(ends, 0.12));
        draw(section, &Chart::in_proportion(main, bounds, 1.0), 1.0, &mut sheet);
        draw_list(section, list, &mut sheet);
        if let Some((middle, wide)) = detail(section) {
            let bounds = middle.map(|x| [x - 0.5 * wide, x + 0.5 * wide]);
            let text = format!("detail, {} mm wide", levelled(wide, 0.01 * wide));
            sheet.text([side.left, side.top - 10.0], Anchor::Start, 13.0, GREY, &text);
            draw(section, &Chart::filling(side, bounds), 1.6, &mut sheet);
        }
    }
    let caption = with_minus(&one_line(&section.note));
    figure::write_caption(&caption, [width, height], &mut sheet);
    Figure { title, caption, items: sheet.items }
}

/// Where the section stands, its list, and its detail: beside it, or below it on a sheet that is higher than wide.
fn parts(width: f64, height: f64) -> [Rect; 3] {
    let [width, height] = figure::useful(width, height);
    let right = width - MARGIN;
    let main = Rect { left: MARGIN, top: 118.0, right, bottom: height - 84.0 };
    let side = Rect { left: right - COLUMN, top: height - 396.0, right, bottom: height - 96.0 };
    let [main, list] = if height > width {
        let list = Rect { left: MARGIN, top: side.top, right: side.left - 40.0, bottom: side.bottom };
        [Rect { bottom: side.top - 50.0, ..main }, list]
    } else {
        [Rect { right: side.left - 36.0, ..main }, Rect { top: 122.0, bottom: side.top - 40.0, ..side }]
    };
    [main.inside(chart::MARGINS), list, side]
}

/// A contact and a width that shows some of its neighbours, mm.
fn detail(section: &Section) -> Option<([f64; 2], f64)> {
    let contacts: Vec<[f64; 2]> = section.tools.iter().flat_map(|tool| tool.contacts.iter().copied()).collect();
    let apart = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let nearest = |at: usize| {
        let others = contacts.iter().enumerate().filter(|(k, _)| *k != at);
        others.map(|(_, other)| apart(&contacts[at], other)).filter(|gap| *gap > 0.0).reduce(f64::min)
    };
    // the one that is nearest to the middle of the first surface
    let first = section.surfaces.first()?;
    let middle = first.points.get(first.points.len() / 2)?;
    let at =
        (0..contacts.len()).min_by(|a, b| apart(&contacts[*a], middle).total_cmp(&apart(&contacts[*b], middle)))?;
    Some((*contacts.get(at)?, DETAIL * nearest(at)?))
}

/// Draws all that lies in the chart; `wide` is how much thicker lines are than usual.
fn draw(section: &Section, chart: &Chart, wide: f64, sheet: &mut Sheet) {
    let rect = chart.rect;
    if wide == 1.0 {
        chart.draw_lines(sheet);
    }
    let inside = |line: &[[f64; 2]], colour: Colour, width: f64, sheet: &mut Sheet| {
        let places: Vec<Place> = line.iter().map(|point| chart.place(*point)).collect();
        pieces(&places, rect).iter().for_each(|piece| sheet.line(piece, colour, width));
    };
    for line in &section.surfaces {
        draw_steel(line, chart, sheet);
    }
    for (number, line) in section.surfaces.iter().enumerate() {
        inside(&line.points, of_surface(number), 4.0 * wide, sheet);
    }
    let ends = ends(section);
    for tool in &section.tools {
        for line in &tool.lines {
            inside(line, of_tool(tool.value, ends), 1.1 * wide, sheet);
        }
    }
    for circle in &section.circles {
        draw_circle(circle, chart, wide == 1.0, sheet);
    }
    for contact in section.tools.iter().flat_map(|tool| &tool.contacts) {
        let place = chart.place(*contact);
        if rect.shrunk(3.0).contains(&Rect { left: place[0], top: place[1], right: place[0], bottom: place[1] }) {
            sheet.line(&[place, place], WHITE, 8.0 * wide);
            sheet.line(&[place, place], INK, 5.0 * wide);
        }
    }
    let titles = ["mm", "mm, towards the tip"];
    if wide == 1.0 {
        chart.draw_axes(titles.map(|text| Title { text, numbered: true }), sheet);
    } else {
        let frame = rect.corners();
        sheet.line(&[frame[0], frame[1], frame[2], frame[3], frame[0]], INK, 1.0);
    }
}

/// Short strokes on the side of the steel.
fn draw_steel(line: &SectionLine, chart: &Chart, sheet: &mut Sheet) {
    let places: Vec<Place> = line.points.iter().map(|point| chart.place(*point)).collect();
    let mut left = 0.5 * HATCH[0];
    for (pair, normals) in places.windows(2).zip(line.normals.windows(2)) {
        let [from, to] = [pair[0], pair[1]];
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        // into the steel on the sheet, where up is minus
        let into = [-(normals[0][0] + normals[1][0]), normals[0][1] + normals[1][1]];
        let size = into[0].hypot(into[1]);
        while size > 0.0 && left <= length && length < 1e5 {
            let at = [0, 1].map(|k| from[k] + (to[k] - from[k]) * left / length);
            let half = 0.5f64.sqrt() / size;
            let slant = [half * (into[0] - into[1]), half * (into[0] + into[1])];
            let end = [at[0] + HATCH[1] * slant[0], at[1] + HATCH[1] * slant[1]];
            for piece in pieces(&[at, end], chart.rect) {
                sheet.line(&piece, GREY, 0.8);
            }
            left += HATCH[0];
        }
        left -= length;
    }
}

/// A circle dashed, with its name at its middle.
fn draw_circle(circle: &SectionCircle, chart: &Chart, is_named: bool, sheet: &mut Sheet) {
    let places: Vec<Place> = circle.points.iter().map(|point| chart.place(*point)).collect();
    let inside = pieces(&places, chart.rect);
    for piece in &inside {
        sheet.dashes(piece, [14.0, 5.0], GREY, 1.0);
    }
    let middle = inside.first().map(|piece| piece[piece.len() / 2]);
    if let Some([x, y]) = middle.filter(|_| is_named) {
        let text = one_line(&circle.name);
        // the tip's above it, the root's below: the tool is between
        let at = [x, if circle.is_above { y - 8.0 } else { y + 19.0 }];
        sheet.polygon(&text_rect(at, Anchor::Middle, 13.0, &text).shrunk(-1.0).corners(), WHITE, WHITE, 0.0);
        sheet.text(at, Anchor::Middle, 13.0, GREY, &text);
    }
}

/// The names of the surfaces, and the bar of colours of the tool's positions.
fn draw_list(section: &Section, rect: Rect, sheet: &mut Sheet) {
    let count = section.surfaces.len() as f64;
    let room = if section.tools.is_empty() { rect.height() } else { rect.height() - 70.0 };
    let pitch = (room / count.max(1.0)).clamp(8.0, PITCH);
    let size = 0.7 * pitch;
    let left = rect.left + 36.0;
    for (k, line) in section.surfaces.iter().enumerate() {
        let middle = rect.top + (k as f64 + 0.3) * pitch;
        sheet.line(&[[rect.left, middle], [rect.left + 24.0, middle]], of_surface(k), 4.0);
        let text = font::fitted(&one_line(&line.name), size, rect.right - left);
        sheet.text([left, middle + 0.35 * size], Anchor::Start, size, INK, &text);
    }
    let top = rect.top + count * pitch + 34.0;
    draw_bar(section, Rect { top, bottom: top + BAR, ..rect }, sheet);
}

/// What colour the tool has at which moment, with a stroke for each position that is drawn.
fn draw_bar(section: &Section, bar: Rect, sheet: &mut Sheet) {
    let ends = ends(section);
    let [low, high] = ends;
    if section.tools.is_empty() {
        return;
    }
    let title = font::fitted(&format!("tool at {}", one_line(&section.motion)), 14.0, bar.width());
    sheet.text([bar.left, bar.top - 12.0], Anchor::Start, 14.0, INK, &title);
    let bar = bar.inside([14.0, 0.0, 14.0, 0.0]);
    let place =
        |value: f64| if high > low { bar.left + bar.width() * (value - low) / (high - low) } else { bar.middle()[0] };
    for k in 0..SHADES {
        let at = |k: usize| bar.left + bar.width() * k as f64 / SHADES as f64;
        let colour = of_tool(low + (high - low) * (k as f64 + 0.5) / SHADES as f64, ends);
        sheet.polygon(&Rect { left: at(k), right: at(k + 1), ..bar }.corners(), colour, colour, 1.0);
    }
    for tool in &section.tools {
        sheet.line(&[[place(tool.value), bar.top], [place(tool.value), bar.bottom]], WHITE, 1.4);
    }
    let frame = bar.corners();
    sheet.line(&[frame[0], frame[1], frame[2], frame[3], frame[0]], INK, 0.8);
    let step = round_up((high - low).max(1e-9) / 4.0);
    let [from, to] = [(low / step).ceil() as i64, (high / step).floor() as i64];
    for value in (from..=to).map(|k| k as f64 * step) {
        sheet.line(&[[place(value), bar.bottom], [place(value), bar.bottom + 4.0]], INK, 0.8);
        let text = levelled(value, step);
        sheet.text([place(value), bar.bottom + 18.0], Anchor::Middle, 12.0, INK, &text);
    }
}

/// The least and the greatest moment.
fn ends(section: &Section) -> [f64; 2] {
    let values = section.tools.iter().map(|tool| tool.value);
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    if low <= high { [low, high] } else { [0.0, 0.0] }
}

/// Dark enough for a line on white.
fn of_surface(number: usize) -> Colour {
    palette::of_patch(number).towards(INK, 0.3)
}

/// From dark blue to a yellow that still shows on white.
fn of_tool(value: f64, [low, high]: [f64; 2]) -> Colour {
    let share = if high > low { (value - low) / (high - low) } else { 0.5 };
    palette::of_share(0.06 + 0.7 * share)
}

/// The parts of a line that lie in a rectangle.
fn pieces(places: &[Place], rect: Rect) -> Vec<Vec<Place>> {
    let mut pieces: Vec<Vec<Place>> = Vec::new();
    let mut goes_on = false;
    for pair in places.windows(2) {
        let Some((start, end)) = clipped(pair[0], pair[1], rect) else {
            goes_on = false;
            continue;
        };
        let at = |share: f64| [0, 1].map(|k| pair[0][k] + share * (pair[1][k] - pair[0][k]));
        match pieces.last_mut().filter(|_| goes_on && start == 0.0) {
            Some(piece) => piece.push(at(end)),
            None => pieces.push(vec![at(start), at(end)]),
        }
        goes_on = end == 1.0;
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_cut_at_the_frame() {
        let rect = Rect { left: 0.0, top: 0.0, right: 10.0, bottom: 10.0 };
        let zigzag = [[-5.0, 5.0], [5.0, 5.0], [5.0, 15.0], [15.0, 15.0], [8.0, 8.0]];
        let found = pieces(&zigzag, rect);
        assert_eq!(found, [vec![[0.0, 5.0], [5.0, 5.0], [5.0, 10.0]], vec![[10.0, 10.0], [8.0, 8.0]]]);
    }
}
