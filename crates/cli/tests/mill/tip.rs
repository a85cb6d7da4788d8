//! Tool-centre control: between positions the tip goes straight and the rotary axes turn evenly, which chord and clearances are held for.

use std::path::Path;

use super::support::{folder, self_contained, written};
use super::{json, mill, text_of};

const RADIUS: f64 = 4.0;
const REACH: f64 = 60.0;
const HOLDER: [f64; 2] = [20.0, 40.0];

/// A ball on a machine with A and C in its table; the face looks along x, the top along z, and a stop stands against x beside the holder.
pub(super) fn job(milling: &str) -> String {
    let library = self_contained(&["machines/five_axis_table_table", "tools/end_mills"]);
    format!(
        "{library}
machine bench {{
    axis lift : linear
    frame table
    frame part in table = translate_z(lift)
    fix lift = 0 mm
}}
tool block {{
    surface face(u: length in -20 mm .. 20 mm, v: length in -20 mm .. 20 mm) {{
        at = [0 mm, u, v]
        body towards [1, 0, 0]
    }}
    surface top(u: length in -20 mm .. 20 mm, v: length in -20 mm .. 20 mm) {{
        at = [v, u, 0 mm]
        body towards [0, 0, -1]
    }}
    surface stop(u: length in -15 mm .. 15 mm, v: length in 80 mm .. 103 mm) {{
        at = [{STOP} mm, u, v]
        body towards [1, 0, 0]
    }}
}}
job milled {{
    machine b = bench
    tool w = block
    mount w on b.part
    surface face, top, stop in b.table = move(w.face, w.top, w.stop)
    sample face, top {{ u: -15 mm .. 15 mm by 9, v: -1 mm .. 1 mm by 3 }}
    sample stop {{ u: -15 mm .. 15 mm by 9, v: 80 mm .. 103 mm by 9 }}
    machine mill = five_axis_table_table(work_z: 60 mm)
    tool ball = ball_mill(radius: {RADIUS} mm, reach: {REACH} mm, holder_radius: {} mm, holder_length: {} mm)
    mount ball on mill.cutter
    mill part of {milling}
    }}
}}
",
        HOLDER[0], HOLDER[1]
    )
}

const STOP: f64 = 36.5;

/// Tip and axis of the cutter all along the blocks of a plan: tip and rotary axes go evenly from position to position.
fn along_blocks(csv: &Path) -> Vec<[[f64; 3]; 2]> {
    const SHARES: usize = 1000;
    let text = text_of(csv);
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let titles: Vec<&str> = lines.next().expect("titles").split(',').collect();
    let column = |name: &str| titles.iter().position(|title| *title == name).expect("a column");
    let columns = ["pass", "tip_x", "tip_y", "tip_z", "A_deg", "C_deg"].map(column);
    let rows: Vec<[f64; 6]> = lines
        .map(|line| {
            let row: Vec<f64> = line.split(',').map(|number| number.parse().expect("a number")).collect();
            columns.map(|k| row[k])
        })
        .collect();
    let blocks = rows.windows(2).filter(|pair| pair[0][0] == pair[1][0]);
    let at = |pair: &[[f64; 6]], share: f64| {
        let [_, x, y, z, a, c] = [0, 1, 2, 3, 4, 5].map(|k| pair[0][k] + share * (pair[1][k] - pair[0][k]));
        let ([a, a_cos], [c, c_cos]) =
            ([a.to_radians().sin(), a.to_radians().cos()], [c.to_radians().sin(), c.to_radians().cos()]);
        [[x, y, z], [c * a, c_cos * a, a_cos]]
    };
    blocks.flat_map(|pair| (0..=SHARES).map(move |k| at(pair, k as f64 / SHARES as f64))).collect()
}

/// A ball that leans along a flat face leaves what its centre goes beside the line: over a block of evenly turning axes fifteen times what it
/// would where its axis went on a great circle.
#[test]
fn blocks_leave_what_evenly_turning_axes_leave() {
    let out = folder("mill_tip_chord");
    let milling = |blocks: &str| {
        job(&format!(
            "face with ball.cutting in mill.work {{\n passes v: -1 mm .. 1 mm, step 0.5 mm\n along u: -15 mm .. 15 mm{blocks}\n \
             lead 10 deg * u / 15 mm\n tilt 75 deg"
        ))
    };
    for (blocks, chord) in [(" by 17", f64::INFINITY), (", chord 0.5 um", 0.5)] {
        let found = json(&written(&out, "milled.chain", &milling(blocks)), &out, &["--tcp"]);
        let [told, deep] = [0, 1].map(|k| found["blocks"][k]["height_um"].as_f64().expect("a height"));
        let off = along_blocks(&out.join("milled.part.csv"))
            .into_iter()
            .map(|[tip, axis]| -tip[0] - RADIUS * (1.0 + axis[0]));
        let left = 1e3 * off.fold(0.0, f64::max);
        assert!(left <= chord, "{blocks}: {left}");
        // beside its line the ball goes by 6 um at the most, where it is 0.005 um higher
        assert!(left > 0.2 && (told - left).abs() < 0.005 && deep > -1e-6, "{blocks}: {told} {deep}, {left}");
    }
}

/// No pass leaves more than the chord error: also where those that are looked at first lean less.
#[test]
fn no_pass_leaves_more_than_the_chord_error() {
    let out = folder("mill_tip_passes");
    let spec = job(
        "face with ball.cutting in mill.work {\n passes v: -1 mm .. 1 mm, step 0.1 mm\n along u: -15 mm .. 15 mm, chord 0.5 um\n \
                    lead 10 deg * (u / 15 mm) * (1 + 0.5 * sin(360 deg * v / 1 mm))\n tilt 75 deg",
    );
    let found = json(&written(&out, "milled.chain", &spec), &out, &["--tcp"]);
    let told = found["blocks"][0]["height_um"].as_f64().expect("a height");
    let off =
        along_blocks(&out.join("milled.part.csv")).into_iter().map(|[tip, axis]| -tip[0] - RADIUS * (1.0 + axis[0]));
    let left = 1e3 * off.fold(0.0, f64::max);
    assert!(left <= 0.5 && told <= 0.5 && (told - left).abs() < 0.005, "{told} {left}");
}

/// Its holder swings nearer to a stop between the positions than at them: a clearance is proven up to where it comes, and not beyond.
#[test]
fn clearances_are_proven_while_axes_turn_evenly() {
    let out = folder("mill_tip_clear");
    let clear = |by: f64| {
        job(&format!(
            "top with ball.cutting in mill.work {{\n passes v: -1 mm .. 1 mm, step 0.5 mm\n along u: -15 mm .. 15 mm by 6\n \
             lead 20 deg * u / 15 mm\n tilt 8 deg\n clear of stop by {by} mm with ball.whole"
        ))
    };
    let at_positions = json(&written(&out, "milled.chain", &clear(0.1)), &out, &["--tcp"]);
    let at_positions = at_positions["clearances"][0]["least"].as_f64().expect("a distance");
    // the rim of each end of the holder
    let rims = along_blocks(&out.join("milled.part.csv")).into_iter().flat_map(|[tip, axis]| {
        [REACH, REACH + HOLDER[1]].map(|up| STOP - tip[0] - up * axis[0] - HOLDER[0] * (1.0 - axis[0].powi(2)).sqrt())
    });
    let least = rims.fold(f64::INFINITY, f64::min);
    assert!(least > 0.1 && least < at_positions - 0.1, "{least} {at_positions}");
    // 1 um is allowed; proofs with 10 um to spare need few boxes
    let certified = |by: f64| mill(&written(&out, "milled.chain", &clear(by)), &out, &["--tcp", "--certify=1um"]);
    let (code, told, errors) = certified(least - 0.009);
    assert!(code == 0 && told.contains("proven to be nowhere nearer than"), "{told}{errors}");
    let (code, _, errors) = certified(least + 0.011);
    assert!(code == 3 && errors.contains("it is not proven that ball.whole comes nowhere nearer"), "{errors}");
}
