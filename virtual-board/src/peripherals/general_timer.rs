//! TIM2 and TIM3 as periodic up-counters. They provide a time base and a trigger at each update.

use super::{Answer, Lack, bit, field, require};

const CR1: u32 = 0x00;
const CR2: u32 = 0x04;
const SMCR: u32 = 0x08;
const DIER: u32 = 0x0C;
const SR: u32 = 0x10;
const EGR: u32 = 0x14;
const CNT: u32 = 0x24;
const PSC: u32 = 0x28;
const ARR: u32 = 0x2C;

const CEN: u32 = 0;
const URS: u32 = 2;
const ARPE: u32 = 7;
const UIF: u32 = 1;
const MMS_UPDATE: u32 = 0b010;

/// A general-purpose timer without its channels (RM0090, section 18).
#[derive(Debug, Clone)]
pub struct GeneralTimer {
    /// Mask of the counter's width.
    mask: u32,
    cr1: u32,
    cr2: u32,
    psc: u32,
    arr: u32,
    /// The active prescaler, loaded at the last update.
    active_psc: u32,
    /// Core cycles in one clock of the timer.
    divider: u32,
    /// Cycle at which the count was 0, while it runs.
    zero_at: u64,
    /// Count while it is stopped.
    stopped_at: u32,
    /// Cycle up to which the program has cleared the update flag.
    cleared_at: u64,
    /// True if software set the update flag.
    forced: bool,
    /// Cycle since which a debugger halts the timer.
    held_at: Option<u64>,
}

impl GeneralTimer {
    /// TIM2, with 32 bits.
    pub fn wide() -> Self {
        Self::of(u32::MAX)
    }

    /// TIM3, with 16 bits.
    pub fn narrow() -> Self {
        Self::of(0xFFFF)
    }

    fn of(mask: u32) -> Self {
        Self {
            mask,
            cr1: 0,
            cr2: 0,
            psc: 0,
            arr: mask,
            active_psc: 0,
            divider: 1,
            zero_at: 0,
            stopped_at: 0,
            cleared_at: 0,
            forced: false,
            held_at: None,
        }
    }

    /// Reads a register at cycle `now`.
    #[inline]
    pub fn read(&self, offset: u32, now: u64) -> Answer<u32> {
        Ok(match offset {
            CNT => self.count(now),
            CR1 => self.cr1,
            CR2 => self.cr2,
            SMCR | DIER | EGR => 0,
            SR => u32::from(self.forced || self.updates(self.cleared_at, now) > 0),
            PSC => self.psc,
            ARR => self.arr,
            _ => return Err(Lack::Register),
        })
    }

    /// Writes a register at cycle `now`. `divider` is the number of core cycles per timer clock.
    pub fn write(&mut self, offset: u32, value: u32, now: u64, divider: u32) -> Answer {
        match offset {
            CR1 => {
                const KNOWN: u32 = 1 << CEN | 1 << URS | 1 << ARPE;
                require(value & !KNOWN == 0, "modes other than counting up")?;
                let (runs, ran) = (bit(value, CEN), self.runs());
                if ran && !runs {
                    self.stopped_at = self.count(now);
                }
                self.cr1 = value;
                if runs && !ran {
                    self.divider = divider;
                    self.start_from(self.stopped_at, now);
                }
            }
            CR2 => {
                require(value & !(0b111 << 4) == 0, "DMA and the exclusive-or input")?;
                require(
                    matches!(field(value, 4, 3), 0 | MMS_UPDATE),
                    "a trigger output other than reset and update",
                )?;
                self.cr2 = value;
            }
            SMCR => require(value == 0, "slave modes")?,
            DIER => require(value == 0, "interrupts and DMA")?,
            SR => {
                if value & UIF == 0 {
                    self.cleared_at = now;
                    self.forced = false;
                }
            }
            EGR => {
                require(value & !1 == 0, "events other than the update")?;
                if bit(value, 0) {
                    self.active_psc = self.psc;
                    self.stopped_at = 0;
                    self.start_from(0, now);
                    self.cleared_at = self.cleared_at.max(now);
                    self.forced |= !bit(self.cr1, URS);
                }
            }
            CNT => {
                self.stopped_at = value & self.mask;
                self.start_from(self.stopped_at, now);
            }
            PSC => self.psc = value & 0xFFFF,
            ARR => {
                require(!self.runs(), "a new top while it runs")?;
                self.arr = value & self.mask;
            }
            _ => return Err(Lack::Register),
        }
        Ok(())
    }

    fn start_from(&mut self, count: u32, now: u64) {
        // The cycle of the last zero may lie before power-on, hence the wrapping subtraction.
        self.zero_at = now.wrapping_sub(u64::from(count) * self.clock_cycles());
    }

    fn runs(&self) -> bool {
        bit(self.cr1, CEN)
    }

    fn clock_cycles(&self) -> u64 {
        u64::from(self.active_psc + 1) * u64::from(self.divider)
    }

    /// Core cycles between two updates.
    pub fn update_cycles(&self) -> u64 {
        (u64::from(self.arr) + 1) * self.clock_cycles()
    }

    fn count(&self, now: u64) -> u32 {
        if !self.runs() {
            return self.stopped_at;
        }
        let since = self.held_at.unwrap_or(now).wrapping_sub(self.zero_at);
        (since % self.update_cycles() / self.clock_cycles()) as u32
    }

    /// Number of updates after cycle `from` and up to cycle `to`.
    pub fn updates(&self, from: u64, to: u64) -> u64 {
        if !self.runs() {
            return 0;
        }
        let by = |cycle: u64| {
            let cycle = self.held_at.map_or(cycle, |held| held.min(cycle));
            // Signed, because the counter may have started within its first period.
            (cycle.wrapping_sub(self.zero_at) as i64).div_euclid(self.update_cycles() as i64)
        };
        u64::try_from(by(to) - by(from)).unwrap_or(0)
    }

    /// Returns true if updates are output as trigger.
    pub fn triggers_by_update(&self) -> bool {
        field(self.cr2, 4, 3) == MMS_UPDATE
    }

    /// A debugger halts the timer at cycle `now`.
    pub fn hold(&mut self, now: u64) {
        self.held_at = Some(now);
    }

    /// The halted timer continues at cycle `now`.
    pub fn go_on(&mut self, now: u64) {
        if let Some(held_at) = self.held_at.take() {
            self.zero_at = self.zero_at.wrapping_add(now - held_at);
            self.cleared_at += now - held_at;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn running(from: u32) -> GeneralTimer {
        let mut timer = GeneralTimer::narrow();
        for (offset, value) in [(ARR, 167), (CNT, from), (CR2, 0x20), (CR1, 1)] {
            timer.write(offset, value, 1000, 2).unwrap();
        }
        timer
    }

    #[test]
    fn it_updates_at_the_end_of_each_period() {
        let timer = running(0);
        assert_eq!(timer.read(CNT, 1000 + 20).unwrap(), 10);
        assert_eq!(timer.read(CNT, 1000 + 336 + 20).unwrap(), 10);
        assert_eq!(timer.updates(1000, 1000 + 8400), 25);
        assert_eq!(timer.updates(1000, 1000 + 335), 0);
    }

    #[test]
    fn a_start_within_the_period_makes_the_first_update_earlier() {
        let timer = running(24);
        assert_eq!(timer.updates(1000, 1000 + 336 - 48 - 1), 0);
        assert_eq!(timer.updates(1000, 1000 + 336 - 48), 1);
        assert_eq!(timer.updates(1000, 1000 + 8400 - 48), 25);
    }

    #[test]
    fn a_debugger_halt_loses_no_count() {
        let mut timer = running(0);
        timer.hold(1000 + 100);
        assert_eq!(timer.read(CNT, 1_000_000).unwrap(), 50);
        timer.go_on(1_000_000);
        assert_eq!(timer.read(CNT, 1_000_000 + 2).unwrap(), 51);
    }
}
