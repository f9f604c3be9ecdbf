//! System configuration: selects the port that feeds each external interrupt line.

use super::{Answer, Lack, field};

const EXTICR1: u32 = 0x08;
const EXTICR4: u32 = 0x14;

/// SYSCFG.
#[derive(Debug, Clone, Default)]
pub struct Syscfg {
    exticr: [u32; 4],
}

impl Syscfg {
    /// Reads a register.
    pub fn read(&self, offset: u32) -> Answer<u32> {
        match offset {
            EXTICR1..=EXTICR4 => Ok(self.exticr[(offset - EXTICR1) as usize / 4]),
            _ => Err(Lack::Register),
        }
    }

    /// Writes a register.
    pub fn write(&mut self, offset: u32, value: u32) -> Answer {
        match offset {
            EXTICR1..=EXTICR4 => self.exticr[(offset - EXTICR1) as usize / 4] = value & 0xFFFF,
            _ => return Err(Lack::Register),
        }
        Ok(())
    }

    /// Port, counted from A, that feeds interrupt line `line`.
    pub fn port_of_line(&self, line: usize) -> usize {
        field(self.exticr[line / 4], 4 * (line as u32 % 4), 4) as usize
    }
}
