//! Settings in flash that outlive a loss of the supply: at any instant the old ones or the new ones, whole.
//!
//! Sectors are divided into slots of one record each, which carries a number that counts up and a checksum. The record
//! of the highest number whose checksum is right counts. The next one goes into a slot that is blank; where there is none,
//! the sector after that of the record that counts is erased first. So that record is never touched, and whatever a store
//! that was cut short leaves in its own slot, or in the sector that it erased, has no right checksum.
//!
//! The crate `sequential-storage` was tried for this. It goes by marks at both ends of a sector: where an erase is cut short
//! and leaves one mark and not the other, it refuses every later store (see `docs/stored-settings.md`).

use core::fmt;
use core::ops::Range;

use crc::{CRC_32_ISO_HDLC, Crc};
use embedded_storage::nor_flash::NorFlash;

use super::Settings;
use super::record::{RECORD_BYTES, Recalled, recall, record};

/// Why settings were not stored or not recalled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoreError {
    /// There is nowhere to store them.
    NoStore,
    /// Somebody armed the paddle.
    Armed,
    /// The supply is too low to write.
    Supply,
    /// Nothing is stored.
    Empty,
    /// What is stored is of a version that is not known.
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

/// Bytes of a slot: its number, the record, room for more settings, and the checksum of it all. A firmware whose slots are
/// larger does not find what this one stored.
const SLOT_BYTES: usize = 1024;
const NUMBER_BYTES: usize = size_of::<u32>();
const CHECK_BYTES: usize = size_of::<u32>();
const _: () = assert!(NUMBER_BYTES + RECORD_BYTES + CHECK_BYTES <= SLOT_BYTES);

const CHECK: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// What an erased flash reads.
const BLANK: u8 = 0xFF;

/// Settings in sectors of a flash.
#[derive(Debug)]
pub struct Store<F> {
    flash: F,
    sectors: Range<u32>,
}

/// A record that counts.
struct Latest {
    number: u32,
    at: u32,
}

type Slot = [u8; SLOT_BYTES];

impl<F: NorFlash> Store<F> {
    /// In these sectors, at least two, of `flash`, by offsets of bytes.
    pub const fn new(flash: F, sectors: Range<u32>) -> Self {
        Self { flash, sectors }
    }

    /// The flash behind it.
    pub fn flash(&mut self) -> &mut F {
        &mut self.flash
    }

    /// The settings that were stored last.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn load(&mut self) -> Result<Recalled, StoreError> {
        let latest = self.latest()?.ok_or(StoreError::Empty)?;
        let slot = self.read(latest.at)?;
        recall(payload(&slot)).ok_or(StoreError::Version)
    }

    /// Stores these settings.
    ///
    /// # Errors
    /// [`StoreError`]; the settings from before are then still there.
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

    /// Writes into a blank slot of a sector, another one if that does not keep it; whether there was one that does.
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

    /// All sectors, round from this one.
    fn sectors_from(&self, first: u32) -> impl Iterator<Item = u32> + use<F> {
        let Range { start, end } = self.sectors;
        let bytes = end - start;
        (0..bytes)
            .step_by(F::ERASE_SIZE)
            .map(move |offset| start + (first - start + offset) % bytes)
    }

    /// The sector of this place.
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

/// Where a sector's slots begin.
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

/// The number of a slot whose checksum is right.
fn number(slot: &Slot) -> Option<u32> {
    let (checked, check) = slot.split_last_chunk()?;
    let number = u32::from_le_bytes(*slot.first_chunk()?);
    // A blank slot needs no arithmetic.
    (number != u32::MAX && CHECK.checksum(checked) == u32::from_le_bytes(*check)).then_some(number)
}
