//! One transit, as opportunities are made of it.

use onboard_core::time::Instant;

/// One transit of a target over a detector, or over the field of view of a telescope.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pass {
    /// Index of the target.
    pub target: usize,
    /// Index of the telescope.
    pub telescope: usize,
    /// Index of the detector on its telescope; 0 for a field of view.
    pub detector: usize,
    /// First instant inside.
    pub entry: Instant,
    /// Last instant inside.
    pub exit: Instant,
    /// Closest approach.
    pub closest: Instant,
    /// The target was inside already at the mission's start.
    pub entry_clipped: bool,
    /// The target was still inside at the mission's end.
    pub exit_clipped: bool,
}
