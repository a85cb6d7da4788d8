//! What was built from a job, written out stage by stage.

mod fixed_frame;

use std::fmt::Write;

use flank_expr::geometry::{Axis as Line, Pose, Step, Vector3};
use flank_expr::{Expr, Style};

use crate::model::{GeneratedSurface, Generation, Job, LawSource, Machine, Process, ToolShape};
use crate::values::dimension::{Dimension, shown};

/// Writes what the compiler built for a job: frames, the chain from tool to work with each elementary matrix, the product
/// and its 3 × 3 vector part, the twist of each motion, position and normal, the equation of meshing, and how much is
/// shared.
pub fn derivation(job: &Job<'_>, style: Style) -> String {
    let mut page = Page { out: String::new(), style };
    page.title(&format!("job {}", job.name));
    job.doc.iter().for_each(|line| page.text(line));
    page.parameters(job);
    job.machines.iter().for_each(|machine| page.machine(machine));
    let made = job.surfaces.iter().filter(|surface| surface.sample_of.is_none());
    made.for_each(|surface| page.surface(surface, job));
    page.finish()
}

/// Texts, each with equations of a variable and its value under it, written as in a derivation; parts that the values under a text
/// share are named once.
pub fn equations(title: &str, groups: &[(String, Vec<(Expr<'_>, Expr<'_>)>)], style: Style) -> String {
    let mut page = Page { out: String::new(), style };
    page.title(title);
    for (text, pairs) in groups {
        page.text(text);
        let exprs: Vec<Expr<'_>> = pairs.iter().flat_map(|(variable, value)| [*variable, *value]).collect();
        let Some(first) = exprs.first() else { continue };
        let listing = first.graph().listing(&exprs, style, "t");
        page.definitions(&listing.definitions);
        for pair in listing.values.chunks(2) {
            page.equation(&pair[0], &pair[1]);
        }
    }
    page.finish()
}

struct Page {
    out: String,
    style: Style,
}

impl Page {
    fn line(&mut self, text: &str) {
        self.out.push_str(text);
        self.out.push('\n');
    }

    fn title(&mut self, text: &str) {
        match self.style {
            Style::Text => self.line(&format!("{text}\n{}", "=".repeat(text.chars().count()))),
            Style::Latex => self.line(&format!("\\section*{{{}}}", escaped(text))),
        }
    }

    fn heading(&mut self, text: &str) {
        match self.style {
            Style::Text => self.line(&format!("\n{text}\n{}", "-".repeat(text.chars().count()))),
            Style::Latex => self.line(&format!("\\subsection*{{{}}}", escaped(text))),
        }
    }

    fn text(&mut self, text: &str) {
        let text = if self.style == Style::Latex { format!("{}\n", escaped(text)) } else { text.to_string() };
        self.line(&text);
    }

    fn finish(self) -> String {
        match self.style {
            Style::Text => self.out,
            Style::Latex => format!(
                "\\documentclass{{article}}\n\\usepackage{{amsmath}}\n\\usepackage[a3paper,landscape,margin=15mm]{{geometry}}\n\
                 \\setcounter{{MaxMatrixCols}}{{20}}\n\\begin{{document}}\n{}\\end{{document}}\n",
                self.out
            ),
        }
    }

    /// `name = value`, on a line of its own.
    fn equation(&mut self, name: &str, value: &str) {
        match self.style {
            Style::Text => self.line(&format!("  {name} = {value}")),
            Style::Latex => self.line(&format!("\\[ {name} = {value} \\]")),
        }
    }

    /// A value with its unit.
    fn amount(&self, value: f64, dimension: Dimension) -> String {
        let shown = shown(value, dimension);
        match (self.style, shown.split_once(' ')) {
            (Style::Latex, Some((number, unit))) => format!("{number}\\,\\mathrm{{{unit}}}"),
            _ => shown,
        }
    }

    fn parameters(&mut self, job: &Job<'_>) {
        if job.parameters.is_empty() {
            return;
        }
        self.heading("parameters");
        for parameter in &job.parameters {
            let listing =
                parameter.variable.graph().listing(&[parameter.variable, parameter.definition], self.style, "p");
            let shown = self.amount(parameter.value, parameter.dimension);
            let value = match (parameter.definition.as_constant(), listing.definitions.is_empty()) {
                (None, true) => format!("{} = {shown}", listing.values[1]),
                _ => shown,
            };
            self.equation(&listing.values[0], &value);
        }
    }

    fn machine(&mut self, machine: &Machine<'_>) {
        self.heading(&format!("machine {} ({})", machine.name, machine.definition));
        self.text("frames:");
        self.tree(machine);
        self.text("axes:");
        for axis in &machine.axes {
            let how = match axis.source {
                LawSource::Driven => "driven",
                LawSource::Fixed => "fixed",
                LawSource::Coupled => "coupled",
                LawSource::Closed => "closed",
                LawSource::Free => "free",
            };
            let listing = axis.law.graph().listing(&[axis.variable, axis.law], self.style, "a");
            let comment =
                if self.style == Style::Latex { format!("\\quad\\text{{{how}}}") } else { format!("   ({how})") };
            self.definitions(&listing.definitions);
            self.equation(&listing.values[0], &format!("{}{comment}", listing.values[1]));
        }
    }

    fn tree(&mut self, machine: &Machine<'_>) {
        if self.style == Style::Latex {
            self.line("\\begin{verbatim}");
        }
        let mut order = vec![(0, 0)];
        while let Some((index, depth)) = order.pop() {
            let Some(frame) = machine.frames.get(index) else {
                break;
            };
            let steps: Vec<String> = frame.steps.iter().map(|step| described(*step)).collect();
            let how = if steps.is_empty() { String::new() } else { format!(" = {}", steps.join(" ")) };
            self.line(&format!("  {}{}{how}", "    ".repeat(depth), frame.name));
            let children = machine.frames.iter().enumerate().filter(|(_, child)| child.parent == Some(index));
            order.extend(children.map(|(child, _)| (child, depth + 1)).rev());
        }
        if self.style == Style::Latex {
            self.line("\\end{verbatim}");
        }
    }

    fn surface<'g>(&mut self, surface: &GeneratedSurface<'g>, job: &Job<'g>) {
        self.heading(&format!("surface {} in {}", surface.name, surface.frame));
        surface.doc.iter().for_each(|line| self.text(line));
        self.chain(&surface.generation, &surface.frame);
        self.tool(&surface.generation);
        self.fixed_frame(surface, &job.machines);
        self.motions(surface, job);
        self.text(&format!("position in {}, mm:", surface.frame));
        self.vector("r", surface.surface.position);
        self.text(&format!("unit normal in {}, out of the body:", surface.frame));
        self.vector("n", surface.surface.normal);
        self.text("unknowns:");
        for unknown in &surface.unknowns {
            let name = unknown.variable.graph().listing(&[unknown.variable], self.style, "u").values[0].clone();
            let [low, high] = [unknown.low, unknown.high].map(|end| self.amount(end, unknown.dimension));
            match self.style {
                Style::Text => {
                    let counted = if unknown.is_count { ", counted" } else { "" };
                    self.line(&format!("  {name} in {low} .. {high}{counted}"));
                }
                Style::Latex => {
                    let counted = if unknown.is_count { "\\text{, counted}" } else { "" };
                    self.line(&format!("\\[ {low} \\le {name} \\le {high}{counted} \\]"));
                }
            }
        }
        if let Some(by) = surface.cut_by {
            self.text(&format!(
                "cut by {}: left is the least h for which r + h n lies on the sweep of one of its edges, each with whole counts",
                job.surfaces[by].name
            ));
        }
        self.counts(surface);
    }

    fn chain(&mut self, generation: &Generation<'_>, frame: &str) {
        let frames: Vec<String> = generation.path.iter().map(|(frame, _)| self.words(frame)).collect();
        let arrow = if self.style == Style::Latex { " $\\leftarrow$ " } else { " <- " };
        let process = match generation.process {
            Process::Envelope => "envelope",
            Process::Sweep => "sweep",
            Process::Move => "move",
        };
        let tool = self.words(&generation.tool_name);
        self.line(&format!("{process} of {tool}; chain from work to tool:\n  {}", frames.join(arrow)));
        let graph = generation.position().0[0].graph();
        for pair in generation.path.windows(2) {
            for step in &pair[1].1 {
                self.text(&format!("{} to {}: {}", pair[0].0, pair[1].0, described(*step)));
                self.matrix4("M", step.pose(graph));
            }
        }
        self.text(&format!("product of all, pose of {} in {frame}:", generation.tool_frame()));
        let pose = generation.t_work_tool.pose();
        self.matrix4("M", pose);
        self.text("its vector part (last row and column deleted):");
        self.matrix("L", &pose.rotation.0.map(|row| row.0.to_vec()));
    }

    fn tool(&mut self, generation: &Generation<'_>) {
        let frame = generation.tool_frame();
        match &generation.tool {
            ToolShape::Surface(surface) => {
                self.text(&format!("tool surface in {frame}, mm, and its unit normal, out of the tool's steel:"));
                self.vector("r_t", surface.position);
                self.vector("n_t", surface.normal);
                if surface.given == 1 {
                    self.text("its equation, mm off the surface:");
                    self.zero("f_t", surface.constraints[0]);
                }
            }
            ToolShape::Edge(edge) => {
                self.text(&format!("cutting edge in {frame}, mm, and a direction into the tool's steel:"));
                self.vector("r_t", edge.position);
                self.vector("s_t", edge.steel);
            }
        }
    }

    fn motions<'g>(&mut self, surface: &GeneratedSurface<'g>, job: &Job<'g>) {
        let generation = &surface.generation;
        let (tool_frame, frame) = (generation.tool_frame(), &surface.frame);
        // a sweep has no equation for its first motion; the constraints of a tool that is an envelope itself come first
        let free = usize::from(generation.process == Process::Sweep);
        let constraints = &surface.surface.constraints;
        let own = &constraints[constraints.len() - generation.motions.len().saturating_sub(free)..];
        for (index, &motion) in generation.motions.iter().enumerate() {
            let graph = motion.graph();
            let plain = motion.to_string();
            self.text(&format!(
                "twist along {plain}, of {tool_frame} against {frame}, in {tool_frame}: angular, linear:"
            ));
            let twist = generation.driven.twist(motion);
            self.vector("omega", twist.angular);
            self.vector("v", twist.linear);
            let Some(&meshing) = index.checked_sub(free).and_then(|k| own.get(k)) else { continue };
            self.text(&format!("equation of meshing for {plain}: n_t . (omega x r_t + v) = 0, the same in every frame, here as in the shortest one"));
            let name = graph.listing(&[motion], self.style, "t").values[0].clone();
            self.zero(&format!("f_{{{name}}}"), meshing);
            self.closed_forms(meshing, &surface.surface.unknowns, &job.bindings());
        }
    }

    /// An equation, which has a name in LaTeX.
    fn zero(&mut self, name: &str, function: Expr<'_>) {
        let listing = function.graph().listing(&[function], self.style, "t");
        self.definitions(&listing.definitions);
        match self.style {
            Style::Text => self.line(&format!("  {} = 0", listing.values[0])),
            Style::Latex => self.line(&format!("\\[ {name} = {} = 0 \\]", listing.values[0])),
        }
    }

    /// The unknowns that an equation can be solved for by hand: those that it is linear in. What they are multiplied by may be zero for the
    /// values of the job: then the equation does not give them.
    fn closed_forms<'g>(&mut self, equation: Expr<'g>, unknowns: &[Expr<'g>], values: &[(Expr<'g>, Expr<'g>)]) {
        for &unknown in unknowns {
            let Some(linear) = equation.linear_in(unknown) else { continue };
            let graph = equation.graph();
            if graph.substitute(&[linear.slope], values)[0].as_constant() == Some(0.0) {
                continue;
            }
            let listing = graph.listing(&[unknown, linear.intercept, linear.slope], self.style, "t");
            let [name, intercept, slope] = [0, 1, 2].map(|k| listing.values[k].clone());
            self.text(&format!("it is linear in {unknown}, which it gives in closed form:"));
            self.definitions(&listing.definitions);
            match self.style {
                Style::Text => self.line(&format!("  {name} = -({intercept}) / ({slope})")),
                Style::Latex => self.line(&format!("\\[ {name} = -\\frac{{{intercept}}}{{{slope}}} \\]")),
            }
        }
    }

    fn counts(&mut self, surface: &GeneratedSurface<'_>) {
        let parts = &surface.surface;
        let all: Vec<Expr<'_>> =
            parts.position.0.into_iter().chain(parts.normal.0).chain(parts.constraints.iter().copied()).collect();
        let graph = all[0].graph();
        let jacobian: Vec<Expr<'_>> =
            parts.constraints.iter().flat_map(|f| parts.unknowns.iter().map(|u| f.derivative(*u))).collect();
        for (what, roots) in [("position, normal and constraints", &all), ("Jacobian of the constraints", &jacobian)] {
            let count = graph.count(roots);
            self.text(&format!("nodes of {what}: {} written out, {} shared", count.written_out, count.shared));
        }
    }

    fn words(&self, text: &str) -> String {
        if self.style == Style::Latex { escaped(text) } else { text.to_string() }
    }

    fn definitions(&mut self, definitions: &[flank_expr::Definition]) {
        for definition in definitions {
            self.equation(&definition.name, &definition.value);
        }
    }

    fn vector(&mut self, name: &str, vector: Vector3<'_>) {
        self.matrix(name, &vector.0.map(|component| vec![component]));
    }

    fn matrix4(&mut self, name: &str, pose: Pose<'_>) {
        self.matrix(name, &pose.matrix4().map(|row| row.to_vec()));
    }

    fn matrix(&mut self, name: &str, rows: &[Vec<Expr<'_>>]) {
        let Some(columns) = rows.first().map(Vec::len) else {
            return;
        };
        let entries: Vec<Expr<'_>> = rows.iter().flatten().copied().collect();
        let listing = entries[0].graph().listing(&entries, self.style, "t");
        self.definitions(&listing.definitions);
        match self.style {
            Style::Latex => {
                let symbol = match name {
                    "omega" => "\\omega",
                    other => other,
                };
                let rows: Vec<String> = listing.values.chunks(columns).map(|row| row.join(" & ")).collect();
                self.line(&format!("\\[ {symbol} = \\begin{{bmatrix}} {} \\end{{bmatrix}} \\]", rows.join(" \\\\ ")));
            }
            Style::Text => {
                let width = |column: usize| {
                    listing
                        .values
                        .iter()
                        .skip(column)
                        .step_by(columns)
                        .map(|text| text.chars().count())
                        .max()
                        .unwrap_or(0)
                };
                for (i, row) in listing.values.chunks(columns).enumerate() {
                    let label = if i == 0 {
                        format!("  {name} = [")
                    } else {
                        format!("  {} [", " ".repeat(name.chars().count() + 2))
                    };
                    let mut text = label;
                    for (j, entry) in row.iter().enumerate() {
                        let pad = " ".repeat(width(j) - entry.chars().count());
                        let _ = write!(text, " {entry}{pad} ");
                    }
                    self.line(&format!("{text}]"));
                }
            }
        }
    }
}

/// A step as it is written in a spec.
pub fn described(step: Step<'_>) -> String {
    match step {
        Step::Translate(Vector3([x, y, z])) => format!("translate({x}, {y}, {z})"),
        Step::Rotate(Line::X, angle) => format!("rotate_x({})", angle_text(angle)),
        Step::Rotate(Line::Y, angle) => format!("rotate_y({})", angle_text(angle)),
        Step::Rotate(Line::Z, angle) => format!("rotate_z({})", angle_text(angle)),
        Step::Rotate(Line::Along(Vector3([x, y, z])), angle) => {
            format!("rotate([{x}, {y}, {z}], {})", angle_text(angle))
        }
        Step::Rigid(_) => "matrix(…)".to_string(),
        Step::Mirror(Line::X) => "mirror_x()".to_string(),
        Step::Mirror(Line::Y) => "mirror_y()".to_string(),
        Step::Mirror(Line::Z) => "mirror_z()".to_string(),
        Step::Mirror(Line::Along(Vector3([x, y, z]))) => format!("mirror([{x}, {y}, {z}])"),
    }
}

fn angle_text(angle: Expr<'_>) -> String {
    match angle.as_constant() {
        Some(value) => shown(value, Dimension::ANGLE),
        None => angle.to_string(),
    }
}

/// Text in which nothing is a command of LaTeX.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '\\' => out.push_str("\\textbackslash{}"),
            '^' => out.push_str("\\textasciicircum{}"),
            '~' => out.push_str("\\textasciitilde{}"),
            '_' | '&' | '%' | '#' | '$' | '{' | '}' => out.extend(['\\', letter]),
            _ => out.push(letter),
        }
    }
    out
}
