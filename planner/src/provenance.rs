//! What every output says about where it comes from.
//!
//! # Example
//! The first lines of every table that is made from a preset:
//! ```
//! use mission::Mission;
//! use planner::{provenance::Provenance, world::World};
//!
//! let world = World::open(Mission::load("litebird", &[])?, None)?;
//! let comment = Provenance::of(&world).comment();
//! let mission = format!("# mission: LiteBIRD\n# mission_sha256: {}\n", world.mission.digest());
//! assert!(comment.starts_with(&mission));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::world::{FileDigest, World};
use ephem::time::{format_tdb, last_leap_second};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fmt::Write;

/// Mission, kernel, time scales and program behind an output.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Provenance {
    /// The mission's name.
    pub mission: String,
    /// SHA-256 of the resolved mission.
    pub mission_sha256: String,
    /// The planetary kernel's name.
    pub kernel: String,
    /// SHA-256 of the kernel.
    pub kernel_sha256: String,
    /// The spacecraft's trajectory.
    pub trajectory: String,
    /// SHA-256 of the uplink table that directions were taken from, where one was named.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table_sha256: Option<String>,
    /// The files that the mission names and that could be read.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<FileDigest>,
    /// The day that the last leap second known ends.
    pub last_leap_second: String,
    /// Zero of the scan clock, TDB.
    pub start_tdb: String,
    /// Zero of the scan clock, ns of TAI since 2000-01-01T12:00:00 TAI.
    pub start_tai_ns: i64,
    /// First and last instant of a window of the mission, TDB, where only that was looked at.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub window_tdb: Option<[String; 2]>,
    /// Program and version.
    pub program: String,
}

/// Program and version.
pub const PROGRAM: &str = concat!("gyrfalcon ", env!("CARGO_PKG_VERSION"));

impl Provenance {
    /// Of everything made from this world.
    #[must_use]
    pub fn of(world: &World) -> Self {
        Self {
            mission: world.mission.name.clone(),
            mission_sha256: world.mission.digest(),
            kernel: world.sky.kernel.name().to_owned(),
            kernel_sha256: world.sky.kernel.sha256().to_owned(),
            trajectory: world.sky.trajectory.name().to_owned(),
            table_sha256: None,
            files: world.files.clone(),
            last_leap_second: last_leap_second(),
            start_tdb: format_tdb(world.zero()),
            start_tai_ns: world.zero().tai_ns(),
            window_tdb: (world.mission_span() != (world.start, world.end))
                .then(|| [world.start, world.end].map(format_tdb)),
            program: PROGRAM.to_owned(),
        }
    }

    /// As comment lines of a CSV.
    #[must_use]
    pub fn comment(&self) -> String {
        let mut text = String::new();
        for (key, value) in self.lines() {
            let _ = writeln!(text, "# {key}: {value}");
        }
        text
    }

    /// Keys and values, in order.
    pub fn lines(&self) -> impl Iterator<Item = (&'static str, Cow<'_, str>)> {
        let files: Vec<String> =
            self.files.iter().map(|it| format!("{} {}", it.sha256, it.path)).collect();
        let files = (!files.is_empty()).then(|| ("files_sha256", Cow::from(files.join("; "))));
        let lines = [
            ("mission", Some(&self.mission)),
            ("mission_sha256", Some(&self.mission_sha256)),
            ("kernel", Some(&self.kernel)),
            ("kernel_sha256", Some(&self.kernel_sha256)),
            ("trajectory", Some(&self.trajectory)),
            ("table_sha256", self.table_sha256.as_ref()),
            ("last_leap_second", Some(&self.last_leap_second)),
            ("start_tdb", Some(&self.start_tdb)),
            ("program", Some(&self.program)),
        ];
        let lines =
            lines.into_iter().filter_map(|(key, value)| Some((key, value?.as_str().into())));
        let window = self.window_tdb.as_ref().map(|it| ("window_tdb", it.join(" to ").into()));
        lines.chain(window).chain(files).map(|(key, value)| (key, on_one_line(value)))
    }
}

/// A text without characters that end lines or turn their direction: these are escaped.
fn on_one_line(text: Cow<'_, str>) -> Cow<'_, str> {
    let is_bad =
        |c: char| c.is_control() || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    if !text.contains(is_bad) {
        return text;
    }
    let escaped =
        text.chars().map(|c| if is_bad(c) { c.escape_default().collect() } else { c.to_string() });
    Cow::from(escaped.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_with_a_line_end_stays_on_its_line() {
        assert_eq!(on_one_line("a\nb\u{202e}c".into()), "a\\nb\\u{202e}c");
        assert!(matches!(on_one_line("plain".into()), Cow::Borrowed(_)));
    }
}
