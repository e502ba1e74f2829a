//! A sentence for each error, for those who print them.
//!
//! The sentences are fixed texts, so that printing one needs no formatting of numbers: an error's
//! values stand in its fields. Where one error wraps another, [`Error::source`] leads to it.

use crate::avoidance::AvoidanceError;
use crate::clock::ClockError;
use crate::ephemeris::EphemerisError;
use crate::field_of_view::FieldOfViewError;
use crate::record::RecordError;
use crate::rotation::RotationError;
use crate::scan::ScanError;
use crate::sequencer::SettingsError;
use crate::telemetry::PacketError;
#[cfg(not(target_os = "none"))]
use crate::telemetry::TelemetryError;
use crate::tracking::{MeasurementRefusal, ResumeError, TrackerSettingsError};
use crate::uplink::{
    FlashError, MissionChangeError, MissionError, NoTables, PlanError, RollbackError,
    RollbackRefusal, SequenceError, SlotState, TableError, UplinkError, UploadRefusal,
};
use crate::visits::{BinsError, VisitError};
use core::error::Error;
use core::fmt::{Display, Formatter, Result};

/// `Display` and `Error` of a type: its sentences, then the errors that it wraps.
macro_rules! sentences {
    ($kind:ty { $($pattern:pat => $sentence:literal,)+ } $({ $($wrap:pat => $inner:ident,)+ })?) => {
        impl Display for $kind {
            fn fmt(&self, formatter: &mut Formatter<'_>) -> Result {
                formatter.write_str(match self { $($pattern => $sentence,)+ })
            }
        }

        impl Error for $kind {
            $(fn source(&self) -> Option<&(dyn Error + 'static)> {
                match self {
                    $($wrap => Some($inner),)+
                    _ => None,
                }
            })?
        }
    };
}

sentences! { EphemerisError {
    Self::WrongLength => "the ephemeris has more or fewer bytes than its counts say",
    Self::BadBody(_) => "a body of the ephemeris has an illegal span range or bound",
    Self::BadSpan(_) => "a span of the ephemeris has an illegal count, length, bound or order",
    Self::BadCoefficient(_) => "a coefficient of the ephemeris is not finite",
    Self::NoSuchBody(_) => "the ephemeris does not have the body",
    Self::OutOfSpan(_) => "the instant lies outside the body's spans",
} }

sentences! { ScanError {
    Self::Alpha(_) => "alpha is not in 0 to pi",
    Self::Beta(_) => "beta is not in 0 to pi",
    Self::AlphaPlusBeta(_) => "alpha and beta together exceed pi",
    Self::PrecessionRate => "the precession rate is zero or too fast",
    Self::SpinRate => "the spin rate is zero or too fast",
} }

sentences! { RotationError {
    Self::NotFinite => "a component of the quaternion is not finite",
    Self::NotUnit(_) => "the quaternion's norm is too far from one",
} }

sentences! { FieldOfViewError {
    Self::Radius(_) => "the field's radius is not above 0 and at most pi",
    Self::Side(_) => "a side of the field is not between 0 and pi",
} }

sentences! { AvoidanceError {
    Self::Angle(_) => "the angle to avoid is not above 0 and at most pi",
} }

sentences! { RecordError {
    Self::Length(_) => "the record has another length than its kind takes",
    Self::Kind => "the record is of another kind",
    Self::Damaged => "the record is damaged",
    Self::Version(_) => "the record is of another version",
    Self::OtherSpacecraft { .. } => "the record is another spacecraft's",
    Self::OtherOrigin => "the record belongs to another search or log",
} }

sentences! { SequenceError {
    Self::Older { .. } => "the sequence number is not above the newest one",
    Self::StepTooLarge { .. } => "the sequence number is too far above the newest one",
} }

sentences! { ClockError {
    Self::NotACorrelation => "the bytes are no clock correlation",
    Self::Damaged => "the clock correlation is damaged",
    Self::Illegal => "the clock correlation has no tick, or its validity runs backwards",
    Self::Sequence(_) => "the clock correlation's sequence number does not follow",
    Self::OtherSpacecraft { .. } => "the clock correlation is another spacecraft's",
    Self::NotYetValid(_) => "the clock correlation is not yet valid",
    Self::Expired(_) => "the clock correlation has expired",
    Self::BeyondScale => "the counter's time lies beyond the time scale",
} { Self::Sequence(inner) => inner, } }

sentences! { BinsError {
    Self::Low(_) => "the lower end of the bins is out of range",
    Self::High(_) => "the upper end of the bins is not finite or not above the lower one",
} }

sentences! { VisitError {
    Self::NoSuchTarget(_) => "no target has this index",
    Self::Reversed { .. } => "the exit lies before the entry",
    Self::OutOfOrder { .. } => "the entry lies before one that was taken already",
    Self::Overlap { .. } => "the entry lies before the same target's last exit",
} }

sentences! { TrackerSettingsError {
    Self::AngleSigma(..) => "an angle's prior standard deviation is out of range",
    Self::PrecessionRateSigma(_) => "the precession rate's prior standard deviation is out of range",
    Self::SpinRateSigma(_) => "the spin rate's prior standard deviation is out of range",
    Self::AngleWalk(..) => "an angle's random walk is out of range",
    Self::PrecessionRateWalk(_) => "the precession rate's random walk is out of range",
    Self::SpinRateWalk(_) => "the spin rate's random walk is out of range",
    Self::MaxAge(_) => "the greatest age of a measurement is not positive",
    Self::MaxLead(_) => "the greatest lead of a measurement is negative",
    Self::Gate(_) => "the gate on chi^2 is out of range",
    Self::Limit(..) => "the limit of an angle's correction is out of range",
} }

sentences! { MeasurementRefusal {
    Self::Sigma(_) => "the measurement's noise is out of range",
    Self::Stale(_) => "the measurement is too old",
    Self::Future(_) => "the measurement lies too far ahead",
    Self::NotAfter(_) => "the measurement is not after the last one",
    Self::Ephemeris(_) => "the Sun's direction is not known then",
    Self::Unobservable(_) => "alpha is too near 0 or pi to tell precession from spin",
    Self::Ambiguous(..) => "a phase is known so badly that turns may be lost",
    Self::Outlier(_) => "the measurement is an outlier",
    Self::Correction(..) => "the correction of an angle is beyond its limit",
    Self::Strategy(_) => "the corrected strategy would be illegal",
} { Self::Ephemeris(inner) => inner, Self::Strategy(inner) => inner, } }

sentences! { ResumeError {
    Self::OtherStrategy => "the state belongs to another nominal strategy",
    Self::Scan(_) => "the state's strategy is illegal",
    Self::Covariance => "the state's covariance is none",
} { Self::Scan(inner) => inner, } }

sentences! { SettingsError {
    Self::Tolerance(_) => "the sequencer's tolerance is negative",
    Self::LongestGap(_) => "the sequencer's longest gap is not above zero",
    Self::Recheck(_) => "the angle of a new check is not above zero and finite",
    Self::CheckAhead(_) => "sessions are checked less than the longest gap ahead",
    Self::StepsPerTick(_) => "the sequencer's steps per tick are zero or too many",
} }

sentences! { UplinkError {
    Self::Truncated(_) => "the container is cut short",
    Self::NotAContainer => "the bytes are no container",
    Self::Version(_) => "the container has another format version",
    Self::HeaderCrc => "the container's header is damaged",
    Self::DirectoryCrc => "the container's directory is damaged",
    Self::BadDirectory => "the container's directory contradicts itself",
    Self::TooLong => "bytes follow the container's end",
    Self::SectionCrc(_) => "a section of the container is damaged",
    Self::MixedSet(_) => "a section of the container is another set's",
    Self::NoSuchSection(_) => "the container does not have the section",
} }

sentences! { MissionError {
    Self::WrongLength => "the mission has more or fewer bytes than its counts say",
    Self::SunModel(_) => "the mission's Sun model is unknown",
    Self::Telescope(_) => "a telescope of the mission is illegal",
    Self::Detector(_) => "a detector of the mission is illegal",
    Self::Avoidance(_) => "an avoidance limit of the mission is illegal",
    Self::Scan(_) => "the mission's scanning strategy is illegal",
    Self::Rotation(_) => "a rotation of the mission is illegal",
    Self::FieldOfView(_) => "a field of view of the mission is illegal",
} {
    Self::Scan(inner) => inner,
    Self::Rotation(inner) => inner,
    Self::FieldOfView(inner) => inner,
} }

sentences! { PlanError {
    Self::WrongLength => "the plan has more or fewer bytes than its count says",
    Self::BadSession(_) => "a session of the plan runs backwards or is out of order",
} }

sentences! { TableError {
    Self::Container(_) => "the container is refused",
    Self::Ephemeris(_) => "the ephemeris is refused",
    Self::Mission(_) => "the mission is refused",
    Self::Plan(_) => "the plan is refused",
    Self::Coverage(_) => "a body does not cover the container's validity",
    Self::SessionOutside(_) => "a session lies outside the container's validity",
    Self::SessionTelescope(_) => "a session names a telescope that the mission does not have",
} {
    Self::Container(inner) => inner,
    Self::Ephemeris(inner) => inner,
    Self::Mission(inner) => inner,
    Self::Plan(inner) => inner,
} }

sentences! { RollbackError {
    Self::NotAnOrder => "the bytes are no rollback order",
    Self::Damaged => "the rollback order is damaged",
    Self::NotBack => "the rollback order does not lead back",
} }

sentences! { MissionChangeError {
    Self::NotAnOrder => "the bytes are no order to change the mission",
    Self::Damaged => "the order to change the mission is damaged",
    Self::NoChange => "the order to change the mission names one spacecraft twice",
} }

sentences! { UploadRefusal {
    Self::Unsound(_) => "the container's contents are refused",
    Self::Expired(_) => "the container's validity has ended",
    Self::NotYetValid(_) => "the container's validity has not begun",
    Self::Sequence(_) => "the container's sequence number does not follow",
    Self::OtherSpacecraft { .. } => "the container is another spacecraft's",
    Self::OrderExpired(_) => "the order to change the mission has expired",
    Self::OtherOrder => "the order to change the mission names another container or spacecraft",
    Self::TooLong(..) => "the container does not fit into the slot",
} { Self::Unsound(inner) => inner, Self::Sequence(inner) => inner, } }

sentences! { RollbackRefusal {
    Self::OrderExpired(_) => "the rollback order has expired",
    Self::NotActive(_) => "the rollback order leaves another container than the active one",
    Self::NothingToReturnTo => "the other slot does not hold the container to return to",
    Self::Expired(_) => "the validity of the container to return to has ended",
    Self::NotYetValid(_) => "the validity of the container to return to has not begun",
    Self::FloorsUsed => "the container was returned to as often as its slot allows",
} }

sentences! { FlashError {
    Self::NotErased(..) => "a word of the slot does not read as erased",
    Self::NotProgrammed(..) => "a word of the slot does not read as programmed",
    Self::Unsound(_) => "the container in the slot is not whole",
    Self::Changed => "the container in the slot is another one than was admitted",
} { Self::Unsound(inner) => inner, } }

sentences! { SlotState {
    Self::TooShort(_) => "the slot is shorter than its head",
    Self::Erased => "the slot is erased",
    Self::BeingWritten => "the slot holds part of a container",
    Self::Complete(_) => "the slot's container is not committed",
    Self::CommitTorn => "the slot's COMMIT word is not whole or not this container's",
    Self::Committed(_) => "the slot's container is committed",
    Self::Revoked(_) => "the slot's container was rolled back",
    Self::Unsound(_) => "the slot's contents are refused",
} { Self::Unsound(inner) => inner, } }

sentences! { NoTables {
    Self { .. } => "neither slot holds tables",
} }

sentences! { PacketError {
    Self::Version(_) => "the packet's version number is not 0",
    Self::Telecommand => "the packet is a telecommand",
    Self::Segment(_) => "the packet is a part of a longer unit",
} }

#[cfg(not(target_os = "none"))]
sentences! { TelemetryError {
    Self::Length(_) => "the payload has another length than its kind takes",
    Self::Version(_) => "the payload's first byte is another version's",
    Self::Kind(_) => "the payload's kind is unknown",
    Self::Damaged => "the payload is damaged",
    Self::State(_) => "the payload's state is unknown",
    Self::Reason(_) => "the payload's reason is unknown, or no reason of its kind",
    Self::Check(_) => "the payload's stage of a check is unknown",
    Self::Illegal => "a word of the payload has a value that it cannot have",
} }

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    #[test]
    fn a_chain_of_errors_tells_itself() {
        let refusal =
            UploadRefusal::Unsound(TableError::Mission(MissionError::Scan(ScanError::Alpha(4.0))));
        let mut told = std::vec![refusal.to_string()];
        let mut next = refusal.source();
        while let Some(error) = next {
            told.push(error.to_string());
            next = error.source();
        }
        assert_eq!(
            told,
            [
                "the container's contents are refused",
                "the mission is refused",
                "the mission's scanning strategy is illegal",
                "alpha is not in 0 to pi",
            ]
        );
        assert!(UploadRefusal::OtherOrder.source().is_none());
    }
}
