//! Positions of axes over motions: a chart for each axis that moves along no straight line, and a table of the others.

use super::chart::{self, Chart, Title};
use super::figure::{self, Figure, MARGIN};
use super::font;
use super::maps::GAP;
use super::paint::{Anchor, Place, Rect, Sheet};
use super::palette::{self, FAINT, GREY, INK};
use flank_export::MotionTable;
use flank_export::Unit;
use flank_export::text::one_line;
use flank_export::text::{dimension, levelled, with_minus};

/// What an axis moves less than this share of its size is rounding.
const ROUNDING: f64 = 1e-9;
/// From row to row of the table.
const ROW: f64 = 25.0;

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
    let (bent, others): (Vec<&Curve<'_>>, Vec<&Curve<'_>>) = curves.iter().partition(|curve| curve.is_bent());
    let lines: Vec<[String; 5]> = straight(&others);
    let area = Rect { left: MARGIN, top: 118.0, right: width - MARGIN, bottom: height - 60.0 };
    if curves.is_empty() {
        sheet.text(area.middle(), Anchor::Middle, 20.0, GREY, "nothing to draw: no axis moves");
    }
    let table = if lines.is_empty() { 0.0 } else { ((lines.len() + 1) as f64 * ROW).min(0.5 * area.height()) };
    let charts = Rect { bottom: area.bottom - table - if bent.is_empty() { 0.0 } else { GAP }, ..area };
    for (curve, rect) in bent.iter().zip(figure::places(bent.len(), charts, GAP)) {
        curve.draw(rect, &mut sheet);
    }
    let top = if bent.is_empty() { area.top } else { area.bottom - table };
    draw_table(&lines, Rect { top, ..area }, &mut sheet);
    Figure { title, caption: String::new(), items: sheet.items }
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

/// What each axis does that moves along straight lines only, motion by motion, and where those stand that move with no motion.
fn straight(curves: &[&Curve<'_>]) -> Vec<[String; 5]> {
    let name = |curve: &Curve<'_>| one_line(&curve.table.axes[curve.axis].name);
    let moving = curves.iter().filter(|curve| curve.moves()).map(|curve| curve.row());
    let is_new = |k: usize| !curves[..k].iter().any(|before| name(before) == name(curves[k]));
    let rests = |k: &usize| is_new(*k) && !curves.iter().any(|other| name(other) == name(curves[*k]) && other.moves());
    let resting = (0..curves.len()).filter(rests).map(|k| curves[k].row());
    moving.chain(resting).collect()
}

/// A row for each axis, as many as there is room for.
fn draw_table(lines: &[[String; 5]], rect: Rect, sheet: &mut Sheet) {
    if lines.is_empty() {
        return;
    }
    let heads = ["axis", "over", "from", "to", "a straight line"].map(str::to_owned);
    let most = (rect.height() / ROW) as usize;
    let shares = [0.0, 0.2, 0.42, 0.62, 0.82];
    let lefts = shares.map(|share| rect.left + share * rect.width());
    for (k, line) in [&heads].into_iter().chain(lines).take(most.max(2)).enumerate() {
        let down = rect.top + (k as f64 + 0.7) * ROW;
        for (column, text) in line.iter().enumerate() {
            let end = lefts.get(column + 1).copied().unwrap_or(rect.right);
            let colour = if k == 0 { GREY } else { INK };
            let text = font::fitted(text, 14.0, end - lefts[column] - 10.0);
            sheet.text([lefts[column], down], Anchor::Start, 14.0, colour, &text);
        }
        let below = down + 0.3 * ROW;
        sheet.line(&[[rect.left, below], [rect.right, below]], FAINT, if k == 0 { 1.4 } else { 0.8 });
    }
}

impl Curve<'_> {
    /// Whether it is neither a point nor a straight line.
    fn is_bent(&self) -> bool {
        self.off_line().is_some_and(|(off, _)| off)
    }

    /// Its name, the motion, both ends, and its rise.
    fn row(&self) -> [String; 5] {
        let (axis, motion) = (&self.table.axes[self.axis], &self.table.motion);
        let unit = axis.unit().symbol();
        let kind = if axis.is_rotary { "rotary" } else { "linear" };
        let name = format!("{}, {kind}", one_line(&axis.name));
        let ends = [self.points.first(), self.points.last()];
        let [from, to] = ends.map(|point| point.map_or(String::new(), |[_, at]| format!("{} {unit}", dimension(*at))));
        match self.off_line().filter(|_| self.moves()) {
            Some((_, rise)) => [name, one_line(&motion.name), from, to, rise].map(|text| with_minus(&text)),
            None => [name, "stands still".to_owned(), from, String::new(), String::new()].map(|text| with_minus(&text)),
        }
    }

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
        let about = font::fitted(&self.off_line().map_or(String::new(), |(_, text)| text), 13.0, room);
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

    /// Whether the curve lies off the straight line between its ends, and by how much; else the rise of that line.
    fn off_line(&self) -> Option<(bool, String)> {
        let (first, last) = (self.points.first()?, self.points.last()?);
        let slope = (last[1] - first[1]) / (last[0] - first[0]);
        let off = self.points.iter().map(|[x, y]| (y - first[1] - slope * (x - first[0])).abs()).fold(0.0, f64::max);
        let size = first[1].abs().max(last[1].abs());
        let unit = self.table.axes[self.axis].unit().symbol();
        if off > ROUNDING * (1.0 + size) {
            return Some((true, format!("up to {} {unit} off a straight line", levelled(off, 0.01 * off))));
        }
        let motion = &self.table.motion;
        let per = match motion.unit {
            Unit::One => format!("unit of {}", one_line(&motion.name)),
            unit => unit.symbol().to_owned(),
        };
        Some((false, format!("{} {unit} per {per}", levelled(slope, 1e-4 * slope.abs()))))
    }
}
