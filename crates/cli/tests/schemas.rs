//! Everything that the program prints or writes as JSON keeps the schemas that it ships.

mod support;

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;
use support::{REXS, flank, folder, self_contained, text, written};

/// All shipped schemas, as the program prints them.
fn schemas() -> BTreeMap<String, Value> {
    let list: Value = serde_json::from_slice(&flank(&["schema", "--json"]).stdout).expect("JSON");
    let names =
        list["schemas"].as_array().expect("a list").iter().map(|schema| schema["name"].as_str().expect("a name"));
    let print = |name: &str| serde_json::from_slice(&flank(&["schema", name]).stdout).expect("JSON");
    names.map(|name| (name.to_string(), print(name))).collect()
}

/// Holds documents against their schemas, and says which schemas were met.
struct Judge {
    schemas: BTreeMap<String, jsonschema::Validator>,
    met: BTreeSet<String>,
}

impl Judge {
    fn new() -> Judge {
        let schemas = schemas();
        let compiled =
            schemas.iter().map(|(name, schema)| (name.clone(), jsonschema::validator_for(schema).expect("a schema")));
        Judge { schemas: compiled.collect(), met: BTreeSet::new() }
    }

    fn hold(&mut self, document: &Value, from: &str) {
        let name = document["schema"].as_str().unwrap_or_else(|| panic!("{from}: no schema in {document}"));
        let schema = self.schemas.get(name).unwrap_or_else(|| panic!("{from}: {name} is not shipped"));
        let faults: Vec<String> =
            schema.iter_errors(document).map(|fault| format!("{}: {fault}", fault.instance_path())).collect();
        assert!(faults.is_empty(), "{from}: {name}\n{}", faults.join("\n"));
        self.met.insert(name.to_string());
    }

    /// The documents of a command, which ends as it should.
    fn run(&mut self, arguments: &[&str], code: i32) -> Vec<Value> {
        let run = flank(arguments);
        let from = arguments.join(" ");
        assert_eq!(run.status.code(), Some(code), "{from}: {}", text(&run.stderr));
        let documents: Vec<Value> = serde_json::Deserializer::from_slice(&run.stdout)
            .into_iter()
            .map(|document| document.unwrap_or_else(|error| panic!("{from}: {error}")))
            .collect();
        assert!(!documents.is_empty(), "{from} prints nothing");
        documents.iter().for_each(|document| self.hold(document, &from));
        documents
    }

    fn file(&mut self, path: &std::path::Path) {
        let text = std::fs::read_to_string(path).expect("a file");
        self.hold(&serde_json::from_str(&text).expect("JSON"), &path.display().to_string());
    }

    fn has_met(&self, names: &[&str]) {
        let names: BTreeSet<String> = names.iter().map(|name| name.to_string()).collect();
        assert!(names.is_subset(&self.met), "met are {:?}", self.met);
    }
}

const SPUR: &str = "specs/hobbing/spur_gear.chain";
const PINION: &str = "specs/bevel/pinion_19x62.chain";
const FREE_FORM: &str = "specs/machines/free_form.chain";
const CRADLE: &str = "specs/machines/cradle.chain";
const THESIS: &str = "specs/bevel/thesis_gear.chain";

#[test]
fn solved_surfaces() {
    let mut judge = Judge::new();
    let out = folder("schemas_solve");
    let [at, to] = ["--out", out.to_str().unwrap()];
    let solve =
        |spec: &'static str, more: &[&'static str]| [&["solve", spec, "--json", "--no-picture", at, to], more].concat();
    judge.run(&solve(SPUR, &["--geometry", "--sensitivity", "--certify", "--limits", "--step", "--format", "json"]), 0);
    judge.file(&out.join("spur_gear.json"));
    judge.run(&solve(PINION, &["--geometry", "--sensitivity", "--format", "json"]), 0);
    judge.file(&out.join("pinion_19x62.json"));
    judge.run(&["solve", PINION, "--solid", "tooth", "--json", at, to], 0);
    judge.run(&["mesh", PINION, "--json", at, to], 0);
    judge.run(&solve("specs/hobbing/undercut_gear.chain", &["--limits", "--format", "json"]), 3);
    judge.file(&out.join("undercut_gear.json"));
    assert_eq!(judge.run(&solve("specs/bevel/ease_off_19x62.chain", &[]), 0).len(), 2, "one document for each job");
    let cut = judge.run(&solve("specs/hobbing/real_hob.chain", &["--set", "points=5"]), 0);
    assert!(cut[0]["surfaces"][0]["cut"].is_object());
    // several branches, none of which is kept
    let spec = self_contained(&[
        "machines/hobbing_6axis",
        "tools/involute",
        "tools/hob_zi",
        "functions/hobbing",
        "hobbing/helical_gear",
    ]);
    let unsaid: String = spec.lines().filter(|line| !line.contains("keep ")).map(|line| format!("{line}\n")).collect();
    let unsaid = written(&out, "unsaid.chain", &unsaid);
    let told = judge.run(&["solve", &unsaid, "--json", "--no-picture", at, to], 3);
    let first = &told[0]["not_done"][0];
    assert_eq!(first["kind"], "ambiguous", "{first}");
    assert!(first["message"].as_str().expect("a message").starts_with("ambiguous: "), "{first}");
    assert_eq!(first["place"]["text"], first["of"], "{first}");
    assert!(first["details"].as_array().expect("branches").len() > 2, "{first}");
    judge.has_met(&["flank.solve/3", "flank.solid/2", "flank.mesh/1", "flank.surfaces/3"]);
}

#[test]
fn other_machines() {
    let mut judge = Judge::new();
    let out = folder("schemas_convert");
    let at = ["--json", "--out", out.to_str().unwrap(), "--format", "json", "--positions", "21"];
    judge.run(&[&["convert", PINION, "--to", FREE_FORM, "--time", "20", "--nc", "linuxcnc"][..], &at].concat(), 0);
    judge.file(&out.join("pinion_19x62_on_free_form.json"));
    judge.run(&[&["convert", PINION, "--to", FREE_FORM, "--tolerance", "1e-15um"][..], &at].concat(), 3);
    judge.run(&["convert", THESIS, "--to", CRADLE, "--fit", "work_offset", "--json"], 0);
    judge.run(&["convert", THESIS, "--to", CRADLE, "--fit", "work_ofset", "--json"], 1);
    judge.run(&[&["convert", THESIS, "--to", CRADLE, "--fit", "work_offset"][..], &at].concat(), 2);
    judge.run(&["derive", PINION, "--json"], 0);
    judge.run(&["derive", PINION, "--json", "--latex"], 0);
    judge.run(&["derive", PINION, "--json", "--cost"], 0);
    judge.run(&["derive", PINION, "--json", "--to", FREE_FORM], 0);
    judge.run(&["derive", SPUR, "--json", "--to", FREE_FORM, "--tool-frame", "cutter", "--work-frame", "work"], 3);
    judge.has_met(&["flank.convert/2", "flank.motion/2", "flank.settings/1", "flank.derivation/2", "flank.cost/2"]);
}

#[test]
fn comparisons_and_pictures() {
    let mut judge = Judge::new();
    let out = folder("schemas_plot");
    let at = ["--json", "--out", out.to_str().unwrap()];
    let ease_off =
        ["deviation", "specs/bevel/ease_off_19x62.chain", "pinion.concave", "--reference", "conjugate.concave"];
    judge.run(&[&ease_off[..], &at, &["--no-picture"]].concat(), 0);
    judge.run(&[&ease_off[..], &at, &["--no-picture", "--no-align"]].concat(), 3);
    judge.run(&[&["deviation", PINION, "concave", "--reference", "flank", "--no-picture"][..], &at].concat(), 1);
    let pair = ["contact", "specs/pairs/bevel_19x62.chain", "--no-picture", "--positions", "12"];
    judge.run(&[&pair[..], &["--sensitivity", "--vhj"], &at].concat(), 0);
    judge.run(&[&pair[..], &["--error", "m.X=1mm"], &at].concat(), 1);
    let milled = ["contact", "specs/pairs/milled_pair.chain", "--no-picture", "--positions", "8", "--milled", "finish"];
    judge.run(&[&milled[..], &at].concat(), 0);
    judge.run(&[&["mill", "specs/bevel/milled_pinion.chain", "finish", "--nc", "fanuc"][..], &at].concat(), 0);
    let program = out.join("milled_pinion.finish.nc");
    let verified = ["mill", "specs/bevel/milled_pinion.chain", "finish", "--verify", program.to_str().unwrap()];
    judge.run(&[&verified[..], &at].concat(), 0);
    judge.run(&[&["plot", SPUR, "--what", "surface,machine", "--format", "svg"][..], &at].concat(), 0);
    judge.run(&[&["plot", SPUR, "--what", "left"][..], &at].concat(), 1);
    judge.run(&[&["view", SPUR][..], &at].concat(), 0);
    judge.run(&[&["view", "specs/hobbing/undercut_gear.chain"][..], &at].concat(), 3);
    judge.run(&[&["measure", PINION, "--format", "csv,json", "--lines", "5"][..], &at].concat(), 0);
    judge.file(&out.join("pinion_19x62.grid.json"));
    judge.run(&[&["measure", "specs/hobbing/undercut_gear.chain", "--format", "json"][..], &at].concat(), 3);
    judge.file(&out.join("undercut_gear.grid.json"));
    let measured = out.join("pinion_19x62.grid.csv");
    let back = ["deviation", PINION, "concave", "--no-picture", "--measured", measured.to_str().unwrap()];
    judge.run(&[&back[..], &at].concat(), 0);
    let fit = ["fit", PINION, "concave", "--json", "--measured", measured.to_str().unwrap()];
    judge.run(&[&fit[..], &["--vary", "radial_distance,cradle_angle,blade_angle"]].concat(), 0);
    judge.run(&fit, 0);
    judge.run(&[&fit[..], &["--vary", "nosuch"]].concat(), 1);
    judge.run(
        &["fit", "specs/pairs/bevel_19x62.chain", "--want", "centred", "--json", "--vary", "p.radial_distance"],
        3,
    );
    let tolerance = ["tolerance", PINION, "concave", "--json", "--scatter", "radial_distance=5um,ratio_of_roll=0.01%"];
    judge.run(&[&tolerance[..], &["--sweep", "20"]].concat(), 0);
    judge.run(&[&tolerance[..], &["--budget", "bias=1nm"]].concat(), 2);
    let study = out.join("study").display().to_string();
    let vary = "m.radial_distance=97.9mm..98.1mm by 2";
    let sweep = ["sweep", PINION, "--json", "--vary", vary, "--collect", "at:concave[0,0]", "--out", &study];
    judge.run(&sweep, 0);
    judge.run(&["sweep", "status", &study, "--json"], 0);
    judge.file(&out.join("study/plan.json"));
    judge.run(&[&tolerance[..], &["--budget", "bias=0.001um"]].concat(), 3);
    judge.run(&[&["report", SPUR, "--certify", "--step"][..], &at].concat(), 0);
    judge.run(&[&["report", "specs/hobbing/undercut_gear.chain"][..], &at].concat(), 3);
    // documents within a document: a contact, and what is milled
    judge.run(&[&["report", "specs/pairs/spur_pair.chain"][..], &at].concat(), 0);
    judge.run(&[&["report", "specs/bevel/milled_pinion.chain"][..], &at].concat(), 0);
    judge.run(&[&["report", "specs/hobbing/undercut_gear.chain", "--set", "teeth=x"][..], &at].concat(), 1);
    judge.has_met(&[
        "flank.contact/2",
        "flank.deviation/2",
        "flank.fit/2",
        "flank.tolerance/1",
        "flank.sweep/1",
        "flank.sweep_plan/1",
        "flank.plot/2",
        "flank.view/2",
        "flank.measure/1",
        "flank.grid/1",
        "flank.report/3",
    ]);
}

#[test]
fn texts_and_files() {
    let mut judge = Judge::new();
    let out = folder("schemas_texts");
    let wrong = written(&out, "wrong.chain", "tool t {\n    param r : lenght\n}\n");
    let rough = written(&out, "rough.chain", "machine m{frame bed}\n");
    judge.run(&["check", CRADLE, &wrong, "--json"], 1);
    judge.run(&["fmt", "--check", &rough, &wrong, CRADLE, "--json"], 1);
    judge.run(&["fmt", "-", "--json"], 0);
    judge.run(&["explain", "--json"], 0);
    judge.run(&["explain", "E0301", "--json"], 0);
    judge.run(&["new", "--json"], 0);
    let made = judge.run(&["new", "helical_gear", "--name", "mine", "--json", "--out", out.to_str().unwrap()], 0);
    assert_eq!((&made[0]["name"], &made[0]["spec"]), (&"mine".into(), &made[0]["files"][0]));
    judge.run(&["new", "helical_gear", "--set", "teeth=0", "--json", "--out", out.to_str().unwrap()], 1);
    judge.run(&["schema", "--json"], 0);
    judge.run(&["completions", "bash", "--json"], 0);
    judge.run(&["man", "--json", "--out", out.to_str().unwrap()], 0);
    let rexs = written(&out, "pinion.rexs", REXS);
    let import = ["import", &rexs, "--signs", "left-hand-pinion", "--outside", "21", "--json"];
    let imported = judge.run(&[&import[..], &["--coefficients", "taylor"]].concat(), 0);
    assert!(imported[0]["text"].as_str().expect("a text").contains("job imported {"));
    judge.run(&import, 1);
    judge.run(&["test", "specs/tutorial", "--json"], 0);
    judge.has_met(&["flank.test/1"]);
    judge.has_met(&["flank.check/1", "flank.fmt/1", "flank.explain/1", "flank.new/4", "flank.templates/3"]);
    judge.has_met(&["flank.schemas/1", "flank.completions/1", "flank.man/1", "flank.import/2", "flank.failure/1"]);
}

#[test]
fn failures_of_all_commands() {
    let mut judge = Judge::new();
    let folder = folder("schemas_failures");
    let wrong = written(&folder, "wrong.chain", "tool t {\n    param r : lenght\n}\n");
    for command in [
        &["solve", &wrong][..],
        &["convert", &wrong, "--to", FREE_FORM],
        &["derive", &wrong],
        &["deviation", &wrong, "a", "--reference", "b"],
        &["fit", &wrong, "a", "--measured", "b.csv"],
        &["tolerance", &wrong, "a"],
        &["plot", &wrong],
        &["view", &wrong],
    ] {
        let told = judge.run(&[command, &["--json"]].concat(), 1);
        assert_eq!(told[0]["findings"][0]["place"]["line"], 2, "{command:?}");
        assert_eq!(told[0]["exit_code"], 1);
    }
    // no folder can be made where a file stands
    let blocked = folder.join("wrong.chain/here");
    let at = ["--json", "--out", blocked.to_str().unwrap()];
    for command in
        [&["solve", SPUR][..], &["plot", SPUR, "--what", "machine"], &["view", SPUR], &["man"], &["new", "spur_gear"]]
    {
        let told = judge.run(&[command, &at].concat(), 1);
        assert!(told[0]["message"].as_str().expect("text").contains("cannot make the folder"), "{command:?}: {told:?}");
    }
    for command in [&["solve", CRADLE][..], &["import", "none.rexs", "--signs", "frames", "--outside", "21"]] {
        judge.run(&[command, &["--json"]].concat(), 1);
    }
    for command in
        [&["solve"][..], &["explain", "E301"], &["schema", "none"], &["plot", SPUR, "--what", "nothing"], &["sovle"]]
    {
        let told = judge.run(&[command, &["--json"]].concat(), 2);
        assert!(!told[0]["message"].as_str().expect("text").starts_with("error"), "{told:?}");
    }
}

#[test]
fn schemas_are_sound_and_closed() {
    let mut definitions: BTreeMap<String, Value> = BTreeMap::new();
    let shipped = schemas();
    assert_eq!(shipped.len(), 33, "no document comes or goes unseen");
    for (name, schema) in &shipped {
        assert!(jsonschema::meta::is_valid(schema), "{name} is no schema");
        let (kind, version) =
            name.strip_prefix("flank.").and_then(|name| name.split_once('/')).expect("flank.KIND/VERSION");
        assert_eq!(
            (&schema["title"], &schema["properties"]["schema"]["const"]),
            (&name.as_str().into(), &name.as_str().into())
        );
        assert_eq!(schema["required"][0], "schema", "{name}");
        assert_eq!(schema["$id"], format!("urn:flank:{kind}:{version}"));
        assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
        assert!(schema["description"].as_str().is_some_and(|about| about.ends_with('.')), "{name} says what it is");
        closed(schema, name);
        described(schema, name);
        for (key, shared) in schema["$defs"].as_object().into_iter().flatten() {
            assert_eq!(definitions.entry(key.clone()).or_insert(shared.clone()), shared, "{key} in {name}");
        }
    }
}

/// What several documents tell has one form in all of them.
#[test]
fn one_thing_has_one_form() {
    const FORMS: [(&str, &str); 7] = [
        ("job", "string"),
        ("spec", "string"),
        ("asked", "integer"),
        ("low", "number"),
        ("high", "number"),
        ("travel", "object"),
        ("reference", "number"),
    ];
    for (name, schema) in schemas() {
        properties(&schema, &mut |key, of| {
            if let Some((_, form)) = FORMS.iter().find(|(known, _)| *known == key) {
                // what may be missing is an alternative to null
                let of = of["anyOf"].as_array().map_or(of, |ways| &ways[0]);
                let of = of["$ref"].as_str().map_or(of, |at| schema.pointer(&at[1..]).expect("it is defined"));
                let is_one = of["type"] == *form || of["type"] == serde_json::json!([form, "null"]);
                assert!(is_one, "{name}: {key} is {of}");
            }
        });
    }
}

fn properties(schema: &Value, look: &mut impl FnMut(&str, &Value)) {
    for (key, of) in schema["properties"].as_object().into_iter().flatten() {
        look(key, of);
    }
    match schema {
        Value::Object(entries) => entries.values().for_each(|value| properties(value, look)),
        Value::Array(items) => items.iter().for_each(|item| properties(item, look)),
        _ => {}
    }
}

/// Every member of every object says what it is: with a description, a constant, or the definition that it refers to.
fn described(schema: &Value, place: &str) {
    properties(schema, &mut |key, of| {
        let is_said = ["description", "const", "$ref"].iter().any(|word| of.get(word).is_some());
        assert!(is_said, "{place}: {key} has no description");
    });
}

/// No object takes keys that its schema does not name.
fn closed(schema: &Value, place: &str) {
    if schema.get("properties").is_some() {
        assert_eq!(schema["additionalProperties"], false, "{place}");
    }
    match schema {
        Value::Object(entries) => entries.iter().for_each(|(key, value)| closed(value, &format!("{place}/{key}"))),
        Value::Array(items) => items.iter().for_each(|item| closed(item, place)),
        _ => {}
    }
}
