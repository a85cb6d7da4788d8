//! What `flank contact` says of bevel pairs that are designed from their blanks.

mod support;

use serde_json::Value;
use support::{flank, folder, text};

const BLANKS: &str = "tests/surfaces/specs/pairs_from_blanks.chain";

fn number(of: &Value) -> f64 {
    of.as_f64().unwrap_or_else(|| panic!("a number, not {of}"))
}

/// Drive and coast side of each pair: the middle is the mean point, the error extreme there, no edge carries, neither flank reaches into
/// the other, and the pattern lies in the middle of the tooth.
#[test]
fn pairs_from_blanks_bear_in_the_middle_of_the_tooth() {
    let out = folder("contact_of_blanks");
    let out = out.to_str().expect("a plain path");
    let run = flank(&["contact", BLANKS, "--no-picture", "--positions", "40", "--out", out, "--json"]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let documents = serde_json::Deserializer::from_slice(&run.stdout).into_iter();
    let found: Vec<Value> = documents.map(|document| document.expect("JSON")).collect();
    assert_eq!(found.len(), 26);
    for contact in &found {
        let what = format!("{contact}");
        assert_eq!(contact["kind"], "point", "{what}");
        let middle = &contact["middle"];
        assert_eq!(middle["is_vertex"], true, "{what}");
        for member in 0..2 {
            let lengthwise = number(&middle["on"][member]["shares"][0]);
            assert!((lengthwise - 0.5).abs() < 1e-9, "{what}");
        }
        assert_eq!(contact["edges"], Value::Array(Vec::new()), "{what}");
        for end in contact["ends"].as_array().expect("ends") {
            assert!(end["at"] != "toe" && end["at"] != "heel", "{what}");
        }
        assert!(number(&contact["ratio"]) > 1.2, "{what}");
        for pattern in contact["pattern"].as_array().expect("two flanks") {
            assert!(number(&pattern["least_um"]) >= 0.0, "{what}");
            let [from, to] = [0, 1].map(|k| number(&pattern["columns"][k]));
            // a column of 25 to either side
            assert!(((from + to) / 2.0 - 0.5).abs() < 0.05 && to - from < 0.6, "{what}");
            assert!(pattern["touches"].as_array().expect("sides").iter().all(|side| side != "toe" && side != "heel"));
        }
        assert!(number(&contact["backlash"]["normal"]) > 0.05, "{what}");
        for room in contact["clearances"].as_array().expect("rooms") {
            assert!(number(&room["least_mm"]) > 0.0, "{what}");
        }
    }
}
