//! Loads and stores of core registers.

use super::super::instruction::{Access, Index, PC, Reg};
use super::super::{Bus, Trapped, Width};
use crate::cpu::Cpu;

impl Access {
    #[inline]
    fn width(self) -> Width {
        match self {
            Self::Byte | Self::SignedByte => Width::Byte,
            Self::Half | Self::SignedHalf => Width::Half,
            Self::Word => Width::Word,
        }
    }

    #[inline]
    fn extend(self, value: u32) -> u32 {
        match self {
            Self::SignedByte => value as i8 as u32,
            Self::SignedHalf => value as i16 as u32,
            _ => value,
        }
    }
}

/// Address of an access, and the new value of the base register if it is written back.
#[inline]
fn addresses(base: u32, offset: i32, index: Index) -> (u32, Option<u32>) {
    let moved = base.wrapping_add_signed(offset);
    match index {
        Index::Offset => (moved, None),
        Index::Pre => (moved, Some(moved)),
        Index::Post => (base, Some(moved)),
    }
}

impl Cpu {
    /// Spends the second cycle of a load. A load that follows another load and does not use its result overlaps and needs
    /// one cycle.
    #[inline(always)]
    pub(super) fn time_load(&mut self, base: Reg, loads: Reg) {
        self.await_address(base);
        self.spent += u32::from(!self.overlaps_load(base));
        self.last_load_at = self.instructions;
        self.last_loaded = loads;
    }

    #[inline(always)]
    fn overlaps_load(&self, base: Reg) -> bool {
        self.last_load_at + 1 == self.instructions && self.last_loaded != base
    }

    #[inline(always)]
    pub(super) fn load_into<B: Bus>(
        &mut self,
        bus: &mut B,
        kind: Access,
        t: Reg,
        address: u32,
    ) -> Result<(), Trapped> {
        let value = self.read(bus, address, kind.width())?;
        if t == PC {
            self.load_pc(bus, address, value)
        } else {
            self.set_loaded(t, kind.extend(value));
            Ok(())
        }
    }

    fn load_pc<B: Bus>(&mut self, bus: &mut B, address: u32, value: u32) -> Result<(), Trapped> {
        if address & 3 != 0 {
            return Err(self.unpredictable(bus));
        }
        self.write_pc(bus, value);
        Ok(())
    }

    #[inline(always)]
    pub(super) fn load<B: Bus>(
        &mut self,
        bus: &mut B,
        kind: Access,
        t: Reg,
        n: Reg,
        offset: i32,
        index: Index,
    ) -> Result<(), Trapped> {
        let (address, new_base) = addresses(self.get(n), offset, index);
        self.time_load(n, t);
        let Some(new_base) = new_base else {
            return self.load_into(bus, kind, t, address);
        };
        let old_base = self.get(n);
        // The base is written back before the load, because a load into PC may end the handler.
        self.set_loaded(n, new_base);
        let result = self.load_into(bus, kind, t, address);
        if result.is_err() {
            self.set_loaded(n, old_base);
        }
        result
    }

    #[inline(always)]
    pub(super) fn load_register<B: Bus>(
        &mut self,
        bus: &mut B,
        kind: Access,
        t: Reg,
        n: Reg,
        m: Reg,
        shift: u8,
    ) -> Result<(), Trapped> {
        let address = self.get(n).wrapping_add(self.get(m) << shift);
        self.await_address(m);
        self.time_load(n, t);
        self.load_into(bus, kind, t, address)
    }

    #[inline(always)]
    pub(super) fn store<B: Bus>(
        &mut self,
        bus: &mut B,
        kind: Access,
        t: Reg,
        n: Reg,
        offset: i32,
        index: Index,
    ) -> Result<(), Trapped> {
        let (address, new_base) = addresses(self.get(n), offset, index);
        // A store needs no second cycle: the write buffer completes it during the next instruction.
        self.await_address(n);
        self.write(bus, address, kind.width(), self.get(t))?;
        if let Some(new_base) = new_base {
            self.set_loaded(n, new_base);
        }
        Ok(())
    }

    #[inline(always)]
    pub(super) fn store_register<B: Bus>(
        &mut self,
        bus: &mut B,
        kind: Access,
        t: Reg,
        n: Reg,
        m: Reg,
        shift: u8,
    ) -> Result<(), Trapped> {
        let address = self.get(n).wrapping_add(self.get(m) << shift);
        self.await_address(n);
        self.await_address(m);
        self.spent += u32::from(!self.overlaps_load(n));
        self.write(bus, address, kind.width(), self.get(t))
    }

    #[inline]
    pub(super) fn load_double<B: Bus>(
        &mut self,
        bus: &mut B,
        t: Reg,
        t2: Reg,
        n: Reg,
        offset: i16,
        index: Index,
    ) -> Result<(), Trapped> {
        let (address, new_base) = addresses(self.get(n), offset.into(), index);
        self.await_address(n);
        self.load_double_from(bus, t, t2, address)?;
        if let Some(new_base) = new_base {
            self.set_loaded(n, new_base);
        }
        Ok(())
    }

    pub(super) fn load_double_from<B: Bus>(
        &mut self,
        bus: &mut B,
        t: Reg,
        t2: Reg,
        address: u32,
    ) -> Result<(), Trapped> {
        self.spent += 2;
        let low = self.read_word(bus, address)?;
        let high = self.read_word(bus, address.wrapping_add(4))?;
        self.set_loaded(t, low);
        self.set_loaded(t2, high);
        Ok(())
    }

    #[inline]
    pub(super) fn store_double<B: Bus>(
        &mut self,
        bus: &mut B,
        t: Reg,
        t2: Reg,
        n: Reg,
        offset: i16,
        index: Index,
    ) -> Result<(), Trapped> {
        let (address, new_base) = addresses(self.get(n), offset.into(), index);
        self.await_address(n);
        self.spent += 2;
        self.write_word(bus, address, self.get(t))?;
        self.write_word(bus, address.wrapping_add(4), self.get(t2))?;
        if let Some(new_base) = new_base {
            self.set_loaded(n, new_base);
        }
        Ok(())
    }

    /// First address of a block of `words` words at register `n`, and the new value of the register. Spends a cycle for each
    /// word.
    pub(super) fn block(&mut self, n: Reg, down: bool, words: u32) -> (u32, u32) {
        self.await_address(n);
        self.spent += words;
        let base = self.get(n);
        let size = 4 * words;
        if down {
            (base.wrapping_sub(size), base.wrapping_sub(size))
        } else {
            (base, base.wrapping_add(size))
        }
    }

    pub(super) fn load_multiple<B: Bus>(
        &mut self,
        bus: &mut B,
        n: Reg,
        list: u16,
        down: bool,
        writeback: bool,
    ) -> Result<(), Trapped> {
        let (mut address, end) = self.block(n, down, list.count_ones());
        let mut values = [0; 16];
        let mut left = list;
        while left != 0 {
            let register = left.trailing_zeros() as usize;
            left &= left - 1;
            values[register] = self.read_word(bus, address)?;
            address = address.wrapping_add(4);
        }
        let mut left = list & !(1 << PC);
        while left != 0 {
            let register = left.trailing_zeros() as Reg;
            left &= left - 1;
            self.set_loaded(register, values[usize::from(register)]);
        }
        if writeback {
            self.set_loaded(n, end);
        }
        if list >> PC & 1 == 1 {
            self.write_pc(bus, values[usize::from(PC)]);
        }
        Ok(())
    }

    pub(super) fn store_multiple<B: Bus>(
        &mut self,
        bus: &mut B,
        n: Reg,
        list: u16,
        down: bool,
        writeback: bool,
    ) -> Result<(), Trapped> {
        let (mut address, end) = self.block(n, down, list.count_ones());
        let mut left = list;
        while left != 0 {
            let register = left.trailing_zeros() as Reg;
            left &= left - 1;
            self.write_word(bus, address, self.get(register))?;
            address = address.wrapping_add(4);
        }
        if writeback {
            self.set_loaded(n, end);
        }
        Ok(())
    }

    pub(super) fn load_exclusive<B: Bus>(
        &mut self,
        bus: &mut B,
        kind: Access,
        t: Reg,
        n: Reg,
        offset: u16,
    ) -> Result<(), Trapped> {
        let address = self.get(n).wrapping_add(offset.into());
        self.await_address(n);
        self.check_aligned(address, kind.width())?;
        self.spent += 1;
        let value = self.read(bus, address, kind.width())?;
        self.set_loaded(t, value);
        self.exclusive = true;
        Ok(())
    }

    pub(super) fn store_exclusive<B: Bus>(
        &mut self,
        bus: &mut B,
        kind: Access,
        d: Reg,
        t: Reg,
        n: Reg,
        offset: u16,
    ) -> Result<(), Trapped> {
        let address = self.get(n).wrapping_add(offset.into());
        self.await_address(n);
        self.check_aligned(address, kind.width())?;
        self.spent += 1;
        let granted = self.exclusive;
        if granted {
            self.write(bus, address, kind.width(), self.get(t))?;
        }
        self.exclusive = false;
        self.set(d, u32::from(!granted));
        Ok(())
    }
}
