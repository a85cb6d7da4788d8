//! The gears that the surfaces are of: what they measure, and how their flanks lie to the involute.

use flank_chain_dsl::Solid;
use flank_draw::{Block, Column, ReportSection};
use flank_export::fixed;

use super::{Findings, pictures};
use crate::compare::trace_result::{FlankTraces, TraceNumbers};
use crate::draw::{Subject, traces};
use crate::project::choices::PlotKind;
use crate::project::failure::Failure;
use crate::project::remark::NotDone;
use crate::solve::body::gauges::measured;
use crate::solve::body::result::GaugeNumbers;
use crate::solve::body::{refusal, space};

/// Spans that are listed about the one that touches nearest to the middle of the flanks.
const SPANS: usize = 3;

/// A gear and what was measured on its body.
pub(super) struct Gear<'j> {
    solid: &'j Solid,
    /// Volume, mm³, and what gauges find; or why there is no body.
    pub(super) measured: Result<(f64, GaugeNumbers), String>,
    /// Steel that the body has and that tools take away.
    pub(super) uncut: Vec<NotDone>,
}

/// # Errors
/// If the work is cancelled.
pub(super) fn gears<'j>(subject: &Subject<'j, '_>) -> Result<Vec<Gear<'j>>, Failure> {
    let gear = |solid: &'j Solid| {
        let (job, session) = (subject.job(), subject.session());
        let made = match space::body(job, solid, session) {
            Ok(made) => made,
            Err(failure) => {
                let reason = refusal::no_body(solid, failure)?.message;
                return Ok(Gear { solid, measured: Err(reason), uncut: Vec::new() });
            }
        };
        let (_, uncut) = made.uncut(job, solid, session)?;
        Ok(Gear { solid, measured: Ok((made.body.mass_properties().volume, measured(&made.body, None))), uncut })
    };
    subject.job().solids.iter().map(gear).collect()
}

/// Nothing of a job without gears and involutes.
pub(super) fn section(findings: &Findings<'_, '_>) -> Option<ReportSection> {
    let mut blocks: Vec<Block> = Vec::new();
    for (number, gear) in findings.gears.iter().enumerate() {
        let [heading, measured @ ..] = &of_gear(gear)[..] else { continue };
        blocks.push(heading.clone());
        // the first one opens the report
        blocks.extend((number > 0).then(|| pictures::gear(findings, gear.solid)).flatten());
        blocks.extend_from_slice(measured);
    }
    if !findings.traces.is_empty() {
        blocks.push(evaluation(&findings.traces));
        blocks.extend(pictures::figure(findings, PlotKind::Traces));
    }
    (!blocks.is_empty()).then(|| ReportSection { title: "Gear".to_string(), blocks })
}

fn of_gear(gear: &Gear<'_>) -> Vec<Block> {
    let Gear { solid, measured, .. } = gear;
    let heading = Block::Heading(solid.name.clone());
    let teeth = ("teeth".to_string(), solid.teeth.to_string());
    let (volume, gauges) = match measured {
        Ok(measured) => measured,
        Err(reason) => return vec![heading, Block::Facts(vec![teeth, ("no closed body".to_string(), reason.clone())])],
    };
    let mm = |value: f64| format!("{} mm", fixed(value, 4));
    let mut facts = vec![teeth];
    let known = [("tip diameter", gauges.tip_diameter_mm), ("root diameter", gauges.root_diameter_mm)];
    facts.extend(known.into_iter().filter_map(|(name, value)| Some((name.to_string(), mm(value?)))));
    let form = gauges.form_diameters_mm.map(|[first, last]| format!("{} and {}", mm(first), mm(last)));
    facts.extend(form.map(|form| ("form diameters".to_string(), form)));
    if let Some(bar) = &gauges.bar {
        let places = [("pitch", bar.pitch_mm), ("tip at x", bar.tip_x_mm), ("root at x", bar.root_x_mm)];
        facts.extend(places.map(|(name, value)| (name.to_string(), mm(value))));
    }
    facts.push(("volume".to_string(), format!("{} mm³", fixed(*volume, 3))));
    facts.extend(spans(gauges));
    facts.extend(gauges.balls.iter().map(|balls| {
        let name = format!("over balls of {} mm", fixed(balls.ball_mm, 3));
        (name, mm(balls.over_balls_mm))
    }));
    let thickness = (!gauges.thickness.is_empty()).then(|| thickness(&solid.name, gauges));
    [heading, Block::Facts(facts)].into_iter().chain(thickness).collect()
}

/// The span that touches nearest to the middle of the flanks, and those beside it.
fn spans(gauges: &GaugeNumbers) -> Vec<(String, String)> {
    let Some(([first, last], tip)) = gauges.form_diameters_mm.zip(gauges.tip_diameter_mm) else { return Vec::new() };
    let middle = 0.5 * (0.5 * (first + last) + tip);
    let off = |k: &usize| (gauges.spans[*k].diameters_mm[0] - middle).abs();
    let Some(best) = (0..gauges.spans.len()).min_by(|a, b| off(a).total_cmp(&off(b))) else { return Vec::new() };
    let from = best.saturating_sub(SPANS / 2);
    let shown = gauges.spans.iter().skip(from).take(SPANS);
    shown.map(|span| (format!("span over {} teeth", span.teeth), format!("{} mm", fixed(span.width_mm, 4)))).collect()
}

fn thickness(name: &str, gauges: &GaugeNumbers) -> Block {
    let place = if gauges.bar.is_some() { "x, mm" } else { "diameter, mm" };
    let columns = [place, "along the circle, mm", "chord, mm", "below the tip, mm"].map(Column::numbers);
    let rows = gauges.thickness.iter().map(|of| {
        let numbers = [of.diameter_mm.or(of.x_mm), Some(of.arc_mm), of.chord_mm, of.chord_height_mm];
        numbers.iter().map(|x| x.map_or_else(String::new, |x| fixed(x, 4))).collect()
    });
    Block::Table(format!("Tooth thickness of {name}, half-way along the teeth"), columns.to_vec(), rows.collect())
}

fn evaluation(traces: &[FlankTraces]) -> Block {
    let columns = [Column::words("flank"), Column::words("trace")].into_iter();
    let numbers = ["F, \u{b5}m", "f f, \u{b5}m", "f H, \u{b5}m", "C, \u{b5}m"].map(Column::numbers);
    let row = |of: &FlankTraces, trace: &str, numbers: &TraceNumbers| {
        let values = [numbers.total_um, numbers.form_um, numbers.slope_um, numbers.crowning_um];
        [of.surface.clone(), trace.to_string()]
            .into_iter()
            .chain(values.map(|um| fixed(um, 3)))
            .collect::<Vec<String>>()
    };
    let rows =
        traces.iter().flat_map(|of| [row(of, "profile, \u{3b1}", &of.profile), row(of, "helix, \u{3b2}", &of.helix)]);
    let caption = format!(
        "Total, form and slope deviation and crowning of the traces, ISO 1328-1:2013, from {}",
        traces::involute(&traces[0].involute)
    );
    Block::Table(caption, columns.chain(numbers).collect(), rows.collect())
}
