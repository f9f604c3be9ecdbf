//! A serial port: one byte in the shift register and one in the buffer, in each direction, at its baud rate.

use super::{Answer, Lack, NEVER, bit, require};

const SR: u32 = 0x00;
/// Offset of the data register.
pub const DR: u32 = 0x04;
const BRR: u32 = 0x08;
const CR1: u32 = 0x0C;
const CR2: u32 = 0x10;
const CR3: u32 = 0x14;

const FE: u32 = 1 << 1;
const NF: u32 = 1 << 2;
const ORE: u32 = 1 << 3;
const RXNE: u32 = 1 << 5;
const TC: u32 = 1 << 6;
const TXE: u32 = 1 << 7;

const RE: u32 = 2;
const TE: u32 = 3;
const RXNEIE: u32 = 5;
const TCIE: u32 = 6;
const TXEIE: u32 = 7;
const UE: u32 = 13;
const OVER8: u32 = 15;

const DMAR: u32 = 6;
const DMAT: u32 = 7;

/// Start bit, eight data bits, stop bit.
pub const FRAME_BITS: u64 = 10;

/// Disturbance of a byte on the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Line {
    /// No disturbance.
    #[default]
    Quiet,
    /// One of the three samples in the middle of a bit differed.
    Noisy,
    /// The stop bit was low.
    Broken,
}

/// A USART without modem lines and parity.
#[derive(Debug, Clone)]
pub struct Usart {
    sr: u32,
    brr: u32,
    cr1: u32,
    cr3: u32,
    received: u8,
    /// The byte that waits for the shift register.
    behind: Option<u8>,
    /// The byte in the shift register, and the cycle at which its stop bit ends.
    shifting: Option<(u8, u64)>,
    /// Error flags that the program has read from the status register. A read of the data register then clears them.
    errors_seen: u32,
}

impl Default for Usart {
    fn default() -> Self {
        Self {
            sr: TXE | TC,
            brr: 0,
            cr1: 0,
            cr3: 0,
            received: 0,
            behind: None,
            shifting: None,
            errors_seen: 0,
        }
    }
}

impl Usart {
    /// Reads a register.
    pub fn read(&mut self, offset: u32) -> Answer<u32> {
        Ok(match offset {
            SR => {
                self.errors_seen = self.sr & (FE | NF | ORE);
                self.sr
            }
            DR => u32::from(self.fetched()),
            BRR => self.brr,
            CR1 => self.cr1,
            CR2 => 0,
            CR3 => self.cr3,
            _ => return Err(Lack::Register),
        })
    }

    /// Writes a register at cycle `now`. `divider` is the number of core cycles per clock of the port's bus.
    pub fn write(&mut self, offset: u32, value: u32, now: u64, divider: u32) -> Answer {
        match offset {
            SR => {
                const CLEARED_BY_ZERO: u32 = TC | RXNE;
                self.sr &= value | !CLEARED_BY_ZERO;
            }
            DR => {
                require(
                    bit(self.cr1, UE) && bit(self.cr1, TE),
                    "sending while it is off",
                )?;
                require(self.behind.is_none(), "overwriting a byte that waits")?;
                self.behind = Some(value as u8);
                self.sr &= !(TXE | TC);
                self.feed_shifter(now, divider);
            }
            BRR => self.brr = value & 0xFFFF,
            CR1 => {
                const KNOWN: u32 =
                    1 << RE | 1 << TE | 1 << RXNEIE | 1 << TCIE | 1 << TXEIE | 1 << UE | 1 << OVER8;
                require(
                    value & !KNOWN == 0,
                    "parity, 9 bits, breaks, wake-up and the idle interrupt",
                )?;
                self.cr1 = value;
            }
            CR2 => require(value == 0, "stop bits other than one, clocks and LIN")?,
            CR3 => {
                const KNOWN: u32 = 1 << DMAR | 1 << DMAT;
                require(
                    value & !KNOWN == 0,
                    "flow control, half duplex, smart cards, infrared and error interrupts",
                )?;
                self.cr3 = value;
            }
            _ => return Err(Lack::Register),
        }
        Ok(())
    }

    fn feed_shifter(&mut self, now: u64, divider: u32) {
        if self.shifting.is_none()
            && let Some(byte) = self.behind.take()
        {
            self.shifting = Some((byte, now + FRAME_BITS * self.bit_cycles(divider)));
            self.sr |= TXE;
        }
    }

    /// Core cycles per bit.
    pub fn bit_cycles(&self, divider: u32) -> u64 {
        let clocks = if bit(self.cr1, OVER8) {
            // With oversampling by 8, the fraction has three bits.
            (self.brr >> 4) * 8 + (self.brr & 0b111)
        } else {
            self.brr
        };
        u64::from(clocks.max(1) * divider)
    }

    /// Returns true if the receiver is on.
    pub fn receives(&self) -> bool {
        bit(self.cr1, UE) && bit(self.cr1, RE)
    }

    /// Cycle at which the byte in the shift register is sent.
    pub fn next_sent(&self) -> u64 {
        self.shifting.map_or(NEVER, |(_, end)| end)
    }

    /// Ends the byte in the shift register and starts the next. Returns the sent byte.
    pub fn sent(&mut self, divider: u32) -> Option<u8> {
        let (byte, end) = self.shifting.take()?;
        self.feed_shifter(end, divider);
        if self.shifting.is_none() {
            self.sr |= TC;
        }
        Some(byte)
    }

    /// A byte has arrived. If the previous byte has not been read, the new byte is lost and the overrun flag is set. Noise
    /// and a missing stop bit set their flags.
    pub fn receive(&mut self, byte: u8, line: Line) {
        if !self.receives() {
            return;
        }
        if self.sr & RXNE != 0 {
            self.sr |= ORE;
        } else {
            self.received = byte;
            self.sr |= RXNE
                | match line {
                    Line::Quiet => 0,
                    Line::Noisy => NF,
                    Line::Broken => FE,
                };
        }
    }

    /// Returns true if it requests DMA to read the received byte.
    pub fn wants_to_be_read(&self) -> bool {
        bit(self.cr3, DMAR) && self.sr & RXNE != 0
    }

    /// The received byte, as read by DMA.
    pub fn fetched(&mut self) -> u8 {
        self.sr &= !RXNE;
        self.sr &= !std::mem::take(&mut self.errors_seen);
        self.received
    }

    /// Returns true if it requests the next byte to send from DMA.
    pub fn wants_to_be_written(&self) -> bool {
        let on = bit(self.cr1, UE) && bit(self.cr1, TE);
        on && bit(self.cr3, DMAT) && self.sr & TXE != 0
    }

    /// Returns true if it requests an interrupt.
    pub fn requests_interrupt(&self) -> bool {
        let asks = |flags: u32, enable: u32| self.sr & flags != 0 && bit(self.cr1, enable);
        asks(RXNE | ORE, RXNEIE) || asks(TXE, TXEIE) || asks(TC, TCIE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIVIDER: u32 = 4;

    #[test]
    fn it_requests_dma_for_sending_and_receiving() {
        let mut port = port();
        assert!(!port.wants_to_be_written());
        port.write(CR3, 1 << DMAT | 1 << DMAR, 0, DIVIDER).unwrap();
        assert!(port.wants_to_be_written() && !port.wants_to_be_read());
        port.write(DR, 1, 0, DIVIDER).unwrap();
        port.write(DR, 2, 0, DIVIDER).unwrap();
        assert!(!port.wants_to_be_written());
        port.receive(b'a', Line::Quiet);
        assert!(port.wants_to_be_read());
        assert_eq!(port.fetched(), b'a');
        assert!(!port.wants_to_be_read());
    }

    fn port() -> Usart {
        let mut port = Usart::default();
        port.write(BRR, 91, 0, DIVIDER).unwrap();
        let on = 1 << UE | 1 << TE | 1 << RE | 1 << RXNEIE;
        port.write(CR1, on, 0, DIVIDER).unwrap();
        port
    }

    #[test]
    fn bytes_are_sent_one_after_the_other() {
        let mut port = port();
        port.write(DR, 1, 1000, DIVIDER).unwrap();
        assert!(port.sr & TXE != 0, "the shifter took it");
        port.write(DR, 2, 1001, DIVIDER).unwrap();
        assert!(port.sr & TXE == 0);
        let frame = 10 * 91 * 4;
        assert_eq!(port.next_sent(), 1000 + frame);
        assert_eq!(port.sent(DIVIDER), Some(1));
        assert_eq!(port.next_sent(), 1000 + 2 * frame);
        assert_eq!(port.sr & TC, 0);
        assert_eq!(port.sent(DIVIDER), Some(2));
        assert_eq!(port.sr & TC, TC);
        assert_eq!(port.next_sent(), NEVER);
    }

    #[test]
    fn a_byte_that_is_not_read_causes_an_overrun() {
        let mut port = port();
        port.receive(b'a', Line::Quiet);
        assert!(port.requests_interrupt());
        port.receive(b'b', Line::Quiet);
        assert_eq!(port.read(SR).unwrap() & ORE, ORE);
        assert_eq!(port.read(DR).unwrap(), u32::from(b'a'));
        assert_eq!(port.read(SR).unwrap() & (ORE | RXNE), 0);
    }

    #[test]
    fn a_noisy_byte_is_received_and_flagged() {
        let mut port = port();
        port.receive(b'a', Line::Noisy);
        assert_eq!(port.read(SR).unwrap() & (RXNE | NF), RXNE | NF);
        assert_eq!(port.read(DR).unwrap(), u32::from(b'a'));
        assert_eq!(port.read(SR).unwrap() & (RXNE | NF), 0);
    }

    #[test]
    fn oversampling_by_eight_uses_three_fraction_bits() {
        let mut port = Usart::default();
        port.write(CR1, 1 << OVER8, 0, 1).unwrap();
        port.write(BRR, 0x53, 0, 1).unwrap();
        assert_eq!(port.bit_cycles(1), 5 * 8 + 3);
    }
}
