//! Texts that were parsed lately: a tree follows from its text alone, and the same texts come again and again, of a job that is loaded and
//! then solved, of a library that many specs use, of the files beside the one that is typed in.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use crate::diagnostics::Diagnostic;
use crate::diagnostics::source::FileId;
use crate::syntax::ast::File;
use crate::syntax::parse;

/// Bytes of all texts that are kept: several times what any shipped spec is made of. Trees take some twenty-five times as much.
const MOST_BYTES: usize = 1 << 18;

/// The tree of a text, and what is wrong in it.
pub(super) type Parsed = (Arc<File>, Vec<Diagnostic>);

static KEPT: Mutex<Kept> = Mutex::new(Kept { texts: VecDeque::new(), bytes: 0 });

/// What was asked for last comes last.
struct Kept {
    texts: VecDeque<(FileId, Arc<str>, Parsed)>,
    bytes: usize,
}

impl Kept {
    fn find(&mut self, text: &str, id: FileId) -> Option<Parsed> {
        let place = self.texts.iter().rposition(|(known, of, _)| *known == id && **of == *text)?;
        let found = self.texts.remove(place)?;
        let parsed = found.2.clone();
        self.texts.push_back(found);
        Some(parsed)
    }

    fn keep(&mut self, text: &str, id: FileId, parsed: Parsed) {
        self.bytes += text.len();
        self.texts.push_back((id, text.into(), parsed));
        while self.bytes > MOST_BYTES
            && let Some((_, oldest, _)) = self.texts.pop_front()
        {
            self.bytes -= oldest.len();
        }
    }
}

/// Parses a text, unless that was done lately for a file of the same number.
pub(super) fn parsed(text: &str, id: FileId) -> Parsed {
    // whoever panics while others wait has changed nothing by halves
    let kept = || KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = kept().find(text, id) {
        return known;
    }
    let (file, diagnostics) = parse(text, id);
    let parsed = (Arc::new(file), diagnostics);
    kept().keep(text, id, parsed.clone());
    parsed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_texts_are_forgotten_when_there_are_too_many() {
        let mut kept = Kept { texts: VecDeque::new(), bytes: 0 };
        let texts: Vec<String> = (0..5).map(|k| format!("{k}").repeat(MOST_BYTES / 4)).collect();
        let tree = || parse("fn f(x: number) -> number = x\n", FileId(0));
        for text in &texts {
            let (file, diagnostics) = tree();
            kept.keep(text, FileId(0), (Arc::new(file), diagnostics));
        }
        let found: Vec<bool> = texts.iter().map(|text| kept.find(text, FileId(0)).is_some()).collect();
        assert_eq!(found, [false, true, true, true, true]);
        kept.find(&texts[1], FileId(0));
        kept.keep(&texts[0], FileId(0), parsed("", FileId(0)));
        assert!(kept.find(&texts[1], FileId(0)).is_some(), "what is asked for stays");
        assert!(kept.find(&texts[4], FileId(1)).is_none(), "places are those of another file");
        assert!(kept.bytes <= MOST_BYTES);
    }

    #[test]
    fn a_text_that_comes_again_has_the_same_tree() {
        let text = "fn twice(x: number) -> number = 2 * x\n";
        let [first, second] = [0, 1].map(|_| parsed(text, FileId(7)).0);
        assert!(Arc::ptr_eq(&first, &second));
    }
}
