//! The independent watchdog. Once started, only a reset stops it. It has its own oscillator, so its time is in seconds.

use super::rcc::LSI_HZ;
use super::{Answer, Lack};

const KR: u32 = 0x00;
const PR: u32 = 0x04;
const RLR: u32 = 0x08;
const SR: u32 = 0x0C;

const UNLOCK: u32 = 0x5555;
const RELOAD: u32 = 0xAAAA;
const START: u32 = 0xCCCC;

/// The watchdog. New settings act from the next reload. The short synchronisation time of the settings is not modelled in
/// SR.
#[derive(Debug, Clone)]
pub struct Iwdg {
    unlocked: bool,
    prescaler: u32,
    reload: u32,
    /// Time of the reset, s. `None` before it is started.
    expires_s: Option<f64>,
    /// Time since which a debugger halts it, s.
    held_s: Option<f64>,
}

impl Default for Iwdg {
    fn default() -> Self {
        Self {
            unlocked: false,
            prescaler: 0,
            reload: 0xFFF,
            expires_s: None,
            held_s: None,
        }
    }
}

impl Iwdg {
    /// Reads a register.
    pub fn read(&self, offset: u32) -> Answer<u32> {
        match offset {
            KR | SR => Ok(0),
            PR => Ok(self.prescaler),
            RLR => Ok(self.reload),
            _ => Err(Lack::Register),
        }
    }

    /// Writes a register at time `now_s`.
    pub fn write(&mut self, offset: u32, value: u32, now_s: f64) -> Answer {
        match (offset, value & 0xFFFF) {
            (KR, key) => {
                self.unlocked = key == UNLOCK;
                if key == START || key == RELOAD && self.expires_s.is_some() {
                    self.expires_s = Some(now_s + self.period_s());
                }
            }
            (PR, value) if self.unlocked => self.prescaler = value & 0b111,
            (RLR, value) if self.unlocked => self.reload = value & 0xFFF,
            (PR | RLR | SR, _) => {}
            _ => return Err(Lack::Register),
        }
        Ok(())
    }

    /// Time from a reload to the reset, s.
    fn period_s(&self) -> f64 {
        let divider = 4 << self.prescaler.min(6);
        f64::from((self.reload + 1) * divider) / LSI_HZ
    }

    /// Time at which it resets the chip unless it is reloaded, s.
    pub fn expires_s(&self) -> Option<f64> {
        self.expires_s.filter(|_| self.held_s.is_none())
    }

    /// A debugger halts it at time `now_s`.
    pub fn hold(&mut self, now_s: f64) {
        self.held_s = Some(now_s);
    }

    /// The halted watchdog continues at time `now_s`.
    pub fn go_on(&mut self, now_s: f64) {
        if let Some(held_s) = self.held_s.take() {
            self.expires_s = self.expires_s.map(|at_s| at_s + now_s - held_s);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_expires_unless_reloaded() {
        let mut watchdog = Iwdg::default();
        watchdog.write(RLR, 99, 0.0).unwrap();
        assert_eq!(watchdog.read(RLR).unwrap(), 0xFFF, "locked");
        watchdog.write(KR, UNLOCK, 0.0).unwrap();
        watchdog.write(PR, 1, 0.0).unwrap();
        watchdog.write(RLR, 79, 0.0).unwrap();
        watchdog.write(KR, RELOAD, 0.0).unwrap();
        assert_eq!(watchdog.expires_s(), None, "not started");
        watchdog.write(KR, START, 1.0).unwrap();
        assert_eq!(watchdog.expires_s(), Some(1.02));
        watchdog.write(KR, RELOAD, 1.01).unwrap();
        assert_eq!(watchdog.expires_s(), Some(1.03));
    }
}
