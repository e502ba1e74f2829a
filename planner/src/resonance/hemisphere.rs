//! Half.
