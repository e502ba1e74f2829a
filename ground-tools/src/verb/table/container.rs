//! A file with a container, as the flight core reads it.

use crate::failure::Failure;
use formats::uplink::{contents_told, digest};
use mission::Mission;
use onboard_core::ephemeris::EphemerisTable;
use onboard_core::uplink::Tables;
use std::path::Path;

/// The bytes of a file.
pub(in crate::verb) fn read(file: &Path) -> Result<Vec<u8>, Failure> {
    std::fs::read(file).map_err(|error| Failure::file("read", file, &error))
}

/// A container's tables, as the flight core reads them.
pub(super) fn load<'b>(file: &Path, bytes: &'b [u8]) -> Result<Tables<'b>, Failure> {
    Tables::load(bytes)
        .map_err(|error| Failure::Input(format!("{}: {}", file.display(), contents_told(error))))
}

/// The ephemeris of an uplink table that was built for this mission.
pub(in crate::verb) fn ephemeris<'b>(
    file: &Path,
    bytes: &'b [u8],
    mission: &Mission,
) -> Result<EphemerisTable<'b>, Failure> {
    let tables = load(file, bytes)?;
    if digest(mission) != tables.header().mission_digest {
        return Err(Failure::Input(format!(
            "{}: it was built for another mission (its digest differs): one of table build with \
             the same --mission, --set, --start and --duration is needed",
            file.display()
        )));
    }
    Ok(tables.ephemeris())
}
