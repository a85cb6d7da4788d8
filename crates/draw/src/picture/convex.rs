//! Convex polygons in one colour as pixels.
//!
//! Of each pixel exactly the share is painted that the polygon covers. A row of pixels is looked at by itself: each side of the polygon that
//! crosses it leaves its height and the area beside it in the columns that it passes, and their sums from the left are the shares (as font-rs does).

use tiny_skia::{Pixmap, PremultipliedColorU8};

use super::paint::{Colour, Place};

/// Paints convex polygons, with room that it uses again for the next one.
#[derive(Default)]
pub(super) struct ConvexPainter {
    sides: Vec<Side>,
    /// Of the columns of a row what sides add to the share that is covered from there on.
    steps: Vec<f64>,
}

/// A side that is not level, from its upper end to its lower one.
struct Side {
    rows: [f64; 2],
    /// The column of its upper end, and how many it passes in a row.
    from: f64,
    slope: f64,
    is_rising: bool,
}

impl ConvexPainter {
    /// Paints a convex polygon over an opaque ground; `points` in pixels, right and down, whichever way round.
    pub(super) fn fill(&mut self, points: &[Place], colour: Colour, pixels: &mut Pixmap) {
        let [red, green, blue] = colour.0;
        let Some(paint) = PremultipliedColorU8::from_rgba(red, green, blue, 255) else { return };
        let (width, height) = (pixels.width() as usize, pixels.height() as usize);
        self.steps.resize(width + 2, 0.0);
        self.sides.clear();
        let next = points.iter().cycle().skip(1);
        self.sides.extend(points.iter().zip(next).filter_map(|(from, to)| Side::between(*from, *to)));
        let rows = self.sides.iter().map(|side| side.rows);
        let [low, high] =
            rows.fold([f64::INFINITY, f64::NEG_INFINITY], |all, own| [all[0].min(own[0]), all[1].max(own[1])]);
        for row in (low.max(0.0) as usize)..(high.clamp(0.0, height as f64).ceil() as usize) {
            let [a, b] = self.add_row(row as f64, width as f64);
            let own = &mut pixels.pixels_mut()[row * width..][..width];
            // between both sides the share is the same
            let (inner, beyond) = (a[1].min(b[1]) + 1, a[0].max(b[0]));
            let (first, last) = (a[0].min(b[0]), a[1].max(b[1]));
            let mut sum = 0.0;
            if inner < beyond {
                self.paint_sides([first, inner], &mut sum, paint, own);
                blend(&mut own[inner..beyond], paint, share_of(sum));
                self.paint_sides([beyond, last + 1], &mut sum, paint, own);
            } else {
                self.paint_sides([first, last + 1], &mut sum, paint, own);
            }
        }
    }

    /// Paints columns in which there are sides; `sum` is the share before them, and then behind.
    fn paint_sides(
        &mut self,
        [from, to]: [usize; 2],
        sum: &mut f64,
        paint: PremultipliedColorU8,
        own: &mut [PremultipliedColorU8],
    ) {
        for (column, step) in (from..to).zip(&mut self.steps[from..to]) {
            *sum += std::mem::take(step);
            if let Some(pixel) = own.get_mut(column) {
                blend(std::slice::from_mut(pixel), paint, share_of(*sum));
            }
        }
    }

    /// Adds what the sides within a row leave in its columns; the first and the last of these, of the sides that fall and of those that rise.
    fn add_row(&mut self, top: f64, width: f64) -> [[usize; 2]; 2] {
        let mut columns = [[usize::MAX, 0]; 2];
        for Side { rows, from, slope, is_rising } in &self.sides {
            let (low, high) = (rows[0].max(top), rows[1].min(top + 1.0));
            if low >= high {
                continue;
            }
            let across = |y: f64| (from + slope * (y - rows[0])).clamp(0.0, width);
            let rise = if *is_rising { low - high } else { high - low };
            let [left, right] = add_side(&mut self.steps, [across(low), across(high)], rise);
            let own = &mut columns[usize::from(*is_rising)];
            *own = [own[0].min(left), own[1].max(right)];
        }
        // both or none
        if columns[0][0] == usize::MAX || columns[1][0] == usize::MAX { [[0, 0]; 2] } else { columns }
    }
}

impl Side {
    fn between(from: Place, to: Place) -> Option<Side> {
        let is_rising = to[1] < from[1];
        let [upper, lower] = if is_rising { [to, from] } else { [from, to] };
        let height = lower[1] - upper[1];
        let slope = (lower[0] - upper[0]) / height;
        (height > 0.0).then_some(Side { rows: [upper[1], lower[1]], from: upper[0], slope, is_rising })
    }
}

/// Adds a side between two places in a row; the columns that it changes.
fn add_side(steps: &mut [f64], [a, b]: [f64; 2], rise: f64) -> [usize; 2] {
    let (from, to) = (a.min(b), a.max(b));
    let (first, last) = (from as usize, to as usize);
    if first == last {
        let right = rise * (first as f64 + 1.0 - 0.5 * (from + to));
        steps[first] += right;
        steps[first + 1] += rise - right;
        return [first, first + 1];
    }
    // of each column the part of the rise in it, and what of that lies to the right of the side; what is left is added in the next one
    let slope = rise / (to - from);
    let mut before = 0.0;
    for (column, step) in (first..=last).zip(&mut steps[first..]) {
        let (start, end) = (from.max(column as f64), to.min(column as f64 + 1.0));
        let part = (end - start) * slope;
        let right = part * (column as f64 + 1.0 - 0.5 * (start + end));
        *step += before + right;
        before = part - right;
    }
    steps[last + 1] += before;
    [first, last + 1]
}

/// Of 256; the ways round differ in the sign.
fn share_of(sum: f64) -> u32 {
    (256.0 * sum.abs() + 0.5) as u32
}

/// Paints a colour with a share of 256 over others; all are opaque.
fn blend(pixels: &mut [PremultipliedColorU8], paint: PremultipliedColorU8, share: u32) {
    match share {
        0 => {}
        256.. => pixels.fill(paint),
        _ => pixels.iter_mut().for_each(|pixel| *pixel = mixed(*pixel, paint, share)),
    }
}

/// A colour with a share of 256 of another one over it; both are opaque.
fn mixed(under: PremultipliedColorU8, over: PremultipliedColorU8, share: u32) -> PremultipliedColorU8 {
    let mix = |a: u8, b: u8| ((u32::from(a) * (256 - share) + u32::from(b) * share + 128) >> 8) as u8;
    let [red, green, blue] =
        [mix(under.red(), over.red()), mix(under.green(), over.green()), mix(under.blue(), over.blue())];
    PremultipliedColorU8::from_rgba(red, green, blue, 255).unwrap_or(over)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Black on white: of each pixel how much is covered, row by row.
    fn covered(points: &[Place], [width, height]: [u32; 2]) -> Vec<f64> {
        let mut pixels = Pixmap::new(width, height).expect("a small size");
        pixels.fill(tiny_skia::Color::WHITE);
        ConvexPainter::default().fill(points, Colour([0, 0, 0]), &mut pixels);
        assert!(pixels.pixels().iter().all(|pixel| pixel.alpha() == 255));
        pixels.pixels().iter().map(|pixel| 1.0 - f64::from(pixel.red()) / 255.0).collect()
    }

    /// The share of a pixel in a convex polygon, by a fine grid of places.
    fn counted(points: &[Place], [column, row]: [usize; 2]) -> f64 {
        const FINE: usize = 64;
        let is_inside = |[x, y]: Place| {
            let turn = |k: usize| {
                let ([a, b], [c, d]) = (points[k], points[(k + 1) % points.len()]);
                (c - a) * (y - b) - (d - b) * (x - a)
            };
            let turns: Vec<f64> = (0..points.len()).map(turn).collect();
            turns.iter().all(|turn| *turn > 0.0) || turns.iter().all(|turn| *turn < 0.0)
        };
        let fine = |k: usize| (k as f64 + 0.5) / FINE as f64;
        let places = (0..FINE * FINE).map(|k| [column as f64 + fine(k % FINE), row as f64 + fine(k / FINE)]);
        places.filter(|place| is_inside(*place)).count() as f64 / (FINE * FINE) as f64
    }

    #[test]
    fn each_pixel_has_the_share_that_is_covered() {
        let shapes: [&[Place]; 6] = [
            &[[1.25, 1.5], [6.5, 1.5], [6.5, 4.75], [1.25, 4.75]],
            &[[0.3, 0.2], [11.7, 3.1], [5.2, 7.9]],
            &[[5.0, 0.0], [12.0, 4.0], [5.0, 8.0], [0.0, 4.0]],
            &[[2.1, 3.2], [2.6, 3.3], [2.4, 3.8]],
            &[[0.5, 2.0], [11.5, 2.4], [11.5, 2.6], [0.5, 2.2]],
            // beyond all sides of the picture
            &[[-20.0, -15.0], [30.0, -10.0], [25.0, 20.0], [-18.0, 22.0]],
        ];
        for shape in shapes {
            let turned: Vec<Place> = shape.iter().rev().copied().collect();
            for points in [shape, &turned] {
                let found = covered(points, [12, 8]);
                for (k, share) in found.iter().enumerate() {
                    let wanted = counted(points, [k % 12, k / 12]);
                    // a 64th of a side for the grid of places, and a 256th for the colour
                    assert!((share - wanted).abs() < 0.03, "{points:?}, pixel {k}: {share} {wanted}");
                }
            }
        }
    }

    /// Painted in parts, as threads do, a polygon is what it is in one piece.
    #[test]
    fn rows_do_not_depend_on_where_a_painting_begins() {
        let points = [[0.3, 0.2], [11.7, 3.1], [5.2, 7.9]];
        let whole = covered(&points, [12, 8]);
        let lower: Vec<Place> = points.iter().map(|[x, y]| [*x, y - 3.0]).collect();
        assert_eq!(covered(&lower, [12, 5]), whole[36..]);
    }
}
