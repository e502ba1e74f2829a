//! At which angles do the used passes cross each target.
//!
//! Angles are psi at closest approach, zero at east, towards north; each pass counts by its dwell.
//! `|<exp(i n psi)>|` is 0 where angles are spread evenly in the sense of n, 1 where all are the same:
//! what cross-linking leaves of a spin-n systematic.

use super::Source;
use super::names::{Names, grouped, real, total};
use super::plot::{colour, n};
use crate::timeline::SessionTransit;
use maud::{Markup, PreEscaped, html};
use std::fmt::Write;

/// Sectors of a full turn.
const SECTORS: usize = 36;
const RADIUS: f64 = 100.0;
/// The multiples of psi that are told.
const ORDERS: [f64; 3] = [1.0, 2.0, 4.0];

pub(super) fn section(source: &Source, names: &Names) -> Markup {
    let passes = |target: usize, telescope: Option<usize>| -> Vec<&SessionTransit> {
        let sessions = source.timeline.sessions.iter().filter(|it| {
            it.target == names.targets[target]
                && telescope.is_none_or(|index| it.telescope == names.telescopes[index])
        });
        sessions.flat_map(|it| &it.transits).collect()
    };
    let targets: Vec<usize> = (0..names.targets.len()).collect();
    html! {
        p { "Crossing angle psi of the used passes, by time in view; east is to the right, north up. Sectors have areas in proportion to time." }
        div.panels.small {
            @for &target in &targets {
                @let here = passes(target, None);
                figure class={ "panel " (colour(target)) } {
                    figcaption { span.swatch aria-hidden="true" {} (names.targets[target]) ": " (grouped(here.len())) @if here.len() == 1 { " pass" } @else { " passes" } }
                    @if here.is_empty() { p.none { "No pass is used." } }
                    @else { (rose(names.targets[target], &here)) }
                }
            }
        }
        div.scroll tabindex="0" role="region" aria-label="Scan angles by target and telescope" {
            table {
                caption { "Spread of psi: |<exp(i n psi)>| by time in view, 0 for evenly spread, 1 for all the same" }
                thead { tr {
                    th scope="col" { "target" } th scope="col" { "telescope" } th.num scope="col" { "passes" }
                    th.num scope="col" { "time (h)" }
                    th.num scope="col" { "n = 1" } th.num scope="col" { "n = 2" } th.num scope="col" { "n = 4" }
                    th.num scope="col" { "sectors hit" }
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
    let hit = sectors(passes).iter().filter(|it| **it > 0.0).count();
    html! { tr {
        th scope="row" { (target) } td { (telescope) } td.num { (grouped(passes.len())) }
        td.num { (format!("{:.2}", total(passes.iter().map(|it| it.dwell_s)) / 3600.0)) }
        @for order in ORDERS {
            td.num { (resultant(passes, order).map_or_else(|| "\u{2013}".to_owned(), |it| format!("{it:.3}"))) }
        }
        td.num { (hit) " of " (SECTORS) }
    } }
}

/// `|<exp(i n psi)>|` by dwell; none without any.
fn resultant(passes: &[&SessionTransit], order: f64) -> Option<f64> {
    let angle = |it: &SessionTransit| order * it.psi_deg.to_radians();
    let time = total(passes.iter().map(|it| it.dwell_s));
    let c = total(passes.iter().map(|it| it.dwell_s * angle(it).cos()));
    let s = total(passes.iter().map(|it| it.dwell_s * angle(it).sin()));
    (time > 0.0).then(|| c.hypot(s) / time)
}

/// Time in each sector, the first from east towards north.
fn sectors(passes: &[&SessionTransit]) -> Vec<f64> {
    let mut times = vec![0.0; SECTORS];
    for it in passes {
        let turn = it.psi_deg.rem_euclid(360.0) / 360.0 * real(SECTORS);
        let sector = (0..SECTORS).rfind(|&sector| real(sector) <= turn).unwrap_or(0);
        times[sector] += it.dwell_s;
    }
    times
}

fn rose(target: &str, passes: &[&SessionTransit]) -> Markup {
    let times = sectors(passes);
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
        .filter_map(|&order| Some(format!("{:.2}", resultant(passes, order)?)))
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
        assert!(resultant(&passes, 1.0).unwrap() < 1e-12);
        assert!((resultant(&passes, 2.0).unwrap() - 1.0).abs() < 1e-12);
        assert!(resultant(&[], 1.0).is_none());
    }

    #[test]
    fn every_angle_has_its_sector() {
        let angles =
            [(0.0, 0), (9.99, 0), (10.0, 1), (90.0, 9), (180.0, 18), (-10.0, 35), (-1e-20, 35)];
        for (psi, sector) in angles {
            let times = sectors(&[&pass(psi, 1.0)]);
            assert!(times[sector] > 0.0, "{psi}");
        }
    }
}
