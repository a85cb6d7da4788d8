//! Points that are cut away lie on the surface that the tool generates: tables say where, pictures and meshes leave them out.

mod support;

use support::{flank, folder, text};

/// Radius of the point that a rack's straight flank generates at `u`, be it cut away: it lies on the line of action, as far from
/// where that touches the base circle as `u` is from its limit, times cot α.
fn radius_at(u: f64) -> f64 {
    let (reference, alpha) = (25.0, 20f64.to_radians());
    let limit = reference * alpha.sin().powi(2) / alpha.cos();
    (reference * alpha.cos()).hypot((limit - u) / alpha.tan())
}

/// The flank of ten teeth, cut by its own tool beyond the base circle and trimmed by its fillet before: the involute goes on through
/// all of it.
#[test]
fn tables_give_the_whole_envelope() {
    let out = folder("cut_away");
    let formats = ["--format", "csv,json,stl,vtp", "--limits"];
    let run = flank(
        &[&["solve", "specs/hobbing/undercut_gear.chain", "--out", out.to_str().expect("a plain path")], &formats[..]]
            .concat(),
    );
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
    let csv = std::fs::read_to_string(out.join("undercut_gear.csv")).expect("written");
    let rows: Vec<Vec<&str>> =
        csv.lines().filter(|row| !row.starts_with('#')).map(|row| row.split(',').collect()).collect();
    let column = |name: &str| rows[0].iter().position(|title| *title == name).expect("a column");
    let number = |row: &[&str], name: &str| -> f64 { row[column(name)].parse().expect(name) };
    let flank = |row: &&Vec<&str>| row[0] == "flank_plus";
    let mut by_what = std::collections::BTreeSet::new();
    for row in rows.iter().filter(flank) {
        let off = number(row, "x").hypot(number(row, "y")) - radius_at(number(row, "u"));
        assert!(off.abs() < 1e-9, "{row:?}: {off:e}");
        let normal = ["nx", "ny", "nz"].map(|name| number(row, name).powi(2));
        assert!((normal.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{row:?}");
        assert!(number(row, "phi").is_finite());
        by_what.insert((row[column("status")], row[column("reason")]));
    }
    let words: Vec<&str> = by_what.iter().map(|(status, _)| *status).collect();
    assert_eq!(words, ["solved", "trimmed", "undercut"], "{by_what:?}: by the tool and by the fillet");

    let json = std::fs::read(out.join("undercut_gear.json")).expect("written");
    let json: serde_json::Value = serde_json::from_slice(&json).expect("JSON");
    let points = json["surfaces"][0]["points"].as_array().expect("points");
    assert_eq!(points.len(), 287);
    for (point, row) in points.iter().zip(rows.iter().filter(flank)) {
        let position: Vec<f64> = ["x", "y", "z"].map(|name| number(row, name)).to_vec();
        assert_eq!(point["position"], serde_json::json!(position), "{point}");
        assert_eq!(point["unknowns"].as_array().map(Vec::len), Some(3), "{point}");
    }

    // the table on the screen, and triangles: of solved points only
    let least = rows.iter().filter(flank).filter(|row| row[column("status")] == "solved");
    let least = least.map(|row| number(row, "x").hypot(number(row, "y"))).fold(f64::MAX, f64::min);
    let table = text(&run.stdout);
    assert!(table.contains(&format!("rho {least:.4} ..")), "{least} in\n{table}");
    // where flank and fillet meet, for ten teeth of 3 mm
    assert!(least > 14.176_806 * 5.0 / 3.0, "{least}");
    let stl = std::fs::read(out.join("undercut_gear.stl")).expect("written");
    let least_in_mesh = stl[84..]
        .chunks_exact(50)
        .flat_map(|triangle| triangle[12..48].chunks_exact(12).map(<[u8]>::to_vec).collect::<Vec<_>>())
        .map(|corner| {
            let at = |k: usize| f32::from_le_bytes([corner[k], corner[k + 1], corner[k + 2], corner[k + 3]]);
            at(0).hypot(at(4))
        })
        .fold(f32::MAX, f32::min);
    let solved_of_all =
        rows.iter().skip(1).filter(|row| row[column("status")] == "solved" && row[0].find('.').is_none());
    let least_of_all = solved_of_all.map(|row| number(row, "x").hypot(number(row, "y"))).fold(f64::MAX, f64::min);
    assert!((f64::from(least_in_mesh) - least_of_all).abs() < 1e-4, "{least_in_mesh} against {least_of_all}");
}
