//! The sessions of a timeline as rows.

use super::types::Timeline;
use crate::error::WriteError;
use crate::rows::{self, Format, Layout};
use serde::Serialize;
use std::io::Write;

#[derive(Serialize)]
struct Row<'t> {
    id: &'t str,
    target: &'t str,
    telescope: &'t str,
    start_utc: &'t str,
    end_utc: &'t str,
    start_tdb: &'t str,
    end_tdb: &'t str,
    start_tai_ns: i64,
    end_tai_ns: i64,
    passes: usize,
    dwell_s: f64,
    impact_min_deg: f64,
    impact_max_deg: f64,
    hwp_coverage: Option<f64>,
    angular_diameter_arcsec: Option<f64>,
    brightness_temperature_k: Option<f64>,
    beam_dilution: Option<f64>,
    antenna_temperature_mk: Option<f64>,
    polarised_temperature_mk: Option<f64>,
    reason: &'t str,
}

const COLUMNS: [&str; 20] = [
    "id",
    "target",
    "telescope",
    "start_utc",
    "end_utc",
    "start_tdb",
    "end_tdb",
    "start_tai_ns",
    "end_tai_ns",
    "passes",
    "dwell_s",
    "impact_min_deg",
    "impact_max_deg",
    "hwp_coverage",
    "angular_diameter_arcsec",
    "brightness_temperature_k",
    "beam_dilution",
    "antenna_temperature_mk",
    "polarised_temperature_mk",
    "reason",
];

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
        let rows = self.sessions.iter().map(|it| Row {
            id: &it.id,
            target: &it.target,
            telescope: &it.telescope,
            start_utc: &it.start_utc,
            end_utc: &it.end_utc,
            start_tdb: &it.start_tdb,
            end_tdb: &it.end_tdb,
            start_tai_ns: it.start_tai_ns,
            end_tai_ns: it.end_tai_ns,
            passes: it.transits.len(),
            dwell_s: it.dwell_s,
            impact_min_deg: it.impact_min_deg,
            impact_max_deg: it.impact_max_deg,
            hwp_coverage: it.hwp_coverage,
            angular_diameter_arcsec: it.signal.angular_diameter_arcsec,
            brightness_temperature_k: it.signal.brightness_temperature_k,
            beam_dilution: it.signal.beam_dilution,
            antenna_temperature_mk: it.signal.antenna_temperature_mk,
            polarised_temperature_mk: it.signal.polarised_temperature_mk,
            reason: &it.reason,
        });
        let layout = Layout { format, provenance: &self.provenance, header: &COLUMNS };
        rows::write(out, rows.map(Ok::<_, WriteError>), &layout).map(|_| ())
    }
}
