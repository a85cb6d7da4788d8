//! How the numbers are worked out leaves no trace in them.

mod support;

use support::{flank, folder, text};

/// Surfaces of four unknowns with a trim, limits, single edges, a deviation: whatever a command writes.
#[test]
fn without_machine_code_the_bytes_are_the_same() {
    let runs = [
        &["solve", "specs/bevel/pinion_19x62.chain", "--limits"][..],
        &["solve", "specs/hobbing/real_hob.chain", "--set", "points=9", "--no-picture"],
        &["deviation", "specs/bevel/ease_off_19x62.chain", "pinion.concave", "--reference", "conjugate.concave"],
        &["plot", "specs/bevel/pinion_19x62.chain", "--what", "curvature,section,contact-lines"],
        &[
            "plot",
            "specs/bevel/ease_off_19x62.chain",
            "--surface",
            "pinion.concave",
            "--reference",
            "conjugate.concave",
        ],
        &["report", "specs/hobbing/spur_gear.chain", "--format", "md"],
        &["view", "specs/hobbing/spur_gear.chain"],
        &["convert", "specs/bevel/pinion_19x62.chain", "--to", "specs/machines/free_form.chain", "--positions", "11"],
    ];
    for (k, run) in runs.into_iter().enumerate() {
        let [with, without] = [&[][..], &["--no-jit"]].map(|further| {
            let out = folder(&format!("means-{k}-{}", further.len()));
            let done = flank(&[run, &["--out", out.to_str().unwrap()], further].concat());
            assert_eq!(done.status.code(), Some(0), "{run:?}: {}", text(&done.stderr));
            let files = std::fs::read_dir(&out).unwrap().map(|file| file.unwrap().path());
            let mut files: Vec<_> =
                files.map(|path| (path.file_name().unwrap().to_owned(), std::fs::read(path).unwrap())).collect();
            files.sort();
            files
        });
        assert!(!with.is_empty());
        assert!(with == without, "{run:?}");
    }
}
