//! The flash interface: wait states, and programming and erasing. Both take time and can be interrupted.

use super::{Answer, Lack, NEVER, bit, field, require};
use crate::cpu::{FlashTiming, Width};

const ACR: u32 = 0x00;
const KEYR: u32 = 0x04;
const OPTKEYR: u32 = 0x08;
const SR: u32 = 0x0C;
const CR: u32 = 0x10;
const OPTCR: u32 = 0x14;

const KEYS: [u32; 2] = [0x4567_0123, 0xCDEF_89AB];
const OPTION_KEYS: [u32; 2] = [0x0819_2A3B, 0x4C5D_6E7F];
const OPTLOCK: u32 = 0;
const OPTSTRT: u32 = 1;
/// Factory option bytes: no protection and no brown-out level.
const OPTIONS: u32 = 0x0FFF_AAEC;
/// Time to program the option bytes, s. Their sector is erased like one of 16 KiB.
const OPTIONS_S: f64 = 0.25;

/// Supply below which the chip is held in reset, V, by brown-out level (data sheet, typical, falling). The last entry is the
/// power-down reset, which applies if no level is set.
const BROWN_OUT_V: [f64; 4] = [2.83, 2.50, 2.19, 1.68];

const EOP: u32 = 1 << 0;
const WRPERR: u32 = 1 << 4;
const PGAERR: u32 = 1 << 5;
const PGPERR: u32 = 1 << 6;
const PGSERR: u32 = 1 << 7;
const BSY: u32 = 1 << 16;
const PG: u32 = 0;
const SER: u32 = 1;
const MER: u32 = 2;
const STRT: u32 = 16;
const LOCK: u32 = 31;

/// Time to program one item, s (data sheet, typical, 32 bits at a time).
const PROGRAM_S: f64 = 16e-6;
/// Sector sizes in KiB and their erase times, s (data sheet, typical, 32 bits at a time).
const ERASE_S: [(u32, f64); 3] = [(16, 0.25), (64, 0.55), (128, 1.0)];

/// A flash operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// Clears the zero bits of `value` in one item.
    Program {
        /// Offset from the start of the flash.
        at: u32,
        /// Width of the item.
        width: Width,
        /// The programmed value.
        value: u32,
    },
    /// Sets all bits of a range to one.
    Erase {
        /// Offset from the start of the flash.
        at: u32,
        /// Length in bytes.
        bytes: u32,
    },
    /// Programs the option bytes to this value.
    Options(u32),
}

/// The flash interface, for the one bank of the STM32F407.
#[derive(Debug, Clone)]
pub struct Flash {
    acr: u32,
    sr: u32,
    cr: u32,
    keys_given: usize,
    /// Option bytes as written to the register.
    optcr: u32,
    /// Option bytes as programmed.
    options: u32,
    /// Option bytes as loaded at power-on.
    loaded: u32,
    option_keys_given: usize,
    /// The running operation, and the cycle of its end.
    busy: Option<(Change, u64)>,
}

impl Default for Flash {
    fn default() -> Self {
        Self {
            acr: 0,
            sr: 0,
            cr: 1 << LOCK,
            keys_given: 0,
            optcr: OPTIONS | 1 << OPTLOCK,
            options: OPTIONS,
            loaded: OPTIONS,
            option_keys_given: 0,
            busy: None,
        }
    }
}

impl Flash {
    /// The state after a reset. The option bytes are kept. They are loaded if the supply was lost.
    pub fn reset(&self, of_power: bool) -> Self {
        Self {
            optcr: self.options | 1 << OPTLOCK,
            options: self.options,
            loaded: if of_power { self.options } else { self.loaded },
            ..Self::default()
        }
    }

    /// The state with the highest brown-out level programmed before power-on.
    pub fn with_brown_out(mut self) -> Self {
        self.options &= !(0b11 << 2);
        self.reset(true)
    }

    /// Supply below which the chip is held in reset, V.
    pub fn brown_out_v(&self) -> f64 {
        BROWN_OUT_V[field(self.loaded, 2, 2) as usize]
    }

    /// Reads a register.
    pub fn read(&self, offset: u32) -> Answer<u32> {
        Ok(match offset {
            ACR => self.acr,
            KEYR | OPTKEYR => 0,
            SR => self.sr | if self.busy.is_some() { BSY } else { 0 },
            CR => self.cr,
            OPTCR => self.optcr,
            _ => return Err(Lack::Register),
        })
    }

    /// Writes a register at cycle `now`. `hclk_hz` is the core frequency. Returns an operation if one starts.
    pub fn write(
        &mut self,
        offset: u32,
        value: u32,
        now: u64,
        hclk_hz: f64,
    ) -> Answer<Option<Change>> {
        match offset {
            ACR => {
                const RESETS: u32 = 0b11 << 11;
                const FIELDS: u32 = 0x1F07;
                self.acr = value & FIELDS & !RESETS;
            }
            KEYR => {
                let expected = KEYS.get(self.keys_given);
                require(
                    expected == Some(&value),
                    "a wrong key, which locks until a reset",
                )?;
                self.keys_given += 1;
                if self.keys_given == KEYS.len() {
                    self.keys_given = 0;
                    self.cr &= !(1 << LOCK);
                }
            }
            OPTKEYR => {
                let expected = OPTION_KEYS.get(self.option_keys_given);
                require(
                    expected == Some(&value),
                    "a wrong key, which locks until a reset",
                )?;
                self.option_keys_given += 1;
                if self.option_keys_given == OPTION_KEYS.len() {
                    self.option_keys_given = 0;
                    self.optcr &= !(1 << OPTLOCK);
                }
            }
            OPTCR => {
                const LEVELS: u32 = 0b11 << 2;
                if bit(self.optcr, OPTLOCK) || self.busy.is_some() {
                    return Ok(None);
                }
                require(
                    (value ^ self.options) & !(LEVELS | 1 << OPTLOCK | 1 << OPTSTRT) == 0,
                    "options other than the brown-out level",
                )?;
                self.optcr = value & !(1 << OPTSTRT);
                if bit(value, OPTSTRT) {
                    let change = Change::Options(value & !(1 << OPTLOCK | 1 << OPTSTRT));
                    self.begin(change, now, OPTIONS_S * hclk_hz);
                    return Ok(Some(change));
                }
            }
            SR => self.sr &= !(value & (EOP | WRPERR | PGAERR | PGPERR | PGSERR)),
            CR => {
                require(value & (1 << 24 | 1 << 25) == 0, "interrupts of the flash")?;
                if bit(self.cr, LOCK) || self.busy.is_some() {
                    return Ok(None);
                }
                self.cr = value & !(1 << STRT);
                if bit(value, STRT) {
                    require(!bit(value, MER), "erasing everything, program included")?;
                    require(bit(value, SER), "a start without anything to do")?;
                    return self.erase(field(value, 3, 4), now, hclk_hz).map(Some);
                }
            }
            _ => return Err(Lack::Register),
        }
        Ok(None)
    }

    fn erase(&mut self, sector: u32, now: u64, hclk_hz: f64) -> Answer<Change> {
        let kib = match sector {
            0..4 => 16,
            4 => 64,
            5..12 => 128,
            _ => return Err(Lack::Use("a sector that is not there")),
        };
        let first_kib = match sector {
            0..=4 => 16 * sector,
            _ => 128 * (sector - 4),
        };
        let seconds = ERASE_S
            .iter()
            .find(|(size, _)| *size == kib)
            .map_or(0.0, |(_, seconds)| *seconds);
        let change = Change::Erase {
            at: first_kib * 1024,
            bytes: kib * 1024,
        };
        self.begin(change, now, seconds * hclk_hz);
        Ok(change)
    }

    fn begin(&mut self, change: Change, now: u64, cycles: f64) {
        self.busy = Some((change, now + cycles as u64));
    }

    /// The program writes `value` at offset `at` of the flash. Returns true if programming starts. Otherwise the status
    /// register holds the error.
    pub fn program(
        &mut self,
        at: u32,
        width: Width,
        value: u32,
        now: u64,
        hclk_hz: f64,
    ) -> Answer<bool> {
        require(self.busy.is_none(), "programming while it is busy")?;
        let parallelism = match field(self.cr, 8, 2) {
            0 => Width::Byte,
            1 => Width::Half,
            2 => Width::Word,
            _ => return Err(Lack::Use("programming 64 bits at a time")),
        };
        if bit(self.cr, LOCK) || !bit(self.cr, PG) {
            self.sr |= PGSERR;
        } else if parallelism != width {
            self.sr |= PGPERR;
        } else {
            self.begin(
                Change::Program { at, width, value },
                now,
                PROGRAM_S * hclk_hz,
            );
            return Ok(true);
        }
        Ok(false)
    }

    /// Cycle at which the running operation ends.
    pub fn next_done(&self) -> u64 {
        self.busy.map_or(NEVER, |(_, end)| end)
    }

    /// The running operation, and the cycle at which it ends.
    pub fn running(&self) -> Option<(Change, u64)> {
        self.busy
    }

    /// Ends and returns the running operation, which the caller then applies.
    pub fn done(&mut self) -> Option<Change> {
        self.busy.take().map(|(change, _)| change)
    }

    /// Stores the result of a completed operation on the option bytes.
    pub fn keep(&mut self, change: Change) {
        if let Change::Options(options) = change {
            self.options = options;
        }
    }

    /// The wait times of the flash.
    pub fn timing(&self) -> FlashTiming {
        FlashTiming {
            wait_states: field(self.acr, 0, 3) as u8,
            prefetch: bit(self.acr, 8),
            instruction_cache: bit(self.acr, 9),
            data_cache: bit(self.acr, 10),
        }
    }
}

impl Change {
    /// Applies the operation to the flash.
    pub fn apply(self, flash: &mut [u8]) {
        match self {
            Self::Program { at, width, value } => {
                let bytes = value.to_le_bytes();
                let item = flash[at as usize..]
                    .iter_mut()
                    .zip(bytes)
                    .take(width.bytes() as usize);
                for (cell, byte) in item {
                    *cell &= byte;
                }
            }
            Self::Erase { at, bytes } => {
                flash[at as usize..(at + bytes) as usize].fill(0xFF);
            }
            Self::Options(_) => {}
        }
    }

    /// Applies the operation as interrupted by a loss of the supply. Cells that were to change take values of `noise`.
    pub fn interrupt(self, flash: &mut [u8], mut noise: impl FnMut() -> u8) {
        let mut after = flash.to_vec();
        self.apply(&mut after);
        for (cell, after) in flash.iter_mut().zip(after) {
            let changing = *cell ^ after;
            if changing != 0 {
                *cell ^= changing & noise();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HCLK_HZ: f64 = 168e6;

    fn unlocked() -> Flash {
        let mut flash = Flash::default();
        for key in KEYS {
            flash.write(KEYR, key, 0, HCLK_HZ).unwrap();
        }
        flash
    }

    #[test]
    fn programming_takes_time_and_only_clears_bits() {
        let mut flash = unlocked();
        flash.write(CR, 1 << PG | 2 << 8, 0, HCLK_HZ).unwrap();
        assert!(
            flash
                .program(8, Width::Word, 0x1234_5678, 1000, HCLK_HZ)
                .unwrap()
        );
        assert_eq!(flash.read(SR).unwrap() & BSY, BSY);
        assert_eq!(flash.next_done(), 1000 + 2688);
        let mut cells = vec![0xF0; 16];
        flash.done().unwrap().apply(&mut cells);
        assert_eq!(cells[7..13], [0xF0, 0x70, 0x50, 0x30, 0x10, 0xF0]);
        assert_eq!(flash.read(SR).unwrap() & BSY, 0);
    }

    #[test]
    fn writing_a_locked_flash_sets_an_error_flag() {
        let mut flash = Flash::default();
        assert!(!flash.program(0, Width::Word, 0, 0, HCLK_HZ).unwrap());
        assert_eq!(flash.read(SR).unwrap(), PGSERR);
    }

    #[test]
    fn erasing_a_sector_takes_time() {
        let mut flash = unlocked();
        let change = flash
            .write(CR, 1 << SER | 5 << 3 | 1 << STRT, 0, HCLK_HZ)
            .unwrap();
        assert_eq!(
            change,
            Some(Change::Erase {
                at: 128 * 1024,
                bytes: 128 * 1024
            })
        );
        assert_eq!(flash.next_done(), 168_000_000);
    }

    #[test]
    fn a_brown_out_level_acts_after_the_next_power_on() {
        let mut flash = Flash::default();
        flash
            .write(OPTCR, OPTIONS & !0b1100 | 1 << OPTSTRT, 0, HCLK_HZ)
            .unwrap();
        assert_eq!(flash.next_done(), NEVER, "locked");
        for key in OPTION_KEYS {
            flash.write(OPTKEYR, key, 0, HCLK_HZ).unwrap();
        }
        flash
            .write(OPTCR, OPTIONS & !0b1100 | 1 << OPTSTRT, 0, HCLK_HZ)
            .unwrap();
        let change = flash.done().unwrap();
        flash.keep(change);
        assert_eq!(flash.reset(false).brown_out_v(), 1.68);
        assert_eq!(flash.reset(true).brown_out_v(), 2.83);
    }

    #[test]
    fn an_interrupted_operation_changes_only_its_own_cells() {
        let mut cells = vec![0; 32 * 1024];
        let erase = Change::Erase {
            at: 16 * 1024,
            bytes: 16 * 1024,
        };
        let mut turn = 0u8;
        erase.interrupt(&mut cells, || {
            turn = turn.wrapping_add(1);
            turn
        });
        assert!(cells[..16 * 1024].iter().all(|cell| *cell == 0));
        let erased = cells[16 * 1024..].iter().filter(|cell| **cell == 0xFF);
        assert!((1..16 * 1024).contains(&erased.count()));
    }
}
