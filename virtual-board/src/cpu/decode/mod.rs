//! Decodes Thumb machine code into [`Instruction`]s.

mod float;
mod narrow;
mod wide;

use super::instruction::{Instruction, Shift};

/// Returns true if `first` is the first halfword of a 32-bit instruction.
pub fn is_wide(first: u16) -> bool {
    first >= 0xE800
}

/// Decodes the instruction at `address`. `second` is used only if [`is_wide`].
pub fn decode(address: u32, first: u16, second: u16) -> Instruction {
    if is_wide(first) {
        wide::decode(address, first, second)
    } else {
        narrow::decode(address, first)
    }
}

/// Bits `high` to `low` of a halfword.
const fn bits(half: u16, high: u32, low: u32) -> u32 {
    (half >> low) as u32 & ((1 << (high - low + 1)) - 1)
}

/// Bit `at` of a halfword.
const fn bit(half: u16, at: u32) -> bool {
    half >> at & 1 == 1
}

/// Bits `high` to `low` of a halfword as a register number or another small number.
const fn small(half: u16, high: u32, low: u32) -> u8 {
    bits(half, high, low) as u8
}

/// Value of PC that the instruction at `address` reads, aligned to a word.
const fn aligned_pc(address: u32) -> u32 {
    address.wrapping_add(4) & !3
}

/// Sign extends the lowest `width` bits.
const fn sign_extend(value: u32, width: u32) -> u32 {
    ((value << (32 - width)) as i32 >> (32 - width)) as u32
}

/// DecodeImmShift.
fn immediate_shift(kind: u32, amount: u32) -> (Shift, u8) {
    let amount = amount as u8;
    match (kind, amount) {
        (0, _) => (Shift::Lsl, amount),
        (1, 0) => (Shift::Lsr, 32),
        (1, _) => (Shift::Lsr, amount),
        (2, 0) => (Shift::Asr, 32),
        (2, _) => (Shift::Asr, amount),
        (_, 0) => (Shift::Rrx, 1),
        (_, _) => (Shift::Ror, amount),
    }
}

/// Shift type of a `type` field whose amount is in a register.
const fn register_shift(kind: u32) -> Shift {
    match kind & 3 {
        0 => Shift::Lsl,
        1 => Shift::Lsr,
        2 => Shift::Asr,
        _ => Shift::Ror,
    }
}
