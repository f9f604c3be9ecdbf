//! Integer arithmetic. The names are those of the architecture manual's pseudocode.

use super::instruction::Shift;

/// AddWithCarry: returns sum, carry out and overflow.
#[inline]
pub fn add_with_carry(a: u32, b: u32, carry: bool) -> (u32, bool, bool) {
    let (partial, first) = a.overflowing_add(b);
    let (sum, second) = partial.overflowing_add(carry.into());
    let overflow = ((a ^ sum) & (b ^ sum)) >> 31 == 1;
    (sum, first || second, overflow)
}

/// Shift_C: returns the value shifted by up to 255 bits, and the carry out.
#[inline]
pub fn shift_with_carry(value: u32, shift: Shift, amount: u8, carry: bool) -> (u32, bool) {
    let amount = u32::from(amount);
    let bit = |at: u32| value >> at & 1 == 1;
    match (shift, amount) {
        (Shift::Rrx, _) => (value >> 1 | u32::from(carry) << 31, bit(0)),
        (_, 0) => (value, carry),
        (Shift::Lsl, 1..=32) => (value.checked_shl(amount).unwrap_or(0), bit(32 - amount)),
        (Shift::Lsr, 1..=32) => (value.checked_shr(amount).unwrap_or(0), bit(amount - 1)),
        (Shift::Lsl | Shift::Lsr, _) => (0, false),
        (Shift::Asr, _) => {
            let amount = amount.min(32);
            ((i64::from(value as i32) >> amount) as u32, bit(amount - 1))
        }
        (Shift::Ror, _) => {
            let rotated = value.rotate_right(amount);
            (rotated, rotated >> 31 == 1)
        }
    }
}

/// SignedSatQ: returns the value saturated to `bits` bits, and true if it saturated.
pub fn saturate_signed(value: i64, bits: u8) -> (i32, bool) {
    let most = (1_i64 << (bits - 1)) - 1;
    let fitted = value.clamp(-most - 1, most);
    (fitted as i32, fitted != value)
}

/// UnsignedSatQ: returns the value saturated to `bits` bits, and true if it saturated.
pub fn saturate_unsigned(value: i64, bits: u8) -> (u32, bool) {
    let fitted = value.clamp(0, (1_i64 << bits) - 1);
    (fitted as u32, fitted != value)
}

/// The low or, if `top`, the high halfword, sign extended.
pub fn half(value: u32, top: bool) -> i32 {
    (if top { value >> 16 } else { value }) as i16 as i32
}
