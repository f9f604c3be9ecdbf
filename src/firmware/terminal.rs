//! Text queues between the serial port and the console. Neither waits for the other.

use core::fmt;
use core::sync::atomic::{AtomicBool, Ordering};

use haptic_paddle::console::{MAX_ANSWER_BYTES, Terminal};
use heapless::spsc::Producer;
use stm32f4xx_hal::pac::Interrupt;

use crate::board;
use crate::board::serial::Received;

/// Size of the output queue, bytes. It holds the answers to pasted settings while they arrive, which are twice as long as
/// the input.
pub const OUTPUT_BYTES: usize = 4096;

/// Set when received bytes were lost.
static CUT: AtomicBool = AtomicBool::new(false);

/// Reports that received bytes were lost.
pub fn cut() {
    CUT.store(true, Ordering::Relaxed);
}

/// Control periods without a byte after which a transmission counts as ended, 10 ms.
const QUIET_PERIODS: u32 = board::CONTROL_HZ / 100;

/// The received bytes as the console reads them.
#[derive(Default)]
pub struct Input {
    received: Received,
    /// Control period of the last discarded byte. It is set while the rest of an incomplete transmission is discarded.
    dropping: Option<u32>,
}

/// Input event of the console.
pub enum Heard {
    Nothing,
    Byte(u8),
    /// Bytes were lost. The rest of the same transmission was discarded.
    Loss,
}

impl Input {
    /// The next input event. `now` is the number of control periods since boot.
    pub fn next(&mut self, now: u32) -> Heard {
        if self.received.overrun() || CUT.load(Ordering::Relaxed) {
            CUT.store(false, Ordering::Relaxed);
            self.dropping = Some(now);
        }
        let byte = self.received.next();
        match (self.dropping, byte) {
            (None, Some(byte)) => Heard::Byte(byte),
            (None, None) => Heard::Nothing,
            (Some(_), Some(_)) => {
                self.dropping = Some(now);
                Heard::Nothing
            }
            (Some(last), None) if now.wrapping_sub(last) > QUIET_PERIODS => {
                self.dropping = None;
                Heard::Loss
            }
            (Some(_), None) => Heard::Nothing,
        }
    }
}

/// The output queue of the console.
pub struct Output {
    to_send: Producer<'static, u8>,
    written: bool,
}

impl Output {
    pub fn new(to_send: Producer<'static, u8>) -> Self {
        Self {
            to_send,
            written: false,
        }
    }

    /// Starts the transmission of the queue. It continues by itself until the queue is empty.
    pub fn flush(&mut self) {
        if self.written {
            self.written = false;
            rtic::pend(Interrupt::DMA1_STREAM6);
        }
    }
}

impl Terminal for Output {
    fn has_room(&self) -> bool {
        self.to_send.capacity() - self.to_send.len() >= MAX_ANSWER_BYTES
    }
}

impl fmt::Write for Output {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.written = true;
        text.bytes()
            .try_for_each(|byte| self.to_send.enqueue(byte))
            .map_err(|_| fmt::Error)
    }
}
