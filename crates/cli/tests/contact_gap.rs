//! The error of pairs of which a pitch is not known whole: the range of the roll ends, or no pair of teeth touches.

mod support;

use serde_json::Value;
use support::{flank, folder, text, written};

/// Two balls on shafts 50 mm apart, their centres 25 mm from their axes: they touch where the centres are as far apart as their radii together. `job` is
/// the rest of the job.
fn balls(job: &str) -> String {
    format!(
        "machine shafts {{
            param shaft_angle : angle = 30 deg
            axis first  : rotary
            axis second : rotary
            frame bed
            frame first  in bed = rotate_z(first)
            frame second in bed = translate_x(50 mm) rotate_x(shaft_angle) rotate_z(second)
        }}
        machine bench {{ axis lift : linear frame table frame part in table = translate_z(lift) fix lift = 0 mm }}
        tool ball {{
            param r : length = 3 mm
            surface face(u: angle in -80 deg .. 80 deg, v: angle in -80 deg .. 80 deg) {{
                let n = [sin(u) * cos(v), cos(u) * cos(v), sin(v)]
                at = [25 mm, 0 mm, 0 mm] + r * n
                body towards -n
            }}
        }}
        job balls {{
            param ratio : number = 1
            param span : angle = 25 deg
            machine b = bench
            tool p = ball
            tool q = ball(r: 4 mm)
            mount p, q on b.part
            surface left, right in b.table = move(p.face, q.face)
            sample left, right {{ u: -60 deg .. 60 deg by 13, v: -60 deg .. 60 deg by 13 }}
            machine m = shafts
            mount left on m.first
            mount right on m.second
            motion turn : angle in -span .. span
            drive m.first = turn
            drive m.second = 164 deg - ratio * turn + lag
            {job}
        }}"
    )
}

fn document(arguments: &[&str], code: i32) -> Value {
    let run = flank(&[&["contact"], arguments, &["--json", "--no-picture"]].concat());
    assert_eq!(run.status.code(), Some(code), "{}{}", text(&run.stderr), text(&run.stdout));
    serde_json::from_slice(&run.stdout).expect("JSON")
}

/// The lag at which balls of 3 and 4 mm touch, rad: by the distance of their centres, from below.
fn lag(turn: f64, ratio: f64) -> f64 {
    let apart = |lag: f64| {
        let (at, (tilt_sin, tilt_cos)) = (164f64.to_radians() - ratio * turn + lag, 30f64.to_radians().sin_cos());
        let [x, y] = [25.0 * at.cos(), 25.0 * at.sin()];
        let other = [50.0 + x, tilt_cos * y, tilt_sin * y];
        let one = [25.0 * turn.cos(), 25.0 * turn.sin(), 0.0];
        (0..3).map(|k| (one[k] - other[k]).powi(2)).sum::<f64>().sqrt() - 7.0
    };
    let (mut low, mut high) = (-8f64.to_radians(), 8f64.to_radians());
    let sign = apart(low).signum();
    assert!(sign != apart(high).signum(), "{turn}");
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if apart(middle).signum() == sign { low = middle } else { high = middle }
    }
    low
}

/// Where the roll has 6 deg and a pitch 10, the error is that of 6 deg, at any number of positions, and is told as that; nothing that is expected of a
/// pitch holds.
#[test]
fn an_error_of_less_than_a_pitch_is_told_as_that() {
    let out = folder("contact_short_roll");
    let into = out.to_str().expect("a plain path");
    let expected = "expect driving.peak_to_peak in 0.5e-3 rad .. 2.5e-3 rad";
    let job = format!(
        "unknown lag : angle in -8 deg .. 8 deg
        contact driving = left with right, over: turn, for: lag, every: 10 deg
        {expected}"
    );
    let spec = written(&out, "balls.chain", &balls(&job));
    let ratio = 0.866_025_4;
    let set = ["--set", "ratio=0.8660254", "--set", "span=3 deg"];
    let lags: Vec<f64> = (0..=6000).map(|k| lag((f64::from(k) / 1000.0 - 3.0).to_radians(), ratio)).collect();
    let ends = lags.iter().fold([f64::MAX, f64::MIN], |[low, high], lag| [low.min(*lag), high.max(*lag)]);
    for positions in ["7", "60", "600"] {
        let found = document(&[&[spec.as_str(), "--out", into, "--positions", positions], &set[..]].concat(), 0);
        let error = &found["error"];
        let number = |name: &str| error[name].as_f64().expect("a number");
        // an extreme between thousandths of a degree is off by less than 1e-10 rad
        assert!((number("peak_to_peak") - 1e6 * (ends[1] - ends[0])).abs() < 1e-3, "{error} {ends:?}");
        assert!((number("over") - 6.0).abs() < 1e-9 && number("pitch") == 10.0, "{error}");
        let gap = &error["gap"];
        let is_at = |name: &str, at: f64| (gap[name].as_f64().expect("a position") - at).abs() < 1e-9;
        assert!(is_at("from", 3.0) && is_at("to", 7.0) && gap["is_of_roll"] == true, "{gap}");
        assert!(found["remarks"].to_string().contains("roll_too_short"), "{}", found["remarks"]);
    }
    let told = text(&flank(&[&["contact", &spec, "--out", into, "--no-picture"], &set[..]].concat()).stdout);
    assert!(told.contains("urad over 6.000 of a pitch of 10.000 deg"), "{told}");
    assert!(
        told.contains("no pair is known to touch from turn 3.000 to 7.000 deg: the range of the roll ends"),
        "{told}"
    );
    let shorter =
        balls(&job).replace("number = 1\n", "number = 0.8660254\n").replace("span : angle = 25", "span : angle = 3");
    let run = flank(&["test", &written(&out, "shorter.chain", &shorter)]);
    let told = text(&run.stdout) + &text(&run.stderr);
    assert!(!run.status.success(), "{told}");
    assert!(told.contains("ends before a pitch of the error is known"), "{told}");
    // the whole pitch is 10 deg of a roll of 16
    let found = document(&[&spec, "--out", into, "--set", "ratio=0.8660254", "--set", "span=8 deg"], 0);
    let error = &found["error"];
    assert!(error["gap"].is_null() && error["over"] == 10.0, "{error}");
}

/// The pair lies on its tip edges when it leaves, with an angle between the shafts so small that its error grows to the end, and the next pair comes only
/// after. The end and the error there were solved outside of this program, as equations of two circles on balls; they do not depend on the positions.
#[test]
fn a_stretch_without_a_contact_is_told_and_its_ends_are_solved() {
    let out = folder("contact_stretch");
    let into = out.to_str().expect("a plain path");
    let blank = |name: &str, tip: &str| {
        format!(
            "profile {name} {{
                tip   = line(from: [2 mm, {tip}], to: [-2 mm, {tip}])
                lower = line(from: [-2 mm, {tip}], to: [-2 mm, 20 mm])
                hub   = line(from: [-2 mm, 20 mm], to: [2 mm, 20 mm])
                upper = line(from: [2 mm, 20 mm], to: [2 mm, {tip}])
            }}"
        )
    };
    let job = format!(
        "{}
        {}
        solid one in b.table = turned(blank1, spaces: 18, of: [left])
        solid two in b.table = turned(blank2, spaces: 18, of: [right])
        unknown lag : angle in -5 deg .. 5 deg
        contact driving = left with right, over: turn, for: lag",
        blank("blank1", "25.6 mm"),
        blank("blank2", "25 mm")
    );
    let spec = written(
        &out,
        "balls.chain",
        &balls(&job).replace("shaft_angle : angle = 30 deg", "shaft_angle : angle = 5 deg"),
    );
    for positions in ["12", "60", "500"] {
        let found = document(&[&spec, "--out", into, "--positions", positions], 3);
        let error = &found["error"];
        let number = |of: &Value| of.as_f64().expect("a number");
        // the table has seven digits of the position and six of the height
        assert!((number(&error["gap"]["from"]) - 3.662_174_2).abs() < 1e-7, "{positions} {error}");
        assert!((number(&error["peak_to_peak"]) - 40015.3).abs() < 0.1, "{positions} {error}");
        // its other end was told in thousandths
        assert!((number(&error["gap"]["to"]) - 4.588).abs() < 1e-3, "{positions} {error}");
        assert_eq!(error["gap"]["is_of_roll"], false, "{error}");
        // one edge carries to where no pair touches any more, and one from where the next pair does
        let edges = found["edges"].as_array().expect("edges");
        for (end, of_gap) in [("to", "from"), ("from", "to")] {
            let is_there = |edge: &Value| (number(&edge[end]) - number(&error["gap"][of_gap])).abs() < 1e-9;
            assert_eq!(edges.iter().filter(|edge| is_there(edge)).count(), 1, "{positions} {end} {:?}", edges);
        }
        let told = found["not_done"].to_string();
        assert!(
            told.contains("no_contact") && told.contains("no pair of teeth touches within the range of `lag`"),
            "{told}"
        );
    }
}
