//! Lines of Heidenhain's Klartext.

use super::block::{Block, Motion, Word, no_number};

/// Lines that move no axis of their own accord; cycle 32 says how near a control keeps to corners.
const STILL: [&str; 5] = ["TOOL DEF", "BLK FORM", "CYCL DEF 32.", "CYCL DEF 32 ", "* -"];

/// Whether a line is the first block of a program in Klartext.
pub(super) fn begins(line: &str) -> bool {
    without_number(&line.to_ascii_uppercase()).starts_with("BEGIN PGM ")
}

/// Whether a line is the last block of one.
pub(super) fn ends(line: &str) -> bool {
    without_number(&line.to_ascii_uppercase()).starts_with("END PGM")
}

/// A line without its number.
fn without_number(line: &str) -> &str {
    line.trim_start().trim_start_matches(|letter: char| letter.is_ascii_digit()).trim()
}

/// A line in capitals.
pub(super) fn line(line: &str) -> Result<Block, String> {
    let line = without_number(line.split(';').next().unwrap_or_default());
    if line.starts_with("BEGIN PGM") {
        let unit = if line.ends_with("INCH") { 25.4 } else { 1.0 };
        return Ok(Block { unit: Some(unit), ..Block::default() });
    }
    if ends(line) {
        return Ok(Block { ends: true, ..Block::default() });
    }
    if line.is_empty() || line == "STOP" || STILL.iter().any(|still| line.starts_with(still)) {
        return Ok(Block::default());
    }
    if let Some(call) = line.strip_prefix("TOOL CALL ") {
        return tool(call);
    }
    if let Some(function) = line.strip_prefix("FUNCTION ") {
        return tip_control(function);
    }
    match line.split_ascii_whitespace().next() {
        Some("L") => straight(&line[1..]),
        Some(word) if word.starts_with('M') => straight(line),
        _ if line.starts_with('/') => {
            Err(format!("`{line}` is skipped or not as a switch says: take the `/` or the block away"))
        }
        _ => Err(format!("`{line}` is no straight block `L`: only these are followed")),
    }
}

/// A tool is called as it is.
fn tool(call: &str) -> Result<Block, String> {
    let added = call.split_ascii_whitespace().find(|word| word.starts_with("DL") || word.starts_with("DR"));
    match added {
        Some(word) => Err(format!("`{word}` adds to the tool, whose size is that of the spec: leave it out")),
        None => Ok(Block::default()),
    }
}

fn tip_control(function: &str) -> Result<Block, String> {
    let switched = |on: bool| Block { tip_control: Some(on), ..Block::default() };
    if function == "RESET TCPM" {
        return Ok(switched(false));
    }
    let has = |word: &str| function.contains(word);
    if !has("TCPM") {
        return Err(format!("FUNCTION {function} is not followed"));
    }
    if has("AXIS SPAT") || has("PATHCTRL VECTOR") {
        return Err(format!(
            "FUNCTION {function} is not followed: rotary words have to be positions of the axes, which turn evenly: AXIS POS PATHCTRL AXIS"
        ));
    }
    Ok(switched(true))
}

/// The words behind `L`, or M words alone.
fn straight(text: &str) -> Result<Block, String> {
    let mut block = Block { motion: Some(Motion::Straight), ..Block::default() };
    for word in text.split_ascii_whitespace() {
        let (address, number) = word.split_at(word.chars().next().map_or(0, char::len_utf8));
        match (address, number) {
            ("R", "0") => {}
            ("R", _) => return Err(format!("`{word}` compensates the radius: only R0 is followed")),
            ("F", "MAX") => block.motion = Some(Motion::Rapid),
            ("F", feed) => block.feed = feed.replace(',', ".").parse().ok(),
            ("M", "91" | "92") => block.is_elsewhere = true,
            ("M", "128") => block.tip_control = Some(true),
            ("M", "129") => block.tip_control = Some(false),
            ("I", _) => {
                return Err(format!(
                    "`{word}` counts from where the axis stands: only absolute positions are followed"
                ));
            }
            _ => {
                // some controls write a decimal comma
                let value = number.replace(',', ".").parse().map_err(|_| no_number(address, number))?;
                match address {
                    "M" => block.auxiliary(value)?,
                    _ => block.goes_to(Word::new(address, value))?,
                }
            }
        }
    }
    Ok(block)
}
