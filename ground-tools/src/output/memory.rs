//! How much memory is there.

/// Bytes that the machine, the control group that the process is in, and its own limit leave; `None`
/// where the system does not tell.
#[must_use]
pub fn available_bytes() -> Option<u64> {
    let machine = std::fs::read_to_string("/proc/meminfo").ok().as_deref().and_then(meminfo);
    let number = |path: &str| std::fs::read_to_string(path).ok()?.trim().parse::<u64>().ok();
    let group = number("/sys/fs/cgroup/memory.max")
        .zip(number("/sys/fs/cgroup/memory.current"))
        .map(|(most, used)| most.saturating_sub(used));
    let own = own_limit();
    [machine, group, own].into_iter().flatten().min()
}

/// What the process may still take of its own limit (`ulimit -v`).
fn own_limit() -> Option<u64> {
    let limit = limit(&std::fs::read_to_string("/proc/self/limits").ok()?)?;
    let pages = std::fs::read_to_string("/proc/self/statm").ok()?;
    let pages: u64 = pages.split_whitespace().next()?.parse().ok()?;
    Some(limit.saturating_sub(pages.saturating_mul(4096)))
}

/// `Max address space` of `/proc/self/limits`, in bytes; none where it is unlimited.
fn limit(text: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// `MemAvailable` of `/proc/meminfo`, in bytes.
fn meminfo(text: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kilobytes: u64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meminfo_is_in_kilobytes() {
        let text = "MemTotal:       24689164 kB\nMemAvailable:   23000000 kB\n";
        assert_eq!(meminfo(text), Some(23_552_000_000));
        assert_eq!(meminfo("MemTotal: 1 kB"), None);
        let line = "Max address space         4194304000           unlimited            bytes\n";
        assert_eq!(limit(line), Some(4_194_304_000));
        assert_eq!(limit("Max address space  unlimited  unlimited  bytes\n"), None);
    }
}
