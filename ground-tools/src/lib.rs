//! The ground half of Gyrfalcon behind the `gyrfalcon` command: mission files and what is made of
//! them.
//!
//! Modules stand in the order that data flows: exact numbers and quantities, the text of a mission,
//! its checks, its canonical form, the typed mission, the command line; then the mission among the
//! planets, its transits, its timeline, and one module per verb.

pub mod number;
pub mod rounding;
pub mod quantity;
pub mod fault;
pub mod presets;
mod document;
mod range;
mod resolve;
mod findings;
mod section;
pub mod mission;
pub mod cli;
pub mod failure;
pub mod output;
pub mod degrees;
pub mod world;
pub mod provenance;
pub mod sightline;
pub mod passes;
pub mod signal;
pub mod places;
pub mod visit_report;
pub mod columns;
pub mod rows;
pub mod fits;
pub mod picture;
pub mod visit_figures;
pub mod memory;
pub mod survey_input;
pub mod survey_report;
pub mod survey_products;
pub mod resonance_check;
pub mod resonance_figure;
pub mod vectors;
pub mod history;
pub mod scan_fit;
pub mod calendar;
mod purposes;
pub mod demands;
pub mod timeline;
pub mod interrupt;
pub mod product;
pub mod report;
pub mod revision;
pub mod uplink;
pub mod verb;
