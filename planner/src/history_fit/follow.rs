//! At which rate does a phase run away, when it is known only up to whole turns.
//!
//! Phases are residuals against a model, so that the rate looked for is the model's error, within a
//! stated half-width. Method: differences of phases over ever longer lags, from the shortest in the
//! data to the whole span. At each lag every rate in the range left open is tried, the best kept by
//! the median misfit, and the next lag is four times as long, with a range of six standard errors of
//! the rate so far. Medians bear a quarter of outliers.
//!
//! Limits: a rate that fits as well as the best within the range (median misfit up to twice as
//! large) makes the data [`Ambiguous`]: rows every tau seconds cannot tell rates 2 pi / tau apart.

use super::angles::wrapped;
use std::f64::consts::TAU;

/// Most pairs of rows per lag.
const PAIRS: usize = 4096;
/// Most rates tried at one lag.
const TRIALS: f64 = 100_000.0;
/// Rates tried per turn of the longest pair.
const PER_TURN: f64 = 16.0;
/// The model's own error, rad: no misfit is taken to be smaller.
pub(super) const LEAST_MISFIT_RAD: f64 = 1e-12;

/// Another rate fits as well.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ambiguous {
    /// Lag at which the rates cannot be told apart, s.
    pub lag_s: f64,
    /// The nearest other rate, rad/s from the model's; where too many fit, the first of them.
    pub other_rate_rad_s: f64,
}

/// A phase followed over whole turns.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Followed {
    /// Its rate, rad/s.
    pub(super) rate_rad_s: f64,
    /// The phase at time zero, rad.
    pub(super) at_zero_rad: f64,
}

impl Followed {
    /// The phase nearest to the line that is `phase` up to whole turns.
    pub(super) fn unwrap(&self, time_s: f64, phase_rad: f64) -> f64 {
        let line = self.at_zero_rad + self.rate_rad_s * time_s;
        line + wrapped(phase_rad - line)
    }
}

/// Follows a phase given at rising times.
pub(super) fn follow(
    times_s: &[f64],
    phases_rad: &[f64],
    half_width_rad_s: f64,
) -> Result<Followed, Ambiguous> {
    let span = times_s.last().zip(times_s.first()).map_or(0.0, |(last, first)| last - first);
    let (mut rate, mut half) = (0.0, half_width_rad_s);
    let mut lag = shortest_lag(times_s);
    while lag > 0.0 {
        let pairs = pairs(times_s, phases_rad, lag);
        let longest = pairs.iter().map(|pair| pair.0).fold(0.0, f64::max);
        if pairs.is_empty() {
            break;
        }
        let best = search(&pairs, rate, half, longest)?;
        rate = best.rate;
        let apart = (span / longest).max(1.0);
        let few = if pairs.len() < 8 { 5.0 } else { 1.0 };
        let misfit = best.misfit.max(LEAST_MISFIT_RAD);
        half = few * 6.0 * 1.4826 * misfit / (0.5 * longest * apart.sqrt());
        let next = (4.0 * lag).max(2.0 * longest);
        lag = if next < 0.7 * span {
            next
        } else if longest < 0.35 * span {
            0.7 * span
        } else {
            break;
        };
    }
    let rest = |at: f64| {
        let phases = times_s.iter().zip(phases_rad);
        let mut rest: Vec<f64> = phases.map(|(t, phase)| wrapped(phase - rate * t - at)).collect();
        median(&mut rest)
    };
    let mean = direction(times_s.iter().zip(phases_rad).map(|(t, phase)| phase - rate * t)).0;
    Ok(Followed { rate_rad_s: rate, at_zero_rad: mean + rest(mean) })
}

/// The lag that a tenth of the neighbours are within.
fn shortest_lag(times_s: &[f64]) -> f64 {
    let mut lags: Vec<f64> =
        times_s.windows(2).map(|pair| pair[1] - pair[0]).filter(|lag| *lag > 0.0).collect();
    lags.sort_by(f64::total_cmp);
    lags.get(lags.len() / 10).copied().unwrap_or(0.0)
}

/// Differences of time and phase over this lag, or the next longer that there is, up to twice it.
fn pairs(times_s: &[f64], phases_rad: &[f64], lag: f64) -> Vec<(f64, f64)> {
    let stride = times_s.len().div_ceil(PAIRS);
    let mut pairs: Vec<(f64, f64)> = (0..times_s.len())
        .step_by(stride)
        .filter_map(|i| {
            let k = times_s.partition_point(|t| *t < times_s[i] + lag * (1.0 - 1e-9));
            Some((times_s.get(k)? - times_s[i], phases_rad.get(k)? - phases_rad[i]))
        })
        .collect();
    let shortest = pairs.iter().map(|pair| pair.0).fold(f64::INFINITY, f64::min);
    pairs.retain(|pair| pair.0 <= 2.0 * shortest);
    pairs
}

struct Candidate {
    rate: f64,
    misfit: f64,
}

/// The rate within `half` of `centre` that fits best.
fn search(
    pairs: &[(f64, f64)],
    centre: f64,
    half: f64,
    longest: f64,
) -> Result<Candidate, Ambiguous> {
    let step = TAU / (PER_TURN * longest);
    let count = (half / step).ceil();
    if count > TRIALS {
        return Err(Ambiguous { lag_s: longest, other_rate_rad_s: centre + TAU / longest });
    }
    let mut trials: Vec<(f64, f64)> = Vec::new();
    let mut offset = -count;
    while offset <= count {
        let rate = centre + offset * step;
        trials.push((rate, direction(pairs.iter().map(|(dt, d)| d - rate * dt)).1));
        offset += 1.0;
    }
    let best = trials.iter().map(|trial| trial.1).fold(0.0, f64::max);
    let mut candidates: Vec<Candidate> = Vec::new();
    for (index, (rate, score)) in trials.iter().enumerate() {
        let before = index.checked_sub(1).map_or(0.0, |before| trials[before].1);
        let after = trials.get(index + 1).map_or(0.0, |trial| trial.1);
        if *score >= before && *score >= after && *score >= 0.5 * best {
            candidates.push(refine(pairs, *rate));
        }
    }
    let least = candidates.iter().map(|it| it.misfit).fold(f64::INFINITY, f64::min);
    let good = 2.0 * least.max(LEAST_MISFIT_RAD);
    candidates.retain(|it| it.misfit <= good);
    let from_centre = |it: &Candidate| (it.rate - centre).abs();
    candidates.sort_by(|a, b| from_centre(a).total_cmp(&from_centre(b)));
    let mut candidates = candidates.into_iter();
    let Some(chosen) = candidates.next() else {
        return Ok(refine(pairs, centre));
    };
    let another = |it: &Candidate| {
        (it.rate - chosen.rate).abs() > 0.25 * TAU / longest && from_centre(it) <= half
    };
    match candidates.find(another) {
        Some(other) => Err(Ambiguous { lag_s: longest, other_rate_rad_s: other.rate }),
        None => Ok(chosen),
    }
}

/// The rate brought to the median of what is left, and the median misfit.
fn refine(pairs: &[(f64, f64)], rate: f64) -> Candidate {
    let mut rate = rate;
    for _ in 0..3 {
        let mut rest: Vec<f64> = pairs.iter().map(|(dt, d)| wrapped(d - rate * dt) / dt).collect();
        rate += median(&mut rest);
    }
    let mut rest: Vec<f64> = pairs.iter().map(|(dt, d)| wrapped(d - rate * dt).abs()).collect();
    Candidate { rate, misfit: median(&mut rest) }
}

/// Mean direction of angles, and how much they agree, in [0, 1].
fn direction(angles: impl Iterator<Item = f64>) -> (f64, f64) {
    let (mut sin, mut cos, mut count) = (0.0, 0.0, 0.0);
    for angle in angles {
        sin += angle.sin();
        cos += angle.cos();
        count += 1.0;
    }
    (sin.atan2(cos), sin.hypot(cos) / f64::max(count, 1.0))
}

/// The middle value, or the upper of the two; zero of none.
pub(super) fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A phase with this rate, wrapped, at the times.
    fn phases(times: &[f64], rate: f64) -> Vec<f64> {
        times.iter().map(|t| wrapped(rate * t + 2.0)).collect()
    }

    #[test]
    fn many_turns_are_followed_over_gaps_and_outliers() {
        let mut times: Vec<f64> = (0..500).map(|i| f64::from(i) * 60.0).collect();
        times.extend((0..500).map(|i| 5e6 + f64::from(i) * 60.0));
        for rate in [1e-3, -3e-3, 1e-9, 0.0] {
            let mut phases = phases(&times, rate);
            for (index, phase) in phases.iter_mut().enumerate() {
                let bits = u32::try_from(index * 7919 % 997).unwrap();
                *phase += 1e-5 * (f64::from(bits) / 997.0 - 0.5);
                if index % 9 == 4 {
                    *phase += 1.7;
                }
            }
            let found = follow(&times, &phases, 5e-3).unwrap();
            assert!((found.rate_rad_s - rate).abs() < 1e-11, "{rate}: {found:?}");
            let last = *times.last().unwrap();
            assert!((found.unwrap(last, 2.0 + rate * last) - 2.0 - rate * last).abs() % TAU < 1e-3);
        }
    }

    #[test]
    fn even_rows_leave_aliases_and_uneven_rows_do_not() {
        let even: Vec<f64> = (0..200).map(|i| f64::from(i) * 600.0).collect();
        let alias = TAU / 600.0;
        assert!(follow(&even, &phases(&even, 1e-3), 0.49 * alias).is_ok());
        let twofold = follow(&even, &phases(&even, 1e-3), 1.5 * alias).unwrap_err();
        assert!((twofold.lag_s - 600.0).abs() < 1e-6, "{twofold:?}");
        assert!((twofold.other_rate_rad_s.abs() - alias).abs() < 2e-3, "{twofold:?}");
        let uneven: Vec<f64> =
            (0..200).map(|i| f64::from(i) * 600.0 + f64::from(i * 37 % 101)).collect();
        let found = follow(&uneven, &phases(&uneven, 1.2 * alias), 1.5 * alias).unwrap();
        assert!((found.rate_rad_s - 1.2 * alias).abs() < 1e-10, "{found:?}");
    }
}
