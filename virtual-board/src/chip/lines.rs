//! Interrupt lines and the peripherals that raise them.

use super::Chip;
use crate::cpu::Signals;

/// Lines of the external interrupts, with the EXTI lines that share each.
const EXTI: [(usize, std::ops::RangeInclusive<u32>); 8] = [
    (1, 16..=16),
    (6, 0..=0),
    (7, 1..=1),
    (8, 2..=2),
    (9, 3..=3),
    (10, 4..=4),
    (23, 5..=9),
    (40, 10..=15),
];
/// EXTI line of the programmable voltage detector.
pub(super) const PVD_LINE: usize = 16;
const USART2: usize = 38;
pub const TIM8_UP_TIM13: usize = 44;
/// Lines of DMA1 streams 0 to 7.
const DMA1: [usize; 8] = [11, 12, 13, 14, 15, 16, 17, 47];
/// Lines of DMA2 streams 0 to 7.
const DMA2: [usize; 8] = [56, 57, 58, 59, 60, 68, 69, 70];

impl Chip {
    pub(super) fn show_lines(&mut self, signals: &mut Signals) {
        signals.set_line(TIM8_UP_TIM13, self.tim8.requests_update_interrupt());
        self.show_usart2(signals);
        self.show_exti(signals);
        self.show_dma1(signals);
        self.show_dma2(signals);
    }

    pub(super) fn show_usart2(&self, signals: &mut Signals) {
        signals.set_line(USART2, self.usart2.requests_interrupt());
    }

    pub(super) fn show_exti(&self, signals: &mut Signals) {
        for (line, pins) in EXTI {
            signals.set_line(line, self.exti.requests(pins));
        }
    }

    pub(super) fn show_dma1(&self, signals: &mut Signals) {
        for (stream, line) in DMA1.into_iter().enumerate() {
            signals.set_line(line, self.dma1.requests_interrupt(stream));
        }
    }

    pub(super) fn show_dma2(&self, signals: &mut Signals) {
        for (stream, line) in DMA2.into_iter().enumerate() {
            signals.set_line(line, self.dma2.requests_interrupt(stream));
        }
    }
}
