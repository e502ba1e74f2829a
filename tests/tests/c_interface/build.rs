//! Building library and program, and running them.

use crate::toolchain::{HOW_TO_ENABLE, TARGET, Toolchain, root};
use libtest_mimic::Failed;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Mutex;

/// How the program must compile.
const STRICT: [&str; 6] = ["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-O2"];

/// What the day is flown with: container, clock, newer container, order to return from it.
pub const FILES: [&str; 4] = ["uplink.tbl", "clock.rec", "newer.tbl", "back.rec"];

/// One build at a time: they share a folder.
static BUILDING: Mutex<()> = Mutex::new(());

fn library() -> PathBuf {
    root().join("onboard-core/c")
}

/// A folder for the test's files.
pub fn folder(name: &str) -> Result<PathBuf, Failed> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("c-interface").join(name);
    std::fs::create_dir_all(&folder)?;
    Ok(folder)
}

/// The C compiler for the target, from the folder of the target's tools or the PATH.
pub fn compiler() -> Result<PathBuf, String> {
    let folder = std::env::var_os("GYRFALCON_THUMB")
        .map_or_else(|| root().join("target/thumb"), |folder| root().join(folder));
    let own = folder.join("arm-none-eabi-gcc");
    let compiler = if own.is_file() { own } else { PathBuf::from("arm-none-eabi-gcc") };
    match Command::new(&compiler).arg("--version").output() {
        Ok(output) if output.status.success() => Ok(compiler),
        _ => Err(format!("{} does not run: {HOW_TO_ENABLE}", compiler.display())),
    }
}

/// Fails with what a program said.
fn succeed(what: &str, output: &Output) -> Result<(), Failed> {
    if output.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stderr);
    Err(format!("{what} ({}):\n{said}", output.status).into())
}

/// The static library for a target, or for the host.
fn archive(target: Option<&Toolchain>) -> Result<PathBuf, Failed> {
    let Ok(_alone) = BUILDING.lock() else { return Err("another build panicked".into()) };
    let built = folder("target")?;
    let mut cargo = Command::new(env!("CARGO"));
    cargo
        .args(["build", "--locked", "--release", "--manifest-path"])
        .arg(library().canonicalize()?.join("Cargo.toml"))
        .arg("--target-dir")
        .arg(&built)
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env_remove("RUSTC_WRAPPER")
        .env_remove("RUSTC_WORKSPACE_WRAPPER");
    let mut place = built;
    if let Some(tools) = target {
        cargo
            .args(["--target", TARGET])
            .env("RUSTC", &tools.rustc)
            .env("CARGO_ENCODED_RUSTFLAGS", "-Ctarget-cpu=cortex-m7");
        place.push(TARGET);
    }
    succeed("the library does not build", &cargo.output()?)?;
    Ok(place.join("release/libgyrfalcon.a"))
}

/// Compiles and links the day with one of the two boards' files.
fn compile(
    compiler: &Path,
    board: &str,
    flags: &[&OsStr],
    archive: &Path,
    program: &Path,
) -> Result<(), Failed> {
    let examples = library().join("examples");
    let output = Command::new(compiler)
        .args(STRICT)
        .args(flags)
        .arg("-I")
        .arg(library().join("include"))
        .args([examples.join("day.c"), examples.join(board)])
        .arg(archive)
        .arg("-o")
        .arg(program)
        .output()
        .map_err(|error| format!("{} does not run ({error})", compiler.display()))?;
    succeed("the C program does not compile and link", &output)
}

/// What the day tells on the host; the compiler is `CC`, or `cc`.
pub fn run_on_the_host(files: &Path) -> Result<String, Failed> {
    let compiler = std::env::var_os("CC").unwrap_or_else(|| "cc".into());
    let program = folder("host")?.join("day");
    compile(Path::new(&compiler), "host.c", &[], &archive(None)?, &program)?;
    let output = Command::new(&program).current_dir(files).args(FILES).output()?;
    succeed("the day failed", &output)?;
    Ok(String::from_utf8(output.stdout)?)
}

/// What the day tells on QEMU's board with a Cortex-M7.
pub fn run_on_cortex_m7(
    compiler: &Path,
    tools: &Toolchain,
    files: &Path,
) -> Result<String, Failed> {
    let folder = folder("cortex-m7")?;
    for name in FILES {
        std::fs::copy(files.join(name), folder.join(name))?;
    }
    let told = folder.join("day.txt");
    if told.exists() {
        std::fs::remove_file(&told)?;
    }
    let program = folder.join("day.elf");
    let firmware = root().join("tests/firmware");
    let script = firmware.join("link.x");
    let memory = firmware.join("boards/mps2-an500");
    let bare = [
        "-mcpu=cortex-m7",
        "-mthumb",
        "-mfloat-abi=hard",
        "-mfpu=fpv5-d16",
        "-ffreestanding",
        "-nostdlib",
        "-Wl,--gc-sections,-z,noexecstack,--fatal-warnings",
    ];
    let mut flags: Vec<&OsStr> = bare.iter().map(OsStr::new).collect();
    flags.extend([OsStr::new("-T"), script.as_os_str(), OsStr::new("-L"), memory.as_os_str()]);
    compile(compiler, "cortex_m.c", &flags, &archive(Some(tools))?, &program)?;
    let output = Command::new(&tools.qemu)
        .current_dir(&folder)
        .args(["-M", "mps2-an500", "-display", "none", "-monitor", "none", "-serial", "none"])
        .args(["-semihosting-config", "enable=on,target=native", "-kernel", "day.elf"])
        .output()?;
    succeed("the day failed on the Cortex-M7", &output)?;
    Ok(std::fs::read_to_string(told)?)
}
