//! What does the flight core answer: its operations on a vector file, word by word.
//!
//! The same functions run on the host and on a Cortex-M: the host makes the input, both run it, and
//! every word of the answers must be the same. A word is 64 bits: an f64's, an integer, or eight
//! letters of a refusal.
//!
//! The input is a row of blocks, little-endian: kind u32, bytes u32, then as the kind's module says.
//!
//! | kind | module | what runs |
//! |---|---|---|
//! | 1 | [`attitude`] | attitude, sweep, half-wave plates, phases at many instants |
//! | 2 | [`ephemeris`] | every body's state at many instants |
//! | 3 | [`transits`] | a transit search over several channels |
//! | 4 | [`tables`] | a container, whole and damaged |
//! | 5 | [`tables`] | a section without its CRC, whole and damaged |
//! | 6 | [`sequencer`] | a flight through plans, with disturbances |
//! | 7 | [`slots`] | two slots under uplinks, damage and orders; clock correlations |
//! | 8 | [`tracking`] | measured attitudes, and transits with what they correct |
//! | 9 | [`visits`] | counts of visits, and the confidence in each |
//! | 10 | [`avoidance`] | violations of limits on bright bodies |
//! | 16 | [`meter`] | instructions per operation |
//! | 17 | [`services_meter`] | instructions of a sequencer's tick and a tracker's update |
//!
//! Method: a new family of operations is a module with a `run` of this shape, and a line in [`run`].
//!
//! Limits: words are compared, not judged; whether they are right is for the host's other tests.

#![no_std]
#![forbid(unsafe_code)]

pub mod reader;
pub mod sink;
pub mod tables;
pub mod ephemeris;
pub mod attitude;
pub mod transits;
pub mod sequencer;
pub mod slots;
pub mod tracking;
pub mod visits;
pub mod avoidance;
pub mod meter;
pub mod services_meter;

use reader::Reader;
use sink::Sink;

/// The input is not what its counts say, or a block that must load is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Malformed;

/// Runs every block of `input`. `scratch` holds a damaged table, `clock` counts ticks upwards.
///
/// # Errors
/// [`Malformed`], after the words of the blocks before.
pub fn run(
    input: &[u8],
    scratch: &mut [u8],
    clock: &impl Fn() -> u32,
    sink: &mut impl Sink,
) -> Result<(), Malformed> {
    let mut blocks = Reader::new(input);
    let mut index = 0;
    while !blocks.is_empty() {
        let kind = blocks.u32()?;
        let mut block = Reader::new(blocks.sized()?);
        sink.block(index);
        match kind {
            1 => attitude::run(&mut block, sink)?,
            2 => ephemeris::run(&mut block, sink)?,
            3 => transits::run(&mut block, sink)?,
            4 => tables::run(&mut block, scratch, sink)?,
            5 => tables::run_section(&mut block, scratch, sink)?,
            6 => sequencer::run(&mut block, sink)?,
            7 => slots::run(&mut block, scratch, sink)?,
            8 => tracking::run(&mut block, sink)?,
            9 => visits::run(&mut block, sink)?,
            10 => avoidance::run(&mut block, sink)?,
            16 => meter::run(&mut block, clock, sink)?,
            17 => services_meter::run(&mut block, clock, sink)?,
            _ => return Err(Malformed),
        }
        index += 1;
    }
    Ok(())
}
