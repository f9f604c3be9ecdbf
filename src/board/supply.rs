//! Supervision of the 3.3 V supply of the chip. A voltage dip turns the bridge off.

use stm32f4xx_hal::pac::{EXTI, FLASH, PWR};
use stm32f4xx_hal::rcc::{Enable, Rcc};

use super::events;

/// Level of the voltage detector (PLS): 2.85 to 2.99 V falling, at most 3.10 V rising (data sheet, embedded reset and power
/// control block characteristics). It is above the brown-out level 3 of 2.75 to 2.88 V.
const DETECTOR_LEVEL: u8 = 0b110;
/// Brown-out level 3 in the option bytes, as a number. The names in the register crate are in the wrong order (RM0090,
/// section 3.9.6: 00 is level 3 and 11 is off. ST's own OB_BOR_LEVEL3 = 0x00 and OB_BOR_OFF = 0x0C agree).
const BROWN_OUT_LEVEL_3: u8 = 0b00;
/// Time for which the supply must be good before the option bytes are written, in core clocks at 16 MHz.
const SOUND_CLOCKS: u32 = 16_000_000 / 10;
/// External interrupt line of the voltage detector (RM0090, section 12.2.5).
const LINE: u8 = 16;

/// The supply. The control loop owns it.
pub struct Supply;

impl Supply {
    /// Starts the supervision of the supply.
    pub fn new(power: PWR, exti: &mut EXTI, rcc: &mut Rcc) -> Self {
        PWR::enable(rcc);
        exti.rtsr().modify(|_, w| w.tr(LINE).set_bit());
        exti.imr().modify(|_, w| w.mr(LINE).set_bit());
        power
            .cr()
            .modify(|_, w| w.pls().set(DETECTOR_LEVEL).pvde().set_bit());
        Self
    }

    /// Returns true if the supply is low.
    pub fn is_low(&self) -> bool {
        is_low()
    }

    /// Sets the brown-out level, so that the chip is held in reset below 2.83 V from the next power-on. With the factory
    /// setting it runs down to 1.7 V, which is too low for 168 MHz. The option bytes are written once in the life of the
    /// chip. A loss of the supply during that quarter of a second may corrupt them.
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

/// Returns true if the supply is low.
#[expect(
    unsafe_code,
    reason = "whoever owns the detector, its state may be read"
)]
pub fn is_low() -> bool {
    // SAFETY: the status is only read.
    let power = unsafe { PWR::steal() };
    power.csr().read().pvdo().bit_is_set()
}

/// Acknowledges a drop of the supply.
#[expect(
    unsafe_code,
    reason = "the interrupt of one line of a register that others share"
)]
pub fn fell() {
    events::raise(events::SUPPLY);
    // SAFETY: writing one clears the flag of this line. Writing zeros to the others has no effect.
    let exti = unsafe { EXTI::steal() };
    exti.pr().write(|w| w.pr(LINE).clear());
    // The write is buffered. Reading it back ensures that it takes effect before the return. Otherwise the interrupt would
    // occur again.
    let _ = exti.pr().read();
}
