//! One attitude of a history, and the checks that it passes where it enters.

use super::error::HistoryError;
use onboard_core::time::Instant;

/// Largest accepted distance of a quaternion's norm from one.
const NORM_SLACK: f64 = 1e-3;

/// One attitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Line of the file, from 1.
    pub line: usize,
    /// When.
    pub at: Instant,
    /// Unit quaternion (x, y, z, w), body to reference.
    pub quaternion: [f64; 4],
}

/// A finite number.
pub(super) fn number(line: usize, key: &'static str, text: &str) -> Result<f64, HistoryError> {
    let read = text.trim().parse::<f64>().ok().filter(|value| value.is_finite());
    read.ok_or_else(|| HistoryError::Value {
        line,
        key,
        value: text.to_owned(),
        legal: "a finite number",
    })
}

/// The quaternion, normalised.
pub(super) fn unit(line: usize, quaternion: [f64; 4]) -> Result<[f64; 4], HistoryError> {
    let norm = quaternion.iter().map(|it| it * it).sum::<f64>().sqrt();
    let near = (norm - 1.0).abs() <= NORM_SLACK;
    if near { Ok(quaternion.map(|it| it / norm)) } else { Err(HistoryError::Norm { line, norm }) }
}

/// The same rotation in the other sense.
pub(super) const fn conjugate([x, y, z, w]: [f64; 4]) -> [f64; 4] {
    [-x, -y, -z, w]
}

/// Refuses a time that does not rise.
pub(super) fn rising(
    before: Option<&Row>,
    at: Instant,
    line: usize,
    time: &str,
) -> Result<(), HistoryError> {
    match before {
        Some(before) if at <= before.at => {
            Err(HistoryError::Order { line, time: time.to_owned(), repeated: at == before.at })
        }
        _ => Ok(()),
    }
}
