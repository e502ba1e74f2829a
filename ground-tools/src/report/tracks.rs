//! Where do the targets stand as the telescope sees the Sun: their angle from the anti-Sun axis, against
//! the ring that lines of sight sweep.
//!
//! Frame: the anti-Sun axis points from the Sun to the spacecraft. The spin axis keeps alpha from it; a
//! direction at beta from the spin axis sweeps the ring from abs(alpha - beta) to alpha + beta (what lies
//! beyond 180 deg comes back from there). A telescope's ring is its line of sight's, widened by its
//! field of view's reach.
//!
//! Method: geometry of the mission's own sky at equal steps.

use super::names::real;
use super::plot::{TimeAxis, colour, dashes, n, path};
use super::source::Source;
use crate::failure::Failure;
use maud::{Markup, PreEscaped, html};
use onboard_core::direction::Direction;
use onboard_core::frame::Boresight;
use onboard_core::time::Duration;
use std::f64::consts::PI;

/// Steps of a track.
const STEPS: usize = 400;
const PLOT: (f64, f64) = (900.0, 360.0);
const LEFT: f64 = 58.0;
const RIGHT: f64 = 110.0;
const ABOVE: f64 = 14.0;
const BELOW: f64 = 46.0;

/// A ring about the anti-Sun axis, in radians.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ring {
    inner: f64,
    outer: f64,
}

pub(super) fn section(source: &Source) -> Result<Markup, Failure> {
    let world = source.world;
    let axis = TimeAxis { start: world.start, end: world.end };
    let length = world.end.since(world.start).seconds();
    let mut tracks: Vec<Vec<f64>> = vec![Vec::new(); world.targets.len()];
    let sun_model = world.sun(source.table)?;
    for step in 0..=STEPS {
        let at = world.start.plus(Duration::from_seconds(length * real(step) / real(STEPS)));
        let at = at.min(world.end);
        let sun = sun_model.state(world.zero(), at);
        let sun = sun.map_err(planner::world::TableFault)?;
        for (track, target) in tracks.iter_mut().zip(&world.targets) {
            let place = world.sky.direction(target, at).map_err(Failure::input)?;
            track.push(place.separation_rad(sun.direction));
        }
    }
    let bore = ring(source, Direction::Z, 0.0);
    let all = source
        .offers
        .lines
        .iter()
        .map(|line| ring(source, line.field.centre(), line.field.reach_rad()))
        .fold(bore, |a, b| Ring { inner: a.inner.min(b.inner), outer: a.outer.max(b.outer) });
    Ok(html! {
        p {
            "Angle of each target from the anti-Sun axis. Lines of sight can reach the shaded ring: dark "
            (degrees(bore.inner)) " to " (degrees(bore.outer)) " deg for the mission boresight, pale "
            (degrees(all.inner)) " to " (degrees(all.outer)) " deg for the telescopes' fields of view. A target outside is not seen."
        }
        figure.scroll tabindex="0" aria-label="Sky tracks" {
            (figure(source, &axis, &tracks, (bore, all)))
        }
        (in_reach(source, &tracks, (bore, all)))
    })
}

/// What a direction, widened by a reach, sweeps.
fn ring(source: &Source, direction: Direction<Boresight>, reach: f64) -> Ring {
    let scan = &source.world.scan;
    let beta = scan.boresight_in_spin().apply(direction).separation_rad(Direction::Z);
    let alpha = scan.parameters().alpha_rad;
    let sum = alpha + beta;
    let far = if sum > PI { 2.0 * PI - sum } else { sum };
    let (low, high) = ((alpha - beta).abs(), far);
    let outer = if sum + reach > PI { PI } else { high + reach };
    Ring { inner: (low.min(high) - reach).max(0.0), outer: outer.max(low + reach).min(PI) }
}

fn degrees(angle: f64) -> String {
    n((angle.to_degrees() * 10.0).round() / 10.0)
}

fn figure(
    source: &Source,
    axis: &TimeAxis,
    tracks: &[Vec<f64>],
    (bore, all): (Ring, Ring),
) -> Markup {
    let (width, height) = PLOT;
    let y = |angle: f64| height * (1.0 - angle / PI);
    let x = |step: usize| width * real(step) / real(STEPS);
    let band = |ring: Ring| (n(y(ring.outer)), n(y(ring.inner) - y(ring.outer)));
    let ends = spread(&tracks.iter().map(|it| y(it[STEPS])).collect::<Vec<_>>());
    html! {
        svg.tracks viewBox={ "0 0 " (n(LEFT + width + RIGHT)) " " (n(ABOVE + height + BELOW)) } role="img"
            aria-label="Angle of each target from the anti-Sun axis over the mission" {
            g transform={ "translate(" (n(LEFT)) " " (n(ABOVE)) ")" } {
                @for (class, ring) in [("reach", all), ("ring", bore)] {
                    @let (top, tall) = band(ring);
                    rect class=(class) x="0" y=(top) width=(n(width)) height=(tall) {}
                }
                @for angle in [0.0_f64, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0] {
                    @let at = n(y(angle.to_radians()));
                    path.grid d={ "M0 " (at) "H" (n(width)) } {}
                    text.end x="-8" y=(at) dy="4" { (angle) "\u{b0}" }
                }
                @for (share, text) in axis.ticks() {
                    path.axis d={ "M" (n(share * width)) " " (n(height)) "v5" } {}
                    text.mid x=(n(share * width)) y=(n(height + 20.0)) { (text) }
                }
                path.axis d={ "M0 0V" (n(height)) "H" (n(width)) } {}
                text.mid x=(n(width / 2.0)) y=(n(height + 40.0)) { "date (UTC)" }
                text.mid transform={ "translate(-46 " (n(height / 2.0)) ") rotate(-90)" } { "angle from the anti-Sun axis" }
                @for (index, track) in tracks.iter().enumerate() {
                    @let points = track.iter().enumerate().map(|(step, angle)| (x(step), y(*angle)));
                    path class={ "line " (colour(index)) } stroke-dasharray=(dashes(index)) d=(PreEscaped(path(points))) {}
                }
                @for (index, at) in ends.iter().enumerate() {
                    path class={ "line " (colour(index)) } stroke-dasharray=(dashes(index)) d={ "M" (n(width + 6.0)) " " (n(*at)) "h26" } {}
                    text x=(n(width + 37.0)) y=(n(*at)) dy="4" { (source.world.targets[index].name()) }
                }
            }
        }
    }
}

/// Places of words near the ends of their lines, a line of text apart.
fn spread(wanted: &[f64]) -> Vec<f64> {
    const APART: f64 = 17.0;
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by(|&a, &b| wanted[a].total_cmp(&wanted[b]));
    let mut places = wanted.to_vec();
    let mut least = f64::NEG_INFINITY;
    for &index in &order {
        places[index] = places[index].max(least);
        least = places[index] + APART;
    }
    let mut most = PLOT.1;
    for &index in order.iter().rev() {
        places[index] = places[index].min(most);
        most = places[index] - APART;
    }
    places
}

/// How much of the mission each target is in reach.
fn in_reach(source: &Source, tracks: &[Vec<f64>], (bore, all): (Ring, Ring)) -> Markup {
    let share = |track: &[f64], ring: Ring| {
        let inside = track.iter().filter(|it| (ring.inner..=ring.outer).contains(*it)).count();
        format!("{:.0} %", 100.0 * real(inside) / real(track.len()))
    };
    let range = |track: &[f64]| {
        let low = track.iter().copied().fold(f64::INFINITY, f64::min);
        let high = track.iter().copied().fold(0.0, f64::max);
        format!("{} to {}", degrees(low), degrees(high))
    };
    html! {
        div.scroll tabindex="0" role="region" aria-label="Targets in reach" {
            table {
                caption { "Share of the mission in reach" }
                thead { tr {
                    th scope="col" { "target" } th.num scope="col" { "of the boresight" }
                    th.num scope="col" { "of any telescope" } th.num scope="col" { "angle (deg)" }
                } }
                tbody { @for (target, track) in source.world.targets.iter().zip(tracks) {
                    tr {
                        th scope="row" { (target.name()) } td.num { (share(track, bore)) }
                        td.num { (share(track, all)) } td.num { (range(track)) }
                    }
                } }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_stand_apart_and_within() {
        let places = spread(&[100.0, 101.0, 359.0, 358.0, 0.0]);
        let mut sorted = places.clone();
        sorted.sort_by(f64::total_cmp);
        assert!(sorted.windows(2).all(|pair| pair[1] - pair[0] > 16.99));
        assert!(sorted.iter().all(|it| (0.0..=PLOT.1).contains(it)));
    }
}
