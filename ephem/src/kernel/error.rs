//! Why there is no kernel, or no state, in sentences.

use super::bodies::{LONGEST_CHAIN, body_name};
use crate::spk::SpkError;
use crate::time::format_tdb;
use onboard_core::time::Instant;
use thiserror::Error;

/// Why a kernel file cannot be used.
#[derive(Debug, Error)]
pub enum KernelError {
    /// The file cannot be read.
    #[error("cannot read the kernel '{path}': {source}")]
    Read {
        /// The path as given.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is damaged, or not an SPK.
    #[error("the kernel '{name}' {fault}")]
    Spk {
        /// File name.
        name: String,
        /// What is wrong.
        fault: SpkError,
    },
    /// A body is not where it can be.
    #[error(
        "the kernel '{name}' is damaged: it puts {} {found_km:.4e} km from {} at {} TDB; legal is {nearest_km:.4e} to {farthest_km:.4e} km",
        body_name(*body), body_name(*center), format_tdb(*at)
    )]
    Implausible {
        /// File name.
        name: String,
        /// The body.
        body: i32,
        /// From what its distance is taken.
        center: i32,
        /// When.
        at: Instant,
        /// The distance.
        found_km: f64,
        /// Smallest distance accepted.
        nearest_km: f64,
        /// Largest.
        farthest_km: f64,
    },
    /// A body hangs on one that it does not belong to.
    #[error(
        "the kernel '{name}' is damaged: it gives {} (NAIF {body}) from {} (NAIF {found}); legal is one of NAIF {}",
        body_name(*body), body_name(*found), list(legal)
    )]
    Center {
        /// File name.
        name: String,
        /// The body.
        body: i32,
        /// The centre of one of its segments.
        found: i32,
        /// Centres that it can have.
        legal: &'static [i32],
    },
    /// The states of a body cannot be had.
    #[error("the kernel '{name}' cannot be used: {fault}")]
    State {
        /// File name.
        name: String,
        /// Why.
        fault: StateError,
    },
    /// A body that every mission needs is not there.
    #[error(
        "the kernel '{name}' lacks {} (NAIF {body}), which every mission needs; it holds {}",
        body_name(*body), list(holds)
    )]
    MissingBody {
        /// File name.
        name: String,
        /// The body.
        body: i32,
        /// What is there.
        holds: Vec<i32>,
    },
}

/// Why there is no state of a body.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum StateError {
    /// No segment for the body.
    #[error("the ephemeris holds no {} (NAIF {body})", body_name(*body))]
    NoBody {
        /// NAIF number.
        body: i32,
    },
    /// The time lies outside the body's segments.
    #[error(
        "{} (NAIF {body}) is not known at {} TDB: its ephemeris runs from {} to {} TDB",
        body_name(*body), format_tdb(*at), format_tdb(*start), format_tdb(*end)
    )]
    OutOfSpan {
        /// NAIF number.
        body: i32,
        /// The time asked for.
        at: Instant,
        /// First time known.
        start: Instant,
        /// Last time known.
        end: Instant,
    },
    /// The segment's type is not read.
    #[error(
        "{} (NAIF {body}) is stored as SPK type {data_type}: legal are 1, 2, 3, 8, 9, 12, 13, 18, 19 and 21; write it again as one of them, with NAIF's mkspk or spkmerge's source",
        body_name(*body)
    )]
    DataType {
        /// NAIF number.
        body: i32,
        /// SPK data type.
        data_type: i32,
    },
    /// The segment's axes are not the ICRF's.
    #[error(
        "{} (NAIF {body}) is stored in SPICE frame {frame}: legal is 1 (J2000)",
        body_name(*body)
    )]
    Frame {
        /// NAIF number.
        body: i32,
        /// SPICE frame number.
        frame: i32,
    },
    /// Segments lead round in a circle, or too far.
    #[error(
        "{} (NAIF {body}) is not tied to the solar system barycentre within {LONGEST_CHAIN} segments",
        body_name(*body)
    )]
    Chain {
        /// NAIF number.
        body: i32,
    },
    /// The trajectory has no state there.
    #[error(
        "the spacecraft's trajectory is not known at {} TDB: it runs from {} to {} TDB{}",
        format_tdb(*at), format_tdb(*start), format_tdb(*end),
        if *at > *start && *at < *end { " with a gap there" } else { "" }
    )]
    OutOfTrajectory {
        /// The time asked for.
        at: Instant,
        /// First time known.
        start: Instant,
        /// Last time known.
        end: Instant,
    },
}

fn list(bodies: &[i32]) -> String {
    bodies.iter().map(i32::to_string).collect::<Vec<_>>().join(", ")
}
