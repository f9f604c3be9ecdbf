//! Loads, stores and fetches. Memories are accessed directly, all else by address.

use super::fault::Fault;
use super::{Bus, Cpu, Memories, Refusal, Stop, Trapped, Unmodelled, Width};

/// First address of the peripherals. Addresses below are memory, which allows unaligned accesses.
const PERIPHERALS: u32 = 0x4000_0000;

/// The vendor's debug support on the private peripheral bus.
const DEBUG_SUPPORT: u32 = 0xE004_2000;

/// What an address outside the memories belongs to.
enum Place {
    Private,
    /// A bit-band alias: the address of the word, and the number of the bit.
    Bit(u32, u32),
    Board,
}

impl Place {
    fn of(address: u32) -> Self {
        let bit = |base: u32| Self::Bit(base | address >> 5 & 0xF_FFFC, address >> 2 & 31);
        match address >> 20 {
            0xE00 if address & !0x3FF != DEBUG_SUPPORT => Self::Private,
            0x220..=0x23F => bit(0x2000_0000),
            0x420..=0x43F => bit(PERIPHERALS),
            _ => Self::Board,
        }
    }
}

impl Cpu {
    /// Loads a zero-extended value.
    #[inline(always)]
    pub(super) fn read<B: Bus>(
        &mut self,
        bus: &mut B,
        address: u32,
        width: Width,
    ) -> Result<u32, Trapped> {
        if address & (width.bytes() - 1) != 0 {
            self.check_unaligned(address)?;
        }
        if let Some(value) = bus.memories().read(address, width) {
            if address < Memories::CCM {
                self.wait_for_flash_data(address);
            }
            return Ok(value);
        }
        self.read_elsewhere(bus, address, width)
    }

    /// Stores the lowest bits of a value.
    #[inline(always)]
    pub(super) fn write<B: Bus>(
        &mut self,
        bus: &mut B,
        address: u32,
        width: Width,
        value: u32,
    ) -> Result<(), Trapped> {
        if address & (width.bytes() - 1) != 0 {
            self.check_unaligned(address)?;
        }
        if bus.memories().write(address, width, value).is_some() {
            return Ok(());
        }
        self.write_elsewhere(bus, address, width, value)
    }

    /// Loads a word for LDM, LDRD and exclusive loads. The address must be aligned.
    #[inline]
    pub(super) fn read_word<B: Bus>(&mut self, bus: &mut B, address: u32) -> Result<u32, Trapped> {
        self.check_aligned(address, Width::Word)?;
        self.read(bus, address, Width::Word)
    }

    /// Stores a word for STM, STRD and exclusive stores. The address must be aligned.
    #[inline]
    pub(super) fn write_word<B: Bus>(
        &mut self,
        bus: &mut B,
        address: u32,
        value: u32,
    ) -> Result<(), Trapped> {
        self.check_aligned(address, Width::Word)?;
        self.write(bus, address, Width::Word, value)
    }

    #[inline]
    pub(super) fn check_aligned(&mut self, address: u32, width: Width) -> Result<(), Trapped> {
        if address & (width.bytes() - 1) != 0 {
            return Err(self.fault(Fault::Unaligned));
        }
        Ok(())
    }

    #[cold]
    fn check_unaligned(&mut self, address: u32) -> Result<(), Trapped> {
        if self.system.traps_unaligned() || address >= PERIPHERALS {
            return Err(self.fault(Fault::Unaligned));
        }
        Ok(())
    }

    #[inline]
    fn wait_for_flash_data(&mut self, address: u32) {
        let line = address >> 4;
        if line != self.data_line {
            self.data_line = line;
            let timing = self.signals.flash_timing;
            self.spent += self.accelerator.read(line, self.signals.cycle, timing);
        }
    }

    #[cold]
    fn read_elsewhere<B: Bus>(
        &mut self,
        bus: &mut B,
        address: u32,
        width: Width,
    ) -> Result<u32, Trapped> {
        match Place::of(address) {
            Place::Private => self.read_private(address, width),
            Place::Bit(word, bit) => {
                Ok(self.read_word_of_bit(bus, word, address, width)? >> bit & 1)
            }
            Place::Board => {
                let answer = bus.read(address, width, &mut self.signals);
                self.after_board();
                answer.map_err(|refusal| self.refused(refusal, address, width, None))
            }
        }
    }

    #[cold]
    fn write_elsewhere<B: Bus>(
        &mut self,
        bus: &mut B,
        address: u32,
        width: Width,
        value: u32,
    ) -> Result<(), Trapped> {
        let value = match width {
            Width::Byte => value & 0xFF,
            Width::Half => value & 0xFFFF,
            Width::Word => value,
        };
        match Place::of(address) {
            Place::Private => self.write_private(address, width, value),
            Place::Bit(word, bit) => {
                let old = self.read_word_of_bit(bus, word, address, width)?;
                let new = old & !(1 << bit) | (value & 1) << bit;
                self.write(bus, word, Width::Word, new)
            }
            Place::Board => {
                let answer = bus.write(address, width, value, &mut self.signals);
                self.after_board();
                if bus.memories().flash_edition() != self.decoded_edition {
                    self.attend_soon();
                }
                match answer {
                    Err(Refusal::BusFault) if self.system.buffers_writes() => {
                        self.pend_imprecise_bus_fault();
                        Ok(())
                    }
                    answer => {
                        answer.map_err(|refusal| self.refused(refusal, address, width, Some(value)))
                    }
                }
            }
        }
    }

    /// Reads the word that contains the bit of a bit-band alias. The alias region is accessed like a device.
    fn read_word_of_bit<B: Bus>(
        &mut self,
        bus: &mut B,
        word: u32,
        address: u32,
        width: Width,
    ) -> Result<u32, Trapped> {
        self.check_aligned(address, width)?;
        self.read(bus, word, Width::Word)
    }

    /// Applies the signals that the board set during an access.
    fn after_board(&mut self) {
        self.spent += std::mem::take(&mut self.signals.wait_cycles);
        if self.signals.risen || self.signals.board_called {
            self.attend_soon();
        }
    }

    fn refused(
        &mut self,
        refusal: Refusal,
        address: u32,
        width: Width,
        written: Option<u32>,
    ) -> Trapped {
        match refusal {
            Refusal::BusFault => self.fault(Fault::PreciseBus(address)),
            Refusal::Unmodelled(register) => self.unmodelled(register, address, width, written),
        }
    }

    /// Ends the run because of an unmodelled access.
    pub(super) fn unmodelled(
        &mut self,
        register: String,
        address: u32,
        width: Width,
        written: Option<u32>,
    ) -> Trapped {
        self.stop(Stop::Unmodelled(Unmodelled::Access {
            register,
            address,
            width,
            written,
            pc: self.instruction_address,
        }))
    }

    /// Fetches one halfword of code.
    pub(super) fn fetch<B: Bus>(&self, bus: &mut B, address: u32) -> Result<u16, Fault> {
        let executable = match address >> 29 {
            0 | 1 | 3 | 4 => !(Memories::CCM..Memories::SRAM).contains(&address),
            _ => return Err(Fault::InstructionAccess),
        };
        let half = bus.memories().read(address, Width::Half);
        match half.filter(|_| executable) {
            Some(half) => Ok(half as u16),
            None => Err(Fault::InstructionBus),
        }
    }
}
