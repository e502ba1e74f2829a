//! Building the firmware for a core, and running it on QEMU's board with that core.

use crate::input::Input;
use crate::toolchain::{TARGET, Toolchain, root};
use libtest_mimic::Failed;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Mutex;

/// A core and how the firmware is built for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Core {
    /// Cortex-M7, doubles in hardware, opt-level 3.
    M7,
    /// The same at opt-level s.
    M7ForSize,
    /// Cortex-M4F, doubles in software, opt-level 3.
    M4F,
}

impl Core {
    const fn cpu(self) -> &'static str {
        match self {
            Self::M7 | Self::M7ForSize => "cortex-m7",
            Self::M4F => "cortex-m4",
        }
    }

    const fn board(self) -> &'static str {
        match self {
            Self::M7 | Self::M7ForSize => "mps2-an500",
            Self::M4F => "mps2-an386",
        }
    }

    const fn opt_level(self) -> &'static str {
        match self {
            Self::M7 | Self::M4F => "profile.release.opt-level=3",
            Self::M7ForSize => "profile.release.opt-level=\"s\"",
        }
    }
}

/// One build at a time: they share a folder, and with it the crates of the host.
static BUILDING: Mutex<()> = Mutex::new(());

/// Where files and builds of these tests lie.
pub fn work_folder() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("cortex-m")
}

/// Runs the firmware on `input` and returns what it wrote; with `counted`, one instruction takes one
/// ns of the board's time.
pub fn run(tools: &Toolchain, core: Core, input: &Input, counted: bool) -> Result<Vec<u8>, Failed> {
    let name = format!("{core:?}{}", if counted { "-counted" } else { "" });
    let folder = work_folder().join(name);
    fs::create_dir_all(&folder)?;
    let firmware = folder.join("firmware.elf");
    build(tools, core, &firmware)?;
    fs::write(folder.join("vectors.in"), &input.bytes)?;
    let written = folder.join("vectors.out");
    if written.exists() {
        fs::remove_file(&written)?;
    }
    let mut qemu = Command::new(&tools.qemu);
    qemu.current_dir(&folder)
        .args(["-M", core.board(), "-display", "none", "-monitor", "none", "-serial", "none"])
        .args(["-semihosting-config", "enable=on,target=native", "-kernel", "firmware.elf"]);
    if counted {
        qemu.args(["-icount", "shift=0"]);
    }
    let output = qemu.output()?;
    match output.status.code() {
        Some(0) => Ok(fs::read(written)?),
        Some(3) => Err("the firmware refuses the vector file as malformed".into()),
        _ => Err(told(&format!("the firmware failed on {core:?}"), &output)),
    }
}

fn build(tools: &Toolchain, core: Core, firmware: &Path) -> Result<(), Failed> {
    let Ok(_alone) = BUILDING.lock() else { return Err("another build panicked".into()) };
    let source = root().canonicalize()?.join("tests/firmware");
    let target = work_folder().join("target");
    let flags = [
        format!("-Clinker={}", tools.linker.display()),
        format!("-Clink-arg=-T{}", source.join("link.x").display()),
        format!("-Clink-arg=-L{}", source.join("boards").join(core.board()).display()),
        format!("-Ctarget-cpu={}", core.cpu()),
    ];
    let output = Command::new(env!("CARGO"))
        .args(["build", "--locked", "--release", "--bin", "firmware", "--target", TARGET])
        .args(["--config", core.opt_level()])
        .arg("--manifest-path")
        .arg(source.join("Cargo.toml"))
        .arg("--target-dir")
        .arg(&target)
        .env("RUSTC", &tools.rustc)
        .env("CARGO_ENCODED_RUSTFLAGS", flags.join("\u{1f}"))
        .env_remove("RUSTC_WRAPPER")
        .env_remove("RUSTC_WORKSPACE_WRAPPER")
        .output()?;
    if !output.status.success() {
        return Err(told(&format!("the firmware does not build for {core:?}"), &output));
    }
    fs::copy(target.join(TARGET).join("release/firmware"), firmware)?;
    Ok(())
}

/// Builds a program of its own with the container that it flies, and returns what it prints.
pub fn run_alone(
    tools: &Toolchain,
    core: Core,
    program: &str,
    uplink: &Path,
) -> Result<String, Failed> {
    let Ok(_alone) = BUILDING.lock() else { return Err("another build panicked".into()) };
    let source = root().canonicalize()?.join(program);
    let target = work_folder().join(program);
    let flags = [
        format!("-Clinker={}", tools.linker.display()),
        "-Clink-arg=-Tlink.x".into(),
        format!("-Ctarget-cpu={}", core.cpu()),
    ];
    let output = Command::new(env!("CARGO"))
        .args(["build", "--locked", "--release", "--target", TARGET, "--manifest-path"])
        .arg(source.join("Cargo.toml"))
        .arg("--target-dir")
        .arg(&target)
        .env("GYRFALCON_UPLINK", uplink)
        .env("RUSTC", &tools.rustc)
        .env("CARGO_ENCODED_RUSTFLAGS", flags.join("\u{1f}"))
        .env_remove("RUSTC_WRAPPER")
        .env_remove("RUSTC_WORKSPACE_WRAPPER")
        .output()?;
    if !output.status.success() {
        return Err(told(&format!("{program} does not build"), &output));
    }
    let name = source.file_name().ok_or("a program without a name")?;
    let output = Command::new(&tools.qemu)
        .args(["-M", core.board(), "-display", "none", "-monitor", "none", "-serial", "none"])
        .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
        .arg(target.join(TARGET).join("release").join(name))
        .output()?;
    if !output.status.success() {
        return Err(told(&format!("{program} failed"), &output));
    }
    // The console of semihosting is the emulator's standard error or output, as it was built.
    let said = [output.stdout, output.stderr].concat();
    Ok(String::from_utf8(said)?)
}

fn told(what: &str, output: &Output) -> Failed {
    format!("{what} ({}):\n{}", output.status, String::from_utf8_lossy(&output.stderr)).into()
}
