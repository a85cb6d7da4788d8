//! Positions of axes over motions: a chart for each axis that moves.

use super::chart::{self, Chart, Title};
use super::figure::{self, Figure, MARGIN};
use super::font;
use super::maps::GAP;
use super::paint::{Anchor, Place, Rect, Sheet};
use super::palette::{self, GREY, INK};
use flank_export::MotionTable;
use flank_export::Unit;
use flank_export::text::one_line;
use flank_export::text::{dimension, levelled};

/// What an axis moves less than this share of its size is rounding.
const ROUNDING: f64 = 1e-9;

/// One axis over one motion, in the units of files.
struct Curve<'a> {
    table: &'a MotionTable,
    axis: usize,
    points: Vec<[f64; 2]>,
}

/// Arranges the charts on a sheet of this size.
pub(super) fn compose(tables: &[MotionTable], [width, height]: [f64; 2]) -> Figure {
    let job = tables.first().map_or(String::new(), |table| one_line(&table.header.job));
    let title = format!("{job}: axes over the motion");
    let mut sheet = Sheet::default();
    if let Some(table) = tables.first() {
        figure::write_heading(&title, &table.header, width - 2.0 * MARGIN, &mut sheet);
    }
    let curves: Vec<Curve<'_>> = tables.iter().flat_map(curves).collect();
    let (moving, resting): (Vec<&Curve<'_>>, Vec<&Curve<'_>>) = curves.iter().partition(|curve| curve.moves());
    let area = Rect { left: MARGIN, top: 118.0, right: width - MARGIN, bottom: height - 92.0 };
    if moving.is_empty() {
        sheet.text(area.middle(), Anchor::Middle, 20.0, GREY, "nothing to draw: no axis moves");
    }
    for (curve, rect) in moving.iter().zip(figure::places(moving.len(), area, GAP)) {
        curve.draw(rect, &mut sheet);
    }
    let caption = caption(&moving, &resting);
    figure::write_caption(&caption, [width, height], &mut sheet);
    Figure { title, caption, items: sheet.items }
}

fn curves(table: &MotionTable) -> impl Iterator<Item = Curve<'_>> {
    (0..table.axes.len()).map(move |axis| {
        let unit = table.axes[axis].unit();
        let points = table.rows.iter().filter_map(|row| {
            let point = [table.motion.unit.written(row.motion), unit.written(*row.axes.get(axis)?)];
            point.iter().all(|x| x.is_finite()).then_some(point)
        });
        Curve { table, axis, points: points.collect() }
    })
}

/// The axes that move with none of the motions, with their positions.
fn caption(moving: &[&Curve<'_>], resting: &[&Curve<'_>]) -> String {
    let mut still: Vec<String> = Vec::new();
    for curve in resting {
        let axis = &curve.table.axes[curve.axis];
        let moves = moving.iter().any(|other| other.table.axes[other.axis].name == axis.name);
        if let (false, Some([_, at])) = (moves, curve.points.first()) {
            let text = format!("{} {} {}", one_line(&axis.name), dimension(*at), axis.unit().symbol());
            if !still.contains(&text) {
                still.push(text);
            }
        }
    }
    if still.is_empty() { String::new() } else { format!("Stand still: {}.", still.join(", ")) }
}

impl Curve<'_> {
    fn moves(&self) -> bool {
        let [_, [low, high]] = chart::bounds(self.points.iter().copied());
        high - low > ROUNDING * (1.0 + low.abs().max(high.abs()))
    }

    fn draw(&self, rect: Rect, sheet: &mut Sheet) {
        let (axis, motion) = (&self.table.axes[self.axis], &self.table.motion);
        let room = rect.width();
        let kind = if axis.is_rotary { "rotary" } else { "linear" };
        let name = format!("{}, {kind}", one_line(&axis.name));
        sheet.text([rect.left, rect.top + 15.0], Anchor::Start, 17.0, INK, &font::fitted(&name, 17.0, room));
        let about = font::fitted(&self.off_line(), 13.0, room);
        sheet.text([rect.left, rect.top + 35.0], Anchor::Start, 13.0, GREY, &about);
        let map = Rect { top: rect.top + 44.0, ..rect }.inside(chart::MARGINS);
        let [across, up] = chart::bounds(self.points.iter().copied());
        let chart = Chart::filling(map, [across, chart::wider(up, 0.06)]);
        chart.draw_lines(sheet);
        let places: Vec<Place> = self.points.iter().map(|point| chart.place(*point)).collect();
        sheet.line(&places, palette::of_patch(usize::from(!axis.is_rotary) * 2 + 3).towards(INK, 0.25), 2.4);
        let unit = |unit: Unit| if unit == Unit::One { String::new() } else { format!(", {}", unit.symbol()) };
        let below = format!("{}{}", one_line(&motion.name), unit(motion.unit));
        let beside = axis.unit().symbol().to_owned();
        chart.draw_axes([&below, &beside].map(|text| Title { text, numbered: true }), sheet);
    }

    /// How far the curve lies off the straight line between its ends.
    fn off_line(&self) -> String {
        let (Some(first), Some(last)) = (self.points.first(), self.points.last()) else { return String::new() };
        let slope = (last[1] - first[1]) / (last[0] - first[0]);
        let off = self.points.iter().map(|[x, y]| (y - first[1] - slope * (x - first[0])).abs()).fold(0.0, f64::max);
        let size = first[1].abs().max(last[1].abs());
        let unit = self.table.axes[self.axis].unit().symbol();
        if off > ROUNDING * (1.0 + size) {
            format!("up to {} {unit} off a straight line", levelled(off, 0.01 * off))
        } else {
            let motion = &self.table.motion;
            let per = match motion.unit {
                Unit::One => format!("unit of {}", one_line(&motion.name)),
                unit => unit.symbol().to_owned(),
            };
            format!("a straight line, {} {unit} per {per}", levelled(slope, 1e-4 * slope.abs()))
        }
    }
}
