//! `flank fit`: settings that are almost zero.

mod support;

use serde_json::Value;
use support::{flank, folder, text, written};

/// A planed gear whose rack is crowned along the tooth by a curvature, and leans by a plain number.
const GEAR: &str = "machine planer {
    axis Y : linear
    axis C : rotary
    frame bed
    frame ram   in bed = translate(36 mm, Y, 0 mm)
    frame table in bed = rotate_z(C)
}

tool rack {
    param pressure_angle : angle = 20 deg
    param crown : number / length
    param lean : number
    surface flank(u: length in -3.5 mm .. 3.5 mm, v: length in -11 mm .. 11 mm) {
        let push = crown * v^2 + lean * v
        at = [
            u * cos(pressure_angle) + push * sin(pressure_angle),
            push * cos(pressure_angle) - u * sin(pressure_angle),
            v
        ]
        body towards [0, 1, 0]
    }
}

job gear {
    machine m = planer
    tool    r = rack(crown: 1e-6 / 1 mm, lean: 1e-5)
    mount r on m.ram
    motion roll : angle in -30 deg .. 30 deg
    drive m.Y = 36 mm * roll
    drive m.C = roll
    surface flank in m.table = envelope(r.flank, over: roll)
    sample flank { rho: 34.5 mm .. 37.5 mm by 5, z: -9 mm .. 9 mm by 9 }
}
";

/// A share of such a value moves nothing that could be measured, another value does: without a name they were no candidates.
#[test]
fn settings_that_are_almost_zero_are_candidates() {
    let folder = folder("fit_small");
    let spec = written(&folder, "gear.chain", GEAR);
    let out = folder.to_str().expect("a plain path");
    for (setting, value, wanted) in [("r.crown", "3e-4 / 1 mm", 3e-4), ("r.lean", "1e-3", 1e-3)] {
        let set = format!("{setting}={value}");
        let measure = ["measure", &spec, "--surface", "flank", "--margin", "0", "--out", out, "--set", &set];
        assert_eq!(flank(&measure).status.code(), Some(0));
        let file = folder.join("gear.grid.csv");
        let run = flank(&[
            "fit",
            &spec,
            "flank",
            "--measured",
            file.to_str().expect("a plain path"),
            "--margin",
            "0",
            "--json",
        ]);
        assert_eq!(run.status.code(), Some(0), "{setting}: {}", text(&run.stderr));
        let told: Value = serde_json::from_slice(&run.stdout).expect("JSON");
        let settings = told["identification"]["settings"].as_array().expect("settings");
        assert_eq!(settings.len(), 1, "{setting}: {settings:?}");
        assert_eq!(settings[0]["name"], setting);
        let found = settings[0]["new"].as_f64().expect("a value");
        assert!((found - wanted).abs() < 1e-9 * wanted.max(1e-3), "{setting}: {found}");
    }
}
