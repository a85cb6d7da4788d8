//! What an XML text costs to read, counted before it is read: a parser compares the attributes of an element with each other, and
//! carries namespaces from element to element.

/// Attributes of one element, declarations of namespaces among them.
pub(super) const ATTRIBUTES: usize = 64;
/// Elements inside each other.
pub(super) const DEPTH: usize = 64;
/// Declarations of namespaces in the whole text.
pub(super) const NAMESPACES: usize = 16;
/// Elements, texts and comments of the whole text.
pub(super) const NODES: u32 = 1_000_000;

/// What is read over as one piece: where it begins and ends.
const PIECES: [[&str; 2]; 5] = [["<!--", "-->"], ["<![CDATA[", "]]>"], ["<?", "?>"], ["<!", ">"], ["</", ">"]];

/// # Errors
/// In words, which limit a text is beyond, and on which line. What is no XML is left to the parser.
pub(super) fn check(text: &str) -> Result<(), String> {
    let (mut depth, mut namespaces) = (0usize, 0);
    let mut at = 0;
    while let Some(next) = text[at..].find('<') {
        at += next;
        let rest = &text[at..];
        let beyond = |what: String| {
            let line = text[..at].matches('\n').count() + 1;
            Err(format!("line {line}: {what}, more than any REXS file needs"))
        };
        if let Some([begin, end]) = PIECES.iter().find(|[begin, _]| rest.starts_with(begin)) {
            depth = depth.saturating_sub(usize::from(*begin == "</"));
            let Some(stop) = rest[begin.len()..].find(end) else { return Ok(()) };
            at += begin.len() + stop + end.len();
            continue;
        }
        let tag = Tag::read(rest);
        namespaces += tag.namespaces;
        depth += usize::from(!tag.is_empty);
        if tag.attributes > ATTRIBUTES {
            return beyond(format!("an element has more than {ATTRIBUTES} attributes"));
        }
        if namespaces > NAMESPACES {
            return beyond(format!("more than {NAMESPACES} namespaces are declared"));
        }
        if depth > DEPTH {
            return beyond(format!("more than {DEPTH} elements stand inside each other"));
        }
        at += tag.length;
    }
    Ok(())
}

/// The tag that begins an element.
struct Tag {
    length: usize,
    attributes: usize,
    namespaces: usize,
    /// Whether the element ends with it.
    is_empty: bool,
}

impl Tag {
    /// The tag at the beginning of a text, as far as it stays within the limit of attributes.
    fn read(text: &str) -> Tag {
        let mut tag = Tag { length: text.len(), attributes: 0, namespaces: 0, is_empty: false };
        let mut quote = None;
        for (at, byte) in text.bytes().enumerate() {
            match (quote, byte) {
                (Some(open), _) if open == byte => quote = None,
                (Some(_), _) => {}
                (None, b'"' | b'\'') => quote = Some(byte),
                (None, b'=') => {
                    let name = text[..at].trim_end().rsplit(char::is_whitespace).next().unwrap_or_default();
                    tag.namespaces += usize::from(name.starts_with("xmlns"));
                    tag.attributes += 1;
                }
                (None, b'>') => {
                    tag.is_empty = text[..at].ends_with('/');
                    tag.length = at + 1;
                }
                (None, _) => {}
            }
            if tag.attributes > ATTRIBUTES || tag.length < text.len() {
                break;
            }
        }
        tag
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_counted_is_what_stands_in_tags() {
        let attributes = |count: usize| (0..count).map(|k| format!(" a{k} = 'x>=\"'")).collect::<String>();
        let deep = |count: usize| "<a>".repeat(count) + &"</a>".repeat(count);
        let beyond = |text: &str| check(text).err().unwrap_or_default();
        for right in [
            &format!("<?xml version='1.0'?>\n<!-- {} -->\n<m{}/>", attributes(99), attributes(ATTRIBUTES)),
            &format!("<m><![CDATA[<a{}>]]></m>", attributes(99)),
            &deep(DEPTH),
            &"<a></a><b/>".repeat(1000),
            "<a",
            "a = b = c > d",
            "<!-- open",
        ] {
            assert_eq!(beyond(right), "", "{right}");
        }
        assert!(
            beyond(&format!("\n<m{}/>", attributes(ATTRIBUTES + 1))).starts_with("line 2: an element has more than 64")
        );
        assert!(beyond(&deep(DEPTH + 1)).contains("more than 64 elements stand inside each other"));
        assert!(beyond(&"<a xmlns:b='c'/>".repeat(NAMESPACES + 1)).contains("more than 16 namespaces are declared"));
    }
}
