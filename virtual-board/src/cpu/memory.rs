//! The memories that the core accesses directly.

use super::Width;

/// Flash, main SRAM and core-coupled RAM (CCM), as plain bytes.
#[derive(Debug, Clone)]
pub struct Memories {
    flash: Vec<u8>,
    flash_edition: u64,
    /// Main SRAM, at [`Memories::SRAM`].
    pub sram: Vec<u8>,
    /// Core-coupled RAM, at [`Memories::CCM`]. It holds data only, and DMA cannot access it.
    pub ccm: Vec<u8>,
}

impl Memories {
    /// First address of the flash. It is also mapped at address 0, from which the core boots.
    pub const FLASH: u32 = 0x0800_0000;
    /// First address of the core-coupled RAM.
    pub const CCM: u32 = 0x1000_0000;
    /// First address of the main SRAM.
    pub const SRAM: u32 = 0x2000_0000;

    /// Memories of the given sizes in bytes, with erased flash and zeroed RAM.
    #[must_use]
    pub fn new(flash: usize, sram: usize, ccm: usize) -> Self {
        Self {
            flash: vec![0xFF; flash],
            flash_edition: 0,
            sram: vec![0; sram],
            ccm: vec![0; ccm],
        }
    }

    /// Content of the flash.
    #[must_use]
    pub fn flash(&self) -> &[u8] {
        &self.flash
    }

    /// Mutable content of the flash. The core then discards its decoded instructions.
    pub fn flash_mut(&mut self) -> &mut [u8] {
        self.flash_edition += 1;
        &mut self.flash
    }

    /// Number of calls of [`Memories::flash_mut`].
    #[must_use]
    pub fn flash_edition(&self) -> u64 {
        self.flash_edition
    }

    /// Reads a little-endian value at any alignment, zero extended. `None` if it does not lie within one memory.
    #[inline]
    #[must_use]
    pub fn read(&self, address: u32, width: Width) -> Option<u32> {
        let (bytes, at) = match address >> 24 {
            0x20 => (&self.sram, address - Self::SRAM),
            0x08 => (&self.flash, address - Self::FLASH),
            0x10 => (&self.ccm, address - Self::CCM),
            0x00 => (&self.flash, address),
            _ => return None,
        };
        let at = at as usize;
        Some(match width {
            Width::Byte => u32::from(*bytes.get(at)?),
            Width::Half => u32::from(u16::from_le_bytes(*bytes.get(at..)?.first_chunk()?)),
            Width::Word => u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?),
        })
    }

    /// Writes a little-endian value to RAM at any alignment. `None` if it does not lie within one RAM.
    #[inline]
    pub fn write(&mut self, address: u32, width: Width, value: u32) -> Option<()> {
        let (bytes, at) = match address >> 24 {
            0x20 => (&mut self.sram, address - Self::SRAM),
            0x10 => (&mut self.ccm, address - Self::CCM),
            _ => return None,
        };
        let at = at as usize;
        match width {
            Width::Byte => *bytes.get_mut(at)? = value as u8,
            Width::Half => {
                *bytes.get_mut(at..)?.first_chunk_mut()? = (value as u16).to_le_bytes();
            }
            Width::Word => *bytes.get_mut(at..)?.first_chunk_mut()? = value.to_le_bytes(),
        }
        Some(())
    }
}
