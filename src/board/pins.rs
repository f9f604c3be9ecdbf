//! Which pin does what.

use stm32f4xx_hal::gpio::{Input, PD5, PD6, PD15, PinState, Pull};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Config, Rcc};

use super::{HSE_HZ, Ports, RESET_SHIFT};

/// Set/reset register of the port with the bridge's enable pins, GPIOC.
pub const ENABLE_BSRR: u32 = 0x4002_0818;
/// What takes the enable pins, PC8 and PC9, low.
pub const ENABLE_OFF: u32 = ((1 << 8) | (1 << 9)) << RESET_SHIFT;

/// Input of ADC1 with the Hall sensor, PB1.
pub const HALL_CHANNEL: u8 = 9;
/// Input of ADC3 with the motor current, PA3.
pub const CURRENT_CHANNEL: u8 = 3;

/// nFAULT of the bridge.
pub type FaultPin = PD15<Input>;

/// What drives the clocks: a crystal.
pub fn oscillator() -> Config {
    Config::hse(HSE_HZ.Hz())
}

/// The pins that something still has to take.
pub struct Pins {
    pub fault: FaultPin,
    pub serial: (PD5, PD6),
}

impl Pins {
    /// Gives every pin its function; the bridge stays off.
    pub fn new(ports: Ports, rcc: &mut Rcc) -> Self {
        let a = ports.a.split(rcc);
        let b = ports.b.split(rcc);
        let c = ports.c.split(rcc);
        let d = ports.d.split(rcc);

        // Bridge: enable is low before it becomes an output; nSLEEP is high, so that faults are reported.
        c.pc8.into_push_pull_output_in_state(PinState::Low);
        c.pc9.into_push_pull_output_in_state(PinState::Low);
        c.pc6.into_alternate::<3>();
        c.pc7.into_alternate::<3>();
        d.pd14.into_push_pull_output_in_state(PinState::High);

        // Encoder on TIM5.
        a.pa0.into_alternate::<2>().set_internal_resistor(Pull::Up);
        a.pa1.into_alternate::<2>().set_internal_resistor(Pull::Up);

        a.pa3.into_analog();
        b.pb1.into_analog();

        Self {
            fault: d.pd15.into_pull_up_input(),
            serial: (d.pd5, d.pd6),
        }
    }
}
