//! Lines of ISO 6983 as Fanuc, LinuxCNC and Siemens write them.

use super::block::{Block, Motion, Word, no_number};

/// G words, tenfold, that leave the nominal way of the cutter as it is: dwells, planes, ends of modes that are errors to begin, feed modes, exact
/// stops, corners within a tolerance, and the first zero, which positions count from.
const STILL: [i64; 24] = [
    51, 90, 170, 180, 190, 400, 540, 610, 611, 640, 6010, 6020, 6030, 6410, 6420, 6430, 6440, 6450, 670, 690, 800, 900,
    970, 980,
];
/// G words, tenfold, with which P and Q say how.
const WITH_PARAMETERS: [i64; 3] = [40, 51, 640];
const TIP_CONTROL: i64 = 434;
/// Statements of Siemens of the same kind: feeds, jerk, corners within a tolerance, rotary axes that turn evenly, messages.
const STILL_NAMES: [&str; 16] = [
    "FNORM", "FFWON", "FFWOF", "SOFT", "BRISK", "COMPON", "COMPCURV", "COMPCAD", "COMPOF", "ORIAXES", "STOPRE", "ADIS",
    "CTOL", "OTOL", "MSG", "CYCLE832",
];

/// What a line is made of.
enum Part {
    Word(Word),
    /// What a word of several letters changes; its arguments do not matter.
    Named(Block),
}

/// A line in capitals.
pub(super) fn line(line: &str) -> Result<Block, String> {
    if line.starts_with('%') {
        return Ok(Block::default());
    }
    let parts = parts(line)?;
    let codes: Vec<i64> = parts.iter().filter_map(preparatory_code).collect();
    let mut block = Block::default();
    for part in parts {
        match part {
            Part::Named(change) => {
                block.tip_control = change.tip_control.or(block.tip_control);
                block.is_elsewhere |= change.is_elsewhere;
            }
            Part::Word(word) => of_word(&mut block, word, &codes)?,
        }
    }
    if codes.contains(&40) {
        // words of a dwell are times
        block.goes_to.clear();
        block.feed = None;
    }
    Ok(block)
}

/// The number of a G word, tenfold.
fn preparatory_code(part: &Part) -> Option<i64> {
    match part {
        Part::Word(word) if word.address == "G" => Some((word.value * 10.0).round() as i64),
        _ => None,
    }
}

/// What a name changes.
///
/// # Errors
/// If it is not followed.
fn statement(name: &str) -> Result<Block, String> {
    let nothing = Block::default();
    match name {
        "TRAORI" => Ok(Block { tip_control: Some(true), ..nothing }),
        "TRAFOOF" => Ok(Block { tip_control: Some(false), ..nothing }),
        "SUPA" => Ok(Block { is_elsewhere: true, ..nothing }),
        _ if STILL_NAMES.contains(&name) => Ok(nothing),
        _ => Err(format!(
            "`{name}` is not followed: write what it does as straight blocks, or leave it out for the check if it changes no position"
        )),
    }
}

fn of_word(block: &mut Block, word: Word, codes: &[i64]) -> Result<(), String> {
    let has = |known: &[i64]| codes.iter().any(|code| known.contains(code));
    match (word.address.as_str(), word.value) {
        ("F", value) => {
            block.feed = Some(value);
            Ok(())
        }
        ("N" | "O" | ":" | "S" | "T", _) => Ok(()),
        ("P" | "Q", _) if has(&WITH_PARAMETERS) => Ok(()),
        ("H", _) if has(&[TIP_CONTROL]) => Ok(()),
        ("G", value) => preparatory(block, value),
        ("M", value) => auxiliary(block, value),
        ("D" | "H", value) => {
            Err(format!("{}{value} adds to the tool, whose size is that of the spec: leave it out", word.address))
        }
        ("L", value) => Err(format!("L{value} calls a subprogram: write its blocks out")),
        _ => block.goes_to(word),
    }
}

fn auxiliary(block: &mut Block, value: f64) -> Result<(), String> {
    match value as i64 {
        428 => block.tip_control = Some(true),
        429 => block.tip_control = Some(false),
        _ => block.auxiliary(value)?,
    }
    Ok(())
}

fn preparatory(block: &mut Block, value: f64) -> Result<(), String> {
    let code = (value * 10.0).round();
    if (code - value * 10.0).abs() > 1e-6 {
        return Err(format!("G{value} is not followed"));
    }
    match code as i64 {
        0 => block.goes(Motion::Rapid)?,
        10 => block.goes(Motion::Straight)?,
        40 => {}
        200 | 700 | 7000 => block.unit = Some(25.4),
        210 | 710 | 7100 => block.unit = Some(1.0),
        TIP_CONTROL => block.tip_control = Some(true),
        490 => block.tip_control = Some(false),
        530 => block.is_elsewhere = true,
        930 => block.inverse_time = Some(true),
        940 | 950 => block.inverse_time = Some(false),
        code if STILL.contains(&code) => {}
        code => return Err(format!("G{value} {}", why_not(code))),
    }
    Ok(())
}

/// Why a G word, tenfold, is not followed, and a way out.
fn why_not(code: i64) -> &'static str {
    match code {
        20..=39 => "is a circle: only straight blocks are followed",
        50..=59 => "is a curve: only straight blocks are followed",
        280..=309 => "goes to a point of the machine by way of its words: write where it goes, with G53",
        410..=429 => "puts the cutter beside its way by a radius that the program does not have: leave it out",
        430..=439 => "adds a tool length, and that of the spec is in the positions already: leave it out",
        100..=109 | 520 | 920..=929 => "moves the zero: write positions that count from G54",
        500 | 510..=519 | 680..=689 => "turns, scales or mirrors what follows: write positions of the axes",
        541..=599 | 5000..=5999 => "counts from another zero than G54: how far that is off, the program does not say",
        650..=669 => "calls a macro: write its blocks out",
        730..=769 | 810..=899 => "is a cycle: write its blocks out",
        910..=919 => "counts from where the axes stand: only absolute positions are followed",
        _ => "is not followed: leave it out for the check if it changes no position",
    }
}

/// Words and names of a line, without remarks.
fn parts(line: &str) -> Result<Vec<Part>, String> {
    let (mut rest, mut parts, mut known) = (line, Vec::new(), Vec::new());
    loop {
        rest = rest.trim_start();
        let mut letters = rest.chars();
        let (first, second) = (letters.next(), letters.next());
        match first {
            None | Some(';') => return Ok(parts),
            Some('(') => {
                let unclosed = "`(` begins a remark that has no end in its line: close it with `)`";
                rest = rest.split_once(')').ok_or(unclosed)?.1;
            }
            Some('/') => {
                return Err(
                    "`/` marks a block that is skipped or not as a switch says: take the `/` or the block away"
                        .to_string(),
                );
            }
            Some('#') => return Err("`#` begins a variable: only numbers are followed".to_string()),
            Some(letter) if !letter.is_ascii_alphabetic() && letter != ':' => {
                return Err(format!("`{}` begins no word", letter.escape_default()));
            }
            Some(_) if second.is_some_and(|letter| letter.is_ascii_alphabetic() || letter == '_') => {
                let (name, behind) = name(rest);
                parts.push(Part::Named(statement(name)?));
                rest = without_arguments(behind);
            }
            Some(_) => {
                let (word, behind) = word(rest)?;
                if !matches!(word.address.as_str(), "G" | "M") && known.contains(&word.address) {
                    return Err(format!("`{}` stands twice in one block", word.address));
                }
                known.push(word.address.clone());
                parts.push(Part::Word(word));
                rest = behind;
            }
        }
    }
}

/// Letters, digits and low lines at the beginning, and what is behind them.
fn name(text: &str) -> (&str, &str) {
    text.split_at(text.find(|letter: char| !(letter.is_ascii_alphanumeric() || letter == '_')).unwrap_or(text.len()))
}

/// What is behind the arguments or the value of a name.
fn without_arguments(text: &str) -> &str {
    if let Some(value) = text.strip_prefix('=') {
        return value.trim_start_matches(|letter: char| !letter.is_whitespace());
    }
    if !text.starts_with('(') {
        return text;
    }
    let mut is_quoted = false;
    let end = text.find(|letter: char| {
        is_quoted ^= letter == '"';
        letter == ')' && !is_quoted
    });
    end.map_or("", |end| &text[end + 1..])
}

/// A letter with its number, or with a sign of equality between: `X1.5`, `X=AC(1.5)`, `B1=12`, `T="MILL"`.
fn word(text: &str) -> Result<(Word, &str), String> {
    let (letter, behind) = text.split_at(1);
    let digits = behind.find(|letter: char| !letter.is_ascii_digit()).unwrap_or(behind.len());
    let (index, after) = behind.split_at(digits);
    if let Some(value) = after.trim_start().strip_prefix('=') {
        return assigned(&format!("{letter}{index}"), value.trim_start());
    }
    let (value, behind) = number(letter, behind.trim_start())?;
    Ok((Word::new(letter, value), behind))
}

fn number<'t>(address: &str, text: &'t str) -> Result<(f64, &'t str), String> {
    let is_part = |letter: char| letter.is_ascii_digit() || matches!(letter, '.' | '-' | '+');
    let (number, behind) = text.split_at(text.find(|letter| !is_part(letter)).unwrap_or(text.len()));
    let value = number.parse().map_err(|_| match address {
        ":" => "`:` ends a label, which only jumps need: leave the label out".to_string(),
        _ => no_number(address, if number.is_empty() { behind } else { number }),
    })?;
    Ok((value, behind))
}

/// What stands behind a sign of equality: a number, the name of a tool, or a position with how to go there.
fn assigned<'t>(address: &str, text: &'t str) -> Result<(Word, &'t str), String> {
    if let Some(tool) = text.strip_prefix('"').filter(|_| address == "T") {
        return Ok((Word::new(address, 0.0), tool.split_once('"').map_or("", |(_, behind)| behind)));
    }
    let (how, inside) = name(text);
    let Some(inside) =
        inside.strip_prefix('(').filter(|_| how.starts_with(|letter: char| letter.is_ascii_alphabetic()))
    else {
        let (value, behind) = number(address, text)?;
        return Ok((Word::new(address, value), behind));
    };
    let (value, behind) = number(address, inside.trim_start())?;
    let behind = behind.trim_start().strip_prefix(')').ok_or_else(|| format!("`{address}={how}(` has no end"))?;
    let word = Word::new(address, value);
    match how {
        "AC" => Ok((word, behind)),
        "DC" if !(0.0..360.0).contains(&value) => Err(format!(
            "`{address}=DC({value})` is no position of DC, which takes 0 .. 359.999: write it within these, or with AC"
        )),
        "DC" => Ok((Word { by_shorter_way: true, ..word }, behind)),
        "IC" => Err(format!(
            "`{address}=IC({value})` counts from where the axis stands: only absolute positions are followed"
        )),
        _ => Err(format!("`{address}={how}({value})` is not followed: write `{address}=AC(…)` or `{address}=DC(…)`")),
    }
}
