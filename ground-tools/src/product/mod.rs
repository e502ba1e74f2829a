//! What operations receive of a plan beside its timeline: attitudes and pointing periods in the
//! formats that their systems read. One file per format; [`attitude`] makes the samples of all.

pub mod stamp;
pub mod attitude;
pub mod aem;
pub mod periods;
pub mod stk;
pub mod spice;
mod files;

pub use files::{ALWAYS, Also, Products};
