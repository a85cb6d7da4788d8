//! The display list as pixels.

use rayon::prelude::*;
use tiny_skia::{Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, Transform};
use ttf_parser::OutlineBuilder;

use super::Picture;
use super::convex::ConvexPainter;
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
        let mut brush = Brush { unit: picture.unit, top: f64::from(first), convex: ConvexPainter::default() };
        let is_seen = |[from, to]: &[f64; 2]| *from <= f64::from(bottom) && *to >= f64::from(top);
        let seen = picture.items.iter().zip(&rows).filter(|(_, rows)| is_seen(rows));
        seen.for_each(|(item, _)| brush.draw(item, &mut pixels));
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

/// What paints a band of the sheet.
struct Brush {
    /// Pixels per sheet unit.
    unit: f64,
    /// The sheet's row of pixels that is the first one of the band.
    top: f64,
    convex: ConvexPainter,
}

impl Brush {
    fn draw(&mut self, item: &Item, pixels: &mut Pixmap) {
        match item {
            Item::Polygon { points, fill, outline, width } => {
                // one shape instead of a shape and its outline
                let whole = (fill == outline).then(|| grown(points, 0.5 * width)).flatten();
                if let Some(whole) = whole {
                    self.fill_convex(&whole, *fill, pixels);
                } else if let Some(path) = path_through(points, true) {
                    pixels.fill_path(&path, &paint(*fill), FillRule::Winding, self.to_band(), None);
                    pixels.stroke_path(&path, &paint(*outline), &pen(*width), self.to_band(), None);
                }
            }
            Item::Line { points, colour, width } => {
                // most are as short as the cells beside them
                let short = if let [from, to] = points[..] { capsule(from, to, 0.5 * width) } else { None };
                if let Some(short) = short {
                    self.fill_convex(&short, *colour, pixels);
                } else if let Some(path) = path_through(points, false) {
                    pixels.stroke_path(&path, &paint(*colour), &pen(*width), self.to_band(), None);
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
                    let transform = self.to_band().pre_concat(to_sheet);
                    pixels.fill_path(&path, &paint(*colour), FillRule::Winding, transform, None);
                }
            }
        }
    }

    fn fill_convex(&mut self, points: &[Place], colour: Colour, pixels: &mut Pixmap) {
        let to_band = |[x, y]: &Place| [x * self.unit, y * self.unit - self.top];
        let points: Vec<Place> = points.iter().map(to_band).collect();
        self.convex.fill(&points, colour, pixels);
    }

    fn to_band(&self) -> Transform {
        let unit = self.unit as f32;
        Transform::from_scale(unit, unit).post_translate(0.0, -self.top as f32)
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

/// What is no farther from a line than `by`, its round ends with a corner each 45 degrees; nothing of a line without length.
fn capsule(from: Place, to: Place, by: f64) -> Option<Vec<Place>> {
    const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;
    const END: [Place; 5] = [[0.0, -1.0], [HALF, -HALF], [1.0, 0.0], [HALF, HALF], [0.0, 1.0]];
    let [x, y] = direction(from, to)?;
    let end = |[u, v]: Place, side: f64| {
        END.map(|[on, aside]| [u + side * by * (on * x - aside * y), v + side * by * (on * y + aside * x)])
    };
    Some([end(to, 1.0), end(from, -1.0)].concat())
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
    fn a_short_line_has_its_width_and_round_ends() {
        let capsule = capsule([3.0, 2.0], [6.0, 6.0], 1.5).expect("it has a length");
        let near = |[x, y]: &Place| {
            let along = (0.6 * (x - 3.0) + 0.8 * (y - 2.0)).clamp(0.0, 5.0);
            (x - 3.0 - 0.6 * along).hypot(y - 2.0 - 0.8 * along)
        };
        assert!(capsule.len() == 10 && capsule.iter().all(|place| (near(place) - 1.5).abs() < 1e-12), "{capsule:?}");
        let turn = |k: usize| {
            let [a, b, c] = [0, 1, 2].map(|step| capsule[(k + step) % 10]);
            (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
        };
        assert!((0..10).all(|k| turn(k) > 0.0), "it is convex");
    }

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
