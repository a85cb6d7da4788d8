//! Lines of Heidenhain's Klartext as words of ISO 6983.

use super::program::Word;

/// What a line says.
pub(super) enum Line {
    /// Nothing about where the cutter goes.
    Nothing,
    /// mm per unit of lengths.
    Unit(f64),
    /// Tool-centre control on or off.
    TipControl(bool),
    /// These axes go to positions of the machine, not of the work.
    Elsewhere(Vec<String>),
    Block(Vec<Word>),
    /// The program ends.
    End,
}

/// Lines that move no axis of their own accord.
const STILL: [&str; 7] = ["TOOL CALL", "TOOL DEF", "BLK FORM", "CYCL DEF 32", "CYCL DEF 32.0", "* -", "STOP"];

/// Whether a line is the first block of a program in Klartext.
pub(super) fn begins(line: &str) -> bool {
    without_number(&line.to_ascii_uppercase()).starts_with("BEGIN PGM ")
}

/// A line in capitals without its number.
fn without_number(line: &str) -> &str {
    line.trim_start().trim_start_matches(|letter: char| letter.is_ascii_digit()).trim()
}

/// A line in capitals without remarks.
pub(super) fn line(line: &str) -> Result<Line, String> {
    let line = without_number(line);
    if line.starts_with("BEGIN PGM") {
        return Ok(Line::Unit(if line.ends_with("INCH") { 25.4 } else { 1.0 }));
    }
    if line.starts_with("END PGM") {
        return Ok(Line::End);
    }
    if line.is_empty() || STILL.iter().any(|still| line.starts_with(still)) {
        return Ok(Line::Nothing);
    }
    if let Some(function) = line.strip_prefix("FUNCTION ") {
        return tip_control(function);
    }
    match line.split_ascii_whitespace().next() {
        Some("L") => straight(&line[1..]),
        Some(word) if word.starts_with('M') => straight(line),
        _ => Err(format!("`{line}` is no straight block `L`: only these are followed")),
    }
}

fn tip_control(function: &str) -> Result<Line, String> {
    if function == "RESET TCPM" {
        return Ok(Line::TipControl(false));
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
    Ok(Line::TipControl(true))
}

/// The words behind `L`, or M words alone.
fn straight(text: &str) -> Result<Line, String> {
    let (mut words, mut axes, mut is_rapid, mut is_elsewhere) = (Vec::new(), Vec::new(), false, false);
    for word in text.split_ascii_whitespace() {
        let (address, number) = word.split_at(1);
        match (address, number) {
            ("R", "0") => {}
            ("R", _) => return Err(format!("`{word}` compensates the radius: only R0 is followed")),
            ("F", "MAX") => is_rapid = true,
            ("F", _) => {}
            ("M", "91" | "92") => is_elsewhere = true,
            ("I", _) => {
                return Err(format!(
                    "`{word}` counts from where the axis stands: only absolute positions are followed"
                ));
            }
            _ => {
                // some controls write a decimal comma
                let value = number.replace(',', ".").parse().map_err(|_| format!("`{word}` has no number"))?;
                if address != "M" {
                    axes.push(address.to_string());
                }
                words.push(Word { address: address.to_string(), value });
            }
        }
    }
    if is_elsewhere {
        return Ok(Line::Elsewhere(axes));
    }
    if words.iter().any(|word| word.address == "M" && matches!(word.value, 2.0 | 30.0)) {
        return Ok(Line::End);
    }
    words.push(Word { address: "G".to_string(), value: if is_rapid { 0.0 } else { 1.0 } });
    Ok(Line::Block(words))
}
