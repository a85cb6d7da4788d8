//! Names that mean something only around a place: arguments, sides, `let`s of a block, what a sum runs over.

use crate::language::editor::cursor::Cursor;

/// Functions whose first argument is a new name.
const RUNNING: [&str; 3] = ["sum", "integral", "root"];

/// All of them that are known at a place, the outermost first.
pub(super) fn locals<'t>(cursor: &Cursor<'t>) -> Vec<&'t str> {
    let mut found = Vec::new();
    let heads = cursor.blocks.iter().filter(|block| ["fn", "surface", "sample"].contains(&block.word));
    let mut from = cursor.first;
    for block in heads {
        from = from.min(block.first);
        let head = cursor.before[block.first..].iter().take_while(|said| **said != "{").count();
        found.extend(of_head(&cursor.before[block.first..block.first + head], block.word));
    }
    if cursor.opening() == "fn" {
        found.extend(of_head(&cursor.before[cursor.first..], "fn"));
    }
    found.extend(lets(&cursor.before[from..cursor.first]));
    found.extend(running(&cursor.before[cursor.first..]));
    found
}

/// `(u: …, v: …)` of a function or a surface, `for side in`.
fn of_head<'t>(head: &[&'t str], word: &str) -> Vec<&'t str> {
    let (mut depth, mut found) = (0, Vec::new());
    for (at, said) in head.iter().enumerate() {
        let next = head.get(at + 1).copied();
        match *said {
            "(" | "[" => depth += 1,
            ")" | "]" if depth == 1 && word == "fn" => break,
            ")" | "]" => depth -= 1,
            "for" if depth == 0 => found.extend(next),
            name if depth == 1 && next == Some(":") && word != "sample" => found.push(name),
            _ => {}
        }
    }
    found
}

fn lets<'t>(words: &[&'t str]) -> impl Iterator<Item = &'t str> {
    words.windows(3).filter(|three| three[0] == "let" && three[2] == "=").map(|three| three[1])
}

/// What the sums that are open run over.
fn running<'t>(statement: &[&'t str]) -> Vec<&'t str> {
    let mut open: Vec<Option<&str>> = Vec::new();
    for (at, said) in statement.iter().enumerate() {
        match *said {
            "(" | "[" => {
                let is_running = at > 0 && RUNNING.contains(&statement[at - 1]) && statement.get(at + 2) == Some(&"in");
                open.push(statement.get(at + 1).copied().filter(|_| is_running));
            }
            ")" | "]" => drop(open.pop()),
            _ => {}
        }
    }
    open.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(marked: &str) -> Vec<&'static str> {
        let text: &'static str = Box::leak(marked.replace('|', "").into_boxed_str());
        locals(&Cursor::at(text, marked.find('|').expect("a mark")))
    }

    #[test]
    fn what_a_block_takes_and_names_is_known_in_it() {
        assert_eq!(at("fn f(a: length[3], b: angle) -> length = sqrt(|"), ["a", "b"]);
        assert_eq!(at("fn f(a: length) {\n let c = a\n let d = |\n}"), ["a", "c"]);
        let surface = "tool t {\n let o = 1\n surface p, q(u: angle in 0 deg .. f(1), s: along e) for side in [1, 2] {\n let w = 1\n at = [|";
        assert_eq!(at(surface), ["u", "s", "side", "w"]);
        assert_eq!(at("job j {\n sample a, b for side in [1, -1] { z: side * |"), ["side"]);
    }

    #[test]
    fn what_a_sum_runs_over_is_known_within_it() {
        assert_eq!(at("fn f() = sum(k in 1 .. 3: |"), ["k"]);
        assert_eq!(at("fn f() = sum(k in 1 .. 3: k) + |"), [""; 0]);
        assert_eq!(at("fn f() = integral(t in 0 .. 1: root(x in 0 .. t: |"), ["t", "x"]);
    }
}
