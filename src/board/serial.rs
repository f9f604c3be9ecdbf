//! The serial port. DMA carries its bytes both ways; nothing waits for a byte.
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

/// Within 0.2 % of what the clock can divide to, and known to every terminal program.
pub const BOOT_BAUD: u32 = 460_800;
/// Room for what a person types, or a script sends, while an answer is on its way; a power of two.
const RING_BYTES: usize = 2048;
/// Most bytes that are sent in one go.
pub const CHUNK_BYTES: usize = link::MOST_BYTES;

/// Streams of DMA1 and their request channel (RM0090, table 42).
const RECEIVING: usize = 5;
const SENDING: usize = 6;
const REQUEST: u8 = 4;

/// What was received; the DMA writes it, nobody else does.
static RING: [AtomicU8; RING_BYTES] = [const { AtomicU8::new(0) }; RING_BYTES];
/// Bytes that have been received since boot, as the receiver knows; wraps.
static ARRIVED: AtomicU32 = AtomicU32::new(0);
static BAUD: AtomicU32 = AtomicU32::new(BOOT_BAUD);

/// Sets the port up.
pub fn start(port: USART2, dma: DMA1, pins: SerialPins, rcc: &mut Rcc) -> (Receiver, Transmitter) {
    DMA1::enable(rcc);
    let config = Config::default()
        .baudrate(BOOT_BAUD.bps())
        .dma(DmaConfig::TxRx);
    if port.serial::<u8>(pins, config, rcc).is_err() {
        unreachable!("the bus clock divides to this rate");
    }
    // SAFETY: the driver above has set the port up and is gone. Of what both halves share, each uses its own registers:
    // the status is only read, and each half has its own stream.
    let (port, other) = unsafe { (USART2::steal(), USART2::steal()) };
    let receiver = Receiver::new(port, dma);
    // SAFETY: as above.
    let dma = unsafe { DMA1::steal() };
    (receiver, Transmitter::new(other, dma))
}

/// Bits a second.
pub fn baud() -> u32 {
    BAUD.load(Ordering::Relaxed)
}

fn set_baud(port: &USART2, baud: u32) {
    let divider = (PCLK1_HZ + baud / 2) / baud;
    // SAFETY: a divider of a rate that was checked.
    port.brr().write(|w| unsafe { w.bits(divider as u16) });
    BAUD.store(baud, Ordering::Relaxed);
}

/// What has arrived since the last look.
#[derive(Clone, Copy, Default)]
pub struct Arrived {
    /// Ctrl-C was among it.
    pub stop: bool,
    /// There was noise on the line; the receiver's majority of three samples has the byte all the same.
    pub noisy: bool,
    /// A byte was lost: its frame was broken, or nobody fetched it in time.
    pub lost: bool,
}

/// The receiving half.
pub struct Receiver {
    port: USART2,
    dma: DMA1,
    /// Where the next byte goes.
    next: usize,
    /// Looks in a row that found a broken byte.
    broken: u32,
}

impl Receiver {
    /// Looks in a row that find broken bytes, after which the other end is taken to have another rate.
    const OTHER_RATE: u32 = 3;

    fn new(port: USART2, dma: DMA1) -> Self {
        let stream = dma.st(RECEIVING);
        // SAFETY: the DMA reads this port's data register only.
        stream
            .par()
            .write(|w| unsafe { w.pa().bits(port.dr().as_ptr() as u32) });
        // SAFETY: the DMA writes this static of atomics only, which is as long as its count says.
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

    /// Looks at what has arrived; to be called every control period, in which fewer bytes come than the ring has.
    #[inline]
    pub fn look(&mut self) -> Arrived {
        let status = self.port.sr().read();
        let mut arrived = Arrived::default();
        if status.fe().bit() || status.nf().bit() || status.ore().bit() {
            // Read after the status, this clears all flags (RM0090, section 30.6.1).
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

    /// Takes what stands in the ring before `next`. Returns whether Ctrl-C is among it.
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

/// The received bytes, one after the other.
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

    /// Forgets all bytes if some were written over before they were taken. Returns whether so.
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
        // SAFETY: the DMA writes this port's data register only.
        stream
            .par()
            .write(|w| unsafe { w.pa().bits(port.dr().as_ptr() as u32) });
        Self {
            port,
            dma,
            chunk: [0; CHUNK_BYTES],
        }
    }

    /// Where to write what is sent next; `None` while it is being sent.
    pub fn chunk(&mut self) -> Option<&mut [u8; CHUNK_BYTES]> {
        let busy = self.dma.st(SENDING).cr().read().en().is_enabled();
        (!busy).then_some(&mut self.chunk)
    }

    /// Sends the first `length` bytes of the chunk, and raises the interrupt when the last one has been fetched.
    pub fn send(&mut self, length: usize) {
        let length = length.min(CHUNK_BYTES);
        self.acknowledge();
        if length == 0 {
            return;
        }
        let stream = self.dma.st(SENDING);
        // SAFETY: the DMA reads the chunk, which stands in a static of the app and which `chunk` lends to nobody until
        // the stream is done.
        stream
            .m0ar()
            .write(|w| unsafe { w.m0a().bits(self.chunk.as_ptr() as u32) });
        stream.ndtr().write(|w| w.ndt().set(length as u16));
        // What was written to the chunk is there before the DMA reads it.
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

    /// Clears the flags of the last transfer, without which no other begins (RM0090, section 10.3.17).
    fn acknowledge(&mut self) {
        self.dma.hifcr().write(|w| {
            w.cdmeif6().set_bit();
            w.cfeif6().set_bit();
            w.chtif6().set_bit();
            w.ctcif6().set_bit();
            w.cteif6().set_bit()
        });
    }

    /// Changes the rate, if the last bit of the last byte is out. Returns whether so.
    pub fn change_baud(&mut self, baud: u32) -> bool {
        let still = self.port.sr().read().tc().bit();
        if still {
            set_baud(&self.port, baud);
        }
        still
    }
}
