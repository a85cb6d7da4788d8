//! `flank mesh`: files, documents, exit codes.

mod support;

use std::path::Path;

use serde_json::Value;
use support::{flank, folder, text};

const PINION: &str = "specs/bevel/pinion_19x62.chain";
const SPUR_PAIR: &str = "specs/pairs/spur_pair.chain";

fn run(arguments: &[&str], out: &Path, code: i32) -> std::process::Output {
    let all = [&["mesh"], arguments, &["--out", out.to_str().expect("a plain path")]].concat();
    let run = flank(&all);
    assert_eq!(run.status.code(), Some(code), "{arguments:?}: {}", text(&run.stderr));
    run
}

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().to_string())
        .collect();
    names.sort();
    names
}

#[test]
fn a_tooth_is_written_with_its_sets_the_same_each_time() {
    let out = folder("mesh_tooth");
    let small = ["--elements", "4,4,4", "--format", "inp,vtu", "--order", "2"];
    let told = text(&run(&[&[PINION], &small[..]].concat(), &out, 0).stdout);
    assert!(told.contains("solid pinion (m.work): 1 of 19 teeth") && told.contains("C3D20R"), "{told}");
    assert_eq!(files(&out), ["pinion_19x62.inp", "pinion_19x62.vtu"]);
    let read = |name: &str| std::fs::read(out.join(name)).expect("written");
    let [inp, vtu] = ["pinion_19x62.inp", "pinion_19x62.vtu"].map(read);
    let head = text(&inp);
    for part in [
        "** units mm, N, MPa, t\n",
        "** faces on generated surfaces lie within ",
        "*NSET, NSET=FLANK_CONCAVE\n",
        "*SURFACE, NAME=FLANK_CONVEX, TYPE=ELEMENT\n",
        "*SURFACE, NAME=FILLET_CONCAVE_FILLET, TYPE=ELEMENT\n",
        "*SURFACE, NAME=ROOT_ROOT, TYPE=ELEMENT\n",
        "*NSET, NSET=BORE\n",
        "*NSET, NSET=SIDE_1\n",
        "*SOLID SECTION, ELSET=BODY_PINION, MATERIAL=STEEL\n",
    ] {
        assert!(head.contains(part), "{part}");
    }
    for threads in ["1", "3"] {
        run(&[&[PINION, "--threads", threads], &small[..]].concat(), &out, 0);
        assert!(
            [read("pinion_19x62.inp"), read("pinion_19x62.vtu")] == [inp.clone(), vtu.clone()],
            "{threads} threads"
        );
    }
}

/// Both files hold the same nodes and bricks.
#[test]
fn paraview_gets_the_same_bricks() {
    let out = folder("mesh_vtu");
    run(&[SPUR_PAIR, "--teeth", "3", "--elements", "2,1,3", "--format", "inp,vtu"], &out, 0);
    assert_eq!(
        files(&out),
        ["spur_pair.gear.inp", "spur_pair.gear.vtu", "spur_pair.pinion.inp", "spur_pair.pinion.vtu"]
    );
    let bytes = std::fs::read(out.join("spur_pair.pinion.vtu")).expect("written");
    let inp = std::fs::read_to_string(out.join("spur_pair.pinion.inp")).expect("written");
    let marker = b"<AppendedData encoding=\"raw\">\n_";
    let start = bytes.windows(marker.len()).position(|part| part == marker).expect("appended data") + marker.len();
    let head = text(&bytes[..start]);
    let closed = format!("{head}</AppendedData></VTKFile>");
    let document = roxmltree::Document::parse(&closed).expect("XML");
    let array = |name: &str| {
        let node = document.descendants().find(|node| node.attribute("Name") == Some(name)).expect("declared");
        let offset: usize = node.attribute("offset").expect("appended").parse().expect("a number");
        let at = start + offset;
        let size = u64::from_le_bytes(bytes[at..at + 8].try_into().expect("eight")) as usize;
        &bytes[at + 8..at + 8 + size]
    };
    let lines = |keyword: &'static str| {
        inp.lines().skip_while(move |line| !line.starts_with(keyword)).skip(1).take_while(|line| !line.starts_with('*'))
    };
    let nodes: Vec<f64> = lines("*NODE")
        .flat_map(|line| line.split(',').skip(1).map(|x| x.parse::<f64>().expect("a number")).collect::<Vec<f64>>())
        .collect();
    let points: Vec<f64> =
        array("points").chunks(8).map(|of| f64::from_le_bytes(of.try_into().expect("eight"))).collect();
    assert_eq!(nodes.len(), points.len());
    assert!(nodes.iter().zip(&points).all(|(a, b)| (a - b).abs() < 1e-12));
    let corners: Vec<i64> = lines("*ELEMENT, TYPE=C3D8, ELSET=TOOTH_1")
        .flat_map(|line| line.split(',').skip(1).map(|x| x.parse::<i64>().expect("a number") - 1).collect::<Vec<i64>>())
        .collect();
    let cells: Vec<i64> =
        array("connectivity").chunks(8).map(|of| i64::from_le_bytes(of.try_into().expect("eight"))).collect();
    assert!(cells.len() == 3 * corners.len() && cells.starts_with(&corners));
    let bricks = cells.len() / 8;
    assert_eq!((array("types").to_vec(), array("tooth").len()), (vec![12; bricks], 4 * bricks));
    let tip = lines("*NSET, NSET=TIP").map(|line| line.matches(',').count()).sum::<usize>();
    assert_eq!(array("TIP").iter().filter(|on| **on == 1).count(), tip);
    let (last, behind) = (array("types").as_ptr_range().end, b"\n</AppendedData>\n</VTKFile>\n");
    assert!(bytes.ends_with(behind) && last == bytes[..bytes.len() - behind.len()].as_ptr_range().end);
}

#[test]
fn documents_have_the_numbers() {
    let out = folder("mesh_json");
    let run = run(&[SPUR_PAIR, "--teeth", "all", "--elements", "2,1,3", "--json"], &out, 0);
    let document: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert_eq!(document["schema"], "flank.mesh/1");
    let pinion = &document["solids"][0];
    assert_eq!([&pinion["teeth"], &pinion["meshed_teeth"]], [24, 24]);
    let sets = pinion["sets"].as_array().expect("a list");
    assert!(
        sets.iter().any(|set| set["name"] == "FLANK_PINION_FLANK_T24")
            && sets.iter().all(|set| set["name"] != "SIDE_1")
    );
    assert!(pinion["least_scaled_jacobian"].as_f64().expect("a number") >= 0.2, "{pinion}");
}

/// What a run does not make anew is named where it lies there from an earlier one; a format that is named twice is one file.
#[test]
fn files_of_earlier_runs_are_told_and_those_of_this_one_once() {
    let out = folder("mesh_older");
    let spec = "specs/bodies/spur_gear_body.chain";
    let to = out.to_str().expect("a plain path");
    let told = text(&run(&[spec, "--teeth", "2", "--elements", "2,1,3", "--format", "inp,inp"], &out, 0).stdout);
    assert_eq!(told.matches("spur_gear_body.inp").count(), 1, "{told}");
    assert!(told.contains("; _T2 on the other tooth\n"), "{told}");
    let told = text(&run(&[spec, "--set", "teeth=4", "--elements", "2,1,3"], &out, 3).stderr);
    assert!(told.contains("spur_gear_body.inp` is there from an earlier run"), "{told}");
    for (wrong, reason) in [
        (["--ball", "-1mm"], "a length above zero is needed"),
        (["--deviation", "-1um"], "a length above zero is needed"),
        (["--density", "-1 kg/m3"], "write a density above zero in kg/m3 or g/cm3"),
    ] {
        let run = flank(&[&["solve", spec, "--solid", "gear", "--out", to], &wrong[..]].concat());
        assert_eq!(run.status.code(), Some(2));
        assert!(text(&run.stderr).contains(reason), "{}", text(&run.stderr));
    }
}

#[test]
fn what_cannot_be_meshed_is_told_with_its_code() {
    let out = folder("mesh_refused");
    for wrong in ["8", "8,12,2", "0,1,3"] {
        let told = text(&run(&[PINION, "--elements", wrong], &out, 2).stderr);
        assert!(told.contains("write three whole numbers, for example 8,12,6"), "{told}");
    }
    run(&[PINION, "--teeth", "0"], &out, 2);
    let told = text(&run(&["specs/hobbing/ellipse.chain"], &out, 1).stderr);
    assert!(!told.is_empty());
    let told = text(&run(&[PINION, "--teeth", "20"], &out, 3).stderr);
    assert!(told.contains("`pinion` has 19 teeth: there are no 20 of them"), "{told}");
    let large = run(&[PINION, "--teeth", "all", "--elements", "60,200,60", "--json"], &out, 4);
    let told = text(&large.stderr);
    assert!(
        told.contains(" bricks of 8 nodes: that would take about ") && told.contains("--elements or --teeth"),
        "{told}"
    );
    let document: Value = serde_json::from_slice(&large.stdout).expect("JSON");
    assert_eq!(document["exit_code"], 4);
    assert!(files(&out).is_empty(), "no file of what was refused: {:?}", files(&out));
}
