//! Tests of settings in flash with a loss of supply at any step of a store. Either the old or the new settings must be
//! intact.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use haptic_paddle::settings::{Settings, Store, StoreError};
use virtual_board::cpu::Width;
use virtual_board::peripherals::flash::Change;

const SECTOR: usize = 16 * 1024;
const SECTORS: usize = 3;

/// An interruption of a flash operation.
#[derive(Clone, Copy, Debug)]
struct Cut {
    /// Number of the operation at which the supply is lost, counted from 1.
    change: usize,
    /// Progress of the interrupted operation. The share of the cells that have changed is 1 - 2^-progress, or 2^progress if
    /// `progress` is negative.
    progress: i32,
    /// Selects the cells that have changed.
    seed: u32,
}

impl Cut {
    /// Generates bytes whose set bits mark the cells that have changed.
    fn bits(self) -> impl FnMut() -> u8 {
        let mut state = self.seed.wrapping_mul(2_654_435_761) ^ self.change as u32 | 1;
        let mut random = move || {
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            (state >> 11) as u8
        };
        move || {
            let first = random();
            (1..self.progress.abs()).fold(first, |bits, _| {
                if self.progress > 0 {
                    bits | random()
                } else {
                    bits & random()
                }
            })
        }
    }
}

/// A flash memory with the virtual board's model of an interrupted operation.
#[derive(Clone)]
struct Flash {
    cells: Vec<u8>,
    changes: usize,
    erases: usize,
    cut: Option<Cut>,
    gone: bool,
}

impl Flash {
    fn new() -> Self {
        Self {
            cells: vec![0xFF; SECTORS * SECTOR],
            changes: 0,
            erases: 0,
            cut: None,
            gone: false,
        }
    }

    fn change(&mut self, change: Change) -> Result<(), Gone> {
        if self.gone {
            return Err(Gone);
        }
        self.changes += 1;
        self.erases += usize::from(matches!(change, Change::Erase { .. }));
        match self.cut {
            Some(cut) if cut.change == self.changes => {
                self.gone = true;
                change.interrupt(&mut self.cells, cut.bits());
                Err(Gone)
            }
            _ => {
                change.apply(&mut self.cells);
                Ok(())
            }
        }
    }
}

#[derive(Debug)]
struct Gone;

impl NorFlashError for Gone {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl ErrorType for Flash {
    type Error = Gone;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 4;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Gone> {
        bytes.copy_from_slice(&self.cells[offset as usize..][..bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.cells.len()
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Gone> {
        for at in (from..to).step_by(SECTOR) {
            self.change(Change::Erase {
                at,
                bytes: SECTOR as u32,
            })?;
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Gone> {
        for (word, at) in bytes.chunks_exact(4).zip((offset..).step_by(4)) {
            let value = u32::from_le_bytes(word.try_into().unwrap());
            self.change(Change::Program {
                at,
                width: Width::Word,
                value,
            })?;
        }
        Ok(())
    }
}

fn store(flash: Flash) -> Store<Flash> {
    Store::new(flash, 0..(SECTORS * SECTOR) as u32)
}

/// Settings that contain the number of their store.
fn settings(number: usize) -> Settings {
    let mut settings = Settings::default();
    settings.pid.kp_nm_per_deg = number as f32 * 1e-3;
    settings.metrics.band_deg = 1.0 + number as f32 * 0.1;
    settings
}

#[test]
fn the_last_saved_settings_are_loaded_after_any_number_of_stores() {
    let mut store = store(Flash::new());
    assert_eq!(store.load(), Err(StoreError::Empty));
    for number in 0..300 {
        store.save(&settings(number)).unwrap();
        assert_eq!(store.load().unwrap().settings, settings(number), "{number}");
    }
}

/// A flash memory after this number of stores.
fn after(stores: usize) -> Flash {
    let mut store = store(Flash::new());
    for number in 0..stores {
        store.save(&settings(number)).unwrap();
    }
    Flash {
        changes: 0,
        erases: 0,
        ..store.flash().clone()
    }
}

/// Loses the supply in a store after `stores` others, and checks the settings that are then found.
fn lose_the_supply(before: &Flash, stores: usize, cut: Cut) {
    let what = format!("after {stores} stores, {cut:?}");
    let mut cut_short = store(Flash {
        cut: Some(cut),
        ..before.clone()
    });
    assert!(cut_short.save(&settings(stores)).is_err(), "{what}");
    let mut later = store(Flash {
        gone: false,
        cut: None,
        ..cut_short.flash().clone()
    });
    let found = later.load().map(|recalled| recalled.settings);
    let is_old = match stores.checked_sub(1) {
        Some(old) => found == Ok(settings(old)),
        None => found == Err(StoreError::Empty),
    };
    assert!(is_old || found == Ok(settings(stores)), "{what}: {found:?}");
    // Later stores must work as usual.
    for number in stores + 1..stores + 3 {
        assert_eq!(later.save(&settings(number)), Ok(()), "{what}");
        let found = later.load().map(|recalled| recalled.settings);
        assert_eq!(found, Ok(settings(number)), "{what}");
    }
}

/// Number of flash operations of the next store, and number of erase operations among them.
fn changes_of_a_store(before: &Flash, stores: usize) -> (usize, usize) {
    let mut whole = store(before.clone());
    whole.save(&settings(stores)).unwrap();
    (whole.flash().changes, whole.flash().erases)
}

#[test]
fn a_loss_of_the_supply_in_any_change_leaves_the_old_or_the_new_settings() {
    let mut losses = 0;
    // The stores are at the start, in the middle and at the end of a sector, and in the next sector.
    for stores in (0..3)
        .chain(20..22)
        .chain(40..46)
        .chain(84..90)
        .chain(126..134)
    {
        let before = after(stores);
        let (changes, _) = changes_of_a_store(&before, stores);
        for change in 1..=changes {
            for progress in [1, 5] {
                lose_the_supply(
                    &before,
                    stores,
                    Cut {
                        change,
                        progress,
                        seed: stores as u32,
                    },
                );
                losses += 1;
            }
        }
    }
    println!("{losses} losses of the supply, no settings lost");
}

#[test]
fn an_erase_cut_short_at_any_point_leaves_the_old_or_the_new_settings() {
    let mut erasing = 0;
    for stores in 40..100 {
        let before = after(stores);
        let (changes, erases) = changes_of_a_store(&before, stores);
        if erases == 0 {
            continue;
        }
        erasing += 1;
        for change in 1..=changes.min(4) {
            for progress in -6..=14 {
                for seed in 0..10 {
                    lose_the_supply(
                        &before,
                        stores,
                        Cut {
                            change,
                            progress,
                            seed,
                        },
                    );
                }
            }
        }
    }
    assert!(erasing > 2, "only {erasing} stores erased");
}
