//! CSV: what is written is what was given, to the bit, and nothing else.

mod synthetic;

use flank_export::{Dataset, Malformed, Patch, Point, Unit, Unknown, Values, WriteError, write_csv};
use synthetic::{Gear, bevel, dataset, holes, plane, undercut, with_fields, without};

const SPUR: Gear = Gear { helix: 0.0, width: 20.0 };

fn text_of(dataset: &Dataset) -> String {
    let mut bytes = Vec::new();
    write_csv(&dataset.surfaces(), &mut bytes).expect("a sound dataset");
    String::from_utf8(bytes).expect("text")
}

/// Column titles and records, read by the `csv` crate with comments skipped.
fn read(text: &str) -> (Vec<String>, Vec<csv::StringRecord>) {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
    let titles = reader.headers().expect("titles").iter().map(str::to_owned).collect();
    (titles, reader.records().map(|record| record.expect("a record as long as the head")).collect())
}

#[test]
fn numbers_come_back_to_the_bit() {
    let patch = Gear { helix: 0.3, width: 30.0 }.flank("flank", [7, 5]);
    let (titles, records) = read(&text_of(&dataset("job", vec![patch.clone()])));
    assert_eq!(titles.join(","), "surface,i,j,x,y,z,nx,ny,nz,phi,s,residual,status");
    assert_eq!(records.len(), 35);
    for (at, (record, point)) in records.iter().zip(&patch.points).enumerate() {
        assert_eq!(&record[1], (at / 5).to_string());
        assert_eq!(&record[2], (at % 5).to_string());
        let given = point.position.iter().chain(&point.normal).copied();
        let given = given.chain([point.unknowns[0].to_degrees(), point.unknowns[1], point.residual]);
        for (cell, number) in record.iter().skip(3).zip(given) {
            // Adding zero turns a negative zero positive and changes nothing else.
            assert_eq!(cell.parse::<f64>().unwrap().to_bits(), (number + 0.0).to_bits(), "{cell} is not {number}");
        }
        assert_eq!(&record[12], "solved");
    }
}

#[test]
fn an_unsolved_point_has_a_status_and_no_number() {
    let mut patch = without(SPUR.flank("flank", [25, 15]), holes);
    // Numbers of a point that failed are not to be trusted, and not to be written.
    patch.points[0].position = [1.0, 2.0, 3.0];
    patch.points[0].unknowns = vec![4.0];
    let (_, records) = read(&text_of(&dataset("job", vec![patch.clone()])));
    let told = "out_of_range, as the test wants it";
    assert_eq!(
        &records[0].iter().collect::<Vec<_>>()[3..],
        ["", "", "", "", "", "", "", "", "0.25", "out_of_range", told]
    );
    assert_eq!(&records[12 * 15 + 7][12], "singular");
    let empty = records.iter().filter(|record| record[3].is_empty()).count();
    assert_eq!(empty, patch.points.iter().filter(|point| !point.is_solved()).count());
}

/// They lie on the generated surface; what is known of solved points only is not theirs.
#[test]
fn points_that_are_cut_away_have_all_their_numbers() {
    let patch = undercut(with_fields(SPUR.flank("flank", [4, 3])), 1..3);
    let (_, records) = read(&text_of(&dataset("job", vec![patch.clone()])));
    for (record, point) in records.iter().zip(&patch.points) {
        assert_eq!(&record[12], point.outcome.word());
        assert_eq!(record[3].parse::<f64>(), Ok(point.position[0]));
        assert_eq!(record[10].parse::<f64>(), Ok(point.unknowns[1]));
        assert_eq!(record[17].is_empty(), !point.is_solved(), "{record:?}");
    }
    assert_eq!(records.iter().filter(|record| &record[12] == "undercut").count(), 5);
    assert_eq!(&records[3][12], "undecided");
}

#[test]
fn the_head_states_the_conventions() {
    let patch = without(SPUR.flank("right flank", [25, 15]), holes);
    let text = text_of(&dataset("gear", vec![patch, bevel([3, 2])]));
    let head: Vec<&str> = text.lines().take_while(|line| line.starts_with('#')).collect();
    for wanted in [
        "# flank 0.1.0",
        "# spec: specs/jobs/synthetic.flank, hash 9f2c1e7a55d0b3c4",
        "# job: gear",
        "lengths in mm, angles in degrees",
        "a normal points out of the body that owns the surface",
        "# the datum face is at z = -10",
        "# unknown `phi` in deg",
        "# unknown `s` in mm",
        "# surface `right flank`: frame m.table; 25 rows i: z; 15 columns j: root -> tip; solved 343 of 375 asked \
         (not_converged 6, out_of_range 25, singular 1), worst residual 1.1e-14",
        "# all surfaces: solved 349 of 381 asked",
    ] {
        assert!(head.iter().any(|line| line.contains(wanted)), "no `{wanted}` in\n{}", head.join("\n"));
    }
}

#[test]
fn unknowns_are_united_and_told_apart() {
    let with = |name: &str, unknowns: &[(&str, Unit)]| {
        let mut patch = plane([1, 1], [0.0; 3], 1.0);
        patch.name = name.into();
        patch.unknowns = unknowns.iter().map(|&(name, unit)| Unknown { name: name.into(), unit }).collect();
        patch.points[0].unknowns = (1..=unknowns.len()).map(|k| k as f64).collect();
        patch
    };
    let first = with("first", &[("u", Unit::Millimetre), ("x", Unit::One)]);
    let second = with("second", &[("u", Unit::One), ("v", Unit::One)]);
    let (titles, records) = read(&text_of(&dataset("job", vec![first, second])));
    assert_eq!(titles[9..], ["u [mm]", "x [1]", "u [1]", "v", "residual", "status"]);
    assert_eq!(records[0].iter().collect::<Vec<_>>()[9..13], ["1", "2", "", ""]);
    assert_eq!(records[1].iter().collect::<Vec<_>>()[9..13], ["", "", "1", "2"]);
}

#[test]
fn fields_follow_the_status() {
    let first = with_fields(without(bevel([3, 2]), |i, _| (i == 2).then_some("out_of_range")));
    let mut second = with_fields(plane([1, 1], [0.0; 3], 1.0));
    // the unit of another field of that name, and the name of an unknown
    second.fields[0].unit = "1/um".into();
    second.fields[1].name = "phi".into();
    second.fields[1].values = Values::Scalars([Some(0.5)].into());
    let text = text_of(&dataset("job", vec![first, second]));
    let (titles, records) = read(&text);
    let last = ["d1_x", "d1_y", "d1_z", "k1 [1/um]", "phi [1]"];
    assert_eq!(titles[9..14], ["phi [deg]", "s", "residual", "status", "reason"]);
    assert_eq!(titles[14..], [&["k1 [1/mm]"], &last[..]].concat());
    let cells = |at: usize| records[at].iter().skip(14).collect::<Vec<_>>();
    assert_eq!(cells(0), ["", "0", "0", "0", "", ""]);
    assert_eq!(cells(3), ["3", "0", "0", "3", "", ""]);
    assert_eq!(cells(4), ["", "", "", "", "", ""]);
    assert_eq!(cells(6), ["", "", "", "", "", "0.5"]);
    assert!(text.contains("\n# field `d1` in 1: d1 of the tests\n"));
}

#[test]
fn names_cannot_break_the_file() {
    let mut patch = plane([2, 1], [0.0; 3], 1.0);
    patch.name = "#1, \"left\"\nflank".into();
    patch.rows.label = "z\nj,k".into();
    let name = patch.name.clone();
    let (_, records) = read(&text_of(&dataset("two\nlines", vec![patch])));
    assert_eq!(records.len(), 2);
    assert_eq!(records[1][0], name);
}

#[test]
fn nothing_asked_for_is_a_head_and_titles() {
    let (titles, records) = read(&text_of(&dataset("job", Vec::new())));
    assert_eq!((titles.len(), records.len()), (11, 0));
}

#[test]
fn a_dataset_that_contradicts_itself_is_refused() {
    let refusal = |patch: Patch| match write_csv(&dataset("job", vec![patch]).surfaces(), &mut Vec::new()) {
        Err(WriteError::Malformed(fault)) => fault,
        other => panic!("{other:?}"),
    };
    let sound = || SPUR.flank("flank", [3, 2]);
    let mut short = sound();
    short.points.pop();
    assert_eq!(refusal(short).to_string(), "surface `flank` has 5 points, but 3 rows of 2");
    let mut poor = sound();
    poor.points[3].unknowns.pop();
    assert_eq!(refusal(poor).to_string(), "surface `flank`, point (1, 1): 1 values for 2 unknowns");
    let mut invented = sound();
    invented.points[4] =
        Point { outcome: flank_export::Outcome::Solved, ..Point::unsolved("out_of_range", f64::NAN, String::new()) };
    assert!(matches!(refusal(invented), Malformed::UnknownCount { .. }));
    let mut endless = sound();
    endless.points[4].normal[1] = f64::INFINITY;
    assert_eq!(refusal(endless), Malformed::NotANumber { surface: "flank".into(), i: 2, j: 0 });
    let mut partial = with_fields(sound());
    partial.fields[1].values = Values::Vectors([None; 5].into());
    assert_eq!(refusal(partial).to_string(), "surface `flank`, field `d1`: 5 values for 6 points");
    let mut infinite = with_fields(sound());
    infinite.fields[0].values = Values::Scalars([Some(f64::INFINITY); 6].into());
    assert_eq!(refusal(infinite), Malformed::NotANumber { surface: "flank".into(), i: 0, j: 0 });
    let mut huge = sound();
    huge.rows.count = usize::MAX;
    assert!(matches!(refusal(huge), Malformed::PointCount { .. }));
}

#[test]
fn same_input_same_bytes() {
    for (name, dataset) in synthetic::gallery() {
        assert_eq!(text_of(&dataset), text_of(&dataset.clone()), "{name}");
    }
}
