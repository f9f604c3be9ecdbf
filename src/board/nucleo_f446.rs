//! NUCLEO-F446RE with an H-bridge shield: STM32F446RE, 8 MHz from the debugger's clock output, serial port through
//! the debugger's USB.
//!
//! The shield carries the paddle board's analogue part: current amplifier, Hall divider, and its 2.5 V reference on
//! the analogue supply.

use stm32f4xx_hal::gpio::{Input, PA2, PA3, PC12, PinState, Pull};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Config, Rcc};

use super::{HSE_HZ, Ports, RESET_SHIFT};

/// Set/reset register of the port with the bridge's enable pins, GPIOC.
pub const ENABLE_BSRR: u32 = 0x4002_0818;
/// What takes the enable pins, PC8 and PC9, low.
pub const ENABLE_OFF: u32 = ((1 << 8) | (1 << 9)) << RESET_SHIFT;

/// Input of ADC1 with the Hall sensor, PA4.
pub const HALL_CHANNEL: u8 = 4;
/// Input of ADC3 with the motor current, PC0.
pub const CURRENT_CHANNEL: u8 = 10;

/// nFAULT of the bridge.
pub type FaultPin = PC12<Input>;

/// What drives the clocks: the debugger's clock output.
pub fn oscillator() -> Config {
    Config::hse(HSE_HZ.Hz()).bypass_hse_oscillator()
}

/// The pins that something still has to take.
pub struct Pins {
    pub fault: FaultPin,
    pub serial: (PA2, PA3),
}

impl Pins {
    /// Gives every pin its function; the bridge stays off.
    pub fn new(ports: Ports, rcc: &mut Rcc) -> Self {
        let a = ports.a.split(rcc);
        let c = ports.c.split(rcc);

        // Bridge: enable is low before it becomes an output; nSLEEP is high, so that faults are reported.
        c.pc8.into_push_pull_output_in_state(PinState::Low);
        c.pc9.into_push_pull_output_in_state(PinState::Low);
        c.pc6.into_alternate::<3>();
        c.pc7.into_alternate::<3>();
        c.pc11.into_push_pull_output_in_state(PinState::High);

        // Encoder on TIM5.
        a.pa0.into_alternate::<2>().set_internal_resistor(Pull::Up);
        a.pa1.into_alternate::<2>().set_internal_resistor(Pull::Up);

        a.pa4.into_analog();
        c.pc0.into_analog();

        Self {
            fault: c.pc12.into_pull_up_input(),
            serial: (a.pa2, a.pa3),
        }
    }
}
