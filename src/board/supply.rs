//! The chip's own supply, 3.3 V: a dip takes the bridge down.

use stm32f4xx_hal::pac::{EXTI, FLASH, PWR};
use stm32f4xx_hal::rcc::{Enable, Rcc};

use super::events;

/// The detector's threshold by PLS: 2.85 to 2.99 V falling, 3.10 V rising at most (data sheet, embedded reset and power
/// control block characteristics), above the brown-out level 3 of 2.75 to 2.88 V.
const DETECTOR_LEVEL: u8 = 0b110;
/// Brown-out level 3 in the option bytes, by number: the names of the register crate are the wrong way round (RM0090,
/// section 3.9.6, 00 is level 3 and 11 is off; so are ST's own OB_BOR_LEVEL3 = 0x00 and OB_BOR_OFF = 0x0C).
const BROWN_OUT_LEVEL_3: u8 = 0b00;
/// A supply that has been sound for so long stays so while the option bytes are written, clocks of the core at 16 MHz.
const SOUND_CLOCKS: u32 = 16_000_000 / 10;
/// External interrupt line of the detector (RM0090, section 12.2.5).
const LINE: u8 = 16;

/// The supply; the control loop owns it.
pub struct Supply;

impl Supply {
    /// A supply that is watched.
    pub fn new(power: PWR, exti: &mut EXTI, rcc: &mut Rcc) -> Self {
        PWR::enable(rcc);
        exti.rtsr().modify(|_, w| w.tr(LINE).set_bit());
        exti.imr().modify(|_, w| w.mr(LINE).set_bit());
        power
            .cr()
            .modify(|_, w| w.pls().set(DETECTOR_LEVEL).pvde().set_bit());
        Self
    }

    /// Whether the supply is low.
    pub fn is_low(&self) -> bool {
        is_low()
    }

    /// Has the chip held in reset below 2.83 V from the next power-on on; as delivered it goes on down to 1.7 V, far
    /// below what 168 MHz need. Written once in the chip's life; a loss of the supply in that
    /// quarter of a second may spoil the option bytes.
    pub fn hold_in_reset_when_low(&self, flash: &FLASH) {
        const KEYS: [u32; 2] = [0x0819_2A3B, 0x4C5D_6E7F];
        if flash.optcr().read().bor_lev().bits() == BROWN_OUT_LEVEL_3 {
            return;
        }
        cortex_m::asm::delay(SOUND_CLOCKS);
        if self.is_low() {
            return;
        }
        while flash.sr().read().bsy().bit_is_set() {}
        for key in KEYS {
            flash.optkeyr().write(|w| w.optkeyr().set(key));
        }
        flash
            .optcr()
            .modify(|_, w| w.bor_lev().set(BROWN_OUT_LEVEL_3));
        flash.optcr().modify(|_, w| w.optstrt().set_bit());
        while flash.sr().read().bsy().bit_is_set() {}
        flash.optcr().modify(|_, w| w.optlock().set_bit());
    }
}

/// Whether the supply is low.
#[expect(
    unsafe_code,
    reason = "whoever owns the detector, its state may be read"
)]
pub fn is_low() -> bool {
    // SAFETY: a state is only read.
    let power = unsafe { PWR::steal() };
    power.csr().read().pvdo().bit_is_set()
}

/// Takes notice of a supply that fell.
#[expect(
    unsafe_code,
    reason = "the interrupt of one line of a register that others share"
)]
pub fn fell() {
    events::raise(events::SUPPLY);
    // SAFETY: a one clears this line's flag, the zeros beside it change nothing.
    let exti = unsafe { EXTI::steal() };
    exti.pr().write(|w| w.pr(LINE).clear());
    // The write is posted: read back, it has taken effect before the return, and the interrupt does not come again.
    let _ = exti.pr().read();
}
