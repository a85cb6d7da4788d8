//! What settings and the mounting change of a contact, by the program's derivatives and by contacts of shipped pairs that are solved anew.

use flank_chain_dsl::{Dimension, Job, SampleGrid};
use flank_expr::{Expr, Graph};
use flank_solver::{
    ContactChange, ContactNumber, ContactPoint, ContactProblem, ContactSynthesis, ContactWish, FlankCorners, Range,
    ScaledUnknown,
};
use flank_tests::job;
use flank_tests::pairs::with_pair_in;

/// Of marking compound, mm.
const FILM: f64 = 0.00635;
/// A step moves the point by no more, mm: over that a contact is a polynomial of fourth degree to 1e-8 of its changes.
const NEAR: f64 = 0.02;
/// The longest steps: mm, radians, shares of a number, and of one that is zero.
const STEPS: [f64; 4] = [0.01, 3e-4, 1e-3, 1e-4];
/// Numbers of a contact are solved to this share of their sizes: Newton's last step and the conditions of these pairs leave that.
const KNOWN: f64 = 2e-11;
/// What two steps leave of their difference: it falls with the square of the step, and the next power of it is a hundredth over `NEAR`.
const LEFT: f64 = 1e-2;
/// Exact derivatives agree to this share with what is left then.
const AGREES: f64 = 1e-6;

/// A setting of the job or an axis of the pair's machine.
struct Cause<'g> {
    name: String,
    variable: Expr<'g>,
    value: f64,
    step: f64,
}

fn causes<'g>(job: &Job<'g>) -> Vec<Cause<'g>> {
    let [length, angle, share, number] = STEPS;
    let step = |dimension: Dimension, value: f64| match dimension {
        Dimension::LENGTH => length,
        Dimension::ANGLE => angle,
        _ if value != 0.0 => share * value.abs(),
        _ => number,
    };
    let cause = |name: &String, variable: Expr<'g>, dimension: Dimension, value: f64| Cause {
        name: name.clone(),
        variable,
        value,
        step: step(dimension, value),
    };
    let axes = job.contacts[0].errors.iter().filter(|axis| !axis.is_driven);
    let axes = axes.map(|of| cause(&of.name, of.variable, of.dimension, 0.0));
    let settings = job.parameters.iter().filter(|of| !of.is_count);
    axes.chain(settings.map(|of| cause(&of.name, of.variable, of.dimension, of.value))).collect()
}

type Read = Box<dyn Fn(&ContactPoint) -> f64>;

/// A number of a contact, with its derivative as the program has it.
struct Quantity {
    name: String,
    exact: f64,
    read: Read,
    /// What its rounding is a share of.
    size: f64,
}

fn quantity(name: impl Into<String>, exact: f64, size: f64, read: impl Fn(&ContactPoint) -> f64 + 'static) -> Quantity {
    Quantity { name: name.into(), exact, read: Box::new(read), size }
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// All that a [`ContactChange`] tells.
fn changed(at: &ContactPoint, by: &ContactChange) -> Vec<Quantity> {
    let mut all = vec![
        quantity("roll", by.roll, 1.0, |at| at.roll),
        quantity("lag", by.lag, 1.0, |at| at.lag),
        quantity("lag curvature", by.lag_curvature, 1.0, |at| at.lag_slopes[1]),
    ];
    for member in [0, 1] {
        for k in 0..3 {
            let (place, way) = (length(at.in_members[member]), length(at.path[member]));
            all.push(quantity(format!("moved {member} {k}"), by.moved[member][k], place, move |at| {
                at.in_members[member][k]
            }));
            all.push(quantity(format!("normal {member} {k}"), by.normals[member][k], 1.0, move |at| {
                at.normals[member][k]
            }));
            all.push(quantity(format!("path {member} {k}"), by.path[member][k], way, move |at| at.path[member][k]));
        }
    }
    let gap = |at: &ContactPoint| at.gap.expect("flank on flank");
    let [k1, k2] = by.gap.expect("flank on flank");
    all.push(quantity("k1", k1, gap(at).k1, move |at| gap(at).k1));
    all.push(quantity("k2", k2, gap(at).k1, move |at| gap(at).k2));
    all
}

/// All numbers that may be wanted of a contact there.
fn numbers(at: &ContactPoint, corners: Option<FlankCorners>) -> Vec<(&'static str, ContactNumber)> {
    let mut all =
        vec![("z", ContactNumber::Z), ("rho", ContactNumber::Rho), ("transmission_error", ContactNumber::Curvature)];
    all.extend(at.gap.filter(|gap| gap.k2 > 0.0).map(|_| ("ellipse", ContactNumber::Ellipse { film: FILM })));
    if let Some(corners) = corners {
        all.push(("lengthwise", ContactNumber::Lengthwise(corners)));
        all.push(("profilewise", ContactNumber::Profilewise(corners)));
        all.push(("path", ContactNumber::Path(corners)));
    }
    all
}

/// For each cause how it changes those numbers at the vertex, as a search for settings has it.
fn effects(
    problem: &ContactProblem,
    causes: &[Cause<'_>],
    at: &ContactPoint,
    numbers: &[(&str, ContactNumber)],
) -> Vec<Vec<f64>> {
    let of = |number: &ContactNumber| number.of(at).expect("it is there");
    // off by a unit is a residual of 1
    let wish = |(_, number): &(&str, ContactNumber)| ContactWish { of: *number, wanted: of(number), within: Some(1.0) };
    let everywhere = Range { low: f64::NEG_INFINITY, high: f64::INFINITY };
    let unit = |of: &Cause<'_>| ScaledUnknown { start: of.value, scale: 1.0, range: everywhere };
    let synthesis = ContactSynthesis {
        problem,
        vertex: at,
        wishes: numbers.iter().map(wish).collect(),
        settings: causes.iter().map(unit).collect(),
    };
    let mut all = synthesis.effects().expect("all numbers are there");
    let by_roll = all.pop().expect("the roll is last");
    // behind the numbers stands the vertex's own condition, which the roll goes on to meet
    let (steps, own) = by_roll.split_at(numbers.len());
    let total = |of: Vec<f64>| (0..steps.len()).map(|k| of[k] - steps[k] * of[steps.len()] / own[0]).collect();
    all.into_iter().map(total).collect()
}

/// The contact a step to both sides and half a step, the step as long as the point stays near.
fn around(
    cause: &Cause<'_>,
    at: &ContactPoint,
    solved: impl Fn(f64) -> Option<ContactPoint>,
) -> ([ContactPoint; 4], f64) {
    let is_near = |other: &ContactPoint| {
        let off = |member: usize| [0, 1, 2].map(|k| other.in_members[member][k] - at.in_members[member][k]);
        length(off(0)).max(length(off(1))) < NEAR
    };
    let mut step = cause.step;
    while step > 1e-9 * cause.step {
        let all = [-step, -0.5 * step, 0.5 * step, step].map(|by| solved(by).filter(is_near));
        if let [Some(a), Some(b), Some(c), Some(d)] = all {
            return ([a, b, c, d], step);
        }
        step *= 0.25;
    }
    panic!("{} leads to no contact", cause.name)
}

/// Of quantities, those whose derivatives are not what solving again says, and of how many it says something to 1e-4.
fn wrong(of: &[Quantity], ([a, b, c, d], step): &([ContactPoint; 4], f64)) -> (Vec<String>, usize) {
    let mut told = 0;
    let off = |of: &Quantity| {
        let [a, b, c, d] = [a, b, c, d].map(|at| (of.read)(at));
        let (wide, fine) = ((d - a) / (2.0 * step), (c - b) / step);
        let known = (4.0 * fine - wide) / 3.0;
        let off = (of.exact - known).abs();
        let most = AGREES * known.abs() + LEFT * (fine - wide).abs() + KNOWN * of.size / step;
        told += usize::from(most < 1e-4 * known.abs());
        let is_right = off <= most;
        (!is_right)
            .then(|| format!("{}: {:e}, solved anew {known:e}; {off:e} is more than {most:e}", of.name, of.exact))
    };
    (of.iter().filter_map(off).collect(), told)
}

/// Contacts at two steps of a cause on either side, with the step.
type Around = ([ContactPoint; 4], f64);

/// A contact, whether it is followed as a vertex, and for each cause its quantities with contacts around it.
struct Compared {
    what: String,
    of: Vec<(String, Vec<Quantity>, Around)>,
}

/// A shipped pair, values of its job, a roll position, and how many contacts of it are compared.
type Pair = (&'static str, &'static [(&'static str, &'static str)], f64, usize);

/// Contacts of a pair at a roll position and at the vertex near it, if that is asked for, each with all that may be told of its changes.
fn compared(spec: &str, set: &[(&str, &str)], (roll, has_vertex): (f64, bool)) -> Vec<Compared> {
    let graph = Graph::new();
    let job = job(&graph, spec, set);
    let all = causes(&job);
    let corners = match job.surfaces[job.contacts[0].surfaces[1]].sample.as_ref().expect("it is sampled").grid {
        SampleGrid::Shares { corners, .. } => Some(FlankCorners(corners)),
        _ => None,
    };
    let (held, vertex) = with_pair_in(&job, &[], |pair, points| {
        let problem = ContactProblem::new(pair).expect("all bound");
        let found = problem.find(roll, points).expect("they touch");
        let vertex =
            has_vertex.then(|| problem.vertex(&found, [roll - 0.3, roll + 0.3]).expect("the error is extreme"));
        (found, vertex)
    });
    let open: Vec<Expr<'_>> = all.iter().map(|of| of.variable).collect();
    with_pair_in(&job, &open, |pair, _| {
        let problem = ContactProblem::new(pair).expect("all bound");
        let values: Vec<f64> = all.iter().map(|of| of.value).collect();
        let each = [(false, Some(held)), (true, vertex)].into_iter();
        let each = each.filter_map(|(is_vertex, at)| Some((is_vertex, at?)));
        each.map(|(is_vertex, at)| {
            let numbers = numbers(&at, corners);
            let effects = is_vertex.then(|| effects(&problem, &all, &at, &numbers));
            let of = |(k, cause): (usize, &Cause<'_>)| {
                let solved = |by: f64| {
                    let mut values = values.clone();
                    values[k] += by;
                    let other = problem.with_values(&values);
                    let near = other.again(&at, at.roll)?;
                    let width = [at.roll - 0.3, at.roll + 0.3];
                    if is_vertex { other.vertex(&near, width) } else { Some(near) }
                };
                let change = problem.change(&at, &[(k, 1.0)], is_vertex).expect("a regular contact");
                let mut quantities = changed(&at, &change);
                if !is_vertex {
                    quantities.push(quantity("lag slope", change.lag_slope, 1.0, |at| at.lag_slopes[0]));
                }
                let wanted = numbers.iter().zip(effects.iter().flat_map(|of| &of[k]));
                quantities.extend(wanted.map(|((name, number), exact)| {
                    let (number, gap) = (*number, at.gap.expect("flank on flank"));
                    // the ellipse's length follows from the smaller curvature, which is known to a share of the greater one
                    let bent = if *name == "ellipse" { gap.k1 / gap.k2 } else { 1.0 };
                    let size = bent * number.of(&at).expect("it is there").abs().max(1.0);
                    quantity(*name, *exact, size, move |at| number.of(at).expect("it is there"))
                }));
                (cause.name.clone(), quantities, around(cause, &at, solved))
            };
            let kind = if is_vertex { "at the vertex" } else { "at the same roll position" };
            Compared { what: format!("{spec} {set:?} {kind}"), of: all.iter().enumerate().map(of).collect() }
        })
        .collect()
    })
}

/// Every setting and every axis of six shipped pairs, spiral bevel, hypoid, helical, crowned spur, worm and face gears: all numbers of a
/// contact change as central differences say of contacts that are solved anew, of two steps so that their square cancels.
#[test]
fn all_settings_change_a_contact_as_solving_again_does() {
    let pairs: [Pair; 6] = [
        ("bevel_19x62", &[], 0.05, 2),
        ("hypoid_pair", &[], 0.05, 2),
        ("helical_pair", &[], 0.05, 1),
        ("helical_pair", &[("helix_angle", "0 deg")], 0.05, 1),
        // its error is almost even: the vertex is known to fewer digits than differences need
        ("worm_and_wheel", &[], 1.4, 1),
        ("face_gear_pair", &[], -0.04, 1),
    ];
    for (pair, set, roll, contacts) in pairs {
        let mut compared = compared(&format!("specs/pairs/{pair}.chain"), set, (roll, contacts == 2));
        assert_eq!(compared.len(), contacts, "{pair}");
        for Compared { what, of } in &mut compared {
            let (mut all, mut told) = (0, 0);
            for (name, quantities, around) in of {
                let (off, sharp) = wrong(quantities, around);
                assert!(off.is_empty(), "{what}: {name}: {off:#?}");
                (all, told) = (all + quantities.len(), told + sharp);
                // what is a thousandth off would be seen
                quantities.iter_mut().for_each(|of| of.exact *= 1.001);
                let (off, _) = wrong(quantities, around);
                assert!(off.len() >= sharp, "{what}: {name}: {off:#?}");
            }
            // the others do not change, or by less than is known of them
            assert!(6 * told > all, "{what}: {told} of {all} changes are known");
        }
    }
}

/// Shares of one parameter add up, wherever they stand.
#[test]
fn shares_of_a_parameter_add_up() {
    let graph = Graph::new();
    let job = job(&graph, "specs/pairs/bevel_19x62.chain", &[]);
    let all = causes(&job);
    let named = |name: &str| all.iter().position(|of| of.name == name).expect("a setting");
    let (angle, ratio) = (named("pinion_cutter.blade_angle"), named("p.ratio_of_roll"));
    let open: Vec<Expr<'_>> = all.iter().map(|of| of.variable).collect();
    let at = with_pair_in(&job, &[], |pair, points| {
        ContactProblem::new(pair).expect("all bound").find(0.05, points).expect("they touch")
    });
    with_pair_in(&job, &open, |pair, _| {
        let problem = ContactProblem::new(pair).expect("all bound");
        let change = |of: &[(usize, f64)]| problem.change(&at, of, false).expect("a regular contact");
        let once = change(&[(angle, 1.0), (ratio, 0.5)]);
        assert_eq!(change(&[(angle, 0.25), (ratio, 0.5), (angle, 0.75)]), once);
        assert_ne!(change(&[(angle, 0.25), (ratio, 0.5)]), once);
    });
}
