//! Files of a contact: how near the mate comes to the points of both flanks, the path on both, and a picture.

use flank_chain_dsl::Job;
use flank_draw::{ContactPicture, DrawnContact, PictureOptions};
use flank_export::{Dataset, Patch};

use crate::contact::milled::MilledPair;
use crate::contact::pair::Members;
use crate::contact::patches::{flank, path};
use crate::contact::pattern::GapMap;
use crate::contact::picture::drawing;
use crate::contact::rolling::Rolling;
use crate::project::failure::Failure;
use crate::project::files::Folder;
use crate::project::requests::ContactRequest;
use crate::project::session::Session;
use crate::project::spec::Origin;
use crate::project::units;
use crate::solve::arrays::PointGrid;
use crate::solve::header;

/// Writes them and names them; with the points that they have, in arrays.
///
/// # Errors
/// If one cannot be written.
pub(crate) fn write(
    job: &Job<'_>,
    members: &Members<'_, '_>,
    rolling: &Rolling,
    (maps, drawn, milled): (&[GapMap], DrawnContact, Option<&MilledPair>),
    errors: &[f64],
    (request, origin, session): (&ContactRequest, &Origin, Session),
) -> Result<(Vec<String>, Vec<PointGrid>), Failure> {
    let name = format!("{}.{}", job.name, members.contact.name);
    let mut header = header(&[job], &request.jobs, origin);
    let mounted = members.contact.errors.iter().zip(errors).filter(|(_, error)| **error != 0.0);
    header
        .conventions
        .extend(mounted.map(|(axis, error)| {
            format!("mounted wrong: {} = {}", axis.name, units::as_given(axis.dimension, *error))
        }));
    header.conventions.push(format!(
        "gap: along the normal of the flank out of its body; film of the marking compound {} um",
        request.compound * 1e3
    ));
    let flanks: Vec<Patch> = maps.iter().enumerate().map(|(member, map)| flank(job, members, member, map)).collect();
    let picture = (!request.no_picture).then(|| {
        let drawing = drawing(&job.name, vec![drawn], ContactPicture::Overview, header.clone());
        flank_draw::contact(ContactPicture::Overview, &drawing, &PictureOptions::default())
    });
    let paths = (0..2).map(|member| path(job, members, rolling, member));
    let dataset = Dataset { header, patches: flanks.into_iter().chain(paths).collect() };
    let mut folder = Folder::at(&request.out, origin, session.monitor());
    folder.picture_after(&name, picture.as_ref(), |folder| folder.data(&name, &dataset.surfaces(), &request.format))?;
    if let Some(milled) = milled {
        let name = format!("{name}.{}", milled.result.milling);
        let of_milled = Dataset { header: dataset.header.clone(), patches: milled.patches.to_vec() };
        let picture = || flank_draw::milled_pair(&milled.drawing, &PictureOptions::default());
        let picture = (!request.no_picture).then(picture);
        let formats = &request.format;
        folder.picture_after(&name, picture.as_ref(), |folder| folder.data(&name, &of_milled.surfaces(), formats))?;
    }
    let grids = dataset.patches.iter().map(PointGrid::of_patch).collect();
    Ok((folder.finish()?, grids))
}
