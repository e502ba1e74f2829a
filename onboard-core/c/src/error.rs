//! Every code that a function can return or an event can carry.
//!
//! Numbers are stable: a refusal keeps its number for good, a new one gets a number of its own. The
//! values that the core's refusals carry are not handed out, but for an outlier's residuals and what
//! an event's `value` says. `refusal.rs` says which refusal of the core a code is.

/// What a function answers: GYR_OK, or why it did nothing. Events carry the same codes as reasons.
/// 1 to 8 are about the call itself; 160 to 203 occur in the sequencer's events and states alone, 220
/// to 225 in gyr_slot_state_t and where a slot holds no tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(i32)]
pub enum gyr_error_t {
    /// Done.
    GYR_OK = 0,
    /// A pointer is null that must not be.
    GYR_ARGUMENT_NULL = 1,
    /// A pointer is not aligned for its type.
    GYR_ARGUMENT_ALIGNMENT = 2,
    /// A length is not the record's, or no length at all.
    GYR_ARGUMENT_LENGTH = 3,
    /// The memory is no state of this kind: never made, ended, copied, or overwritten.
    GYR_ARGUMENT_STATE = 4,
    /// An index or a number that stands for a choice is out of its range.
    GYR_ARGUMENT_RANGE = 5,
    /// The tables are not those that the state was made with.
    GYR_ARGUMENT_TABLES = 6,
    /// The state holds as many as it can.
    GYR_ARGUMENT_FULL = 7,
    /// There is none: no event waits, no visit is known.
    GYR_NOTHING = 8,
    /// The core refuses for a reason that has no code here.
    GYR_UNNAMED = 9,
    /// Shorter than a header, or than the length in it.
    GYR_CONTAINER_TRUNCATED = 20,
    /// The first bytes are not a container's.
    GYR_CONTAINER_NOT_ONE = 21,
    /// Another format version.
    GYR_CONTAINER_VERSION = 22,
    /// The header's CRC does not match, or its spare bytes are not zero.
    GYR_CONTAINER_HEADER_CRC = 23,
    /// The directory's CRC does not match.
    GYR_CONTAINER_DIRECTORY_CRC = 24,
    /// The directory's counts, offsets or lengths contradict each other.
    GYR_CONTAINER_DIRECTORY = 25,
    /// Bytes follow the container's end.
    GYR_CONTAINER_TOO_LONG = 26,
    /// A section's CRC does not match.
    GYR_CONTAINER_SECTION_CRC = 27,
    /// A section comes from another set than the rest.
    GYR_CONTAINER_MIXED_SET = 28,
    /// A section is not there.
    GYR_CONTAINER_NO_SECTION = 29,
    /// The section's length is not what its counts say.
    GYR_EPHEMERIS_LENGTH = 40,
    /// A span's record is illegal.
    GYR_EPHEMERIS_SPAN = 41,
    /// A coefficient is illegal.
    GYR_EPHEMERIS_COEFFICIENT = 42,
    /// The tables do not have this body.
    GYR_EPHEMERIS_NO_BODY = 43,
    /// The tables do not cover this instant.
    GYR_EPHEMERIS_OUT_OF_SPAN = 44,
    /// A body's record is illegal, or out of order.
    GYR_EPHEMERIS_BODY = 45,
    /// The section's length is not what its counts say.
    GYR_MISSION_LENGTH = 50,
    /// An unknown Sun model.
    GYR_MISSION_SUN_MODEL = 51,
    /// A telescope's record is illegal.
    GYR_MISSION_TELESCOPE = 52,
    /// A detector's record is illegal.
    GYR_MISSION_DETECTOR = 53,
    /// An avoidance limit is illegal.
    GYR_MISSION_AVOIDANCE = 54,
    /// Alpha is not in [0, pi].
    GYR_SCAN_ALPHA = 60,
    /// Beta is not in [0, pi].
    GYR_SCAN_BETA = 61,
    /// Alpha + beta exceeds pi.
    GYR_SCAN_ALPHA_PLUS_BETA = 62,
    /// The precession rate is zero, or half a turn per ns or faster.
    GYR_SCAN_PRECESSION_RATE = 63,
    /// The spin rate is zero, or half a turn per ns or faster.
    GYR_SCAN_SPIN_RATE = 64,
    /// A quaternion's component is not a finite number.
    GYR_ROTATION_NOT_FINITE = 66,
    /// A quaternion's norm is not 1.
    GYR_ROTATION_NOT_UNIT = 67,
    /// A field of view's radius is not in (0, pi].
    GYR_FIELD_RADIUS = 70,
    /// A field of view's width or height is not in (0, pi).
    GYR_FIELD_SIDE = 71,
    /// The section's length is not what its count says.
    GYR_PLAN_LENGTH = 74,
    /// A session's record is illegal, or breaks the order of starts.
    GYR_PLAN_SESSION = 75,
    /// A body that is needed does not cover the container's validity.
    GYR_TABLES_COVERAGE = 78,
    /// A session lies outside the container's validity.
    GYR_TABLES_SESSION_OUTSIDE = 79,
    /// A session's telescope is not there.
    GYR_TABLES_SESSION_TELESCOPE = 80,
    /// The slot's container was rolled back.
    GYR_SLOTS_REVOKED = 90,
    /// Neither slot holds tables.
    GYR_SLOTS_NO_TABLES = 91,
    /// The validity of the candidate, or of the container to return to, has ended.
    GYR_SLOTS_EXPIRED = 92,
    /// The validity of the candidate, or of the container to return to, has not begun.
    GYR_SLOTS_NOT_YET_VALID = 93,
    /// The candidate's sequence number is not above the newest one seen.
    GYR_SLOTS_OLDER = 94,
    /// The candidate does not fit into the slot.
    GYR_SLOTS_TOO_LONG = 95,
    /// The last instant of the order, rollback or mission change, has passed.
    GYR_SLOTS_ORDER_EXPIRED = 96,
    /// The order leaves another container than the active one.
    GYR_SLOTS_NOT_ACTIVE = 97,
    /// The other slot does not hold the container that the order returns to.
    GYR_SLOTS_NOTHING_TO_RETURN_TO = 98,
    /// The candidate's sequence number is more than 1000 above the newest one seen.
    GYR_SLOTS_STEP_TOO_LARGE = 99,
    /// The first bytes are not an order's.
    GYR_ROLLBACK_NOT_AN_ORDER = 100,
    /// The order's CRC does not match, or its spare bytes are not zero.
    GYR_ROLLBACK_DAMAGED = 101,
    /// The order returns to the same or a newer container.
    GYR_ROLLBACK_NOT_BACK = 102,
    /// The candidate is another spacecraft's.
    GYR_SLOTS_OTHER_SPACECRAFT = 103,
    /// The mission change order names other spacecraft, or another container.
    GYR_SLOTS_OTHER_ORDER = 104,
    /// The container was returned to as often as its slot can remember.
    GYR_SLOTS_FLOORS_USED = 105,
    /// The first bytes are not a clock correlation's.
    GYR_CLOCK_NOT_A_CORRELATION = 110,
    /// The record's CRC does not match, or its spare bytes are not zero.
    GYR_CLOCK_DAMAGED = 111,
    /// A tick of no length, or a validity that ends before it begins.
    GYR_CLOCK_ILLEGAL = 112,
    /// The record's sequence number is not above the active one's.
    GYR_CLOCK_OLDER = 113,
    /// The counter's time lies before the record's validity.
    GYR_CLOCK_NOT_YET_VALID = 114,
    /// The counter's time lies behind the record's validity.
    GYR_CLOCK_EXPIRED = 115,
    /// The counter's time lies beyond the time scale.
    GYR_CLOCK_BEYOND_SCALE = 116,
    /// The record's sequence number is more than 1000 above the active one's.
    GYR_CLOCK_STEP_TOO_LARGE = 117,
    /// The record is another spacecraft's.
    GYR_CLOCK_OTHER_SPACECRAFT = 118,
    /// An angle's prior standard deviation is out of its range.
    GYR_TRACKER_SETTING_ANGLE_SIGMA = 120,
    /// A rate's prior standard deviation is out of its range.
    GYR_TRACKER_SETTING_RATE_SIGMA = 121,
    /// An angle's random walk is out of its range.
    GYR_TRACKER_SETTING_ANGLE_WALK = 122,
    /// A rate's random walk is out of its range.
    GYR_TRACKER_SETTING_RATE_WALK = 123,
    /// The greatest age is not positive.
    GYR_TRACKER_SETTING_MAX_AGE = 124,
    /// The greatest lead is negative.
    GYR_TRACKER_SETTING_MAX_LEAD = 125,
    /// The gate on chi^2 is out of its range.
    GYR_TRACKER_SETTING_GATE = 126,
    /// The limit of an angle's correction is out of its range.
    GYR_TRACKER_SETTING_LIMIT = 127,
    /// The measurement's noise is out of its range.
    GYR_TRACKER_SIGMA = 130,
    /// The measurement is older than the settings allow.
    GYR_TRACKER_STALE = 131,
    /// The measurement lies further ahead of now than the settings allow.
    GYR_TRACKER_FUTURE = 132,
    /// The measurement is not after the last accepted one.
    GYR_TRACKER_NOT_AFTER = 133,
    /// The measured alpha is too near 0 or pi.
    GYR_TRACKER_UNOBSERVABLE = 134,
    /// A phase is known so badly that whole turns may be lost.
    GYR_TRACKER_AMBIGUOUS = 135,
    /// Chi^2 is above the gate; the residuals are given.
    GYR_TRACKER_OUTLIER = 136,
    /// The correction of an angle is beyond its limit.
    GYR_TRACKER_CORRECTION = 137,
    /// The saved tracker began with another strategy.
    GYR_TRACKER_OTHER_STRATEGY = 138,
    /// The saved tracker's covariance is not one.
    GYR_TRACKER_COVARIANCE = 139,
    /// The setting `tolerance_ns` is negative.
    GYR_SEQUENCER_TOLERANCE = 150,
    /// The setting `longest_gap_ns` is not above zero.
    GYR_SEQUENCER_LONGEST_GAP = 151,
    /// The setting `check_ahead_ns` is less than the longest gap.
    GYR_SEQUENCER_CHECK_AHEAD = 152,
    /// The setting `steps_per_tick` is zero or too large.
    GYR_SEQUENCER_STEPS_PER_TICK = 153,
    /// The setting `recheck_rad` is not above zero and finite.
    GYR_SEQUENCER_RECHECK = 154,
    /// Safe: ordered by gyr_sequencer_stop.
    GYR_SAFE_COMMANDED = 160,
    /// Safe: there is no clock correlation.
    GYR_SAFE_NO_CLOCK = 161,
    /// Safe: there are no tables.
    GYR_SAFE_NO_TABLES = 162,
    /// Safe: the tables' validity has not begun; the value is its first instant.
    GYR_SAFE_TABLES_NOT_YET_VALID = 163,
    /// Safe: the tables' validity has ended; the value is its last instant.
    GYR_SAFE_TABLES_EXPIRED = 164,
    /// Safe: the mission does not have the sequencer's telescope.
    GYR_SAFE_NO_SUCH_TELESCOPE = 165,
    /// Safe: time ran backwards; the value says by how much, ns.
    GYR_SAFE_TIME_REVERSED = 166,
    /// Safe: the sequencer is new.
    GYR_SAFE_BOOT = 167,
    /// Safe: the tables' bytes were found damaged.
    GYR_SAFE_TABLES_DAMAGED = 168,
    /// Skipped: the start had passed by more than the longest gap.
    GYR_SKIP_MISSED = 180,
    /// Skipped: another session was still running.
    GYR_SKIP_OVERLAP = 181,
    /// Skipped: the prediction was not finished at the start.
    GYR_SKIP_NOT_CHECKED = 182,
    /// Skipped: the prediction finds no pass.
    GYR_SKIP_NO_PASS = 183,
    /// Skipped: the predicted first entry is off by the value, ns.
    GYR_SKIP_ENTRY = 184,
    /// Skipped: the predicted last exit is off by the value, ns.
    GYR_SKIP_EXIT = 185,
    /// Skipped: the prediction finds this number of passes (the value).
    GYR_SKIP_PASSES = 186,
    /// Skipped: a field of view would come too close to this body (the value).
    GYR_SKIP_AVOIDANCE = 187,
    /// Skipped: entry or exit is known only within the value, ns.
    GYR_SKIP_UNCERTAIN = 188,
    /// Given up: the state became safe.
    GYR_ABORT_SAFE = 200,
    /// Given up: other tables are in use.
    GYR_ABORT_TABLES = 201,
    /// Given up: time moved on by more than the longest gap.
    GYR_ABORT_TIME_JUMPED = 202,
    /// Given up: a field of view is too close to this body (the value).
    GYR_ABORT_AVOIDANCE = 203,
    /// The log has no target of this index.
    GYR_VISIT_NO_SUCH_TARGET = 210,
    /// The exit lies before the entry.
    GYR_VISIT_REVERSED = 211,
    /// The entry lies before one that was taken already.
    GYR_VISIT_OUT_OF_ORDER = 212,
    /// The entry lies before the same target's last exit.
    GYR_VISIT_OVERLAP = 213,
    /// The lower end of the bins is out of its range.
    GYR_VISIT_BINS_LOW = 214,
    /// The upper end of the bins is not above the lower one.
    GYR_VISIT_BINS_HIGH = 215,
    /// The slot was not written since its last erase.
    GYR_SLOT_ERASED = 220,
    /// The slot holds part of a container: an upload under way, or cut short.
    GYR_SLOT_BEING_WRITTEN = 221,
    /// The slot holds a whole container without COMMIT word.
    GYR_SLOT_COMPLETE = 222,
    /// The slot's COMMIT word is not whole, or not this container's.
    GYR_SLOT_COMMIT_TORN = 223,
    /// The slot holds a container with its COMMIT word.
    GYR_SLOT_COMMITTED = 224,
    /// The slot is shorter than its head.
    GYR_SLOT_TOO_SHORT = 225,
    /// A word that was to be erased does not read as ones.
    GYR_FLASH_NOT_ERASED = 230,
    /// A word does not read as it was to be programmed.
    GYR_FLASH_NOT_PROGRAMMED = 231,
    /// The container in the slot is another one than was admitted.
    GYR_FLASH_CHANGED = 232,
    /// The first bytes are not a mission change order's.
    GYR_CHANGE_NOT_AN_ORDER = 240,
    /// The mission change order's CRC does not match.
    GYR_CHANGE_DAMAGED = 241,
    /// The mission change order changes nothing.
    GYR_CHANGE_NONE = 242,
    /// The record is of another kind.
    GYR_RECORD_KIND = 250,
    /// The record's CRC does not match, or a field has no meaning.
    GYR_RECORD_DAMAGED = 251,
    /// The record is of another version.
    GYR_RECORD_VERSION = 252,
    /// The record is another spacecraft's.
    GYR_RECORD_OTHER_SPACECRAFT = 253,
    /// The record belongs to another search or another log.
    GYR_RECORD_OTHER_ORIGIN = 254,
}
