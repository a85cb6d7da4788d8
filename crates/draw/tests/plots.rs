//! Lines, reliefs, sections, machines and motions as pictures: what they say, where their lines lie, and that SVG and PNG are the same.

mod readers;
#[path = "../../export/tests/synthetic/mod.rs"]
mod synthetic;

use flank_draw::{
    DrawnFrame, GearDrawing, GearFace, GearFaceKind, LinkKind, MachineDrawing, MachineLink, Picture, PictureOptions,
    Section, SectionCircle, SectionLine, ToolPosition, TraceChart, TraceDrawing, axis_positions, field_lines,
    field_maps, gear, machine, picture, section, topography, traces,
};
use flank_export::{Dataset, Field, MachineAxis, MotionRow, MotionTable, Patch, Unit, Unknown, Values};
use readers::{Drawn, labels};

fn flank_with(size: [usize; 2], value: impl Fn(&[f64; 3]) -> f64) -> Dataset {
    let patch = synthetic::Gear { helix: 0.2, width: 20.0 }.flank("right flank", size);
    let values = patch.points.iter().map(|point| Some(value(&point.position))).collect();
    let field =
        Field { name: "value".into(), unit: "um".into(), meaning: "test".into(), values: Values::Scalars(values) };
    synthetic::dataset("job", vec![Patch { fields: vec![field], ..patch }])
}

fn options() -> PictureOptions {
    PictureOptions::default()
}

/// Everything that a picture has to be, whatever it shows.
fn sound(picture: &Picture, name: &str) -> Drawn {
    let drawn = Drawn::of(picture, name);
    drawn.is_the_same_in_both();
    drawn.has_no_text_over_text();
    drawn
}

#[test]
fn lines_lie_where_the_value_is() {
    let drawn = sound(&field_lines(&flank_with([21, 15], |p| p[2]), "lines", &[(0, 0)], "note", &options()), "lines");
    let labels = labels(&drawn.svg);
    for wanted in ["lines", "value", "note", "root", "tip", "lower face", "upper face", "z, mm"] {
        assert!(labels.iter().any(|label| label == wanted), "no `{wanted}` in {labels:?}");
    }
    // the value is z, which goes across: the lines are upright and evenly apart
    let lines = drawn.lines("#1a1a1a", 1.4);
    let places: Vec<f64> = lines.iter().map(|line| line[0][0]).collect();
    assert!(lines.iter().zip(&places).all(|(line, x)| line.iter().all(|place| (place[0] - x).abs() < 0.02)));
    assert!(places.len() > 8, "{places:?}");
    let gap = places[1] - places[0];
    assert!(places.windows(2).all(|pair| (pair[1] - pair[0] - gap).abs() < 0.05), "{places:?}");
}

/// Blue is minus, orange plus, and their border lies where the value is zero.
#[test]
fn signs_have_their_colours() {
    let drawn = sound(&field_maps(&flank_with([21, 15], |p| p[2]), "map", &[(0, 0)], "", &options()), "signed");
    let zero = drawn.lines("#1a1a1a", 2.0).into_iter().find(|line| line.len() > 20).expect("the line of zero");
    let [x, y] = zero[zero.len() / 2];
    let [red, _, blue] = drawn.pixel(x - 60.0, y);
    assert!(blue > red, "minus is blue");
    let [red, _, blue] = drawn.pixel(x + 60.0, y);
    assert!(red > blue, "plus is orange");
}

/// One sign only: dark is low and light is high, in grey too.
#[test]
fn without_signs_light_is_high() {
    let drawn =
        sound(&field_maps(&flank_with([21, 15], |p| p[2] + 11.0), "map", &[(0, 0)], "", &options()), "unsigned");
    let luma = |x: f64| {
        let [r, g, b] = drawn.pixel(x, 470.0).map(f64::from);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    // the middle of the flank, left, middle and right
    let lumas = [350.0, 625.0, 900.0].map(luma);
    assert!(lumas.windows(2).all(|pair| pair[1] > pair[0] + 20.0), "{lumas:?}");
}

#[test]
fn a_relief_rises_above_its_grid() {
    let hill = |p: &[f64; 3]| 12.0 - 0.1 * p[2] * p[2];
    let drawn = sound(&topography(&flank_with([21, 15], hill), "relief", &[(0, 0)], "", &options()), "relief");
    let labels = labels(&drawn.svg);
    assert!(labels.iter().any(|label| label == "5 \u{b5}m"), "{labels:?}");
    for wanted in ["root", "tip", "lower face", "upper face"] {
        assert!(labels.iter().any(|label| label == wanted), "no `{wanted}` in {labels:?}");
    }
    let flat = sound(&topography(&flank_with([21, 15], |_| 0.0), "flat", &[(0, 0)], "", &options()), "flat");
    assert!(flat.svg.contains("<polygon"));
}

fn header() -> flank_export::Header {
    synthetic::dataset("job", Vec::new()).header
}

#[test]
fn a_section_shows_tool_and_work() {
    let parabola = |x: f64| [x, x * x];
    let tangent = |at: f64| vec![[at - 1.0, at * at - 2.0 * at], [at + 1.0, at * at + 2.0 * at]];
    let tool = |at: f64| ToolPosition { value: at, lines: vec![tangent(at)], contacts: vec![parabola(at)] };
    let shares = || (-20..=20).map(|k| 0.05 * f64::from(k));
    let section_of = Section {
        header: header(),
        note: "across".into(),
        surfaces: vec![SectionLine {
            name: "groove".into(),
            points: shares().map(parabola).collect(),
            normals: shares().map(|x| [-2.0 * x, 1.0]).collect(),
        }],
        circles: vec![SectionCircle {
            name: "tip circle".into(),
            is_above: true,
            points: vec![[-2.0, 0.9], [2.0, 0.9]],
        }],
        motion: "turn, deg".into(),
        tools: (-3..=3).map(|k| tool(0.3 * f64::from(k))).collect(),
    };
    let drawn = sound(&section(&section_of, &options()), "section");
    let labels = labels(&drawn.svg);
    for wanted in
        ["job: section", "groove", "tool at turn, deg", "\u{2212}0.5", "tip circle", "across", "mm, towards the tip"]
    {
        assert!(labels.iter().any(|label| label == wanted), "no `{wanted}` in {labels:?}");
    }
    let empty = Section { surfaces: Vec::new(), tools: Vec::new(), ..section_of };
    assert!(section(&empty, &options()).svg().contains("nothing to draw"));
}

fn link(kind: LinkKind, name: &str, direction: [f64; 3], step: [f64; 3]) -> MachineLink {
    MachineLink {
        kind,
        name: name.into(),
        moves: true,
        direction_name: "along x".into(),
        value: "-12.5 mm".into(),
        origin: [0.0; 3],
        direction,
        step,
    }
}

#[test]
fn a_machine_has_its_frames_and_letters() {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let frame = |name: &str, parent, origin, links| DrawnFrame { name: name.into(), parent, origin, axes, links };
    let drawing = MachineDrawing {
        header: header(),
        name: "m = mill".into(),
        note: "seen askew".into(),
        frames: vec![
            frame("bed", None, [0.0; 3], Vec::new()),
            frame(
                "slide",
                Some(0),
                [80.0, 0.0, 0.0],
                vec![
                    link(LinkKind::Linear, "X", axes[0], [60.0, 0.0, 0.0]),
                    MachineLink {
                        origin: [60.0, 0.0, 0.0],
                        ..link(LinkKind::Shift, "offset", axes[0], [20.0, 0.0, 0.0])
                    },
                ],
            ),
            frame("table", Some(0), [0.0; 3], vec![link(LinkKind::Rotary, "C", axes[2], [0.0; 3])]),
        ],
        tool: Vec::new(),
        work: vec![synthetic::Gear { helix: 0.0, width: 20.0 }.flank("flank", [9, 9])],
    };
    let drawn = sound(&machine(&drawing, &options()), "machine");
    let labels = labels(&drawn.svg);
    for wanted in ["job: machine m = mill", "bed \u{b7} table", "slide in bed", "X", "C", "offset", "\u{2212}12.5 mm"] {
        assert!(labels.iter().any(|label| label == wanted), "no `{wanted}` in {labels:?}");
    }
    // what turns has a ring of many pieces, what slides a straight arrow
    let red = drawn.lines("#be0000", 2.4);
    assert_eq!(red.iter().filter(|line| line.len() == 41).count(), 1);
    assert_eq!(red.iter().filter(|line| line.len() == 2).count(), 1);
    let none = MachineDrawing { frames: Vec::new(), ..drawing };
    assert!(machine(&none, &options()).svg().contains("nothing to draw"));
}

/// A plate: a generated face on top, the blank below; what faces away from the eye is hidden.
#[test]
fn a_gear_is_seen_from_outside() {
    let face = |kind, z: f64| GearFace {
        kind,
        counts: [2, 2],
        ends: [true; 4],
        points: [[1.0, -1.0], [1.0, 1.0], [3.0, -1.0], [3.0, 1.0]].map(|[x, y]| Some([x, y, z])).to_vec(),
        normals: vec![[0.0, 0.0, z.signum()]; 4],
    };
    let faces = vec![face(GearFaceKind::Surface(0), 0.5), face(GearFaceKind::Blank, -0.5)];
    let drawing = GearDrawing {
        header: header(),
        title: "plate".into(),
        note: "seen askew".into(),
        facts: vec![("teeth".into(), "19".into())],
        surfaces: vec!["top".into()],
        whole: faces.clone(),
        teeth: faces,
        shown: "3 of 19 teeth".into(),
        directions: [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        is_closed: true,
    };
    let drawn = sound(&gear(&drawing, &options()), "gear");
    let found = labels(&drawn.svg);
    for wanted in ["plate", "3 of 19 teeth", "teeth", "19", "top", "seen askew"] {
        assert!(found.iter().any(|label| label == wanted), "no `{wanted}` in {found:?}");
    }
    let open = sound(&gear(&GearDrawing { is_closed: false, ..drawing.clone() }, &options()), "open gear");
    let polygons = |drawn: &Drawn| drawn.svg.matches("<polygon").count();
    assert_eq!(polygons(&open), polygons(&drawn) + 2, "the lower face, in both views");
    let none = GearDrawing { teeth: Vec::new(), whole: Vec::new(), ..drawing };
    assert!(gear(&none, &options()).svg().contains("nothing to draw"));
}

#[test]
fn traces_have_their_range_and_numbers() {
    let chart = |name: &str, rise: f64| TraceChart {
        name: name.into(),
        across: "length of roll, mm".into(),
        lengths: (0..=20).map(f64::from).collect(),
        deviations: (0..=20).map(|k| rise * (f64::from(k) - 10.0)).collect(),
        range: [0.0, 19.0],
        mean: [-0.5 * rise, rise],
        numbers: vec!["F\u{3b1} 3.8 \u{b5}m".into(), "fH\u{3b1} 4.0 \u{b5}m".into()],
    };
    let drawing = TraceDrawing {
        header: header(),
        title: "traces".into(),
        note: "transverse".into(),
        flanks: vec![vec![chart("left, profile", 0.2), chart("left, helix", 0.0)]],
    };
    let drawn = sound(&traces(&drawing, &options()), "traces");
    let found = labels(&drawn.svg);
    for wanted in [
        "left, profile",
        "left, helix",
        "length of roll, mm",
        "F\u{3b1} 3.8 \u{b5}m   fH\u{3b1} 4.0 \u{b5}m",
        "transverse",
    ] {
        assert!(found.iter().any(|label| label == wanted), "no `{wanted}` in {found:?}");
    }
    // the same scale in both: one rises by 4 um, the other stays at its zero
    let lines = drawn.lines("#0072b2", 2.4);
    assert_eq!(lines.len(), 2);
    let high = |line: &[[f64; 2]]| (line[0][1] - line[line.len() - 1][1]).abs();
    assert!(high(&lines[0]) > 200.0 && high(&lines[1]) < 0.1, "{} {}", high(&lines[0]), high(&lines[1]));
    assert!(traces(&TraceDrawing { flanks: Vec::new(), ..drawing }, &options()).svg().contains("nothing to draw"));
}

#[test]
fn axes_that_move_have_a_chart() {
    let axis = |name: &str, is_rotary| MachineAxis {
        name: name.into(),
        address: name.into(),
        is_rotary,
        decimals: 3,
        offset: 0.0,
        reversed: false,
        travel: None,
    };
    let rows = (0..=40).map(|k| {
        let at = 0.05 * f64::from(k);
        MotionRow { motion: at, axes: vec![3.0 * at, 5.0, at * at] }
    });
    let table = MotionTable {
        header: header(),
        motion: Unknown { name: "feed".into(), unit: Unit::Millimetre },
        axes: vec![axis("Z", false), axis("A", true), axis("C", true)],
        rows: rows.collect(),
        series: None,
        rates: None,
    };
    let drawn = sound(&axis_positions(std::slice::from_ref(&table), &options()), "axes");
    let labels = labels(&drawn.svg);
    // a parabola of two mm is off its chord by 1 rad
    let off = "up to 57.3 deg off a straight line";
    for wanted in ["Z, linear", "C, rotary", "feed, mm", off, "3.0000 mm per mm", "A, rotary", "286.479 deg"] {
        assert!(labels.iter().any(|label| label == wanted), "no `{wanted}` in {labels:?}");
    }
    assert_eq!(labels.iter().filter(|label| *label == "stands still").count(), 1, "{labels:?}");
    assert!(axis_positions(&[], &options()).svg().contains("nothing to draw"));
}

/// A million points are drawn as some ten thousand cells, and the picture says so.
#[test]
fn a_large_grid_is_thinned_and_told_so() {
    let dataset = flank_with([1000, 1000], |p| (3.0 * p[2]).sin() * p[0]);
    for (name, drawn) in [
        ("map", field_maps(&dataset, "", &[(0, 0)], "", &options())),
        ("lines", field_lines(&dataset, "", &[(0, 0)], "", &options())),
        ("relief", topography(&dataset, "", &[(0, 0)], "", &options())),
        ("surface", picture(&dataset, &options())),
    ] {
        let svg = drawn.svg();
        assert!(svg.len() < 9_000_000, "{name}: {} bytes", svg.len());
        assert!(svg.contains("of 1000 x 1000 points."), "{name}");
    }
}
