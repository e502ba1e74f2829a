//! Proof by linking: no path from any public function of `onboard-core` reaches a panic, an
//! allocator or std.
//!
//! The panic handler calls a symbol that nobody defines, there is no allocator and no std: if this
//! binary links, none of them is reachable. Arguments come through pointers of `extern "C"`
//! functions, so nothing folds away. `tests/tests/link_probe.rs` holds the list below against the
//! public functions in the source; the features seed faults that must break the link, without the
//! probes, which say nothing about them.

#![no_std]
#![no_main]
#![cfg_attr(
    feature = "alone",
    allow(unused_imports, dead_code, reason = "the probes are left out")
)]

mod faults;
#[cfg(target_arch = "x86_64")]
mod memory;

use core::num::NonZeroU64;
use onboard_core::attitude::{Sweep, attitude, crossing_angle_rad, sweep};
use onboard_core::avoidance::{
    AvoidanceError, AvoidanceFinder, AvoidanceLimit, AvoidanceStep, Zone, angle_to_field_rad,
};
use onboard_core::clock::{CLOCK_BYTES, ClockCorrelation, ClockError};
use onboard_core::detector::detector_at;
use onboard_core::direction::{Direction, DirectionState, MotionBounds};
use onboard_core::ephemeris::{
    self, BODY_BYTES, BodyRecord, BodyTable, EphemerisError, EphemerisTable, HEADER_BYTES,
    SPAN_BYTES, Span,
};
use onboard_core::field_of_view::{FieldOfView, FieldOfViewError, FieldShape};
use onboard_core::forecast::{Forecast, ForecastStep, NextVisit};
use onboard_core::frame::{AntiSun, Boresight, Detector, Ecliptic, Icrf, Spin, Telescope};
use onboard_core::hwp::hwp_phase;
use onboard_core::phase::{Phase, Rotor, TurnRate};
use onboard_core::record::RecordError;
use onboard_core::rotation::{Rotation, RotationError};
use onboard_core::saved_visits::visits_record_bytes;
use onboard_core::scan::{ScanError, ScanParameters, ScanStrategy};
use onboard_core::sequencer::{
    Event, EventKind, EventQueue, Lost, Question, ScanEstimate, Sequencer, SessionCheck, Settings,
    SettingsError, Situation, SkipReason, Stamped, State, Tick,
};
use onboard_core::sun::{AntiSunAxes, SunModel};
use onboard_core::telemetry::{
    ClockInUse, EVENT_BYTES, EventReport, HOUSEKEEPING_BYTES, Housekeeping, Origin,
    PACKET_HEADER_BYTES, PacketError, PacketHeader, TablesInUse, TrackerHealth, VisitToCome,
};
#[cfg(not(target_os = "none"))]
use onboard_core::telemetry::{Payload, TelemetryError, payload_bytes};
use onboard_core::time::{Duration, Instant};
use onboard_core::tracking::{
    Measurement, MeasurementRefusal, Residuals, ResumeError, ScanAngles, TRACKER_BYTES, Tracker,
    TrackerSettings, TrackerSettingsError, TrackerState,
};
use onboard_core::transit::{
    Channel, Confidence, SEARCH_BYTES, SearchOrigin, SearchState, Step, Transit, TransitFinder,
};
use onboard_core::uncertainty::ScanCovariance;
use onboard_core::uplink::{
    Active, AvoidanceRecord, Container, Counts, DetectorRecord, FlashError, FlashOperation, Header,
    MISSION_CHANGE_BYTES, MissionChangeError, MissionChangeOrder, MissionError, MissionTable,
    NoTables, PlanError, PlanTable, ROLLBACK_BYTES, Revocation, RollbackError, RollbackOrder,
    RollbackRefusal, SESSION_BYTES, Scrub, ScrubProgress, ScrubStep, SectionKind, SequenceError,
    SessionRecord, SetDigest, Slot, SlotState, Slots, SunRecord, TableError, Tables,
    TelescopeRecord, UplinkError, Upload, UploadRefusal, check_sequence, checksum, committed_head,
    entry_to_le_bytes, slot_bytes,
};

use onboard_core::visits::{
    Bins, BinsError, Divisions, Histogram, HistogramBin, Spacing, TargetVisits, VisitError,
    VisitLog,
};

unsafe extern "C" {
    fn panic_is_reachable() -> !;
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    // SAFETY: nobody defines it; a binary that contains this call does not link.
    unsafe { panic_is_reachable() }
}

type Bytes = &'static [u8];
/// A queue of events larger than any flight computer would take.
const MAX_EVENTS: usize = 65_536;
type Attitude = Rotation<Detector, Ecliptic>;

/// One `extern "C"` function per line: arguments read from pointers, the result written where the
/// caller says.
///
/// Large arguments are `&'static`, so that no copy of them counts as stack. A function with const
/// parameters stands twice: `name__1` at capacity 1, `name__max` at the largest.
macro_rules! probes {
    ($($(#[$only:meta])? $name:ident ($($arg:ident: $kind:ty),*) -> $out:ty $body:block)*) => {
        $(
            #[cfg(not(feature = "alone"))]
            $(#[$only])?
            #[unsafe(no_mangle)]
            #[allow(improper_ctypes_definitions, unused_unsafe, reason = "nobody calls it from C")]
            unsafe extern "C" fn $name($($arg: *const $kind),*) -> $out {
                // SAFETY: never called; the pointers stand for any valid ones.
                unsafe {
                    $(let $arg = $arg.read();)*
                    $body
                }
            }
        )*

        /// Keeps every probe in the binary.
        #[unsafe(no_mangle)]
        extern "C" fn _start() -> ! {
            $(
                #[cfg(not(feature = "alone"))]
                $(#[$only])?
                core::hint::black_box($name as *const ());
            )*
            faults::keep();
            loop {}
        }
    };
}

probes! {
    instant_from_tai_ns(ns: i64) -> Instant { Instant::from_tai_ns(ns) }
    instant_tai_ns(at: Instant) -> i64 { at.tai_ns() }
    instant_since(at: Instant, earlier: Instant) -> Duration { at.since(earlier) }
    instant_plus(at: Instant, span: Duration) -> Instant { at.plus(span) }
    duration_from_ns(ns: i64) -> Duration { Duration::from_ns(ns) }
    duration_ns(span: Duration) -> i64 { span.ns() }
    duration_from_seconds(seconds: f64) -> Duration { Duration::from_seconds(seconds) }
    duration_from_seconds_floor(seconds: f64) -> Duration { Duration::from_seconds_floor(seconds) }
    duration_seconds(span: Duration) -> f64 { span.seconds() }

    phase_from_bits(bits: u64) -> Phase { Phase::from_bits(bits) }
    phase_bits(phase: Phase) -> u64 { phase.bits() }
    phase_from_radians(radians: f64) -> Phase { Phase::from_radians(radians) }
    phase_radians(phase: Phase) -> f64 { phase.radians() }
    phase_turns(phase: Phase) -> f64 { phase.turns() }
    phase_plus(a: Phase, b: Phase) -> Phase { a.plus(b) }
    phase_negated(phase: Phase) -> Phase { phase.negated() }
    phase_half(phase: Phase) -> Phase { phase.half() }
    phase_sin_cos(phase: Phase) -> (f64, f64) { phase.sin_cos() }
    turn_rate_from_bits(bits: u128) -> TurnRate { TurnRate::from_bits(bits) }
    turn_rate_from_turns(turns: i64, seconds: NonZeroU64) -> Option<TurnRate> { TurnRate::from_turns(turns, seconds) }
    turn_rate_from_period(period: Duration) -> Option<TurnRate> { TurnRate::from_period(period) }
    rotor_with_period(period: Duration, start: Phase) -> Option<Rotor> { Rotor::with_period(period, start) }
    scrub_new(tables: &'static Tables<'static>) -> Scrub<'static> { Scrub::new(tables) }
    scrub_longest(scrub: &'static Scrub<'static>) -> u32 { scrub.longest() }
    scrub_progress(scrub: *const Scrub<'static>) -> ScrubProgress { (&*scrub).progress() }
    scrub_step(scrub: *mut Scrub<'static>) -> ScrubStep { (&mut *scrub).step() }
    turn_rate_from_radians_per_second(rad_s: f64) -> TurnRate { TurnRate::from_radians_per_second(rad_s) }
    turn_rate_plus(a: TurnRate, b: TurnRate) -> TurnRate { a.plus(b) }
    turn_rate_bits(rate: TurnRate) -> u128 { rate.bits() }
    turn_rate_reversed(rate: TurnRate) -> TurnRate { rate.reversed() }
    turn_rate_is_negative(rate: TurnRate) -> bool { rate.is_negative() }
    turn_rate_radians_per_second(rate: TurnRate) -> f64 { rate.radians_per_second() }
    turn_rate_after(rate: TurnRate, elapsed: Duration) -> Phase { rate.after(elapsed) }
    turn_rate_completed_turns(rate: TurnRate, elapsed: Duration) -> u64 { rate.completed_turns(elapsed) }
    rotor_phase(rotor: Rotor, elapsed: Duration) -> Phase { rotor.phase(elapsed) }

    direction_new(x: f64, y: f64, z: f64) -> Option<Direction<Ecliptic>> { Direction::new(x, y, z) }
    direction_from_longitude_latitude(longitude: f64, latitude: f64) -> Direction<Ecliptic> { Direction::from_longitude_latitude(longitude, latitude) }
    direction_xyz(direction: Direction<Ecliptic>) -> [f64; 3] { direction.xyz() }
    direction_separation_rad(a: Direction<Ecliptic>, b: Direction<Ecliptic>) -> f64 { a.separation_rad(b) }
    direction_longitude_rad(direction: Direction<Ecliptic>) -> f64 { direction.longitude_rad() }
    direction_latitude_rad(direction: Direction<Ecliptic>) -> f64 { direction.latitude_rad() }

    rotation_from_xyzw(xyzw: [f64; 4]) -> Result<Attitude, RotationError> { Attitude::from_xyzw(xyzw) }
    rotation_to_xyzw(rotation: Attitude) -> [f64; 4] { rotation.to_xyzw() }
    rotation_about_x(angle: f64) -> Attitude { Attitude::about_x(angle) }
    rotation_about_y(angle: f64) -> Attitude { Attitude::about_y(angle) }
    rotation_about_z(angle: f64) -> Attitude { Attitude::about_z(angle) }
    rotation_about_z_by(phase: Phase) -> Attitude { Attitude::about_z_by(phase) }
    rotation_to_direction_with_x_north(direction: Direction<Ecliptic>) -> Attitude { Attitude::to_direction_with_x_north(direction) }
    rotation_by_obliquity() -> Rotation<Icrf, Ecliptic> { Rotation::by_obliquity() }
    rotation_then(a: Rotation<Detector, Boresight>, b: Rotation<Boresight, Ecliptic>) -> Attitude { a.then(b) }
    rotation_inverse(rotation: Attitude) -> Rotation<Ecliptic, Detector> { rotation.inverse() }
    rotation_apply(rotation: Attitude, direction: Direction<Detector>) -> Direction<Ecliptic> { rotation.apply(direction) }

    body_record_from_le_bytes(record: [u8; BODY_BYTES]) -> Option<BodyRecord> { BodyRecord::from_le_bytes(&record) }
    body_record_to_le_bytes(record: BodyRecord) -> [u8; BODY_BYTES] { record.to_le_bytes() }
    table_header(bodies: u32, spans: u32, coefficients: u32) -> [u8; HEADER_BYTES] { ephemeris::table_header(bodies, spans, coefficients) }
    motion_bounds_and(a: MotionBounds, b: MotionBounds) -> MotionBounds { a.and(&b) }
    span_from_le_bytes(record: [u8; SPAN_BYTES]) -> Option<Span> { Span::from_le_bytes(&record) }
    span_to_le_bytes(span: Span) -> [u8; SPAN_BYTES] { span.to_le_bytes() }
    span_end(span: Span) -> Option<Instant> { span.end() }
    ephemeris_table_parse(bytes: Bytes) -> Result<EphemerisTable<'static>, EphemerisError> { EphemerisTable::parse(bytes) }
    ephemeris_table_spans(table: EphemerisTable<'static>) -> u64 { table.spans().fold(0, |sum, span| sum ^ span.granule_ns.get()) }
    ephemeris_table_bodies(table: EphemerisTable<'static>) -> u32 { table.bodies().fold(0, |sum, body| sum ^ body.first) }
    ephemeris_table_body(table: EphemerisTable<'static>, body: i32) -> Result<BodyTable<'static>, EphemerisError> { table.body(body) }
    body_table_state(body: BodyTable<'static>, at: Instant) -> Result<DirectionState<Ecliptic>, EphemerisError> { body.state(at) }
    body_table_coverage(body: BodyTable<'static>) -> Option<(Instant, Instant)> { body.coverage() }
    body_table_bounds(body: BodyTable<'static>) -> MotionBounds { body.bounds() }

    sun_model_state(sun: &'static SunModel<'static>, start: Instant, at: Instant) -> Result<DirectionState<Ecliptic>, EphemerisError> { sun.state(start, at) }
    sun_model_bounds(sun: &'static SunModel<'static>) -> MotionBounds { sun.bounds() }
    anti_sun_axes_new(sun: &'static DirectionState<Ecliptic>) -> AntiSunAxes { AntiSunAxes::new(sun) }
    anti_sun_axes_in_anti_sun(axes: &'static AntiSunAxes, target: &'static DirectionState<Ecliptic>) -> DirectionState<AntiSun> { axes.in_anti_sun(target) }
    anti_sun_axes_angular_velocity_rad_s(axes: &'static AntiSunAxes) -> [f64; 3] { axes.angular_velocity_rad_s() }
    anti_sun_axes_rotation(axes: &'static AntiSunAxes) -> Rotation<AntiSun, Ecliptic> { axes.rotation() }

    scan_strategy_new(parameters: &'static ScanParameters) -> Result<ScanStrategy, ScanError> { ScanStrategy::new(*parameters) }
    scan_strategy_parameters(scan: &'static ScanStrategy) -> ScanParameters { *scan.parameters() }
    scan_strategy_elapsed(scan: &'static ScanStrategy, at: Instant) -> Duration { scan.elapsed(at) }
    scan_strategy_phases(scan: &'static ScanStrategy, at: Instant) -> (Phase, Phase) { scan.phases(at) }
    scan_strategy_turns(scan: &'static ScanStrategy, at: Instant) -> (u64, u64) { scan.turns(at) }
    scan_strategy_boresight_in_spin(scan: &'static ScanStrategy) -> Rotation<Boresight, Spin> { scan.boresight_in_spin() }
    scan_strategy_spin_in_anti_sun(scan: &'static ScanStrategy, at: Instant) -> Rotation<Spin, AntiSun> { scan.spin_in_anti_sun(at) }
    scan_covariance_along(covariance: ScanCovariance, gradient: [f64; 3]) -> f64 { covariance.along(gradient) }

    detector_at_probe(r: f64, a: f64, g: f64) -> Rotation<Detector, Boresight> { detector_at(r, a, g) }
    field_of_view_new(frame: Rotation<Telescope, Boresight>, shape: FieldShape) -> Result<FieldOfView, FieldOfViewError> { FieldOfView::new(frame, shape) }
    field_of_view_shape(field: &'static FieldOfView) -> FieldShape { field.shape() }
    field_of_view_circle(frame: Rotation<Telescope, Boresight>, radius: f64) -> Result<FieldOfView, FieldOfViewError> { FieldOfView::circle(frame, radius) }
    field_of_view_rectangle(frame: Rotation<Telescope, Boresight>, width: f64, height: f64) -> Result<FieldOfView, FieldOfViewError> { FieldOfView::rectangle(frame, width, height) }
    field_of_view_centre(field: &'static FieldOfView) -> Direction<Boresight> { field.centre() }
    field_of_view_reach_rad(field: &'static FieldOfView) -> f64 { field.reach_rad() }
    field_of_view_contains(field: &'static FieldOfView, direction: Direction<Boresight>) -> bool { field.contains(direction) }
    field_of_view_enlarged(field: FieldOfView, margin: f64) -> Option<FieldOfView> { field.enlarged(margin) }
    field_of_view_margin_rad(field: FieldOfView) -> f64 { field.margin_rad() }
    field_of_view_angle_to_rad(field: FieldOfView, direction: Direction<Boresight>) -> f64 { field.angle_to_rad(direction) }
    hwp_phase_probe(scan: &'static ScanStrategy, plate: Rotor, at: Instant) -> Phase { hwp_phase(scan, plate, at) }

    attitude_probe(scan: &'static ScanStrategy, sun: &'static SunModel<'static>, at: Instant) -> Result<Rotation<Boresight, Ecliptic>, EphemerisError> { attitude(scan, sun, at) }
    sweep_probe(scan: &'static ScanStrategy, sun: &'static SunModel<'static>, detector: Rotation<Detector, Boresight>, at: Instant) -> Result<Sweep, EphemerisError> { sweep(scan, sun, detector, at) }
    crossing_angle_rad_probe(attitude: Attitude) -> f64 { crossing_angle_rad(attitude) }

    scan_angles_measured(attitude: Rotation<Boresight, Ecliptic>, scan: ScanStrategy, sun: SunModel<'static>, at: Instant) -> Result<ScanAngles, EphemerisError> { ScanAngles::measured(attitude, &scan, &sun, at) }
    scan_angles_of(rotation: Rotation<Spin, AntiSun>) -> ScanAngles { ScanAngles::of(rotation) }
    scan_angles_modelled(scan: ScanStrategy, at: Instant) -> ScanAngles { ScanAngles::modelled(&scan, at) }
    scan_angles_minus(angles: ScanAngles, model: ScanAngles) -> [f64; 3] { angles.minus(&model) }
    tracker_settings_check(settings: TrackerSettings) -> Result<(), TrackerSettingsError> { settings.check() }
    tracker_new(scan: *const ScanStrategy, settings: *const TrackerSettings, epoch: Instant) -> Result<Tracker, TrackerSettingsError> { Tracker::new(&*scan, &*settings, epoch) }
    tracker_restart(tracker: *mut Tracker, scan: *const ScanStrategy, epoch: Instant) -> () { (&mut *tracker).restart(&*scan, epoch) }
    tracker_state(tracker: *const Tracker) -> TrackerState { (&*tracker).state() }
    tracker_state_to_le_bytes(state: *const TrackerState, spacecraft: u32) -> [u8; TRACKER_BYTES] { (&*state).to_le_bytes(spacecraft) }
    tracker_state_from_le_bytes(record: &'static [u8; TRACKER_BYTES], spacecraft: u32) -> Result<TrackerState, RecordError> { TrackerState::from_le_bytes(record, spacecraft) }
    tracker_resume(tracker: *mut Tracker, state: *const TrackerState) -> Result<(), ResumeError> { (&mut *tracker).resume(&*state) }
    tracker_strategy(tracker: *const Tracker) -> ScanStrategy { *(&*tracker).strategy() }
    tracker_epoch(tracker: *const Tracker) -> Instant { (&*tracker).epoch() }
    tracker_accepted(tracker: *const Tracker) -> u32 { (&*tracker).accepted() }
    tracker_refused_in_a_row(tracker: *const Tracker) -> u32 { (&*tracker).refused_in_a_row() }
    tracker_covariance_at(tracker: *const Tracker, at: Instant) -> ScanCovariance { (&*tracker).covariance_at(at) }
    tracker_rate_sigmas_rad_s(tracker: *const Tracker) -> [f64; 2] { (&*tracker).rate_sigmas_rad_s() }
    tracker_update(tracker: &'static mut Tracker, sun: &'static SunModel<'static>, measurement: &'static Measurement, now: Instant) -> Result<Residuals, MeasurementRefusal> { tracker.update(sun, measurement, now) }

    channel_new(scan: &'static ScanStrategy, sun: &'static SunModel<'static>, target: BodyTable<'static>, field: &'static FieldOfView, span: (Instant, Instant)) -> Channel<'static> { Channel::new(scan, *sun, target, field, span) }
    channel_state(channel: &'static Channel<'static>) -> SearchState { channel.state() }
    search_origin_new(header: &'static Header, set_digest: u64, scan: &'static ScanStrategy, field: &'static FieldOfView, body: i32) -> SearchOrigin { SearchOrigin::new(header, set_digest, scan, field, body) }
    search_state_to_le_bytes(state: *const SearchState, of: SearchOrigin) -> [u8; SEARCH_BYTES] { (&*state).to_le_bytes(&of) }
    search_state_from_le_bytes(record: &'static [u8; SEARCH_BYTES], of: SearchOrigin) -> Result<SearchState, RecordError> { SearchState::from_le_bytes(record, &of) }
    channel_resume(channel: &'static mut Channel<'static>, state: &'static SearchState) -> () { channel.resume(*state) }
    channel_evaluations(channel: &'static Channel<'static>) -> u64 { channel.evaluations() }
    channel_frontier(channel: &'static Channel<'static>) -> Option<Instant> { channel.frontier() }
    transit_dwell(transit: Transit) -> Duration { transit.dwell() }
    transit_finder_new(channels: *mut [Channel<'static>]) -> TransitFinder<'static, 'static> { TransitFinder::new(&mut *channels) }
    transit_finder_resume(channels: *mut [Channel<'static>]) -> TransitFinder<'static, 'static> { TransitFinder::resume(&mut *channels) }
    transit_finder_channels(finder: *const TransitFinder<'static, 'static>) -> usize { (&*finder).channels().len() }
    transit_finder_step(finder: *mut TransitFinder<'static, 'static>) -> Step { (&mut *finder).step() }

    channel_confidence(channel: *const Channel<'static>, transit: Transit, covariance: ScanCovariance) -> Result<Confidence, EphemerisError> { (&*channel).confidence(&transit, &covariance) }

    angle_to_field_rad_probe(field: FieldOfView, direction: Direction<Boresight>) -> f64 { angle_to_field_rad(&field, direction) }
    avoidance_limit_new(body: i32, angle: f64) -> Result<AvoidanceLimit, AvoidanceError> { AvoidanceLimit::new(body, angle) }
    avoidance_limit_body(limit: AvoidanceLimit) -> i32 { limit.body() }
    avoidance_limit_angle_rad(limit: AvoidanceLimit) -> f64 { limit.angle_rad() }
    avoidance_limit_zone(limit: AvoidanceLimit, field: FieldOfView) -> Zone { limit.zone(&field) }
    avoidance_limit_is_violated(limit: AvoidanceLimit, field: FieldOfView, direction: Direction<Boresight>) -> bool { limit.is_violated(&field, direction) }
    avoidance_finder_new(channels: *mut [Channel<'static>]) -> AvoidanceFinder<'static, 'static> { AvoidanceFinder::new(&mut *channels) }
    avoidance_finder_channels(finder: *const AvoidanceFinder<'static, 'static>) -> usize { (&*finder).channels().len() }
    avoidance_finder_step(finder: *mut AvoidanceFinder<'static, 'static>) -> AvoidanceStep { (&mut *finder).step() }

    bins_new(spacing: Spacing, low: f64, high: f64) -> Result<Bins, BinsError> { Bins::new(spacing, low, high) }
    bins_edge_s(bins: Bins, index: usize, count: usize) -> f64 { bins.edge_s(index, count) }
    bins_bin(bins: Bins, seconds: f64, count: usize) -> HistogramBin { bins.bin(seconds, count) }
    visits_record_bytes_probe(bins: usize) -> usize { visits_record_bytes(bins) }
    target_visits_to_record__1(visits: &'static TargetVisits<1>, divisions: &'static Divisions, target: u32, spacecraft: u32, record: *mut [u8]) -> Result<(), RecordError> { visits.to_record(divisions, target, spacecraft, &mut *record) }
    target_visits_to_record__max(visits: &'static TargetVisits<64>, divisions: &'static Divisions, target: u32, spacecraft: u32, record: *mut [u8]) -> Result<(), RecordError> { visits.to_record(divisions, target, spacecraft, &mut *record) }
    target_visits_from_record__1(record: Bytes, divisions: &'static Divisions, target: u32, spacecraft: u32) -> Result<TargetVisits<1>, RecordError> { TargetVisits::from_record(record, divisions, target, spacecraft) }
    target_visits_from_record__max(record: Bytes, divisions: &'static Divisions, target: u32, spacecraft: u32) -> Result<TargetVisits<64>, RecordError> { TargetVisits::from_record(record, divisions, target, spacecraft) }
    histogram_total__1(histogram: &'static Histogram<1>) -> u32 { histogram.total() }
    histogram_total__max(histogram: &'static Histogram<64>) -> u32 { histogram.total() }
    visit_log_new__1(divisions: &'static Divisions, targets: *mut [TargetVisits<1>]) -> VisitLog<'static, 1> { VisitLog::new(divisions, &mut *targets) }
    visit_log_new__max(divisions: &'static Divisions, targets: *mut [TargetVisits<64>]) -> VisitLog<'static, 64> { VisitLog::new(divisions, &mut *targets) }
    visit_log_record__1(log: &'static mut VisitLog<'static, 1>, target: usize, transit: &'static Transit) -> Result<(), VisitError> { log.record(target, transit) }
    visit_log_record__max(log: &'static mut VisitLog<'static, 64>, target: usize, transit: &'static Transit) -> Result<(), VisitError> { log.record(target, transit) }
    visit_log_targets__1(log: &'static VisitLog<'static, 1>) -> usize { log.targets().len() }
    visit_log_targets__max(log: &'static VisitLog<'static, 64>) -> usize { log.targets().len() }
    visit_log_divisions__1(log: &'static VisitLog<'static, 1>) -> Divisions { *log.divisions() }
    visit_log_divisions__max(log: &'static VisitLog<'static, 64>) -> Divisions { *log.divisions() }

    forecast_new(channels: *mut [Channel<'static>], next: *mut [Option<NextVisit>]) -> Forecast<'static, 'static, 'static> { Forecast::new(&mut *channels, &mut *next) }
    forecast_resume(channels: *mut [Channel<'static>], next: *mut [Option<NextVisit>], waiting: Option<Transit>) -> Forecast<'static, 'static, 'static> { Forecast::resume(&mut *channels, &mut *next, waiting) }
    forecast_waiting(forecast: &'static Forecast<'static, 'static, 'static>) -> Option<Transit> { forecast.waiting() }
    forecast_next(forecast: &'static Forecast<'static, 'static, 'static>) -> usize { forecast.next().len() }
    forecast_step(forecast: &'static mut Forecast<'static, 'static, 'static>, covariance: &'static ScanCovariance) -> ForecastStep { forecast.step(|_| *covariance) }

    checksum_probe(bytes: Bytes) -> u32 { checksum(bytes) }
    entry_to_le_bytes_probe(kind: SectionKind, offset: u32, length: u32, crc: u32) -> [u8; 16] { entry_to_le_bytes(kind, offset, length, crc) }
    section_kind_number(kind: SectionKind) -> u16 { kind.number() }
    header_to_le_bytes(header: &'static Header, length: u32, sections: u16, crc: u32) -> [u8; 64] { header.to_le_bytes(length, sections, crc) }
    container_parse(bytes: Bytes) -> Result<Container<'static>, UplinkError> { Container::parse(bytes) }
    container_header(container: Container<'static>) -> Header { container.header() }
    container_set_digest(container: Container<'static>) -> u64 { container.set_digest() }
    set_digest_new() -> SetDigest { SetDigest::new() }
    set_digest_update(digest: *mut SetDigest, contents: Bytes) -> () { (&mut *digest).update(contents) }
    set_digest_value(digest: SetDigest) -> u64 { digest.value() }
    container_section(container: Container<'static>, kind: SectionKind) -> Result<Bytes, UplinkError> { container.section(kind) }
    mission_table_parse(bytes: Bytes) -> Result<MissionTable<'static>, MissionError> { MissionTable::parse(bytes) }
    mission_table_strategy(table: *const MissionTable<'static>) -> ScanStrategy { (&*table).strategy() }
    mission_table_detector_radius_rad(table: *const MissionTable<'static>) -> f64 { (&*table).detector_radius_rad() }
    mission_table_sun_record(table: *const MissionTable<'static>) -> SunRecord { (&*table).sun_record() }
    mission_table_telescope(table: *const MissionTable<'static>, index: u16) -> Option<TelescopeRecord> { (&*table).telescope(index) }
    mission_table_detectors(table: *const MissionTable<'static>) -> u64 { (&*table).detectors().fold(0, |sum, detector| sum ^ u64::from(detector.telescope)) }
    mission_table_calibration_field(table: *const MissionTable<'static>, telescope: u16, index: u16) -> Option<FieldOfView> { (&*table).calibration_field(telescope, index) }
    mission_table_avoidance(table: *const MissionTable<'static>) -> f64 { (&*table).avoidance().fold(0.0, |sum, limit| sum + limit.angle_rad) }
    mission_table_avoidance_limit(table: *const MissionTable<'static>, index: u16) -> Option<AvoidanceRecord> { (&*table).avoidance_limit(index) }
    mission_table_sun(mission: &'static MissionTable<'static>, table: EphemerisTable<'static>) -> Result<SunModel<'static>, EphemerisError> { mission.sun(table) }
    mission_table_telescopes(mission: &'static MissionTable<'static>) -> f64 { mission.telescopes().fold(0.0, |sum, telescope| sum + telescope.rotation.to_xyzw()[0]) }
    mission_table_fixed_to_le_bytes(parameters: &'static ScanParameters, sun: SunRecord, counts: Counts, radius: f64) -> [u8; 112] { MissionTable::fixed_to_le_bytes(parameters, sun, counts, radius) }
    telescope_record_to_le_bytes(telescope: &'static TelescopeRecord) -> [u8; 80] { telescope.to_le_bytes() }
    telescope_record_field_of_view(telescope: &'static TelescopeRecord) -> Result<FieldOfView, FieldOfViewError> { telescope.field_of_view() }
    detector_record_to_le_bytes(detector: DetectorRecord) -> [u8; 40] { detector.to_le_bytes() }
    avoidance_record_to_le_bytes(limit: AvoidanceRecord) -> [u8; 16] { limit.to_le_bytes() }
    session_record_to_le_bytes(session: &'static SessionRecord) -> [u8; SESSION_BYTES] { session.to_le_bytes() }
    session_record_from_le_bytes(bytes: [u8; SESSION_BYTES]) -> Option<SessionRecord> { SessionRecord::from_le_bytes(&bytes) }
    plan_table_parse(bytes: Bytes) -> Result<PlanTable<'static>, PlanError> { PlanTable::parse(bytes) }
    plan_table_sessions(plan: PlanTable<'static>) -> u64 { plan.sessions().fold(0, |sum, session| sum ^ u64::from(session.turn)) }
    plan_table_session(plan: PlanTable<'static>, index: u32) -> Option<SessionRecord> { plan.session(index) }
    plan_table_first_from(plan: PlanTable<'static>, at: Instant) -> u32 { plan.first_from(at) }

    tables_load(bytes: Bytes) -> Result<Tables<'static>, TableError> { Tables::load(bytes) }
    tables_header(tables: *const Tables<'static>) -> Header { *(&*tables).header() }
    tables_set_digest(tables: *const Tables<'static>) -> u64 { (&*tables).set_digest() }
    tables_ephemeris(tables: *const Tables<'static>) -> EphemerisTable<'static> { (&*tables).ephemeris() }
    tables_mission(tables: *const Tables<'static>) -> ScanStrategy { (&*tables).mission().strategy() }
    tables_plan(tables: *const Tables<'static>) -> PlanTable<'static> { (&*tables).plan() }
    tables_sun(tables: *const Tables<'static>) -> Result<SunModel<'static>, EphemerisError> { (&*tables).sun() }
    slot_other(slot: Slot) -> Slot { slot.other() }
    slot_bytes_probe(container: usize) -> Option<usize> { slot_bytes(container) }
    committed_head_probe(container: Container<'static>) -> [u8; 512] { committed_head(&container) }
    slots_bytes(slots: Slots<'static>, slot: Slot) -> Bytes { slots.bytes(slot) }
    slots_state(slots: &'static Slots<'static>, slot: Slot) -> SlotState { slots.state(slot) }
    slots_tables(slots: &'static Slots<'static>, slot: Slot) -> Result<Tables<'static>, SlotState> { slots.tables(slot) }
    slots_active(slots: &'static Slots<'static>) -> Result<Active<'static>, NoTables> { slots.active() }
    slots_admit(slots: &'static Slots<'static>, candidate: Bytes, now: Instant) -> Result<Upload<'static>, UploadRefusal> { slots.admit(candidate, now) }
    slots_admit_changed(slots: &'static Slots<'static>, candidate: Bytes, order: &'static MissionChangeOrder, now: Instant) -> Result<Upload<'static>, UploadRefusal> { slots.admit_changed(candidate, order, now) }
    slots_roll_back(slots: &'static Slots<'static>, order: &'static RollbackOrder, now: Instant) -> Result<Revocation, RollbackRefusal> { slots.roll_back(order, now) }
    upload_slot(upload: *const Upload<'static>) -> Slot { (&*upload).slot() }
    upload_next(upload: *mut Upload<'static>, slots: &'static Slots<'static>) -> Result<Option<FlashOperation>, FlashError> { (&mut *upload).next(slots) }
    revocation_slot(revocation: *const Revocation) -> Slot { (&*revocation).slot() }
    revocation_next(revocation: *mut Revocation, slots: &'static Slots<'static>) -> Result<Option<FlashOperation>, FlashError> { (&mut *revocation).next(slots) }
    check_sequence_probe(candidate: u32, newest: Option<u32>) -> Result<(), SequenceError> { check_sequence(candidate, newest) }
    mission_change_order_from_le_bytes(bytes: [u8; MISSION_CHANGE_BYTES]) -> Result<MissionChangeOrder, MissionChangeError> { MissionChangeOrder::from_le_bytes(&bytes) }
    mission_change_order_to_le_bytes(order: MissionChangeOrder) -> [u8; MISSION_CHANGE_BYTES] { order.to_le_bytes() }
    rollback_order_from_le_bytes(bytes: [u8; ROLLBACK_BYTES]) -> Result<RollbackOrder, RollbackError> { RollbackOrder::from_le_bytes(&bytes) }
    rollback_order_to_le_bytes(order: RollbackOrder) -> [u8; ROLLBACK_BYTES] { order.to_le_bytes() }

    clock_correlation_from_le_bytes(bytes: [u8; CLOCK_BYTES]) -> Result<ClockCorrelation, ClockError> { ClockCorrelation::from_le_bytes(&bytes) }
    clock_correlation_to_le_bytes(clock: ClockCorrelation) -> [u8; CLOCK_BYTES] { clock.to_le_bytes() }
    origin_new(spacecraft: u32, telescope: u16, ticks: u64, clock: *const ClockCorrelation) -> Origin { Origin::new(spacecraft, telescope, ticks, Some(&*clock)) }
    event_report_new(stamped: *const Stamped, spacecraft: u32, telescope: u16, clock: *const ClockCorrelation) -> EventReport { EventReport::new(&*stamped, spacecraft, telescope, Some(&*clock)) }
    event_report_to_be_bytes(report: *const EventReport) -> [u8; EVENT_BYTES] { (&*report).to_be_bytes() }
    tables_in_use_of(tables: *const Tables<'static>) -> TablesInUse { TablesInUse::of(&*tables) }
    clock_in_use_of(clock: *const ClockCorrelation) -> ClockInUse { ClockInUse::of(&*clock) }
    tracker_health_of(tracker: *const Tracker, at: Instant) -> TrackerHealth { TrackerHealth::of(&*tracker, at) }
    visit_to_come_of(next: *const NextVisit, body: i32) -> VisitToCome { VisitToCome::of(&*next, body) }
    housekeeping_to_be_bytes(report: *const Housekeeping) -> [u8; HOUSEKEEPING_BYTES] { (&*report).to_be_bytes() }
    packet_header_to_be_bytes(header: PacketHeader) -> [u8; PACKET_HEADER_BYTES] { header.to_be_bytes() }
    packet_header_from_be_bytes(bytes: [u8; PACKET_HEADER_BYTES]) -> Result<PacketHeader, PacketError> { PacketHeader::from_be_bytes(bytes) }
    #[cfg(not(target_os = "none"))]
    payload_bytes_probe(kind: u8) -> Option<usize> { payload_bytes(kind) }
    #[cfg(not(target_os = "none"))]
    payload_from_be_bytes(bytes: Bytes) -> Result<Payload, TelemetryError> { Payload::from_be_bytes(bytes) }
    #[cfg(not(target_os = "none"))]
    payload_origin(payload: *const Payload) -> Origin { *(&*payload).origin() }

    clock_correlation_replacing(clock: ClockCorrelation, active: *const ClockCorrelation, spacecraft: u32) -> Result<ClockCorrelation, ClockError> { clock.replacing(Some(&*active), spacecraft) }
    clock_correlation_instant(clock: *const ClockCorrelation, ticks: u64) -> Result<Instant, ClockError> { (&*clock).instant(ticks) }
    clock_correlation_tick_of(ns: u64, fraction: u64) -> u128 { ClockCorrelation::tick_of(ns, fraction) }

    event_queue_new__1() -> EventQueue<1> { EventQueue::new() }
    event_queue_new__max() -> EventQueue<MAX_EVENTS> { EventQueue::new() }
    event_queue_pop__1(queue: *mut EventQueue<1>) -> Option<Stamped> { (&mut *queue).pop() }
    event_queue_pop__max(queue: *mut EventQueue<MAX_EVENTS>) -> Option<Stamped> { (&mut *queue).pop() }
    event_queue_push__1(queue: *mut EventQueue<1>, stamped: *const Stamped) -> () { (&mut *queue).push(*stamped) }
    event_queue_push__max(queue: *mut EventQueue<MAX_EVENTS>, stamped: *const Stamped) -> () { (&mut *queue).push(*stamped) }
    event_queue_lost__1(queue: *const EventQueue<1>) -> Lost { (&*queue).lost() }
    event_queue_lost__max(queue: *const EventQueue<MAX_EVENTS>) -> Lost { (&*queue).lost() }
    event_kind(event: *const Event) -> EventKind { (&*event).kind() }
    event_kind_rank(kind: EventKind) -> u8 { kind.rank() }
    lost_total(lost: Lost) -> u32 { lost.total() }
    scan_estimate_strategy(scan: *const ScanEstimate<'static>) -> Option<&'static ScanStrategy> { (&*scan).strategy() }
    scan_estimate_covariance_at(scan: *const ScanEstimate<'static>, at: Instant) -> ScanCovariance { (&*scan).covariance_at(at) }
    session_check_reset(check: *mut SessionCheck) -> () { (&mut *check).reset() }
    session_check_start(check: *mut SessionCheck, strategy: *const ScanStrategy) -> () { (&mut *check).start(&*strategy) }
    session_check_start_with_avoidance(check: *mut SessionCheck, strategy: *const ScanStrategy) -> () { (&mut *check).start_with_avoidance(&*strategy) }
    session_check_is_waiting(check: *const SessionCheck) -> bool { (&*check).is_waiting() }
    session_check_strategy(check: *const SessionCheck) -> &'static ScanStrategy { (&*check).strategy() }
    session_check_verdict(check: *const SessionCheck) -> Option<Result<(), SkipReason>> { (&*check).verdict() }
    session_check_pieces(check: *const SessionCheck) -> u32 { (&*check).pieces() }
    session_check_uncertainty(check: *const SessionCheck, scan: *const ScanEstimate<'static>) -> Duration { (&*check).uncertainty(&*scan) }
    session_check_advance(check: *mut SessionCheck, question: *const Question<'static, 'static>, steps: u16) -> u32 { (&mut *check).advance(&*question, steps) }
    sequencer_new(settings: Settings) -> Result<Sequencer, SettingsError> { Sequencer::new(settings) }
    sequencer_state(sequencer: *const Sequencer) -> State { (&*sequencer).state() }
    sequencer_stop(sequencer: *mut Sequencer) -> () { (&mut *sequencer).stop() }
    sequencer_resume(sequencer: *mut Sequencer) -> () { (&mut *sequencer).resume() }
    sequencer_tick__1(sequencer: *mut Sequencer, situation: *const Situation<'static, 'static>, queue: *mut EventQueue<1>) -> Tick { (&mut *sequencer).tick(&*situation, &mut *queue) }
    sequencer_tick__max(sequencer: *mut Sequencer, situation: *const Situation<'static, 'static>, queue: *mut EventQueue<MAX_EVENTS>) -> Tick { (&mut *sequencer).tick(&*situation, &mut *queue) }
}
