//! TIM5, a 32-bit timer in encoder mode: its counter follows two pins.

use super::{Answer, Lack, field, require};

const CR1: u32 = 0x00;
const SMCR: u32 = 0x08;
const CCMR1: u32 = 0x18;
const CCER: u32 = 0x20;
const CNT: u32 = 0x24;
const ARR: u32 = 0x2C;

const CEN: u32 = 1;
const ENCODER_MODE_3: u32 = 0b011;

/// The timer. Only encoder mode on both edges of both channels is modelled.
#[derive(Debug, Clone)]
pub struct Tim5 {
    cr1: u32,
    smcr: u32,
    ccmr1: u32,
    ccer: u32,
    cnt: u32,
    arr: u32,
}

impl Default for Tim5 {
    fn default() -> Self {
        Self {
            cr1: 0,
            smcr: 0,
            ccmr1: 0,
            ccer: 0,
            cnt: 0,
            arr: u32::MAX,
        }
    }
}

impl Tim5 {
    /// Reads a register.
    #[inline]
    pub fn read(&self, offset: u32) -> Answer<u32> {
        Ok(match offset {
            CNT => self.cnt,
            CR1 => self.cr1,
            SMCR => self.smcr,
            CCMR1 => self.ccmr1,
            CCER => self.ccer,
            ARR => self.arr,
            _ => return Err(Lack::Register),
        })
    }

    /// Writes a register.
    pub fn write(&mut self, offset: u32, value: u32) -> Answer {
        match offset {
            CR1 => {
                require(value & !CEN == 0, "a mode other than that of an encoder")?;
                require(
                    value & CEN == 0 || self.smcr == ENCODER_MODE_3,
                    "a mode other than that of an encoder",
                )?;
                self.cr1 = value;
            }
            SMCR => {
                require(
                    matches!(value, 0 | ENCODER_MODE_3),
                    "a slave mode other than encoder mode 3",
                )?;
                self.smcr = value;
            }
            CCMR1 => {
                const OWN_INPUT: u32 = 0b01;
                for channel in [field(value, 0, 8), field(value, 8, 8)] {
                    require(
                        matches!(channel & 0b1111, 0 | OWN_INPUT),
                        "channels other than undivided inputs of their own pins",
                    )?;
                }
                self.ccmr1 = value & 0xFFFF;
            }
            CCER => {
                const INVERTED: u32 = 0b1010_1010;
                require(value & INVERTED == 0, "inverted inputs")?;
                self.ccer = value & 0xBBBB;
            }
            CNT => self.cnt = value,
            ARR => {
                require(value == u32::MAX, "a count of less than 32 bits")?;
                self.arr = value;
            }
            _ => return Err(Lack::Register),
        }
        Ok(())
    }

    /// The encoder has moved by `counts` within `clocks` of the timer. Levels shorter than the input filter are not counted.
    /// The model then assumes the largest number that could pass.
    pub fn follow(&mut self, counts: i32, clocks: u64) {
        if self.cr1 & CEN == 0 {
            return;
        }
        // Each channel has an edge at every second count.
        let slowest = self.filter_clocks(0).max(self.filter_clocks(1));
        let most = i32::try_from(2 * clocks / slowest).unwrap_or(i32::MAX);
        self.cnt = self.cnt.wrapping_add_signed(counts.clamp(-most, most));
    }

    /// Timer clocks for which a level of a channel must be stable.
    fn filter_clocks(&self, channel: u32) -> u64 {
        /// Divider of the sampling clock, and number of equal samples, by ICxF.
        const FILTERS: [(u64, u64); 16] = [
            (1, 1),
            (1, 2),
            (1, 4),
            (1, 8),
            (2, 6),
            (2, 8),
            (4, 6),
            (4, 8),
            (8, 6),
            (8, 8),
            (16, 5),
            (16, 6),
            (16, 8),
            (32, 5),
            (32, 6),
            (32, 8),
        ];
        let (division, samples) = FILTERS[field(self.ccmr1, 8 * channel + 4, 4) as usize];
        division * samples
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoder() -> Tim5 {
        let mut timer = Tim5::default();
        timer.write(CCMR1, 0x8181).unwrap();
        timer.write(SMCR, ENCODER_MODE_3).unwrap();
        timer.write(CR1, CEN).unwrap();
        timer
    }

    #[test]
    fn it_counts_in_both_directions_and_wraps() {
        let mut timer = encoder();
        timer.follow(3, 4200);
        timer.follow(-5, 4200);
        assert_eq!(timer.read(CNT).unwrap(), u32::MAX - 1);
    }

    #[test]
    fn edges_shorter_than_the_filter_are_not_counted() {
        let mut timer = encoder();
        timer.follow(1000, 4200);
        assert_eq!(timer.read(CNT).unwrap(), 2 * 4200 / 48);
    }

    #[test]
    fn it_does_not_count_until_it_is_enabled() {
        let mut timer = Tim5::default();
        timer.follow(3, 4200);
        assert_eq!(timer.read(CNT).unwrap(), 0);
    }
}
