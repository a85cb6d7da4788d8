//! Parameters of machines and tools get their values.

use std::collections::{HashMap, HashSet};
use std::fmt;
use std::rc::Rc;

use flank_expr::Expr;

use crate::definitions::profile;
use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::rewriting::Rewriting;
use crate::diagnostics::source::{Name, Span};
use crate::model::{Parameter, RangedVariable, ValueSource};
use crate::syntax::ast::{Argument, Dimension, Expression, ExpressionKind, Param};
use crate::values::context::{Context, READABLE, Role};
use crate::values::dimension::{shown, shown_like};
use crate::values::functions::plural;
use crate::values::segment::Profile;
use crate::values::value::{Constant, Scope, Value};

/// Values from outside the text, by full name (`ratio`, `m.swivel`): they win over what the text says.
pub(crate) type Overrides = HashMap<String, Expression>;

/// Where a parameter's values come from.
pub(crate) enum Source<'a, 'g> {
    /// A definition by itself: no values unless by default.
    Definition,
    /// `machine m = definition(setting: value, …)` in a job; `first` is the earlier one of the job that it is again, if it is one.
    Instance {
        name: &'a Name,
        definition: &'a str,
        settings: &'a [Argument],
        job: &'a Scope<'g>,
        first: Option<&'a str>,
    },
    /// A machine by itself, under its own name: settings may have no value.
    Standing { name: &'a Name },
    /// The job itself.
    Job,
}

impl<'a> Source<'a, '_> {
    /// The place of the one who gives the values.
    pub(crate) fn user(&self) -> Option<Span> {
        match self {
            Source::Instance { name, .. } => Some(name.span),
            Source::Definition | Source::Standing { .. } | Source::Job => None,
        }
    }

    /// Who gives the value that a parameter has where nobody gives another one.
    fn by_default(&self) -> ValueSource {
        match self {
            Source::Instance { definition, .. } => ValueSource::Definition((*definition).to_string()),
            Source::Standing { name } => ValueSource::Definition(name.node.clone()),
            Source::Definition | Source::Job => ValueSource::Job,
        }
    }
}

/// The value of a parameter as somebody gives it.
struct Given<'g> {
    definition: Expr<'g>,
    written: Span,
    by: ValueSource,
}

impl<'g> Given<'g> {
    /// As a number; NaN while it depends on parameters without values.
    fn number(&self, context: &mut Context<'g>, param: &Param) -> Option<f64> {
        match context.constant_kept(self.definition) {
            Constant::Unknown => Some(f64::NAN),
            Constant::Known(value) if value.is_finite() => Some(value),
            _ => context.require_constant(self.definition, self.written, shown_name(param)),
        }
    }
}

/// The short name: a default is looked at once by itself and once for each use, and both must say the same.
fn shown_name(param: &Param) -> ShownName<'_> {
    ShownName(&param.name.node)
}

#[derive(Clone, Copy)]
struct ShownName<'a>(&'a str);

impl fmt::Display for ShownName<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}`", self.0)
    }
}

/// Makes a variable for each `param`, puts it into the scope and gives the list of them.
pub(crate) struct Binder<'a, 'g> {
    pub(crate) source: Source<'a, 'g>,
    pub(crate) overrides: &'a Overrides,
    pub(crate) parameters: Vec<Parameter<'g>>,
    pub(crate) missing: Vec<Name>,
    /// All of them, of a machine that stands by itself.
    pub(crate) standing: Vec<RangedVariable<'g>>,
    /// The settings of an instance by name.
    settings: HashMap<&'a str, &'a Expression>,
    /// Of one that is an earlier one again the variables of those that are not what they are there.
    other: Vec<Expr<'g>>,
}

impl<'a, 'g> Binder<'a, 'g> {
    pub(crate) fn new(source: Source<'a, 'g>, overrides: &'a Overrides) -> Binder<'a, 'g> {
        let given: &[Argument] = match source {
            Source::Instance { settings, .. } => settings,
            Source::Definition | Source::Standing { .. } | Source::Job => &[],
        };
        let named = given.iter().filter_map(|setting| Some((setting.name.as_ref()?.node.as_str(), &setting.value)));
        // of two with one name the first counts: the second is reported
        let settings = named.rev().collect();
        let (parameters, missing, standing, other) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Binder { source, overrides, parameters, missing, standing, settings, other }
    }

    /// One parameter.
    pub(crate) fn bind(&mut self, context: &mut Context<'g>, param: &Param, scope: &mut Scope<'g>) {
        if is_profile(&param.dimension) {
            match self.profile(context, param) {
                Some(profile) => profile::insert(scope, &param.name.node, profile),
                None => drop(scope.insert(param.name.node.clone(), Value::Poison)),
            }
            return;
        }
        let value = self.bound(context, param, scope).unwrap_or(Value::Poison);
        scope.insert(param.name.node.clone(), value);
    }

    /// The variable that stands for it; nothing if something is wrong (and reported).
    fn bound(&mut self, context: &mut Context<'g>, param: &Param, scope: &Scope<'g>) -> Option<Value<'g>> {
        let dimension = context.dimension(&param.dimension)?;
        if param.is_error && param.dimension.is_count() {
            let message = format!("{} is a count: an error may be as small as it likes", shown_name(param));
            let help = "a whole number that may differ is a parameter, such as `param name : count = 0`";
            context.report(Diagnostic::new(Code::WrongDimension, param.dimension.span, message).help(help));
            return None;
        }
        let name = match &self.source {
            Source::Instance { name, .. } | Source::Standing { name } => format!("{}.{}", name.node, param.name.node),
            Source::Definition | Source::Job => param.name.node.clone(),
        };
        let given = match self.given(context, param, &name, scope) {
            Some((expression, value, by)) => {
                let definition = context.require(&value, dimension, expression.span, shown_name(param))?;
                Some(Given { definition, written: expression.span, by })
            }
            None if param.is_error => {
                let definition = context.graph.constant(0.0);
                Some(Given { definition, written: param.name.span, by: self.source.by_default() })
            }
            None => None,
        };
        let first = self.in_first(param);
        let given = match (given, first) {
            (Some(given), Some(first)) => Some(self.taken_over(context, given, first)),
            (given, _) => given,
        };
        if given.is_none() && !matches!(self.source, Source::Definition | Source::Standing { .. }) {
            self.missing.push(param.name.clone());
        }
        let value = given.as_ref().map_or(Some(f64::NAN), |given| given.number(context, param))?;
        let checked_at = given.as_ref().map_or(param.name.span, |given| given.written);
        // what follows from a value that is refused is no finding of its own
        let range = self.check_value(context, param, value, scope, checked_at).ok()?;
        let step = match &param.step {
            Some(step) => checked_step(context, param, (step, scope), dimension).ok()?,
            None => None,
        };
        let variable = context.variable(name.clone(), Role::Parameter, value);
        if given.as_ref().is_some_and(|given| first.is_some_and(|first| given.definition != first)) {
            self.other.push(variable);
        }
        let is_count = param.dimension.is_count();
        if is_count {
            context.set_count(variable);
        }
        if matches!(self.source, Source::Standing { .. }) {
            let (low, high) = range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
            self.standing.push(RangedVariable {
                name: name.clone(),
                variable,
                dimension,
                low,
                high,
                is_count,
                piece: None,
            });
        }
        if let Some(given) = &given {
            context.note_value(param.name.span, given.written, &Value::Scalar(variable, dimension));
        }
        if let Some(Given { definition, written, by: given_by }) = given {
            let doc = param.doc.clone();
            let value_in_text = match given_by {
                ValueSource::Caller => self.in_text(context, param, scope).unwrap_or(f64::NAN),
                ValueSource::Definition(_) | ValueSource::Job => value,
            };
            self.parameters.push(Parameter {
                name,
                variable,
                dimension,
                definition,
                value,
                value_in_text,
                is_count,
                is_error: param.is_error,
                range,
                step,
                doc,
                given_by,
                written,
            });
        }
        Some(Value::Scalar(variable, dimension))
    }

    /// The variable of a parameter in the earlier machine or tool that this one is again.
    fn in_first(&self, param: &Param) -> Option<Expr<'g>> {
        let Source::Instance { job, first: Some(first), .. } = self.source else { return None };
        match job.get(&format!("{first}.{}", param.name.node)) {
            Some(Value::Scalar(variable, _)) => variable.as_variable().map(|_| *variable),
            _ => None,
        }
    }

    /// What nobody gives a value is what it is in the earlier one, and follows that, unless it is made of what is another one here.
    fn taken_over(&self, context: &Context<'g>, given: Given<'g>, first: Expr<'g>) -> Given<'g> {
        if !matches!(given.by, ValueSource::Definition(_)) {
            return given;
        }
        let is_own = context.variables_of(&[given.definition]).iter().any(|variable| self.other.contains(variable));
        let value = context.constant_kept(given.definition);
        if is_own || !matches!(value, Constant::Known(value) if value == context.value_of(first)) {
            // given a value there it has that here, too, whatever it is made of
            context.decides(first);
            return given;
        }
        Given { definition: first, ..given }
    }

    /// The profile that a parameter is set to; nothing if something is wrong (and reported).
    fn profile(&mut self, context: &mut Context<'g>, param: &Param) -> Option<Rc<Profile<'g>>> {
        let name = &param.name;
        let values = param.default.iter().chain(&param.step).map(|value| value.span);
        let places: Vec<Span> = values.chain(param.range.as_ref().map(|range| range.span)).collect();
        if let Some(&place) = places.first() {
            let message =
                format!("{} is a profile: it has no range, no step, and no value by default", shown_name(param));
            let written = format!("param {} : profile", name.node);
            let end = places.iter().map(|place| place.end).fold(place.end, u32::max);
            let behind = Span { start: param.dimension.span.end, end, ..place };
            let valued = Diagnostic::new(Code::WrongKind, place, message)
                .help(format!("write `{written}`; the job gives the profile"));
            context.report(valued.cure(format!("write `{written}`"), behind, ""));
            return None;
        }
        let job = match self.source {
            Source::Instance { job, .. } => job,
            Source::Definition | Source::Standing { .. } => return Some(profile::standing(context, name)),
            Source::Job => {
                let message = format!("{} is a profile: a job writes its own", shown_name(param));
                let help = format!("write `profile {} {{ … }}`", name.node);
                context.report(Diagnostic::new(Code::WrongKind, param.dimension.span, message).help(help));
                return None;
            }
        };
        let Some(setting) = self.settings.get(name.node.as_str()).copied() else {
            self.missing.push(name.clone());
            return None;
        };
        match context.evaluate(setting, job) {
            Value::Profile(profile) => Some(profile),
            Value::Poison => None,
            other => {
                let message = format!("{} must be a profile, this is {}", shown_name(param), other.described());
                let help = "give it the name of a `profile` of the job";
                context.report(Diagnostic::new(Code::WrongKind, setting.span, message).help(help));
                None
            }
        }
    }

    /// What a parameter is set to, and who says so: the caller before the job before the definition.
    fn given<'p>(
        &self,
        context: &mut Context<'g>,
        param: &'p Param,
        full_name: &str,
        scope: &Scope<'g>,
    ) -> Option<(&'p Expression, Value<'g>, ValueSource)>
    where
        'a: 'p,
    {
        let setting = self.settings.get(param.name.node.as_str()).copied();
        let overridden = match self.source {
            Source::Definition => None,
            _ => self.overrides.get(full_name),
        };
        match (overridden, setting, &self.source) {
            (Some(value), _, _) => {
                context.taken.insert(value.span.file);
                Some((value, context.evaluate(value, &Scope::new()), ValueSource::Caller))
            }
            (None, Some(value), Source::Instance { job, .. }) => {
                Some((value, context.evaluate(value, job), ValueSource::Job))
            }
            _ => param.default.as_ref().map(|value| (value, context.evaluate(value, scope), self.source.by_default())),
        }
    }

    /// What the text sets a parameter to that the caller gives another value.
    fn in_text(&self, context: &mut Context<'g>, param: &Param, scope: &Scope<'g>) -> Option<f64> {
        let value = match (self.settings.get(param.name.node.as_str()), &self.source) {
            (Some(value), Source::Instance { job, .. }) => context.evaluate(value, job),
            _ => context.evaluate(param.default.as_ref()?, scope),
        };
        match value {
            Value::Scalar(value, _) => match context.constant_kept(value) {
                Constant::Known(value) => Some(value),
                _ => None,
            },
            _ => None,
        }
    }

    /// Counts are whole, and not negative unless their declared range says so; values lie in that range, which is given back if there
    /// is one.
    ///
    /// # Errors
    /// If the value is refused, which has been reported.
    fn check_value(
        &self,
        context: &mut Context<'g>,
        param: &Param,
        value: f64,
        scope: &Scope<'g>,
        span: Span,
    ) -> Result<Option<(f64, f64)>, Refused> {
        let what = shown_name(param);
        let is_count = param.dimension.is_count() && value.is_finite();
        if is_count && value.fract() != 0.0 {
            let message = format!("{what} is a count: it must be a whole number, not {value}");
            context.report(Diagnostic::new(Code::WrongDimension, span, message));
            return Err(Refused);
        }
        let (Some(range), Some(dimension)) = (&param.range, context.dimension(&param.dimension)) else {
            if is_count && value < 0.0 {
                let message = format!(
                    "{what} is a count, and {value} is below 0: without a range of its own a count starts from 0"
                );
                let name = &param.name.node;
                let range = format!("in {value} .. {}", -value);
                let help = format!("if it may be negative, give it a range: `param {name} : count {range}`");
                let behind = Span { start: param.dimension.span.end, ..param.dimension.span };
                let negative = Diagnostic::new(Code::WrongDimension, span, message).help(help);
                context.report(negative.cure(format!("write `count {range}`"), behind, format!(" {range}")));
                return Err(Refused);
            }
            return Ok(None);
        };
        let Some((low, high)) = context.range(range, scope, dimension, what) else { return Ok(None) };
        if param.dimension.is_count() && low.ceil() > high.floor() {
            let message = format!("{what} is a count: no whole number lies in {low} .. {high}");
            context.report(Diagnostic::new(Code::WrongDimension, range.span, message));
            return Err(Refused);
        }
        if value < low || value > high {
            let ends = [(value, &range.high), (low, &range.low), (high, &range.high)];
            let [value, low, high] = ends.map(|(value, written)| shown_like(value, dimension, written));
            let message = format!("{what} is {value}, outside its range {low} .. {high}");
            let diagnostic =
                Diagnostic::new(Code::OutOfRange, span, message).note(range.span, "the range is stated here");
            context.report(diagnostic);
            return Err(Refused);
        }
        Ok(Some((low, high)))
    }

    /// What was given too little or too much.
    pub(crate) fn finish(&self, context: &mut Context<'g>, params: &[&Param]) {
        let names: Vec<&str> = self.missing.iter().map(|name| name.node.as_str()).collect();
        match &self.source {
            Source::Definition | Source::Standing { .. } => {}
            Source::Job => {
                for name in &self.missing {
                    let message = format!("`{}` has no value", name.node);
                    let help = "give it one: `param name : … = …`";
                    let diagnostic = Diagnostic::new(Code::MissingValue, name.span, message).help(help);
                    let written = params.iter().find(|param| param.name == *name);
                    let valued = written.and_then(|param| Some((param, starting_value(param)?)));
                    context.report(valued.into_iter().fold(diagnostic, |diagnostic, (param, value)| {
                        diagnostic.cure(format!("write `= {value}`"), behind(param), format!(" = {value}"))
                    }));
                }
            }
            Source::Instance { name, definition, settings, job, .. } => {
                let known: HashSet<&str> = params.iter().map(|param| param.name.node.as_str()).collect();
                let unknown = settings.iter().filter_map(|setting| setting.name.as_ref());
                let unknown = unknown.filter(|name| !known.contains(name.node.as_str())).count();
                // a setting that is misspelt, or cannot be read, is one mistake, not also a missing one
                let is_read = settings.iter().all(|setting| setting.value.kind != ExpressionKind::Error);
                if names.len() > unknown && is_read {
                    let missing = params.iter().filter(|param| names.contains(&param.name.node.as_str())).copied();
                    let message = format!("`{}` needs {}", name.node, with_dimensions(context, missing));
                    let help =
                        format!("give the value{}: `{definition}({}: …)`", plural(names.len()), names.join(": …, "));
                    let mut diagnostic = Diagnostic::new(Code::MissingValue, name.span, message).help(help);
                    let missing = params.iter().filter(|param| names.contains(&param.name.node.as_str())).copied();
                    for settings in settings_to_choose_from(&missing.collect::<Vec<_>>(), job) {
                        let definition = (*definition).to_string();
                        diagnostic = diagnostic.rewriting(Rewriting::Settings(name.span, definition, settings));
                    }
                    context.report(diagnostic);
                }
                check_settings(context, settings, params);
            }
        }
    }
}

/// Settings to start from, with each of the job's profiles where a profile is missing.
pub(crate) fn settings_to_choose_from(missing: &[&Param], job: &Scope<'_>) -> Vec<String> {
    let is_profile_value = |(_, value): &(&String, &Value<'_>)| matches!(value, Value::Profile(_));
    let mut profiles: Vec<&str> = job.iter().filter(is_profile_value).map(|(name, _)| name.as_str()).collect();
    profiles.sort_unstable();
    if !missing.iter().any(|param| is_profile(&param.dimension)) {
        profiles = vec![""];
    }
    let with = |profile: &&str| {
        let setting = |param: &&Param| {
            let given = if is_profile(&param.dimension) { Some((*profile).to_string()) } else { starting_value(param) };
            Some(format!("{}: {}", param.name.node, given?))
        };
        Some(missing.iter().map(setting).collect::<Option<Vec<String>>>()?.join(", "))
    };
    profiles.iter().take(READABLE).filter_map(with).collect()
}

/// Behind all that is said of a parameter.
fn behind(param: &Param) -> Span {
    let said = [param.range.as_ref().map(|range| range.span), param.step.as_ref().map(|step| step.span)];
    let end = said.into_iter().flatten().fold(param.dimension.span.end, |end, span| end.max(span.end));
    Span { start: end, end, ..param.dimension.span }
}

/// A value that the parameter may have: the lower end of its range, or one of its unit; none of a profile.
fn starting_value(param: &Param) -> Option<String> {
    let ones: Vec<(&str, i32)> =
        param.dimension.factors.iter().map(|(name, power)| (name.node.as_str(), *power)).collect();
    let unit = match ones[..] {
        [("length", 1)] => " mm",
        [("angle", 1)] => " deg",
        [("number" | "count", 1)] => "",
        [("length", 1), ("angle", -1)] => " mm/rev",
        [("angle", 1), ("length", -1)] => " deg/mm",
        _ => return None,
    };
    let low = param.range.as_ref().and_then(|range| match &range.low.kind {
        ExpressionKind::Number(number, units) => match units.as_slice() {
            [(unit, 1)] => Some(format!("{number} {}", unit.node)),
            [] => Some(number.to_string()),
            _ => None,
        },
        _ => None,
    });
    Some(low.unwrap_or_else(|| format!("1{unit}")))
}

/// A value cannot stay, which has been reported.
struct Refused;

/// What a parameter is set in multiples of; none while that depends on parameters without values.
///
/// # Errors
/// If the step is refused, which has been reported.
fn checked_step<'g>(
    context: &mut Context<'g>,
    param: &Param,
    (step, scope): (&Expression, &Scope<'g>),
    dimension: crate::values::dimension::Dimension,
) -> Result<Option<f64>, Refused> {
    let (what, span) = (format!("the step of {}", shown_name(param)), step.span);
    if param.dimension.is_count() {
        let message = format!("{} is a count: it goes in whole steps, and has no step of its own", shown_name(param));
        let step = Diagnostic::new(Code::WrongDimension, span, message).help("leave the step out");
        context.report(step.rewriting(Rewriting::Without("step", span)));
        return Err(Refused);
    }
    let value = context.evaluate(step, scope);
    let definition = context.require(&value, dimension, span, &what).ok_or(Refused)?;
    if let Constant::Unknown = context.constant_kept(definition) {
        return Ok(None);
    }
    let value = context.require_constant(definition, span, &what).ok_or(Refused)?;
    if value <= 0.0 {
        let message = format!("{what} is {}: it must be above zero", shown(value, dimension));
        let help = "write the smallest change that can be set, for example `step 0.001 mm`";
        context.report(Diagnostic::new(Code::OutOfRange, span, message).help(help));
        return Err(Refused);
    }
    Ok(Some(value))
}

/// Whether a parameter is a profile.
pub(crate) fn is_profile(dimension: &Dimension) -> bool {
    matches!(dimension.factors.as_slice(), [(name, _)] if name.node == "profile")
}

/// `radius` (length), `teeth` (count)
fn with_dimensions<'p>(context: &mut Context<'_>, params: impl Iterator<Item = &'p Param>) -> String {
    let each = params.map(|param| {
        let of = match &param.dimension {
            dimension if dimension.is_count() => "count".to_string(),
            dimension if is_profile(dimension) => "profile".to_string(),
            dimension => context.dimension(dimension).map_or(String::new(), |of| of.to_string()),
        };
        format!("`{}` ({of})", param.name.node)
    });
    each.collect::<Vec<_>>().join(", ")
}

fn check_settings(context: &mut Context<'_>, settings: &[Argument], params: &[&Param]) {
    let known: HashSet<&str> = params.iter().map(|param| param.name.node.as_str()).collect();
    let mut seen: HashMap<&str, Span> = HashMap::new();
    for setting in settings {
        match &setting.name {
            // the parser has reported settings that cannot be read
            None if setting.value.kind == ExpressionKind::Error => {}
            None => {
                let message = "a setting has a name: `name: value`";
                let nameless = Diagnostic::new(Code::WrongArguments, setting.value.span, message);
                let few = (1..=READABLE).contains(&params.len());
                let settings =
                    few.then(|| format!("its settings are {}", with_dimensions(context, params.iter().copied())));
                context.report(Diagnostic { help: settings, ..nameless });
            }
            Some(name) if !known.contains(name.node.as_str()) => {
                context.unknown(name, "setting", known.iter().copied());
            }
            Some(name) => match seen.get(name.node.as_str()) {
                Some(&first) => {
                    let message = format!("`{}` is given twice", name.node);
                    let diagnostic =
                        Diagnostic::new(Code::DuplicateName, name.span, message).note(first, "first given here");
                    context.report(diagnostic);
                }
                None => drop(seen.insert(&name.node, name.span)),
            },
        }
    }
}
