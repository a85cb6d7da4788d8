//! What may be broken where.

use super::STEP;
use super::WIDTH;
use super::tokens::Token;

/// A text, ready to be laid out.
#[derive(Debug)]
pub(super) struct Source {
    /// All words and signs, and one without a text at the end.
    pub(super) tokens: Vec<Token>,
    pub(super) items: Vec<Item>,
}

/// What begins on a line of its own: an item or a statement.
#[derive(Debug)]
pub(super) enum Item {
    Statement(Statement),
    Block(Block),
}

impl Item {
    pub(super) fn first(&self) -> usize {
        match self {
            Item::Statement(statement) => statement.head[0].node.first,
            Item::Block(block) => block.head[0].node.first,
        }
    }
}

/// A statement.
#[derive(Debug)]
pub(super) struct Statement {
    /// Up to the equal sign if there is one, otherwise all of it.
    pub(super) head: Vec<Piece>,
    pub(super) value: Option<Node>,
    /// Statements of one family are aligned below each other.
    pub(super) family: Option<Family>,
    /// As [`Node::width`].
    pub(super) width: Option<usize>,
}

/// Statements that are aligned below each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Family {
    Axis,
    Frame,
    /// `fix` and `couple`.
    Law,
    NcWord,
    /// `machine` and `tool` in a job.
    Instance,
    Drive,
    Surface,
    Sample,
    /// `name = line(…)` in a profile.
    Segment,
}

/// Statements between braces.
#[derive(Debug)]
pub(super) struct Block {
    /// Up to the opening brace.
    pub(super) head: Vec<Piece>,
    pub(super) items: Vec<Item>,
    /// The closing brace.
    pub(super) close: usize,
}

/// A part of a row.
#[derive(Debug)]
pub(super) struct Piece {
    /// Whether a space stands before it.
    pub(super) gap: bool,
    /// Whether it is moved to the right to stand below that of the line above.
    pub(super) stop: bool,
    pub(super) node: Node,
}

impl Piece {
    /// Columns that it takes on one line with the space before it.
    pub(super) fn width(&self) -> Option<usize> {
        self.node.width.map(|width| width + usize::from(self.gap))
    }
}

/// A range of tokens.
#[derive(Debug)]
pub(super) struct Node {
    pub(super) shape: Shape,
    pub(super) first: usize,
    pub(super) last: usize,
    /// Columns that it takes on one line; none if comments or the writer's own line ends keep it from standing on one.
    pub(super) width: Option<usize>,
}

/// How a [`Node`] is made.
#[derive(Debug)]
pub(super) enum Shape {
    Token,
    /// Parts that stay on a line as long as they can.
    Row(Vec<Piece>),
    List(List),
    /// Brackets around one expression; an index if it stands behind a value.
    Group(Box<Node>),
    /// Operand, operator, operand, …; broken before operators.
    Operation(Vec<Node>),
    /// `if`, condition, `then`, value, `else`, value.
    Conditional(Vec<Node>),
    /// Transforms of a frame, a line each.
    Steps(Vec<Node>),
}

/// Brackets around elements with commas between them.
#[derive(Debug)]
pub(super) struct List {
    pub(super) elements: Vec<Element>,
    /// Whether it was written with the first element on a line of its own: it stays so, and its lines too.
    pub(super) broken: bool,
    /// The list of a sample: spaces inside the braces, no commas at the ends of lines.
    pub(super) is_sample: bool,
}

/// An element of a [`List`].
#[derive(Debug)]
pub(super) struct Element {
    pub(super) node: Node,
    /// The comma behind it.
    pub(super) comma: Option<usize>,
    /// Whether it was written on another line than the element before.
    pub(super) starts_line: bool,
}

impl Node {
    /// Whether it fits on a line from this column on, with that many columns to follow.
    pub(super) fn fits(&self, column: usize, rest: usize) -> bool {
        self.width.is_some_and(|width| column + width + rest <= WIDTH)
    }

    /// Columns that its first line takes at least.
    pub(super) fn lead(&self) -> usize {
        match &self.shape {
            Shape::Token => self.width.unwrap_or(0),
            Shape::Row(pieces) => lead(pieces, 0),
            Shape::List(_) | Shape::Group(_) => 1,
            Shape::Operation(parts) => parts[0].lead(),
            Shape::Conditional(_) | Shape::Steps(_) => 0,
        }
    }

    /// Whether it cannot be broken.
    fn is_fixed(&self) -> bool {
        match &self.shape {
            Shape::Token => true,
            Shape::Row(pieces) => pieces.iter().all(|piece| piece.node.is_fixed()),
            Shape::List(list) => list.elements.is_empty(),
            _ => false,
        }
    }

    /// Columns up to and with the opening bracket that it ends with, if it is a vector, a call or a group.
    pub(super) fn opening_width(&self) -> Option<usize> {
        match &self.shape {
            Shape::List(list) if !list.elements.is_empty() => Some(1),
            Shape::Group(_) => Some(1),
            Shape::Row(pieces) => match pieces.as_slice() {
                [name, Piece { node: Node { shape: Shape::List(list), .. }, .. }] if !list.elements.is_empty() => {
                    name.node.width.map(|width| width + 1)
                }
                _ => None,
            },
            _ => None,
        }
    }
}

/// Columns that the first line of a row takes at least: up to where it can be broken, otherwise all with `rest` behind.
pub(super) fn lead(pieces: &[Piece], rest: usize) -> usize {
    let fixed = pieces.iter().take_while(|piece| piece.node.is_fixed()).count();
    let width: usize = pieces[..fixed].iter().filter_map(Piece::width).sum();
    width + pieces.get(fixed).map_or(rest, |next| next.node.lead() + usize::from(next.gap))
}

impl List {
    /// The elements in lines: as they were written if the list was broken; otherwise all on one if they fit; otherwise each
    /// on one.
    pub(super) fn rows(&self, indent: usize, tokens: &[Token]) -> Vec<&[Element]> {
        let written: Vec<&[Element]> = if self.broken {
            self.elements.chunk_by(|_, next| !next.starts_line).collect()
        } else {
            vec![&self.elements]
        };
        let length = |row: &[Element]| if fits(row, indent, tokens) { row.len() } else { 1 };
        written.into_iter().flat_map(|row| row.chunks(length(row))).collect()
    }
}

/// Whether elements fit on one line, with a comma behind.
fn fits(row: &[Element], indent: usize, tokens: &[Token]) -> bool {
    let (Some(first), Some(last)) = (row.first(), row.last()) else { return false };
    let quiet = tokens[first.node.first].comments_before == tokens[last.node.last].comments_before;
    let width: Option<usize> = row.iter().map(|element| element.node.width.map(|width| width + ", ".len())).sum();
    quiet && width.is_some_and(|width| indent + width <= WIDTH + 1)
}

/// Where something is printed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Indentation of the line on which it begins, or of the statement that it belongs to.
    pub(super) indent: usize,
    /// How much further its other lines are indented.
    pub(super) hang: usize,
    /// Columns that must be left on its last line.
    pub(super) rest: usize,
}

impl Place {
    /// Somewhere on a line with this indentation.
    pub(super) fn on_line(indent: usize, rest: usize) -> Place {
        Place { indent, hang: STEP, rest }
    }

    /// Alone on lines with this indentation.
    pub(super) fn alone(indent: usize) -> Place {
        Place { indent, hang: 0, rest: 0 }
    }
}
