//! Model cycles of instructions.
//!
//! The numbers are those of the Cortex-M4 technical reference manual (ARM DDI 0439): the tables of instruction timings, and
//! the notes on loads, stores and the FPU. Where the manual gives a range, the model uses these values:
//!
//! - A taken branch or a barrier refills the pipeline in 2 cycles, or in 3 if the target is not aligned to a word (table: 1
//!   to 3).
//! - A division takes 2 cycles plus one for every 4 bits of the quotient, at most 10 (table: 2 to 12).
//! - A single load takes 2 cycles, or 1 directly after another load whose result is not its address. A store with an
//!   immediate offset takes 1 cycle. A store with a register offset takes 2, or 1 directly after a load. Nothing overlaps
//!   with a preceding store.
//! - An address waits one cycle for a base register that the previous instruction computed.
//! - An instruction waits one cycle for an FPU result of the previous instruction, except for the addend of a
//!   multiplication.
//! - IT takes one cycle. It is never folded into another instruction.
//! - Exception entry and return take 12 cycles each, and 17 more if they transfer FPU registers. Tail-chaining takes 6
//!   cycles. An instruction of many cycles is not abandoned for an interrupt.
//! - Flash adds wait states as [`super::flash_accelerator`] describes. The board adds those of its buses by
//!   [`super::Signals::wait`].
//!
//! An instruction whose condition fails takes 1 cycle.

use super::instruction::FloatOp;

/// Cycles of an exception entry.
pub const ENTRY: u32 = 12;
/// Cycles of an exception return.
pub const RETURN: u32 = 12;
/// Cycles of tail-chaining, and of a late exception that takes over an entry.
pub const TAIL_CHAIN: u32 = 6;
/// Additional cycles for the FPU part of a stack frame.
pub const FLOAT_FRAME: u32 = 17;
/// Additional cycles of MRS and MSR.
pub const SPECIAL: u32 = 1;
/// Additional cycles of MLA and MLS.
pub const MULTIPLY_ADD: u32 = 1;
/// Additional cycles of VSQRT.
pub const SQUARE_ROOT: u32 = 13;

/// Additional cycles of a jump or barrier that continues at `target`.
#[inline]
pub fn refill(target: u32) -> u32 {
    2 + (target >> 1 & 1)
}

/// Additional cycles of a division.
pub fn divide(dividend: u32, divisor: u32) -> u32 {
    let quotient_bits = (33 + divisor.leading_zeros())
        .saturating_sub(dividend.leading_zeros() + 32)
        .min(32);
    1 + quotient_bits.div_ceil(4)
}

/// Additional cycles of an FPU operation.
#[inline]
pub fn float(op: FloatOp) -> u32 {
    match op {
        FloatOp::Add | FloatOp::Sub | FloatOp::Mul | FloatOp::Nmul => 0,
        FloatOp::Div => 13,
        _ => 2,
    }
}
