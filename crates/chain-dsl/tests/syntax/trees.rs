//! What a text without a mistake means.

use flank_chain_dsl::syntax::ast::{Item, JobStatement};
use flank_chain_dsl::syntax::{CommentKind, comments, parse_expression};
use flank_chain_dsl::{FileId, Span};

use crate::{SPECS, printed, tree};

/// An expression and its tree.
fn check(text: &str, expected: &str) {
    let Item::Job(job) = &tree(&format!("job j {{ let x = {text} }}")).items[0] else { panic!("{text}") };
    let JobStatement::Let(it) = &job.statements[0] else { panic!("{text}") };
    assert_eq!(printed::expression(&it.value), expected, "{text}");
    assert_eq!(it.value.span, span(16, 16 + text.len() as u32), "{text}");
}

fn span(start: u32, end: u32) -> Span {
    Span { file: FileId(0), start, end }
}

#[test]
fn precedence() {
    check("1 + 2 * 3", "(+ 1 (* 2 3))");
    check("1 - 2 - 3", "(- (- 1 2) 3)");
    check("a / b * c", "(* (/ a b) c)");
    check("(1 + 2) * 3", "(* (+ 1 2) 3)");
    check("2^3^4", "(^ 2 (^ 3 4))");
    check("-2^2", "(- (^ 2 2))");
    check("2^-3", "(^ 2 (- 3))");
    check("2^-3^2 * 4", "(* (^ 2 (- (^ 3 2))) 4)");
    check("-a * b", "(* (- a) b)");
    check("a * -b", "(* a (- b))");
    check("a - -b", "(- a (- b))");
    check("--a", "(- (- a))");
    check("not a < b and c or d", "(or (and (not (< a b)) c) d)");
    check("a or b and not c", "(or a (and b (not c)))");
    check("a + 1 <= b * 2", "(<= (+ a 1) (* b 2))");
    check("a < b and b < c", "(and (< a b) (< b c))");
    check("(a == b) != (c >= d)", "(!= (== a b) (>= c d))");
    check("if a > b then 1 + 2 else 3 + 4", "(if (> a b) (+ 1 2) (+ 3 4))");
    check("if a then b else if c then d else e", "(if a b (if c d e))");
    check("1 + (if a then b else c)", "(+ 1 (if a b c))");
}

#[test]
fn values() {
    check("20 mm", "20_mm");
    check("20mm", "20_mm");
    check("1.5e-3 deg", "0.0015_deg");
    check("1E3", "1000");
    check("2 mm/rev", "2_mm*rev^-1");
    check("2 mm^2 / deg^3", "2_mm^2*deg^-3");
    check("2 mm^-1", "2_mm^-1");
    check("2 mm^x", "(^ 2_mm x)");
    check("2 mm^0.5", "(^ 2_mm 0.5)");
    check("2 mm / 4 mm", "(/ 2_mm 4_mm)");
    check("2 mm/rev/x", "(/ 2_mm*rev^-1 x)");
    check("3 µm", "3_µm");
    check("3 μm", "3_µm");
    check("α_n.β", "α_n.β");
    check("mount_x + inches + X + m", "(+ (+ (+ mount_x inches) X) m)");
    check("[]", "[]");
    check("[1, [a], 3,]", "[1 [a] 3]");
    check("v[0][i + 1]", "(at (at v 0) (+ i 1))");
    check("[1, 2][0]^2", "(^ (at [1 2] 0) 2)");
    check("f()", "(f!)");
    check("f(x, over: y, a.b,)", "(f! x over: y a.b)");
    check("f(x)[0]", "(at (f! x) 0)");
    check("table(\"a b.csv\")", "(table! \"a b.csv\")");
    check("a // one\n // two\n + b", "(+ a b)");
}

#[test]
fn words_that_begin_like_others() {
    check("note or orb and android", "(or note (and orb android))");
    check("iffy + thenar", "(+ iffy thenar)");
    check("inside + towards + linear", "(+ (+ inside towards) linear)");
}

#[test]
fn line_ends_and_byte_order_marks_mean_nothing() {
    for (name, text) in SPECS {
        let plain = printed::file(&tree(text));
        assert_eq!(printed::file(&tree(&text.replace('\n', "\r\n"))), plain, "{name}");
        assert_eq!(printed::file(&tree(&text.replace('\n', "\r"))), plain, "{name}");
        assert_eq!(printed::file(&tree(&format!("\u{feff}{text}"))), plain, "{name}");
        assert_eq!(printed::file(&tree(&text.replace("    ", "\t"))), plain, "{name}");
    }
    assert!(tree("").items.is_empty());
    assert!(tree("// nothing").items.is_empty());
}

#[test]
fn everything() {
    insta::assert_snapshot!(printed::file(&tree(SPECS[3].1)), @r#"
    //! Every construct of the language at least once.
    //! It means nothing.
    use "../machines/cradle_tilt.chain"
    /The involute function./ fn involute(a: angle) -> number
      (- (tan! a) (/ a 1_rad))
    fn lead(pitch: length, starts: count) -> length*angle^-1
      let turn 1_rev
      (/ (* starts pitch) turn)
    fn curvature(r: length) -> length^-1
      (if (and (> r 0_mm) (not (== r 1_mm))) (/ 1 r) (/ 0 1_mm))
    fn lowered(p: length[3], by_rate: length*angle^-1[2]) -> length[3]
      (- p [0_mm 0_mm (* (at by_rate 0) 1_rad)])
    /A machine./ /Its second line./ machine α_machine
      /How far./ param radial: length in 0_mm..100.5_mm = 70_mm
      param feed: length*angle^-1 = 2_mm*rev^-1
      param area: length^2*number = 3_mm^2
      param bare: count
      let half (/ radial 2)
      axis X Linear in (- radial)..radial
      /Turns./ axis C Rotary
      frame bed
      frame slide in bed (translate! X 0_mm half) (rotate_x! 5_deg) (rotate! about: [0 0 1] by_angle: C)
      nc B1 (- C) by 0.001_deg
      nc X1 X
      fix X (- half)
      couple C (/ (* (^ 2 (- (^ 3 2))) X) feed)
    machine variant < α_machine
      /Of the ways./ error sag: length in (- 1_um)..1_um
      unknown rod Rotary in (- 80_deg)..80_deg
      insert sagged in slide (translate_z! sag)
      close slide bed along x y about z keep rod in 0_deg..80_deg keep rod in (- 1_deg)..90_deg
      let area (+ (integral! (each t 0_mm X (sum! (each k 1 3 (^ t k))))) (root! (each x 0_mm half (- x X))))
    tool cutter
      param radius: length
      let c [radius 0_mm (- radius)]
      /The flank./ surface flank(s: length in 0_mm..12_mm, theta: angle in (- 180_deg)..180_deg)
        let k (+ (+ (at c 0) (* s (sin! theta))) (polynomial! [1 2 3] (/ s 1_mm)))
        let unused (- k)
        at [(* k (cos! theta)) (* k (sin! theta)) (max! s 0_µm)]
        body towards [0 0 1]
      /From root to tip./ profile blade
        /Straight./ edge (line! from: [0_mm (- radius)] to: [radius 0_mm])
        profile (arc! center: c radius: radius from: 0_deg to: 90_deg)
        along (spline! "top.csv" x: length y: length)
      profile nothing
      surface side(s: along blade, profile: number in 0..1)
        at (* (blade! s) profile)
        body towards [1 0 0]
      surface back(u: number in 0..1)
        at (* [u u u] 1_inch)
        body outside
    job everything
      param ratio: number in 0.5..2 = 1.0323
      let start (- 30_arcmin)
      machine m = variant()
      machine n = α_machine(radial: 70.53_mm, feed: 1_mm*deg^-1)
      tool c = cutter(radius: 76.2_mm)
      mount c m.slide
      motion /The roll./ roll: angle in start..30_deg
      drive m.X (* ratio roll)
      drive m.Y, m.A 0_mm, [roll 2]
      surface concave in m.bed (envelope! c.flank over: roll)
      surface left, right, both in m.bed (sweep! c.left c.right.edge over: roll)
      trim concave convex
      cut concave blades
      require (and (> ratio 1) (not (== start 0_deg))) "this rolls the wrong way"
      sample concave z: 40_mm..62_mm by 45, rho: 70_mm..88_mm by 25
      sample concave.edge z: 40_mm..62_mm by 45, rho: [1_mm 2_mm], u: 3
      sample left, right.edge as root_row, as as as u: [3 4]
      sample left, right u: (* side 3)
      let curve (table! "profile.csv")
      let choice (if (or (>= ratio 1) (< ratio 0.5)) "a" (if (!= ratio 0) "b" "c"))
    /As it was./ job again = everything()
    job slower = everything(ratio: (/ 1 2), m.feed: 3_mm*rev^-1, c: (other_cutter! radius: 3_mm))
    "#);
}

#[test]
fn hobbing() {
    insta::assert_snapshot!(printed::file(&tree(SPECS[0].1)), @r"
    //! Six-axis CNC hobbing machine, after Chang, Tsay and Nagata (1997).
    machine hobbing_6axis
      axis X Linear in 20_mm..400_mm
      axis Y Linear in (- 150_mm)..150_mm
      axis Z Linear in (- 200_mm)..200_mm
      axis A Rotary in (- 45_deg)..45_deg
      axis B Rotary
      axis C Rotary
      frame bed
      frame slide in bed (translate! X 0_mm Z)
      frame head in slide (rotate_x! A) (translate_y! Y)
      frame hob in head (rotate_y! B)
      frame table in bed (rotate_z! C)
    /Today's machine: swivel and shift are set-up only, the table follows the spindle./ machine hobbing_3axis < hobbing_6axis
      param swivel: angle
      fix A swivel
      fix Y 0_mm
    ");
}

#[test]
fn documentation_belongs_to_what_follows() {
    let text = "//! top\n/// a\n// plain\n/// b\nmachine m { param p : length /// trailing\n /// x\n axis X : linear }";
    insta::assert_snapshot!(printed::file(&tree(text)), @r"
    //! top
    /a/ /b/ machine m
      param p: length
      /x/ axis X Linear
    ");
}

#[test]
fn comments_are_all_found() {
    let text = "//! top\n/// doc\nmachine a { // \"in\" side\n} //// plain";
    let found: Vec<_> = comments(text, FileId(0))
        .into_iter()
        .map(|comment| (&text[comment.span.start as usize..comment.span.end as usize], comment.kind, comment.own_line))
        .collect();
    assert_eq!(
        found,
        [
            ("//! top", CommentKind::FileDoc, true),
            ("/// doc", CommentKind::Doc, true),
            ("// \"in\" side", CommentKind::Plain, false),
            ("//// plain", CommentKind::Plain, false),
        ]
    );
}

#[test]
fn places() {
    let text = "machine m { frame a in b = f(x)   g(y) // end\n }  \n";
    let Item::Machine(machine) = &tree(text).items[0] else { panic!() };
    assert_eq!(machine.span, span(0, text.find('}').unwrap() as u32 + 1));
}

#[test]
fn an_expression_by_itself() {
    let check = |text: &str, expected: &str, place: (u32, u32)| {
        let start = text.find('=').map_or(0, |at| at as u32 + 1);
        let (value, diagnostics) = parse_expression(text, FileId(0), start);
        let said = diagnostics.iter().map(|diagnostic| format!(" {}", diagnostic.message)).collect::<String>();
        assert_eq!(format!("{}{said}", printed::expression(&value)), expected);
        assert_eq!(diagnostics.first().map_or(value.span, |first| first.span), span(place.0, place.1), "{text}");
    };
    check("ratio=-3 deg", "(- 3_deg)", (6, 12));
    check("αβ= 1 + x ", "(+ 1 x)", (6, 11));
    check("2 * 3", "(* 2 3)", (0, 5));
    check("a=", "ERROR expected a value", (2, 2));
    check("a==3", "ERROR expected a value, found `=`", (2, 3));
    check("a=20 mmm", "ERROR `mmm` is not a unit", (5, 8));
    check("a=(1", "ERROR expected `)` after `1`", (3, 4));
    check("a=1 2", "ERROR expected an operator between `1` and `2`", (4, 5));
    check("a=1\nb", "ERROR `b` does not belong here", (4, 5));
    check("a=67,5mm", "ERROR decimals are written with a point", (4, 5));
    check("a=0 < 1 < 2", "ERROR comparisons do not chain", (8, 9));
}
