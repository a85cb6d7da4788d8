//! `flank contact --certify`: proofs that the flanks touch where they are said to.

use flank_chain_dsl::Contact;
use flank_solver::ContactProof;

use crate::contact::pair::Members;
use crate::contact::result::ProvenContact;
use crate::contact::rolling::Rolling;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::units;

/// What is proven of one pair of teeth from its first touch to its last, and what is not.
pub(crate) fn of_engagement(members: &Members<'_, '_>, rolling: &Rolling) -> (ProvenContact, Vec<NotDone>) {
    let Contact { name, roll, lag, .. } = members.contact;
    let points = &rolling.engagement.points;
    let proofs = rolling.problem.proven(points);
    let open: Vec<String> = points
        .iter()
        .zip(&proofs)
        .filter(|(_, proof)| proof.is_none())
        .map(|(point, _)| units::text(roll.dimension, point.roll, 3))
        .collect();
    let most = |of: &dyn Fn(&ContactProof) -> f64| proofs.iter().flatten().map(of).reduce(f64::max);
    let proven = ProvenContact {
        points: proofs.iter().flatten().count(),
        radius_mm: most(&|proof| proof.position),
        error: most(&|proof| proof.lag).map(|error| units::shown(lag.dimension, error)),
    };
    let message = || {
        let (count, places) = (units::counted(open.len(), "position"), open.join(", "));
        format!("contact {name}: not certified at {count} of {}: {places}", roll.name)
    };
    let way =
        "where the flanks touch along a line, or an edge only just begins to touch, no single point can be proven"
            .to_string();
    let surface = &members.surfaces[0].name;
    let not_done =
        (!open.is_empty()).then(|| NotDone::new(NotDoneKind::NotCertified, surface, message()).with(vec![way]));
    (proven, not_done.into_iter().collect())
}
