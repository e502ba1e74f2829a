//! Holds stack and sizes of the link probe's binaries against a budget file.
//!
//! `budget [--update] [--all] FOLDER BUILD=BINARY...`: FOLDER holds `budget.toml` (limits and the
//! last recorded worst values) and `stack.csv` (every entry point's recorded stack). Prints each value
//! with its limit, its recorded value and the difference; exits 1 above a limit or where no bound on
//! the stack can be given. `--update` records the new values, `--all` lists every entry point, `--fault`
//! looks at a binary without the entry points.
//! The environment's `OBJDUMP` and `OBJDUMP_ARM` name the disassemblers.

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::path::Path;
use std::process::{Command, ExitCode};
use tests::stack::{Binary, Depth, Machine, Sizes};
use toml_edit::{DocumentMut, Item, Table, value};

/// What was measured of one binary.
struct Measured {
    build: String,
    /// Without the probes' own code.
    sizes: Sizes,
    /// By function: every named one, entry point or not.
    depths: BTreeMap<String, Depth>,
}

fn main() -> ExitCode {
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("budget: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<bool, Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (options, rest): (Vec<_>, Vec<_>) =
        arguments.iter().map(String::as_str).partition(|argument| argument.starts_with("--"));
    let known = ["--update", "--all", "--fault"];
    if let Some(unknown) = options.iter().find(|option| !known.contains(option)) {
        return Err(format!("no such option: {unknown}").into());
    }
    let [folder, builds @ ..] = &*rest else { return Err("which folder?".into()) };
    let folder = Path::new(folder);
    let budget = folder.join("budget.toml");
    let mut document: DocumentMut = std::fs::read_to_string(&budget)
        .map_err(|error| format!("{}: {error}", budget.display()))?
        .parse()?;
    let mut entries = entry_points(&folder.join("../link-probe/src/main.rs"))?;
    if options.contains(&"--fault") {
        entries.clear();
    }
    let mut measured = Vec::new();
    for build in builds {
        let (name, path) = build.split_once('=').ok_or("a build is NAME=BINARY")?;
        let found =
            measure(name, Path::new(path), &entries).map_err(|error| format!("{name}: {error}"))?;
        if let Some(missing) = entries.iter().find(|entry| !found.depths.contains_key(*entry)) {
            return Err(format!("{name}: the entry point {missing} is not in the binary").into());
        }
        measured.push(found);
    }
    let recorded = Recorded::read(&folder.join("stack.csv"))?;
    let mut within = true;
    for one in &measured {
        within &= report_stack(one, &entries, &document, &recorded, options.contains(&"--all"));
        within &= report_sizes(one, &document);
    }
    if options.contains(&"--update") {
        for one in &measured {
            record(one, &entries, &mut document);
        }
        std::fs::write(&budget, document.to_string())?;
        recorded.updated(&measured, &entries).write(&folder.join("stack.csv"))?;
        println!("budget: recorded in {}", folder.display());
    }
    Ok(within)
}

/// The names of the link probe's functions, one per line of its source; without those of hosts alone,
/// which stand below a `#[cfg]`.
fn entry_points(probe: &Path) -> Result<BTreeSet<String>, Box<dyn Error>> {
    let source =
        std::fs::read_to_string(probe).map_err(|error| format!("{}: {error}", probe.display()))?;
    let name = |line: &str| {
        let (name, rest) = line.strip_prefix("    ")?.split_once('(')?;
        let plain = name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
        (plain && rest.contains(") -> ") && rest.ends_with(" }")).then(|| name.to_owned())
    };
    let lines = source.lines().zip(source.lines().skip(1));
    let everywhere = lines.filter(|(before, _)| !before.starts_with("    #[cfg("));
    Ok(everywhere.filter_map(|(_, line)| name(line)).collect())
}

fn measure(
    build: &str,
    path: &Path,
    entries: &BTreeSet<String>,
) -> Result<Measured, Box<dyn Error>> {
    let bytes = std::fs::read(path)
        .map_err(|error| format!("{} cannot be read: {error}", path.display()))?;
    let binary = Binary::parse(&bytes)?;
    let (variable, default) = match binary.machine() {
        Machine::X86 => ("OBJDUMP", "objdump"),
        Machine::Arm => ("OBJDUMP_ARM", "arm-none-eabi-objdump"),
    };
    let program = std::env::var(variable).unwrap_or_else(|_| default.into());
    let output =
        Command::new(&program).args(["-d", "--no-show-raw-insn"]).arg(path).output().map_err(
            |error| format!("{program} cannot run ({variable} may name another): {error}"),
        )?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    let depths = binary.depths(&String::from_utf8(output.stdout)?)?;
    // The probes only move arguments and results; what the core does stands in its own functions.
    let probes: u64 = entries.iter().map(|name| binary.code_bytes(name)).sum();
    let mut sizes = binary.sizes;
    sizes.text -= probes + binary.code_bytes("_start");
    Ok(Measured { build: build.into(), sizes, depths })
}

/// The limit of a section, where it binds this build: the build's own, else the section's.
fn limit(document: &DocumentMut, section: &str, build: &str) -> Option<u64> {
    if let Some(own) = number(document, section, build, "limit_bytes") {
        return Some(own);
    }
    let section = document.get(section)?;
    let binds = section.get("limited")?.as_array()?.iter().any(|name| name.as_str() == Some(build));
    u64::try_from(section.get("limit_bytes")?.as_integer()?).ok().filter(|_| binds)
}

fn number(document: &DocumentMut, section: &str, build: &str, key: &str) -> Option<u64> {
    let value = document.get(section)?.get(build)?.get(key)?.as_integer()?;
    u64::try_from(value).ok()
}

/// `value (recorded 12, +3; limit 20)`, and whether the limit holds.
fn compare(value: u64, recorded: Option<u64>, limit: Option<u64>) -> (String, bool) {
    let recorded = recorded.map_or_else(
        || "not recorded".into(),
        |before| format!("recorded {before}, {:+}", value.cast_signed() - before.cast_signed()),
    );
    let within = limit.is_none_or(|limit| value <= limit);
    let bound = limit.map_or_else(|| "no limit".into(), |limit| format!("limit {limit}"));
    let verdict = if within { "" } else { ": TOO LARGE" };
    (format!("{value} ({recorded}; {bound}){verdict}"), within)
}

/// The deepest function of all: an entry point, since everything else hangs below one.
fn worst<'a>(one: &'a Measured, entries: &BTreeSet<String>) -> Option<(&'a String, &'a Depth)> {
    one.depths.iter().max_by_key(|(name, depth)| (depth.bytes, entries.contains(*name)))
}

fn report_stack(
    one: &Measured,
    entries: &BTreeSet<String>,
    document: &DocumentMut,
    recorded: &Recorded,
    all: bool,
) -> bool {
    let limit = limit(document, "stack", &one.build);
    let Some((name, deepest)) = worst(one, entries) else { return false };
    let before = number(document, "stack", &one.build, "bytes");
    let (line, within) = compare(deepest.bytes, before, limit);
    println!("stack {}: {name} {line}", one.build);
    let mut listed: Vec<_> =
        one.depths.iter().filter(|(name, _)| all || entries.contains(*name)).collect();
    listed.sort_by_key(|(name, depth)| (std::cmp::Reverse(depth.bytes), *name));
    for (entry, depth) in listed {
        let before = recorded.0.get(entry).and_then(|builds| builds.get(&one.build)).copied();
        let over = limit.is_some_and(|limit| depth.bytes > limit);
        let moved = entries.contains(entry) && before.is_some_and(|before| before != depth.bytes);
        if all || over || moved {
            println!("  {entry} {}", compare(depth.bytes, before, limit).0);
        }
        if over || all && depth.bytes == deepest.bytes {
            for (callee, frame) in &depth.chain {
                println!("    {frame:5} {callee}");
            }
        }
    }
    within
}

fn report_sizes(one: &Measured, document: &DocumentMut) -> bool {
    let Sizes { text, rodata, statics } = one.sizes;
    let before = |key| number(document, "size", &one.build, key);
    let total = before("text").zip(before("rodata")).map(|(text, rodata)| text + rodata);
    let limit = limit(document, "size", &one.build);
    let (line, within) = compare(text + rodata, total, limit);
    println!("size {}: .text {text} + .rodata {rodata} = {line}", one.build);
    let (line, none) = compare(statics, before("static"), Some(0));
    println!("size {}: static memory {line}", one.build);
    within && none
}

fn record(one: &Measured, entries: &BTreeSet<String>, document: &mut DocumentMut) {
    let integer = |number: u64| value(i64::try_from(number).unwrap_or(i64::MAX));
    let mut put = |section: &str, key: &str, item: Item| {
        let table = document[section][&one.build].or_insert(Item::Table(Table::new()));
        table[key] = item;
    };
    if let Some((name, depth)) = worst(one, entries) {
        put("stack", "worst", value(name));
        put("stack", "bytes", integer(depth.bytes));
    }
    put("size", "text", integer(one.sizes.text));
    put("size", "rodata", integer(one.sizes.rodata));
    put("size", "static", integer(one.sizes.statics));
}

/// `stack.csv`: a line per entry point, a column per build, bytes.
struct Recorded(BTreeMap<String, BTreeMap<String, u64>>);

impl Recorded {
    fn read(path: &Path) -> Result<Self, Box<dyn Error>> {
        let text = std::fs::read_to_string(path).unwrap_or_default();
        let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let Some(head) = lines.next() else { return Ok(Self(BTreeMap::new())) };
        let mut recorded = BTreeMap::new();
        for line in lines {
            let mut builds = BTreeMap::new();
            for (build, bytes) in head.iter().zip(&line).skip(1).filter(|(_, b)| !b.is_empty()) {
                let bytes = bytes.parse().map_err(|_| format!("{}: {bytes}", path.display()))?;
                builds.insert(String::from(*build), bytes);
            }
            recorded.insert(line.first().copied().unwrap_or_default().to_owned(), builds);
        }
        Ok(Self(recorded))
    }

    /// The new values in place of the old; entry points that are gone drop out.
    fn updated(mut self, measured: &[Measured], entries: &BTreeSet<String>) -> Self {
        self.0.retain(|entry, _| entries.contains(entry));
        for one in measured {
            for (entry, depth) in one.depths.iter().filter(|(name, _)| entries.contains(*name)) {
                self.0.entry(entry.clone()).or_default().insert(one.build.clone(), depth.bytes);
            }
        }
        self
    }

    fn write(&self, path: &Path) -> std::io::Result<()> {
        let builds: BTreeSet<&String> = self.0.values().flat_map(BTreeMap::keys).collect();
        let mut text = String::from("entry");
        for build in &builds {
            text.extend([",", build]);
        }
        for (entry, values) in &self.0 {
            text.extend(["\n", entry]);
            for build in &builds {
                let bytes = values.get(*build).map_or_else(String::new, u64::to_string);
                text.extend([",", &bytes]);
            }
        }
        text.push('\n');
        std::fs::write(path, text)
    }
}
