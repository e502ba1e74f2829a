//! Thumb instructions: where they lead, and how far they move the stack pointer.

use super::{Flow, Instruction};

pub(super) fn flow(instruction: &Instruction<'_>) -> Flow {
    let Instruction { mnemonic, operands } = instruction;
    // Width and condition do not matter: `b.w`, `beq.n`.
    let base = mnemonic.split('.').next().unwrap_or_default();
    if base.starts_with("tb") {
        // Offsets forward from the instruction, in the table behind it.
        return Flow::On;
    }
    if ["bl", "blx"].contains(&base) {
        return instruction.target().map_or(Flow::Indirect, Flow::Call);
    }
    if base.starts_with("bx") {
        return if *operands == "lr" { Flow::On } else { Flow::Indirect };
    }
    if ["cbz", "cbnz"].contains(&base) || is_branch(base) {
        return instruction.target().map_or(Flow::Indirect, Flow::Jump);
    }
    let returns = base.starts_with("pop")
        || base.starts_with("ldm") && operands.starts_with("sp!")
        || base.starts_with("ldr") && operands.starts_with("pc, [sp], #");
    let writes_pc = !base.starts_with("push")
        && !base.starts_with("cmp")
        && !base.starts_with("st")
        && operands.split([',', '{', '}', ' ']).any(|operand| operand == "pc")
        && (operands.starts_with("pc") || base.starts_with("pop") || base.starts_with("ldm"));
    if writes_pc && !returns { Flow::Indirect } else { Flow::On }
}

/// `b` or `b` with a condition.
fn is_branch(base: &str) -> bool {
    const CONDITIONS: [&str; 16] = [
        "", "eq", "ne", "cs", "hs", "cc", "lo", "mi", "pl", "vs", "vc", "hi", "ls", "ge", "lt",
        "gt",
    ];
    base.strip_prefix('b').is_some_and(|rest| CONDITIONS.contains(&rest) || rest == "le")
}

/// Bytes that the instruction takes from the stack; `None` where that cannot be told.
pub(super) fn stack_moved(instruction: &Instruction<'_>) -> Option<u64> {
    let Instruction { mnemonic, operands } = instruction;
    let base = mnemonic.split('.').next().unwrap_or_default();
    if base == "push" || base == "stmdb" && operands.starts_with("sp!") {
        return Some(4 * registers(operands)?);
    }
    if base == "vpush" || base == "vstmdb" && operands.starts_with("sp!") {
        let bytes = if operands.contains('d') { 8 } else { 4 };
        return Some(bytes * registers(operands)?);
    }
    if let Some((_, offset)) = operands.split_once("[sp, #")
        && let Some(offset) = offset.strip_suffix("]!")
    {
        return offset.parse::<i64>().ok().map(|offset| offset.min(0).unsigned_abs());
    }
    let mut parts = operands.split(',').map(str::trim);
    let stores = base.starts_with("st") || base.starts_with("vst") || base.starts_with("cmp");
    if parts.next() != Some("sp") || stores {
        return Some(0);
    }
    let last = parts.next_back()?;
    let bytes = last.strip_prefix('#').and_then(|bytes| bytes.parse().ok());
    match base {
        "sub" | "subw" => bytes,
        "add" | "addw" if bytes.is_some() => Some(0),
        _ => None,
    }
}

/// How many registers a list `{r4, r5, lr}` or `{d8-d15}` names.
fn registers(operands: &str) -> Option<u64> {
    let list = operands.split_once('{')?.1.split_once('}')?.0;
    let number = |name: &str| name.trim_start_matches(char::is_alphabetic).parse::<u64>().ok();
    list.split(',')
        .map(|item| match item.trim().split_once('-') {
            Some((first, last)) => number(last)?.checked_sub(number(first)?)?.checked_add(1),
            None => Some(1),
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flow_of(line: &str) -> Flow {
        flow(&Instruction::parse(line))
    }

    fn moved(line: &str) -> Option<u64> {
        stack_moved(&Instruction::parse(line))
    }

    #[test]
    fn calls_jumps_returns_and_what_cannot_be_followed() {
        assert_eq!(flow_of("bl\t1a2c <f>"), Flow::Call(0x1a2c));
        assert_eq!(flow_of("b.w\t1a2c <f>"), Flow::Jump(0x1a2c));
        assert_eq!(flow_of("ble.n\t1a2c <f+0x4>"), Flow::Jump(0x1a2c));
        assert_eq!(flow_of("cbz\tr0, 1a2c <f+0x4>"), Flow::Jump(0x1a2c));
        for still in [
            "bx\tlr",
            "pop\t{r4, pc}",
            "ldr.w\tpc, [sp], #8",
            "bic.w\tr0, r0, #3",
            "bfi\tr0, r1, #0, #4",
            "tbb\t[pc, r0]",
            "push\t{r4, lr}",
            "ldr\tr0, [pc, #8]\t@ (20 <f+0x10>)",
        ] {
            assert_eq!(flow_of(still), Flow::On, "{still}");
        }
        for refused in [
            "blx\tr3",
            "bx\tr0",
            "mov\tpc, r1",
            "ldr.w\tpc, [r0, r1, lsl #2]",
            "add\tpc, r0",
            "ldmia.w\tr0!, {r1, pc}",
        ] {
            assert_eq!(flow_of(refused), Flow::Indirect, "{refused}");
        }
    }

    #[test]
    fn the_stack_pointer_is_followed_or_refused() {
        assert_eq!(moved("push\t{r4, r5, r7, lr}"), Some(16));
        assert_eq!(moved("stmdb\tsp!, {r4, r5, r6, r7, r8, lr}"), Some(24));
        assert_eq!(moved("vpush\t{d8-d15}"), Some(64));
        assert_eq!(moved("vpush\t{s16}"), Some(4));
        assert_eq!(moved("sub.w\tsp, sp, #1024\t@ 0x400"), Some(1024));
        assert_eq!(moved("sub\tsp, #16"), Some(16));
        assert_eq!(moved("str.w\tr8, [sp, #-4]!"), Some(4));
        assert_eq!(moved("add\tsp, #16"), Some(0));
        assert_eq!(moved("str\tr0, [sp, #4]"), Some(0));
        for refused in ["mov\tsp, r7", "sub.w\tsp, sp, r0", "bic.w\tsp, r4, #7"] {
            assert_eq!(moved(refused), None, "{refused}");
        }
    }
}
