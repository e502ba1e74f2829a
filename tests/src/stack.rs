//! How much stack can a function of a binary use, at most.
//!
//! Answers with the frame of every function and the deepest chain of calls below it, in bytes.
//!
//! Method: frames are the compiler's own (`.stack_sizes`: 32- or 64-bit address, LEB128 bytes); where
//! that says nothing (hand-written routines), they are summed from the instructions that move the
//! stack pointer. Calls are read from a disassembly by `objdump -d`. A call on x86-64 pushes eight
//! bytes for the return address; on Arm the link register is saved in the caller's or the callee's
//! frame. A jump to another function (a tail call) counts as a call, which is never too little.
//!
//! Refused, because no bound follows: recursion, calls and jumps through registers or memory (a
//! `tbb`/`tbh` table is a jump inside its function; an address from the linker's table is known), jumps into the middle of a function, frames that
//! neither source gives.
//!
//! Limits: x86-64 and 32-bit Arm (Thumb) only; interrupts' own frames are not included.
//! The link probe's seeded faults show each refusal.

use object::read::elf::ElfFile;
use object::{Architecture, Object, ObjectSection, ObjectSymbol, SectionFlags, elf};
use std::collections::{BTreeMap, BTreeSet};

/// Why no bound can be given.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StackError {
    /// The file is no ELF binary that can be read.
    Unreadable(String),
    /// Neither x86-64 nor 32-bit Arm.
    Machine(String),
    /// The functions that call each other in a circle.
    Recursion(Vec<String>),
    /// A function and its instruction whose target is not known.
    IndirectCall(String, String),
    /// A function and its jump into the middle of another.
    JumpIntoFunction(String, String),
    /// A function, and its instruction that moves the stack pointer by an unknown amount.
    UnknownFrame(String, String),
}

impl std::fmt::Display for StackError {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Unreadable(why) => write!(out, "the binary cannot be read: {why}"),
            Self::Machine(name) => write!(out, "{name} is neither x86-64 nor 32-bit Arm"),
            Self::Recursion(names) => write!(out, "recursion: {}", names.join(" calls ")),
            Self::IndirectCall(name, line) => write!(out, "indirect call in {name}: {line}"),
            Self::JumpIntoFunction(name, line) => {
                write!(out, "jump from {name} into the middle of a function: {line}")
            }
            Self::UnknownFrame(name, line) => {
                write!(out, "unknown frame of {name}, which has: {line}")
            }
        }
    }
}

impl std::error::Error for StackError {}

/// Sizes of a binary's memory in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Sizes {
    /// Code.
    pub text: u64,
    /// Constants.
    pub rodata: u64,
    /// Memory that the program may write: initialised and zeroed.
    pub statics: u64,
}

/// The deepest chain of calls from one function.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Depth {
    /// Stack in bytes, the return addresses included.
    pub bytes: u64,
    /// Functions from the entry downwards with their own frames.
    pub chain: Vec<(String, u64)>,
}

/// What a binary says of itself before it is disassembled.
#[derive(Debug)]
pub struct Binary {
    machine: Machine,
    /// Names of functions; several may share an address.
    symbols: Vec<(String, u64)>,
    /// Where a function's code ends, by where it begins; the linker's padding follows.
    ends: BTreeMap<u64, u64>,
    frames: BTreeMap<u64, u64>,
    /// The linker's table of addresses (`.got`), by place.
    addresses: BTreeMap<u64, u64>,
    /// Sizes of its memory.
    pub sizes: Sizes,
}

/// Instruction sets that can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Machine {
    /// 64-bit Intel and AMD.
    X86,
    /// 32-bit Arm in Thumb state.
    Arm,
}

impl Machine {
    /// What a call itself pushes.
    const fn call_bytes(self) -> u64 {
        match self {
            Self::X86 => 8,
            Self::Arm => 0,
        }
    }
}

impl Binary {
    /// Reads an ELF file.
    ///
    /// # Errors
    /// [`StackError::Unreadable`] and [`StackError::Machine`].
    pub fn parse(bytes: &[u8]) -> Result<Self, StackError> {
        let unreadable = |error: object::Error| StackError::Unreadable(error.to_string());
        match object::FileKind::parse(bytes).map_err(unreadable)? {
            object::FileKind::Elf32 => Self::from_elf(
                &ElfFile::<elf::FileHeader32<object::Endianness>>::parse(bytes)
                    .map_err(unreadable)?,
            ),
            object::FileKind::Elf64 => Self::from_elf(
                &ElfFile::<elf::FileHeader64<object::Endianness>>::parse(bytes)
                    .map_err(unreadable)?,
            ),
            other => Err(StackError::Unreadable(format!("{other:?} is not ELF"))),
        }
    }

    fn from_elf<'data>(file: &impl Object<'data>) -> Result<Self, StackError> {
        let machine = match file.architecture() {
            Architecture::X86_64 => Machine::X86,
            Architecture::Arm => Machine::Arm,
            other => return Err(StackError::Machine(format!("{other:?}"))),
        };
        let mut sizes = Sizes::default();
        let mut frames = BTreeMap::new();
        let mut addresses = BTreeMap::new();
        for section in file.sections() {
            let name = section.name().unwrap_or_default();
            let SectionFlags::Elf { sh_flags } = section.flags() else { continue };
            let written_by_linker = [".got", ".dynamic", ".relro_padding", ".data.rel.ro"]
                .iter()
                .any(|prefix| name.starts_with(prefix));
            if name == ".got" && machine == Machine::X86 {
                let data = section.data().map_err(|e| StackError::Unreadable(e.to_string()))?;
                let places = (section.address()..).step_by(8);
                addresses = places
                    .zip(data.as_chunks::<8>().0)
                    .map(|(place, address)| (place, u64::from_le_bytes(*address)))
                    .collect();
            } else if name == ".stack_sizes" {
                let data = section.data().map_err(|e| StackError::Unreadable(e.to_string()))?;
                frames = stack_sizes(data, if machine == Machine::X86 { 8 } else { 4 })
                    .ok_or_else(|| StackError::Unreadable("cut .stack_sizes".into()))?;
            } else if sh_flags & u64::from(elf::SHF_ALLOC) == 0 || written_by_linker {
            } else if sh_flags & u64::from(elf::SHF_WRITE) != 0 {
                sizes.statics += section.size();
            } else if name.starts_with(".text") {
                sizes.text += section.size();
            } else if name.starts_with(".rodata") {
                sizes.rodata += section.size();
            }
        }
        let mut symbols = Vec::new();
        let mut ends = BTreeMap::new();
        for symbol in file.symbols().filter(|symbol| symbol.kind() == object::SymbolKind::Text) {
            let Ok(name) = symbol.name() else { continue };
            // Arm marks Thumb code in the lowest bit.
            let start = symbol.address() & !u64::from(machine == Machine::Arm);
            symbols.push((name.to_owned(), start));
            if symbol.size() > 0 {
                ends.insert(start, start + symbol.size());
            }
        }
        Ok(Self { machine, symbols, ends, frames, addresses, sizes })
    }

    /// Bytes of code of a named function; 0 where it has no size of its own.
    #[must_use]
    pub fn code_bytes(&self, name: &str) -> u64 {
        let start = self.symbols.iter().find(|(known, _)| known == name).map(|(_, start)| *start);
        start.and_then(|start| Some(self.ends.get(&start)? - start)).unwrap_or(0)
    }

    /// The instruction set, which decides on the disassembler.
    #[must_use]
    pub const fn machine(&self) -> Machine {
        self.machine
    }

    /// The depth of every named function, from the text of `objdump -d --no-show-raw-insn`.
    ///
    /// # Errors
    /// See [`StackError`]: the first refusal.
    pub fn depths(&self, disassembly: &str) -> Result<BTreeMap<String, Depth>, StackError> {
        let functions = self.functions(disassembly)?;
        let mut known = BTreeMap::new();
        for start in functions.keys() {
            self.descend(*start, &functions, &mut Vec::new(), &mut known)?;
        }
        Ok(self
            .symbols
            .iter()
            .filter_map(|(name, at)| Some((name.clone(), Self::depth_of(*at, &functions, &known)?)))
            .collect())
    }

    fn depth_of(
        start: u64,
        functions: &BTreeMap<u64, Function>,
        known: &BTreeMap<u64, (u64, Option<u64>)>,
    ) -> Option<Depth> {
        let mut chain = Vec::new();
        let mut at = Some(start);
        while let Some(here) = at {
            let function = functions.get(&here)?;
            chain.push((function.name.clone(), function.frame));
            at = known.get(&here)?.1;
        }
        Some(Depth { bytes: known.get(&start)?.0, chain })
    }

    /// Depth of one function and its deepest callee.
    fn descend(
        &self,
        start: u64,
        functions: &BTreeMap<u64, Function>,
        above: &mut Vec<u64>,
        known: &mut BTreeMap<u64, (u64, Option<u64>)>,
    ) -> Result<u64, StackError> {
        if let Some((bytes, _)) = known.get(&start) {
            return Ok(*bytes);
        }
        let name = |at: &u64| functions.get(at).map_or_else(String::new, |f| f.name.clone());
        if let Some(first) = above.iter().position(|at| *at == start) {
            return Err(StackError::Recursion(
                above[first..].iter().chain([&start]).map(name).collect(),
            ));
        }
        let Some(function) = functions.get(&start) else {
            return Err(StackError::JumpIntoFunction(
                above.last().map_or_else(String::new, name),
                format!("{start:x}"),
            ));
        };
        above.push(start);
        let mut deepest = (0, None);
        for callee in &function.calls {
            let bytes = self.descend(*callee, functions, above, known)? + self.machine.call_bytes();
            if bytes > deepest.0 || deepest.1.is_none() {
                deepest = (bytes, Some(*callee));
            }
        }
        above.pop();
        known.insert(start, (function.frame + deepest.0, deepest.1));
        Ok(function.frame + deepest.0)
    }

    fn functions(&self, disassembly: &str) -> Result<BTreeMap<u64, Function>, StackError> {
        let mut functions: BTreeMap<u64, Function> = BTreeMap::new();
        let blocks: Vec<Block<'_>> = blocks(disassembly);
        for (index, block) in blocks.iter().enumerate() {
            let next = blocks.get(index + 1).map_or(u64::MAX, |next| next.start);
            let end = self.ends.get(&block.start).map_or(next, |end| next.min(*end));
            let name = rustc_demangle::demangle(block.name).to_string();
            let mut calls = BTreeSet::new();
            let mut moved = 0;
            let mut unknown = None;
            let own: Vec<_> = block.instructions.iter().filter(|(at, _)| *at < end).collect();
            let held = if self.machine == Machine::X86 {
                x86::held(&own, &self.addresses)
            } else {
                Vec::new()
            };
            for (index, (_, line)) in own.iter().enumerate() {
                let instruction = Instruction::parse(line);
                match self.flow(&instruction) {
                    Flow::On => {}
                    Flow::Call(to) => {
                        calls.insert(to);
                    }
                    Flow::Jump(to) if (block.start..end).contains(&to) => {}
                    Flow::Jump(to) if blocks.iter().any(|other| other.start == to) => {
                        calls.insert(to);
                    }
                    Flow::Jump(_) => {
                        return Err(StackError::JumpIntoFunction(name, instruction.to_string()));
                    }
                    Flow::Indirect => {
                        let place = x86::place(line).and_then(|at| self.addresses.get(&at));
                        let held = held.get(index).and_then(|held| x86::called(&instruction, held));
                        let Some(to) = place.copied().or(held) else {
                            return Err(StackError::IndirectCall(name, instruction.to_string()));
                        };
                        calls.insert(to);
                    }
                }
                match self.stack_moved(&instruction) {
                    Some(bytes) => moved += bytes,
                    None => unknown = Some(instruction.to_string()),
                }
            }
            let frame = match (self.frames.get(&block.start), unknown) {
                (Some(frame), _) => *frame,
                (None, None) => moved,
                (None, Some(line)) => return Err(StackError::UnknownFrame(name, line)),
            };
            functions.insert(block.start, Function { name, frame, calls });
        }
        Ok(functions)
    }

    fn flow(&self, instruction: &Instruction<'_>) -> Flow {
        match self.machine {
            Machine::X86 => x86::flow(instruction),
            Machine::Arm => arm::flow(instruction),
        }
    }

    fn stack_moved(&self, instruction: &Instruction<'_>) -> Option<u64> {
        match self.machine {
            Machine::X86 => x86::stack_moved(instruction),
            Machine::Arm => arm::stack_moved(instruction),
        }
    }
}

/// One function of the disassembly.
#[derive(Debug)]
struct Function {
    name: String,
    frame: u64,
    calls: BTreeSet<u64>,
}

/// Where an instruction leads.
#[derive(Debug, PartialEq, Eq)]
enum Flow {
    /// To the next one, or back to the caller.
    On,
    Call(u64),
    Jump(u64),
    Indirect,
}

/// Frames by function: the address (`width` bytes) and the bytes as LEB128, repeated.
fn stack_sizes(mut data: &[u8], width: usize) -> Option<BTreeMap<u64, u64>> {
    let mut frames = BTreeMap::new();
    while !data.is_empty() {
        let (address, rest) = data.split_at_checked(width)?;
        let address = address.iter().rev().fold(0, |value, byte| value << 8 | u64::from(*byte));
        let address = if width == 4 { address & !1 } else { address };
        let length = rest.iter().position(|byte| byte & 0x80 == 0)? + 1;
        let (digits, rest) = rest.split_at(length);
        let bytes = digits.iter().rev().fold(0, |value, byte| value << 7 | u64::from(byte & 0x7f));
        let frame = frames.entry(address).or_insert(bytes);
        *frame = bytes.max(*frame);
        data = rest;
    }
    Some(frames)
}

/// The lines between two symbols of a disassembly.
struct Block<'a> {
    start: u64,
    name: &'a str,
    instructions: Vec<(u64, &'a str)>,
}

fn blocks(disassembly: &str) -> Vec<Block<'_>> {
    let mut blocks: Vec<Block<'_>> = Vec::new();
    for line in disassembly.lines() {
        if let Some((address, name)) = line.strip_suffix(">:").and_then(|l| l.split_once(" <"))
            && let Ok(start) = u64::from_str_radix(address, 16)
        {
            blocks.push(Block { start, name, instructions: Vec::new() });
        } else if let (Some(block), Some((address, instruction))) =
            (blocks.last_mut(), line.split_once(":\t"))
            && let Ok(at) = u64::from_str_radix(address.trim(), 16)
        {
            block.instructions.push((at, instruction.trim()));
        }
    }
    blocks
}

/// One line of the disassembly: mnemonic and operands.
#[derive(Debug)]
struct Instruction<'a> {
    mnemonic: &'a str,
    operands: &'a str,
}

impl<'a> Instruction<'a> {
    fn parse(line: &'a str) -> Self {
        const PREFIXES: [&str; 9] =
            ["addr32", "rep", "repz", "repnz", "lock", "notrack", "bnd", "data16", "cs"];
        // Comments: of Arm's disassembly after `@` or `;`, of x86-64's after `# `.
        let line = line.split(['@', ';']).next().unwrap_or_default();
        let mut line = line.split("# ").next().unwrap_or_default().trim();
        loop {
            let (mnemonic, operands) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
            if !PREFIXES.contains(&mnemonic) || operands.is_empty() {
                return Self { mnemonic, operands: operands.trim() };
            }
            line = operands.trim();
        }
    }

    /// The address that the disassembler resolved: `1234 <name+0x10>`.
    fn target(&self) -> Option<u64> {
        let (before, _) = self.operands.split_once(" <")?;
        u64::from_str_radix(before.rsplit([' ', '\t']).next()?, 16).ok()
    }
}

impl std::fmt::Display for Instruction<'_> {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "{} {}", self.mnemonic, self.operands)
    }
}

mod arm;
mod x86;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stack_sizes_are_read_and_a_cut_one_is_refused() {
        let data = [0x01, 0x10, 0, 0, 0x80, 0x04, 0x20, 0x10, 0, 0, 0x18];
        let frames = stack_sizes(&data, 4).unwrap();
        assert_eq!(frames, BTreeMap::from([(0x1000, 512), (0x1020, 24)]));
        assert_eq!(stack_sizes(&data[..5], 4), None);
    }

    fn binary(machine: Machine, frames: &[(u64, u64)]) -> Binary {
        let symbols = ["a", "b", "c"].iter().zip([0x10, 0x20, 0x30]);
        Binary {
            machine,
            symbols: symbols.map(|(name, at)| (String::from(*name), at)).collect(),
            ends: BTreeMap::new(),
            addresses: BTreeMap::from([(0x100, 0x30)]),
            frames: frames.iter().copied().collect(),
            sizes: Sizes::default(),
        }
    }

    #[test]
    fn the_deepest_chain_counts_frames_and_return_addresses() {
        let text = "00000010 <a>:\n  10:\tcall   20 <b>\n  15:\tcall   30 <c>\n  1a:\tret\n\
            00000020 <b>:\n  20:\tjmp    30 <c>\n00000030 <c>:\n  30:\tpush   %rbx\n  31:\tret\n";
        let depths = binary(Machine::X86, &[(0x10, 100), (0x20, 10)]).depths(text).unwrap();
        assert_eq!(depths["c"].bytes, 8);
        assert_eq!(depths["b"].bytes, 10 + 8 + 8);
        assert_eq!(depths["a"].bytes, 100 + 8 + 26);
        let names: Vec<_> = depths["a"].chain.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["a", "b", "c"]);
    }

    #[test]
    fn an_address_of_the_linkers_table_is_followed_while_it_is_held() {
        let depths = |between: &str| {
            let text = format!(
                "00000010 <a>:\n  10:\tmov    0xe9(%rip),%r12        # 100 <x>\n  14:\t{between}\n  \
                 18:\tcall   *%r12\n  1a:\tjne    10 <a>\n00000030 <c>:\n  30:\tpush   %rbx\n"
            );
            binary(Machine::X86, &[(0x10, 100)]).depths(&text)
        };
        assert_eq!(depths("call   30 <c>").unwrap()["a"].bytes, 100 + 8 + 8);
        // A jump from behind the load keeps it; one from before the load does not.
        assert!(depths("je     18 <a+0x8>").is_ok());
        for lost in ["xor    %r12d,%r12d", "pop    %r12", "cmovo  %rcx,%r12"] {
            assert!(matches!(depths(lost), Err(StackError::IndirectCall(..))), "{lost}");
        }
    }

    #[test]
    fn a_circle_of_calls_is_named() {
        let text = "00000010 <a>:\n  10:\tbl\t20 <b>\n00000020 <b>:\n  20:\tb.w\t30 <c>\n\
            00000030 <c>:\n  30:\tbeq.w\t20 <b>\n";
        let found = binary(Machine::Arm, &[]).depths(text);
        let circle = ["b", "c", "b"].map(String::from).to_vec();
        assert_eq!(found.unwrap_err(), StackError::Recursion(circle));
    }

    #[test]
    fn a_jump_into_another_function_is_refused() {
        let text = "00000010 <a>:\n  10:\tb.n\t24 <b+0x4>\n00000020 <b>:\n  20:\tbx\tlr\n";
        let found = binary(Machine::Arm, &[]).depths(text);
        assert!(matches!(found, Err(StackError::JumpIntoFunction(name, _)) if name == "a"));
    }
}
