//! Trees as short text, `(+ 1 (* 2 3))`, an item or statement a line.

use flank_chain_dsl::Name;
use flank_chain_dsl::syntax::ast::*;

pub(crate) fn file(file: &File) -> String {
    let mut lines: Vec<String> = file.doc.iter().map(|line| format!("//! {line}")).collect();
    lines.extend(file.items.iter().flat_map(item));
    lines.join("\n")
}

fn item(item: &Item) -> Vec<String> {
    let (head, statements): (String, Vec<String>) = match item {
        Item::Use(path) => (format!("use {:?}", path.node), Vec::new()),
        Item::Function(function) => function_lines(function),
        Item::Machine(machine) => {
            let extends = machine.extends.as_ref().map_or(String::new(), |name| format!(" < {}", name.node));
            let head = format!("{}machine {}{extends}", doc(&machine.doc), machine.name.node);
            (head, machine.statements.iter().map(machine_statement).collect())
        }
        Item::Tool(tool) => {
            let head = format!("{}tool {}", doc(&tool.doc), tool.name.node);
            (head, tool.statements.iter().flat_map(tool_statement).collect())
        }
        Item::Variant(it) => {
            let changes = listed(&it.changes, |it| format!("{}: {}", path(&it.target), expression(&it.value)));
            (format!("{}job {} = {}({changes})", doc(&it.doc), it.name.node, it.parent.node), Vec::new())
        }
        Item::Job(job) => {
            let head = format!("{}job {}", doc(&job.doc), job.name.node);
            (head, job.statements.iter().map(job_statement).collect())
        }
    };
    std::iter::once(head).chain(statements.into_iter().map(|line| format!("  {line}"))).collect()
}

fn function_lines(function: &Function) -> (String, Vec<String>) {
    let arguments: Vec<String> =
        function.arguments.iter().map(|(name, of)| format!("{}: {}", name.node, value_type(of))).collect();
    let result = function.result.as_ref().map_or(String::new(), |result| format!(" -> {}", value_type(result)));
    let head = format!("{}fn {}({}){result}", doc(&function.doc), function.name.node, arguments.join(", "));
    let lets = function.lets.iter().map(let_statement);
    (head, lets.chain([expression(&function.body)]).collect())
}

fn value_type(it: &Type) -> String {
    dimension(&it.dimension) + &it.size.map_or(String::new(), |size| format!("[{size}]"))
}

fn frame(word: &str, it: &Frame) -> String {
    let parent = it.parent.as_ref().map_or(String::new(), |name| format!(" in {}", named(name)));
    let transforms: String = it.transforms.iter().map(|it| format!(" {}", call(it))).collect();
    format!("{}{word} {}{parent}{transforms}", doc(&it.doc), it.name.node)
}

fn machine_statement(statement: &MachineStatement) -> String {
    match statement {
        MachineStatement::Param(it) => param(it),
        MachineStatement::Let(it) => let_statement(it),
        MachineStatement::Axis(it) => {
            let word = if it.is_unknown { "unknown" } else { "axis" };
            format!("{}{word} {} {:?}{}", doc(&it.doc), it.name.node, it.kind, optional_range(it.range.as_ref()))
        }
        MachineStatement::Frame(it) => frame("frame", it),
        MachineStatement::Insert(it) => frame("insert", it),
        MachineStatement::Close(it) => {
            let list = |word: &str, names: &[Name]| {
                let names: Vec<&str> = names.iter().map(|name| name.node.as_str()).collect();
                if names.is_empty() { String::new() } else { format!(" {word} {}", names.join(" ")) }
            };
            let components = format!("{}{}", list("along", &it.along), list("about", &it.about));
            let keep = |kept: &KeptAxis| format!(" keep {}{}", kept.name.node, optional_range(Some(&kept.range)));
            let keeps: String = it.keeps.iter().map(keep).collect();
            format!("close {} {}{components}{keeps}", it.first.node, it.second.node)
        }
        MachineStatement::Fix(it) => assignment("fix", it),
        MachineStatement::Couple(it) => assignment("couple", it),
        MachineStatement::Nc(it) => {
            let by = it.increment.as_ref().map_or(String::new(), |by| format!(" by {}", expression(by)));
            format!("nc {} {}{by}", it.address.node, expression(&it.value))
        }
        MachineStatement::Require(it) => requirement(it),
        MachineStatement::Expect(it) => expectation(it),
    }
}

fn tool_statement(statement: &ToolStatement) -> Vec<String> {
    match statement {
        ToolStatement::Param(it) => vec![param(it)],
        ToolStatement::Let(it) => vec![let_statement(it)],
        ToolStatement::Require(it) => vec![requirement(it)],
        ToolStatement::Profile(it) => {
            let head = format!("{}profile {}", doc(&it.doc), it.name.node);
            let segment = |it: &Segment| format!("  {}{} {}", doc(&it.doc), it.name.node, expression(&it.value));
            std::iter::once(head).chain(it.segments.iter().map(segment)).collect()
        }
        ToolStatement::Surface(it) => {
            let parameters: Vec<String> = it.parameters.iter().map(surface_parameter).collect();
            let each = it.each.as_ref().map_or(String::new(), |each| {
                format!(" for {} in [{}]", each.name.node, listed(&each.values, expression))
            });
            let names = listed(&it.names, |name| name.node.clone());
            let head = format!("{}surface {names}({}){each}", doc(&it.doc), parameters.join(", "));
            let body = match &it.body.side {
                Side::Inside => "inside".to_owned(),
                Side::Outside => "outside".to_owned(),
                Side::Towards(direction) => format!("towards {}", expression(direction)),
                Side::Where(condition) => format!("where {}", expression(condition)),
            };
            let lets = it.lets.iter().map(|it| format!("  {}", let_statement(it)));
            let rest = [format!("  at {}", expression(&it.at)), format!("  body {body}")];
            std::iter::once(head).chain(lets).chain(rest).collect()
        }
    }
}

fn job_statement(statement: &JobStatement) -> String {
    match statement {
        JobStatement::Param(it) => param(it),
        JobStatement::Let(it) => let_statement(it),
        JobStatement::Machine(it) => instance("machine", it),
        JobStatement::Tool(it) => instance("tool", it),
        JobStatement::Mount { names, frame } => {
            format!("mount {} {}", listed(names, |name: &Name| name.node.to_string()), path(frame))
        }
        JobStatement::Motion(it) => format!("motion {}", parameter(it)),
        JobStatement::Unknown(it) => format!("unknown {}", parameter(it)),
        JobStatement::Profile(it) => {
            let segment = |it: &Segment| format!("{}{} {}", doc(&it.doc), it.name.node, expression(&it.value));
            format!("{}profile {} {}", doc(&it.doc), it.name.node, listed(&it.segments, segment))
        }
        JobStatement::Solid(it) => {
            format!("{}solid {} in {} {}", doc(&it.doc), it.name.node, path(&it.frame), expression(&it.value))
        }
        JobStatement::Contact(it) => {
            let [first, second] = it.surfaces.each_ref().map(path);
            format!(
                "{}contact {} {first} with {second} {}",
                doc(&it.doc),
                it.name.node,
                listed(&it.arguments, argument)
            )
        }
        JobStatement::Want(it) => {
            format!("{}want {} in {} {}", doc(&it.doc), it.name.node, path(&it.contact), expression(&it.value))
        }
        JobStatement::Mill(it) => milling(it),
        JobStatement::Drive(it) => {
            format!("drive {} {}", listed(&it.targets, path), listed(&it.values, expression))
        }
        JobStatement::Surface(it) => {
            format!(
                "{}surface {} in {} {}",
                doc(&it.doc),
                listed(&it.names, |it| it.node.clone()),
                path(&it.frame),
                expression(&it.value)
            )
        }
        JobStatement::Trim { surface, by } => format!("trim {} {}", path(surface), path(by)),
        JobStatement::Cut { surface, by } => format!("cut {} {}", path(surface), path(by)),
        JobStatement::Require(it) => requirement(it),
        JobStatement::Expect(it) => expectation(it),
        JobStatement::Sample(it) => {
            let entries: Vec<String> = it.entries.iter().map(entry).collect();
            format!("sample {} {}", listed(&it.surfaces, sampled), entries.join(", "))
        }
    }
}

fn milling(it: &Mill) -> String {
    let run = |it: &MillRun| {
        let definition = it.definition.as_ref().map_or(String::new(), |it| format!(" = {}", expression(it)));
        format!("{}{definition}: {} {} {}", it.key.node, range(&it.range), it.word.node, expression(&it.value))
    };
    let clearance =
        |it: &MillClearance| format!("clear {} {} {}", path(&it.surface), expression(&it.distance), path(&it.body));
    format!(
        "{}mill {} {} {} {} [{}] [{}] [{}] {} [{}]",
        doc(&it.doc),
        it.name.node,
        path(&it.surface),
        path(&it.cutter),
        path(&it.frame),
        listed(&it.passes, run),
        listed(&it.along, run),
        listed(&it.attitudes, |(word, value)| format!("{} {}", word.node, expression(value))),
        it.both_ways.len(),
        listed(&it.clearances, clearance),
    )
}

fn expectation(it: &Expectation) -> String {
    let of = |surface: &Option<Path>| surface.as_ref().map_or(String::new(), |surface| format!("{}: ", path(surface)));
    match &it.what {
        Expected::Error(code) => format!("expect error {}", code.node),
        Expected::Nothing => "expect nothing".to_owned(),
        Expected::Travel => "expect travel".to_owned(),
        Expected::On { machine, within } => {
            let settings = listed(&machine.settings, argument);
            format!("expect on {}({settings}) within {}", machine.definition.node, expression(within))
        }
        Expected::Status { surface, status, at } => {
            let at = at.as_ref().map_or(String::new(), |at| format!(" at {}", expression(at)));
            format!("expect {} {}{at}", path(surface), status.node)
        }
        Expected::Near { surface, value, target, within } => format!(
            "expect {}{} near {} within {}",
            of(surface),
            expression(value),
            expression(target),
            expression(within)
        ),
        Expected::InRange { surface, value, range } => format!(
            "expect {}{} in {} .. {}",
            of(surface),
            expression(value),
            expression(&range.low),
            expression(&range.high)
        ),
        Expected::Pose { frames: [frame, reference], at, within, .. } => format!(
            "expect {} in {} at {} within {}",
            frame.node,
            reference.node,
            listed(at, argument),
            listed(within, expression)
        ),
    }
}

fn requirement(it: &Requirement) -> String {
    format!("require {} {:?}", expression(&it.condition), it.message)
}

fn surface_parameter(it: &SurfaceParameter) -> String {
    match it {
        SurfaceParameter::Within(it) => parameter(it),
        SurfaceParameter::Along(name, profile) => format!("{}: along {}", name.node, named(profile)),
    }
}

fn doc(lines: &[String]) -> String {
    lines.iter().map(|line| format!("/{line}/ ")).collect()
}

/// A name, or `?` where it is missing.
fn named(name: &Name) -> &str {
    if name.node.is_empty() { "?" } else { &name.node }
}

fn param(it: &Param) -> String {
    let default = it.default.as_ref().map_or(String::new(), |it| format!(" = {}", expression(it)));
    let range = optional_range(it.range.as_ref());
    let step = it.step.as_ref().map_or(String::new(), |it| format!(" step {}", expression(it)));
    let word = if it.is_error { "error" } else { "param" };
    format!("{}{word} {}: {}{range}{step}{default}", doc(&it.doc), it.name.node, dimension(&it.dimension))
}

fn let_statement(it: &Let) -> String {
    format!("let {} {}", it.name.node, expression(&it.value))
}

fn assignment(word: &str, it: &Assignment) -> String {
    format!("{word} {} {}", path(&it.target), expression(&it.value))
}

fn sampled(it: &Sampled) -> String {
    let name = it.name.as_ref().map_or(String::new(), |name| format!(" as {}", named(name)));
    format!("{}{name}", path(&it.surface))
}

fn listed<T>(items: &[T], shown: impl Fn(&T) -> String) -> String {
    items.iter().map(shown).collect::<Vec<_>>().join(", ")
}

fn instance(word: &str, it: &Instance) -> String {
    let settings: Vec<String> = it.settings.iter().map(argument).collect();
    format!("{word} {} = {}({})", it.name.node, named(&it.definition), settings.join(", "))
}

fn entry(it: &SampleEntry) -> String {
    match &it.values {
        SampleValues::Range(of, points) => format!("{}: {} by {}", named(&it.key), range(of), expression(points)),
        SampleValues::Value(value) => format!("{}: {}", named(&it.key), expression(value)),
    }
}

fn parameter(it: &Parameter) -> String {
    format!("{}{}: {} in {}", doc(&it.doc), it.name.node, dimension(&it.dimension), range(&it.range))
}

fn optional_range(it: Option<&Range>) -> String {
    it.map_or(String::new(), |it| format!(" in {}", range(it)))
}

fn range(it: &Range) -> String {
    format!("{}..{}", expression(&it.low), expression(&it.high))
}

fn dimension(it: &Dimension) -> String {
    powers(&it.factors)
}

fn powers(factors: &[(Name, i32)]) -> String {
    let factors: Vec<String> = factors
        .iter()
        .map(|(name, power)| if *power == 1 { named(name).to_owned() } else { format!("{}^{power}", named(name)) })
        .collect();
    factors.join("*")
}

fn path(it: &Path) -> String {
    it.segments.iter().map(named).collect::<Vec<_>>().join(".")
}

fn call(it: &Call) -> String {
    let arguments: String = it.arguments.iter().map(|it| format!(" {}", argument(it))).collect();
    format!("({}!{arguments})", it.function.node)
}

fn argument(it: &Argument) -> String {
    let name = it.name.as_ref().map_or(String::new(), |name| format!("{}: ", name.node));
    format!("{name}{}", expression(&it.value))
}

pub(crate) fn expression(it: &Expression) -> String {
    match &it.kind {
        ExpressionKind::Number(value, units) if units.is_empty() => value.to_string(),
        ExpressionKind::Number(value, units) => format!("{value}_{}", powers(units)),
        ExpressionKind::Text(text) => format!("{text:?}"),
        ExpressionKind::Path(it) => path(it),
        ExpressionKind::Call(it) => call(it),
        ExpressionKind::Vector(items) => format!("[{}]", items.iter().map(expression).collect::<Vec<_>>().join(" ")),
        ExpressionKind::Index(of, at) => format!("(at {} {})", expression(of), expression(at)),
        ExpressionKind::Unary(operator, value) => {
            let operator = if operator.node == UnaryOperator::Not { "not" } else { "-" };
            format!("({operator} {})", expression(value))
        }
        ExpressionKind::Binary(operator, a, b) => {
            format!("({} {} {})", sign(operator.node), expression(a), expression(b))
        }
        ExpressionKind::If(condition, a, b) => {
            format!("(if {} {} {})", expression(condition), expression(a), expression(b))
        }
        ExpressionKind::Bound(bound) => {
            let [low, high] = [&bound.range.low, &bound.range.high].map(expression);
            format!("(each {} {low} {high} {})", bound.name.node, expression(&bound.value))
        }
        ExpressionKind::Error => "ERROR".to_owned(),
    }
}

fn sign(operator: BinaryOperator) -> &'static str {
    match operator {
        BinaryOperator::Add => "+",
        BinaryOperator::Subtract => "-",
        BinaryOperator::Multiply => "*",
        BinaryOperator::Divide => "/",
        BinaryOperator::Power => "^",
        BinaryOperator::Less => "<",
        BinaryOperator::LessEqual => "<=",
        BinaryOperator::Greater => ">",
        BinaryOperator::GreaterEqual => ">=",
        BinaryOperator::Equal => "==",
        BinaryOperator::NotEqual => "!=",
        BinaryOperator::And => "and",
        BinaryOperator::Or => "or",
    }
}
