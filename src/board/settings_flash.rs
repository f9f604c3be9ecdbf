//! The flash sectors of the stored settings.
//!
//! While a sector is erased or a word is programmed, the flash cannot be read and the core stalls. DMA and peripherals
//! continue. The HAL is not used: it erases and programs by bytes, which takes four times as long, and it only knows sectors
//! of 128 KiB.

use core::ops::Range;

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash, check_erase, check_read,
    check_write,
};
use stm32f4xx_hal::pac::FLASH;

/// First address of the flash.
const ORIGIN: usize = 0x0800_0000;
/// Size of sectors 0 to 3, bytes (RM0090, section 3.3, table 5).
const SECTOR_BYTES: usize = 16 * 1024;
/// Offsets of sectors 1 to 3. `memory.x` reserves them.
pub const SECTORS: Range<u32> = SECTOR_BYTES as u32..4 * SECTOR_BYTES as u32;

const KEYS: [u32; 2] = [0x4567_0123, 0xCDEF_89AB];
/// Programming by 32 bits, for a supply of 2.7 V or more (RM0090, section 3.6.2).
const PARALLELISM: u8 = 2;

/// Access to the flash. Only the sectors of the settings can be changed.
pub struct SettingsFlash(FLASH);

/// Why an access to the flash failed.
#[derive(Clone, Copy, Debug)]
pub enum FlashError {
    /// The range is outside the sectors or not aligned to a sector or word.
    Place(NorFlashErrorKind),
    /// The status register reports an error.
    Refused,
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::Place(kind) => *kind,
            Self::Refused => NorFlashErrorKind::Other,
        }
    }
}

impl SettingsFlash {
    pub fn new(flash: FLASH) -> Self {
        Self(flash)
    }

    /// Unlocks the control register for `work`. Afterwards it flushes the data cache, so that nobody reads old data.
    fn change(&mut self, work: impl FnOnce(&FLASH)) -> Result<(), FlashError> {
        let flash = &self.0;
        self.wait();
        // Clears the flags of an earlier failure. Writing one clears a flag.
        flash.sr().write(|w| {
            w.eop().clear_bit_by_one();
            w.operr().clear_bit_by_one();
            w.wrperr().clear_bit_by_one();
            w.pgaerr().clear_bit_by_one();
            w.pgperr().clear_bit_by_one();
            w.pgserr().clear_bit_by_one()
        });
        for key in KEYS {
            flash.keyr().write(|w| w.key().set(key));
        }
        work(flash);
        self.wait();
        let status = flash.sr().read();
        let refused = status.operr().bit()
            || status.wrperr().bit()
            || status.pgaerr().bit()
            || status.pgperr().bit()
            || status.pgserr().bit();
        flash.cr().modify(|_, w| w.lock().set_bit());
        self.flush_data_cache();
        if refused {
            return Err(FlashError::Refused);
        }
        Ok(())
    }

    fn wait(&self) {
        while self.0.sr().read().bsy().bit_is_set() {}
    }

    /// Flushes the data cache, which may hold old data (RM0090, section 3.5.2). It can be reset only while it is off.
    fn flush_data_cache(&self) {
        let control = self.0.acr();
        if control.read().dcen().bit_is_set() {
            control.modify(|_, w| w.dcen().clear_bit());
            control.modify(|_, w| w.dcrst().set_bit());
            control.modify(|_, w| w.dcrst().clear_bit());
            control.modify(|_, w| w.dcen().set_bit());
        }
    }
}

/// Checks that a range lies within the sectors of the settings.
fn check_sectors(from: u32, to: u32) -> Result<(), FlashError> {
    if from < SECTORS.start || to > SECTORS.end {
        return Err(FlashError::Place(NorFlashErrorKind::OutOfBounds));
    }
    Ok(())
}

impl ErrorType for SettingsFlash {
    type Error = FlashError;
}

impl ReadNorFlash for SettingsFlash {
    const READ_SIZE: usize = size_of::<u32>();

    #[expect(
        unsafe_code,
        reason = "the flash is memory that changes beside the program"
    )]
    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        check_read(self, offset, bytes.len()).map_err(FlashError::Place)?;
        check_sectors(offset, offset + bytes.len() as u32)?;
        let from = (ORIGIN + offset as usize) as *const u32;
        for (place, word) in bytes.chunks_exact_mut(Self::READ_SIZE).enumerate() {
            // SAFETY: the checks ensure that the address is aligned and within the sectors.
            let value = unsafe { from.add(place).read_volatile() };
            word.copy_from_slice(&value.to_le_bytes());
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        SECTORS.end as usize
    }
}

impl NorFlash for SettingsFlash {
    const WRITE_SIZE: usize = size_of::<u32>();
    const ERASE_SIZE: usize = SECTOR_BYTES;

    #[expect(unsafe_code, reason = "the register takes any number")]
    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        check_erase(self, from, to).map_err(FlashError::Place)?;
        check_sectors(from, to)?;
        for sector in (from..to).step_by(SECTOR_BYTES) {
            let number = (sector as usize / SECTOR_BYTES) as u8;
            self.change(|flash| {
                // SAFETY: the check ensures that this is the number of a settings sector.
                flash.cr().modify(|_, w| unsafe {
                    w.psize().bits(PARALLELISM);
                    w.pg().clear_bit();
                    w.ser().set_bit();
                    w.snb().bits(number)
                });
                flash.cr().modify(|_, w| w.strt().set_bit());
            })?;
        }
        Ok(())
    }

    #[expect(
        unsafe_code,
        reason = "a write to the flash's memory is how it is programmed"
    )]
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        check_write(self, offset, bytes.len()).map_err(FlashError::Place)?;
        check_sectors(offset, offset + bytes.len() as u32)?;
        let to = (ORIGIN + offset as usize) as *mut u32;
        self.change(|flash| {
            flash.cr().modify(|_, w| {
                w.psize().set(PARALLELISM);
                w.ser().clear_bit();
                w.pg().set_bit()
            });
            for (place, word) in bytes.chunks_exact(Self::WRITE_SIZE).enumerate() {
                let value = u32::from_le_bytes(word.try_into().unwrap_or_default());
                // SAFETY: the address is aligned and within the sectors, which hold no code or data of the program.
                unsafe { to.add(place).write_volatile(value) };
                while flash.sr().read().bsy().bit_is_set() {}
            }
        })
    }
}
