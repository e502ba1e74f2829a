//! The letters of every picture, and how wide a text is.
//!
//! Roboto Regular (Google, Apache-2.0; see `font/README.md`), so no font of the system is asked for. A
//! viewer of the SVG without Roboto takes another font of nearly the same widths.

use skrifa::instance::{LocationRef, Size};
use skrifa::{FontRef, MetadataProvider};
use std::sync::OnceLock;

/// The font's file.
pub(super) const ROBOTO: &[u8] = include_bytes!("font/roboto.ttf");
/// Fonts in the order in which a viewer should try them.
pub(super) const FAMILIES: &str = "Roboto, Helvetica, Arial, sans-serif";
/// Height of a digit over the font's size.
pub(super) const DIGIT: f64 = 0.71;

/// Characters up to this one have their widths looked up once.
const LOOKED_UP: usize = 0x2300;

/// Width of a text in units of the font's size.
pub(super) fn width(text: &str) -> f64 {
    static WIDTHS: OnceLock<Vec<f32>> = OnceLock::new();
    let widths = WIDTHS.get_or_init(|| {
        let Ok(font) = FontRef::new(ROBOTO) else { return Vec::new() };
        let metrics = font.glyph_metrics(Size::new(1.0), LocationRef::default());
        let map = font.charmap();
        (0..LOOKED_UP)
            .map(|code| {
                let glyph = u32::try_from(code).ok().and_then(|code| map.map(code));
                glyph.and_then(|glyph| metrics.advance_width(glyph)).unwrap_or(0.6)
            })
            .collect()
    });
    text.chars().map(|c| widths.get(c as usize).map_or(0.6, |&width| f64::from(width))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_the_fonts() {
        // Roboto's digits are 1151 of 2048 units wide.
        assert!((width("0123456789") - 11510.0 / 2048.0).abs() < 1e-5);
        assert!(width("W") > 2.0 * width("i"));
        assert!((width("\u{4e00}") - 0.6).abs() < 1e-12);
    }

    #[test]
    fn every_letter_that_pictures_use_is_in_the_font() {
        let map = FontRef::new(ROBOTO).unwrap().charmap();
        for c in "AZaz09 °µ×−–·αβψσωΔ²³⁰⁴⁵⁹⁻₀₉≤≥√′″%/()[]|".chars()
        {
            assert!(map.map(c).is_some(), "{c}");
        }
    }
}
