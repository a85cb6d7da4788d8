//! `flank deviation` as a user runs it.

mod support;

use support::{flank, folder, self_contained, text, written};

#[test]
fn deviation_of_two_flanks_is_told_and_drawn() {
    let out = folder("deviation");
    let spec = "specs/bevel/ease_off_19x62.chain";
    let into = out.to_str().unwrap();
    let of = ["deviation", spec, "pinion.concave", "--reference", "conjugate.concave", "--out", into];
    let run = flank(&[&of[..], &["--json"]].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let told: serde_json::Value = serde_json::from_str(&text(&run.stdout)).unwrap();
    assert_eq!((told["asked"].as_u64(), told["known"].as_u64()), (Some(1125), Some(1125)));
    assert!(told["middle_um"].as_f64().unwrap().abs() < 1e-6);
    for extension in ["csv", "png", "svg"] {
        assert!(out.join(format!("pinion.concave.deviation.{extension}")).exists(), "{extension}");
    }
    let run = flank(&["deviation", spec, "concave", "--reference", "conjugate.concave", "--out", into]);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("several jobs have a surface `concave`"), "{}", text(&run.stderr));
    let run = flank(&["deviation", spec, "pinion.convex", "--reference", "conjugate.concave", "--out", into]);
    assert!(text(&run.stderr).contains("there is no surface `pinion.convex`"), "{}", text(&run.stderr));
    let run = flank(&["deviation", spec, "conjugate.concave", "--reference", "pinion.concave", "--out", into]);
    assert!(text(&run.stderr).contains("`concave` is not sampled"), "{}", text(&run.stderr));
}

/// Opposite flanks are turned onto each other, and that is told.
#[test]
fn normals_that_face_apart_are_told() {
    let out = folder("deviation_opposite");
    let of = |surface| {
        let spec = "specs/hobbing/spur_gear.chain";
        let rest = ["--reference", "flank_minus", "--no-picture", "--out", out.to_str().expect("a plain path")];
        text(&flank(&[&["deviation", spec, surface], &rest[..]].concat()).stderr)
    };
    let told = "note: flank_plus and flank_minus have their steel on opposite sides in the middle of the grid";
    assert!(of("flank_plus").contains(told), "{}", of("flank_plus"));
    assert!(!of("flank_minus").contains("opposite sides"));
}

/// Two surfaces that are both sampled by a coordinate of the spec's own are compared by it.
#[test]
fn a_worm_wheel_lies_off_the_conjugate_one() {
    let out = folder("worm_wheel");
    let surfaces = ["specs/hobbing/worm_wheel.chain", "upper.flank", "--reference", "conjugate_upper.flank"];
    let rest = ["--no-picture", "--out", out.to_str().expect("a plain path")];
    let run = flank(&[&["deviation"], &surfaces[..], &rest].concat());
    let told = text(&run.stdout);
    assert_eq!(run.status.code(), Some(0), "{told}");
    assert!(told.contains("points       315 of 315") && told.contains("range        -36.448 .. 0.223 um"), "{told}");
}

/// A polar angle goes on beyond half a turn on both surfaces: cylinders of 15 mm and 14.9 mm lie 100 um apart all the way.
#[test]
fn a_deviation_is_told_across_half_a_turn() {
    let out = folder("half_turn");
    let spec = written(
        &out,
        "cylinders.chain",
        "machine lathe { axis C : rotary frame bed frame work in bed = rotate_z(C) }
        tool knife {
            param reach : length
            surface edge(u: length in 0 mm .. 3 mm) { at = [reach, 0 mm, u] body towards [1, 0, 0] }
        }
        job j {
            machine m = lathe
            tool one   = knife(reach: 15 mm)
            tool other = knife(reach: 14.9 mm)
            mount one   on m.bed
            mount other on m.bed
            motion turn : angle in -360 deg .. 0 deg
            drive m.C = turn
            surface ideal in m.work = sweep(one.edge, over: turn)
            surface real  in m.work = sweep(other.edge, over: turn)
            sample ideal { z: 1 mm .. 2 mm by 3, polar_angle: 150 deg .. 220 deg by 5 }
        }",
    );
    let run = flank(&[
        "deviation",
        &spec,
        "real",
        "--reference",
        "ideal",
        "--no-align",
        "--no-picture",
        "--json",
        "--out",
        out.to_str().expect("a plain path"),
    ]);
    assert_eq!(run.status.code(), Some(0), "{}{}", text(&run.stdout), text(&run.stderr));
    let told: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert_eq!((told["asked"].as_u64(), told["known"].as_u64()), (Some(15), Some(15)));
    for end in ["lowest_um", "highest_um"] {
        assert!((told[end].as_f64().expect("a number").abs() - 100.0).abs() < 1e-6, "{told}");
    }
}

/// A surface lies off itself by nothing, not by minus nothing.
#[test]
fn nothing_has_no_sign() {
    let out = folder("deviation_of_itself");
    let of = ["deviation", "specs/bevel/thesis_gear.chain", "concave", "--reference", "concave", "--no-picture"];
    let run = flank(&[&of[..], &["--out", out.to_str().unwrap()]].concat());
    let told = text(&run.stdout);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    assert!(told.contains("range        0.000 .. 0.000 um, rms 0.000") && !told.contains("-0"), "{told}");
}

/// Two surfaces of one shape whose parameters have the same names and count from different places lie on each other.
#[test]
fn names_of_unknowns_say_nothing_of_places() {
    let out = folder("deviation_names");
    let job = "
        tool rail {
            param begin : length = 0 mm
            surface flank(u: length in -12 mm .. 12 mm, v: length in -12 mm .. 12 mm) {
                let w = u + begin
                at = [-w * cos(20 deg), 1.25 * pi * 1 mm - w * sin(20 deg), v]
                body towards [0, -1, 0]
            }
        }
        job pair {
            machine m = rack_generating(reference_radius: 50 mm)
            machine n = rack_generating(reference_radius: 50 mm)
            tool one = rail
            tool other = rail(begin: 6 mm)
            mount one on m.head
            mount other on n.head
            motion phi : angle in -60 deg .. 60 deg
            drive m.C = phi
            drive n.C = phi
            surface a in m.table = envelope(one.flank, over: phi)
            surface b in n.table = envelope(other.flank, over: phi)
            sample a { u: -3 mm .. 3 mm by 7, v: -5 mm .. 5 mm by 3 }
        }";
    let library = self_contained(&["machines/hobbing_6axis", "machines/rack_generating"]);
    let spec = written(&out, "rails.chain", &format!("{library}{job}"));
    let run =
        flank(&["deviation", &spec, "b", "--reference", "a", "--no-picture", "--json", "--out", out.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let told: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert_eq!((told["asked"].as_u64(), told["known"].as_u64()), (Some(21), Some(21)));
    for end in ["lowest_um", "highest_um"] {
        assert!(told[end].as_f64().expect("a number").abs() < 1e-6, "{told}");
    }
}

/// The disc that a helical gear's flank makes grinds two spaces of it within its ranges: which one is meant is asked as `solve` asks.
#[test]
fn several_branches_are_listed() {
    let out = folder("deviation_branches");
    let job = "
        machine thread_grinding {
            param center_distance : length
            param swivel : angle
            param lead : length / angle
            axis feed : rotary
            frame bed
            frame worm in bed = screw([0, 0, 1], feed, lead)
            frame disc in bed = translate_x(center_distance) rotate_x(swivel)
        }
        job round_trip {
            let reference_radius = 51 mm
            let transverse_pressure_angle = atan(tan(20 deg) / cos(20 deg))
            let base_radius = reference_radius * cos(transverse_pressure_angle)
            let lead = reference_radius / tan(20 deg) / 1 rad
            machine m = thread_grinder(center_distance: reference_radius + 110 mm, swivel: 70 deg)
            machine n = thread_grinding(center_distance: reference_radius + 110 mm, swivel: 70 deg, lead: lead)
            tool right = thread_zi(
                side: 1, base_radius: base_radius, lead: lead,
                half_space: pi / 48 * 1 rad - inv(transverse_pressure_angle)
            )
            mount right on m.thread
            motion spindle : angle in -40 deg .. 40 deg
            motion feed : angle in -60 deg .. 60 deg
            drive m.spindle = spindle
            drive n.feed = feed
            surface wheel in m.wheel = envelope(right.flank, over: spindle)
            mount wheel on n.disc
            surface again in n.worm = envelope(wheel, over: feed)
            surface original in m.thread = move(right.flank)
            sample original { rho: 48 mm .. 55 mm by 5, z: -15 mm .. 15 mm by 5 }
            sample again { rho: 48 mm .. 55 mm by 5, z: -15 mm .. 15 mm by 5 KEEP }
        }";
    let library = self_contained(&["machines/thread_grinder", "grinding/thread_wheel"]);
    let run = |keep: &str| {
        let spec = written(&out, "round_trip.chain", &format!("{library}{}", job.replace("KEEP", keep)));
        flank(&[
            "deviation",
            &spec,
            "again",
            "--reference",
            "original",
            "--no-picture",
            "--json",
            "--out",
            out.to_str().unwrap(),
        ])
    };
    let ambiguous = run("");
    let told = text(&ambiguous.stderr);
    assert_eq!(ambiguous.status.code(), Some(3), "{told}");
    assert!(told.contains("ambiguous: the ranges of again hold 2 branches at rho 51.5000 mm, z 0.0000 mm"), "{told}");
    let keep = told.split("mm: `keep ").nth(1).and_then(|rest| rest.split('`').next()).expect("what selects a branch");
    assert!(!told.contains("in common"), "{told}");
    let listed: serde_json::Value = serde_json::from_slice(&ambiguous.stdout).expect("JSON");
    assert!(listed["not_done"][0]["kind"] == "ambiguous", "{listed}");
    // nor is one taken to be measured
    let spec = out.join("round_trip.chain");
    let grid = flank(&["measure", spec.to_str().unwrap(), "--surface", "again", "--out", out.to_str().unwrap()]);
    let told_by_measure = text(&grid.stderr);
    assert_eq!(grid.status.code(), Some(3), "{told_by_measure}");
    assert!(told_by_measure.contains("ambiguous: the ranges of again hold 2 branches"), "{told_by_measure}");
    assert!(told_by_measure.contains(&format!("keep {keep}")), "{told_by_measure}");
    // as it says
    let chosen = run(&format!(", keep {keep}"));
    assert_eq!(chosen.status.code(), Some(0), "{}", text(&chosen.stderr));
    let found: serde_json::Value = serde_json::from_slice(&chosen.stdout).expect("JSON");
    assert_eq!(found["known"], 25, "{found}");
    assert!(found["rms_um"].as_f64().expect("a number") < 1e-3, "{found}");
}

/// A flank as a formula, and one that is turned away from it by polynomials of radius and height.
fn formula(sample: &str) -> String {
    format!(
        "machine bench {{ axis lift : linear frame table frame part in table = translate_z(lift) fix lift = 0 mm }}
        tool tooth {{
            param e : number = 0
            surface flank(d: length in 40 mm .. 60 mm, h: length in -25 mm .. 25 mm) {{
                let r = d - 50 mm
                let way = e * (r - h / 2 + r^2 / 5 mm + h^2 / 100 mm + r * h / 10 mm + r^3 / 100 mm^2)
                let a = 0.3 * r / 50 mm * 1 rad + 0.2 * (r / 50 mm)^2 * 1 rad + h / (400 mm/rev) + way / 50 mm * 1 rad
                at = [d * cos(a), d * sin(a), h]
                body towards [sin(a), -cos(a), 0]
            }}
        }}
        job teeth {{
            machine b = bench
            tool t = tooth
            tool u = t(e: 1e-3)
            mount t, u on b.part
            surface plain, bent in b.table = move(t.flank, u.flank)
            sample plain, bent {sample}
        }}"
    )
}

/// The command that compares both.
fn bent_against_plain<'c>(spec: &'c str, out: &'c std::path::Path) -> [&'c str; 8] {
    let out = out.to_str().expect("a path of letters");
    ["deviation", spec, "bent", "--reference", "plain", "--no-picture", "--out", out]
}

/// What `flank deviation` tells of both, as a document and as text.
fn bent_from_plain(name: &str, sample: &str) -> (serde_json::Value, String) {
    let out = folder(name);
    let spec = written(&out, "teeth.chain", &formula(sample));
    let of = bent_against_plain(&spec, &out);
    let [document, told] = [&["--json"][..], &[]].map(|option| {
        let run = flank(&[&of[..], option].concat());
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        text(&run.stdout)
    });
    (serde_json::from_str(&document).expect("JSON"), told)
}

/// Turn, slopes, crownings, bias and angles of slopes wherever rows and columns lie, and however many there are: as the formulas of both flanks have
/// them that were intersected with the normals, turned and fitted by least squares outside of this program. Both are at the mean point then, rho 49.5
/// and z 2.5, also where no row and no column goes through it. Surfaces are solved to 1e-9 mm here, 1e-6 um.
#[test]
fn a_grid_has_its_numbers_wherever_its_rows_and_columns_lie() {
    let even = |rows, columns| format!("{{ rho: 44 mm .. 55 mm by {rows}, z: -15 mm .. 20 mm by {columns} }}");
    let uneven = "{ rho: [44 mm, 45 mm, 55 mm], z: [-15 mm, -14 mm, -13 mm, 20 mm] }".to_string();
    let cases = [
        (
            even(7, 9),
            [11.26176009608577, -12.914494784885342],
            [-4.556604057148848, -2.3275985977802147, 27.615405908352685],
            [3.379216599929341, -1.0061275726943448],
        ),
        (
            even(6, 8),
            [11.353706897921349, -12.89388800440907],
            [-4.557395271774641, -2.3272282921677694, 27.609232998304606],
            [3.4068062443382985, -1.0045221634866384],
        ),
        (
            uneven,
            [12.088100241152384, -12.486494431925399],
            [-3.1424013911707864, -2.285063724171349, 27.746043261466863],
            [3.627168990143402, -0.972783416377948],
        ),
    ];
    for (sample, slopes, others, angles) in cases {
        let (told, words) = bent_from_plain("deviation_lines", &sample);
        let number = |of: &serde_json::Value| of.as_f64().expect("a number");
        let is =
            |of: &serde_json::Value, wanted: f64| assert!((number(of) - wanted).abs() < 1e-5, "{of} {wanted} {sample}");
        // 1e-9 mm at 49.5 mm
        assert!((number(&told["turn_deg"]) - 0.0020211086223299).abs() < 2e-9, "{told}");
        is(&told["middle_um"], 0.0);
        for k in 0..2 {
            is(&told["directions"][k]["slope_um"], slopes[k]);
            is(&told["directions"][k]["slope_arcmin"], angles[k]);
            is(&told["directions"][k]["crowning_um"], others[k]);
        }
        is(&told["bias_um"], others[2]);
        assert!(told["middle_at"].is_null() && words.contains("in the middle 0.000"), "{words}");
    }
    let (told, _) = bent_from_plain("deviation_lines", &even(2, 2));
    assert!((told["turn_deg"].as_f64().unwrap() - 0.0020211086223299).abs() < 2e-9, "{told}");
    assert_eq!(told["known"], 4);
}

/// A list of points has no mean point: both are made to meet at the one half-way along it, which is named.
#[test]
fn the_point_at_which_lists_meet_is_named() {
    let out = folder("deviation_list");
    written(&out, "places.csv", "rho [mm],z [mm]\n44,-15\n46,3\n55,20\n50,-2\n");
    let spec = written(&out, "teeth.chain", &formula("{ points: table(\"places.csv\", rho: length, z: length) }"));
    let of = bent_against_plain(&spec, &out);
    let run = flank(&of);
    assert!(text(&run.stdout).contains("at row 1, column 3 0.000"), "{}{}", text(&run.stdout), text(&run.stderr));
    let told: serde_json::Value = serde_json::from_slice(&flank(&[&of[..], &["--json"]].concat()).stdout).unwrap();
    let place = serde_json::json!({ "row": 1, "column": 3 });
    assert_eq!(told["middle_at"], place);
    // so is the one at which corrected settings leave a surface
    let own = formula("").replace(
        "sample plain, bent ",
        "sample plain { rho: 44 mm .. 55 mm by 5, z: -15 mm .. 20 mm by 5 }
            sample bent { points: table(\"places.csv\", rho: length, z: length) }",
    );
    let spec = written(&out, "kept.chain", &own);
    let of = [
        "fit",
        &spec,
        "plain",
        "--from",
        "plain",
        "--ease-off",
        "slope: 1 profilewise",
        "--vary",
        "t.e",
        "--keep",
        "bent",
    ];
    let run = flank(&of);
    assert!(text(&run.stdout).contains("bent at row 1, column 3"), "{}{}", text(&run.stdout), text(&run.stderr));
    let told: serde_json::Value = serde_json::from_slice(&flank(&[&of[..], &["--json"]].concat()).stdout).unwrap();
    assert_eq!(told["kept"][0]["at"], place);
}

/// Studies and tolerances turn surfaces at the mean point, too: where one polynomial is e and the other nothing, circles about the axis lead from the one
/// to the other, and the way there is 1.76375 e over 50 mm, as an angle.
#[test]
fn studies_and_tolerances_have_the_same_mean_point() {
    let out = folder("deviation_elsewhere");
    let study = out.join("study").display().to_string();
    let spec = written(&out, "teeth.chain", &formula("{ rho: 44 mm .. 55 mm by 6, z: -15 mm .. 20 mm by 8 }"));
    let (turn, way) = ((1.763_75e-3f64 / 50.0).to_degrees(), 49.5 * 1.763_75e-3 / 50.0);
    let collect = ["--collect", "ease_off:bent,width:bent,plain", "--out", &study];
    let run = flank(&[&["sweep", &spec, "--vary", "u.e=0..1e-3 by 2"][..], &collect].concat());
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let rows = support::studies::rows(&study);
    let last = |row: usize, k: usize| rows[row][rows[row].len() - k].parse::<f64>().expect("a number");
    // surfaces are solved to 1e-9 mm: the turn of the ease-off without e, the turn and the way of the width with it
    assert!((last(0, 3) + turn).abs() < 2e-9 && (last(1, 2) - turn).abs() < 2e-9, "{rows:?}");
    assert!((last(1, 1) - way).abs() < 2e-9, "{rows:?}");
    let run = flank(&["tolerance", &spec, "bent", "--json", "--scatter", "u.e=1e-6"]);
    let told: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    let results = told["results"].as_array().expect("results");
    let position = results.iter().find(|of| of["name"] == "position").expect("a position");
    // of a thousandth, in um
    assert!((position["standard_deviation"].as_f64().expect("a number") / way - 1.0).abs() < 1e-9, "{position}");
}
