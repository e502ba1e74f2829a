//! Attitude for SPICE: a C-kernel of type 3 with its clock (SCLK) and frame (FK) text kernels.
//!
//! The frame is the mission boresight frame against J2000, which SPICE takes for ICRF. SPICE's
//! quaternions are scalar first and of the matrix that takes reference to frame, the conjugate of
//! this project's; angular velocity has components in the reference frame, rad/s.
//!
//! The clock counts microseconds of TAI since 2000-01-01T12:00:00 TAI. It is parallel to TT (32.184 s
//! ahead), so one coefficient serves all missions and samples lie at whole ticks: ticks are exact
//! until 2285, and what is left is the rounding of SPICE's ET (0.1 us at 2032, 7e-10 rad for a spin of
//! 20 min).
//!
//! Method: a double precision array file of little-endian records of 1024 bytes: file record,
//! comments, one summary record, one name record, one segment. Its interpolation intervals are the
//! spans of the other products, inside which SPICE turns uniformly as they do.
//!
//! Limits: instants before 2000 and from 2285 on are refused.

use super::aem::sampling;
use super::samples::{Attitudes, Span, sampled, turned};
use super::spice_error::SpiceError;
use crate::error::WriteError;
use ephem::time::format_utc;
use onboard_core::time::Instant;
use rayon::prelude::*;
use std::io::Write;

/// Bytes of a record.
const RECORD: usize = 1024;
/// Numbers of a record.
const RECORD_NUMBERS: usize = 128;
/// Characters of a record of comments.
const COMMENT_CHARACTERS: usize = 1000;
/// Numbers of one attitude: quaternion and angular velocity.
const PACKET: usize = 7;
/// Epochs between two entries of a directory.
const DIRECTORY: usize = 100;
/// NAIF's frame number of J2000.
const J2000: i32 = 1;
/// The clock's last tick; whole numbers are exact to 2^53.
const LAST_TICK: i64 = 9_000_000_000_000_000;
/// What a file must begin and end its string check with, so that a transfer as text is noticed.
const TRANSFER_CHECK: &[u8; 28] = b"FTPSTR:\r:\n:\r\n:\r\x00:\x81:\x10\xce:ENDFTP";

/// What SPICE's kernels are made from.
#[derive(Debug, Clone, Copy)]
pub struct Kernels<'k> {
    /// The spacecraft's NAIF number, negative.
    pub spacecraft: i32,
    /// What they are made from.
    pub attitudes: Attitudes<'k>,
    /// Where there are samples.
    pub spans: &'k [Span],
}

/// Places of a segment's parts, in numbers from 0.
struct Layout {
    samples: usize,
    directory: usize,
    intervals: usize,
    interval_directory: usize,
}

impl Layout {
    fn numbers(&self) -> usize {
        (PACKET + 1) * self.samples + self.directory + self.intervals + self.interval_directory + 2
    }
}

impl Kernels<'_> {
    /// The frame's number, which is the structure's in the C-kernel too.
    fn frame(&self) -> i32 {
        self.spacecraft.saturating_mul(1000)
    }

    fn object(&self) -> String {
        let legal = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
        let name = self.attitudes.product.object_name.to_uppercase().replace([' ', '-'], "_");
        let name: String = name.chars().filter(|letter| legal(*letter)).take(16).collect();
        if name.is_empty() { "SPACECRAFT".to_owned() } else { name }
    }

    /// Writes the clock's kernel.
    ///
    /// # Errors
    /// What the writer says.
    pub fn write_clock(&self, out: &mut dyn Write) -> Result<(), WriteError> {
        let id = self.spacecraft.unsigned_abs();
        let stamp = format_utc(self.attitudes.stamp);
        let stamp = stamp.get(..19).unwrap_or("").replace('T', "/");
        write!(
            out,
            "KPL/SCLK\n\nSeconds and microseconds of TAI since 2000-01-01T12:00:00 TAI, as \
             number:number.\nParallel to TT, which is 32.184 s ahead.\n\n\\begindata\n\n\
             SCLK_KERNEL_ID = ( @{stamp} )\n\
             SCLK_DATA_TYPE_{id} = ( 1 )\n\
             SCLK01_TIME_SYSTEM_{id} = ( 2 )\n\
             SCLK01_N_FIELDS_{id} = ( 2 )\n\
             SCLK01_MODULI_{id} = ( 10000000000 1000000 )\n\
             SCLK01_OFFSETS_{id} = ( 0 0 )\n\
             SCLK01_OUTPUT_DELIM_{id} = ( 2 )\n\
             SCLK_PARTITION_START_{id} = ( 0 )\n\
             SCLK_PARTITION_END_{id} = ( {LAST_TICK} )\n\
             SCLK01_COEFFICIENTS_{id} = ( 0 32.184 1 )\n\n\\begintext\n"
        )?;
        Ok(())
    }

    /// Writes the frame's kernel.
    ///
    /// # Errors
    /// What the writer says.
    pub fn write_frame(&self, out: &mut dyn Write) -> Result<(), WriteError> {
        let (object, id, frame) = (self.object(), self.spacecraft, self.frame());
        write!(
            out,
            "KPL/FK\n\n{object}_BODY: z the mission's line of sight, x away from the spin axis, \
             y along\nthe nominal scan.\n\n\\begindata\n\n\
             NAIF_BODY_NAME += ( '{object}' )\n\
             NAIF_BODY_CODE += ( {id} )\n\
             FRAME_{object}_BODY = {frame}\n\
             FRAME_{frame}_NAME = '{object}_BODY'\n\
             FRAME_{frame}_CLASS = 3\n\
             FRAME_{frame}_CLASS_ID = {frame}\n\
             FRAME_{frame}_CENTER = {id}\n\
             CK_{frame}_SCLK = {id}\n\
             CK_{frame}_SPK = {id}\n\n\\begintext\n"
        )?;
        Ok(())
    }

    fn layout(&self) -> Layout {
        let samples = self.spans.iter().map(|span| span.count(self.attitudes.step.step)).sum();
        let intervals = self.spans.len();
        let directory = |count: usize| count.saturating_sub(1) / DIRECTORY;
        Layout {
            samples,
            directory: directory(samples),
            intervals,
            interval_directory: directory(intervals),
        }
    }

    /// Writes the C-kernel.
    ///
    /// # Errors
    /// What the writer says; [`SpiceError`] where there is no sample, or the clock does not reach.
    pub fn write_attitude(&self, out: &mut dyn Write) -> Result<(), WriteError> {
        let (Some(first), Some(last)) = (self.spans.first(), self.spans.last()) else {
            return Err(SpiceError::Empty.into());
        };
        let (start, end) = (ticks(first.first)?, ticks(last.last)?);
        let layout = self.layout();
        let comments = self.comments();
        let summary_record = 2 + comments.len() / RECORD;
        // Addresses count numbers from 1; the data follow the summary's and the name's record.
        let begin = (summary_record + 1) * RECORD_NUMBERS + 1;
        let finish = begin + layout.numbers() - 1;
        out.write_all(&file_record(summary_record, finish + 1)?)?;
        out.write_all(&comments)?;
        out.write_all(&self.summary((start, end), (begin, finish))?)?;
        let mut name = [b' '; RECORD];
        overwrite(&mut name, 0, b"MISSION BORESIGHT, PLANNED");
        out.write_all(&name)?;
        self.write_packets(out)?;
        self.write_times(out, &layout)?;
        let filled = layout.numbers() % RECORD_NUMBERS;
        if filled > 0 {
            out.write_all(&vec![0; 8 * (RECORD_NUMBERS - filled)])?;
        }
        Ok(())
    }

    /// Records of comments: lines that end with a zero byte, the last of them followed by 4.
    fn comments(&self) -> Vec<u8> {
        let mut text: Vec<u8> = Vec::new();
        let lines = self.attitudes.provenance.lines().map(|(key, value)| format!("{key}: {value}"));
        for line in lines.chain([sampling(&self.attitudes.step)]) {
            text.extend(line.bytes().filter(|byte| (32..127).contains(byte)));
            text.push(0);
        }
        text.push(4);
        let mut records = Vec::new();
        for part in text.chunks(COMMENT_CHARACTERS) {
            records.extend_from_slice(part);
            records.resize(records.len().next_multiple_of(RECORD), 0);
        }
        records
    }

    fn summary(
        &self,
        (start, end): (f64, f64),
        (begin, finish): (usize, usize),
    ) -> Result<Vec<u8>, SpiceError> {
        let mut record = Vec::with_capacity(RECORD);
        for number in [0.0, 0.0, 1.0, start, end] {
            record.extend(f64::to_le_bytes(number));
        }
        let with_rates = 1;
        for number in [self.frame(), J2000, 3, with_rates, address(begin)?, address(finish)?] {
            record.extend(i32::to_le_bytes(number));
        }
        record.resize(RECORD, 0);
        Ok(record)
    }

    fn write_packets(&self, out: &mut dyn Write) -> Result<(), WriteError> {
        for span in self.spans {
            sampled(&self.attitudes.motion, span.instants(self.attitudes.step.step), |samples| {
                let bytes: Vec<[u8; 8 * PACKET]> = samples
                    .par_iter()
                    .map(|sample| {
                        let [x, y, z, w] = sample.quaternion;
                        let rate = turned(sample.quaternion, sample.body_rate_rad_s);
                        let packet = [w, -x, -y, -z].into_iter().chain(rate);
                        let mut bytes = [0; 8 * PACKET];
                        for (place, number) in packet.enumerate() {
                            bytes[8 * place..][..8].copy_from_slice(&number.to_le_bytes());
                        }
                        bytes
                    })
                    .collect();
                out.write_all(bytes.as_flattened()).map_err(WriteError::from)
            })?;
        }
        Ok(())
    }

    /// Epochs, their directory, interval starts, their directory, and both counts.
    fn write_times(&self, out: &mut dyn Write, layout: &Layout) -> Result<(), WriteError> {
        let mut put = |number: f64| out.write_all(&number.to_le_bytes());
        let mut directory = Vec::with_capacity(layout.directory);
        let mut count = 0;
        for span in self.spans {
            for at in span.instants(self.attitudes.step.step) {
                let ticks = ticks(at)?;
                put(ticks)?;
                count += 1;
                if count % DIRECTORY == 0 && directory.len() < layout.directory {
                    directory.push(ticks);
                }
            }
        }
        directory.into_iter().try_for_each(&mut put)?;
        for span in self.spans {
            put(ticks(span.first)?)?;
        }
        let starts = self.spans.iter().skip(DIRECTORY - 1).step_by(DIRECTORY);
        for span in starts.take(layout.interval_directory) {
            put(ticks(span.first)?)?;
        }
        put(number(layout.intervals))?;
        put(number(layout.samples))?;
        Ok(())
    }
}

/// Whole microseconds on the clock.
fn ticks(at: Instant) -> Result<f64, SpiceError> {
    let us = at.tai_ns().div_euclid(1000);
    if !(0..LAST_TICK).contains(&us) {
        return Err(SpiceError::OutsideClock(at));
    }
    #[expect(clippy::cast_precision_loss, reason = "below 2^53")]
    Ok(us as f64)
}

fn number(count: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "an address fits an i32")]
    let number = count as f64;
    number
}

fn address(place: usize) -> Result<i32, SpiceError> {
    i32::try_from(place).map_err(|_| SpiceError::TooLarge(place))
}

fn overwrite(record: &mut [u8; RECORD], at: usize, bytes: &[u8]) {
    record[at..at + bytes.len()].copy_from_slice(bytes);
}

/// The first record: what kind of file, where the summaries are, what is free.
fn file_record(summary_record: usize, free: usize) -> Result<[u8; RECORD], SpiceError> {
    let mut record = [0; RECORD];
    overwrite(&mut record, 0, b"DAF/CK  ");
    overwrite(&mut record, 8, &2_i32.to_le_bytes());
    overwrite(&mut record, 12, &6_i32.to_le_bytes());
    overwrite(&mut record, 16, &[b' '; 60]);
    overwrite(&mut record, 16, b"GYRFALCON ATTITUDE");
    let summary = address(summary_record)?.to_le_bytes();
    overwrite(&mut record, 76, &summary);
    overwrite(&mut record, 80, &summary);
    overwrite(&mut record, 84, &address(free)?.to_le_bytes());
    overwrite(&mut record, 88, b"LTL-IEEE");
    overwrite(&mut record, 699, TRANSFER_CHECK);
    Ok(record)
}
