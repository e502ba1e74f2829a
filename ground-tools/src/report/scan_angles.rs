//! At which angles and how far off do the used passes cross each target.
//!
//! Angles are psi and the scan-beam angle zeta at closest approach; psi is zero at east, towards north.
//! The impact is the target's offset across the scan at closest approach. Each pass counts by its dwell.
//! `|<exp(i n psi)>|` is 0 where angles are spread evenly in the sense of n, 1 where all are the same:
//! what cross-linking leaves of a spin-n systematic.

use super::names::{Names, grouped, real, total};
use super::plot::{colour, n, steps};
use super::source::Source;
use formats::timeline::SessionTransit;
use maud::{Markup, PreEscaped, html};
use std::fmt::Write;

/// Sectors of a full turn.
const SECTORS: usize = 36;
const RADIUS: f64 = 100.0;
/// The multiples of psi that are told.
const ORDERS: [f64; 3] = [1.0, 2.0, 4.0];
/// Bins of the impact from one end to the other.
const BINS: usize = 28;
const STRIP: (f64, f64) = (240.0, 44.0);

/// Which angle of a pass, in degrees.
type Angle = fn(&SessionTransit) -> f64;
const PSI: Angle = |it| it.psi_deg;
const ZETA: Angle = |it| it.scan_beam_angle_deg;

pub(super) fn section(source: &Source, names: &Names) -> Markup {
    let passes = |target: usize, telescope: Option<usize>| -> Vec<&SessionTransit> {
        let sessions = source.timeline.sessions.iter().filter(|it| {
            it.target == names.targets[target]
                && telescope.is_none_or(|index| it.telescope == names.telescopes[index])
        });
        sessions.flat_map(|it| &it.transits).collect()
    };
    let targets: Vec<usize> = (0..names.targets.len()).collect();
    let all = source.timeline.sessions.iter().flat_map(|it| &it.transits);
    let farthest = all.map(|it| it.impact_deg.abs()).fold(0.0, f64::max);
    html! {
        p { "Crossing angle psi of the used passes, by time in view; east is to the right, north up. Sectors have areas in proportion to time. Below, time in view by impact: the target's offset across the scan." }
        div.panels.small {
            @for &target in &targets {
                @let here = passes(target, None);
                figure class={ "panel " (colour(target)) } {
                    figcaption { span.swatch aria-hidden="true" {} (names.targets[target]) ": " (grouped(here.len())) @if here.len() == 1 { " pass" } @else { " passes" } }
                    @if here.is_empty() { p.none { "No pass is used." } }
                    @else {
                        (rose(names.targets[target], &here))
                        (impacts(names.targets[target], &here, farthest))
                    }
                }
            }
        }
        div.scroll tabindex="0" role="region" aria-label="Scan angles by target and telescope" {
            table {
                caption { "Spread of psi and zeta: |<exp(i n psi)>| by time in view, 0 for evenly spread, 1 for all the same" }
                thead { tr {
                    th scope="col" { "target" } th scope="col" { "telescope" } th.num scope="col" { "passes" }
                    th.num scope="col" { "time (h)" }
                    @for order in ORDERS { th.num scope="col" { "psi, n = " (n(order)) } }
                    th.num scope="col" { "sectors hit" }
                    th.num scope="col" { "zeta, n = 1" } th.num scope="col" { "sectors hit" }
                    th.num scope="col" { "impact (deg)" }
                } }
                tbody { @for &target in &targets {
                    (row(names.targets[target], "all", &passes(target, None)))
                    @if names.telescopes.len() > 1 {
                        @for (index, telescope) in names.telescopes.iter().enumerate() {
                            @let here = passes(target, Some(index));
                            @if !here.is_empty() { (row(names.targets[target], telescope, &here)) }
                        }
                    }
                } }
            }
        }
    }
}

fn row(target: &str, telescope: &str, passes: &[&SessionTransit]) -> Markup {
    let hit = |angle| sectors(passes, angle).iter().filter(|it| **it > 0.0).count();
    let told = |angle, order| {
        resultant(passes, angle, order)
            .map_or_else(|| "\u{2013}".to_owned(), |it| format!("{it:.3}"))
    };
    let impacts = || passes.iter().map(|it| it.impact_deg);
    let (least, most) = (impacts().fold(f64::MAX, f64::min), impacts().fold(f64::MIN, f64::max));
    html! { tr {
        th scope="row" { (target) } td { (telescope) } td.num { (grouped(passes.len())) }
        td.num { (format!("{:.2}", total(passes.iter().map(|it| it.dwell_s)) / 3600.0)) }
        @for order in ORDERS { td.num { (told(PSI, order)) } }
        td.num { (hit(PSI)) " of " (SECTORS) }
        td.num { (told(ZETA, 1.0)) }
        td.num { (hit(ZETA)) " of " (SECTORS) }
        td.num { @if passes.is_empty() { "\u{2013}" } @else { (format!("{least:.2} to {most:.2}")) } }
    } }
}

/// `|<exp(i n psi)>|` by dwell; none without any.
fn resultant(passes: &[&SessionTransit], angle: Angle, order: f64) -> Option<f64> {
    let angle = |it: &SessionTransit| order * angle(it).to_radians();
    let time = total(passes.iter().map(|it| it.dwell_s));
    let c = total(passes.iter().map(|it| it.dwell_s * angle(it).cos()));
    let s = total(passes.iter().map(|it| it.dwell_s * angle(it).sin()));
    (time > 0.0).then(|| c.hypot(s) / time)
}

/// Time in each sector, the first from east towards north.
fn sectors(passes: &[&SessionTransit], angle: Angle) -> Vec<f64> {
    let mut times = vec![0.0; SECTORS];
    for it in passes {
        let turn = angle(it).rem_euclid(360.0) / 360.0 * real(SECTORS);
        let sector = (0..SECTORS).rfind(|&sector| real(sector) <= turn).unwrap_or(0);
        times[sector] += it.dwell_s;
    }
    times
}

fn rose(target: &str, passes: &[&SessionTransit]) -> Markup {
    let times = sectors(passes, PSI);
    let most = times.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let place = |sector: usize, radius: f64| {
        let angle = std::f64::consts::TAU * real(sector) / real(SECTORS);
        format!("{} {}", n(radius * angle.cos()), n(-radius * angle.sin()))
    };
    let mut wedges = String::new();
    for (sector, time) in times.iter().enumerate().filter(|it| *it.1 > 0.0) {
        let radius = RADIUS * (time / most).sqrt();
        let r = n(radius);
        let (from, to) = (place(sector, radius), place(sector + 1, radius));
        let _ = write!(wedges, "M0 0L{from}A{r} {r} 0 0 0 {to}Z");
    }
    let told: Vec<String> = ORDERS
        .iter()
        .filter_map(|&order| Some(format!("{:.2}", resultant(passes, PSI, order)?)))
        .collect();
    html! {
        svg viewBox="-130 -122 260 264" role="img" aria-label={ (target) ": scan angles; |<exp(i n psi)>| for n = 1, 2, 4 is " (told.join(", ")) } {
            circle.grid r=(n(RADIUS)) {}
            circle.grid r=(n(RADIUS * 0.5_f64.sqrt())) {}
            path.grid d={ "M-" (n(RADIUS)) " 0H" (n(RADIUS)) "M0 -" (n(RADIUS)) "V" (n(RADIUS)) } {}
            path.used d=(PreEscaped(wedges)) {}
            text x="104" y="4" { "E" }
            text.mid x="0" y="-106" { "N" }
            text.end x="-104" y="4" { "W" }
            text.mid x="0" y="115" { "S" }
            text.mid x="0" y="136" { "n = 1, 2, 4: " (told.join(", ")) }
        }
    }
}

/// Time in each bin of the impact, from -farthest to farthest.
fn offsets(passes: &[&SessionTransit], farthest: f64) -> Vec<f64> {
    let mut times = vec![0.0; BINS];
    for it in passes {
        let place =
            f64::midpoint(it.impact_deg / farthest.max(f64::MIN_POSITIVE), 1.0) * real(BINS);
        let bin = (0..BINS).rfind(|&bin| real(bin) <= place).unwrap_or(0);
        times[bin] += it.dwell_s;
    }
    times
}

fn impacts(target: &str, passes: &[&SessionTransit], farthest: f64) -> Markup {
    let times = offsets(passes, farthest);
    let most = times.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let shares: Vec<f64> = times.iter().map(|it| it / most).collect();
    let (width, height) = STRIP;
    let hit = times.iter().filter(|it| **it > 0.0).count();
    html! {
        svg viewBox={ "-10 -4 " (n(width + 20.0)) " " (n(height + 24.0)) } role="img"
            aria-label={ (target) ": time in view by impact, " (hit) " of " (BINS) " bins from " (format!("{:.1}", -farthest)) " to " (format!("{farthest:.1}")) " deg hit" } {
            path.grid d={ "M0 " (n(height)) "H" (n(width)) "M" (n(width / 2.0)) " 0V" (n(height)) } {}
            path.used d=(PreEscaped(steps(&shares, STRIP))) {}
            text x="0" y=(n(height + 16.0)) { (format!("{:.1}", -farthest)) }
            text.mid x=(n(width / 2.0)) y=(n(height + 16.0)) { "impact (deg)" }
            text.end x=(n(width)) y=(n(height + 16.0)) { (format!("{farthest:.1}")) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pass(psi_deg: f64, dwell_s: f64) -> SessionTransit {
        SessionTransit {
            detector: String::new(),
            entry_tdb: String::new(),
            exit_tdb: String::new(),
            entry_tai_ns: 0,
            exit_tai_ns: 0,
            closest_tai_ns: 0,
            dwell_s,
            min_separation_deg: 0.0,
            psi_deg,
            scan_beam_angle_deg: 0.0,
            impact_deg: 0.0,
            hwp_deg: None,
        }
    }

    #[test]
    fn opposite_scans_cancel_at_one_and_agree_at_two() {
        let passes = [pass(30.0, 2.0), pass(-150.0, 2.0)];
        let passes: Vec<&SessionTransit> = passes.iter().collect();
        assert!(resultant(&passes, PSI, 1.0).unwrap() < 1e-12);
        assert!((resultant(&passes, PSI, 2.0).unwrap() - 1.0).abs() < 1e-12);
        assert!(resultant(&[], PSI, 1.0).is_none());
    }

    #[test]
    fn every_impact_has_its_bin() {
        for (impact, bin) in [(-2.0, 0), (-1e-9, 13), (0.0, 14), (1.999, 27), (2.0, 27)] {
            let mut it = pass(0.0, 3.0);
            it.impact_deg = impact;
            let times = offsets(&[&it], 2.0);
            assert!((times[bin] - 3.0).abs() < 1e-12, "{impact}");
        }
        let still = pass(0.0, 1.0);
        assert!((total(offsets(&[&still], 0.0).into_iter()) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn every_angle_has_its_sector() {
        let angles =
            [(0.0, 0), (9.99, 0), (10.0, 1), (90.0, 9), (180.0, 18), (-10.0, 35), (-1e-20, 35)];
        for (psi, sector) in angles {
            let times = sectors(&[&pass(psi, 1.0)], PSI);
            assert!(times[sector] > 0.0, "{psi}");
        }
    }
}
