//! Settings in flash that survive a loss of the supply. At any time either the old or the new settings are complete.
//!
//! Sectors are divided into slots of one record each. A record has a sequence number and a checksum. The valid record with
//! the highest number is the current one. The next record is written to a blank slot. If there is none, the sector after
//! that of the current record is erased first. The current record is therefore never touched. An interrupted write or erase
//! leaves only slots without a valid checksum.
//!
//! The crate `sequential-storage` does not fit. It marks both ends of a sector. If an interrupted erase leaves one mark
//! only, it refuses every later store (see `docs/stored-settings.md`).

use core::fmt;
use core::ops::Range;

use crc::{CRC_32_ISO_HDLC, Crc};
use embedded_storage::nor_flash::NorFlash;

use super::Settings;
use super::record::{RECORD_BYTES, Recalled, recall, record};

/// Why settings were not stored or loaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoreError {
    /// The device has no store.
    NoStore,
    /// The paddle is armed.
    Armed,
    /// The supply is too low to write.
    Supply,
    /// No settings are stored.
    Empty,
    /// The stored settings have an unknown version.
    Version,
    /// The flash cannot be read, written or erased.
    Flash,
}

impl fmt::Display for StoreError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoStore => "there is no flash to store settings in",
            Self::Armed => "disarm first: the motor must be off while the flash is written",
            Self::Supply => "the 3.3 V supply is too low to write the flash",
            Self::Empty => "no settings are stored: save stores them",
            Self::Version => "the stored settings are of another version of the firmware: set them anew, and save",
            Self::Flash => "the flash does not keep what is written: save again; if that fails, replace the board",
        })
    }
}

impl core::error::Error for StoreError {}

/// Size of a slot, bytes: number, record, reserve for more settings, and checksum. A firmware with another slot size does
/// not find the settings that this one stored.
const SLOT_BYTES: usize = 1024;
const NUMBER_BYTES: usize = size_of::<u32>();
const CHECK_BYTES: usize = size_of::<u32>();
const _: () = assert!(NUMBER_BYTES + RECORD_BYTES + CHECK_BYTES <= SLOT_BYTES);

const CHECK: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// Content of erased flash.
const BLANK: u8 = 0xFF;

/// Stores settings in the sectors of a flash.
#[derive(Debug)]
pub struct Store<F> {
    flash: F,
    sectors: Range<u32>,
}

/// The current record.
struct Latest {
    number: u32,
    at: u32,
}

type Slot = [u8; SLOT_BYTES];

impl<F: NorFlash> Store<F> {
    /// A store in `sectors` of `flash`, which are at least two. The range is in bytes.
    pub const fn new(flash: F, sectors: Range<u32>) -> Self {
        Self { flash, sectors }
    }

    /// The flash.
    pub fn flash(&mut self) -> &mut F {
        &mut self.flash
    }

    /// Loads the settings that were stored last.
    ///
    /// # Errors
    ///
    /// [`StoreError`].
    pub fn load(&mut self) -> Result<Recalled, StoreError> {
        let latest = self.latest()?.ok_or(StoreError::Empty)?;
        let slot = self.read(latest.at)?;
        recall(payload(&slot)).ok_or(StoreError::Version)
    }

    /// Stores these settings.
    ///
    /// # Errors
    ///
    /// [`StoreError`]. The previous settings are kept in that case.
    pub fn save(&mut self, settings: &Settings) -> Result<(), StoreError> {
        let (number, own) = match self.latest()? {
            Some(latest) => (latest.number.wrapping_add(1), Some(self.sector(latest.at))),
            None => (0, None),
        };
        let slot = slot(number, settings);
        let first = own.unwrap_or(self.sectors.start);
        for sector in self.sectors_from(first) {
            if self.write_into(sector, &slot)? {
                return Ok(());
            }
        }
        for sector in self
            .sectors_from(first)
            .filter(|sector| Some(*sector) != own)
        {
            let end = sector + F::ERASE_SIZE as u32;
            self.flash
                .erase(sector, end)
                .map_err(|_| StoreError::Flash)?;
            if self.write_into(sector, &slot)? {
                return Ok(());
            }
        }
        Err(StoreError::Flash)
    }

    /// Writes into a blank slot of a sector. If the slot does not keep the data, it tries the next. Returns true on success.
    fn write_into(&mut self, sector: u32, slot: &Slot) -> Result<bool, StoreError> {
        for at in slots::<F>(sector) {
            if self.read(at)?.iter().all(|byte| *byte == BLANK) {
                self.flash.write(at, slot).map_err(|_| StoreError::Flash)?;
                if self.read(at)? == *slot {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    fn latest(&mut self) -> Result<Option<Latest>, StoreError> {
        let mut latest: Option<Latest> = None;
        for sector in self.sectors_from(self.sectors.start) {
            for at in slots::<F>(sector) {
                if let Some(number) = number(&self.read(at)?)
                    && latest.as_ref().is_none_or(|latest| latest.number < number)
                {
                    latest = Some(Latest { number, at });
                }
            }
        }
        Ok(latest)
    }

    /// All sectors in a cycle, starting with this one.
    fn sectors_from(&self, first: u32) -> impl Iterator<Item = u32> + use<F> {
        let Range { start, end } = self.sectors;
        let bytes = end - start;
        (0..bytes)
            .step_by(F::ERASE_SIZE)
            .map(move |offset| start + (first - start + offset) % bytes)
    }

    /// The sector that contains this offset.
    fn sector(&self, at: u32) -> u32 {
        at - (at - self.sectors.start) % F::ERASE_SIZE as u32
    }

    fn read(&mut self, at: u32) -> Result<Slot, StoreError> {
        let mut slot = [0; SLOT_BYTES];
        self.flash
            .read(at, &mut slot)
            .map_err(|_| StoreError::Flash)?;
        Ok(slot)
    }
}

/// Offsets of the slots of a sector.
fn slots<F: NorFlash>(sector: u32) -> impl Iterator<Item = u32> {
    (0..F::ERASE_SIZE / SLOT_BYTES).map(move |place| sector + (place * SLOT_BYTES) as u32)
}

fn slot(number: u32, settings: &Settings) -> Slot {
    let mut slot = [BLANK; SLOT_BYTES];
    let (checked, check) = slot.split_at_mut(SLOT_BYTES - CHECK_BYTES);
    let (head, rest) = checked.split_at_mut(NUMBER_BYTES);
    head.copy_from_slice(&number.to_le_bytes());
    let record = record(settings);
    rest.iter_mut()
        .zip(record)
        .for_each(|(place, byte)| *place = byte);
    check.copy_from_slice(&CHECK.checksum(checked).to_le_bytes());
    slot
}

fn payload(slot: &Slot) -> &[u8] {
    slot.get(NUMBER_BYTES..SLOT_BYTES - CHECK_BYTES)
        .unwrap_or_default()
}

/// The number of a slot. `None` if its checksum is wrong.
fn number(slot: &Slot) -> Option<u32> {
    let (checked, check) = slot.split_last_chunk()?;
    let number = u32::from_le_bytes(*slot.first_chunk()?);
    // The checksum of a blank slot is not computed.
    (number != u32::MAX && CHECK.checksum(checked) == u32::from_le_bytes(*check)).then_some(number)
}
