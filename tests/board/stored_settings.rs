//! Tests of stored settings: resets, flashing, and a loss of supply while they are written.

use crate::bench::{Bench, image};
use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use haptic_paddle::settings::Store;
use std::convert::Infallible;
use std::ops::Range;
use virtual_board::board::FlashChange;
use virtual_board::image::Image;

/// Sectors 1 to 3, as offsets in the flash.
const SECTORS: Range<usize> = 0x4000..0x1_0000;

/// A bench that has booted and stored a gain.
fn stored(image: Image) -> Bench {
    let mut bench = Bench::new(image);
    let greeting = bench.boot();
    assert!(
        greeting.contains("the settings are the defaults"),
        "{greeting}"
    );
    bench.command("set kp 0.04");
    let answer = bench.command("save");
    assert!(answer.contains("saved"), "{answer}");
    bench.board.take_flash_changes();
    bench
}

/// The active gain.
fn gain(bench: &mut Bench) -> String {
    let shown = bench.command("get kp");
    let value = shown.split("= ").nth(1).unwrap_or_default();
    value.split(' ').next().unwrap_or_default().to_owned()
}

#[test]
fn stored_settings_survive_a_loss_of_the_supply_and_a_new_image() {
    let Some(image) = image("they_outlive_a_loss_of_the_supply") else {
        return;
    };
    let mut bench = stored(image);
    bench.board.interrupt_supply(0.05);
    let greeting = bench.boot();
    assert!(
        greeting.contains("the settings are the stored ones"),
        "{greeting}"
    );
    assert_eq!(gain(&mut bench), "0.04");
    let image = bench.image.clone();
    image
        .flash(bench.board.memories().flash_mut(), 0x0800_0000)
        .unwrap();
    bench.board.press_reset();
    bench.boot();
    assert_eq!(gain(&mut bench), "0.04");
}

#[test]
fn load_and_defaults_restore_settings() {
    let Some(image) = image("load_and_defaults_go_back") else {
        return;
    };
    let mut bench = stored(image);
    bench.command("set kp 0.01");
    bench.command("load");
    assert_eq!(gain(&mut bench), "0.04");
    bench.command("defaults");
    assert_eq!(gain(&mut bench), "0.05");
    bench.board.press_reset();
    bench.boot();
    assert_eq!(gain(&mut bench), "0.04", "defaults alone store nothing");
}

#[test]
fn a_store_is_refused_while_the_paddle_is_armed() {
    let Some(image) = image("an_armed_paddle_stores_nothing") else {
        return;
    };
    let mut bench = Bench::armed(image);
    for line in ["save", "load", "defaults"] {
        let refusal = bench.command(line);
        assert!(refusal.contains("disarm first"), "{line}: {refusal}");
    }
    assert!(bench.command("status").contains("mode position"));
    assert!(bench.board.take_flash_changes().is_empty());
}

/// Stores settings until a store erases a sector, which stalls the core for 0.25 s.
fn until_erased(bench: &mut Bench) {
    for _ in 0..60 {
        bench.command("save");
        let changes = bench.board.take_flash_changes();
        if changes
            .iter()
            .any(|change| change.to_s - change.from_s > 0.1)
        {
            return;
        }
    }
    panic!("nothing was erased");
}

#[test]
fn an_erase_causes_no_fault() {
    let Some(image) = image("after_an_erase_nothing_is_amiss") else {
        return;
    };
    let mut bench = stored(image);
    until_erased(&mut bench);
    assert!(
        bench.board.resets().is_empty(),
        "{:?}",
        bench.board.resets()
    );
    let faults = bench.command("faults");
    assert!(faults.contains("no fault"), "{faults}");
    bench.command("zero hall");
    assert!(bench.command("arm").contains("mode position"));
    bench.command("ref 5");
    bench.run(0.3);
    assert!(!bench.command("status").contains("fault"));
}

/// The watchdog timeout is as short as before after the settings are stored.
#[test]
fn a_store_does_not_lengthen_the_watchdog_timeout() {
    let Some(image) = image("after_a_store_a_stuck_program") else {
        return;
    };
    let mut bench = stored(image);
    const BRANCH_TO_ITSELF: [u8; 2] = 0xE7FEu16.to_le_bytes();
    let flash = bench.board.memories().flash_mut();
    flash[0x1_0000..0x2_0000]
        .chunks_exact_mut(2)
        .for_each(|code| code.copy_from_slice(&BRANCH_TO_ITSELF));
    let from_s = bench.board.time_s();
    while bench.board.resets().is_empty() {
        bench.run(1e-3);
        assert!(bench.board.time_s() - from_s < 0.05, "no watchdog");
    }
}

/// The gain that is stored in these sectors.
fn stored_gain(sectors: Vec<u8>) -> String {
    let recalled = Store::new(Cells(sectors), 0..SECTORS.len() as u32)
        .load()
        .unwrap();
    assert_eq!(recalled.left_out, 0);
    recalled.settings.pid.kp_nm_per_deg.to_string()
}

/// Interrupts the write of every word in several ways, then searches the settings with the code that the image uses.
#[test]
fn a_loss_of_supply_in_any_word_leaves_the_old_or_the_new_settings() {
    let Some(image) = image("a_supply_that_goes_in_any_word") else {
        return;
    };
    let mut bench = stored(image);
    for _ in 0..40 {
        let mut flash = bench.board.memories().flash()[..SECTORS.end].to_vec();
        bench.command("set kp 0.06");
        bench.command("save");
        let changes = bench.board.take_flash_changes();
        for FlashChange { change, .. } in &changes {
            for seed in 0..4 {
                let mut cut = flash.clone();
                let mut state = 4 * changes.len() as u32 + seed;
                change.interrupt(&mut cut, || {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    (state >> 16) as u8
                });
                let gain = stored_gain(cut[SECTORS].to_vec());
                assert!(gain == "0.04" || gain == "0.06", "{change:?}: {gain}");
            }
            change.apply(&mut flash);
        }
        assert_eq!(stored_gain(flash[SECTORS].to_vec()), "0.06");
        bench.command("set kp 0.04");
        bench.command("save");
        bench.board.take_flash_changes();
    }
}

/// As above for some of the words, with a simulated loss of supply and a boot. The test for every word takes minutes.
#[test]
fn the_image_finds_the_old_or_the_new_settings_after_a_loss_of_the_supply() {
    const EVERY: usize = 24;
    let Some(image) = image("the_image_finds_the_old_or_the_new_settings") else {
        return;
    };
    let mut pilot = stored(image.clone());
    pilot.command("set kp 0.06");
    pilot.command("save");
    let changes = pilot.board.take_flash_changes();
    assert!(changes.len() > 100, "{}", changes.len());
    for change in changes.iter().step_by(EVERY).chain(changes.last()) {
        let mut bench = stored(image.clone());
        bench.command("set kp 0.06");
        bench.board.type_in("save\r");
        let middle_s = 0.5 * (change.from_s + change.to_s);
        bench.run(middle_s - bench.board.time_s());
        bench.board.interrupt_supply(0.05);
        bench.boot();
        let found = gain(&mut bench);
        assert!(found == "0.04" || found == "0.06", "{change:?}: {found}");
        bench.command("set kp 0.07");
        assert!(bench.command("save").contains("saved"));
    }
}

/// Flash that can only be read.
struct Cells(Vec<u8>);

impl ErrorType for Cells {
    type Error = Infallible;
}

impl ReadNorFlash for Cells {
    const READ_SIZE: usize = 4;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Infallible> {
        bytes.copy_from_slice(&self.0[offset as usize..][..bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.len()
    }
}

impl NorFlash for Cells {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = 16 * 1024;

    fn erase(&mut self, _: u32, _: u32) -> Result<(), Infallible> {
        unreachable!("it is only read")
    }

    fn write(&mut self, _: u32, _: &[u8]) -> Result<(), Infallible> {
        unreachable!("it is only read")
    }
}
