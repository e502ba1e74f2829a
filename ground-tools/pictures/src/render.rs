//! Pixels of a drawing, and images within one.

use super::error::PictureError;
use super::font::ROBOTO;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use png::{BitDepth, ColorType, Compression, Encoder};
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};
use std::sync::Arc;

/// Makes a PNG of an SVG, on white.
pub(super) fn png_of_svg(svg: &str) -> Result<Vec<u8>, PictureError> {
    let fail = |error: String| PictureError::Render(error);
    let mut fonts = fontdb::Database::new();
    fonts.load_font_data(ROBOTO.to_vec());
    let options =
        Options { fontdb: Arc::new(fonts), font_family: "Roboto".to_owned(), ..Options::default() };
    let tree = Tree::from_str(svg, &options).map_err(|error| fail(error.to_string()))?;
    let size = tree.size().to_int_size();
    let (width, height) = (size.width(), size.height());
    let mut pixels =
        Pixmap::new(width, height).ok_or_else(|| fail(format!("{width} x {height}")))?;
    pixels.fill(resvg::tiny_skia::Color::WHITE);
    resvg::render(&tree, Transform::identity(), &mut pixels.as_mut());
    let (quads, _) = pixels.data().as_chunks::<4>();
    let rgb: Vec<u8> = quads.iter().flat_map(|&[red, green, blue, _]| [red, green, blue]).collect();
    encode(width, height, &rgb, None)
}

/// Colours of an image, and the number of one that is transparent.
pub(super) struct Palette {
    pub(super) colours: Vec<[u8; 3]>,
    pub(super) clear: u8,
}

/// Makes a PNG of RGB triples, or of numbers of colours.
pub(super) fn encode(
    width: u32,
    height: u32,
    pixels: &[u8],
    palette: Option<&Palette>,
) -> Result<Vec<u8>, PictureError> {
    let fail = |error: png::EncodingError| PictureError::Render(error.to_string());
    let mut out = Vec::new();
    let mut encoder = Encoder::new(&mut out, width, height);
    encoder.set_color(if palette.is_some() { ColorType::Indexed } else { ColorType::Rgb });
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Balanced);
    if let Some(Palette { colours, clear }) = palette {
        let mut opacity = vec![255; usize::from(*clear)];
        opacity.push(0);
        encoder.set_palette(colours.as_flattened().to_vec());
        encoder.set_trns(opacity);
    }
    let mut writer = encoder.write_header().map_err(fail)?;
    writer.write_image_data(pixels).map_err(fail)?;
    writer.finish().map_err(fail)?;
    Ok(out)
}

/// A PNG as it stands within an SVG.
pub(super) fn data_uri(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", STANDARD.encode(png))
}
