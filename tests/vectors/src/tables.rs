//! Loading tables, good ones and damaged ones, and why they are refused.
//!
//! Block 4: a container (u32 bytes, then it), then edits to the end. Block 5: a section's kind (u32: 1
//! ephemeris, 2 mission, 3 plan), the section (u32 bytes, then it), then edits to the end.
//!
//! An edit is three u32: bytes to keep, offset, and the bits to flip in the byte there. The table is
//! first loaded as it is, then once with each edit alone.

use crate::Malformed;
use crate::reader::Reader;
use crate::sink::Sink;
use onboard_core::ephemeris::EphemerisTable;
use onboard_core::sun::SunModel;
use onboard_core::uplink::{Container, MissionTable, PlanTable, SectionKind, Tables};

/// What every operation needs of a container.
#[derive(Debug)]
pub struct Loaded<'a> {
    /// Directions of Sun and targets.
    pub ephemeris: EphemerisTable<'a>,
    /// Strategy and telescopes.
    pub mission: MissionTable<'a>,
}

impl<'a> Loaded<'a> {
    /// Loads a container that must be good.
    ///
    /// # Errors
    /// [`Malformed`] when any part is refused.
    pub fn read(bytes: &'a [u8]) -> Result<Self, Malformed> {
        let container = Container::parse(bytes).map_err(|_| Malformed)?;
        let section = |kind| container.section(kind).map_err(|_| Malformed);
        Ok(Self {
            ephemeris: EphemerisTable::parse(section(SectionKind::Ephemeris)?)
                .map_err(|_| Malformed)?,
            mission: MissionTable::parse(section(SectionKind::Mission)?).map_err(|_| Malformed)?,
        })
    }

    /// The mission's Sun.
    ///
    /// # Errors
    /// [`Malformed`] when the table has none.
    pub fn sun(&self) -> Result<SunModel<'a>, Malformed> {
        self.mission.sun(self.ephemeris).map_err(|_| Malformed)
    }
}

/// Loads a container and its sections, whole and with each edit.
///
/// # Errors
/// [`Malformed`] where the scratch memory cannot hold the container.
pub fn run(
    block: &mut Reader<'_>,
    scratch: &mut [u8],
    sink: &mut impl Sink,
) -> Result<(), Malformed> {
    let good = block.sized()?;
    container(good, sink);
    damage(good, block, scratch, |bytes, sink| container(bytes, sink), sink)
}

/// Loads one section, whole and with each edit.
///
/// # Errors
/// [`Malformed`] where the scratch memory cannot hold the section.
pub fn run_section(
    block: &mut Reader<'_>,
    scratch: &mut [u8],
    sink: &mut impl Sink,
) -> Result<(), Malformed> {
    let kind = block.u32()?;
    let good = block.sized()?;
    section(kind, good, sink);
    damage(good, block, scratch, |bytes, sink| section(kind, bytes, sink), sink)
}

fn damage<S: Sink>(
    good: &[u8],
    edits: &mut Reader<'_>,
    scratch: &mut [u8],
    load: impl Fn(&[u8], &mut S),
    sink: &mut S,
) -> Result<(), Malformed> {
    let bad = scratch.get_mut(..good.len()).ok_or(Malformed)?;
    bad.copy_from_slice(good);
    let mut number = 0;
    while !edits.is_empty() {
        let (keep, offset, flip) = (edits.u32()?, edits.u32()?, edits.u32()?.to_le_bytes()[0]);
        let offset = usize::try_from(offset).map_err(|_| Malformed)?;
        let keep = usize::try_from(keep).map_err(|_| Malformed)?;
        *bad.get_mut(offset).ok_or(Malformed)? ^= flip;
        number += 1;
        sink.item(number);
        load(bad.get(..keep).ok_or(Malformed)?, sink);
        *bad.get_mut(offset).ok_or(Malformed)? ^= flip;
    }
    Ok(())
}

fn container(bytes: &[u8], sink: &mut impl Sink) {
    if let Err(error) = Tables::load(bytes) {
        sink.text("tables refused", &error);
    }
    match Container::parse(bytes) {
        Err(error) => sink.text("container refused", &error),
        Ok(container) => {
            sink.text("header", &container.header());
            sink.word("set digest", container.set_digest());
            for kind in [SectionKind::Ephemeris, SectionKind::Mission, SectionKind::Plan] {
                match container.section(kind) {
                    Ok(bytes) => section(kind.number().into(), bytes, sink),
                    Err(error) => sink.text("section refused", &error),
                }
            }
        }
    }
}

fn section(kind: u32, bytes: &[u8], sink: &mut impl Sink) {
    match kind {
        1 => ephemeris(bytes, sink),
        2 => mission(bytes, sink),
        _ => plan(bytes, sink),
    }
}

fn ephemeris(bytes: &[u8], sink: &mut impl Sink) {
    match EphemerisTable::parse(bytes) {
        Ok(table) => {
            for span in table.spans() {
                sink.integer("span's body", span.body.into());
                sink.integer("span's start", span.start.tai_ns());
                sink.word("span's granule", span.granule_ns.get());
                sink.number("span's rate", span.bounds.rate_rad_s);
            }
        }
        Err(error) => sink.text("ephemeris refused", &error),
    }
}

fn mission(bytes: &[u8], sink: &mut impl Sink) {
    match MissionTable::parse(bytes) {
        Ok(table) => {
            let scan = *table.strategy().parameters();
            sink.integer("start", scan.start.tai_ns());
            sink.numbers(["alpha", "beta"], [scan.alpha_rad, scan.beta_rad]);
            for rotor in [scan.precession, scan.spin] {
                sink.number("rate", rotor.rate.radians_per_second());
                sink.word("start phase", rotor.start.bits());
            }
            for telescope in table.telescopes() {
                sink.numbers(
                    ["telescope.x", "telescope.y", "telescope.z", "telescope.w"],
                    telescope.rotation.to_xyzw(),
                );
                match telescope.field_of_view() {
                    Ok(field) => sink.number("reach", field.reach_rad()),
                    Err(error) => sink.text("field of view refused", &error),
                }
            }
            for detector in table.detectors() {
                sink.integer("detector's telescope", detector.telescope.into());
                sink.numbers(
                    ["detector.x", "detector.y", "detector.z", "detector.w"],
                    detector.rotation.to_xyzw(),
                );
            }
            for limit in table.avoidance() {
                sink.integer("avoided body", limit.body.into());
                sink.number("avoidance angle", limit.angle_rad);
            }
        }
        Err(error) => sink.text("mission refused", &error),
    }
}

fn plan(bytes: &[u8], sink: &mut impl Sink) {
    match PlanTable::parse(bytes) {
        Ok(table) => {
            for session in table.sessions() {
                sink.text("session", &session);
            }
        }
        Err(error) => sink.text("plan refused", &error),
    }
}
