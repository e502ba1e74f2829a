//! What RTIC must know of the microcontroller: how many bits of priority, and no interrupt besides
//! the processor's own exceptions.

/// Bits of an interrupt's priority.
pub(crate) const NVIC_PRIO_BITS: u8 = 3;
