//! The binary and its files, for all tests of it.
#![allow(dead_code, unreachable_pub)] // each test file uses its own part of it

pub mod grids;
pub mod studies;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

pub fn top() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

pub fn flank(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_flank")).args(arguments).current_dir(top()).output().expect("the binary runs")
}

/// A folder of its own for each test, empty.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder for the test");
    folder
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

pub fn written(folder: &Path, name: &str, content: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, content).expect("the test's file");
    path.to_str().expect("a plain path").to_string()
}

/// What a command must not read to its end, with what is said of it: a device, a pipe that nobody writes to, a file beyond 256 MiB.
#[cfg(unix)]
pub fn endless(folder: &Path) -> [(String, &'static str); 3] {
    let pipe = folder.join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo runs").success());
    let large = folder.join("large");
    // holes, of which the disk holds nothing
    std::fs::File::create(&large).and_then(|file| file.set_len((256 << 20) + 1)).expect("the test's file");
    [
        (
            "/dev/zero".to_string(),
            "it is not a plain file: what comes from a pipe or a device may never end; save it to a file first",
        ),
        (pipe.to_str().expect("a plain path").to_string(), "it is not a plain file"),
        (large.to_str().expect("a plain path").to_string(), "it has more than"),
    ]
}

/// Specs of the library as one file that uses no other.
pub fn self_contained(specs: &[&str]) -> String {
    let read = |name: &&str| std::fs::read_to_string(top().join(format!("specs/{name}.chain"))).expect("it is shipped");
    let all: String = specs.iter().map(read).collect();
    let needs_files = |line: &str| line.contains(" near table(") || line.trim_start().starts_with("expect on ");
    all.lines().filter(|line| !line.starts_with("use ") && !needs_files(line)).map(|line| format!("{line}\n")).collect()
}

/// A second tool and a second machine with one other setting each, and a tool under a second name.
pub const AGAIN: &str = "machine planer {
    param shift : length = 0 mm
    param bias : length = 0 mm
    axis C : rotary
    axis Y : linear
    frame bed
    frame ram   in bed = translate(30 mm + shift, Y + bias, 0 mm)
    frame table in bed = rotate_z(C)
}
tool rack {
    param tilt : angle = 20 deg
    param helix : angle = 15 deg
    param crown : number = 0.1 * sin(tilt)
    surface plus(u: length in -3 mm .. 3 mm, v: length in -20 mm .. 20 mm) {
        at = [u * cos(tilt), -u * sin(tilt) + v * sin(helix) + crown * u^2 / 10 mm, v * cos(helix)]
        body towards [0, 1, 0]
    }
}
job gear {
    machine m = planer
    machine n = m(bias: 1 mm)
    tool r = rack
    tool r2 = r(tilt: 25 deg)
    tool r3 = r
    mount r, r2 on m.ram
    mount r3 on n.ram
    motion roll : angle in -60 deg .. 60 deg
    drive m.Y, m.C = 30 mm * roll, roll
    drive n.Y, n.C = 30 mm * roll, roll
    surface one in m.table = envelope(r.plus, over: roll)
    surface two in m.table = envelope(r2.plus, over: roll)
    surface three in n.table = envelope(r3.plus, over: roll)
    sample one, two, three { rho: 29.7 mm .. 31 mm by 5, z: -3 mm .. 3 mm by 5 }
    expect all solved
}
";

/// The pinion of the library as a REXS file; `COEFFICIENTS` and further tools are put in by the tests.
pub const REXS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<model version="1.4" applicationId="test" date="2026-01-01T00:00:00+01:00">
  <components>
    <component id="12" type="bevel_gear_manufacturing_settings" name="pinion">
      <attribute id="radial_distance" unit="mm">97.95940290780507</attribute>
      <attribute id="center_roll_position" unit="deg">52.79674678267486</attribute>
      <attribute id="cutter_tilt" unit="deg">2.5</attribute>
      <attribute id="machine_root_angle" unit="deg">15.64096727073747</attribute>
      <attribute id="machine_center_to_crossing_point" unit="mm">-0.001306176586991889</attribute>
      <attribute id="ratio_of_roll" unit="none">3.339685914944047</attribute>
      <attribute id="helical_motion_coefficients" unit="none"><array><c>1.2</c><c>-1.5</c></array></attribute>
    </component>
    <component id="21" type="bevel_gear_tool" name="outside">
      <attribute id="blade_point_radius" unit="mm">95.9517390193892</attribute>
      <attribute id="blade_pressure_angle" unit="deg">20.0</attribute>
      <attribute id="blade_spheric_radius" unit="mm">2000000</attribute>
      <attribute id="tool_edge_radius_bevel_gear_tool" unit="mm">0.20845</attribute>
    </component>
  </components>
</model>
"#;
