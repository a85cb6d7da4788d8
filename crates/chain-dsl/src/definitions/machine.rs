//! Machines: what `extends` amounts to, axes and their laws, the tree of frames.

use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap, HashSet};

use flank_expr::{Expr, Interval};

use crate::definitions::circles::{Following, report_circles};
use crate::definitions::closure::{self, Linkage};
use crate::definitions::instance::{Binder, Overrides, Source};
use crate::definitions::nc_word;
use crate::definitions::requirement;
use crate::definitions::transforms;
use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::rewriting::Rewriting;
use crate::diagnostics::source::{Name, Span};
use crate::diagnostics::spelling::closest;
use crate::limits;
use crate::model::{Frame, NcWord, Parameter, RangedVariable};
use crate::syntax::ast::{
    self, AxisKind, Close, Expression, ExpressionKind, Let, MachineStatement, Param, Requirement,
};
use crate::values::context::{Context, READABLE, Role};
use crate::values::dimension::{Dimension, WrittenUnit, written_unit};
use crate::values::value::{Constant, Scope, Value};

/// What a statement of a machine costs each time that the machine is built: it is looked for twins, replaces others, gets a
/// value, finds its place in the tree.
const STEPS_PER_STATEMENT: usize = 4;

/// All machines of a compilation by name.
pub(crate) type Machines = HashMap<String, ast::Machine>;

/// A machine with everything it inherits, each thing once.
#[derive(Default)]
pub(crate) struct Flat<'a> {
    constants: Named<'a, &'a MachineStatement>,
    axes: Named<'a, &'a ast::Axis>,
    laws: Named<'a, (&'a ast::Assignment, LawKind)>,
    /// Laws beside the first of their axis: perhaps meant for another one.
    repeated_laws: usize,
    frames: Named<'a, Hung<'a>>,
    closes: Vec<&'a Close>,
    /// Each with the place of its machine in the line.
    words: Vec<(&'a ast::NcWord, usize)>,
    /// Of all machines of the line: what a variant demands comes on top of what its parents do.
    requirements: Vec<&'a Requirement>,
    /// Each with the place of its machine in the line: a variant says it anew for those about the same.
    expectations: Vec<(&'a ast::Expectation, usize)>,
}

/// A frame, and the frame that it hangs on: the one that is written, or one that a variant inserted there.
#[derive(Clone, Copy)]
struct Hung<'a> {
    name: &'a Name,
    parent: Option<&'a Name>,
    transforms: &'a [ast::Call],
}

impl<'a> Hung<'a> {
    fn written(frame: &'a ast::Frame) -> Hung<'a> {
        Hung { name: &frame.name, parent: frame.parent.as_ref(), transforms: &frame.transforms }
    }
}

/// A law that the machine itself states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LawKind {
    Fix,
    Couple,
}

/// A machine with values.
pub(crate) struct Built<'g> {
    pub(crate) parameters: Vec<Parameter<'g>>,
    /// Of a machine that stands by itself.
    pub(crate) settings: Vec<RangedVariable<'g>>,
    pub(crate) scope: Scope<'g>,
    pub(crate) axes: Vec<BuiltAxis<'g>>,
    pub(crate) frames: Vec<Frame<'g>>,
    pub(crate) linkages: Vec<Linkage<'g>>,
    /// Names of all frames that the text declares, also those that could not be built.
    pub(crate) declared_frames: Vec<String>,
    /// Laws that belong to no axis (and have been reported).
    pub(crate) lost_laws: usize,
    /// Whether a transform of a frame is wrong (and has been reported).
    pub(crate) lacks_transforms: bool,
    /// What each job that uses it is to be like.
    pub(crate) expectations: Vec<ast::Expectation>,
}

/// An axis, perhaps with a law.
pub(crate) struct BuiltAxis<'g> {
    pub(crate) name: Name,
    /// `None` where it could not be read (and that has been reported).
    pub(crate) dimension: Option<Dimension>,
    pub(crate) variable: Expr<'g>,
    pub(crate) travel: Option<(f64, f64)>,
    /// What the travel is written in.
    pub(crate) travel_unit: Option<WrittenUnit>,
    /// Closed loops give its motion.
    pub(crate) is_unknown: bool,
    pub(crate) law: Option<(Option<Expr<'g>>, LawKind, Span)>,
    pub(crate) word: NcWord,
}

/// Names, and all that stand on them through however many; each pair is a name and what it stands on.
fn with_descendants<'n>(
    names: impl Iterator<Item = &'n str>,
    pairs: impl Iterator<Item = (&'n str, &'n str)>,
) -> HashSet<&'n str> {
    let mut children: HashMap<&str, Vec<&str>> = HashMap::new();
    pairs.for_each(|(child, parent)| children.entry(parent).or_default().push(child));
    let mut open: Vec<&str> = names.collect();
    let mut found: HashSet<&str> = open.iter().copied().collect();
    while let Some(name) = open.pop() {
        open.extend(children.get(name).into_iter().flatten().filter(|child| found.insert(child)));
    }
    found
}

/// What a machine consists of, its parents' things first; what a variant states again replaces the parent's.
pub(crate) fn flatten<'a, 'g>(
    context: &mut Context<'g>,
    machines: &'a Machines,
    machine: &'a ast::Machine,
) -> Option<Flat<'a>> {
    let mut line = vec![machine];
    while let Some(parent) = &line[line.len() - 1].extends {
        let Some(next) = machines.get(&parent.node) else {
            // what extends it itself would be a circle
            if context.tells_more() {
                let pairs = machines
                    .values()
                    .filter_map(|machine| Some((machine.name.node.as_str(), machine.extends.as_ref()?.node.as_str())));
                let child = line[line.len() - 1].name.node.as_str();
                let own = with_descendants([child].into_iter(), pairs);
                let others = machines.keys().map(String::as_str).filter(|name| !own.contains(name));
                context.unknown_item(parent, "machine", others);
            }
            return None;
        };
        if line.iter().any(|seen| seen.name.node == next.name.node) {
            // reported once: at the machine of the circle that is written first
            let circle = line.iter().skip_while(|seen| seen.name.node != next.name.node);
            let first = circle.min_by_key(|seen| seen.name.span).map(|seen| seen.name.span);
            if first == Some(machine.name.span) {
                let through = if line.len() == 1 { String::new() } else { format!(" through `{}`", line[1].name.node) };
                let message = format!("`{}` extends itself{through}", machine.name.node);
                let at = machine.extends.as_ref().map_or(machine.name.span, |name| name.span);
                let help = "a machine must stand by itself in the end, without `extends`";
                context.report(Diagnostic::new(Code::CyclicExtends, at, message).help(help));
            }
            return None;
        }
        if line.len() >= limits::EXTENDS_DEPTH.most {
            context.report(limits::EXTENDS_DEPTH.exceeded(parent.span));
            return None;
        }
        line.push(next);
    }
    let mut flat = Flat::default();
    for (place, machine) in line.into_iter().rev().enumerate() {
        if !context.spend(STEPS_PER_STATEMENT * machine.statements.len(), machine.name.span) {
            return None;
        }
        flat.repeated_laws += check_duplicates(context, machine);
        machine.statements.iter().for_each(|statement| flat.insert(context, statement));
        machine.statements.iter().for_each(|statement| flat.add(statement, place));
    }
    if let Some(axis) = flat.axes.list.get(limits::AXES.most) {
        context.report(limits::AXES.exceeded(axis.name.span));
        return None;
    }
    Some(flat)
}

/// The axes whose motion a machine gives itself, by a law or by a closed loop, its own and those of what it extends; of one that is wrong,
/// as many as are known.
pub(crate) fn axes_with_laws<'a>(context: &mut Context<'_>, machines: &'a Machines, name: &str) -> BTreeSet<&'a str> {
    let mut line: Vec<&ast::Machine> = Vec::new();
    let mut next = machines.get(name);
    while let Some(machine) = next.filter(|_| line.len() < limits::EXTENDS_DEPTH.most) {
        if !context.spend(machine.statements.len(), machine.name.span) {
            return BTreeSet::new();
        }
        line.push(machine);
        next = machine.extends.as_ref().and_then(|parent| machines.get(&parent.node));
    }
    let (mut laws, mut closed) = (BTreeSet::new(), BTreeSet::new());
    for statement in line.into_iter().rev().flat_map(|machine| &machine.statements) {
        match statement {
            MachineStatement::Fix(law) | MachineStatement::Couple(law) => {
                laws.insert(law.target.segments[0].node.as_str());
            }
            MachineStatement::Axis(axis) if axis.is_unknown => {
                closed.insert(axis.name.node.as_str());
            }
            MachineStatement::Axis(axis) => {
                closed.remove(axis.name.node.as_str());
            }
            _ => {}
        }
    }
    laws.extend(closed);
    laws
}

/// Whether an expression names one of these.
fn names_any(expression: &Expression, names: &HashSet<String>) -> bool {
    let mut found = false;
    expression.each(&mut |part| {
        found |= matches!(&part.kind, ExpressionKind::Path(path) if names.contains(&path.segments[0].node));
    });
    found
}

/// Name and place of what a statement defines, with a word for its namespace; nothing for requirements and NC words.
fn defined(statement: &MachineStatement) -> Option<(&Name, &'static str)> {
    Some(match statement {
        MachineStatement::Param(param) => (&param.name, "value"),
        MachineStatement::Let(binding) => (&binding.name, "value"),
        MachineStatement::Axis(axis) => (&axis.name, "value"),
        MachineStatement::Frame(frame) | MachineStatement::Insert(frame) => (&frame.name, "frame"),
        MachineStatement::Fix(law) | MachineStatement::Couple(law) => (&law.target.segments[0], "law"),
        MachineStatement::Close(_)
        | MachineStatement::Nc(_)
        | MachineStatement::Require(_)
        | MachineStatement::Expect(_) => return None,
    })
}

/// Reports what is defined twice; gives the number of laws among it.
fn check_duplicates(context: &mut Context<'_>, machine: &ast::Machine) -> usize {
    let mut laws = 0;
    let mut seen: HashMap<(&str, &str), Span> = HashMap::with_capacity(machine.statements.len());
    for (name, kind) in machine.statements.iter().filter_map(defined) {
        let Some(&first) = seen.get(&(kind, name.node.as_str())) else {
            seen.insert((kind, &name.node), name.span);
            continue;
        };
        if kind == "law" && !name.node.is_empty() {
            laws += 1;
            let message = format!("axis `{}` is fixed or coupled twice", name.node);
            context.report(Diagnostic::new(Code::DrivenTwice, name.span, message).note(first, "first here"));
        } else {
            context.duplicate(name, first);
        }
    }
    laws
}

/// Things by name, in the order in which their names came up first.
struct Named<'a, T> {
    list: Vec<T>,
    places: HashMap<&'a str, usize>,
}

impl<T> Default for Named<'_, T> {
    fn default() -> Self {
        Named { list: Vec::new(), places: HashMap::new() }
    }
}

impl<'a, T> Named<'a, T> {
    /// Puts something in the place of what has the same name, else at the end.
    fn put(&mut self, name: &'a Name, new: T) {
        match self.places.entry(&name.node) {
            Entry::Occupied(known) => self.list[*known.get()] = new,
            Entry::Vacant(free) => {
                free.insert(self.list.len());
                self.list.push(new);
            }
        }
    }
}

impl<'a> Flat<'a> {
    fn add(&mut self, statement: &'a MachineStatement, place: usize) {
        match statement {
            MachineStatement::Param(Param { name, .. }) | MachineStatement::Let(Let { name, .. }) => {
                self.constants.put(name, statement);
            }
            MachineStatement::Axis(axis) => self.axes.put(&axis.name, axis),
            MachineStatement::Frame(frame) => self.frames.put(&frame.name, Hung::written(frame)),
            // it hangs there already
            MachineStatement::Insert(_) => {}
            MachineStatement::Close(close) => self.closes.push(close),
            MachineStatement::Fix(law) => self.laws.put(&law.target.segments[0], (law, LawKind::Fix)),
            MachineStatement::Couple(law) => self.laws.put(&law.target.segments[0], (law, LawKind::Couple)),
            MachineStatement::Nc(word) => self.words.push((word, place)),
            MachineStatement::Require(required) => self.requirements.push(required),
            MachineStatement::Expect(expected) => {
                self.expectations.retain(|(earlier, of)| *of == place || earlier.about != expected.about);
                self.expectations.push((expected, place));
            }
        }
    }

    /// Hangs a frame that a variant inserts between another one and all that its parents hang on that.
    fn insert(&mut self, context: &mut Context<'_>, statement: &'a MachineStatement) {
        let MachineStatement::Insert(frame) = statement else { return };
        let inserted = Hung::written(frame);
        // the parser has reported a missing name
        let Some(parent) = inserted.parent.filter(|parent| !parent.node.is_empty()) else { return };
        if !self.frames.places.contains_key(parent.node.as_str()) {
            let known = self.frames.list.iter().map(|frame| frame.name.node.as_str());
            return context.unknown(parent, "frame of a parent", known);
        }
        if let Some(&known) = self.frames.places.get(frame.name.node.as_str()) {
            return context.duplicate(&frame.name, self.frames.list[known].name.span);
        }
        let hangs_there = |frame: &&mut Hung<'a>| frame.parent.is_some_and(|other| other.node == parent.node);
        let mut moved = 0;
        for frame in self.frames.list.iter_mut().filter(hangs_there) {
            frame.parent = Some(inserted.name);
            moved += 1;
        }
        if moved == 0 {
            let message = format!("nothing hangs on `{}` that `{}` could carry", parent.node, frame.name.node);
            let help = format!("a frame at the end is declared: `frame {} in {} = …`", frame.name.node, parent.node);
            context.report(Diagnostic::new(Code::FrameTree, frame.name.span, message).help(help));
        }
        self.frames.put(inserted.name, inserted);
    }

    fn params(&self) -> Vec<&'a ast::Param> {
        self.constants
            .list
            .iter()
            .filter_map(|statement| match statement {
                MachineStatement::Param(param) => Some(param),
                _ => None,
            })
            .collect()
    }

    /// Gives values to the parameters and builds axes and frames.
    pub(crate) fn build<'g>(
        &self,
        context: &mut Context<'g>,
        machine: &Name,
        source: Source<'_, 'g>,
        overrides: &Overrides,
    ) -> Built<'g> {
        let prefix = match &source {
            Source::Instance { name, .. } | Source::Standing { name } => format!("{}.", name.node),
            _ => String::new(),
        };
        let user = source.user();
        let is_instance = matches!(source, Source::Instance { .. });
        let mut binder = Binder::new(source, overrides);
        let mut scope = Scope::with_capacity(self.constants.list.len() + self.axes.list.len());
        context.moving = self.axes.list.iter().map(|axis| axis.name.node.clone()).collect();
        // values that axes move come after the axes, whose travels may depend on the others
        let mut moving = Vec::new();
        for statement in &self.constants.list {
            match statement {
                MachineStatement::Param(param) => binder.bind(context, param, &mut scope),
                MachineStatement::Let(binding) if names_any(&binding.value, &context.moving) => {
                    context.moving.insert(binding.name.node.clone());
                    moving.push(binding);
                }
                MachineStatement::Let(binding) => {
                    let value = context.evaluate(&binding.value, &scope);
                    context.note_value(binding.name.span, binding.value.span, &value);
                    scope.insert(binding.name.node.clone(), value);
                }
                _ => {}
            }
        }
        binder.finish(context, &self.params());
        let Binder { parameters, standing: settings, .. } = binder;
        let mut axes = self.build_axes(context, &scope, &prefix);
        context.moving.clear();
        for axis in &axes {
            let value = axis.dimension.map_or(Value::Poison, |dimension| Value::Scalar(axis.variable, dimension));
            scope.insert(axis.name.node.clone(), value);
        }
        for binding in moving {
            let value = context.evaluate(&binding.value, &scope);
            scope.insert(binding.name.node.clone(), value);
        }
        self.requirements.iter().for_each(|required| requirement::check(context, required, &scope, user));
        let lost_laws = self.repeated_laws + self.build_laws(context, &scope, &mut axes);
        // the axes of an instance may follow those of others, too: its job looks
        if !is_instance {
            let following = axes.iter().map(|axis| Following {
                name: axis.name.node.clone(),
                variable: axis.variable,
                law: axis.law.as_ref().and_then(|(law, ..)| *law),
                place: axis.law.as_ref().map_or(axis.name.span, |(.., place)| *place),
            });
            report_circles(context, &following.collect::<Vec<_>>());
        }
        nc_word::settle(context, &self.words, &scope, &mut axes);
        let (frames, lacks_transforms) = self.build_frames(context, machine, &scope);
        let linkages = if lacks_transforms {
            Vec::new()
        } else {
            closure::linkages(context, &self.closes, &frames, &axes, &scope)
        };
        let declared_frames = self.frames.list.iter().map(|frame| frame.name.node.clone()).collect();
        let expectations = self.expectations.iter().map(|(expected, _)| (*expected).clone()).collect();
        Built {
            parameters,
            settings,
            scope,
            axes,
            frames,
            linkages,
            declared_frames,
            lost_laws,
            lacks_transforms,
            expectations,
        }
    }

    fn build_axes<'g>(&self, context: &mut Context<'g>, scope: &Scope<'g>, prefix: &str) -> Vec<BuiltAxis<'g>> {
        let mut axes = Vec::new();
        for axis in &self.axes.list {
            let dimension = match axis.kind {
                AxisKind::Linear => Some(Dimension::LENGTH),
                AxisKind::Rotary => Some(Dimension::ANGLE),
                AxisKind::Unknown => None,
            };
            let what = format!("axis `{}`", axis.name.node);
            let travel = axis.range.as_ref().zip(dimension);
            let travel_unit = travel.and_then(|(range, dimension)| written_unit(dimension, &range.high));
            let travel = travel.and_then(|(range, dimension)| context.range(range, scope, dimension, &what));
            let variable = context.variable(format!("{prefix}{}", axis.name.node), Role::Axis, f64::NAN);
            match (travel, &axis.range) {
                (Some((low, high)), _) => context.set_range(variable, Interval::new(low, high)),
                // its ends have no values yet, or are wrong, which has been reported
                (None, Some(_)) => context.set_range(variable, Interval::WHOLE),
                (None, None) => {}
            }
            let word = NcWord::of_axis(&axis.name.node);
            let (name, is_unknown) = (axis.name.clone(), axis.is_unknown);
            axes.push(BuiltAxis { name, dimension, variable, travel, travel_unit, is_unknown, law: None, word });
        }
        axes
    }

    /// Gives the axes their laws; the number of laws for axes that are not there (and reported).
    fn build_laws<'g>(&self, context: &mut Context<'g>, scope: &Scope<'g>, axes: &mut [BuiltAxis<'g>]) -> usize {
        let mut lost = 0;
        for (law, kind) in &self.laws.list {
            let target = &law.target.segments[0];
            let Some(index) = axes.iter().position(|axis| axis.name.node == target.node) else {
                context.unknown(target, "axis", axes.iter().map(|axis| axis.name.node.as_str()));
                lost += 1;
                continue;
            };
            let what = format!("axis `{}`", target.node);
            let dimension = axes[index].dimension;
            let mut value = dimension.and_then(|dimension| context.scalar(&law.value, scope, dimension, &what));
            if let (Some(expr), LawKind::Fix) = (value, kind)
                && let Constant::Moves(name) = context.constant(expr)
            {
                let message = format!("{what} is fixed and must stand still, but depends on {name}");
                let help = format!("an axis that follows another one is coupled: `couple {} = …`", target.node);
                let couple = Rewriting::WordBefore("fix", law.target.span, "couple");
                context
                    .report(Diagnostic::new(Code::NotConstant, law.value.span, message).help(help).rewriting(couple));
                value = None;
            }
            axes[index].law = Some((value, *kind, law.target.span));
        }
        lost
    }

    /// The frames, parents before children, and whether a transform of theirs is wrong (and reported).
    fn build_frames<'g>(&self, context: &mut Context<'g>, machine: &Name, scope: &Scope<'g>) -> (Vec<Frame<'g>>, bool) {
        if self.frames.list.len() > limits::FRAMES.most {
            context.report(limits::FRAMES.exceeded(machine.span));
            return (Vec::new(), true);
        }
        let roots: Vec<&Hung<'_>> = self.frames.list.iter().filter(|frame| frame.parent.is_none()).collect();
        if let Some(second) = roots.get(1) {
            let message = format!("`{}` hangs on nothing, and so does `{}`", second.name.node, roots[0].name.node);
            let diagnostic = Diagnostic::new(Code::FrameTree, second.name.span, message)
                .note(roots[0].name.span, "the first frame without a parent")
                .help(format!("say what it hangs on: `frame {} in {} = …`", second.name.node, roots[0].name.node));
            context.report(diagnostic);
        }
        let index: HashMap<&str, usize> =
            self.frames.list.iter().enumerate().map(|(k, frame)| (frame.name.node.as_str(), k)).collect();
        for frame in &self.frames.list {
            if let Some(parent) = frame.parent
                && !index.contains_key(parent.node.as_str())
            {
                self.unknown_parent(context, (frame, parent), &index);
            }
        }
        self.report_circles(context, &index);
        let mut lacks_transforms = false;
        let frames = self.order_frames(&index).into_iter().map(|(k, parent)| {
            let frame = self.frames.list[k];
            let steps = transforms::steps(context, frame.transforms, scope);
            lacks_transforms |= steps.is_none();
            Frame { name: frame.name.node.clone(), parent, steps: steps.unwrap_or_default() }
        });
        (frames.collect(), lacks_transforms)
    }

    fn report_circles(&self, context: &mut Context<'_>, index: &HashMap<&str, usize>) {
        // 0 not seen, 1 on the way up from the frame being looked at, 2 done
        let mut state = vec![0u8; self.frames.list.len()];
        for start in 0..self.frames.list.len() {
            let mut way = Vec::new();
            let mut at = Some(start);
            while let Some(k) = at.filter(|k| state[*k] == 0) {
                state[k] = 1;
                way.push(k);
                at = self.frames.list[k].parent.and_then(|parent| index.get(parent.node.as_str()).copied());
            }
            if let Some(k) = at.filter(|k| state[*k] == 1) {
                let names: Vec<&str> = way
                    .iter()
                    .skip_while(|other| **other != k)
                    .map(|other| self.frames.list[*other].name.node.as_str())
                    .collect();
                let shown = match names.get(..READABLE) {
                    Some(first) => format!("{} → …", first.join(" → ")),
                    None => names.join(" → "),
                };
                let message = format!("frames hang on each other in a circle: {shown} → {}", names[0]);
                let place = self.frames.list[k].parent.map_or(self.frames.list[k].name.span, |parent| parent.span);
                let root = self.frames.list.iter().find(|frame| frame.parent.is_none());
                let help = match root.map(|root| &root.name.node) {
                    Some(root) => {
                        format!("hang one of them on a frame outside the circle: `frame {} in {root} = …`", names[0])
                    }
                    None => "one frame must hang on nothing: `frame bed`".to_string(),
                };
                context.report(Diagnostic::new(Code::CyclicFrames, place, message).help(help));
            }
            way.into_iter().for_each(|k| state[k] = 2);
        }
    }

    /// Reports the parent of a frame that is no frame. Those that hang on the frame itself would make a circle; of the others, those that
    /// hang on nothing known are meant only where they are called much alike.
    fn unknown_parent(
        &self,
        context: &mut Context<'_>,
        (frame, parent): (&Hung<'_>, &Name),
        index: &HashMap<&str, usize>,
    ) {
        if !context.tells_more() {
            return;
        }
        let hung = || {
            self.frames.list.iter().filter_map(|frame| Some((frame.name.node.as_str(), frame.parent?.node.as_str())))
        };
        let own = with_descendants([frame.name.node.as_str()].into_iter(), hung());
        let mut known: Vec<&str> = index.keys().copied().filter(|name| !own.contains(name)).collect();
        if closest(&parent.node, known.iter().copied()).is_none() {
            let missing = hung().map(|(_, parent)| parent).filter(|parent| !index.contains_key(parent));
            let untied = with_descendants(missing, hung());
            known.retain(|name| !untied.contains(name));
        }
        let findings = context.findings();
        let is_lone = known.is_empty();
        context.unknown(parent, "frame", known.into_iter());
        if is_lone {
            context.help_since(findings, "the first frame hangs on nothing and stands alone, such as `frame bed`");
        }
    }

    /// Indices of the frames, parents first, with the new index of each one's parent; circles are left out.
    fn order_frames(&self, index: &HashMap<&str, usize>) -> Vec<(usize, Option<usize>)> {
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); self.frames.list.len()];
        let mut order: Vec<(usize, Option<usize>)> = Vec::new();
        for (k, frame) in self.frames.list.iter().enumerate() {
            match frame.parent.map(|parent| index.get(parent.node.as_str())) {
                Some(Some(&parent)) => children[parent].push(k),
                Some(None) => {}
                None => order.push((k, None)),
            }
        }
        let mut next = 0;
        while next < order.len() {
            let parent = order[next].0;
            order.extend(children[parent].iter().map(|&child| (child, Some(next))));
            next += 1;
        }
        order
    }
}
