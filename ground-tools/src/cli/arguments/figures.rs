//! Into which folders pictures go, and in which form.

use clap::Args;
use std::path::{Path, PathBuf};

/// Folders for pictures.
#[derive(Debug, Clone, Args)]
pub struct FigureArgs {
    /// A folder for pictures as PNG
    #[arg(long, value_name = "DIR")]
    pub png: Option<PathBuf>,
    /// A folder for pictures as SVG
    #[arg(long, value_name = "DIR")]
    pub svg: Option<PathBuf>,
}

impl FigureArgs {
    /// Whether any pictures are asked for.
    #[must_use]
    pub const fn asked(&self) -> bool {
        self.png.is_some() || self.svg.is_some()
    }

    /// The folders for PNG and for SVG.
    #[must_use]
    pub fn folders(&self) -> [Option<&Path>; 2] {
        [self.png.as_deref(), self.svg.as_deref()]
    }
}
