//! Drawings under names, written into folders.

use super::write_folder;
use crate::failure::Failure;
use pictures::Drawing;
use rayon::prelude::*;
use std::path::Path;

/// A drawing and the stem of its file's name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// The file's name without its extension.
    pub stem: String,
    /// What is drawn.
    pub drawing: Drawing,
}

/// Names and contents.
type Files = Vec<(String, Vec<u8>)>;

/// Writes figures into the folders for PNG and for SVG, each folder whole; names what was written.
///
/// # Errors
/// [`Failure`] names the folder that cannot be written.
pub fn write_figures(
    [png, svg]: [Option<&Path>; 2],
    figures: &[Figure],
) -> Result<Vec<String>, Failure> {
    let pixels = |figure: &Figure| figure.drawing.png().map_err(Failure::from);
    let lines = |figure: &Figure| Ok(figure.drawing.svg().as_bytes().to_vec());
    let files = |extension: &str, bytes: &(dyn Fn(&Figure) -> Result<Vec<u8>, Failure> + Sync)| {
        let file = |figure: &Figure| Ok((format!("{}.{extension}", figure.stem), bytes(figure)?));
        figures.par_iter().map(file).collect::<Result<Vec<_>, Failure>>()
    };
    let mut folders: Vec<(&Path, Files)> = Vec::new();
    if let Some(folder) = png {
        folders.push((folder, files("png", &pixels)?));
    }
    if let Some(folder) = svg {
        let drawn = files("svg", &lines)?;
        match folders.iter_mut().find(|(other, _)| *other == folder) {
            Some((_, files)) => files.extend(drawn),
            None => folders.push((folder, drawn)),
        }
    }
    let mut written = Vec::new();
    for (folder, files) in &folders {
        let files: Vec<(&str, &[u8])> =
            files.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice())).collect();
        write_folder(folder, &files)?;
        written.extend(files.iter().map(|(name, _)| folder.join(name).display().to_string()));
    }
    Ok(written)
}
