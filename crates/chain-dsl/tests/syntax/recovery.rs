//! What stands around a mistake, and what a broken statement would have defined, is still in the tree.

use flank_chain_dsl::syntax::ast::Item;

use crate::{SPECS, printed, read};

/// A text with mistakes and its tree.
fn check(text: &str, expected: &str) {
    let (file, diagnostics) = read(text);
    assert!(!diagnostics.is_empty(), "{text}");
    let expected: Vec<&str> = expected.lines().map(|line| line.strip_prefix("        ").unwrap_or(line)).collect();
    assert_eq!(printed::file(&file), expected.join("\n").trim(), "{text}");
}

#[test]
fn broken_statements_still_define() {
    check(
        "machine m {
            param a length
            param b : length in 0 mm 12 mm
            param c = 3 mm
            let d = 2 *
            axis C rotary
            axis X : linea
            frame e
            frame f e = translate(a)
            frame g in e = translate(a
            fix C 3 deg
            couple X =
            axis Z : linear
        }",
        "
        machine m
          param a: length = ERROR
          param b: length = ERROR
          param c: ? = ERROR
          let d ERROR
          axis C Rotary
          axis X Unknown
          frame e
          frame f in ?
          frame g in e
          fix C ERROR
          couple X ERROR
          axis Z Linear",
    );
}

#[test]
fn broken_statements_of_a_job() {
    check(
        "job j {
            machine m cradle(radial 3 mm, tilt: 4 deg)
            machine n =
            tool c = face_mill(radius: 3 mm
            mount c m.b
            motion q angle in 0 deg .. 1 deg
            drive m.X q
            surface s in m.work envelope(c)
            surface t = envelope(c)
            sample s { z: 3 mm .. 4 mm }
        }",
        "
        job j
          machine m = cradle(radial: ERROR, tilt: ERROR, ERROR)
          machine n = ?(ERROR)
          tool c = face_mill(radius: ERROR, ERROR)
          mount c ?
          motion q: angle in ERROR..ERROR
          drive m.X ERROR
          surface s in m.work ERROR
          surface t in ? ERROR
          sample s ?: ERROR",
    );
}

#[test]
fn broken_heads_still_define() {
    check(
        "fn f(a: length, b angle) = 3
        machine m extend n {
            axis X : linear
        }
        tool t
            surface s(u: length, v: angle in 0 deg .. 1 deg) {
                at = [u, u, v]
                body insid
            }
        }
        j job {
            let a = 3
        }",
        "
        fn f(a: length, b: angle)
          ERROR
        machine m < n
          axis X Linear
        tool t
          surface s(u: length in ERROR..ERROR, v: angle in ERROR..ERROR)
            at [u u v]
            body towards ERROR
        job j
          let a 3",
    );
}

#[test]
fn misspelt_words_still_define() {
    check(
        "job j {
            parm a : length = 3 mm
            b = 3 mm
            value c = 3 mm
            d let = 3 mm
            let e = 3
            let f = 4;
            let g = 5
        }",
        "
        job j
          param a: length = ERROR
          let b ERROR
          let c ERROR
          let d ERROR
          let e 3
          let f 4
          let g 5",
    );
}

#[test]
fn braces() {
    check(
        "machine m {
            axis X : linear }
            axis Y : linear
        }
        machine n {
            job j { let a = 3 }
            axis X : linear
        machine o { axis X : linear }",
        "
        machine m
          axis X Linear
          axis Y Linear
        job j
          let a 3
        machine n
          axis X Linear
        machine o
          axis X Linear",
    );
}

/// One line lost in a long text costs no other.
#[test]
fn nothing_around_a_mistake_is_lost() {
    let (_, text) = SPECS[3];
    let whole = printed::file(&read(text).0);
    for line in [
        "    param bare : count",
        "    let half = radial / 2",
        "    couple C = 2^-3^2 * X / feed",
        "    let start = -30 arcmin",
    ] {
        let (file, diagnostics) = read(&text.replace(line, &format!("{line} *")));
        assert_eq!(diagnostics.len(), 1, "{line}");
        let printed = printed::file(&file);
        let lost = whole.lines().filter(|line| !printed.lines().any(|other| other == *line)).count();
        assert_eq!(lost, 1, "{line}");
        assert_eq!(file.items.len(), read(text).0.items.len());
    }
    let (file, _) = read(&text.replace("job everything {", "job everything"));
    let job = file.items.iter().find_map(|item| if let Item::Job(job) = item { Some(job) } else { None });
    let Some(job) = job else { panic!("the job is lost") };
    assert_eq!(job.statements.len(), 20);
}
