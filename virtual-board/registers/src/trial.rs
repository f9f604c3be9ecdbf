//! Tests a register of the virtual board by reading and writing it.

use virtual_board::chip::Chip;
use virtual_board::cpu::{Bus, Refusal, Signals, Width};

/// Effect of changing one bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effect {
    /// The same bit reads changed, and no other.
    Sticks,
    /// No bit reads changed.
    Nothing,
    /// Other bits read changed.
    Other,
    /// The board reports that it does not model the write.
    Refused,
}

/// The result of testing one register.
#[derive(Debug)]
pub struct Trial {
    /// Value after a reset.
    pub reset: u32,
    /// Effect of changing each bit.
    pub effects: [Effect; 32],
}

impl Trial {
    /// Tests the register at `address`. Returns `None` if the board has no register there.
    pub fn of(address: u32) -> Option<Self> {
        let fresh = with_clocks(address);
        let signals = &mut Signals::default();
        let reset = fresh.clone().read(address, Width::Word, signals).ok()?;
        let effects = std::array::from_fn(|bit| {
            let chip = &mut fresh.clone();
            let signals = &mut Signals::default();
            match chip.write(address, Width::Word, reset ^ 1 << bit, signals) {
                Err(Refusal::Unmodelled(_) | Refusal::BusFault) => return Effect::Refused,
                Ok(()) => {}
            }
            match chip.read(address, Width::Word, signals) {
                Ok(value) if value == reset => Effect::Nothing,
                Ok(value) if value ^ reset == 1 << bit => Effect::Sticks,
                Ok(_) => Effect::Other,
                Err(_) => Effect::Refused,
            }
        });
        Some(Self { reset, effects })
    }
}

/// A chip after reset. All peripheral clocks are on, except when RCC itself is tested.
fn with_clocks(address: u32) -> Chip {
    const RCC: u32 = 0x4002_3800;
    const ENABLES: [u32; 5] = [0x30, 0x34, 0x38, 0x40, 0x44];
    let mut chip = Chip::new();
    if address & !0x3FF != RCC {
        for enable in ENABLES {
            let written = chip.write(RCC + enable, Width::Word, !0, &mut Signals::default());
            debug_assert!(written.is_ok());
        }
    }
    chip
}
