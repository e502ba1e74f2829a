//! Which code each refusal of the core is.
//!
//! Method: one `From` per enum of the core. Those that may gain reasons end in GYR_UNNAMED, and a test
//! reads the core's source and asks for every name; the others are matched without a wildcard.

use crate::error::gyr_error_t;
use onboard_core::clock::ClockError;
use onboard_core::ephemeris::EphemerisError;
use onboard_core::field_of_view::FieldOfViewError;
use onboard_core::record::RecordError;
use onboard_core::rotation::RotationError;
use onboard_core::scan::ScanError;
use onboard_core::sequencer::SettingsError;
use onboard_core::tracking::{MeasurementRefusal, ResumeError, TrackerSettingsError};
use onboard_core::uplink::{
    FlashError, MissionChangeError, MissionError, NoTables, PlanError, RollbackError,
    RollbackRefusal, SequenceError, SlotState, TableError, UplinkError, UploadRefusal,
};
use onboard_core::visits::{BinsError, VisitError};

impl From<UplinkError> for gyr_error_t {
    fn from(error: UplinkError) -> Self {
        match error {
            UplinkError::Truncated(_) => Self::GYR_CONTAINER_TRUNCATED,
            UplinkError::NotAContainer => Self::GYR_CONTAINER_NOT_ONE,
            UplinkError::Version(_) => Self::GYR_CONTAINER_VERSION,
            UplinkError::HeaderCrc => Self::GYR_CONTAINER_HEADER_CRC,
            UplinkError::DirectoryCrc => Self::GYR_CONTAINER_DIRECTORY_CRC,
            UplinkError::BadDirectory => Self::GYR_CONTAINER_DIRECTORY,
            UplinkError::TooLong => Self::GYR_CONTAINER_TOO_LONG,
            UplinkError::SectionCrc(_) => Self::GYR_CONTAINER_SECTION_CRC,
            UplinkError::MixedSet(_) => Self::GYR_CONTAINER_MIXED_SET,
            UplinkError::NoSuchSection(_) => Self::GYR_CONTAINER_NO_SECTION,
            _ => Self::GYR_UNNAMED,
        }
    }
}

impl From<EphemerisError> for gyr_error_t {
    fn from(error: EphemerisError) -> Self {
        match error {
            EphemerisError::WrongLength => Self::GYR_EPHEMERIS_LENGTH,
            EphemerisError::BadSpan(_) => Self::GYR_EPHEMERIS_SPAN,
            EphemerisError::BadBody(_) => Self::GYR_EPHEMERIS_BODY,
            EphemerisError::BadCoefficient(_) => Self::GYR_EPHEMERIS_COEFFICIENT,
            EphemerisError::NoSuchBody(_) => Self::GYR_EPHEMERIS_NO_BODY,
            EphemerisError::OutOfSpan(_) => Self::GYR_EPHEMERIS_OUT_OF_SPAN,
            _ => Self::GYR_UNNAMED,
        }
    }
}

impl From<ScanError> for gyr_error_t {
    fn from(error: ScanError) -> Self {
        match error {
            ScanError::Alpha(_) => Self::GYR_SCAN_ALPHA,
            ScanError::Beta(_) => Self::GYR_SCAN_BETA,
            ScanError::AlphaPlusBeta(_) => Self::GYR_SCAN_ALPHA_PLUS_BETA,
            ScanError::PrecessionRate => Self::GYR_SCAN_PRECESSION_RATE,
            ScanError::SpinRate => Self::GYR_SCAN_SPIN_RATE,
        }
    }
}

impl From<RotationError> for gyr_error_t {
    fn from(error: RotationError) -> Self {
        match error {
            RotationError::NotFinite => Self::GYR_ROTATION_NOT_FINITE,
            RotationError::NotUnit(_) => Self::GYR_ROTATION_NOT_UNIT,
        }
    }
}

impl From<FieldOfViewError> for gyr_error_t {
    fn from(error: FieldOfViewError) -> Self {
        match error {
            FieldOfViewError::Radius(_) => Self::GYR_FIELD_RADIUS,
            FieldOfViewError::Side(_) => Self::GYR_FIELD_SIDE,
        }
    }
}

impl From<MissionError> for gyr_error_t {
    fn from(error: MissionError) -> Self {
        match error {
            MissionError::WrongLength => Self::GYR_MISSION_LENGTH,
            MissionError::SunModel(_) => Self::GYR_MISSION_SUN_MODEL,
            MissionError::Telescope(_) => Self::GYR_MISSION_TELESCOPE,
            MissionError::Detector(_) => Self::GYR_MISSION_DETECTOR,
            MissionError::Avoidance(_) => Self::GYR_MISSION_AVOIDANCE,
            MissionError::Scan(error) => error.into(),
            MissionError::Rotation(error) => error.into(),
            MissionError::FieldOfView(error) => error.into(),
            _ => Self::GYR_UNNAMED,
        }
    }
}

impl From<PlanError> for gyr_error_t {
    fn from(error: PlanError) -> Self {
        match error {
            PlanError::WrongLength => Self::GYR_PLAN_LENGTH,
            PlanError::BadSession(_) => Self::GYR_PLAN_SESSION,
            _ => Self::GYR_UNNAMED,
        }
    }
}

impl From<TableError> for gyr_error_t {
    fn from(error: TableError) -> Self {
        match error {
            TableError::Container(error) => error.into(),
            TableError::Ephemeris(error) => error.into(),
            TableError::Mission(error) => error.into(),
            TableError::Plan(error) => error.into(),
            TableError::Coverage(_) => Self::GYR_TABLES_COVERAGE,
            TableError::SessionOutside(_) => Self::GYR_TABLES_SESSION_OUTSIDE,
            TableError::SessionTelescope(_) => Self::GYR_TABLES_SESSION_TELESCOPE,
            _ => Self::GYR_UNNAMED,
        }
    }
}

impl From<SlotState> for gyr_error_t {
    fn from(state: SlotState) -> Self {
        match state {
            SlotState::TooShort(_) => Self::GYR_SLOT_TOO_SHORT,
            SlotState::Erased => Self::GYR_SLOT_ERASED,
            SlotState::BeingWritten => Self::GYR_SLOT_BEING_WRITTEN,
            SlotState::Complete(_) => Self::GYR_SLOT_COMPLETE,
            SlotState::CommitTorn => Self::GYR_SLOT_COMMIT_TORN,
            SlotState::Committed(_) => Self::GYR_SLOT_COMMITTED,
            SlotState::Revoked(_) => Self::GYR_SLOTS_REVOKED,
            SlotState::Unsound(error) => error.into(),
            _ => Self::GYR_UNNAMED,
        }
    }
}

impl From<NoTables> for gyr_error_t {
    fn from(_: NoTables) -> Self {
        Self::GYR_SLOTS_NO_TABLES
    }
}

impl From<UploadRefusal> for gyr_error_t {
    fn from(refusal: UploadRefusal) -> Self {
        match refusal {
            UploadRefusal::Unsound(error) => error.into(),
            UploadRefusal::Expired(_) => Self::GYR_SLOTS_EXPIRED,
            UploadRefusal::NotYetValid(_) => Self::GYR_SLOTS_NOT_YET_VALID,
            UploadRefusal::Sequence(SequenceError::Older { .. }) => Self::GYR_SLOTS_OLDER,
            UploadRefusal::Sequence(SequenceError::StepTooLarge { .. }) => {
                Self::GYR_SLOTS_STEP_TOO_LARGE
            }
            UploadRefusal::OtherSpacecraft { .. } => Self::GYR_SLOTS_OTHER_SPACECRAFT,
            UploadRefusal::OrderExpired(_) => Self::GYR_SLOTS_ORDER_EXPIRED,
            UploadRefusal::OtherOrder => Self::GYR_SLOTS_OTHER_ORDER,
            UploadRefusal::TooLong(..) => Self::GYR_SLOTS_TOO_LONG,
            _ => Self::GYR_UNNAMED,
        }
    }
}

impl From<RollbackRefusal> for gyr_error_t {
    fn from(refusal: RollbackRefusal) -> Self {
        match refusal {
            RollbackRefusal::OrderExpired(_) => Self::GYR_SLOTS_ORDER_EXPIRED,
            RollbackRefusal::NotActive(_) => Self::GYR_SLOTS_NOT_ACTIVE,
            RollbackRefusal::NothingToReturnTo => Self::GYR_SLOTS_NOTHING_TO_RETURN_TO,
            RollbackRefusal::Expired(_) => Self::GYR_SLOTS_EXPIRED,
            RollbackRefusal::NotYetValid(_) => Self::GYR_SLOTS_NOT_YET_VALID,
            RollbackRefusal::FloorsUsed => Self::GYR_SLOTS_FLOORS_USED,
            _ => Self::GYR_UNNAMED,
        }
    }
}

impl From<FlashError> for gyr_error_t {
    fn from(error: FlashError) -> Self {
        match error {
            FlashError::NotErased(..) => Self::GYR_FLASH_NOT_ERASED,
            FlashError::NotProgrammed(..) => Self::GYR_FLASH_NOT_PROGRAMMED,
            FlashError::Unsound(error) => error.into(),
            FlashError::Changed => Self::GYR_FLASH_CHANGED,
            _ => Self::GYR_UNNAMED,
        }
    }
}

impl From<MissionChangeError> for gyr_error_t {
    fn from(error: MissionChangeError) -> Self {
        match error {
            MissionChangeError::NotAnOrder => Self::GYR_CHANGE_NOT_AN_ORDER,
            MissionChangeError::Damaged => Self::GYR_CHANGE_DAMAGED,
            MissionChangeError::NoChange => Self::GYR_CHANGE_NONE,
            _ => Self::GYR_UNNAMED,
        }
    }
}

impl From<RecordError> for gyr_error_t {
    fn from(error: RecordError) -> Self {
        match error {
            RecordError::Length(_) => Self::GYR_ARGUMENT_LENGTH,
            RecordError::Kind => Self::GYR_RECORD_KIND,
            RecordError::Damaged => Self::GYR_RECORD_DAMAGED,
            RecordError::Version(_) => Self::GYR_RECORD_VERSION,
            RecordError::OtherSpacecraft { .. } => Self::GYR_RECORD_OTHER_SPACECRAFT,
            RecordError::OtherOrigin => Self::GYR_RECORD_OTHER_ORIGIN,
            _ => Self::GYR_UNNAMED,
        }
    }
}

impl From<RollbackError> for gyr_error_t {
    fn from(error: RollbackError) -> Self {
        match error {
            RollbackError::NotAnOrder => Self::GYR_ROLLBACK_NOT_AN_ORDER,
            RollbackError::Damaged => Self::GYR_ROLLBACK_DAMAGED,
            RollbackError::NotBack => Self::GYR_ROLLBACK_NOT_BACK,
            _ => Self::GYR_UNNAMED,
        }
    }
}

impl From<ClockError> for gyr_error_t {
    fn from(error: ClockError) -> Self {
        match error {
            ClockError::NotACorrelation => Self::GYR_CLOCK_NOT_A_CORRELATION,
            ClockError::Damaged => Self::GYR_CLOCK_DAMAGED,
            ClockError::Illegal => Self::GYR_CLOCK_ILLEGAL,
            ClockError::Sequence(SequenceError::Older { .. }) => Self::GYR_CLOCK_OLDER,
            ClockError::Sequence(SequenceError::StepTooLarge { .. }) => {
                Self::GYR_CLOCK_STEP_TOO_LARGE
            }
            ClockError::OtherSpacecraft { .. } => Self::GYR_CLOCK_OTHER_SPACECRAFT,
            ClockError::NotYetValid(_) => Self::GYR_CLOCK_NOT_YET_VALID,
            ClockError::Expired(_) => Self::GYR_CLOCK_EXPIRED,
            ClockError::BeyondScale => Self::GYR_CLOCK_BEYOND_SCALE,
            _ => Self::GYR_UNNAMED,
        }
    }
}

impl From<TrackerSettingsError> for gyr_error_t {
    fn from(error: TrackerSettingsError) -> Self {
        match error {
            TrackerSettingsError::AngleSigma(..) => Self::GYR_TRACKER_SETTING_ANGLE_SIGMA,
            TrackerSettingsError::PrecessionRateSigma(_)
            | TrackerSettingsError::SpinRateSigma(_) => Self::GYR_TRACKER_SETTING_RATE_SIGMA,
            TrackerSettingsError::AngleWalk(..) => Self::GYR_TRACKER_SETTING_ANGLE_WALK,
            TrackerSettingsError::PrecessionRateWalk(_) | TrackerSettingsError::SpinRateWalk(_) => {
                Self::GYR_TRACKER_SETTING_RATE_WALK
            }
            TrackerSettingsError::MaxAge(_) => Self::GYR_TRACKER_SETTING_MAX_AGE,
            TrackerSettingsError::MaxLead(_) => Self::GYR_TRACKER_SETTING_MAX_LEAD,
            TrackerSettingsError::Gate(_) => Self::GYR_TRACKER_SETTING_GATE,
            TrackerSettingsError::Limit(..) => Self::GYR_TRACKER_SETTING_LIMIT,
            _ => Self::GYR_UNNAMED,
        }
    }
}

impl From<MeasurementRefusal> for gyr_error_t {
    fn from(refusal: MeasurementRefusal) -> Self {
        match refusal {
            MeasurementRefusal::Sigma(_) => Self::GYR_TRACKER_SIGMA,
            MeasurementRefusal::Stale(_) => Self::GYR_TRACKER_STALE,
            MeasurementRefusal::Future(_) => Self::GYR_TRACKER_FUTURE,
            MeasurementRefusal::NotAfter(_) => Self::GYR_TRACKER_NOT_AFTER,
            MeasurementRefusal::Ephemeris(error) => error.into(),
            MeasurementRefusal::Unobservable(_) => Self::GYR_TRACKER_UNOBSERVABLE,
            MeasurementRefusal::Ambiguous(..) => Self::GYR_TRACKER_AMBIGUOUS,
            MeasurementRefusal::Outlier(_) => Self::GYR_TRACKER_OUTLIER,
            MeasurementRefusal::Correction(..) => Self::GYR_TRACKER_CORRECTION,
            MeasurementRefusal::Strategy(error) => error.into(),
            _ => Self::GYR_UNNAMED,
        }
    }
}

impl From<ResumeError> for gyr_error_t {
    fn from(error: ResumeError) -> Self {
        match error {
            ResumeError::Scan(error) => error.into(),
            ResumeError::OtherStrategy => Self::GYR_TRACKER_OTHER_STRATEGY,
            ResumeError::Covariance => Self::GYR_TRACKER_COVARIANCE,
            _ => Self::GYR_UNNAMED,
        }
    }
}

impl From<SettingsError> for gyr_error_t {
    fn from(error: SettingsError) -> Self {
        match error {
            SettingsError::Tolerance(_) => Self::GYR_SEQUENCER_TOLERANCE,
            SettingsError::LongestGap(_) => Self::GYR_SEQUENCER_LONGEST_GAP,
            SettingsError::CheckAhead(_) => Self::GYR_SEQUENCER_CHECK_AHEAD,
            SettingsError::Recheck(_) => Self::GYR_SEQUENCER_RECHECK,
            SettingsError::StepsPerTick(_) => Self::GYR_SEQUENCER_STEPS_PER_TICK,
            _ => Self::GYR_UNNAMED,
        }
    }
}

impl From<VisitError> for gyr_error_t {
    fn from(error: VisitError) -> Self {
        match error {
            VisitError::NoSuchTarget(_) => Self::GYR_VISIT_NO_SUCH_TARGET,
            VisitError::Reversed { .. } => Self::GYR_VISIT_REVERSED,
            VisitError::OutOfOrder { .. } => Self::GYR_VISIT_OUT_OF_ORDER,
            VisitError::Overlap { .. } => Self::GYR_VISIT_OVERLAP,
            _ => Self::GYR_UNNAMED,
        }
    }
}

impl From<BinsError> for gyr_error_t {
    fn from(error: BinsError) -> Self {
        match error {
            BinsError::Low(_) => Self::GYR_VISIT_BINS_LOW,
            BinsError::High(_) => Self::GYR_VISIT_BINS_HIGH,
        }
    }
}

#[cfg(test)]
mod tests {
    /// Names of an enum's variants in its source.
    fn variants<'s>(source: &'s str, name: &str) -> Vec<&'s str> {
        let (_, behind) = source.split_once(&format!("pub enum {name} {{\n")).unwrap();
        let (body, _) = behind.split_once("\n}").unwrap();
        body.lines()
            .filter_map(|line| line.strip_prefix("    "))
            .filter(|line| line.starts_with(char::is_uppercase))
            .filter_map(|line| line.split(|letter: char| !letter.is_alphanumeric()).next())
            .collect()
    }

    #[test]
    fn every_refusal_that_may_gain_a_reason_has_all_of_its_codes() {
        let own = concat!(include_str!("refusal.rs"), include_str!("sequencer.rs"));
        for (name, source, count) in [
            ("SlotState", include_str!("../../src/uplink/slots.rs"), 8),
            ("UploadRefusal", include_str!("../../src/uplink/slots.rs"), 8),
            ("RollbackRefusal", include_str!("../../src/uplink/slots.rs"), 6),
            ("FlashError", include_str!("../../src/uplink/flash.rs"), 4),
            ("MissionChangeError", include_str!("../../src/uplink/mission_change.rs"), 3),
            ("SequenceError", include_str!("../../src/uplink/sequence.rs"), 2),
            ("RecordError", include_str!("../../src/record.rs"), 6),
            ("ResumeError", include_str!("../../src/tracking/mod.rs"), 3),
            ("UplinkError", include_str!("../../src/uplink/mod.rs"), 10),
            ("TableError", include_str!("../../src/uplink/tables.rs"), 7),
            ("MissionError", include_str!("../../src/uplink/mission.rs"), 8),
            ("PlanError", include_str!("../../src/uplink/plan.rs"), 2),
            ("RollbackError", include_str!("../../src/uplink/rollback.rs"), 3),
            ("EphemerisError", include_str!("../../src/ephemeris/error.rs"), 6),
            ("ClockError", include_str!("../../src/clock.rs"), 8),
            ("TrackerSettingsError", include_str!("../../src/tracking/settings.rs"), 10),
            ("MeasurementRefusal", include_str!("../../src/tracking/mod.rs"), 10),
            ("SettingsError", include_str!("../../src/sequencer/settings.rs"), 5),
            ("VisitError", include_str!("../../src/visits.rs"), 4),
            ("SafeReason", include_str!("../../src/sequencer/reason.rs"), 10),
            ("SkipReason", include_str!("../../src/sequencer/reason.rs"), 10),
            ("AbortReason", include_str!("../../src/sequencer/reason.rs"), 5),
        ] {
            let found = variants(source, name);
            assert!(found.len() >= count, "{name}: {found:?}");
            for variant in found {
                assert!(own.contains(&format!("{name}::{variant}")), "{name}::{variant}");
            }
        }
    }
}
