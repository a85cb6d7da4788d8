//! What the layout changes of a text, in pieces as small as they can be.

/// Lines of a text and of the same text laid out that have the same letters: from and to in each.
type Piece = [usize; 4];

/// The changes from a text to the same text laid out, as bytes and what is written there: of lines of a range, or of all.
pub(super) fn changes(before: &str, after: &str, within: Option<[usize; 2]>) -> Vec<(usize, usize, String)> {
    let (old, new): (Vec<&str>, Vec<&str>) =
        (before.split_inclusive('\n').collect(), after.split_inclusive('\n').collect());
    let starts: Vec<usize> = std::iter::once(0)
        .chain(old.iter().scan(0, |end, line| {
            *end += line.len();
            Some(*end)
        }))
        .collect();
    let is_within =
        |[from, to, ..]: &Piece| within.is_none_or(|[first, last]| *from <= last && (*to).max(from + 1) > first);
    let wanted = changed(&old, &new).into_iter().filter(is_within);
    joined(wanted).into_iter().map(|[from, to, a, b]| (starts[from], starts[to], new[a..b].concat())).collect()
}

/// Pieces that follow each other as one.
fn joined(pieces: impl Iterator<Item = Piece>) -> Vec<Piece> {
    let mut all: Vec<Piece> = Vec::new();
    for piece in pieces {
        match all.last_mut() {
            Some(last) if last[1] == piece[0] && last[3] == piece[2] => (last[1], last[3]) = (piece[1], piece[3]),
            _ => all.push(piece),
        }
    }
    all
}

/// The pieces that differ.
fn changed(old: &[&str], new: &[&str]) -> Vec<Piece> {
    let Some([sizes, new_sizes]) = matched(old, new) else { return vec![[0, old.len(), 0, new.len()]] };
    let (mut a, mut b, mut found) = (0, 0, Vec::new());
    while a < old.len() || b < new.len() {
        let [is_empty, is_new_empty] = [sizes.get(a), new_sizes.get(b)].map(|size| size == Some(&0));
        let (mut x, mut y) = match (is_empty, is_new_empty) {
            (true, false) => (a + 1, b),
            (false, true) => (a, b + 1),
            _ => (old.len().min(a + 1), new.len().min(b + 1)),
        };
        let size = |sizes: &[usize], from: usize, to: usize| sizes[from..to].iter().sum::<usize>();
        let (mut here, mut there) = (size(&sizes, a, x), size(&new_sizes, b, y));
        while here != there {
            if (here < there && x < old.len()) || y == new.len() {
                here += sizes[x];
                x += 1;
            } else {
                there += new_sizes[y];
                y += 1;
            }
        }
        if old[a..x] != new[b..y] {
            found.push([a, x, b, y]);
        }
        (a, b) = (x, y);
    }
    found
}

/// How many letters of each line the other text has, too: all but white space and commas that the layout adds or leaves out. Nothing of texts
/// that differ in more.
fn matched(old: &[&str], new: &[&str]) -> Option<[Vec<usize>; 2]> {
    let [letters, new_letters] = [letters(old), letters(new)];
    let mut sizes = [vec![0; old.len()], vec![0; new.len()]];
    let (mut i, mut j) = (0, 0);
    loop {
        match (letters.get(i), new_letters.get(j)) {
            (None, None) => return Some(sizes),
            (Some((line, letter)), Some((new_line, new_letter))) if letter == new_letter => {
                sizes[0][*line] += 1;
                sizes[1][*new_line] += 1;
                (i, j) = (i + 1, j + 1);
            }
            (Some((_, ',')), _) => i += 1,
            (_, Some((_, ','))) => j += 1,
            _ => return None,
        }
    }
}

/// Letters with their lines.
fn letters(lines: &[&str]) -> Vec<(usize, char)> {
    let numbered = lines.iter().enumerate().flat_map(|(line, text)| text.chars().map(move |letter| (line, letter)));
    numbered.filter(|(_, letter)| !letter.is_whitespace()).collect()
}

#[cfg(test)]
mod tests {
    use super::changes;

    /// A text after changes of a range.
    fn after(before: &str, laid: &str, within: Option<[usize; 2]>) -> String {
        let mut text = before.to_string();
        let all = changes(before, laid, within);
        all.iter().rev().for_each(|(from, to, new)| text.replace_range(*from..*to, new));
        text
    }

    #[test]
    fn only_lines_that_differ_change() {
        let before = "a\nb \nc\n";
        assert_eq!(changes(before, "a\nb\nc\n", None), [(2, 5, "b\n".to_string())]);
        assert!(changes(before, before, None).is_empty());
        assert_eq!(changes("a\n b\n c\nd", "a\nb\nc\nd\n", None), [(2, 9, "b\nc\nd\n".to_string())]);
    }

    #[test]
    fn of_a_range_only_its_statements_change() {
        let before = "m {\n  a\n  b( c,\n    d, )\n\n\n  e\n }";
        let laid = "m {\n    a\n    b(c, d)\n\n    e\n}\n";
        assert_eq!(after(before, laid, None), laid);
        assert_eq!(after(before, laid, Some([1, 1])), "m {\n    a\n  b( c,\n    d, )\n\n\n  e\n }");
        assert_eq!(after(before, laid, Some([3, 3])), "m {\n  a\n    b(c, d)\n\n\n  e\n }");
        assert_eq!(after(before, laid, Some([5, 5])), "m {\n  a\n  b( c,\n    d, )\n\n  e\n }");
        assert_eq!(after(before, laid, Some([7, 7])), "m {\n  a\n  b( c,\n    d, )\n\n\n  e\n}\n");
        let all = (0..8).rev().fold(before.to_string(), |text, line| after(&text, laid, Some([line, line])));
        assert_eq!(all, laid);
    }

    #[test]
    fn a_layout_that_writes_something_else_is_one_change() {
        assert_eq!(changes("a\nb\n", "a\nc\n", Some([0, 0])), [(0, 4, "a\nc\n".to_string())]);
    }
}
