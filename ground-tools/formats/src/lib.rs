//! What others read and write: rows as CSV, JSON lines and Parquet, maps in FITS, a plan's timeline and
//! calendar, attitudes for operations and simulators, the container that goes on board, test vectors,
//! attitude histories.
//!
//! Modules stand in the order that data flows. Nothing is printed here and no file is named: writers
//! take a [`std::io::Write`], readers a text or a path.

mod error;
pub mod degrees;
pub mod rows;
pub mod fits;
pub mod maps;
pub mod resonance;
pub mod visits;
pub mod survey;
pub mod timeline;
pub mod calendar;
pub mod attitude;
pub mod periods;
pub mod products;
pub mod uplink;
pub mod vectors;
pub mod history;

pub use error::WriteError;
