//! Debug support. No debugger halts this core, so that its settings are kept and change nothing.

use super::{Answer, Lack};

/// Device and revision of an STM32F407 of revision Z.
const IDCODE: u32 = 0x1001_6413;

/// DBGMCU.
#[derive(Debug, Clone, Default)]
pub struct Dbgmcu {
    /// CR, APB1_FZ, APB2_FZ.
    settings: [u32; 3],
}

impl Dbgmcu {
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
            0x04 | 0x08 | 0x0C => self.settings[offset as usize / 4 - 1] = value,
            _ => return Err(Lack::Register),
        }
        Ok(())
    }
}
