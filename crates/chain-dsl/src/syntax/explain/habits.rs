//! Habits from other languages and from paper, and how the same is said here.

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;

use super::super::grammar::Rule;
use super::super::scan::{Kind, Scan};
use super::Mistake;

impl Mistake<'_> {
    /// A mistake for which there is better advice than the list of what could follow.
    pub(super) fn habit(&self) -> Option<Diagnostic> {
        if let Some(diagnostic) = foreign(self.scan, self.found).filter(|_| self.found < self.range.end) {
            return Some(diagnostic);
        }
        self.block()
            .or_else(|| self.space())
            .or_else(|| self.decimal())
            .or_else(|| self.second_call())
            .or_else(|| self.sign())
    }

    /// `machine mill [`
    fn block(&self) -> Option<Diagnostic> {
        let is_sign = matches!(self.say(), "(" | "[") && self.expected.contains(&Rule::open_brace);
        let is_last = self.found + 1 >= self.range.end || self.scan.indent(self.found + 1).is_some();
        (is_sign && is_last).then(|| {
            let found = self.here(format!("a block begins with `{{`, not with `{}`", self.say()));
            found.help("write `{`, and `}` at its end").cure("write `{`", self.place(), "{")
        })
    }

    /// `curve("ratio.csv", x: angle, y: length)(turn)`
    fn second_call(&self) -> Option<Diagnostic> {
        let is_called = self.before() == ")" && self.say() == "(" && self.touches(self.found) && !self.leads();
        let help = "give it a name and call that: `let f = curve(…)`, then `f(x)`";
        is_called.then(|| self.here("what a call gives cannot be called where it stands").help(help))
    }

    /// `sin (x)`, `v [0]`
    fn space(&self) -> Option<Diagnostic> {
        let (name, sign) = (self.before(), self.say());
        let after = match self.kind_before()? {
            Kind::Word => self.scan.is_name(self.found - 1),
            _ => sign == "[" && matches!(name, ")" | "]"),
        };
        if !after || self.touches(self.found) || self.leads() {
            return None;
        }
        let what = match sign {
            "(" if self.expected.contains(&Rule::open_brace) => return None,
            "(" => "call",
            "[" => "index",
            _ => return None,
        };
        let message = format!("no space may stand before the `{sign}` of a {what}").replace("a index", "an index");
        let written = format!("write `{}{sign}`", self.scan.short(self.found - 1));
        let gap = Span { start: self.scan.place(self.found - 1).end, end: self.place().start, ..self.place() };
        Some(self.here(message).help(written.clone()).cure(written, gap, ""))
    }

    /// `.5`, `5.`, `1,5`
    fn decimal(&self) -> Option<Diagnostic> {
        let digits_before = self.kind_before() == Some(Kind::Number) && self.touches(self.found);
        let digits_after = self.scan.kind(self.found + 1) == Some(Kind::Number) && self.touches(self.found + 1);
        let (before, after) = (self.scan.short(self.found.saturating_sub(1)), self.scan.short(self.found + 1));
        match self.say() {
            "." if digits_before => Some(
                self.here("a digit must follow the decimal point")
                    .help(format!("write `{before}.0` or `{before}`"))
                    .cure(format!("write `{before}.0`"), self.place(), ".0"),
            ),
            "." if digits_after => {
                let written = format!("write `0.{after}`");
                let message = "a digit must stand before the decimal point";
                Some(self.here(message).help(written.clone()).cure(written, self.place(), "0."))
            }
            "," if digits_before && digits_after => {
                let written = format!("write `{before}.{after}`");
                let message = "decimals are written with a point";
                Some(self.here(message).help(written.clone()).cure(written, self.place(), "."))
            }
            _ => None,
        }
    }

    fn sign(&self) -> Option<Diagnostic> {
        let wants = |rule: Rule| self.expected.contains(&rule);
        let statement = self.scan.say(self.range.start);
        let help = match (self.before(), self.say()) {
            ("*", "*") if self.touches(self.found) => "a power is written `a ^ b`",
            ("..", ".") if self.touches(self.found) => "a range is written `a .. b`",
            ("]", _) if wants(Rule::dots) => "a range has no brackets, as in `-40 deg .. 40 deg`",
            (_, "by") if matches!(statement, "motion" | "unknown") => {
                "a motion takes all values of its range; how many points are wanted stands in the `sample`"
            }
            (_, "(") if statement == "sample" && wants(Rule::open_brace) => {
                "what is asked for stands between `{` and `}`, as in `sample flank { z: 0 mm .. 5 mm by 6, rho: 48 mm }`"
            }
            (_, "(") if matches!(statement, "machine" | "tool" | "job") && wants(Rule::open_brace) => {
                "settings stand in the block, as in `param module : length = 4 mm`"
            }
            (_, "along") if statement == "axis" => {
                "a frame says which way an axis moves it, as in `frame slide in bed = translate_y(Y)`"
            }
            (_, "=") if statement == "expect" && wants(Rule::kw_near) => {
                "say how near the value must lie, as in `near 3 mm within 1 um`"
            }
            (_, _) if statement == "expect" && wants(Rule::kw_near) && self.compares() => {
                "a bound is a range, as in `in 2 mm .. 3 mm`"
            }
            (_, _) if statement == "use" && self.scan.is_name(self.found) => {
                "the name of a file stands between quotes, as in `use \"machines/hobbing.chain\"`"
            }
            (_, _) if statement == "sample" && wants(Rule::kw_by) && self.scan.is_name(self.found) => {
                "`by` and how many points are wanted follow a range, as in `0 mm .. 5 mm by 6`"
            }
            (_, ":") if wants(Rule::equals) && self.scan.say(self.found + 1) == "=" && self.touches(self.found + 1) => {
                "a value is given with `=`"
            }
            (_, "=")
                if wants(Rule::colon)
                    && matches!(statement, "machine" | "tool" | "job")
                    && self.scan.is_name(self.found - 1) =>
            {
                "a setting gets its value with `:`"
            }
            (_, "." | "to") if wants(Rule::dots) => "a range is written `a .. b`",
            (_, "=") if wants(Rule::close_paren) && self.scan.is_name(self.found - 1) => {
                "an argument gets its value with `:`"
            }
            (_, "in") if self.is_inch() => "an inch is written `inch`",
            (_, "in") if statement == "param" && wants(Rule::infix) && !wants(Rule::dots) => {
                "the range stands before the value: write `in low .. high = value`"
            }
            (_, ".") if matches!(statement, "machine" | "tool") && wants(Rule::EOI) => {
                "what a used file defines is called by its plain name"
            }
            (_, "if") if wants(Rule::value) => "put the `if` into parentheses",
            (_, "=") if statement == "error" => {
                "an error is zero in the machine; a job gives it a value: `machine m = cradle(swivel_error: 1 arcmin)`"
            }
            (_, "=") if wants(Rule::infix) && !wants(Rule::equals) && !self.leads() => "values are compared with `==`",
            (_, "==") if wants(Rule::equals) => "write `=` to give something a value",
            (_, "=") if statement == "surface" && wants(Rule::kw_in) => {
                "write the frame of the work before the `=`: `surface flank in m.work = envelope(…)`"
            }
            (_, ":") if statement == "let" && wants(Rule::equals) => {
                "a `let` takes its dimension from its value: write `let name = value`"
            }
            (")", "*") if matches!(statement, "frame" | "insert") => {
                "transforms stand side by side, without a sign between them"
            }
            ("/", "*") if self.touches(self.found) => block_comment(self.scan, self.found - 1)?,
            (_, "angle" | "rotation" | "rotational" | "revolute" | "deg" | "rad" | "rev") if wants(Rule::axis_kind) => {
                "an axis that turns is `rotary`"
            }
            (_, "length" | "translation" | "translational" | "prismatic" | "mm") if wants(Rule::axis_kind) => {
                "an axis that slides is `linear`"
            }
            (_, ",") if wants(Rule::EOI) => "a statement ends without a sign",
            _ => block_comment(self.scan, self.found)?,
        };
        let diagnostic = self.unexpected().help(help);
        Some(match self.sign_here(help) {
            Some((title, span, text)) => diagnostic.cure(title, span, text),
            None => diagnostic,
        })
    }

    /// Whether a comparison stands before the mistake, and nothing behind it.
    fn compares(&self) -> bool {
        let is_sign = |index: usize| matches!(self.scan.say(index), "<" | ">" | "<=" | ">=");
        (self.ends() || self.leads()) && (self.range.start..self.found).any(is_sign)
    }

    /// `0.5 in` at the end of a line.
    fn is_inch(&self) -> bool {
        let is_last = self.found + 1 >= self.range.end || self.scan.indent(self.found + 1).is_some();
        self.say() == "in" && self.kind_before() == Some(Kind::Number) && is_last
    }

    /// The change that such a help asks for, where the text to write follows from what stands there.
    fn sign_here(&self, help: &str) -> Option<(&'static str, Span, String)> {
        let text = |span: Span| &self.scan.text[span.start as usize..span.end as usize];
        let before = |sign: &str| (self.range.start..self.found).rev().find(|at| self.scan.say(*at) == sign);
        let after = |sign: &str| (self.found..self.range.end).find(|at| self.scan.say(*at) == sign);
        let replaced = match (self.before(), self.say(), help) {
            ("..", ".", _) => ("leave `.` out", self.place(), ""),
            ("*", "*", _) => ("write `^`", self.scan.extent(self.found - 1..self.found + 1), "^"),
            (_, ":", "a value is given with `=`") => ("write `=`", self.scan.extent(self.found..self.found + 2), "="),
            (_, "." | "to", "a range is written `a .. b`") => ("write `..`", self.place(), ".."),
            (_, "=", "an argument gets its value with `:`" | "a setting gets its value with `:`") => {
                ("write `:`", self.place(), ":")
            }
            (_, "=", _) if self.scan.say(self.range.start) == "error" => {
                ("leave the value out", self.scan.extent(self.found..self.range.end), "")
            }
            (_, "=", "values are compared with `==`") => ("write `==`", self.place(), "=="),
            (_, "==", _) => ("write `=`", self.place(), "="),
            (_, "angle" | "rotation" | "rotational" | "revolute" | "deg" | "rad" | "rev", _) => {
                ("write `rotary`", self.place(), "rotary")
            }
            (_, "length" | "translation" | "translational" | "prismatic" | "mm", _) => {
                ("write `linear`", self.place(), "linear")
            }
            (")", "*", _) => ("leave `*` out", self.place(), ""),
            (_, ",", _) => ("leave `,` out", self.place(), ""),
            (_, ".", _) if self.scan.is_name(self.found + 1) => {
                ("leave the file out", self.scan.extent(self.found - 1..self.found + 1), "")
            }
            (_, ":", _) => {
                let end = self.behind(after("=")? - 1);
                ("leave the dimension out", Span { start: self.behind(self.found - 1).start, ..end }, "")
            }
            (_, "in", _) if self.is_inch() => ("write `inch`", self.place(), "inch"),
            (_, "in", _) => {
                let equals = before("=")?;
                let [value, range] =
                    [equals + 1..self.found, self.found..self.range.end].map(|of| self.scan.extent(of));
                let whole = self.scan.place(equals).to(range);
                return Some(("put the range first", whole, format!("{} = {}", text(range), text(value))));
            }
            (_, "if", _) => {
                let whole = self.scan.extent(self.found..self.end_of_value());
                return Some(("write parentheses", whole, format!("({})", text(whole))));
            }
            (_, "/", _) | ("/", "*", _) => {
                let open = if self.say() == "/" { self.found } else { self.found - 1 };
                return line_comment(self.scan, open);
            }
            _ => return None,
        };
        let (title, span, text) = replaced;
        Some((title, span, text.to_string()))
    }

    /// One past the last token before a comma, or a bracket that is open, ends the value at hand.
    fn end_of_value(&self) -> usize {
        let mut depth = 0usize;
        for index in self.found..self.range.end {
            match self.scan.say(index) {
                "(" | "[" | "{" => depth += 1,
                ")" | "]" | "}" if depth > 0 => depth -= 1,
                ")" | "]" | "}" | "," if depth == 0 => return index,
                _ => {}
            }
        }
        self.range.end
    }
}

/// The report on a character that the language does not know.
pub(in super::super) fn foreign(scan: &Scan, index: usize) -> Option<Diagnostic> {
    if scan.kind(index) != Some(Kind::Strange) {
        return None;
    }
    let message = format!("{} is not part of the language", scan.quote(index));
    let place = scan.place(index);
    let diagnostic = Diagnostic::new(Code::Syntax, place, message);
    let sign = scan.say(index);
    if let Some(closing) = absolute(scan, index) {
        let whole = scan.extent(index..closing + 1);
        let inside = scan.extent(index + 1..closing);
        let text = format!("abs({})", &scan.text[inside.start as usize..inside.end as usize]);
        return Some(diagnostic.help("an absolute value is written `abs(x)`").cure(
            format!("write `{text}`"),
            whole,
            text,
        ));
    }
    if let Some(text) = written_here(sign) {
        let is_twice = matches!(sign, "&" | "|") && scan.say(index + 1) == sign;
        let whole = scan.extent(index..index + if is_twice { 2 } else { 1 });
        let next = index + if is_twice { 2 } else { 1 };
        // words stand apart, as units do from their numbers
        let is_word = text.starts_with(char::is_alphabetic);
        let space = |touches: bool| if is_word && touches { " " } else { "" };
        let before = space(index > 0 && scan.place(index - 1).end == place.start);
        let behind = space(scan.kind(next) == Some(Kind::Word) && scan.place(next).start == whole.end);
        let title = format!("write `{text}`");
        return Some(diagnostic.help(title.clone()).cure(title, whole, format!("{before}{text}{behind}")));
    }
    let is_percent = sign == "%" && index > 0 && matches!(scan.kind(index - 1), Some(Kind::Number));
    let help = if is_percent { Some("a share is a number, as in `0.5`") } else { strange(sign) };
    let Some(help) = help else { return Some(diagnostic) };
    let diagnostic = diagnostic.help(help);
    Some(match sign {
        ";" => diagnostic.cure("leave `;` out", place, ""),
        "…" => diagnostic.cure("write `..`", place, " .. "),
        "\u{a0}" | "\u{2009}" | "\u{202f}" => diagnostic.cure(help, place, " "),
        "#" => diagnostic.cure("write `//`", place, "//"),
        "%" if is_percent => diagnostic.cure("write `/ 100`", place, " / 100"),
        "%" if scan.indent(index).is_some() => diagnostic.cure("write `//`", place, "//"),
        "√" if scan.say(index + 1) == "(" => diagnostic.cure("write `sqrt`", place, "sqrt"),
        "√" if matches!(scan.kind(index + 1), Some(Kind::Word | Kind::Number)) => {
            let whole = scan.extent(index..index + 2);
            diagnostic.cure("write `sqrt`", whole, format!("sqrt({})", scan.say(index + 1)))
        }
        _ => match quoted(scan, place) {
            Some((whole, text)) => diagnostic.cure(format!("write `{text}`"), whole, text),
            None => diagnostic,
        },
    })
}

/// The `|` that closes an absolute value which opens at a token: where a value begins, and on the same line.
fn absolute(scan: &Scan, open: usize) -> Option<usize> {
    let before = open.checked_sub(1)?;
    let begins_value = scan.kind(before) == Some(Kind::Sign) && !matches!(scan.say(before), ")" | "]" | "}");
    let mut line = (open + 1..scan.tokens.len()).take_while(|index| scan.indent(*index).is_none());
    let closing = line.find(|index| scan.say(*index) == "|")?;
    (scan.say(open) == "|" && begins_value && closing > open + 1).then_some(closing)
}

/// A text between other signs that opens at a place, and how it is written here.
fn quoted(scan: &Scan, open: Span) -> Option<(Span, String)> {
    let line = scan.text[open.end as usize..].split(['\n', '\r']).next()?;
    let inside = line.split(['\'', '‘', '’', '“', '”', '"']).next().filter(|inside| inside.len() < line.len())?;
    let end = open.end as usize + inside.len();
    let closing = scan.text[end..].chars().next()?.len_utf8();
    Some((Span { end: (end + closing) as u32, ..open }, format!("\"{inside}\"")))
}

/// A comment of one line between `/*` and `*/`, and how it is written here.
pub(in super::super) fn line_comment(scan: &Scan, open: usize) -> Option<(&'static str, Span, String)> {
    let start = scan.place(open);
    let line = scan.text[start.start as usize..].split(['\n', '\r']).next()?.trim_end();
    let inside = line.strip_prefix("/*")?.strip_suffix("*/").filter(|inside| !inside.contains("*/"))?;
    let whole = Span { end: start.start + line.len() as u32, ..start };
    Some(("write `//`", whole, format!("//{}", inside.trim_end())))
}

/// Whether a character is a sign from elsewhere for a part of a value, the decimal comma among them: what stands before it is no whole value.
pub(in super::super) fn belongs_to_value(scan: &Scan, index: usize) -> bool {
    let is_number = |index: usize| scan.kind(index) == Some(Kind::Number);
    let is_decimal = || {
        let (before, after) = (index.checked_sub(1), index + 1);
        scan.say(index) == ","
            && before.is_some_and(|before| is_number(before) && scan.place(before).end == scan.place(index).start)
            && is_number(after)
            && scan.place(index).end == scan.place(after).start
    };
    (scan.kind(index) == Some(Kind::Strange) && written_here(scan.say(index)).is_some()) || is_decimal()
}

/// What to say of `/*`.
pub(in super::super) fn block_comment(scan: &Scan, index: usize) -> Option<&'static str> {
    (scan.say(index) == "/" && scan.say(index + 1) == "*")
        .then_some("a comment begins with `//` and ends with the line")
}

/// How a sign from elsewhere is written here, wherever it stands.
fn written_here(sign: &str) -> Option<&'static str> {
    Some(match sign {
        "°" | "º" => "deg",
        "′" => "arcmin",
        "″" => "arcsec",
        "&" => "and",
        "|" => "or",
        "!" => "not",
        "×" | "·" | "⋅" | "∙" => "*",
        "÷" | "∕" => "/",
        "−" | "–" | "—" => "-",
        "²" => "^2",
        "³" => "^3",
        "≤" => "<=",
        "≥" => ">=",
        "≠" => "!=",
        _ => return None,
    })
}

/// What to say of other signs from elsewhere.
fn strange(sign: &str) -> Option<&'static str> {
    Some(match sign {
        ";" => "a statement ends without a sign",
        "\u{a0}" | "\u{2009}" | "\u{202f}" => "write a plain space",
        "'" | "‘" | "’" | "“" | "”" | "„" => "text stands between `\"` and `\"`",
        "#" | "%" => "a comment begins with `//`",
        "…" => "a range is written `a .. b`",
        "√" => "write `sqrt(x)`",
        "±" => {
            "a range names both ends, as in `-40 deg .. 40 deg`; by how much a value may differ stands behind `within`"
        }
        "≈" | "≃" | "≅" | "~" => "an expectation compares by `near`, as in `near 1.6 mm within 1 um`",
        _ => return None,
    })
}
