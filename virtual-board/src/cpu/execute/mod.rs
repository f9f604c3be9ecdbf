//! Executes instructions.

mod branch;
mod data;
mod float;
mod load_store;
mod multiply;
mod parallel;
mod system;

use super::fault::Fault;
use super::instruction::{Instruction, Reg, SP, SetFlags};
use super::{Bus, Cpu, Stop, Trapped, Unmodelled, timing};

/// Writable bits of each register. The stack pointer is always aligned to a word.
const WRITABLE: [u32; 17] = {
    let mut masks = [u32::MAX; 17];
    masks[SP as usize] = !3;
    masks
};

impl Cpu {
    #[inline(always)]
    fn get(&self, register: Reg) -> u32 {
        self.registers[usize::from(register)]
    }

    /// Sets a register to the result of a computation.
    #[inline(always)]
    fn set(&mut self, register: Reg, value: u32) {
        self.last_result_at = self.instructions;
        self.last_result = register;
        self.set_loaded(register, value);
    }

    /// Sets a register to a loaded value, or to a written-back address.
    #[inline(always)]
    fn set_loaded(&mut self, register: Reg, value: u32) {
        let register = usize::from(register);
        self.registers[register] = value & WRITABLE[register];
    }

    /// Waits one cycle if the previous instruction computed the base register of an address.
    #[inline(always)]
    fn await_address(&mut self, base: Reg) {
        let fresh = self.last_result_at + 1 == self.instructions && self.last_result == base;
        self.spent += u32::from(fresh);
    }

    #[inline(always)]
    fn sets_flags(&self, set: SetFlags) -> bool {
        match set {
            SetFlags::Never => false,
            SetFlags::Always => true,
            SetFlags::OutsideIt => !self.in_it_block,
        }
    }

    /// Executes one instruction. `pc` already points to the next one.
    #[inline(always)]
    pub(super) fn execute<B: Bus>(
        &mut self,
        bus: &mut B,
        instruction: &Instruction,
    ) -> Result<(), Trapped> {
        use Instruction as I;
        match *instruction {
            I::DataImmediate {
                alu,
                set,
                d,
                n,
                carry,
                value,
            } => self.data_immediate(alu, set, d, n, carry, value),
            I::DataRegister {
                alu,
                set,
                d,
                n,
                m,
                shift,
                amount,
            } => self.data_register(alu, set, d, n, m, shift, amount),
            I::ShiftRegister {
                shift,
                set,
                d,
                n,
                m,
            } => self.shift_register(shift, set, d, n, m),
            I::MoveTop { d, value } => {
                self.set(d, self.get(d) & 0xFFFF | u32::from(value) << 16);
            }
            I::CountLeadingZeros { d, m } => self.set(d, self.get(m).leading_zeros()),
            I::Reverse { reverse, d, m } => self.reverse(reverse, d, m),
            I::BitFieldInsert { d, n, mask, lsb } => self.insert_bits(d, n, mask, lsb),
            I::BitFieldExtract {
                d,
                n,
                lsb,
                width,
                signed,
            } => self.extract_bits(d, n, lsb, width, signed),
            I::Extend {
                extend,
                d,
                n,
                m,
                rotation,
            } => self.extend(extend, d, n, m, rotation),
            I::Saturate {
                signed,
                d,
                n,
                to,
                shift,
                amount,
            } => self.saturate(signed, d, n, to, shift, amount),
            I::SaturateHalves { signed, d, n, to } => self.saturate_halves(signed, d, n, to),
            I::SaturatingAdd {
                d,
                n,
                m,
                double,
                subtract,
            } => self.saturating_add(d, n, m, double, subtract),
            I::PackHalfwords {
                d,
                n,
                m,
                top,
                shift,
                amount,
            } => self.pack_halfwords(d, n, m, top, shift, amount),
            I::Select { d, n, m } => self.select(d, n, m),
            I::Parallel {
                parallel,
                lanes,
                d,
                n,
                m,
            } => self.parallel(parallel, lanes, d, n, m),
            I::SumOfDifferences { d, n, m, a } => self.sum_of_differences(d, n, m, a),

            I::Multiply { d, n, m, set } => self.multiply(d, n, m, set),
            I::MultiplyAdd {
                d,
                n,
                m,
                a,
                subtract,
            } => self.multiply_add(d, n, m, a, subtract),
            I::MultiplyLong {
                long,
                low,
                high,
                n,
                m,
            } => self.multiply_long(long, low, high, n, m),
            I::MultiplyHalves {
                d,
                n,
                m,
                a,
                n_top,
                m_top,
            } => self.multiply_halves(d, n, m, a, n_top, m_top),
            I::MultiplyWordByHalf { d, n, m, a, m_top } => {
                self.multiply_word_by_half(d, n, m, a, m_top);
            }
            I::MultiplyDual {
                d,
                n,
                m,
                a,
                subtract,
                exchange,
            } => self.multiply_dual(d, n, m, a, subtract, exchange),
            I::MultiplyHalvesLong {
                low,
                high,
                n,
                m,
                n_top,
                m_top,
            } => self.multiply_halves_long(low, high, n, m, n_top, m_top),
            I::MultiplyDualLong {
                low,
                high,
                n,
                m,
                subtract,
                exchange,
            } => self.multiply_dual_long(low, high, n, m, subtract, exchange),
            I::MultiplyMostSignificant {
                d,
                n,
                m,
                a,
                subtract,
                round,
            } => self.multiply_most_significant(d, n, m, a, subtract, round),
            I::Divide { d, n, m, signed } => self.divide(d, n, m, signed)?,

            I::Branch { condition, target } => {
                if self.flags.hold(condition) {
                    self.branch(target);
                }
            }
            I::BranchLink { target } => self.branch_link(target),
            I::BranchExchange { m, link } => self.branch_exchange(bus, m, link),
            I::MoveToPc { m } => self.branch(self.get(m) & !1),
            I::AddToPc { m, base } => self.branch(self.get(m).wrapping_add(base) & !1),
            I::CompareBranch { n, nonzero, target } => {
                if (self.get(n) != 0) == nonzero {
                    self.branch(target);
                }
            }
            I::TableBranch { n, m, half } => self.table_branch(bus, n, m, half)?,
            I::IfThen { state } => self.it.0 = state,

            I::Load {
                kind,
                t,
                n,
                offset,
                index,
            } => self.load(bus, kind, t, n, offset, index)?,
            I::LoadRegister {
                kind,
                t,
                n,
                m,
                shift,
            } => self.load_register(bus, kind, t, n, m, shift)?,
            I::LoadLiteral { kind, t, address } => {
                self.time_load(super::NO_REGISTER, t);
                self.load_into(bus, kind, t, address)?;
            }
            I::Store {
                kind,
                t,
                n,
                offset,
                index,
            } => self.store(bus, kind, t, n, offset, index)?,
            I::StoreRegister {
                kind,
                t,
                n,
                m,
                shift,
            } => self.store_register(bus, kind, t, n, m, shift)?,
            I::LoadDouble {
                t,
                t2,
                n,
                offset,
                index,
            } => self.load_double(bus, t, t2, n, offset, index)?,
            I::LoadDoubleLiteral { t, t2, address } => {
                self.load_double_from(bus, t, t2, address)?;
            }
            I::StoreDouble {
                t,
                t2,
                n,
                offset,
                index,
            } => self.store_double(bus, t, t2, n, offset, index)?,
            I::LoadMultiple {
                n,
                list,
                down,
                writeback,
            } => self.load_multiple(bus, n, list, down, writeback)?,
            I::StoreMultiple {
                n,
                list,
                down,
                writeback,
            } => self.store_multiple(bus, n, list, down, writeback)?,
            I::LoadExclusive { kind, t, n, offset } => {
                self.load_exclusive(bus, kind, t, n, offset)?;
            }
            I::StoreExclusive {
                kind,
                d,
                t,
                n,
                offset,
            } => self.store_exclusive(bus, kind, d, t, n, offset)?,
            I::ClearExclusive => self.exclusive = false,

            I::ReadSpecial { d, special } => self.read_special(d, special)?,
            I::WriteSpecial { n, special, mask } => self.write_special(n, special, mask)?,
            I::ChangeState {
                disable,
                primask,
                faultmask,
            } => self.change_state(disable, primask, faultmask),
            I::Barrier => self.spent += timing::refill(self.pc),
            I::Nop => {}
            I::SendEvent => self.event = true,
            I::WaitForEvent => self.wait_for_event(),
            I::WaitForInterrupt => self.wait_for_interrupt(),
            I::SupervisorCall => self.call_supervisor(),
            I::Breakpoint => return Err(self.fault(Fault::Debug)),
            I::Undefined => return Err(self.fault(Fault::UndefinedInstruction)),
            I::NoCoprocessor => return Err(self.fault(Fault::NoCoprocessor)),
            I::Unpredictable => return Err(self.unpredictable(bus)),

            _ => self.execute_float(bus, instruction)?,
        }
        Ok(())
    }

    /// Ends the run at an instruction that the manual calls unpredictable.
    #[cold]
    fn unpredictable<B: Bus>(&mut self, bus: &mut B) -> Trapped {
        let pc = self.instruction_address;
        let half = |cpu: &Self, bus: &mut B, at| cpu.fetch(bus, at).map_or(0, u32::from);
        let first = half(self, bus, pc);
        let word = if first >= 0xE800 {
            first << 16 | half(self, bus, pc.wrapping_add(2))
        } else {
            first
        };
        self.stop(Stop::Unmodelled(Unmodelled::Instruction {
            word,
            pc,
            why: "its effect is unpredictable",
        }))
    }
}
