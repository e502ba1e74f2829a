//! x86-64 instructions (AT&T order): where they lead, and how far they move the stack pointer.

use super::{Flow, Instruction};
use std::collections::BTreeMap;

pub(super) fn flow(instruction: &Instruction<'_>) -> Flow {
    match instruction.mnemonic {
        "call" | "callq" => instruction.target().map_or(Flow::Indirect, Flow::Call),
        jump if jump.starts_with('j') => {
            if instruction.operands.starts_with('*') {
                return Flow::Indirect;
            }
            instruction.target().map_or(Flow::Indirect, Flow::Jump)
        }
        _ => Flow::On,
    }
}

/// Bytes that the instruction takes from the stack; `None` where that cannot be told.
pub(super) fn stack_moved(instruction: &Instruction<'_>) -> Option<u64> {
    let Instruction { mnemonic, operands } = instruction;
    if mnemonic.starts_with("push") {
        return Some(8);
    }
    if *mnemonic == "enter" {
        return None;
    }
    let reads_only = mnemonic.starts_with("cmp") || mnemonic.starts_with("test");
    let Some(source) = operands.strip_suffix(",%rsp").filter(|_| !reads_only) else {
        return Some(0);
    };
    let constant = source.strip_prefix("$0x").and_then(|hex| u64::from_str_radix(hex, 16).ok());
    match *mnemonic {
        // objdump writes negative constants as their two's complement.
        "sub" => constant.map(|bytes| bytes.cast_signed().max(0).unsigned_abs()),
        "add" => constant.map(|bytes| bytes.cast_signed().min(0).unsigned_abs()),
        _ => None,
    }
}

/// The place that a call or a load through the instruction pointer names: `*0x9ce0(%rip) # 20e3f8 <...>`.
pub(super) fn place(line: &str) -> Option<u64> {
    let (instruction, comment) = line.split_once("# ")?;
    let address = comment.split_whitespace().next()?;
    instruction.contains("(%rip)").then(|| u64::from_str_radix(address, 16).ok()).flatten()
}

/// The register that a `mov` loads from a place; only one that calls preserve.
fn loaded(line: &str) -> Option<(&str, u64)> {
    const KEPT: [&str; 6] = ["%rbx", "%rbp", "%r12", "%r13", "%r14", "%r15"];
    let (source, register) = line.strip_prefix("mov ")?.split('#').next()?.split_once(",%")?;
    let register = register.trim();
    let register = KEPT.iter().find(|kept| kept.trim_start_matches('%') == register)?;
    source.trim_end().ends_with("(%rip)").then_some((*register, place(line)?))
}

/// What is known before an instruction of one register that holds an address of the linker's table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Held<'a> {
    /// No path leads here, as far as is known.
    Unreached,
    /// On every path here the register holds the address.
    Address(&'a str, u64),
    /// Nothing.
    Nothing,
}

impl Held<'_> {
    /// The address, when the instruction calls what the register holds.
    pub(super) fn called(self, instruction: &Instruction<'_>) -> Option<u64> {
        match self {
            Self::Address(register, to) if calls(instruction, register) => Some(to),
            _ => None,
        }
    }

    fn meet(self, other: Self) -> Self {
        match (self, other) {
            (Self::Unreached, known) | (known, Self::Unreached) => known,
            (a, b) if a == b => a,
            _ => Self::Nothing,
        }
    }
}

/// What is held before each instruction of a function: the fixed point over its jumps.
pub(super) fn held<'a>(
    function: &[&(u64, &'a str)],
    addresses: &BTreeMap<u64, u64>,
) -> Vec<Held<'a>> {
    let index: BTreeMap<u64, usize> =
        function.iter().enumerate().map(|(index, (at, _))| (*at, index)).collect();
    let mut before = vec![Held::Unreached; function.len()];
    if let Some(first) = before.first_mut() {
        *first = Held::Nothing;
    }
    loop {
        let known = before.clone();
        for (at, (_, line)) in function.iter().enumerate() {
            let instruction = Instruction::parse(line);
            let address = |place| addresses.get(&place).copied();
            let after = match (known[at], loaded(line)) {
                (Held::Unreached, _) => Held::Unreached,
                (_, Some((register, place))) if address(place).is_some() => {
                    address(place).map_or(Held::Nothing, |to| Held::Address(register, to))
                }
                (Held::Address(register, to), _) if keeps(&instruction, register) => {
                    Held::Address(register, to)
                }
                _ => Held::Nothing,
            };
            let mut reach = |to: usize| {
                if let Some(there) = before.get_mut(to) {
                    *there = there.meet(after);
                }
            };
            if let Flow::Jump(to) = flow(&instruction)
                && let Some(to) = index.get(&to)
            {
                reach(*to);
            }
            if !["jmp", "ret", "ud2"].contains(&instruction.mnemonic) {
                reach(at + 1);
            }
        }
        if before == known {
            return before;
        }
    }
}

/// Whether the instruction calls or jumps to what `register` holds.
fn calls(instruction: &Instruction<'_>, register: &str) -> bool {
    instruction.operands.strip_prefix('*') == Some(register)
}

/// Whether a register that holds an address surely still does: any other mention of it, whole or in
/// part, counts as a write.
fn keeps(instruction: &Instruction<'_>, register: &str) -> bool {
    let family = register.trim_start_matches("%r");
    let low = if family == "bx" { "%bl" } else { family };
    calls(instruction, register)
        || !instruction.operands.contains(family) && !instruction.operands.contains(low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calls_jumps_and_what_cannot_be_followed() {
        let flow_of = |line| flow(&Instruction::parse(line));
        assert_eq!(flow_of("call   201a <f>"), Flow::Call(0x201a));
        assert_eq!(flow_of("jmp    201a <f+0x2>"), Flow::Jump(0x201a));
        assert_eq!(flow_of("jne    201a <f+0x2>"), Flow::Jump(0x201a));
        assert_eq!(flow_of("ret"), Flow::On);
        assert_eq!(flow_of("rep movsb (%rsi),(%rdi)"), Flow::On);
        for refused in ["call   *%rax", "call   *0x10(%rsi)", "jmp    *%rcx", "notrack jmp *%rax"] {
            assert_eq!(flow_of(refused), Flow::Indirect, "{refused}");
        }
    }

    #[test]
    fn the_stack_pointer_is_followed_or_refused() {
        let moved = |line| stack_moved(&Instruction::parse(line));
        assert_eq!(moved("push   %rbx"), Some(8));
        assert_eq!(moved("sub    $0x28,%rsp"), Some(0x28));
        assert_eq!(moved("sub    $0xffffffffffffff80,%rsp"), Some(0));
        assert_eq!(moved("add    $0xffffffffffffff80,%rsp"), Some(0x80));
        assert_eq!(moved("add    $0x28,%rsp"), Some(0));
        assert_eq!(moved("mov    %rsp,%rbp"), Some(0));
        for refused in [
            "mov    %rbp,%rsp",
            "sub    %rax,%rsp",
            "and    $0xffffffffffffffe0,%rsp",
            "lea    -0x8(%rbp),%rsp",
        ] {
            assert_eq!(moved(refused), None, "{refused}");
        }
    }
}
