//! A commissioning campaign of 90 days under real constraints, planned and accounted for.
//!
//! `cargo run -p ground-tools --example commissioning [FOLDER]`
//!
//! The mission file beside this program asks for sessions of every visible planet on every telescope
//! between ground contacts, wheel unloadings and station keeping. The plan goes into FOLDER, or into
//! a temporary one; what is printed is read back from its `timeline.json`, as another program would.
//!
//! Limits: the proof leaves a gap of 5.3 %, because memory binds together with seasons and gaps
//! (`docs/scheduling.md`).

use clap::Parser;
use formats::timeline::Timeline;
use ground_tools::cli::Cli;
use ground_tools::verb;
use std::collections::BTreeMap;
use std::error::Error;
use std::path::{Path, PathBuf};

#[expect(clippy::print_stdout, reason = "an example shows its result")]
fn main() -> Result<(), Box<dyn Error>> {
    let temporary = tempfile::tempdir()?;
    let given = std::env::args_os().nth(1).map(PathBuf::from);
    let folder = given.unwrap_or_else(|| temporary.path().join("plan"));
    plan(&folder)?;

    let text = std::fs::read_to_string(folder.join("timeline.json"))?;
    let timeline: Timeline = serde_json::from_str(&text)?;
    println!("{:<10} {:<10} {:>8} {:>9}", "target", "telescope", "sessions", "in view");
    let mut shares = BTreeMap::<(&str, &str), (usize, f64)>::new();
    for session in &timeline.sessions {
        let share = shares.entry((&session.target, &session.telescope)).or_default();
        *share = (share.0 + 1, share.1 + session.dwell_s);
    }
    for ((target, telescope), (sessions, dwell_s)) in shares {
        println!("{target:<10} {telescope:<10} {sessions:>8} {:>7.2} h", dwell_s / 3600.0);
    }
    println!(
        "objective {:.1}, at most {:.1}: gap {:.2} % ({})",
        timeline.objective,
        timeline.upper_bound,
        100.0 * timeline.gap,
        timeline.stopped
    );

    // Rules are told by the first word of a constraint's name.
    let mut rules = BTreeMap::<&str, (usize, usize)>::new();
    for constraint in &timeline.constraints {
        let rule = constraint.name.split(' ').next().unwrap_or_default();
        let count = rules.entry(rule).or_default();
        *count = (count.0 + 1, count.1 + usize::from(constraint.shadow_price > 0.0));
    }
    for (rule, (places, priced)) in rules {
        println!("{rule}: holds in {places} places, {priced} of them with a price");
    }
    let tightest =
        timeline.constraints.iter().max_by(|a, b| a.shadow_price.total_cmp(&b.shadow_price));
    if let Some(it) = tightest {
        println!(
            "tightest: {}, {} of {} used, {:.2} of the objective per unit more",
            it.name, it.used, it.limit, it.shadow_price
        );
    }
    Ok(())
}

/// `gyrfalcon plan` on the mission file of this example.
fn plan(folder: &Path) -> Result<(), Box<dyn Error>> {
    let mission = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/commissioning/mission.toml");
    let command = ["gyrfalcon", "plan", "--quiet", "--mission"].map(Into::into);
    let places = [mission.into_os_string(), "--out".into(), folder.into()];
    Ok(verb::run(&Cli::try_parse_from(command.into_iter().chain(places))?)?)
}
