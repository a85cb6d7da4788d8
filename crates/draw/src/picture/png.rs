//! The display list as pixels.

use rayon::prelude::*;
use tiny_skia::{Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, Transform};
use ttf_parser::OutlineBuilder;

use super::Picture;
use super::font;
use super::paint::{Colour, Item, Place};
use crate::picture::PictureError;

/// Rows of pixels that one thread paints. How many threads there are does not change them, nor the file.
const BAND: u32 = 240;
/// Rows that it paints beyond these: curves that the edge of a painting cuts are not quite as they are within it.
const BEYOND: u32 = 24;

/// The picture as a PNG file: the same shapes as in the SVG.
pub(super) fn file(picture: &Picture) -> Result<Vec<u8>, PictureError> {
    let (width, height) = (picture.width, picture.height);
    let tops: Vec<u32> = (0..height).step_by(BAND as usize).collect();
    let rows: Vec<[f64; 2]> = picture.items.iter().map(|item| rows(item).map(|row| row * picture.unit)).collect();
    let bands = tops.par_iter().map(|&top| {
        let bottom = height.min(top + BAND);
        let (first, end) = (top.saturating_sub(BEYOND), height.min(bottom + BEYOND));
        let mut pixels = Pixmap::new(width, end - first)?;
        pixels.fill(Color::WHITE);
        let to_pixels = Transform::from_scale(picture.unit as f32, picture.unit as f32);
        let to_band = to_pixels.post_translate(0.0, -(first as f32));
        let is_seen = |[from, to]: &[f64; 2]| *from <= f64::from(bottom) && *to >= f64::from(top);
        let seen = picture.items.iter().zip(&rows).filter(|(_, rows)| is_seen(rows));
        seen.for_each(|(item, _)| draw(item, to_band, &mut pixels));
        // three channels, as the ground is white everywhere
        let [from, to] = [top, bottom].map(|row| 4 * (row - first) as usize * width as usize);
        let own = pixels.data()[from..to].chunks_exact(4);
        let mut colours = Vec::with_capacity(3 * own.len());
        own.for_each(|pixel| colours.extend_from_slice(&pixel[..3]));
        Some(colours)
    });
    let bands = bands.collect::<Option<Vec<Vec<u8>>>>().filter(|_| width > 0 && height > 0);
    let colours = bands.ok_or(PictureError::TooLarge { width, height })?.concat();
    encoded(&colours, (width, height)).map_err(|error| PictureError::Encoding(error.to_string()))
}

/// Lines as they are: flat colours pack best so.
fn encoded(colours: &[u8], (width, height): (u32, u32)) -> Result<Vec<u8>, png::EncodingError> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    // a third longer than the shortest, in a tenth of the time
    encoder.set_deflate_compression(png::DeflateCompression::Level(1));
    encoder.set_filter(png::Filter::NoFilter);
    encoder.write_header()?.write_image_data(colours)?;
    Ok(file)
}

/// The highest and the lowest place of an item on the sheet, with room for the widths of lines and what letters have beyond their line.
fn rows(item: &Item) -> [f64; 2] {
    let (heights, beyond): (&mut dyn Iterator<Item = f64>, f64) = match item {
        Item::Polygon { points, width, .. } | Item::Line { points, width, .. } => {
            (&mut points.iter().map(|[_, y]| *y), width + 1.0)
        }
        Item::Text { at, size, .. } => (&mut std::iter::once(at[1]), 2.0 * size),
    };
    let [low, high] = heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], y| [low.min(y), high.max(y)]);
    [low - beyond, high + beyond]
}

fn draw(item: &Item, to_pixels: Transform, pixels: &mut Pixmap) {
    match item {
        Item::Polygon { points, fill, outline, width } => {
            // one shape takes less than half the time of a shape and its outline
            let whole = (fill == outline).then(|| grown(points, 0.5 * width)).flatten();
            if let Some(path) = path_through(whole.as_deref().unwrap_or(points), true) {
                pixels.fill_path(&path, &paint(*fill), FillRule::Winding, to_pixels, None);
                if whole.is_none() {
                    pixels.stroke_path(&path, &paint(*outline), &pen(*width), to_pixels, None);
                }
            }
        }
        Item::Line { points, colour, width } => {
            if let Some(path) = path_through(points, false) {
                pixels.stroke_path(&path, &paint(*colour), &pen(*width), to_pixels, None);
            }
        }
        Item::Text { at, size, colour, text } => {
            let scale = font::scale(*size) as f32;
            let to_sheet = Transform::from_row(scale, 0.0, 0.0, -scale, at[0] as f32, at[1] as f32);
            let mut line = TextPath { builder: PathBuilder::new(), shift: 0.0 };
            for placed in font::layout(text) {
                line.shift = placed.at as f32;
                font::outline(placed.glyph, &mut line);
            }
            if let Some(path) = line.builder.finish() {
                let transform = to_pixels.pre_concat(to_sheet);
                pixels.fill_path(&path, &paint(*colour), FillRule::Winding, transform, None);
            }
        }
    }
}

/// A triangle or a convex quadrangle with what is no farther from it than `by`; round corners are cut twice, a twelfth of `by`
/// farther out at a right angle. None of other polygons.
fn grown(points: &[Place], by: f64) -> Option<Vec<Place>> {
    let count = points.len();
    if !(3..=4).contains(&count) {
        return None;
    }
    let along: Vec<Place> = (0..count).map(|k| direction(points[k], points[(k + 1) % count])).collect::<Option<_>>()?;
    // how each corner turns: it lies between the side before it and its own
    let turn = |k: usize| {
        let ([x, y], [u, v]) = (along[(k + count - 1) % count], along[k]);
        (x * v - y * u).atan2(x * u + y * v)
    };
    let side = turn(0).signum();
    if !(0..count).all(|k| turn(k) * side > 1e-6) {
        return None;
    }
    let corner = |k: usize| {
        let ([x, y], before, after) = (points[k], along[(k + count - 1) % count], along[k]);
        let cut = (0.25 * turn(k).abs()).tan();
        let beside = |[u, v]: Place, along: f64| [x + by * (side * v + along * u), y + by * (along * v - side * u)];
        [beside(before, cut), beside(after, -cut)]
    };
    Some((0..count).flat_map(corner).collect())
}

fn direction(from: Place, to: Place) -> Option<Place> {
    let [x, y] = [to[0] - from[0], to[1] - from[1]];
    let length = x.hypot(y);
    (length > 1e-6).then(|| [x / length, y / length])
}

fn path_through(points: &[Place], closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    let (first, rest) = points.split_first()?;
    builder.move_to(first[0] as f32, first[1] as f32);
    for point in rest {
        builder.line_to(point[0] as f32, point[1] as f32);
    }
    if closed {
        builder.close();
    }
    builder.finish()
}

fn paint(colour: Colour) -> Paint<'static> {
    let [red, green, blue] = colour.0;
    let mut paint = Paint::default();
    paint.set_color_rgba8(red, green, blue, 255);
    paint
}

fn pen(width: f64) -> Stroke {
    Stroke { width: width as f32, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() }
}

/// Collects the glyphs of a line of text into one path, font units.
struct TextPath {
    builder: PathBuilder,
    shift: f32,
}

impl OutlineBuilder for TextPath {
    fn move_to(&mut self, x: f32, y: f32) {
        self.builder.move_to(self.shift + x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.builder.line_to(self.shift + x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.builder.quad_to(self.shift + x1, y1, self.shift + x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.builder.cubic_to(self.shift + x1, y1, self.shift + x2, y2, self.shift + x, y);
    }

    fn close(&mut self) {
        self.builder.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_grows_on_all_sides_whichever_way_round_it_is() {
        let mut square = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
        for _ in 0..2 {
            let grown = grown(&square, 1.0).expect("it is convex");
            assert_eq!(grown.len(), 8);
            for [x, y] in grown {
                let off = |x: f64| (x - 5.0).abs();
                let (near, far) = (off(x).min(off(y)), off(x).max(off(y)));
                assert!((far - 6.0).abs() < 1e-12 && (near - 5.0 - (std::f64::consts::PI / 8.0).tan()).abs() < 1e-12);
            }
            square.reverse();
        }
        assert_eq!(grown(&[[0.0, 0.0], [10.0, 10.0], [10.0, 0.0], [0.0, 10.0]], 1.0), None, "it crosses itself");
        assert_eq!(grown(&[[0.0, 0.0], [10.0, 0.0], [20.0, 0.0]], 1.0), None, "it has no area");
        assert_eq!(grown(&[[0.0, 0.0]; 4], 1.0), None);
    }
}
