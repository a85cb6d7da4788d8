//! A document as one HTML page that is well-formed XML too: style and pictures are in it, and there is no script.

use std::io::Write;

use super::{Block, Column, Figure, Kind, Report, Section, Tone};
use crate::base64::encoded_bytes;
use crate::picture::{Picture, letters};
use flank_export::WriteError;
use flank_export::text::escaped;
use flank_export::text::with_minus;

const STYLE: &str = include_str!("style.css");
/// Bytes that the pictures of a page have at the most, as long as some of them are not pixels.
const MOST_BYTES: usize = 2_200_000;
/// Letters of names that are kept on one line.
const LONG_NAME: usize = 26;

/// Writes a document as an HTML page that needs no other file and prints on A4.
///
/// # Errors
/// If the stream refuses.
pub fn write_report_html(report: &Report, out: &mut dyn Write) -> Result<(), WriteError> {
    let title = escaped(&report.title);
    write!(out, "<!DOCTYPE html>\n<html lang=\"en\" xmlns=\"http://www.w3.org/1999/xhtml\">\n<head>\n")?;
    write!(out, "<meta charset=\"utf-8\"/>\n<meta name=\"viewport\" content=\"width=device-width\"/>\n")?;
    write!(out, "<title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n")?;
    let pictures: Vec<&Picture> = report.figures().map(|figure| &figure.picture).collect();
    let mut drawn = drawn(&pictures)?.into_iter();
    if !pictures.is_empty() {
        let letters = letters(pictures);
        writeln!(
            out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"letters\" aria-hidden=\"true\">{letters}</svg>"
        )?;
    }
    write!(out, "<header>\n<p class=\"kind\">{}</p>\n<h1>{title}</h1>\n", escaped(&report.kind))?;
    report.opening.iter().try_for_each(|block| write_block(block, &mut drawn, out))?;
    write!(out, "</header>\n<nav>\n<ol>\n")?;
    for (k, section) in report.sections.iter().enumerate() {
        writeln!(out, "<li><a href=\"#s{}\">{}</a></li>", k + 1, escaped(&section.title))?;
    }
    write!(out, "</ol>\n</nav>\n<main>\n")?;
    for (k, section) in report.sections.iter().enumerate() {
        write_section(k + 1, section, &mut drawn, out)?;
    }
    write!(out, "</main>\n<footer>{}</footer>\n</body>\n</html>\n", escaped(&report.closing))?;
    Ok(())
}

/// The pictures as lines and letters; the largest of them as pixels, if the page would become too large.
fn drawn(pictures: &[&Picture]) -> Result<Vec<String>, WriteError> {
    let mut drawn: Vec<(usize, String)> = pictures.iter().map(|picture| picture.element()).enumerate().collect();
    drawn.sort_by_key(|(at, element)| (std::cmp::Reverse(element.len()), *at));
    let mut bytes: usize = drawn.iter().map(|(_, element)| element.len()).sum();
    for (at, element) in &mut drawn {
        if bytes <= MOST_BYTES {
            break;
        }
        let picture = pictures[*at];
        let pixels = encoded_bytes(&picture.png()?);
        bytes -= element.len();
        *element = format!("<img alt=\"{}\" src=\"data:image/png;base64,{pixels}\"/>\n", escaped(picture.title()));
        bytes += element.len();
    }
    drawn.sort_by_key(|(at, _)| *at);
    Ok(drawn.into_iter().map(|(_, element)| element).collect())
}

fn write_section(
    number: usize,
    section: &Section,
    drawn: &mut impl Iterator<Item = String>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let title = escaped(&section.title);
    write!(out, "<section id=\"s{number}\">\n<h2><span>{number}</span> {title}</h2>\n")?;
    section.blocks.iter().try_for_each(|block| write_block(block, drawn, out))?;
    writeln!(out, "</section>")?;
    Ok(())
}

/// `drawn` are the pictures that are still to come.
fn write_block(block: &Block, drawn: &mut impl Iterator<Item = String>, out: &mut dyn Write) -> Result<(), WriteError> {
    match block {
        Block::Heading(text) => writeln!(out, "<h3>{}</h3>", escaped(text))?,
        Block::Paragraph(text) => writeln!(out, "<p>{}</p>", escaped(text))?,
        Block::Notice(tone, text, more) => write_notice(*tone, text, more, out)?,
        Block::List(items) => write_list(items, out)?,
        Block::Facts(facts) => {
            writeln!(out, "<dl>")?;
            for (name, value) in facts {
                writeln!(out, "<dt>{}</dt><dd>{}</dd>", escaped(name), escaped(value))?;
            }
            writeln!(out, "</dl>")?;
        }
        Block::Table(caption, columns, rows) => write_table(caption, columns, rows, out)?,
        Block::Figure(Figure { caption, .. }) => {
            let picture = drawn.next().unwrap_or_default();
            write!(out, "<figure>\n{picture}<figcaption>{}</figcaption>\n</figure>\n", escaped(caption))?;
        }
    }
    Ok(())
}

fn write_notice(tone: Tone, text: &str, more: &[String], out: &mut dyn Write) -> Result<(), WriteError> {
    let (class, mark) = match tone {
        Tone::Good => ("good", "\u{2713}"),
        Tone::Bad => ("bad", "!"),
        Tone::Open => ("open", "?"),
    };
    write!(out, "<div class=\"notice {class}\">\n<p><b>{mark}</b> {}</p>\n", escaped(text))?;
    if !more.is_empty() {
        write_list(more, out)?;
    }
    writeln!(out, "</div>")?;
    Ok(())
}

fn write_list(items: &[String], out: &mut dyn Write) -> Result<(), WriteError> {
    writeln!(out, "<ul>")?;
    for item in items {
        writeln!(out, "<li>{}</li>", escaped(item))?;
    }
    writeln!(out, "</ul>")?;
    Ok(())
}

fn write_table(caption: &str, columns: &[Column], rows: &[Vec<String>], out: &mut dyn Write) -> Result<(), WriteError> {
    write!(out, "<div class=\"table\"><table>\n<caption>{}</caption>\n<thead><tr>", escaped(caption))?;
    for column in columns {
        write!(out, "<th{}>{}</th>", class(column.kind), escaped(&column.title))?;
    }
    write!(out, "</tr></thead>\n<tbody>\n")?;
    for row in rows {
        // a row without a name belongs to the one above
        let joined = if row.first().is_some_and(String::is_empty) { " class=\"same\"" } else { "" };
        write!(out, "<tr{joined}>")?;
        for (column, cell) in columns.iter().zip(row) {
            let class = if is_amount(column.kind, cell) { " class=\"k\"" } else { class(column.kind) };
            write!(out, "<td{class}>{}</td>", shown(column.kind, cell))?;
        }
        writeln!(out, "</tr>")?;
    }
    write!(out, "</tbody>\n</table></div>\n")?;
    Ok(())
}

/// A cell: numbers with a real minus sign, names in pieces that fit on a line.
fn shown(kind: Kind, cell: &str) -> String {
    match kind {
        Kind::Words | Kind::Sentences if cell.split_whitespace().any(is_long) => in_pieces(cell),
        Kind::Words | Kind::Sentences => escaped(cell),
        Kind::Numbers => escaped(&with_minus(cell)),
        Kind::Code if is_long(cell) => in_pieces(cell),
        Kind::Code => escaped(cell),
    }
}

/// A number with its unit, which stays on one line.
fn is_amount(kind: Kind, cell: &str) -> bool {
    kind == Kind::Words && !is_long(cell) && cell.starts_with(|letter: char| letter.is_ascii_digit())
}

fn is_long(text: &str) -> bool {
    text.chars().count() > LONG_NAME
}

fn in_pieces(text: &str) -> String {
    escaped(text).replace('_', "_<wbr/>")
}

fn class(kind: Kind) -> &'static str {
    match kind {
        Kind::Words => "",
        Kind::Sentences => " class=\"s\"",
        Kind::Numbers => " class=\"n\"",
        Kind::Code => " class=\"c\"",
    }
}
