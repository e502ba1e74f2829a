//! Why there is no picture.

use thiserror::Error;

/// Why there is no picture.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PictureError {
    /// No size that can be drawn.
    #[error("a picture {0} pixels wide: 200 to 8000 are legal")]
    Width(u32),
    /// No size that can be drawn.
    #[error("a picture {0} pixels high: 150 to 8000 are legal")]
    Height(u32),
    /// No range of values.
    #[error("a range from {0} to {1}: two finite numbers are needed, the first below the second")]
    Range(f64, f64),
    /// No range of values on a logarithmic scale.
    #[error("a logarithmic scale from {0} to {1}: a start above 0 is needed")]
    Logarithm(f64, f64),
    /// No percentiles.
    #[error("percentiles {0} and {1}: 0 to 100 are legal, the first below the second")]
    Percentiles(f64, f64),
    /// No patch of the sky.
    #[error("a patch of {0} deg: more than 0 and up to 150 are legal")]
    Side(f64),
    /// No place on the sky.
    #[error(
        "a centre at longitude {0} and latitude {1} deg: a finite longitude and a latitude from -90 to 90 are needed"
    )]
    Centre(f64, f64),
    /// A histogram whose edges and counts do not match.
    #[error(
        "histogram {name}: {edges} edges for {counts} bins; edges must rise and be one more than bins"
    )]
    Bins {
        /// The series.
        name: String,
        /// Number of edges.
        edges: usize,
        /// Number of bins.
        counts: usize,
    },
    /// What was drawn cannot be made an image.
    #[error("the drawing cannot be made an image: {0}")]
    Render(String),
}
