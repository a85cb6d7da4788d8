//! The surface that is milled, and the cutter on it.

use std::ops::Deref;

use flank_chain_dsl::{BlockLength, Job, Milling, PassSpacing};
use flank_expr::{ScalarEvaluator, Tape};
use flank_solver::{Chart, CutterPose, Lean, NoPose, OutlinePiece, PoseField, SurfaceFrame};

use super::cutter::MillingCutter;
use super::patch::{ENOUGH, GRIDS, Lattice, NEAR, Patch, halfway, point_field, rough};
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::session::Session;

/// Polynomials that are not as near as [`NEAR`] are near enough where they are off by no more than this share of
/// the scallop and of the chord that are asked for.
const SHARE: f64 = 0.01;

/// A surface that is milled.
pub(super) struct Target<'j, 'g> {
    patch: Patch<'j, 'g>,
    pub(super) milling: &'j Milling<'g>,
    lean: Tape,
}

impl<'j, 'g> Deref for Target<'j, 'g> {
    type Target = Patch<'j, 'g>;

    fn deref(&self) -> &Patch<'j, 'g> {
        &self.patch
    }
}

/// A surface and the cutter on it as polynomials.
pub(super) struct Fields {
    /// Position and normal of the surface.
    pub(super) surface: PoseField,
    /// Origin and axis of the cutter on passes that run forwards, and on those that run backwards if there are any; nothing of a pass with
    /// the side.
    pub(super) cutter: Vec<PoseField>,
    /// How far the polynomials may be off, mm.
    pub(super) off: f64,
    /// The exact points that they go through.
    pub(super) lattice: Lattice,
}

impl Fields {
    /// The cutter's poses on passes of a number.
    pub(super) fn of_pass(&self, number: usize) -> &PoseField {
        &self.cutter[number % self.cutter.len()]
    }
}

impl<'j, 'g> Target<'j, 'g> {
    pub(super) fn new(job: &'j Job<'g>, milling: &'j Milling<'g>, session: Session<'_>) -> Target<'j, 'g> {
        let lean = milling.lean.map(|lean| lean.graph().substitute(&[lean], &job.bindings())[0]);
        Target {
            patch: Patch::new(job, &job.surfaces[milling.surface], milling.area.clone(), session),
            milling,
            lean: Tape::new(&lean, &milling.area.variables).expect("a job without errors leaves nothing unbound"),
        }
    }

    /// How the cutter leans at shares.
    pub(super) fn lean(&self, shares: [f64; 2]) -> Lean {
        let mut out = [0.0; 2];
        ScalarEvaluator::new(&self.lean).run(&self.values(shares), &mut out);
        Lean { lead: out[0], tilt: out[1], stock: self.milling.stock }
    }

    /// The pose of the cutter at a point.
    ///
    /// # Errors
    /// Why it cannot touch there, with the place.
    pub(super) fn pose(
        &self,
        shares: [f64; 2],
        frame: &SurfaceFrame,
        cutter: &MillingCutter,
        forward: f64,
    ) -> Result<CutterPose, NotDone> {
        let lean = self.lean(shares);
        if let Some((name, _)) = [("lead", lean.lead), ("tilt", lean.tilt)].into_iter().find(|of| !of.1.is_finite()) {
            let message = format!("`{name}` of {} is no number at {}", self.milling.name, self.place(shares));
            let way =
                "its formula has no value there: a root or an arcus of what is out of its range, or a division by zero";
            return Err(NotDone::new(NotDoneKind::NotMilled, self.name(), message).with(vec![way.to_string()]));
        }
        let pose = CutterPose::touching(frame, &cutter.cutting, lean, forward);
        pose.map_err(|why| {
            let place = self.place(shares);
            let (message, way) = match why {
                NoPose::Flat => (
                    format!("the bottom of {} lies flat on {} at {place}", self.milling.cutter_name, self.name()),
                    "nothing says which point of its edge touches: give it a `lead` above zero".to_string(),
                ),
                NoPose::OffCutter { angle } => (
                    format!(
                        "{} does not touch {} at {place}: its normal would be {:.3} deg from the tip",
                        self.milling.cutter_name,
                        self.name(),
                        angle.to_degrees()
                    ),
                    cutter.angles(),
                ),
                NoPose::NoFeed => {
                    (format!("{} has no direction along the pass at {place}", self.name()), String::new())
                }
            };
            let details = [way].into_iter().filter(|way| !way.is_empty()).collect();
            NotDone::new(NotDoneKind::NotMilled, self.name(), message).with(details)
        })
    }

    /// That what is cut deeper than the surface leaves the arcs of the cutter some radius.
    ///
    /// # Errors
    /// If it does not.
    pub(super) fn has_room(&self, cutter: &MillingCutter) -> Result<(), NotDone> {
        let arcs = cutter.cutting.pieces.iter().filter_map(|piece| match *piece {
            OutlinePiece::Arc { radius, .. } if radius > 0.0 => Some(radius),
            _ => None,
        });
        let stock = self.milling.stock;
        let Some(radius) = arcs.reduce(f64::min).filter(|radius| stock <= -radius) else { return Ok(()) };
        let [stock, radius] = [stock, radius].map(|x| (1e9 * x).round() / 1e9);
        let message = format!(
            "`stock {stock} mm` of {} lies deeper than an arc of {} is round: its radius is {radius} mm",
            self.milling.name, self.milling.cutter_name
        );
        let way = format!("cut less deep than {radius} mm, or take a cutter with a larger arc");
        Err(NotDone::new(NotDoneKind::NotMilled, self.name(), message).with(vec![way]))
    }

    /// Surface and cutter as polynomials that are as near as [`NEAR`], or else as heights ask for.
    ///
    /// # Errors
    /// What the surface does not have, or that its polynomials do not come as near.
    pub(super) fn fields(&self, cutter: &MillingCutter) -> Result<Fields, NotDone> {
        let mut rougher = None;
        for counts in GRIDS {
            let fields = self.fields_through(counts, cutter)?;
            if fields.off <= NEAR {
                return Ok(fields);
            }
            rougher = Some(fields);
        }
        // a profile with a relief bends at once where that begins: coefficients tell little of how near such polynomials are
        let mut fields = rougher.expect("there are counts");
        fields.off = self.measured(&fields, cutter)?;
        if fields.off <= self.needed() { Ok(fields) } else { Err(rough(self.name(), fields.off)) }
    }

    /// How near polynomials have to be, mm.
    fn needed(&self) -> f64 {
        let scallop = if let PassSpacing::Scallop(height) = self.milling.spacing { height } else { f64::INFINITY };
        let chord = if let BlockLength::Chord(chord) = self.milling.blocks { chord } else { f64::INFINITY };
        let asked = SHARE * scallop.min(chord);
        if asked.is_finite() { asked } else { ENOUGH }
    }

    /// Surface and cutter through exact points at so many rows and columns.
    fn fields_through(&self, counts: [usize; 2], cutter: &MillingCutter) -> Result<Fields, NotDone> {
        let lattice = self.lattice(counts.map(Chart::shares))?;
        let surface = point_field(&lattice);
        let poses = self.directions().iter().map(|forward| {
            let rows = lattice.each().map(|(shares, frame)| Ok(self.pose(shares, frame, cutter, *forward)?.row()));
            Ok(PoseField::through(rows.collect::<Result<Vec<[f64; 6]>, NotDone>>()?, counts))
        });
        let cutter = poses.collect::<Result<Vec<PoseField>, NotDone>>()?;
        let off = cutter.iter().map(PoseField::tail).fold(surface.tail(), f64::max);
        Ok(Fields { surface, cutter, off, lattice })
    }

    /// The ways that passes run: with its side the cutter lies as leaves least, not as it is told to lean.
    fn directions(&self) -> &'static [f64] {
        match self.milling.both_ways {
            _ if matches!(self.milling.spacing, PassSpacing::Side(_)) => &[],
            true => &[1.0, -1.0],
            false => &[1.0],
        }
    }

    /// How far polynomials are off half-way between the points that they go through, mm: along the normal of the surface, and so far as that moves
    /// the part of the cutter that touches.
    fn measured(&self, fields: &Fields, cutter: &MillingCutter) -> Result<f64, NotDone> {
        let lattice = self.lattice(fields.lattice.shares.each_ref().map(|nodes| halfway(nodes)))?;
        let mut off: f64 = 0.0;
        for (shares, frame) in lattice.each() {
            let near = fields.surface.at(shares);
            let along = (0..3).map(|k| (near[k] - frame.position[k]) * frame.normal[k]).sum::<f64>();
            off = off.max(along.abs());
            for (field, forward) in fields.cutter.iter().zip(self.directions()) {
                let exact = self.pose(shares, frame, cutter, *forward)?;
                let near = field.at(shares);
                let tip = (0..3).map(|k| (near[k] - exact.tip[k]) * frame.normal[k]).sum::<f64>();
                let arm = [0, 1, 2].map(|k| frame.position[k] - exact.tip[k]);
                let height = (0..3).map(|k| arm[k] * exact.axis[k]).sum::<f64>();
                let turned = (0..3).map(|k| (near[3 + k] - exact.axis[k]) * frame.normal[k]).sum::<f64>();
                off = off.max((tip + height * turned).abs());
            }
        }
        Ok(off)
    }
}
