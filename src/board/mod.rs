//! The lab's paddle board: STM32F407VG, 8 MHz crystal, 24 V motor supply, converter reference 2.5 V.
//!
//! What the app needs of it, a file for each thing behind the pins.

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

/// Control periods a second.
pub const CONTROL_HZ: u32 = bridge::TIMER_HZ / bridge::CLOCKS_PER_PERIOD;

/// Main RAM, as `memory.x` has it.
pub const RAM: Range<usize> = 0x2000_0000..0x2002_0000;

/// Ports that the board has its pins on.
pub struct Ports {
    a: pac::GPIOA,
    b: pac::GPIOB,
    c: pac::GPIOC,
    d: pac::GPIOD,
    e: pac::GPIOE,
}

/// A board that is set up: sensors converting, timer running, bridge off.
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

/// Nominal time to reset during the boot, ms: longer than a crystal may take and the option bytes do, even with the
/// fastest oscillator behind the watchdog.
const BOOT_WATCHDOG_MS: u32 = 2000;

impl Board {
    /// Sets the board up: pins first, the watchdog next, and what may fail to start after them.
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

/// All that is measured.
pub struct Sensors {
    encoder: Encoder,
    converters: Converters,
}

impl Sensors {
    /// The current alone, in counts, for the calibration of its offset; a place where a debugger can stop.
    #[inline(never)]
    pub fn current_counts(&self) -> f32 {
        self.converters.current_counts()
    }

    /// Stops the ring of the current's samples.
    pub fn stop(&self) {
        self.converters.stop();
    }

    /// Begins it anew, in step with the control periods; to be called within 1.9 us of the beginning of one, before its
    /// first sample has arrived.
    pub fn go_on(&self) {
        self.converters.go_on();
    }

    /// What the control loop gets to see of this period.
    #[inline]
    pub fn read(&mut self) -> Measurement {
        Measurement {
            encoder_count: self.encoder.count(),
            current_adc: self.converters.current_counts(),
            hall_adc: self.converters.hall_counts(),
        }
    }
}

/// Takes the bridge's enable pins low, from any context.
#[expect(
    unsafe_code,
    reason = "the way that must work from a panic, whoever owns the pins"
)]
pub fn bridge_off() {
    // SAFETY: a set/reset register acts on the named pins only, in one write.
    unsafe { (ENABLE_BSRR as *mut u32).write_volatile(ENABLE_OFF) }
}

/// Lets the bridge drive the motor.
#[expect(
    unsafe_code,
    reason = "the counterpart of `bridge_off`, in the same register"
)]
fn bridge_on() {
    // SAFETY: as for `bridge_off`.
    unsafe { (ENABLE_BSRR as *mut u32).write_volatile(ENABLE_OFF >> RESET_SHIFT) }
}

/// In a GPIO set/reset register the upper half resets what the lower half sets.
const RESET_SHIFT: u32 = 16;

/// A processor that a debugger halts must neither leave the motor on nor be reset, and one that sleeps must answer.
/// With its counter held, TIM8 drives the bridge's inputs to their idle state (RM0090, sections 17.3.20 and 38.16).
fn stop_with_the_debugger(dbgmcu: &pac::DBGMCU, watchdog: &IndependentWatchdog) {
    dbgmcu.apb2_fz().modify(|_, w| w.dbg_tim8_stop().set_bit());
    dbgmcu.apb1_fz().modify(|_, w| w.dbg_tim3_stop().set_bit());
    dbgmcu.cr().modify(|_, w| w.dbg_sleep().set_bit());
    watchdog.stop_on_debug(dbgmcu, true);
}
