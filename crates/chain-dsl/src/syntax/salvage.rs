//! What a statement that does not parse would have defined, so that its uses are not mistakes of their own.

use std::ops::Range;

use crate::diagnostics::source::{Name, Span, Spanned};

use super::ast::{
    Argument, Assignment, Axis, AxisKind, Body, Contact, Dimension, Drive, Expression, ExpressionKind, Frame, Function,
    GeneratedSurface, Instance, Item, JobStatement, Let, MachineStatement, Mill, NcWord, Param, Parameter, Path,
    Sample, SampleEntry, SampleValues, Sampled, Segment, Side, Solid, SurfaceParameter, ToolStatement, Type,
};
use super::build::{Head, SurfaceParts};
use super::scan::{Kind, Scan};
use super::words;

/// A machine's statement; nothing if it has no name.
pub(super) fn machine_statement(scan: &Scan, word: &str, range: Range<usize>) -> Option<MachineStatement> {
    let piece = Piece { scan, range };
    let name = piece.defined()?;
    Some(match word {
        "param" | "error" => MachineStatement::Param(piece.param(name)),
        "axis" | "unknown" => MachineStatement::Axis(piece.axis(name, word == "unknown")),
        "frame" => MachineStatement::Frame(piece.frame(name)),
        "insert" => MachineStatement::Insert(piece.frame(name)),
        "fix" => MachineStatement::Fix(piece.assignment()),
        "couple" => MachineStatement::Couple(piece.assignment()),
        "nc" => MachineStatement::Nc(NcWord { address: name, value: piece.error(), increment: None }),
        "close" | "require" | "expect" => return None,
        _ => MachineStatement::Let(piece.let_statement(name)),
    })
}

/// A tool's statement; nothing if it has no name.
pub(super) fn tool_statement(scan: &Scan, word: &str, range: Range<usize>) -> Option<ToolStatement> {
    let piece = Piece { scan, range };
    let name = piece.defined()?;
    Some(match word {
        "param" => ToolStatement::Param(piece.param(name)),
        "require" => return None,
        _ => ToolStatement::Let(piece.let_statement(name)),
    })
}

/// A job's statement; nothing if it has no name.
pub(super) fn job_statement(scan: &Scan, word: &str, range: Range<usize>) -> Option<JobStatement> {
    let piece = Piece { scan, range };
    // of these two it is known that something is mounted or driven, whatever it is
    match word {
        "mount" => {
            let names = if piece.names().is_empty() { vec![piece.nameless()] } else { piece.names() };
            return Some(JobStatement::Mount { names, frame: piece.path_after("on") });
        }
        "drive" => {
            return Some(JobStatement::Drive(Drive { targets: piece.paths(), values: vec![piece.error()] }));
        }
        _ => {}
    }
    let name = piece.defined()?;
    Some(match word {
        "param" => JobStatement::Param(piece.param(name)),
        "machine" => JobStatement::Machine(piece.instance(name)),
        "tool" => JobStatement::Tool(piece.instance(name)),
        "motion" => JobStatement::Motion(piece.parameter(piece.range.start + 1, name)),
        "unknown" => JobStatement::Unknown(piece.parameter(piece.range.start + 1, name)),
        "surface" => JobStatement::Surface(GeneratedSurface {
            doc: piece.doc(),
            names: piece.names(),
            frame: piece.path_after("in"),
            value: piece.error(),
        }),
        "trim" => JobStatement::Trim { surface: piece.path(piece.range.start + 1), by: piece.path_after("by") },
        "cut" => JobStatement::Cut { surface: piece.path(piece.range.start + 1), by: piece.path_after("by") },
        "sample" => JobStatement::Sample(piece.sample()),
        "mill" => JobStatement::Mill(piece.mill(name)),
        "solid" => {
            let (doc, frame, value) = (piece.doc(), piece.path_after("in"), piece.error());
            JobStatement::Solid(Solid { doc, name, frame, value })
        }
        "contact" => JobStatement::Contact(Contact {
            doc: piece.doc(),
            name,
            surfaces: ["=", "with"].map(|word| piece.path_after(word)),
            arguments: vec![Argument { name: None, value: piece.error() }],
        }),
        "require" | "want" | "expect" => return None,
        _ => JobStatement::Let(piece.let_statement(name)),
    })
}

/// Adds a broken statement to a tool's surface.
pub(super) fn surface_statement(scan: &Scan, parts: &mut SurfaceParts, word: &str, range: Range<usize>) {
    let piece = Piece { scan, range };
    parts.broken = true;
    match word {
        "at" => parts.at = Some(piece.error()),
        "body" => parts.body = Some(Body { side: Side::Towards(piece.error()), span: piece.span() }),
        _ => parts.lets.extend(piece.defined().map(|name| piece.let_statement(name))),
    }
}

/// A segment of a profile.
pub(super) fn segment(scan: &Scan, range: Range<usize>) -> Segment {
    let piece = Piece { scan, range };
    Segment { doc: piece.doc(), name: piece.name(piece.range.start), value: piece.error() }
}

/// What stands before the block of a machine, tool, profile or job.
pub(super) fn head(scan: &Scan, first: usize) -> Head {
    let piece = Piece { scan, range: first..first + 1 };
    // behind a hyphen stands a part of the name
    let extends = scan.is_name(first + 3) && !matches!(scan.say(first + 2), "{" | "-");
    let parent = match extends {
        true => Some(piece.name(first + 3)),
        // of which one is not known
        false => (scan.say(first + 2) == "extends").then(|| piece.nameless()),
    };
    Head {
        doc: piece.doc(),
        name: piece.defined().unwrap_or_else(|| piece.nameless()),
        extends: parent,
        changes: Vec::new(),
    }
}

/// What stands before the block of a tool's surface.
pub(super) fn surface_head(scan: &Scan, range: Range<usize>) -> SurfaceParts {
    let piece = Piece { scan, range };
    let mut names = piece.names();
    if names.is_empty() {
        names.push(piece.nameless());
    }
    let firsts = piece.firsts_in_parentheses();
    let parameters = firsts.into_iter().map(|index| piece.surface_parameter(index)).collect();
    SurfaceParts { doc: piece.doc(), parameters, ..SurfaceParts::new(names) }
}

/// A function; nothing for a `use` or a variant of a job.
pub(super) fn flat_item(scan: &Scan, word: &str, range: Range<usize>) -> Option<Item> {
    let piece = Piece { scan, range };
    if word != "fn" {
        return None;
    }
    let firsts = piece.firsts_in_parentheses();
    Some(Item::Function(Function {
        doc: piece.doc(),
        name: piece.defined()?,
        arguments: firsts.into_iter().map(|index| (piece.name(index), piece.value_type(index))).collect(),
        result: None,
        lets: Vec::new(),
        body: piece.error(),
    }))
}

/// The tokens of a broken statement.
struct Piece<'s> {
    scan: &'s Scan<'s>,
    range: Range<usize>,
}

impl Piece<'_> {
    fn span(&self) -> Span {
        self.scan.extent(self.range.clone())
    }

    fn error(&self) -> Expression {
        Expression { kind: ExpressionKind::Error, span: self.span() }
    }

    fn doc(&self) -> Vec<String> {
        self.scan.doc_above(self.scan.place(self.range.start).start)
    }

    fn name(&self, index: usize) -> Name {
        Spanned { node: self.scan.say(index).to_owned(), span: self.scan.place(index) }
    }

    /// The name that a report speaks of as missing.
    fn nameless(&self) -> Name {
        Spanned { node: String::new(), span: self.scan.place(self.range.start) }
    }

    /// The name after the first word, also behind a strange character; or the first word, if the two are swapped.
    fn defined(&self) -> Option<Name> {
        let first = self.range.start;
        let is_strange = self.scan.kind(first + 1) == Some(Kind::Strange);
        let mut places = [if is_strange { first + 2 } else { first + 1 }, first].into_iter();
        places.find(|&index| self.scan.is_name(index)).map(|index| self.name(index))
    }

    /// The tokens that say something.
    fn find(&self, word: &str) -> Option<usize> {
        self.range.clone().find(|&index| self.scan.say(index) == word)
    }

    /// The dimension in which a parameter is most likely measured: the first one named after it.
    fn dimension(&self, after: usize) -> Dimension {
        let named = (after..self.range.end).take_while(|&index| self.scan.say(index) != ",");
        let found = named.clone().find(|&index| words::DIMENSIONS.contains(&self.scan.say(index)));
        // of `length / angle` it is not known how much of it is meant
        let found = found.filter(|index| !matches!(self.scan.say(index + 1), "/" | "*" | "^"));
        let factor = found.map_or_else(|| self.nameless(), |index| self.name(index));
        Dimension { span: factor.span, factors: vec![(factor, 1)] }
    }

    fn value_type(&self, after: usize) -> Type {
        let dimension = self.dimension(after);
        Type { size: None, span: dimension.span, dimension }
    }

    fn range(&self) -> super::ast::Range {
        super::ast::Range { low: self.error(), high: self.error(), span: self.span() }
    }

    fn param(&self, name: Name) -> Param {
        let dimension = self.dimension(self.range.start);
        Param {
            doc: self.doc(),
            name,
            dimension,
            range: None,
            step: None,
            default: Some(self.error()),
            is_error: false,
        }
    }

    fn parameter(&self, index: usize, name: Name) -> Parameter {
        Parameter { doc: self.doc(), name, dimension: self.dimension(index), range: self.range() }
    }

    fn surface_parameter(&self, index: usize) -> SurfaceParameter {
        let name = self.name(index);
        if self.scan.say(index + 2) != "along" {
            return SurfaceParameter::Within(self.parameter(index, name));
        }
        let profile = if self.scan.is_name(index + 3) { self.name(index + 3) } else { self.nameless() };
        SurfaceParameter::Along(name, profile)
    }

    fn let_statement(&self, name: Name) -> Let {
        Let { name, value: self.error() }
    }

    fn axis(&self, name: Name, is_unknown: bool) -> Axis {
        let kinds = [("linear", AxisKind::Linear), ("rotary", AxisKind::Rotary)];
        let found = kinds.into_iter().find_map(|(word, kind)| Some((kind, self.scan.place(self.find(word)?))));
        let (kind, kind_span) = found.unwrap_or((AxisKind::Unknown, name.span));
        Axis { doc: self.doc(), name, kind, kind_span, range: None, is_unknown }
    }

    /// A frame that hangs on another, be it unknown on which: a second root would be a mistake of its own.
    fn frame(&self, name: Name) -> Frame {
        Frame { doc: self.doc(), name, parent: Some(self.name_after("in")), transforms: Vec::new() }
    }

    fn assignment(&self) -> Assignment {
        Assignment { target: self.path(self.range.start + 1), value: self.error() }
    }

    fn name_after(&self, word: &str) -> Name {
        match self.find(word).map(|index| index + 1) {
            Some(index) if self.scan.is_name(index) && index < self.range.end => self.name(index),
            _ => self.nameless(),
        }
    }

    fn path_after(&self, word: &str) -> Path {
        self.path(self.find(word).map_or(self.range.end, |index| index + 1))
    }

    /// As much of a path as there is.
    fn path(&self, from: usize) -> Path {
        let mut segments = Vec::new();
        let mut index = from;
        while index < self.range.end && self.scan.is_name(index) {
            segments.push(self.name(index));
            index += 1;
            if self.scan.say(index) != "." {
                break;
            }
            index += 1;
            // what stands behind the dot is no name, which is reported
            if !self.scan.is_name(index) {
                segments.push(Spanned { span: self.scan.place(index), ..self.nameless() });
            }
        }
        if segments.is_empty() {
            segments.push(self.nameless());
        }
        let span = segments[0].span.to(segments[segments.len() - 1].span);
        Path { segments, span }
    }

    /// The paths behind the first word, with commas between them.
    fn paths(&self) -> Vec<Path> {
        let mut paths = vec![self.path(self.range.start + 1)];
        let mut index = self.range.start + 1;
        while index < self.range.end && (self.scan.is_name(index) || matches!(self.scan.say(index), "." | ",")) {
            index += 1;
            if self.scan.say(index - 1) == "," && index < self.range.end && self.scan.is_name(index) {
                paths.push(self.path(index));
            }
        }
        paths
    }

    /// The names behind the first word, or the first word itself where the two are swapped.
    fn names(&self) -> Vec<Name> {
        let behind = self.paths().into_iter().filter_map(|path| path.segments.into_iter().next());
        let names: Vec<Name> = behind.filter(|name| !name.node.is_empty()).collect();
        if names.is_empty() { self.defined().into_iter().collect() } else { names }
    }

    fn instance(&self, name: Name) -> Instance {
        let index = self.find("=").unwrap_or(self.range.start + 1) + 1;
        let named = index < self.range.end && self.scan.is_name(index);
        let definition = if named { self.name(index) } else { self.nameless() };
        let settings = self.firsts_in_parentheses().into_iter();
        let settings = settings.map(|index| Argument { name: Some(self.name(index)), value: self.error() });
        // what else there may be
        let others = Argument { name: None, value: self.error() };
        Instance { name, definition, settings: settings.chain([others]).collect() }
    }

    /// Its frame is known: the axes of that machine need no laws.
    fn mill(&self, name: Name) -> Mill {
        Mill {
            doc: self.doc(),
            name,
            surface: self.path_after("of"),
            cutter: self.path_after("with"),
            frame: self.path_after("in"),
            passes: Vec::new(),
            sides: Vec::new(),
            along: Vec::new(),
            attitudes: Vec::new(),
            both_ways: Vec::new(),
            clearances: Vec::new(),
            broken: true,
        }
    }

    fn sample(&self) -> Sample {
        let entry = SampleEntry { key: self.nameless(), definition: None, values: SampleValues::Value(self.error()) };
        Sample {
            surfaces: self.paths().into_iter().map(|surface| self.sampled(surface)).collect(),
            each: None,
            entries: vec![entry],
            keeps: Vec::new(),
            limits: Vec::new(),
            span: self.span(),
        }
    }

    /// What is sampled, with the name behind its `as`.
    fn sampled(&self, surface: Path) -> Sampled {
        let behind = self.range.clone().find(|&index| self.scan.place(index).start >= surface.span.end);
        let named = behind.filter(|&index| self.scan.say(index) == "as" && self.scan.is_name(index + 1));
        Sampled { surface, name: named.map(|index| self.name(index + 1)) }
    }

    /// The names right after the first opening parenthesis and after each comma on its level.
    fn firsts_in_parentheses(&self) -> Vec<usize> {
        let mut depth = 0usize;
        let mut firsts = Vec::new();
        for index in self.range.clone() {
            let separates = match self.scan.say(index) {
                "(" | "[" => {
                    depth += 1;
                    depth == 1
                }
                // what stands in further parentheses is a value
                ")" | "]" if depth <= 1 => break,
                ")" | "]" => {
                    depth -= 1;
                    false
                }
                "," => depth == 1,
                _ => false,
            };
            if separates && index + 1 < self.range.end && self.scan.is_name(index + 1) {
                firsts.push(index + 1);
            }
        }
        firsts
    }
}
