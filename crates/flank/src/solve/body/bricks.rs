//! `flank mesh`: bodies as bricks for finite elements.

use std::collections::BTreeSet;

use flank_chain_dsl::{Job, Solid};
use flank_export::{BrickBody, BrickSet, Header};
use flank_expr::Graph;
use flank_solver::{
    Body, BrickCounts, BrickFaces, BrickMesh, BrickOrder, BrickQuality, BrickSide, OutlineSegment, SpacePart,
};

use crate::project::choices::{BrickFormat, Choice, ElementOrder};
use crate::project::failure::Failure;
use crate::project::files::Folder;
use crate::project::monitor::Monitor;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::requests::MeshRequest;
use crate::project::session::Session;
use crate::project::shown_path;
use crate::project::spec;
use crate::project::spec::Origin;
use crate::project::units::length;
use crate::solve::body::bricks_result::{BrickNumbers, MeshResult, exact_volume};
use crate::solve::body::file_of;
use crate::solve::body::refusal;
use crate::solve::body::space::{self, Space};
use crate::solve::dataset::header;

/// Bytes that a mesh may take with what its files are made from: what machines of today can spare.
const MOST_BYTES: usize = 1 << 30;
/// The width of a tooth's tip that counts as none, mm: rounding of solved points.
const LEAST_LAND: f64 = 1e-6;
/// The scaled Jacobian below which bricks are good for nothing.
const LEAST_SHAPE: f64 = 0.1;
const STRAIGHT_BLANK: &str = "a blank whose ends run straight from the tip to the bore: below the teeth, lines from every place of the spaces to the rest of the outline \
     must not cross it, as they do where a web is much narrower than the teeth";
/// How far the volume of bricks may be off, as a share: stiffness goes by the third power of a width, and is 15 % off by then.
const MOST_VOLUME: f64 = 0.05;
/// Bytes of a node, in sections and in place, and of a brick's node, in parts and together.
const OF_NODE: usize = 3 * size_of::<[f64; 3]>();
const OF_CORNER: usize = 2 * size_of::<u32>() + size_of::<i64>();

/// Cuts the bodies of jobs into bricks and writes these. `each` is given the result of each job.
///
/// # Errors
/// What is wrong with the spec, that it has no solid, that there would be too many bricks, or that a file cannot be written.
pub fn mesh(request: &MeshRequest, monitor: &dyn Monitor, each: &mut dyn FnMut(MeshResult)) -> Result<(), Failure> {
    let graph = Graph::new();
    let (compilation, jobs) = spec::jobs(&graph, &request.jobs, monitor)?;
    let origin = Origin::of_compilation(&compilation);
    let session = Session::new(request.evaluator, monitor).with_points_alone();
    for job in space::with_solids(&jobs)? {
        each(meshed(job, (request, &origin), session)?);
    }
    Ok(())
}

fn meshed(
    job: &Job<'_>,
    (request, origin): (&MeshRequest, &Origin),
    session: Session<'_>,
) -> Result<MeshResult, Failure> {
    let header = header(&[job], &request.jobs, origin);
    let mut folder = Folder::at(&request.out, origin, session.monitor());
    let (mut solids, mut not_done, mut uncut) = (Vec::new(), Vec::new(), Vec::new());
    for solid in &job.solids {
        let _working = session.begin(format!("meshing {}", solid.name))?;
        match space::body(job, solid, session) {
            Ok(space) => match one(job, solid, &space, (request, &header), &mut folder)? {
                Ok(numbers) => {
                    solids.push(numbers);
                    uncut.extend(space.uncut(job, solid, session)?.1);
                }
                Err(refused) => not_done.push(refused),
            },
            Err(failure) => not_done.push(refusal::no_body(solid, failure)?),
        }
    }
    for told in &mut not_done {
        let solid = job.solids.iter().find(|solid| told.of.as_ref() == Some(&solid.name));
        let formats = request.format.iter().map(|format| format.name());
        told.details.extend(solid.into_iter().flat_map(|solid| folder.older(&file_of(job, solid), formats.clone())));
    }
    not_done.extend(uncut);
    Ok(MeshResult {
        job: job.name.clone(),
        spec: shown_path(request.jobs.file()),
        solids,
        files: folder.finish()?,
        not_done: origin.located(&[job], not_done),
    })
}

/// The bricks of a solid, or why there are none.
fn one(
    job: &Job<'_>,
    solid: &Solid,
    space: &Space,
    (request, header): (&MeshRequest, &Header),
    folder: &mut Folder<'_>,
) -> Result<Result<BrickNumbers, NotDone>, Failure> {
    let body = &space.body;
    let teeth = request.teeth.unwrap_or(body.teeth());
    let refused = |message: String, ways: &[&str]| {
        let ways = ways.iter().map(ToString::to_string).collect();
        Ok(Err(NotDone::new(NotDoneKind::NoBricks, &solid.name, message).with(ways)))
    };
    if teeth > body.teeth() {
        let message = format!("`{}` has {} teeth: there are no {teeth} of them", solid.name, body.teeth());
        return refused(message, &["fewer with option `teeth`, or `all`"]);
    }
    if body.least_land() < LEAST_LAND {
        let message = format!("the teeth of `{}` end in an edge: bricks need a land at their tip", solid.name);
        return refused(message, &["a lower tip of the blank, if it is to have one"]);
    }
    if body.reaches_axis() {
        let message = format!("the blank of `{}` reaches its axis: bricks would have no room there", solid.name);
        return refused(message, &["a bore, however small: its outline then runs beside the axis and not along it"]);
    }
    let order = match request.order {
        ElementOrder::First => BrickOrder::First,
        ElementOrder::Second => BrickOrder::Second,
    };
    let elements = request.elements.map(|count| count as usize);
    let cut = |counts: BrickCounts| -> Result<(BrickCounts, BrickMesh, BrickQuality), Failure> {
        check_size(&solid.name, counts.size(body, order, teeth as usize), order)?;
        let mesh = body.bricks(&counts, order, teeth as usize);
        let quality = mesh.quality();
        Ok((counts, mesh, quality))
    };
    let (mut counts, mut mesh, mut quality) = cut(body.brick_counts(elements))?;
    // sections across the teeth do not reach what goes on beyond them
    if folded(quality).is_some()
        && let Some(with_shaft) = body.brick_counts_with_shaft(elements)
    {
        (counts, mesh, quality) = cut(with_shaft)?;
    }
    if let Some(why) = folded(quality) {
        let straight = || body.bricks(&counts, BrickOrder::First, teeth as usize).quality();
        let straight = (order == BrickOrder::Second).then(straight).filter(|quality| folded(*quality).is_none());
        let (message, ways) = of_folded(solid, why, beyond_teeth(body).filter(|_| counts.shaft.is_none()));
        let straight = straight.map(|quality| {
            format!(
                "bricks of the first order, with option `order`: their least scaled Jacobian is {:.3} with the same numbers",
                quality.least_scaled_jacobian
            )
        });
        return refused(message, &straight.as_deref().into_iter().chain(ways).collect::<Vec<&str>>());
    }
    let off = exact_volume(body, teeth).map_or(0.0, |exact| quality.volume / exact - 1.0);
    if off.abs() > MOST_VOLUME {
        let message = format!(
            "the bricks of `{}` would be another body: their volume is {:.1} % off, and their faces are off the generated surfaces by up to {}",
            solid.name,
            100.0 * off,
            length(mesh.deviation)
        );
        return refused(
            message,
            &["more bricks with option `elements`, above all along the teeth where these wind about the axis"],
        );
    }
    let sets = sets(&mesh, body, &names(space, body), teeth);
    let file = file_of(job, solid);
    let written = BrickBody {
        name: &solid.name,
        frame: &solid.frame,
        nodes: &mesh.nodes,
        nodes_of_brick: order.nodes(),
        bricks: &mesh.bricks,
        teeth: teeth as usize,
        sets: &sets,
        deviation: mesh.deviation,
    };
    for format in &request.format {
        match format {
            BrickFormat::Inp => folder.bricks_inp(&file, header, &written)?,
            BrickFormat::Vtu => folder.bricks_vtu(&file, header, &written)?,
        }
    }
    Ok(Ok(BrickNumbers::new((&solid.name, &solid.frame), body, &counts, (mesh, quality), sets)))
}

/// The segment of the outline below the teeth that goes on farthest beyond the ends of these, and by how much, mm.
fn beyond_teeth(body: &Body) -> Option<(String, f64)> {
    let blank = body.blank();
    let beyond = |segment: &OutlineSegment| {
        [segment.from, segment.to].map(|place| blank.beyond_ends(place)).into_iter().fold(0.0, f64::max)
    };
    let rest = blank.rest().into_iter().map(|segment| (segment.name.clone(), beyond(segment)));
    rest.filter(|(_, by)| *by > LEAST_LAND).reduce(|most, other| if other.1 > most.1 { other } else { most })
}

/// What bricks that are folded are told as, and ways out; with what of the outline goes on beyond the teeth and has no bricks of its own.
fn of_folded(solid: &Solid, why: String, beyond: Option<(String, f64)>) -> (String, [&'static str; 2]) {
    let message = format!("the bricks of `{}` would be folded or nearly so: {why}", solid.name);
    match beyond {
        Some((segment, by)) => (
            format!(
                "{message}. `{segment}` of the outline goes on beyond the teeth, by up to {}, and bricks follow it only as a shaft with a face at \
                 its end",
                length(by)
            ),
            [
                "in a job that extends this one a blank that ends with its teeth: both ends straight from the tip to the bore",
                "or the whole body for a mesher that fills any: `flank solve` with option `step`",
            ],
        ),
        None => (message, ["other numbers with option `elements`", STRAIGHT_BLANK]),
    }
}

/// Why bricks are good for nothing.
fn folded(quality: BrickQuality) -> Option<String> {
    let BrickQuality { least_scaled_jacobian: scaled, least_jacobian: least, .. } = quality;
    if scaled < LEAST_SHAPE {
        return Some(format!("their least scaled Jacobian is {scaled:.3}, and has to be {LEAST_SHAPE} at the least"));
    }
    (least <= 0.0).then(|| format!("their least Jacobian is {least:.3} of a brick's mean, and has to be above 0"))
}

fn check_size(name: &str, [bricks, nodes]: [usize; 2], order: BrickOrder) -> Result<(), Failure> {
    let bytes = nodes.saturating_mul(OF_NODE).saturating_add(bricks.saturating_mul(order.nodes() * OF_CORNER));
    if bytes <= MOST_BYTES {
        return Ok(());
    }
    Err(Failure::TooLarge(format!(
        "`{name}` would have {bricks} bricks of {} nodes: that would take about {:.1} GB, and {:.1} GB is the most; ask for fewer with \
         option `elements` or option `teeth`",
        order.nodes(),
        bytes as f64 / 1e9,
        MOST_BYTES as f64 / 1e9
    )))
}

/// What the sets on charts are called, in the order of the body.
fn names(space: &Space, body: &Body) -> Vec<String> {
    let (count, is_reversed) = (body.charts().len(), body.is_reversed());
    let name = |(k, part): (usize, SpacePart)| {
        let own = &space.names[if is_reversed { count - 1 - k } else { k }];
        let kind = match part {
            SpacePart::Chamfer => "CHAMFER",
            SpacePart::Flank => "FLANK",
            SpacePart::Fillet => "FILLET",
            SpacePart::Root => "ROOT",
        };
        format!("{kind}_{}", set_name(own))
    };
    body.space_parts().into_iter().enumerate().map(name).collect()
}

/// As readers of input files take names: they do not tell small letters from large ones.
fn set_name(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_uppercase() } else { '_' }).collect()
}

/// The sets of a mesh, those of one tooth beside each other.
fn sets(mesh: &BrickMesh, body: &Body, charts: &[String], teeth: u32) -> Vec<BrickSet> {
    let mut taken = BTreeSet::new();
    let mut sets = Vec::new();
    let mut add = |name: String, faces: &[&BrickFaces]| {
        let mut name = name;
        while !taken.insert(name.clone()) {
            name.push('_');
        }
        let nodes = mesh.side_nodes(faces);
        sets.push(BrickSet { name, faces: faces.iter().flat_map(|of| of.faces.iter().copied()).collect(), nodes });
    };
    for of in mesh.faces.iter() {
        if let BrickSide::Chart(chart) = of.side {
            let name = &charts[chart];
            add(if teeth == 1 { name.clone() } else { format!("{name}_T{}", of.tooth + 1) }, &[of]);
        }
    }
    let on = |side: BrickSide| mesh.faces.iter().filter(|of| of.side == side).collect::<Vec<&BrickFaces>>();
    let cuts = (0..2).map(|k| (format!("SIDE_{}", k + 1), BrickSide::Cut(k)));
    let segments = body.blank().outline.segments().iter().enumerate();
    let outline = segments.map(|(k, segment)| (set_name(&segment.name), BrickSide::Outline(k)));
    for (name, side) in cuts.chain(outline) {
        let faces = on(side);
        if !faces.is_empty() {
            add(name, &faces);
        }
    }
    sets
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_that_is_too_large_is_refused_with_its_size() {
        assert!(check_size("gear", [100_000, 450_000], BrickOrder::Second).is_ok());
        let refused = check_size("gear", [3_000_000, 13_000_000], BrickOrder::Second).expect_err("1.9 GB");
        let told = refused.to_string();
        assert!(
            told.starts_with("`gear` would have 3000000 bricks of 20 nodes: that would take about 1.9 GB, and 1.1 GB"),
            "{told}"
        );
    }
}
