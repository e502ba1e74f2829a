//! The missions that come with the program.
//!
//! Each is a mission file whose comments name the publication behind its numbers.
//!
//! # Example
//! The spin period of every preset, in minutes:
//! ```
//! use mission::{Mission, presets};
//!
//! let spins = presets::NAMES.map(|name| {
//!     Mission::load(name, &[]).map(|it| it.scan.spin_period_min.text().to_owned())
//! });
//! let spins = spins.into_iter().collect::<Result<Vec<String>, _>>()?;
//! assert_eq!(spins, ["20.0", "1.0", "1.0", "2.15", "1.0", "2.0"]);
//! # Ok::<(), mission::fault::MissionError>(())
//! ```

/// The presets' names, the default first.
pub const NAMES: [&str; 6] = ["litebird", "pico", "planck", "wmap", "epic", "core"];

/// The text of a preset.
#[must_use]
pub fn find(name: &str) -> Option<&'static str> {
    let text = match name {
        "litebird" => include_str!("../presets/litebird.toml"),
        "pico" => include_str!("../presets/pico.toml"),
        "planck" => include_str!("../presets/planck.toml"),
        "wmap" => include_str!("../presets/wmap.toml"),
        "epic" => include_str!("../presets/epic.toml"),
        "core" => include_str!("../presets/core.toml"),
        _ => return None,
    };
    Some(text)
}
