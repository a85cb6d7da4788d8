//! From the words of the text to what may be broken where.

use crate::syntax::{Comment, Kind, Part};

use super::tokens::Tokens;
use super::tree::{Block, Element, Family, Item, List, Node, Piece, Shape, Source, Statement};

/// A text, ready to be laid out.
pub(super) fn source(text: &str, parts: &[Part<'_>], comments: &[Comment]) -> Source {
    let mut builder = Builder { tokens: Tokens::new(text, comments) };
    let items = parts.iter().map(|part| builder.item(part)).collect();
    Source { tokens: builder.tokens.finish(), items }
}

struct Builder<'t> {
    tokens: Tokens<'t>,
}

impl Builder<'_> {
    fn item(&mut self, part: &Part<'_>) -> Item {
        if part.kind == Kind::Block { Item::Block(self.block(part)) } else { Item::Statement(self.statement(part)) }
    }

    fn block(&mut self, part: &Part<'_>) -> Block {
        let body = part.parts.iter().position(|part| part.is("{")).map_or(part.parts.len(), |open| open + 1);
        let (head, body) = part.parts.split_at(body);
        let (items, close) = body.split_at(body.len() - 1);
        Block {
            head: self.pieces(Kind::Statement, head),
            items: items.iter().map(|item| self.item(item)).collect(),
            close: self.token(&close[0]),
        }
    }

    fn statement(&mut self, part: &Part<'_>) -> Statement {
        // the value of a requirement is its message
        let equals = part.parts.iter().position(|part| part.is("=") || part.is(","));
        let (head, value) = part.parts.split_at(equals.map_or(part.parts.len(), |equals| equals + 1));
        let (family, stops) = family(head).unzip();
        let mut head = self.pieces(Kind::Statement, head);
        for &stop in stops.unwrap_or_default() {
            let stop = if stop == EQUALS { equals.unwrap_or(EQUALS) } else { stop };
            if let Some(piece) = head.get_mut(stop) {
                piece.stop = true;
            }
        }
        let value = value.first().map(|value| self.node(value));
        let last = value.as_ref().map_or(head[head.len() - 1].node.last, |value| value.last);
        let value_width = value.as_ref().map_or(Some(0), |value| value.width.map(|width| width + 1));
        let width = row_width(&head).and_then(|head| value_width.map(|value| head + value));
        let width = width.filter(|_| self.is_quiet(head[0].node.first, last));
        Statement { head, value, family, width }
    }

    fn node(&mut self, part: &Part<'_>) -> Node {
        match part.kind {
            Kind::Token | Kind::Number => {
                let token = self.token(part);
                self.finished(Shape::Token, token, Some(self.tokens.row[token].text.chars().count()))
            }
            Kind::List => self.list(part),
            Kind::Group => self.group(part),
            Kind::Operation | Kind::Conditional | Kind::Steps => self.spaced(part),
            kind => {
                let pieces = self.pieces(kind, &part.parts);
                let width = row_width(&pieces);
                let first = pieces[0].node.first;
                self.finished(Shape::Row(pieces), first, width)
            }
        }
    }

    fn spaced(&mut self, part: &Part<'_>) -> Node {
        let nodes: Vec<Node> = part.parts.iter().map(|part| self.node(part)).collect();
        let (first, gaps) = (nodes[0].first, nodes.len() - 1);
        let width = nodes.iter().map(|node| node.width).sum::<Option<usize>>().map(|width| width + gaps);
        let shape = match part.kind {
            Kind::Operation => Shape::Operation(nodes),
            Kind::Conditional => Shape::Conditional(nodes),
            _ => Shape::Steps(nodes),
        };
        self.finished(shape, first, width)
    }

    fn group(&mut self, part: &Part<'_>) -> Node {
        let first = self.token(&part.parts[0]);
        let inner = self.node(&part.parts[1]);
        self.token(&part.parts[2]);
        let width = inner.width.map(|width| width + "()".len());
        self.finished(Shape::Group(Box::new(inner)), first, width)
    }

    fn list(&mut self, part: &Part<'_>) -> Node {
        let is_sample = part.parts[0].is("{");
        let first = self.token(&part.parts[0]);
        let mut elements: Vec<Element> = Vec::new();
        for part in &part.parts[1..part.parts.len() - 1] {
            match elements.last_mut() {
                Some(last) if part.is(",") => last.comma = Some(self.token(part)),
                _ => {
                    let node = self.node(part);
                    let from = elements.last().map_or(first, |last| last.node.last) + 1;
                    let starts_line = (from..=node.first).any(|token| self.tokens.row[token].starts_line);
                    elements.push(Element { node, comma: None, starts_line });
                }
            }
        }
        self.token(&part.parts[part.parts.len() - 1]);
        let broken = elements.first().is_some_and(|first| first.starts_line);
        let commas = elements.len().saturating_sub(1) * ", ".len();
        let brackets = if is_sample && !elements.is_empty() { "{  }".len() } else { "()".len() };
        let width: Option<usize> = elements.iter().map(|element| element.node.width).sum();
        let width = width.map(|width| width + commas + brackets).filter(|_| !broken);
        self.finished(Shape::List(List { elements, broken, is_sample }), first, width)
    }

    fn pieces(&mut self, kind: Kind, parts: &[Part<'_>]) -> Vec<Piece> {
        let gap = |index| index > 0 && gap(kind, parts, index);
        let parts = parts.iter().enumerate();
        parts.map(|(index, part)| Piece { gap: gap(index), stop: false, node: self.node(part) }).collect()
    }

    fn token(&mut self, part: &Part<'_>) -> usize {
        let text = if part.kind == Kind::Number { number(part) } else { part.text.to_owned() };
        self.tokens.push(part.start, part.text.len(), text)
    }

    /// The node that ends with the last token so far.
    fn finished(&self, shape: Shape, first: usize, width: Option<usize>) -> Node {
        let last = self.tokens.row.len() - 1;
        Node { shape, first, last, width: width.filter(|_| self.is_quiet(first, last)) }
    }

    /// Whether no comment stands between two tokens.
    fn is_quiet(&self, first: usize, last: usize) -> bool {
        self.tokens.row[first].comments_before == self.tokens.row[last].comments_before
    }
}

/// Columns that pieces take on one line.
fn row_width(pieces: &[Piece]) -> Option<usize> {
    pieces.iter().map(Piece::width).sum()
}

/// Whether a space stands between the part at an index and the one before it.
fn gap(kind: Kind, parts: &[Part<'_>], index: usize) -> bool {
    let (left, right) = (&parts[index - 1], &parts[index]);
    match kind {
        Kind::Joined => false,
        Kind::Signed => left.is("not"),
        Kind::Element => !(right.is(":") || right.is(",")),
        // without a space, the exponent would be that of the unit
        Kind::Power => parts[0].kind == Kind::Number && parts[0].parts.len() > 1,
        Kind::Statement => !(right.kind == Kind::List && right.parts[0].is("(") && !left.is("at") || right.is(",")),
        _ => true,
    }
}

/// A number as written, one space between it and its unit, none in the unit.
fn number(part: &Part<'_>) -> String {
    let words = part.parts.iter().map(|part| part.text.replace([' ', '\t'], ""));
    words.collect::<Vec<_>>().join(" ")
}

/// Stands for the place of the equal sign among stops.
const EQUALS: usize = usize::MAX;

/// The family of a statement, and which of its parts are aligned.
fn family(head: &[Part<'_>]) -> Option<(Family, &'static [usize])> {
    Some(match head.first()?.text {
        "axis" => (Family::Axis, &[2]),
        "frame" | "insert" => (Family::Frame, &[2, EQUALS]),
        "fix" | "couple" => (Family::Law, &[1, EQUALS]),
        "nc" => (Family::NcWord, &[EQUALS]),
        "machine" | "tool" => (Family::Instance, &[1, EQUALS]),
        "drive" => (Family::Drive, &[EQUALS]),
        "surface" => (Family::Surface, &[2, EQUALS]),
        "sample" => (Family::Sample, &[2]),
        first if first != "at" && head.get(1).is_some_and(|sign| sign.is("=")) => (Family::Segment, &[EQUALS]),
        _ => return None,
    })
}
