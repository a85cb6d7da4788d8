//! The sentences that every file of data states about itself.

use crate::points::dataset::Header;
use crate::text::one_line;

const UNITS: &str = "lengths in mm, angles in degrees, not reduced to one turn";
const FRAMES: &str = "positions and unit normals are in the frame named with their surface";
const NORMALS: &str = "a normal points out of the body that owns the surface: out of the gear's steel on a tooth flank";
const PLACES: &str = "row i and column j count from 0; what each runs over is named with its surface";

const CUT_AWAY: &str = "a point that is `undercut` or `trimmed` lies on the generated surface and is no point of the finished work; of one that is \
     `undecided` this is not known";

/// What a reader must know to use the numbers of all points, then the caller's own sentences.
#[must_use]
pub fn sentences(header: &Header) -> Vec<String> {
    let unsolved = "any other point that was not solved has a status that says why, the residual of the best attempt, and no other numbers";
    with_own(&[UNITS, FRAMES, NORMALS, PLACES, CUT_AWAY, unsolved], header)
}

/// The same for a mesh of the solved points.
pub(crate) fn sentences_of_mesh(header: &Header) -> Vec<String> {
    let solved = "only solved points are in this file; triangles face where the normals point";
    with_own(&[UNITS, FRAMES, NORMALS, solved], header)
}

/// The same for all points that have a place, with triangles between the solved ones.
pub(crate) fn sentences_of_points(header: &Header) -> Vec<String> {
    let placed = "status 0 is `solved`, 1 `undercut`, 2 `trimmed`, 3 `undecided`; other points are not in this file";
    let triangles = "triangles join solved points and face where the normals point";
    with_own(&[UNITS, FRAMES, NORMALS, PLACES, placed, CUT_AWAY, triangles], header)
}

fn with_own(fixed: &[&str], header: &Header) -> Vec<String> {
    fixed.iter().map(|&sentence| sentence.to_owned()).chain(header.conventions.iter().map(|s| one_line(s))).collect()
}
