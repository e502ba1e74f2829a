#ifndef GYRFALCON_H
#define GYRFALCON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The flight core of Gyrfalcon. docs/c-interface.md says how it is built and used.
 *
 * This file is made from the library's source; do not edit it.
 *
 * Names. Functions and types begin with gyr_, types end in _t; constants and codes begin with GYR_.
 * The unit stands at a name's end: _rad, _s, _ns; _tai_ns is an instant in nanoseconds of TAI since
 * 2000-01-01T12:00:00 TAI. Phases are 64-bit fractions of a turn.
 *
 * Answers. A function returns a gyr_error_t and writes its results where its last arguments point.
 * Unless it returns GYR_OK, nothing is written and no state is changed, but for what its comment
 * names and the tracker's count of refused measurements.
 *
 * States. A type with a member `opaque` is a state: memory of the caller's, in which the library
 * keeps what it knows. It is made by an ..._init, _load, _read, _active, _admit or _roll_back function,
 * needs no end, and may be made anew at any time. It belongs to its address: a copy of it is refused. Memory that was
 * never made a state, or another kind of state, is refused with GYR_ARGUMENT_STATE.
 *
 * What the library cannot see, and every caller must hold:
 * - A pointer points to memory of its type, or is null. Null and misaligned pointers are refused.
 * - The bytes of a container stay where and as they are while tables made of it are in use, that is
 *   until gyr_tables_unload. Finder, forecast and scrub belong to tables and are given them in every
 *   step.
 * - The bytes of a candidate stay where and as they are while its gyr_upload_t is used.
 * - One thread at a time uses a state; different states may be used at the same time. The library
 *   has no memory of its own, calls nothing back, and may be used in an interrupt. */


// Bytes of a clock correlation's record.
#define GYR_CLOCK_BYTES 72

// 64-bit words of a gyr_clock_t.
#define GYR_CLOCK_WORDS 14

// 64-bit words of a gyr_tables_t.
#define GYR_TABLES_WORDS 32

// Bytes of a slot's word: offsets are multiples of it.
#define GYR_WORD_BYTES 32

// Bytes of a slot before its container. A slot needs them and the container's length, filled up to a
// whole word.
#define GYR_SLOT_HEAD_BYTES 512

// The slot A.
#define GYR_SLOT_A 0

// The slot B.
#define GYR_SLOT_B 1

// Bytes of a rollback order.
#define GYR_ROLLBACK_BYTES 40

// Bytes of a mission change order.
#define GYR_MISSION_CHANGE_BYTES 40

// 64-bit words of a gyr_upload_t.
#define GYR_UPLOAD_WORDS 16

// 64-bit words of a gyr_revocation_t.
#define GYR_REVOCATION_WORDS 6

// Erase every sector of the slot, the one with its head first.
#define GYR_FLASH_ERASE 1

// Program `word` at `offset` of the slot.
#define GYR_FLASH_PROGRAM 2

// Nothing is left to be done.
#define GYR_FLASH_DONE 3

// 64-bit words of a gyr_scrub_t.
#define GYR_SCRUB_WORDS 16

// Nothing so far; the round goes on.
#define GYR_SCRUB_GOES_ON 1

// A round is over and nothing was found.
#define GYR_SCRUB_ROUND_OVER 2

// The container is damaged: unload the tables, tell the sequencer, and ask the slots anew.
#define GYR_SCRUB_DAMAGED 3

// 64-bit words of a gyr_strategy_t.
#define GYR_STRATEGY_WORDS 20

// Bytes of a saved tracker.
#define GYR_TRACKER_BYTES 228

// 64-bit words of a gyr_tracker_t.
#define GYR_TRACKER_WORDS 72

// Most channels of a finder or a forecast.
#define GYR_CHANNELS 8

// Bytes of a channel's saved search.
#define GYR_SEARCH_BYTES 108

// 64-bit words of a gyr_finder_t.
#define GYR_FINDER_WORDS 960

// A gyr_step_t brings a transit.
#define GYR_STEP_TRANSIT 1

// A gyr_step_t brings nothing yet.
#define GYR_STEP_SEARCHED 2

// All channels have reached their end.
#define GYR_STEP_DONE 3

// 64-bit words of a gyr_forecast_t.
#define GYR_FORECAST_WORDS 1120

// A gyr_forecast_step_t says that a target has its next visit.
#define GYR_STEP_FOUND 4

// Events that a sequencer holds until they are popped; a tick emits at most 37.
#define GYR_EVENTS 64

// 64-bit words of a gyr_sequencer_t.
#define GYR_SEQUENCER_WORDS 704

// Surveying; no session runs.
#define GYR_STATE_IDLE 1

// Before the target's first entry.
#define GYR_STATE_SETUP 2

// Between first entry and last exit.
#define GYR_STATE_CALIBRATING 3

// After the last exit.
#define GYR_STATE_COOLDOWN 4

// Nothing is done until gyr_sequencer_resume.
#define GYR_STATE_SAFE 5

// No session is near enough to be checked.
#define GYR_CHECK_WAITING 1

// The check goes on at the next tick.
#define GYR_CHECK_UNDER_WAY 2

// The check's outcome is known.
#define GYR_CHECK_DONE 3

// The state changed to `state`.
#define GYR_EVENT_ENTERED 1

// The session `session`, whose record is `record`, begins.
#define GYR_EVENT_STARTED 2

// The session `session` is over, cooldown included.
#define GYR_EVENT_ENDED 3

// The session `session` is not begun; `reason`, `value`.
#define GYR_EVENT_SKIPPED 4

// The running session `session` is given up; `reason`, `value`.
#define GYR_EVENT_ABORTED 5

// The state is left for safe, or is safe from the first tick on; `reason`, `value`.
#define GYR_EVENT_SAFE 6

// Other tables are in use; `value` is their sequence number.
#define GYR_EVENT_TABLES 7

// Time moved on by more than the longest gap, from `value` to `to_tai_ns`.
#define GYR_EVENT_TIME_JUMPED 8

// Bytes of an event's payload.
#define GYR_EVENT_BYTES 96

// Bytes of housekeeping's payload.
#define GYR_HOUSEKEEPING_BYTES 268

// Bytes of a space packet's primary header.
#define GYR_PACKET_HEADER_BYTES 6

// Targets of a visit log.
#define GYR_VISIT_TARGETS 8

// Bins of each histogram.
#define GYR_VISIT_BINS 20

// Bytes of a target's saved visits.
#define GYR_VISIT_BYTES 336

// 64-bit words of a gyr_visit_log_t.
#define GYR_VISIT_LOG_WORDS 368

// Bins of equal widths.
#define GYR_BINS_LINEAR 1

// Bins of equal ratios.
#define GYR_BINS_LOGARITHMIC 2

// What a function answers: GYR_OK, or why it did nothing. Events carry the same codes as reasons.
// 1 to 8 are about the call itself; 160 to 203 occur in the sequencer's events and states alone, 220
// to 225 in gyr_slot_state_t and where a slot holds no tables.
enum gyr_error_t
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Done.
    GYR_OK = 0,
    // A pointer is null that must not be.
    GYR_ARGUMENT_NULL = 1,
    // A pointer is not aligned for its type.
    GYR_ARGUMENT_ALIGNMENT = 2,
    // A length is not the record's, or no length at all.
    GYR_ARGUMENT_LENGTH = 3,
    // The memory is no state of this kind: never made, ended, copied, or overwritten.
    GYR_ARGUMENT_STATE = 4,
    // An index or a number that stands for a choice is out of its range.
    GYR_ARGUMENT_RANGE = 5,
    // The tables are not those that the state was made with.
    GYR_ARGUMENT_TABLES = 6,
    // The state holds as many as it can.
    GYR_ARGUMENT_FULL = 7,
    // There is none: no event waits, no visit is known.
    GYR_NOTHING = 8,
    // The core refuses for a reason that has no code here.
    GYR_UNNAMED = 9,
    // Shorter than a header, or than the length in it.
    GYR_CONTAINER_TRUNCATED = 20,
    // The first bytes are not a container's.
    GYR_CONTAINER_NOT_ONE = 21,
    // Another format version.
    GYR_CONTAINER_VERSION = 22,
    // The header's CRC does not match, or its spare bytes are not zero.
    GYR_CONTAINER_HEADER_CRC = 23,
    // The directory's CRC does not match.
    GYR_CONTAINER_DIRECTORY_CRC = 24,
    // The directory's counts, offsets or lengths contradict each other.
    GYR_CONTAINER_DIRECTORY = 25,
    // Bytes follow the container's end.
    GYR_CONTAINER_TOO_LONG = 26,
    // A section's CRC does not match.
    GYR_CONTAINER_SECTION_CRC = 27,
    // A section comes from another set than the rest.
    GYR_CONTAINER_MIXED_SET = 28,
    // A section is not there.
    GYR_CONTAINER_NO_SECTION = 29,
    // The section's length is not what its counts say.
    GYR_EPHEMERIS_LENGTH = 40,
    // A span's record is illegal.
    GYR_EPHEMERIS_SPAN = 41,
    // A coefficient is illegal.
    GYR_EPHEMERIS_COEFFICIENT = 42,
    // The tables do not have this body.
    GYR_EPHEMERIS_NO_BODY = 43,
    // The tables do not cover this instant.
    GYR_EPHEMERIS_OUT_OF_SPAN = 44,
    // A body's record is illegal, or out of order.
    GYR_EPHEMERIS_BODY = 45,
    // The section's length is not what its counts say.
    GYR_MISSION_LENGTH = 50,
    // An unknown Sun model.
    GYR_MISSION_SUN_MODEL = 51,
    // A telescope's record is illegal.
    GYR_MISSION_TELESCOPE = 52,
    // A detector's record is illegal.
    GYR_MISSION_DETECTOR = 53,
    // An avoidance limit is illegal.
    GYR_MISSION_AVOIDANCE = 54,
    // Alpha is not in [0, pi].
    GYR_SCAN_ALPHA = 60,
    // Beta is not in [0, pi].
    GYR_SCAN_BETA = 61,
    // Alpha + beta exceeds pi.
    GYR_SCAN_ALPHA_PLUS_BETA = 62,
    // The precession rate is zero, or half a turn per ns or faster.
    GYR_SCAN_PRECESSION_RATE = 63,
    // The spin rate is zero, or half a turn per ns or faster.
    GYR_SCAN_SPIN_RATE = 64,
    // A quaternion's component is not a finite number.
    GYR_ROTATION_NOT_FINITE = 66,
    // A quaternion's norm is not 1.
    GYR_ROTATION_NOT_UNIT = 67,
    // A field of view's radius is not in (0, pi].
    GYR_FIELD_RADIUS = 70,
    // A field of view's width or height is not in (0, pi).
    GYR_FIELD_SIDE = 71,
    // The section's length is not what its count says.
    GYR_PLAN_LENGTH = 74,
    // A session's record is illegal, or breaks the order of starts.
    GYR_PLAN_SESSION = 75,
    // A body that is needed does not cover the container's validity.
    GYR_TABLES_COVERAGE = 78,
    // A session lies outside the container's validity.
    GYR_TABLES_SESSION_OUTSIDE = 79,
    // A session's telescope is not there.
    GYR_TABLES_SESSION_TELESCOPE = 80,
    // The slot's container was rolled back.
    GYR_SLOTS_REVOKED = 90,
    // Neither slot holds tables.
    GYR_SLOTS_NO_TABLES = 91,
    // The validity of the candidate, or of the container to return to, has ended.
    GYR_SLOTS_EXPIRED = 92,
    // The validity of the candidate, or of the container to return to, has not begun.
    GYR_SLOTS_NOT_YET_VALID = 93,
    // The candidate's sequence number is not above the newest one seen.
    GYR_SLOTS_OLDER = 94,
    // The candidate does not fit into the slot.
    GYR_SLOTS_TOO_LONG = 95,
    // The last instant of the order, rollback or mission change, has passed.
    GYR_SLOTS_ORDER_EXPIRED = 96,
    // The order leaves another container than the active one.
    GYR_SLOTS_NOT_ACTIVE = 97,
    // The other slot does not hold the container that the order returns to.
    GYR_SLOTS_NOTHING_TO_RETURN_TO = 98,
    // The candidate's sequence number is more than 1000 above the newest one seen.
    GYR_SLOTS_STEP_TOO_LARGE = 99,
    // The first bytes are not an order's.
    GYR_ROLLBACK_NOT_AN_ORDER = 100,
    // The order's CRC does not match, or its spare bytes are not zero.
    GYR_ROLLBACK_DAMAGED = 101,
    // The order returns to the same or a newer container.
    GYR_ROLLBACK_NOT_BACK = 102,
    // The candidate is another spacecraft's.
    GYR_SLOTS_OTHER_SPACECRAFT = 103,
    // The mission change order names other spacecraft, or another container.
    GYR_SLOTS_OTHER_ORDER = 104,
    // The container was returned to as often as its slot can remember.
    GYR_SLOTS_FLOORS_USED = 105,
    // The first bytes are not a clock correlation's.
    GYR_CLOCK_NOT_A_CORRELATION = 110,
    // The record's CRC does not match, or its spare bytes are not zero.
    GYR_CLOCK_DAMAGED = 111,
    // A tick of no length, or a validity that ends before it begins.
    GYR_CLOCK_ILLEGAL = 112,
    // The record's sequence number is not above the active one's.
    GYR_CLOCK_OLDER = 113,
    // The counter's time lies before the record's validity.
    GYR_CLOCK_NOT_YET_VALID = 114,
    // The counter's time lies behind the record's validity.
    GYR_CLOCK_EXPIRED = 115,
    // The counter's time lies beyond the time scale.
    GYR_CLOCK_BEYOND_SCALE = 116,
    // The record's sequence number is more than 1000 above the active one's.
    GYR_CLOCK_STEP_TOO_LARGE = 117,
    // The record is another spacecraft's.
    GYR_CLOCK_OTHER_SPACECRAFT = 118,
    // An angle's prior standard deviation is out of its range.
    GYR_TRACKER_SETTING_ANGLE_SIGMA = 120,
    // A rate's prior standard deviation is out of its range.
    GYR_TRACKER_SETTING_RATE_SIGMA = 121,
    // An angle's random walk is out of its range.
    GYR_TRACKER_SETTING_ANGLE_WALK = 122,
    // A rate's random walk is out of its range.
    GYR_TRACKER_SETTING_RATE_WALK = 123,
    // The greatest age is not positive.
    GYR_TRACKER_SETTING_MAX_AGE = 124,
    // The greatest lead is negative.
    GYR_TRACKER_SETTING_MAX_LEAD = 125,
    // The gate on chi^2 is out of its range.
    GYR_TRACKER_SETTING_GATE = 126,
    // The limit of an angle's correction is out of its range.
    GYR_TRACKER_SETTING_LIMIT = 127,
    // The measurement's noise is out of its range.
    GYR_TRACKER_SIGMA = 130,
    // The measurement is older than the settings allow.
    GYR_TRACKER_STALE = 131,
    // The measurement lies further ahead of now than the settings allow.
    GYR_TRACKER_FUTURE = 132,
    // The measurement is not after the last accepted one.
    GYR_TRACKER_NOT_AFTER = 133,
    // The measured alpha is too near 0 or pi.
    GYR_TRACKER_UNOBSERVABLE = 134,
    // A phase is known so badly that whole turns may be lost.
    GYR_TRACKER_AMBIGUOUS = 135,
    // Chi^2 is above the gate; the residuals are given.
    GYR_TRACKER_OUTLIER = 136,
    // The correction of an angle is beyond its limit.
    GYR_TRACKER_CORRECTION = 137,
    // The saved tracker began with another strategy.
    GYR_TRACKER_OTHER_STRATEGY = 138,
    // The saved tracker's covariance is not one.
    GYR_TRACKER_COVARIANCE = 139,
    // The setting `tolerance_ns` is negative.
    GYR_SEQUENCER_TOLERANCE = 150,
    // The setting `longest_gap_ns` is not above zero.
    GYR_SEQUENCER_LONGEST_GAP = 151,
    // The setting `check_ahead_ns` is less than the longest gap.
    GYR_SEQUENCER_CHECK_AHEAD = 152,
    // The setting `steps_per_tick` is zero or too large.
    GYR_SEQUENCER_STEPS_PER_TICK = 153,
    // The setting `recheck_rad` is not above zero and finite.
    GYR_SEQUENCER_RECHECK = 154,
    // Safe: ordered by gyr_sequencer_stop.
    GYR_SAFE_COMMANDED = 160,
    // Safe: there is no clock correlation.
    GYR_SAFE_NO_CLOCK = 161,
    // Safe: there are no tables.
    GYR_SAFE_NO_TABLES = 162,
    // Safe: the tables' validity has not begun; the value is its first instant.
    GYR_SAFE_TABLES_NOT_YET_VALID = 163,
    // Safe: the tables' validity has ended; the value is its last instant.
    GYR_SAFE_TABLES_EXPIRED = 164,
    // Safe: the mission does not have the sequencer's telescope.
    GYR_SAFE_NO_SUCH_TELESCOPE = 165,
    // Safe: time ran backwards; the value says by how much, ns.
    GYR_SAFE_TIME_REVERSED = 166,
    // Safe: the sequencer is new.
    GYR_SAFE_BOOT = 167,
    // Safe: the tables' bytes were found damaged.
    GYR_SAFE_TABLES_DAMAGED = 168,
    // Skipped: the start had passed by more than the longest gap.
    GYR_SKIP_MISSED = 180,
    // Skipped: another session was still running.
    GYR_SKIP_OVERLAP = 181,
    // Skipped: the prediction was not finished at the start.
    GYR_SKIP_NOT_CHECKED = 182,
    // Skipped: the prediction finds no pass.
    GYR_SKIP_NO_PASS = 183,
    // Skipped: the predicted first entry is off by the value, ns.
    GYR_SKIP_ENTRY = 184,
    // Skipped: the predicted last exit is off by the value, ns.
    GYR_SKIP_EXIT = 185,
    // Skipped: the prediction finds this number of passes (the value).
    GYR_SKIP_PASSES = 186,
    // Skipped: a field of view would come too close to this body (the value).
    GYR_SKIP_AVOIDANCE = 187,
    // Skipped: entry or exit is known only within the value, ns.
    GYR_SKIP_UNCERTAIN = 188,
    // Given up: the state became safe.
    GYR_ABORT_SAFE = 200,
    // Given up: other tables are in use.
    GYR_ABORT_TABLES = 201,
    // Given up: time moved on by more than the longest gap.
    GYR_ABORT_TIME_JUMPED = 202,
    // Given up: a field of view is too close to this body (the value).
    GYR_ABORT_AVOIDANCE = 203,
    // The log has no target of this index.
    GYR_VISIT_NO_SUCH_TARGET = 210,
    // The exit lies before the entry.
    GYR_VISIT_REVERSED = 211,
    // The entry lies before one that was taken already.
    GYR_VISIT_OUT_OF_ORDER = 212,
    // The entry lies before the same target's last exit.
    GYR_VISIT_OVERLAP = 213,
    // The lower end of the bins is out of its range.
    GYR_VISIT_BINS_LOW = 214,
    // The upper end of the bins is not above the lower one.
    GYR_VISIT_BINS_HIGH = 215,
    // The slot was not written since its last erase.
    GYR_SLOT_ERASED = 220,
    // The slot holds part of a container: an upload under way, or cut short.
    GYR_SLOT_BEING_WRITTEN = 221,
    // The slot holds a whole container without COMMIT word.
    GYR_SLOT_COMPLETE = 222,
    // The slot's COMMIT word is not whole, or not this container's.
    GYR_SLOT_COMMIT_TORN = 223,
    // The slot holds a container with its COMMIT word.
    GYR_SLOT_COMMITTED = 224,
    // The slot is shorter than its head.
    GYR_SLOT_TOO_SHORT = 225,
    // A word that was to be erased does not read as ones.
    GYR_FLASH_NOT_ERASED = 230,
    // A word does not read as it was to be programmed.
    GYR_FLASH_NOT_PROGRAMMED = 231,
    // The container in the slot is another one than was admitted.
    GYR_FLASH_CHANGED = 232,
    // The first bytes are not a mission change order's.
    GYR_CHANGE_NOT_AN_ORDER = 240,
    // The mission change order's CRC does not match.
    GYR_CHANGE_DAMAGED = 241,
    // The mission change order changes nothing.
    GYR_CHANGE_NONE = 242,
    // The record is of another kind.
    GYR_RECORD_KIND = 250,
    // The record's CRC does not match, or a field has no meaning.
    GYR_RECORD_DAMAGED = 251,
    // The record is of another version.
    GYR_RECORD_VERSION = 252,
    // The record is another spacecraft's.
    GYR_RECORD_OTHER_SPACECRAFT = 253,
    // The record belongs to another search or another log.
    GYR_RECORD_OTHER_ORIGIN = 254,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum gyr_error_t gyr_error_t;
#else
typedef int32_t gyr_error_t;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// A checked clock correlation; made by gyr_clock_read, holds no pointer.
typedef struct {
    uint64_t opaque[GYR_CLOCK_WORDS];
} gyr_clock_t;

// A container's tables, checked; made by gyr_tables_load or gyr_slots_active.
//
// It points into the container's bytes: they must stay where and as they are until
// gyr_tables_unload, after which every function refuses these tables.
typedef struct {
    uint64_t opaque[GYR_TABLES_WORDS];
} gyr_tables_t;

// What a container says about itself.
typedef struct {
    // Digest of the set's contents.
    uint64_t set_digest;
    // First and last instant that the tables serve, ns of TAI.
    int64_t valid_from_tai_ns;
    // See `valid_from_tai_ns`.
    int64_t valid_until_tai_ns;
    // Grows with every uplink.
    uint32_t sequence;
    // Numbers of telescopes, listed detectors and avoidance limits.
    uint16_t telescopes;
    // See `telescopes`.
    uint16_t detectors;
    // See `telescopes`.
    uint16_t avoidance_limits;
    // Identity of the spacecraft.
    uint32_t spacecraft;
    // First 16 bytes of the mission's digest.
    uint8_t mission_digest[16];
} gyr_header_t;

// A session of the plan.
typedef struct {
    // Start and end, setup and cooldown included, ns of TAI.
    int64_t start_tai_ns;
    // See `start_tai_ns`.
    int64_t end_tai_ns;
    // First entry and last exit of the target, ns of TAI.
    int64_t first_entry_tai_ns;
    // See `first_entry_tai_ns`.
    int64_t last_exit_tai_ns;
    // The target's number in the ephemeris.
    int32_t body;
    // The spin turn of the first entry, as the ground counts it.
    uint32_t turn;
    // The telescope's index.
    uint16_t telescope;
    // Passes within the session.
    uint16_t passes;
} gyr_session_t;

// A rotation: a unit quaternion; v_B = q v_A q* for a rotation from frame A to frame B.
typedef struct {
    // Along the first axis.
    double x;
    // Along the second axis.
    double y;
    // Along the third axis.
    double z;
    // The scalar.
    double w;
} gyr_quaternion_t;

// A uniform rotation, exact: a rate of (rate_high 2^64 + rate_low) / 2^128 turns per ns, two's
// complement, and the phase at the mission's start in 2^-64 turn.
typedef struct {
    // Low half of the rate.
    uint64_t rate_low;
    // High half of the rate.
    uint64_t rate_high;
    // Phase at the mission's start.
    uint64_t start;
} gyr_rotor_t;

// A telescope of the mission.
typedef struct {
    // Its frame in the mission boresight frame.
    gyr_quaternion_t rotation;
    // Its half-wave plate; all zero without one.
    gyr_rotor_t hwp;
    // Whether it has a half-wave plate.
    bool has_hwp;
} gyr_telescope_t;

// A direction in the ecliptic frame of J2000, and its change.
typedef struct {
    // Unit vector.
    double xyz[3];
    // Its derivative, per s.
    double rate_per_s[3];
} gyr_direction_t;

// Where the two slots lie in flash, which is read in place. A slot is whole sectors and begins at a
// multiple of GYR_WORD_BYTES; a word that cannot be corrected must read as bytes (zeros, for
// instance), not as a fault.
typedef struct {
    // First byte of A.
    const uint8_t *a;
    // Bytes of A.
    size_t a_length;
    // First byte of B.
    const uint8_t *b;
    // Bytes of B.
    size_t b_length;
} gyr_slots_t;

// What a slot holds.
typedef struct {
    // GYR_SLOT_ERASED to GYR_SLOT_TOO_SHORT, GYR_SLOTS_REVOKED, or, where the slot is committed but its
    // contents are refused, why.
    gyr_error_t state;
    // The container's sequence number.
    uint32_t sequence;
    // Whether it is known: of a complete or committed container, and mostly of a revoked one.
    bool has_sequence;
} gyr_slot_state_t;

// Bytes of the caller's.
typedef struct {
    // The first.
    const uint8_t *first;
    // How many.
    size_t length;
} gyr_bytes_t;

// A container that was admitted, on its way into its slot; made by gyr_slots_admit.
//
// It points into the candidate's bytes: they must stay where and as they are until gyr_upload_next
// brings GYR_FLASH_DONE or a refusal, or the upload is given up. To give it up, call it no more.
typedef struct {
    uint64_t opaque[GYR_UPLOAD_WORDS];
} gyr_upload_t;

// The next thing to do to the flash. What its kind does not name is 0.
typedef struct {
    // One of GYR_FLASH_ERASE, GYR_FLASH_PROGRAM, GYR_FLASH_DONE.
    uint32_t kind;
    // GYR_SLOT_A or GYR_SLOT_B.
    uint32_t slot;
    // Where the word begins in the slot, a multiple of GYR_WORD_BYTES.
    size_t offset;
    // The word's bytes; it was not programmed since it was erased.
    uint8_t word[GYR_WORD_BYTES];
} gyr_flash_operation_t;

// A rollback on its way; made by gyr_slots_roll_back, holds no pointer.
typedef struct {
    uint64_t opaque[GYR_REVOCATION_WORDS];
} gyr_revocation_t;

// A scrub of the container that tables were made of. It belongs to the tables it was made with and is
// given them at every step.
typedef struct {
    uint64_t opaque[GYR_SCRUB_WORDS];
} gyr_scrub_t;

// What a step found.
typedef struct {
    // One of GYR_SCRUB_GOES_ON, GYR_SCRUB_ROUND_OVER, GYR_SCRUB_DAMAGED.
    uint32_t kind;
    // What is damaged, with GYR_SCRUB_DAMAGED, else GYR_OK.
    gyr_error_t damage;
} gyr_scrub_step_t;

// A legal scanning strategy; holds no pointer.
typedef struct {
    uint64_t opaque[GYR_STRATEGY_WORDS];
} gyr_strategy_t;

// What defines a scanning strategy.
typedef struct {
    // Instant at which both phases have their start values, ns of TAI.
    int64_t start_tai_ns;
    // Angle from the anti-Sun axis to the spin axis.
    double alpha_rad;
    // Angle from the spin axis to the boresight.
    double beta_rad;
    // Precession.
    gyr_rotor_t precession;
    // Spin.
    gyr_rotor_t spin;
} gyr_scan_t;

// Where the scan stands.
typedef struct {
    // Precession phase in 2^-64 turn.
    uint64_t precession;
    // Spin phase in 2^-64 turn.
    uint64_t spin;
    // Completed precession turns since the start.
    uint64_t precession_turns;
    // Completed spin turns since the start.
    uint64_t spin_turns;
} gyr_phases_t;

// What a detector does on the sky.
typedef struct {
    // From the detector's frame to the ecliptic.
    gyr_quaternion_t attitude;
    // Line of sight in the ecliptic frame.
    double direction_xyz[3];
    // Crossing angle psi, in (-pi, pi].
    double crossing_angle_rad;
    // Speed of the line of sight on the sky.
    double speed_rad_s;
    // Scan-beam angle zeta, in (-pi, pi].
    double scan_beam_angle_rad;
} gyr_sweep_t;

// The best known scan, and how well it is known; holds no pointer.
typedef struct {
    uint64_t opaque[GYR_TRACKER_WORDS];
} gyr_tracker_t;

// What the tracker is told. Angles stand in the order precession phase, alpha, spin phase; rates in
// the order precession, spin.
typedef struct {
    // Standard deviations of the angles before any measurement, rad; in [0, 0.5].
    double angle_sigmas_rad[3];
    // Standard deviations of the rates before any measurement, relative; in [0, 0.01].
    double rate_sigmas[2];
    // Random walks of the angles, rad/s^(1/2); in [0, 1e-3].
    double angle_walks[3];
    // Random walks of the rates, rad/s^(3/2); in [0, 1e-6].
    double rate_walks[2];
    // Oldest measurement that is used, ns; positive.
    int64_t max_age_ns;
    // How far a measurement may lie ahead of now, ns; not negative.
    int64_t max_lead_ns;
    // Largest chi^2 that is not an outlier; in [1, 1e4].
    double gate;
    // Largest correction of each angle by one measurement, rad; in (0, pi/2].
    double limits_rad[3];
} gyr_tracker_settings_t;

// A measured attitude.
typedef struct {
    // When it was, ns of TAI.
    int64_t at_tai_ns;
    // From the mission boresight frame to the ecliptic.
    gyr_quaternion_t attitude;
    // Standard deviation of the noise about each axis, rad.
    double sigma_rad;
} gyr_measurement_t;

// What a measurement showed against the model: precession phase, alpha, spin phase.
typedef struct {
    // Measured minus modelled, rad.
    double innovation_rad[3];
    // Their standard deviations, of model and noise together, rad.
    double sigma_rad[3];
    // Chi^2 of the three together.
    double chi2;
} gyr_residuals_t;

// Covariance of the errors in precession phase, alpha and spin phase, rad^2.
typedef struct {
    // Variances.
    double variances[3];
    // Precession phase with alpha, precession phase with spin phase, alpha with spin phase.
    double covariances[3];
} gyr_covariance_t;

// How the tracker stands.
typedef struct {
    // Instant of the last accepted measurement, or the epoch when there is none, ns of TAI.
    int64_t epoch_tai_ns;
    // Standard deviations of precession and spin rate, rad/s.
    double rate_sigmas_rad_s[2];
    // Accepted measurements since the start.
    uint32_t accepted;
    // Refused measurements since the last accepted one.
    uint32_t refused_in_a_row;
} gyr_tracker_status_t;

// A search over up to GYR_CHANNELS channels. It belongs to the tables it was made with and is given
// them at every step.
typedef struct {
    uint64_t opaque[GYR_FINDER_WORDS];
} gyr_finder_t;

// What a channel searches for.
typedef struct {
    // Start and end of the search, both included, ns of TAI.
    int64_t from_tai_ns;
    // See `from_tai_ns`.
    int64_t until_tai_ns;
    // The target's number in the ephemeris.
    int32_t body;
    // The telescope's index.
    uint16_t telescope;
    // Which of the fields it is calibrated through: a listed detector's circle, or 0 for its field
    // of view where none is listed.
    uint16_t field;
} gyr_channel_t;

// A maximal interval with the target inside the field of view.
typedef struct {
    // First instant inside, or the search's start, ns of TAI.
    int64_t entry_tai_ns;
    // Last instant inside, or the search's end, ns of TAI.
    int64_t exit_tai_ns;
    // Instant of smallest separation, ns of TAI.
    int64_t closest_tai_ns;
    // Separation there, rad.
    double min_separation_rad;
    // Index of the channel that found it.
    uint32_t channel;
    // 1 where the target was inside already at the search's start, else 0.
    uint32_t entry_clipped;
    // 1 where the target was still inside at the search's end, else 0.
    uint32_t exit_clipped;
} gyr_transit_t;

// What one step of a search brought.
typedef struct {
    // One of GYR_STEP_TRANSIT, GYR_STEP_SEARCHED, GYR_STEP_DONE.
    uint32_t kind;
    // No transit that is still to come begins before this instant, ns of TAI; with
    // GYR_STEP_SEARCHED alone.
    int64_t searched_tai_ns;
    // The next transit in order; with GYR_STEP_TRANSIT alone.
    gyr_transit_t transit;
} gyr_step_t;

// The next visit of up to GYR_CHANNELS targets, a channel each. It belongs to the tables it was
// made with and is given them at every step.
typedef struct {
    uint64_t opaque[GYR_FORECAST_WORDS];
} gyr_forecast_t;

// What one step of a forecast brought.
typedef struct {
    // One of GYR_STEP_FOUND, GYR_STEP_SEARCHED, GYR_STEP_DONE.
    uint32_t kind;
    // The target's index, with GYR_STEP_FOUND.
    uint32_t target;
    // No visit that is still to come begins before this instant, ns of TAI, with GYR_STEP_SEARCHED.
    int64_t searched_tai_ns;
} gyr_forecast_step_t;

// A predicted visit and how well it is known.
typedef struct {
    // The visit.
    gyr_transit_t transit;
    // Standard deviations of entry, exit and closest approach, s.
    double entry_sigma_s;
    // See `entry_sigma_s`.
    double exit_sigma_s;
    // See `entry_sigma_s`.
    double closest_sigma_s;
    // Standard deviation of the track's offset across the scan, rad.
    double separation_sigma_rad;
    // Probability that the target enters the field of view at all in this passage.
    double probability;
    // Entry less 1.96 standard deviations, ns of TAI.
    int64_t earliest_entry_tai_ns;
    // Exit plus 1.96 standard deviations, ns of TAI.
    int64_t latest_exit_tai_ns;
} gyr_next_visit_t;

// One telescope's sessions, carried out, and the events that wait; holds no pointer.
typedef struct {
    uint64_t opaque[GYR_SEQUENCER_WORDS];
} gyr_sequencer_t;

// How a sequencer behaves.
typedef struct {
    // How far predicted and planned first entry and last exit may differ, and how uncertain the
    // predicted ones may be, ns.
    int64_t tolerance_ns;
    // Longest time between two ticks, and latest start of a session after its planned one, ns.
    int64_t longest_gap_ns;
    // How long before its start a session is checked, ns.
    int64_t check_ahead_ns;
    // Where the strategy's change turns the attitude predicted for a session's start or end by more
    // than this, the session is checked again, rad.
    double recheck_rad;
    // Index of its telescope in the mission.
    uint16_t telescope;
    // How far predicted and planned number of passes may differ.
    uint16_t passes_tolerance;
    // Search steps per tick, 1 to 8.
    uint16_t steps_per_tick;
} gyr_sequencer_settings_t;

// What a tick is given; each pointer may be null where there is none.
typedef struct {
    // The on-board counter.
    uint64_t ticks;
    // The clock correlation.
    const gyr_clock_t *clock;
    // The active tables.
    const gyr_tables_t *tables;
    // The strategy as measured attitudes have corrected it, and as well as the tracker knows it;
    // without it the mission's strategy counts, as exact.
    const gyr_tracker_t *tracker;
    // Not 0 where the tables' bytes were found damaged after they had been loaded.
    uint32_t tables_damaged;
} gyr_situation_t;

// What the spacecraft does now.
typedef struct {
    // One of GYR_STATE_IDLE to GYR_STATE_SAFE.
    uint32_t kind;
    // The running session's index in the plan; 0 in GYR_STATE_IDLE and GYR_STATE_SAFE.
    uint32_t session;
    // Why it is safe, else GYR_OK.
    gyr_error_t reason;
    // As the reason says, else 0.
    int64_t value;
} gyr_state_t;

// What a tick brought.
typedef struct {
    // The state now.
    gyr_state_t state;
    // Evaluations made: at most 108.
    uint32_t evaluations;
    // How far the check of the next session has come: one of GYR_CHECK_WAITING to GYR_CHECK_DONE.
    uint32_t check;
} gyr_tick_t;

// Something that happened. What its kind does not name is 0.
typedef struct {
    // The on-board counter then.
    uint64_t ticks;
    // One of GYR_EVENT_ENTERED to GYR_EVENT_TIME_JUMPED.
    uint32_t kind;
    // A session's index in the plan.
    uint32_t session;
    // Why, else GYR_OK.
    gyr_error_t reason;
    // As the kind or the reason says.
    int64_t value;
    // Where time jumped to, ns of TAI.
    int64_t to_tai_ns;
    // The state entered.
    gyr_state_t state;
    // The record of a session that begins.
    gyr_session_t record;
} gyr_event_t;

// How many events of each kind were lost; each number stays at its largest value.
typedef struct {
    // GYR_EVENT_ENTERED.
    uint32_t entered;
    // GYR_EVENT_STARTED.
    uint32_t started;
    // GYR_EVENT_ENDED.
    uint32_t ended;
    // GYR_EVENT_SKIPPED.
    uint32_t skipped;
    // GYR_EVENT_ABORTED.
    uint32_t aborted;
    // GYR_EVENT_SAFE.
    uint32_t safe;
    // GYR_EVENT_TABLES.
    uint32_t tables;
    // GYR_EVENT_TIME_JUMPED.
    uint32_t time_jumped;
} gyr_lost_t;

// What housekeeping tells of; each pointer but the sequencer's may be null where there is none.
typedef struct {
    // The on-board counter.
    uint64_t ticks;
    // The sequencer: state, last tick, events lost.
    const gyr_sequencer_t *sequencer;
    // The clock correlation in use.
    const gyr_clock_t *clock;
    // The tables in use.
    const gyr_tables_t *tables;
    // The tracker.
    const gyr_tracker_t *tracker;
    // The scrub of the tables in use.
    const gyr_scrub_t *scrub;
    // The visit to come that the forecast has found, and with it `body`.
    const gyr_next_visit_t *visit;
    // The number of that visit's target.
    int32_t body;
    // Identity of the spacecraft (gyr_header_t).
    uint32_t spacecraft;
    // Not 0 where the tables' bytes were found damaged after they had been loaded.
    uint32_t tables_damaged;
} gyr_housekeeping_t;

// Running statistics of the visits of GYR_VISIT_TARGETS targets; holds no pointer.
typedef struct {
    uint64_t opaque[GYR_VISIT_LOG_WORDS];
} gyr_visit_log_t;

// The range of a histogram and how it is divided into GYR_VISIT_BINS bins.
typedef struct {
    // GYR_BINS_LINEAR or GYR_BINS_LOGARITHMIC.
    uint32_t spacing;
    // Lower end, s.
    double low_s;
    // Upper end, s.
    double high_s;
} gyr_bins_t;

// The bins of the three histograms.
typedef struct {
    // Of dwells: exit less entry.
    gyr_bins_t dwell;
    // Of revisits: next entry less entry.
    gyr_bins_t revisit;
    // Of gaps: next entry less exit.
    gyr_bins_t gap;
} gyr_divisions_t;

// Counts of values by bin.
typedef struct {
    // Values in each bin.
    uint32_t counts[GYR_VISIT_BINS];
    // Values below the first bin.
    uint32_t under;
    // Values at or above the end of the last bin.
    uint32_t over;
} gyr_histogram_t;

// What is known of one target's visits.
typedef struct {
    // Sum of the dwells of whole visits, ns.
    int64_t dwell_sum_ns;
    // Longest gap between an exit and the next entry, ns; -1 where there is none.
    int64_t longest_gap_ns;
    // Entry of the last visit, ns of TAI.
    int64_t last_entry_tai_ns;
    // Exit of the last visit, ns of TAI.
    int64_t last_exit_tai_ns;
    // Visits, clipped ones included.
    uint32_t visits;
    // Visits whose entry or exit is a search's start or end.
    uint32_t clipped;
    // 1 where there is a last visit, else 0.
    uint32_t has_last;
    // 1 where the last visit's entry is a search's start, else 0.
    uint32_t last_entry_clipped;
    // 1 where the last visit's exit is a search's end, else 0.
    uint32_t last_exit_clipped;
    // Dwells of whole visits.
    gyr_histogram_t dwell;
    // Spans from entry to next entry, both whole.
    gyr_histogram_t revisit;
    // Spans from exit to next entry, both whole.
    gyr_histogram_t gap;
} gyr_target_visits_t;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Reads a record of GYR_CLOCK_BYTES bytes for this spacecraft (the identity in the tables' header).
// `active` is the correlation in use, whose number the new one's must exceed, by 1000 at most; null
// where there is none, which counts as 0.
gyr_error_t gyr_clock_read(const uint8_t *bytes,
                           size_t length,
                           const gyr_clock_t *active,
                           uint32_t spacecraft,
                           gyr_clock_t *clock);

// The TAI instant at which the counter stands at `ticks`, in ns since 2000-01-01T12:00:00 TAI.
gyr_error_t gyr_clock_instant(const gyr_clock_t *clock, uint64_t ticks, int64_t *tai_ns);

// Checks a container and makes `tables` of it. Reads all of the container: once per change of
// tables, not per cycle.
gyr_error_t gyr_tables_load(const uint8_t *container, size_t length, gyr_tables_t *tables);

// Ends the use of the container's bytes: the tables are no state any more.
gyr_error_t gyr_tables_unload(gyr_tables_t *tables);

// What the container says about itself.
gyr_error_t gyr_tables_header(const gyr_tables_t *tables, gyr_header_t *header);

// The session of this index in the plan; GYR_ARGUMENT_RANGE behind the last.
gyr_error_t gyr_tables_session(const gyr_tables_t *tables, uint32_t index, gyr_session_t *session);

// The telescope of this index in the mission; GYR_ARGUMENT_RANGE behind the last.
gyr_error_t gyr_tables_telescope(const gyr_tables_t *tables,
                                 uint16_t index,
                                 gyr_telescope_t *telescope);

// The apparent direction of a body of the ephemeris at an instant; of body 10 the direction from
// the Sun to the spacecraft.
gyr_error_t gyr_tables_direction(const gyr_tables_t *tables,
                                 int32_t body,
                                 int64_t at_tai_ns,
                                 gyr_direction_t *direction);

// Makes `tables` of the newest committed container, from the slots' contents alone, and names its
// slot. Reads both slots several times: once after a reset and per change of a slot, not per cycle.
// The active slot's bytes must stay until gyr_tables_unload; the other slot's may change at once.
// Where neither holds tables, gyr_slots_state says what they hold instead.
gyr_error_t gyr_slots_active(const gyr_slots_t *places, uint32_t *slot, gyr_tables_t *tables);

// Makes `tables` of one slot; where it holds none, the code is what gyr_slots_state says of it.
gyr_error_t gyr_slots_tables(const gyr_slots_t *places, uint32_t slot, gyr_tables_t *tables);

// What a slot holds.
gyr_error_t gyr_slots_state(const gyr_slots_t *places, uint32_t slot, gyr_slot_state_t *state);

// Checks a new container where it was received; on success makes `upload` its way into the slot that
// is not active. With no container in either slot, that of any spacecraft is taken.
gyr_error_t gyr_slots_admit(const gyr_slots_t *places,
                            const gyr_bytes_t *candidate,
                            int64_t now_tai_ns,
                            gyr_upload_t *upload);

// As gyr_slots_admit, for the one container of another spacecraft that the mission change order of
// GYR_MISSION_CHANGE_BYTES bytes names.
gyr_error_t gyr_slots_admit_changed(const gyr_slots_t *places,
                                    const gyr_bytes_t *candidate,
                                    const gyr_bytes_t *order_bytes,
                                    int64_t now_tai_ns,
                                    gyr_upload_t *upload);

// The slot that an upload writes; the other one stays in use meanwhile.
gyr_error_t gyr_upload_slot(const gyr_upload_t *upload, uint32_t *slot);

// The next operation of an upload, with the slots as they now read: carry it out, then ask again,
// until GYR_FLASH_DONE, with which the container is active. The operation before is read back first;
// a code that says that it failed ends the upload, as a reset does: admit the candidate again.
// Tables of the slot that is written may not be in use.
gyr_error_t gyr_upload_next(gyr_upload_t *upload,
                            const gyr_slots_t *places,
                            gyr_flash_operation_t *operation);

// Checks a rollback order of GYR_ROLLBACK_BYTES bytes; on success makes `revocation` the way to carry
// it out.
gyr_error_t gyr_slots_roll_back(const gyr_slots_t *places,
                                const gyr_bytes_t *order_bytes,
                                int64_t now_tai_ns,
                                gyr_revocation_t *revocation);

// The slot whose container a rollback revokes.
gyr_error_t gyr_revocation_slot(const gyr_revocation_t *revocation, uint32_t *slot);

// The next operation of a rollback, as gyr_upload_next. The first one programs a word of the slot that
// is returned to, which carries the rollback out; the second one a word of the slot that is left. No
// tables of either slot may be in use.
gyr_error_t gyr_revocation_next(gyr_revocation_t *revocation,
                                const gyr_slots_t *places,
                                gyr_flash_operation_t *operation);

// Begins with the first round of these tables.
gyr_error_t gyr_scrub_init(gyr_scrub_t *scrub, const gyr_tables_t *tables);

// Steps after which a flipped bit is found at the latest: two rounds.
gyr_error_t gyr_scrub_longest(const gyr_scrub_t *scrub, uint32_t *steps);

// Looks at the next 256 bytes at most; after the last the next round begins.
gyr_error_t gyr_scrub_step(gyr_scrub_t *scrub,
                           const gyr_tables_t *tables,
                           gyr_scrub_step_t *result);

// Makes a strategy of its parameters.
gyr_error_t gyr_strategy_init(gyr_strategy_t *strategy, const gyr_scan_t *parameters);

// Makes the mission's strategy, as the tables have it.
gyr_error_t gyr_strategy_of_tables(gyr_strategy_t *strategy, const gyr_tables_t *tables);

// The strategy's parameters.
gyr_error_t gyr_strategy_parameters(const gyr_strategy_t *strategy, gyr_scan_t *parameters);

// Phases and completed turns at an instant.
gyr_error_t gyr_strategy_phases(const gyr_strategy_t *strategy,
                                int64_t at_tai_ns,
                                gyr_phases_t *phases);

// The rotation from the mission boresight frame to the ecliptic at an instant.
gyr_error_t gyr_attitude(const gyr_strategy_t *strategy,
                         const gyr_tables_t *tables,
                         int64_t at_tai_ns,
                         gyr_quaternion_t *boresight);

// What a detector does on the sky at an instant; `detector` is the rotation from its frame to the
// mission boresight frame (a telescope's serves as well).
gyr_error_t gyr_sweep(const gyr_strategy_t *strategy,
                      const gyr_tables_t *tables,
                      const gyr_quaternion_t *detector,
                      int64_t at_tai_ns,
                      gyr_sweep_t *result);

// A half-wave plate's angle at an instant, in 2^-64 turn; `plate` as a telescope has it.
gyr_error_t gyr_hwp_phase(const gyr_strategy_t *strategy,
                          const gyr_rotor_t *plate,
                          int64_t at_tai_ns,
                          uint64_t *phase);

// A phase (2^-64 turn) in radians, in [-pi, pi).
double gyr_phase_rad(uint64_t phase);

// Makes a tracker that knows `strategy` at the epoch as well as the settings say.
gyr_error_t gyr_tracker_init(gyr_tracker_t *tracker,
                             const gyr_strategy_t *strategy,
                             const gyr_tracker_settings_t *settings,
                             int64_t epoch_tai_ns);

// Forgets everything and begins anew: the way out when every measurement is refused.
gyr_error_t gyr_tracker_restart(gyr_tracker_t *tracker,
                                const gyr_strategy_t *strategy,
                                int64_t epoch_tai_ns);

// Corrects the strategy by a measured attitude. `residuals` may be null; it is written where the
// measurement is accepted and where it is an outlier.
gyr_error_t gyr_tracker_update(gyr_tracker_t *tracker,
                               const gyr_tables_t *tables,
                               const gyr_measurement_t *measurement,
                               int64_t now_tai_ns,
                               gyr_residuals_t *residuals);

// The strategy as corrected by all accepted measurements.
gyr_error_t gyr_tracker_strategy(const gyr_tracker_t *tracker, gyr_strategy_t *strategy);

// How well the angles of the strategy are known at an instant.
gyr_error_t gyr_tracker_covariance(const gyr_tracker_t *tracker,
                                   int64_t at_tai_ns,
                                   gyr_covariance_t *covariance);

// How the tracker stands.
gyr_error_t gyr_tracker_status(const gyr_tracker_t *tracker, gyr_tracker_status_t *status);

// Writes the record of GYR_TRACKER_BYTES bytes to keep through a reset, for this spacecraft (the
// identity in the tables' header).
gyr_error_t gyr_tracker_save(const gyr_tracker_t *tracker,
                             uint32_t spacecraft,
                             uint8_t *bytes,
                             size_t length);

// Goes on with the same bits from a saved record, in a tracker that gyr_tracker_init or
// gyr_tracker_restart made with the same strategy as the saved one was. A refused record changes
// nothing: begin anew.
gyr_error_t gyr_tracker_resume(gyr_tracker_t *tracker,
                               uint32_t spacecraft,
                               const uint8_t *bytes,
                               size_t length);

// Makes a finder without channels on these tables.
gyr_error_t gyr_finder_init(gyr_finder_t *finder, const gyr_tables_t *tables);

// Adds a channel; its index is the number of channels before. The strategy is copied.
gyr_error_t gyr_finder_add(gyr_finder_t *finder,
                           const gyr_tables_t *tables,
                           const gyr_strategy_t *strategy,
                           const gyr_channel_t *channel);

// Searches on by a bounded amount of work, or hands out the next transit. Where a channel cannot be
// evaluated, the ephemeris' refusal is returned once; the channel stands where it was, the others go
// on in the next steps, and it is tried again when they are done.
gyr_error_t gyr_finder_step(gyr_finder_t *finder,
                            const gyr_tables_t *tables,
                            gyr_step_t *result);

// Writes the record of GYR_SEARCH_BYTES bytes to keep of a channel's search through a reset.
gyr_error_t gyr_finder_save(gyr_finder_t *finder, uint32_t channel, uint8_t *bytes, size_t length);

// Goes on with the same bits from a saved record, in a channel that gyr_finder_add made for the same
// body, field and strategy on the same tables. A refused record changes nothing: search anew.
gyr_error_t gyr_finder_resume(gyr_finder_t *finder,
                              uint32_t channel,
                              const uint8_t *bytes,
                              size_t length);

// Makes a forecast without targets on these tables.
gyr_error_t gyr_forecast_init(gyr_forecast_t *forecast, const gyr_tables_t *tables);

// Adds a target; its index is the number of targets before. The strategy is copied.
gyr_error_t gyr_forecast_add(gyr_forecast_t *forecast,
                             const gyr_tables_t *tables,
                             const gyr_strategy_t *strategy,
                             const gyr_channel_t *channel);

// Searches on by a bounded amount of work, or judges a visit by the tracker's covariance. Without a
// tracker (null) the strategy counts as known exactly.
gyr_error_t gyr_forecast_step(gyr_forecast_t *forecast,
                              const gyr_tables_t *tables,
                              const gyr_tracker_t *tracker,
                              gyr_forecast_step_t *result);

// The next visit of a target, as far as it is known: GYR_NOTHING until it is found.
gyr_error_t gyr_forecast_next(const gyr_forecast_t *forecast,
                              uint32_t target,
                              gyr_next_visit_t *visit);

// Makes a sequencer with an empty queue. It is safe until gyr_sequencer_resume.
gyr_error_t gyr_sequencer_init(gyr_sequencer_t *sequencer,
                               const gyr_sequencer_settings_t *settings);

// Moves on to the time of the on-board counter. Call it every cycle, without clock or tables too:
// the missing input makes it safe.
gyr_error_t gyr_sequencer_tick(gyr_sequencer_t *sequencer,
                               const gyr_situation_t *situation,
                               gyr_tick_t *result);

// The oldest event, taken out; GYR_NOTHING when none waits.
gyr_error_t gyr_sequencer_pop(gyr_sequencer_t *sequencer, gyr_event_t *event);

// Events lost so far because the queue was full: a full queue keeps what matters most.
gyr_error_t gyr_sequencer_lost(const gyr_sequencer_t *sequencer, gyr_lost_t *lost);

// Orders safe at the next tick.
gyr_error_t gyr_sequencer_stop(gyr_sequencer_t *sequencer);

// Orders safe to be left at the next tick that has a valid clock and valid tables.
gyr_error_t gyr_sequencer_resume(gyr_sequencer_t *sequencer);

// The oldest event, taken out, as a payload of GYR_EVENT_BYTES bytes and as gyr_sequencer_pop gives
// it; GYR_NOTHING when none waits. The clock (null where there is none) tells the event's instant.
gyr_error_t gyr_telemetry_pop(gyr_sequencer_t *sequencer,
                              const gyr_clock_t *clock,
                              uint32_t spacecraft,
                              gyr_event_t *event,
                              uint8_t *payload,
                              size_t length);

// Housekeeping as a payload of GYR_HOUSEKEEPING_BYTES bytes. The tracker's covariance is that of the
// counter's instant, or of its last measurement where the clock does not tell it.
gyr_error_t gyr_telemetry_housekeeping(const gyr_housekeeping_t *housekeeping,
                                       uint8_t *payload,
                                       size_t length);

// The primary header, GYR_PACKET_HEADER_BYTES bytes, of a telemetry packet without secondary header
// around a payload of `payload_length` bytes, 1 to 65536; the lower 14 bits of `count` count.
gyr_error_t gyr_packet_header(uint16_t apid,
                              uint16_t count,
                              size_t payload_length,
                              uint8_t *header,
                              size_t length);

// Makes a log without visits.
gyr_error_t gyr_visit_log_init(gyr_visit_log_t *log, const gyr_divisions_t *divisions);

// Counts a visit; a target's visits come in order of entry. A refused one leaves the log as it was.
gyr_error_t gyr_visit_log_record(gyr_visit_log_t *log,
                                 uint32_t target,
                                 const gyr_transit_t *transit);

// What is known of a target's visits.
gyr_error_t gyr_visit_log_get(const gyr_visit_log_t *log,
                              uint32_t target,
                              gyr_target_visits_t *visits);

// Writes the record of GYR_VISIT_BYTES bytes to keep of a target through a reset, for this spacecraft
// (the identity in the tables' header).
gyr_error_t gyr_visit_log_save(const gyr_visit_log_t *log,
                               uint32_t target,
                               uint32_t spacecraft,
                               uint8_t *bytes,
                               size_t length);

// Goes on from a saved record of the same target (index) of a log with the same divisions. A refused
// record changes nothing.
gyr_error_t gyr_visit_log_resume(gyr_visit_log_t *log,
                                 uint32_t target,
                                 uint32_t spacecraft,
                                 const uint8_t *bytes,
                                 size_t length);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* GYRFALCON_H */
