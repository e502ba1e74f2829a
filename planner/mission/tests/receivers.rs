//! What is said of receivers and requirements that are not legal.

use mission::{Mission, Override};
use std::path::Path;

/// The sentence for a text over litebird.
fn fault(text: &str) -> String {
    let text = format!("base = \"litebird\"\n{text}");
    let read = Mission::from_toml(&text, "mission.toml", Path::new(""), &[]);
    read.expect_err("a fault").to_string()
}

fn set_fault(change: &str) -> String {
    let change = Override::set(change).expect("an override");
    Mission::load("litebird", &[change]).expect_err("a fault").to_string()
}

#[test]
fn receivers_have_their_own_sentences() {
    assert_eq!(
        set_fault("telescope.HFT.net_uk_rts=0"),
        "--set: telescope.HFT.net_uk_rts = 0 is out of range: a noise above 0 and at most 1e12 uK sqrt(s) \
         is needed"
    );
    assert_eq!(
        set_fault("telescope.HFT.ellipticity=0.9"),
        "--set: telescope.HFT.ellipticity = 0.9 is out of range: a ratio of axes from 1 to 100 is needed"
    );
    assert!(
        set_fault("telescope.HFT.knee_mhz=-1").contains("a frequency from 0 to 1e9 mHz is needed")
    );
    assert!(
        set_fault("telescope.HFT.time_constant_ms=x").contains("a duration above 0 and at most")
    );
    let wide = set_fault("telescope.HFT.bandwidth_ghz=900");
    assert!(wide.contains(
        "bandwidth_ghz = 900 is out of range: less than twice the frequency, 402.0 GHz,"
    ));
    let twice = "[[telescope]]\nname = \"A\"\nfwhm_arcmin = 9\n\
                 channel = [{ name = \"c\" }, { name = \"c\" }]\n";
    assert!(fault(twice).contains("telescope.A.channel.1.name = c is there twice"));
    let stray = "[[telescope]]\nname = \"A\"\nfwhm_arcmin = 9\nchannel = [{ name = \"c\" }]\n\
                 [[telescope.detector]]\nname = \"d\"\nchannel = \"b\"\n";
    assert!(
        fault(stray).contains("telescope.A.detector.d.channel = \"b\" is not legal: one of c is")
    );
}

#[test]
fn requirements_have_their_own_sentences() {
    let of = |keys: &str| fault(&format!("[[calibration.requirement]]\n{keys}\n"));
    let sigma = "a positive error with its unit (%), such as \"0.2 %\", is needed";
    assert!(
        of("sigma = \"1 %\"").contains("requirement.0.quantity is missing: one of gain, offset, ")
    );
    for wrong in ["\"0.2\"", "\"-1 %\"", "\"0 %\"", "\"1 ms\"", "3", "\"%\""] {
        let told = of(&format!("quantity = \"gain\"\nsigma = {wrong}"));
        assert!(told.contains(&format!("sigma = {wrong} is not legal: {sigma}")), "{told}");
    }
    assert!(
        of("quantity = \"beam_level\"\nsigma = \"-30 dB\"").contains("radius_arcmin is missing")
    );
    assert!(of("quantity = \"gain\"\nsigma = \"1 %\"\nradius_arcmin = 3").contains(
        "radius_arcmin = 3 is not legal: quantity = \"beam_level\", not \"gain\", is needed"
    ));
    let stray = of("quantity = \"gain\"\nsigma = \"1 %\"\ntelescope = \"H1-196\"");
    assert!(
        stray.contains("telescope = \"H1-196\" is not legal: \"all\", a telescope, a channel"),
        "{stray}"
    );
    assert!(stray.contains("H1-195"));
    assert!(
        of("quantity = \"gain\"\nsigma = \"1 %\"\nevery_days = 0")
            .contains("every_days = 0 is out")
    );
}
