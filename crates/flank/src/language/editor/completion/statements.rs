//! What a statement or an item begins with.

use flank_chain_dsl::syntax::vocabulary;

use super::{CompletionKind, List};
use crate::language::editor::cursor::Cursor;

/// Blocks to start from: word, what it is, text.
const SNIPPETS: [(&str, &str, &str); 3] = [
    (
        "machine",
        "a machine: axes and frames",
        "machine ${1:name} {\n    axis ${2:C} : ${3|rotary,linear|}\n\n    frame ${4:bed}\n    frame ${5:work} in ${4:bed} = rotate_z(${2:C})\n    $0\n}\n",
    ),
    (
        "tool",
        "a tool: parameters and surfaces",
        "tool ${1:name} {\n    param ${2:radius} : length = ${3:5 mm}\n\n    surface ${4:face}(${5:u}: angle in ${6:-80 deg} .. ${7:80 deg}, ${8:v}: length in ${9:0 mm} .. ${10:10 mm}) {\n        at = [${11:x}, ${12:y}, ${13:z}]\n        body ${14|inside,outside|}\n    }\n    $0\n}\n",
    ),
    (
        "job",
        "a job: machine, tool, motion, surface, sample",
        "job ${1:name} {\n    machine m = ${2:machine}\n    tool c = ${3:tool}\n    mount c on m.${4:frame}\n\n    motion ${5:roll} : angle in ${6:-20 deg} .. ${7:20 deg}\n    drive m.${8:axis} = ${5:roll}\n\n    surface ${9:flank} in m.${10:work} = envelope(c.${11:surface}, over: ${5:roll})\n    sample ${9:flank} { ${12:z: 0 mm .. 10 mm by 5, rho: 40 mm .. 50 mm by 5} }\n    $0\n}\n",
    ),
];

/// Words that begin a statement of the block around a place; false where the grammar tells them.
pub(super) fn statements(cursor: &Cursor<'_>, list: &mut List<'_>) -> bool {
    let words = vocabulary();
    let (own, what): (&[&str], &str) = match cursor.block() {
        "" => (words.items, "item"),
        "machine" => (words.in_machine, "statement of a machine"),
        "tool" => (words.in_tool, "statement of a tool"),
        "job" => (words.in_job, "statement of a job"),
        "surface" => (words.in_surface, "statement of a surface"),
        _ => return false,
    };
    for word in own {
        list.add_text(word, CompletionKind::Keyword, what, format!("{word} "), 1);
    }
    if cursor.blocks.is_empty() {
        for (word, detail, text) in SNIPPETS {
            list.add_text(word, CompletionKind::Snippet, detail, text.to_string(), 0);
        }
    }
    true
}
