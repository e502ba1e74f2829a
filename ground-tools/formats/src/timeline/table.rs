//! The sessions of a timeline as rows.

use super::types::{Session, Timeline};
use crate::error::WriteError;
use crate::rows::Field::{Count, Number, Tdb, Utc, Whole, Word};
use crate::rows::{self, Column, Format, Layout};
use std::io::Write;

fn columns<'s>() -> [Column<&'s Session>; 20] {
    [
        Column::new("id", Word(|it| Some((&it.id).into()))),
        Column::new("target", Word(|it| Some((&it.target).into()))),
        Column::new("telescope", Word(|it| Some((&it.telescope).into()))),
        Column::new("start_utc", Utc(|it| it.start())),
        Column::new("end_utc", Utc(|it| it.end())),
        Column::new("start_tdb", Tdb(|it| it.start())),
        Column::new("end_tdb", Tdb(|it| it.end())),
        Column::new("start_tai_ns", Whole(|it| Some(it.start_tai_ns))),
        Column::new("end_tai_ns", Whole(|it| Some(it.end_tai_ns))),
        Column::new("passes", Count(|it| u64::try_from(it.transits.len()).ok())),
        Column::new("dwell_s", Number(|it| Some(it.dwell_s))),
        Column::new("impact_min_deg", Number(|it| Some(it.impact_min_deg))),
        Column::new("impact_max_deg", Number(|it| Some(it.impact_max_deg))),
        Column::new("hwp_coverage", Number(|it| it.hwp_coverage)),
        Column::new("angular_diameter_arcsec", Number(|it| it.signal.angular_diameter_arcsec)),
        Column::new("brightness_temperature_k", Number(|it| it.signal.brightness_temperature_k)),
        Column::new("beam_dilution", Number(|it| it.signal.beam_dilution)),
        Column::new("antenna_temperature_mk", Number(|it| it.signal.antenna_temperature_mk)),
        Column::new("polarised_temperature_mk", Number(|it| it.signal.polarised_temperature_mk)),
        Column::new("reason", Word(|it| Some((&it.reason).into()))),
    ]
}

impl Timeline {
    /// `timeline.csv`.
    ///
    /// # Errors
    /// [`WriteError`] where it cannot be written.
    pub fn to_csv(&self) -> Result<Vec<u8>, WriteError> {
        let mut bytes = Vec::new();
        self.write_table(&mut bytes, Format::Csv)?;
        Ok(bytes)
    }

    /// A row per session.
    ///
    /// # Errors
    /// What the writer says.
    pub fn write_table(&self, out: &mut dyn Write, format: Format) -> Result<(), WriteError> {
        let rows = self.sessions.iter().map(Ok::<_, WriteError>);
        let layout = Layout { format, provenance: &self.provenance, columns: &columns() };
        rows::write(out, rows, &layout).map(|_| ())
    }
}
