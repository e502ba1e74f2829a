//! Who looks: lines of sight with the receivers behind them.
//!
//! A telescope without listed detectors looks along its own axis with each of its channels, or with its
//! own values where it has none; one with detectors through each of them.
//!
//! Limits: a line whose noise is not known is left out and told ([`Left`](super::Left)).

use crate::opportunities::{NONE, SightError, SightLine, select};
use mission::Mission;
use mission::number::Number;
use mission::receiver::Receiver;
use onboard_core::field_of_view::FieldOfView;
use std::collections::HashMap;

/// A detector, or a channel on its telescope's axis.
#[derive(Debug, Clone)]
pub struct Look {
    /// Its line of sight.
    pub line: SightLine,
    /// Its channel, where it has one.
    pub channel: Option<String>,
    /// What it measures with.
    pub receiver: Receiver,
}

/// How far from the line of sight passes count, in full widths of the beam: the Gaussian is at -48 dB.
pub const REACH: f64 = 2.0;

impl Look {
    /// `TELESCOPE/DETECTOR`, or `TELESCOPE/CHANNEL` on the axis.
    #[must_use]
    pub fn key(&self) -> String {
        format!("{}/{}", self.line.telescope_name, self.name())
    }

    /// The detector's name, or the channel's on the axis, or [`NONE`].
    #[must_use]
    pub fn name(&self) -> &str {
        match &self.channel {
            Some(channel) if self.line.detector_name == NONE => channel,
            _ => &self.line.detector_name,
        }
    }

    fn new(
        line: SightLine,
        channel: Option<String>,
        receiver: &Receiver,
    ) -> Result<Self, SightError> {
        let width = receiver.fwhm_rad().unwrap_or_default();
        let field = FieldOfView::circle(line.rotation, REACH * width).map_err(SightError::Field)?;
        Ok(Self { line: SightLine { field, ..line }, channel, receiver: receiver.clone() })
    }

    /// Frequency and width of its band in GHz.
    pub(super) fn band_ghz(&self) -> Option<(f64, Option<f64>)> {
        let number = |it: &Option<Number>| it.as_ref().map(Number::to_f64);
        number(&self.receiver.frequency_ghz).map(|at| (at, number(&self.receiver.bandwidth_ghz)))
    }
}

/// The looks of a mission: of a telescope, of a detector or a channel by name, or of all.
///
/// # Errors
/// [`SightError`] names what the mission does not have, or what is ambiguous.
pub fn looks(
    mission: &Mission,
    telescope: Option<&str>,
    detector: Option<&str>,
) -> Result<Vec<Look>, SightError> {
    let named = detector.filter(|name| *name != "all");
    // A channel by name: all that belongs to it.
    let of_channel = named.filter(|name| {
        let short = name.rsplit('/').next().unwrap_or_default();
        mission.telescopes.iter().any(|it| it.channels.iter().any(|of| of.name == short))
            || mission
                .telescopes
                .iter()
                .any(|it| it.detectors.iter().any(|of| of.channel.as_deref() == Some(short)))
    });
    let lines = match (of_channel, named) {
        (None, Some(name)) => select(mission, telescope, Some(name))?,
        _ => every(mission, telescope)?,
    };
    let mut receivers = HashMap::new();
    for (index, it) in mission.telescopes.iter().enumerate() {
        for of in &it.detectors {
            receivers.insert((index, of.name.as_str()), of);
        }
    }
    let mut looks = Vec::new();
    for line in lines {
        let Some(index) = line.telescope else { continue };
        let it = &mission.telescopes[index];
        if let Some(of) = receivers.get(&(index, line.detector_name.as_str())) {
            looks.push(Look::new(line.clone(), of.channel.clone(), &of.receiver)?);
        } else if it.channels.is_empty() {
            looks.push(Look::new(line, None, &it.receiver)?);
        } else {
            for of in &it.channels {
                looks.push(Look::new(line.clone(), Some(of.name.clone()), &of.receiver)?);
            }
        }
    }
    if let Some(name) = of_channel {
        let (first, short) = name.split_once('/').unwrap_or(("", name));
        looks.retain(|it| {
            it.channel.as_deref() == Some(short)
                && (first.is_empty() || it.line.telescope_name == first)
        });
    }
    Ok(looks)
}

/// The lines of all telescopes, or of one by name.
fn every(mission: &Mission, telescope: Option<&str>) -> Result<Vec<SightLine>, SightError> {
    let mut lines = Vec::new();
    match telescope {
        Some(name) => lines.extend(select(mission, Some(name), None)?),
        None => {
            for it in &mission.telescopes {
                lines.extend(select(mission, Some(&it.name), None)?);
            }
        }
    }
    Ok(lines)
}
