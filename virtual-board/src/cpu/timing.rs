//! Model cycles.
//!
//! They are those of the Cortex-M4 technical reference manual (ARM DDI 0439), tables of instruction timings and the
//! notes on loads and stores and on the FPU that follow them, with these choices where it leaves a range:
//!
//! - A taken branch or a barrier refills the pipeline in 2 cycles, in 3 if it goes on where no word begins (table: 1
//!   to 3).
//! - A division takes 2 cycles and one for every 4 bits of quotient, at most 10 (table: 2 to 12).
//! - A single load takes 2 cycles, or 1 right after another one whose result is not in its address. A store with an
//!   immediate offset takes 1; one with a register 2, or 1 right after a load. Nothing overlaps with a store before it.
//! - An address waits a cycle for a base that the instruction right before has computed.
//! - An instruction waits a cycle for a number that the FPU has computed right before; not for the addend of a
//!   multiplication with one.
//! - IT takes its cycle; it is never folded into another instruction.
//! - Exception entry and return take 12 cycles each, and 17 more if they move registers of the FPU; from one exception
//!   to the next without a return between, 6. Instructions of many cycles are not abandoned for an interrupt.
//! - Flash adds wait states as [`super::flash_accelerator`] says; the board adds those of its buses by
//!   [`super::Signals::wait`].
//!
//! An instruction whose condition fails takes 1 cycle.

use super::instruction::FloatOp;

/// Exception entry.
pub const ENTRY: u32 = 12;
/// Exception return.
pub const RETURN: u32 = 12;
/// From one exception to the next, or to one that comes late in an entry.
pub const TAIL_CHAIN: u32 = 6;
/// What moving the FPU's part of a frame adds.
pub const FLOAT_FRAME: u32 = 17;
/// What MRS and MSR add.
pub const SPECIAL: u32 = 1;
/// What MLA and MLS add.
pub const MULTIPLY_ADD: u32 = 1;
/// What VSQRT adds.
pub const SQUARE_ROOT: u32 = 13;

/// What going on at `target` adds, for a jump or a barrier.
#[inline]
pub fn refill(target: u32) -> u32 {
    2 + (target >> 1 & 1)
}

/// What a division adds.
pub fn divide(dividend: u32, divisor: u32) -> u32 {
    let quotient_bits = (33 + divisor.leading_zeros())
        .saturating_sub(dividend.leading_zeros() + 32)
        .min(32);
    1 + quotient_bits.div_ceil(4)
}

/// What an operation of the FPU adds.
#[inline]
pub fn float(op: FloatOp) -> u32 {
    match op {
        FloatOp::Add | FloatOp::Sub | FloatOp::Mul | FloatOp::Nmul => 0,
        FloatOp::Div => 13,
        _ => 2,
    }
}
