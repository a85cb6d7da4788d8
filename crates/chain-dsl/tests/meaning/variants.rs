//! Jobs, machines and tools that are others with something changed.

use flank_chain_dsl::{Compilation, compile_text, derivation, render};
use flank_expr::{Graph, Style};

use crate::models::compiled;

#[test]
fn a_machine_in_the_place_of_another_brings_its_own_laws() {
    let text = "
        job first {
            machine m = lathe(height: 4 mm)
            machine n = m
            tool b = ball
            tool d = b
            mount b on m.slide
            mount d on n.slide
            motion turn : angle in 0 deg .. 90 deg
            drive m.C, m.Z, n.Z = turn, 4 mm/rad * turn, 5 mm/rad * turn
            drive n.C = turn
            surface s in m.work = envelope(b.face, over: turn)
            surface t in n.work = envelope(d.face, over: turn)
        }
        job changed = first(m: fixed(height: 4 mm))
        job extending extends first { machine m = fixed(height: 4 mm) }
        job of_one extends first { machine n = geared(height: 4 mm) }
        job free_again extends changed { machine m = lathe(height: 4 mm)  drive m.Z, n.Z = 6 mm, 7 mm }
        job by_a_second_name extends first { machine k = fixed(height: 4 mm)  drive k.C = 1 deg  machine m = k }
        machine fixed extends lathe { fix Z = 3 mm }
        machine geared extends fixed { couple Z = 2 mm/rad * C }";
    let graph = Graph::new();
    let compilation = compiled(&graph, text);
    let laws = |name: &str| {
        let job = compilation.jobs.iter().find(|job| job.name == name).expect("there is such a job");
        let of = |machine: &flank_chain_dsl::Machine<'_>| {
            let axes = machine.axes.iter().map(|axis| format!("{}.{} = {}", machine.name, axis.name, axis.law));
            axes.collect::<Vec<_>>().join(", ")
        };
        job.machines.iter().map(of).collect::<Vec<_>>()
    };
    let fixed = ["m.Z = 3, m.C = turn", "n.Z = 3, n.C = turn"];
    assert_eq!(laws("first"), ["m.Z = 4 * turn, m.C = turn", "n.Z = 5 * turn, n.C = turn"]);
    assert_eq!(laws("changed"), fixed);
    assert_eq!(laws("extending"), fixed);
    assert_eq!(laws("of_one"), ["m.Z = 4 * turn, m.C = turn", "n.Z = 2 * turn, n.C = turn"]);
    assert_eq!(laws("free_again"), ["m.Z = 6, m.C = turn", "n.Z = 7, n.C = turn"]);
    assert_eq!(laws("by_a_second_name")[1..], fixed);
}

/// Two of a kind, the second with one value changed, and a surface sampled twice.
const AGAIN: &str = "
    job j {
        param reach : length = 4 mm
        machine m = lathe(height: reach)
        machine n = m(height: 2 * reach)
        tool a = ball(radius: reach)
        tool b = a
        tool c = b(radius: 6 mm)
        mount a, c on m.slide
        mount b on n.slide
        motion turn : angle in 0 deg .. 90 deg
        drive m.C, m.Z, n.C, n.Z = turn, 0 mm, turn, 1 mm
        surface one, three in m.work = envelope(a.face, c.face, over: turn)
        surface two in n.work = envelope(b.face, over: turn)
        trim one by three
        sample one, one as its_row { turn: [10 deg, 12 deg, 80 deg], u: 1 deg .. 2 deg by 3 }
    }";

#[test]
fn a_machine_or_tool_again_has_the_values_of_the_first_but_for_its_own() {
    let value = |overrides: &[(&str, &str)], name: &str| {
        let graph = Graph::new();
        let set: Vec<_> = overrides.iter().map(|(name, value)| ((*name).to_string(), (*value).to_string())).collect();
        let compilation = compile_text(&graph, "text", &format!("{AGAIN}{}", super::LIBRARY), &set);
        assert!(!compilation.has_errors(), "{:?}", compilation.diagnostics);
        let job = &compilation.jobs[0];
        job.parameters.iter().find(|parameter| parameter.name == name).map(|parameter| parameter.value)
    };
    assert_eq!(value(&[], "b.radius"), Some(4.0));
    assert_eq!(value(&[], "c.radius"), Some(6.0));
    assert_eq!(value(&[], "n.height"), Some(8.0));
    // it follows the first, also where the value comes from outside
    assert_eq!(value(&[("a.radius", "5 mm")], "b.radius"), Some(5.0));
    assert_eq!(value(&[("b.radius", "5 mm")], "a.radius"), Some(4.0));
    assert_eq!(value(&[("a.radius", "5 mm")], "c.radius"), Some(6.0));
}

#[test]
fn a_sample_with_a_name_of_its_own_is_the_surface_once_more() {
    let graph = Graph::new();
    let compilation = compiled(&graph, AGAIN);
    let surfaces = &compilation.jobs[0].surfaces;
    let names: Vec<&str> = surfaces.iter().map(|surface| surface.name.as_str()).collect();
    assert_eq!(names, ["one", "three", "two", "its_row"]);
    assert_eq!((surfaces[3].sample_of, &surfaces[3].trimmed_by), (Some(0), &vec![1]));
    for surface in [&surfaces[0], &surfaces[3]] {
        let sample = surface.sample.as_ref().expect("a sample");
        assert_eq!(sample.counts, [3, 3]);
        let rows: Vec<f64> = (0..3).map(|row| sample.grid.at(row, 0)[0].to_degrees()).collect();
        assert!(rows.iter().zip([10.0, 12.0, 80.0]).all(|(row, wanted)| (row - wanted).abs() < 1e-12), "{rows:?}");
    }
    // its equations are those of the surface, which the derivation has once
    let page = derivation(&compilation.jobs[0], Style::Text);
    assert!(page.contains("one") && !page.contains("its_row"), "{page}");
}

#[test]
fn a_job_may_be_another_one_with_values_and_parts_changed() {
    let text = "
        tool small { param radius : length = 1 mm
            surface face(u: angle in -80 deg .. 80 deg, v: angle in -60 deg .. 60 deg) {
                at = [20 mm - radius * cos(u) * cos(v), radius * cos(u) * sin(v), radius * sin(u)]
                body towards [cos(u) * cos(v), -cos(u) * sin(v), -sin(u)]
            }
        }
        /// The first.
        job crowned {
            param reach : length = 4 mm
            machine m = lathe(height: reach)
            tool b = ball(radius: 3 mm)
            mount b on m.slide
            motion turn : angle in 0 deg .. 90 deg
            drive m.C, m.Z = turn, 0 mm
            surface s in m.work = envelope(b.face, over: turn)
            sample s { turn: 10 deg .. 80 deg by 3, u: 1 deg .. 2 deg by 3 }
        }
        job plain = crowned(reach: 5 mm)
        /// The third.
        job higher = plain(m.height: 2 * reach, b: small(radius: reach / 5))";
    let set = [("plain.b.radius".to_string(), "2 mm".to_string())];
    let graph = Graph::new();
    let compilation = compile_text(&graph, "text", &format!("{text}{}", super::LIBRARY), &set);
    assert!(!compilation.has_errors(), "{:?}", compilation.diagnostics);
    let told = compilation.jobs.iter().map(|job| {
        let values = job.parameters.iter().map(|parameter| format!("{} {}", parameter.name, parameter.value));
        (job.name.as_str(), job.doc.join(" "), values.collect::<Vec<_>>().join(", "))
    });
    let wanted = [
        ("crowned", "The first.", "reach 4, m.height 4, b.radius 3"),
        ("plain", "The first.", "reach 5, m.height 5, b.radius 2"),
        ("higher", "The third.", "reach 5, m.height 10, b.radius 1"),
    ];
    let wanted = wanted.map(|(name, doc, values)| (name, doc.to_string(), values.to_string()));
    assert_eq!(told.collect::<Vec<_>>(), wanted);
    assert!(compilation.jobs.iter().all(|job| job.surfaces[0].sample.is_some()));
}

/// A job that extends another one is the job written out: what it says again takes the place of what was said, also of one axis or surface
/// of several.
#[test]
fn a_job_that_extends_another_is_the_job_written_out() {
    let first = "
        job first {
            param reach : length = 4 mm
            let height = reach / 2
            machine m = lathe(height: height)
            tool b = ball(radius: 3 mm)
            mount b on m.slide
            motion turn : angle in 0 deg .. 90 deg
            drive m.C, m.Z = turn, 0 mm
            surface s, t in m.work = envelope(b.face, b.face, over: turn)
            sample s, t { turn: 10 deg .. 80 deg by 3, u: 1 deg .. 2 deg by 3 }
        }";
    let made = "
        /// The second.
        job second extends first(reach: 5 mm) {
            param lead : length / angle = 3 mm/rev
            let height = reach + lead * 1 rev
            drive m.Z = lead * turn
            tool c = b(radius: 2 mm)
            mount c on m.slide
            surface t in m.work = envelope(c.face, over: turn)
            sample t { turn: 20 deg .. 80 deg by 4, u: 1 deg .. 2 deg by 3 }
            sample t as middle { turn: 20 deg .. 80 deg by 4, u: 0 deg }
        }";
    let written = "
        /// The second.
        job second {
            param reach : length = 5 mm
            param lead : length / angle = 3 mm/rev
            let height = reach + lead * 1 rev
            machine m = lathe(height: height)
            tool b = ball(radius: 3 mm)
            mount b on m.slide
            motion turn : angle in 0 deg .. 90 deg
            drive m.C, m.Z = turn, lead * turn
            tool c = ball(radius: 2 mm)
            mount c on m.slide
            surface s in m.work = envelope(b.face, over: turn)
            surface t in m.work = envelope(c.face, over: turn)
            sample s { turn: 10 deg .. 80 deg by 3, u: 1 deg .. 2 deg by 3 }
            sample t { turn: 20 deg .. 80 deg by 4, u: 1 deg .. 2 deg by 3 }
            sample t as middle { turn: 20 deg .. 80 deg by 4, u: 0 deg }
        }";
    let graphs = [Graph::new(), Graph::new()];
    let made = compiled(&graphs[0], &format!("{first}{made}"));
    let written = compiled(&graphs[1], written);
    let told = |compilation: &Compilation<'_>| {
        let job = compilation.jobs.last().expect("a job");
        let samples = job.surfaces.iter().map(|of| format!("{} {:?}", of.name, of.sample.as_ref().map(|it| &it.grid)));
        (derivation(job, Style::Text), job.doc.clone(), samples.collect::<Vec<_>>())
    };
    assert_eq!(told(&made), told(&written));
    // what only an extension uses of its own is not unused
    assert!(made.diagnostics.is_empty(), "{}", render(&made.diagnostics, &made.sources, false));
}
