//! What gauges and calipers find on a body.

use flank_solver::{Arrangement, BallFault, BallGauge, Body, Span, Thickness};

use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::units::length;
use crate::solve::body::result::{BallNumbers, BarNumbers, FaceNumbers, GaugeNumbers, SpanNumbers, ThicknessNumbers};

/// Circles from the form diameter to the tip on which the thickness is told.
const CIRCLES: usize = 5;
/// Circles on which balls are looked for, and those where none of these has one that fits; of the last way to the tip each half has one more.
const BALL_CIRCLES: usize = 9;
const MORE_CIRCLES: usize = 65;
const TIP_HALVES: i32 = 16;
/// Parts of the way from circle to circle that are told apart.
const AWAY: f64 = 1e6;
/// Balls come in steps, so many to a millimetre: the coarsest of which a ball has a few at the least, and finer ones where none fits.
const BALL_STEPS: [f64; 4] = [4.0, 20.0, 100.0, 1000.0];
const FEWEST_STEPS: f64 = 4.0;
/// A ball that touches this near to the circle where the flanks end touches where they end, mm.
const TOUCHES_END: f64 = 1e-6;

/// A ball of the diameter that is asked for, or of one that touches the flanks as near to their middle as one fits in. Spans and balls are dimensions of
/// cylindrical gears: those whose tip is a cylinder.
pub(crate) fn measured(body: &Body, ball: Option<f64>) -> GaugeNumbers {
    let [tip, root] = body.tip_and_root();
    let edge_below_tip_mm = body.edge_below_tip();
    if body.distinct() > 1 {
        let [tip, root] = [tip, root].map(|rho| Some(2.0 * rho));
        return GaugeNumbers { tip_diameter_mm: tip, root_diameter_mm: root, ..GaugeNumbers::default() };
    }
    let form = body.form();
    let thickness = circles(body, CIRCLES).into_iter().filter_map(|circle| body.thickness(circle));
    let thickness: Vec<ThicknessNumbers> = thickness.map(|of| thickness_numbers(body, of)).collect();
    if let Arrangement::Straight { pitch } = body.arrangement() {
        let bar = BarNumbers { pitch_mm: pitch, tip_x_mm: tip, root_x_mm: root, form_x_mm: form };
        return GaugeNumbers { thickness, edge_below_tip_mm, bar: Some(bar), ..GaugeNumbers::default() };
    }
    let is_cylindrical = is_cylindrical(body);
    let most = if is_cylindrical { body.teeth() / 2 } else { 0 };
    let face = body.is_face_gear().then_some(FaceNumbers { tip_z_mm: tip, root_z_mm: root, form_z_mm: form });
    let diameters = |of: f64| match &face {
        Some(_) => thickness.first().and_then(|tooth| tooth.diameter_mm).unwrap_or_default(),
        None => 2.0 * of,
    };
    let balls = is_cylindrical.then(|| fitting(body, ball)).flatten();
    GaugeNumbers {
        tip_diameter_mm: Some(diameters(tip)),
        root_diameter_mm: Some(diameters(root)),
        form_diameters_mm: Some(form.map(diameters)),
        thickness,
        spans: (1..=most).filter_map(|teeth| body.span(teeth)).map(span_numbers).collect(),
        no_ball_fits: is_cylindrical && body.teeth() > 1 && ball.is_none() && balls.is_none(),
        balls: balls.map(ball_numbers),
        edge_below_tip_mm,
        face,
        bar: None,
    }
}

/// The ball that is asked for, or the first that fits in of those that touch on a circle: on the middle one of the flanks, then on those beside
/// it. It touches flanks alone, and stands out beyond the tip, where an anvil reaches it. Where none does, more circles are tried, which come near
/// to the tip, where balls stand out the farthest, and finer steps.
fn fitting(body: &Body, ball: Option<f64>) -> Option<BallGauge> {
    if let Some(ball) = ball {
        return body.ball(ball).ok();
    }
    let form = body.form();
    let touches_flanks = |of: &BallGauge| of.rho.iter().zip(form).all(|(rho, form)| (rho - form).abs() > TOUCHES_END);
    let fits = |of: &BallGauge| touches_flanks(of) && of.beyond_tip > 0.0;
    let mut tried: Vec<f64> = Vec::new();
    let mut first = |balls: &[f64], finer: usize| {
        balls.iter().find_map(|ball| {
            let ball = in_steps(*ball, finer);
            let is_new = ball > 0.0 && !tried.contains(&ball);
            tried.push(ball);
            is_new.then(|| body.ball(ball).ok()).flatten().filter(fits)
        })
    };
    let touching = |circle: f64| body.ball_touching(circle);
    let few: Vec<f64> =
        ball_circles(body, BALL_CIRCLES).into_iter().filter_map(touching).map(|of| of.diameter).collect();
    first(&few, 0).or_else(|| {
        let more = ball_circles(body, MORE_CIRCLES).into_iter().filter_map(touching).filter(fits);
        let more: Vec<f64> = more.map(|of| of.diameter).collect();
        (0..BALL_STEPS.len()).find_map(|finer| first(&more, finer))
    })
}

/// Circles of the flanks by their distance from the middle one; where there are many, also near the tip.
fn ball_circles(body: &Body, count: usize) -> Vec<f64> {
    let mut of_flanks = circles(body, count);
    let (middle, [before, tip]) = (of_flanks[count / 2], [of_flanks[count - 2], of_flanks[count - 1]]);
    if count > BALL_CIRCLES {
        of_flanks.extend((1..=TIP_HALVES).map(|k| tip + (before - tip) * 0.5_f64.powi(k)));
    }
    // of two that are as far the deeper one comes first, whatever rounding leaves
    let away = |circle: &f64| ((circle - middle) / (tip - before) * AWAY).abs().round();
    of_flanks.sort_by(|a, b| away(a).total_cmp(&away(b)));
    of_flanks
}

/// A ball in whole steps, the nearest one.
fn in_steps(ball: f64, finer: usize) -> f64 {
    let last = BALL_STEPS.len() - 1;
    let coarsest = BALL_STEPS.iter().position(|of_mm| ball * of_mm >= FEWEST_STEPS).unwrap_or(last);
    let of_mm = BALL_STEPS[(coarsest + finer).min(last)];
    (ball * of_mm).round() / of_mm
}

/// Whether spans and balls are dimensions of it: its tip is a cylinder.
fn is_cylindrical(body: &Body) -> bool {
    let [_, outline, _] = body.blank().bounds();
    body.arrangement().is_closed() && outline.center.is_none() && outline.from[1] == outline.to[1]
}

/// Why there is no dimension over balls of the diameter that is asked for, of a solid with surfaces of these names.
pub(crate) fn no_ball(name: &str, (body, surfaces): (&Body, &[String]), ball: f64) -> NotDone {
    let has_one = is_cylindrical(body) && body.distinct() == 1 && body.teeth() > 1;
    let message = match body.ball(ball).err().filter(|_| has_one) {
        None => format!(
            "`{name}` has no dimension over balls: only of a gear with several teeth that are alike and a cylinder as its tip there is one"
        ),
        Some(BallFault::NotTouching) => {
            format!("balls of {ball} mm do not touch both flanks of a space of `{name}` half-way along")
        }
        Some(BallFault::Inside { chart, by }) => format!(
            "balls of {ball} mm that touch both flanks of a space of `{name}` half-way along would lie {} deep in the steel of `{}`",
            length(by),
            surfaces[chart]
        ),
        Some(BallFault::InEachOther) => {
            format!("balls of {ball} mm in opposite spaces of `{name}` would lie in each other")
        }
    };
    let fits = fitting(body, None).filter(|_| has_one);
    let way = fits.map(|of| format!("balls of {} mm fit", of.diameter));
    NotDone::new(NotDoneKind::NoBall, name, message).with(way.into_iter().collect())
}

/// So many circles from the form diameter to the tip.
fn circles(body: &Body, count: usize) -> Vec<f64> {
    let (tip, form) = (body.tip(), body.form());
    let deepest = if body.is_external() { form[0].max(form[1]) } else { form[0].min(form[1]) };
    (0..count).map(|k| deepest + (tip - deepest) * k as f64 / (count - 1) as f64).collect()
}

fn thickness_numbers(body: &Body, of: Thickness) -> ThicknessNumbers {
    let Thickness { rho, z, arc, chord } = of;
    let is_round = body.arrangement().is_closed();
    ThicknessNumbers {
        diameter_mm: is_round.then_some(2.0 * rho),
        x_mm: (!is_round).then_some(rho),
        z_mm: z,
        arc_mm: arc,
        chord_mm: chord.map(|chord| chord.length),
        chord_height_mm: chord.map(|chord| chord.height),
    }
}

fn span_numbers(of: Span) -> SpanNumbers {
    SpanNumbers { teeth: of.teeth, width_mm: of.width, diameters_mm: of.rho.map(|rho| 2.0 * rho) }
}

fn ball_numbers(of: BallGauge) -> BallNumbers {
    BallNumbers { ball_mm: of.diameter, over_balls_mm: of.over_balls, diameters_mm: of.rho.map(|rho| 2.0 * rho) }
}
