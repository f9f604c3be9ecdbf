//! Data processing.

use super::super::arithmetic::{
    add_with_carry, half, saturate_signed, saturate_unsigned, shift_with_carry,
};
use super::super::instruction::{Alu, Extension, Reg, Reversal, SetFlags, Shift, ShifterCarry};
use crate::cpu::Cpu;

impl Cpu {
    #[inline(always)]
    fn alu(&mut self, alu: Alu, set: bool, d: Reg, a: u32, b: u32, shifter_carry: bool) {
        let flags = self.flags;
        let logical = |result| (result, shifter_carry, flags.v);
        let (result, c, v) = match alu {
            Alu::And => logical(a & b),
            Alu::Bic => logical(a & !b),
            Alu::Orr => logical(a | b),
            Alu::Orn => logical(a | !b),
            Alu::Eor => logical(a ^ b),
            Alu::Mov => logical(b),
            Alu::Mvn => logical(!b),
            Alu::Add => add_with_carry(a, b, false),
            Alu::Adc => add_with_carry(a, b, flags.c),
            Alu::Sub => add_with_carry(a, !b, true),
            Alu::Sbc => add_with_carry(a, !b, flags.c),
            Alu::Rsb => add_with_carry(!a, b, true),
        };
        self.set(d, result);
        if set {
            self.set_nz(result);
            self.flags.c = c;
            self.flags.v = v;
        }
    }

    #[inline]
    pub(super) fn set_nz(&mut self, result: u32) {
        self.flags.n = result >> 31 == 1;
        self.flags.z = result == 0;
    }

    #[inline(always)]
    pub(super) fn data_immediate(
        &mut self,
        alu: Alu,
        set: SetFlags,
        d: Reg,
        n: Reg,
        carry: ShifterCarry,
        value: u32,
    ) {
        let carry = match carry {
            ShifterCarry::Unchanged => self.flags.c,
            ShifterCarry::Clear => false,
            ShifterCarry::Set => true,
        };
        self.alu(alu, self.sets_flags(set), d, self.get(n), value, carry);
    }

    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "the fields of one instruction")]
    pub(super) fn data_register(
        &mut self,
        alu: Alu,
        set: SetFlags,
        d: Reg,
        n: Reg,
        m: Reg,
        shift: Shift,
        amount: u8,
    ) {
        let (operand, carry) = shift_with_carry(self.get(m), shift, amount, self.flags.c);
        self.alu(alu, self.sets_flags(set), d, self.get(n), operand, carry);
    }

    #[inline]
    pub(super) fn shift_register(&mut self, shift: Shift, set: SetFlags, d: Reg, n: Reg, m: Reg) {
        let amount = self.get(m) as u8;
        let (result, carry) = shift_with_carry(self.get(n), shift, amount, self.flags.c);
        self.set(d, result);
        if self.sets_flags(set) {
            self.set_nz(result);
            self.flags.c = carry;
        }
    }

    pub(super) fn reverse(&mut self, reverse: Reversal, d: Reg, m: Reg) {
        let value = self.get(m);
        let result = match reverse {
            Reversal::Bits => value.reverse_bits(),
            Reversal::Bytes => value.swap_bytes(),
            Reversal::BytesOfHalves => value.swap_bytes().rotate_right(16),
            Reversal::SignedHalf => (value as u16).swap_bytes() as i16 as u32,
        };
        self.set(d, result);
    }

    pub(super) fn insert_bits(&mut self, d: Reg, n: Reg, mask: u32, lsb: u8) {
        // BFC is decoded as an insertion from the sink register. It inserts zeros.
        let source = if n == super::super::instruction::SINK {
            0
        } else {
            self.get(n)
        };
        self.set(d, self.get(d) & !mask | source << lsb & mask);
    }

    pub(super) fn extract_bits(&mut self, d: Reg, n: Reg, lsb: u8, width: u8, signed: bool) {
        let unused = 32 - u32::from(width);
        let top = self.get(n) << (unused - u32::from(lsb));
        let result = if signed {
            (top as i32 >> unused) as u32
        } else {
            top >> unused
        };
        self.set(d, result);
    }

    pub(super) fn extend(&mut self, extend: Extension, d: Reg, n: Option<Reg>, m: Reg, by: u8) {
        let value = self.get(m).rotate_right(by.into());
        let addend = n.map_or(0, |n| self.get(n));
        let in_halves = |low: u32, high: u32| {
            let low = addend.wrapping_add(low) & 0xFFFF;
            let high = (addend >> 16).wrapping_add(high) << 16;
            high | low
        };
        let result = match extend {
            Extension::SignedByte => addend.wrapping_add(value as i8 as u32),
            Extension::Byte => addend.wrapping_add(value & 0xFF),
            Extension::SignedHalf => addend.wrapping_add(value as i16 as u32),
            Extension::Half => addend.wrapping_add(value & 0xFFFF),
            Extension::SignedBytes => in_halves(value as i8 as u32, (value >> 16) as i8 as u32),
            Extension::Bytes => in_halves(value & 0xFF, value >> 16 & 0xFF),
        };
        self.set(d, result);
    }

    pub(super) fn saturate(
        &mut self,
        signed: bool,
        d: Reg,
        n: Reg,
        to: u8,
        shift: Shift,
        amount: u8,
    ) {
        let (value, _) = shift_with_carry(self.get(n), shift, amount, false);
        let value = i64::from(value as i32);
        let (result, saturated) = if signed {
            let (result, saturated) = saturate_signed(value, to);
            (result as u32, saturated)
        } else {
            saturate_unsigned(value, to)
        };
        self.set(d, result);
        self.flags.q |= saturated;
    }

    pub(super) fn saturate_halves(&mut self, signed: bool, d: Reg, n: Reg, to: u8) {
        let value = self.get(n);
        let [low, high] = [false, true].map(|top| {
            let value = i64::from(half(value, top));
            let (result, saturated) = if signed {
                let (result, saturated) = saturate_signed(value, to);
                (result as u32, saturated)
            } else {
                saturate_unsigned(value, to)
            };
            self.flags.q |= saturated;
            result & 0xFFFF
        });
        self.set(d, high << 16 | low);
    }

    pub(super) fn saturating_add(&mut self, d: Reg, n: Reg, m: Reg, double: bool, subtract: bool) {
        let mut n = i64::from(self.get(n) as i32);
        let m = i64::from(self.get(m) as i32);
        if double {
            let (doubled, saturated) = saturate_signed(2 * n, 32);
            self.flags.q |= saturated;
            n = doubled.into();
        }
        let (result, saturated) = saturate_signed(if subtract { m - n } else { m + n }, 32);
        self.flags.q |= saturated;
        self.set(d, result as u32);
    }

    pub(super) fn pack_halfwords(
        &mut self,
        d: Reg,
        n: Reg,
        m: Reg,
        top: bool,
        shift: Shift,
        amount: u8,
    ) {
        let n = self.get(n);
        let (m, _) = shift_with_carry(self.get(m), shift, amount, false);
        let (high, low) = if top { (n, m) } else { (m, n) };
        self.set(d, high & 0xFFFF_0000 | low & 0xFFFF);
    }
}
