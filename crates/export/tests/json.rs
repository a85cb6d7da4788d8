//! JSON: by the schema of its types, and with the numbers that were given.

mod schema;
mod synthetic;

use flank_export::{Dataset, write_json};
use schema::faults_of;
use serde_json::Value;
use synthetic::{Gear, bevel, dataset, gallery, holes, undercut, with_fields, without};

const SCHEMA: &str = "flank.surfaces/3";

fn text_of(dataset: &Dataset) -> String {
    let mut bytes = Vec::new();
    write_json(&dataset.surfaces(), &mut bytes).expect("a sound dataset");
    String::from_utf8(bytes).expect("text")
}

#[test]
fn every_document_keeps_the_schema() {
    for (name, dataset) in gallery() {
        let document: Value = serde_json::from_str(&text_of(&dataset)).expect("JSON");
        assert_eq!(document["schema"], SCHEMA);
        assert_eq!(faults_of(&document, SCHEMA), Vec::<String>::new(), "{name}");
    }
}

#[test]
fn the_check_of_the_schema_can_fail() {
    let patch = Gear { helix: 0.0, width: 20.0 }.flank("flank", [2, 2]);
    let sound: Value = serde_json::from_str(&text_of(&dataset("job", vec![patch]))).unwrap();
    type Spoil = fn(&mut Value);
    let spoilers: [(Spoil, &str); 6] = [
        (|d| d["schema"] = "flank.surfaces/2".into(), "/schema: const"),
        (|d| d["more"] = 1.into(), ": additionalProperties"),
        (|d| d["surfaces"][0]["points"][1]["normal"] = vec![1.0, 0.0].into(), "/surfaces/0/points/1/normal: minItems"),
        (|d| d["surfaces"][0]["unknowns"][0]["unit"] = "rad".into(), "/surfaces/0/unknowns/0/unit: oneOf"),
        (|d| d["asked"] = (-1).into(), "/asked: minimum"),
        (|d| drop(d.as_object_mut().unwrap().remove("spec_hash")), ": required"),
    ];
    for (spoil, fault) in spoilers {
        let mut document = sound.clone();
        spoil(&mut document);
        assert!(
            faults_of(&document, SCHEMA).iter().any(|found| found == fault),
            "{fault} in {:?}",
            faults_of(&document, SCHEMA)
        );
    }
}

#[test]
fn numbers_come_back_and_holes_are_null() {
    let patch = without(undercut(Gear { helix: 0.3, width: 20.0 }.flank("flank", [25, 15]), 20..22), holes);
    let document: Value = serde_json::from_str(&text_of(&dataset("job", vec![patch.clone()]))).unwrap();
    let points = document["surfaces"][0]["points"].as_array().unwrap();
    assert_eq!((document["asked"].as_u64(), document["solved"].as_u64()), (Some(375), Some(313)));
    for (out, point) in points.iter().zip(&patch.points) {
        assert_eq!(out["status"], point.outcome.word());
        if point.is_placed() {
            assert_eq!(out["position"], Value::from(point.position.map(|x| x + 0.0).to_vec()));
            assert_eq!(out["unknowns"][0].as_f64(), Some(point.unknowns[0].to_degrees()));
        } else {
            let all = ["position", "normal", "unknowns"];
            assert!(all.iter().all(|&key| out[key].is_null()));
            assert_eq!(out["residual"].as_f64(), Some(point.residual));
        }
    }
}

#[test]
fn fields_stand_with_their_points() {
    let patch = with_fields(without(bevel([3, 2]), |i, _| (i == 2).then_some("out_of_range")));
    let document: Value = serde_json::from_str(&text_of(&dataset("job", vec![patch]))).unwrap();
    let surface = &document["surfaces"][0];
    assert_eq!(
        surface["fields"],
        serde_json::json!([
            { "name": "k1", "unit": "1/mm", "components": 1, "meaning": "k1 of the tests" },
            { "name": "d1", "unit": "1", "components": 3, "meaning": "d1 of the tests" },
        ])
    );
    let fields = |at: usize| &surface["points"][at]["fields"];
    assert_eq!(fields(0), &serde_json::json!([null, [0.0, 0.0, 0.0]]));
    assert_eq!(fields(3), &serde_json::json!([3.0, [0.0, 0.0, 3.0]]));
    assert!(fields(4).is_null());
}

#[test]
fn a_point_takes_a_line_and_keys_keep_their_order() {
    let text = text_of(&dataset("job", vec![synthetic::plane([2, 1], [-0.0, 1.0, 2.0], 0.5)]));
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[1], "  \"schema\": \"flank.surfaces/3\",");
    let points: Vec<&&str> = lines.iter().filter(|line| line.contains("\"i\"")).collect();
    assert_eq!(points.len(), 2);
    assert!(points[0].contains("\"status\": \"solved\", \"position\": [0.0, 1.25, 2.0]"), "{}", points[0]);
    assert!(text.ends_with("}\n"));
}

/// What the disk says is said in the words of every other format, wherever in the document it says so.
#[test]
fn a_full_disk_is_called_so() {
    struct Full(usize);
    impl std::io::Write for Full {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0 = self.0.checked_sub(bytes.len()).ok_or(std::io::ErrorKind::StorageFull)?;
            Ok(bytes.len())
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let patch = Gear { helix: 0.0, width: 20.0 }.flank("flank", [3, 3]);
    let dataset = dataset("job", vec![patch]);
    let whole = text_of(&dataset).len();
    for room in (0..whole).step_by(97) {
        let refused = write_json(&dataset.surfaces(), &mut Full(room)).expect_err("the disk is full");
        assert_eq!(refused.to_string(), "the disk is full", "{room} bytes of {whole}");
    }
}
