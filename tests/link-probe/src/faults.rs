//! Seeded faults: with any of the features the link must fail, else the probe proves nothing.

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
