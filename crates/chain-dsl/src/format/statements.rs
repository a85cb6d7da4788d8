//! Items and statements, and the empty lines between them.

use super::print::Printer;
use super::tree::{Block, Item, Node, Piece, Place, Shape, Statement};
use super::{STEP, WIDTH};

impl Printer<'_> {
    /// Writes all items, and the comments at the end of the file.
    pub(super) fn file(&mut self, items: &[Item]) {
        let mut last: Option<(&str, usize)> = None;
        for item in items {
            let keyword = self.tokens[item.first()].text.as_str();
            self.paragraph(item.first(), last.is_some());
            let from = self.line_count();
            self.item(item, 0);
            let height = self.line_count() - from;
            if last.is_some_and(|last| are_apart(last, (keyword, height))) {
                self.insert_blank(from);
            }
            last = Some((keyword, height));
        }
        let Some(end) = self.tokens.last().filter(|end| !end.above.is_empty()) else { return };
        self.paragraph(self.tokens.len() - 1, last.is_some());
        self.remarks(end, 0);
    }

    /// Leaves a line empty where one was before a token and its comments.
    fn paragraph(&mut self, token: usize, is_between: bool) {
        if is_between && self.tokens[token].begins_paragraph() {
            self.blank();
        }
        self.end_line();
    }

    fn item(&mut self, item: &Item, indent: usize) {
        self.newline(indent);
        match item {
            Item::Statement(statement) => self.statement(statement, indent),
            Item::Block(block) => self.block(block, indent),
        }
    }

    fn block(&mut self, block: &Block, indent: usize) {
        self.pieces(&block.head, Place::on_line(indent, 0));
        let open = block.head[block.head.len() - 1].node.last;
        match block.items.as_slice() {
            [] if self.is_quiet(open, block.close) => self.token(block.close, indent),
            [Item::Statement(only)] if self.stays_on_line(block, only) => {
                self.space();
                self.inline(only, indent);
                self.space();
                self.token(block.close, indent);
            }
            items => {
                for (index, item) in items.iter().enumerate() {
                    self.paragraph(item.first(), index > 0);
                    self.item(item, indent + STEP);
                }
                self.close(block.close, indent);
            }
        }
    }

    /// Whether a block was written on one line and fits on one.
    fn stays_on_line(&self, block: &Block, only: &Statement) -> bool {
        let first = only.head[0].node.first;
        let width = only.width.map(|width| self.column(first, 0) + width + "  }".len());
        let was_on_line = !self.tokens[first..=block.close].iter().any(|token| token.starts_line);
        was_on_line && self.is_quiet(first - 1, block.close) && width.is_some_and(|width| width <= WIDTH)
    }

    fn statement(&mut self, statement: &Statement, indent: usize) {
        self.align(statement.family);
        if statement.width.is_some_and(|width| indent + width <= WIDTH) {
            return self.inline(statement, indent);
        }
        self.pieces(&statement.head, Place::on_line(indent, 0));
        let Some(value) = &statement.value else { return };
        if self.begins_line(&statement.head, value, indent) {
            self.newline(indent + STEP);
            self.node(value, Place::alone(indent + STEP));
        } else {
            self.space();
            self.node(value, Place::on_line(indent, 0));
        }
    }

    /// Writes a statement on the line at hand.
    fn inline(&mut self, statement: &Statement, indent: usize) {
        for piece in &statement.head {
            self.before(piece);
            self.flat(&piece.node, indent);
        }
        if let Some(value) = &statement.value {
            self.space();
            self.flat(value, indent);
        }
    }

    /// Whether a value that does not fit behind its equal sign stands below it, instead of being broken where it is.
    fn begins_line(&self, head: &[Piece], value: &Node, indent: usize) -> bool {
        let column = self.column(value.first, indent) + 1;
        if value.fits(column, 0) {
            return false;
        }
        let after_comment =
            self.tokens[head[head.len() - 1].node.last].behind.is_some() || !self.tokens[value.first].above.is_empty();
        let is_column = match &value.shape {
            Shape::Conditional(_) => true,
            Shape::Steps(calls) => calls.len() > 1,
            _ => false,
        };
        let is_function = self.tokens[head[0].node.first].text == "fn";
        let head_width: Option<usize> = head.iter().map(Piece::width).sum();
        let on_a_line = head_width.is_some_and(|width| indent + width <= WIDTH);
        let fits_below = is_function && on_a_line && value.fits(indent + STEP, 0);
        after_comment || is_column || fits_below || column + value.lead() > WIDTH
    }
}

/// Whether an empty line always stands between two items: unless both are `use`, or both are short.
fn are_apart((first, first_height): (&str, usize), (second, second_height): (&str, usize)) -> bool {
    match (first == "use", second == "use") {
        (true, true) => false,
        (false, false) => first_height > 1 || second_height > 1,
        _ => true,
    }
}
