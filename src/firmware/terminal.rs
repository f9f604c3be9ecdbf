//! Text between the serial port and the console, neither of which waits for the other.

use core::fmt;
use core::sync::atomic::{AtomicBool, Ordering};

use haptic_paddle::console::{MAX_ANSWER_BYTES, Terminal};
use heapless::spsc::Producer;
use stm32f4xx_hal::pac::Interrupt;

use crate::board;
use crate::board::serial::Received;

/// Room for what is answered to pasted settings while they arrive: twice as much as they are.
pub const OUTPUT_BYTES: usize = 4096;

/// Set when received bytes were lost.
static CUT: AtomicBool = AtomicBool::new(false);

/// Received bytes were lost.
pub fn cut() {
    CUT.store(true, Ordering::Relaxed);
}

/// Control periods without a byte after which what was sent in one go is over, 10 ms.
const QUIET_PERIODS: u32 = board::CONTROL_HZ / 100;

/// The console's side of what was received.
#[derive(Default)]
pub struct Input {
    received: Received,
    /// When the last byte was dropped, in control periods, while the rest of what lost some is.
    dropping: Option<u32>,
}

/// What the console hears.
pub enum Heard {
    Nothing,
    Byte(u8),
    /// Bytes were lost, and the rest of what was sent with them is dropped.
    Loss,
}

impl Input {
    /// What there is to hear, `now` control periods after boot.
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

/// The console's side of what is to be sent.
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

    /// Sees to it that the port sends what was written; it then goes on by itself until the queue is empty.
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
