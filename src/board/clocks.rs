//! The clocks, from the crystal if it starts, and the time of the control periods by a clock of its own.

use core::sync::atomic::{AtomicU32, Ordering};

use stm32f4xx_hal::pac::TIM2;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Config, Enable, Rcc};

/// After a reset the internal oscillator drives everything.
const HSI_HZ: u32 = 16_000_000;
const HSE_HZ: u32 = 8_000_000;
pub const SYSCLK_HZ: u32 = 168_000_000;
pub const PCLK1_HZ: u32 = SYSCLK_HZ / 4;
pub const PCLK2_HZ: u32 = SYSCLK_HZ / 2;

/// Longest wait for the crystal, ms; it starts within 2 ms (data sheet, typical).
const CRYSTAL_MS: u32 = 50;

/// What drives the clocks.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Oscillator {
    /// The crystal, watched: should it stop, the timer's outputs go off by hardware, and the non-maskable interrupt
    /// takes the bridge's enables low.
    Crystal,
    /// The internal one, 1 % off at most at room temperature: good enough for a console that says so.
    Internal,
}

/// Starts all clocks at their full rates, by the crystal if it starts in time.
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

/// Waits, by the clock of the control periods.
#[expect(unsafe_code, reason = "interrupts above the control loop wait too")]
pub fn wait_us(us: u32) {
    // SAFETY: a counter is only read.
    let timer = unsafe { TIM2::steal() };
    let from = timer.cnt().read().bits();
    while timer.cnt().read().bits().wrapping_sub(from) < 2 * PCLK1_HZ / 1_000_000 * us {}
}

/// When the control interrupt began last, by TIM2.
static BEGAN: AtomicU32 = AtomicU32::new(0);

/// Since then, s.
#[expect(unsafe_code, reason = "tasks below the control loop ask too")]
pub fn since_control_began_s() -> f32 {
    // SAFETY: a counter is only read.
    let timer = unsafe { TIM2::steal() };
    let now = timer.cnt().read().bits();
    now.wrapping_sub(BEGAN.load(Ordering::Relaxed)) as f32 * (1.0 / (2 * PCLK1_HZ) as f32)
}

/// Measures the control periods with TIM2, which no debugger's halt stops, so that a halt shows.
pub struct PeriodClock {
    timer: TIM2,
}

impl PeriodClock {
    /// Clocks of TIM2 in a control period.
    const PERIOD: u32 = 2 * PCLK1_HZ / super::CONTROL_HZ;

    /// A clock that begins now.
    pub fn new(timer: TIM2, rcc: &mut Rcc) -> Self {
        TIM2::enable(rcc);
        timer.arr().write(|w| w.set(u32::MAX));
        timer.cr1().write(|w| w.cen().enabled());
        Self { timer }
    }

    /// Takes this moment for the beginning of a period.
    pub fn restart(&mut self) {
        BEGAN.store(self.timer.cnt().read().bits(), Ordering::Relaxed);
    }

    /// Whole periods since the last call; 1 if none was missed.
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
