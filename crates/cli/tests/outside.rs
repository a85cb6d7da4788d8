//! Points that a surface does not come to say by how much, and what lies there.

mod support;

use std::path::Path;

use serde_json::Value;
use support::{flank, folder, self_contained, text, written};

/// What a spec's surfaces have come to, and what is told of it.
fn solved(folder: &Path, spec: &str, more: &[&str]) -> (Value, String) {
    let file = written(folder, "spec.chain", spec);
    let to = ["--no-picture", "--json", "--out", folder.to_str().expect("a plain path")];
    let run = flank(&[&["solve", &file], more, &to].concat());
    let told = text(&run.stderr);
    let table: Value = serde_json::from_slice(&run.stdout).unwrap_or_else(|_| panic!("{told}"));
    assert_eq!(run.status.code(), Some(3), "{told}");
    (table, told)
}

/// The last cells of the rows of a surface: status and reason.
fn verdicts(csv: &Path, surface: &str) -> Vec<String> {
    let csv = std::fs::read_to_string(csv).expect("written");
    let rows = csv.lines().filter(|row| row.starts_with(&format!("{surface},")));
    rows.map(|row| row.rsplitn(3, ',').take(2).collect::<Vec<_>>().into_iter().rev().collect::<Vec<_>>().join(": "))
        .collect()
}

const RAIL: &str = "
    tool rail {
        surface flank(u: length in -12 mm .. 12 mm, v: length in -12 mm .. 12 mm) {
            at = [-u * cos(20 deg), 1.25 * pi * 1 mm - u * sin(20 deg), v]
            body towards [0, -1, 0]
        }
    }
    job j {
        machine m = rack_generating(reference_radius: 50 mm)
        tool t = rail
        mount t on m.head
        motion phi : angle in -60 deg .. 60 deg
        drive m.C = phi
        surface a in m.table = envelope(t.flank, over: phi)
        sample a { SAMPLE }
    }";

/// A value of a parameter beyond its range is outside by just that, near and far, also where no branch leads so far.
#[test]
fn what_is_asked_for_outside_is_outside() {
    let folder = folder("asked_outside");
    let library = self_contained(&["machines/hobbing_6axis", "machines/rack_generating"]);
    for sample in
        ["u: 200 mm .. 300 mm by 3, v: 0 mm .. 2 mm by 2", "v: 60 mm .. 80 mm by 3, phi: -2 deg .. 2 deg by 2"]
    {
        let (table, told) = solved(&folder, &format!("{library}{}", RAIL.replace("SAMPLE", sample)), &[]);
        assert_eq!(table["surfaces"][0]["outcomes"]["out_of_range"], 6, "{told}");
        let (name, by) = if sample.starts_with('u') { ("u", "288.000000 mm") } else { ("v", "68.000000 mm") };
        assert!(told.contains(&format!("6: {name} outside its range, by up to {by}")), "{told}");
        let last = verdicts(&folder.join("j.csv"), "a").pop().expect("a row");
        assert_eq!(last, format!("out_of_range: {name} by {by}"));
    }
    // what lies within is found all the same; rolling the rail densely, without equations, cuts u = 4, 5 and 6 mm by up to 0.1228 mm
    let mixed = RAIL.replace("SAMPLE", "u: -3 mm .. 57 mm by 61, v: 0 mm");
    let (table, told) = solved(&folder, &format!("{library}{mixed}"), &[]);
    assert_eq!(table["surfaces"][0]["outcomes"]["out_of_range"], 45, "{told}");
    assert_eq!(table["surfaces"][0]["solved"], 7, "{table}");
    assert!(told.contains("3: cut away by t.flank in another position of the tool, by up to 0.1"), "{told}");
    assert!(!told.contains("not_converged"), "{told}");
}

/// The flank of a gear without undercut ends before its singular line, which lies on the base circle.
#[test]
fn limits_beyond_the_flank_say_by_how_much() {
    let out = folder("limits_outside");
    let spec = ["solve", "specs/hobbing/spur_gear.chain", "--set", "teeth=18", "--set", "profile_shift=0", "--limits"];
    let run = flank(&[&spec[..], &["--no-picture", "--out", out.to_str().expect("a plain path")]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let (sine, cosine) = 20f64.to_radians().sin_cos();
    let ends = (3.75 - 1.14 * (1.0 - sine)) / cosine;
    let by = 27.0 * sine * sine / cosine - ends;
    let table = text(&run.stdout);
    let row = table.lines().find(|row| row.contains("flank_plus.singular_line")).expect("a row");
    assert!(row.ends_with(&format!("none within the ranges: outside, u by up to {by:.6} mm")), "{row}");
}

/// Of a tool that leaves nothing, but would not leave it either with its body on the other side, the body is not blamed.
#[test]
fn undercut_in_one_direction_is_no_body_on_the_wrong_side() {
    let folder = folder("saddle");
    // a ball of 3 mm goes over a ridge that is sharper than itself, and along it through a hollow
    let spec = "machine router {
            axis X : linear axis Y : linear axis Z : linear
            frame bed
            frame head in bed = translate([X, Y, Z])
        }
        tool ball {
            surface low(theta: angle in 120 deg .. 180 deg, turn: angle in -180 deg .. 180 deg) {
                at = [3 mm * sin(theta) * cos(turn), 3 mm * sin(theta) * sin(turn), 3 mm * cos(theta)]
                body towards [-sin(theta) * cos(turn), -sin(theta) * sin(turn), -cos(theta)]
            }
        }
        job ridge {
            machine m = router
            tool t = ball
            mount t on m.head
            motion a : length in -1 mm .. 1 mm
            motion b : length in -1 mm .. 1 mm
            drive m.X = a
            drive m.Y = b
            drive m.Z = SHAPE
            surface s in m.bed = envelope(t.low, over: [a, b])
            sample s { a: 0.1 mm .. 0.2 mm by 3, b: 0.1 mm .. 0.2 mm by 3 }
        }";
    let blamed = "the tool's `body` may lie on the wrong side";
    for (shape, is_blamed) in [("-a^2 / 2 mm + b^2 / 10 mm", false), ("-a^2 / 2 mm - b^2 / 3 mm", true)] {
        let (table, told) = solved(&folder, &spec.replace("SHAPE", shape), &[]);
        assert_eq!(table["surfaces"][0]["outcomes"]["undercut"], 9, "{shape}: {told}");
        assert_eq!(told.contains(blamed), is_blamed, "{shape}: {told}");
    }
}

const PIECES: &str = "machine lathe {
        axis C : rotary
        frame bed
        frame work in bed = rotate_z(C)
        frame slide in bed = translate_x(15 mm)
    }
    tool groover {
        profile blade {
            top    = line(from: [3 mm, 3 mm], to: [1 mm, 3 mm])
            corner = arc(center: [1 mm, 2 mm], radius: 1 mm, from: 90 deg, to: 180 deg)
            front  = line(from: [0 mm, 2 mm], to: [0 mm, 0 mm])
        }
        surface edge(s: along blade) {
            let p = blade(s)
            at = [p[0], 0 mm, p[1]]
            body towards [6 mm - p[0], 0 mm, -p[1]]
        }
    }
    job j {
        machine m = lathe
        tool t = groover
        mount t on m.slide
        motion turn : angle in -180 deg .. 180 deg
        drive m.C = turn
        SURFACES
    }";

/// A grid that runs over the end of a piece names the piece that follows, and the surface made of it; no range would help.
#[test]
fn the_piece_that_follows_is_named() {
    let folder = folder("pieces");
    let whole = "surface ground in m.work = sweep(t.edge, over: turn)
        sample ground.corner { rho: 15.1 mm .. 16.5 mm by 6, turn: -90 deg .. 90 deg by 3 }
        sample ground.front { z: -1 mm .. 2.4 mm by 9, turn: -90 deg .. 90 deg by 3 }";
    let (_, told) = solved(&folder, &PIECES.replace("SURFACES", whole), &[]);
    for wanted in [
        "`corner` begins at s 2.0000 mm, before it lies `top` of the same profile: sample `ground.top` for the points beyond",
        "`front` begins at s 3.5708 mm, before it lies `corner` of the same profile: sample `ground.corner` for the points beyond",
        "`front` ends at s 5.5708 mm, and with it the profile: there is no tool beyond",
    ] {
        assert!(told.contains(wanted), "{wanted} in\n{told}");
    }
    assert!(!told.contains("would reach"), "{told}");
    // alone it has no neighbour in the job, nor has it a name to go by
    let alone = "surface ground in m.work = sweep(t.edge.corner, over: turn)
        sample ground { rho: 15.1 mm .. 16.5 mm by 6, turn: -90 deg .. 90 deg by 3 }";
    let (_, told) = solved(&folder, &PIECES.replace("SURFACES", alone), &[]);
    assert!(told.contains("make a surface of `t.edge.top` for the points beyond"), "{told}");
}

/// Limits beyond the ranges stand in the files as in the table: each point with its status and by how much. Pictures do not show them.
#[test]
fn limits_outside_the_ranges_stand_in_the_files() {
    let out = folder("limits_outside");
    let spec = "specs/hobbing/chang_tsay_nagata.chain";
    let run = flank(&["solve", spec, "--limits", "--format", "csv,json", "--out", out.to_str().expect("a plain path")]);
    let table = text(&run.stdout);
    let read = |name: &str| std::fs::read_to_string(out.join(name)).expect("written");
    let (csv, json, picture) =
        (read("chang_tsay_nagata.csv"), read("chang_tsay_nagata.json"), read("chang_tsay_nagata.svg"));
    for line in ["lower_flank.singular_line", "upper_flank.contact_limit"] {
        let told = table.lines().find(|row| row.contains(line)).expect("a row of the table");
        assert!(told.contains("none within the ranges: outside"), "{told}");
        let rows: Vec<&str> = csv.lines().filter(|row| row.starts_with(&format!("{line},"))).collect();
        assert_eq!(rows.len(), 21, "{csv}");
        assert!(rows.iter().all(|row| row.contains("out_of_range,") && row.contains(" by ")), "{rows:?}");
        assert!(json.contains(line) && !picture.contains(line), "{line}");
    }
}
