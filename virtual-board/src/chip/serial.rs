//! The serial port of the console: its pins, and the DMA transfer of its bytes.

use super::Chip;
use super::pins::{AF_USART2, USART2_RX, USART2_TX};
use crate::cpu::{Memories, Signals, Width};
use crate::peripherals::usart::{self, Line};

/// Address of its data register.
const DATA: u32 = 0x4000_4400 + usart::DR;
/// DMA1 streams and channels that can serve the receiver and the transmitter (RM0090, table 42).
const RECEIVER: [(usize, u32); 1] = [(5, 4)];
const TRANSMITTER: [(usize, u32); 1] = [(6, 4)];

impl Chip {
    /// Core cycles per bit of the console's port.
    pub fn usart2_bit_cycles(&self) -> u64 {
        self.usart2.bit_cycles(self.clocks.apb1_divider)
    }

    /// Returns true if the input of USART2 floats when nothing is connected to it.
    pub fn receiver_floats(&self) -> bool {
        self.settled(USART2_RX).is_none()
    }

    /// Takes the byte that USART2 has just sent. `None` if its pin is not assigned to USART2.
    pub fn take_sent(&mut self, signals: &mut Signals) -> Option<u8> {
        let at = self.usart2.next_sent();
        let byte = self.usart2.sent(self.clocks.apb1_divider);
        self.carry_serial(at, signals);
        byte.filter(|_| self.mode(USART2_TX) == AF_USART2)
    }

    /// A byte arrives at the input pin of USART2.
    pub fn receive(&mut self, byte: u8, line: Line, signals: &mut Signals) {
        if self.mode(USART2_RX) == AF_USART2 {
            self.usart2.receive(byte, line);
            self.carry_serial(signals.cycle(), signals);
        }
    }

    /// Transfers received bytes and bytes to send by DMA, at cycle `now`.
    pub(super) fn carry_serial(&mut self, now: u64, signals: &mut Signals) {
        if self.usart2.wants_to_be_read()
            && let Some(stream) = self.dma1.serving(DATA, &RECEIVER)
            && let Some(to) = self.dma1.carry(stream)
        {
            let byte = self.usart2.fetched();
            let in_sram = to.address >> 24 == Memories::SRAM >> 24;
            let written = in_sram
                .then(|| self.memories.write(to.address, to.width, byte.into()))
                .flatten();
            if written.is_none() || to.width != Width::Byte {
                self.trouble = Some(format!(
                    "a received byte that DMA1 carries to {:#010x}",
                    to.address
                ));
            }
        }
        while self.usart2.wants_to_be_written()
            && let Some(stream) = self.dma1.serving(DATA, &TRANSMITTER)
            && let Some(from) = self.dma1.carry(stream)
        {
            let word = self.memories.read(from.address, from.width);
            let sent = word.map(|word| {
                self.usart2
                    .write(usart::DR, word, now, self.clocks.apb1_divider)
            });
            if from.width != Width::Byte || !matches!(sent, Some(Ok(()))) {
                self.trouble = Some(format!(
                    "a byte to be sent that DMA1 fetches from {:#010x}",
                    from.address
                ));
                break;
            }
        }
        self.show_usart2(signals);
        self.show_dma1(signals);
    }
}
