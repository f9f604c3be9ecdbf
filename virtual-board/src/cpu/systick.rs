//! SysTick, the timer of the core.

/// A down counter. It reloads one clock after zero and sets its flag at zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SysTick {
    control: u32,
    reload: u32,
    /// Cycle of the next zero while it counts.
    zero_at: u64,
    /// Value while it is stopped.
    held: u32,
    count_flag: bool,
}

const ENABLE: u32 = 1;
const TICK_INTERRUPT: u32 = 2;
const CORE_CLOCK: u32 = 4;
const MAXIMUM: u32 = 0xFF_FFFF;

impl SysTick {
    fn cycles_per_count(&self) -> u64 {
        // The reference clock of an STM32F4 is one eighth of the core clock.
        if self.control & CORE_CLOCK != 0 { 1 } else { 8 }
    }

    fn counts(&self) -> bool {
        self.control & ENABLE != 0 && (self.reload != 0 || self.zero_at != u64::MAX)
    }

    /// Cycle of the next zero.
    pub fn next_zero(&self) -> u64 {
        if self.counts() {
            self.zero_at
        } else {
            u64::MAX
        }
    }

    /// Processes all zeros up to `cycle`. Returns true if one of them requests the exception.
    pub fn pass(&mut self, cycle: u64) -> bool {
        let mut passed = false;
        while self.next_zero() <= cycle {
            passed = true;
            self.zero_at = if self.reload == 0 {
                u64::MAX
            } else {
                self.zero_at + (u64::from(self.reload) + 1) * self.cycles_per_count()
            };
        }
        self.count_flag |= passed;
        passed && self.control & TICK_INTERRUPT != 0
    }

    fn value(&self, cycle: u64) -> u32 {
        if !self.counts() {
            return self.held;
        }
        let left = self
            .zero_at
            .saturating_sub(cycle)
            .div_ceil(self.cycles_per_count());
        // The one clock between zero and the reloaded value.
        if left == u64::from(self.reload) + 1 {
            0
        } else {
            left as u32
        }
    }

    /// Reads the register at `offset` from SYST_CSR.
    pub fn read(&mut self, offset: u32, cycle: u64) -> Option<u32> {
        Some(match offset {
            0 => {
                let flag = std::mem::take(&mut self.count_flag);
                self.control | u32::from(flag) << 16
            }
            4 => self.reload,
            8 => self.value(cycle),
            // NOREF is clear and SKEW is set: there is no exact 10 ms value.
            12 => 0x4000_0000,
            _ => return None,
        })
    }

    /// Writes the register at `offset` from SYST_CSR.
    pub fn write(&mut self, offset: u32, value: u32, cycle: u64) -> Option<()> {
        match offset {
            0 => {
                let now = self.value(cycle);
                self.control = value & (ENABLE | TICK_INTERRUPT | CORE_CLOCK);
                self.held = now;
                self.count_from(now, cycle);
            }
            4 => self.reload = value & MAXIMUM,
            8 => {
                self.held = 0;
                self.count_flag = false;
                self.count_from(0, cycle);
            }
            _ => return None,
        }
        Some(())
    }

    fn count_from(&mut self, value: u32, cycle: u64) {
        let counts = match (value, self.reload) {
            (0, 0) => {
                self.zero_at = u64::MAX;
                return;
            }
            (0, reload) => u64::from(reload) + 1,
            (value, _) => value.into(),
        };
        self.zero_at = cycle + counts * self.cycles_per_count();
    }
}
