//! The interface between the core and the board around it.

use std::fmt;

use super::{Memories, Signals};

/// The board as the core sees it: memories with direct access, and reads and writes of all else.
///
/// The core handles the private peripheral bus (0xE000_0000 to 0xE00F_FFFF) itself. It converts an access to a bit-band
/// alias into a read and a write of the word that holds the bit.
pub trait Bus {
    /// The memories.
    fn memories(&mut self) -> &mut Memories;

    /// Reads `address`, which is a multiple of the width and in none of the memories. The value is zero extended.
    ///
    /// # Errors
    ///
    /// [`Refusal`] if the address cannot be read.
    fn read(&mut self, address: u32, width: Width, signals: &mut Signals) -> Result<u32, Refusal>;

    /// Writes `address`, which is a multiple of the width and not in RAM. Writes to flash arrive here. `value` has no bits
    /// above the width.
    ///
    /// # Errors
    ///
    /// [`Refusal`] if the address cannot be written.
    fn write(
        &mut self,
        address: u32,
        width: Width,
        value: u32,
        signals: &mut Signals,
    ) -> Result<(), Refusal>;
}

/// Why the board refuses an access.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Refusal {
    /// The real chip answers with an error too. The core takes a bus fault.
    BusFault,
    /// The real chip would answer, but this board does not model it. The run stops. The text names the register, such as
    /// `TIM8 + 0x4C`.
    Unmodelled(String),
}

/// Width of an access.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Width {
    /// 8 bit.
    Byte,
    /// 16 bit.
    Half,
    /// 32 bit.
    Word,
}

impl Width {
    /// Number of bytes: 1, 2 or 4.
    #[must_use]
    pub const fn bytes(self) -> u32 {
        match self {
            Self::Byte => 1,
            Self::Half => 2,
            Self::Word => 4,
        }
    }
}

impl fmt::Display for Width {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Byte => "byte",
            Self::Half => "halfword",
            Self::Word => "word",
        })
    }
}
