//! What a map says in a few numbers.
//!
//! `sigma_hits` is the standard deviation of hits over all pixels with `N_pix - 1` in the denominator
//! [Takase2024, section 3.1]; normalised, it is divided by the mean. Of each moment the mean of
//! `|h|^2` over the sky (where every pixel is observed) and over observed pixels, and its standard
//! deviation over observed pixels, again with one less than their number.
//!
//! Method: sums of hits are exact integers; others are added in a fixed order.

use super::maps::SurveyMaps;
use super::moment::Moment;
use rayon::prelude::*;

/// Numbers of a survey's map.
#[derive(Debug, Clone, PartialEq)]
pub struct SurveyStatistics {
    /// Samples in the map.
    pub samples: u64,
    /// Mean hits per pixel of the sky.
    pub mean_hits: f64,
    /// Standard deviation of hits.
    pub sigma_hits: f64,
    /// The same over the mean; 0 for an empty map.
    pub sigma_hits_normalised: f64,
    /// Fewest and most hits of a pixel.
    pub range: (u64, u64),
    /// Pixels without a sample.
    pub unobserved_pixels: u64,
    /// Per moment, in the order asked for.
    pub moments: Vec<MomentStatistics>,
}

/// Numbers of `|h|^2` of one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MomentStatistics {
    /// Which.
    pub moment: Moment,
    /// Mean over the sky; `None` where a pixel is unobserved.
    pub mean: Option<f64>,
    /// Mean over observed pixels; `None` for an empty map.
    pub mean_observed: Option<f64>,
    /// Standard deviation over observed pixels; `None` for fewer than two.
    pub std: Option<f64>,
}

/// Pixels that are added at a time, in their order.
const CHUNK: u32 = 1 << 14;

impl SurveyStatistics {
    /// Of a survey's maps.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "quotients of rounded numbers")]
    pub fn of(maps: &SurveyMaps) -> Self {
        let pixels = maps.nside().pixels();
        let chunks: Vec<(u32, u32)> = (0..pixels.div_ceil(CHUNK))
            .map(|chunk| (chunk * CHUNK, ((chunk + 1) * CHUNK).min(pixels)))
            .collect();
        let hits = chunks
            .par_iter()
            .map(|&(from, to)| {
                (from..to).map(|pixel| maps.hits(pixel)).fold(Hits::EMPTY, Hits::with)
            })
            .reduce(|| Hits::EMPTY, Hits::joined);
        let count = f64::from(pixels);
        let mean_hits = hits.sum as f64 / count;
        // N sum h^2 - (sum h)^2, exact.
        let spread = u128::from(pixels) * hits.squares - u128::from(hits.sum).pow(2);
        let sigma_hits = (spread as f64 / (count * (count - 1.0))).sqrt();
        let observed = u64::from(pixels) - hits.empty;
        let moments = maps
            .moments()
            .iter()
            .enumerate()
            .map(|(index, &moment)| {
                let sum = |term: &(dyn Fn(f64) -> f64 + Sync)| -> f64 {
                    let sums: Vec<f64> = chunks
                        .par_iter()
                        .map(|&(from, to)| {
                            (from..to)
                                .filter_map(|pixel| maps.h(pixel, index))
                                .map(|(re, im)| term(re * re + im * im))
                                .sum()
                        })
                        .collect();
                    sums.iter().sum()
                };
                let mean = (observed > 0).then(|| sum(&|square| square) / observed as f64);
                let std = mean.filter(|_| observed > 1).map(|mean| {
                    (sum(&|square| (square - mean).powi(2)) / (observed - 1) as f64).sqrt()
                });
                MomentStatistics {
                    moment,
                    mean: mean.filter(|_| hits.empty == 0),
                    mean_observed: mean,
                    std,
                }
            })
            .collect();
        Self {
            samples: hits.sum,
            mean_hits,
            sigma_hits,
            sigma_hits_normalised: if hits.sum > 0 { sigma_hits / mean_hits } else { 0.0 },
            range: (hits.fewest, hits.most),
            unobserved_pixels: hits.empty,
            moments,
        }
    }
}

/// Sums over hits of pixels.
#[derive(Debug, Clone, Copy)]
struct Hits {
    sum: u64,
    squares: u128,
    fewest: u64,
    most: u64,
    empty: u64,
}

impl Hits {
    const EMPTY: Self = Self { sum: 0, squares: 0, fewest: u64::MAX, most: 0, empty: 0 };

    fn with(self, hits: u64) -> Self {
        self.joined(Self {
            sum: hits,
            squares: u128::from(hits).pow(2),
            fewest: hits,
            most: hits,
            empty: u64::from(hits == 0),
        })
    }

    fn joined(self, other: Self) -> Self {
        Self {
            sum: self.sum + other.sum,
            squares: self.squares + other.squares,
            fewest: self.fewest.min(other.fewest),
            most: self.most.max(other.most),
            empty: self.empty + other.empty,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::healpix::Nside;
    use crate::survey::frame::MapFrame;
    use crate::survey::sampled::Pixels;
    use crate::survey::sums::{Sums, steps};

    fn pixels(nside: u32) -> Pixels {
        Pixels { nside: Nside::new(nside).unwrap(), frame: MapFrame::Ecliptic }
    }

    #[test]
    fn numbers_of_a_small_map() {
        let moment = Moment::new(1.0, 0.0).unwrap();
        let mut sums = Sums::new(pixels(1), &[moment]);
        // Twelve pixels with 0 to 11 hits, half of them with h = 1, half with h = i / 2.
        for pixel in 1..12_u32 {
            let hits = f64::from(pixel);
            let (re, im) = if pixel % 2 == 0 { (hits, 0.0) } else { (0.0, 0.5 * hits) };
            sums.add(pixel, i64::from(pixel), &[steps(re)], &[steps(im)]);
        }
        let found = SurveyStatistics::of(&sums.into_maps());
        assert_eq!((found.samples, found.range, found.unobserved_pixels), (66, (0, 11), 1));
        assert!((found.mean_hits - 5.5).abs() < 1e-15);
        assert!((found.sigma_hits - 13.0_f64.sqrt()).abs() < 1e-14);
        assert!((found.sigma_hits_normalised - 13.0_f64.sqrt() / 5.5).abs() < 1e-14);
        let h = found.moments[0];
        assert_eq!(h.mean, None);
        // Five ones and six quarters.
        assert!((h.mean_observed.unwrap() - 6.5 / 11.0).abs() < 1e-12);
        let mean: f64 = 6.5 / 11.0;
        let squares = 5.0 * (1.0 - mean).powi(2) + 6.0 * (0.25 - mean).powi(2);
        assert!((h.std.unwrap() - (squares / 10.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn an_empty_map_has_no_means() {
        let moment = Moment::new(1.0, 0.0).unwrap();
        let found = SurveyStatistics::of(&Sums::new(pixels(2), &[moment]).into_maps());
        assert_eq!((found.samples, found.range, found.unobserved_pixels), (0, (0, 0), 48));
        assert_eq!(found.moments[0].mean_observed, None);
        assert!(found.sigma_hits_normalised.abs() < 1e-300);
    }
}
