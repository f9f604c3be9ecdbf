//! The encoder, counted by TIM5 with 32 bits.

use stm32f4xx_hal::pac::TIM5;
use stm32f4xx_hal::rcc::{Enable, Rcc};

/// The counter of the encoder.
pub struct Encoder(TIM5);

impl Encoder {
    /// Sets up the counter, starting at 0.
    pub fn new(timer: TIM5, rcc: &mut Rcc) -> Self {
        TIM5::enable(rcc);
        timer.arr().write(|w| w.set(u32::MAX));
        // Input filter: a level counts after 6 equal samples at an eighth of the clock, 0.6 us. At a paddle speed of 1500
        // degrees per second the edges of one channel are 16 us apart.
        timer.ccmr1_input().write(|w| {
            w.cc1s().ti1();
            w.ic1f().fdts_div8_n6();
            w.cc2s().ti2();
            w.ic2f().fdts_div8_n6()
        });
        timer.smcr().write(|w| w.sms().encoder_mode_3());
        timer.cr1().write(|w| w.cen().enabled());
        Self(timer)
    }

    /// The count. Each period of a channel has four counts.
    #[inline]
    pub fn count(&self) -> u32 {
        self.0.cnt().read().bits()
    }
}
