//! Pictures as other programs read them.
#![allow(dead_code, reason = "each test binary uses some of them")]

use std::path::{Path, PathBuf};

use flank_draw::Picture;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, roxmltree};

/// A picture in both of its formats; they are left in a folder for people to look at.
pub(crate) struct Drawn {
    pub(crate) svg: String,
    pub(crate) pixels: Pixmap,
    name: String,
}

/// The pictures are left here for people to look at.
pub(crate) fn kept(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// Texts of the picture, as a screen reader finds them.
pub(crate) fn labels(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).expect("well-formed XML");
    let labels = document.descendants().filter_map(|node| node.attribute("aria-label"));
    labels.map(str::to_owned).collect()
}

impl Drawn {
    pub(crate) fn of(picture: &Picture, name: &str) -> Drawn {
        let pixels =
            Pixmap::decode_png(&picture.png().expect("a picture of usual size")).expect("a PNG others can read");
        let svg = picture.svg();
        std::fs::write(kept(&format!("{name}.svg")), &svg).expect("the folder of the tests");
        pixels.save_png(kept(&format!("{name}.png"))).expect("the folder of the tests");
        Drawn { svg, pixels, name: name.to_owned() }
    }

    /// Another program draws the same from the SVG.
    pub(crate) fn is_the_same_in_both(&self) {
        let tree = Tree::from_str(&self.svg, &Options::default()).expect("an SVG that others can read");
        let mut others = Pixmap::new(self.pixels.width(), self.pixels.height()).expect("a usual size");
        resvg::render(&tree, Transform::identity(), &mut others.as_mut());
        let differences = self.pixels.data().iter().zip(others.data()).map(|(&a, &b)| a.abs_diff(b));
        let off = differences.clone().filter(|&difference| difference > 40).count();
        let mean = differences.map(f64::from).sum::<f64>() / self.pixels.data().len() as f64;
        // flank paints of each pixel what is covered, the other program counts places in it: along every edge they differ by a few bytes' steps
        assert!(mean < 0.2 && off < 200, "{}: {mean} on average, {off} bytes far off", self.name);
    }

    /// No two texts cover each other: by the widths and heights that letters have, less what two lines of a paragraph share.
    pub(crate) fn has_no_text_over_text(&self) {
        let document = roxmltree::Document::parse(&self.svg).expect("well-formed XML");
        let texts: Vec<(String, [f64; 4])> = document.descendants().filter_map(covered).collect();
        assert!(!texts.is_empty(), "{}", self.name);
        for (k, (text, [left, top, right, bottom])) in texts.iter().enumerate() {
            for (other, [other_left, other_top, other_right, other_bottom]) in &texts[..k] {
                let apart = left >= other_right || right <= other_left || top >= other_bottom || bottom <= other_top;
                assert!(apart, "{}: `{text}` lies on `{other}`", self.name);
            }
        }
    }

    /// The polylines of a colour and a width.
    pub(crate) fn lines(&self, colour: &str, width: f64) -> Vec<Vec<[f64; 2]>> {
        let document = roxmltree::Document::parse(&self.svg).expect("well-formed XML");
        let is_meant = |node: &roxmltree::Node<'_, '_>| {
            let own = node.attribute("stroke-width").and_then(|text| text.parse::<f64>().ok());
            node.tag_name().name() == "polyline" && node.attribute("stroke") == Some(colour) && own == Some(width)
        };
        let points = |node: roxmltree::Node<'_, '_>| {
            let numbers = node.attribute("points").unwrap_or("").split([' ', ',']).filter_map(|x| x.parse().ok());
            numbers.collect::<Vec<f64>>().chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
        };
        document.descendants().filter(is_meant).map(points).collect()
    }

    pub(crate) fn pixel(&self, x: f64, y: f64) -> [u8; 3] {
        let pixel = self.pixels.pixel(x.round() as u32, y.round() as u32).expect("on the picture");
        [pixel.red(), pixel.green(), pixel.blue()]
    }
}

/// A text with the rectangle of its small letters: left, top, right, bottom.
fn covered(node: roxmltree::Node<'_, '_>) -> Option<(String, [f64; 4])> {
    let text = node.attribute("aria-label")?;
    let transform = node.attribute("transform")?;
    let numbers = transform.split(['(', ')', ' ', ',']).filter_map(|part| part.parse::<f64>().ok());
    let [x, y, scale] = numbers.take(3).collect::<Vec<f64>>().try_into().ok()?;
    // DejaVu Sans: 2048 units to the size, small letters 1120 high
    let last = node.children().filter_map(|glyph| glyph.attribute("x")?.parse::<f64>().ok()).fold(0.0, f64::max);
    Some((text.to_owned(), [x, y - 1120.0 * scale.abs(), x + (last + 600.0) * scale.abs(), y]))
}
