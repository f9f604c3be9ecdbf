//! Power control: what start-up code sets. The core is never put into stop or standby mode.

use super::{Answer, Lack, require};

const CR: u32 = 0x00;
const CSR: u32 = 0x04;
const VOS: u32 = 1 << 14;
const DBP: u32 = 1 << 8;
const VOSRDY: u32 = 1 << 14;

/// PWR.
#[derive(Debug, Clone)]
pub struct Pwr {
    cr: u32,
}

impl Default for Pwr {
    fn default() -> Self {
        Self { cr: VOS }
    }
}

impl Pwr {
    /// Reads a register.
    pub fn read(&self, offset: u32) -> Answer<u32> {
        match offset {
            CR => Ok(self.cr),
            CSR => Ok(VOSRDY),
            _ => Err(Lack::Register),
        }
    }

    /// Writes a register.
    pub fn write(&mut self, offset: u32, value: u32) -> Answer {
        match offset {
            CR => {
                require(
                    value & !(VOS | DBP) == 0,
                    "stop and standby modes and the voltage detector",
                )?;
                self.cr = value;
                Ok(())
            }
            _ => Err(Lack::Register),
        }
    }
}
