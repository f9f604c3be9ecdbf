//! Bytes between the serial port and the console: two queues, so that neither waits for the other.

use core::fmt;
use core::sync::atomic::{AtomicBool, Ordering};

use heapless::spsc::{Consumer, Producer};
use stm32f4xx_hal::nb;
use stm32f4xx_hal::pac::Interrupt;
use stm32f4xx_hal::prelude::*;

use crate::board::{SerialRx, SerialTx};

/// Room for what a person types, or a script sends, while an answer is on its way.
pub const INPUT_BYTES: usize = 1024;
/// Room for two of the longest answers.
pub const OUTPUT_BYTES: usize = 8192;
/// An answer, `get` of all settings being the longest, is shorter than this.
const LONGEST_ANSWER_BYTES: usize = 4096;

/// Set when received bytes were lost.
static CUT: AtomicBool = AtomicBool::new(false);

/// The port's side of both queues; the serial interrupt owns it.
pub struct Port {
    rx: SerialRx,
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
            rx,
            tx,
            received,
            to_send,
        }
    }

    /// Takes a received byte, sends the next one.
    pub fn serve(&mut self) {
        let intact = match self.rx.read() {
            Ok(byte) => self.received.enqueue(byte).is_ok(),
            Err(nb::Error::WouldBlock) => true,
            Err(nb::Error::Other(_)) => false,
        };
        if !intact {
            CUT.store(true, Ordering::Relaxed);
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

/// The console's side of what was received.
pub struct Input(Consumer<'static, u8>);

impl Input {
    pub fn new(received: Consumer<'static, u8>) -> Self {
        Self(received)
    }

    pub fn next(&mut self) -> Option<u8> {
        self.0.dequeue()
    }

    /// Whether bytes were lost since the last question; what is left of them is then dropped.
    pub fn was_cut(&mut self) -> bool {
        let cut = CUT.load(Ordering::Relaxed);
        if cut {
            while self.next().is_some() {}
            CUT.store(false, Ordering::Relaxed);
        }
        cut
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

    /// Whether any answer fits.
    pub fn has_room(&self) -> bool {
        self.to_send.capacity() - self.to_send.len() >= LONGEST_ANSWER_BYTES
    }

    /// Sees to it that the port sends what was written; it then goes on by itself until the queue is empty.
    pub fn flush(&mut self) {
        if self.written {
            self.written = false;
            rtic::pend(Interrupt::USART2);
        }
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
