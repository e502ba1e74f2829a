//! Every preset's plan of sixty days, as it was looked at.

use serde_json::Value;
use std::fmt::Write;
use std::process::Command;

const GOLDEN: &str = include_str!("data/presets.csv");

/// Sessions by target, hours, opportunities, objective and gap of each preset.
#[test]
fn every_preset_has_its_plan() {
    let folder = tempfile::tempdir().unwrap();
    let mut found =
        String::from("preset,opportunities,sessions,jupiter,neptune,hours,objective,gap_percent\n");
    for preset in mission::presets::NAMES {
        let output = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"))
            .args([
                "plan",
                "--mission",
                preset,
                "--until",
                "+60d",
                "--json",
                "--quiet",
                "--out",
                preset,
            ])
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert!(output.status.success(), "{preset}: {}", String::from_utf8_lossy(&output.stderr));
        let plan: Value = serde_json::from_slice(&output.stdout).unwrap();
        let hours: f64 = plan["hours_by_target"]
            .as_object()
            .unwrap()
            .values()
            .map(|it| it.as_f64().unwrap())
            .sum();
        let number = |key: &str| plan[key].as_f64().unwrap();
        writeln!(
            found,
            "{preset},{},{},{},{},{hours:.3},{:.2},{:.3}",
            plan["opportunities"],
            plan["sessions"],
            plan["sessions_by_target"]["jupiter"],
            plan["sessions_by_target"]["neptune"],
            number("objective"),
            100.0 * number("gap"),
        )
        .unwrap();
    }
    assert_eq!(found, GOLDEN, "\n{found}");
}
