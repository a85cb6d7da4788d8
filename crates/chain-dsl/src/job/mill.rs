//! `mill finish of flank with e.cutting in m.work { … }`: a cutter of revolution that mills a surface of the job along passes.

use flank_expr::Expr;
use flank_expr::geometry::Chain;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::{Name, Span};
use crate::job::sample;
use crate::model::{
    BlockLength, CutterPiece, MilledArea, Milling, MillingClearance, MillingObstacle, PassSpacing, SampleGrid,
    ToolShape,
};
use crate::syntax::ast::{self, JobStatement};
use crate::values::context::{Context, Role};
use crate::values::dimension::Dimension;
use crate::values::value::Value;

use super::{Builder, FrameRef};

/// The two directions of a flank between four corners.
const SHARES: [&str; 2] = ["profilewise", "lengthwise"];
/// More passes, or positions on one, than anybody mills.
const MOST: f64 = 100_000.0;
/// Places along a pass at which the axis of a cutter is free: more only follow rounding.
const MOST_FREE: f64 = 60.0;

const PASSES: &str = "for example `passes profilewise: 0.05 .. 1, scallop 2 um`";
const SIDE: &str = "for example `side profilewise: 0.05 .. 1 by 8`";
const ALONG: &str = "for example `along lengthwise: 0 .. 1, chord 0.5 um`";

impl<'g> Builder<'_, 'g> {
    /// Which machines mill and generate no surface, and which surfaces of tools the millings name.
    pub(super) fn name_mills(&mut self, job: &ast::Job) {
        let machine_of = |path: &ast::Path| path.segments.first().map(|first| first.node.clone());
        let mills = job.statements.iter().filter_map(|statement| match statement {
            JobStatement::Mill(mill) => Some(mill),
            _ => None,
        });
        for mill in mills {
            self.mills.extend(machine_of(&mill.frame));
            let bodies = mill.clearances.iter().flat_map(|clearance| [&clearance.body, &clearance.surface]);
            for path in [&mill.cutter].into_iter().chain(bodies) {
                self.named.push(path.segments.iter().map(|segment| segment.node.clone()).collect());
            }
        }
        for statement in &job.statements {
            if let JobStatement::Surface(surface) = statement
                && let Some(machine) = machine_of(&surface.frame)
            {
                self.mills.remove(&machine);
            }
        }
    }

    pub(super) fn mill(&mut self, context: &mut Context<'g>, written: &ast::Mill, job: &ast::Job) {
        if written.broken {
            return;
        }
        let Some(milling) = self.built_milling(context, written, job) else { return };
        self.millings.push(milling);
    }

    fn built_milling(&mut self, context: &mut Context<'g>, written: &ast::Mill, job: &ast::Job) -> Option<Milling<'g>> {
        let surface = self.finished(context, &written.surface, job);
        let frame = self.frame(context, &written.frame);
        let cutter = self.cutter(context, &written.cutter);
        let is_side = !written.sides.is_empty();
        let first = if is_side { (&written.sides, "side", SIDE) } else { (&written.passes, "passes", PASSES) };
        let [passes, along] = [first, (&written.along, "along", ALONG)]
            .map(|(said, word, example)| only(context, written, said, (word, example)));
        if is_side && self.says_more(context, written) {
            return None;
        }
        let (surface, frame, (cutter, sits)) = (surface?, frame?, cutter?);
        let [passes, along] = [passes?, along?];
        let (its, own) = &self.surfaces[surface];
        if own.0 == frame.0 && own.1 != frame.1 {
            let message = format!("`{}` is given in `{}`, not in `{}`", its.name, its.frame, self.frame_name(frame));
            let help = "mill it in the frame that it is given in, or clamp the work on a machine of its own";
            context.report(Diagnostic::new(Code::Milling, written.frame.span, message).help(help));
            return None;
        }
        let path = self.path_between(context, frame, sits, written.cutter.span)?;
        if self.unsettled.contains(&frame.0) {
            return None;
        }
        let t_work_tool = Chain::new(context.graph, path.into_iter().flat_map(|(_, steps)| steps).collect());
        let area = self.area(context, surface, [passes, along])?;
        let counts = if is_side { [1.0, MOST_FREE] } else { [2.0, MOST] };
        let spacing = spacing(passes, self.amount(context, passes, counts)?, is_side);
        let blocks = blocks(along, self.amount(context, along, [2.0, MOST])?);
        let (Some(spacing), Some(blocks)) = (spacing, blocks) else {
            let (run, allowed) = if spacing.is_none() && is_side {
                (passes, "the axis is free at as many places along the pass as `by` says")
            } else if spacing.is_none() {
                (passes, "passes lie apart by `scallop`, `step` or `by`")
            } else {
                (along, "blocks are as long as `chord`, `step` or `by` says")
            };
            let message = format!("`{}` does not say that", run.word.node);
            context.report(Diagnostic::new(Code::Milling, run.word.span, message).help(allowed));
            return None;
        };
        let [lead, tilt, stock] = self.attitudes(context, written, &area)?;
        let mut clearances = Vec::new();
        for clearance in &written.clearances {
            clearances.push(self.kept_clear(context, clearance, (frame, sits), job)?);
        }
        if let [_, second, ..] = written.both_ways[..] {
            context.report(Diagnostic::new(Code::Milling, second, "`both ways` is said twice"));
        }
        Some(Milling {
            name: written.name.node.clone(),
            doc: written.doc.clone(),
            surface,
            cutter_name: written.cutter.joined(),
            cutter,
            machine: frame.0,
            frames: [self.frame_name(frame), self.frame_name(sits)],
            t_work_tool,
            area,
            spacing,
            blocks,
            lean: [lead, tilt],
            stock: match stock.as_constant() {
                Some(stock) => stock,
                None => context.require_constant(stock, written.name.span, "the stock")?,
            },
            both_ways: !written.both_ways.is_empty(),
            clearances,
            written: written.name.span,
        })
    }

    /// What is said of a pass with the side that its motion leaves no choice of.
    fn says_more(&self, context: &mut Context<'g>, written: &ast::Mill) -> bool {
        let passes = written.passes.iter().map(|run| (run.key.span, "passes"));
        let both = written.both_ways.iter().map(|span| (*span, "both ways"));
        let leans = written.attitudes.iter().filter(|(word, _)| word.node != "stock");
        let leans = leans.map(|(word, _)| (word.span, if word.node == "lead" { "lead" } else { "tilt" }));
        let Some((span, word)) = passes.chain(both).chain(leans).next() else { return false };
        let message = format!("`{}` says `side` and `{word}`", written.name.node);
        let help = "one pass with the side of the cutter covers the surface, and the cutter leans as that leaves least";
        context.report(Diagnostic::new(Code::Milling, span, message).help(help));
        true
    }

    fn is_of_tool(&self, path: &ast::Path) -> bool {
        path.segments.first().is_some_and(|owner| self.tools.iter().any(|(tool, ..)| tool.node == owner.node))
    }

    /// A surface of a tool that is fixed to the work.
    fn fixture(&mut self, context: &mut Context<'g>, path: &ast::Path, work: FrameRef) -> Option<MillingObstacle<'g>> {
        let (pieces, frame) = self.cutter(context, path)?;
        let steps = self.path_between(context, work, frame, path.span)?;
        let t_work_fixture = Chain::new(context.graph, steps.into_iter().flat_map(|(_, steps)| steps).collect());
        let pose = t_work_fixture.pose();
        let parts = pose.rotation.0.into_iter().chain([pose.translation]).flat_map(|vector| vector.0);
        let variables = context.graph.variables_of(&parts.collect::<Vec<_>>());
        let moving = self.machines[work.0]
            .2
            .axes
            .iter()
            .find(|axis| axis.variable.as_variable().is_some_and(|variable| variables.contains(&variable)));
        if let Some(axis) = moving {
            let message =
                format!("`{}` moves against the work: `{}` turns or shifts it", path.joined(), axis.name.node);
            let help =
                "what is kept clear of stands still in the frame of the work: mount it on that or on what carries it";
            context.report(Diagnostic::new(Code::Milling, path.span, message).help(help));
            return None;
        }
        if let Some(edge) = pieces.iter().find(|piece| matches!(piece.shape, ToolShape::Edge(_))) {
            let message = format!("`{}` is an edge; a cutter keeps clear of surfaces", edge.name);
            context.report(Diagnostic::new(Code::Milling, path.span, message));
            return None;
        }
        Some(MillingObstacle::Fixture { pieces, t_work_fixture })
    }

    /// The pieces of a cutter's surface, and the frame that the cutter sits on.
    fn cutter(&mut self, context: &mut Context<'g>, path: &ast::Path) -> Option<(Vec<CutterPiece<'g>>, FrameRef)> {
        let is_other = |owner: &Name| self.names.contains_key(&owner.node) && !context.is_unmade(&owner.node);
        if !self.is_of_tool(path) && path.segments.first().is_some_and(is_other) {
            let message = format!("`{}` is no surface of a tool", path.joined());
            let help = "name a surface of the cutter: `e.cutting`";
            context.report(Diagnostic::new(Code::WrongKind, path.span, message).help(help));
            return None;
        }
        let available = self.available(context, path)?;
        let frame = available.first()?.frame;
        let piece = |available: super::available::Available<'g>| CutterPiece {
            name: available.name,
            shape: available.shape,
            unknowns: available.unknowns,
        };
        Some((available.into_iter().map(piece).collect(), frame))
    }

    /// Where the passes lie on a surface.
    fn area(&self, context: &mut Context<'g>, surface: usize, runs: [&ast::MillRun; 2]) -> Option<MilledArea<'g>> {
        let surface = &self.surfaces[surface].0;
        let [first, second] = runs;
        if first.key.node == second.key.node {
            let message = format!("passes are counted by `{}` and run along it", first.key.node);
            let help = "a pass runs along the other coordinate of the surface";
            context.report(Diagnostic::new(Code::Milling, second.key.span, message).help(help));
            return None;
        }
        let corners = surface.sample.as_ref().and_then(|sample| match &sample.grid {
            SampleGrid::Shares { corners, .. } => Some((*corners, sample.coordinates.clone())),
            _ => None,
        });
        let is_share = |run: &ast::MillRun| SHARES.contains(&run.key.node.as_str()) && run.definition.is_none();
        let shares = runs.into_iter().filter(|run| is_share(run)).count();
        let (coordinates, dimensions, shares) = match (shares, corners) {
            (0, _) => {
                let found = runs.map(|run| {
                    let key = (&run.key, run.definition.as_ref());
                    sample::coordinate(context, key, surface, &self.scope)
                });
                let [first, second] = found;
                let coordinates = [first?, second?];
                let dimensions = coordinates.each_ref().map(|coordinate| coordinate.dimension);
                (coordinates, dimensions, None)
            }
            (2, Some((corners, coordinates))) => {
                (coordinates, [Dimension::NUMBER; 2], Some((corners, first.key.node == SHARES[1])))
            }
            (2, None) => {
                let message =
                    format!("`{}` has no corners, between which `{}` would run", surface.name, first.key.node);
                let help = format!(
                    "give it a sample with `toe_root`, `heel_root`, `toe_tip` and `heel_tip`, or name two coordinates of `{}`",
                    surface.name
                );
                context.report(Diagnostic::new(Code::Milling, first.key.span, message).help(help));
                return None;
            }
            _ => {
                let message = "`profilewise` and `lengthwise` go together";
                let help =
                    "count the passes by one of them and run along the other, or name two coordinates of the surface";
                context.report(Diagnostic::new(Code::Milling, second.key.span, message).help(help));
                return None;
            }
        };
        let ranges = [0, 1]
            .map(|k| context.range(&runs[k].range, &self.scope, dimensions[k], &format!("`{}`", runs[k].key.node)));
        let ranges = [ranges[0]?, ranges[1]?];
        // a polar angle that does not jump within the area
        let coordinates = match shares {
            Some(_) => coordinates,
            None => {
                let [first, second] = coordinates;
                let middle = ranges.map(|(low, high)| 0.5 * (low + high));
                [surface.about(first, middle[0]), surface.about(second, middle[1])]
            }
        };
        let names = runs.map(|run| run.key.node.clone());
        let variables = names.each_ref().map(|name| context.variable(name.clone(), Role::SurfaceParameter, f64::NAN));
        Some(MilledArea { coordinates, names, dimensions, ranges, shares, variables })
    }

    /// What a run says behind its word: a height or a distance, or a number.
    fn amount(&self, context: &mut Context<'g>, run: &ast::MillRun, [least, most]: [f64; 2]) -> Option<f64> {
        let is_count = run.word.node == "by";
        let (dimension, what) =
            if is_count { (Dimension::NUMBER, "the number") } else { (Dimension::LENGTH, run.word.node.as_str()) };
        let value = context.scalar(&run.value, &self.scope, dimension, what)?;
        let value = context.require_constant(value, run.value.span, what)?;
        let message = match is_count {
            true if value.fract() != 0.0 || !(least..=most).contains(&value) => {
                format!("the number must be a whole number from {least} to {most}, not {value}")
            }
            false if value <= 0.0 => format!("`{}` must be above zero", run.word.node),
            _ => return Some(value),
        };
        context.report(Diagnostic::new(Code::Milling, run.value.span, message));
        None
    }

    /// Lead, tilt and stock; zero where they are not said.
    fn attitudes(
        &self,
        context: &mut Context<'g>,
        written: &ast::Mill,
        area: &MilledArea<'g>,
    ) -> Option<[Expr<'g>; 3]> {
        const KNOWN: [(&str, Dimension); 3] =
            [("lead", Dimension::ANGLE), ("tilt", Dimension::ANGLE), ("stock", Dimension::LENGTH)];
        let mut found: [Option<(Expr<'g>, Span)>; 3] = [None; 3];
        if !context.spend(self.scope.len(), written.name.span) {
            return None;
        }
        let mut scope = self.scope.clone();
        for k in [0, 1] {
            scope.insert(area.names[k].clone(), Value::Scalar(area.variables[k], area.dimensions[k]));
        }
        for (word, value) in &written.attitudes {
            let Some(place) = KNOWN.iter().position(|(known, _)| *known == word.node) else { continue };
            let scope = if word.node == "stock" { &self.scope } else { &scope };
            let expr = context.scalar(value, scope, KNOWN[place].1, &format!("`{}`", word.node))?;
            if let Some((_, first)) = found[place].replace((expr, word.span)) {
                let name = Name { node: word.node.clone(), span: word.span };
                context.duplicate(&name, first);
                return None;
            }
        }
        Some(found.map(|found| found.map_or_else(|| context.graph.constant(0.0), |(expr, _)| expr)))
    }

    fn kept_clear(
        &mut self,
        context: &mut Context<'g>,
        written: &ast::MillClearance,
        (work, sits): (FrameRef, FrameRef),
        job: &ast::Job,
    ) -> Option<MillingClearance<'g>> {
        let obstacle = if self.is_of_tool(&written.surface) {
            self.fixture(context, &written.surface, work)?
        } else {
            let surface = self.finished(context, &written.surface, job)?;
            let (its, own) = &self.surfaces[surface];
            if own.0 == work.0 && own.1 != work.1 {
                let message = format!("`{}` is given in `{}`, not in `{}`", its.name, its.frame, self.frame_name(work));
                context.report(Diagnostic::new(Code::Milling, written.surface.span, message));
                return None;
            }
            MillingObstacle::Surface(surface)
        };
        let (body, frame) = self.cutter(context, &written.body)?;
        if frame != sits {
            let message = format!(
                "`{}` sits on `{}`, the cutter on `{}`",
                written.body.joined(),
                self.frame_name(frame),
                self.frame_name(sits)
            );
            context.report(Diagnostic::new(Code::Milling, written.body.span, message));
            return None;
        }
        let distance = context.scalar(&written.distance, &self.scope, Dimension::LENGTH, "the clearance")?;
        let distance = context.require_constant(distance, written.distance.span, "the clearance")?;
        if distance < 0.0 {
            let message = "the clearance is below zero: the cutter would cut in";
            let help = "say how far it stays away, `by 0.1 mm`, or `by 0 mm` where it may touch";
            context.report(Diagnostic::new(Code::Milling, written.distance.span, message).help(help));
            return None;
        }
        let body_name = written.body.joined();
        Some(MillingClearance { obstacle, distance, body_name, body, written: written.surface.span })
    }
}

/// What is said once.
fn only<'w>(
    context: &mut Context<'_>,
    written: &ast::Mill,
    said: &'w [ast::MillRun],
    (word, example): (&str, &str),
) -> Option<&'w ast::MillRun> {
    match said {
        [one] => Some(one),
        [] => {
            let message = format!("`{}` does not say `{word}`", written.name.node);
            context.report(Diagnostic::new(Code::Milling, written.name.span, message).help(example));
            None
        }
        [first, second, ..] => {
            let message = format!("`{word}` is said twice");
            let twice = Diagnostic::new(Code::Milling, second.key.span, message);
            context.report(twice.note(first.key.span, "first here"));
            None
        }
    }
}

fn spacing(run: &ast::MillRun, amount: f64, is_side: bool) -> Option<PassSpacing> {
    match run.word.node.as_str() {
        "by" if is_side => Some(PassSpacing::Side(amount as usize)),
        _ if is_side => None,
        "scallop" => Some(PassSpacing::Scallop(amount)),
        "step" => Some(PassSpacing::Step(amount)),
        "by" => Some(PassSpacing::Count(amount as usize)),
        _ => None,
    }
}

fn blocks(run: &ast::MillRun, amount: f64) -> Option<BlockLength> {
    match run.word.node.as_str() {
        "chord" => Some(BlockLength::Chord(amount)),
        "step" => Some(BlockLength::Step(amount)),
        "by" => Some(BlockLength::Count(amount as usize)),
        _ => None,
    }
}
