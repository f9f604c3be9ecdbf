//! Bytes between the serial port and the console: two queues, so that neither waits for the other.

use core::fmt;
use core::sync::atomic::{AtomicBool, Ordering};

use haptic_paddle::console::{MAX_ANSWER_BYTES, STOP_BYTE, Terminal};
use heapless::spsc::{Consumer, Producer};
use stm32f4xx_hal::pac::Interrupt;
use stm32f4xx_hal::prelude::*;

use crate::board::{self, SerialRx, SerialTx, events};

/// Room for what a person types, or a script sends, while an answer is on its way.
pub const INPUT_BYTES: usize = 2048;
/// Room for what is answered to pasted settings while they arrive: twice as much as they are.
pub const OUTPUT_BYTES: usize = 4096;

/// Set when received bytes were lost.
static CUT: AtomicBool = AtomicBool::new(false);

/// The port's side of both queues; the serial interrupt owns it.
pub struct Port {
    tx: SerialTx,
    received: Producer<'static, u8>,
    to_send: Consumer<'static, u8>,
}

impl Port {
    pub fn new(
        (tx, mut rx): (SerialTx, SerialRx),
        received: Producer<'static, u8>,
        to_send: Consumer<'static, u8>,
    ) -> Self {
        rx.listen();
        Self {
            tx,
            received,
            to_send,
        }
    }

    /// Takes a received byte, sends the next one.
    pub fn serve(&mut self) {
        if let Some(received) = board::receive() {
            let queued = received.byte.is_none_or(|byte| {
                if byte == STOP_BYTE {
                    board::bridge_off();
                    events::raise(events::STOP);
                }
                self.received.enqueue(byte).is_ok()
            });
            if received.noisy {
                events::raise(events::NOISE);
            }
            if received.lost || !queued {
                CUT.store(true, Ordering::Relaxed);
            }
        }
        if self.tx.is_tx_empty() {
            match self.to_send.dequeue() {
                Some(byte) => {
                    self.tx.listen();
                    // The data register was empty a moment ago, and nobody else writes to it.
                    let _ = self.tx.write(byte);
                }
                None => self.tx.unlisten(),
            }
        }
    }
}

/// Control periods without a byte after which what was sent in one go is over, 10 ms.
const QUIET_PERIODS: u32 = board::CONTROL_HZ / 100;

/// The console's side of what was received.
pub struct Input {
    received: Consumer<'static, u8>,
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
    pub fn new(received: Consumer<'static, u8>) -> Self {
        Self {
            received,
            dropping: None,
        }
    }

    /// What there is to hear, `now` control periods after boot.
    pub fn next(&mut self, now: u32) -> Heard {
        if CUT.load(Ordering::Relaxed) {
            CUT.store(false, Ordering::Relaxed);
            self.dropping = Some(now);
        }
        let byte = self.received.dequeue();
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
            rtic::pend(Interrupt::USART2);
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
