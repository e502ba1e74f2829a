//! Seeded faults: with any of the features the link or the budget must fail, else the probe proves
//! nothing.

/// Keeps the seeded faults in the binary.
pub(crate) fn keep() {
    #[cfg(feature = "bad-index")]
    core::hint::black_box(index as *const ());
    #[cfg(feature = "bad-division")]
    core::hint::black_box(divide as *const ());
    #[cfg(feature = "bad-overflow")]
    core::hint::black_box(add as *const ());
    #[cfg(feature = "bad-allocation")]
    core::hint::black_box(allocate as *const ());
    #[cfg(feature = "bad-std")]
    core::hint::black_box(read_clock as *const ());
    #[cfg(feature = "bad-recursion")]
    core::hint::black_box(climb as *const ());
    #[cfg(feature = "bad-indirect")]
    core::hint::black_box(call_any as *const ());
    #[cfg(feature = "bad-frame")]
    core::hint::black_box(fill as *const ());
    #[cfg(feature = "bad-dynamic")]
    core::hint::black_box(shift_stack as *const ());
    #[cfg(feature = "bad-static")]
    core::hint::black_box(count as *const ());
}

#[cfg(feature = "bad-index")]
extern "C" fn index(numbers: &[f64; 8], at: usize) -> f64 {
    numbers[at]
}

#[cfg(feature = "bad-division")]
extern "C" fn divide(a: i64, b: i64) -> i64 {
    a / b
}

#[cfg(feature = "bad-overflow")]
extern "C" fn add(a: i64, b: i64) -> i64 {
    a + b
}

#[cfg(feature = "bad-allocation")]
extern crate alloc;

#[cfg(feature = "bad-allocation")]
extern "C" fn allocate(length: usize) -> *mut u8 {
    alloc::vec![1_u8; length].leak().as_mut_ptr()
}

#[cfg(feature = "bad-std")]
extern crate std;

#[cfg(feature = "bad-std")]
extern "C" fn read_clock() -> u64 {
    std::time::SystemTime::now().elapsed().map_or(0, |span| span.as_secs())
}

// What follows links, but has no bound on its stack, exceeds it, or holds static memory.

#[cfg(feature = "bad-recursion")]
extern "C" fn climb(steps: u32) -> u32 {
    use core::hint::black_box;
    if steps == 0 { 0 } else { black_box(climb(black_box(steps >> 1))) ^ steps }
}

#[cfg(feature = "bad-indirect")]
extern "C" fn call_any(function: extern "C" fn(u32) -> u32) -> u32 {
    function(7) ^ 1
}

#[cfg(feature = "bad-frame")]
extern "C" fn fill(seed: u8, at: usize) -> u8 {
    let bytes = core::hint::black_box([seed; 4096]);
    bytes.get(at).copied().unwrap_or(0)
}

/// Takes as much stack as it is told, by hand: no compiler knows its frame.
#[cfg(feature = "bad-dynamic")]
#[unsafe(naked)]
extern "C" fn shift_stack(bytes: usize) {
    #[cfg(target_arch = "x86_64")]
    core::arch::naked_asm!("sub rsp, rdi", "add rsp, rdi", "ret");
    #[cfg(target_arch = "arm")]
    core::arch::naked_asm!("sub sp, sp, r0", "add sp, sp, r0", "bx lr");
}

#[cfg(feature = "bad-static")]
extern "C" fn count() -> u32 {
    use core::sync::atomic::{AtomicU32, Ordering};
    static COUNT: AtomicU32 = AtomicU32::new(0);
    COUNT.fetch_add(1, Ordering::Relaxed)
}
