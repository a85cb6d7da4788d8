//! Documents for people: headings, paragraphs, tables and pictures, as an HTML page or as Markdown.
//!
//! A [`Report`] says what stands in the document; `html` and `markdown` say how it looks. All texts are plain: whatever
//! they hold, nothing in them is taken for a tag or a mark.

mod html;
mod markdown;

pub use html::write_report_html;
pub use markdown::write_report_markdown;

use crate::picture::Picture;

/// A document.
#[derive(Debug, Clone)]
pub struct Report {
    /// What kind of document it is; small, above the title.
    pub kind: String,
    /// Its title.
    pub title: String,
    /// What stands before the first section.
    pub opening: Vec<Block>,
    /// Its sections, numbered from 1.
    pub sections: Vec<Section>,
    /// The last line.
    pub closing: String,
}

/// A part of a document with a heading.
#[derive(Debug, Clone)]
pub struct Section {
    /// The heading.
    pub title: String,
    /// What stands under it.
    pub blocks: Vec<Block>,
}

/// A part of a section.
#[derive(Debug, Clone)]
pub enum Block {
    /// A smaller heading.
    Heading(String),
    /// A paragraph.
    Paragraph(String),
    /// Something that must be seen, with more about it below.
    Notice(Tone, String, Vec<String>),
    /// Points one below the other.
    List(Vec<String>),
    /// Names with what belongs to them.
    Facts(Vec<(String, String)>),
    /// A table: its caption, columns, and rows of as many cells.
    Table(String, Vec<Column>, Vec<Vec<String>>),
    /// A picture.
    Figure(Figure),
}

/// What a notice means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// All is as it was asked for.
    Good,
    /// Something is not.
    Bad,
    /// Not all of it was looked at.
    Open,
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// What stands above it.
    pub title: String,
    /// What its cells are.
    pub kind: Kind,
}

/// What cells are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Words, on the left.
    Words,
    /// Sentences, which need room.
    Sentences,
    /// Numbers, on the right.
    Numbers,
    /// Names and formulas as a spec has them.
    Code,
}

/// A picture with its caption.
#[derive(Debug, Clone)]
pub struct Figure {
    /// What a file with it is called, without folder and extension.
    pub name: String,
    /// The picture.
    pub picture: Picture,
    /// What is written below it.
    pub caption: String,
}

impl Report {
    /// All pictures in their order.
    pub fn figures(&self) -> impl Iterator<Item = &Figure> {
        let blocks = self.opening.iter().chain(self.sections.iter().flat_map(|section| &section.blocks));
        blocks.filter_map(|block| match block {
            Block::Figure(figure) => Some(figure),
            _ => None,
        })
    }
}

impl Column {
    /// A column of words.
    #[must_use]
    pub fn words(title: &str) -> Column {
        Column { title: title.to_owned(), kind: Kind::Words }
    }

    /// A column of sentences.
    #[must_use]
    pub fn sentences(title: &str) -> Column {
        Column { title: title.to_owned(), kind: Kind::Sentences }
    }

    /// A column of numbers.
    #[must_use]
    pub fn numbers(title: &str) -> Column {
        Column { title: title.to_owned(), kind: Kind::Numbers }
    }

    /// A column of names and formulas.
    #[must_use]
    pub fn code(title: &str) -> Column {
        Column { title: title.to_owned(), kind: Kind::Code }
    }
}
