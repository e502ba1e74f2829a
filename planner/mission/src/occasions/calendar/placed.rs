//! Times in their zones, and as instants.

use super::error::EventError;
use super::moment::{Moment, civil};
use super::zone::{Zone, Zones};
use chrono::{NaiveDateTime, NaiveTime};
use icalendar::parser::Property;

/// A time in its zone.
#[derive(Debug, Clone)]
pub(super) struct Placed {
    /// As its zone's clocks show it.
    pub(super) local: NaiveDateTime,
    pub(super) zone: Zone,
    /// A whole day.
    pub(super) is_day: bool,
}

impl Placed {
    /// UTC.
    pub(super) fn utc(&self) -> NaiveDateTime {
        self.zone.utc(self.local)
    }
}

/// The zone of a property's times that say none themselves.
pub(super) fn zone_of(
    key: &'static str,
    property: &Property<'_>,
    (zones, own): (&Zones, Option<&Zone>),
) -> Result<Option<Zone>, EventError> {
    let is_zone = |name: &str| name.eq_ignore_ascii_case("TZID");
    let name = property.params.iter().find(|it| is_zone(it.key.as_str()));
    match name.and_then(|it| it.val.as_ref()) {
        None => Ok(own.cloned()),
        Some(name) => {
            let zone = name.as_str().trim_matches('"').to_owned();
            zones.find(&zone).map(Some).ok_or(EventError::Zone { key, zone })
        }
    }
}

/// A time in its zone; a day begins at midnight UTC.
pub(super) fn placed(
    key: &'static str,
    text: &str,
    zone: Option<&Zone>,
) -> Result<Placed, EventError> {
    let text = text.trim();
    let not_utc = || EventError::NotUtc { key, text: text.to_owned() };
    let moment = civil(text).map_err(|error| match error {
        Some(error) => EventError::Time { key, error },
        None => not_utc(),
    })?;
    let (local, zone, is_day) = match moment {
        Moment::Day(day) => (day.and_time(NaiveTime::MIN), Zone::Utc, true),
        Moment::Utc(utc) => (utc, Zone::Utc, false),
        Moment::Local(local) => (local, zone.ok_or_else(not_utc)?.clone(), false),
    };
    Ok(Placed { local, zone, is_day })
}
