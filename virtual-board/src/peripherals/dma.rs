//! A DMA controller: transfers between a peripheral register and memory, one item per request.

use super::{Answer, Lack, bit, field, require};
use crate::cpu::Width;

const STREAMS: usize = 8;
const HIFCR: u32 = 0x0C;
const LIFCR: u32 = 0x08;
const FIRST_STREAM: u32 = 0x10;
const STREAM_BYTES: u32 = 0x18;

const EN: u32 = 0;
const TEIE: u32 = 2;
const HTIE: u32 = 3;
const TCIE: u32 = 4;
const CIRC: u32 = 8;
const MINC: u32 = 10;

/// Implemented bits of a stream's control register and of its FIFO control register. The FIFO is always empty.
const CONTROL_FIELDS: u32 = 0x0FEF_FFFF;
const FIFO_FIELDS: u32 = 0b1000_0111;
const EMPTY: u32 = 0b100 << 3;

/// Flags of a stream, by their position in its six bits.
const HALF: u32 = 1 << 4;
const COMPLETE: u32 = 1 << 5;

/// One DMA stream.
#[derive(Debug, Clone, Copy)]
struct Stream {
    cr: u32,
    ndtr: u32,
    par: u32,
    m0ar: u32,
    m1ar: u32,
    /// FIFO control register without the fill level, which is always empty.
    fcr: u32,
    flags: u32,
    /// Number of items at the start.
    items: u32,
    left: u32,
}

impl Default for Stream {
    fn default() -> Self {
        /// FIFO threshold of half.
        const HALF_FULL: u32 = 0b01;
        Self {
            cr: 0,
            ndtr: 0,
            par: 0,
            m0ar: 0,
            m1ar: 0,
            fcr: HALF_FULL,
            flags: 0,
            items: 0,
            left: 0,
        }
    }
}

/// DMA1 or DMA2.
#[derive(Debug, Clone, Default)]
pub struct Dma {
    streams: [Stream; STREAMS],
}

/// Memory side of a transfer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// Address in memory.
    pub address: u32,
    /// Width of the item.
    pub width: Width,
}

impl Dma {
    /// Reads a register.
    pub fn read(&self, offset: u32) -> Answer<u32> {
        match offset {
            0x00 | 0x04 => Ok(self.flags(offset as usize / 4)),
            LIFCR | HIFCR => Ok(0),
            _ => {
                let (stream, register) = place(offset)?;
                let stream = &self.streams[stream];
                Ok(match register {
                    0x00 => stream.cr,
                    0x04 if bit(stream.cr, EN) => stream.left,
                    0x04 => stream.ndtr,
                    0x08 => stream.par,
                    0x0C => stream.m0ar,
                    0x10 => stream.m1ar,
                    _ => stream.fcr | EMPTY,
                })
            }
        }
    }

    /// Writes a register.
    pub fn write(&mut self, offset: u32, value: u32) -> Answer {
        match offset {
            0x00 | 0x04 => {}
            LIFCR | HIFCR => {
                for (index, shift) in SHIFTS.iter().enumerate() {
                    let stream = 4 * usize::from(offset == HIFCR) + index;
                    self.streams[stream].flags &= !field(value, *shift, 6);
                }
            }
            _ => {
                let (stream, register) = place(offset)?;
                let stream = &mut self.streams[stream];
                match register {
                    0x00 => stream.control(value)?,
                    0x04 => stream.ndtr = value & 0xFFFF,
                    0x08 => stream.par = value,
                    0x0C => stream.m0ar = value,
                    0x10 => stream.m1ar = value,
                    _ => {
                        require(value & 1 << 2 == 0, "the FIFO")?;
                        stream.fcr = value & FIFO_FIELDS;
                    }
                }
            }
        }
        Ok(())
    }

    /// Flags of streams 0 to 3, or 4 to 7.
    fn flags(&self, half: usize) -> u32 {
        SHIFTS.iter().enumerate().fold(0, |all, (index, shift)| {
            all | self.streams[4 * half + index].flags << shift
        })
    }

    /// Stream that serves the peripheral register at address `from`. `able` lists the possible streams and channels.
    pub fn serving(&self, from: u32, able: &[(usize, u32)]) -> Option<usize> {
        able.iter().find_map(|(number, channel)| {
            let stream = &self.streams[*number];
            let serves = bit(stream.cr, EN) && field(stream.cr, 25, 3) == *channel;
            (serves && stream.par == from).then_some(*number)
        })
    }

    /// Transfers one item with stream `number`. Returns its memory address and width. `None` if the stream has completed.
    #[inline]
    pub fn carry(&mut self, number: usize) -> Option<Place> {
        let stream = &mut self.streams[number];
        bit(stream.cr, EN).then(|| stream.step())
    }

    /// Remaining items of stream `number`.
    pub fn left(&self, number: usize) -> u32 {
        self.streams[number].left
    }

    /// Returns true if stream `number` requests an interrupt.
    pub fn requests_interrupt(&self, number: usize) -> bool {
        let stream = &self.streams[number];
        let asks = |flag: u32, enable: u32| stream.flags & flag != 0 && bit(stream.cr, enable);
        asks(HALF, HTIE) || asks(COMPLETE, TCIE)
    }
}

/// Bit positions of the flags of four streams in their register.
const SHIFTS: [u32; 4] = [0, 6, 16, 22];

/// Stream number, and offset in the registers of the stream.
fn place(offset: u32) -> Answer<(usize, u32)> {
    let from_first = offset.checked_sub(FIRST_STREAM).ok_or(Lack::Register)?;
    let stream = (from_first / STREAM_BYTES) as usize;
    if stream < STREAMS {
        Ok((stream, from_first % STREAM_BYTES))
    } else {
        Err(Lack::Register)
    }
}

impl Stream {
    fn control(&mut self, value: u32) -> Answer {
        let starts = bit(value, EN) && !bit(self.cr, EN);
        if starts {
            require(field(value, 6, 2) < 2, "transfers from memory to memory")?;
            require(field(value, 21, 4) == 0, "bursts")?;
            require(field(value, 18, 1) == 0, "double buffers")?;
            require(!bit(value, 9), "an address of the peripheral that moves")?;
            require(!bit(value, TEIE), "the interrupt on errors")?;
            require(
                field(value, 11, 2) == field(value, 13, 2) && field(value, 11, 2) < 3,
                "items of different width",
            )?;
            require(self.ndtr > 0, "no items")?;
            require(self.flags == 0, "a start with flags of the last transfer")?;
            (self.items, self.left) = (self.ndtr, self.ndtr);
        }
        self.cr = value & CONTROL_FIELDS;
        Ok(())
    }

    #[inline]
    fn step(&mut self) -> Place {
        let width = match field(self.cr, 13, 2) {
            0 => Width::Byte,
            1 => Width::Half,
            _ => Width::Word,
        };
        let done = if bit(self.cr, MINC) {
            self.items - self.left
        } else {
            0
        };
        let address = self.m0ar.wrapping_add(done * width.bytes());
        self.left -= 1;
        if self.left == self.items / 2 {
            self.flags |= HALF;
        }
        if self.left == 0 {
            self.flags |= COMPLETE;
            self.left = self.items;
            if !bit(self.cr, CIRC) {
                self.cr &= !(1 << EN);
                self.ndtr = 0;
            }
        }
        Place { address, width }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FROM: u32 = 0x4001_224C;

    fn ring(items: u32, circular: bool) -> Dma {
        let mut dma = Dma::default();
        let stream = FIRST_STREAM + STREAM_BYTES;
        for (register, value) in [
            (0x08, FROM),
            (0x0C, 0x2000_0100),
            (0x04, items),
            (
                0x00,
                2 << 25 | 0b01 << 13 | 0b01 << 11 | 1 << MINC | u32::from(circular) << CIRC | 1,
            ),
        ] {
            dma.write(stream + register, value).unwrap();
        }
        dma
    }

    fn addresses(dma: &mut Dma, requests: usize) -> Vec<u32> {
        (0..requests)
            .filter_map(|_| dma.carry(dma.serving(FROM, &[(0, 2), (1, 2)])?))
            .map(|to| to.address)
            .collect()
    }

    #[test]
    fn a_circular_stream_restarts_at_the_beginning() {
        let mut dma = ring(3, true);
        assert_eq!(
            addresses(&mut dma, 4),
            [0x2000_0100, 0x2000_0102, 0x2000_0104, 0x2000_0100]
        );
        assert_eq!(dma.read(FIRST_STREAM + STREAM_BYTES + 4).unwrap(), 2);
        assert_eq!(dma.read(0).unwrap() >> 6 & 0b11_0000, 0b11_0000);
        dma.write(LIFCR, 0b11_0000 << 6).unwrap();
        assert_eq!(dma.read(0).unwrap(), 0);
    }

    #[test]
    fn a_completed_stream_transfers_nothing() {
        let mut dma = ring(2, false);
        assert_eq!(addresses(&mut dma, 3).len(), 2);
    }

    #[test]
    fn a_stream_with_another_channel_does_not_serve_the_peripheral() {
        assert_eq!(ring(3, true).serving(FROM, &[(1, 0)]), None);
    }
}
