//! What a mission may say and hardly means: warnings, with their sentences.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use mission::{Mission, Override};

/// The warnings of litebird with these changes.
fn warnings(changes: &[&str]) -> Vec<String> {
    let changes: Vec<Override> = changes.iter().map(|text| Override::set(text).unwrap()).collect();
    let mission = Mission::load("litebird", &changes).unwrap();
    mission.warnings.iter().map(ToString::to_string).collect()
}

#[test]
fn a_sky_that_is_not_full_is_a_warning() {
    assert_eq!(
        warnings(&["scan.alpha_deg=30.5"]),
        ["no full sky: scan.alpha_deg + scan.beta_deg - 90 = -9.5 does not exceed \
          scan.full_sky_margin_deg = 0.0"]
    );
    assert_eq!(warnings(&["scan.full_sky_margin_deg=4.999"]), [""; 0]);
    assert_eq!(warnings(&["scan.full_sky_margin_deg=5"]).len(), 1);
    assert_eq!(warnings(&["scan.alpha_deg=0", "scan.beta_deg=90"]).len(), 1);
    assert_eq!(
        warnings(&["scan.alpha_deg=0", "scan.beta_deg=120.5"]),
        ["no full sky: scan.alpha_deg and scan.beta_deg differ by 120.5, more than 90 deg"]
    );
}

#[test]
fn a_boresight_near_the_sun_is_a_warning() {
    assert_eq!(
        warnings(&["scan.alpha_deg=60", "scan.beta_deg=80"]),
        ["the boresight comes within 40 deg of the Sun (180 - scan.alpha_deg - scan.beta_deg); \
          less than 45 deg is warned of"]
    );
    assert_eq!(warnings(&["scan.alpha_deg=60", "scan.beta_deg=75"]), [""; 0]);
}

#[test]
fn a_weight_of_no_target_is_a_warning() {
    let of = |weights: &str| {
        let weights = format!("calibration.schedule.weights={weights}");
        warnings(&["calibration.targets=jupiter,mars", &weights])
    };
    assert_eq!(
        of("{ jupiter = 3, tau_a = 2.5 }"),
        ["calibration.schedule.weights.tau_a weighs nothing: tau_a is not among \
          calibration.targets, which are jupiter, mars"]
    );
    assert_eq!(of("{ saturn = 1.0, mars = 0 }"), [""; 0]);
    assert_eq!(of("{ saturn = { gain = 1.0 }, uranus = 0 }").len(), 1);
}
