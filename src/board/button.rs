//! The stop button, with its own interrupt.

use stm32f4xx_hal::gpio::ExtiPin;

use super::events;
use super::pins::ButtonPin;

/// The button. Its interrupt owns it.
pub struct Button {
    pin: ButtonPin,
    /// Level of the released button. It differs between boards, so it is the level at boot.
    idle_high: bool,
}

impl Button {
    /// Sets up the interrupt. The button must not be pressed now. If it is pressed, its release stops the paddle.
    pub fn new(pin: ButtonPin) -> Self {
        Self {
            idle_high: pin.is_high(),
            pin,
        }
    }

    /// Acknowledges an edge and reports it to the control loop if the button is pressed.
    pub fn take_notice(&mut self) {
        self.pin.clear_interrupt_pending_bit();
        if self.pin.is_high() != self.idle_high {
            super::bridge_off();
            events::raise(events::BUTTON);
        }
        // The write is buffered. Reading it back ensures that it takes effect before the return.
        let _ = self.pin.check_interrupt();
    }
}
