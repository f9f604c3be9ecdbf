//! Debug support: selects the peripherals that stop while a debugger halts the core.

use super::{Answer, Lack, bit};

/// Device and revision identifier of an STM32F407 of revision Z.
const IDCODE: u32 = 0x1001_6413;

/// Peripherals that can stop with the core (RM0090, section 38.16).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names of the reference manual")]
pub enum Held {
    Tim2,
    Tim3,
    Tim8,
    Iwdg,
}

/// Implemented bits of its registers.
const FIELDS: [u32; 3] = [0x001F_00E7, 0x06E0_19FF, 0x0007_0003];

/// DBGMCU.
#[derive(Debug, Clone, Default)]
pub struct Dbgmcu {
    /// The registers CR, APB1_FZ and APB2_FZ.
    settings: [u32; 3],
}

impl Dbgmcu {
    /// Returns true if the clock of this timer or watchdog stops with the core.
    pub fn stops(&self, held: Held) -> bool {
        match held {
            Held::Tim2 => bit(self.settings[1], 0),
            Held::Tim3 => bit(self.settings[1], 1),
            Held::Iwdg => bit(self.settings[1], 12),
            Held::Tim8 => bit(self.settings[2], 1),
        }
    }

    /// Reads a register.
    pub fn read(&self, offset: u32) -> Answer<u32> {
        match offset {
            0x00 => Ok(IDCODE),
            0x04 | 0x08 | 0x0C => Ok(self.settings[offset as usize / 4 - 1]),
            _ => Err(Lack::Register),
        }
    }

    /// Writes a register.
    pub fn write(&mut self, offset: u32, value: u32) -> Answer {
        match offset {
            0x04 | 0x08 | 0x0C => {
                let index = offset as usize / 4 - 1;
                self.settings[index] = value & FIELDS[index];
            }
            _ => return Err(Lack::Register),
        }
        Ok(())
    }
}
