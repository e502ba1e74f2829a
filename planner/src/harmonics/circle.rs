//! A ring of pixels.

/// A ring of the northern half or the equator, and its mirror image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Circle {
    /// `1 - cos theta`.
    pub(super) sagitta: f64,
    /// Pixels on it.
    pub(super) count: usize,
    /// Whether its first pixel is half a pixel east of longitude 0.
    pub(super) shifted: bool,
    /// First pixel.
    pub(super) first: usize,
    /// First pixel of its mirror image; none for the equator.
    pub(super) mirrored: Option<usize>,
}

impl Circle {
    pub(super) fn cos(&self) -> f64 {
        1.0 - self.sagitta
    }

    pub(super) fn sin(&self) -> f64 {
        (self.sagitta * (2.0 - self.sagitta)).sqrt()
    }
}
