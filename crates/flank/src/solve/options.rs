//! What is wanted of surfaces beside their points.

use crate::project::session::Session;

/// What is wanted of a surface beside its points.
#[derive(Clone, Copy)]
pub(crate) struct SolveOptions<'m> {
    pub(crate) geometry: bool,
    pub(crate) sensitivity: bool,
    pub(crate) certificates: bool,
    /// What else needs all points together, if something does.
    pub(crate) together: Option<&'static str>,
    /// Whether geometry and sensitivity are wanted of the points that are shown alone, where a surface has too many to keep.
    pub(crate) of_shown: bool,
    /// Whether points are kept in arrays even where they are too many to keep with all that is known of them.
    pub(crate) arrays: bool,
    pub(crate) session: Session<'m>,
}
