//! Instructions of the FPU.

use super::super::fault::Fault;
use super::super::instruction::{FloatOp, Instruction, UnaryOp};
use super::super::status::Flags;
use super::super::{Bus, Trapped, Width, timing};
use crate::cpu::Cpu;
use crate::cpu::floating_point::Fpscr;

const SIGN: u32 = 1 << 31;

impl Cpu {
    #[inline]
    fn s(&self, register: u8) -> u32 {
        self.float.registers[usize::from(register & 31)]
    }

    #[inline]
    fn set_s(&mut self, register: u8, bits: u32) {
        self.float.registers[usize::from(register & 31)] = bits;
    }

    /// Sets a register to the result of arithmetic. An instruction that reads it next must wait.
    #[inline]
    fn set_result(&mut self, register: u8, bits: u32) {
        self.set_s(register, bits);
        self.float.last_result_at = self.instructions;
        self.float.last_result = register;
    }

    /// Waits one cycle if the previous instruction computed one of these registers.
    #[inline]
    fn await_operands(&mut self, n: u8, m: u8) {
        let fresh = self.float.last_result_at + 1 == self.instructions
            && (self.float.last_result == n || self.float.last_result == m);
        self.spent += u32::from(fresh);
    }

    #[inline]
    pub(super) fn execute_float<B: Bus>(
        &mut self,
        bus: &mut B,
        instruction: &Instruction,
    ) -> Result<(), Trapped> {
        use Instruction as I;
        if !self.float.ready {
            self.prepare_float(bus)?;
        }
        match *instruction {
            I::FloatArithmetic { float, d, n, m } => self.float_arithmetic(float, d, n, m),
            I::FloatUnary { float, d, m } => self.float_unary(float, d, m),
            I::FloatImmediate { d, bits } => self.set_s(d, bits),
            I::FloatCompare {
                d,
                m,
                quiet_is_invalid,
            } => {
                self.await_operands(d, m.unwrap_or(d));
                let other = m.map_or(0, |m| self.s(m));
                let this = self.s(d);
                self.float.status.compare(this, other, quiet_is_invalid);
            }
            I::FloatToInteger {
                d,
                m,
                signed,
                round_to_zero,
            } => {
                self.await_operands(m, m);
                let value = self.s(m);
                let status = &mut self.float.status;
                let result = status.float_to_fixed(value, signed, 32, 0, round_to_zero);
                self.set_result(d, result);
            }
            I::IntegerToFloat { d, m, signed } => {
                self.await_operands(m, m);
                let value = self.s(m);
                let result = self
                    .float
                    .status
                    .fixed_to_float(value, signed, 32, 0, false);
                self.set_result(d, result);
            }
            I::FloatToFixed {
                d,
                signed,
                bits,
                fraction,
            } => {
                self.await_operands(d, d);
                let value = self.s(d);
                let status = &mut self.float.status;
                let result = status.float_to_fixed(value, signed, bits, fraction, true);
                self.set_result(d, result);
            }
            I::FixedToFloat {
                d,
                signed,
                bits,
                fraction,
            } => {
                self.await_operands(d, d);
                let value = self.s(d);
                let status = &mut self.float.status;
                let result = status.fixed_to_float(value, signed, bits, fraction, true);
                self.set_result(d, result);
            }
            I::HalfToFloat { d, m, top } => {
                self.await_operands(m, m);
                let half = (self.s(m) >> if top { 16 } else { 0 }) as u16;
                let result = self.float.status.half_to_single(half);
                self.set_result(d, result);
            }
            I::FloatToHalf { d, m, top } => {
                self.await_operands(m, m);
                let value = self.s(m);
                let half = u32::from(self.float.status.single_to_half(value));
                let old = self.s(d);
                let result = if top {
                    old & 0xFFFF | half << 16
                } else {
                    old & 0xFFFF_0000 | half
                };
                self.set_result(d, result);
            }
            I::FloatLoad {
                first,
                count,
                n,
                offset,
            } => {
                self.spent += u32::from(count);
                self.await_address(n);
                let address = self.get(n).wrapping_add_signed(offset);
                self.float_load(bus, first, count, address)?;
            }
            I::FloatLoadLiteral {
                first,
                count,
                address,
            } => {
                self.spent += u32::from(count);
                self.float_load(bus, first, count, address)?;
            }
            I::FloatStore {
                first,
                count,
                n,
                offset,
            } => {
                self.spent += u32::from(count);
                self.await_address(n);
                self.await_operands(first, first);
                let address = self.get(n).wrapping_add_signed(offset);
                self.float_store(bus, first, count, address)?;
            }
            I::FloatLoadMultiple {
                first,
                count,
                n,
                down,
                writeback,
                words,
            } => {
                let (address, end) = self.block(n, down, words.into());
                self.float_load(bus, first, count, address)?;
                if writeback {
                    self.set_loaded(n, end);
                }
            }
            I::FloatStoreMultiple {
                first,
                count,
                n,
                down,
                writeback,
                words,
            } => {
                let (address, end) = self.block(n, down, words.into());
                self.float_store(bus, first, count, address)?;
                if writeback {
                    self.set_loaded(n, end);
                }
            }
            I::CoreToFloat { s, t } => self.set_s(s, self.get(t)),
            I::FloatToCore { s, t } => {
                self.await_operands(s, s);
                self.set(t, self.s(s));
            }
            I::CorePairToFloat { s, t, t2 } => {
                self.spent += 1;
                self.set_s(s, self.get(t));
                self.set_s(s + 1, self.get(t2));
            }
            I::FloatToCorePair { s, t, t2 } => {
                self.spent += 1;
                self.await_operands(s, s + 1);
                self.set(t, self.s(s));
                self.set(t2, self.s(s + 1));
            }
            I::FloatStatusToCore { t } => self.set(t, self.float.status.bits()),
            I::FloatStatusToFlags => {
                let compared = Flags::from_bits(self.float.status.bits());
                self.flags.n = compared.n;
                self.flags.z = compared.z;
                self.flags.c = compared.c;
                self.flags.v = compared.v;
            }
            I::CoreToFloatStatus { t } => self.float.status = Fpscr::new(self.get(t)),
            _ => return Err(self.fault(Fault::UndefinedInstruction)),
        }
        Ok(())
    }

    #[inline]
    fn float_arithmetic(&mut self, float: FloatOp, d: u8, n: u8, m: u8) {
        self.spent += timing::float(float);
        self.await_operands(n, m);
        let (old, n, m) = (self.s(d), self.s(n), self.s(m));
        let status = &mut self.float.status;
        let result = match float {
            FloatOp::Add => status.add(n, m),
            FloatOp::Sub => status.sub(n, m),
            FloatOp::Mul => status.mul(n, m),
            FloatOp::Nmul => status.mul(n, m) ^ SIGN,
            FloatOp::Div => status.div(n, m),
            FloatOp::Mla => {
                let product = status.mul(n, m);
                status.add(old, product)
            }
            FloatOp::Mls => {
                let product = status.mul(n, m) ^ SIGN;
                status.add(old, product)
            }
            FloatOp::Nmla => {
                let product = status.mul(n, m) ^ SIGN;
                status.add(old ^ SIGN, product)
            }
            FloatOp::Nmls => {
                let product = status.mul(n, m);
                status.add(old ^ SIGN, product)
            }
            FloatOp::Fma => status.fused(old, n, m),
            FloatOp::Fms => status.fused(old, n ^ SIGN, m),
            FloatOp::Fnma => status.fused(old ^ SIGN, n ^ SIGN, m),
            FloatOp::Fnms => status.fused(old ^ SIGN, n, m),
        };
        self.set_result(d, result);
    }

    #[inline]
    fn float_unary(&mut self, float: UnaryOp, d: u8, m: u8) {
        self.await_operands(m, m);
        let value = self.s(m);
        match float {
            UnaryOp::Mov => self.set_s(d, value),
            UnaryOp::Abs => self.set_s(d, value & !SIGN),
            UnaryOp::Neg => self.set_s(d, value ^ SIGN),
            UnaryOp::Sqrt => {
                self.spent += timing::SQUARE_ROOT;
                let root = self.float.status.sqrt(value);
                self.set_result(d, root);
            }
        }
    }

    #[inline]
    fn float_load<B: Bus>(
        &mut self,
        bus: &mut B,
        first: u8,
        count: u8,
        address: u32,
    ) -> Result<(), Trapped> {
        self.check_aligned(address, Width::Word)?;
        for i in 0..count {
            let word = self.read(bus, address.wrapping_add(4 * u32::from(i)), Width::Word)?;
            self.set_s(first + i, word);
        }
        Ok(())
    }

    #[inline]
    fn float_store<B: Bus>(
        &mut self,
        bus: &mut B,
        first: u8,
        count: u8,
        address: u32,
    ) -> Result<(), Trapped> {
        self.check_aligned(address, Width::Word)?;
        for i in 0..count {
            let word = self.s(first + i);
            self.write(
                bus,
                address.wrapping_add(4 * u32::from(i)),
                Width::Word,
                word,
            )?;
        }
        Ok(())
    }
}
