//! The committed corpus holds every seed, byte for byte, and nothing in it breaks a rule.

use fuzz::seeds::seeds;
use std::fs;
use std::path::{Path, PathBuf};

type Run = fn(&[u8]);

const TARGETS: [(&str, Run); 8] = [
    ("container", fuzz::container::run),
    ("ephemeris", fuzz::ephemeris::run),
    ("mission", fuzz::mission::run),
    ("plan", fuzz::plan::run),
    ("records", fuzz::records::run),
    ("slots", fuzz::slots::run),
    ("sequencer", fuzz::sequencer::run),
    ("telemetry", fuzz::telemetry::run),
];

fn folder(target: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target)
}

/// `UPDATE_CORPUS=1` writes the seeds anew.
#[test]
fn the_seeds_are_what_the_generator_makes() {
    for seed in seeds() {
        let path = folder(seed.target).join(seed.name);
        if std::env::var_os("UPDATE_CORPUS").is_some() {
            fs::create_dir_all(folder(seed.target)).unwrap();
            fs::write(&path, &seed.bytes).unwrap();
        }
        assert_eq!(fs::read(&path).ok(), Some(seed.bytes), "{}", path.display());
    }
}

#[test]
fn no_file_of_the_corpus_breaks_a_rule() {
    let mut size = 0;
    for (target, run) in TARGETS {
        let mut files = 0;
        for file in fs::read_dir(folder(target)).unwrap() {
            let bytes = fs::read(file.unwrap().path()).unwrap();
            size += bytes.len();
            files += 1;
            run(&bytes);
        }
        assert!(files >= 2, "{target} has {files} files");
    }
    assert!(size < 200 * 1024, "the corpus has {size} bytes");
}
