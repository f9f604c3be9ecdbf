//! The connection that carries bytes between computer and board.

use std::io::{self, ErrorKind, Read, Write};
use std::time::{Duration, Instant};

use serialport::{SerialPort, TTYPort};

use crate::DeviceError;

/// Baud rate of a board after boot, bit/s.
pub const BOOT_BAUD: u32 = 460_800;
/// Baud rate for a stream, bit/s.
pub const FAST_BAUD: u32 = 1_843_200;

/// A line to a board.
pub trait Wire {
    /// Reads the bytes that have arrived into `bytes`. Waits some milliseconds, and returns 0 if none arrive.
    ///
    /// # Errors
    ///
    /// If the line is broken.
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize>;

    /// Sends all bytes.
    ///
    /// # Errors
    ///
    /// If the line is broken.
    fn write(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Sets the baud rate, bit/s.
    ///
    /// # Errors
    ///
    /// If the line does not support it.
    fn set_baud(&mut self, baud: u32) -> io::Result<()>;

    /// Time since the line was opened, s.
    fn time_s(&self) -> f64;
}

/// A serial port of the computer.
pub struct SerialWire {
    port: TTYPort,
    opened: Instant,
}

impl SerialWire {
    /// Longest wait of a read for a byte.
    const WAIT: Duration = Duration::from_millis(5);

    /// Opens a port by its name.
    ///
    /// # Errors
    /// [`DeviceError::Open`].
    pub fn open(name: &str) -> Result<Self, DeviceError> {
        let port = serialport::new(name, BOOT_BAUD)
            .timeout(Self::WAIT)
            .open_native()
            .map_err(|source| DeviceError::Open {
                port: name.into(),
                source,
            })?;
        Ok(Self {
            port,
            opened: Instant::now(),
        })
    }
}

impl Drop for SerialWire {
    fn drop(&mut self) {
        // Without this, a pseudo-terminal that its other side keeps open would stay locked.
        let _ = self.port.set_exclusive(false);
    }
}

impl Wire for SerialWire {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        match self.port.read(bytes) {
            Err(error) if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::Interrupted) => {
                Ok(0)
            }
            other => other,
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.port.write_all(bytes)
    }

    fn set_baud(&mut self, baud: u32) -> io::Result<()> {
        self.port.set_baud_rate(baud).map_err(io::Error::from)
    }

    fn time_s(&self) -> f64 {
        self.opened.elapsed().as_secs_f64()
    }
}
