//! Pictures beside the one of the points.

use flank_draw::{Picture, PictureOptions, comparable_maps, field_maps};
use flank_export::{Dataset, Patch};

use crate::solve::cut;
use crate::solve::sensitivity::{self, MAPS};
use crate::solve::solved::Solved;

/// A picture of each surface: maps of the parameters that move it most. Named by the surface.
pub(super) fn sensitivities(solved: &[Solved<'_, '_>], dataset: &Dataset) -> Vec<(String, Picture)> {
    let mut pictures = Vec::new();
    // the surfaces come first among the patches
    for (patch, solved) in solved.iter().enumerate() {
        let Some(sensitivity) = &solved.sensitivity else { continue };
        let fields = sensitivity.plain_fields(&sensitivity.most_moving(MAPS));
        let shown: Vec<(usize, usize)> = (0..fields.len()).map(|field| (0, field)).collect();
        let patch = Patch { fields, ..dataset.patches[patch].clone() };
        let drawn = Dataset { header: dataset.header.clone(), patches: vec![patch] };
        let title = format!("{}: what moves {}", dataset.header.job, solved.surface.name);
        let picture = comparable_maps(&drawn, &title, &shown, sensitivity::NOTE, &PictureOptions::default());
        pictures.push((solved.surface.name.clone(), picture));
    }
    pictures
}

/// A map of what is left on each surface that is cut, named by the surface.
pub(super) fn left(solved: &[Solved<'_, '_>], dataset: &Dataset) -> Vec<(String, Picture)> {
    let mut pictures = Vec::new();
    for (patch, solved) in solved.iter().enumerate().filter(|(_, solved)| solved.cut.is_some()) {
        let left = solved.fields.iter().position(|field| field.name == "left");
        let shown: Vec<(usize, usize)> = left.map(|field| (patch, field)).into_iter().collect();
        let title = format!("{}: what is left on {}", dataset.header.job, solved.surface.name);
        let picture = field_maps(dataset, &title, &shown, cut::NOTE, &PictureOptions::default());
        pictures.push((solved.surface.name.clone(), picture));
    }
    pictures
}
