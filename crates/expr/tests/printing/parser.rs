//! A reader of printed expressions by precedence climbing, which gives their value.

use std::collections::HashMap;

/// The value of an expression in which some names stand for numbers.
pub(crate) fn value(text: &str, names: &HashMap<&str, f64>) -> f64 {
    let mut parser = Parser { tokens: tokens(text), next: 0, names };
    let value = parser.sum();
    assert_eq!(parser.next, parser.tokens.len(), "left over: {text}");
    value
}

/// Names, numbers (with exponents), and single characters.
fn tokens(text: &str) -> Vec<&str> {
    let mut tokens = Vec::new();
    let mut left = text.trim_start();
    while let Some(first) = left.chars().next() {
        let belongs = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
        let mut end = left.find(|c| !belongs(c)).unwrap_or(left.len());
        let is_number = first.is_ascii_digit();
        // the sign of an exponent belongs to the number
        if is_number && left[..end].ends_with('e') && left[end..].starts_with('-') {
            let digits = left[end + 1..].find(|c: char| !c.is_ascii_digit());
            end = digits.map_or(left.len(), |length| end + 1 + length);
        }
        let (token, rest) = left.split_at(end.max(first.len_utf8()));
        tokens.push(token);
        left = rest.trim_start();
    }
    tokens
}

struct Parser<'t> {
    tokens: Vec<&'t str>,
    next: usize,
    names: &'t HashMap<&'t str, f64>,
}

impl<'t> Parser<'t> {
    fn accept(&mut self, token: &str) -> bool {
        let is_next = self.tokens.get(self.next) == Some(&token);
        self.next += usize::from(is_next);
        is_next
    }

    fn sum(&mut self) -> f64 {
        let mut value = self.product();
        loop {
            if self.accept("+") {
                value += self.product();
            } else if self.accept("-") {
                value -= self.product();
            } else {
                return value;
            }
        }
    }

    fn product(&mut self) -> f64 {
        let mut value = self.signed();
        loop {
            if self.accept("*") {
                value *= self.power();
            } else if self.accept("/") {
                value /= self.power();
            } else {
                return value;
            }
        }
    }

    /// A minus binds looser than a power, and stands only in front of a term.
    fn signed(&mut self) -> f64 {
        if self.accept("-") { -self.power() } else { self.power() }
    }

    fn power(&mut self) -> f64 {
        let base = self.atom();
        if self.accept("^") { base.powf(self.power()) } else { base }
    }

    fn atom(&mut self) -> f64 {
        if self.accept("(") {
            let value = self.sum();
            assert!(self.accept(")"), "`)` expected");
            return value;
        }
        let token = self.tokens[self.next];
        self.next += 1;
        if let Ok(number) = token.parse() {
            return number;
        }
        if self.accept("(") {
            return self.call(token);
        }
        if token == "pi" { std::f64::consts::PI } else { self.names[token] }
    }

    fn call(&mut self, function: &str) -> f64 {
        let a = self.sum();
        let b = if self.accept(",") { self.sum() } else { f64::NAN };
        assert!(self.accept(")"), "`)` expected");
        match function {
            "sqrt" => a.sqrt(),
            "sin" => a.sin(),
            "cos" => a.cos(),
            "tan" => a.tan(),
            "asin" => a.asin(),
            "acos" => a.acos(),
            "atan" => a.atan(),
            "sinh" => a.sinh(),
            "cosh" => a.cosh(),
            "tanh" => a.tanh(),
            "asinh" => a.asinh(),
            "acosh" => a.acosh(),
            "atanh" => a.atanh(),
            "arcinv" => flank_expr::Unary::Arcinv.apply(a),
            "exp" => a.exp(),
            "ln" => a.ln(),
            "abs" => a.abs(),
            "sign" => a.signum(),
            "atan2" => a.atan2(b),
            "min" => a.min(b),
            "max" => a.max(b),
            _ => panic!("unknown function `{function}`"),
        }
    }
}
