//! All rules joined in one integer programme over the sessions.
//!
//! Method: `rows.rs` lists the rows of overlap, days, windows, memory and scan angles, `cells.rs` the
//! concave parts of the objective; `build.rs` puts them together. Rows too many to list come from a family
//! per kind (`starts.rs`, `heat.rs`, `memory.rs`, `cone.rs`), each of which finds its worst places exactly
//! in integers and gives the rows that hold there for every schedule.
//!
//! Limits: values are rounded up to units, scan angles to milliseconds; the objective reported is summed
//! from the problem's own numbers.

mod facts;
mod separation;
mod starts;
mod heat;
mod memory;
mod cone;
mod built;
mod rows;
mod cells;
mod build;

pub(super) use build::build;
pub(super) use built::{Built, Season};
pub(super) use cone::{DIRECTION, members as cone_members};
pub(super) use facts::Facts;
