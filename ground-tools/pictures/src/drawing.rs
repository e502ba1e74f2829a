//! A finished picture, as SVG and as PNG.

use super::error::PictureError;
use super::render::png_of_svg;

/// A finished picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Drawing {
    pub(super) svg: String,
}

impl Drawing {
    /// As SVG.
    #[must_use]
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// As PNG, a pixel for each unit of the SVG.
    ///
    /// # Errors
    /// [`PictureError::Render`], which no drawing of this module causes.
    pub fn png(&self) -> Result<Vec<u8>, PictureError> {
        png_of_svg(&self.svg)
    }
}
