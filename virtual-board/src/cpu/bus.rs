//! What the core needs of the board around it.

use std::fmt;

use super::{Memories, Signals};

/// The board, as the core sees it: memories that it reaches directly, and everything else behind reads and writes.
///
/// The core keeps to itself the private peripheral bus (0xE000_0000 to 0xE00F_FFFF) and the bit-band aliases of SRAM
/// and peripherals, which arrive here as a read and a write of the word that holds the bit.
pub trait Bus {
    /// The memories.
    fn memories(&mut self) -> &mut Memories;

    /// Reads `address`, which is a multiple of the width and in none of the memories. The value is zero-extended.
    ///
    /// # Errors
    /// [`Refusal`], if there is nothing to read.
    fn read(&mut self, address: u32, width: Width, signals: &mut Signals) -> Result<u32, Refusal>;

    /// Writes `address`, which is a multiple of the width and not in RAM; flash is written here.
    /// `value` has no bits above the width.
    ///
    /// # Errors
    /// [`Refusal`], if there is nothing to write.
    fn write(
        &mut self,
        address: u32,
        width: Width,
        value: u32,
        signals: &mut Signals,
    ) -> Result<(), Refusal>;
}

/// Why the board does not answer an access.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Refusal {
    /// The chip answers with an error too: the core takes a bus fault.
    BusFault,
    /// The chip would answer, this board cannot: the run stops. The text names the register, as in `TIM8 + 0x4C`.
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
    /// Bytes of the access: 1, 2 or 4.
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
