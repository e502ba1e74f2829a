//! Random missions: legal ones resolve and read back equal, others end in a sentence.

#![expect(clippy::format_push_string, reason = "a test's text, built once per case")]

use mission::{Mission, Override};
use proptest::prelude::*;
use std::path::Path;

fn decimal(low: i64, high: i64) -> impl Strategy<Value = String> {
    (low..high, 0..1_000_000_u32, 0..4_u8).prop_map(|(whole, fraction, form)| match form {
        0 => whole.to_string(),
        1 => format!("{whole}.{fraction:06}"),
        2 => format!("{whole}.{fraction}e0"),
        _ => format!("\"{whole}{fraction:06}/1000000\""),
    })
}

fn name() -> impl Strategy<Value = String> {
    "[A-Za-z0-9_.][A-Za-z0-9 _.+äΩ-]{0,8}[A-Za-z0-9_.+]"
}

prop_compose! {
    fn telescope(index: usize)(
        name in name(),
        turn in any::<bool>(),
        plate in proptest::option::of(decimal(1, 200)),
        fwhm in decimal(1, 100),
        field in 0..3_u8,
        side in decimal(1, 100),
        noise in proptest::option::of(decimal(1, 1000)),
        channels in proptest::collection::vec((name(), decimal(200, 900)), 0..3),
        detectors in proptest::collection::vec((name(), decimal(-180, 180)), 0..3),
    ) -> String {
        let mut text = format!("[[telescope]]\nname = \"{name}{index}\"\nfwhm_arcmin = {fwhm}\n");
        if turn {
            text += "boresight_quaternion_xyzw = [0.6, -0.8, 0, 0e0]\n";
        }
        if let Some(rate) = plate {
            text += &format!("hwp_rate_rpm = {rate}\nhwp_sign = -1\n");
        }
        match field {
            0 => {}
            1 => text += &format!("field_of_view = {{ radius_deg = {side} }}\n"),
            _ => text += &format!("field_of_view = {{ width_deg = {side}, height_deg = 1.50 }}\n"),
        }
        if let Some(noise) = noise {
            text += &format!("net_uk_rts = {noise}\nbandwidth_ghz = 100\nknee_mhz = {noise}\n");
        }
        for (number, (name, frequency)) in channels.iter().enumerate() {
            text += &format!(
                "[[telescope.channel]]\nname = \"{name}{number}\"\nfrequency_ghz = {frequency}\n"
            );
        }
        for (number, (name, angle)) in detectors.iter().enumerate() {
            text += &format!(
                "[[telescope.detector]]\nname = \"{name}{number}\"\npolarisation_angle_deg = {angle}\n"
            );
        }
        text
    }
}

prop_compose! {
    fn mission()(
        name in name(),
        days in decimal(1, 36524),
        alpha in decimal(0, 89),
        beta in decimal(0, 89),
        precession in decimal(1, 1_000_000),
        spin in decimal(1, 1000),
        senses in (any::<bool>(), any::<bool>()),
        phase in decimal(-359, 359),
        telescopes in (telescope(0), telescope(1), telescope(2), 0..4_usize),
        radius in decimal(1, 179),
        limit in proptest::option::of((1..100_u32, decimal(1, 100))),
        weight in proptest::option::of(decimal(0, 100)),
        circular in proptest::option::of(decimal(0, 359)),
    ) -> String {
        let sign = |positive| if positive { 1 } else { -1 };
        let mut text = format!(
            "name = \"{name}\"\n[span]\nstart = \"2032-02-29T23:59:59.125 TT\"\n\
             duration_days = {days}\n[scan]\nalpha_deg = {alpha}\nbeta_deg = {beta}\n\
             precession_period_min = {precession}\nspin_period_min = {spin}\n\
             precession_sign = {}\nspin_sign = {}\nspin_phase_deg = {phase}\n",
            sign(senses.0),
            sign(senses.1),
        );
        if let Some(longitude) = circular {
            text += &format!("[orbit]\nsun = \"circular\"\nstart_longitude_deg = {longitude}\n");
        }
        let (a, b, c, count) = telescopes;
        text.extend([a, b, c].into_iter().take(count));
        text += &format!("[calibration]\nradius_deg = {radius}\ntargets = [\"{name}\", \"moon\"]\n");
        text += &format!("[[calibration.source]]\nname = \"{name}\"\ndirections = \"a \\\"b\\\\.csv\"\n");
        text += "[calibration.schedule]\n";
        if let Some((count, days)) = limit {
            text += &format!("max_sessions = {{ count = {count}, days = {days} }}\n");
        }
        if let Some(weight) = weight {
            text += &format!("[calibration.schedule.weights]\n\"{name}\" = {weight}\nmars = 2\n");
        }
        text
    }
}

proptest! {
    #[test]
    fn a_legal_mission_resolves_and_reads_back(text in mission()) {
        let load = |text: &str| Mission::from_toml(text, "random", Path::new(""), &[]);
        let mission = load(&text).map_err(|e| TestCaseError::fail(format!("{e}\n{text}")))?;
        let again = load(mission.resolved_toml())
            .map_err(|e| TestCaseError::fail(format!("{e}\n{}", mission.resolved_toml())))?;
        prop_assert_eq!(format!("{again:?}"), format!("{mission:?}"));
        prop_assert_eq!(again.digest(), mission.digest());
    }

    #[test]
    fn no_text_panics(text in "(\\[+[a-z_.]{0,12}\\]+|[a-z_]{1,12} = [-0-9a-z.\"{}\\[\\], ]{0,12}|\\PC{0,12}|\n){0,20}") {
        let read = Mission::from_toml(&text, "random", Path::new(""), &[]);
        prop_assert!(read.is_err_and(|error| !error.to_string().is_empty()));
    }

    #[test]
    fn no_override_panics(
        key in prop::sample::select(keys()),
        value in "([-0-9.e/]{0,8}|[a-z,\\[\\]{}= \"]{0,12}|\\PC{0,8}|nan|inf|\\[\\{\\}\\]|\\[1, 2\\])",
    ) {
        let change = Override::set(&format!("{key}={value}")).unwrap();
        if let Err(error) = Mission::load("litebird", &[change]) {
            let sentence = error.to_string();
            prop_assert!(sentence.starts_with("--set: ") || sentence.contains("preset litebird"), "{sentence}");
        }
    }
}

/// The dotted path of every key in a mission that has them all.
fn keys() -> Vec<String> {
    let litebird = Mission::load("litebird", &[]).unwrap_or_else(|error| panic!("{error}"));
    let mut keys = Vec::new();
    let mut table = String::new();
    for line in litebird.resolved_toml().lines() {
        if line.starts_with('[') {
            table = format!("{}.", line.trim_matches(['[', ']']));
            keys.push(table.trim_end_matches('.').to_owned());
            if table == "telescope." {
                "telescope.HFT.".clone_into(&mut table);
            }
        } else if let Some((key, _)) = line.split_once(" = ") {
            keys.push(format!("{table}{key}"));
            keys.push(format!("{table}{key}.count"));
        }
    }
    keys
}
