//! Cutters of millings as outlines.

use flank_chain_dsl::{CutterPiece, Job, Milling, ToolShape};
use flank_expr::Expr;
use flank_expr::geometry::Vector3;
use flank_solver::{Cutter, OutlinePiece, Range};

use crate::project::failure::Failure;

/// A cutter with numbers.
pub(super) struct MillingCutter {
    /// What touches the surface.
    pub(super) cutting: Cutter,
}

impl MillingCutter {
    /// # Errors
    /// If a surface of it is no surface of revolution, or its outline is neither a line nor an arc.
    pub(super) fn of_milling(job: &Job<'_>, milling: &Milling<'_>) -> Result<MillingCutter, Failure> {
        let cutting = outline(job, &milling.cutter)?.with_edges();
        if cutting.angles().is_none() {
            let name = &milling.cutter_name;
            let message = format!(
                "`{name}` has no arc and no edge: a cutter touches a surface with an arc of its outline, or with an edge that turns about its axis"
            );
            return Err(Failure::from(message));
        }
        Ok(MillingCutter { cutting })
    }

    /// Whether a sharp edge of it cuts.
    pub(super) fn has_edge(&self) -> bool {
        self.cutting.pieces.iter().any(|piece| matches!(piece, OutlinePiece::Arc { radius: 0.0, .. }))
    }

    /// Which normals it may touch with, in words.
    pub(super) fn angles(&self) -> String {
        let [from, to] = self.cutting.angles().unwrap_or_default().map(f64::to_degrees);
        format!(
            "its arcs have normals from {from:.3} deg to {to:.3} deg: change `lead` or `tilt`, or take another cutter"
        )
    }
}

pub(super) fn put<'g>(vector: Vector3<'g>, bindings: &[(Expr<'g>, Expr<'g>)]) -> Vector3<'g> {
    let found = vector.0[0].graph().substitute(&vector.0, bindings);
    Vector3([found[0], found[1], found[2]])
}

/// The outline of a part of a cutter.
///
/// # Errors
/// If a surface of it is no surface of revolution, or its outline is neither a line nor an arc.
pub(super) fn outline<'g>(job: &Job<'g>, pieces: &[CutterPiece<'g>]) -> Result<Cutter, Failure> {
    let bindings = job.bindings();
    let piece = |piece: &CutterPiece<'g>| {
        let (position, normal) = match &piece.shape {
            ToolShape::Surface(surface) => (surface.position, Some(surface.normal)),
            ToolShape::Edge(edge) => (edge.position, None),
        };
        let parameters: Vec<_> = piece.unknowns.iter().map(|unknown| unknown.variable).collect();
        let ranges: Vec<Range> =
            piece.unknowns.iter().map(|unknown| Range { low: unknown.low, high: unknown.high }).collect();
        let found = OutlinePiece::of_tool(
            put(position, &bindings),
            normal.map(|normal| put(normal, &bindings)),
            &parameters,
            &ranges,
        );
        let found = found.expect("a job without errors leaves nothing unbound");
        found.map_err(|why| Failure::from(format!("`{}` is no cutter that mills: {why}", piece.name)))
    };
    Ok(Cutter { pieces: pieces.iter().map(piece).collect::<Result<_, Failure>>()? })
}
