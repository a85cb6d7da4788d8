//! Diagnostics as the user sees them.

use flank_chain_dsl::Code;
use flank_chain_dsl::Diagnostic;
use flank_chain_dsl::render;
use flank_chain_dsl::syntax::parse;
use flank_chain_dsl::{FileId, Sources, Span};

fn rendered(text: &str) -> String {
    let mut sources = Sources::default();
    let file = sources.add("gears/pinion.chain", text);
    render(&parse(text, file).1, &sources, false)
}

#[test]
fn a_report_with_help() {
    insta::assert_snapshot!(rendered("machine m {\n    axis A : rotory\n}\n"), @r"
    error[E0101]: expected `linear` or `rotary`, found `rotory`
     --> gears/pinion.chain:2:14
      |
    2 |     axis A : rotory
      |              ^^^^^^
      |
      = help: did you mean `rotary`?
    ");
}

#[test]
fn a_report_with_another_place() {
    let text = "machine m {\n    axis A : rotary\n    axis B : rotary\n    axis C : rotary\n    axis X : linear\n    axis Y : linear\n\njob j { }\n";
    insta::assert_snapshot!(rendered(text), @r"
    error[E0101]: expected `}` before `job`
     --> gears/pinion.chain:8:1
      |
    1 | machine m {
      |           - this `{` is not closed
    ...
    8 | job j { }
      | ^^^
    ");
}

#[test]
fn two_reports() {
    insta::assert_snapshot!(rendered("job j {\r\n\tlet α = 20 mmm\r\n\tlet b = (2\r\n}\r\n"), @r"
    error[E0101]: `mmm` is not a unit
     --> gears/pinion.chain:2:13
      |
    2 |     let α = 20 mmm
      |                ^^^
      |
      = help: did you mean `mm`?

    error[E0101]: expected `)` after `2`
     --> gears/pinion.chain:3:11
      |
    3 |     let b = (2
      |             -^
      |             |
      |             this `(` is not closed
    ");
}

/// A carriage return ends a line as a line feed does.
#[test]
fn every_kind_of_line_end_gives_the_same_report() {
    let text = "// α = 20 mm\nmachine m {\n    axis A : rotory // no\n}\n\ntool t {\n";
    let plain = rendered(text);
    assert!(plain.contains("gears/pinion.chain:3:14") && plain.contains("3 |     axis A : rotory // no\n"), "{plain}");
    for end in ["\r", "\r\n"] {
        assert_eq!(rendered(&text.replace('\n', end)), plain, "{end:?}");
    }
}

/// Of a text without letters nothing is shown but its name.
#[test]
fn an_empty_file_is_named_alone() {
    let mut sources = Sources::default();
    let file = sources.add("none.chain", "");
    let finding = Diagnostic::new(Code::UnreadableFile, Span { file, start: 0, end: 0 }, "it is not there");
    let shown = render(&[finding], &sources, false);
    assert_eq!(shown, "error[E0001]: it is not there\n--> none.chain\n");
}

#[test]
fn an_empty_file_and_its_end() {
    insta::assert_snapshot!(rendered("job j {"), @r"
    error[E0101]: expected `}` at the end of the file
     --> gears/pinion.chain:1:7
      |
    1 | job j {
      |       ^
      |       |
      |       this `{` is not closed
    ");
}

#[test]
fn a_report_over_two_files() {
    let mut sources = Sources::default();
    let a = sources.add("a.chain", "use \"b.chain\"\nmachine m { }\n");
    let b = sources.add("b.chain", "// the library\nmachine m { }\n");
    let span = |file: FileId, start, end| Span { file, start, end };
    let diagnostic = Diagnostic::new(Code::DuplicateName, span(a, 22, 23), "the machine `m` is defined twice")
        .note(span(b, 23, 24), "first defined here")
        .help("give one of them another name");
    insta::assert_snapshot!(render(&[diagnostic], &sources, false), @r"
    error[E0202]: the machine `m` is defined twice
     --> a.chain:2:9
      |
    2 | machine m { }
      |         ^
      |
     ::: b.chain:2:9
      |
    2 | machine m { }
      |         - first defined here
      |
      = help: give one of them another name
    ");
}

#[test]
fn a_long_file_is_not_copied() {
    let text = format!("{}job j {{ let a = 3 mmm }}", "// a comment\n".repeat(50_000));
    insta::assert_snapshot!(rendered(&text), @r"
    error[E0101]: `mmm` is not a unit
         --> gears/pinion.chain:50001:19
          |
    50001 | job j { let a = 3 mmm }
          |                   ^^^
          |
          = help: did you mean `mm`?
    ");
}

#[test]
fn colour() {
    let mut sources = Sources::default();
    let file = sources.add("a.chain", "jop j { }");
    let diagnostics = parse("jop j { }", file).1;
    assert!(render(&diagnostics, &sources, true).contains("\u{1b}["));
    assert!(!render(&diagnostics, &sources, false).contains('\u{1b}'));
    assert_eq!(render(&[], &sources, true), "");
}
