//! Proof by linking: no path from any public function of `onboard-core` reaches a panic, an
//! allocator or std.
//!
//! The panic handler calls a symbol that nobody defines, there is no allocator and no std: if this
//! binary links, none of them is reachable. Arguments come through pointers of `extern "C"`
//! functions, so nothing folds away. `tests/tests/link_probe.rs` holds the list below against the
//! public functions in the source; the features seed faults that must break the link.

#![no_std]
#![no_main]

mod faults;
#[cfg(target_arch = "x86_64")]
mod memory;

use onboard_core::attitude::{Sweep, attitude, crossing_angle_rad, sweep};
use onboard_core::detector::detector_at;
use onboard_core::direction::{Direction, DirectionState, MotionBounds};
use onboard_core::ephemeris::{BodyTable, EphemerisError, EphemerisTable, SPAN_BYTES, Span};
use onboard_core::field_of_view::{FieldOfView, FieldOfViewError, FieldShape};
use onboard_core::frame::{AntiSun, Boresight, Detector, Ecliptic, Spin, Telescope};
use onboard_core::hwp::hwp_phase;
use onboard_core::phase::{Phase, Rotor, TurnRate};
use onboard_core::rotation::{Rotation, RotationError};
use onboard_core::scan::{ScanError, ScanParameters, ScanStrategy};
use onboard_core::sun::{AntiSunAxes, SunModel};
use onboard_core::time::{Duration, Instant};
use onboard_core::transit::{Channel, SearchState, Step, Transit, TransitFinder};
use onboard_core::uncertainty::ScanCovariance;
use onboard_core::uplink::{
    Container, Header, MissionError, MissionTable, PlanError, PlanTable, SESSION_BYTES,
    SectionKind, SessionRecord, SunRecord, TelescopeRecord, UplinkError, checksum,
    entry_to_le_bytes,
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
type Attitude = Rotation<Detector, Ecliptic>;

/// One `extern "C"` function per line: arguments read from pointers, the result written to one.
///
/// Large arguments are `&'static`, so that no copy of them counts as stack. A function with const
/// parameters stands twice: `name__1` at capacity 1, `name__max` at the largest.
macro_rules! probes {
    ($($name:ident ($($arg:ident: $kind:ty),*) -> $out:ty $body:block)*) => {
        $(
            #[unsafe(no_mangle)]
            unsafe extern "C" fn $name($($arg: *const $kind,)* out: *mut $out) {
                // SAFETY: never called; the pointers stand for any valid ones.
                unsafe {
                    $(let $arg = $arg.read();)*
                    out.write($body);
                }
            }
        )*

        /// Keeps every probe in the binary.
        #[unsafe(no_mangle)]
        extern "C" fn _start() -> ! {
            $(core::hint::black_box($name as *const ());)*
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
    rotation_then(a: Rotation<Detector, Boresight>, b: Rotation<Boresight, Ecliptic>) -> Attitude { a.then(b) }
    rotation_inverse(rotation: Attitude) -> Rotation<Ecliptic, Detector> { rotation.inverse() }
    rotation_apply(rotation: Attitude, direction: Direction<Detector>) -> Direction<Ecliptic> { rotation.apply(direction) }

    span_from_le_bytes(record: [u8; SPAN_BYTES]) -> Option<Span> { Span::from_le_bytes(&record) }
    span_to_le_bytes(span: Span) -> [u8; SPAN_BYTES] { span.to_le_bytes() }
    span_end(span: Span) -> Option<Instant> { span.end() }
    ephemeris_table_parse(bytes: Bytes) -> Result<EphemerisTable<'static>, EphemerisError> { EphemerisTable::parse(bytes) }
    ephemeris_table_spans(table: EphemerisTable<'static>) -> u64 { table.spans().fold(0, |sum, span| sum ^ span.granule_ns.get()) }
    ephemeris_table_body(table: EphemerisTable<'static>, body: i32) -> Result<BodyTable<'static>, EphemerisError> { table.body(body) }
    body_table_state(body: BodyTable<'static>, at: Instant) -> Result<DirectionState<Ecliptic>, EphemerisError> { body.state(at) }
    body_table_coverage(body: BodyTable<'static>) -> Option<(Instant, Instant)> { body.coverage() }
    body_table_bounds(body: BodyTable<'static>) -> MotionBounds { body.bounds() }

    sun_model_state(sun: &'static SunModel<'static>, start: Instant, at: Instant) -> Result<DirectionState<Ecliptic>, EphemerisError> { sun.state(start, at) }
    sun_model_bounds(sun: &'static SunModel<'static>) -> MotionBounds { sun.bounds() }
    anti_sun_axes_new(sun: &'static DirectionState<Ecliptic>) -> AntiSunAxes { AntiSunAxes::new(sun) }
    anti_sun_axes_view(axes: &'static AntiSunAxes, target: &'static DirectionState<Ecliptic>) -> DirectionState<AntiSun> { axes.view(target) }
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
    hwp_phase_probe(scan: &'static ScanStrategy, plate: Rotor, at: Instant) -> Phase { hwp_phase(scan, plate, at) }

    attitude_probe(scan: &'static ScanStrategy, sun: &'static SunModel<'static>, at: Instant) -> Result<Rotation<Boresight, Ecliptic>, EphemerisError> { attitude(scan, sun, at) }
    sweep_probe(scan: &'static ScanStrategy, sun: &'static SunModel<'static>, detector: Rotation<Detector, Boresight>, at: Instant) -> Result<Sweep, EphemerisError> { sweep(scan, sun, detector, at) }
    crossing_angle_rad_probe(attitude: Attitude) -> f64 { crossing_angle_rad(attitude) }

    channel_new(scan: &'static ScanStrategy, sun: &'static SunModel<'static>, target: BodyTable<'static>, field: &'static FieldOfView, span: (Instant, Instant)) -> Channel<'static> { Channel::new(scan, *sun, target, field, span) }
    channel_state(channel: &'static Channel<'static>) -> SearchState { channel.state() }
    channel_resume(channel: &'static mut Channel<'static>, state: SearchState) -> () { channel.resume(state) }
    channel_evaluations(channel: &'static Channel<'static>) -> u64 { channel.evaluations() }
    channel_frontier(channel: &'static Channel<'static>) -> Option<Instant> { channel.frontier() }
    transit_dwell(transit: Transit) -> Duration { transit.dwell() }
    transit_finder_new(channels: *mut [Channel<'static>]) -> TransitFinder<'static, 'static> { TransitFinder::new(&mut *channels) }
    transit_finder_channels(finder: *const TransitFinder<'static, 'static>) -> usize { (&*finder).channels().len() }
    transit_finder_step(finder: *mut TransitFinder<'static, 'static>) -> Step { (&mut *finder).step() }

    checksum_probe(bytes: Bytes) -> u32 { checksum(bytes) }
    entry_to_le_bytes_probe(kind: SectionKind, offset: u32, length: u32, crc: u32) -> [u8; 16] { entry_to_le_bytes(kind, offset, length, crc) }
    section_kind_number(kind: SectionKind) -> u16 { kind.number() }
    header_to_le_bytes(header: &'static Header, length: u32, sections: u16, crc: u32) -> [u8; 64] { header.to_le_bytes(length, sections, crc) }
    container_parse(bytes: Bytes) -> Result<Container<'static>, UplinkError> { Container::parse(bytes) }
    container_header(container: Container<'static>) -> Header { container.header() }
    container_section(container: Container<'static>, kind: SectionKind) -> Result<Bytes, UplinkError> { container.section(kind) }
    mission_table_parse(bytes: Bytes) -> Result<MissionTable<'static>, MissionError> { MissionTable::parse(bytes) }
    mission_table_strategy(table: &'static MissionTable<'static>) -> ScanStrategy { table.strategy() }
    mission_table_sun(mission: &'static MissionTable<'static>, table: EphemerisTable<'static>) -> Result<SunModel<'static>, EphemerisError> { mission.sun(table) }
    mission_table_telescopes(mission: &'static MissionTable<'static>) -> f64 { mission.telescopes().fold(0.0, |sum, telescope| sum + telescope.rotation.to_xyzw()[0]) }
    mission_table_fixed_to_le_bytes(parameters: &'static ScanParameters, sun: SunRecord, telescopes: u16) -> [u8; 104] { MissionTable::fixed_to_le_bytes(parameters, sun, telescopes) }
    telescope_record_to_le_bytes(telescope: &'static TelescopeRecord) -> [u8; 80] { telescope.to_le_bytes() }
    telescope_record_field_of_view(telescope: &'static TelescopeRecord) -> Result<FieldOfView, FieldOfViewError> { telescope.field_of_view() }
    session_record_to_le_bytes(session: &'static SessionRecord) -> [u8; SESSION_BYTES] { session.to_le_bytes() }
    session_record_from_le_bytes(bytes: [u8; SESSION_BYTES]) -> Option<SessionRecord> { SessionRecord::from_le_bytes(&bytes) }
    plan_table_parse(bytes: Bytes) -> Result<PlanTable<'static>, PlanError> { PlanTable::parse(bytes) }
    plan_table_sessions(plan: PlanTable<'static>) -> u64 { plan.sessions().fold(0, |sum, session| sum ^ u64::from(session.turn)) }
}
