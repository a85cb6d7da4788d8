//! The settled layout of specs.

use flank_chain_dsl::{Sources, format, read_file};
use flank_export::{FileError, write_atomically};

use crate::project::Project;
use crate::project::failure::Failure;
use crate::project::findings::Findings;

/// A text as it is laid out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    /// The text.
    pub text: String,
    /// Whether it is another one than was read.
    pub is_changed: bool,
}

/// Lays out the spec of a project; comments stay where they are. Nothing is written.
///
/// # Errors
/// If it cannot be read, or is not in the language.
pub fn lay_out(project: &Project) -> Result<Layout, Failure> {
    let mut sources = Sources::default();
    let file = read_file(project.files(), &mut sources, project.file())
        .map_err(|finding| Failure::Findings(Findings::new(&[finding], &sources)))?;
    let before = &sources.file(file).text;
    let text = format(before, file).map_err(|findings| Failure::Findings(Findings::new(&findings, &sources)))?;
    Ok(Layout { is_changed: text != *before, text })
}

impl Layout {
    /// Writes it in place of the project's file, whole or not at all.
    ///
    /// # Errors
    /// What stands in the way.
    pub fn write(&self, project: &Project) -> Result<(), FileError> {
        write_atomically(project.file(), |out| Ok(out.write_all(self.text.as_bytes())?))
    }
}
