//! Values over cells of a plane as FITS images.
//!
//! Images of double precision, rows from the lowest y; the axes are linear coordinates (`CTYPE` `X`, `Y`).
//! The first is the file's primary image, the others are extensions. Cells without a value are NaN.
//!
//! Method: [FITS4, sections 4.4.1 and 7.1], big-endian.

use super::write::{finished, header_bytes};
use super::{BLOCK, Card};
use crate::error::WriteError;
use std::io::Write;

/// A square image.
#[derive(Debug, Clone, Copy)]
pub struct Image<'i> {
    /// Its name, `EXTNAME`.
    pub name: &'i str,
    /// Unit of its values, `BUNIT`; empty where they have none.
    pub unit: &'i str,
    /// Values row by row; NaN where there is none.
    pub values: &'i [f64],
}

/// What images of one file share.
#[derive(Debug, Clone, Copy)]
pub struct Plane<'i> {
    /// Cells along each side.
    pub side: usize,
    /// From the middle to each edge.
    pub half: f64,
    /// Unit of the axes, `CUNIT`.
    pub unit: &'i str,
    /// What else is to be said, in the primary header.
    pub cards: &'i [Card],
}

/// Writes images of one plane.
///
/// # Errors
/// What `out` failed with; [`WriteError::Refused`] where an image is not of the plane's size.
pub fn write_images(
    out: &mut dyn Write,
    plane: &Plane<'_>,
    images: &[Image<'_>],
) -> Result<(), WriteError> {
    for (index, image) in images.iter().enumerate() {
        if image.values.len() != plane.side * plane.side {
            let count = image.values.len();
            return Err(WriteError::Refused(format!(
                "{count} values in a square of {}",
                plane.side
            )));
        }
        out.write_all(&header_bytes(&cards(plane, image, index == 0))?)?;
        let mut written = 0;
        for value in image.values {
            out.write_all(&value.to_be_bytes())?;
            written += 8;
        }
        out.write_all(&vec![0; finished(written, BLOCK)])?;
    }
    Ok(())
}

fn cards(plane: &Plane<'_>, image: &Image<'_>, first: bool) -> Vec<Card> {
    let side = i64::try_from(plane.side).unwrap_or(i64::MAX);
    let mut cards = if first {
        vec![Card::logical("SIMPLE", true, "FITS")]
    } else {
        vec![Card::text("XTENSION", "IMAGE", "image")]
    };
    cards.extend([
        Card::integer("BITPIX", -64, "double precision"),
        Card::integer("NAXIS", 2, ""),
        Card::integer("NAXIS1", side, "cells along x"),
        Card::integer("NAXIS2", side, "cells along y"),
    ]);
    if first {
        cards.push(Card::logical("EXTEND", true, "images follow"));
    } else {
        cards.extend([Card::integer("PCOUNT", 0, ""), Card::integer("GCOUNT", 1, "")]);
    }
    cards.push(Card::text("EXTNAME", image.name, ""));
    if !image.unit.is_empty() {
        cards.push(Card::text("BUNIT", image.unit, ""));
    }
    #[expect(clippy::cast_precision_loss, reason = "a few cells")]
    let side = plane.side as f64;
    for (number, axis) in [(1, "X"), (2, "Y")] {
        cards.extend([
            Card::text(&format!("CTYPE{number}"), axis, "of the detector's frame"),
            Card::real(&format!("CRPIX{number}"), side / 2.0 + 0.5, ""),
            Card::real(&format!("CRVAL{number}"), 0.0, ""),
            Card::real(&format!("CDELT{number}"), 2.0 * plane.half / side, ""),
            Card::text(&format!("CUNIT{number}"), plane.unit, ""),
        ]);
    }
    if first {
        cards.extend(plane.cards.iter().cloned());
    }
    cards
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_fill_whole_blocks_and_hold_their_values() {
        let plane = Plane { side: 2, half: 3.0, unit: "arcmin", cards: &[] };
        let one = Image { name: "ERROR", unit: "", values: &[1.0, f64::NAN, 3.0, -4.5] };
        let other = Image { name: "SECONDS", unit: "s", values: &[0.0; 4] };
        let mut bytes = Vec::new();
        write_images(&mut bytes, &plane, &[one, other]).unwrap();
        assert_eq!(bytes.len(), 4 * BLOCK);
        assert!(bytes.starts_with(b"SIMPLE  =                    T"));
        let value = |at: usize| f64::from_be_bytes(*bytes[BLOCK + 8 * at..].first_chunk().unwrap());
        assert!((value(3) + 4.5).abs() < 1e-15 && value(1).is_nan());
        assert!(bytes[2 * BLOCK..].starts_with(b"XTENSION= 'IMAGE"));
        let text = String::from_utf8_lossy(&bytes[..BLOCK]);
        assert!(text.contains("CDELT1  =") && text.contains("CUNIT2  = 'arcmin"));
        let wrong = Image { values: &[0.0; 3], ..one };
        assert!(write_images(&mut Vec::new(), &plane, &[wrong]).is_err());
    }
}
