//! Pictures of all kinds of datasets: they exist, are well formed, show something, and SVG and PNG are the same.

mod readers;
#[path = "../../export/tests/synthetic/mod.rs"]
mod synthetic;

use std::collections::BTreeSet;

use flank_draw::{PictureError, PictureOptions, field_maps, picture};
use flank_export::shape::rows_follow_profile;
use flank_export::{Dataset, Field, Patch, Values};
use readers::{Drawn, kept, labels};
use resvg::tiny_skia::Pixmap;
use resvg::usvg::roxmltree;

fn drawn(dataset: &Dataset) -> (String, Pixmap) {
    let picture = picture(dataset, &PictureOptions::default());
    let png = picture.png().expect("a picture of usual size");
    (picture.svg(), Pixmap::decode_png(&png).expect("a PNG that others can read"))
}

/// How many pixels are not white.
fn inked(pixels: &Pixmap) -> usize {
    pixels.pixels().iter().filter(|pixel| (pixel.red(), pixel.green(), pixel.blue()) != (255, 255, 255)).count()
}

#[test]
fn every_dataset_has_a_picture() {
    for (name, dataset) in synthetic::gallery() {
        let (svg, pixels) = drawn(&dataset);
        std::fs::write(kept(&format!("{name}.svg")), &svg).unwrap();
        pixels.save_png(kept(&format!("{name}.png"))).unwrap();
        assert_eq!((pixels.width(), pixels.height()), (1200, 900), "{name}");
        assert!(inked(&pixels) > 2_000, "{name} is blank");
        let document = roxmltree::Document::parse(&svg).expect("well-formed XML");
        assert_eq!(document.root_element().tag_name().name(), "svg");
    }
}

#[test]
fn the_png_is_the_svg() {
    let some = ["spur", "holes", "face", "point", "empty"];
    for (name, dataset) in synthetic::gallery().into_iter().filter(|(name, _)| some.contains(name)) {
        Drawn::of(&picture(&dataset, &PictureOptions::default()), name).is_the_same_in_both();
    }
}

/// A flank with a signed field that is not defined at some points, one that is the same everywhere, and one of vectors.
fn with_maps() -> Dataset {
    let flank = synthetic::Gear { helix: 0.3, width: 20.0 }.flank("right flank", [25, 15]);
    let mut patch = synthetic::without(flank, synthetic::holes);
    let field = |name: &str, values| Field { name: name.into(), unit: "um/mm".into(), meaning: "test".into(), values };
    let shares = (0..375).map(|at| ((at / 15) as f64 / 24.0, (at % 15) as f64 / 14.0));
    let wave = |(s, t): (f64, f64)| (s > 0.1 || t > 0.2).then_some(8.0 * (s - 0.4) - 30.0 * (t - 0.3) * s);
    patch.fields = vec![
        field("d_normal/d_wave", Values::Scalars(shares.map(wave).collect())),
        field("d_normal/d_constant", Values::Scalars([Some(0.25); 375].into())),
        field("vectors", Values::Vectors([None; 375].into())),
        field("none", Values::Scalars([None; 375].into())),
    ];
    synthetic::dataset("job", vec![patch])
}

#[test]
fn maps_say_what_they_show() {
    let shown: Vec<(usize, usize)> = (0..4).map(|field| (0, field)).chain([(1, 0), (0, 9)]).collect();
    let picture = field_maps(&with_maps(), "sensitivity", &shown, "what is held", &PictureOptions::default());
    let drawn = Drawn::of(&picture, "maps");
    drawn.is_the_same_in_both();
    drawn.has_no_text_over_text();
    let svg = drawn.svg;
    let labels = labels(&svg);
    let about = "right flank, \u{b5}m/mm; laid flat, upwards 1.9 times larger";
    let words = ["root", "tip", "lower face", "upper face", "lengthwise, mm", "profilewise, mm", "0.25 everywhere"];
    let titles =
        ["sensitivity", "d_normal/d_wave", "d_normal/d_constant", "none", "no point has a value", "what is held"];
    for wanted in titles.into_iter().chain(words).chain([about]) {
        assert!(labels.iter().any(|label| label == wanted), "no `{wanted}` in {labels:?}");
    }
    assert!(!labels.contains(&"vectors".to_string()) && labels.contains(&"0".to_string()));
    assert!(svg.contains("stroke=\"#be0000\""), "points without a value have a cross");
    let nothing = field_maps(&with_maps(), "", &[], "", &PictureOptions::default()).svg();
    assert!(nothing.contains("nothing to draw"));
}

/// A bevel flank has the words of its labels, whichever way its grid runs; a surface that turns about the axis is laid by rows and
/// columns.
#[test]
fn sides_are_named_in_words() {
    let words = |patch: Patch| {
        let count = patch.points.len();
        let values = Values::Scalars((0..count).map(|at| Some(at as f64)).collect());
        let field = Field { name: "number".into(), unit: "1".into(), meaning: "test".into(), values };
        let dataset = synthetic::dataset("job", vec![Patch { fields: vec![field], ..patch }]);
        labels(&field_maps(&dataset, "", &[(0, 0)], "", &PictureOptions::default()).svg())
    };
    let all = |found: &[String], wanted: &[&str]| wanted.iter().all(|word| found.iter().any(|label| label == word));
    assert!(all(&words(synthetic::bevel([11, 9])), &["toe", "heel", "root", "tip", "lengthwise, mm"]));
    let spur = synthetic::Gear { helix: 0.0, width: 20.0 };
    assert!(all(&words(spur.flank("flank", [11, 9])), &["root", "tip", "lower face", "upper face"]));
    let cylinder = synthetic::grid("root land", ["z", "angle"], [5, 7], |s, t| {
        let (sin, cos) = (0.1 * t).sin_cos();
        synthetic::point([30.0 * cos, 30.0 * sin, 10.0 * s], [cos, sin, 0.0], [s, t])
    });
    let found = words(cylinder);
    assert!(all(&found, &["angle \u{2192}", "up: z \u{2192}"]), "{found:?}");
    assert!(!found.iter().any(|label| label == "root" || label == "tip"));
}

#[test]
fn the_profile_is_found() {
    assert_eq!(rows_follow_profile(&synthetic::bevel([11, 9])), Some(false));
    for helix in [0.0, 0.4, -0.4] {
        let gear = synthetic::Gear { helix, width: 30.0 };
        assert_eq!(rows_follow_profile(&gear.flank("flank", [11, 9])), Some(false));
        // a flank without words in its labels leans to its tip
        let mut patch = gear.flank("flank", [11, 9]);
        patch.columns.label = "rho".into();
        assert_eq!(rows_follow_profile(&patch), Some(false), "{helix}");
        let narrow = synthetic::Gear { helix: 0.0, width: 3.0 };
        let mut patch = narrow.flank("flank", [11, 9]);
        patch.columns.label = "rho".into();
        assert_eq!(rows_follow_profile(&patch), Some(false));
    }
}

#[test]
fn patches_have_their_own_colours() {
    let colours = |name: &str| {
        let dataset = synthetic::gallery().into_iter().find(|(other, _)| *other == name).unwrap().1;
        let pixels = drawn(&dataset).1;
        let hue = |r: u8, g: u8, b: u8| match (r > b, g > b) {
            _ if r.abs_diff(b) < 30 => "grey",
            (true, true) if g.abs_diff(r) < 40 => "yellow",
            (true, _) => "orange",
            (false, _) => "blue",
        };
        pixels.pixels().iter().map(|p| hue(p.red(), p.green(), p.blue())).collect::<BTreeSet<_>>()
    };
    assert_eq!(colours("helical"), BTreeSet::from(["blue", "grey"]));
    assert!(colours("spur").is_superset(&BTreeSet::from(["blue", "grey", "orange"])));
    assert!(colours("tooth").is_superset(&BTreeSet::from(["blue", "grey", "orange", "yellow"])));
}

#[test]
fn the_figure_says_what_it_shows() {
    let dataset = synthetic::gallery().into_iter().find(|(name, _)| *name == "holes").unwrap().1;
    let labels = labels(&drawn(&dataset).0);
    for wanted in [
        "flank with holes",
        "specs/jobs/synthetic.flank \u{b7} hash 9f2c1e7a55d0b3c4 \u{b7} flank 0.1.0",
        "right flank",
        "z \u{2212}10 to 10 mm",
        "radius 34.014 to 37.986 mm",
        "z",
        "root",
        "tip",
        "x",
        "y",
        "5 mm",
        "frame m.table",
        "z axis",
    ] {
        assert!(labels.iter().any(|label| label == wanted), "no `{wanted}` in {labels:?}");
    }
    let all = labels.join(" ");
    assert!(all.contains("Solved 343 of 375 points asked for; worst residual 1.1e-14."), "{all}");
    assert!(all.contains("not_converged 6, out_of_range 25, singular 1"), "{all}");
}

/// Patches of two frames do not lie over each other, and all of many patches are named.
#[test]
fn frames_have_their_own_views() {
    let patch = |k: usize| {
        let plane = synthetic::plane([5, 5], [30.0, 0.0, 0.0], 8.0);
        flank_export::Patch { name: format!("side {k}"), frame: format!("m.body{}", k % 2), ..plane }
    };
    let labels = labels(&drawn(&synthetic::dataset("pair", (0..10).map(patch).collect())).0);
    for frame in ["m.body0", "m.body1"] {
        for wanted in [format!("in {frame}"), format!("frame {frame}")] {
            assert_eq!(labels.iter().filter(|label| **label == wanted).count(), 1, "{wanted} in {labels:?}");
        }
    }
    for k in 0..10 {
        let wanted = format!("side {k} in m.body{}", k % 2);
        assert!(labels.contains(&wanted), "{wanted} in {labels:?}");
    }
}

/// A cylinder's second curvature is zero but for rounding.
#[test]
fn rounding_is_not_drawn_as_data() {
    let mut patch = synthetic::plane([9, 9], [30.0, 0.0, 0.0], 8.0);
    let values = (0..81).map(|k| Some(if k % 2 == 0 { 3e-17 } else { -2e-17 })).collect();
    patch.fields = vec![flank_export::Field {
        name: "k2".into(),
        unit: "1/mm".into(),
        meaning: String::new(),
        values: flank_export::Values::Scalars(values),
    }];
    let dataset = synthetic::dataset("cylinder", vec![patch]);
    let labels = labels(&field_maps(&dataset, "curvature", &[(0, 0)], "", &PictureOptions::default()).svg());
    assert!(labels.iter().any(|label| label == "0 within rounding"), "{labels:?}");
    assert!(!labels.iter().any(|label| label.contains("e\u{2212}17")), "{labels:?}");
}

#[test]
fn crosses_stand_only_beside_solved_points() {
    let crosses = |lost: fn(usize, usize) -> Option<&'static str>| {
        let patch = synthetic::without(synthetic::plane([9, 9], [30.0, 0.0, 0.0], 8.0), lost);
        let svg = drawn(&synthetic::dataset("job", vec![patch])).0;
        svg.matches("stroke=\"#be0000\"").count() / 2
    };
    assert_eq!(crosses(|_, _| None), 0);
    assert_eq!(crosses(|i, j| (i == 4 && j == 4).then_some("out_of_range")), 1);
    // Rows beyond the third from the known ones have no neighbour to tell where they are.
    assert_eq!(crosses(|i, _| (i > 4).then_some("out_of_range")), 9);
    assert_eq!(crosses(|_, _| Some("out_of_range")), 0);
}

#[test]
fn size_is_as_asked_and_letters_grow_with_it() {
    let dataset = synthetic::gallery().remove(0).1;
    for (width, height) in [(2400, 1800), (1200, 500), (300, 900), (64, 64)] {
        let picture = picture(&dataset, &PictureOptions { width, height });
        let pixels = Pixmap::decode_png(&picture.png().unwrap()).unwrap();
        assert_eq!((pixels.width(), pixels.height()), (width, height));
        pixels.save_png(kept(&format!("spur-{width}x{height}.png"))).unwrap();
    }
    let large = picture(&dataset, &PictureOptions { width: 2400, height: 1800 }).svg();
    let usual = picture(&dataset, &PictureOptions::default()).svg();
    assert_eq!(large.lines().skip(2).collect::<Vec<_>>(), usual.lines().skip(2).collect::<Vec<_>>());
}

#[test]
fn odd_sizes_are_brought_into_range() {
    let dataset = synthetic::dataset("job", Vec::new());
    let pixels = picture(&dataset, &PictureOptions { width: 0, height: 1 }).png().unwrap();
    assert_eq!(Pixmap::decode_png(&pixels).unwrap().width(), 64);
    let error = PictureError::TooLarge { width: 9, height: 8 };
    assert_eq!(error.to_string(), "a picture of 9 x 8 pixels is too large");
}

#[test]
fn names_cannot_break_the_svg() {
    let mut patch = synthetic::plane([3, 3], [30.0, 0.0, 0.0], 5.0);
    patch.name = "<b>&\"'\u{0}\u{ffff} ]]>".into();
    patch.frame = "a\nb".into();
    patch.rows.label = "-> ->".into();
    patch.columns.label = "\u{1F980} \u{2192} \u{4e2d}".into();
    let mut dataset = synthetic::dataset("<&>", vec![patch]);
    dataset.header.spec = "x".repeat(5_000);
    let labels = labels(&drawn(&dataset).0);
    assert!(labels.contains(&"<&>".to_owned()) && labels.contains(&"<b>&\"'  ]]>".to_owned()), "{labels:?}");
}

/// A sequence without pattern, the same in every run.
struct Noise(u64);

impl Noise {
    fn next(&mut self, below: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % below
    }

    fn number(&mut self) -> f64 {
        let odd = [f64::NAN, f64::INFINITY, -1e300, 1e300, 1e9, -0.0, 0.0, 5e-324, 1e-12, 1.0, 1.0, 30.0];
        match self.next(24) as usize {
            at if at < odd.len() => odd[at],
            _ => self.next(2_000) as f64 / 20.0 - 50.0,
        }
    }
}

#[test]
fn no_numbers_make_it_panic() {
    let mut noise = Noise(7);
    for _ in 0..300 {
        let size = [noise.next(5) as usize, noise.next(5) as usize];
        let mut patch = synthetic::plane(size, [0.0; 3], 1.0);
        for point in &mut patch.points {
            point.position = [(); 3].map(|()| noise.number());
            point.normal = [(); 3].map(|()| noise.number());
            point.residual = noise.number();
        }
        let mut patch = synthetic::without(patch, |i, j| ((i + 2 * j) % 5 == 4).then_some("out_of_range"));
        if noise.next(4) == 0 {
            patch.rows.count = [0, 1, 7, usize::MAX][noise.next(4) as usize];
            patch.columns.count = [0, 1, 7, usize::MAX][noise.next(4) as usize];
        }
        let picture = picture(&synthetic::dataset("noise", vec![patch]), &PictureOptions { width: 200, height: 150 });
        roxmltree::Document::parse(&picture.svg()).expect("well-formed XML");
        assert!(picture.png().is_ok());
    }
}
