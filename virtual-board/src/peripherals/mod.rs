//! The peripherals of the STM32F407 that the paddle's firmware and its like use, one file each.
//!
//! Registers, bits and their effects are those of ST's reference manual RM0090, by its names. Each peripheral is
//! functions of its registers and of the time, in cycles of the core; what connects it to others is in
//! [`crate::chip`]. What a model lacks is refused, never answered with a zero.

pub mod adc;
pub mod dbgmcu;
pub mod dma;
pub mod exti;
pub mod flash;
pub mod general_timer;
pub mod gpio;
pub mod iwdg;
pub mod pwr;
pub mod rcc;
pub mod syscfg;
pub mod tim5;
pub mod tim8;
pub mod usart;

/// What the model of a peripheral lacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lack {
    /// The register.
    Register,
    /// This use of the register.
    Use(&'static str),
}

/// A peripheral's answer to an access.
pub type Answer<T = ()> = Result<T, Lack>;

/// Refuses a use unless `holds`.
fn require(holds: bool, otherwise: &'static str) -> Answer {
    if holds {
        Ok(())
    } else {
        Err(Lack::Use(otherwise))
    }
}

/// Whether bit `number` of `word` is set.
pub(crate) const fn bit(word: u32, number: u32) -> bool {
    word >> number & 1 == 1
}

/// The `width` bits of `word` from bit `first` on.
const fn field(word: u32, first: u32, width: u32) -> u32 {
    word >> first & ((1 << width) - 1)
}

/// No event is to come.
pub const NEVER: u64 = u64::MAX;
