//! A virtual board: the image that is flashed, on a simulated STM32F407, wired to the simulated paddle.
//!
//! [`cpu`] is the processor core; it reaches everything else through its [`cpu::Bus`].

pub mod board;
pub mod chip;
pub mod clock;
pub mod cpu;
pub mod image;
pub mod log;
pub mod peripherals;
pub mod script;
pub mod terminal;
pub mod wiring;
