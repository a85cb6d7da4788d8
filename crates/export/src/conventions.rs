//! The sentences that every file of data states about itself.

use crate::dataset::Header;

/// What a reader must know to use the numbers, then the caller's own sentences.
#[must_use]
pub fn sentences(header: &Header) -> Vec<String> {
    let fixed = [
        "lengths in mm, angles in degrees, not reduced to one turn",
        "positions and unit normals are in the frame named with their surface",
        "a normal points out of the body that owns the surface: out of the gear's steel on a tooth flank",
        "row i and column j count from 0; what each runs over is named with its surface",
        "a point that was not solved has a status that says why, the residual of the best attempt, and no other numbers",
    ];
    fixed.iter().map(|&sentence| sentence.to_owned()).chain(header.conventions.iter().map(|s| one_line(s))).collect()
}

/// Text that stays on its line, whatever a user has put into it.
pub(crate) fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}
