//! Branches.

use super::super::instruction::{LR, PC, Reg};
use super::super::{Bus, Trapped, Width, timing};
use crate::cpu::Cpu;

/// In handler mode, a jump to this address or above is an exception return.
const EXCEPTION_RETURN: u32 = 0xF000_0000;

impl Cpu {
    /// BranchTo.
    #[inline(always)]
    pub(super) fn branch(&mut self, target: u32) {
        self.spent += timing::refill(target);
        self.pc = target;
    }

    #[inline]
    pub(super) fn branch_link(&mut self, target: u32) {
        self.set(LR, self.pc | 1);
        self.branch(target);
    }

    /// BX and BLX.
    #[inline]
    pub(super) fn branch_exchange<B: Bus>(&mut self, bus: &mut B, m: Reg, link: bool) {
        let target = self.get(m);
        if link {
            self.set(LR, self.pc | 1);
            self.spent += timing::refill(target);
            self.jump_unspent(target);
        } else {
            self.write_pc(bus, target);
        }
    }

    /// BXWritePC. A load into PC uses it too.
    #[inline]
    pub(super) fn write_pc<B: Bus>(&mut self, bus: &mut B, target: u32) {
        self.spent += timing::refill(target);
        if self.exception != 0 && target >= EXCEPTION_RETURN {
            self.return_from_exception(bus, target);
        } else {
            self.jump_unspent(target);
        }
    }

    /// TBB and TBH.
    pub(super) fn table_branch<B: Bus>(
        &mut self,
        bus: &mut B,
        n: Reg,
        m: Reg,
        half: bool,
    ) -> Result<(), Trapped> {
        let base = if n == PC { self.pc } else { self.get(n) };
        let index = self.get(m);
        let halfwords = if half {
            self.read(bus, base.wrapping_add(index << 1), Width::Half)?
        } else {
            self.read(bus, base.wrapping_add(index), Width::Byte)?
        };
        self.spent += 1;
        self.branch(self.pc.wrapping_add(2 * halfwords));
        Ok(())
    }
}
