//! Which colour stands for a value, and which values have one.

use super::error::PictureError;
use colorous::Gradient;

/// Colours of a raster apart from those for what is unobserved or outside.
pub(super) const STEPS: u8 = 254;
/// The colour of unobserved pixels.
pub(super) const UNOBSERVED: [u8; 3] = [190, 190, 190];
/// Colours told apart by the colour-blind, for lines.
pub(super) const LINES: [&str; 7] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#333333"];
/// Dashes that tell lines apart in black and white, in line widths.
pub(super) const DASHES: [&[f64]; 4] = [&[], &[4.0, 1.6], &[1.2, 1.4], &[6.0, 1.6, 1.2, 1.6]];

/// A scale of colours that is even to the eye.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ColourMap {
    /// Dark violet through green to yellow.
    #[default]
    Viridis,
    /// Dark blue to yellow, nearly the same to every eye.
    Cividis,
    /// Blue through white to red, for values about zero: an automatic range is symmetric.
    BlueRed,
}

/// How values are spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scale {
    /// Evenly.
    #[default]
    Linear,
    /// By their logarithms.
    Log,
}

/// Which values the ends of a scale stand for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Range {
    /// These percentiles of the values shown.
    Percentiles(f64, f64),
    /// These values.
    Given(f64, f64),
}

impl ColourMap {
    /// The colour at a place from 0 to 1.
    pub(super) fn at(self, place: f64) -> [u8; 3] {
        let (gradient, place): (Gradient, f64) = match self {
            Self::Viridis => (colorous::VIRIDIS, place),
            Self::Cividis => (colorous::CIVIDIS, place),
            Self::BlueRed => (colorous::RED_BLUE, 1.0 - place),
        };
        let colour = gradient.eval_continuous(place.clamp(0.0, 1.0));
        [colour.r, colour.g, colour.b]
    }
}

/// A range on a scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Span {
    pub(super) scale: Scale,
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Span {
    /// A given range.
    pub(super) fn given(scale: Scale, low: f64, high: f64) -> Result<Self, PictureError> {
        if !(low.is_finite() && high.is_finite() && low < high && (high - low).is_finite()) {
            return Err(PictureError::Range(low, high));
        }
        if scale == Scale::Log && low <= 0.0 {
            return Err(PictureError::Logarithm(low, high));
        }
        Ok(Self { scale, low, high })
    }

    /// The range of an image's values.
    pub(super) fn of_values(
        scale: Scale,
        range: Range,
        colours: ColourMap,
        values: impl Iterator<Item = f64>,
    ) -> Result<Self, PictureError> {
        let (first, last) = match range {
            Range::Given(low, high) => return Self::given(scale, low, high),
            Range::Percentiles(first, last) => (first, last),
        };
        if !(0.0 <= first && first < last && last <= 100.0) {
            return Err(PictureError::Percentiles(first, last));
        }
        let shown = |value: &f64| value.is_finite() && (scale == Scale::Linear || *value > 0.0);
        let mut values: Vec<f64> = values.filter(shown).collect();
        let (low, high) = (percentile(&mut values, first), percentile(&mut values, last));
        let (low, high) = match (low, high, colours, scale) {
            (Some(low), Some(high), ColourMap::BlueRed, Scale::Linear) => {
                let most = low.abs().max(high.abs());
                (Some(-most), Some(most))
            }
            (low, high, ..) => (low, high),
        };
        Ok(Self::about(scale, low, high))
    }

    /// A range that holds two values and is no point.
    pub(super) fn about(scale: Scale, low: Option<f64>, high: Option<f64>) -> Self {
        let (low, high) = match (low, high) {
            (Some(low), Some(high)) => (low, high),
            _ if scale == Scale::Log => (1.0, 10.0),
            _ => (0.0, 1.0),
        };
        let (low, high) = match scale {
            // Halved, so that their difference is a number.
            Scale::Linear => (low.clamp(-8e307, 8e307), high.clamp(-8e307, 8e307)),
            Scale::Log => (low.max(1e-300), high.clamp(1e-300, 8e307)),
        };
        let close = high - low <= 1e-12 * low.abs().max(high.abs());
        let (low, high) = match (close, scale) {
            (false, _) => (low, high),
            (true, Scale::Linear) if low.abs() < 1e-300 => (-1.0, 1.0),
            (true, Scale::Linear) => (low - 0.5 * low.abs(), high + 0.5 * high.abs()),
            (true, Scale::Log) => (low / 2.0, high * 2.0),
        };
        Self { scale, low, high }
    }

    /// Where a value lies, 0 at the low end and 1 at the high one.
    pub(super) fn place(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Log if value <= 0.0 => f64::NEG_INFINITY,
            Scale::Log => (value / self.low).ln() / (self.high / self.low).ln(),
        }
    }
}

fn percentile(values: &mut [f64], percent: f64) -> Option<f64> {
    let last = values.len().checked_sub(1)?;
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a number of pixels, and a rank between 0 and the last"
    )]
    let rank = ((percent / 100.0) * last as f64).round() as usize;
    Some(*values.select_nth_unstable_by(rank.min(last), f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn span(scale: Scale, range: Range, values: &[f64]) -> Result<Span, PictureError> {
        Span::of_values(scale, range, ColourMap::Viridis, values.iter().copied())
    }

    #[test]
    fn a_range_is_never_a_point() {
        let all = Range::Percentiles(0.0, 100.0);
        for scale in [Scale::Linear, Scale::Log] {
            for values in [
                &[][..],
                &[f64::NAN],
                &[3.0, 3.0],
                &[0.0],
                &[-2.0],
                &[f64::MAX, f64::MIN],
                &[5e-324],
                &[f64::MAX],
            ] {
                let span = span(scale, all, values).unwrap();
                assert!(span.low < span.high, "{span:?} of {values:?}");
                assert!((span.high - span.low).is_finite());
                assert!(scale == Scale::Linear || span.low > 0.0);
                assert!(span.place(span.low).abs() < 1e-12);
                assert!((span.place(span.high) - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn percentiles_leave_out_what_stands_apart() {
        let values: Vec<f64> = (0..=100).map(f64::from).chain([1e9]).collect();
        let span = span(Scale::Linear, Range::Percentiles(5.0, 95.0), &values).unwrap();
        assert!((span.low - 5.0).abs() < 1.1 && (span.high - 95.0).abs() < 1.1, "{span:?}");
    }

    #[test]
    fn wrong_ranges_are_told() {
        let wrong = |scale, range| span(scale, range, &[1.0]).unwrap_err().to_string();
        assert!(wrong(Scale::Linear, Range::Given(2.0, 1.0)).contains("from 2 to 1"));
        assert!(wrong(Scale::Linear, Range::Given(f64::NAN, 1.0)).contains("finite"));
        assert!(wrong(Scale::Log, Range::Given(0.0, 1.0)).contains("a start above 0"));
        assert!(wrong(Scale::Log, Range::Percentiles(50.0, 101.0)).contains("0 to 100"));
    }
}
