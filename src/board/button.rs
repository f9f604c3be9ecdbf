//! The button, which stops everything, by an interrupt of its own.

use stm32f4xx_hal::gpio::ExtiPin;

use super::events;
use super::pins::ButtonPin;

/// The button; its interrupt owns it.
pub struct Button {
    pin: ButtonPin,
    /// Which level is the pressed one is not known of every board: it is the other one than at boot.
    idle_high: bool,
}

impl Button {
    /// A button that nobody presses now, whose interrupt is set up. One that somebody does stops when it is let go.
    pub fn new(pin: ButtonPin) -> Self {
        Self {
            idle_high: pin.is_high(),
            pin,
        }
    }

    /// Takes notice of an edge, and tells the control loop if the button is pressed.
    pub fn take_notice(&mut self) {
        self.pin.clear_interrupt_pending_bit();
        if self.pin.is_high() != self.idle_high {
            super::bridge_off();
            events::raise(events::BUTTON);
        }
        // The write is posted: read back, it has taken effect before the return.
        let _ = self.pin.check_interrupt();
    }
}
