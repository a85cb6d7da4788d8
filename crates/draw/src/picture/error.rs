//! What can go wrong when a picture becomes a file.

use flank_export::WriteError;

/// Why a picture could not become a PNG.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PictureError {
    /// There is no memory for that many pixels.
    #[error("a picture of {width} x {height} pixels is too large")]
    TooLarge {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// The encoder refused.
    #[error("the picture could not be encoded as PNG: {0}")]
    Encoding(String),
}

impl From<PictureError> for WriteError {
    fn from(error: PictureError) -> WriteError {
        std::io::Error::other(error).into()
    }
}
