//! Why axes do not bring the spindle to its direction: the pole, a machine of the other hand, a lean that is no number.

use super::mill;
use super::support::{folder, written};
use super::tip::job;

fn leaning(lead: &str, tilt: &str) -> String {
    job(&format!(
        "top with ball.cutting in mill.work {{\n passes v: -1 mm .. 1 mm by 3\n along u: -15 mm .. 15 mm by 5\n lead {lead}\n tilt {tilt}"
    ))
}

#[test]
fn what_keeps_the_spindle_from_its_direction_is_named() {
    let out = folder("mill_reached");
    let mirrored = |frame: &str| {
        let machine = format!("machine mirrored extends five_axis_table_table {{\n {frame} mirror_x()\n}}\n");
        leaning("20 deg * u / 15 mm", "8 deg").replace("= five_axis_table_table(", "= mirrored(") + &machine
    };
    let of_other_hand: &[&str] = &["cannot bring the spindle", "it is of the other hand", "`mirror` one of the frames"];
    let cases: [(String, &[&str]); 4] = [
        (
            leaning("20 deg * u / 15 mm", "0 deg"),
            &["holds the spindle at its pole at v", "C is free there", "lean the cutter away"],
        ),
        (mirrored("frame cutter in tip = rotate_x(180 deg)"), of_other_hand),
        (mirrored("frame work in table = translate(work_x, work_y, work_z)"), of_other_hand),
        (leaning("10 deg * sqrt(u / 1 mm)", "8 deg"), &["`lead` of part is no number at v -1.0000 mm, u -15.0000 mm"]),
    ];
    for (spec, parts) in cases {
        let (code, _, told) = mill(&written(&out, "milled.chain", &spec), &out, &[]);
        assert_eq!(code, 3, "{told}");
        for part in parts {
            assert!(told.contains(part), "{part} in {told}");
        }
        assert!(!told.contains("NaN") && !told.contains("from where a rotary axis is free"), "{told}");
    }
}

/// A rotary axis along the spindle leans no cutter; where two others do, it is held still.
#[test]
fn an_axis_along_the_spindle_is_told() {
    let out = folder("mill_along_spindle");
    let machine = |axes: &str, tip: &str, work: &str| {
        let rotary: String = axes.split(", ").map(|axis| format!(" axis {axis} : rotary\n")).collect();
        let machine = format!(
            "machine other {{\n axis X : linear\n axis Y : linear\n axis Z : linear\n{rotary} frame bed\n frame tip in bed = translate(X, Y, Z) {tip}\n \
             frame cutter in tip = rotate_x(180 deg)\n frame work in bed = {work}\n}}\n"
        );
        leaning("5 deg", "75 deg").replace("= five_axis_table_table(work_z: 60 mm)", "= other") + &machine
    };
    let cases: [(String, &[&str]); 5] = [
        (
            machine("C", "", "rotate_z(C)"),
            &["C is parallel to the spindle", "no other rotary axis does, and two are needed", "take a machine"],
        ),
        (
            machine("A, C", "rotate_z(C)", "rotate_x(A)"),
            &["C is parallel to the spindle", "1 other rotary axis does, and two are needed", "take a machine"],
        ),
        (
            machine("A, B, C", "rotate_z(C)", "rotate_x(A) rotate_z(B) translate_z(60 mm)"),
            &["C is parallel to the spindle", "2 other rotary axes do, and two are needed", "`fix C = 0 deg`"],
        ),
        (
            machine("A", "", "rotate_x(A)"),
            &["that lean the spindle against the work are 1, those that shift it 3; it takes two and three"],
        ),
        (
            machine("A, B", "rotate_x(B)", "rotate_x(A)"),
            &["two of its rotary axes that follow each other are parallel"],
        ),
    ];
    for (spec, parts) in cases {
        let (code, _, told) = mill(&written(&out, "milled.chain", &spec), &out, &["--nc", "siemens"]);
        assert_eq!(code, 3, "{told}");
        for part in parts {
            assert!(told.contains(part), "{part} in {told}");
        }
    }
    let spec = machine("A, B, C", "rotate_z(C)", "rotate_x(A) rotate_z(B) translate_z(60 mm)");
    let still = spec.replace("= other", "= still") + "machine still extends other {\n fix C = 0 deg\n}\n";
    let (code, _, told) = mill(&written(&out, "milled.chain", &still), &out, &["--nc", "siemens"]);
    assert_eq!(code, 0, "{told}");
}
