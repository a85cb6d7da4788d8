//! Surfaces of tools.

use pest::iterators::Pair;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::{Name, Span};

use super::super::ast::{
    Body, EachSide, Expression, ExpressionKind, Let, Profile, Segment, Side, SurfaceParameter, ToolSurface,
};
use super::super::grammar::Rule;
use super::super::scan::shorten;
use super::{Build, Head, Parts};

impl Build<'_> {
    pub(super) fn tool_surface(&mut self, pair: Pair<'_, Rule>) -> ToolSurface {
        let mut parts = pair.into_inner();
        let head = parts.next().unwrap_or_else(|| unreachable!("the grammar has a head here"));
        let mut surface = self.surface_head(head);
        for part in parts {
            self.surface_statement(&mut surface, part);
        }
        self.finish_surface(surface)
    }

    pub(in super::super) fn surface_head(&mut self, pair: Pair<'_, Rule>) -> SurfaceParts {
        let doc = self.doc(&pair);
        let mut parts = Parts::of(pair);
        let names = parts.all(Rule::name).into_iter().map(|name| self.name(name)).collect();
        let parameters =
            parts.all(Rule::surface_parameter).into_iter().map(|pair| self.surface_parameter(pair)).collect();
        let each = parts.optional(Rule::each_side).map(|each| self.each_side(each));
        SurfaceParts { doc, parameters, each, ..SurfaceParts::new(names) }
    }

    pub(super) fn each_side(&mut self, pair: Pair<'_, Rule>) -> EachSide {
        let mut parts = Parts::of(pair);
        let name = self.name(parts.required(Rule::name));
        let vector = parts.required(Rule::vector);
        let span = self.span(&vector);
        let values = Parts::of(vector).all(Rule::expression).into_iter().map(|value| self.expression(value)).collect();
        EachSide { name, values, span }
    }

    fn surface_parameter(&mut self, pair: Pair<'_, Rule>) -> SurfaceParameter {
        let mut parts = Parts::of(pair.clone());
        let name = self.name(parts.required(Rule::name));
        match parts.optional(Rule::name) {
            Some(profile) => SurfaceParameter::Along(name, self.name(profile)),
            None => SurfaceParameter::Within(self.parameter(pair)),
        }
    }

    pub(super) fn profile(&mut self, pair: Pair<'_, Rule>) -> Profile {
        let mut parts = pair.into_inner();
        let head = parts.next().unwrap_or_else(|| unreachable!("the grammar has a head here"));
        let Head { doc, name, .. } = self.head(head);
        let segments = parts.filter_map(|part| self.segment(part)).collect();
        Profile { doc, name, segments, broken: false }
    }

    /// A segment of a profile; nothing for its closing brace and the end of a piece.
    pub(in super::super) fn segment(&mut self, pair: Pair<'_, Rule>) -> Option<Segment> {
        if pair.as_rule() != Rule::segment {
            return None;
        }
        let doc = self.doc(&pair);
        let mut parts = Parts::of(pair);
        let name = self.name(parts.required(Rule::name));
        Some(Segment { doc, name, value: self.expression(parts.required(Rule::expression)) })
    }

    /// Adds a statement to a tool's surface.
    pub(in super::super) fn surface_statement(&mut self, surface: &mut SurfaceParts, pair: Pair<'_, Rule>) {
        let span = self.span(&pair);
        match pair.as_rule() {
            Rule::let_statement => surface.lets.push(self.let_statement(pair)),
            Rule::at => {
                self.once("at", surface.at.as_ref().map(|at| at.span), span);
                surface.at = Some(self.expression(Parts::of(pair).required(Rule::expression)));
            }
            Rule::body => {
                self.once("body", surface.body.as_ref().map(|body| body.span), span);
                surface.body = Some(Body { side: self.side(pair), span });
            }
            _ => {}
        }
    }

    fn side(&mut self, pair: Pair<'_, Rule>) -> Side {
        let mut parts = Parts::of(pair);
        match parts.optional(Rule::side) {
            Some(side) if side.as_str() == "inside" => Side::Inside,
            Some(_) => Side::Outside,
            None if parts.optional(Rule::kw_where).is_some() => {
                Side::Where(self.expression(parts.required(Rule::expression)))
            }
            None => Side::Towards(self.expression(parts.required(Rule::expression))),
        }
    }

    fn once(&mut self, word: &str, first: Option<Span>, second: Span) {
        if let Some(first) = first {
            let keyword = Span { end: second.start + word.len() as u32, ..second };
            let message = format!("a second `{word}` in one surface");
            self.diagnostics.push(Diagnostic::new(Code::Syntax, keyword, message).note(first, "the first one"));
        }
    }

    /// A tool's surface, with a report on what it lacks.
    pub(in super::super) fn finish_surface(&mut self, parts: SurfaceParts) -> ToolSurface {
        let SurfaceParts { doc, names, parameters, each, lets, at, body, broken } = parts;
        let name = names[0].clone();
        let place = name.span;
        if at.is_none() && !broken {
            let message = format!("the surface `{}` does not say where its points are", shorten(&name.node));
            self.report(place, message, "say where they are, as in `at = [x, y, z]`");
        }
        if body.is_none() && !broken {
            let message = format!("the surface `{}` does not say on which side the steel is", shorten(&name.node));
            let help = "say it by `body …`, such as `body inside`, `body outside`, `body towards [x, y, z]` or, of three parameters, `body where u^2 + v^2 < r^2`";
            let mut diagnostic = Diagnostic::new(Code::Syntax, place, message).help(help);
            for (at, body) in at.iter().flat_map(|at| ["body inside", "body outside"].map(|body| (at, body))) {
                let behind = Span { start: at.span.end, ..at.span };
                diagnostic = diagnostic.cure(format!("add `{body}`"), behind, format!("\n        {body}"));
            }
            self.diagnostics.push(diagnostic);
        }
        let error = Expression { kind: ExpressionKind::Error, span: place };
        let at = at.unwrap_or_else(|| error.clone());
        let body = body.unwrap_or(Body { side: Side::Towards(error), span: place });
        ToolSurface { doc, names, parameters, each, lets, at, body }
    }
}

/// A tool's surface while it is being read.
pub(in super::super) struct SurfaceParts {
    pub(in super::super) doc: Vec<String>,
    /// At least one.
    pub(in super::super) names: Vec<Name>,
    pub(in super::super) parameters: Vec<SurfaceParameter>,
    pub(in super::super) each: Option<EachSide>,
    pub(in super::super) lets: Vec<Let>,
    pub(in super::super) at: Option<Expression>,
    pub(in super::super) body: Option<Body>,
    /// Whether a statement of it did not parse.
    pub(in super::super) broken: bool,
}

impl SurfaceParts {
    pub(in super::super) fn new(names: Vec<Name>) -> SurfaceParts {
        SurfaceParts {
            doc: Vec::new(),
            names,
            parameters: Vec::new(),
            each: None,
            lets: Vec::new(),
            at: None,
            body: None,
            broken: false,
        }
    }
}
