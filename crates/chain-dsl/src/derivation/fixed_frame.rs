//! The way from the tool over the fixed frame to the work, as papers on machines write it: matrices, locus and normal, velocities
//! of a common point by the rates of the axes, the equation of meshing.

use flank_expr::geometry::{Chain, Step, Vector3};
use flank_expr::{Expr, Graph, Style};

use super::{Page, escaped};
use crate::model::{Axis, GeneratedSurface, Generation, Machine, ToolShape};

/// A machine's axis with a variable that stands for its rate.
type Rated<'m, 'g> = (&'m Axis<'g>, Expr<'g>);

impl Page {
    /// Written for the envelope of a tool's surface where tool and work both move against the machine's root.
    pub(super) fn fixed_frame(&mut self, surface: &GeneratedSurface<'_>, machines: &[Machine<'_>]) {
        let generation = &surface.generation;
        let ToolShape::Surface(tool) = &generation.tool else { return };
        let Some((machine, fixed)) = root(generation, machines) else { return };
        let frame = &generation.path[fixed].0;
        let short = short(frame);
        self.text(&format!(
            "from the tool through the fixed frame {frame} to the work, each matrix with its vector part:"
        ));
        self.matrices(generation);
        let graph = tool.position.0[0].graph();
        let t_work_fixed = chain(graph, &generation.path[1..=fixed]);
        let t_fixed_tool = chain(graph, &generation.path[fixed + 1..]);
        let (r_fixed, n_fixed) = (t_fixed_tool.point(tool.position), t_fixed_tool.direction(tool.normal));
        self.locus(frame, r_fixed, n_fixed);
        self.locus(&surface.frame, t_work_fixed.point(r_fixed), t_work_fixed.direction(n_fixed));

        let rated: Vec<Rated<'_, '_>> = machine
            .axes
            .iter()
            .map(|axis| (axis, graph.variable(format!("{}.{}_rate", machine.name, axis.name))))
            .collect();
        let common = Vector3(["x", "y", "z"].map(|name| graph.variable(format!("P_{name}"))));
        self.text(&format!("a point P that tool and work have in common, in {frame}; each axis moves at its rate:"));
        self.vector("P", common);
        self.text("velocity of P as a point of the work:");
        let of_work = velocity(graph, &t_work_fixed, &rated, common);
        self.vector(&self.subscript("V", "work"), of_work);
        self.text("velocity of P as a point of the tool:");
        let of_tool = velocity(graph, &t_fixed_tool.inverse(), &rated, common);
        self.vector(&self.subscript("V", "tool"), of_tool);
        self.text("relative velocity, of the tool against the work:");
        let relative = Vector3([0, 1, 2].map(|k| of_tool.0[k] - of_work.0[k]));
        self.vector("V", relative);
        self.text(&format!("equation of meshing, f = n_{short} . V = 0:"));
        let listing = graph.listing(&[n_fixed.dot(relative)], self.style, "t");
        self.definitions(&listing.definitions);
        self.equation("f", &listing.values[0]);
        self.rates(generation, &rated, [&t_work_fixed, &t_fixed_tool]);
    }

    /// Of each frame in the next one towards the work.
    fn matrices(&mut self, generation: &Generation<'_>) {
        let graph = generation.position().0[0].graph();
        for pair in generation.path.windows(2).rev() {
            let (to, from) = (short(&pair[0].0), short(&pair[1].0));
            let pose = Chain::new(graph, pair[1].1.clone()).pose();
            self.text(&format!("{} to {}:", pair[1].0, pair[0].0));
            self.matrix4(&self.subscript("M", &format!("{to}_{from}")), pose);
            self.matrix(&self.subscript("L", &format!("{to}_{from}")), &pose.rotation.0.map(|row| row.0.to_vec()));
        }
    }

    fn locus(&mut self, frame: &str, position: Vector3<'_>, normal: Vector3<'_>) {
        self.text(&format!("locus and unit normal of the tool in {frame}, mm:"));
        self.vector(&self.subscript("r", short(frame)), position);
        self.vector(&self.subscript("n", short(frame)), normal);
    }

    /// What the rates are along each motion.
    fn rates(&mut self, generation: &Generation<'_>, rated: &[Rated<'_, '_>], chains: [&Chain<'_>; 2]) {
        for motion in &generation.motions {
            self.text(&format!("rates of the axes along {motion}, the others rest:"));
            for (axis, rate) in rated {
                let slope = axis.law.derivative(*motion);
                if slope.is_zero() || chains.iter().all(|chain| chain.twist(axis.variable).is_zero()) {
                    continue;
                }
                let listing = slope.graph().listing(&[*rate, slope], self.style, "t");
                self.definitions(&listing.definitions);
                self.equation(&listing.values[0], &listing.values[1]);
            }
        }
    }

    /// `V_tool`, `M_head_hob`.
    fn subscript(&self, symbol: &str, of: &str) -> String {
        match self.style {
            Style::Text => format!("{symbol}_{of}"),
            Style::Latex => format!("{symbol}_{{\\mathrm{{{}}}}}", escaped(of)),
        }
    }
}

/// The machine whose root lies on the way between tool and work, and where.
fn root<'m, 'g>(generation: &Generation<'g>, machines: &'m [Machine<'g>]) -> Option<(&'m Machine<'g>, usize)> {
    let last = generation.path.len().checked_sub(1)?;
    machines.iter().find_map(|machine| {
        let name = format!("{}.{}", machine.name, machine.frames.first()?.name);
        let place = generation.path.iter().position(|(frame, _)| *frame == name)?;
        (0 < place && place < last).then_some((machine, place))
    })
}

/// The velocity in a chain's last frame of a point that its first one carries: with T the pose of the last frame in the first, a
/// point that rests in the first moves in the last with the twist of T⁻¹, seen from there: −(ω × P + v).
fn velocity<'g>(graph: &'g Graph, chain: &Chain<'g>, rated: &[Rated<'_, 'g>], common: Vector3<'g>) -> Vector3<'g> {
    rated
        .iter()
        .fold(Vector3::zero(graph), |sum, (axis, rate)| sum - chain.twist(axis.variable).velocity(common).scaled(*rate))
}

fn chain<'g>(graph: &'g Graph, hops: &[(String, Vec<Step<'g>>)]) -> Chain<'g> {
    Chain::new(graph, hops.iter().flat_map(|(_, steps)| steps.clone()).collect())
}

/// The name of a frame without that of its machine.
fn short(frame: &str) -> &str {
    frame.rsplit('.').next().unwrap_or(frame)
}
