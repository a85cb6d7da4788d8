//! What a compilation knows while it runs: variables with their values, functions, findings.

use std::cell::{Cell, RefCell};
use std::collections::{HashMap, HashSet};
use std::fmt;
use std::rc::Rc;

use flank_expr::{Expr, Graph, Interval, IntervalEvaluator, Tape, VariableId};

use crate::definitions::index::KnownValue;
use crate::diagnostics::codes::Code;
use crate::diagnostics::rewriting::Rewriting;
use crate::diagnostics::source::{FileId, Name, Span};
use crate::diagnostics::spelling::closest;
use crate::diagnostics::{Diagnostic, Note, Severity};
use crate::limits;
use crate::syntax::ast;
use crate::values::angle_product::AngleProducts;
use crate::values::dimension::{Dimension, shown};
use crate::values::steel_side::SteelSide;
use crate::values::table_files::Tables;
use crate::values::value::{Constant, Value};

/// Names that a reader takes in at once.
pub(crate) const READABLE: usize = 16;

/// What a variable stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    Parameter,
    Axis,
    Motion,
    SurfaceParameter,
    /// What a function takes, where it differentiates by it and the argument stands still.
    StandingArgument,
    /// The same where the argument moves.
    MovingArgument,
    /// What an integral runs over.
    Integration,
    /// What an equation gives, in the equation.
    Unknown,
    /// What is known of a job once it is solved.
    Quantity,
}

impl Role {
    /// Whether it has one value in a job.
    pub(crate) fn stands_still(self) -> bool {
        matches!(self, Role::Parameter | Role::StandingArgument)
    }

    pub(crate) fn described(self) -> &'static str {
        match self {
            Role::Parameter => "parameter",
            Role::Axis => "axis",
            Role::Motion => "motion",
            Role::SurfaceParameter => "surface parameter",
            Role::Integration => "variable of integration",
            Role::Unknown => "unknown",
            Role::Quantity => "quantity",
            Role::StandingArgument | Role::MovingArgument => "argument",
        }
    }
}

/// Why it is not known where an expression lies.
pub(crate) enum Unranged {
    /// It depends on a parameter that has no value yet.
    Unknown,
    /// It depends on something that moves without ends.
    Endless(String),
}

/// The state of one compilation.
pub(crate) struct Context<'g> {
    pub(crate) graph: &'g Graph,
    pub(crate) functions: HashMap<String, Rc<ast::Function>>,
    pub(crate) tables: Tables,
    /// Whether a file is used that was not read.
    pub(crate) lacks_files: bool,
    /// Whether what specs are tested by is looked at, and what names amount to.
    pub(crate) is_whole: bool,
    variables: Vec<Expr<'g>>,
    roles: Vec<Role>,
    values: Vec<f64>,
    /// Where those lie that move, if it is known.
    ranges: Vec<Option<Interval>>,
    /// Which of them are declared as counts, by their numbers: their values are whole, and as negative as their ranges say.
    counts: HashSet<usize>,
    diagnostics: Vec<Diagnostic>,
    /// Errors among them.
    errors: usize,
    reported: HashSet<(Code, Span)>,
    /// The axes of the machine whose constants are being looked at, and the values that they move.
    pub(crate) moving: HashSet<String>,
    /// Texts of values from outside that a parameter has taken, right or wrong.
    pub(crate) taken: HashSet<FileId>,
    /// Names that the item being looked at uses without their being defined.
    unknown: HashSet<String>,
    /// What the job being looked at declares farther down, and where.
    pub(crate) later: HashMap<String, Span>,
    /// What it declares that could not be made, which has been reported: its values are not known. Machines and tools; for expectations
    /// all else, too.
    pub(crate) unmade: HashSet<String>,
    /// Its surfaces that lack a sample, which has been reported.
    pub(crate) unsampled: HashSet<String>,
    /// Whether a requirement did not hold in the item being looked at.
    is_unmet: bool,
    /// Steps of evaluation so far: expressions looked at and nodes walked over.
    steps: Cell<usize>,
    /// Which variables have decided a number of the model, an `if` or how far something is laid out, by their numbers.
    decisive: RefCell<Vec<bool>>,
    /// On which sides of the surfaces of the job that is built the steel was seen.
    pub(crate) steel_sides: Vec<SteelSide<'g>>,
    /// A limit on the work has been exceeded and reported.
    exhausted: bool,
    /// Points of the samples so far.
    pub(crate) sample_points: usize,
    pub(crate) call_depth: usize,
    /// Whose values are looked at: `job.m`.
    pub(crate) owner: Rc<str>,
    pub(super) angle_products: AngleProducts<'g>,
    /// What names amount to.
    noted: Vec<NotedValue<'g>>,
}

/// What a name amounts to, not yet a number.
struct NotedValue<'g> {
    name: Span,
    written: Span,
    of: Rc<str>,
    value: Expr<'g>,
    dimension: Dimension,
}

impl<'g> Context<'g> {
    pub(crate) fn new(graph: &'g Graph, tables: Tables) -> Context<'g> {
        assert_eq!(graph.variable_count(), 0, "a compilation starts with a graph of its own");
        Context {
            graph,
            functions: HashMap::new(),
            tables,
            lacks_files: false,
            is_whole: false,
            variables: Vec::new(),
            roles: Vec::new(),
            values: Vec::new(),
            ranges: Vec::new(),
            counts: HashSet::new(),
            diagnostics: Vec::new(),
            errors: 0,
            reported: HashSet::new(),
            taken: HashSet::new(),
            unknown: HashSet::new(),
            later: HashMap::new(),
            unmade: HashSet::new(),
            unsampled: HashSet::new(),
            is_unmet: false,
            moving: HashSet::new(),
            steps: Cell::new(0),
            decisive: RefCell::default(),
            steel_sides: Vec::new(),
            exhausted: false,
            sample_points: 0,
            call_depth: 0,
            owner: Rc::from(""),
            angle_products: AngleProducts::default(),
            noted: Vec::new(),
        }
    }

    /// Notes what a name amounts to, for the index of names.
    pub(crate) fn note_value(&mut self, name: Span, written: Span, value: &Value<'g>) {
        if let Value::Scalar(value, dimension) = value
            && !self.owner.is_empty()
            && self.is_whole
        {
            let (of, value, dimension) = (Rc::clone(&self.owner), *value, *dimension);
            self.noted.push(NotedValue { name, written, of, value, dimension });
        }
    }

    /// What names amount to, as far as it is known and stands still, and the dimensions of the others, both sorted by where they are defined.
    pub(crate) fn known_values(&mut self) -> (Vec<KnownValue>, Vec<(Span, Dimension)>) {
        let noted = std::mem::take(&mut self.noted);
        let exprs: Vec<Expr<'g>> = noted.iter().map(|noted| noted.value).collect();
        let values = self.graph.evaluate(&exprs, &self.values);
        let (known, others): (Vec<_>, Vec<_>) = noted.into_iter().zip(values).partition(|(_, value)| value.is_finite());
        let known = known.into_iter().map(|(NotedValue { name, written, of, dimension, .. }, value)| KnownValue {
            name,
            written,
            of: of.to_string(),
            value,
            dimension,
        });
        let mut known: Vec<KnownValue> = known.collect();
        known.sort_by(|a, b| (a.name, &a.of).cmp(&(b.name, &b.of)));
        // a job is built again where splines go through points of its samples
        known.dedup_by(|a, b| (a.name, &a.of, a.value) == (b.name, &b.of, b.value));
        let mut others: Vec<(Span, Dimension)> =
            others.iter().map(|(noted, _)| (noted.name, noted.dimension)).collect();
        others.sort_by_key(|(name, _)| *name);
        others.dedup_by_key(|(name, _)| *name);
        (known, others)
    }

    /// Reports the second definition of a name, unless the parser has reported that the name is missing.
    pub(crate) fn duplicate(&mut self, name: &Name, first: Span) {
        self.duplicate_with(name, first, None);
    }

    /// The same with a way out.
    pub(crate) fn duplicate_with(&mut self, name: &Name, first: Span, help: Option<&str>) {
        if !name.node.is_empty() {
            let message = format!("`{}` is defined twice", name.node);
            let twice = Diagnostic::new(Code::DuplicateName, name.span, message).note(first, "first here");
            self.report(match help {
                Some(help) => twice.help(help),
                None => twice,
            });
        }
    }

    /// Whether the names of one block are each given once; those that are not are reported.
    pub(crate) fn are_distinct<'n>(&mut self, names: impl IntoIterator<Item = &'n Name>) -> bool {
        let mut seen: HashMap<&str, Span> = HashMap::new();
        let mut are_distinct = true;
        for name in names {
            if let Some(first) = seen.get(name.node.as_str()) {
                self.duplicate(name, *first);
                are_distinct = false;
            } else {
                seen.insert(&name.node, name.span);
            }
        }
        are_distinct
    }

    /// Keeps a finding, unless the same was found at the same place before (a definition is looked at once by itself and
    /// once for each use), or there are enough of them.
    pub(crate) fn report(&mut self, diagnostic: Diagnostic) {
        if diagnostic.severity() == Severity::Warning || self.errors < limits::MISTAKES.most {
            self.keep(diagnostic);
        } else if self.errors == limits::MISTAKES.most {
            self.keep(limits::MISTAKES.exceeded(diagnostic.span));
        }
    }

    fn keep(&mut self, diagnostic: Diagnostic) {
        // formulas that were cut off are wrong in ways that nobody wrote, and so are those of values that are not as required
        let is_cut_off = diagnostic.code != Code::LimitExceeded && self.graph.is_full();
        let follows = diagnostic.code == Code::NotANumber && self.is_unmet;
        let is_own_fault = !is_cut_off && !follows;
        self.is_unmet |= diagnostic.code == Code::Unmet;
        if is_own_fault && self.reported.insert((diagnostic.code, diagnostic.span)) {
            self.errors += usize::from(diagnostic.severity() == Severity::Error);
            self.diagnostics.push(diagnostic);
        }
    }

    pub(crate) fn finish(self) -> Vec<Diagnostic> {
        self.diagnostics
    }

    pub(crate) fn has_errors(&self) -> bool {
        self.errors > 0
    }

    /// Whether jobs may lack parameters that they have in a right text: a file, a name, a value or a machine is wrong, and that not in the texts
    /// of values from outside.
    pub(crate) fn lacks_parameters(&self, is_from_outside: impl Fn(Span) -> bool) -> bool {
        let is_of_parts = |code: Code| code != Code::Unmet && code < Code::UndrivenAxis;
        self.diagnostics.iter().any(|finding| is_of_parts(finding.code) && !is_from_outside(finding.span))
    }

    /// Number of findings so far, to ask later whether there are new ones.
    pub(crate) fn findings(&self) -> usize {
        self.diagnostics.len()
    }

    pub(crate) fn variable(&mut self, name: impl Into<String>, role: Role, value: f64) -> Expr<'g> {
        let variable = self.graph.variable(name);
        self.variables.push(variable);
        self.roles.push(role);
        self.values.push(value);
        self.ranges.push(None);
        variable
    }

    /// Says where a variable that moves lies.
    pub(crate) fn set_range(&mut self, variable: Expr<'g>, range: Interval) {
        if let Some(variable) = variable.as_variable() {
            self.ranges[variable.index()] = Some(range);
        }
    }

    /// Says that a variable is declared as a count.
    pub(crate) fn set_count(&mut self, variable: Expr<'g>) {
        self.counts.extend(variable.as_variable().map(|variable| variable.index()));
    }

    /// Whether an expression is a variable that is declared as a count.
    pub(crate) fn is_count(&self, expr: Expr<'g>) -> bool {
        expr.as_variable().is_some_and(|variable| self.counts.contains(&variable.index()))
    }

    /// The variables of an expression, each with its value or where it lies.
    pub(crate) fn ranges_of(&self, expr: Expr<'g>) -> Result<Vec<(Expr<'g>, Interval)>, Unranged> {
        self.ranged(expr, true)
    }

    pub(super) fn ranged(&self, expr: Expr<'g>, decides: bool) -> Result<Vec<(Expr<'g>, Interval)>, Unranged> {
        let known = |variable: Expr<'g>| {
            let index = variable.as_variable().map_or(0, VariableId::index);
            let role = self.roles[index];
            match self.ranges[index] {
                _ if role.stands_still() && self.values[index].is_nan() => Err(Unranged::Unknown),
                _ if role.stands_still() => {
                    if decides {
                        self.decide([index]);
                    }
                    Ok((variable, Interval::point(self.values[index])))
                }
                // a range that depends on parameters without values
                Some(range) if !range.continuous => Err(Unranged::Unknown),
                Some(range) => Ok((variable, range)),
                None => {
                    let name = variable.as_variable().map_or_else(String::new, |id| self.graph.variable_name(id));
                    Err(Unranged::Endless(format!("the {} `{name}`", role.described())))
                }
            }
        };
        self.variables_of(&[expr]).into_iter().map(known).collect()
    }

    /// Where an expression lies.
    pub(crate) fn enclosure(&self, expr: Expr<'g>) -> Result<Interval, Unranged> {
        self.enclosed(expr, true)
    }

    pub(super) fn enclosed(&self, expr: Expr<'g>, decides: bool) -> Result<Interval, Unranged> {
        let ranges = self.ranged(expr, decides)?;
        let (variables, ranges): (Vec<_>, Vec<_>) = ranges.into_iter().unzip();
        let mut out = [Interval::WHOLE];
        if let Ok(tape) = Tape::new(&[expr], &variables) {
            IntervalEvaluator::new(&tape).run(&ranges, &mut out);
        }
        Ok(out[0])
    }

    /// Adds a note to those findings, from a number of them on, that lie in a part of the text.
    pub(crate) fn note_since(&mut self, first: usize, part: Span, note: &Note) {
        let lies_there = |place: Span| place.file == part.file && part.start <= place.start && place.end <= part.end;
        for diagnostic in self.diagnostics[first..].iter_mut().filter(|diagnostic| lies_there(diagnostic.span)) {
            diagnostic.notes.push(note.clone());
        }
    }

    /// Says what to write in a finding about just one place, if it does not.
    pub(crate) fn help_on(&mut self, (code, place): (Code, Span), help: &str) {
        let is_meant = |found: &&mut Diagnostic| found.code == code && found.span == place && found.help.is_none();
        if let Some(found) = self.diagnostics.iter_mut().find(is_meant) {
            found.help = Some(help.to_string());
        }
    }

    /// Says what to write in those findings, from a number of them on, that do not.
    pub(crate) fn help_since(&mut self, first: usize, help: &str) {
        for diagnostic in self.diagnostics[first..].iter_mut().filter(|diagnostic| diagnostic.help.is_none()) {
            diagnostic.help = Some(help.to_string());
        }
    }

    /// The variables that expressions depend on.
    pub(crate) fn variables_of(&self, exprs: &[Expr<'g>]) -> Vec<Expr<'g>> {
        self.graph.variables_of(exprs).into_iter().map(|variable| self.variables[variable.index()]).collect()
    }

    /// What a variable stands for; nothing of other expressions.
    pub(crate) fn role(&self, expr: Expr<'g>) -> Option<Role> {
        expr.as_variable().map(|variable| self.roles[variable.index()])
    }

    /// The value of a variable; NaN where it has none yet.
    pub(crate) fn value_of(&self, variable: Expr<'g>) -> f64 {
        variable.as_variable().map_or(f64::NAN, |variable| self.values[variable.index()])
    }

    pub(crate) fn values(&self) -> &[f64] {
        &self.values
    }

    /// The number that an expression of parameters is, which decides something.
    pub(crate) fn constant(&self, expr: Expr<'g>) -> Constant {
        self.evaluated(expr, true)
    }

    /// The same for a parameter, of which the model keeps the expression as well.
    pub(crate) fn constant_kept(&self, expr: Expr<'g>) -> Constant {
        self.evaluated(expr, false)
    }

    /// Notes that a number of the model follows from the value of a variable.
    pub(crate) fn decides(&self, variable: Expr<'g>) {
        self.decide(variable.as_variable().map(|variable| variable.index()));
    }

    fn decide(&self, variables: impl IntoIterator<Item = usize>) {
        let mut decisive = self.decisive.borrow_mut();
        for variable in variables {
            if decisive.len() <= variable {
                decisive.resize(variable + 1, false);
            }
            decisive[variable] = true;
        }
    }

    /// Whether a number of the model follows from the value of a variable beside its surfaces, which are functions of it.
    pub(crate) fn is_decisive(&self, variable: Expr<'g>) -> bool {
        let index = variable.as_variable().map(|variable| variable.index());
        index.is_some_and(|index| self.decisive.borrow().get(index).copied().unwrap_or(false))
    }

    fn evaluated(&self, expr: Expr<'g>, decides: bool) -> Constant {
        if let Some(value) = expr.as_constant() {
            return Constant::Known(value);
        }
        if self.steps.get() > limits::EVALUATION_STEPS.most {
            return Constant::Unknown;
        }
        let (size, variables) = self.graph.extent(expr);
        self.steps.set(self.steps.get() + size);
        if let Some(moving) = variables.iter().find(|variable| !self.roles[variable.index()].stands_still()) {
            let role = self.roles[moving.index()].described();
            return Constant::Moves(format!("the {role} `{}`", self.graph.variable_name(*moving)));
        }
        if variables.iter().any(|variable| self.values[variable.index()].is_nan()) {
            return Constant::Unknown;
        }
        if decides {
            self.decide(variables.iter().map(|variable| variable.index()));
        }
        Constant::Known(self.graph.evaluate(&[expr], &self.values)[0])
    }

    /// The number behind a value that must be one; `None` (reported where it is the user's fault) if it is not.
    pub(crate) fn require_constant(&mut self, expr: Expr<'g>, span: Span, what: impl fmt::Display) -> Option<f64> {
        match self.constant(expr) {
            Constant::Known(value) if value.is_finite() => Some(value),
            Constant::Known(value) => {
                self.not_finite(value, Some(expr), span, what);
                None
            }
            Constant::Unknown => None,
            Constant::Moves(name) => {
                let message = format!("{what} must stand still, but depends on {name}");
                self.report(Diagnostic::new(Code::NotConstant, span, message));
                None
            }
        }
    }

    /// A scalar of the wanted dimension, or `None` with the reason reported.
    pub(crate) fn require(
        &mut self,
        value: &Value<'g>,
        wanted: Dimension,
        span: Span,
        what: impl fmt::Display,
    ) -> Option<Expr<'g>> {
        match value {
            Value::Poison => None,
            Value::Scalar(expr, dimension) if wanted.accepts(*dimension) => {
                if wanted == Dimension::ANGLE {
                    self.warn_of_angle_product((*expr, *dimension));
                }
                Some(*expr)
            }
            other => {
                let wanted_text = Value::Scalar(self.graph.constant(0.0), wanted).described();
                let message = format!("{what} must be {wanted_text}, this is {}", other.described());
                self.report(with_unit_help(Diagnostic::new(Code::WrongDimension, span, message), wanted, other));
                None
            }
        }
    }

    /// Whether another mistake would be told: looking for a near name among many takes long.
    pub(crate) fn tells_more(&self) -> bool {
        self.errors <= limits::MISTAKES.most
    }

    /// Begins with a machine, tool, job or function.
    pub(crate) fn begin_item(&mut self) {
        self.unknown.clear();
        self.is_unmet = false;
    }

    /// Reports an unknown name with the nearest known one: once for each item, however often the item uses it.
    pub(crate) fn unknown<'a>(&mut self, name: &Name, kind: &str, known: impl Iterator<Item = &'a str>) {
        self.unknown_with(name, kind, |diagnostic| suggesting(diagnostic, name, known));
    }

    fn unknown_with(&mut self, name: &Name, kind: &str, way_out: impl FnOnce(Diagnostic) -> Diagnostic) {
        // a missing name has been reported, and so has what could not be made
        let is_reported = name.node.is_empty() || self.is_unmade(&name.node);
        if is_reported || !self.tells_more() || !self.unknown.insert(name.node.clone()) {
            return;
        }
        let message = format!("there is no {kind} `{}`", name.node);
        self.report(way_out(Diagnostic::new(Code::UnknownName, name.span, message)));
    }

    /// Whether a name, or what it is a member of, is declared and could not be made, which has been reported.
    pub(crate) fn is_unmade(&self, name: &str) -> bool {
        self.unmade.contains(name.split('.').next().unwrap_or_default())
    }

    /// Reports a name that has no value; one that the job gives farther down has none yet.
    pub(crate) fn unknown_value<'a>(&mut self, name: &Name, known: impl Iterator<Item = &'a str>) {
        let first = name.node.split('.').next().unwrap_or_default();
        if self.is_unmade(first) {
            return;
        }
        let Some(place) = self.later.get(first).copied() else {
            return self.unknown_with(name, "value", |diagnostic| suggesting_value(diagnostic, name, known));
        };
        let message = format!("`{}` has no value yet", name.node);
        let note = format!("`{first}` is declared here, and statements know only what stands above them");
        self.report(Diagnostic::new(Code::UnknownName, name.span, message).note(place, note));
    }

    /// The same for what other files may declare: nothing is missing while one that is used could not be read, which has been reported.
    pub(crate) fn unknown_item<'a>(&mut self, name: &Name, kind: &str, known: impl Iterator<Item = &'a str>) {
        if !self.lacks_files {
            self.unknown(name, kind, known);
        }
    }

    /// Counts one step of evaluation; false (reported once) when a text asks for too many.
    pub(crate) fn step(&mut self, span: Span) -> bool {
        self.spend(1, span)
    }

    /// The same for many steps.
    pub(crate) fn spend(&mut self, steps: usize, span: Span) -> bool {
        self.steps.set(self.steps.get().saturating_add(steps));
        let exceeded = if self.steps.get() > limits::EVALUATION_STEPS.most {
            limits::EVALUATION_STEPS
        } else if self.graph.is_full() {
            limits::GRAPH_OPERATIONS
        } else {
            return true;
        };
        if !std::mem::replace(&mut self.exhausted, true) {
            self.report(exceeded.exceeded(span));
        }
        false
    }
}

/// Says what to write where a plain number stands for an angle or a length, and either for a length per angle.
fn with_unit_help(diagnostic: Diagnostic, wanted: Dimension, found: &Value<'_>) -> Diagnostic {
    const LEAD: Dimension = Dimension { length: 1, angle: -1 };
    let Value::Scalar(expr, dimension) = found else { return diagnostic };
    let (value, span) = (expr.as_constant(), diagnostic.span);
    match (wanted, *dimension) {
        (LEAD, Dimension::NUMBER | Dimension::LENGTH) => {
            let help = match value.map(|value| shown(value, Dimension::LENGTH)) {
                Some(value) => format!("say for which angle: `{value}/rev` a turn, or `{value}/rad` a radian"),
                None => "say for which angle: a length becomes a lead by `/ 1 rev`, a turn, or `/ 1 rad`".to_string(),
            };
            let per: fn(Span, [&'static str; 2]) -> Rewriting = match *dimension {
                Dimension::LENGTH => |span, [_, angle]| Rewriting::Per(span, angle),
                _ => |span, [both, _]| Rewriting::Unit(span, both),
            };
            let units = [["mm/rev", "rev"], ["mm/rad", "rad"]];
            units.into_iter().fold(diagnostic.help(help), |diagnostic, unit| diagnostic.rewriting(per(span, unit)))
        }
        (Dimension::ANGLE | Dimension::LENGTH, Dimension::NUMBER) => {
            let (help, unit) = match (value, wanted) {
                // what is no whole number of degrees may be radians
                (Some(value), Dimension::ANGLE) if value.fract() != 0.0 && value.abs() < std::f64::consts::TAU => {
                    (format!("give it a unit: `{value} deg`, or `{value} rad`"), "deg")
                }
                (Some(value), Dimension::ANGLE) => (format!("give it a unit: `{value} deg`"), "deg"),
                (Some(value), _) => (format!("give it a unit: `{value} mm`"), "mm"),
                (None, Dimension::ANGLE) => ("a number of radians becomes an angle by `* 1 rad`".to_string(), "rad"),
                (None, _) => ("a number of millimetres becomes a length by `* 1 mm`".to_string(), "mm"),
            };
            diagnostic.help(help).rewriting(Rewriting::Unit(span, unit))
        }
        _ => diagnostic,
    }
}

/// A finding about a name with the nearest of the known ones, or all of them.
pub(crate) fn suggesting<'a>(
    mut diagnostic: Diagnostic,
    name: &Name,
    known: impl Iterator<Item = &'a str>,
) -> Diagnostic {
    let known: Vec<&str> = known.filter(|name| !name.is_empty()).collect();
    diagnostic.help = did_you_mean(&name.node, known.iter().copied());
    // of those alike, the one that the sentence names
    let meant = diagnostic.help.as_deref().and_then(|help| help.strip_prefix("did you mean `")?.strip_suffix("`?"));
    match meant.map(str::to_string) {
        Some(meant) => diagnostic.cure(format!("write `{meant}`"), name.span, meant),
        None => {
            let mut known = known;
            known.sort_unstable();
            known.dedup();
            let few = known.iter().filter(|_| known.len() <= READABLE);
            few.fold(diagnostic, |diagnostic, choice| diagnostic.cure(format!("write `{choice}`"), name.span, *choice))
        }
    }
}

/// The same about a value, for which another one far off can stand only by chance: these are told, and none of them is written.
fn suggesting_value<'a>(diagnostic: Diagnostic, name: &Name, known: impl Iterator<Item = &'a str>) -> Diagnostic {
    if matches!(name.node.as_str(), "tau" | "TAU" | "Tau" | "τ") {
        let help = "a whole turn is `2 * pi`";
        return diagnostic.help(help).cure("write `2 * pi`", name.span, "(2 * pi)");
    }
    let is_pi = name.node.eq_ignore_ascii_case("pi") || name.node == "π";
    let known: Vec<&str> = known.chain(is_pi.then_some("pi")).collect();
    if closest(&name.node, known.iter().copied()).is_some() {
        return suggesting(diagnostic, name, known.into_iter());
    }
    Diagnostic { help: listed(known).map(|list| format!("values here: {list}")), ..diagnostic }
}

/// The same about a word somewhere in the place of the finding.
pub(crate) fn suggesting_word<'a>(
    diagnostic: Diagnostic,
    word: &str,
    known: impl Iterator<Item = &'a str>,
) -> Diagnostic {
    let place = diagnostic.span;
    let mut suggested = suggesting(diagnostic, &Name { node: word.to_string(), span: place }, known);
    let choices: Vec<String> = suggested.cures.drain(..).map(|cure| cure.replacement).collect();
    let word = |choice| Rewriting::Word(place, word.to_string(), choice);
    choices.into_iter().fold(suggested, |suggested, choice| suggested.rewriting(word(choice)))
}

/// The nearest of the known names, as a sentence.
pub(crate) fn did_you_mean<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<String> {
    let known: Vec<&str> = known.filter(|name| !name.is_empty()).collect();
    // of those alike, the first
    let mut in_order = known.clone();
    in_order.sort_unstable();
    match closest(name, in_order) {
        Some(meant) => Some(format!("did you mean `{meant}`?")),
        None => listed(known).map(|list| format!("there is: {list}")),
    }
}

/// Names in order, if there are some and not too many of them.
fn listed(mut known: Vec<&str>) -> Option<String> {
    known.retain(|name| !name.is_empty());
    known.sort_unstable();
    known.dedup();
    (!known.is_empty() && known.len() <= READABLE).then(|| quoted(&known))
}

/// Names in a list.
pub(crate) fn quoted(names: &[&str]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}
