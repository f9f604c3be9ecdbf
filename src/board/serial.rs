//! The serial port. DMA transfers its bytes in both directions, so no code waits for a byte.
#![expect(
    unsafe_code,
    reason = "two halves share one port's registers, and DMA is given addresses"
)]

use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

use stm32f4xx_hal::pac::{DMA1, USART2};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Enable, Rcc};
use stm32f4xx_hal::serial::config::{Config, DmaConfig};

use super::clocks::PCLK1_HZ;
use super::pins::SerialPins;

/// Baud rate after boot. The clock divider reaches it within 0.2 %, and every terminal program knows it.
pub const BOOT_BAUD: u32 = 460_800;
/// Size of the receive ring, bytes, a power of two. It holds what a person types or a script sends while an answer is sent.
const RING_BYTES: usize = 2048;
/// Largest number of bytes in one DMA transfer.
pub const CHUNK_BYTES: usize = link::MOST_BYTES;

/// DMA1 streams of the receiver and the transmitter (RM0090, table 42).
const RECEIVING: usize = 5;
const SENDING: usize = 6;
const REQUEST: u8 = 4;

/// The received bytes. Only the DMA writes them.
static RING: [AtomicU8; RING_BYTES] = [const { AtomicU8::new(0) }; RING_BYTES];
/// Number of bytes received since boot. It wraps.
static ARRIVED: AtomicU32 = AtomicU32::new(0);
static BAUD: AtomicU32 = AtomicU32::new(BOOT_BAUD);

/// Sets up the port.
pub fn start(port: USART2, dma: DMA1, pins: SerialPins, rcc: &mut Rcc) -> (Receiver, Transmitter) {
    DMA1::enable(rcc);
    let config = Config::default()
        .baudrate(BOOT_BAUD.bps())
        .dma(DmaConfig::TxRx);
    if port.serial::<u8>(pins, config, rcc).is_err() {
        unreachable!("the bus clock divides to this rate");
    }
    // SAFETY: the driver above has set up the port and no longer exists. The two halves use different registers and streams.
    // The shared status register is only read.
    let (port, other) = unsafe { (USART2::steal(), USART2::steal()) };
    let receiver = Receiver::new(port, dma);
    // SAFETY: as above.
    let dma = unsafe { DMA1::steal() };
    (receiver, Transmitter::new(other, dma))
}

/// Baud rate, bit/s.
pub fn baud() -> u32 {
    BAUD.load(Ordering::Relaxed)
}

fn set_baud(port: &USART2, baud: u32) {
    let divider = (PCLK1_HZ + baud / 2) / baud;
    // SAFETY: the caller has checked the rate, so the divider is valid.
    port.brr().write(|w| unsafe { w.bits(divider as u16) });
    BAUD.store(baud, Ordering::Relaxed);
}

/// Events since the last call of [`Receiver::look`].
#[derive(Clone, Copy, Default)]
pub struct Arrived {
    /// Ctrl-C was received.
    pub stop: bool,
    /// There was noise on the line. The byte is still correct, by the majority of three samples.
    pub noisy: bool,
    /// A byte was lost, because its frame was broken or it was not read in time.
    pub lost: bool,
}

/// The receiving half.
pub struct Receiver {
    port: USART2,
    dma: DMA1,
    /// Index of the next byte in the ring.
    next: usize,
    /// Number of successive calls that found a broken byte.
    broken: u32,
}

impl Receiver {
    /// After this many successive calls with broken bytes, the other end is assumed to use another baud rate.
    const OTHER_RATE: u32 = 3;

    fn new(port: USART2, dma: DMA1) -> Self {
        let stream = dma.st(RECEIVING);
        // SAFETY: the DMA only reads the data register of this port.
        stream
            .par()
            .write(|w| unsafe { w.pa().bits(port.dr().as_ptr() as u32) });
        // SAFETY: the DMA only writes this static of atomics. Its length is the count of the transfer.
        stream
            .m0ar()
            .write(|w| unsafe { w.m0a().bits(RING.as_ptr() as u32) });
        stream.ndtr().write(|w| w.ndt().set(RING_BYTES as u16));
        stream.cr().write(|w| {
            w.chsel().set(REQUEST);
            w.pl().high();
            w.msize().bits8();
            w.psize().bits8();
            w.minc().incremented();
            w.circ().enabled();
            w.dir().peripheral_to_memory();
            w.en().enabled()
        });
        Self {
            port,
            dma,
            next: 0,
            broken: 0,
        }
    }

    /// Checks what has arrived. It must be called every control period. In one period fewer bytes arrive than the ring
    /// holds.
    #[inline]
    pub fn look(&mut self) -> Arrived {
        let status = self.port.sr().read();
        let mut arrived = Arrived::default();
        if status.fe().bit() || status.nf().bit() || status.ore().bit() {
            // This read after the read of the status clears all flags (RM0090, section 30.6.1).
            self.port.dr().read();
            arrived.noisy = status.nf().bit();
            arrived.lost = status.fe().bit() || status.ore().bit();
            if status.fe().bit() {
                self.broken += 1;
                if self.broken >= Self::OTHER_RATE && baud() != BOOT_BAUD {
                    set_baud(&self.port, BOOT_BAUD);
                }
            }
        }
        let left = usize::from(self.dma.st(RECEIVING).ndtr().read().ndt().bits());
        let next = (RING_BYTES - left) % RING_BYTES;
        if next != self.next {
            if !arrived.lost {
                self.broken = 0;
            }
            arrived.stop = self.take_up_to(next);
        }
        arrived
    }

    /// Counts the bytes in the ring before `next` as received. Returns true if Ctrl-C is one of them.
    fn take_up_to(&mut self, next: usize) -> bool {
        let mut stop = false;
        let mut count = 0;
        while self.next != next {
            stop |= byte(self.next) == haptic_paddle::console::STOP_BYTE;
            self.next = (self.next + 1) % RING_BYTES;
            count += 1;
        }
        ARRIVED.fetch_add(count, Ordering::Release);
        stop
    }
}

fn byte(index: usize) -> u8 {
    RING.get(index % RING_BYTES)
        .map_or(0, |byte| byte.load(Ordering::Relaxed))
}

/// Reads the received bytes one after the other.
#[derive(Default)]
pub struct Received {
    taken: u32,
}

impl Received {
    /// The next byte.
    pub fn next(&mut self) -> Option<u8> {
        let arrived = ARRIVED.load(Ordering::Acquire);
        if arrived == self.taken {
            return None;
        }
        let byte = byte(self.taken as usize);
        self.taken = self.taken.wrapping_add(1);
        Some(byte)
    }

    /// Discards all bytes if some were overwritten before they were read. Returns true in that case.
    pub fn overrun(&mut self) -> bool {
        let arrived = ARRIVED.load(Ordering::Acquire);
        let overrun = arrived.wrapping_sub(self.taken) > RING_BYTES as u32;
        if overrun {
            self.taken = arrived;
        }
        overrun
    }
}

/// The sending half.
pub struct Transmitter {
    port: USART2,
    dma: DMA1,
    chunk: [u8; CHUNK_BYTES],
}

impl Transmitter {
    fn new(port: USART2, dma: DMA1) -> Self {
        let stream = dma.st(SENDING);
        // SAFETY: the DMA only writes the data register of this port.
        stream
            .par()
            .write(|w| unsafe { w.pa().bits(port.dr().as_ptr() as u32) });
        Self {
            port,
            dma,
            chunk: [0; CHUNK_BYTES],
        }
    }

    /// The buffer for the next transfer. `None` while a transfer runs.
    pub fn chunk(&mut self) -> Option<&mut [u8; CHUNK_BYTES]> {
        let busy = self.dma.st(SENDING).cr().read().en().is_enabled();
        (!busy).then_some(&mut self.chunk)
    }

    /// Sends the first `length` bytes of the buffer. The interrupt is raised when the last byte has been read by the DMA.
    pub fn send(&mut self, length: usize) {
        let length = length.min(CHUNK_BYTES);
        self.acknowledge();
        if length == 0 {
            return;
        }
        let stream = self.dma.st(SENDING);
        // SAFETY: the DMA reads the buffer, which is part of a static of the app. `chunk` does not lend it until the
        // transfer has ended.
        stream
            .m0ar()
            .write(|w| unsafe { w.m0a().bits(self.chunk.as_ptr() as u32) });
        stream.ndtr().write(|w| w.ndt().set(length as u16));
        // The barrier ensures that the buffer is written before the DMA reads it.
        cortex_m::asm::dmb();
        stream.cr().write(|w| {
            w.chsel().set(REQUEST);
            w.pl().medium();
            w.msize().bits8();
            w.psize().bits8();
            w.minc().incremented();
            w.dir().memory_to_peripheral();
            w.tcie().enabled();
            w.en().enabled()
        });
    }

    /// Clears the flags of the last transfer. Otherwise no other transfer starts (RM0090, section 10.3.17).
    fn acknowledge(&mut self) {
        self.dma.hifcr().write(|w| {
            w.cdmeif6().set_bit();
            w.cfeif6().set_bit();
            w.chtif6().set_bit();
            w.ctcif6().set_bit();
            w.cteif6().set_bit()
        });
    }

    /// Changes the baud rate if the last bit of the last byte has been sent. Returns true if it did.
    pub fn change_baud(&mut self, baud: u32) -> bool {
        let still = self.port.sr().read().tc().bit();
        if still {
            set_baud(&self.port, baud);
        }
        still
    }
}
