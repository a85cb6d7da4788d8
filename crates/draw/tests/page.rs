//! The page: one file that needs no other, with the numbers that were given.

#[path = "../../export/tests/synthetic/mod.rs"]
mod synthetic;

use flank_draw::{PageFrame, PageMachine, PageMotion, PageParameter, PageSurface, Scene, write_page};
use flank_export::{Dataset, Patch, Unit, WriteError};
use serde_json::Value;
use synthetic::{Gear, dataset, holes, with_fields, without};

/// A scene around patches whose functions are not called here.
fn scene(patches: &[Patch]) -> Scene {
    let surface = |patch: &Patch| PageSurface {
        machine: 0,
        frame_index: 0,
        tool_frame: 0,
        contact: Vec::new(),
        coordinates: ["z", "rho"].map(String::from),
        targets: vec![[0.25, -1.5]; patch.points.len()],
        shares: [patch.rows.count, patch.columns.count].map(|count| vec![0.0; count]),
        corners: "corners".into(),
        ranges: vec![[-1.0, 1.0]; patch.unknowns.len()],
        motions: vec![None; patch.unknowns.len()],
        equations: "equations".into(),
        point: "point".into(),
        conditions: 0,
        curvatures: false,
        trimmed_by: Vec::new(),
    };
    let functions = ["poses", "equations", "point", "corners"];
    Scene {
        motions: vec![PageMotion {
            limits: [-1.0, 1.0],
            name: "roll".into(),
            unit: Unit::Degree,
            low: -0.5,
            high: 0.5,
            start: 0.1,
            is_count: false,
        }],
        parameters: vec![PageParameter {
            name: "m.x".into(),
            unit: "mm".into(),
            value: 3.0,
            range: Some([2.0, 4.0]),
            limits: [0.0, f64::INFINITY],
        }],
        machines: vec![PageMachine {
            name: "m".into(),
            definition: "machine".into(),
            frames: vec![PageFrame { name: "table".into(), parent: None }],
            joints: Vec::new(),
            axes: Vec::new(),
            poses: "poses".into(),
        }],
        surfaces: patches.iter().map(surface).collect(),
        functions: functions.map(|name| format!("export function {name}() {{}}\n")).concat(),
        function_names: functions.map(String::from).to_vec(),
        ..Scene::default()
    }
}

fn page(dataset: &Dataset) -> String {
    let mut bytes = Vec::new();
    write_page(dataset, &scene(&dataset.patches), &mut bytes).expect("a sound dataset");
    String::from_utf8(bytes).expect("text")
}

fn between<'t>(text: &'t str, begin: &str, end: &str) -> &'t str {
    let from = text.find(begin).expect("it begins") + begin.len();
    &text[from..from + text[from..].find(end).expect("it ends")]
}

fn data(page: &str) -> Value {
    serde_json::from_str(between(page, "<script type=\"application/json\" id=\"data\">", "</script>")).expect("JSON")
}

/// Base64 by its definition: each letter is six bits.
fn doubles(text: &Value) -> Vec<f64> {
    let letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let text = text.as_str().expect("a text").trim_end_matches('=');
    let bits: Vec<bool> = text
        .chars()
        .map(|letter| letters.find(letter).expect("a letter of base64"))
        .flat_map(|six| (0..6).rev().map(move |bit| six >> bit & 1 == 1))
        .collect();
    let byte = |bits: &[bool]| bits.iter().fold(0u8, |byte, &bit| byte << 1 | u8::from(bit));
    let bytes: Vec<u8> = bits.chunks_exact(8).map(byte).collect();
    bytes.chunks_exact(8).map(|eight| f64::from_le_bytes(eight.try_into().expect("eight"))).collect()
}

fn same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()))
}

#[test]
fn the_numbers_come_back_to_the_bit() {
    let patch = with_fields(without(Gear { helix: 0.3, width: 20.0 }.flank("flank", [9, 7]), holes));
    let document = data(&page(&dataset("job", vec![patch.clone()])));
    assert_eq!(document.get("schema"), None, "it is for the page itself, no document that has a schema");
    let surface = &document["surfaces"][0];
    let positions: Vec<f64> = patch.points.iter().flat_map(|point| point.position).collect();
    assert!(same(&doubles(&surface["positions"]), &positions));
    let normals: Vec<f64> = patch.points.iter().flat_map(|point| point.normal).collect();
    assert!(same(&doubles(&surface["normals"]), &normals));
    assert!(same(&doubles(&surface["targets"]), &[0.25, -1.5].repeat(63)));
    let words: Vec<&str> = surface["words"].as_array().unwrap().iter().map(|word| word.as_str().unwrap()).collect();
    for (point, status) in patch.points.iter().zip(surface["status"].as_array().unwrap()) {
        assert_eq!(words[status.as_u64().unwrap() as usize], point.outcome.word());
    }
    assert_eq!(surface["fields"].as_array().unwrap().len(), patch.fields.len());
    assert_eq!(document["parameters"][0]["range"], serde_json::json!([2.0, 4.0]));
    assert_eq!(document["parameters"][0]["limits"], serde_json::json!([0.0, null]));
    assert_eq!((document["motions"][0]["unit"].as_str(), surface["rows"]["count"].as_u64()), (Some("deg"), Some(9)));
}

/// Nothing is loaded: the policy forbids it, and no element asks for it.
#[test]
fn it_needs_no_other_file() {
    let page = page(&dataset("job", vec![Gear { helix: 0.0, width: 20.0 }.flank("flank", [3, 3])]));
    assert!(page.contains("default-src 'none'"));
    for wish in [" src=", " href=", "<link", "@import", "url(", "fetch(\"", "import(\"", "new Worker(\"http"] {
        let own: String = page.split("<script>").step_by(2).collect();
        assert!(!own.contains(wish), "{wish}");
    }
    // names of things, not addresses that anything is loaded from: the namespace of XHTML and the library's home page
    let addresses: Vec<&str> = page.match_indices("http").map(|(at, _)| &page[at..at + 12]).collect();
    for address in &addresses {
        assert!(["http://www.w", "https://thre", "http-equiv=\""].contains(address), "{address}");
    }
    assert!(page.contains("The MIT License") && page.contains("three.js authors"));
    assert!(page.len() < 800_000, "{} bytes without data", page.len());
    for left in ["\nimport ", "\nexport "] {
        assert!(!page.contains(left), "the modules are one script");
    }
}

#[test]
fn names_cannot_leave_their_place() {
    let hostile = "</script><script>alert(1)</script><!-- & \u{2028}";
    let mut one = dataset(hostile, vec![Gear { helix: 0.0, width: 20.0 }.flank(hostile, [3, 3])]);
    one.header.spec = hostile.into();
    let page = page(&one);
    assert!(!page.contains("<script>alert"));
    assert_eq!(data(&page)["surfaces"][0]["name"], hostile);
    assert_eq!(page.matches("</script>").count(), 3);
}

#[test]
fn the_same_job_is_the_same_page() {
    let one = dataset("job", vec![Gear { helix: 0.3, width: 20.0 }.flank("flank", [5, 4])]);
    assert_eq!(page(&one), page(&one));
}

#[test]
fn a_malformed_dataset_is_refused() {
    let mut patch = Gear { helix: 0.0, width: 20.0 }.flank("flank", [3, 3]);
    patch.points.pop();
    let broken = dataset("job", vec![patch]);
    let refused = write_page(&broken, &scene(&broken.patches), &mut Vec::new());
    assert!(matches!(refused, Err(WriteError::Malformed(_))), "{refused:?}");
}
