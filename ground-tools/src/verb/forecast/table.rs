//! A forecast as text: errors per detector or channel, what cannot be told apart, requirements.

use ephem::source::Source;
use formats::forecast::{COLUMNS, Required, apart, lines, shown};
use planner::information::{STRONG, Teaching};
use planner::world::World;
use std::fmt::Write;

/// The whole text; requirements first.
pub(super) fn text(world: &World, teaching: &Teaching, required: &[Required]) -> String {
    let windows = teaching.windows.of_kind(0).len();
    let targets: Vec<&str> = world.targets.iter().map(Source::name).collect();
    let mut text = String::new();
    if !required.is_empty() {
        text.push_str("requirements:\n");
        for it in required {
            let _ = writeln!(text, "  {}: {}", it.name(), it.sentence());
        }
        text.push('\n');
    }
    let _ = write!(
        text,
        "{}: errors at one standard deviation, all others free, {} together{}{}\n\n",
        world.mission.name,
        targets.join(", "),
        if teaching.sessions.is_some() { ", in the plan's sessions" } else { "" },
        if windows > 1 {
            format!(", the worst of those of {windows} windows that measure anything")
        } else {
            String::new()
        },
    );
    let lines = lines(teaching);
    let width = lines.iter().map(|it| it.name.len()).max().unwrap_or(0);
    let mut row = |name: &str, cells: &[String], windows: &str| {
        let _ = write!(text, "{name:<width$}");
        for cell in cells {
            let _ = write!(text, " {cell:>8}");
        }
        text.push_str(windows);
        text.push('\n');
    };
    let head = if windows > 1 { "  windows" } else { "" };
    row("", &COLUMNS.map(|it| it.0.to_owned()), head);
    row("", &COLUMNS.map(|it| it.1.to_owned()), "");
    for line in lines {
        let count = if windows > 1 { format!("{:>9}", line.measured) } else { String::new() };
        row(&line.name, &line.cells.map(shown), &count);
    }
    text.push_str(
        "\n-20 dB, -30 dB: radius up to which the beam's response is known to that; seen: up to which it \
         exceeds its error; at most two full widths.\n",
    );
    let apart = apart(teaching);
    if apart.is_empty() {
        let _ = writeln!(text, "\nNo two errors are correlated by {STRONG} or more.");
    } else {
        text.push_str("\nHard to tell apart (correlation of errors, the strongest):\n");
        for it in apart {
            let _ = writeln!(text, "  {it}");
        }
    }
    text
}
