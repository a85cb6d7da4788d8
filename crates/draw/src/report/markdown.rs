//! A document as Markdown, with its pictures in files beside it.

use std::io::Write;

use super::{Block, Column, Kind, Report, Tone};
use flank_export::WriteError;

/// Writes a document as Markdown with tables. Each picture is named as a file beside it: its name with `.svg`.
///
/// # Errors
/// If the stream refuses.
pub fn write_report_markdown(report: &Report, out: &mut dyn Write) -> Result<(), WriteError> {
    write!(out, "# {}\n\n*{}*\n\n", plain(&report.title), plain(&report.kind))?;
    report.opening.iter().try_for_each(|block| write_block(block, out))?;
    for (k, section) in report.sections.iter().enumerate() {
        write!(out, "## {} {}\n\n", k + 1, plain(&section.title))?;
        section.blocks.iter().try_for_each(|block| write_block(block, out))?;
    }
    write!(out, "---\n\n{}\n", plain(&report.closing))?;
    Ok(())
}

fn write_block(block: &Block, out: &mut dyn Write) -> Result<(), WriteError> {
    match block {
        Block::Heading(text) => write!(out, "### {}\n\n", plain(text))?,
        Block::Paragraph(text) => write!(out, "{}\n\n", plain(text))?,
        Block::Notice(tone, text, more) => {
            let mark = if *tone == Tone::Good { "\u{2713} " } else { "" };
            writeln!(out, "> **{mark}{}**", plain(text))?;
            for (k, item) in more.iter().enumerate() {
                writeln!(out, "{}> - {}", if k == 0 { ">\n" } else { "" }, plain(item))?;
            }
            writeln!(out)?;
        }
        Block::List(items) => {
            items.iter().try_for_each(|item| writeln!(out, "- {}", plain(item)))?;
            writeln!(out)?;
        }
        Block::Facts(facts) => {
            facts.iter().try_for_each(|(name, value)| writeln!(out, "- **{}**: {}", plain(name), plain(value)))?;
            writeln!(out)?;
        }
        Block::Table(caption, columns, rows) => write_table(caption, columns, rows, out)?,
        Block::Figure(figure) => {
            write!(out, "![{}]({}.svg)\n\n", plain(figure.picture.title()), address(&figure.name))?;
            write!(out, "*{}*\n\n", plain(&figure.caption))?;
        }
    }
    Ok(())
}

fn write_table(caption: &str, columns: &[Column], rows: &[Vec<String>], out: &mut dyn Write) -> Result<(), WriteError> {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    write!(out, "**{}**\n\n", plain(caption))?;
    write!(out, "{}", line(columns.iter().map(|column| plain(&column.title)).collect()))?;
    let rule = |column: &Column| if column.kind == Kind::Numbers { "---:" } else { "---" };
    write!(out, "{}", line(columns.iter().map(|column| rule(column).to_owned()).collect()))?;
    for row in rows {
        write!(out, "{}", line(row.iter().map(|cell| plain(cell)).collect()))?;
    }
    writeln!(out)?;
    Ok(())
}

/// Text on one line in which nothing is a mark of Markdown or a tag.
fn plain(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '\\' | '`' | '*' | '_' | '[' | ']' | '|' | '~' | '#' | '$' | '!' => out.extend(['\\', letter]),
            letter if letter.is_control() => out.push(' '),
            letter => out.push(letter),
        }
    }
    out
}

/// A file's name as an address has it.
fn address(name: &str) -> String {
    let is_safe = |byte: u8| byte.is_ascii_alphanumeric() || b"-_.".contains(&byte);
    name.bytes().map(|byte| if is_safe(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") }).collect()
}
