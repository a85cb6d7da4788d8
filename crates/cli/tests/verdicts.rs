//! What `flank solve` says of points that are not on the finished work, and of what it cannot exclude.

mod support;

use std::path::Path;

use support::{flank, folder, self_contained, text, top, written};

/// What is told of a job, and of one of its surfaces as the table has it.
fn solved(folder: &Path, spec: &str, number: usize) -> (String, serde_json::Value) {
    let file = written(folder, "job.chain", spec);
    let run = flank(&["solve", &file, "--json", "--no-picture", "--out", folder.to_str().expect("a plain path")]);
    let table: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    (text(&run.stderr), table["surfaces"][number].clone())
}

/// A finishing rack that stands farther out than the roughing rack cuts only air, whatever its points are asked for by.
#[test]
fn what_lies_deeper_takes_all_of_a_surface_whatever_its_coordinates_are() {
    let folder = folder("deeper");
    let library = self_contained(&["tools/rack", "machines/hobbing_6axis", "machines/rack_generating"]);
    for sample in [
        "rho: r - 1.5 mm .. r + 3 mm by 7, z: -3 mm .. 3 mm by 3",
        "h = rho - r: -1.5 mm .. 3 mm by 7, z: -3 mm .. 3 mm by 3",
        "u: -1 mm .. 1 mm by 7, z: -3 mm .. 3 mm by 3",
        "rho: r - 1 mm .. r + 3 mm by 7, h = z + 1 mm: -2 mm .. 4 mm by 3",
        "polar_angle: 3.6 deg .. 4.4 deg by 7, v: -3 mm .. 3 mm by 3",
    ] {
        let job = "job air {
            let r = 36 mm
            machine rough = rack_generating(reference_radius: r)
            machine fine = rack_generating(reference_radius: r, shift: 0.3 mm)
            tool t = rack(module: 3 mm)
            tool f = rack(module: 3 mm)
            mount t on rough.head
            mount f on fine.head
            motion phi : angle in -60 deg .. 60 deg
            drive rough.C = phi
            drive fine.C = phi
            surface under in rough.table = envelope(t.flank_plus, over: phi)
            surface over in fine.table = envelope(f.flank_plus, over: phi)
            trim over by under
            sample over { SAMPLE }
        }";
        let (told, surface) = solved(&folder, &format!("{library}{}", job.replace("SAMPLE", sample)), 0);
        assert_eq!(surface["outcomes"]["trimmed"], 21, "{sample}: {surface}\n{told}");
    }
}

/// Steel on the wrong side: the tool takes away all that it generates, which is told of every point.
#[test]
fn a_branch_that_is_cut_away_whole_is_told_to_be_so() {
    let folder = folder("inside-out");
    let gear = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped");
    let gear = gear.replacen("body towards [0, -1, 0]", "body towards [0, 1, 0]", 1);
    let first = gear[..gear.find("/// The tool sits").expect("the second machine")].to_string();
    let by_unknowns = "sample flank_plus { u: -2 mm .. 1 mm by 5, v: 0 mm .. 4 mm by 9 }";
    let other = first.lines().map(|line| if line.contains("sample flank_plus") { by_unknowns } else { line });
    for spec in [other.collect::<Vec<&str>>().join("\n"), first.clone()] {
        let (told, surface) = solved(&folder, &spec, 0);
        assert_eq!(surface["outcomes"]["undercut"], 45, "{surface}\n{told}");
        assert!(told.contains("nothing of the surface stays: the tool's `body` may lie on the wrong side"), "{told}");
        assert!(!told.contains("would reach"), "{told}");
    }
}

/// A protuberance that cuts in the free leaves nothing; its `body` is that of the flank, which is there.
#[test]
fn a_piece_that_leaves_nothing_beside_one_that_does_has_its_body_on_the_right_side() {
    let folder = folder("protuberance");
    let library = self_contained(&["tools/rack_protuberance", "machines/hobbing_6axis", "machines/rack_generating"]);
    let job = "job stock {
        machine m = rack_generating(reference_radius: 36 mm, shift: 0.6 mm)
        tool r = rack_protuberance(module: 3 mm)
        mount r on m.head
        motion phi : angle in -60 deg .. 60 deg
        drive m.C = phi
        surface plus in m.table = envelope(r.plus, over: phi)
        sample plus.flank { rho: 36 mm .. 39.6 mm by 7, z: -10 mm .. 10 mm by 5 }
        sample plus.protuberance {
            s: r.tooth.protuberance.from .. r.tooth.protuberance.to by 7, z: -10 mm .. 10 mm by 5
        }
    }";
    let (told, surface) = solved(&folder, &format!("{library}{job}"), 1);
    assert_eq!(surface["outcomes"]["undercut"], 35, "{surface}\n{told}");
    assert!(
        told.contains("though the same `body` leaves other pieces of it") && !told.contains("wrong side"),
        "{told}"
    );
}

/// Boxes about the middle of two ranges that the search divides there hold no root.
#[test]
fn what_holds_no_root_is_excluded() {
    let out = folder("excluded");
    let spec = "specs/hobbing/shaped_gear.chain";
    let run = flank(&[
        "solve",
        spec,
        "--job",
        "shaped_internal_gear",
        "--no-picture",
        "--out",
        out.to_str().expect("a plain path"),
    ]);
    assert!(!text(&run.stderr).contains("not excluded"), "{}", text(&run.stderr));
}

/// What is asked for and is not there is told: triangles of a line, points that a trim took, a job under another name.
#[test]
fn what_a_command_does_not_give_is_told() {
    let out = folder("told");
    let gear = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped");
    let line = gear.replace("z: -10 mm .. 10 mm by 5", "z: 0 mm");
    let file = written(&out, "line.chain", &line);
    let to = ["--format", "stl", "--no-picture", "--out", out.to_str().expect("a plain path")];
    let told = text(&flank(&[&["solve", &file][..], &to].concat()).stderr);
    assert!(told.contains("note: the mesh of first_gear has no triangle"), "{told}");
    let told = text(&flank(&["new", "hobbing/elliptical_gear_hobbed.chain"]).stderr);
    assert!(told.contains("did you mean `elliptical_gear_hobbed`?"), "{told}");
    let spec = "specs/hobbing/undercut_gear.chain";
    let to = ["--reference", "flank_plus", "--no-picture", "--out", out.to_str().expect("a plain path")];
    let run = flank(&[&["deviation", spec, "flank_plus"][..], &to].concat());
    let told = text(&run.stderr);
    assert!(told.contains("note: `trim` takes away 28 of 287 points of the sample of flank_plus"), "{told}");
    let told = text(&flank(&["solve", "specs/hobbing/helical_gear.chain", "--set", "m.C=1 deg"]).stderr);
    assert!(told.contains("`m.C` is an axis, not a parameter"), "{told}");
}

/// Where a table ends the surface does: its ends are told beside those of the parameter.
#[test]
fn the_end_of_a_table_is_told() {
    let folder = folder("short-table");
    written(&folder, "flank.toml", "");
    written(&folder, "relief.csv", "s,depth\n-4,0\n0,0.001\n1,0.01\n");
    let gear = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped");
    let gear = gear[..gear.find("/// The tool sits").expect("the second machine")].to_string();
    let relieved = gear.replacen(
        "at = [-u * cos(pressure_angle), pi * module / 4 - u",
        "let relief = curve(\"relief.csv\", s: length, depth: length)
         at = [-u * cos(pressure_angle), pi * module / 4 - relief(u) - u",
        1,
    );
    let (told, surface) = solved(&folder, &relieved, 0);
    assert!(surface["outcomes"]["not_converged"].as_u64() > Some(0), "{surface}");
    let ends = "the table of `depth` covers u -4 mm .. 1 mm, the range of u is -4 mm .. 4 mm";
    assert!(told.contains(ends), "{told}");
}

/// A `keep` that takes none of the branches says which there are.
#[test]
fn what_a_keep_leaves_out_is_listed() {
    let out = folder("kept_out");
    let first = "sample flank_plus  { rho: low .. high by 9, z: -10 mm .. 10 mm by 5 }";
    let spec = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped");
    let kept = first.replace(" }", "\n keep roll: 100 deg .. 120 deg }");
    let spec = written(&out, "kept.chain", &spec.replacen(first, &kept, 1));
    let run = flank(&["solve", &spec, "--job", "first_gear", "--no-picture", "--out", out.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stdout));
    let told = text(&run.stderr);
    // the involute at 41 mm: how far the blank has rolled from the pitch point, which lies a quarter of a pitch off the middle
    let base = 40.0 * 20f64.to_radians().cos();
    let roll = ((41f64.powi(2) - base * base).sqrt() / base - 20f64.to_radians().tan()).to_degrees() + 4.5;
    assert!(told.contains("  `keep` leaves out the only branch at rho 41.0000 mm, z 0.0000 mm: u "), "{told}");
    assert!(told.contains(&format!("roll -{roll:.4} deg; it takes roll 100.0000 .. 120.0000 deg")), "{roll}: {told}");
}

/// What a `keep` looks at need not be an unknown: its value is told, and what it should have been.
#[test]
fn the_value_that_a_keep_saw_is_told() {
    let out = folder("kept_out_value");
    let first = "sample flank_plus  { rho: low .. high by 9, z: -10 mm .. 10 mm by 5 }";
    let spec = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped");
    for (keep, seen) in [("x: 80 mm .. 100 mm", ", x 40."), ("twice = 2 * roll: 300 deg .. 310 deg", ", twice -")] {
        let kept = first.replace(" }", &format!("\n keep {keep} }}"));
        let spec = written(&out, "kept.chain", &spec.replacen(first, &kept, 1));
        let run = flank(&["solve", &spec, "--job", "first_gear", "--no-picture", "--out", out.to_str().unwrap()]);
        let told = text(&run.stderr);
        let line = told.lines().find(|line| line.contains("`keep` leaves out the only branch")).unwrap_or_default();
        let (name, ends) = keep.split_once(": ").expect("a range");
        let name = name.split_once(" =").map_or(name, |(name, _)| name);
        let (low, high) = ends.split_once(" .. ").expect("two ends");
        let taken = format!("; it takes {name} {}.0000 .. {}.0000", &low[..low.len() - 3].trim(), &high[..3]);
        assert!(line.contains(seen) && line.contains(&taken), "{keep}: {taken}: {told}");
    }
}

/// A `keep` that is narrower than its branch is told at the points beyond it, as the reason and beside each of them.
#[test]
fn points_beyond_a_keep_are_told() {
    let out = folder("narrow_keep");
    let first = "sample flank_plus  { rho: low .. high by 9, z: -10 mm .. 10 mm by 5 }";
    let spec = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped");
    let kept = first.replace(" }", "\n keep u: -1 mm .. 1 mm }");
    let spec = written(&out, "narrow.chain", &spec.replacen(first, &kept, 1));
    let run = flank(&["solve", &spec, "--job", "first_gear", "--no-picture", "--out", out.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stdout));
    let told = text(&run.stderr);
    assert!(told.contains(": outside of `keep u: -1.0000 mm .. 1.0000 mm`"), "{told}");
    let points = std::fs::read_to_string(out.join("first_gear.csv")).expect("it is written");
    assert!(points.contains("out_of_range,outside of `keep u: -1.0000 mm .. 1.0000 mm`"), "{points}");
}

/// What is left undecided by the search is told with what would decide it, and how long it looked.
#[test]
fn what_would_decide_a_search_is_told() {
    let solve = |boxes: &[&str]| {
        let out = folder("boxes");
        let spec = ["solve", "specs/hobbing/worm_wheel.chain", "--no-picture", "--out", out.to_str().unwrap()];
        let run = flank(&[&spec[..], boxes].concat());
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        text(&run.stderr)
    };
    let told = solve(&[]);
    assert!(told.contains("(2000 boxes looked at)") && told.contains("a longer search, `--boxes 20000`,"), "{told}");
    assert!(told.contains("a narrower range of s or tau or spindle, a `keep`"), "{told}");
    let told = solve(&["--boxes", "100"]);
    assert!(told.contains("(100 boxes looked at)") && told.contains("`--boxes 1000`"), "{told}");
}

/// Along a straight tooth z is the rack's v, and each roll makes the points of one u.
#[test]
fn coordinates_that_follow_from_each_other_are_told() {
    let out = folder("dependent");
    let first = "sample flank_plus  { rho: low .. high by 9, z: -10 mm .. 10 mm by 5 }";
    let spec = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped");
    for (one, other, fine) in
        [("z: 0 mm", "v: 0 mm", false), ("u: 1 mm", "roll: 2 deg", false), ("u: 1 mm", "z: 0 mm", true)]
    {
        let sample = format!("sample flank_plus {{ {one}, {other} }}");
        let spec = written(&out, "dependent.chain", &spec.replacen(first, &sample, 1));
        let run = flank(&["solve", &spec, "--job", "first_gear", "--no-picture", "--out", out.to_str().unwrap()]);
        let told = text(&run.stderr);
        assert_eq!(run.status.code(), Some(if fine { 0 } else { 1 }), "{told}");
        let [one, other] = [one, other].map(|said| said.split(':').next().expect("a name"));
        let words = format!("error[E0506]: `{one}` and `{other}` do not tell points of `flank_plus` apart");
        assert_eq!(told.contains(&words), !fine, "{told}");
    }
}

/// The branch that a grid follows leaves the ranges at some of its points; another one has a point within them there. It is told with
/// what selects it, in words and in the document.
#[test]
fn another_branch_within_the_ranges_is_told() {
    let spec = "machine shaper {
    axis W : rotary
    axis T : rotary
    frame bed
    frame work in bed = rotate_z(W)
    frame holder in bed = translate(99.5719 mm, 0 mm, 7.843 mm) rotate_x(-1.569414271179295 rad) rotate_z(T)
}
tool thread {
    surface face(u: length in 46.8305 mm .. 54.2733 mm, v: angle in 0.6566 rad .. 5.6266 rad) {
        at = [u * cos(v), u * sin(v), 2.0425 mm/rad * v - 3.208351497478576 mm + (u - 50.5519 mm) * tan(0.356 rad)]
        body towards [0, 0, 1]
    }
}
job wheel {
    machine m = shaper
    tool t = thread
    mount t on m.holder
    motion phi : angle in -2.78 rad .. 4.016 rad
    drive m.W = -phi / 24
    drive m.T = phi
    surface f in m.work = envelope(t.face, over: phi)
    sample f { u: 51.334 mm .. 54.6832 mm by 3, z: -13.763 mm .. -9.263 mm by 3 }
}
";
    let (told, surface) = solved(&folder("verdicts_beyond"), spec, 0);
    assert!(told.contains("the ranges of f hold another branch that is not among its points"), "{told}");
    let elsewhere = surface["branches"]["elsewhere"].as_array().expect("a list");
    let [other] = &elsewhere[..] else { panic!("{elsewhere:?}") };
    let keep = &other["keep"];
    let of = other["unknowns"].as_array().expect("a list").iter().find(|unknown| unknown["name"] == keep["name"]);
    let value = |value: &serde_json::Value| value.as_f64().expect("a number");
    let [low, at, high] = [&keep["low"], &of.expect("keep names an unknown")["value"], &keep["high"]].map(value);
    assert!(low < at && at < high, "{other}");
    assert!(told.contains(&format!("keep {}: ", keep["name"].as_str().expect("a name"))), "{told}");
}

/// Four branches that no unknown and no sum of two tells apart, as one of them means the same after a turn: what is offered of each is two
/// conditions, and chooses it.
#[test]
fn what_is_offered_of_a_periodic_unknown_chooses_its_branch() {
    let folder = folder("periodic");
    let spec = std::fs::read_to_string(top().join("tests/surfaces/specs/ring_disc.chain")).expect("the spec is there");
    let (told, surface) = solved(&folder, &spec, 0);
    let found = surface["branches"]["found"].as_array().expect("branches");
    let offered: Vec<&str> = told.split('`').filter(|code| code.starts_with("keep ")).collect();
    assert_eq!((found.len(), offered.len()), (4, 4), "{told}");
    for (branch, keep) in found.iter().zip(offered) {
        let last = "by 4\n";
        let (_, kept) = solved(&folder, &spec.replace(last, &format!("{last}        {keep}\n")), 0);
        let chosen = kept["branches"]["found"].as_array().expect("branches");
        let [chosen] = &chosen[..] else { panic!("{keep}: {chosen:?}") };
        assert!(kept["outcomes"]["solved"].as_u64() >= Some(10), "{keep}: {kept}");
        let turns = |branch: &serde_json::Value| branch["unknowns"][2]["value"].as_f64().expect("a number");
        assert!((turns(branch) - turns(chosen)).abs() < 1e-6, "{keep}: {branch} {chosen}");
    }
}

/// With a table that stands still no edge of the hob comes back to where the ideal edges were: what is left is undecided everywhere, which
/// a few points tell, and no point is searched for thousands of edges.
#[test]
fn a_search_without_prospect_ends() {
    let folder = folder("prospect");
    let library = [
        "functions/hobbing",
        "machines/hobbing_6axis",
        "machines/hobbing_edges",
        "tools/involute",
        "tools/hob_zi",
        "tools/hob_zi_edges",
        "hobbing/helical_gear",
        "hobbing/real_hob",
    ];
    let still = "job still extends real_hob { drive r.C = 0 rad }";
    let spec = written(&folder, "still.chain", &format!("{}{still}", self_contained(&library)));
    let out = folder.to_str().expect("a plain path");
    let run = flank(&["solve", &spec, "--job", "still", "--no-picture", "--out", out]);
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
    let told = text(&run.stderr);
    assert!(told.contains("what is left is unknown at 40000 of 40000 points of lower_flank"), "{told}");
    assert!(told.contains("too many would have to be tried"), "{told}");
}

/// Verdicts that a coarse look misses, of surfaces drawn at random: each with how many points have the word, and what is told.
#[test]
fn what_a_coarse_look_misses_is_told() {
    let out = folder("coarse_look");
    for (spec, word, count, words) in [
        // no point of the part that is a line stands where a grid is looked at first
        ("line_at_few_points", "singular", 2, "no tangent plane"),
        // where the fillet meets the flank's envelope beyond its fold, nothing is cut away before
        ("trim_beyond_a_fold", "solved", 33, ""),
        // the tool bends up one way and down the other, so that its corners lie as deep as its middle
        ("saddle", "undercut", 75, "in another position of the tool"),
        // the flank's envelope ends before the point, its tool does not
        ("cut_at_the_end_of_a_motion", "trimmed", 6, "as `trim` asks for"),
        // two points of 231 have another branch
        ("seldom_two_branches", "solved", 165, "the ranges of face hold another branch that is not among its points"),
    ] {
        let text = std::fs::read_to_string(top().join(format!("tests/surfaces/specs/{spec}.chain"))).expect("its spec");
        let (told, surface) = solved(&out, &text, 0);
        assert_eq!(surface["outcomes"][word], count, "{spec}: {surface}\n{told}");
        assert!(told.contains(words), "{spec}: {told}");
    }
}

/// A grid so dense that it is solved in bands tells of another branch as a coarse one does.
#[test]
fn another_branch_of_a_dense_grid_is_told() {
    let out = folder("dense_grid");
    let coarse =
        std::fs::read_to_string(top().join("tests/surfaces/specs/seldom_two_branches.chain")).expect("its spec");
    let dense = coarse.replace(" by 11\n", " by 400\n").replace(" by 21\n", " by 401\n");
    assert_ne!(dense, coarse);
    let file = written(&out, "dense.chain", &dense);
    let run = flank(&["solve", &file, "--geometry", "--no-picture", "--out", out.to_str().expect("a plain path")]);
    let told = text(&run.stderr);
    assert!(told.contains("the ranges of face hold another branch that is not among its points"), "{told}");
}

/// A `keep` reaches over the seam of a full turn: the point a turn on is the same one, and its value stays in its range.
#[test]
fn a_keep_goes_on_over_the_seam_of_a_turn() {
    let folder = folder("seam");
    let torus = "machine bench { axis X : linear frame bed frame wheel in bed = translate_x(X) }
        tool torus {
            surface face(a: angle in -60 deg .. 60 deg, th: angle in -180 deg .. 180 deg) {
                let out = 20 mm + 5 mm * cos(a)
                at = [out * cos(th), out * sin(th), 5 mm * sin(a)]
                body towards [-cos(a) * cos(th), -cos(a) * sin(th), -sin(a)]
            }
        }
        job band {
            machine m = bench
            tool t = torus
            mount t on m.wheel
            drive m.X = 0 mm
            surface face in m.bed = move(t.face)
            sample face { a: -30 deg .. 30 deg by 3, y: -3 mm .. 3 mm by 7, keep th: KEEP }
        }";
    let pin = "machine table { axis C : rotary frame bed frame pin in bed = translate_x(30 mm) frame work in bed = rotate_z(C) }
        tool pin {
            surface face(a: angle in 90 deg .. 270 deg, v: length in -5 mm .. 5 mm) {
                at = [5 mm * cos(a), 5 mm * sin(a), v]
                body inside
            }
        }
        job ring {
            machine m = table
            tool t = pin
            mount t on m.pin
            motion c : angle in -180 deg .. 180 deg
            drive m.C = c
            surface face in m.work = envelope(t.face, over: c)
            sample face { y: -3 mm .. 3 mm by 7, v: 0 mm, keep c: KEEP }
        }";
    for (spec, points) in [(torus, 21), (pin, 7)] {
        for keep in ["90 deg .. 270 deg", "-270 deg .. -90 deg", "450 deg .. 630 deg"] {
            let (told, surface) = solved(&folder, &spec.replace("KEEP", keep), 0);
            assert_eq!(surface["solved"], points, "{keep}: {surface}\n{told}");
        }
        // the half that it leaves out
        let (_, surface) = solved(&folder, &spec.replace("KEEP", "-90 deg .. 90 deg"), 0);
        assert_eq!(surface["solved"], points, "{surface}");
    }
}

/// A wobbling plate carries cone rollers round a crown gear: its flank is a curve on a sphere about the centre of nutation, seen from both
/// sides of the roller, and where that curve turns back there are cusps, found from its curvature by hand: at ±157.3 deg of the shaft on one
/// side, at ±22.7 deg on the other.
#[test]
fn limits_are_those_of_the_branch_that_is_kept() {
    let folder = folder("limits_kept");
    for (keep, cusp, side) in [("-170 deg .. -10 deg", 157.3, -1.0), ("10 deg .. 170 deg", 22.7, 1.0)] {
        let file = written(&folder, "crown.chain", &NUTATION.replace("KEPT", keep));
        let out = folder.to_str().expect("a plain path");
        let run = flank(&["solve", &file, "--limits", "--json", "--no-picture", "--out", out]);
        let table: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
        let line = &table["lines"][0];
        assert_eq!((&line["name"], &line["solved"]), (&"flank.singular_line".into(), &line["asked"]));
        let range = |name: &str| {
            let all = line["ranges_reached"].as_array().expect("ranges");
            let of = all.iter().find(|of| of["name"] == name).expect("it is an unknown");
            (of["low"].as_f64().expect("a number"), of["high"].as_f64().expect("a number"))
        };
        let ((low, high), (least, most)) = (range("shaft"), range("a"));
        assert!((low.abs() - cusp).abs() < 0.06 && (high.abs() - cusp).abs() < 0.06, "{keep}: {low} .. {high}");
        assert!(side * least > 10.0 && side * most > 10.0, "{keep}: {least} .. {most}");
    }
}

/// A study of one point looks at the tool's other positions for it, as solving all of them does.
#[test]
fn a_studied_point_that_the_tool_cuts_away_elsewhere_is_not_solved() {
    let folder = folder("studied_point");
    let file = written(&folder, "crown.chain", &NUTATION.replace("KEPT", "10 deg .. 170 deg"));
    let plain = |path: std::path::PathBuf| path.to_str().expect("a plain path").to_string();
    let study = |at: &str, name: &str| {
        let out = plain(folder.join(name));
        let _ = std::fs::remove_dir_all(&out);
        let scatter = "r.half_angle=normal(0.0001 deg)";
        flank(&["sweep", &file, "--scatter", scatter, "--count", "3", "--collect", at, "--out", &out]);
        text(&flank(&["sweep", "gather", &out]).stdout)
    };
    let out = plain(folder.clone());
    flank(&["solve", &file, "--no-picture", "--out", &out]);
    let table = std::fs::read_to_string(folder.join("crown.csv")).expect("it is written");
    let is_elsewhere = |line: &&str| line.contains("in another position of the tool");
    let cut = table.lines().find(is_elsewhere).expect("the roller cuts some away");
    let solved = table.lines().find(|line| line.contains(",solved,")).expect("others are there");
    for (line, verdict) in [(cut, "not all solved,undercut"), (solved, "done,")] {
        let place: Vec<&str> = line.split(',').skip(1).take(2).collect();
        let rows = study(&format!("at:flank[{}]", place.join(",")), &format!("study_{}", place.join("_")));
        assert_eq!(rows.matches(verdict).count(), 3, "{line}: {rows}");
    }
}

const NUTATION: &str = "//! Nutation drive: a wobbling plate carries cone rollers round a crown gear, one tooth more.

machine wobble {
    param tilt : angle in 0.1 deg .. 30 deg = 5 deg
    param rollers : count in 3 .. 200 = 20
    param teeth : count in 3 .. 200 = 21
    axis shaft : rotary
    frame bed
    frame swash in bed = rotate_z(shaft) rotate_y(tilt) rotate_z(-shaft)
    frame plate in swash = rotate_z(0 deg)
    frame crown in bed = rotate_z(turn)
    axis turn : rotary
    couple turn = shaft / teeth
}

/// A cone on x, its apex in the centre of nutation.
tool cone_roller {
    param half_angle : angle in 0.1 deg .. 30 deg = 3 deg
    surface side(u: length in 30 mm .. 60 mm, a: angle in -180 deg .. 180 deg) {
        at = u * [cos(half_angle), sin(half_angle) * cos(a), sin(half_angle) * sin(a)]
        body towards [0, -cos(a), -sin(a)]
    }
}

job crown {
    machine m = wobble
    tool r = cone_roller
    mount r on m.plate
    motion shaft : angle in -180 deg .. 180 deg
    drive m.shaft = shaft
    surface flank in m.crown = envelope(r.side, over: shaft)
    sample flank { shaft: -170 deg .. 170 deg by 35, u: 30 mm .. 60 mm by 3
 keep a: KEPT }
    expect all solved
}
";

/// A Wankel engine: the rotor is what its housing leaves of it, and both waists of the housing touch the same flank. The search in the
/// middle of the sample does not come to its end; what is found elsewhere counts.
#[test]
fn branches_that_are_found_beside_an_unfinished_search_are_told_as_such() {
    const SPEC: &str = "machine engine {
    axis A : rotary
    frame housing
    frame crank in housing = rotate_z(3 * A) translate_x(15 mm)
    frame rotor in crank   = rotate_z(-2 * A)
}
tool seal {
    surface tip(t: angle in -180 deg .. 180 deg, w: length in -30 mm .. 30 mm) {
        at = [100 mm + 2 mm * cos(t), 2 mm * sin(t), w]
        body towards [-cos(t), -sin(t), 0]
    }
}
job rotor {
    machine m = engine
    machine n = engine
    tool s = seal
    mount s on m.rotor
    motion turn : angle in -180 deg .. 180 deg
    motion back : angle in -180 deg .. 180 deg
    drive m.A = turn
    drive n.A = back
    surface bore in m.housing = envelope(s.tip, over: turn)
    mount bore on n.housing
    surface flank in n.rotor = envelope(bore, over: back)
    sample flank {
        polar_angle: 10 deg .. 110 deg by 11, z: 0 mm .. 10 mm by 2
        keep rho: 65 mm .. 104 mm, keep t: -60 deg .. 60 deg
    }
}
";
    let folder = folder("unfinished");
    let (_, flank) = solved(&folder, SPEC, 0);
    assert_eq!(flank["outcomes"], serde_json::json!({ "ambiguous": 22 }), "{flank}");
    let found = flank["branches"]["found"].as_array().expect("branches");
    assert_eq!(found.len(), 2, "{found:?}");
    for branch in found {
        assert!(branch["keep"].is_object(), "{branch}");
        let unknown = |name: &str| {
            let all = branch["unknowns"].as_array().expect("unknowns");
            let of = all.iter().find(|of| of["name"] == name).expect(name);
            of["value"].as_f64().expect("a number").to_radians()
        };
        // the normal of the housing passes through the pole of the turn that made it, and meets the circle of poles once more where the
        // housing makes the rotor
        let (turn, back) = (unknown("turn"), unknown("back"));
        let towards = |angle: f64| [angle.cos(), angle.sin()];
        let (crank, apex) = (towards(3.0 * turn), towards(turn));
        let pole = crank.map(|x| -30.0 * x);
        let along = [0, 1].map(|k| 45.0 * crank[k] + 100.0 * apex[k]);
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        let share = 2.0 * dot(pole, along) / dot(along, along);
        let other = [0, 1].map(|k| pole[k] - share * along[k]);
        let off_pole = [0, 1].map(|k| other[k] + 30.0 * towards(3.0 * back)[k]);
        assert!(dot(off_pole, off_pole).sqrt() < 1e-9, "{off_pole:?}");
        let length = dot(along, along).sqrt();
        let at = [0, 1].map(|k| pole[k] + along[k] * (1.0 + 2.0 / length) - 15.0 * towards(3.0 * back)[k]);
        let (cos, sin) = (back.cos(), back.sin());
        let in_rotor = [cos * at[0] + sin * at[1], cos * at[1] - sin * at[0]];
        for (k, value) in in_rotor.into_iter().enumerate() {
            let told = branch["position"][k].as_f64().expect("a number");
            assert!((told - value).abs() < 1e-9, "{told} {value}");
        }
    }
}

/// A ball on a plane way touches with its pole alone, where the angle about the pole is anything: roots that lead nowhere are no branches.
#[test]
fn roots_that_lead_nowhere_are_no_branches() {
    const SPEC: &str = "machine table {
    axis X : linear
    axis Y : linear
    frame work
    frame head in work = translate(X, Y, 0 mm)
}
tool ball {
    surface cap(a: angle in -180 deg .. 180 deg, b: angle in 0 deg .. 90 deg) {
        at = [5 mm * cos(a) * sin(b), 5 mm * sin(a) * sin(b), -5 mm * cos(b)]
        body towards [-cos(a) * sin(b), -sin(a) * sin(b), cos(b)]
    }
}
job plane {
    machine m = table
    tool t = ball
    mount t on m.head
    motion across : length in -40 mm .. 40 mm
    motion along : length in -40 mm .. 40 mm
    drive m.X, m.Y = across, along
    surface floor in m.work = envelope(t.cap, over: [across, along])
    sample floor { x: -15 mm .. 15 mm by 5, y: 10 mm .. 25 mm by 5 }
}
";
    let folder = folder("poles");
    let (_, floor) = solved(&folder, SPEC, 0);
    assert!(floor["outcomes"]["ambiguous"].is_null() && floor["solved"] == 0, "{}", floor["outcomes"]);
}
