//! The peripherals of the STM32F407 that the paddle's firmware and similar programs use, one per file.
//!
//! Registers, bits and their effects follow ST's reference manual RM0090, with its names. Each peripheral depends only on
//! its registers and on the time in core cycles. The connections between peripherals are in [`crate::chip`]. An unmodelled
//! access is refused and never answered with a zero.

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

/// What a peripheral does not model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lack {
    /// The register.
    Register,
    /// This use of the register.
    Use(&'static str),
}

/// The answer of a peripheral to an access.
pub type Answer<T = ()> = Result<T, Lack>;

/// Returns an error with the text `otherwise` unless `holds` is true.
fn require(holds: bool, otherwise: &'static str) -> Answer {
    if holds {
        Ok(())
    } else {
        Err(Lack::Use(otherwise))
    }
}

/// Returns true if bit `number` of `word` is set.
pub(crate) const fn bit(word: u32, number: u32) -> bool {
    word >> number & 1 == 1
}

/// The `width` bits of `word` starting at bit `first`.
const fn field(word: u32, first: u32, width: u32) -> u32 {
    word >> first & ((1 << width) - 1)
}

/// A cycle that is never reached: no event.
pub const NEVER: u64 = u64::MAX;
