//! A virtual board: the image that is flashed, on a simulated STM32F407, wired to the simulated paddle.
//!
//! ```text
//! image        the ELF file            -> flash
//! cpu          the processor core      -> accesses, through its Bus
//! peripherals  one file each           -> pins, interrupts, the time of their next event
//! chip         connects these
//! wiring       pins                    -> host-sim's paddle -> pins
//! board        all of it in one virtual time, with a terminal and a log
//! script       what a user types, and what happens to the board
//! ```
//!
//! The peripherals are those that the paddle's firmware and its obvious variations use. Anything else ends the run with
//! an error that names the register.
//!
//! ```no_run
//! use haptic_paddle::settings::Settings;
//! use host_sim::closed_loop::LoopSetup;
//! use host_sim::presets;
//! use virtual_board::{board::Board, image::Image, wiring::Wires};
//!
//! let image = Image::read("firmware.elf".as_ref())?;
//! let setup = LoopSetup::firmware(presets::refit(), Settings::default(), presets::motor());
//! let mut board = Board::new(&image, &setup.paddle, &setup.settings, Wires::default())?;
//! board.run_until(0.1)?;
//! board.type_in("status\r");
//! board.run_until(0.2)?;
//! println!("{}", String::from_utf8_lossy(&board.terminal.take_answer()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

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
