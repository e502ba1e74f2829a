//! The machine: reset, the clock, and the host's files by semihosting. The firmware's only unsafe
//! code is here.
//!
//! Method: Armv7-M Architecture Reference Manual (vector table B1.5.3, CPACR B3.2.20, `SysTick` B3.3);
//! Semihosting for `AArch32` and `AArch64`, the operations by number.
//!
//! Limits: one thread, no interrupts.

use core::arch::{asm, global_asm};
use core::ffi::CStr;
use core::panic::PanicInfo;
use core::ptr::{addr_of_mut, read_volatile, write_volatile};
use vectors::sink::Sink;

// The FPU (coprocessors 10 and 11) must be on before the first compiled instruction that uses it.
global_asm!(
    ".section .vectors, \"a\"",
    ".word stack_top",
    ".word reset",
    ".rept 14",
    ".word fault",
    ".endr",
    ".section .text.reset, \"ax\"",
    ".global reset",
    ".thumb_func",
    "reset:",
    "ldr r0, =0xE000ED88",
    "ldr r1, [r0]",
    "orr r1, r1, #0xF00000",
    "str r1, [r0]",
    "dsb",
    "isb",
    "b start",
);

#[unsafe(no_mangle)]
extern "C" fn start() -> ! {
    crate::firmware()
}

#[unsafe(no_mangle)]
extern "C" fn fault() -> ! {
    exit(1)
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    exit(1)
}

const SYS_OPEN: u32 = 0x01;
const SYS_CLOSE: u32 = 0x02;
const SYS_WRITE: u32 = 0x05;
const SYS_READ: u32 = 0x06;
const SYS_EXIT_EXTENDED: u32 = 0x20;
/// `ADP_Stopped_ApplicationExit`.
const APPLICATION_EXIT: u32 = 0x20026;

/// One call to the host.
fn call(operation: u32, arguments: &[u32]) -> u32 {
    let result;
    // SAFETY: the host reads the arguments and the memory that they point to, and writes only the
    // buffer of a SYS_READ, which its caller borrows mutably; r0 carries operation and result.
    unsafe {
        asm!("bkpt 0xAB", inlateout("r0") operation => result, in("r1") arguments.as_ptr());
    }
    result
}

/// An address or a size as the host takes it; both fit, since the target has 32 bits.
#[expect(clippy::cast_possible_truncation, reason = "usize has 32 bits on the target")]
const fn word(value: usize) -> u32 {
    value as u32
}

/// Ends the run with this code.
pub(crate) fn exit(code: u32) -> ! {
    loop {
        call(SYS_EXIT_EXTENDED, &[APPLICATION_EXIT, code]);
    }
}

const INPUT_BYTES: usize = 12 << 20;
const SCRATCH_BYTES: usize = 256 << 10;
const OUTPUT_BYTES: usize = 64 << 10;

#[unsafe(link_section = ".input")]
static mut INPUT: [u8; INPUT_BYTES] = [0; INPUT_BYTES];
static mut SCRATCH: [u8; SCRATCH_BYTES] = [0; SCRATCH_BYTES];
static mut OUTPUT: [u8; OUTPUT_BYTES] = [0; OUTPUT_BYTES];

/// The memory for input, scratch and output; to be taken once.
pub(crate) fn memory() -> (&'static mut [u8], &'static mut [u8], &'static mut [u8]) {
    // SAFETY: called once, by the only thread; nobody else names these statics.
    unsafe { (&mut *addr_of_mut!(INPUT), &mut *addr_of_mut!(SCRATCH), &mut *addr_of_mut!(OUTPUT)) }
}

/// Opens a file of the host's; modes 1 (read, binary) and 5 (write, binary).
fn open(name: &CStr, mode: u32) -> Option<u32> {
    let length = name.to_bytes().len();
    let handle = call(SYS_OPEN, &[word(name.as_ptr().addr()), mode, word(length)]);
    (handle != u32::MAX).then_some(handle)
}

/// The whole file, if it is there and fits.
pub(crate) fn read_input<'m>(name: &CStr, memory: &'m mut [u8]) -> Option<&'m [u8]> {
    let handle = open(name, 1)?;
    let size = word(memory.len());
    let left = call(SYS_READ, &[handle, word(memory.as_mut_ptr().addr()), size]);
    call(SYS_CLOSE, &[handle]);
    let length = usize::try_from(size.checked_sub(left)?).ok()?;
    // A file that fills the memory may go on beyond it.
    (left > 0).then(|| memory.get(..length)).flatten()
}

/// A file of words, written in large pieces.
pub(crate) struct Output {
    handle: u32,
    buffer: &'static mut [u8],
    filled: usize,
    failed: bool,
}

impl Output {
    /// An empty file.
    pub(crate) fn create(name: &CStr, buffer: &'static mut [u8]) -> Option<Self> {
        Some(Self { handle: open(name, 5)?, buffer, filled: 0, failed: false })
    }

    fn flush(&mut self) {
        let piece = [self.handle, word(self.buffer.as_ptr().addr()), word(self.filled)];
        self.failed |= call(SYS_WRITE, &piece) != 0;
        self.filled = 0;
    }

    /// Writes what is left; false when anything could not be written.
    pub(crate) fn close(mut self) -> bool {
        self.flush();
        call(SYS_CLOSE, &[self.handle]);
        !self.failed
    }
}

impl Sink for Output {
    fn block(&mut self, _: u32) {}

    fn item(&mut self, _: i64) {}

    fn word(&mut self, _: &'static str, bits: u64) {
        if self.filled == self.buffer.len() {
            self.flush();
        }
        if let Some(place) = self.buffer.get_mut(self.filled..).and_then(<[u8]>::first_chunk_mut) {
            *place = bits.to_le_bytes();
        }
        self.filled += 8;
    }
}

const SYST_CSR: *mut u32 = 0xE000_E010 as *mut u32;
const SYST_RVR: *mut u32 = 0xE000_E014 as *mut u32;
const SYST_CVR: *mut u32 = 0xE000_E018 as *mut u32;

/// Starts `SysTick` over its 24 bits, without interrupts, on the processor's clock.
pub(crate) fn start_clock() {
    // SAFETY: registers of this one core; no interrupt is enabled.
    unsafe {
        write_volatile(SYST_RVR, 0x00FF_FFFF);
        write_volatile(SYST_CVR, 0);
        write_volatile(SYST_CSR, 0b101);
    }
}

/// Ticks, counted upwards, modulo 2^24.
pub(crate) fn ticks() -> u32 {
    // SAFETY: reading the counter has no effect.
    let left = unsafe { read_volatile(SYST_CVR) };
    0x00FF_FFFF - (left & 0x00FF_FFFF)
}
