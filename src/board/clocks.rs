//! The clock tree, driven by the crystal if it starts, and the clock that measures the control periods.

use core::sync::atomic::{AtomicU32, Ordering};

use stm32f4xx_hal::pac::TIM2;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Config, Enable, Rcc};

/// Frequency of the internal oscillator, which drives everything after a reset, Hz.
const HSI_HZ: u32 = 16_000_000;
const HSE_HZ: u32 = 8_000_000;
pub const SYSCLK_HZ: u32 = 168_000_000;
pub const PCLK1_HZ: u32 = SYSCLK_HZ / 4;
pub const PCLK2_HZ: u32 = SYSCLK_HZ / 2;

/// Longest wait for the crystal, ms. It typically starts within 2 ms (data sheet).
const CRYSTAL_MS: u32 = 50;

/// Source of the clocks.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Oscillator {
    /// The crystal, supervised by the clock security system. If it stops, hardware turns the outputs of the timer off, and
    /// the non-maskable interrupt drives the bridge enables low.
    Crystal,
    /// The internal oscillator. Its error is at most 1 % at room temperature, which is sufficient for the console.
    Internal,
}

/// Starts all clocks at their full rates, from the crystal if it starts in time.
pub fn start(mut rcc: Rcc) -> (Rcc, Oscillator) {
    let oscillator = start_crystal(&mut rcc);
    let source = match oscillator {
        Oscillator::Crystal => Config::hse(HSE_HZ.Hz()),
        Oscillator::Internal => Config::hsi(),
    };
    let rcc = rcc.freeze(
        source
            .sysclk(SYSCLK_HZ.Hz())
            .hclk(SYSCLK_HZ.Hz())
            .pclk1(PCLK1_HZ.Hz())
            .pclk2(PCLK2_HZ.Hz()),
    );
    if oscillator == Oscillator::Crystal {
        rcc.cr().modify(|_, w| w.csson().set_bit());
    }
    (rcc, oscillator)
}

fn start_crystal(rcc: &mut Rcc) -> Oscillator {
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    for _ in 0..CRYSTAL_MS {
        if rcc.cr().read().hserdy().bit_is_set() {
            return Oscillator::Crystal;
        }
        cortex_m::asm::delay(HSI_HZ / 1000);
    }
    rcc.cr().modify(|_, w| w.hseon().clear_bit());
    Oscillator::Internal
}

/// Waits, measured by TIM2.
#[expect(unsafe_code, reason = "interrupts above the control loop wait too")]
pub fn wait_us(us: u32) {
    // SAFETY: the counter is only read.
    let timer = unsafe { TIM2::steal() };
    let from = timer.cnt().read().bits();
    while timer.cnt().read().bits().wrapping_sub(from) < 2 * PCLK1_HZ / 1_000_000 * us {}
}

/// Count of TIM2 at the start of the last control interrupt.
static BEGAN: AtomicU32 = AtomicU32::new(0);

/// Time since the start of the last control interrupt, s.
#[expect(unsafe_code, reason = "tasks below the control loop ask too")]
pub fn since_control_began_s() -> f32 {
    // SAFETY: the counter is only read.
    let timer = unsafe { TIM2::steal() };
    let now = timer.cnt().read().bits();
    now.wrapping_sub(BEGAN.load(Ordering::Relaxed)) as f32 * (1.0 / (2 * PCLK1_HZ) as f32)
}

/// Measures the control periods with TIM2. A debugger does not stop TIM2, so a halt of the core is detected.
pub struct PeriodClock {
    timer: TIM2,
}

impl PeriodClock {
    /// Clocks of TIM2 per control period.
    const PERIOD: u32 = 2 * PCLK1_HZ / super::CONTROL_HZ;

    /// Starts the measurement.
    pub fn new(timer: TIM2, rcc: &mut Rcc) -> Self {
        TIM2::enable(rcc);
        timer.arr().write(|w| w.set(u32::MAX));
        timer.cr1().write(|w| w.cen().enabled());
        Self { timer }
    }

    /// Sets the start of a period to this instant.
    pub fn restart(&mut self) {
        BEGAN.store(self.timer.cnt().read().bits(), Ordering::Relaxed);
    }

    /// Number of whole periods since the last call. It is 1 if no period was missed.
    #[inline]
    pub fn periods(&mut self) -> u32 {
        let now = self.timer.cnt().read().bits();
        let since = now.wrapping_sub(BEGAN.load(Ordering::Relaxed));
        BEGAN.store(now, Ordering::Relaxed);
        if since < Self::PERIOD + Self::PERIOD / 2 {
            1
        } else {
            since.saturating_add(Self::PERIOD / 2) / Self::PERIOD
        }
    }
}
