//! Where are the compiler for the target, its linker, and the emulator.
//!
//! First the folder that `GYRFALCON_THUMB` names (default `target/thumb`), as
//! `tests/firmware/toolchain.sh` fills it; then rustup's target with QEMU on the PATH.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The command that brings the tools.
pub const HOW_TO_ENABLE: &str = "tests/firmware/toolchain.sh target/thumb enables it";
/// The target of both cores.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// Programs, each with its path.
#[derive(Debug)]
pub struct Toolchain {
    /// A compiler with libcore for [`TARGET`].
    pub rustc: PathBuf,
    /// rustup's linker.
    pub linker: PathBuf,
    /// `qemu-system-arm`.
    pub qemu: PathBuf,
}

/// The repository's root.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

impl Toolchain {
    /// The tools, or what is missing.
    pub fn find() -> Result<Self, String> {
        let folder = std::env::var_os("GYRFALCON_THUMB")
            .map_or_else(|| root().join("target/thumb"), |folder| root().join(folder));
        let own = folder.join("rustc");
        let (rustc, qemu) = if own.is_file() {
            (own, folder.join("qemu-system-arm"))
        } else if has_core() {
            (PathBuf::from("rustc"), PathBuf::from("qemu-system-arm"))
        } else {
            return Err(format!(
                "there is no compiler for {TARGET}, neither {} nor rustup's: {HOW_TO_ENABLE}",
                own.display()
            ));
        };
        if stdout(&qemu, &["--version"]).is_none() {
            return Err(format!("{} does not run: {HOW_TO_ENABLE}", qemu.display()));
        }
        let linker = linker().ok_or("rust-lld is not in the sysroot of rustc")?;
        Ok(Self { rustc, linker, qemu })
    }
}

/// Whether rustc on the PATH has libcore for the target.
fn has_core() -> bool {
    let folder = stdout(Path::new("rustc"), &["--print", "target-libdir", "--target", TARGET]);
    let entries = folder.and_then(|folder| std::fs::read_dir(folder).ok());
    entries
        .into_iter()
        .flatten()
        .flatten()
        .any(|entry| entry.file_name().to_str().is_some_and(|name| name.starts_with("libcore")))
}

fn linker() -> Option<PathBuf> {
    let sysroot = stdout(Path::new("rustc"), &["--print", "sysroot"])?;
    let version = stdout(Path::new("rustc"), &["-vV"])?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: "))?;
    let linker = Path::new(&sysroot).join("lib/rustlib").join(host).join("bin/rust-lld");
    linker.is_file().then_some(linker)
}

/// What a program prints, without the last line's end; `None` where it fails.
fn stdout(program: &Path, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).current_dir(root()).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim_end().to_owned())
}
