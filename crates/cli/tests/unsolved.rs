//! `flank solve`: points that are not there, by a profile that ends and by a `keep` that takes nothing.

mod support;

use support::{flank, folder, text, top, written};

/// A spline ends where its points do: beyond its ends nothing is found, and not something that lies out of range.
#[test]
fn a_profile_that_ends_with_a_spline_is_told() {
    let out = folder("profile_end");
    let wheel = std::fs::read_to_string(top().join("specs/grinding/dressed_wheel.chain")).expect("it is shipped");
    let narrow = "rho: 31 mm .. 37 mm by 9";
    assert!(wheel.contains(narrow));
    let mut spec = wheel.replace(narrow, "rho: 28 mm .. 40 mm by 9");
    for (folder, file) in [("machines", "thread_grinder"), ("tools", "form_wheel"), ("grinding", "thread_wheel")] {
        let text = std::fs::read_to_string(top().join(format!("specs/{folder}/{file}.chain"))).expect("it is shipped");
        written(&out, &format!("{file}.chain"), &text.replace("\"../machines/", "\"").replace("\"../tools/", "\""));
        spec = spec.replace(&format!("\"../{folder}/{file}.chain\""), &format!("\"{file}.chain\""));
    }
    for table in ["thread_wheel_zi.csv", "thread_wheel_zn.csv"] {
        let rows = std::fs::read_to_string(top().join("specs/grinding").join(table)).expect("it is shipped");
        written(&out, table, &rows);
    }
    let spec = written(&out, "wheel.chain", &spec);
    let why = "the profile that s runs along ends with the spline flank, at 0.0000 mm and ";
    let run = flank(&["solve", &spec, "--no-picture", "--out", out.to_str().expect("a plain path")]);
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stdout));
    assert!(text(&run.stderr).contains(why), "{}", text(&run.stderr));
    let told = text(&flank(&["test", &spec]).stdout);
    assert!(told.contains(why), "{told}");
}

/// Two conditions that no value meets are told, and not all branches that they leave out.
#[test]
fn conditions_of_a_keep_that_exclude_each_other_are_told() {
    let out = folder("keep_nothing");
    let first = "sample flank_plus  { rho: low .. high by 9, z: -10 mm .. 10 mm by 5 }";
    let spec = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped");
    let kept = first.replace(" }", "\n keep roll: 0 deg .. 10 deg\n keep rolled = roll: 20 deg .. 30 deg }");
    let spec = written(&out, "kept.chain", &spec.replacen(first, &kept, 1));
    let run = flank(&["solve", &spec, "--job", "first_gear", "--no-picture", "--out", out.to_str().unwrap()]);
    let told = text(&run.stderr);
    let why =
        "`keep` takes nothing: roll 0.0000 .. 10.0000 deg and rolled 20.0000 .. 30.0000 deg are about the same value";
    assert!(told.contains(why), "{told}");
    assert!(!told.contains("leaves out"), "{told}");
}
