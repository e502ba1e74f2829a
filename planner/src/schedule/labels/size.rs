//! How many numbers a label holds at most.

/// Most starts in a window, lanes and last starts together.
pub(super) const MOST_PLACES: usize = 24;
/// Most days that a session touches.
pub(super) const MOST_DAYS: usize = 4;
/// Most lines of thermal windows at a time.
pub(super) const MOST_LINES: usize = 16;
/// Most amounts: days, memory, lines of thermal windows.
pub(super) const MOST_AMOUNTS: usize = MOST_DAYS + 1 + MOST_LINES;
