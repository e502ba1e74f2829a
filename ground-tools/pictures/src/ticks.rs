//! Where a scale has marks, and what is written at them.
//!
//! Linear scales have marks at 1, 2 or 5 times a power of ten; logarithmic ones at powers of ten, and
//! at 2 and 5 times these where there are few. Large and small numbers share a power of ten, which the
//! axis names once.

use super::colour::{Scale, Span};

/// A mark; without a label it is a small one.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    pub(super) value: f64,
    pub(super) label: String,
}

/// The marks of a scale.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Ticks {
    pub(super) ticks: Vec<Tick>,
    /// The power of ten that the labels leave out.
    pub(super) exponent: i32,
}

/// The marks of a span, at most `most` of them labelled.
pub(super) fn ticks(span: Span, most: u32) -> Ticks {
    match span.scale {
        Scale::Linear => linear(span, most),
        Scale::Log => logarithmic(span, most),
    }
}

/// A power of ten that a title takes on, such as ` (×10⁴)`.
pub(super) fn factor(exponent: i32) -> String {
    if exponent == 0 { String::new() } else { format!("×{}", power(exponent)) }
}

fn power(exponent: i32) -> String {
    let raised = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '0' => '⁰',
        c => char::from_u32(u32::from('⁴') + u32::from(c) - u32::from('4')).unwrap_or(c),
    };
    format!("10{}", exponent.to_string().chars().map(raised).collect::<String>())
}

#[expect(clippy::cast_possible_truncation, reason = "the logarithm of a finite number")]
fn decade(value: f64) -> i32 {
    value.abs().max(1e-307).log10().floor() as i32
}

fn number(value: f64, decimals: i32) -> String {
    let decimals = usize::try_from(decimals.clamp(0, 17)).unwrap_or(0);
    let text = format!("{value:.decimals$}");
    let zero = text.bytes().all(|byte| b"-0.".contains(&byte));
    if zero { text.replace('-', "") } else { text.replace('-', "\u{2212}") }
}

fn linear(span: Span, most: u32) -> Ticks {
    let rough = (span.high - span.low) / f64::from(most.max(1));
    let base = 10_f64.powi(decade(rough));
    let step = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|times| times * base)
        .find(|step| (span.high - span.low) / step <= f64::from(most) + 1e-9)
        .unwrap_or(10.0 * base);
    let largest = decade(span.low.abs().max(span.high.abs()));
    let exponent = if (-3..5).contains(&largest) { 0 } else { largest };
    let decimals = exponent - decade(step * 1.000_001);
    let (first, last) = ((span.low / step - 1e-9).ceil(), (span.high / step + 1e-9).floor());
    let mut ticks = Vec::new();
    let mut count = first;
    while count <= last && ticks.len() <= 100 {
        let value = count * step;
        let label = number(value / 10_f64.powi(exponent), decimals);
        ticks.push(Tick { value, label });
        count += 1.0;
    }
    Ticks { ticks, exponent }
}

fn logarithmic(span: Span, most: u32) -> Ticks {
    let (first, last) = (decade(span.low), decade(span.high));
    let inside = |value: f64| {
        let place = span.place(value);
        (-1e-9..=1.0 + 1e-9).contains(&place)
    };
    let whole: Vec<i32> =
        (first..=last + 1).filter(|&exponent| inside(10_f64.powi(exponent))).collect();
    let plain = first >= -3 && last <= 4;
    let most = usize::try_from(most).unwrap_or(2).max(2);
    let mut ticks = Vec::new();
    if whole.len() >= 3 || (whole.len() == 2 && most < 5) {
        let stride = whole.len().div_ceil(most);
        for (count, &exponent) in whole.iter().enumerate() {
            if whole.len() > 30 && count % stride != 0 {
                continue;
            }
            let value = 10_f64.powi(exponent);
            let label = match (count % stride, plain) {
                (0, true) => number(value, -exponent),
                (0, false) => power(exponent),
                _ => String::new(),
            };
            ticks.push(Tick { value, label });
        }
        if stride == 1 && whole.len() <= 12 {
            ticks.extend(small(first, last, 2..10).filter(|tick| inside(tick.value)));
        }
        return Ticks { ticks, exponent: 0 };
    }
    let labelled: Vec<(i32, i32, f64)> = (first..=last)
        .flat_map(|exponent| [1, 2, 5].map(|times| (exponent, times)))
        .map(|(exponent, times)| (exponent, times, f64::from(times) * 10_f64.powi(exponent)))
        .filter(|&(.., value)| inside(value))
        .collect();
    if labelled.len() < 2 {
        return linear(span, u32::try_from(most).unwrap_or(5));
    }
    for (exponent, times, value) in labelled {
        let label = match (plain, times) {
            (true, _) => number(value, -exponent),
            (false, 1) => power(exponent),
            (false, _) => format!("{times}×{}", power(exponent)),
        };
        ticks.push(Tick { value, label });
    }
    ticks.extend(small(first, last, 3..10).filter(|tick| inside(tick.value)));
    Ticks { ticks, exponent: 0 }
}

fn small(first: i32, last: i32, times: std::ops::Range<i32>) -> impl Iterator<Item = Tick> {
    (first..=last).flat_map(move |exponent| {
        times.clone().map(move |times| Tick {
            value: f64::from(times) * 10_f64.powi(exponent),
            label: String::new(),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale, low: f64, high: f64, most: u32) -> (Vec<String>, i32) {
        let Ticks { ticks, exponent } = ticks(Span { scale, low, high }, most);
        for tick in &ticks {
            let place = Span { scale, low, high }.place(tick.value);
            assert!((-1e-6..=1.0 + 1e-6).contains(&place), "{tick:?} in {low} to {high}");
        }
        (
            ticks.into_iter().map(|tick| tick.label).filter(|label| !label.is_empty()).collect(),
            exponent,
        )
    }

    #[test]
    fn linear_marks_are_round_numbers() {
        assert_eq!(
            labels(Scale::Linear, 0.0, 1.0, 5).0,
            ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]
        );
        assert_eq!(labels(Scale::Linear, -1.0, 1.0, 4).0, ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(labels(Scale::Linear, 3.0, 97.0, 5).0, ["20", "40", "60", "80"]);
        assert_eq!(
            labels(Scale::Linear, 0.0, 3e6, 4),
            (["0", "1", "2", "3"].map(String::from).to_vec(), 6)
        );
        assert_eq!(
            labels(Scale::Linear, 0.0, 2e-5, 4),
            (["0.0", "0.5", "1.0", "1.5", "2.0"].map(String::from).to_vec(), -5)
        );
    }

    #[test]
    fn logarithmic_marks_are_powers_of_ten() {
        assert_eq!(labels(Scale::Log, 1.0, 1000.0, 6).0, ["1", "10", "100", "1000"]);
        assert_eq!(labels(Scale::Log, 1e-6, 1.0, 8).0.first().unwrap(), "10⁻⁶");
        assert_eq!(labels(Scale::Log, 15.0, 70.0, 6).0, ["20", "50"]);
        assert_eq!(labels(Scale::Log, 31.0, 33.0, 4).0, ["31.0", "31.5", "32.0", "32.5", "33.0"]);
    }

    #[test]
    fn odd_ranges_have_some_marks_and_not_too_many() {
        for scale in [Scale::Linear, Scale::Log] {
            for (low, high) in
                [(1e-300, 1e300), (1.0, 1.0 + 1e-9), (1e307, 8e307), (7e-300, 8e-300)]
            {
                let found = ticks(Span { scale, low, high }, 6).ticks.len();
                assert!((1..=200).contains(&found), "{found} in {low} to {high}");
            }
        }
    }
}
