//! Multiplication and division.

use super::super::arithmetic::half;
use super::super::fault::Fault;
use super::super::instruction::{Long, Reg, SetFlags};
use super::super::{Trapped, timing};
use crate::cpu::Cpu;

impl Cpu {
    #[inline]
    pub(super) fn multiply(&mut self, d: Reg, n: Reg, m: Reg, set: SetFlags) {
        let result = self.get(n).wrapping_mul(self.get(m));
        self.set(d, result);
        if self.sets_flags(set) {
            self.set_nz(result);
        }
    }

    #[inline]
    pub(super) fn multiply_add(&mut self, d: Reg, n: Reg, m: Reg, a: Reg, subtract: bool) {
        let product = self.get(n).wrapping_mul(self.get(m));
        let addend = self.get(a);
        let result = if subtract {
            addend.wrapping_sub(product)
        } else {
            addend.wrapping_add(product)
        };
        self.set(d, result);
        self.spent += timing::MULTIPLY_ADD;
    }

    #[inline]
    pub(super) fn multiply_long(&mut self, long: Long, low: Reg, high: Reg, n: Reg, m: Reg) {
        let (n, m) = (self.get(n), self.get(m));
        let signed = i64::from(n as i32) * i64::from(m as i32);
        let unsigned = u64::from(n) * u64::from(m);
        let result = match long {
            Long::Signed => signed as u64,
            Long::Unsigned => unsigned,
            Long::SignedAccumulate => (signed as u64).wrapping_add(self.pair(low, high)),
            Long::UnsignedAccumulate => unsigned.wrapping_add(self.pair(low, high)),
            Long::UnsignedAccumulateTwice => {
                unsigned + u64::from(self.get(low)) + u64::from(self.get(high))
            }
        };
        self.set_pair(low, high, result);
    }

    fn pair(&self, low: Reg, high: Reg) -> u64 {
        u64::from(self.get(high)) << 32 | u64::from(self.get(low))
    }

    fn set_pair(&mut self, low: Reg, high: Reg, value: u64) {
        self.set(low, value as u32);
        self.set(high, (value >> 32) as u32);
    }

    /// Sets a register to the lower 32 bits of a sum, and sets Q if the sum does not fit.
    fn set_sum(&mut self, d: Reg, sum: i64) {
        self.set(d, sum as u32);
        self.flags.q |= i64::from(sum as i32) != sum;
    }

    fn addend(&self, a: Option<Reg>) -> i64 {
        a.map_or(0, |a| i64::from(self.get(a) as i32))
    }

    /// SMULBB, SMLABB and their variants.
    pub(super) fn multiply_halves(
        &mut self,
        d: Reg,
        n: Reg,
        m: Reg,
        a: Option<Reg>,
        n_top: bool,
        m_top: bool,
    ) {
        let product = half(self.get(n), n_top) * half(self.get(m), m_top);
        self.set_sum(d, i64::from(product) + self.addend(a));
    }

    /// SMULWB, SMLAWB and their variants.
    pub(super) fn multiply_word_by_half(
        &mut self,
        d: Reg,
        n: Reg,
        m: Reg,
        a: Option<Reg>,
        m_top: bool,
    ) {
        let product = i64::from(self.get(n) as i32) * i64::from(half(self.get(m), m_top));
        self.set_sum(d, (product >> 16) + self.addend(a));
    }

    /// Sum or difference of the products of the low and of the high halfwords.
    fn dual(&self, n: Reg, m: Reg, subtract: bool, exchange: bool) -> i64 {
        let n = self.get(n);
        let m = self.get(m).rotate_right(if exchange { 16 } else { 0 });
        let low = i64::from(half(n, false)) * i64::from(half(m, false));
        let high = i64::from(half(n, true)) * i64::from(half(m, true));
        if subtract { low - high } else { low + high }
    }

    /// SMUAD, SMUSD, SMLAD, SMLSD.
    pub(super) fn multiply_dual(
        &mut self,
        d: Reg,
        n: Reg,
        m: Reg,
        a: Option<Reg>,
        subtract: bool,
        exchange: bool,
    ) {
        let sum = self.dual(n, m, subtract, exchange) + self.addend(a);
        self.set_sum(d, sum);
    }

    /// SMLALBB and its variants.
    pub(super) fn multiply_halves_long(
        &mut self,
        low: Reg,
        high: Reg,
        n: Reg,
        m: Reg,
        n_top: bool,
        m_top: bool,
    ) {
        let product = half(self.get(n), n_top) * half(self.get(m), m_top);
        let sum = self.pair(low, high).wrapping_add_signed(product.into());
        self.set_pair(low, high, sum);
    }

    /// SMLALD and SMLSLD.
    pub(super) fn multiply_dual_long(
        &mut self,
        low: Reg,
        high: Reg,
        n: Reg,
        m: Reg,
        subtract: bool,
        exchange: bool,
    ) {
        let products = self.dual(n, m, subtract, exchange);
        let sum = self.pair(low, high).wrapping_add_signed(products);
        self.set_pair(low, high, sum);
    }

    /// SMMUL, SMMLA, SMMLS.
    pub(super) fn multiply_most_significant(
        &mut self,
        d: Reg,
        n: Reg,
        m: Reg,
        a: Option<Reg>,
        subtract: bool,
        round: bool,
    ) {
        let product = i64::from(self.get(n) as i32) * i64::from(self.get(m) as i32);
        let addend = self.addend(a) << 32;
        let sum = if subtract {
            addend.wrapping_sub(product)
        } else {
            addend.wrapping_add(product)
        };
        let sum = sum.wrapping_add(if round { 0x8000_0000 } else { 0 });
        self.set(d, (sum >> 32) as u32);
    }

    #[inline]
    pub(super) fn divide(&mut self, d: Reg, n: Reg, m: Reg, signed: bool) -> Result<(), Trapped> {
        let (n, m) = (self.get(n), self.get(m));
        if m == 0 {
            if self.system.traps_division_by_zero() {
                return Err(self.fault(Fault::DivideByZero));
            }
            self.spent += 1;
            self.set(d, 0);
            return Ok(());
        }
        let (result, dividend, divisor) = if signed {
            let (n, m) = (n as i32, m as i32);
            (n.wrapping_div(m) as u32, n.unsigned_abs(), m.unsigned_abs())
        } else {
            (n / m, n, m)
        };
        self.spent += timing::divide(dividend, divisor);
        self.set(d, result);
        Ok(())
    }
}
