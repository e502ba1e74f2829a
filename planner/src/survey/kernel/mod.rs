//! The fast arithmetic of a survey: blocks of samples side by side, on any instruction set.
//!
//! `blocks` is the kernel proper, which hands a detector's block to `smooth` (interpolated) or to
//! `each` (every sample evaluated); `stream` shows every sample to whoever makes maps of a sky.

mod lanes;
mod arc;
mod axes;
mod sight;
mod pixel;
mod level;
mod powers;
mod pending;
mod blocks;
mod smooth;
mod each;
mod stream;

pub(super) use blocks::{Kernel, Scratch};
pub(crate) use stream::{BLOCK, Block, Job, Phasors, Stream};
