//! External interrupts: edges at pins.

use super::{Answer, Lack, bit};

/// Number of lines that pins can feed.
pub const PIN_LINES: usize = 16;

/// EXTI.
#[derive(Debug, Clone, Default)]
pub struct Exti {
    mask: u32,
    event_mask: u32,
    rising: u32,
    falling: u32,
    pending: u32,
}

impl Exti {
    /// Reads a register.
    pub fn read(&self, offset: u32) -> Answer<u32> {
        Ok(match offset {
            0x00 => self.mask,
            0x04 => self.event_mask,
            0x08 => self.rising,
            0x0C => self.falling,
            0x10 => 0,
            0x14 => self.pending,
            _ => return Err(Lack::Register),
        })
    }

    /// Writes a register.
    pub fn write(&mut self, offset: u32, value: u32) -> Answer {
        /// Implemented lines.
        const LINES: u32 = 0x007F_FFFF;
        let value = value & LINES;
        match offset {
            0x00 => self.mask = value,
            0x04 if value == 0 => self.event_mask = 0,
            0x04 => return Err(Lack::Use("events without interrupts")),
            0x08 => self.rising = value,
            0x0C => self.falling = value,
            0x10 => self.pending |= value & self.mask,
            0x14 => self.pending &= !value,
            _ => return Err(Lack::Register),
        }
        Ok(())
    }

    /// The pin of a line has changed to `high`.
    pub fn edge(&mut self, line: usize, high: bool) {
        let chosen = if high { self.rising } else { self.falling };
        if bit(chosen, line as u32) {
            self.pending |= 1 << line;
        }
    }

    /// Lines with at least one enabled edge.
    pub fn watched(&self) -> u32 {
        self.rising | self.falling
    }

    /// Returns true if any of these lines requests an interrupt.
    pub fn requests(&self, lines: std::ops::RangeInclusive<u32>) -> bool {
        let asked = self.pending & self.mask;
        lines.into_iter().any(|line| bit(asked, line))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_falling_edge_stays_pending_until_a_one_is_written() {
        let mut exti = Exti::default();
        exti.write(0x00, 1 << 15).unwrap();
        exti.write(0x0C, 1 << 15).unwrap();
        exti.edge(15, true);
        assert!(!exti.requests(10..=15));
        exti.edge(15, false);
        assert!(exti.requests(10..=15));
        exti.write(0x14, 0).unwrap();
        assert!(exti.requests(10..=15));
        exti.write(0x14, 1 << 15).unwrap();
        assert!(!exti.requests(10..=15));
    }
}
