//! Assignment of the pins.
#![expect(unsafe_code, reason = "before there is a memory to rely on")]

use stm32f4xx_hal::gpio::{Input, PD5, PD6, PD15, PE2, PinState, Pull, Speed};
use stm32f4xx_hal::pac::GPIOD;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;

use super::{Ports, RESET_SHIFT};

/// Address of the set/reset register of the port with the bridge's enable pins, GPIOC.
pub const ENABLE_BSRR: u32 = 0x4002_0818;
/// Value that drives the enable pins, PC8 and PC9, low.
pub const ENABLE_OFF: u32 = ((1 << 8) | (1 << 9)) << RESET_SHIFT;

/// Channel of ADC1 with the Hall sensor, PB1.
pub const HALL_CHANNEL: u8 = 9;
/// Channel of ADC3 with the motor current, PA3.
pub const CURRENT_CHANNEL: u8 = 3;

/// nFAULT of the bridge.
type FaultPin = PD15<Input>;
/// The button.
pub type ButtonPin = PE2<Input>;

/// Returns true if the bridge pulls nFAULT, PD15, low.
#[inline]
pub fn bridge_reports_fault() -> bool {
    // SAFETY: the level of a pin is only read.
    let port = unsafe { GPIOD::steal() };
    port.idr().read().idr15().bit_is_clear()
}

/// The first instructions after a reset, before any memory is initialised. They drive the bridge's enable pins, PC8 and PC9,
/// low, which float until then. They pull its inputs, PC6 and PC7, down.
#[unsafe(naked)]
#[unsafe(no_mangle)]
extern "C" fn __pre_init() {
    const RCC_AHB1ENR: u32 = 0x4002_3830;
    const GPIOC_CLOCK: u32 = 1 << 2;
    const GPIOC: u32 = 0x4002_0800;
    const OUTPUTS: u32 = 0b01 << 16 | 0b01 << 18;
    const PULLED_DOWN: u32 = 0b10 << 12 | 0b10 << 14;
    core::arch::naked_asm!(
        "movw r0, #{clocks_low}",
        "movt r0, #{clocks_high}",
        "ldr r1, [r0]",
        "orr r1, r1, #{port}",
        "str r1, [r0]",
        // The peripheral clock is available after two cycles (erratum: delay after an RCC peripheral clock enabling).
        "ldr r1, [r0]",
        "dsb",
        "movw r0, #{gpio_low}",
        "movt r0, #{gpio_high}",
        "mov.w r1, #{outputs}",
        "str r1, [r0]",
        "movw r1, #{pulled_down}",
        "str r1, [r0, #0x0C]",
        "bx lr",
        clocks_low = const RCC_AHB1ENR & 0xFFFF,
        clocks_high = const RCC_AHB1ENR >> 16,
        port = const GPIOC_CLOCK,
        gpio_low = const GPIOC & 0xFFFF,
        gpio_high = const GPIOC >> 16,
        outputs = const OUTPUTS,
        pulled_down = const PULLED_DOWN,
    )
}

/// The pins of the serial port: output and input.
pub type SerialPins = (PD5, PD6);

/// The pins that other drivers still have to take.
pub struct Pins {
    pub fault: FaultPin,
    pub button: ButtonPin,
    pub serial: SerialPins,
}

impl Pins {
    /// Gives every pin its function. The bridge stays off.
    pub fn new(ports: Ports, rcc: &mut Rcc) -> Self {
        let a = ports.a.split(rcc);
        let b = ports.b.split(rcc);
        let c = ports.c.split(rcc);
        let d = ports.d.split(rcc);
        let e = ports.e.split(rcc);

        // Bridge: an enable pin is low before it becomes an output. nSLEEP is high, so that the bridge reports faults.
        c.pc8.into_push_pull_output_in_state(PinState::Low);
        c.pc9.into_push_pull_output_in_state(PinState::Low);
        // The bridge inputs are low whenever the timer does not drive them. Their edges take 20 ns instead of 100, a
        // thirtieth of the shortest charging time of the bootstrap.
        let mut inputs = (c.pc6.into_alternate::<3>(), c.pc7.into_alternate::<3>());
        inputs.0.set_internal_resistor(Pull::Down);
        inputs.1.set_internal_resistor(Pull::Down);
        inputs.0.set_speed(Speed::Medium);
        inputs.1.set_speed(Speed::Medium);
        d.pd14.into_push_pull_output_in_state(PinState::High);

        // Encoder inputs of TIM5.
        a.pa0.into_alternate::<2>().set_internal_resistor(Pull::Up);
        a.pa1.into_alternate::<2>().set_internal_resistor(Pull::Up);

        a.pa3.into_analog();
        b.pb1.into_analog();

        Self {
            fault: d.pd15.into_pull_up_input(),
            button: e.pe2.into_pull_up_input(),
            // The pull-up keeps an unconnected input from picking up motor noise.
            serial: (d.pd5, d.pd6.internal_resistor(Pull::Up)),
        }
    }
}
