//! The pins that the board uses, and the peripheral that each is assigned to.

use super::Chip;
use crate::cpu::Signals;
use crate::peripherals::gpio::Mode;
use crate::peripherals::rcc::Clocks;
use crate::peripherals::tim8::Output;

/// A pin: port, counted from A, and number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pin(pub usize, pub usize);

/// Port numbers.
pub(super) const PORT_A: usize = 0;
pub(super) const PORT_B: usize = 1;
pub(super) const PORT_C: usize = 2;
const PORT_D: usize = 3;

/// Numbers of alternate functions.
const AF_TIM5: Mode = Mode::Alternate(2);
const AF_TIM8: Mode = Mode::Alternate(3);
pub(super) const AF_USART2: Mode = Mode::Alternate(7);

/// Pins of TIM8's first two channels, TIM5's inputs, and USART2.
const TIM8_PINS: [Pin; 2] = [Pin(PORT_C, 6), Pin(PORT_C, 7)];
const TIM5_PINS: [Pin; 2] = [Pin(PORT_A, 0), Pin(PORT_A, 1)];
pub(super) const USART2_TX: Pin = Pin(PORT_D, 5);
pub(super) const USART2_RX: Pin = Pin(PORT_D, 6);

/// Offset of the counter of TIM5.
const TIM5_CNT: u32 = 0x24;

impl Chip {
    /// Fraction of time, 0 to 1, for which each bridge input is high. `None` if nothing drives or pulls it.
    pub fn half_bridges(&self) -> [Option<f64>; 2] {
        std::array::from_fn(|channel| {
            let pin = TIM8_PINS[channel];
            match (self.mode(pin), self.tim8.output(channel)) {
                (Mode::Alternate(_), Output::High(share)) if self.mode(pin) == AF_TIM8 => {
                    Some(share)
                }
                _ => self.settled(pin).map(|high| f64::from(u8::from(high))),
            }
        })
    }

    /// Shortest low time of a bridge input in a PWM period, s. The edge time is subtracted.
    pub fn shortest_low_s(&self) -> f64 {
        let period_s = self.tim8.pwm_cycles() as f64 / self.clock.hz();
        let lows = self.half_bridges().into_iter().zip(TIM8_PINS);
        lows.map(|(share, Pin(port, pin))| {
            (1.0 - share.unwrap_or(1.0)) * period_s - self.gpio[port].edge_s(pin)
        })
        .fold(f64::INFINITY, f64::min)
    }

    /// Level to which the program drives or pulls a pin. `None` if it floats.
    pub fn settled(&self, Pin(port, pin): Pin) -> Option<bool> {
        self.gpio[port].driven(pin).or(self.gpio[port].pull(pin))
    }

    /// Level to which the program drives a pin. `None` if it does not drive it.
    pub fn driven(&self, Pin(port, pin): Pin) -> Option<bool> {
        self.gpio[port].driven(pin)
    }

    pub(super) fn mode(&self, Pin(port, pin): Pin) -> Mode {
        self.gpio[port].mode(pin)
    }

    /// Connects a pin to an external level. An edge can raise an interrupt.
    pub fn connect(&mut self, Pin(port, pin): Pin, level: Option<bool>, signals: &mut Signals) {
        let before = self.gpio[port].level(pin);
        self.gpio[port].connect(pin, level);
        let after = self.gpio[port].level(pin);
        self.edge(port, pin, before, after);
        self.show_exti(signals);
    }

    pub(super) fn edge(&mut self, port: usize, pin: usize, before: bool, after: bool) {
        if before != after && self.syscfg.port_of_line(pin) == port {
            self.exti.edge(pin, after);
        }
    }

    /// The encoder has moved by `counts` within `cycles`.
    pub fn follow_encoder(&mut self, counts: i32, cycles: u64) {
        if TIM5_PINS.iter().all(|pin| self.mode(*pin) == AF_TIM5) {
            let divider = Clocks::timer_divider(self.clocks.apb1_divider);
            self.tim5.follow(counts, cycles / u64::from(divider));
        }
    }

    /// The present count of the encoder timer.
    pub fn encoder_count(&self) -> u32 {
        self.tim5.read(TIM5_CNT).unwrap_or_default()
    }
}
