//! How much work typical equations are: exact counts, so that a silent loss shows up. A smaller number is good news.

use flank_expr::geometry::{Axis, Chain, Step, Surface, Vector3};
use flank_expr::{Expr, Graph, Operation, Tape, Unary};

/// A cone turned about a cradle's axis by `motions[0]` while the work rolls with it, eleven settings; then the second gear
/// that the first one generates over `motions[1]`.
struct Model<'g> {
    generated: Surface<'g>,
    conjugate: Surface<'g>,
    inputs: Vec<Expr<'g>>,
}

impl<'g> Model<'g> {
    /// Settings are variables, or numbers.
    fn new(graph: &'g Graph, settings_are_numbers: bool) -> Model<'g> {
        let mut inputs: Vec<Expr<'g>> = ["u", "theta", "phi", "psi"].map(|name| graph.variable(name)).to_vec();
        let [u, theta, phi, psi] = inputs[..] else { panic!("four") };
        let mut setting = |name: &str, value: f64| {
            if settings_are_numbers {
                return graph.constant(value);
            }
            inputs.push(graph.variable(name));
            inputs[inputs.len() - 1]
        };
        let zero = graph.constant(0.0);
        let shift = |x, y, z| Step::Translate(Vector3([x, y, z]));
        let (blade, point_radius) = (setting("blade_angle", 0.35), setting("point_radius", 114.0));
        let radius = point_radius + u * blade.sin();
        let cone = Surface::parametric(
            [u, theta],
            Vector3([radius * theta.cos(), radius * theta.sin(), -(u * blade.cos())]),
            false,
        );
        let roll = setting("ratio_of_roll", 3.2) * (phi - 0.02 * phi.powi(2) + 0.003 * phi.powi(3));
        let t_work_tool = Chain::new(
            graph,
            vec![
                Step::Rotate(Axis::Z, -roll),
                shift(zero, zero, -setting("machine_center_to_crossing_point", -1.0)),
                Step::Rotate(Axis::Y, setting("machine_root_angle", 0.6)),
                shift(zero, setting("work_offset", 2.0), setting("sliding_base", 3.0)),
                Step::Rotate(Axis::Z, setting("cradle_angle", 1.1) + phi),
                shift(setting("radial_distance", 110.0), zero, zero),
                Step::Rotate(Axis::Z, setting("cutter_swivel", -0.2)),
                Step::Rotate(Axis::X, setting("cutter_tilt", 0.3)),
            ],
        );
        let generated = cone.envelope(&t_work_tool.merged(), &[phi]);
        let t_pinion_gear = Chain::new(
            graph,
            vec![
                Step::Rotate(Axis::Z, -(setting("ratio", 3.0) * psi)),
                shift(setting("offset", 10.0), zero, zero),
                Step::Rotate(Axis::X, setting("shaft_angle", 1.6)),
                Step::Rotate(Axis::Z, psi),
            ],
        );
        let conjugate = generated.envelope(&t_pinion_gear.merged(), &[psi]);
        Model { generated, conjugate, inputs }
    }

    /// Steps of the tape, and pairs of sine and cosine, single ones and roots among them, of the equations for a point and their Jacobian.
    fn steps(&self, surface: &Surface<'g>) -> (usize, usize) {
        let [x, y, z] = surface.position.0;
        let residuals = [surface.constraints.clone(), vec![z, (x.squared() + y.squared()).sqrt()]].concat();
        let slopes = residuals.iter().flat_map(|f| surface.unknowns.iter().map(|p| f.derivative(*p)));
        let outputs: Vec<Expr<'g>> = residuals.iter().copied().chain(slopes).collect();
        let tape = Tape::new(&outputs, &self.inputs).expect("every variable is an input");
        let is_slow = |op| matches!(op, Operation::SinCos | Operation::Unary(Unary::Sin | Unary::Cos | Unary::Sqrt));
        let slow = tape.instructions().iter().filter(|step| is_slow(step.operation)).count();
        (tape.instructions().len(), slow)
    }
}

#[test]
fn with_settings_as_variables() {
    let graph = Graph::new();
    let model = Model::new(&graph, false);
    assert_eq!(model.steps(&model.generated), (214, 7));
    assert_eq!(model.steps(&model.conjugate), (440, 10));
}

#[test]
fn with_settings_as_numbers() {
    let graph = Graph::new();
    let model = Model::new(&graph, true);
    assert_eq!(model.steps(&model.generated), (201, 3));
    assert_eq!(model.steps(&model.conjugate), (420, 5));
}
