//! The options of `systematics`.

use super::figures::FigureArgs;
use super::meaning::meaning;
use super::sight::SightArgs;
use clap::{ArgAction, Args};
use std::path::PathBuf;

/// `systematics`.
#[derive(Debug, Clone, Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is an option of its own")]
#[command(mut_args(meaning(&[
    ("png", "DIR", "A folder for the spectra and the residual's maps as PNG"),
    ("svg", "DIR", "A folder for the spectra and the residual's maps as SVG"),
])))]
pub struct SystematicsArgs {
    /// An effect with its parameters: pointing:rho=1arcmin,chi=0deg; again and again
    #[arg(long, value_name = "NAME:KEY=VALUE,...", action = ArgAction::Append, required = true,
          allow_hyphen_values = true)]
    pub effect: Vec<String>,
    /// The map's resolution, a power of two up to 1024
    #[arg(long, value_name = "N", default_value_t = 128)]
    pub nside: u32,
    /// Sampling rate in Hz; without it the mission's
    #[arg(long, value_name = "HZ", allow_hyphen_values = true)]
    pub rate: Option<String>,
    /// Maps in galactic coordinates, not ecliptic ones
    #[arg(long)]
    pub galactic: bool,
    /// The orientation functions of an earlier `survey --moment ... --out FILE` instead of a new one
    #[arg(long, value_name = "FITS", conflicts_with_all = ["nside", "rate", "galactic", "tod"])]
    pub survey: Option<PathBuf>,
    /// The lines of sight.
    #[command(flatten)]
    pub sight: SightArgs,
    /// Beam through which the CMB is seen, full width at half maximum
    #[arg(long, value_name = "ANGLE", default_value = "17.9arcmin", allow_hyphen_values = true)]
    pub fwhm: String,
    /// Last degree of the CMB that effects act on, up to 600
    #[arg(long, value_name = "L", default_value_t = 383)]
    pub cmb_lmax: usize,
    /// One CMB sky of this seed instead of the mean over all; with --realisations the first seed
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Also so many CMB skies one by one: how far delta r scatters about that of the mean
    #[arg(long, value_name = "N", conflicts_with = "sky",
          value_parser = clap::value_parser!(u32).range(2..=10_000))]
    pub realisations: Option<u32>,
    /// A sky for all effects instead: FITS of I, Q, U in uK, or lines `field,l,m,real,imaginary`
    #[arg(long, value_name = "FILE", conflicts_with = "seed")]
    pub sky: Option<PathBuf>,
    /// The dipole's amplitude in uK and the galactic place of its warm pole instead of the solar one
    #[arg(long, value_name = "UK,LON,LAT", allow_hyphen_values = true)]
    pub dipole: Option<String>,
    /// First and last degree from which r is estimated
    #[arg(long, value_name = "LO:HI", default_value = "2:191")]
    pub degrees: String,
    /// Tensors with the consistency relation's tilt, -1/8 at r = 1, not with 0
    #[arg(long)]
    pub consistency: bool,
    /// White noise of the polarisation in uK arcmin, seen through the beam, beside lensing
    #[arg(long, value_name = "N", default_value = "0", allow_hyphen_values = true)]
    pub noise: String,
    /// Share of the sky from which r is estimated: it enters the error of r alone
    #[arg(long, value_name = "F", default_value = "1", allow_hyphen_values = true)]
    pub f_sky: String,
    /// Also delta r of the effect on T alone and on E and B alone
    #[arg(long)]
    pub parts: bool,
    /// Iterations of the harmonic transform of a residual
    #[arg(long, value_name = "N", default_value_t = 0,
          value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(0..=20))]
    pub iterations: usize,
    /// The same signal sample by sample through map-making, and how far its spectra are off
    #[arg(long)]
    pub tod: bool,
    /// A folder for the residual's maps as FITS
    #[arg(long, value_name = "DIR")]
    pub maps: Option<PathBuf>,
    /// The figure.
    #[command(flatten)]
    pub figures: FigureArgs,
}
