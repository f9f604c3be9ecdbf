//! The lab's paddle board: STM32F407VG, 8 MHz crystal, 24 V motor supply, converter reference 2.5 V.
//!
//! Each file provides one device behind the pins to the app.

mod bridge;
mod button;
mod clocks;
mod converters;
mod encoder;
pub mod events;
mod pins;
pub mod serial;
mod settings_flash;
mod supply;

use core::ops::Range;

use haptic_paddle::controller::Measurement;
use stm32f4xx_hal::gpio::{Edge, ExtiPin, PinExt};
use stm32f4xx_hal::pac;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::watchdog::IndependentWatchdog;

pub use bridge::{Bridge, FaultLine, wait_for_next_period};
pub use button::Button;
pub use clocks::{Oscillator, PeriodClock, since_control_began_s};
use clocks::{PCLK2_HZ, SYSCLK_HZ};
use converters::Converters;
pub use converters::{PERIODS_TO_MEASURE, overrun, sample_current_once};
use encoder::Encoder;
use pins::Pins;
pub use pins::{ENABLE_BSRR, ENABLE_OFF, bridge_reports_fault};
pub use settings_flash::{SECTORS as SETTINGS_SECTORS, SettingsFlash};
pub use supply::Supply;
pub use supply::{fell as supply_fell, is_low as supply_is_low};

/// Control periods per second.
pub const CONTROL_HZ: u32 = bridge::TIMER_HZ / bridge::CLOCKS_PER_PERIOD;

/// Address range of the main RAM, as in `memory.x`.
pub const RAM: Range<usize> = 0x2000_0000..0x2002_0000;

/// The GPIO ports with pins that the board uses.
pub struct Ports {
    a: pac::GPIOA,
    b: pac::GPIOB,
    c: pac::GPIOC,
    d: pac::GPIOD,
    e: pac::GPIOE,
}

/// A board that is set up: the sensors convert, the timer runs, and the bridge is off.
pub struct Board {
    pub bridge: Bridge,
    pub sensors: Sensors,
    pub fault_line: FaultLine,
    pub receiver: serial::Receiver,
    pub transmitter: serial::Transmitter,
    pub watchdog: IndependentWatchdog,
    pub supply: Supply,
    pub button: Button,
    pub periods: PeriodClock,
    pub oscillator: Oscillator,
    pub settings_flash: SettingsFlash,
}

/// Nominal watchdog time during boot, ms. It is longer than the start of the crystal and the programming of the option
/// bytes, even with the fastest watchdog oscillator.
const BOOT_WATCHDOG_MS: u32 = 2000;

impl Board {
    /// Sets up the board: first the pins, then the watchdog, then everything whose start can fail.
    pub fn new(chip: pac::Peripherals) -> Self {
        let mut rcc = chip.RCC.constrain();
        let mut pins = Pins::new(
            Ports {
                a: chip.GPIOA,
                b: chip.GPIOB,
                c: chip.GPIOC,
                d: chip.GPIOD,
                e: chip.GPIOE,
            },
            &mut rcc,
        );
        let mut watchdog = IndependentWatchdog::new(chip.IWDG);
        stop_with_the_debugger(&chip.DBGMCU, &watchdog);
        watchdog.start(BOOT_WATCHDOG_MS.millis());

        let mut exti = chip.EXTI;
        let supply = Supply::new(chip.PWR, &mut exti, &mut rcc);
        supply.hold_in_reset_when_low(&chip.FLASH);
        let (mut rcc, oscillator) = clocks::start(rcc);

        let mut syscfg = chip.SYSCFG.constrain(&mut rcc);
        pins.button.make_interrupt_source(&mut syscfg);
        pins.button.trigger_on_edge(&mut exti, Edge::RisingFalling);
        pins.button.enable_interrupt(&mut exti);
        pins.fault.make_interrupt_source(&mut syscfg);
        pins.fault.trigger_on_edge(&mut exti, Edge::Falling);
        pins.fault.enable_interrupt(&mut exti);
        let fault_line = FaultLine::new(exti, pins.fault.pin_id());

        let bridge = Bridge::new(chip.TIM8, &mut rcc);
        let sensors = Sensors {
            encoder: Encoder::new(chip.TIM5, &mut rcc),
            converters: Converters::new(
                chip.ADC1,
                chip.ADC3,
                &chip.ADC_COMMON,
                chip.DMA2,
                chip.TIM3,
                &mut rcc,
            ),
        };
        sensors.converters.start();
        bridge.start();

        let (receiver, transmitter) = serial::start(chip.USART2, chip.DMA1, pins.serial, &mut rcc);
        Self {
            bridge,
            sensors,
            fault_line,
            receiver,
            transmitter,
            watchdog,
            supply,
            button: Button::new(pins.button),
            periods: PeriodClock::new(chip.TIM2, &mut rcc),
            oscillator,
            settings_flash: SettingsFlash::new(chip.FLASH),
        }
    }
}

/// All sensors.
pub struct Sensors {
    encoder: Encoder,
    converters: Converters,
}

impl Sensors {
    /// The current in counts, for the calibration of its offset. It is not inlined, so that a debugger can set a breakpoint.
    #[inline(never)]
    pub fn current_counts(&self) -> f32 {
        self.converters.current_counts()
    }

    /// Stops the ring of current samples.
    pub fn stop(&self) {
        self.converters.stop();
    }

    /// Restarts the ring, aligned with the control periods. It must be called within 1.9 us of the start of a period, before
    /// its first sample has arrived.
    pub fn go_on(&self) {
        self.converters.go_on();
    }

    /// The measurement of this period for the control loop.
    #[inline]
    pub fn read(&mut self) -> Measurement {
        Measurement {
            encoder_count: self.encoder.count(),
            current_adc: self.converters.current_counts(),
            hall_adc: self.converters.hall_counts(),
        }
    }
}

/// Drives the bridge's enable pins low. It may be called from any context.
#[expect(
    unsafe_code,
    reason = "the way that must work from a panic, whoever owns the pins"
)]
pub fn bridge_off() {
    // SAFETY: one write to a set/reset register affects only the named pins.
    unsafe { (ENABLE_BSRR as *mut u32).write_volatile(ENABLE_OFF) }
}

/// Enables the outputs of the bridge.
#[expect(
    unsafe_code,
    reason = "the counterpart of `bridge_off`, in the same register"
)]
fn bridge_on() {
    // SAFETY: as for `bridge_off`.
    unsafe { (ENABLE_BSRR as *mut u32).write_volatile(ENABLE_OFF >> RESET_SHIFT) }
}

/// In a GPIO set/reset register, the upper half resets the pins that the lower half sets.
const RESET_SHIFT: u32 = 16;

/// While a debugger halts the processor, the motor must be off and the watchdog must not reset. The debugger must also reach
/// a sleeping processor. TIM8 stops with the core and then drives the bridge inputs to their idle state (RM0090, sections
/// 17.3.20 and 38.16).
fn stop_with_the_debugger(dbgmcu: &pac::DBGMCU, watchdog: &IndependentWatchdog) {
    dbgmcu.apb2_fz().modify(|_, w| w.dbg_tim8_stop().set_bit());
    dbgmcu.apb1_fz().modify(|_, w| w.dbg_tim3_stop().set_bit());
    dbgmcu.cr().modify(|_, w| w.dbg_sleep().set_bit());
    watchdog.stop_on_debug(dbgmcu, true);
}
