//! What a person types: the `gyrfalcon` command, its verbs and the report.
//!
//! Modules stand in the order that data flows: the command line, how a command may fail, where results
//! go, the report, and one module per verb.

pub mod message;
pub mod failure;
pub mod cli;
pub mod output;
pub mod report;
pub mod verb;
