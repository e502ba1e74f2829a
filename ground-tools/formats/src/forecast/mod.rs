//! What is told of a forecast: rows, a table of errors, whether requirements are met, what is left out.
//!
//! The command prints it, and the page of a plan shows it; the words are the same.

mod told;
mod lines;
mod requirement;
mod left_out;
mod of_plan;

pub use left_out::left_out;
pub use lines::{COLUMNS, Cells, Line, apart, lines, shown};
pub use of_plan::{Taught, sessions};
pub use requirement::{Required, required};
pub use told::{ALL, Told, columns, degeneracies, profile};
