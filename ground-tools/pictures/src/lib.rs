//! Pictures of maps and charts of numbers, as SVG and as PNG.
//!
//! [`sky_picture`] draws a HEALPix map, the whole sky or a patch of it; [`chart()`] draws lines and
//! histograms, [`plane_picture`] cells of a plane. Longitude increases to the left, as the sky is seen from within. A picture is drawn
//! once, as SVG; its PNG is made from that SVG, with a font that comes with the program, so equal
//! input gives equal bytes.
//!
//! Method: Mollweide's and the gnomonic projection [Snyder1987, chapters 22 and 31]; colours that are even to the eye and
//! told apart by the colour-blind ([`ColourMap`]).
//!
//! Limits: 200 to 8000 pixels wide; text in Latin and Greek letters.

mod error;
mod font;
mod render;
mod drawing;
mod colour;
mod ticks;
mod canvas;
mod legend;
mod projection;
mod graticule;
mod sky_map;
mod raster;
mod sky;
mod chart;
mod plane;
mod matrix;

pub use chart::{Axis, Band, Chart, Mark, Series, Shape, chart};
pub use colour::{ColourMap, Range, Scale};
pub use drawing::Drawing;
pub use error::PictureError;
pub use matrix::{MatrixPicture, matrix_picture};
pub use plane::{Contours, PlanePicture, Ring, plane_picture};
pub use projection::View;
pub use sky::{SkyPicture, Track, sky_picture};
pub use sky_map::SkyMap;
