//! Models that texts make: inheritance, coupled axes, poses between frames, envelopes of envelopes.

use flank_chain_dsl::{Code, Compilation, GeneratedSurface, compile_text, derivation, render};
use flank_expr::{Graph, Style};

use crate::errors;

pub(crate) fn compiled<'g>(graph: &'g Graph, text: &str) -> Compilation<'g> {
    let compilation = compile_text(graph, "text", &format!("{text}{}", super::LIBRARY), &[]);
    let told = render(&compilation.diagnostics, &compilation.sources, false);
    assert!(!compilation.has_errors(), "{told}");
    compilation
}

/// The printed laws of the axes of a job's first machine.
pub(crate) fn laws(text: &str) -> Vec<String> {
    let graph = Graph::new();
    let compilation = compiled(&graph, text);
    compilation.jobs[0].machines[0].axes.iter().map(|axis| format!("{} = {}", axis.name, axis.law)).collect()
}

#[test]
fn a_variant_adds_replaces_and_fixes() {
    let text = "
        machine tilted extends lathe {
            param tilt : angle = 5 deg
            axis A : rotary
            fix Z = height / 2
            frame slide in bed = translate(0 mm, height, Z) rotate_x(A)
            frame tip in slide = translate_z(1 mm)
        }
        job j {
            machine m = tilted(height: 4 mm)
            tool b = ball
            mount b on m.tip
            motion turn : angle in 0 deg .. 90 deg
            drive m.C = turn
            drive m.A = m.tilt
            surface s in m.work = envelope(b.face, over: turn)
        }";
    assert_eq!(laws(text), ["Z = m.height / 2", "C = turn", "A = m.tilt"]);
    let graph = Graph::new();
    let compilation = compiled(&graph, text);
    let names: Vec<&str> = compilation.jobs[0].machines[0].frames.iter().map(|frame| frame.name.as_str()).collect();
    assert_eq!(names, ["bed", "slide", "work", "tip"]);
}

/// A zero divisor in a way that is not taken, and a law or a transform with a value in a small part of the ranges, are no mistakes.
#[test]
fn what_has_a_value_somewhere_is_kept() {
    let of = |law: &str, transforms: &str| {
        let text = format!(
            "machine tilted extends lathe {{
                frame work in bed = rotate_z(C) {transforms}
            }}
            job j {{
                param starts : count = 0
                machine m = tilted(height: 4 mm)
                tool b = ball
                mount b on m.slide
                motion turn : angle in 0 deg .. 90 deg
                drive m.C = turn
                drive m.Z = {law}
                surface s in m.work = envelope(b.face, over: turn)
            }}"
        );
        compiled(&Graph::new(), &text);
    };
    of("if starts == 0 then 2 mm/rad * turn else 2 mm * turn / (1 rad * starts)", "");
    of("2 mm/rad * turn + 1 mm * sqrt(turn / 1 deg - 89.9)", "");
    of("2 mm/rad * turn", "rotate_x(asin(C / 1 deg + 0.99))");
}

#[test]
fn coupled_axes_follow_through_others() {
    let text = "
        machine geared extends lathe {
            axis D : rotary
            couple Z = 2 mm/rad * D
            couple D = 3 * C
        }
        job j {
            machine m = geared(height: 4 mm)
            tool b = ball
            mount b on m.slide
            motion turn : angle in 0 deg .. 90 deg
            drive m.C = turn
            surface s in m.work = envelope(b.face, over: turn)
        }";
    assert_eq!(laws(text), ["Z = 6 * turn", "C = turn", "D = 3 * turn"]);
}

/// The rows of a printed matrix stand below each other, also where a frame's name is longer in bytes than in letters.
#[test]
fn printed_rows_are_aligned() {
    let text = "
        machine kopf extends lathe { frame läufer in slide = rotate_x(0.3 rad) }
        job j {
            machine m = kopf(height: 3 mm)
            tool b = ball
            mount b on m.läufer
            surface s in m.work = move(b.face)
            motion turn : angle in 0 deg .. 90 deg
            drive m.C = 0 deg
            drive m.Z = 1 mm
        }";
    let graph = Graph::new();
    let page = derivation(&compiled(&graph, text).jobs[0], Style::Text);
    let column = |line: &str| line.chars().position(|c| c == '[');
    let lines: Vec<&str> = page.lines().collect();
    let below = |pair: &&[&str]| pair[1].trim_start().starts_with('[');
    let rows: Vec<&[&str]> = lines.windows(2).filter(below).collect();
    assert!(rows.iter().any(|pair| pair[0].contains("läufer")), "{page}");
    assert!(rows.iter().all(|pair| column(pair[0]) == column(pair[1])), "{page}");
}

/// A definition by itself is looked at with values that nobody gave: what cannot be computed for them says nothing of it.
#[test]
fn a_matrix_is_judged_by_values_that_were_given() {
    let text = |cosine: &str| {
        format!(
            "machine tilted {{
                param c : number
                frame bed
                let a = acos(c)
                let half = tan(a / 2)
                let sine = 2 * half / (1 + half^2)
                frame head in bed = matrix([[c, -sine, 0, 0 mm], [sine, c, 0, 0 mm], [0, 0, 1, 0 mm]])
            }}
            job j {{
                machine m = tilted(c: {cosine})
                tool b = ball
                mount b on m.head
                surface s in m.bed = move(b.face)
            }}"
        )
    };
    let codes = |text: &str| errors(text).into_iter().map(|finding| finding.code).collect::<Vec<_>>();
    assert_eq!(codes(&text("0.8")), []);
    assert_eq!(codes(&text("1.2")), [Code::NotRigid]);
}

#[test]
fn a_polar_angle_is_measured_from_the_middle_of_its_values() {
    for (low, high, jump) in [(170.0, 190.0, 0.0), (530.0, 550.0, 360.0), (-190.0, -170.0, -360.0)] {
        let text = format!(
            "tool knife {{
                surface edge(u: length in 0 mm .. 3 mm) {{
                    at = [15 mm, 0 mm, u]
                    body towards [1, 0, 0]
                }}
            }}
            job j {{
                machine m = lathe(height: 0 mm)
                tool k = knife
                mount k on m.slide
                motion turn : angle in -360 deg .. 360 deg
                drive m.C = -turn
                drive m.Z = 0 mm
                surface s in m.work = sweep(k.edge, over: turn)
                sample s {{
                    z: 1 mm .. 2 mm by 2
                    polar_angle: {low} deg .. {high} deg by 3
                    keep polar_angle: {low} deg .. {high} deg
                    require polar_angle: {low} deg .. {high} deg, \"it lies elsewhere\"
                }}
            }}"
        );
        let graph = Graph::new();
        let compilation = compiled(&graph, &text);
        let surface = &compilation.jobs[0].surfaces[0];
        let sample = surface.sample.as_ref().expect("a sample");
        let polar = sample.coordinates[1].value;
        assert_eq!([sample.keep[0].0.value, sample.limits[0].of.value], [polar; 2]);
        for degrees in [171.0, 179.9, 180.1, 189.0_f64] {
            let turn = (surface.unknowns[1].variable, graph.constant(degrees.to_radians()));
            let bound = [compilation.jobs[0].bindings(), vec![turn]].concat();
            let found = graph.substitute(&[polar], &bound)[0].as_constant().expect("a number").to_degrees();
            assert!((found - degrees - jump).abs() < 1e-12, "{degrees}: {found}");
        }
    }
}

#[test]
fn the_chain_leads_from_the_work_over_the_common_frame_to_the_tool() {
    let graph = Graph::new();
    let text = "
        job j {
            machine m = lathe(height: 4 mm)
            tool b = ball
            mount b on m.slide
            motion turn : angle in 0 deg .. 90 deg
            drive m.C = turn
            drive m.Z = 1 mm/rad * turn
            surface s in m.work = envelope(b.face, over: turn)
        }";
    let compilation = compiled(&graph, text);
    let generation = &compilation.jobs[0].surfaces[0].generation;
    let frames: Vec<&str> = generation.path.iter().map(|(frame, _)| frame.as_str()).collect();
    assert_eq!(frames, ["m.work", "m.bed", "m.slide"]);
    // p_work = Rz(−turn) · (p_tool + (0, 4, turn))
    let pose = generation.driven.pose();
    let bindings = compilation.jobs[0].bindings();
    let z = graph.substitute(&pose.translation.0, &bindings);
    assert_eq!(z.map_text(), ["4 * sin(turn)", "4 * cos(turn)", "turn"]);
}

/// A rack's tooth whose profile has two straight pieces, of 3 mm and of 5 mm, and a job with a sample of what they leave.
fn of_two_pieces(sample: &str) -> String {
    format!(
        "machine planer {{
            axis Y : linear
            axis C : rotary
            frame bed
            frame slide in bed = translate(36 mm, Y, 0 mm)
            frame table in bed = rotate_z(C)
        }}
        tool bent {{
            profile p {{
                short = line(from: [0 mm, 0 mm], to: [2.4 mm, -1.8 mm])
                long  = line(from: [2.4 mm, -1.8 mm], to: [5.4 mm, -5.8 mm])
            }}
            surface face(s: along p, v: length in -1 mm .. 1 mm) {{
                at = [p(s)[0], p(s)[1], v]
                body towards [0, -1, 0]
            }}
        }}
        job j {{
            machine m = planer
            tool b = bent
            mount b on m.slide
            motion roll : angle in -40 deg .. 40 deg
            drive m.C, m.Y = roll, 36 mm * roll
            surface t in m.table = envelope(b.face, over: roll)
            {sample}
        }}"
    )
}

#[test]
fn a_whole_profile_is_sampled_as_one() {
    let graph = Graph::new();
    let text = of_two_pieces(
        "sample t { v: 0.1 mm .. 0.2 mm by 2, s: 0 mm .. 8 mm by 17 }
        sample t as ends { s: [0 mm, 3 mm, 8 mm], v: 0.1 mm .. 0.2 mm by 3 }
        sample t as tail { s: 4 mm .. 8 mm by 3, v: 0.1 mm .. 0.2 mm by 3 }",
    );
    let compilation = compiled(&graph, &text);
    let of = |name: &str| {
        let surface = compilation.jobs[0].surfaces.iter().find(|surface| surface.name == name)?;
        let sample = surface.sample.as_ref()?;
        let targets = sample.targets();
        Some((sample.counts, targets[0], targets[targets.len() - 1]))
    };
    let [one, two] = [0.1, 0.2];
    // 3 mm is the end of the one and the beginning of the other
    assert_eq!(of("t.short"), Some(([2, 7], [one, 0.0], [two, 3.0])));
    assert_eq!(of("t.long"), Some(([2, 11], [one, 3.0], [two, 8.0])));
    assert_eq!(of("ends.short"), Some(([2, 3], [0.0, one], [3.0, two])));
    assert_eq!(of("ends.long"), Some(([2, 3], [3.0, one], [8.0, two])));
    assert_eq!(of("tail.long"), Some(([3, 3], [4.0, one], [8.0, two])));
    // no value lies on it
    assert_eq!(of("tail.short"), None);
    for (sample, code) in [
        ("sample t { rho: 34 mm .. 36 mm by 2, v: 0.1 mm .. 0.2 mm by 3 }", Code::WrongKind),
        ("sample t { s: 0 mm .. 9 mm by 3, v: 0.1 mm .. 0.2 mm by 3 }", Code::SampleShape),
        ("sample t { s: 1 mm, v: 0 mm } sample t { s: 1 mm, v: 0.1 mm .. 0.2 mm by 3 }", Code::DuplicateName),
    ] {
        let found: Vec<Code> = errors(&of_two_pieces(sample)).iter().map(|finding| finding.code).collect();
        assert_eq!(found, [code], "{sample}");
    }
}

#[test]
fn a_piece_with_a_sample_of_its_own_takes_no_part_in_that_of_the_whole() {
    let whole = "sample t { s: 0 mm .. 8 mm by 17, v: 0.1 mm .. 0.2 mm by 2 }";
    let own = "sample t.short { s: 1 mm .. 2 mm by 5, v: 0 mm .. 1 mm by 3 }";
    let extended = format!("{} job k extends j {{ {own} }}", of_two_pieces(whole));
    for text in [of_two_pieces(&[whole, own].concat()), of_two_pieces(&[own, whole].concat()), extended] {
        let graph = Graph::new();
        let compilation = compiled(&graph, &text);
        let surfaces = &compilation.jobs.last().expect("a job").surfaces;
        let counts: Vec<_> = surfaces.iter().map(|surface| surface.sample.as_ref().map(|of| of.counts)).collect();
        assert_eq!(counts, [Some([5, 3]), Some([11, 2])], "{text}");
    }
}

#[test]
fn sides_of_a_surface_are_surfaces_written_one_by_one() {
    let of = |surfaces: &str| {
        let graph = Graph::new();
        let text = format!(
            "tool wedge {{
                param half : length = 2 mm
                {surfaces}
            }}
            job j {{
                machine m = lathe(height: 4 mm)
                tool w = wedge
                mount w on m.slide
                motion turn : angle in 0 deg .. 90 deg
                drive m.C, m.Z = turn, 1 mm/rad * turn
                surface a, b in m.work = envelope(w.plus, w.minus, over: turn)
            }}"
        );
        let compilation = compiled(&graph, &text);
        let surfaces = &compilation.jobs[0].surfaces;
        let shown = |surface: &GeneratedSurface<'_>| {
            let all = surface.surface.position.0.into_iter().chain(surface.surface.normal.0);
            all.chain(surface.surface.constraints.iter().copied()).map(|part| part.to_string()).collect::<Vec<_>>()
        };
        surfaces.iter().map(shown).collect::<Vec<_>>()
    };
    let one = |name: &str, side: &str| {
        format!(
            "surface {name}(u: length in 0 mm .. 5 mm, v: length in -1 mm .. 1 mm) {{
                at = [u, {side} * (half + u), v]
                body towards [1 mm, -{side} * half, 0 mm]
            }}"
        )
    };
    let sides = one("plus, minus", "side").replacen(" {\n", " for side in [1, -1] {\n", 1);
    assert!(sides.contains("for side in"), "{sides}");
    assert_eq!(of(&sides), of(&(one("plus", "1") + &one("minus", "(-1)"))));
}

#[test]
fn a_sample_of_sides_is_samples_written_one_by_one() {
    let of = |sample: &str| {
        let graph = Graph::new();
        let compilation = compiled(&graph, &of_two_pieces(sample));
        let surfaces = &compilation.jobs[0].surfaces;
        let shown = |surface: &GeneratedSurface<'_>| {
            let sample = surface.sample.as_ref()?;
            let keep = sample.keep.iter().map(|(of, ends)| (of.value.to_string(), *ends));
            let limits = sample.limits.iter().map(|limit| (limit.of.value.to_string(), limit.ends));
            Some((surface.name.clone(), sample.targets(), keep.chain(limits).collect::<Vec<_>>()))
        };
        surfaces.iter().filter_map(shown).collect::<Vec<_>>()
    };
    let sides = of("sample t.short as near, t.short as far for side in [1, -1] {
        v: -0.2 mm .. side * 0.4 mm + 0.5 mm by 3, s: 0 mm .. 2 mm by 2
        keep turned = side * roll: -20 deg .. 10 deg
        require there = side * x: -90 mm .. 90 mm, \"it is elsewhere\"
    }");
    let one = |name: &str, side: &str| {
        format!(
            "sample t.short as {name} {{
                v: -0.2 mm .. {side} * 0.4 mm + 0.5 mm by 3, s: 0 mm .. 2 mm by 2
                keep turned = {side} * roll: -20 deg .. 10 deg
                require there = {side} * x: -90 mm .. 90 mm, \"it is elsewhere\"
            }}\n"
        )
    };
    assert_eq!(sides, of(&(one("near", "1") + &one("far", "(-1)"))));
    assert_eq!(sides.len(), 2);
    assert_ne!(sides[0].1, sides[1].1);
}

#[test]
fn an_inserted_frame_carries_all_that_hung_on_another_one() {
    let surface = "
            tool b = ball
            mount b on m.nose
            motion turn : angle in 0 deg .. 90 deg
            drive m.C = turn
            drive m.Z = 1 mm/rad * turn
            surface s in m.work = envelope(b.face, over: turn)";
    let machines = "
        machine long_lathe extends lathe {
            frame nose  in slide = translate_y(2 mm)
            frame steady in slide = translate_y(3 mm)
        }
        machine wrong_lathe extends long_lathe {
            insert tilted in slide = rotate_x(1 deg)
            insert sunk in tilted = translate_y(-5 um)
        }
        machine again extends wrong_lathe {
            insert higher in slide = translate_z(1 mm)
        }";
    let of = |machine: &str| {
        let graph = Graph::new();
        let text = format!("{machines} job j {{ machine m = {machine}(height: 4 mm) {surface} }}");
        let compilation = compiled(&graph, &text);
        let job = &compilation.jobs[0];
        let frames = &job.machines[0].frames;
        let parent = |name: &str| {
            let frame = frames.iter().find(|frame| frame.name == name).expect("declared");
            frame.parent.map(|parent| frames[parent].name.clone()).unwrap_or_default()
        };
        let path = &job.surfaces[0].generation.path;
        (path.iter().map(|(frame, _)| frame.clone()).collect::<Vec<_>>().join(" "), parent("steady"), parent("sunk"))
    };
    let named = |path: &str, steady: &str, sunk: &str| (path.to_string(), steady.to_string(), sunk.to_string());
    let wrong = "m.work m.bed m.slide m.tilted m.sunk m.nose";
    assert_eq!(of("wrong_lathe"), named(wrong, "sunk", "tilted"));
    let again = "m.work m.bed m.slide m.higher m.tilted m.sunk m.nose";
    assert_eq!(of("again"), named(again, "sunk", "tilted"));
}

trait MapText {
    fn map_text(&self) -> Vec<String>;
}

impl MapText for Vec<flank_expr::Expr<'_>> {
    fn map_text(&self) -> Vec<String> {
        self.iter().map(ToString::to_string).collect()
    }
}

#[test]
fn an_envelope_is_a_tool() {
    let graph = Graph::new();
    let text = "
        machine pair extends lathe {
            axis D : rotary
            frame mate in bed = translate_x(80 mm) rotate_z(D)
        }
        job j {
            machine m = pair(height: 4 mm)
            tool b = ball
            mount b on m.slide
            motion turn : angle in 0 deg .. 90 deg
            motion mesh : angle in 0 deg .. 90 deg
            drive m.C = turn
            drive m.Z = 1 mm/rad * turn
            drive m.D = -2 * mesh
            surface first in m.bed = envelope(b.face, over: turn)
            surface second in m.mate = envelope(first, over: mesh)
        }";
    let compilation = compiled(&graph, text);
    let second = &compilation.jobs[0].surfaces[1];
    assert_eq!(second.surface.constraints.len(), 2);
    let names: Vec<&str> = second.unknowns.iter().map(|unknown| unknown.name.as_str()).collect();
    assert_eq!(names, ["u", "v", "turn", "mesh"]);
}

#[test]
fn conditions_are_decided_by_the_parameters() {
    for (hand, law) in [("1", "Z = turn"), ("-1", "Z = -turn")] {
        let text = format!(
            "job j {{
                param hand : number = {hand}
                machine m = lathe(height: 4 mm)
                tool b = ball
                mount b on m.slide
                motion turn : angle in 0 deg .. 90 deg
                drive m.C = turn
                drive m.Z = if hand > 0 then 1 mm/rad * turn else -1 mm/rad * turn
                surface s in m.work = envelope(b.face, over: turn)
            }}"
        );
        assert_eq!(laws(&text)[0], law);
    }
}

/// What NC programs say of the axes of a machine, and a variant of it that has other letters.
#[test]
fn nc_words_name_and_count_axes() {
    let text = "
        machine table extends lathe {
            param tool_turns : count = 1
            axis tilt : rotary
            frame tilted in work = rotate_x(tilt)
            nc A = if tool_turns == 1 then -tilt else tilt
            nc Z = height - Z by 1 um
        }
        machine other_table extends table {
            nc B1 = tilt - 90 deg by 0.0001 deg
        }
        job j {
            machine m = table(height: 4 mm)
            machine n = other_table(height: 4 mm, tool_turns: 0)
            tool b = ball
            mount b on m.slide
            motion turn : angle in 0 deg .. 90 deg
            drive m.C = turn
            drive m.Z = 0 mm
            drive m.tilt = 0 deg
            drive n.C = turn
            drive n.Z = 0 mm
            drive n.tilt = 0 deg
            surface s in m.work = envelope(b.face, over: turn)
        }";
    let graph = Graph::new();
    let compilation = compiled(&graph, text);
    let words = |machine: usize| -> Vec<(String, bool, f64, Option<u8>)> {
        let axes = compilation.jobs[0].machines[machine].axes.iter().map(|axis| axis.word.clone());
        axes.map(|word| (word.address, word.reversed, word.offset, word.decimals)).collect()
    };
    let word = |address: &str, reversed, offset, decimals| (address.to_string(), reversed, offset, decimals);
    let slide = word("Z", true, 4.0, Some(3));
    let spindle = word("C", false, 0.0, None);
    assert_eq!(words(0), [slide.clone(), spindle.clone(), word("A", true, 0.0, None)]);
    assert_eq!(words(1), [slide, spindle, word("B1", false, -std::f64::consts::FRAC_PI_2, Some(4))]);
}

/// Values that axes move, through each other, in frames, couplings and jobs; travels from values that stand still.
#[test]
fn values_of_a_machine_may_follow_its_axes() {
    let machine = |values: &str, law: &str| {
        format!(
            "machine pushed extends lathe {{
                param arm : length = 3 mm
                {values}
                axis D : rotary in 0 deg .. limit
                let limit = 90 deg
                couple Z = {law}
            }}
            job j {{
                machine m = pushed(height: 4 mm)
                tool b = ball
                mount b on m.slide
                motion turn : angle in 0 deg .. 90 deg
                drive m.D = turn
                drive m.C = 2 * turn
                surface s in m.work = envelope(b.face, over: turn)
            }}"
        )
    };
    let swept = "integral(t in 0 deg .. D: cos(t)) * 1 mm";
    let named = machine("let rise = arm * sin(D) let all = 2 * rise", &format!("all + {swept}"));
    let written = machine("", &format!("2 * (arm * sin(D)) + {swept}"));
    assert_eq!(laws(&named), laws(&written));
}

/// A knee of two links, whose slide drives it: both angles by the law of cosines, and what is coupled to one of them.
#[test]
fn a_closed_loop_gives_unknown_axes_their_laws() {
    let text = "machine knee extends lathe {
            param upper : length = 50 mm
            param lower : length = 40 mm
            unknown thigh : rotary in 0 deg .. 89 deg
            unknown shank : rotary in -89 deg .. 0 deg
            axis W : linear
            couple W = 1 mm/rad * thigh
            frame pin in bed = rotate_y(thigh) translate_z(upper)
            frame foot in bed = translate_z(Z)
            frame ankle in foot = rotate_y(shank) translate_z(-lower)
            frame pushed in bed = translate_x(W)
            close pin = ankle along x, z
        }
        job j {
            machine m = knee(height: 4 mm)
            tool b = ball
            mount b on m.slide
            motion turn : angle in 0 deg .. 90 deg
            drive m.C, m.Z = turn, 60 mm + 20 mm * sin(turn)
            surface s in m.work = envelope(b.face, over: turn)
        }";
    let graph = Graph::new();
    let compilation = compiled(&graph, text);
    let job = &compilation.jobs[0];
    let law = |name: &str| job.machines[0].axes.iter().find(|axis| axis.name == name).expect("the axis").law;
    let turn = job.motions[0].variable;
    for at in [0.0_f64, 0.4, 1.1, 1.5] {
        let mut values = vec![0.0; graph.variable_count()];
        for parameter in &job.parameters {
            values[parameter.variable.as_variable().expect("a variable").index()] = parameter.value;
        }
        values[turn.as_variable().expect("a variable").index()] = at;
        let exprs = [law("thigh"), law("shank"), law("W"), law("thigh").derivative(turn)];
        let [thigh, shank, pushed, speed] = graph.evaluate(&exprs, &values)[..] else { panic!("four values") };
        let (slide, slide_speed) = (60.0 + 20.0 * at.sin(), 20.0 * at.cos());
        let exact = ((50.0_f64.powi(2) + slide * slide - 40.0_f64.powi(2)) / (100.0 * slide)).acos();
        assert!((thigh - exact).abs() < 1e-14 && pushed == thigh, "{at}: {thigh}, not {exact}");
        assert!((40.0 * shank.sin() + 50.0 * thigh.sin()).abs() < 1e-13, "{at}: {shank}");
        let cosine_speed = slide_speed * (0.5 / 50.0 - (2500.0 - 1600.0) / (100.0 * slide * slide));
        assert!((speed + cosine_speed / thigh.sin()).abs() < 1e-14, "{at}: {speed}");
    }
}

/// A rack whose parameters are called as a page calls its parts. The equation of meshing is linear in `t2` with the factor sin(tilt), which is
/// zero: the page gives no closed form for it, and one where the rack is tilted.
#[test]
fn a_derivation_has_names_of_its_own_and_divides_by_nothing_that_is_zero() {
    let page = |tilt: &str| {
        let text = format!(
            "machine planer {{
                axis Y : linear
                axis C : rotary
                frame bed
                frame ram in bed = translate(36 mm, Y, 0 mm)
                frame table in bed = rotate_z(C)
            }}
            tool rack {{
                param pressure_angle : angle = 20 deg
                param tilt : angle = {tilt}
                surface flank(t1: length in -3 mm .. 3 mm, t2: length in -10 mm .. 10 mm) {{
                    at = [
                        t1 * cos(pressure_angle), t2 * sin(tilt) - t1 * sin(pressure_angle), t2 * cos(tilt)
                    ]
                    body towards [0, 1, 0]
                }}
            }}
            job gear {{
                machine m = planer
                tool r = rack
                mount r on m.ram
                motion roll : angle in -30 deg .. 30 deg
                drive m.Y, m.C = 36 mm * roll, roll
                surface flank in m.table = envelope(r.flank, over: roll)
            }}"
        );
        let graph = Graph::new();
        derivation(&compiled(&graph, &text).jobs[0], Style::Text)
    };
    for (tilt, is_given) in [("0 deg", false), ("10 deg", true)] {
        let page = page(tilt);
        // but for the closed form of the parameter
        let is_part = |line: &str| line.starts_with("  t1 = ") && !line.starts_with("  t1 = -(");
        assert!(!page.lines().any(is_part) && page.contains("  t3 = "), "{page}");
        assert_eq!(page.contains("it is linear in t2, which it gives in closed form"), is_given, "{page}");
        assert!(page.contains("it is linear in t1, which it gives in closed form"), "{page}");
    }
}
