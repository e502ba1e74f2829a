//! The ground's planner: what a scanning strategy demands of the hardware, which calibration
//! opportunities it offers, and which of them to take.
//!
//! Modules stand in the order that data flows. All angles are radians, rates radians per second or
//! hertz, times nanoseconds of TAI; degrees, minutes and rpm belong to files and reports.

pub mod progress;
pub mod healpix;
pub mod world;
pub mod provenance;
pub mod constraints;
pub mod visits;
pub mod opportunities;
pub mod worth;
mod conic;
pub mod program;
pub mod schedule;
pub mod plan;
pub mod survey;
pub mod mapmaking;
pub mod resonance;
pub mod history_fit;
