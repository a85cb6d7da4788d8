//! What could have stood at a place, in the user's words.

use super::grammar::Rule;

/// An example of what a profile consists of.
pub(super) const SEGMENT: &str = "a segment such as `flank = line(from: [x, y], to: [x, y])`";

const TRANSFORM: &str = "a transform such as `translate(x, y, z)`";

/// What stands before the place.
pub(super) struct Before<'t> {
    /// The first word of the statement.
    pub(super) statement: &'t str,
    /// The word or sign right before.
    pub(super) last: &'t str,
    /// Whether that one is a name.
    pub(super) name: bool,
    /// Whether a bracket is open.
    pub(super) in_brackets: bool,
    /// Whether the last one is a parenthesis.
    pub(super) in_parentheses: bool,
}

/// Leaves out what can always follow: operators, the end, another digit; unless there is nothing else.
pub(super) fn relevant(mut rules: Vec<Rule>) -> Vec<Rule> {
    const TIGHT: [Rule; 7] =
        [Rule::open_index, Rule::unit, Rule::unit_word, Rule::unit_power, Rule::dot, Rule::caret, Rule::kw_runs];
    if rules.iter().any(|rule| !TIGHT.contains(rule)) {
        rules.retain(|rule| !TIGHT.contains(rule));
    }
    if rules.contains(&Rule::infix) {
        rules.retain(|rule| *rule != Rule::colon);
    }
    if rules.contains(&Rule::infix) || rules.contains(&Rule::EOI) {
        rules.retain(|rule| *rule != Rule::open_paren);
    }
    // that a list may go on is no news to whoever forgot what follows it
    if rules.iter().any(|rule| matches!(rule, Rule::kw_in | Rule::equals | Rule::open_brace)) {
        rules.retain(|rule| !matches!(rule, Rule::comma | Rule::kw_as));
    }
    const OPTIONAL: [Rule; 5] = [Rule::EOI, Rule::infix, Rule::dimension_operator, Rule::let_statement, Rule::kw_let];
    if rules.iter().any(|rule| !OPTIONAL.contains(rule)) {
        rules.retain(|rule| !OPTIONAL.contains(rule));
    }
    rules.sort_by_key(|rule| match rule {
        Rule::comma => 0,
        Rule::EOI => 2,
        _ => 1,
    });
    rules
}

/// All of the rules in words, as a list.
pub(super) fn list(rules: &[Rule], before: &Before<'_>) -> String {
    let mut words: Vec<String> = Vec::new();
    for &rule in rules {
        let word = describe(rule, before);
        if !words.contains(&word) {
            words.push(word);
        }
    }
    match words.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
        None => "something else".to_owned(),
    }
}

fn describe(rule: Rule, before: &Before<'_>) -> String {
    match rule {
        Rule::EOI => "the next statement".to_owned(),
        Rule::name => name(before),
        Rule::path => path(before).to_owned(),
        Rule::colon if before.name => format!("`:` after the name of the {}", named(before)),
        Rule::equals if before.name => format!("`=` after {}", assigned(before)),
        Rule::open_brace if before.name => {
            format!("`{{` after the name of the {}", noun(before.statement))
        }
        Rule::open_paren if matches!(before.statement, "frame" | "insert") => TRANSFORM.to_owned(),
        Rule::open_paren if before.name => {
            format!("`(` after the name of the {}", noun(before.statement))
        }
        Rule::kw_in if matches!(before.statement, "frame" | "insert") => {
            "`in` and the frame that it hangs on".to_owned()
        }
        Rule::kw_in if before.statement == "surface" && before.name && !before.in_parentheses => {
            "`in` and the frame in which the surface is given".to_owned()
        }
        Rule::kw_in if before.statement == "want" => "`in` and the contact that is wanted so".to_owned(),
        Rule::kw_in if before.statement == "mill" => "`in` and the frame in which the work is clamped".to_owned(),
        Rule::kw_of if before.name => "`of` and the name of a surface".to_owned(),
        Rule::spacing_word => "`scallop`, `step`, `chord` or `by` and a value".to_owned(),
        Rule::attitude_word => "`lead`, `tilt` or `stock`".to_owned(),
        Rule::kw_with if before.statement == "mill" => "`with` and a surface of the cutter".to_owned(),
        Rule::kw_in if before.statement == "solid" => "`in` and the frame of the body".to_owned(),
        Rule::kw_in if matches!(before.statement, "motion" | "unknown" | "surface") && !before.name => {
            "`in` and a range".to_owned()
        }
        Rule::kw_by if before.statement == "nc" => "`by` and the increment".to_owned(),
        Rule::kw_by if before.statement == "trim" => "`by` and the surface that cuts".to_owned(),
        Rule::kw_by if before.statement == "cut" => "`by` and the sweep of the edges that cut".to_owned(),
        Rule::kw_with => "`with` and the flank that it touches".to_owned(),
        Rule::kw_by => "`by` and a number of points".to_owned(),
        Rule::dots => "`..` between the ends of the range".to_owned(),
        Rule::axis_kind => "`linear` or `rotary`".to_owned(),
        Rule::side => "`inside`, `outside`".to_owned(),
        Rule::string if before.statement == "require" => "what to tell, such as `\"too few teeth\"`".to_owned(),
        Rule::string => "a path such as `\"machines/hobbing.chain\"`".to_owned(),
        Rule::infix => "an operator".to_owned(),
        Rule::integer => "a whole number".to_owned(),
        Rule::expected_value | Rule::expected_status | Rule::expected_pose => {
            "what is expected, such as `all solved`".to_owned()
        }
        Rule::kw_near => "`near` and what it is compared with".to_owned(),
        Rule::kw_within => "`within` and a tolerance".to_owned(),
        Rule::error_code => "the code of an error, such as `E0307`".to_owned(),
        Rule::status => "a status such as `solved`".to_owned(),
        Rule::dimension | Rule::dimension_factor | Rule::dimension_name | Rule::one => {
            "a dimension such as `length` or `angle`".to_owned()
        }
        Rule::expression
        | Rule::operation
        | Rule::conditional
        | Rule::value
        | Rule::prefix
        | Rule::argument
        | Rule::label
        | Rule::dimension_word
        | Rule::coordinate => "a value".to_owned(),
        Rule::range => "a range such as `0 mm .. 12 mm`".to_owned(),
        _ => sign(rule).map_or_else(|| "something else".to_owned(), |sign| format!("`{sign}`")),
    }
}

fn name(before: &Before<'_>) -> String {
    let first = before.last == before.statement;
    match (before.statement, before.last) {
        _ if first => format!("the name of the {}", noun(before.statement)),
        (_, ".") => "a name".to_owned(),
        ("surface", "in") | (_, "on") => path(before).to_owned(),
        ("drive", _) => path(before).to_owned(),
        ("sample", "as") => "the name of the sample".to_owned(),
        ("surface" | "sample", ",") if !before.in_brackets => "the name of the surface".to_owned(),
        ("frame" | "insert", "in") => "the frame that it hangs on".to_owned(),
        ("frame" | "insert", _) => TRANSFORM.to_owned(),
        ("close", "along" | "about" | ",") => "`x`, `y` or `z`".to_owned(),
        ("close", "keep") => "the name of an unknown axis".to_owned(),
        ("close", _) => "the name of a frame".to_owned(),
        ("job", "extends") => "the job that it extends".to_owned(),
        (_, "extends") => "the machine that it extends".to_owned(),
        ("machine", "=") => "the name of a machine".to_owned(),
        ("tool", "=") => "the name of a tool".to_owned(),
        ("job", "=") => "the name of a job".to_owned(),
        ("machine" | "tool" | "job", _) => "a setting such as `radial: 70 mm`".to_owned(),
        ("trim", "by") => "the name of the surface that cuts".to_owned(),
        ("want", "in") => "the name of a contact".to_owned(),
        ("contact", "=") | ("contact", "with") => "the name of a flank".to_owned(),
        ("contact", _) => "an argument such as `over: turn` or `for: lag`".to_owned(),
        ("mill", "of") => "the name of a surface".to_owned(),
        ("mill", "with") => "a surface of the cutter such as `e.cutting`".to_owned(),
        ("mill", "in") => "a frame such as `m.work`".to_owned(),
        ("mill", _) => "a coordinate such as `lengthwise`".to_owned(),
        ("cut", "by") => "the name of the sweep of the edges that cut".to_owned(),
        ("surface", "along") => "the name of a profile".to_owned(),
        ("profile", _) => SEGMENT.to_owned(),
        ("surface", _) => "a parameter such as `u: length in 0 mm .. 12 mm`".to_owned(),
        ("fn", _) => "a parameter such as `x: length`".to_owned(),
        ("sample", _) => "an entry such as `z: 40 mm .. 62 mm by 45`".to_owned(),
        _ => "a name".to_owned(),
    }
}

fn path(before: &Before<'_>) -> &'static str {
    match before.statement {
        "drive" => "an axis such as `m.X`",
        "job" => "a setting such as `radial: 70 mm`",
        "sample" | "trim" | "cut" => "the name of the surface",
        "contact" => "the name of a flank",
        "want" => "the name of a contact",
        "mill" => "the name of a surface",
        _ => "a frame such as `m.work`",
    }
}

/// What a name before a colon or a brace is the name of.
fn named<'t>(before: &Before<'t>) -> &'t str {
    match before.statement {
        "machine" | "tool" | "job" if before.in_parentheses => "setting",
        "surface" | "fn" if before.in_parentheses => "parameter",
        "sample" if before.last != "sample" => "entry",
        "close" => "axis",
        statement => noun(statement),
    }
}

fn assigned(before: &Before<'_>) -> String {
    match before.statement {
        "frame" | "insert" | "close" | "surface" | "solid" => "the name of the frame".to_owned(),
        "want" => "the name of the contact".to_owned(),
        statement => format!("the name of the {}", noun(statement)),
    }
}

/// What a statement is about.
pub(super) fn noun(statement: &str) -> &str {
    match statement {
        "param" => "parameter",
        "let" => "value",
        "fix" | "couple" | "drive" => "axis",
        "mount" => "tool",
        "sample" | "trim" | "cut" => "surface",
        "require" => "condition",
        "fn" => "function",
        "want" => "wanted contact",
        "nc" => "NC word",
        "expect" => "surface",
        "insert" | "close" => "frame",
        "mill" => "milling",
        other => other,
    }
}

/// The text of a rule that stands for one word or sign.
pub(super) fn sign(rule: Rule) -> Option<&'static str> {
    Some(match rule {
        Rule::open_brace => "{",
        Rule::close_brace => "}",
        Rule::open_paren | Rule::open_group => "(",
        Rule::close_paren => ")",
        Rule::open_bracket | Rule::open_index => "[",
        Rule::close_bracket => "]",
        Rule::comma => ",",
        Rule::colon => ":",
        Rule::equals => "=",
        Rule::arrow => "->",
        Rule::dot => ".",
        Rule::dots => "..",
        Rule::caret => "^",
        Rule::kw_use => "use",
        Rule::kw_fn => "fn",
        Rule::kw_machine => "machine",
        Rule::kw_extends => "extends",
        Rule::kw_tool => "tool",
        Rule::kw_job => "job",
        Rule::kw_on => "on",
        Rule::kw_along => "along",
        Rule::kw_about => "about",
        Rule::kw_for => "for",
        Rule::kw_as => "as",
        Rule::kw_in | Rule::kw_runs => "in",
        Rule::kw_step => "step",
        Rule::kw_by => "by",
        Rule::kw_keep => "keep",
        Rule::kw_travel => "travel",
        Rule::kw_nothing => "nothing",
        Rule::kw_error => "error",
        Rule::kw_at => "at",
        Rule::kw_with => "with",
        Rule::kw_near => "near",
        Rule::kw_within => "within",
        Rule::kw_of => "of",
        Rule::kw_passes => "passes",
        Rule::kw_side => "side",
        Rule::kw_both => "both",
        Rule::kw_ways => "ways",
        Rule::kw_clear => "clear",
        Rule::kw_require => "require",
        Rule::kw_if => "if",
        Rule::kw_then => "then",
        Rule::kw_else => "else",
        Rule::kw_towards => "towards",
        Rule::kw_where => "where",
        _ => return None,
    })
}
