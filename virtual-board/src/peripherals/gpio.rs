//! General-purpose pins.

use super::{Answer, Lack, bit, field};

/// Number of pins of a port.
pub const PINS: usize = 16;

const MODER: u32 = 0x00;
const OTYPER: u32 = 0x04;
const OSPEEDR: u32 = 0x08;
const PUPDR: u32 = 0x0C;
const IDR: u32 = 0x10;
const ODR: u32 = 0x14;
const BSRR: u32 = 0x18;
const LCKR: u32 = 0x1C;
const AFRL: u32 = 0x20;
const AFRH: u32 = 0x24;

/// Function of a pin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Input of the program.
    Input,
    /// Output of the program.
    Output,
    /// Assigned to the peripheral with this alternate function number.
    Alternate(u8),
    /// Analog input.
    Analog,
}

/// One port.
#[derive(Debug, Clone)]
pub struct Gpio {
    moder: u32,
    otyper: u32,
    ospeedr: u32,
    pupdr: u32,
    odr: u32,
    afr: [u32; 2],
    /// External level of each pin. `None` if nothing is connected.
    outside: [Option<bool>; PINS],
}

impl Gpio {
    /// The port number `port`, counted from A, after a reset.
    pub fn reset(port: usize) -> Self {
        // The debug pins of ports A and B keep their function.
        let (moder, ospeedr, pupdr) = match port {
            0 => (0xA800_0000, 0x0C00_0000, 0x6400_0000),
            1 => (0x0000_0280, 0x0000_00C0, 0x0000_0100),
            _ => (0, 0, 0),
        };
        Self {
            moder,
            otyper: 0,
            ospeedr,
            pupdr,
            odr: 0,
            afr: [0; 2],
            outside: [None; PINS],
        }
    }

    /// Resets the registers. External connections are kept.
    pub fn reset_registers(&mut self, port: usize) {
        let outside = self.outside;
        *self = Self::reset(port);
        self.outside = outside;
    }

    /// Reads a register.
    pub fn read(&self, offset: u32) -> Answer<u32> {
        Ok(match offset {
            MODER => self.moder,
            OTYPER => self.otyper,
            OSPEEDR => self.ospeedr,
            PUPDR => self.pupdr,
            IDR => (0..PINS).fold(0, |levels, pin| levels | u32::from(self.level(pin)) << pin),
            ODR => self.odr,
            AFRL | AFRH => self.afr[(offset - AFRL) as usize / 4],
            _ => return Err(Lack::Register),
        })
    }

    /// Writes a register.
    pub fn write(&mut self, offset: u32, value: u32) -> Answer {
        match offset {
            MODER => self.moder = value,
            OTYPER => self.otyper = value & 0xFFFF,
            OSPEEDR => self.ospeedr = value,
            PUPDR => self.pupdr = value,
            ODR => self.odr = value & 0xFFFF,
            // If a pin is both set and reset, it is set.
            BSRR => self.odr = self.odr & !(value >> 16) | value & 0xFFFF,
            LCKR => return Err(Lack::Use("locking of pins")),
            AFRL | AFRH => self.afr[(offset - AFRL) as usize / 4] = value,
            _ => return Err(Lack::Register),
        }
        Ok(())
    }

    /// Function of `pin`.
    pub fn mode(&self, pin: usize) -> Mode {
        match field(self.moder, 2 * pin as u32, 2) {
            0 => Mode::Input,
            1 => Mode::Output,
            2 => Mode::Alternate(field(self.afr[pin / 8], 4 * (pin as u32 % 8), 4) as u8),
            _ => Mode::Analog,
        }
    }

    /// Level to which the program drives `pin`. `None` if it does not drive it.
    pub fn driven(&self, pin: usize) -> Option<bool> {
        let high = bit(self.odr, pin as u32);
        let open = bit(self.otyper, pin as u32) && high;
        (self.mode(pin) == Mode::Output && !open).then_some(high)
    }

    /// Edge time of `pin`, s, by its speed setting (data sheet, I/O AC characteristics, 50 pF).
    pub fn edge_s(&self, pin: usize) -> f64 {
        [100e-9, 20e-9, 10e-9, 6e-9][field(self.ospeedr, 2 * pin as u32, 2) as usize]
    }

    /// Level to which the internal resistor pulls `pin`. `None` without one.
    pub fn pull(&self, pin: usize) -> Option<bool> {
        match field(self.pupdr, 2 * pin as u32, 2) {
            0b01 => Some(true),
            0b10 => Some(false),
            _ => None,
        }
    }

    /// Level of `pin` in the input register. A floating pin and an analog pin read 0.
    pub fn level(&self, pin: usize) -> bool {
        if self.mode(pin) == Mode::Analog {
            return false;
        }
        let pulled_up = self.pull(pin) == Some(true);
        self.driven(pin).or(self.outside[pin]).unwrap_or(pulled_up)
    }

    /// Connects `pin` to an external level, or disconnects it.
    pub fn connect(&mut self, pin: usize, level: Option<bool>) {
        self.outside[pin] = level;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn set_wins_over_reset() {
        let mut port = Gpio::reset(2);
        port.write(BSRR, 1 << 8 | 1 << (8 + 16) | 1 << 9).unwrap();
        assert_eq!(port.read(ODR).unwrap(), 1 << 8 | 1 << 9);
        port.write(BSRR, 1 << (9 + 16)).unwrap();
        assert_eq!(port.read(ODR).unwrap(), 1 << 8);
    }

    #[test]
    fn an_input_follows_the_external_level_or_its_pull_resistor() {
        let mut port = Gpio::reset(3);
        assert!(!port.level(15));
        port.write(PUPDR, 0b01 << 30).unwrap();
        assert!(port.level(15));
        port.connect(15, Some(false));
        assert_eq!(port.read(IDR).unwrap() >> 15, 0);
    }

    #[test]
    fn an_open_drain_output_only_pulls_low() {
        let mut port = Gpio::reset(3);
        port.write(MODER, 0b01).unwrap();
        port.write(OTYPER, 1).unwrap();
        port.write(ODR, 1).unwrap();
        assert_eq!(port.driven(0), None);
        port.write(ODR, 0).unwrap();
        assert_eq!(port.driven(0), Some(false));
    }

    #[test]
    fn a_pin_reports_its_alternate_function_number() {
        let mut port = Gpio::reset(2);
        port.write(MODER, 0b10 << 12).unwrap();
        port.write(AFRL, 3 << 24).unwrap();
        assert_eq!(port.mode(6), Mode::Alternate(3));
    }
}
