//! Where expressions are broken: one level at a time, from the outside.

use super::print::Printer;
use super::tree::{List, Node, Piece, Place, Shape, lead};
use super::{STEP, WIDTH};

impl Printer<'_> {
    /// Writes a node on one line if it fits, otherwise broken.
    pub(super) fn node(&mut self, node: &Node, at: Place) {
        if node.fits(self.column(node.first, at.indent), at.rest) {
            return self.flat(node, at.indent);
        }
        match &node.shape {
            Shape::Token => self.token(node.first, at.indent),
            Shape::Row(pieces) => self.pieces(pieces, at),
            Shape::List(list) => self.list(node, list, at),
            Shape::Group(inner) => self.group(node, inner, at),
            Shape::Operation(parts) => self.operation(parts, at),
            Shape::Conditional(parts) => self.conditional(parts, at),
            Shape::Steps(calls) => self.steps(calls, at),
        }
    }

    /// Writes a node on the line at hand.
    pub(super) fn flat(&mut self, node: &Node, indent: usize) {
        match &node.shape {
            Shape::Token => self.token(node.first, indent),
            Shape::Row(pieces) => {
                for piece in pieces {
                    self.before(piece);
                    self.flat(&piece.node, indent);
                }
            }
            Shape::List(list) => self.flat_list(node, list, indent),
            Shape::Group(inner) => {
                self.token(node.first, indent);
                self.flat(inner, indent);
                self.token(node.last, indent);
            }
            Shape::Operation(parts) | Shape::Conditional(parts) | Shape::Steps(parts) => {
                for (index, part) in parts.iter().enumerate() {
                    if index > 0 {
                        self.space();
                    }
                    self.flat(part, indent);
                }
            }
        }
    }

    fn flat_list(&mut self, node: &Node, list: &List, indent: usize) {
        let padded = list.is_sample && !list.elements.is_empty();
        self.token(node.first, indent);
        for (index, element) in list.elements.iter().enumerate() {
            if index > 0 {
                self.text(",");
            }
            if index > 0 || padded {
                self.space();
            }
            self.flat(&element.node, indent);
        }
        if padded {
            self.space();
        }
        self.token(node.last, indent);
    }

    /// What belongs to the place before a piece.
    pub(super) fn before(&mut self, piece: &Piece) {
        if piece.gap {
            self.space();
        }
        if piece.stop {
            self.stop();
        }
    }

    /// Writes the pieces of a row; each leaves room for what follows on its line in any case.
    pub(super) fn pieces(&mut self, pieces: &[Piece], at: Place) {
        for (index, piece) in pieces.iter().enumerate() {
            self.before(piece);
            self.node(&piece.node, Place { rest: lead(&pieces[index + 1..], at.rest), ..at });
        }
    }

    fn list(&mut self, node: &Node, list: &List, at: Place) {
        self.token(node.first, at.indent);
        if self.holds_last(node, list, at) {
            return self.list_around_last(node, list, at);
        }
        let inner = at.indent + STEP;
        let rows = list.rows(inner, self.tokens);
        for (index, row) in rows.iter().enumerate() {
            if index > 0 && self.tokens[row[0].node.first].begins_paragraph() {
                self.blank();
            }
            self.newline(inner);
            for (position, element) in row.iter().enumerate() {
                if position > 0 {
                    self.space();
                }
                self.node(&element.node, Place::on_line(inner, 1));
                let ends_line = position + 1 == row.len();
                let ends_list = index + 1 == rows.len() && ends_line;
                match element.comma {
                    Some(comma) if ends_list || ends_line && list.is_sample => self.drop_comma(comma, inner),
                    Some(comma) => self.comma(comma, inner),
                    None if list.is_sample && !ends_line => self.text(","),
                    None => {}
                }
            }
        }
        self.close(node.last, at.indent);
    }

    /// Whether only the last element needs to be broken, as in `taylor(roll, [ … ])`.
    fn holds_last(&self, node: &Node, list: &List, at: Place) -> bool {
        let Some((last, others)) = list.elements.split_last() else { return false };
        let vector = match &last.node.shape {
            Shape::Row(pieces) => pieces.last().map_or(&last.node, |piece| &piece.node),
            _ => &last.node,
        };
        let is_vector = matches!(&vector.shape, Shape::List(_)) && self.tokens[vector.first].text == "[";
        let others: Option<usize> = others.iter().map(|other| other.node.width.map(|width| width + ", ".len())).sum();
        let column = self.column(list.elements[0].node.first, at.indent);
        let fits = others.is_some_and(|others| column + others + last.node.lead() <= WIDTH);
        let is_quiet = self.is_quiet(node.first, vector.first) && self.is_quiet(vector.last, node.last);
        !list.broken && is_vector && fits && is_quiet
    }

    /// Whether no comment stands between two tokens.
    pub(super) fn is_quiet(&self, first: usize, last: usize) -> bool {
        self.tokens[first].comments_before == self.tokens[last].comments_before
    }

    fn list_around_last(&mut self, node: &Node, list: &List, at: Place) {
        for (index, element) in list.elements.iter().enumerate() {
            if index > 0 {
                self.text(",");
                self.space();
            }
            self.node(&element.node, Place::on_line(at.indent, at.rest + 1));
        }
        self.token(node.last, at.indent);
    }

    fn group(&mut self, node: &Node, inner: &Node, at: Place) {
        self.token(node.first, at.indent);
        self.newline(at.indent + STEP);
        self.node(inner, Place::alone(at.indent + STEP));
        self.close(node.last, at.indent);
    }

    /// Writes a closing bracket on a line of its own, comments before it as far in as what it closes.
    pub(super) fn close(&mut self, token: usize, indent: usize) {
        let close = &self.tokens[token];
        if !close.above.is_empty() {
            let is_empty = matches!(self.tokens[token - 1].text.as_str(), "(" | "[" | "{");
            if close.begins_paragraph() && !is_empty {
                self.blank();
            }
            self.newline(indent + STEP);
            self.remarks(close, indent + STEP);
        }
        self.newline(indent);
        self.text(&close.text);
        self.behind(close);
    }

    fn operation(&mut self, parts: &[Node], at: Place) {
        if self.ends_in_brackets(parts, at) {
            let (last, before) = parts.split_last().unwrap_or_else(|| unreachable!("an operation has operands"));
            for part in before {
                self.flat(part, at.indent);
                self.space();
            }
            return self.node(last, at);
        }
        let lines = at.indent + at.hang;
        self.node(&parts[0], Place { rest: 0, ..at });
        for (index, pair) in parts[1..].chunks_exact(2).enumerate() {
            let rest = if 2 * index + 3 == parts.len() { at.rest } else { 0 };
            self.newline(lines);
            self.token(pair[0].first, lines);
            self.space();
            self.node(&pair[1], Place::on_line(lines, rest));
        }
    }

    /// Whether an operation stays on its line and its last operand, a call, a vector or a group, is broken instead: where
    /// lines of their own would not be enough for the operands, and where something is multiplied by one long operand.
    fn ends_in_brackets(&self, parts: &[Node], at: Place) -> bool {
        let Some((last, before)) = parts.split_last() else { return false };
        let Some(opening) = last.opening_width() else { return false };
        let is_quiet = self.is_quiet(parts[0].first, last.first);
        let before: Option<usize> = before.iter().map(|part| part.width.map(|width| width + 1)).sum();
        let column = self.column(parts[0].first, at.indent);
        let fits = before.is_some_and(|before| column + before + opening <= WIDTH);
        is_quiet && fits && (is_product_of_two(parts, self) || !self.fit_on_lines(parts, at))
    }

    fn fit_on_lines(&self, parts: &[Node], at: Place) -> bool {
        let lines = at.indent + at.hang;
        let operators = parts[1..].iter().step_by(2);
        let mut others = operators.zip(parts[2..].iter().step_by(2));
        let rest = |operand: &Node| if operand.last == parts[parts.len() - 1].last { at.rest } else { 0 };
        parts[0].fits(self.column(parts[0].first, at.indent), 0)
            && others.all(|(operator, operand)| {
                operator.width.is_some_and(|width| operand.fits(lines + width + 1, rest(operand)))
            })
    }

    /// `if … then …`, `else if … then …`, `else …`, a line each.
    fn conditional(&mut self, parts: &[Node], at: Place) {
        let lines = at.indent + at.hang;
        self.branch(&parts[..4], at);
        self.newline(lines);
        self.token(parts[4].first, lines);
        self.space();
        match &parts[5].shape {
            Shape::Conditional(parts) => self.conditional(parts, Place { indent: lines, hang: 0, ..at }),
            _ => self.node(&parts[5], Place::on_line(lines, at.rest)),
        }
    }

    /// `if`, condition, `then`, value.
    fn branch(&mut self, parts: &[Node], at: Place) {
        let lines = at.indent + at.hang;
        let width: Option<usize> = parts.iter().map(|part| part.width.map(|width| width + 1)).sum();
        let column = self.column(parts[0].first, at.indent);
        let fits =
            self.is_quiet(parts[0].first, parts[3].last) && width.is_some_and(|width| column + width <= WIDTH + 1);
        self.token(parts[0].first, at.indent);
        self.space();
        self.node(&parts[1], Place::on_line(lines, 0));
        if fits {
            self.space();
        } else {
            self.newline(lines + STEP);
        }
        self.token(parts[2].first, lines);
        self.space();
        self.node(&parts[3], Place::on_line(if fits { lines } else { lines + STEP }, 0));
    }

    fn steps(&mut self, calls: &[Node], at: Place) {
        for (index, call) in calls.iter().enumerate() {
            let below = at.indent + at.hang;
            if index > 0 {
                self.newline(below);
                self.node(call, Place { rest: 0, ..Place::alone(below) });
            } else {
                self.node(call, Place { rest: 0, ..at });
            }
        }
    }
}

fn is_product_of_two(parts: &[Node], printer: &Printer<'_>) -> bool {
    matches!(parts, [_, sign, _] if matches!(printer.tokens[sign.first].text.as_str(), "*" | "/"))
}
