//! Changes that mend a text: what a finding says to write, written.

use flank_chain_dsl::{Diagnostic, compile_text};
use flank_expr::Graph;

/// A line of a function, wrong and mended.
const MENDED: [(&str, &str); 27] = [
    ("fn f(x: angle) = sin (x)", "fn f(x: angle) = sin(x)"),
    ("fn f(x: number) = 5. * x", "fn f(x: number) = 5.0 * x"),
    ("fn f(x: number) = .5 * x", "fn f(x: number) = 0.5 * x"),
    ("fn f(x: number) = 1,5 * x", "fn f(x: number) = 1.5 * x"),
    ("fn f(x: number) = x ** 2", "fn f(x: number) = x ^ 2"),
    ("fn f(x: number) = if x = 1 then 2 else 3", "fn f(x: number) = if x == 1 then 2 else 3"),
    ("fn f(x: number) == x", "fn f(x: number) = x"),
    ("fn f(x: number) = x;", "fn f(x: number) = x"),
    ("fn f(x: number) = 2 × x", "fn f(x: number) = 2 * x"),
    ("fn f(x: number) = 2 ÷ x", "fn f(x: number) = 2 / x"),
    ("fn f(x: number) = 2 − x", "fn f(x: number) = 2 - x"),
    ("fn f(x: number) = x²", "fn f(x: number) = x^2"),
    ("fn f(x: number) = if x ≤ 1 then 2 else 3", "fn f(x: number) = if x <= 1 then 2 else 3"),
    ("fn f(x: number) = if x ≠ 1 then 2 else 3", "fn f(x: number) = if x != 1 then 2 else 3"),
    ("fn f(x: mm) = x", "fn f(x: length) = x"),
    ("fn f(x: deg) = x", "fn f(x: angle) = x"),
    ("fn f(x: length) = x + 2 mmm", "fn f(x: length) = x + 2 mm"),
    ("fn f(x: angle) = sinn(x)", "fn f(x: angle) = sin(x)"),
    ("fn f(x: length) = x + 2", "fn f(x: length) = x + 2 mm"),
    ("fn f(x: number) = PI * x", "fn f(x: number) = pi * x"),
    ("fn f(x: number) = π * x", "fn f(x: number) = pi * x"),
    ("fn f(x: number) = x / tau", "fn f(x: number) = x / (2 * pi)"),
    ("fn f(x: int) = x", "fn f(x: count) = x"),
    ("fn f(x: angle) = x + 20°", "fn f(x: angle) = x + 20 deg"),
    ("fn f(x: angle) = x + 20 ″", "fn f(x: angle) = x + 20 arcsec"),
    ("fn f(x: number) = x + 20−x", "fn f(x: number) = x + 20-x"),
    ("fn f(x: number) = if x < 1 & x > 0 then 2 else 3", "fn f(x: number) = if x < 1 and x > 0 then 2 else 3"),
];

fn found(text: &str) -> Vec<Diagnostic> {
    compile_text(&Graph::new(), "mended.chain", text, &[]).diagnostics
}

/// A text after the likeliest change for its first finding.
fn mended(text: &str) -> Option<String> {
    let cure = found(text).into_iter().next()?.cures.into_iter().next()?;
    let [start, end] = [cure.span.start, cure.span.end].map(|at| at as usize);
    Some(format!("{}{}{}", &text[..start], cure.replacement, &text[end..]))
}

#[test]
fn what_a_finding_says_to_write_mends_the_text() {
    let mut wrong = Vec::new();
    for (text, right) in MENDED {
        assert!(found(right).is_empty(), "{right}: {:?}", found(right));
        let is = mended(text);
        if is.as_deref() != Some(right) {
            let said: Vec<String> =
                found(text).iter().map(|found| format!("{} {:?}", found.message, found.help)).collect();
            wrong.push(format!("{text}: {is:?}, {said:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// `m.frame.more`, and a frame without its machine.
#[test]
fn a_frame_is_named_together_with_its_machine() {
    let text = |frame: &str| {
        format!(
            "machine lathe {{
    axis Z : linear
    axis C : rotary
    frame bed
    frame slide in bed = translate_z(Z)
    frame work  in bed = rotate_z(C)
}}
tool ball {{
    surface face(u: angle in -80 deg .. 80 deg, v: angle in -60 deg .. 60 deg) {{
        at = [20 mm - 5 mm * cos(u) * cos(v), 5 mm * cos(u) * sin(v), 5 mm * sin(u)]
        body towards [1, 0, 0]
    }}
}}
job thread {{
    machine m = lathe
    tool b = ball
    mount b on {frame}
    motion turn : angle in 0 deg .. 360 deg
    drive m.C = turn
    drive m.Z = 4 mm/rev * turn
    surface groove in m.work = envelope(b.face, over: turn)
}}
"
        )
    };
    for frame in ["slide", "m.slide.more"] {
        assert_eq!(mended(&text(frame)).as_deref(), Some(text("m.slide").as_str()), "{frame}");
    }
}
