//! Power control: the settings of start-up code, and the voltage detector. Stop and standby modes are not modelled.

use super::{Answer, Lack, bit, field, require};

const CR: u32 = 0x00;
const CSR: u32 = 0x04;
const PVDE: u32 = 4;
const PLS: u32 = 0b111 << 5;
const DBP: u32 = 1 << 8;
const VOS: u32 = 1 << 14;
const PVDO: u32 = 2;
const VOSRDY: u32 = 1 << 14;

/// Nominal supply, V.
pub const NOMINAL_V: f64 = 3.3;

/// Detector threshold for a falling supply, V, by PLS (data sheet, embedded reset and power control block characteristics,
/// typical).
const FALLING_V: [f64; 8] = [2.04, 2.19, 2.35, 2.51, 2.66, 2.82, 2.93, 3.03];
/// Additional voltage for a rising supply, V.
const HYSTERESIS_V: f64 = 0.1;

/// PWR.
#[derive(Debug, Clone)]
pub struct Pwr {
    cr: u32,
    supply_v: f64,
    low: bool,
}

impl Pwr {
    /// The state after a reset at this supply.
    pub fn reset(supply_v: f64) -> Self {
        Self {
            cr: VOS,
            supply_v,
            low: false,
        }
    }

    /// Reads a register.
    pub fn read(&self, offset: u32) -> Answer<u32> {
        match offset {
            CR => Ok(self.cr),
            CSR => Ok(VOSRDY | u32::from(self.low) << PVDO),
            _ => Err(Lack::Register),
        }
    }

    /// Writes a register. Returns the new output of the detector if it changes.
    pub fn write(&mut self, offset: u32, value: u32) -> Answer<Option<bool>> {
        match offset {
            CR => {
                require(
                    value & !(VOS | DBP | PLS | 1 << PVDE) == 0,
                    "stop and standby modes",
                )?;
                self.cr = value;
                Ok(self.compare())
            }
            _ => Err(Lack::Register),
        }
    }

    /// Sets the supply to `supply_v`. Returns the new output of the detector, true for low, if it changes.
    pub fn set_supply(&mut self, supply_v: f64) -> Option<bool> {
        self.supply_v = supply_v;
        self.compare()
    }

    fn compare(&mut self) -> Option<bool> {
        let threshold_v = FALLING_V[field(self.cr, 5, 3) as usize];
        let rises_v = threshold_v + if self.low { HYSTERESIS_V } else { 0.0 };
        let low = bit(self.cr, PVDE) && self.supply_v < rises_v;
        let changed = low != self.low;
        self.low = low;
        changed.then_some(low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_enabled_detector_sees_a_voltage_dip() {
        let mut pwr = Pwr::reset(NOMINAL_V);
        assert_eq!(pwr.set_supply(2.5), None);
        pwr.set_supply(NOMINAL_V);
        pwr.write(CR, VOS | 0b110 << 5 | 1 << PVDE).unwrap();
        assert_eq!(pwr.set_supply(2.95), None);
        assert_eq!(pwr.set_supply(2.9), Some(true));
        assert_eq!(pwr.read(CSR).unwrap() >> PVDO & 1, 1);
        assert_eq!(pwr.set_supply(3.0), None, "hysteresis");
        assert_eq!(pwr.set_supply(3.1), Some(false));
    }
}
