//! The ground's planner: what a scanning strategy demands of the hardware, which calibration
//! opportunities it offers, and which of them to take.
//!
//! Modules stand in the order that data flows. All angles are radians, rates radians per second or
//! hertz, times nanoseconds of TAI; degrees, minutes and rpm belong to files and reports.

pub mod progress;
pub mod constraints;
pub mod healpix;
pub mod opportunity;
pub mod strength;
pub mod visits;
mod conic;
pub mod program;
pub mod schedule;
pub mod survey;
pub mod mapmaking;
pub mod resonance;
