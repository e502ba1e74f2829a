//! What the cross-crate tests share: exact strategies from plain numbers, and small tables.

pub mod campaign;
pub mod uplink;
pub mod attitudes;
pub mod stack;

use onboard_core::direction::MotionBounds;
use onboard_core::ephemeris::{BodyRecord, Span, table_header};
use onboard_core::phase::{Phase, Rotor, TurnRate};
use onboard_core::scan::{ScanParameters, ScanStrategy};
use onboard_core::time::{Duration, Instant};
use onboard_core::transit::{Channel, MAX_EVALUATIONS_PER_STEP, Step, Transit, TransitFinder};
use std::num::NonZeroU64;

/// The rate of one turn in `period_ns`.
///
/// # Panics
/// For a period of 2 ns or less, or beyond 292 years.
#[must_use]
pub fn turn_rate(period_ns: u64, sign: i8) -> TurnRate {
    let period = Duration::from_ns(i64::try_from(period_ns).expect("a short period"));
    let rate = TurnRate::from_period(period).expect("a slow rotation");
    if sign < 0 { rate.reversed() } else { rate }
}

/// A scanning strategy in plain numbers: angles in degrees, periods in ns, start at instant 0.
#[derive(Debug, Clone, Copy)]
pub struct Plain {
    /// Anti-Sun axis to spin axis, degrees.
    pub alpha_deg: f64,
    /// Spin axis to boresight, degrees.
    pub beta_deg: f64,
    /// Precession period, ns.
    pub precession_ns: u64,
    /// Spin period, ns.
    pub spin_ns: u64,
    /// Senses of precession and spin.
    pub signs: (i8, i8),
    /// Start phases of precession and spin, radians.
    pub phases_rad: (f64, f64),
}

impl Plain {
    /// LiteBIRD's strategy, starting at Falcons.jl's equator.
    pub const LITEBIRD: Self = Self {
        alpha_deg: 45.0,
        beta_deg: 50.0,
        precession_ns: 11_540_880_000_000,
        spin_ns: 1_200_000_000_000,
        signs: (1, 1),
        phases_rad: (0.0, std::f64::consts::PI),
    };

    /// PICO's strategy.
    pub const PICO: Self = Self {
        alpha_deg: 26.0,
        beta_deg: 69.0,
        precession_ns: 36_000_000_000_000,
        spin_ns: 60_000_000_000,
        ..Self::LITEBIRD
    };

    /// Planck's strategy.
    pub const PLANCK: Self = Self {
        alpha_deg: 7.5,
        beta_deg: 85.0,
        precession_ns: 15_778_800_000_000_000,
        spin_ns: 60_000_000_000,
        ..Self::LITEBIRD
    };

    /// The strategy, in exact phases.
    ///
    /// # Panics
    /// When the numbers are not a strategy.
    #[must_use]
    pub fn strategy(&self) -> ScanStrategy {
        let rotor = |period, sign, start| Rotor {
            rate: turn_rate(period, sign),
            start: Phase::from_radians(start),
        };
        let parameters = ScanParameters {
            start: Instant::from_tai_ns(0),
            alpha_rad: self.alpha_deg.to_radians(),
            beta_rad: self.beta_deg.to_radians(),
            precession: rotor(self.precession_ns, self.signs.0, self.phases_rad.0),
            spin: rotor(self.spin_ns, self.signs.1, self.phases_rad.1),
        };
        match ScanStrategy::new(parameters) {
            Ok(strategy) => strategy,
            Err(error) => panic!("not a strategy: {error:?}"),
        }
    }
}

/// All transits of some channels, in order; every step is held to its bound on evaluations.
///
/// # Panics
/// When a channel cannot be evaluated, or a step evaluates more often than it may.
pub fn transits(channels: &mut [Channel<'_>]) -> Vec<Transit> {
    let mut finder = TransitFinder::new(channels);
    let mut found = Vec::new();
    let made = |finder: &TransitFinder<'_, '_>| -> u64 {
        finder.channels().iter().map(Channel::evaluations).sum()
    };
    let mut before = made(&finder);
    loop {
        let step = finder.step();
        let after = made(&finder);
        assert!(after - before <= u64::from(MAX_EVALUATIONS_PER_STEP), "{}", after - before);
        before = after;
        match step {
            Step::Transit(transit) => found.push(transit),
            Step::Searched(_) => {}
            Step::Done => return found,
            Step::Failed { channel, error } => panic!("channel {channel}: {error:?}"),
        }
    }
}

/// One span of a body: granules of equal length, each a Chebyshev series.
#[derive(Debug, Clone)]
pub struct Piece {
    /// Start of the first granule, ns.
    pub start_ns: i64,
    /// Length of a granule, ns.
    pub granule_ns: u64,
    /// Series per granule.
    pub granules: Vec<Vec<[f64; 3]>>,
}

impl Piece {
    /// The span record with bounds on the motion, its coefficients at `first`.
    fn span(&self, body: i32, first: usize) -> Span {
        Span {
            body,
            coefficients: u16::try_from(self.granules[0].len()).expect("few orders"),
            granules: u32::try_from(self.granules.len()).expect("few granules"),
            first: u32::try_from(first).expect("few numbers"),
            start: Instant::from_tai_ns(self.start_ns),
            granule_ns: NonZeroU64::new(self.granule_ns).expect("a length"),
            bounds: bounds(&self.granules, self.granule_ns),
        }
    }
}

/// Sums over the series bound the motion of p: `|T_k'| <= k^2`, `|T_k''| <= k^2 (k^2 - 1) / 3`. The
/// direction `p/|p|` moves at most at `|p'|/|p|`, with `|p''|/|p| + 3 (|p'|/|p|)^2`.
fn bounds(granules: &[Vec<[f64; 3]>], granule_ns: u64) -> MotionBounds {
    let per_second = 2.0e9 / granule_ns as f64;
    let mut bounds = MotionBounds { rate_rad_s: 0.0, acceleration_per_s2: 0.0, max_abs_z: 0.0 };
    for granule in granules {
        let (mut rate, mut acceleration, mut z) = (0.0, 0.0, 0.0);
        let mut shortest = 0.0;
        for (order, c) in granule.iter().enumerate() {
            let k2 = (order * order) as f64;
            let size = (c[0] * c[0] + c[1] * c[1] + c[2] * c[2]).sqrt();
            rate += k2 * size * per_second;
            acceleration += k2 * (k2 - 1.0).max(0.0) / 3.0 * size * per_second * per_second;
            z += c[2].abs();
            shortest += if order == 0 { size } else { -size };
        }
        assert!(shortest > 0.1, "the series comes too close to zero");
        let rate = rate / shortest;
        let acceleration = acceleration / shortest + 3.0 * rate * rate;
        bounds.rate_rad_s = bounds.rate_rad_s.max(rate * 1.001);
        bounds.acceleration_per_s2 = bounds.acceleration_per_s2.max(acceleration * 1.001);
        bounds.max_abs_z = bounds.max_abs_z.max((z / shortest).min(1.0));
    }
    bounds
}

/// The bytes of a table with one body that moves on Chebyshev series given per granule.
///
/// # Panics
/// When a granule is empty or too long for the format.
#[must_use]
pub fn table(body: i32, start_ns: i64, granule_ns: u64, granules: &[Vec<[f64; 3]>]) -> Vec<u8> {
    table_of(body, &[Piece { start_ns, granule_ns, granules: granules.to_vec() }])
}

/// The bytes of a table with one body of several spans.
///
/// # Panics
/// When a granule is empty or too long for the format.
#[must_use]
pub fn table_of(body: i32, pieces: &[Piece]) -> Vec<u8> {
    let (mut records, mut numbers) = (Vec::new(), Vec::<f64>::new());
    for piece in pieces {
        records.extend(piece.span(body, numbers.len()).to_le_bytes());
        numbers.extend(piece.granules.iter().flatten().flatten());
    }
    let spans = u32::try_from(pieces.len()).expect("few spans");
    let count = u32::try_from(numbers.len()).expect("few numbers");
    let own = pieces.iter().map(|piece| bounds(&piece.granules, piece.granule_ns));
    let bounds = own.fold(MotionBounds::NONE, |largest, own| largest.and(&own));
    let mut bytes = table_header(1, spans, count).to_vec();
    bytes.extend(BodyRecord { body, spans, first: 0, bounds }.to_le_bytes());
    bytes.extend(records);
    bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
    bytes
}

/// Numbers without a pattern, the same in every run (`SplitMix64`).
#[derive(Debug, Clone)]
pub struct Noise(u64);

impl Noise {
    /// The sequence of `seed`.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// The next number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / 9_007_199_254_740_992.0
    }

    /// The next number in [-1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }
}
