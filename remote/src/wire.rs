//! The bytes between computer and board.

use std::io::{self, ErrorKind, Read, Write};
use std::time::{Duration, Instant};

use serialport::{SerialPort, TTYPort};

use crate::DeviceError;

/// Bits a second at which a board boots.
pub const BOOT_BAUD: u32 = 460_800;
/// Bits a second of a stream.
pub const FAST_BAUD: u32 = 1_843_200;

/// A line to a board.
pub trait Wire {
    /// Puts what has arrived into `bytes`; waits some milliseconds for it, and gives 0 if nothing comes.
    ///
    /// # Errors
    /// If the line is gone.
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize>;

    /// Sends all of them.
    ///
    /// # Errors
    /// If the line is gone.
    fn write(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Sets the rate, bits a second.
    ///
    /// # Errors
    /// If the line has no such rate.
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
    /// How long a read waits for a byte.
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
        // A pseudo-terminal that its other side holds open would stay closed to others.
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
