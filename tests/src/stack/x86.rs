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

/// Registers that calls preserve.
const KEPT: [&str; 6] = ["%rbx", "%rbp", "%r12", "%r13", "%r14", "%r15"];
/// Those that they do not.
const LOST: [&str; 9] = ["%rax", "%rcx", "%rdx", "%rsi", "%rdi", "%r8", "%r9", "%r10", "%r11"];
/// Instructions that write no register but those they name.
const PLAIN: [&str; 24] = [
    "mov", "lea", "add", "sub", "adc", "sbb", "xor", "and", "or", "not", "neg", "cmp", "test",
    "shl", "shr", "sar", "cmov", "set", "pxor", "div", "pop", "push", "j", "bt",
];

fn register(text: &str) -> Option<&'static str> {
    KEPT.iter().chain(&LOST).find(|register| **register == text).copied()
}

/// The register that a `mov` loads from a place.
fn loaded(line: &str) -> Option<(&'static str, u64)> {
    let (source, to) = line.strip_prefix("mov ")?.split('#').next()?.rsplit_once(',')?;
    let to = register(to.trim())?;
    source.trim_end().ends_with("(%rip)").then_some((to, place(line)?))
}

/// The two registers of a `mov` from one to the other.
fn copied(instruction: &Instruction<'_>) -> Option<(&'static str, &'static str)> {
    let (from, to) = instruction.operands.split_once(',')?;
    (instruction.mnemonic == "mov").then_some((register(from)?, register(to)?))
}

/// Registers that surely hold an address of the linker's table.
pub(super) type Held = BTreeMap<&'static str, u64>;

/// The address, when the instruction calls what a register holds.
pub(super) fn called(instruction: &Instruction<'_>, held: &Held) -> Option<u64> {
    held.get(instruction.operands.strip_prefix('*')?).copied()
}

/// What is held after an instruction.
fn after(line: &str, addresses: &BTreeMap<u64, u64>, before: &Held) -> Held {
    let instruction = Instruction::parse(line);
    let mut held = before.clone();
    if instruction.mnemonic.starts_with("call") {
        held.retain(|register, _| KEPT.contains(register));
        return held;
    }
    if let Some((from, to)) = copied(&instruction) {
        match before.get(from) {
            Some(address) => held.insert(to, *address),
            None => held.remove(to),
        };
        return held;
    }
    if !PLAIN.iter().any(|plain| instruction.mnemonic.starts_with(plain)) {
        held.retain(|register, _| KEPT.contains(register));
    }
    if ["div", "mul", "imul", "idiv"].iter().any(|wide| instruction.mnemonic.starts_with(wide)) {
        held.retain(|register, _| !["%rax", "%rdx"].contains(register));
    }
    held.retain(|register, _| keeps(&instruction, register));
    if let Some((to, place)) = loaded(line)
        && let Some(address) = addresses.get(&place)
    {
        held.insert(to, *address);
    }
    held
}

/// What is held before each instruction of a function: the fixed point over its jumps.
pub(super) fn held(function: &[&(u64, &str)], addresses: &BTreeMap<u64, u64>) -> Vec<Held> {
    let index: BTreeMap<u64, usize> =
        function.iter().enumerate().map(|(index, (at, _))| (*at, index)).collect();
    // `None` where no path leads, as far as is known.
    let mut before: Vec<Option<Held>> = vec![None; function.len()];
    if let Some(first) = before.first_mut() {
        *first = Some(Held::new());
    }
    let mut changed = true;
    while changed {
        changed = false;
        for (at, (_, line)) in function.iter().enumerate() {
            let Some(known) = &before[at] else { continue };
            let after = after(line, addresses, known);
            let mut reach = |to: usize| {
                let Some(there) = before.get_mut(to) else { return };
                let met = match there {
                    None => after.clone(),
                    Some(known) => {
                        let both = known.iter().filter(|(name, at)| after.get(*name) == Some(*at));
                        both.map(|(name, at)| (*name, *at)).collect()
                    }
                };
                if there.as_ref() != Some(&met) {
                    *there = Some(met);
                    changed = true;
                }
            };
            let instruction = Instruction::parse(line);
            if let Flow::Jump(to) = flow(&instruction)
                && let Some(to) = index.get(&to)
            {
                reach(*to);
            }
            if !["jmp", "ret", "ud2"].contains(&instruction.mnemonic) {
                reach(at + 1);
            }
        }
    }
    before.into_iter().map(Option::unwrap_or_default).collect()
}

/// Whether a register that holds an address surely still does: any mention of it, whole or in part,
/// counts as a write, but the call through it.
fn keeps(instruction: &Instruction<'_>, register: &str) -> bool {
    let mut names = instruction.operands.split('%').skip(1);
    instruction.operands.strip_prefix('*') == Some(register)
        || !names.any(|text| {
            let end = text.find(|letter: char| !letter.is_ascii_alphanumeric());
            whole(&text[..end.unwrap_or(text.len())]) == register.trim_start_matches('%')
        })
}

/// The whole register that a name is a part of.
fn whole(name: &str) -> &str {
    match name {
        "eax" | "ax" | "al" | "ah" => "rax",
        "ebx" | "bx" | "bl" | "bh" => "rbx",
        "ecx" | "cx" | "cl" | "ch" => "rcx",
        "edx" | "dx" | "dl" | "dh" => "rdx",
        "esi" | "si" | "sil" => "rsi",
        "edi" | "di" | "dil" => "rdi",
        "ebp" | "bp" | "bpl" => "rbp",
        numbered => numbered.trim_end_matches(['d', 'w', 'b']),
    }
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

    #[test]
    fn registers_are_known_by_all_their_names() {
        let keeps = |line, register| keeps(&Instruction::parse(line), register);
        for line in ["xor %eax,%eax", "mov %al,(%rdx)", "lea 0x8(%rax),%rcx", "mov $0x1,%ah"] {
            assert!(!keeps(line, "%rax"), "{line}");
        }
        for line in ["mov %r8d,%ecx", "add %r8b,%cl", "movzwl %r8w,%ecx"] {
            assert!(!keeps(line, "%r8"), "{line}");
            assert!(keeps(line, "%r10") && keeps(line, "%rdx"), "{line}");
        }
        for line in ["mov %sil,(%rcx)", "mov %esi,%ecx", "mov (%rsi),%rcx"] {
            assert!(!keeps(line, "%rsi") && keeps(line, "%rdi"), "{line}");
        }
        for (line, register) in [
            ("mov %bl,(%rcx)", "%rbx"),
            ("mov %bp,%cx", "%rbp"),
            ("mov %dil,%cl", "%rdi"),
            ("mov %dl,%cl", "%rdx"),
            ("lea (%rcx,%r15,8),%rcx", "%r15"),
        ] {
            assert!(!keeps(line, register), "{line}");
        }
    }
}
