//! Texts of the language at random: every construct, brackets where they matter, white space and comments where nobody
//! would put them.

/// Knuth's linear congruential generator.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % bound.max(1)
    }

    fn one_in(&mut self, bound: usize) -> bool {
        self.below(bound) == 0
    }

    fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }
}

const NAMES: [&str; 10] = [
    "a",
    "b",
    "profile",
    "along",
    "α_n",
    "roll",
    "work_offset",
    "machine_center_to_crossing_point",
    "x1",
    "point_radius",
];
const NUMBERS: [&str; 12] = [
    "0",
    "2",
    "20 mm",
    "20deg",
    "1.0e-3 mm",
    "1E3",
    "2 mm/rev",
    "2 mm / rev",
    "3 µm",
    "2 mm^2/deg^-3",
    "70.53\tmm",
    "127.37207511178428 mm",
];
const OPERATORS: [&str; 8] = ["+", "-", "*", "/", "^", "and", "or", "*"];
const COMPARISONS: [&str; 6] = ["<", "<=", ">", ">=", "==", "!="];

/// Writes one text.
pub(crate) struct Writer {
    random: Random,
    text: String,
    /// One in so many gaps has a comment.
    comments: usize,
    count: usize,
}

/// A text from a seed.
pub(crate) fn text(seed: u64) -> String {
    let mut random = Random(seed);
    let comments = random.of(&[3, 10, 40, usize::MAX]);
    let mut writer = Writer { random, text: String::new(), comments, count: 0 };
    for _ in 0..=writer.random.below(3) {
        writer.item();
    }
    writer.gap(false);
    writer.text
}

impl Writer {
    /// A word or a sign, with a gap before it.
    fn put(&mut self, word: &str) {
        let is_word = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || "_\".".contains(c));
        let must = is_word(self.text.chars().next_back()) && is_word(word.chars().next());
        self.gap(must);
        self.text.push_str(word);
    }

    fn all(&mut self, words: &[&str]) {
        words.iter().for_each(|word| self.put(word));
    }

    fn gap(&mut self, must: bool) {
        if self.comments < usize::MAX && self.random.one_in(self.comments) {
            return self.comment();
        }
        let gaps = ["", " ", " ", " ", " ", "\n", "\t", "\r\n  ", "\n\n\n"];
        let from = usize::from(must);
        let gap = gaps[from + self.random.below(gaps.len() - from)];
        self.text.push_str(gap);
    }

    fn comment(&mut self) {
        self.count += 1;
        let before = self.random.of(&[" ", "\n", "  ", "\n\n", "\r\n\t"]);
        let mark = self.random.of(&["//", "// ", "/// ", "//! ", "//// "]);
        let after = self.random.of(&["\n", "\n", "\r\n", "  \n\n"]);
        self.text.push_str(&format!("{before}{mark}{}{after}", self.count));
        if self.random.one_in(3) {
            self.comment();
        }
    }

    fn name(&mut self) {
        let name = self.random.of(&NAMES);
        self.put(name);
    }

    fn item(&mut self) {
        match self.random.below(7) {
            6 => {
                self.all(&["job", "again", "="]);
                self.name();
                self.text.push('(');
                for _ in 0..self.random.below(4) {
                    self.put("m.x");
                    self.put(":");
                    self.expression(2);
                    self.put(",");
                }
                self.put(")");
            }
            0 => self.all(&["use", "\"../a // b.chain\""]),
            1 => self.function(),
            2 => self.block(&["machine"], Writer::machine_statement),
            3 => self.block(&["tool"], Writer::tool_statement),
            _ => self.block(&["job"], Writer::job_statement),
        }
    }

    fn block(&mut self, head: &[&str], statement: fn(&mut Writer)) {
        self.all(head);
        self.name();
        if head != ["tool"] && self.random.one_in(3) {
            self.put("extends");
            self.name();
            if head == ["job"] && self.random.one_in(2) {
                self.text.push('(');
                self.all(&["m.x", ":"]);
                self.expression(1);
                self.put(")");
            }
        }
        self.put("{");
        for _ in 0..self.random.below(5) {
            statement(self);
        }
        self.put("}");
    }

    fn function(&mut self) {
        self.put("fn");
        self.name();
        self.list("(", ")", |writer| {
            writer.name();
            writer.put(":");
            writer.value_type();
        });
        if self.random.one_in(2) {
            self.put("->");
            self.value_type();
        }
        if self.random.one_in(2) {
            self.put("=");
            return self.value();
        }
        self.put("{");
        for _ in 0..self.random.below(3) {
            self.assignment("let");
        }
        // a sign or a bracket would go on with the value before
        self.put("if");
        self.conditional(2);
        self.put("}");
    }

    fn list(&mut self, open: &str, close: &str, element: fn(&mut Writer)) {
        self.put(open);
        let count = self.random.of(&[0, 1, 2, 3, 7]);
        for index in 0..count {
            element(self);
            if index + 1 < count || self.random.one_in(3) {
                self.put(",");
            }
        }
        self.put(close);
    }

    fn assignment(&mut self, keyword: &str) {
        self.put(keyword);
        self.name();
        self.put("=");
        self.value();
    }

    fn param(&mut self) {
        self.put("param");
        self.name();
        self.put(":");
        self.dimension();
        if self.random.one_in(3) {
            self.put("in");
            self.range();
        }
        if self.random.one_in(4) {
            self.put("step");
            self.value();
        }
        if self.random.one_in(2) {
            self.put("=");
            self.expression(2);
        }
    }

    fn parameter(&mut self) {
        self.name();
        self.put(":");
        self.dimension();
        self.put("in");
        self.range();
    }

    fn value_type(&mut self) {
        self.dimension();
        if self.random.one_in(3) {
            self.all(&["[", "3", "]"]);
        }
    }

    fn dimension(&mut self) {
        let dimension: &[&str] = self.random.of(&[
            &["length"][..],
            &["angle"],
            &["length", "/", "angle"],
            &["1", "/", "length"],
            &["length", "^", "2", "*", "count"],
        ]);
        self.all(dimension);
    }

    fn range(&mut self) {
        self.expression(1);
        self.put("..");
        self.expression(1);
    }

    fn machine_statement(&mut self) {
        match self.random.below(13) {
            0 => self.param(),
            12 => {
                self.put("error");
                self.name();
                self.put(":");
                self.dimension();
                if self.random.one_in(2) {
                    self.put("in");
                    self.range();
                }
            }
            1 => self.assignment("let"),
            7 => self.requirement(),
            8 => {
                self.assignment("nc");
                if self.random.one_in(2) {
                    self.put("by");
                    self.value();
                }
            }
            9 => {
                self.put("unknown");
                self.name();
                self.all(&[":", "rotary", "in"]);
                self.range();
            }
            10 => self.close(),
            11 => self.machine_expectation(),
            2 => self.assignment("fix"),
            3 => self.assignment("couple"),
            4 => {
                self.put("axis");
                self.name();
                self.all(&[":", "linear"]);
                if self.random.one_in(2) {
                    self.put("in");
                    self.range();
                }
            }
            _ => self.frame(),
        }
    }

    fn close(&mut self) {
        self.put("close");
        self.name();
        self.put("=");
        self.name();
        for word in ["along", "about"] {
            if self.random.one_in(2) {
                self.all(&[word, "x", ",", "y"]);
            }
        }
        for _ in 0..self.random.of(&[0, 0, 1, 2]) {
            self.put("keep");
            self.name();
            self.put(":");
            self.range();
        }
    }

    fn machine_expectation(&mut self) {
        self.all(&["expect", "tool", "in", "work", "near"]);
        self.call(2);
        self.all(&["at", "(", "X", ":"]);
        self.value();
        self.all(&[")", "within"]);
        self.value();
        if self.random.one_in(2) {
            self.put(",");
            self.value();
        }
    }

    fn expectation(&mut self) {
        self.put("expect");
        match self.random.below(6) {
            0 => self.all(&["error", "E0307"]),
            1 => self.all(&["all", "solved"]),
            2 => {
                self.all(&["flank", "undercut", "at", "["]);
                self.value();
                self.put(",");
                self.value();
                self.put("]");
            }
            3 => {
                self.all(&["on", "free_form", "within"]);
                self.value();
            }
            4 => {
                self.all(&["flank", ":"]);
                self.value();
                self.put("in");
                self.range();
            }
            _ => {
                self.value();
                self.put("near");
                self.value();
                self.put("within");
                self.value();
            }
        }
    }

    fn requirement(&mut self) {
        self.put("require");
        self.value();
        self.all(&[",", "\"a // b\""]);
    }

    fn frame(&mut self) {
        let keyword = self.random.of(&["frame", "insert"]);
        self.put(keyword);
        self.name();
        if keyword == "frame" && self.random.one_in(5) {
            return;
        }
        self.put("in");
        self.name();
        self.put("=");
        for _ in 0..=self.random.below(3) {
            self.call(2);
        }
    }

    fn tool_statement(&mut self) {
        match self.random.below(6) {
            0 => self.param(),
            1 => self.assignment("let"),
            2 => self.profile(),
            3 => self.requirement(),
            _ => self.tool_surface(),
        }
    }

    fn profile(&mut self) {
        self.put("profile");
        self.name();
        self.put("{");
        for _ in 0..self.random.below(4) {
            self.name();
            self.put("=");
            self.call(2);
        }
        self.put("}");
    }

    fn tool_surface(&mut self) {
        self.put("surface");
        self.name();
        let has_sides = self.random.one_in(3);
        if has_sides {
            self.put(",");
            self.name();
        }
        self.put("(");
        if self.random.one_in(3) {
            self.name();
            self.all(&[":", "along"]);
            self.name();
        } else {
            self.parameter();
        }
        for _ in 0..self.random.below(3) {
            self.put(",");
            self.parameter();
        }
        self.put(")");
        if has_sides {
            self.put("for");
            self.name();
            self.put("in");
            self.vector(1);
        }
        self.put("{");
        if self.random.one_in(2) {
            self.assignment("let");
        }
        self.all(&["at", "="]);
        self.value();
        match self.random.below(3) {
            0 => self.all(&["body", "inside"]),
            1 => {
                self.all(&["body", "towards"]);
                self.vector(1);
            }
            _ => {
                self.all(&["body", "where"]);
                self.value();
                self.put("<");
                self.value();
            }
        }
        self.put("}");
    }

    fn job_statement(&mut self) {
        match self.random.below(16) {
            0 => self.param(),
            1 => self.assignment("let"),
            2 | 3 => self.instance(),
            4 => {
                self.put("mount");
                self.name();
                self.all(&["on", "m.work"]);
            }
            5 => {
                let keyword = self.random.of(&["motion", "unknown"]);
                self.put(keyword);
                self.parameter();
            }
            6 => {
                self.put("drive");
                let more = self.row(|it: &mut Writer| it.put("m.cradle"));
                self.put("=");
                self.value();
                for _ in 0..more {
                    self.put(",");
                    self.value();
                }
            }
            7 => {
                self.put("surface");
                self.row(Self::name);
                self.all(&["in", "m.work", "="]);
                self.call(2);
            }
            8 => {
                let keyword = self.random.of(&["trim", "cut"]);
                self.put(keyword);
                self.name();
                self.put("by");
                self.name();
            }
            9 => self.requirement(),
            10 => {
                self.put("solid");
                self.name();
                self.all(&["in", "m.work", "="]);
                self.call(2);
            }
            11 => {
                self.put("contact");
                self.name();
                self.put("=");
                self.name();
                self.put("with");
                self.name();
                for _ in 0..self.random.below(4) {
                    self.put(",");
                    self.name();
                    self.put(":");
                    self.value();
                }
            }
            12 => self.profile(),
            13 => {
                self.put("want");
                self.name();
                self.put("in");
                self.name();
                self.put("=");
                self.call(2);
            }
            14 => self.expectation(),
            _ => self.sample(),
        }
    }

    /// One or several with commas between them; how many after the first.
    fn row(&mut self, put: impl Fn(&mut Self)) -> usize {
        put(self);
        let more = self.random.of(&[0, 0, 1, 3]);
        for _ in 0..more {
            self.put(",");
            put(self);
        }
        more
    }

    fn instance(&mut self) {
        let keyword = self.random.of(&["machine", "tool"]);
        self.put(keyword);
        self.name();
        self.put("=");
        self.name();
        if self.random.one_in(3) {
            return;
        }
        self.text.push('(');
        for _ in 0..self.random.below(5) {
            self.name();
            self.put(":");
            self.expression(2);
            self.put(",");
        }
        self.put(")");
    }

    fn sample(&mut self) {
        self.put("sample");
        self.row(|it: &mut Writer| {
            it.name();
            if it.random.one_in(4) {
                it.put("as");
                it.name();
            }
        });
        if self.random.one_in(5) {
            self.put("for");
            self.name();
            self.put("in");
            self.vector(1);
        }
        self.put("{");
        for _ in 0..self.random.below(4) {
            self.name();
            if self.random.one_in(4) {
                self.put("=");
                self.expression(1);
            }
            self.put(":");
            self.expression(1);
            if self.random.one_in(2) {
                self.put("..");
                self.expression(1);
                self.put("by");
                self.expression(0);
            }
            if self.random.one_in(2) {
                self.put(",");
            } else {
                self.text.push('\n');
            }
        }
        self.put("}");
    }

    fn expression(&mut self, depth: usize) {
        if depth > 0 && self.random.one_in(8) {
            self.put("if");
            return self.conditional(depth);
        }
        let mut compared = false;
        self.operand(depth);
        for _ in 0..self.random.of(&[0, 0, 0, 1, 1, 2, 4]) {
            let compares = !compared && self.random.one_in(6);
            compared |= compares;
            let operator = if compares { self.random.of(&COMPARISONS) } else { self.random.of(&OPERATORS) };
            self.put(operator);
            self.operand(depth);
        }
    }

    /// An expression, not often a deep one.
    fn value(&mut self) {
        let depth = self.random.of(&[0, 1, 1, 2, 2, 3]);
        self.expression(depth);
    }

    fn conditional(&mut self, depth: usize) {
        self.expression(depth.saturating_sub(1));
        self.put("then");
        self.expression(depth.saturating_sub(1));
        self.put("else");
        self.expression(depth);
    }

    fn operand(&mut self, depth: usize) {
        while self.random.one_in(6) {
            let prefix = self.random.of(&["-", "-", "not"]);
            self.put(prefix);
        }
        match self.random.below(if depth == 0 { 4 } else { 9 }) {
            0 | 1 => {
                let number = self.random.of(&NUMBERS);
                self.put(number);
            }
            2 => self.put("m.work.x"),
            3 => self.name(),
            4 | 5 => {
                self.put("(");
                self.expression(depth - 1);
                self.put(")");
            }
            6 => self.vector(depth - 1),
            _ => self.call(depth - 1),
        }
        if depth > 0 && self.random.one_in(8) && !self.text.ends_with("mm") {
            self.text.push('[');
            self.expression(0);
            self.put("]");
        }
    }

    fn vector(&mut self, depth: usize) {
        self.put("[");
        for _ in 0..self.random.below(5) {
            self.expression(depth);
            self.put(",");
        }
        self.put("]");
    }

    fn call(&mut self, depth: usize) {
        self.name();
        self.text.push('(');
        if self.random.one_in(6) {
            self.name();
            self.put("in");
            self.range();
            self.put(":");
            self.expression(depth.saturating_sub(1));
            return self.put(")");
        }
        let count = self.random.below(5);
        for index in 0..count {
            if self.random.one_in(3) {
                self.name();
                self.put(":");
            }
            if self.text.ends_with(':') && self.random.one_in(8) {
                self.put("length");
            } else {
                self.expression(depth.saturating_sub(1));
            }
            if index + 1 < count || self.random.one_in(4) {
                self.put(",");
            }
        }
        self.put(")");
    }
}
