//! The options of `systematics`.

use super::figures::FigureArgs;
use super::meaning::meaning;
use super::sight::SightArgs;
use clap::{ArgAction, Args};
use std::path::PathBuf;

/// `systematics`.
#[derive(Debug, Clone, Args)]
#[command(mut_args(meaning(&[
    ("png", "DIR", "A folder for the figure of the spectra as PNG"),
    ("svg", "DIR", "A folder for the figure of the spectra as SVG"),
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
    /// The lines of sight.
    #[command(flatten)]
    pub sight: SightArgs,
    /// Beam through which the CMB is seen, full width at half maximum
    #[arg(long, value_name = "ANGLE", default_value = "17.9arcmin")]
    pub fwhm: String,
    /// Last degree of the CMB that effects act on, up to 600
    #[arg(long, value_name = "L", default_value_t = 383)]
    pub cmb_lmax: usize,
    /// One CMB sky of this seed instead of the mean over all
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// A sky for all effects instead: FITS of I, Q, U in uK, or lines `field,l,m,real,imaginary`
    #[arg(long, value_name = "FILE", conflicts_with = "seed")]
    pub sky: Option<PathBuf>,
    /// First and last degree from which r is estimated
    #[arg(long, value_name = "LO:HI", default_value = "2:191")]
    pub degrees: String,
    /// Tensors with the consistency relation's tilt, -1/8 at r = 1, not with 0
    #[arg(long)]
    pub consistency: bool,
    /// Iterations of the harmonic transform of a residual
    #[arg(long, value_name = "N", default_value_t = 0)]
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
